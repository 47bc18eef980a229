//! The BSDF of a surface point: evaluation and sampling of all its lobes. `translucid-render`'s `surface/bsdf` states its formula.
//!
//! Directions are in the shading frame, z along the normal, away from the surface.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;

use crate::conductor::MetalFresnel;
use crate::dielectric::{fresnel_dielectric, mirrored, refracted, scaled_ior};
use crate::directions::sample_cosine;
use crate::elementary::{greatest, is_finite, is_zero_vector, unit_or};
use crate::ggx::Ggx;
use crate::layers::{Layers, Tables, glass_kept};
use crate::surface::SurfaceParameters;
use crate::thin_wall::{Slab, roughness_through};

/// Below this cosine the direction seen from is bent up: the shading normal lies, or the ray grazes.
const LEAST_COSINE: f32 = 1e-4;
/// Index steps below this do not bend light; F₀ is below 2.5e-7.
const SAME_INDEX: f32 = 1e-3;
/// Least albedo by which a lobe that exists is chosen, so that table errors cannot hide it.
const LEAST_LOBE: f32 = 1e-4;

/// Kind of a [`BsdfDraw`]: no light comes.
pub const NOTHING: u32 = 0;
/// Kind of a [`BsdfDraw`]: light comes from a direction.
pub const DIRECTION: u32 = 1;
/// Kind of a [`BsdfDraw`]: light comes from under the surface.
pub const BELOW: u32 = 2;
/// Lobe over the whole hemisphere.
pub const DIFFUSE: u32 = 0;
/// Lobe of rough facets.
pub const GLOSSY: u32 = 1;
/// Lobe of a mirror: no other technique can find its direction.
pub const MIRROR: u32 = 2;

/// f·|cosθi| of a pair of directions [1/sr], without mirror lobes and without subsurface scattering.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsdfValue {
    /// Matte reflection.
    pub diffuse: Vec3,
    /// Density with which the direction is drawn, choice of lobe included [1/sr].
    pub pdf: f32,
    /// Reflection by coat, dielectric and metal, and rough transmission.
    pub specular: Vec3,
}

impl BsdfValue {
    /// No light.
    #[inline]
    pub fn none() -> Self {
        Self { diffuse: Vec3::ZERO, pdf: 0.0, specular: Vec3::ZERO }
    }
}

/// A decision where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfDraw {
    /// [`NOTHING`], [`DIRECTION`] or [`BELOW`].
    pub kind: u32,
    /// Where it comes from.
    pub wi: Vec3,
    /// f|cosθi| / pdf over all lobes that share the direction; of light from below, what leaves, without A.
    pub weight: Vec3,
    /// Part of `weight` that is matte reflection, per channel in [0, 1].
    pub diffuse_share: Vec3,
    /// Density [1/sr], 0 for a mirror.
    pub pdf: f32,
    /// [`DIFFUSE`], [`GLOSSY`] or [`MIRROR`].
    pub lobe: u32,
    /// Light crosses the surface.
    pub is_transmitted: bool,
}

impl BsdfDraw {
    /// A decision without density.
    #[inline]
    fn of(kind: u32, wi: Vec3, weight: Vec3, lobe: u32, is_transmitted: bool) -> Self {
        Self { kind, wi, weight, diffuse_share: Vec3::ZERO, pdf: 0.0, lobe, is_transmitted }
    }

    /// No light.
    #[inline]
    pub fn none() -> Self {
        Self::of(NOTHING, Vec3::ZERO, Vec3::ZERO, DIFFUSE, false)
    }

    /// A direction with the value and density of all lobes there.
    #[inline]
    #[must_use]
    pub fn weighed(&self, value: &BsdfValue) -> Self {
        if !is_finite(value.pdf) || value.pdf <= 0.0 {
            return Self::none();
        }
        let f = value.diffuse + value.specular;
        let share = value.diffuse / f.max(Vec3::splat(f32::MIN_POSITIVE));
        let mut draw = *self;
        draw.weight = f / value.pdf;
        draw.diffuse_share = Vec3::select(f.cmpgt(Vec3::ZERO), share, Vec3::ZERO);
        draw.pdf = value.pdf;
        draw
    }
}

