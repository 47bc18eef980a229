//! The scale s(A) of normalized diffusion, in the three cases that the talk gives polynomials for.

use translucid_fit::{ErrorSummary, ScalingFit, ScalingPolynomial};
use translucid_profile::{Configuration, ParameterError, Parameterization};

use super::{R_MAX, talk_albedos};

/// A length and a configuration for which s(A) is fitted.
#[derive(Clone, Debug)]
pub struct ScalingCase {
    /// The length that s divides.
    pub parameterization: Parameterization,
    /// Way in which light enters.
    pub configuration: Configuration,
    /// The talk's polynomial.
    pub talk: ScalingPolynomial,
    /// Polynomial of the talk's form with constants that make the mean error least.
    pub fitted: ScalingPolynomial,
    /// The mean error that the talk states, "about"; `None` where it has no polynomial of its own.
    pub stated: Option<f64>,
    /// Surface albedo, best s, and its error, for each of [`talk_albedos`].
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

    /// Greatest distance of a mean error from the stated one that counts as agreement: half a point.
    const TOLERANCE: f64 = 0.005;

    /// Fits s for least errors over radii up to `r_max` mean free paths, which may be infinite.
    ///
    /// # Errors
    /// `r_max` is not greater than 0.
    pub fn new(
        parameterization: Parameterization,
        configuration: Configuration,
        r_max: f64,
    ) -> Result<Self, ParameterError> {
        let is_this = |case: &&(Parameterization, Configuration, f64)| {
            (case.0, case.1) == (parameterization, configuration)
        };
        let stated = Self::TALK.iter().find(is_this).map(|case| case.2);
        let fit = ScalingFit::new(parameterization, configuration, &talk_albedos(), r_max)?;
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

    /// Index in [`R_MAX`] of the range over which the talk's polynomial has a mean error closest to what the talk
    /// states, and whether it is that within half a point; `None` where it states nothing.
    pub fn reproduction(&self) -> Option<(usize, bool)> {
        let stated = self.stated?;
        let distance = |i: usize| (self.talk_errors[i].mean - stated).abs();
        let nearest = (0..R_MAX.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
        Some((nearest, distance(nearest) < Self::TOLERANCE))
    }
}
