//! Least squares of a few parameters.
//!
//! The method is Levenberg's and Marquardt's as in MINPACK [J. J. Moré, *The Levenberg–Marquardt Algorithm: Implementation and
//! Theory*, 1978], by the crate `levenberg-marquardt`.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

/// Residuals r(p) of a model, which least squares makes small.
pub trait Residuals {
    /// The residuals; their number is the same for all parameters.
    fn residuals(&self, parameters: &[f64]) -> Vec<f64>;

    /// Their derivatives: ∂r_i/∂p_j in row i and column j.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64>;
}

/// Parameters near a start where Σ r² is least.
///
/// A step that leads to residuals that are not finite is not taken.
/// The start comes back where there is nothing to do: no residuals, no parameters, or numbers that are not finite.
pub fn least_squares(search: LevenbergMarquardt<f64>, start: &[f64], residuals: &impl Residuals) -> Vec<f64> {
    let parameters = DVector::from_column_slice(start);
    let (found, _) = search.minimize(Problem { residuals, parameters });
    found.parameters.as_slice().to_vec()
}

/// A search of the crate's own form, at some parameters.
struct Problem<'a, R> {
    residuals: &'a R,
    parameters: DVector<f64>,
}

impl<R: Residuals> LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, R> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, parameters: &DVector<f64>) {
        self.parameters.copy_from(parameters);
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(DVector::from_vec(self.residuals.residuals(self.parameters.as_slice())))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some(self.residuals.jacobian(self.parameters.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's function as a sum of squares, whose minimum is (1, 1).
    struct Rosenbrock;

    impl Residuals for Rosenbrock {
        fn residuals(&self, p: &[f64]) -> Vec<f64> {
            vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]
        }

        fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
            DMatrix::from_row_slice(2, 2, &[-20.0 * p[0], 10.0, -1.0, 0.0])
        }
    }

    #[test]
    fn least_squares_finds_the_minimum() {
        let found = least_squares(LevenbergMarquardt::new(), &[-1.2, 1.0], &Rosenbrock);
        assert!(found.iter().all(|p| (p - 1.0).abs() < 1e-12), "{found:?}");
    }

    /// Only where the root is of a positive number are there residuals.
    struct Root;

    impl Residuals for Root {
        fn residuals(&self, p: &[f64]) -> Vec<f64> {
            vec![p[0].sqrt() - 0.1, 1e-3 * p[0]]
        }

        fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
            DMatrix::from_row_slice(2, 1, &[0.5 / p[0].sqrt(), 1e-3])
        }
    }

    #[test]
    fn steps_to_residuals_that_are_not_finite_are_not_taken() {
        let found = least_squares(LevenbergMarquardt::new(), &[4.0], &Root);
        assert!((found[0] - 0.01).abs() < 1e-4, "{found:?}");
        assert_eq!(least_squares(LevenbergMarquardt::new(), &[-1.0], &Root), [-1.0]);
    }
}
