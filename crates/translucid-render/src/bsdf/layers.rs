//! What lies over the base of a material: coat and dielectric interface, and what they let through.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec3;

use super::reflectance_table::{
    AVERAGE_ROWS, COSINE_NODES, GlassTable, MetalTable, ReflectanceTable, average_position,
    average_roughness, gauss_legendre,
};
use super::surface::SurfaceParameters;

/// Mean of two layers' reflectances, and of their product, over roughness.
type Averages = [f32; AVERAGE_ROWS];

/// The tables of a material's two indices of refraction; materials with the same indices can share them.
#[derive(Clone, Debug)]
pub struct MaterialTables {
    pub(super) specular: ReflectanceTable,
    pub(super) coat: ReflectanceTable,
    pub(super) glass: GlassTable,
    pub(super) metal: &'static MetalTable,
    specular_average: Averages,
    coat_average: Averages,
    // Indices: roughness of the coat, of the specular interface.
    product_average: Box<[Averages; AVERAGE_ROWS]>,
}

impl MaterialTables {
    /// Tables for a dielectric base and a coat with indices in [1, 4] (clamped).
    #[must_use]
    pub fn new(specular_ior: f32, coat_ior: f32) -> Self {
        let specular = ReflectanceTable::new(valid_ior(specular_ior));
        let coat = ReflectanceTable::new(valid_ior(coat_ior));
        let nodes = gauss_legendre::<COSINE_NODES>();
        let sampled = |table: &ReflectanceTable| -> [[f32; COSINE_NODES]; AVERAGE_ROWS] {
            std::array::from_fn(|row| nodes.map(|(mu, _)| table.eval(mu, average_roughness(row))))
        };
        let mean = |f: &dyn Fn(usize) -> f32| -> f32 {
            nodes.iter().enumerate().map(|(i, (mu, weight))| 2.0 * mu * weight * f(i)).sum()
        };
        let (e_s, e_c) = (sampled(&specular), sampled(&coat));
        let mut product_average = Box::new([[0.0; AVERAGE_ROWS]; AVERAGE_ROWS]);
        for (c, line) in product_average.iter_mut().enumerate() {
            *line = std::array::from_fn(|s| mean(&|i| e_c[c][i] * e_s[s][i]));
        }
        Self {
            glass: GlassTable::new(specular.eta()),
            metal: MetalTable::shared(),
            specular_average: std::array::from_fn(|row| mean(&|i| e_s[row][i])),
            coat_average: std::array::from_fn(|row| mean(&|i| e_c[row][i])),
            product_average,
            specular,
            coat,
        }
    }

    /// Index of refraction of the base.
    #[must_use]
    pub fn specular_ior(&self) -> f32 {
        self.specular.eta()
    }

    /// Index of refraction of the coat.
    #[must_use]
    pub fn coat_ior(&self) -> f32 {
        self.coat.eta()
    }
}

fn valid_ior(ior: f32) -> f32 {
    // A comparison rather than `clamp`, which would keep NaN.
    if ior > 1.0 { ior.min(4.0) } else { 1.0 }
}

/// Transmittances of the interfaces of one surface point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layers<'a> {
    tables: &'a MaterialTables,
    specular_weight: f32,
    specular_roughness: f32,
    coat_weight: f32,
    coat_roughness: f32,
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
        }
    }

    /// Directional albedo of the coat.
    pub(super) fn coat_reflectance(&self, mu: f32) -> f32 {
        if self.coat_weight == 0.0 {
            0.0
        } else {
            self.coat_weight * self.tables.coat.eval(mu, self.coat_roughness)
        }
    }

    /// Directional albedo of the dielectric under the coat.
    pub(super) fn specular_reflectance(&self, mu: f32) -> f32 {
        if self.specular_weight == 0.0 {
            return 0.0;
        }
        self.specular_weight * self.tables.specular.eval(mu, self.specular_roughness)
    }

    /// T(μ): what passes both interfaces, without the coat's tint.
    pub(super) fn transmittance(&self, mu: f32) -> f32 {
        (1.0 - self.coat_reflectance(mu)) * (1.0 - self.specular_reflectance(mu))
    }

    /// T̄ = 2 ∫ T(μ) μ dμ.
    pub(super) fn average_transmittance(&self) -> f32 {
        let (c0, c1, c) = average_position(self.coat_roughness);
        let (s0, s1, s) = average_position(self.specular_roughness);
        let tables = self.tables;
        let mix = |a: f32, b: f32, x: f32| a + (b - a) * x;
        let coat = mix(tables.coat_average[c0], tables.coat_average[c1], c);
        let specular = mix(tables.specular_average[s0], tables.specular_average[s1], s);
        let line = |row: usize| mix(tables.product_average[row][s0], tables.product_average[row][s1], s);
        let product = mix(line(c0), line(c1), c);
        let (wc, ws) = (self.coat_weight, self.specular_weight);
        1.0 - wc * coat - ws * specular + wc * ws * product
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
pub(super) fn sample_cosine(v: [f32; 2]) -> Vec3 {
    let (sin, cos) = (TAU * v[1]).sin_cos();
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
    #[must_use]
    pub fn new(p: &SurfaceParameters, tables: &'a MaterialTables) -> Self {
        let p = p.clamped();
        let layers = Layers::new(&p, tables);
        Self { layers, tint: coat_tint_one_way(&p), inverse_average: 1.0 / layers.average_transmittance() }
    }

    /// T(ωi) cosθi / (π T̄) with the tint of one pass through the coat [1/sr]; 0 from below.
    #[must_use]
    pub fn eval(&self, cos_i: f32) -> Vec3 {
        if cos_i <= 0.0 {
            return Vec3::ZERO;
        }
        self.weight(cos_i) * Self::pdf(cos_i)
    }

    /// Density of [`EntryBsdf::sample`]: cosθ/π [1/sr].
    #[must_use]
    pub fn pdf(cos_i: f32) -> f32 {
        cos_i.max(0.0) * FRAC_1_PI
    }

    /// A direction and its weight `eval / pdf`.
    #[must_use]
    pub fn sample(&self, v: [f32; 2]) -> (Vec3, Vec3) {
        let wi = sample_cosine(v);
        (wi, self.weight(wi.z))
    }

    fn weight(&self, cos_i: f32) -> Vec3 {
        self.tint * (self.layers.transmittance(cos_i.min(1.0)) * self.inverse_average)
    }
}
