//! The trait of reflectance profiles: values, energies, and the distribution of radii with its samples.

use std::f64::consts::PI;

use crate::math::roots::falling_root;

/// A radially symmetric reflectance profile R(r): exitance at the distance r from the point where one unit of flux has
/// entered the medium \[L⁻²\].
///
/// Lengths are in one unit that the caller chose when the profile was made.
/// Light that the boundary reflects from outside is not part of the unit; reflection from inside is accounted for.
///
/// Energies are parts of the surface albedo A: [`enclosed`](Self::enclosed) within a radius, [`beyond`](Self::beyond)
/// it.
/// Shares are parts of 1: [`cdf`](Self::cdf) within a radius, [`complementary_cdf`](Self::complementary_cdf) beyond it,
/// with their density [`pdf`](Self::pdf) and their inverse [`quantile`](Self::quantile).
/// A model gives its energies, and shares follow; models with closed forms replace what follows by those.
/// A profile that returns nothing has no shares of its own: all counts as leaving at r = 0, where it has none in closed
/// form.
///
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an infinity.
/// For inner loops tabulate the profile ([`TabulatedProfile`](crate::TabulatedProfile)): the trait serves those who
/// swap models, and some models cost microseconds a call.
///
/// ```
/// use translucid_profile::{Appearance, BetterDipole, Parameterization, Profile};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let jade = Appearance { surface_albedo: 0.6, length: 1.5, parameterization: Parameterization::Mfp, g: 0.0 };
/// let dipole: Box<dyn Profile> = Box::new(BetterDipole::new(&jade, 1.0)?);
/// let r = dipole.sample(0.7); // one random number in, one radius out
/// assert!((dipole.cdf(r) - 0.7).abs() < 1e-11);
/// assert!((dipole.eval(r) / dipole.pdf_area(r) - 0.6).abs() < 1e-11); // the weight of a sample
/// # Ok(())
/// # }
/// ```
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

    /// Energy that leaves beyond r, `surface_albedo() - enclosed(r)` with the digits of a large r.
    fn beyond(&self, r: f64) -> f64;

    /// Surface albedo A = ∫₀^∞ R 2πr dr: all the energy that leaves.
    ///
    /// Where the model makes more than there is, it is greater than 1.
    fn surface_albedo(&self) -> f64;

    /// A length near which much of the energy leaves, greater than 0 \[L\]: where a table starts to look.
    fn scale(&self) -> f64;

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\].
    fn pdf(&self, r: f64) -> f64 {
        share_of(self.surface_albedo(), 2.0 * PI * self.eval_times_r(r)).unwrap_or(0.0)
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\], at r = 0 as [`eval`](Self::eval).
    fn pdf_area(&self, r: f64) -> f64 {
        share_of(self.surface_albedo(), self.eval(r)).unwrap_or(0.0)
    }

    /// Share of the energy that leaves within r, with the digits of a small r.
    fn cdf(&self, r: f64) -> f64 {
        share_of(self.surface_albedo(), self.enclosed(r)).map_or(1.0, |share| share.min(1.0))
    }

    /// Share of the energy that leaves beyond r, with the digits of a large r.
    fn complementary_cdf(&self, r: f64) -> f64 {
        share_of(self.surface_albedo(), self.beyond(r)).map_or(0.0, |share| share.min(1.0))
    }

    /// Radius within which the share u ∈ [0, 1] of the energy leaves \[L\]: the inverse of [`cdf`](Self::cdf).
    ///
    /// Without a closed form it is a search of some ten steps, to 1e-12 of the lesser of u and 1 − u.
    /// u is clamped to [0, 1], NaN counts as 0, and u = 1 gives the radius of the complement 2.2e-308.
    fn quantile(&self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0);
        if u > 0.5 {
            return self.quantile_complement(1.0 - u);
        }
        radius_where(self.scale(), |r| self.cdf(r) - u, [1.0 - u, -u], 1e-12 * u)
    }

    /// Radius beyond which the share v ∈ [0, 1] of the energy leaves \[L\]: `quantile(1 − v)` with every digit of the
    /// tail.
    ///
    /// v is clamped to [2.2e-308, 1]; NaN counts as 1.
    fn quantile_complement(&self, v: f64) -> f64 {
        let v = v.min(1.0).max(f64::MIN_POSITIVE);
        if v > 0.5 {
            return self.quantile(1.0 - v);
        }
        // In logarithms, where an exponential tail is a straight line
        let excess = |share: f64| libm::log(v) - libm::log(share.max(LEAST_SHARE));
        let at_ends = [excess(0.0), excess(1.0)];
        radius_where(self.scale(), |r| excess(self.complementary_cdf(r)), at_ends, 1e-12)
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\].
    ///
    /// It need not rise with u: where a mixture is sampled term by term, strata of u overlap in r.
    /// u is clamped to [0, 1]; NaN counts as 0.
    fn sample(&self, u: f64) -> f64 {
        self.quantile(u)
    }

    /// Returns whether [`sample`](Self::sample) is a closed form or looked up in a table, which takes nanoseconds, and not a
    /// search.
    ///
    /// Where it is not, a [`TabulatedProfile`](crate::TabulatedProfile) of the profile pays from a few dozen samples on.
    fn samples_directly(&self) -> bool {
        false
    }

    /// Applies a quantity number by number, as far as the shorter slice goes, with the bits of one call for each.
    ///
    /// One call of a `dyn Profile` for many numbers; closed forms run in vector registers.
    fn apply(&self, quantity: Quantity, from: &[f64], to: &mut [f64]) {
        apply_each(self, quantity, from, to);
    }
}

