//! The light that a half space reflects where it enters: the limit of every body as its mean free path gets short.
//!
//! Without a boundary and with isotropic scattering it is exact, with Chandrasekhar's H function (see
//! [`HFunction`]):
//!
//! ```text
//! f(μ_o, μ_i) = α/(4π) H(μ_o) H(μ_i) / (μ_o + μ_i)        BRDF
//! A(μ_o) = 1 − H(μ_o) √(1−α)                              of light that is alike from everywhere
//! ```

use std::sync::LazyLock;

use glam::Vec3;
use translucid_profile::HFunction;

/// Steps of each axis of the table; H is exact to 2e-4 between its values.
const STEPS: usize = 64;

/// H by √(1−α), then √μ, in even steps.
static TABLE: LazyLock<Vec<[f32; STEPS + 1]>> = LazyLock::new(|| {
    let squared = |i: usize| (i as f64 / STEPS as f64).powi(2);
    let row = |i: usize| {
        let h = HFunction::new(1.0 - squared(i));
        std::array::from_fn(|j| h.eval(squared(j)) as f32)
    };
    (0..=STEPS).map(row).collect()
});

/// A half space of isotropic scatterers without a boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpace {
    /// Single-scattering albedo α of each channel.
    alpha: Vec3,
    /// √(1−α).
    root: Vec3,
}

/// Light that enters a half space and leaves it in one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpaceReflection {
    half_space: HalfSpace,
    /// Unit normal on the outside.
    normal: Vec3,
    /// Cosine of the direction in which light leaves.
    cosine: f32,
    /// α/4 H(μ_o).
    factor: Vec3,
}

impl HalfSpace {
    /// The half space of single-scattering albedos in [0, 1].
    pub(crate) fn new(alpha: Vec3) -> Self {
        Self { alpha, root: (1.0 - alpha).max(Vec3::ZERO).map(f32::sqrt) }
    }

    /// H of each channel at a cosine in [0, 1].
    fn h(&self, cosine: f32) -> Vec3 {
        let place = |x: f32| {
            let x = x.clamp(0.0, 1.0) * STEPS as f32;
            let i = (x as usize).min(STEPS - 1);
            (i, x - i as f32)
        };
        let (j, along) = place(cosine.max(0.0).sqrt());
        let table = &*TABLE;
        self.root.map(|root| {
            let (i, across) = place(root);
            let of_row = |row: &[f32; STEPS + 1]| row[j] + (row[j + 1] - row[j]) * along;
            let (low, high) = (of_row(&table[i]), of_row(&table[i + 1]));
            low + (high - low) * across
        })
    }

    /// Albedo A(μ_o) of each channel, seen at a cosine under light that is alike from everywhere.
    pub(crate) fn albedo(&self, cosine: f32) -> Vec3 {
        1.0 - self.root * self.h(cosine)
    }

    /// Reflection in a direction at a cosine to a normal.
    pub(crate) fn reflection(self, normal: Vec3, cosine: f32) -> HalfSpaceReflection {
        HalfSpaceReflection { half_space: self, normal, cosine, factor: 0.25 * self.alpha * self.h(cosine) }
    }
}

impl HalfSpaceReflection {
    /// π f for light from a unit direction.
    pub(crate) fn weight(&self, toward_light: Vec3) -> Vec3 {
        let cosine = toward_light.dot(self.normal).max(f32::MIN_POSITIVE);
        self.factor * self.half_space.h(cosine) / (self.cosine + cosine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALPHAS: [f32; 5] = [0.05, 0.6, 0.93, 0.998, 1.0];

    #[test]
    fn table_is_the_h_function() {
        for alpha in ALPHAS {
            let exact = HFunction::new(f64::from(alpha));
            for cosine in [0.0, 1e-3, 0.013, 0.1, 0.37, 0.9, 1.0] {
                let found = HalfSpace::new(Vec3::splat(alpha)).h(cosine).x;
                let off = f64::from(found) / exact.eval(f64::from(cosine)) - 1.0;
                assert!(off.abs() < 2e-4, "{alpha} {cosine}: {off:e}");
            }
        }
    }

    /// Under light from everywhere the BRDF reflects the albedo.
    #[test]
    fn reflection_integrates_to_albedo() {
        for alpha in ALPHAS {
            let half_space = HalfSpace::new(Vec3::splat(alpha));
            for cosine in [0.05, 0.4, 1.0] {
                let reflection = half_space.reflection(Vec3::Z, cosine);
                let steps = 4000;
                let weight = |i: u16| {
                    let mu = (f32::from(i) + 0.5) / f32::from(steps);
                    reflection.weight(Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu)).x * 2.0 * mu
                        / f32::from(steps)
                };
                let (found, expected) = ((0..steps).map(weight).sum::<f32>(), half_space.albedo(cosine).x);
                assert!((found - expected).abs() < 5e-4, "{alpha} {cosine}: {found} {expected}");
            }
        }
    }
}
