//! The medium behind a surface albedo: what a walk through the volume needs.

use std::ops::RangeInclusive;

use crate::error::{ParameterError, require};
use crate::math::monotone_cubic::MonotoneCubic;
use crate::medium::discrete_ordinates::DiscreteOrdinates;
use crate::medium::media::transport_mfp_over_dmfp;
use crate::medium::similarity::is_plain;
use crate::{Configuration, Parameterization, half_space_surface_albedo};

/// Media that are tabulated.
const POINTS: usize = 64;
/// Surface albedo whose mean free path stands in above it where the diffuse one is stated: at 1 there is none.
const BRIGHTEST_WITH_DMFP: f64 = 0.9999;

/// The medium of a half space for every surface albedo A, for a mean cosine g of the phase function of Henyey and
/// Greenstein and a smooth boundary of the relative index η.
///
/// A is the share of the light that *entered* which leaves again; what enters does so as the [`Configuration`] says
/// outside the boundary, less what is reflected there, as everywhere in this crate.
/// For g = 0 and η = 1 the relation is the exact one ([`half_space_surface_albedo`]), otherwise that of twenty
/// directions in each hemisphere, forty with a boundary. More of them change A by less than 2e-5 for |g| ≤ 0.9 and η ≤ 1.4;
/// for the pencil under a boundary on strongly backward scattering by 3e-4 (3e-3 at g = −0.95).
/// It is tabulated: the medium found has the surface albedo A to 2e-5 for η ≤ 1.5, and to 2e-4 for η = 3.
///
/// ```
/// use translucid_profile::{AlbedoInversion, Configuration, half_space_single_scattering_albedo};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let plain = AlbedoInversion::new(0.0, 1.0, Configuration::Diffuse)?;
/// let exact = half_space_single_scattering_albedo(0.5, Configuration::Diffuse);
/// assert!((plain.single_scattering_albedo(0.5) - exact).abs() < 2e-5);
/// // Of a medium that scatters forward less comes back
/// let skin = AlbedoInversion::new(0.8, 1.4, Configuration::Diffuse)?;
/// assert!(skin.single_scattering_albedo(0.5) > 0.99);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AlbedoInversion {
    g: f64,
    /// √(1 − α') over 1 − A, in which it is nearly straight.
    root: MonotoneCubic,
}

impl AlbedoInversion {
    /// Mean cosines g that the relation is accurate for.
    pub const G: RangeInclusive<f64> = -0.95..=0.95;
    /// Relative indices η = n_inside/n_outside that it is made for.
    pub const ETA: RangeInclusive<f64> = 1.0..=3.0;

    /// Tabulates the media of g ∈ [−0.95, 0.95] and η ∈ [1, 3]; takes some 0.1 s unless g = 0 and η = 1.
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(g: f64, eta: f64, configuration: Configuration) -> Result<Self, ParameterError> {
        require(Self::G.contains(&g), "g", g, "in [-0.95, 0.95]")?;
        require(Self::ETA.contains(&eta), "eta", eta, "in [1, 3]")?;
        let ordinates = DiscreteOrdinates::new(g, eta, configuration);
        let surface_albedo = |absorbed: f64| {
            if is_plain(g, eta) {
                half_space_surface_albedo(1.0 - absorbed, configuration)
            } else {
                ordinates.surface_albedo(absorbed)
            }
        };
        // Dense near white, where a boundary makes A fall steeply, and near black, where the curve's end is straight
        let place = |i: usize| i as f64 / (POINTS - 1) as f64;
        let roots: Vec<f64> = (0..POINTS).map(|i| place(i).powi(2) * (3.0 - 2.0 * place(i))).collect();
        let kept: Vec<f64> = roots.iter().map(|root| 1.0 - surface_albedo(root * root)).collect();
        Ok(Self { g, root: MonotoneCubic::new(&kept, &roots) })
    }

    /// Mean cosine g of the phase function.
    pub fn g(&self) -> f64 {
        self.g
    }

    /// Single-scattering albedo α ∈ [0, 1] of the half space with surface albedo A; A is clamped to [0, 1], NaN counts
    /// as 0.
    pub fn single_scattering_albedo(&self, surface_albedo: f64) -> f64 {
        let absorbed = self.absorbed(surface_albedo);
        (1.0 - absorbed) / (1.0 - self.g * absorbed)
    }

    /// Mean free path ℓ = 1/σ_t \[L\] of the half space with surface albedo A whose mean free path or diffuse mean free
    /// path is `length` \[L\].
    ///
    /// A diffuse mean free path is that of the similar isotropic medium with Grosjean's diffusion coefficient, as
    /// everywhere in this crate; above A = 0.9999 that albedo's ratio stands in, as a medium without absorption has none.
    pub fn mfp(&self, surface_albedo: f64, length: f64, parameterization: Parameterization) -> f64 {
        match parameterization {
            Parameterization::Mfp => length,
            Parameterization::Dmfp => {
                let absorbed = self.absorbed(surface_albedo.min(BRIGHTEST_WITH_DMFP));
                let transport_mfp = length * transport_mfp_over_dmfp(absorbed);
                transport_mfp * (1.0 - self.g) / (1.0 - self.g * absorbed)
            }
        }
    }