/// [`Profile::apply`] for models without vector code of their own.
pub(crate) fn apply_each<P: Profile + ?Sized>(profile: &P, quantity: Quantity, from: &[f64], to: &mut [f64]) {
    fn each(from: &[f64], to: &mut [f64], f: impl Fn(f64) -> f64) {
        to.iter_mut().zip(from).for_each(|(to, &from)| *to = f(from));
    }
    match quantity {
        Quantity::Eval => each(from, to, |r| profile.eval(r)),
        Quantity::Pdf => each(from, to, |r| profile.pdf(r)),
        Quantity::PdfArea => each(from, to, |r| profile.pdf_area(r)),
        Quantity::Cdf => each(from, to, |r| profile.cdf(r)),
        Quantity::Enclosed => each(from, to, |r| profile.enclosed(r)),
        Quantity::Beyond => each(from, to, |r| profile.beyond(r)),
        Quantity::Quantile => each(from, to, |u| profile.quantile(u)),
        Quantity::Sample => each(from, to, |u| profile.sample(u)),
    }
}

/// A method of [`Profile`] that takes one number and gives one, for [`Profile::apply`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// [`Profile::eval`].
    Eval,
    /// [`Profile::pdf`].
    Pdf,
    /// [`Profile::pdf_area`].
    PdfArea,
    /// [`Profile::cdf`].
    Cdf,
    /// [`Profile::enclosed`].
    Enclosed,
    /// [`Profile::beyond`].
    Beyond,
    /// [`Profile::quantile`].
    Quantile,
    /// [`Profile::sample`].
    Sample,
}

/// Methods of [`Profile`] that a part of the type has, or the type itself, under the same names; with `all`, those of one that
/// knows its shares and samples directly.
macro_rules! methods_of {
    (|$this:ident| $part:expr; all) => {
        $crate::profile::methods_of!(
            |$this| $part; eval_times_r, eval, enclosed, pdf, pdf_area, cdf, complementary_cdf, quantile,
            quantile_complement, sample
        );

        fn beyond(&self, r: f64) -> f64 {
            let $this = self;
            $part.surface_albedo() * $part.complementary_cdf(r)
        }

        fn surface_albedo(&self) -> f64 {
            let $this = self;
            $part.surface_albedo()
        }

        fn samples_directly(&self) -> bool {
            true
        }
    };
    (|$this:ident| $part:expr; $($method:ident),+) => {
        $(fn $method(&self, x: f64) -> f64 {
            let $this = self;
            $part.$method(x)
        })+
    };
}
pub(crate) use methods_of;

/// numerator / r, at most `f64::MAX`.
#[inline(always)]
pub(crate) fn finite_quotient(numerator: f64, r: f64) -> f64 {
    (numerator / r.max(f64::MIN_POSITIVE)).min(f64::MAX)
}

/// A part of a whole, at least 0 and at most `f64::MAX`; none where there is no whole.
fn share_of(whole: f64, part: f64) -> Option<f64> {
    (whole > 0.0).then(|| (part / whole).max(0.0).min(f64::MAX))
}

/// Least share of which a logarithm is taken: less than every normal number.
const LEAST_SHARE: f64 = 5e-324;

/// The radius where a function is 0 that falls with x = scale/(scale + r), by its values at x = 0 and x = 1.
fn radius_where(scale: f64, f: impl Fn(f64) -> f64, at_ends: [f64; 2], tolerance: f64) -> f64 {
    let radius = |x: f64| (scale * ((1.0 - x) / x)).min(f64::MAX);
    radius(falling_root(|x| f(radius(x)), at_ends, |_| tolerance))
}