/// Probabilities of the sampling strategies; they sum to 1, or to 0 for a black surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Strategies {
    /// The coat.
    pub coat: f32,
    /// Facets of the base.
    pub facets: f32,
    /// Straight on, through glass without a step of the index or a thin wall.
    pub straight: f32,
    /// The matte base.
    pub diffuse: f32,
    /// Light from below.
    pub subsurface: f32,
}

impl Strategies {
    /// Chances in proportion to these.
    #[inline]
    #[must_use]
    pub fn normalized(self) -> Self {
        let sum = self.coat + self.facets + self.straight + self.diffuse + self.subsurface;
        let scale = if sum >= f32::MIN_POSITIVE { 1.0 / sum } else { 0.0 };
        Self {
            coat: scaled_chance(self.coat, scale),
            facets: scaled_chance(self.facets, scale),
            straight: scaled_chance(self.straight, scale),
            diffuse: scaled_chance(self.diffuse, scale),
            subsurface: scaled_chance(self.subsurface, scale),
        }
    }
}

/// A scaled chance, or 0: a number whose inverse is infinite makes no weight.
#[inline]
fn scaled_chance(chance: f32, scale: f32) -> f32 {
    let scaled = chance * scale;
    if scaled < f32::MIN_POSITIVE { 0.0 } else { scaled }
}

/// Clear part of a material.
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    /// Mixture weight.
    pub weight: f32,
    /// Index of the other side over that of the side of `wo`.
    pub eta: f32,
    /// Inverse of the single-scattering albedo: scales both lobes to lose nothing [after Turquin 2019]. Of a thin wall that
    /// of transmission.
    pub compensation: f32,
    /// Tint of reflection; of a thin wall its compensated reflectance.
    pub reflection_tint: Vec3,
    /// Tint of a crossing, the coat's one-way tint included; of a thin wall its transmittance, and both ways.
    pub transmission_tint: Vec3,
    /// No step of the index, or a thin wall: light goes straight on.
    pub is_straight: bool,
}

/// Light at a facet: reflected and transmitted parts and the chance that reflection is sampled.
#[derive(Clone, Copy, Debug)]
pub struct FacetSplit {
    /// Share that is reflected.
    pub reflected: Vec3,
    /// Share that is transmitted.
    pub transmitted: Vec3,
    /// Chance of the former.
    pub reflect_probability: f32,
}

/// The BSDF of a surface point seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    /// The interfaces.
    pub layers: Layers,
    /// Directions are mirrored to the side of `wo`: wo.z > 0.
    pub wo: Vec3,
    /// −1 where they are mirrored, else 1.
    pub side: f32,
    /// Share that passes the coat toward `wo`.
    pub coat_transmittance: f32,
    /// Tint of two passes through the coat.
    pub coat_tint: Vec3,
    /// Weight of the opaque dielectric's reflection.
    pub dielectric: Vec3,
    /// Weight of the metal.
    pub metal_weight: f32,
    /// The metal's reflectance.
    pub metal: MetalFresnel,
    /// Reflection between facets without the factor of wi: f = facet_exchange · deficit(wi).
    pub facet_exchange: Vec3,
    /// The clear part.
    pub glass: Glass,
    /// `true` for a thin wall.
    pub is_thin: bool,
    /// Diffuse transmission of a thin wall without the factors of wi, A' (…) T(ωo) / (π T̄).
    pub thin_matte: Vec3,
    /// Probability of sampling it.
    pub thin_probability: f32,
    /// Facets of clear transmission through a thin wall.
    pub thin_facets: Ggx,
    /// A (…) T(ωo) / (π T̄).
    pub matte: Vec3,
    /// T(ωi) is 1, and does not follow the interface.
    pub matte_is_bare: bool,
    /// The weight of light from below.
    pub subsurface: Vec3,
    /// How lobes are chosen.
    pub strategies: Strategies,
    /// About the hemispherical–directional reflectance, transmission and subsurface color included.
    pub albedo: Vec3,
}

