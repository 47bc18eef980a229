//! Small square matrices, as systems of directions need them.

/// A square matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SquareMatrix {
    size: usize,
    values: Vec<f64>,
}

impl SquareMatrix {
    /// The matrix with the elements f(row, column).
    pub(crate) fn from_fn(size: usize, mut f: impl FnMut(usize, usize) -> f64) -> Self {
        let values = (0..size * size).map(|i| f(i / size, i % size)).collect();
        Self { size, values }
    }

    pub(crate) fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.size..][..self.size]
    }

    /// The sum of the identity, times `diagonal`, and this matrix, times `factor`.
    pub(crate) fn plus_diagonal(&self, factor: f64, diagonal: f64) -> Self {
        Self::from_fn(self.size, |i, j| factor * self.row(i)[j] + if i == j { diagonal } else { 0.0 })
    }

    /// The sum of both, the other one times `factor`.
    pub(crate) fn plus(&self, factor: f64, other: &Self) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| a + factor * b).collect();
        Self { size: self.size, values }
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut values = vec![0.0; self.size * self.size];
        for (row, result) in values.chunks_exact_mut(self.size).enumerate() {
            for (k, factor) in self.row(row).iter().enumerate() {
                for (sum, x) in result.iter_mut().zip(other.row(k)) {
                    *sum += factor * x;
                }
            }
        }
        Self { size: self.size, values }
    }

    pub(crate) fn times_vector(&self, vector: &[f64]) -> Vec<f64> {
        (0..self.size).map(|row| self.row(row).iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
    }

    /// Greatest absolute value of an element.
    pub(crate) fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |most, value| value.abs().max(most))
    }

    /// X with self · X = `right`, by Gauss's elimination with partial pivoting.
    pub(crate) fn solve(mut self, mut right: Self) -> Self {
        let size = self.size;
        for column in 0..size {
            let size_of = |row: usize| self.values[row * size + column].abs();
            let pivot = (column..size).max_by(|a, b| size_of(*a).total_cmp(&size_of(*b))).unwrap_or(column);
            for k in 0..size {
                self.values.swap(column * size + k, pivot * size + k);
                right.values.swap(column * size + k, pivot * size + k);
            }
            let inverse = 1.0 / self.values[column * size + column];
            for row in 0..size {
                if row == column {
                    continue;
                }
                let factor = self.values[row * size + column] * inverse;
                if factor == 0.0 {
                    continue;
                }
                subtract_row(&mut self.values, size, row, column, factor);
                subtract_row(&mut right.values, size, row, column, factor);
            }
        }
        for row in 0..size {
            let inverse = 1.0 / self.values[row * size + row];
            right.values[row * size..][..size].iter_mut().for_each(|value| *value *= inverse);
        }
        right
    }
}

/// Subtracts a multiple of row `from` from row `to`.
fn subtract_row(values: &mut [f64], size: usize, to: usize, from: usize, factor: f64) {
    let (first, second) = values.split_at_mut(to.max(from) * size);
    let (lower, upper) = (&mut first[to.min(from) * size..][..size], &mut second[..size]);
    let (target, source) = if to < from { (lower, upper) } else { (upper, lower) };
    target.iter_mut().zip(source.iter()).for_each(|(t, s)| *t -= factor * s);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solve_inverts_times() {
        // No pivot on the diagonal at first
        let a = SquareMatrix::from_fn(7, |i, j| if i == j { 0.0 } else { 1.0 / (1.0 + (i * 3 + j) as f64) });
        let x = SquareMatrix::from_fn(7, |i, j| ((i * 5 + j * 2) % 7) as f64 - 3.0);
        let back = a.clone().solve(a.times(&x));
        assert!(back.plus(-1.0, &x).largest() < 1e-10, "{back:?}");
        let product = a.times_vector(&[1.0; 7]);
        assert!((product[2] - a.row(2).iter().sum::<f64>()).abs() < 1e-15);
    }
}
