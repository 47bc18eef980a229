//! Small square matrices, as systems of rays need them.
//!
//! The order of every sum is fixed: the same bits on every machine.

/// A square matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Matrix {
    size: usize,
    values: Vec<f64>,
}

/// Eigenvalues, and eigenvectors as columns.
pub(super) struct Eigen {
    pub(super) values: Vec<f64>,
    pub(super) vectors: Matrix,
}

impl Matrix {
    pub(super) fn from_fn(size: usize, mut f: impl FnMut(usize, usize) -> f64) -> Self {
        let values = (0..size * size).map(|i| f(i / size, i % size)).collect();
        Self { size, values }
    }

    pub(super) fn diagonal(values: &[f64]) -> Self {
        Self::from_fn(values.len(), |i, j| if i == j { values[i] } else { 0.0 })
    }

    pub(super) fn size(&self) -> usize {
        self.size
    }

    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.size + column]
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.size..][..self.size]
    }

    pub(super) fn transposed(&self) -> Self {
        Self::from_fn(self.size, |i, j| self.at(j, i))
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let n = self.size;
        let mut values = vec![0.0; n * n];
        for (row, result) in values.chunks_exact_mut(n).enumerate() {
            for (k, factor) in self.row(row).iter().enumerate() {
                for (sum, x) in result.iter_mut().zip(other.row(k)) {
                    *sum += factor * x;
                }
            }
        }
        Self { size: n, values }
    }

    pub(super) fn times_vector(&self, vector: &[f64]) -> Vec<f64> {
        (0..self.size).map(|row| self.row(row).iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
    }

    /// M · diag(values) · Mᵀ.
    pub(super) fn sandwich(&self, values: &[f64]) -> Self {
        let scaled = Self::from_fn(self.size, |i, j| self.at(i, j) * values[j]);
        scaled.times(&self.transposed())
    }

    /// The lower factor L of a positive definite matrix L·Lᵀ.
    pub(super) fn cholesky(&self) -> Self {
        let n = self.size;
        let mut lower = Self { size: n, values: vec![0.0; n * n] };
        for i in 0..n {
            for j in 0..=i {
                let dot: f64 = lower.row(i)[..j].iter().zip(&lower.row(j)[..j]).map(|(a, b)| a * b).sum();
                let rest = self.at(i, j) - dot;
                lower.values[i * n + j] =
                    if i == j { rest.max(f64::MIN_POSITIVE).sqrt() } else { rest / lower.at(j, j) };
            }
        }
        lower
    }

    /// The inverse of a lower triangle.
    pub(super) fn lower_inverse(&self) -> Self {
        let n = self.size;
        let mut inverse = Self { size: n, values: vec![0.0; n * n] };
        for i in 0..n {
            let scale = 1.0 / self.at(i, i);
            let (before, now) = inverse.values.split_at_mut(i * n);
            let row = &mut now[..n];
            for (k, factor) in self.row(i)[..i].iter().enumerate() {
                for (sum, x) in row.iter_mut().zip(&before[k * n..][..=k]) {
                    *sum -= factor * x;
                }
            }
            row.iter_mut().for_each(|x| *x *= scale);
            row[i] = scale;
        }
        inverse
    }

    /// (1 + self)⁻¹ for a positive semidefinite matrix.
    pub(super) fn one_plus_inverse(&self) -> Self {
        let sum = Self::from_fn(self.size, |i, j| self.at(i, j) + if i == j { 1.0 } else { 0.0 });
        let inverse = sum.cholesky().lower_inverse();
        inverse.transposed().times(&inverse)
    }

    /// X with self · X = `right`, by Gauss's elimination with partial pivoting.
    pub(super) fn solve(mut self, mut right: Self) -> Self {
        let n = self.size;
        for column in 0..n {
            let size_of = |row: usize| self.values[row * n + column].abs();
            let pivot = (column..n).max_by(|a, b| size_of(*a).total_cmp(&size_of(*b))).unwrap_or(column);
            for k in 0..n {
                self.values.swap(column * n + k, pivot * n + k);
                right.values.swap(column * n + k, pivot * n + k);
            }
            let inverse = 1.0 / self.values[column * n + column];
            for row in column + 1..n {
                let factor = self.values[row * n + column] * inverse;
                if factor != 0.0 {
                    subtract_row(&mut self.values, n, [column, row], factor);
                    subtract_row(&mut right.values, n, [column, row], factor);
                }
            }
        }
        for row in (0..n).rev() {
            for later in row + 1..n {
                let factor = self.values[row * n + later];
                let (first, second) = right.values.split_at_mut(later * n);
                let target = &mut first[row * n..][..n];
                target.iter_mut().zip(&second[..n]).for_each(|(t, s)| *t -= factor * s);
            }
            let inverse = 1.0 / self.values[row * n + row];
            right.values[row * n..][..n].iter_mut().for_each(|value| *value *= inverse);
        }
        right
    }

    /// Eigenvalues and eigenvectors of a symmetric matrix: Householder's tridiagonal form and implicit QL steps
    /// (R. S. Martin, C. Reinsch and J. H. Wilkinson 1968; the procedures tred2 and tql2).
    pub(super) fn symmetric_eigen(mut self) -> Eigen {
        let n = self.size;
        let [mut diagonal, mut beside] = [vec![0.0; n], vec![0.0; n]];
        self.make_tridiagonal(&mut diagonal, &mut beside);
        self.ql_steps(&mut diagonal, &mut beside);
        Eigen { values: diagonal, vectors: self }
    }

    /// Becomes the orthogonal matrix that makes it tridiagonal.
    fn make_tridiagonal(&mut self, d: &mut [f64], e: &mut [f64]) {
        let n = self.size;
        let a = &mut self.values;
        for i in (1..n).rev() {
            let scale: f64 = if i > 1 { a[i * n..][..i].iter().map(|x| x.abs()).sum() } else { 0.0 };
            let mut h = 0.0;
            if scale == 0.0 {
                e[i] = a[i * n + i - 1];
            } else {
                a[i * n..][..i].iter_mut().for_each(|x| *x /= scale);
                h = a[i * n..][..i].iter().map(|x| x * x).sum();
                let f = a[i * n + i - 1];
                let g = if f >= 0.0 { -h.sqrt() } else { h.sqrt() };
                e[i] = scale * g;
                h -= f * g;
                a[i * n + i - 1] = f - g;
                let mut sum = 0.0;
                for j in 0..i {
                    a[j * n + i] = a[i * n + j] / h;
                    let mut g: f64 = (0..=j).map(|k| a[j * n + k] * a[i * n + k]).sum();
                    g += (j + 1..i).map(|k| a[k * n + j] * a[i * n + k]).sum::<f64>();
                    e[j] = g / h;
                    sum += e[j] * a[i * n + j];
                }
                let half = sum / (h + h);
                for j in 0..i {
                    let f = a[i * n + j];
                    e[j] -= half * f;
                    let g = e[j];
                    for k in 0..=j {
                        a[j * n + k] -= f * e[k] + g * a[i * n + k];
                    }
                }
            }
            d[i] = h;
        }
        (d[0], e[0]) = (0.0, 0.0);
        for i in 0..n {
            if d[i] != 0.0 {
                for j in 0..i {
                    let g: f64 = (0..i).map(|k| a[i * n + k] * a[k * n + j]).sum();
                    (0..i).for_each(|k| a[k * n + j] -= g * a[k * n + i]);
                }
            }
            d[i] = a[i * n + i];
            a[i * n + i] = 1.0;
            (0..i).for_each(|j| (a[j * n + i], a[i * n + j]) = (0.0, 0.0));
        }
    }

    fn ql_steps(&mut self, d: &mut [f64], e: &mut [f64]) {
        let n = self.size;
        e.rotate_left(1);
        // Rotations run over pairs of rows of the transposed vectors, which lie in one piece
        let mut z = self.transposed();
        for l in 0..n {
            for _ in 0..60 {
                let is_split = |m: usize| e[m].abs() <= f64::EPSILON * (d[m].abs() + d[m + 1].abs());
                let m = (l..n - 1).find(|m| is_split(*m)).unwrap_or(n - 1);
                if m == l {
                    break;
                }
                let g = (d[l + 1] - d[l]) / (2.0 * e[l]);
                let r = (g * g + 1.0).sqrt();
                let mut g = d[m] - d[l] + e[l] / (g + r.copysign(g));
                let (mut s, mut c, mut p) = (1.0, 1.0, 0.0);
                for i in (l..m).rev() {
                    let (f, b) = (s * e[i], c * e[i]);
                    let r = (f * f + g * g).sqrt();
                    e[i + 1] = r;
                    if r == 0.0 {
                        d[i + 1] -= p;
                        e[m] = 0.0;
                        break;
                    }
                    (s, c) = (f / r, g / r);
                    g = d[i + 1] - p;
                    let r = (d[i] - g) * s + 2.0 * c * b;
                    p = s * r;
                    d[i + 1] = g + p;
                    g = c * r - b;
                    let (first, second) = z.values.split_at_mut((i + 1) * n);
                    for (low, high) in first[i * n..].iter_mut().zip(&mut second[..n]) {
                        (*high, *low) = (s * *low + c * *high, c * *low - s * *high);
                    }
                }
                d[l] -= p;
                e[l] = g;
                e[m] = 0.0;
            }
        }
        *self = z.transposed();
    }
}

