//! The layers over the base of a material: coat and dielectric interface, and the light they let through.

use std::f32::consts::FRAC_1_PI;
use std::sync::OnceLock;

use glam::Vec3;
use translucid_law::bsdf::Entry;
use translucid_law::{SurfaceParameters, Tables, sample_cosine};

use super::coated_table::CoatedTable;
use super::glass_table::GlassTable;
use super::reflectance_table::{MetalTable, ReflectanceTable};

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

/// The tables of a material as one surface point asks them.
#[derive(Clone, Copy, Debug)]
pub(super) struct AskedTables<'a> {
    of: &'a MaterialTables,
    coated: Option<&'a CoatedTable>,
}

impl<'a> AskedTables<'a> {
    /// Those for a surface with a coat of a weight.
    pub(super) fn new(of: &'a MaterialTables, coat_weight: f32) -> Self {
        Self { of, coated: (coat_weight > 0.0).then(|| of.coated()) }
    }
}

impl Tables for AskedTables<'_> {
    fn specular_ior(&self) -> f32 {
        self.of.specular_ior()
    }

    fn coat_ior(&self) -> f32 {
        self.of.coat_ior()
    }

    fn specular_albedo(&self, mu: f32, roughness: f32) -> f32 {
        self.of.specular.eval(mu, roughness)
    }

    fn average_specular_albedo(&self, roughness: f32) -> f32 {
        self.of.specular.average(roughness)
    }

    fn coat_albedo(&self, mu: f32, roughness: f32) -> f32 {
        self.of.coat.eval(mu, roughness)
    }

    fn average_coat_albedo(&self, roughness: f32) -> f32 {
        self.of.coat.average(roughness)
    }

    fn metal_deficit(&self, mu: f32, roughness: f32) -> f32 {
        self.of.metal.deficit(mu, roughness)
    }

    fn average_metal_deficit(&self, roughness: f32) -> f32 {
        self.of.metal.average_deficit(roughness)
    }

    fn dielectric_loss(&self, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
        self.coated.map_or(0.0, |coated| coated.dielectric_loss(mu, roughness, coat_roughness))
    }

    fn average_dielectric_loss(&self, roughness: f32, coat_roughness: f32) -> f32 {
        self.coated.map_or(0.0, |coated| coated.dielectric_average(roughness, coat_roughness))
    }

    fn metal_loss(&self, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
        self.coated.map_or(0.0, |coated| coated.metal_loss(mu, roughness, coat_roughness))
    }

    fn average_metal_loss(&self, roughness: f32, coat_roughness: f32) -> f32 {
        self.coated.map_or(0.0, |coated| coated.metal_average(roughness, coat_roughness))
    }

    fn glass_level(&self, level: u32, is_inside: bool, mu: f32, roughness: f32) -> f32 {
        self.of.glass.eval(level, is_inside, mu, roughness)
    }
}

/// How light enters a scattering medium at a point: the factor T(ωi) / (π T̄).
///
/// Directions are in the local frame of the entry point, on the side that the light comes from (z > 0).
#[derive(Clone, Copy, Debug)]
pub struct EntryBsdf<'a> {
    law: Entry,
    tables: AskedTables<'a>,
}

impl<'a> EntryBsdf<'a> {
    /// The factor of a surface point.
    pub fn new(p: &SurfaceParameters, tables: &'a MaterialTables) -> Self {
        let tables = AskedTables::new(tables, p.coat_weight);
        Self { law: Entry::new(&tables, p), tables }
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
        self.law.tint
    }

    /// A direction and its weight `eval / pdf`.
    pub fn sample(&self, v: [f32; 2]) -> (Vec3, Vec3) {
        let wi = sample_cosine(v);
        (wi, self.weight(wi.z))
    }

    /// T(ωi)/T̄ with the tint of one pass through the coat: the share of a radiance that enters.
    pub fn weight(&self, cos_i: f32) -> Vec3 {
        self.law.entering(&self.tables, cos_i)
    }
}