impl Bsdf {
    /// The BSDF seen from `wo`; `wo.z` < 0 is from inside.
    ///
    /// An opaque surface seen from inside looks as from outside; of one that is partly clear, the opaque part is bare from
    /// inside, and the coat only tints. A thin-walled one has no inside.
    pub fn new(tables: &impl Tables, parameters: &SurfaceParameters, wo: Vec3) -> Self {
        let p = parameters.clamped();
        let glass_weight = (1.0 - p.metalness) * p.transmission_weight;
        let is_inside = wo.z < 0.0 && glass_weight > 0.0 && !p.is_thin();
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let unlit = Self::unlit(&p, lifted(Vec3::new(wo.x, wo.y, wo.z * side)), side);
        if is_inside {
            return unlit.filled_from_inside(tables, &p, glass_weight);
        }
        unlit.filled_from_outside(tables, &p, glass_weight)
    }

    /// All that does not depend on the side, without lobes.
    #[inline]
    fn unlit(p: &SurfaceParameters, wo: Vec3, side: f32) -> Self {
        Self {
            layers: Layers {
                specular_weight: p.specular_weight,
                specular_roughness: p.specular_roughness,
                coat_weight: p.coat_weight,
                coat_roughness: p.coat_roughness,
            },
            wo,
            side,
            coat_transmittance: 1.0,
            coat_tint: Vec3::ONE,
            dielectric: Vec3::ZERO,
            metal_weight: 0.0,
            metal: MetalFresnel::new(p.base_color, p.specular_color),
            facet_exchange: Vec3::ZERO,
            glass: Glass {
                weight: 0.0,
                eta: 1.0,
                compensation: 1.0,
                reflection_tint: p.specular_color,
                transmission_tint: p.transmission_tint * p.coat_tint_one_way(),
                is_straight: true,
            },
            is_thin: p.is_thin(),
            thin_matte: Vec3::ZERO,
            thin_probability: 0.0,
            thin_facets: Ggx { alpha2: 0.0 },
            matte: Vec3::ZERO,
            matte_is_bare: false,
            subsurface: Vec3::ZERO,
            strategies: Strategies { coat: 0.0, facets: 0.0, straight: 0.0, diffuse: 0.0, subsurface: 0.0 },
            albedo: Vec3::ZERO,
        }
    }

    fn filled_from_outside(&self, tables: &impl Tables, p: &SurfaceParameters, glass_weight: f32) -> Self {
        let mut b = *self;
        let mu = b.wo.z;
        let opaque = (1.0 - p.metalness) * (1.0 - p.transmission_weight);
        let coat = b.layers.coat_reflectance(tables, mu);
        let specular = b.layers.specular_reflectance(tables, mu);
        let transmittance = b.layers.transmittance_under(tables, coat, mu);
        b.coat_transmittance = 1.0 - coat;
        b.coat_tint = p.coat_tint();
        b.dielectric = p.specular_color * (opaque * p.specular_weight);
        b.metal_weight = p.metalness * p.specular_weight;
        b.facet_exchange = b.exchange(tables);
        let eta = scaled_ior(tables.specular_ior(), p.specular_weight);
        if p.is_thin() {
            b.thin_facets = Ggx::from_roughness(roughness_through(p.specular_roughness, eta));
            b.glass = b.slab(tables, p, glass_weight, eta);
        } else {
            b.glass = b.body(tables, p, glass_weight, eta);
        }
        let average = b.layers.average_transmittance(tables);
        let matte_albedo = b.coat_tint * p.matte_albedo();
        b.matte = matte_albedo * (opaque * transmittance * FRAC_1_PI / average);
        let below = opaque * p.subsurface_weight * transmittance;
        b.subsurface = p.coat_tint_one_way() * below * p.subsurface_active;
        let matte = matte_albedo * (opaque * transmittance);
        let reflection = (p.specular_color * (opaque * specular) + b.metal_albedo(tables)) * b.coat_tint;
        if !p.is_thin() {
            let subsurface = b.coat_tint * p.subsurface_albedo_active() * below;
            return b.chosen(tables, coat, reflection, matte, subsurface);
        }
        let passed = b.coat_tint * p.thin_albedo * below;
        let reflected = b.glass.reflection_tint * b.coat_tint * b.glass.weight;
        b = b.chosen(tables, coat, reflection + reflected, matte + passed, Vec3::ZERO);
        let exchanged = mean(b.facet_exchange) * PI * b.layers.average_metal_exchange(tables);
        let all = mean(matte) + mean(passed) + exchanged;
        if all > 0.0 {
            // Light samples look for the reflected part, too, however small it is
            b.thin_probability = b.strategies.diffuse * (mean(passed) / all).min(0.99);
        }
        b.thin_matte = passed * (FRAC_1_PI / average);
        b.strategies.diffuse -= b.thin_probability;
        b
    }

