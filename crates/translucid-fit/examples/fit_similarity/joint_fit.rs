//! Functions of (A, g, η) with linear coefficients, fitted to the shares of all rings at once.

use nalgebra::{DMatrix, DVector};

/// Differences below this count as their squares: at first, and in the end.
const EPSILON: [f64; 2] = [3e-2, 1e-3];
/// Number of times that ε falls.
const STAGES: i32 = 8;
/// Most steps between two ε.
const STEPS: u32 = 30;
/// Step of the difference quotients.
const STEP: f64 = 1e-5;

/// Points with their rings, and P functions each a sum of basis functions times coefficients.
pub(crate) struct JointFit<'a, const P: usize, Model> {
    /// Shares of the rings to be met.
    pub(crate) shares: Vec<&'a [f64]>,
    /// By point, then by function: the basis functions there.
    pub(crate) bases: Vec<[Vec<f64>; P]>,
    /// Shares of the rings for a point and values of the functions.
    pub(crate) model: Model,
}

impl<const P: usize, Model: Fn(usize, [f64; P]) -> Vec<f64>> JointFit<'_, P, Model> {
    /// Coefficients for the least sum of L1 distances, from a start.
    ///
    /// The sum of √(x² + ε²) over the differences x, by least squares whose weights 1/√(x² + ε²) are made anew in each
    /// step, after Levenberg and Marquardt; ε falls.
    pub(crate) fn minimize_l1(&self, start: Vec<f64>) -> Vec<f64> {
        let mut coefficients = DVector::from_vec(start);
        for stage in 0..STAGES {
            let share = f64::from(stage) / f64::from(STAGES - 1);
            let epsilon = EPSILON[0] * (EPSILON[1] / EPSILON[0]).powf(share);
            self.descend(&mut coefficients, epsilon);
        }
        coefficients.as_slice().to_vec()
    }

    /// L1 distance at each point.
    pub(crate) fn l1_errors(&self, coefficients: &[f64]) -> Vec<f64> {
        let coefficients = DVector::from_column_slice(coefficients);
        let of_point = |point: usize| -> f64 {
            let model = (self.model)(point, self.values(&coefficients, point));
            model.iter().zip(self.shares[point]).map(|(a, b)| (a - b).abs()).sum()
        };
        (0..self.shares.len()).map(of_point).collect()
    }

    fn descend(&self, coefficients: &mut DVector<f64>, epsilon: f64) {
        let mut damping = 1e-3;
        let mut cost = self.cost(coefficients, epsilon);
        for _ in 0..STEPS {
            let (hessian, gradient) = self.normal_equations(coefficients, epsilon);
            let before = cost;
            while damping < 1e6 {
                let damped = DMatrix::from_fn(hessian.nrows(), hessian.ncols(), |i, j| {
                    let diagonal = if i == j { damping * (hessian[(i, i)] + 1e-6) } else { 0.0 };
                    hessian[(i, j)] + diagonal
                });
                let step = damped.cholesky().map(|cholesky| cholesky.solve(&gradient));
                let next = step.map(|step| &*coefficients - step);
                if let Some(next) = next {
                    let found = self.cost(&next, epsilon);
                    if found < cost {
                        (*coefficients, cost) = (next, found);
                        damping = (damping / 5.0).max(1e-9);
                        break;
                    }
                }
                damping *= 4.0;
            }
            if before - cost <= 1e-6 * before {
                break;
            }
        }
    }

    /// Values of the functions at a point.
    fn values(&self, coefficients: &DVector<f64>, point: usize) -> [f64; P] {
        let mut rest = coefficients.as_slice();
        self.bases[point].each_ref().map(|basis| {
            let (own, others) = rest.split_at(basis.len());
            rest = others;
            basis.iter().zip(own).map(|(b, c)| b * c).sum()
        })
    }

    fn cost(&self, coefficients: &DVector<f64>, epsilon: f64) -> f64 {
        let of_point = |point: usize| -> f64 {
            let values = self.values(coefficients, point);
            // Steps that leave what is sensible count as failures
            if values.iter().any(|value| value.abs() > 5.0) {
                return f64::INFINITY;
            }
            let model = (self.model)(point, values);
            model.iter().zip(self.shares[point]).map(|(a, b)| (a - b).hypot(epsilon)).sum()
        };
        (0..self.shares.len()).map(of_point).sum()
    }

    /// JᵀWJ and JᵀWx, point by point: each has a block of P × P in its own functions.
    fn normal_equations(&self, coefficients: &DVector<f64>, epsilon: f64) -> (DMatrix<f64>, DVector<f64>) {
        let n = coefficients.len();
        let (mut hessian, mut gradient) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (point, shares) in self.shares.iter().enumerate() {
            let values = self.values(coefficients, point);
            let model = (self.model)(point, values);
            let slopes: [Vec<f64>; P] = std::array::from_fn(|i| {
                let at = |step: f64| {
                    let mut moved = values;
                    moved[i] += step;
                    (self.model)(point, moved)
                };
                let (above, below) = (at(STEP), at(-STEP));
                above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * STEP)).collect()
            });
            let weigh = |a: &[f64], b: &dyn Fn(usize) -> f64| -> f64 {
                let weight = |k: usize| 1.0 / (model[k] - shares[k]).hypot(epsilon);
                (0..model.len()).map(|k| a[k] * b(k) * weight(k)).sum()
            };
            let block: [[f64; P]; P] =
                std::array::from_fn(|i| std::array::from_fn(|j| weigh(&slopes[i], &|k| slopes[j][k])));
            let pull: [f64; P] = std::array::from_fn(|i| weigh(&slopes[i], &|k| model[k] - shares[k]));

            let rows: Vec<(usize, f64)> = (self.bases[point].iter().enumerate())
                .flat_map(|(i, basis)| basis.iter().map(move |b| (i, *b)))
                .collect();
            for (row, (i, b)) in rows.iter().enumerate() {
                gradient[row] += b * pull[*i];
                for (column, (j, c)) in rows.iter().enumerate() {
                    hessian[(row, column)] += b * c * block[*i][*j];
                }
            }
        }
        (hessian, gradient)
    }
}
