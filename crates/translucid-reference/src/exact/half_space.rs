//! Radial profile of the half space.

use translucid_profile::{ParameterError, require};

use super::albedo::single_scattering_albedo;
use super::boundary_entrance::BoundaryEntrance;
use super::dielectric::{DielectricHalfSpace, DielectricSettings};
use super::hankel_inversion::Settings;
use super::index_matched::MatchedHalfSpace;
use super::positive_radius;
use super::single_scattering::{Entrance, SingleScattering};
use crate::{Estimate, Incidence};

/// Exact reflectance profile of a half space of isotropic scatterers.
///
/// Without a boundary it is G. B. Rybicki's solution; under a [boundary](Self::with_boundary) that of an integral
/// equation over directions.
#[derive(Clone, Debug)]
pub struct HalfSpace(Solution);

#[derive(Clone, Debug)]
enum Solution {
    Matched(Box<MatchedHalfSpace>),
    Boundary(Box<DielectricHalfSpace>),
}

/// Asks whichever solution it is.
macro_rules! solution {
    ($half_space:expr, $method:ident($($argument:expr)?)) => {
        match &$half_space.0 {
            Solution::Matched(matched) => matched.$method($($argument)?),
            Solution::Boundary(boundary) => boundary.$method($($argument)?),
        }
    };
}

impl HalfSpace {
    /// Solves the half space of a single-scattering albedo α ∈ (0, 1] under light of the given entry.
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(single_scattering_albedo: f64, incidence: Incidence) -> Result<Self, ParameterError> {
        let alpha = single_scattering_albedo;
        require(alpha > 0.0 && alpha <= 1.0, "single_scattering_albedo", alpha, "in (0, 1]")?;
        let matched = MatchedHalfSpace::new(alpha, Entrance::of(incidence)?, &Settings::default());
        Ok(Self(Solution::Matched(Box::new(matched))))
    }