    fn filled_from_inside(&self, tables: &impl Tables, p: &SurfaceParameters, glass_weight: f32) -> Self {
        let mut b = *self;
        let opaque = (1.0 - p.metalness) * (1.0 - p.transmission_weight);
        b.layers.coat_weight = 0.0;
        b.metal_weight = p.metalness * p.specular_weight;
        b.facet_exchange = b.exchange(tables);
        let eta = 1.0 / scaled_ior(tables.specular_ior(), p.specular_weight);
        b.glass = b.body(tables, p, glass_weight, eta);
        let bare = p.matte_albedo() + p.subsurface_albedo_active() * p.subsurface_weight;
        b.matte = bare * (opaque * FRAC_1_PI);
        b.matte_is_bare = true;
        b.chosen(tables, 0.0, b.metal_albedo(tables), bare * opaque, Vec3::ZERO)
    }

    /// The reflection of light between the metal's facets, without the factor of wi.
    fn exchange(&self, tables: &impl Tables) -> Vec3 {
        let roughness = self.layers.specular_roughness;
        if self.metal_weight == 0.0 || Ggx::from_roughness(roughness).is_smooth() {
            return Vec3::ZERO;
        }
        let average = self.layers.average_metal_exchange(tables);
        if average <= 1e-6 {
            return Vec3::ZERO;
        }
        let out = self.layers.metal_exchange_under(tables, 1.0 - self.coat_transmittance, self.wo.z);
        let color = self.metal.multiple_scattering(1.0 - tables.average_metal_deficit(roughness));
        self.coat_tint * color * (self.metal_weight * out * FRAC_1_PI / average)
    }

    /// About the albedo of the metal in single scattering.
    fn metal_albedo(&self, tables: &impl Tables) -> Vec3 {
        if self.metal_weight == 0.0 {
            return Vec3::ZERO;
        }
        let roughness = self.layers.specular_roughness;
        let single = 1.0 - tables.metal_deficit(self.wo.z, roughness);
        // Rough facets are seen from all angles
        let color = self.metal.reflectance(self.wo.z).lerp(self.metal.average(), roughness);
        color * (self.metal_weight * single)
    }

    /// The clear part of a thin-walled surface.
    #[cold]
    fn slab(&self, tables: &impl Tables, p: &SurfaceParameters, weight: f32, eta: f32) -> Glass {
        let mu = self.wo.z;
        let slab = Slab::new(mu, eta, p.transmission_tint);
        let roughness = roughness_through(p.specular_roughness, eta);
        // The coat takes more from a rough reflection than its share
        let under_coat = self.coat_transmittance * self.layers.specular_reflectance(tables, mu);
        let loss = self.layers.specular_loss(tables, mu);
        let mut kept = 1.0;
        if loss > 0.0 {
            kept = (1.0 - loss / under_coat).max(0.5);
        }
        let mut glass = self.glass;
        glass.weight = weight;
        glass.compensation = 1.0 / (1.0 - tables.metal_deficit(mu, roughness));
        let faces = 1.0 - tables.metal_deficit(mu, p.specular_roughness);
        glass.reflection_tint = slab.reflectance * p.specular_color / (kept * faces);
        glass.transmission_tint = slab.transmittance * self.coat_tint;
        glass
    }

