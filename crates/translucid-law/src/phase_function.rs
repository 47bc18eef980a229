//! The phase function of L. G. Henyey and J. L. Greenstein, *Diffuse radiation in the galaxy*, 1941.

use std::f32::consts::PI;

use glam::Vec3;

use crate::elementary::circle;
use crate::frame::Frame;

/// |g| below which directions are drawn evenly: the quotient of the closed form would be rounding noise.
const ISOTROPIC: f32 = 1e-3;

/// Scattering with the mean cosine g ∈ (−1, 1).
#[derive(Clone, Copy, Debug)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// Scattering with this mean cosine.
    #[inline]
    pub fn new(g: f32) -> Self {
        Self { g: if g.abs() < ISOTROPIC { 0.0 } else { g } }
    }

    /// Returns `true` if all directions are alike.
    #[inline]
    pub fn is_isotropic(self) -> bool {
        self.g == 0.0
    }

    /// Density \[1/sr\] of turning by an angle of this cosine; it is the phase function, too.
    #[inline]
    pub fn pdf(self, cosine: f32) -> f32 {
        let g = self.g;
        if g == 0.0 {
            return 0.25 / PI;
        }
        let squared = (1.0 + g * g - 2.0 * g * cosine).max(f32::MIN_POSITIVE);
        0.25 / PI * (1.0 - g * g) / (squared * squared.sqrt())
    }

    /// A direction after scattering, for a unit direction before and two numbers uniform in [0, 1).
    #[inline]
    pub fn sample(self, direction: Vec3, u: [f32; 2]) -> Vec3 {
        let g = self.g;
        let around = circle(u[1]);
        let mut cosine = 1.0 - 2.0 * u[0];
        if g != 0.0 {
            let root = (1.0 - g * g) / (1.0 + g - 2.0 * g * u[0]);
            cosine = ((1.0 + g * g - root * root) / (2.0 * g)).clamp(-1.0, 1.0);
        }
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let turned = Vec3::new(sine * around.x, sine * around.y, cosine);
        if g == 0.0 {
            return turned;
        }
        Frame::from_normal(direction).to_world(turned).normalize()
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;

    /// Even steps of the random number give each ring of directions its share of the density's integral.
    #[test]
    fn sample_follows_pdf() {
        for g in [-0.9, -0.3, 0.0, 0.5, 0.95] {
            let phase = HenyeyGreenstein::new(g);
            let n = 20_000_u16;
            let (mut counts, mut mean) = ([0_u32; 20], 0.0);
            for i in 0..n {
                let u = [(f32::from(i) + 0.5) / f32::from(n), f32::from(i) * 0.618_034 % 1.0];
                let turned = phase.sample(Vec3::new(0.6, 0.0, -0.8), u);
                let cosine = turned.dot(Vec3::new(0.6, 0.0, -0.8));
                mean += cosine / f32::from(n);
                counts[(((cosine + 1.0) * 10.0) as usize).min(19)] += 1;
            }
            assert!((mean - g).abs() < 2e-3, "{g}: {mean}");
            for (ring, count) in counts.into_iter().enumerate() {
                let steps = 400;
                let cosine = |i: usize| -1.0 + 0.1 * (ring as f32 + (i as f32 + 0.5) / steps as f32);
                let expected: f32 = (0..steps).map(|i| TAU * phase.pdf(cosine(i)) * 0.1 / steps as f32).sum();
                let found = count as f32 / f32::from(n);
                assert!(
                    (found - expected).abs() < 1e-3 + 2e-3 * expected,
                    "{g}, ring {ring}: {found} {expected}"
                );
            }
        }
    }
}
