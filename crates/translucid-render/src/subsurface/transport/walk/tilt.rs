//! Directions of flights, leaning toward where the light of a body comes from.
//!
//! Most light that leaves a body has entered nearby. So the light inside gets dimmer with the distance from the exit's
//! surface, like e^{−κz}, and walks that turn back to it are worth more. Far below an even surface the light that they look
//! for is proportional to 1/(1 − κμ/σ_t), where μ is the cosine to the normal and κ/σ_t ≈ √(3(1 − α)) [Křivánek & d'Eon 2014,
//! "A Zero-variance-based Sampling Scheme for Monte Carlo Subsurface Scattering"]. The first terms of that series are
//! enough here, and their weights stay small:
//!
//! ```text
//! p(ω) = (1 + t·ω) / 4π,    t = β √(1 − α) n
//! ```

use std::f32::consts::TAU;

use glam::Vec3;

use crate::sampling::Frame;

/// A vector t, shorter than 1, of isotropic scattering's directions drawn with the density (1 + t·ω)/4π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tilt(Vec3);

impl Tilt {
    /// No tilt.
    pub(super) const NONE: Self = Self(Vec3::ZERO);

    /// A tilt toward the surface with an outward normal, of strength β (√3 in the series), in a medium with the mean
    /// single-scattering albedo `alpha`.
    pub(super) fn toward(normal: Vec3, strength: f32, alpha: f32) -> Self {
        Self(normal * (strength * (1.0 - alpha.clamp(0.0, 1.0)).sqrt()))
    }

    /// Density of the direction of a vector over that of isotropic scattering, by the vector's reciprocal length.
    #[inline(always)]
    pub(super) fn factor(self, [x, y, z]: [f32; 3], per_length: f32) -> f32 {
        1.0 + (self.0.x * x + self.0.y * y + self.0.z * z) * per_length
    }

    /// A direction, for two numbers uniform in [0, 1).
    pub(super) fn sample(self, u: [f32; 2]) -> Vec3 {
        let t = self.0.length();
        // (1 + cosine) (1 + t cosine / 2 − t / 2) = 2 u without the cancellation of a small t
        let below = 2.0 * u[0];
        let cosine = 2.0 * below / (1.0 - t + ((1.0 - t) * (1.0 - t) + 2.0 * t * below).sqrt()) - 1.0;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (sin, cos) = libm::sincosf(TAU * u[1]);
        let axis = self.0.try_normalize().unwrap_or(Vec3::Z);
        Frame::from_normal(axis).to_world(Vec3::new(sine * cos, sine * sin, cosine)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over a grid of numbers the mean direction is t/3, and 1 over the factor, the weight of a direction, has the
    /// mean 1.
    #[test]
    fn directions_are_tilted() {
        let normal = Vec3::new(0.48, -0.6, 0.64);
        for tilt in [
            Tilt::NONE,
            Tilt::toward(normal, 0.8, 1.0),
            Tilt::toward(normal, 0.8, 0.9),
            Tilt::toward(normal, 0.8, 0.0),
        ] {
            let n = 400_u16;
            let number = |i: u16| (f32::from(i) + 0.5) / f32::from(n);
            let (mut mean, mut counted) = (glam::DVec3::ZERO, 0.0);
            for i in 0..n {
                for j in 0..n {
                    let direction = tilt.sample([number(i), number(j)]);
                    assert!((direction.length() - 1.0).abs() < 1e-6);
                    mean += direction.as_dvec3();
                    counted += f64::from(tilt.factor(direction.to_array(), 1.0)).recip();
                }
            }
            let count = f64::from(n) * f64::from(n);
            assert!((mean / count - tilt.0.as_dvec3() / 3.0).length() < 1e-4, "{tilt:?}: {}", mean / count);
            assert!((counted / count - 1.0).abs() < 1e-4, "{tilt:?}: {}", counted / count);
        }
    }

    #[test]
    fn extremes_are_directions() {
        for alpha in [0.0, 1.0, 2.0, -1.0] {
            for u in [0.0, 1e-30, 0.5, 1.0 - f32::EPSILON / 2.0] {
                let tilt = Tilt::toward(Vec3::NEG_Z, 0.8, alpha);
                let direction = tilt.sample([u, u]);
                assert!(
                    direction.is_normalized() && tilt.factor(direction.to_array(), 1.0) > 0.1,
                    "{alpha} {u}"
                );
            }
        }
    }
}