    /// The clear part of a body.
    fn body(&self, tables: &impl Tables, p: &SurfaceParameters, weight: f32, eta: f32) -> Glass {
        let mut glass = self.glass;
        glass.weight = weight;
        glass.eta = eta;
        glass.is_straight = (eta - 1.0).abs() < SAME_INDEX;
        if weight > 0.0 && !glass.is_straight {
            let mu = self.wo.z;
            let single = glass_kept(tables, eta <= 1.0, mu, p.specular_roughness, p.specular_weight);
            // The coat takes more from a rough reflection than its share
            let kept = 1.0 - self.layers.specular_loss(tables, mu) / (self.coat_transmittance * single);
            glass.compensation = 1.0 / (single * kept.max(0.5));
        }
        glass
    }

    /// Chooses lobes in proportion to their albedos at `wo`; the arguments are without the coat's shadow on specular lobes.
    fn chosen(&self, tables: &impl Tables, coat: f32, reflection: Vec3, matte: Vec3, below: Vec3) -> Self {
        let mut b = *self;
        let exchange = b.facet_exchange * (PI * b.layers.average_metal_exchange(tables));
        let glass = b.glass_albedo(tables);
        let has_step = !b.glass.is_straight;
        let under_coat = b.coat_transmittance;
        let has_coat = b.layers.coat_weight > 0.0 && tables.coat_ior() > 1.0;
        let has_facets = b.metal_weight > 0.0
            || (greatest(b.dielectric) > 0.0 && tables.specular_ior() > 1.0)
            || (b.glass.weight > 0.0 && (has_step || b.is_thin));
        let mut facets = mean(reflection);
        if has_step {
            facets += mean(glass);
        }
        let strategies = Strategies {
            coat: if has_coat { coat.max(LEAST_LOBE) } else { 0.0 },
            facets: if has_facets { facets.max(LEAST_LOBE) * under_coat } else { 0.0 },
            straight: if has_step { 0.0 } else { mean(glass) * under_coat },
            diffuse: mean(matte) + mean(exchange),
            subsurface: mean(below),
        };
        b.strategies = strategies.normalized();
        let under = (reflection + glass) * under_coat;
        b.albedo = (Vec3::splat(coat) + under + exchange + matte + below).min(Vec3::ONE);
        b
    }

    /// Approximate albedo of glass: reflection and transmission.
    fn glass_albedo(&self, tables: &impl Tables) -> Vec3 {
        let glass = self.glass;
        if glass.weight == 0.0 {
            return Vec3::ZERO;
        }
        let mut f = 0.0;
        if !glass.is_straight {
            if glass.eta > 1.0 {
                f = self.layers.specular_reflectance(tables, self.wo.z);
            } else {
                f = fresnel_dielectric(self.wo.z, glass.eta);
            }
        }
        (glass.reflection_tint * self.coat_tint * f + glass.transmission_tint * (1.0 - f)) * glass.weight
    }

    /// Facets of the base.
    #[inline]
    pub fn base_facets(&self) -> Ggx {
        Ggx::from_roughness(self.layers.specular_roughness)
    }

    /// Facets of the coat.
    #[inline]
    pub fn coat_facets(&self) -> Ggx {
        Ggx::from_roughness(self.layers.coat_roughness)
    }

    /// Returns `true` if light sampling finds nothing: only mirror lobes, subsurface scattering or black.
    #[inline]
    pub fn is_smooth_only(&self) -> bool {
        self.strategies.diffuse == 0.0
            && (self.strategies.coat == 0.0 || self.coat_facets().is_smooth())
            && (self.strategies.facets == 0.0 || self.base_facets().is_smooth())
    }

    /// The share of light that comes from below, of a sample on average; 0 in the channels that are not active. Does not
    /// include A.
    #[inline]
    pub fn below(&self) -> Vec3 {
        if self.strategies.subsurface > 0.0 { self.subsurface } else { Vec3::ZERO }
    }

    /// The share of light that goes straight through, or, through a rough thin wall, about straight.
    #[inline]
    pub fn straight(&self) -> Vec3 {
        self.glass.transmission_tint * (self.glass.weight * self.coat_transmittance)
    }