    /// 1 − α'.
    fn absorbed(&self, surface_albedo: f64) -> f64 {
        let kept = 1.0 - surface_albedo.max(0.0).min(1.0);
        self.root.eval(kept).powi(2).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use translucid_testing::is_thorough;

    use super::*;
    use crate::{Medium, half_space_single_scattering_albedo};

    const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];

    #[test]
    fn medium_found_has_the_surface_albedo() {
        for (g, eta) in [(0.0, 1.0), (0.0, 1.4), (-0.5, 1.0), (0.8, 1.0), (0.9, 1.5), (0.95, 3.0)] {
            let allowed = if eta > 1.5 { 2e-4 } else { 2e-5 };
            for configuration in CONFIGURATIONS {
                let inversion = AlbedoInversion::new(g, eta, configuration).unwrap();
                let ordinates = DiscreteOrdinates::new(g, eta, configuration);
                for a in [0.0, 1e-3, 0.02, 0.05, 0.31, 0.5, 0.77, 0.95, 0.99, 0.999, 1.0] {
                    let back = ordinates.surface_albedo(inversion.absorbed(a));
                    assert!((back - a).abs() < allowed, "g {g} eta {eta} {configuration:?} A {a}: {back}");
                }
            }
        }
    }

    /// Error of A for want of directions: with twice as many or more the error is a fiftieth.
    ///
    /// Light thrown straight back by a pencil under a boundary is the hardest: strongly backward scattering is 3e-4 off.
    #[test]
    fn surface_albedo_hardly_changes_with_more_directions() {
        let cosines: &[f64] = if is_thorough() { &[-0.9, -0.5, 0.0, 0.5, 0.9] } else { &[-0.9, 0.5] };
        for (g, eta) in cosines.iter().flat_map(|&g| [(g, 1.0), (g, 1.4)]) {
            let directions = if eta == 1.0 { 64 } else { 40 };
            for configuration in CONFIGURATIONS {
                let backward_pencil = g < -0.5 && eta > 1.0 && configuration == Configuration::Searchlight;
                let allowed = if backward_pencil { 4e-4 } else { 2e-5 };
                let inversion = AlbedoInversion::new(g, eta, configuration).unwrap();
                let used = DiscreteOrdinates::new(g, eta, configuration);
                let finer = DiscreteOrdinates::with_directions(g, eta, configuration, directions);
                for a in [0.5, 0.9, 0.99] {
                    let absorbed = inversion.absorbed(a);
                    let change = finer.surface_albedo(absorbed) - used.surface_albedo(absorbed);
                    assert!(change.abs() < allowed, "g {g} eta {eta} {configuration:?} A {a}: {change:e}");
                }
            }
        }
    }

    #[test]
    fn lengths_and_albedos_are_those_of_the_medium() {
        let configuration = Configuration::Diffuse;
        let plain = AlbedoInversion::new(0.0, 1.0, configuration).unwrap();
        for a in [0.05, 0.5, 0.95] {
            let alpha = half_space_single_scattering_albedo(a, configuration);
            assert!((plain.single_scattering_albedo(a) - alpha).abs() < 1e-4, "{a}");
        }
        let inversion = AlbedoInversion::new(0.7, 1.3, configuration).unwrap();
        for a in [0.0, 0.3, 0.9] {
            let (alpha, mfp) = (inversion.single_scattering_albedo(a), |p| inversion.mfp(a, 2.5, p));
            assert_eq!(mfp(Parameterization::Mfp), 2.5);
            let medium = Medium::from_mfp(alpha, mfp(Parameterization::Dmfp), 0.7).unwrap();
            assert!((medium.dmfp() / 2.5 - 1.0).abs() < 1e-9, "{a}: {}", medium.dmfp());
        }
        assert_eq!(
            [inversion.single_scattering_albedo(f64::NAN), inversion.single_scattering_albedo(7.0)],
            [0.0, 1.0]
        );
        assert!(inversion.mfp(1.0, 1.0, Parameterization::Dmfp) > 0.0);
    }

    #[test]
    fn inversion_refuses_what_it_is_not_made_for() {
        for (g, eta, parameter) in
            [(0.96, 1.0, "g"), (-1.0, 1.0, "g"), (0.0, 0.9, "eta"), (0.0, f64::NAN, "eta")]
        {
            let error = AlbedoInversion::new(g, eta, Configuration::Diffuse).unwrap_err();
            assert_eq!(error.parameter, parameter);
        }
    }
}
