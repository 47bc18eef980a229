//! Random walks of Blender Cycles: the medium that they make of a color, and the light that comes back from it.
//!
//! The single-scattering albedo α of a channel with the color c and the mean cosine g is, in *Random Walk* of Blender 5.2, the
//! one by which C. Kulla and A. Conty invert van de Hulst's approximation ([`super::multiscatter`]), and in *Random Walk (Legacy)*, the *Random Walk* of Blender 3.0 to 5.1, and in *Random Walk (Skin)* the fit of
//! M. Wrenninge, R. Villemin and C. Hery, *Path Traced Subsurface Scattering using Anisotropic Phase Functions and
//! Non-Exponential Free Flights*, 2017:
//!
//! ```text
//! α = (1 − c^¼) A atan(B c)^C + c^¼ D atan(E c)^F,     A … F functions of g
//! ```
//!
//! Both are at most 0.999999. In place of an α below 0.2 Cycles walks with 0.2, and takes the share α/0.2 of the light.
//! Every walk ends after 256 flights. Seen under light from all sides, and in the mean over all
//! views, a half space of that medium returns
//!
//! ```text
//! A(α, g) − ∫ (2/√(3π)) n^{−3/2} e^{−n(1−α')} dn   from n = 256 on,    α' = α (1 − g)/(1 − αg)
//! ```
//!
//! where the integral is the light still inside after n flights, as in the limit of many.
//! Measured in Blender 5.0.1, in the mean over all views: 0.197, 0.498, 0.807, 0.903 and 0.917 for colors of 0.2, 0.5, 0.8, 0.9
//! and 0.95 by the older fit.

use std::f64::consts::PI;

use super::multiscatter;
use crate::math::scaled_erfc::erfcx;
use crate::{AlbedoInversion, Configuration, half_space_surface_albedo};

/// Largest single-scattering albedo.
const LARGEST_ALPHA: f64 = 0.999999;

/// Least single-scattering albedo that Cycles walks with.
const LEAST_ALPHA: f64 = 0.2;

/// Steps of a bisection.
const STEPS: u32 = 60;

/// The random walks of Blender Cycles in media of a mean cosine g.
#[derive(Clone, Debug)]
pub struct CyclesWalk {
    g: f64,
    /// The surface albedos of media with g ≠ 0.
    inversion: Option<AlbedoInversion>,
    fit: AlbedoFit,
}

/// The single-scattering albedo of a color.
#[derive(Clone, Debug)]
enum AlbedoFit {
    /// The inverse of van de Hulst's approximation by Kulla and Conty.
    VanDeHulst,
    /// The fit of Wrenninge and others, with its coefficients A, B, C, D, E, F.
    Wrenninge([f64; 6]),
}

impl CyclesWalk {
    /// *Random Walk* of Blender 5.2 in media of a mean cosine g, which is clamped to [−0.9, 0.9].
    pub fn new(g: f64) -> Self {
        Self::with_fit(g.max(-0.9).min(0.9), |_| AlbedoFit::VanDeHulst)
    }

    /// *Random Walk (Legacy)*, which is *Random Walk* before Blender 5.2, and the walk of *Random Walk (Skin)*; Cycles clamps
    /// the mean cosine g to [0, 0.9].
    pub fn legacy(g: f64) -> Self {
        Self::with_fit(g.max(0.0).min(0.9), |g| AlbedoFit::Wrenninge(wrenninge(g)))
    }

    fn with_fit(g: f64, fit: impl Fn(f64) -> AlbedoFit) -> Self {
        let inversion = (g != 0.0).then(|| AlbedoInversion::new(g, 1.0, Configuration::Diffuse).ok());
        Self { g, inversion: inversion.flatten(), fit: fit(g) }
    }

    /// Flights after which a walk ends.
    pub const MOST_FLIGHTS: f64 = 256.0;

    /// Mean cosine g of the phase function.
    pub fn g(&self) -> f64 {
        self.g
    }

    /// Single-scattering albedo α of a color, which is clamped to [0, 1].
    pub fn single_scattering_albedo(&self, color: f64) -> f64 {
        let color = color.max(0.0).min(1.0);
        let alpha = match self.fit {
            AlbedoFit::VanDeHulst => multiscatter::single_scattering_albedo(color, self.g),
            AlbedoFit::Wrenninge([a, b, c, d, e, f]) => {
                let blend = color.sqrt().sqrt();
                (1.0 - blend) * a * libm::pow(libm::atan(b * color), c)
                    + blend * d * libm::pow(libm::atan(e * color), f)
            }
        };
        alpha.max(0.0).min(LARGEST_ALPHA)
    }

    /// Mean free path 1/σ_t for a length that Cycles takes for it, and before 5.2 for 1/((1 − g) σ_t).
    pub(super) fn mfp(&self, length: f64) -> f64 {
        match self.fit {
            AlbedoFit::VanDeHulst => length,
            AlbedoFit::Wrenninge(_) => (1.0 - self.g) * length,
        }
    }

    /// Transport mean free path 1/(σ_a + (1 − g) σ_s) for the length that [`mfp`](Self::mfp) takes.
    pub(super) fn transport_mfp(&self, color: f64, length: f64) -> f64 {
        self.mfp(length) / (1.0 - self.g * self.single_scattering_albedo(color).max(LEAST_ALPHA))
    }

    /// Surface albedo that a color comes out as, under light from all sides and in the mean over all views.
    pub fn surface_albedo(&self, color: f64) -> f64 {
        let alpha = self.single_scattering_albedo(color);
        let absorbed = (1.0 - alpha) / (1.0 - alpha * self.g);
        (self.surface_albedo_of_medium(color) - still_inside(absorbed)).max(0.0)
    }