    /// The share of light that goes straight through a thin wall.
    #[inline]
    pub fn straight_through_wall(&self) -> Vec3 {
        let is_straight = self.is_thin && self.thin_facets.is_smooth() && self.strategies.straight > 0.0;
        if is_straight { self.straight() } else { Vec3::ZERO }
    }

    /// Value and density for light from `wi`.
    pub fn eval(&self, tables: &impl Tables, wi: Vec3) -> BsdfValue {
        let z = wi.z * self.side;
        if z > 0.0 {
            return self.eval_reflection(tables, Vec3::new(wi.x, wi.y, z));
        }
        if z < 0.0 {
            if self.is_thin {
                return self.eval_through(tables, Vec3::new(wi.x, wi.y, -z));
            }
            return self.eval_transmission(tables, Vec3::new(wi.x, wi.y, z));
        }
        BsdfValue::none()
    }

    fn eval_reflection(&self, tables: &impl Tables, wi: Vec3) -> BsdfValue {
        let mut value = BsdfValue::none();
        let mu = wi.z;
        let h = unit_or(self.wo + wi, Vec3::Z);
        let coat = self.layers.coat_reflectance(tables, mu);
        let under_coat = self.coat_transmittance.min(1.0 - coat);
        let coat_facets = self.coat_facets();
        if self.strategies.coat > 0.0 && !coat_facets.is_smooth() {
            let lobe = coat_facets.reflection(self.wo, wi, h);
            let f = self.layers.coat_weight * fresnel_dielectric(self.wo.dot(h), tables.coat_ior());
            value.specular += Vec3::splat(f * lobe[0]);
            value.pdf += self.strategies.coat * lobe[1];
        }
        let facets = self.base_facets();
        if self.strategies.facets > 0.0 && !facets.is_smooth() {
            let lobe = facets.reflection(self.wo, wi, h);
            let split = self.split_at_facet(tables, self.wo.dot(h));
            value.specular += split.reflected * (lobe[0] * under_coat);
            value.pdf += self.strategies.facets * split.reflect_probability * lobe[1];
        }
        if self.strategies.diffuse > 0.0 {
            if !is_zero_vector(self.facet_exchange) {
                let exchange = self.layers.metal_exchange_under(tables, coat, mu);
                value.specular += self.facet_exchange * (exchange * mu);
            }
            let mut passed = 1.0;
            if !self.matte_is_bare {
                passed = self.layers.transmittance_under(tables, coat, mu);
            }
            value.diffuse = self.matte * (passed * mu);
            value.pdf += self.strategies.diffuse * mu * FRAC_1_PI;
        }
        value
    }

    fn eval_transmission(&self, tables: &impl Tables, wi: Vec3) -> BsdfValue {
        let eta = self.glass.eta;
        let facets = self.base_facets();
        if self.glass.weight == 0.0 || self.glass.is_straight || facets.is_smooth() {
            return BsdfValue::none();
        }
        // Normal of the facet that refracts wi to wo [Walter et al. 2007, eq. 16], on the side of wo
        let mut h = unit_or(self.wo + wi * eta, Vec3::ZERO);
        if h.z < 0.0 {
            h = -h;
        }
        let (cos_o, cos_i) = (self.wo.dot(h), wi.dot(h));
        if cos_o <= 0.0 || cos_i >= 0.0 {
            return BsdfValue::none();
        }
        let split = self.split_at_facet(tables, cos_o);
        let root = cos_o + eta * cos_i;
        let jacobian = eta * eta * -cos_i / (root * root);
        let pdf = facets.visible_density(self.wo, h) * jacobian;
        let shadowing = facets.masking_shadowing(self.wo.z, wi.z) / facets.masking(self.wo.z);
        if !is_finite(pdf) {
            return BsdfValue::none();
        }
        BsdfValue {
            diffuse: Vec3::ZERO,
            pdf: self.strategies.facets * (1.0 - split.reflect_probability) * pdf,
            specular: split.transmitted * (shadowing * pdf * self.coat_transmittance),
        }
    }

