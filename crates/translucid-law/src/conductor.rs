//! Fresnel reflectance of a metal given by two colors.

use glam::Vec3;

/// Schlick's approximation with a tint at 82°:
///
/// ```text
/// F(μ) = F₀ + (1 − F₀)(1 − μ)⁵ − a μ (1 − μ)⁶,    a such that F(1/7) = tint · F_Schlick(1/7)
/// ```
///
/// [Kutz, Hašan & Edmondson 2021, "Novel aspects of the Adobe Standard Material", Sec. 2.3].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetalFresnel {
    /// F₀.
    pub f0: Vec3,
    /// a.
    pub a: Vec3,
}

impl MetalFresnel {
    /// Reflectance `f0` at normal incidence and tint at 82°, both in [0, 1]; tint 1 is Schlick's curve.
    #[inline]
    pub fn new(f0: Vec3, tint: Vec3) -> Self {
        let mu = 1.0 / 7.0;
        let m = 1.0 - mu;
        let m5 = m * m * m * m * m;
        let schlick = f0 + (Vec3::ONE - f0) * m5;
        Self { f0, a: schlick * (Vec3::ONE - tint) / (mu * (m5 * m)) }
    }

    /// Reflectance at the cosine `mu` in [0, 1].
    #[inline]
    pub fn reflectance(&self, mu: f32) -> Vec3 {
        let m = (1.0 - mu).clamp(0.0, 1.0);
        let m2 = m * m;
        let m5 = m2 * m2 * m;
        (self.f0 + (Vec3::ONE - self.f0) * m5 - self.a * ((1.0 - m) * m5 * m)).max(Vec3::ZERO)
    }

    /// Cosine-weighted mean 2 ∫ F(μ) μ dμ = F₀ + (1 − F₀)/21 − a/126, or 0 where that is negative: [`Self::reflectance`]
    /// clips the dip of dark metals with a dark tint.
    #[inline]
    pub fn average(&self) -> Vec3 {
        (self.f0 + (Vec3::ONE - self.f0) / 21.0 - self.a / 126.0).max(Vec3::ZERO)
    }

    /// Reflectance of the light that leaves after several reflections between facets, when
    /// `facet_albedo` of it leaves at each [Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks"].
    #[inline]
    pub fn multiple_scattering(&self, facet_albedo: f32) -> Vec3 {
        let f = self.average();
        f * f * facet_albedo / (Vec3::ONE - f * (1.0 - facet_albedo))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metal_meets_its_colors() {
        let f0 = Vec3::new(1.0, 0.7, 0.2);
        let tint = Vec3::new(0.9, 0.5, 1.0);
        let metal = MetalFresnel::new(f0, tint);
        assert!((metal.reflectance(1.0) - f0).length() < 1e-6);
        let plain = MetalFresnel::new(f0, Vec3::ONE).reflectance(1.0 / 7.0);
        assert!((metal.reflectance(1.0 / 7.0) - plain * tint).length() < 1e-5);
        assert!((metal.reflectance(0.0) - Vec3::ONE).length() < 1e-6);
    }

    #[test]
    fn metal_average_integrates_reflectance() {
        let metal = MetalFresnel::new(Vec3::new(0.9, 0.6, 0.1), Vec3::new(1.0, 0.7, 0.9));
        let n = 20_000;
        let sum: Vec3 = (0..n)
            .map(|i| {
                let mu = (i as f32 + 0.5) / n as f32;
                metal.reflectance(mu) * (2.0 * mu / n as f32)
            })
            .sum();
        assert!((sum - metal.average()).abs().max_element() < 1e-4, "{sum} {}", metal.average());
    }

    #[test]
    fn metal_white_loses_nothing_between_facets() {
        let white = MetalFresnel::new(Vec3::ONE, Vec3::ONE);
        assert!((white.multiple_scattering(0.6) - Vec3::ONE).length() < 1e-6);
    }
}
