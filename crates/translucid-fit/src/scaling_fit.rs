//! The scale s(A) of normalized diffusion that brings it closest to the exact half space.

use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::DMatrix;
use translucid_profile::{
    Configuration, ExactProfile, Medium, NormalizedDiffusion, ParameterError, Parameterization,
    half_space_single_scattering_albedo, require,
};

use crate::least_squares::{Residuals, least_squares};
use crate::minimum::minimum;
use crate::{Judge, ScalingPolynomial};

/// The best scale at one surface albedo.
#[derive(Clone, Debug)]
pub struct ScalingPoint {
    /// Surface albedo A.
    pub surface_albedo: f64,
    /// The length that s divides, in mean free paths: 1, or ℓ_d/ℓ of the medium.
    pub length: f64,
    /// The scale that minimizes the L1 error, dimensionless.
    pub s: f64,
    /// Error [`l1_error`](crate::l1_error) for the radii of the fit.
    pub error: f64,
    judge: Judge,
}

impl ScalingPoint {
    fn new(case: &ScalingFit, surface_albedo: f64) -> Result<Self, ParameterError> {
        let exact = ExactProfile::new(surface_albedo, 1.0, Parameterization::Mfp, case.configuration)?;
        let length = match case.parameterization {
            Parameterization::Mfp => 1.0,
            Parameterization::Dmfp => {
                let alpha = half_space_single_scattering_albedo(surface_albedo, case.configuration);
                Medium::from_mfp(alpha, 1.0, 0.0)?.dmfp()
            }
        };
        let judge = Judge::new(&exact);
        let mut point = Self { surface_albedo, length, s: 1.0, error: 0.0, judge };
        // The tolerance is what the rounding of the error leaves
        let error = |ln_s: f64| point.error_of(libm::exp(ln_s), case.r_max);
        let [ln_s, least] = minimum(error, Self::LN_S.map(|ln_s| ln_s + libm::log(length)), 60, 1e-8);
        (point.s, point.error) = (libm::exp(ln_s), least);
        Ok(point)
    }

    /// Range of ln(s/length), which at all albedos and radii holds the best one.
    const LN_S: [f64; 2] = [-5.0, 5.0];

    /// L1 error of a scale for radii up to `r_max` mean free paths.
    pub fn error_of(&self, s: f64, r_max: f64) -> f64 {
        let [error] = self.errors_of(s, [r_max]);
        error
    }

    /// L1 errors of a scale for several greatest radii, in mean free paths; 2 where s is not greater than 0.
    pub fn errors_of<const N: usize>(&self, s: f64, r_max: [f64; N]) -> [f64; N] {
        let profile = NormalizedDiffusion::from_d(self.surface_albedo, self.length / s);
        profile.map_or([2.0; N], |profile| self.judge.l1_errors(&profile, r_max))
    }
}

/// Best scales of normalized diffusion for many surface albedos, and polynomials through them.
///
/// The reference is the exact half space of isotropic scatterers without a boundary ([`ExactProfile`]).
///
/// ```
/// use translucid_fit::{ScalingFit, ScalingPolynomial};
/// use translucid_profile::{Configuration, Parameterization};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let (mfp, searchlight) = (Parameterization::Mfp, Configuration::Searchlight);
/// let fit = ScalingFit::new(mfp, searchlight, &[0.1, 0.3, 0.5, 0.7, 0.9], f64::INFINITY)?;
/// assert!((fit.points()[2].s - 1.594).abs() < 1e-3);
/// let talk = ScalingPolynomial::talk(mfp, searchlight);
/// let mean = |s: &ScalingPolynomial| fit.errors(|a| s.eval(a), f64::INFINITY).mean;
/// assert!(mean(&fit.polynomial(&talk)) < mean(&talk));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ScalingFit {
    parameterization: Parameterization,
    configuration: Configuration,
    r_max: f64,
    points: Vec<ScalingPoint>,
}

/// Errors over many surface albedos.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSummary {
    /// Mean over the albedos.
    pub mean: f64,
    /// The greatest.
    pub worst: f64,
    /// Surface albedo of the greatest.
    pub worst_surface_albedo: f64,
}

impl ErrorSummary {
    /// Sums up errors of surface albedos; all 0 where there are none.
    pub fn new(errors: &[(f64, f64)]) -> Self {
        let sum: f64 = errors.iter().map(|(_, error)| error).sum();
        let worst = errors.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        Self { mean: sum / errors.len().max(1) as f64, worst: worst.1, worst_surface_albedo: worst.0 }
    }
}