    /// Value and density for light from behind a thin wall; `wi` is its direction mirrored to this side.
    #[cold]
    fn eval_through(&self, tables: &impl Tables, wi: Vec3) -> BsdfValue {
        let mu = wi.z;
        let mut value = BsdfValue {
            diffuse: self.thin_matte * (self.layers.transmittance(tables, mu) * mu),
            pdf: self.thin_probability * mu * FRAC_1_PI,
            specular: Vec3::ZERO,
        };
        if self.strategies.straight > 0.0 && !self.thin_facets.is_smooth() {
            let h = unit_or(self.wo + wi, Vec3::Z);
            let lobe = self.thin_facets.reflection(self.wo, wi, h);
            value.specular = self.straight() * (lobe[0] * self.glass.compensation);
            value.pdf += self.strategies.straight * lobe[1];
        }
        value
    }

    /// Reflectance and transmittance of a base facet seen at a cosine, the coat's tints but not its shadow included.
    pub fn split_at_facet(&self, tables: &impl Tables, cosine: f32) -> FacetSplit {
        let glass = self.glass;
        let mut reflected = Vec3::ZERO;
        let mut transmitted = Vec3::ZERO;
        if greatest(self.dielectric) > 0.0 {
            reflected += self.dielectric * fresnel_dielectric(cosine, tables.specular_ior());
        }
        if self.metal_weight > 0.0 {
            reflected += self.metal.reflectance(cosine) * self.metal_weight;
        }
        if glass.weight > 0.0 {
            if self.is_thin {
                reflected += glass.reflection_tint * glass.weight;
            } else if !glass.is_straight {
                let f = fresnel_dielectric(cosine, glass.eta);
                let weight = glass.weight * glass.compensation;
                reflected += glass.reflection_tint * (f * weight);
                transmitted = glass.transmission_tint * ((1.0 - f) * weight);
            }
        }
        reflected *= self.coat_tint;
        let (r, t) = (mean(reflected), mean(transmitted));
        FacetSplit { reflected, transmitted, reflect_probability: if t > 0.0 { r / (r + t) } else { 1.0 } }
    }

    /// Chooses where light comes from; `u` and `v` are uniform in [0, 1). The weight of a direction that is no mirror's is that
    /// of all lobes there, see [`BsdfDraw::weighed`].
    pub fn draw(&self, tables: &impl Tables, u: f32, v: [f32; 2]) -> BsdfDraw {
        let chances = self.strategies;
        let mut left = u;
        if left < chances.subsurface {
            return BsdfDraw::of(BELOW, Vec3::ZERO, self.subsurface / chances.subsurface, DIFFUSE, false);
        }
        left -= chances.subsurface;
        if left < chances.diffuse {
            return self.toward(sample_cosine(v), DIFFUSE);
        }
        left -= chances.diffuse;
        if left < chances.coat {
            return self.draw_coat(tables, v);
        }
        left -= chances.coat;
        if left < chances.straight {
            return self.draw_straight(v);
        }
        left -= chances.straight;
        if left < self.thin_probability {
            return self.toward(through(sample_cosine(v)), DIFFUSE);
        }
        left -= self.thin_probability;
        if chances.facets > 0.0 {
            return self.draw_facets(tables, (left / chances.facets).clamp(0.0, 1.0), v);
        }
        BsdfDraw::none()
    }

    fn draw_coat(&self, tables: &impl Tables, v: [f32; 2]) -> BsdfDraw {
        let facets = self.coat_facets();
        if facets.is_smooth() {
            let f = self.layers.coat_weight * fresnel_dielectric(self.wo.z, tables.coat_ior());
            return self.mirror(mirrored(self.wo, Vec3::Z), Vec3::splat(f / self.strategies.coat));
        }
        let wi = mirrored(self.wo, facets.sample_visible(self.wo, v));
        // Below the horizon it would count as light through a wall or glass
        if wi.z <= 0.0 {
            return BsdfDraw::none();
        }
        self.toward(wi, GLOSSY)
    }

