//! Similarity: how a phase function and a boundary change the profiles that were made for neither.
//!
//! D. R. Wyman, M. S. Patterson and B. C. Wilson, *Similarity relations for anisotropic scattering in Monte Carlo
//! simulations of deeply penetrating neutral particles*, J. Comput. Phys. 81, 1989: media of equal absorption σ_a and
//! equal reduced scattering σ'_s = (1 − g) σ_s look alike from afar.
//! Up close they do not, and a boundary that sends light back inside changes the profile at any distance.
//! The remaining differences are fitted here to walks of photons and, for g = 0, to the exact solution.

use std::ops::RangeInclusive;

use crate::error::{ParameterError, require, require_fraction, require_positive};
use crate::math::polynomial::polynomial;
use crate::math::roots::falling_root;
use crate::medium::scaling::mfp_per_dmfp_polynomial;
use crate::medium::similarity_coefficients::{Coefficients, DIFFUSE, SEARCHLIGHT, SURFACE_ALBEDOS};
use crate::{Configuration, Medium, Parameterization, fresnel_moment_1_from_inside};

/// Monomials of g and the boundary that the fits are made of.
const MONOMIALS: usize = 7;

/// Effect of a mean cosine g and a relative index η on the profile of a surface albedo A, for g ∈ [−0.5, 0.9], η ∈ [1, 1.5].
///
/// The half space has the phase function of L. G. Henyey and J. L. Greenstein, 1941, and a smooth dielectric boundary.
/// As everywhere in this crate, A is the share of the light that *entered* which leaves again: what the boundary
/// reflects outside is no part of it, what it reflects inside is.
/// Light enters as the [`Configuration`] says *outside* the boundary: as a perpendicular pencil, or from all directions
/// with a cosine distribution, less what is reflected and then refracted.
///
/// ```text
/// logit A' = logit A + f(A, g, η)         A': surface albedo of the isotropic, index-matched half space with the same α'
/// α' = α'(A'),   α = α' / (1 − g + g α'),   ℓ* = ℓ / (1 − α g)
/// normalized diffusion          d = ℓ* / (c s(A)),                                    c = c(A, g, η)
/// refined       2πr R/A = c/ℓ* [(1 + b) Σ w_k λ_k e^{−λ_k x} − b κ e^{−κ x}],   x = c r/ℓ*;  c, b, κ likewise
/// ```
///
/// w_k(A) and λ_k(A) are those of [`RefinedDiffusion`](crate::RefinedDiffusion).
/// f, ln c, b and ln κ are polynomials in √A, g and ln of the boundary's transmittance for diffuse light from inside.
/// Without phase function and boundary (g = 0, η = 1) f = b = 0 and c = 1, exactly.
/// Below A = 0.02 and above 0.98 the values there stand in.
/// 1 − α' is off by 0.9 % on average and 9 % at most, ℓ* by 0.1 % and 4 %;
/// `docs/accuracy/similarity.md` has the errors of the profiles, before and after.
///
/// ```
/// use translucid_profile::{Configuration, Parameterization, Similarity};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let plain = Similarity::new(0.5, 0.0, 1.0, Configuration::Diffuse)?;
/// assert_eq!(plain.transport_mfp(2.0, Parameterization::Mfp)?, 2.0);
/// // Forward scattering: light goes farther than a mean free path before it forgets its direction.
/// let skin = Similarity::new(0.5, 0.8, 1.4, Configuration::Diffuse)?;
/// assert!(skin.transport_mfp(2.0, Parameterization::Mfp)? > 8.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    surface_albedo: f64,
    g: f64,
    configuration: Configuration,
    /// e^f.
    odds_ratio: f64,
    stretch_of_normalized_diffusion: f64,
    stretch: f64,
    dimple: f64,
    dimple_rate: f64,
}

impl Similarity {
    /// Mean cosines g of the phase function that the fits are made for.
    pub const G: RangeInclusive<f64> = -0.5..=0.9;
    /// Relative indices η = n_inside/n_outside that the fits are made for.
    pub const ETA: RangeInclusive<f64> = 1.0..=1.5;