impl ScalingFit {
    /// Finds the best scale for each surface albedo and radii up to `r_max` mean free paths, which may be infinite.
    ///
    /// A millisecond or two for each albedo.
    ///
    /// # Errors
    /// A surface albedo is not in \[0, 1\], 0, or 1 with a diffuse mean free path; or `r_max` is not greater than 0.
    pub fn new(
        parameterization: Parameterization,
        configuration: Configuration,
        surface_albedos: &[f64],
        r_max: f64,
    ) -> Result<Self, ParameterError> {
        require(r_max > 0.0, "r_max", r_max, "greater than 0")?;
        for &a in surface_albedos {
            let is_allowed = a > 0.0 && (a < 1.0 || parameterization == Parameterization::Mfp);
            require(is_allowed, "surface_albedo", a, "in (0, 1], and below 1 with a dmfp")?;
        }
        let mut fit = Self { parameterization, configuration, r_max, points: Vec::new() };
        fit.points = surface_albedos.iter().map(|a| ScalingPoint::new(&fit, *a)).collect::<Result<_, _>>()?;
        Ok(fit)
    }

    /// The best scale for each surface albedo.
    pub fn points(&self) -> &[ScalingPoint] {
        &self.points
    }

    /// The polynomial of the form of `start` whose mean error over the points is least, from there.
    ///
    /// A point that is missed counts by the error that this adds: the residual is the root of error(s) − error(best s),
    /// whose squares sum to what the mean error has above its floor. Where the error is quadratic about its minimum,
    /// the residual is linear in s, as least squares like it.
    pub fn polynomial(&self, start: &ScalingPolynomial) -> ScalingPolynomial {
        let problem = Problem { fit: self, form: *start };
        let search = LevenbergMarquardt::new().with_patience(100).with_tol(1e-12);
        problem.polynomial(&least_squares(search, &start.constants(), &problem))
    }

    /// Mean and worst error of a scale s(A) over the points, for radii up to `r_max` mean free paths.
    pub fn errors(&self, s: impl Fn(f64) -> f64, r_max: f64) -> ErrorSummary {
        let error =
            |point: &ScalingPoint| (point.surface_albedo, point.error_of(s(point.surface_albedo), r_max));
        ErrorSummary::new(&self.points.iter().map(error).collect::<Vec<_>>())
    }

    /// Mean and worst error of the best scales.
    pub fn least_errors(&self, r_max: f64) -> ErrorSummary {
        let error = |point: &ScalingPoint| (point.surface_albedo, point.error_of(point.s, r_max));
        ErrorSummary::new(&self.points.iter().map(error).collect::<Vec<_>>())
    }

    /// Residual of a point as a function of s, falling below the best s and rising above.
    fn residual(&self, point: &ScalingPoint, s: f64) -> f64 {
        // Continues in the logarithm where s leaves the range that has profiles
        let s = s.max(1e-6 * point.s);
        let excess = point.error_of(s, self.r_max) - point.error;
        excess.max(0.0).sqrt().copysign(s - point.s)
    }
}

/// Errors that polynomials of a form add to those of the best scales.
struct Problem<'a> {
    fit: &'a ScalingFit,
    form: ScalingPolynomial,
}

impl Problem<'_> {
    fn polynomial(&self, constants: &[f64]) -> ScalingPolynomial {
        self.form.with_constants([constants[0], constants[1], constants[2]])
    }
}

impl Residuals for Problem<'_> {
    fn residuals(&self, constants: &[f64]) -> Vec<f64> {
        let s = self.polynomial(constants);
        let residual = |point: &ScalingPoint| self.fit.residual(point, s.eval(point.surface_albedo));
        self.fit.points.iter().map(residual).collect()
    }

    fn jacobian(&self, constants: &[f64]) -> DMatrix<f64> {
        /// Relative step of s: far above where the roots of rounding errors count
        const STEP: f64 = 1e-3;
        let polynomial = self.polynomial(constants);
        let row = |point: &ScalingPoint| {
            let s = polynomial.eval(point.surface_albedo);
            let residual = |s: f64| self.fit.residual(point, s);
            let slope = (residual(s * (1.0 + STEP)) - residual(s * (1.0 - STEP))) / (2.0 * STEP * s);
            polynomial.slopes(point.surface_albedo).map(|of_constant| slope * of_constant)
        };
        let rows: Vec<[f64; 3]> = self.fit.points.iter().map(row).collect();
        DMatrix::from_fn(rows.len(), 3, |row, column| rows[row][column])
    }
}