    #[inline]
    fn draw_straight(&self, v: [f32; 2]) -> BsdfDraw {
        if self.is_thin && !self.thin_facets.is_smooth() {
            let wi = mirrored(self.wo, self.thin_facets.sample_visible(self.wo, v));
            if wi.z <= 0.0 {
                return BsdfDraw::none();
            }
            return self.toward(through(wi), GLOSSY);
        }
        let share = self.glass.weight * self.coat_transmittance / self.strategies.straight;
        self.mirror(-self.wo, self.glass.transmission_tint * share)
    }

    fn draw_facets(&self, tables: &impl Tables, u: f32, v: [f32; 2]) -> BsdfDraw {
        let facets = self.base_facets();
        let is_smooth = facets.is_smooth();
        let mut h = Vec3::Z;
        if !is_smooth {
            h = facets.sample_visible(self.wo, v);
        }
        let split = self.split_at_facet(tables, self.wo.dot(h));
        let chance = self.strategies.facets;
        // Rounding may bring u to 1: where nothing is transmitted, all is reflected
        let is_reflected = u < split.reflect_probability || split.reflect_probability >= 1.0;
        let mut wi = mirrored(self.wo, h);
        let mut part = split.reflected / (chance * split.reflect_probability);
        if !is_reflected {
            let bent = refracted(self.wo, h, self.glass.eta);
            if !bent.exists {
                return BsdfDraw::none();
            }
            wi = bent.direction;
            part = split.transmitted / (chance * (1.0 - split.reflect_probability));
        }
        if is_smooth {
            return self.mirror(wi, part * self.coat_transmittance);
        }
        if (wi.z > 0.0) != is_reflected {
            return BsdfDraw::none();
        }
        self.toward(wi, GLOSSY)
    }

    /// A draw of a mirror lobe; `wi` on the side of `wo`.
    #[inline]
    pub fn mirror(&self, wi: Vec3, weight: Vec3) -> BsdfDraw {
        BsdfDraw::of(DIRECTION, Vec3::new(wi.x, wi.y, wi.z * self.side), weight, MIRROR, wi.z < 0.0)
    }

    /// A direction on the side of `wo`, without its weight.
    #[inline]
    fn toward(&self, local: Vec3, lobe: u32) -> BsdfDraw {
        let wi = local.normalize();
        BsdfDraw::of(DIRECTION, Vec3::new(wi.x, wi.y, wi.z * self.side), Vec3::ZERO, lobe, wi.z < 0.0)
    }
}

/// How light enters a scattering medium at a point: the factor T(ωi) / (π T̄).
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    layers: Layers,
    /// The tint of one pass through the coat.
    pub tint: Vec3,
    inverse_average: f32,
}

impl Entry {
    /// The factor of a surface point.
    pub fn new(tables: &impl Tables, parameters: &SurfaceParameters) -> Self {
        let p = parameters.clamped();
        let layers = Layers {
            specular_weight: p.specular_weight,
            specular_roughness: p.specular_roughness,
            coat_weight: p.coat_weight,
            coat_roughness: p.coat_roughness,
        };
        let average = layers.average_transmittance(tables);
        Self { layers, tint: p.coat_tint_one_way(), inverse_average: 1.0 / average }
    }

    /// T(ωi)/T̄ with the tint of one pass through the coat: the share of a radiance that enters.
    pub fn entering(&self, tables: &impl Tables, cos_i: f32) -> Vec3 {
        self.tint * (self.layers.transmittance(tables, cos_i.min(1.0)) * self.inverse_average)
    }
}

/// A direction at least [`LEAST_COSINE`] over the horizon.
#[inline]
fn lifted(wo: Vec3) -> Vec3 {
    if wo.z >= LEAST_COSINE {
        return wo;
    }
    unit_or(Vec3::new(wo.x, wo.y, LEAST_COSINE), Vec3::Z)
}

/// A direction on the other side of the surface.
#[inline]
fn through(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

/// The mean of a color's channels.
#[inline]
pub fn mean(c: Vec3) -> f32 {
    (c.x + c.y + c.z) * (1.0 / 3.0)
}
