//! The layers over the base of a material: coat and dielectric interface, and the light they let through.

use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::OnceLock;

use glam::Vec3;

use super::coated_table::CoatedTable;
use super::glass_table::GlassTable;
use super::reflectance_table::{MetalTable, ReflectanceTable};
use super::surface::SurfaceParameters;

/// The tables of a material's two indices of refraction; materials with the same indices can share them.
#[derive(Clone, Debug)]
pub struct MaterialTables {
    pub(super) specular: ReflectanceTable,
    pub(super) coat: ReflectanceTable,
    pub(super) glass: GlassTable,
    pub(super) metal: &'static MetalTable,
    // Computed when the first coated surface is met.
    coated: OnceLock<CoatedTable>,
}

impl MaterialTables {
    /// Tables for a dielectric base and a coat with indices in [1, 4] (clamped).
    pub fn new(specular_ior: f32, coat_ior: f32) -> Self {
        let specular = ReflectanceTable::new(valid_ior(specular_ior));
        Self {
            glass: GlassTable::new(specular.eta()),
            coat: ReflectanceTable::new(valid_ior(coat_ior)),
            metal: MetalTable::shared(),
            coated: OnceLock::new(),
            specular,
        }
    }

    /// Index of refraction of the base.
    pub fn specular_ior(&self) -> f32 {
        self.specular.eta()
    }

    /// Index of refraction of the coat.
    pub fn coat_ior(&self) -> f32 {
        self.coat.eta()
    }

    /// All that the tables hold as numbers, for devices: with the names that their shaders give the places, in this order.
    pub fn sections(&self) -> [(&'static str, Vec<f32>); 9] {
        let [dielectric, metal, coat_dielectric, coat_metal] = self.coated().numbers();
        [
            ("INDICES", vec![self.specular_ior(), self.coat_ior()]),
            ("SPECULAR_TABLE", self.specular.numbers()),
            ("COAT_TABLE", self.coat.numbers()),
            ("METAL_TABLE", self.metal.numbers()),
            ("COATED_DIELECTRIC_TABLE", dielectric),
            ("COATED_METAL_TABLE", metal),
            ("COAT_DIELECTRIC_AVERAGES", coat_dielectric),
            ("COAT_METAL_AVERAGES", coat_metal),
            ("GLASS_TABLE", self.glass.numbers()),
        ]
    }

    fn coated(&self) -> &CoatedTable {
        self.coated.get_or_init(|| CoatedTable::new(&self.coat, &self.specular))
    }
}

fn valid_ior(ior: f32) -> f32 {
    // A comparison rather than `clamp`, which would keep NaN.
    if ior > 1.0 { ior.min(4.0) } else { 1.0 }
}

/// The interfaces of one surface point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layers<'a> {
    tables: &'a MaterialTables,
    specular_weight: f32,
    specular_roughness: f32,
    coat_weight: f32,
    coat_roughness: f32,
    coated: Option<&'a CoatedTable>,
}

impl<'a> Layers<'a> {
    /// The interfaces of a surface with clamped parameters.
    pub(super) fn new(p: &SurfaceParameters, tables: &'a MaterialTables) -> Self {
        Self {
            tables,
            specular_weight: p.specular_weight,
            specular_roughness: p.specular_roughness,
            coat_weight: p.coat_weight,
            coat_roughness: p.coat_roughness,
            coated: (p.coat_weight > 0.0).then(|| tables.coated()),
        }
    }

    /// This surface without its coat.
    pub(super) fn without_coat(self) -> Self {
        Self { coat_weight: 0.0, coated: None, ..self }
    }

    /// Directional albedo of the coat.
    pub(super) fn coat_reflectance(&self, mu: f32) -> f32 {
        if self.coat_weight == 0.0 {
            0.0
        } else {
            self.coat_weight * self.tables.coat.eval(mu, self.coat_roughness)
        }
    }

    /// Directional albedo of the dielectric, as if there were no coat.
    pub(super) fn specular_reflectance(&self, mu: f32) -> f32 {
        if self.specular_weight == 0.0 {
            return 0.0;
        }
        self.specular_weight * self.tables.specular.eval(mu, self.specular_roughness)
    }

    /// Part of the dielectric's reflection that is lost under the coat, see [`CoatedTable`].
    pub(super) fn specular_loss(&self, mu: f32) -> f32 {
        self.coated.map_or(0.0, |coated| {
            let loss = coated.dielectric_loss(mu, self.specular_roughness, self.coat_roughness);
            self.coat_weight * self.specular_weight * loss
        })
    }