    /// The color that comes out as a surface albedo; the nearest one beyond [`brightest`](Self::brightest).
    pub fn color(&self, surface_albedo: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if self.surface_albedo(middle) < surface_albedo {
                low = middle;
            } else {
                high = middle;
            }
        }
        if high == 1.0 { self.color(self.brightest() * (1.0 - 1e-9)) } else { high }
    }

    /// The greatest surface albedo.
    pub fn brightest(&self) -> f64 {
        self.surface_albedo(1.0)
    }

    /// Surface albedo of the medium of a color, as walks that never end would have it.
    pub fn surface_albedo_of_medium(&self, color: f64) -> f64 {
        let alpha = self.single_scattering_albedo(color);
        let share = (alpha / LEAST_ALPHA).min(1.0);
        share * self.surface_albedo_of_alpha(alpha.max(LEAST_ALPHA))
    }

    fn surface_albedo_of_alpha(&self, alpha: f64) -> f64 {
        let Some(inversion) = &self.inversion else {
            return half_space_surface_albedo(alpha, Configuration::Diffuse);
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if inversion.single_scattering_albedo(middle) < alpha {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Share of the light that is still in a half space after the last flight, of what absorption leaves: 1 − α' = s.
fn still_inside(s: f64) -> f64 {
    let x = (CyclesWalk::MOST_FLIGHTS * s).sqrt();
    let whole = 2.0 / (3.0 * PI).sqrt() * 2.0 / CyclesWalk::MOST_FLIGHTS.sqrt();
    whole * libm::exp(-x * x) * (1.0 - PI.sqrt() * x * erfcx(x))
}

/// Coefficients of the fit of Wrenninge and others at a mean cosine.
#[rustfmt::skip]
fn wrenninge(g: f64) -> [f64; 6] {
    let polynomial = |c: [f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * g + c);
    let exponential = |c| libm::exp(polynomial(c));
    [
        polynomial([1.8260523782, -1.28451056436, -1.79904629312, 9.19393289202,
            -22.8215585862, 32.0234874259, -23.6264803333, 7.21067002658]),
        4.98511194385 + 0.127355959438 * exponential([0.0, 31.1491581433, -201.847017512, 841.576016723,
            -2018.09288505, 2731.71560286, -1935.41424244, 559.009054474]),
        polynomial([1.09686102424, -0.394704063468, 1.05258115941, -8.83963712726,
            28.8643230661, -46.8802913581, 38.5402837518, -12.7181042538]),
        polynomial([0.496310210422, 0.360146581622, -2.15139309747, 17.8896899217,
            -55.2984010333, 82.065982243, -58.5106008578, 15.8478295021]),
        4.23190299701 + 0.00310603949088 * exponential([0.0, 76.7316253952, -594.356773233, 2448.8834203,
            -5576.68528998, 7116.60171912, -4763.54467887, 1303.5318055]),
        polynomial([2.40602999408, -2.51814844609, 9.18494908356, -79.2191708682,
            259.082868209, -403.613804597, 302.85712436, -87.4370473567]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean over all views that Blender 5.0.1 was measured at, good to some 0.01.
    #[test]
    fn surface_albedo_is_that_of_blender() {
        let isotropic = CyclesWalk::legacy(0.0);
        for (color, measured) in [(0.2, 0.197), (0.5, 0.498), (0.8, 0.807), (0.9, 0.903), (0.95, 0.917)] {
            let found = isotropic.surface_albedo(color);
            assert!((found - measured).abs() < 0.008, "{color}: {found}");
        }
        let forward = CyclesWalk::legacy(0.6);
        for (color, measured) in [(0.2, 0.193), (0.5, 0.488), (0.8, 0.794)] {
            let found = forward.surface_albedo(color);
            assert!((found - measured).abs() < 0.008, "{color}, g = 0.6: {found}");
        }
    }

    #[test]
    fn color_inverts_the_surface_albedo_as_far_as_it_goes() {
        for walk in [-0.6, 0.0, 0.3, 0.9].map(|g| [CyclesWalk::new(g), CyclesWalk::legacy(g)]).as_flattened()
        {
            let g = walk.g();
            for a in [0.01, 0.2, 0.5, 0.8, 0.9] {
                let found = walk.surface_albedo(walk.color(a));
                assert!((found - a).abs() < 1e-5, "{g} {a}: {found}");
            }
            let white = walk.color(1.0);
            assert!(
                (walk.surface_albedo(white) - walk.brightest()).abs() < 1e-6 && white < 1.0,
                "{g}: {white}"
            );
            assert!((0.9..0.93).contains(&walk.brightest()), "{g}: {}", walk.brightest());
        }
    }

    /// Isotropic walks of at most 256 flights, counted one by one.
    #[test]
    fn light_still_inside_is_that_of_walks() {
        let mut random = translucid_testing::SplitMix(5);
        let walks = 40_000;
        let inside = (0..walks)
            .filter(|_| {
                let mut uniform = || random.uniform();
                let mut cosine = uniform().sqrt();
                let mut depth = 0.0;
                (0..256).all(|_| {
                    depth -= (1.0 - uniform()).ln() * cosine;
                    cosine = 2.0 * uniform() - 1.0;
                    depth > 0.0
                })
            })
            .count();
        // Four standard deviations are 0.0055
        let share = inside as f64 / f64::from(walks);
        assert!((share - still_inside(0.0)).abs() < 0.0065, "{share} {}", still_inside(0.0));
    }
}