    /// Finds the effect of g ∈ [−0.5, 0.9] and η ∈ [1, 1.5] at a surface albedo A ∈ [0, 1].
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(
        surface_albedo: f64,
        g: f64,
        eta: f64,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        require_fraction("surface_albedo", surface_albedo)?;
        Ok(Self::at(surface_albedo, &Monomials::new(g, eta)?, configuration))
    }

    /// Finds the effect on the profile of a medium: its surface albedo A is the one whose A' has the medium's α'.
    ///
    /// # Errors
    /// The medium's g or η is outside its range.
    pub fn of_medium(
        medium: &Medium,
        eta: f64,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        let monomials = Monomials::new(medium.g(), eta)?;
        let similar = medium.surface_albedo(configuration);
        let at = |surface_albedo: f64| Self::at(surface_albedo, &monomials, configuration);
        if is_plain(medium.g(), eta) {
            return Ok(at(similar));
        }
        let excess = |kept: f64| at(1.0 - kept).similar_surface_albedo() - similar;
        let kept = falling_root(excess, [1.0 - similar, -similar], |_| 1e-15);
        Ok(at((1.0 - kept).max(0.0).min(1.0)))
    }

    fn at(surface_albedo: f64, monomials: &Monomials, configuration: Configuration) -> Self {
        let Coefficients { similar_albedo, stretch_of_normalized_diffusion, stretch, dimple, dimple_rate } =
            match configuration {
                Configuration::Searchlight => &SEARCHLIGHT,
                Configuration::Diffuse => &DIFFUSE,
            };
        let root = surface_albedo.max(SURFACE_ALBEDOS[0]).min(SURFACE_ALBEDOS[1]).sqrt();
        let [of_one, of_monomials @ ..] = dimple_rate;
        Self {
            surface_albedo,
            g: monomials.g,
            configuration,
            odds_ratio: libm::exp(monomials.sum(similar_albedo, root)),
            stretch_of_normalized_diffusion: libm::exp(monomials.sum(stretch_of_normalized_diffusion, root)),
            stretch: libm::exp(monomials.sum(stretch, root)),
            dimple: monomials.sum(dimple, root),
            dimple_rate: libm::exp(polynomial(of_one, root) + monomials.sum(of_monomials, root)),
        }
    }

    /// Surface albedo A of the half space, dimensionless.
    pub fn surface_albedo(&self) -> f64 {
        self.surface_albedo
    }

    /// Surface albedo A' ∈ [0, 1] that the similar half space has: isotropic, index-matched, with the same α'.
    pub fn similar_surface_albedo(&self) -> f64 {
        self.surface_albedo * self.odds_ratio / self.odds()
    }

    /// Reduced albedo α' ∈ [0, 1], by way of A'.
    pub fn alpha_prime(&self) -> f64 {
        1.0 - self.absorbed()
    }

    /// Single-scattering albedo α = α'/(1 − g + g α') ∈ [0, 1].
    pub fn single_scattering_albedo(&self) -> f64 {
        let absorbed = self.absorbed();
        (1.0 - absorbed) / (1.0 - self.g * absorbed)
    }

    /// Transport mean free path ℓ* \[L\] of the half space whose mean free path or diffuse mean free path is `length`.
    ///
    /// # Errors
    /// The length is not finite and greater than 0, or the surface albedo is 1 with a diffuse mean free path, which a
    /// medium without absorption does not have.
    pub fn transport_mfp(
        &self,
        length: f64,
        parameterization: Parameterization,
    ) -> Result<f64, ParameterError> {
        require_positive("length", length)?;
        match parameterization {
            // 1/(1 − αg), without cancellation
            Parameterization::Mfp => {
                let absorbed = self.absorbed();
                Ok(length * (1.0 - self.g * absorbed) / (1.0 - self.g))
            }
            Parameterization::Dmfp => {
                let a = self.surface_albedo;
                require(a < 1.0, "surface_albedo", a, "less than 1 with a dmfp")?;
                Ok(length * self.transport_mfp_per_dmfp())
            }
        }
    }