    /// Solves the half space of a surface albedo A ∈ (0, 1], which its total then is to 1e-12.
    ///
    /// ```
    /// use translucid_reference::{Incidence, exact::HalfSpace};
    ///
    /// # fn main() -> Result<(), translucid_profile::ParameterError> {
    /// let half_space = HalfSpace::from_surface_albedo(0.5, Incidence::NORMAL)?;
    /// assert!((half_space.single_scattering_albedo() - 0.938171938710).abs() < 1e-12);
    /// assert!((half_space.total().value - 0.5).abs() < 1e-12);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn from_surface_albedo(surface_albedo: f64, incidence: Incidence) -> Result<Self, ParameterError> {
        Self::new(single_scattering_albedo(surface_albedo, 1.0, incidence)?, incidence)
    }

    /// Solves the half space under a dielectric boundary, η = n_inside/n_outside ∈ [0.5, 3].
    ///
    /// As everywhere, one unit of flux has entered, and what the boundary reflects on its way out stays inside. An
    /// oblique pencil has its mean over the azimuth here; the rest is
    /// [`ObliqueHalfSpace`](super::ObliqueHalfSpace)'s.
    /// η = 1 is the solution without a boundary.
    ///
    /// The relative error of R(r) that is returned for r ∈ \[0.03, 10\] is some 1e-8 for η ∈ \[1.1, 2\], and 1e-6 or
    /// less for η ∈ \[0.5, 0.9\] and \[1.02, 3\]; closer to 1 it grows to some 1e-4, as the boundary reflects in an
    /// ever narrower range of angles.
    /// Totals are off by less: 2e-8 at η = 0.5, 5e-9 at 3, 1e-6 at 1.01, 8e-5 at 1.001 (parts of the total,
    /// [`Incidence::Cosine`], α = 0.5).
    /// All cores are used.
    ///
    /// # Errors
    /// A parameter is outside its range, or a beam is totally reflected (η < 1).
    ///
    /// ```
    /// use translucid_reference::exact::HalfSpace;
    /// use translucid_reference::{Incidence, specular_reflectance};
    ///
    /// // R. G. Giovanelli 1955: 0.2600, with what the surface reflects
    /// let half_space = HalfSpace::with_boundary(0.9, 1.5, Incidence::NORMAL)?;
    /// let specular = specular_reflectance(Incidence::NORMAL, 1.5);
    /// let reflectance = specular + (1.0 - specular) * half_space.total().value;
    /// assert!((reflectance - 0.2599185699).abs() < 1e-9);
    /// # Ok::<(), translucid_profile::ParameterError>(())
    /// ```
    pub fn with_boundary(
        single_scattering_albedo: f64,
        eta: f64,
        incidence: Incidence,
    ) -> Result<Self, ParameterError> {
        let entrance = BoundaryEntrance::checked(single_scattering_albedo, eta, incidence)?;
        let oblique = matches!(incidence, Incidence::Pencil { cos_theta } if cos_theta < 1.0);
        if eta == 1.0 && !oblique {
            return Self::new(single_scattering_albedo, incidence);
        }
        let settings = DielectricSettings::default();
        let solution = DielectricHalfSpace::new(single_scattering_albedo, eta, entrance, &settings);
        Ok(Self(Solution::Boundary(Box::new(solution))))
    }

    /// Single-scattering albedo α.
    pub fn single_scattering_albedo(&self) -> f64 {
        solution!(self, single_scattering_albedo())
    }

    /// Profile of the light that is scattered once.
    pub fn single_scattering(&self) -> &SingleScattering {
        solution!(self, single_scattering())
    }

    /// Surface albedo A = ∫ R 2πr dr.
    pub fn total(&self) -> Estimate {
        solution!(self, total())
    }

    /// Profile R(r) \[ℓ⁻²\].
    ///
    /// R grows like 1/r: r below the least normal number 2.2e-308 counts as that number and R above the greatest
    /// number as that one. NaN counts as 0.
    pub fn eval(&self, r: f64) -> Estimate {
        let r = positive_radius(r);
        solution!(self, eval(r))
    }

    /// Energy that leaves within r: ∫₀^r R(r') 2πr' dr', which rises to the total.
    pub fn enclosed(&self, r: f64) -> Estimate {
        let [within, _] = self.split(r);
        within
    }

    /// Energy that leaves beyond r: ∫_r^∞ R(r') 2πr' dr', the total less what leaves within r.
    ///
    /// Beyond 1e5 mean free paths it goes on like e^{−k₀r}/r, with an error of its own size; so it does beyond
    /// min(1e4, 3/k₀) where k₀ < 0.01.
    pub fn beyond(&self, r: f64) -> Estimate {
        let [_, beyond] = self.split(r);
        beyond
    }

    fn split(&self, r: f64) -> [Estimate; 2] {
        let r = positive_radius(r);
        solution!(self, split(r))
    }

    /// Hankel transform R̂(k) = ∫ R(r) J₀(kr) 2πr dr of the wave number k ≥ 0.
    pub fn hankel(&self, k: f64) -> Estimate {
        let k = if k > 0.0 { k } else { 0.0 };
        solution!(self, hankel(k))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use translucid_profile::quadrature::{gauss_legendre, integrate};
    use translucid_profile::{Configuration, half_space_surface_albedo};

    use super::super::dispersion::Dispersion;
    use super::*;

    const INCIDENCES: [Incidence; 3] = [Incidence::NORMAL, Incidence::Cosine, Incidence::UniformCosine];
    const ALPHAS: [f64; 11] = [1e-3, 0.01, 0.1, 0.3, 0.6, 0.9, 0.94, 0.99, 0.999, 0.9999, 1.0];

    fn half_space(alpha: f64, incidence: Incidence) -> HalfSpace {
        HalfSpace::new(alpha, incidence).expect("valid parameters")
    }

    /// The functions of a radius.
    const FUNCTIONS: [fn(&HalfSpace, f64) -> Estimate; 3] =
        [HalfSpace::eval, HalfSpace::enclosed, HalfSpace::beyond];

    /// Values of an independent program (plain quadrature on a fixed ray), confirmed by Monte Carlo.
    #[test]
    fn eval_matches_check_values() {
        for (alpha, incidence, r, expected, digit) in [
            (0.5, Incidence::NORMAL, 0.1, 0.27160357244, 1e-11),
            (0.9, Incidence::NORMAL, 0.1, 0.56107802802, 1e-11),
            (0.99, Incidence::NORMAL, 0.1, 0.64361446601, 1e-11),
            (0.5, Incidence::NORMAL, 1.0, 5.2531991084e-3, 1e-13),
            (0.9, Incidence::NORMAL, 1.0, 2.1217649785e-2, 1e-12),
            (0.99, Incidence::NORMAL, 1.0, 3.1387826006e-2, 1e-12),
            (0.5, Incidence::Cosine, 1.0, 7.4036993206e-3, 1e-13),
            (0.9, Incidence::Cosine, 1.0, 2.5383964017e-2, 1e-12),
        ] {
            let found = half_space(alpha, incidence).eval(r).value;
            assert!((found - expected).abs() < 0.6 * digit, "{incidence:?}, alpha {alpha}, r {r}: {found}");
        }
        let searchlight = half_space(0.938171938710, Incidence::NORMAL);
        for (r, expected) in [(0.1, 0.041267), (1.0, 0.253274), (5.0, 0.474759), (20.0, 0.499984)] {
            let found = searchlight.enclosed(r).value;
            assert!((found - expected).abs() < 6e-7, "{r}: {found}");
        }
        let total = searchlight.total().value;
        assert!((total - 0.5).abs() < 1e-11, "{total}");
    }

    /// The ray against the real axis: both sides of Parseval's equation for a Gaussian,
    /// ∫ R e^{−r²/2w²} 2πr dr = w² ∫ R̂ e^{−w²k²/2} k dk.
    #[test]
    fn eval_is_the_transform_of_hankel() {
        for (alpha, incidence) in
            [0.1, 0.9, 0.99, 1.0].iter().flat_map(|alpha| INCIDENCES.map(|incidence| (*alpha, incidence)))
        {
            let half_space = half_space(alpha, incidence);
            for width in [0.05, 1.0, 20.0f64] {
                // Both integrands are smooth in the logarithm, and fall like its exponential or faster
                let sum = |f: &dyn Fn(f64) -> f64, scale: f64| -> f64 {
                    let term = |i: i32| {
                        let x = scale * (0.125 * f64::from(i)).exp();
                        f(x) * x * 0.125
                    };
                    (-250..20).map(term).sum()
                };
                let gaussian = |x: f64| (-0.5 * x * x).exp();
                let left = sum(&|r| half_space.eval(r).value * gaussian(r / width) * 2.0 * PI * r, width);
                let right = sum(
                    &|k| half_space.hankel(k).value * gaussian(k * width) * width * width * k,
                    1.0 / width,
                );
                let off = (left / right - 1.0).abs();
                assert!(off < 1e-11, "{incidence:?}, alpha {alpha}, width {width}: {left} {right} {off:e}");
            }
        }
    }

    /// Against another program's integral, and the closed form of the uniform entry.
    #[test]
    fn total_matches_the_surface_albedo() {
        for alpha in ALPHAS {
            let root = (1.0 - alpha).sqrt();
            let expected = [
                half_space_surface_albedo(alpha, Configuration::Searchlight),
                half_space_surface_albedo(alpha, Configuration::Diffuse),
                alpha / ((1.0 + root) * (1.0 + root)),
            ];
            for (incidence, expected) in INCIDENCES.into_iter().zip(expected) {
                let total = half_space(alpha, incidence).total();
                assert!(
                    (total.value - expected).abs() < 1e-13,
                    "{incidence:?}, alpha {alpha}: {total:?} {expected}"
                );
                assert!(total.error < 4e-12 * total.value, "{total:?}");
            }
        }
    }

    #[test]
    fn enclosed_and_beyond_sum_to_total() {
        for (alpha, incidence) in
            ALPHAS.iter().flat_map(|alpha| INCIDENCES.map(|incidence| (*alpha, incidence)))
        {
            let half_space = half_space(alpha, incidence);
            let total = half_space.total().value;
            for r in [1e-300, 1e-3, 0.1, 1.0, 10.0, 300.0, 1e4] {
                let sum = half_space.enclosed(r).value + half_space.beyond(r).value;
                assert!(
                    (sum - total).abs() < 1e-12 * total,
                    "{incidence:?}, alpha {alpha}, r {r}: {sum} {total}"
                );
            }
        }
    }

    #[test]
    fn enclosed_is_the_integral_of_eval() {
        let rule = gauss_legendre(24);
        for (alpha, incidence) in
            [0.01, 0.9, 1.0].iter().flat_map(|alpha| INCIDENCES.map(|incidence| (*alpha, incidence)))
        {
            let half_space = half_space(alpha, incidence);
            for (from, to) in [(1e-4, 1.1e-4), (0.01, 0.02), (0.5, 0.8), (3.0, 4.0), (30.0, 40.0)] {
                let ring = integrate(&rule, from, to, |r| half_space.eval(r).value * 2.0 * PI * r);
                let inner = half_space.enclosed(to).value - half_space.enclosed(from).value;
                let outer = half_space.beyond(from).value - half_space.beyond(to).value;
                let total = half_space.total().value;
                assert!(
                    (ring - inner).abs() < 1e-13 * total + 1e-11 * ring,
                    "{alpha} {from}: {ring} {inner}"
                );
                assert!((ring / outer - 1.0).abs() < 1e-9 * (1.0 + 1e-4 * total / ring), "{alpha} {from}");
            }
        }
    }

    /// R → α R₁ + O(α²), and the second order by a difference quotient.
    #[test]
    fn orders_of_scattering_come_first() {
        for incidence in INCIDENCES {
            let half_space = half_space(1e-9, incidence);
            for r in [1e-3, 0.1, 1.0, 10.0, 50.0] {
                let ratio = half_space.eval(r).value / half_space.single_scattering().eval(r).value;
                assert!(ratio > 1.0 && ratio < 1.0 + 1e-7, "{incidence:?}, r {r}: {ratio}");
            }
        }
        let (normal, cosine) = (0.0972733365, 0.1158020630);
        for (incidence, expected) in INCIDENCES.into_iter().zip([normal, cosine, 0.125]) {
            let half_space = half_space(1e-7, incidence);
            let more = half_space.total().value - half_space.single_scattering().total().value;
            // The third order is below 0.1 α of the second
            assert!((more / 1e-14 - expected).abs() < 2e-8, "{incidence:?}: {more:e}");
        }
    }

    /// Far out R ~ e^{−k₀r} r⁻², from the root √(k² + k₀²) in R̂.
    #[test]
    fn eval_falls_with_the_slowest_mode() {
        for (alpha, k0) in [(0.5, 0.95750), (0.9, 0.52543), (0.99, 0.17251), (0.999, 0.05475)] {
            assert!((Dispersion::new(alpha).k0 - k0).abs() < 6e-6, "{alpha}");
            let half_space = half_space(alpha, Incidence::NORMAL);
            let r = 200.0 / k0;
            let steepness = -(half_space.eval(1.01 * r).value / half_space.eval(r).value).ln() / (0.01 * r);
            let power = (steepness - Dispersion::new(alpha).k0) * r;
            assert!((power - 2.0).abs() < 0.2, "alpha {alpha}: {power}");
        }
    }

    #[test]
    fn nothing_is_lost_without_absorption() {
        for incidence in INCIDENCES {
            let half_space = half_space(1.0, incidence);
            assert!((half_space.total().value - 1.0).abs() < 1e-13);
            // R ~ r⁻³, so beyond ~ 1/r
            let (near, far) = (half_space.beyond(100.0).value, half_space.beyond(1000.0).value);
            assert!((near / far - 10.0).abs() < 0.2, "{near} {far}");
        }
    }

    #[test]
    fn extreme_arguments_give_numbers() {
        let radii = [f64::NEG_INFINITY, -1.0, -0.0, 0.0, 1e-320, 1e-200, 1e-21, 1e-10, 1e6, 1e12, 1e300];
        for (alpha, incidence) in [1e-320, 1e-10, 0.5, 1.0 - 1e-16, 1.0]
            .iter()
            .flat_map(|alpha| INCIDENCES.map(|incidence| (*alpha, incidence)))
        {
            let half_space = half_space(alpha, incidence);
            let total = half_space.total();
            for r in radii.into_iter().chain([f64::INFINITY, f64::NAN]) {
                let values = FUNCTIONS.map(|function| function(&half_space, r));
                for Estimate { value, error } in values {
                    assert!(
                        value.is_finite() && value >= 0.0,
                        "{incidence:?}, alpha {alpha}, r {r}: {values:?}"
                    );
                    assert!(
                        error.is_finite() && error >= 0.0,
                        "{incidence:?}, alpha {alpha}, r {r}: {values:?}"
                    );
                }
                // R falls with r, so a disc of its least value is less than the whole
                let r = positive_radius(r);
                let bound = total.value / (PI * r * r);
                assert!(
                    values[0].value <= bound + values[0].error,
                    "{incidence:?}, alpha {alpha}, r {r}: {values:?}"
                );
            }
            for k in radii.into_iter().chain([f64::INFINITY, f64::NAN]) {
                let Estimate { value, error } = half_space.hankel(k);
                assert!(
                    value >= 0.0 && value <= total.value + total.error && error.is_finite(),
                    "{alpha} {k} {value}"
                );
            }
        }
    }

    #[test]
    fn surface_albedo_comes_back() {
        for incidence in INCIDENCES {
            for surface_albedo in [1e-300, 1e-17, 1e-9, 0.01, 0.3, 0.6, 0.9, 0.99, 0.9999, 1.0] {
                let half_space =
                    HalfSpace::from_surface_albedo(surface_albedo, incidence).expect("valid parameters");
                let total = half_space.total().value;
                let allowed = 1e-12 + 3e-16 / (1.0 - surface_albedo).max(1e-16);
                assert!(
                    (total - surface_albedo).abs() < allowed,
                    "{incidence:?}: {total} for {surface_albedo}"
                );
            }
            for surface_albedo in [0.0, -1.0, 1.1, f64::NAN] {
                let error = HalfSpace::from_surface_albedo(surface_albedo, incidence).unwrap_err();
                assert_eq!(error.parameter, "surface_albedo");
            }
        }
    }

    #[test]
    fn parameters_are_checked() {
        for alpha in [0.0, -0.1, 1.0000001, f64::NAN] {
            assert_eq!(
                HalfSpace::new(alpha, Incidence::NORMAL).unwrap_err().parameter,
                "single_scattering_albedo"
            );
        }
        let error = HalfSpace::new(0.5, Incidence::Pencil { cos_theta: 0.5 }).unwrap_err();
        assert_eq!(
            error.to_string(),
            "cos_theta is 0.5, but must be 1; the mean profile of an oblique pencil is with_boundary's"
        );
    }
}