/// Subtracts a multiple of the first row from the second, which comes later.
fn subtract_row(values: &mut [f64], size: usize, [from, to]: [usize; 2], factor: f64) {
    let (first, second) = values.split_at_mut(to * size);
    let source = &first[from * size..][..size];
    second[..size].iter_mut().zip(source).for_each(|(t, s)| *t -= factor * s);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(a: &Matrix, b: &Matrix) -> f64 {
        a.values.iter().zip(&b.values).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
    }

    fn example(n: usize) -> Matrix {
        let element =
            |i: usize, j: usize| 1.0 / (1.0 + (i * j + i + j) as f64) + if i == j { 2.0 } else { 0.0 };
        Matrix::from_fn(n, element)
    }

    #[test]
    fn solve_inverts_times() {
        // No pivot on the diagonal at first
        let a = Matrix::from_fn(7, |i, j| if i == j { 0.0 } else { 1.0 / (1.0 + (i * 3 + j) as f64) });
        let x = Matrix::from_fn(7, |i, j| ((i * 5 + j * 2) % 7) as f64 - 3.0);
        assert!(distance(&a.clone().solve(a.times(&x)), &x) < 1e-10);
    }

    #[test]
    fn factors_make_the_matrix() {
        for n in [1, 2, 9] {
            let (a, one) = (example(n), Matrix::diagonal(&vec![1.0; n]));
            let lower = a.cholesky();
            assert!(distance(&lower.times(&lower.transposed()), &a) < 1e-14);
            assert!(distance(&lower.times(&lower.lower_inverse()), &one) < 1e-14);
            let sum = Matrix::from_fn(n, |i, j| a.at(i, j) + one.at(i, j));
            assert!(distance(&sum.times(&a.one_plus_inverse()), &one) < 1e-14);
            let Eigen { values, vectors } = a.clone().symmetric_eigen();
            assert!(distance(&vectors.sandwich(&values), &a) < 1e-13);
            assert!(distance(&vectors.sandwich(&vec![1.0; n]), &one) < 1e-13);
        }
    }
}