    /// Factor c of the scale in [`NormalizedDiffusion`](crate::NormalizedDiffusion): s(A; g, η) = c s(A), where
    /// d = ℓ*/s; in ℓ_d it is another, as ℓ_d/ℓ* depends on g and η.
    pub fn stretch_of_normalized_diffusion(&self, parameterization: Parameterization) -> f64 {
        let of_mfp = self.stretch_of_normalized_diffusion;
        match parameterization {
            Parameterization::Mfp => of_mfp,
            // c (ℓ_d/ℓ*)(A') / (ℓ_d/ℓ*)(A), without the factors 1 − A that they share
            Parameterization::Dmfp => {
                let per = |a: f64| mfp_per_dmfp_polynomial(a, self.configuration);
                of_mfp * self.odds() * per(self.surface_albedo) / per(self.similar_surface_albedo())
            }
        }
    }

    /// Factor c of the rates in the refined profile.
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Depth b of the refined profile's dimple, a share of the energy: the light that a forward-scattering medium does
    /// not return close by. Negative where it returns more.
    pub fn dimple(&self) -> f64 {
        self.dimple
    }

    /// Rate κ of the dimple, in the unit of the rates λ_k.
    pub fn dimple_rate(&self) -> f64 {
        self.dimple_rate
    }

    /// (1 − A)/(1 − A').
    fn odds(&self) -> f64 {
        1.0 + self.surface_albedo * (self.odds_ratio - 1.0)
    }

    /// ℓ*/ℓ_d = √(3 (1 − α')/(2 − α')), a polynomial of A' times 1 − A'.
    fn transport_mfp_per_dmfp(&self) -> f64 {
        let kept = (1.0 - self.surface_albedo) / self.odds();
        kept * mfp_per_dmfp_polynomial(self.similar_surface_albedo(), self.configuration)
    }

    /// 1 − α', with all its digits.
    fn absorbed(&self) -> f64 {
        let square = self.transport_mfp_per_dmfp().powi(2);
        // At A = 0 the polynomial is off by its rounding
        (square / (3.0 - square)).min(1.0)
    }
}

/// Returns whether there is neither a phase function nor a boundary to account for.
pub(crate) fn is_plain(g: f64, eta: f64) -> bool {
    g == 0.0 && eta == 1.0
}

/// g, g², g³, L, L², gL, g²L, where 1 − e^{−L} is the boundary's reflectance for diffuse light from inside.
struct Monomials {
    g: f64,
    values: [f64; MONOMIALS],
}

impl Monomials {
    fn new(g: f64, eta: f64) -> Result<Self, ParameterError> {
        require(Similarity::G.contains(&g), "g", g, "in [-0.5, 0.9], which this model is fitted for")?;
        require(Similarity::ETA.contains(&eta), "eta", eta, "in [1, 1.5], which this model is fitted for")?;
        let l = -libm::log(1.0 - 2.0 * fresnel_moment_1_from_inside(eta));
        // Exactly 0 where there is no boundary, whatever the quadrature's last digit
        let l = if eta == 1.0 { 0.0 } else { l };
        Ok(Self { g, values: [g, g * g, g * g * g, l, l * l, g * l, g * g * l] })
    }

