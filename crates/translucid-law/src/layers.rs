//! The layers over the base of a material: coat and dielectric interface, and the light they let through.

use crate::ggx::Ggx;
use crate::reflectances::{GLASS_LEVELS, linear};

/// Albedos of the interfaces of a material with two indices of refraction.
pub trait Tables {
    /// Index of refraction of the base.
    fn specular_ior(&self) -> f32;
    /// Index of refraction of the coat.
    fn coat_ior(&self) -> f32;
    /// Directional albedo of the base's dielectric interface from outside.
    fn specular_albedo(&self, mu: f32, roughness: f32) -> f32;
    /// Cosine mean of that.
    fn average_specular_albedo(&self, roughness: f32) -> f32;
    /// Directional albedo of the coat from outside.
    fn coat_albedo(&self, mu: f32, roughness: f32) -> f32;
    /// Cosine mean of that.
    fn average_coat_albedo(&self, roughness: f32) -> f32;
    /// Share of light that single scattering by the facets of a lossless metal loses; 0 for a mirror.
    fn metal_deficit(&self, mu: f32, roughness: f32) -> f32;
    /// Cosine mean of that.
    fn average_metal_deficit(&self, roughness: f32) -> f32;
    /// X of the dielectric's reflection: what it loses to a coat beyond the coat's loss in the direction seen.
    fn dielectric_loss(&self, mu: f32, roughness: f32, coat_roughness: f32) -> f32;
    /// 2 ∫ (E_c E + X) μ dμ for the dielectric's reflection of albedo E.
    fn average_dielectric_loss(&self, roughness: f32, coat_roughness: f32) -> f32;
    /// X of a white metal.
    fn metal_loss(&self, mu: f32, roughness: f32, coat_roughness: f32) -> f32;
    /// 2 ∫ (X − E_c (1 − E)) μ dμ for a white metal of albedo E.
    fn average_metal_loss(&self, roughness: f32, coat_roughness: f32) -> f32;
    /// Share of light that single scattering by the facets of lossless rough glass keeps, whose F₀ is scaled by 4⁻ᵏ.
    fn glass_level(&self, level: u32, is_inside: bool, mu: f32, roughness: f32) -> f32;
}

/// The interfaces of one surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Factor on the dielectric's reflectance.
    pub specular_weight: f32,
    /// Perceptual roughness of the dielectric.
    pub specular_roughness: f32,
    /// Strength of the coat; 0 where there is none.
    pub coat_weight: f32,
    /// Perceptual roughness of the coat.
    pub coat_roughness: f32,
}

impl Layers {
    /// Directional albedo of the coat.
    pub fn coat_reflectance(&self, tables: &impl Tables, mu: f32) -> f32 {
        if self.coat_weight == 0.0 {
            return 0.0;
        }
        self.coat_weight * tables.coat_albedo(mu, self.coat_roughness)
    }

    /// Directional albedo of the dielectric, as if there were no coat.
    pub fn specular_reflectance(&self, tables: &impl Tables, mu: f32) -> f32 {
        if self.specular_weight == 0.0 {
            return 0.0;
        }
        self.specular_weight * tables.specular_albedo(mu, self.specular_roughness)
    }

    /// Part of the dielectric's reflection that is lost under the coat.
    pub fn specular_loss(&self, tables: &impl Tables, mu: f32) -> f32 {
        if self.coat_weight == 0.0 {
            return 0.0;
        }
        let loss = tables.dielectric_loss(mu, self.specular_roughness, self.coat_roughness);
        self.coat_weight * self.specular_weight * loss
    }

    /// T(μ): share that passes both interfaces, without the coat's tint; `coat` is the coat's reflectance there.
    pub fn transmittance_under(&self, tables: &impl Tables, coat: f32, mu: f32) -> f32 {
        (1.0 - coat) * (1.0 - self.specular_reflectance(tables, mu)) + self.specular_loss(tables, mu)
    }

    /// T(μ): share that passes both interfaces, without the coat's tint.
    pub fn transmittance(&self, tables: &impl Tables, mu: f32) -> f32 {
        self.transmittance_under(tables, self.coat_reflectance(tables, mu), mu)
    }

    /// T̄ = 2 ∫ T(μ) μ dμ.
    pub fn average_transmittance(&self, tables: &impl Tables) -> f32 {
        let (roughness, coat_roughness) = (self.specular_roughness, self.coat_roughness);
        let specular = self.specular_weight * tables.average_specular_albedo(roughness);
        if self.coat_weight == 0.0 {
            return 1.0 - specular;
        }
        let both = self.specular_weight * tables.average_dielectric_loss(roughness, coat_roughness);
        1.0 - specular - self.coat_weight * (tables.average_coat_albedo(coat_roughness) - both)
    }

    /// Light that a white metal leaves between its facets; `coat` is the coat's reflectance there.
    pub fn metal_exchange_under(&self, tables: &impl Tables, coat: f32, mu: f32) -> f32 {
        let deficit = (1.0 - coat) * tables.metal_deficit(mu, self.specular_roughness);
        if self.coat_weight == 0.0 {
            return deficit;
        }
        deficit + self.coat_weight * tables.metal_loss(mu, self.specular_roughness, self.coat_roughness)
    }

    /// The cosine mean of that light.
    pub fn average_metal_exchange(&self, tables: &impl Tables) -> f32 {
        let deficit = tables.average_metal_deficit(self.specular_roughness);
        if self.coat_weight == 0.0 {
            return deficit;
        }
        deficit + self.coat_weight * tables.average_metal_loss(self.specular_roughness, self.coat_roughness)
    }
}

/// Share of light that single scattering by the facets of lossless rough glass keeps, where the reflectance at normal incidence
/// is scaled by `weight`; 1 for a mirror.
pub fn glass_kept(tables: &impl Tables, is_inside: bool, mu: f32, roughness: f32, weight: f32) -> f32 {
    if Ggx::from_roughness(roughness).is_smooth() {
        return 1.0;
    }
    let root = weight.sqrt();
    let mut level = 0_u32;
    let mut root_of_level = 1.0;
    while level + 1_u32 < GLASS_LEVELS && root < 0.5 * root_of_level {
        level += 1_u32;
        root_of_level *= 0.5;
    }
    let mut kept = tables.glass_level(level, is_inside, mu, roughness);
    if level + 1_u32 < GLASS_LEVELS && root < 1.0 {
        let next = tables.glass_level(level + 1_u32, is_inside, mu, roughness);
        kept = linear(next, kept, 2.0 * root / root_of_level - 1.0);
    }
    kept.clamp(0.1, 1.0)
}
