//! The scale s(A) of normalized diffusion, in the three cases that the talk gives polynomials for.

use translucid_fit::{ErrorSummary, ScalingFit, ScalingPolynomial};
use translucid_profile::{Configuration, ParameterError, Parameterization};

use super::{R_MAX, talk_albedos};

/// One of the talk's cases.
#[derive(Clone, Debug)]
pub struct ScalingCase {
    /// The length that s divides.
    pub parameterization: Parameterization,
    /// How light enters.
    pub configuration: Configuration,
    /// The talk's polynomial.
    pub talk: ScalingPolynomial,
    /// The same form with constants that make the mean error over all radii least.
    pub fitted: ScalingPolynomial,
    /// The mean error that the talk states, "about".
    pub stated: f64,
    /// Best s, and its error over all radii, for each of [`talk_albedos`].
    pub points: Vec<[f64; 3]>,
    /// Errors of the talk's polynomial up to each of [`R_MAX`].
    pub talk_errors: [ErrorSummary; 3],
    /// Errors of the fitted polynomial.
    pub fitted_errors: [ErrorSummary; 3],
    /// Errors of the best s at each A.
    pub least_errors: [ErrorSummary; 3],
}

impl ScalingCase {
    /// The cases in the order of the talk, with the mean errors that it states (P. H. Christensen and B. Burley 2015).
    pub const TALK: [(Parameterization, Configuration, f64); 3] = [
        (Parameterization::Mfp, Configuration::Searchlight, 0.055),
        (Parameterization::Mfp, Configuration::Diffuse, 0.039),
        (Parameterization::Dmfp, Configuration::Searchlight, 0.077),
    ];

    /// Fits one case.
    ///
    /// # Errors
    /// None for the talk's cases.
    pub fn new(
        parameterization: Parameterization,
        configuration: Configuration,
        stated: f64,
    ) -> Result<Self, ParameterError> {
        let fit = ScalingFit::new(parameterization, configuration, &talk_albedos(), f64::INFINITY)?;
        let talk = ScalingPolynomial::talk(parameterization, configuration);
        let fitted = fit.polynomial(&talk);
        Ok(Self {
            parameterization,
            configuration,
            talk,
            fitted,
            stated,
            points: fit.points().iter().map(|point| [point.surface_albedo, point.s, point.error]).collect(),
            talk_errors: R_MAX.map(|r_max| fit.errors(|a| talk.eval(a), r_max)),
            fitted_errors: R_MAX.map(|r_max| fit.errors(|a| fitted.eval(a), r_max)),
            least_errors: R_MAX.map(|r_max| fit.least_errors(r_max)),
        })
    }

    /// Short name: "searchlight-mfp".
    pub fn name(&self) -> &'static str {
        match (self.parameterization, self.configuration) {
            (Parameterization::Mfp, Configuration::Searchlight) => "searchlight-mfp",
            (Parameterization::Mfp, Configuration::Diffuse) => "diffuse-mfp",
            (Parameterization::Dmfp, Configuration::Searchlight) => "searchlight-dmfp",
            (Parameterization::Dmfp, Configuration::Diffuse) => "diffuse-dmfp",
        }
    }

    /// Index in [`R_MAX`] of the range whose mean error is nearest to the one that the talk states.
    pub fn nearest_range(&self) -> usize {
        let distance = |i: &usize| (self.talk_errors[*i].mean - self.stated).abs();
        (0..R_MAX.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }
}
