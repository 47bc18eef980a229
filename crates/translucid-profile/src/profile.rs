//! What every reflectance profile can be asked.

use crate::NormalizedDiffusion;

/// A radially symmetric reflectance profile R(r): exitance at the distance r from the point where one unit of flux has
/// entered the medium \[L⁻²\].
///
/// Lengths are in one unit that the caller chose when the profile was made.
/// What the boundary reflects from outside is no part of the unit; what it reflects from inside is accounted for.
///
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an infinity.
/// For inner loops tabulate the profile: the trait serves those who
/// swap models, and some models cost microseconds a call.
pub trait Profile: Send + Sync {
    /// Profile times radius, r R(r) \[L⁻¹\], finite everywhere: models that grow like 1/r have a limit at r = 0.
    fn eval_times_r(&self, r: f64) -> f64;

    /// Reflectance profile R(r) \[L⁻²\].
    ///
    /// r below the least normal number 2.2e-308 counts as that number, and R above the greatest number as that one.
    fn eval(&self, r: f64) -> f64 {
        finite_quotient(self.eval_times_r(r), r)
    }

    /// Energy that leaves within r: ∫₀^r R(r') 2πr' dr', with the digits of a small r.
    fn enclosed(&self, r: f64) -> f64;

    /// Energy that leaves beyond r, `total() - enclosed(r)` with the digits of a large r.
    fn beyond(&self, r: f64) -> f64;

    /// All the energy that leaves, ∫₀^∞ R 2πr dr: the surface albedo A.
    fn total(&self) -> f64;

    /// A length near which much of the energy leaves, greater than 0 \[L\]: where a table starts to look.
    fn scale(&self) -> f64;

    /// What making this profile cost: how many times its kernel (one exponential of depth or radius, one trial of an
    /// inversion) was evaluated. 0 where there is nothing to do but to store the parameters.
    fn evaluations_to_build(&self) -> u32;
}

impl Profile for NormalizedDiffusion {
    fn eval_times_r(&self, r: f64) -> f64 {
        self.eval_times_r(r)
    }

    fn eval(&self, r: f64) -> f64 {
        self.eval(r)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.enclosed(r)
    }

    fn beyond(&self, r: f64) -> f64 {
        self.surface_albedo() * self.complementary_cdf(r)
    }

    fn total(&self) -> f64 {
        self.surface_albedo()
    }

    fn scale(&self) -> f64 {
        self.d()
    }

    fn evaluations_to_build(&self) -> u32 {
        0
    }
}

/// numerator / r, at most `f64::MAX`.
#[inline(always)]
pub(crate) fn finite_quotient(numerator: f64, r: f64) -> f64 {
    (numerator / r.max(f64::MIN_POSITIVE)).min(f64::MAX)
}