    /// Σ_m m(g, L) P_m(√A).
    fn sum<const N: usize>(&self, coefficients: &[[f64; N]], root: f64) -> f64 {
        self.values.iter().zip(coefficients).map(|(m, row)| m * polynomial(row, root)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{half_space_single_scattering_albedo, half_space_surface_albedo};

    const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];
    const ALBEDOS: [f64; 9] = [0.0, 1e-9, 0.02, 0.1, 0.4, 0.7, 0.95, 0.9999, 1.0];

    /// All over the domain, in both configurations.
    fn everywhere() -> impl Iterator<Item = (f64, f64, f64, Configuration)> {
        let cosines = (0..=14).map(|i| (-0.5 + 0.1 * f64::from(i)).min(0.9));
        let indices = (0..=5).map(|i| 1.0 + 0.1 * f64::from(i));
        let pairs = cosines.flat_map(move |g| indices.clone().map(move |eta| (g, eta)));
        let cases = pairs.flat_map(|(g, eta)| CONFIGURATIONS.map(|c| (g, eta, c)));
        cases.flat_map(|(g, eta, c)| ALBEDOS.map(|a| (a, g, eta, c)))
    }

    #[test]
    fn similarity_changes_nothing_without_phase_function_and_boundary() {
        for configuration in CONFIGURATIONS {
            for a in ALBEDOS {
                let plain = Similarity::new(a, 0.0, 1.0, configuration).unwrap();
                assert_eq!(plain.similar_surface_albedo(), a);
                assert_eq!((plain.stretch(), plain.dimple()), (1.0, 0.0));
                assert_eq!(plain.transport_mfp(0.7, Parameterization::Mfp), Ok(0.7));
                for parameterization in [Parameterization::Mfp, Parameterization::Dmfp] {
                    assert_eq!(plain.stretch_of_normalized_diffusion(parameterization), 1.0);
                }
            }
        }
    }

    /// α of g = 0, η = 1 is known; the surface albedo that it has tells what the error means.
    #[test]
    fn alpha_prime_is_that_of_the_exact_half_space() {
        for configuration in CONFIGURATIONS {
            for a in ALBEDOS {
                let alpha = Similarity::new(a, 0.0, 1.0, configuration).unwrap().single_scattering_albedo();
                let back = half_space_surface_albedo(alpha, configuration);
                assert!((back - a).abs() < 6e-4 * (1.0 - a) + 1e-13, "{configuration:?} {a}: {back}");
            }
        }
    }

    /// Both factors c stretch the same d: they differ by ℓ_d/ℓ* = √((2 − α')/(3 (1 − α'))) of A' over that of A.
    #[test]
    fn stretch_of_dmfp_is_that_of_mfp_in_the_other_length() {
        let dmfp_per_transport_mfp = |a: f64, configuration| {
            let alpha = half_space_single_scattering_albedo(a, configuration);
            ((2.0 - alpha) / (3.0 * (1.0 - alpha))).sqrt()
        };
        for (a, g, eta, configuration) in everywhere().filter(|case| case.0 > 0.0 && case.0 < 1.0) {
            let it = Similarity::new(a, g, eta, configuration).unwrap();
            let [mfp, dmfp] = [Parameterization::Mfp, Parameterization::Dmfp]
                .map(|parameterization| it.stretch_of_normalized_diffusion(parameterization));
            let [here, similar] =
                [a, it.similar_surface_albedo()].map(|a| dmfp_per_transport_mfp(a, configuration));
            let off = dmfp / mfp / (similar / here) - 1.0;
            assert!(off.abs() < 1.2e-3, "A {a} g {g} eta {eta} {configuration:?}: {off}");
        }
    }

    #[test]
    fn similarity_is_sane_all_over_its_domain() {
        for (a, g, eta, configuration) in everywhere() {
            let it = Similarity::new(a, g, eta, configuration).unwrap();
            let at = || format!("A {a} g {g} eta {eta} {configuration:?}: {it:?}");
            let similar = it.similar_surface_albedo();
            assert!((0.0..=1.0).contains(&similar) && (similar == 0.0) == (a == 0.0), "{}", at());
            let (alpha, reduced) = (it.single_scattering_albedo(), it.alpha_prime());
            assert!((0.0..=1.0).contains(&alpha) && (0.0..=1.0).contains(&reduced), "{}", at());
            let mfp = it.transport_mfp(1.0, Parameterization::Mfp).unwrap();
            assert!((mfp * (1.0 - alpha * g) - 1.0).abs() < 1e-12, "{}", at());
            for c in [it.stretch(), it.stretch_of_normalized_diffusion(Parameterization::Mfp)] {
                assert!(c > 0.2 && c < 5.0, "{}", at());
            }
            assert!(it.dimple() > -0.5 && it.dimple() < 1.5, "{}", at());
            assert!(it.dimple_rate() > 1.0 && it.dimple_rate() < 20.0, "{}", at());
        }
    }

    /// Steps of 1e-7 in g, η and A move nothing by more than a thousand times that.
    #[test]
    fn similarity_is_continuous() {
        let values = |a: f64, g: f64, eta: f64, configuration| {
            let it = Similarity::new(a, g, eta, configuration).unwrap();
            let c = it.stretch_of_normalized_diffusion(Parameterization::Mfp);
            [it.similar_surface_albedo(), it.stretch(), it.dimple(), it.dimple_rate(), c]
        };
        const STEP: f64 = 1e-7;
        for (a, g, eta, configuration) in everywhere() {
            let back = |x: f64, least: f64| if x - STEP >= least { x - STEP } else { x + STEP };
            let here = values(a, g, eta, configuration);
            for there in [
                values(back(a, 0.0), g, eta, configuration),
                values(a, back(g, -0.5), eta, configuration),
                values(a, g, back(eta, 1.0), configuration),
            ] {
                for (x, y) in here.into_iter().zip(there) {
                    assert!((x - y).abs() < 1e3 * STEP, "A {a} g {g} eta {eta}: {here:?} {there:?}");
                }
            }
        }
    }

    /// The more a half space sends back, the more its similar one does.
    #[test]
    fn similar_surface_albedo_rises() {
        for (_, g, eta, configuration) in everywhere().step_by(ALBEDOS.len()) {
            let mut last = -1.0;
            for i in 0..=200 {
                let it = Similarity::new(f64::from(i) / 200.0, g, eta, configuration).unwrap();
                assert!(it.similar_surface_albedo() > last, "{i} {g} {eta}");
                last = it.similar_surface_albedo();
            }
        }
    }

    /// The polynomial for ℓ/ℓ_d is off by a share of 5.5e-4, 1 − α' by up to four times that.
    #[test]
    fn of_medium_inverts_alpha_prime() {
        for (g, eta) in [(0.0, 1.0), (0.9, 1.5), (-0.5, 1.0), (0.3, 1.2)] {
            for (alpha, configuration) in
                [0.0, 0.3, 0.9, 0.9999, 1.0].iter().flat_map(|a| CONFIGURATIONS.map(|c| (*a, c)))
            {
                let medium = Medium::from_mfp(alpha, 1.0, g).unwrap();
                let it = Similarity::of_medium(&medium, eta, configuration).unwrap();
                let (found, expected) = (1.0 - it.alpha_prime(), 1.0 - medium.alpha_prime());
                assert!(
                    (found - expected).abs() < 2.5e-3 * expected + 1e-13,
                    "{alpha} {g} {eta}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn similarity_refuses_what_it_is_not_fitted_for() {
        for (g, eta, parameter) in
            [(0.91, 1.0, "g"), (-0.6, 1.2, "g"), (0.0, 0.99, "eta"), (0.0, 1.51, "eta")]
        {
            let error = Similarity::new(0.5, g, eta, Configuration::Diffuse).unwrap_err();
            assert_eq!(error.parameter, parameter);
        }
        assert!(Similarity::new(0.5, f64::NAN, 1.0, Configuration::Diffuse).is_err());
        assert!(Similarity::new(0.5, 0.0, f64::NAN, Configuration::Diffuse).is_err());
        assert!(Similarity::new(1.1, 0.0, 1.0, Configuration::Diffuse).is_err());
        let white = Similarity::new(1.0, 0.5, 1.4, Configuration::Diffuse).unwrap();
        assert!(white.transport_mfp(1.0, Parameterization::Dmfp).is_err());
        assert!(white.transport_mfp(0.0, Parameterization::Mfp).is_err());
    }
}