    /// T(μ): share that passes both interfaces, without the coat's tint; `coat` is the coat's reflectance there.
    pub(super) fn transmittance_under(&self, coat: f32, mu: f32) -> f32 {
        (1.0 - coat) * (1.0 - self.specular_reflectance(mu)) + self.specular_loss(mu)
    }

    /// T(μ): share that passes both interfaces, without the coat's tint.
    pub(super) fn transmittance(&self, mu: f32) -> f32 {
        self.transmittance_under(self.coat_reflectance(mu), mu)
    }

    /// T̄ = 2 ∫ T(μ) μ dμ.
    pub(super) fn average_transmittance(&self) -> f32 {
        let specular = self.specular_weight * self.tables.specular.average(self.specular_roughness);
        let Some(coated) = self.coated else { return 1.0 - specular };
        let both =
            self.specular_weight * coated.dielectric_average(self.specular_roughness, self.coat_roughness);
        1.0 - specular - self.coat_weight * (self.tables.coat.average(self.coat_roughness) - both)
    }

    /// Light that a white metal leaves between its facets; `coat` is the coat's reflectance there.
    pub(super) fn metal_exchange_under(&self, coat: f32, mu: f32) -> f32 {
        let deficit = (1.0 - coat) * self.tables.metal.deficit(mu, self.specular_roughness);
        let loss = self
            .coated
            .map_or(0.0, |coated| coated.metal_loss(mu, self.specular_roughness, self.coat_roughness));
        deficit + self.coat_weight * loss
    }

    /// Its cosine mean.
    pub(super) fn average_metal_exchange(&self) -> f32 {
        let deficit = self.tables.metal.average_deficit(self.specular_roughness);
        let more = self
            .coated
            .map_or(0.0, |coated| coated.metal_average(self.specular_roughness, self.coat_roughness));
        deficit + self.coat_weight * more
    }
}

/// Tint of two passes through the coat.
pub(super) fn coat_tint(p: &SurfaceParameters) -> Vec3 {
    Vec3::ONE.lerp(p.coat_color, p.coat_weight)
}

/// Tint of one pass through the coat.
pub(super) fn coat_tint_one_way(p: &SurfaceParameters) -> Vec3 {
    let tint = coat_tint(p);
    Vec3::new(tint.x.sqrt(), tint.y.sqrt(), tint.z.sqrt())
}

/// A direction over the upper hemisphere with density cosθ/π.
pub fn sample_cosine(v: [f32; 2]) -> Vec3 {
    let (sin, cos) = libm::sincosf(TAU * v[1]);
    let r = v[0].sqrt();
    // Never exactly on the horizon.
    Vec3::new(r * cos, r * sin, (1.0 - v[0]).max(1e-7).sqrt())
}

/// How light enters a scattering medium at a point: the factor T(ωi) / (π T̄).
///
/// Directions are in the local frame of the entry point, on the side that the light comes from (z > 0).
#[derive(Clone, Copy, Debug)]
pub struct EntryBsdf<'a> {
    layers: Layers<'a>,
    tint: Vec3,
    inverse_average: f32,
}

impl<'a> EntryBsdf<'a> {
    /// The factor of a surface point.
    pub fn new(p: &SurfaceParameters, tables: &'a MaterialTables) -> Self {
        let p = p.clamped();
        let layers = Layers::new(&p, tables);
        Self { layers, tint: coat_tint_one_way(&p), inverse_average: 1.0 / layers.average_transmittance() }
    }

    /// T(ωi) cosθi / (π T̄) with the tint of one pass through the coat [1/sr]; 0 from below.
    pub fn eval(&self, cos_i: f32) -> Vec3 {
        if cos_i <= 0.0 {
            return Vec3::ZERO;
        }
        self.weight(cos_i) * Self::pdf(cos_i)
    }

    /// Density of [`EntryBsdf::sample`]: cosθ/π [1/sr].
    pub fn pdf(cos_i: f32) -> f32 {
        cos_i.max(0.0) * FRAC_1_PI
    }

    /// The tint of one pass through the coat.
    pub fn tint(&self) -> Vec3 {
        self.tint
    }

    /// A direction and its weight `eval / pdf`.
    pub fn sample(&self, v: [f32; 2]) -> (Vec3, Vec3) {
        let wi = sample_cosine(v);
        (wi, self.weight(wi.z))
    }

    /// T(ωi)/T̄ with the tint of one pass through the coat: the share of a radiance that enters.
    pub fn weight(&self, cos_i: f32) -> Vec3 {
        self.tint * (self.layers.transmittance(cos_i.min(1.0)) * self.inverse_average)
    }
}
