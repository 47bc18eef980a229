//! The BSDF of a surface point: evaluation and sampling of all its lobes.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;

use super::conductor::MetalFresnel;
use super::dielectric::{fresnel_dielectric, reflect, refract, scaled_ior};
use super::ggx::Ggx;
use super::layers::{Layers, MaterialTables, coat_tint, coat_tint_one_way, sample_cosine};
use super::surface::SurfaceParameters;
use super::thin_wall::{Slab, ThinWall, roughness_through, through};

/// Below this cosine the direction seen from is bent up: the shading normal lies, or the ray grazes.
const MIN_COS: f32 = 1e-4;
/// Index steps below this do not bend light; F₀ is below 2.5e-7.
const SAME_INDEX: f32 = 1e-3;
/// Least albedo by which a lobe that exists is chosen, so that table errors cannot hide it.
const MIN_LOBE: f32 = 1e-4;

/// f·|cosθi| of a pair of directions [1/sr], without mirror lobes and without subsurface scattering.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsdfValue {
    /// Matte reflection.
    pub diffuse: Vec3,
    /// Reflection by coat, dielectric and metal, and rough transmission.
    pub specular: Vec3,
    /// Density with which [`Bsdf::sample`] makes the direction, choice of lobe included [1/sr].
    pub pdf: f32,
}

/// Kind of the lobe that a direction was drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Over the whole hemisphere.
    Diffuse,
    /// By rough facets.
    Glossy,
    /// By a mirror: no other technique can find this direction.
    Delta,
}

/// A decision of [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BsdfSample {
    /// Light comes from a direction.
    Direction {
        /// Where it comes from.
        wi: Vec3,
        /// f|cosθi| / pdf over all lobes that share the direction.
        weight: Vec3,
        /// Part of `weight` that is matte reflection, per channel in [0, 1].
        diffuse_share: Vec3,
        /// Density [1/sr], 0 for a mirror.
        pdf: f32,
        /// Which lobe made it.
        lobe: Lobe,
        /// Light crosses the surface.
        transmitted: bool,
    },
    /// Light comes from under the surface: go on with the profile and [`super::EntryBsdf`].
    Subsurface {
        /// T(ωo), tint of one pass through the coat and mixture weights, over the probability of this
        /// choice; 0 in the channels that are not active. Does not include A.
        weight: Vec3,
    },
}

impl BsdfSample {
    /// f|cosθi| / pdf.
    pub(crate) fn weight(&self) -> Vec3 {
        match *self {
            Self::Direction { weight, .. } | Self::Subsurface { weight } => weight,
        }
    }
}

/// Light from under a surface beside what the surface itself scatters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightBelow {
    /// Probability with which it is to be followed: twice that of drawing it, up to 1.
    pub(crate) probability: f32,
    /// Its weight then, as in [`BsdfSample::Subsurface`].
    pub(crate) weight: Vec3,
}

/// Probabilities of the sampling strategies; they sum to 1, or to 0 for a black surface.
#[derive(Clone, Copy, Debug, Default)]
struct Strategies {
    coat: f32,
    facets: f32,
    straight: f32,
    diffuse: f32,
    subsurface: f32,
}

impl Strategies {
    fn normalized(self) -> Self {
        let sum = self.coat + self.facets + self.straight + self.diffuse + self.subsurface;
        let scale = if sum >= f32::MIN_POSITIVE { 1.0 / sum } else { 0.0 };
        // A number whose inverse is infinite makes no weight
        let scaled = |chance: f32| if chance * scale < f32::MIN_POSITIVE { 0.0 } else { chance * scale };
        Self {
            coat: scaled(self.coat),
            facets: scaled(self.facets),
            straight: scaled(self.straight),
            diffuse: scaled(self.diffuse),
            subsurface: scaled(self.subsurface),
        }
    }
}

/// Clear part of a material.
#[derive(Clone, Copy, Debug)]
struct Glass {
    /// Mixture weight.
    weight: f32,
    /// Index of the other side over that of the side of `wo`.
    eta: f32,
    /// Inverse of the single-scattering albedo: scales both lobes to lose nothing [after Turquin 2019]. Of a thin wall that
    /// of transmission.
    compensation: f32,
    /// Tint of reflection; of a thin wall its compensated reflectance.
    reflection_tint: Vec3,
    /// Tint of a crossing, the coat's one-way tint included; of a thin wall its transmittance, and both ways.
    transmission_tint: Vec3,
    /// No step of the index, or a thin wall: light goes straight on.
    is_straight: bool,
}

/// Light at a facet: reflected and transmitted parts and the chance that reflection is sampled.
struct FacetSplit {
    reflected: Vec3,
    transmitted: Vec3,
    reflect_probability: f32,
}

/// The BSDF of a surface point seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'a> {
    layers: Layers<'a>,
    tables: &'a MaterialTables,
    // Directions are mirrored to the side of `wo`: wo.z > 0.
    wo: Vec3,
    side: f32,
    coat_ggx: Ggx,
    coat_weight: f32,
    coat_transmittance: f32,
    coat_tint: Vec3,
    base_ggx: Ggx,
    roughness: f32,
    // Weight of the opaque dielectric's reflection, of the metal, and the metal's reflectance.
    dielectric: Vec3,
    metal_weight: f32,
    metal: MetalFresnel,
    // Reflection between facets without the factor of wi: f = facet_exchange · deficit(wi).
    facet_exchange: Vec3,
    glass: Glass,
    thin: Option<ThinWall>,
    // A (…) T(ωo) / (π T̄), and whether T(ωi) follows the interface or is 1.
    matte: Vec3,
    matte_is_bare: bool,
    subsurface: Vec3,
    strategies: Strategies,
    albedo: Vec3,
}

impl<'a> Bsdf<'a> {
    /// The BSDF seen from `wo`; `wo.z` < 0 is from inside.
    ///
    /// `tables` hold the indices of refraction. An opaque surface seen from inside looks as from outside;
    /// of one that is partly clear, the opaque part is bare from inside, and the coat only tints. A thin-walled one has no
    /// inside.
    pub fn new(p: &SurfaceParameters, tables: &'a MaterialTables, wo: Vec3) -> Self {
        let p = p.clamped();
        let glass_weight = (1.0 - p.metalness) * p.transmission_weight;
        let is_inside = wo.z < 0.0 && glass_weight > 0.0 && p.thin_wall.is_none();
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let mut bsdf = Self::unlit(&p, tables, lifted(Vec3::new(wo.x, wo.y, wo.z * side)), side);
        if is_inside {
            bsdf.fill_from_inside(&p, glass_weight);
        } else {
            bsdf.fill_from_outside(&p, glass_weight);
        }
        bsdf
    }

    /// All that does not depend on the side, without lobes.
    fn unlit(p: &SurfaceParameters, tables: &'a MaterialTables, wo: Vec3, side: f32) -> Self {
        let layers = Layers::new(p, tables);
        Self {
            layers,
            tables,
            wo,
            side,
            coat_ggx: Ggx::from_roughness(p.coat_roughness),
            coat_weight: 0.0,
            coat_transmittance: 1.0,
            coat_tint: Vec3::ONE,
            base_ggx: Ggx::from_roughness(p.specular_roughness),
            roughness: p.specular_roughness,
            dielectric: Vec3::ZERO,
            metal_weight: 0.0,
            metal: MetalFresnel::new(p.base_color, p.specular_color),
            facet_exchange: Vec3::ZERO,
            glass: Glass {
                weight: 0.0,
                eta: 1.0,
                compensation: 1.0,
                reflection_tint: p.specular_color,
                transmission_tint: p.transmission_tint * coat_tint_one_way(p),
                is_straight: true,
            },
            thin: None,
            matte: Vec3::ZERO,
            matte_is_bare: false,
            subsurface: Vec3::ZERO,
            strategies: Strategies::default(),
            albedo: Vec3::ZERO,
        }
    }

    fn fill_from_outside(&mut self, p: &SurfaceParameters, glass_weight: f32) {
        let mu = self.wo.z;
        let opaque = (1.0 - p.metalness) * (1.0 - p.transmission_weight);
        let coat = self.layers.coat_reflectance(mu);
        let specular = self.layers.specular_reflectance(mu);
        let transmittance = self.layers.transmittance_under(coat, mu);
        self.coat_weight = p.coat_weight;
        self.coat_transmittance = 1.0 - coat;
        self.coat_tint = coat_tint(p);
        self.dielectric = p.specular_color * (opaque * p.specular_weight);
        self.fill_metal(p.metalness * p.specular_weight);
        let eta = scaled_ior(self.tables.specular_ior(), p.specular_weight);
        if p.thin_wall.is_some() {
            self.fill_slab(p, glass_weight, eta);
        } else {
            self.fill_glass(p, glass_weight, eta);
        }
        self.matte = self.coat_tint
            * p.matte_albedo()
            * (opaque * transmittance * FRAC_1_PI / self.layers.average_transmittance());
        let travelling_albedo = p.subsurface_albedo_active();
        let subsurface = opaque * p.subsurface_weight * transmittance;
        self.subsurface = coat_tint_one_way(p) * subsurface * active_mask(p);
        let matte_albedo = self.coat_tint * p.matte_albedo() * (opaque * transmittance);
        let subsurface_albedo = self.coat_tint * travelling_albedo * subsurface;
        let reflection = (p.specular_color * (opaque * specular) + self.metal_albedo()) * self.coat_tint;
        match p.thin_wall {
            None => self.choose(coat, reflection, matte_albedo, subsurface_albedo),
            Some(albedo) => {
                let passed = self.coat_tint * albedo * subsurface;
                self.choose_sides(coat, reflection, matte_albedo, passed);
            }
        }
    }

    /// The clear part of a thin-walled surface.
    #[cold]
    fn fill_slab(&mut self, p: &SurfaceParameters, weight: f32, eta: f32) {
        let mu = self.wo.z;
        let slab = Slab::new(mu, eta, p.transmission_tint);
        let roughness = roughness_through(p.specular_roughness, eta);
        let (facets, faces) = (Ggx::from_roughness(roughness), &self.base_ggx);
        let albedo = |ggx: &Ggx, roughness| {
            if ggx.is_smooth() { 1.0 } else { 1.0 - self.tables.metal.deficit(mu, roughness) }
        };
        // The coat takes more from a rough reflection than its share.
        let under_coat = self.coat_transmittance * self.layers.specular_reflectance(mu);
        let loss = self.layers.specular_loss(mu);
        let kept = if loss > 0.0 { (1.0 - loss / under_coat).max(0.5) } else { 1.0 };
        self.thin = Some(ThinWall { matte: Vec3::ZERO, probability: 0.0, facets });
        self.glass = Glass {
            weight,
            compensation: 1.0 / albedo(&facets, roughness),
            reflection_tint: slab.reflectance * p.specular_color
                / (kept * albedo(faces, p.specular_roughness)),
            transmission_tint: slab.transmittance * self.coat_tint,
            ..self.glass
        };
    }

    /// Chooses lobes as [`choose`](Self::choose) does, and divides diffuse light between the two sides; `passed` is the albedo
    /// of the other one.
    #[cold]
    fn choose_sides(&mut self, coat: f32, reflection: Vec3, matte: Vec3, passed: Vec3) {
        let Some(mut thin) = self.thin else { return };
        let reflected = self.glass.reflection_tint * self.coat_tint * self.glass.weight;
        self.choose(coat, reflection + reflected, matte + passed, Vec3::ZERO);
        let exchange = mean(self.facet_exchange) * PI * self.layers.average_metal_exchange();
        let all = mean(matte) + mean(passed) + exchange;
        if all > 0.0 {
            // Light samples look for the reflected part, too, however small it is.
            thin.probability = self.strategies.diffuse * (mean(passed) / all).min(0.99);
        }
        thin.matte = passed * (FRAC_1_PI / self.layers.average_transmittance());
        self.strategies.diffuse -= thin.probability;
        self.thin = Some(thin);
    }

    fn fill_from_inside(&mut self, p: &SurfaceParameters, glass_weight: f32) {
        let opaque = (1.0 - p.metalness) * (1.0 - p.transmission_weight);
        self.layers = self.layers.without_coat();
        self.fill_metal(p.metalness * p.specular_weight);
        self.fill_glass(p, glass_weight, 1.0 / scaled_ior(self.tables.specular_ior(), p.specular_weight));
        let bare = p.matte_albedo() + p.subsurface_albedo_active() * p.subsurface_weight;
        self.matte = bare * (opaque * FRAC_1_PI);
        self.matte_is_bare = true;
        self.choose(0.0, self.metal_albedo(), bare * opaque, Vec3::ZERO);
    }

    fn fill_metal(&mut self, weight: f32) {
        self.metal_weight = weight;
        if weight == 0.0 || self.base_ggx.is_smooth() {
            return;
        }
        let average = self.layers.average_metal_exchange();
        if average > 1e-6 {
            let out = self.layers.metal_exchange_under(1.0 - self.coat_transmittance, self.wo.z);
            let color =
                self.metal.multiple_scattering(1.0 - self.tables.metal.average_deficit(self.roughness));
            self.facet_exchange = self.coat_tint * color * (weight * out * FRAC_1_PI / average);
        }
    }

    /// About the albedo of a metal in single scattering.
    fn metal_albedo(&self) -> Vec3 {
        if self.metal_weight == 0.0 {
            return Vec3::ZERO;
        }
        let single = 1.0 - self.tables.metal.deficit(self.wo.z, self.roughness);
        // Rough facets are seen from all angles.
        let color = self.metal.eval(self.wo.z).lerp(self.metal.average(), self.roughness);
        color * (self.metal_weight * single)
    }

    fn fill_glass(&mut self, p: &SurfaceParameters, weight: f32, eta: f32) {
        let glass = &mut self.glass;
        glass.weight = weight;
        glass.eta = eta;
        glass.is_straight = (eta - 1.0).abs() < SAME_INDEX;
        if weight > 0.0 && !glass.is_straight {
            let (mu, table) = (self.wo.z, &self.tables.glass);
            let single = if eta > 1.0 {
                table.from_outside(mu, p.specular_roughness, p.specular_weight)
            } else {
                table.from_inside(mu, p.specular_roughness, p.specular_weight)
            };
            // The coat takes more from a rough reflection than its share.
            let kept = 1.0 - self.layers.specular_loss(mu) / (self.coat_transmittance * single);
            glass.compensation = 1.0 / (single * kept.max(0.5));
        }
    }

    /// Chooses lobes in proportion to their albedos at `wo`; the arguments are without the coat's shadow
    /// on specular lobes.
    fn choose(&mut self, coat: f32, reflection: Vec3, matte: Vec3, subsurface: Vec3) {
        let exchange = self.facet_exchange * (PI * self.layers.average_metal_exchange());
        let (glass, has_step) = (self.glass_albedo(), !self.glass.is_straight);
        let under_coat = self.coat_transmittance;
        let has_coat = self.coat_weight > 0.0 && self.tables.coat_ior() > 1.0;
        let has_facets = self.metal_weight > 0.0
            || self.dielectric.max_element() > 0.0 && self.tables.specular_ior() > 1.0
            || self.glass.weight > 0.0 && (has_step || self.thin.is_some());
        let facets = mean(reflection) + if has_step { mean(glass) } else { 0.0 };
        self.strategies = Strategies {
            coat: if has_coat { coat.max(MIN_LOBE) } else { 0.0 },
            facets: if has_facets { facets.max(MIN_LOBE) * under_coat } else { 0.0 },
            straight: if has_step { 0.0 } else { mean(glass) * under_coat },
            diffuse: mean(matte) + mean(exchange),
            subsurface: mean(subsurface),
        }
        .normalized();
        let under = (reflection + glass) * under_coat;
        self.albedo = (Vec3::splat(coat) + under + exchange + matte + subsurface).min(Vec3::ONE);
    }

    /// Approximate albedo of glass: reflection and transmission.
    fn glass_albedo(&self) -> Vec3 {
        let glass = &self.glass;
        if glass.weight == 0.0 {
            return Vec3::ZERO;
        }
        let f = match glass.eta {
            _ if glass.is_straight => 0.0,
            eta if eta > 1.0 => self.layers.specular_reflectance(self.wo.z),
            eta => fresnel_dielectric(self.wo.z, eta),
        };
        (glass.reflection_tint * self.coat_tint * f + glass.transmission_tint * (1.0 - f)) * glass.weight
    }

    /// Returns `true` if light sampling finds nothing: only mirror lobes, subsurface scattering or black.
    pub fn is_smooth_only(&self) -> bool {
        let s = &self.strategies;
        s.diffuse == 0.0
            && (s.coat == 0.0 || self.coat_ggx.is_smooth())
            && (s.facets == 0.0 || self.base_ggx.is_smooth())
    }

    /// The share of light that comes from below, of a sample on average; 0 in the channels that are not active. Does not
    /// include A.
    pub(crate) fn below(&self) -> Vec3 {
        if self.strategies.subsurface > 0.0 { self.subsurface } else { Vec3::ZERO }
    }

    /// About the hemispherical–directional reflectance, transmission and subsurface color included.
    pub fn albedo(&self) -> Vec3 {
        self.albedo
    }

    /// Value and density for light from `wi`.
    pub fn eval(&self, wi: Vec3) -> BsdfValue {
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        if wi.z > 0.0 {
            self.eval_reflection(wi)
        } else if wi.z < 0.0 {
            self.eval_transmission(wi)
        } else {
            BsdfValue::default()
        }
    }

    fn eval_reflection(&self, wi: Vec3) -> BsdfValue {
        let mut value = BsdfValue::default();
        let cos = wi.z;
        let h = (self.wo + wi).normalize_or(Vec3::Z);
        let coat_i = self.layers.coat_reflectance(cos);
        let under_coat = self.coat_transmittance.min(1.0 - coat_i);
        if self.strategies.coat > 0.0 && !self.coat_ggx.is_smooth() {
            let (shape, pdf) = facet_reflection(&self.coat_ggx, self.wo, wi, h);
            let f = self.coat_weight * fresnel_dielectric(self.wo.dot(h), self.tables.coat_ior());
            value.specular += Vec3::splat(f * shape);
            value.pdf += self.strategies.coat * pdf;
        }
        if self.strategies.facets > 0.0 && !self.base_ggx.is_smooth() {
            let (shape, pdf) = facet_reflection(&self.base_ggx, self.wo, wi, h);
            let split = self.split_at_facet(self.wo.dot(h));
            value.specular += split.reflected * (shape * under_coat);
            value.pdf += self.strategies.facets * split.reflect_probability * pdf;
        }
        if self.strategies.diffuse > 0.0 {
            if self.facet_exchange != Vec3::ZERO {
                value.specular += self.facet_exchange * (self.layers.metal_exchange_under(coat_i, cos) * cos);
            }
            let passed = if self.matte_is_bare { 1.0 } else { self.layers.transmittance_under(coat_i, cos) };
            value.diffuse = self.matte * (passed * cos);
            value.pdf += self.strategies.diffuse * cos * FRAC_1_PI;
        }
        value
    }

    fn eval_transmission(&self, wi: Vec3) -> BsdfValue {
        if let Some(thin) = &self.thin {
            return self.eval_through(thin, through(wi));
        }
        let glass = &self.glass;
        if glass.weight == 0.0 || glass.is_straight || self.base_ggx.is_smooth() {
            return BsdfValue::default();
        }
        // Normal of the facet that refracts wi to wo [Walter et al. 2007, eq. 16], on the side of wo.
        let sum = self.wo + wi * glass.eta;
        let Some(mut h) = sum.try_normalize() else { return BsdfValue::default() };
        if h.z < 0.0 {
            h = -h;
        }
        let (cos_o, cos_i) = (self.wo.dot(h), wi.dot(h));
        if cos_o <= 0.0 || cos_i >= 0.0 {
            return BsdfValue::default();
        }
        let split = self.split_at_facet(cos_o);
        let root = cos_o + glass.eta * cos_i;
        let jacobian = glass.eta * glass.eta * -cos_i / (root * root);
        let pdf = self.base_ggx.visible_density(self.wo, h) * jacobian;
        let shadowing = self.base_ggx.masking_shadowing(self.wo.z, wi.z) / self.base_ggx.masking(self.wo.z);
        if !pdf.is_finite() {
            return BsdfValue::default();
        }
        BsdfValue {
            diffuse: Vec3::ZERO,
            specular: split.transmitted * (shadowing * pdf * self.coat_transmittance),
            pdf: self.strategies.facets * (1.0 - split.reflect_probability) * pdf,
        }
    }

    /// Value and density for light from behind a thin wall; `wi` is its direction mirrored to this side.
    #[cold]
    fn eval_through(&self, thin: &ThinWall, wi: Vec3) -> BsdfValue {
        let cos = wi.z;
        let mut value = BsdfValue {
            diffuse: thin.matte * (self.layers.transmittance(cos) * cos),
            specular: Vec3::ZERO,
            pdf: thin.probability * cos * FRAC_1_PI,
        };
        if self.strategies.straight > 0.0 && !thin.facets.is_smooth() {
            let h = (self.wo + wi).normalize_or(Vec3::Z);
            let (shape, pdf) = facet_reflection(&thin.facets, self.wo, wi, h);
            value.specular = self.straight() * (shape * self.glass.compensation);
            value.pdf += self.strategies.straight * pdf;
        }
        value
    }

    /// Reflectance and transmittance of a base facet seen at `cos`, the coat's tints but not its shadow included.
    fn split_at_facet(&self, cos: f32) -> FacetSplit {
        let mut reflected = Vec3::ZERO;
        if self.dielectric.max_element() > 0.0 {
            reflected += self.dielectric * fresnel_dielectric(cos, self.tables.specular_ior());
        }
        if self.metal_weight > 0.0 {
            reflected += self.metal.eval(cos) * self.metal_weight;
        }
        let glass = &self.glass;
        let mut transmitted = Vec3::ZERO;
        if glass.weight > 0.0 {
            if self.thin.is_some() {
                reflected += glass.reflection_tint * glass.weight;
            } else if !glass.is_straight {
                let f = fresnel_dielectric(cos, glass.eta);
                let weight = glass.weight * glass.compensation;
                reflected += glass.reflection_tint * (f * weight);
                transmitted = glass.transmission_tint * ((1.0 - f) * weight);
            }
        }
        reflected *= self.coat_tint;
        let (r, t) = (mean(reflected), mean(transmitted));
        FacetSplit { reflected, transmitted, reflect_probability: if t > 0.0 { r / (r + t) } else { 1.0 } }
    }

    /// Chooses where light comes from; `None` where it would come from nowhere.
    ///
    /// `u` and `v` are uniform in [0, 1).
    pub fn sample(&self, u: f32, v: [f32; 2]) -> Option<BsdfSample> {
        let s = &self.strategies;
        let mut u = u;
        if take(&mut u, s.subsurface) {
            return Some(BsdfSample::Subsurface { weight: self.subsurface / s.subsurface });
        }
        if take(&mut u, s.diffuse) {
            return self.finish(sample_cosine(v), Lobe::Diffuse);
        }
        if take(&mut u, s.coat) {
            return self.sample_coat(v);
        }
        if take(&mut u, s.straight) {
            return self.sample_straight(v);
        }
        if let Some(thin) = &self.thin
            && take(&mut u, thin.probability)
        {
            return self.finish(through(sample_cosine(v)), Lobe::Diffuse);
        }
        if s.facets > 0.0 { self.sample_facets((u / s.facets).clamp(0.0, 1.0), v) } else { None }
    }

    /// Returns `true` if the surface is clear and smooth: mirrors alone scatter light.
    pub(crate) fn is_clear(&self) -> bool {
        let s = &self.strategies;
        let is_opaque = s.subsurface + s.diffuse + s.coat > 0.0;
        !is_opaque
            && self.glass.weight > 0.0
            && self.thin.is_none()
            && (s.facets == 0.0 || self.base_ggx.is_smooth())
    }

    /// Reflection and refraction by a [clear](Self::is_clear) surface, each with its share of the light, the smaller one first;
    /// `None` where there is only one.
    pub(crate) fn mirrors(&self) -> Option<[BsdfSample; 2]> {
        let split = self.split_at_facet(self.wo.z);
        let reflected = self.mirror(reflect(self.wo, Vec3::Z), split.reflected * self.coat_transmittance);
        let refracted = refract(self.wo, Vec3::Z, self.glass.eta)?;
        let refracted = self.mirror(refracted, split.transmitted * self.coat_transmittance);
        let is_split = split.reflect_probability > 0.0 && split.reflect_probability < 1.0;
        let both =
            if split.reflect_probability < 0.5 { [reflected, refracted] } else { [refracted, reflected] };
        is_split.then_some(both)
    }

    /// Leaves light from under the surface out of the choice of [`sample`](Self::sample), which then always draws a reflection
    /// if there is one, so that light from below can be followed beside it.
    ///
    /// `None`, and nothing changes, where no light comes from below.
    pub(crate) fn split_below(&mut self) -> Option<LightBelow> {
        let subsurface = self.strategies.subsurface;
        if subsurface == 0.0 {
            return None;
        }
        self.strategies = Strategies { subsurface: 0.0, ..self.strategies }.normalized();
        let probability = (2.0 * subsurface).min(1.0);
        Some(LightBelow { probability, weight: self.subsurface / probability })
    }

    fn sample_coat(&self, v: [f32; 2]) -> Option<BsdfSample> {
        if self.coat_ggx.is_smooth() {
            let f = self.coat_weight * fresnel_dielectric(self.wo.z, self.tables.coat_ior());
            return Some(self.mirror(reflect(self.wo, Vec3::Z), Vec3::splat(f / self.strategies.coat)));
        }
        let h = self.coat_ggx.sample_visible(self.wo, v);
        let wi = reflect(self.wo, h);
        // Below the horizon it would count as light through a wall or glass
        if wi.z <= 0.0 {
            return None;
        }
        self.finish(wi, Lobe::Glossy)
    }

    fn sample_straight(&self, v: [f32; 2]) -> Option<BsdfSample> {
        if let Some(thin) = &self.thin
            && !thin.facets.is_smooth()
        {
            let wi = reflect(self.wo, thin.facets.sample_visible(self.wo, v));
            return if wi.z > 0.0 { self.finish(through(wi), Lobe::Glossy) } else { None };
        }
        let glass = &self.glass;
        let weight =
            glass.transmission_tint * (glass.weight * self.coat_transmittance / self.strategies.straight);
        Some(self.mirror(-self.wo, weight))
    }

    /// The share of light that goes straight through, or, through a rough thin wall, about straight.
    fn straight(&self) -> Vec3 {
        self.glass.transmission_tint * (self.glass.weight * self.coat_transmittance)
    }

    /// The share of light that goes straight through a thin wall.
    pub fn straight_through_wall(&self) -> Vec3 {
        let is_smooth = self.thin.is_some_and(|thin| thin.facets.is_smooth());
        if is_smooth && self.strategies.straight > 0.0 { self.straight() } else { Vec3::ZERO }
    }

    fn sample_facets(&self, u: f32, v: [f32; 2]) -> Option<BsdfSample> {
        let is_smooth = self.base_ggx.is_smooth();
        let h = if is_smooth { Vec3::Z } else { self.base_ggx.sample_visible(self.wo, v) };
        let split = self.split_at_facet(self.wo.dot(h));
        let chosen = self.strategies.facets;
        // Rounding may bring u to 1: where nothing is transmitted, all is reflected.
        let is_reflected = u < split.reflect_probability || split.reflect_probability >= 1.0;
        let (wi, part) = if is_reflected {
            (reflect(self.wo, h), split.reflected / (chosen * split.reflect_probability))
        } else {
            (
                refract(self.wo, h, self.glass.eta)?,
                split.transmitted / (chosen * (1.0 - split.reflect_probability)),
            )
        };
        if is_smooth {
            return Some(self.mirror(wi, part * self.coat_transmittance));
        }
        if (wi.z > 0.0) != is_reflected {
            return None;
        }
        self.finish(wi, Lobe::Glossy)
    }

    /// A sample of a mirror lobe; `wi` on the side of `wo`.
    fn mirror(&self, wi: Vec3, weight: Vec3) -> BsdfSample {
        BsdfSample::Direction {
            wi: Vec3::new(wi.x, wi.y, wi.z * self.side),
            weight,
            diffuse_share: Vec3::ZERO,
            pdf: 0.0,
            lobe: Lobe::Delta,
            transmitted: wi.z < 0.0,
        }
    }

    /// A sample in the direction `wi`, on the side of `wo`, weighted by all lobes that reach it.
    fn finish(&self, wi: Vec3, lobe: Lobe) -> Option<BsdfSample> {
        let wi = wi.normalize();
        let value = if wi.z > 0.0 { self.eval_reflection(wi) } else { self.eval_transmission(wi) };
        if value.pdf.is_nan() || value.pdf <= 0.0 || !value.pdf.is_finite() {
            return None;
        }
        let f = value.diffuse + value.specular;
        let diffuse_share = Vec3::select(
            f.cmpgt(Vec3::ZERO),
            value.diffuse / f.max(Vec3::splat(f32::MIN_POSITIVE)),
            Vec3::ZERO,
        );
        Some(BsdfSample::Direction {
            wi: Vec3::new(wi.x, wi.y, wi.z * self.side),
            weight: f / value.pdf,
            diffuse_share,
            pdf: value.pdf,
            lobe,
            transmitted: wi.z < 0.0,
        })
    }
}

/// Returns `true` if `u` lies in [0, p); if not, it moves down by p.
fn take(u: &mut f32, p: f32) -> bool {
    let is_taken = *u < p;
    if !is_taken {
        *u -= p;
    }
    is_taken
}

/// f cosθi of a white facet lobe and its sampling density.
fn facet_reflection(ggx: &Ggx, wo: Vec3, wi: Vec3, h: Vec3) -> (f32, f32) {
    let density = ggx.density(h) / (4.0 * wo.z);
    let (lambda_o, lambda_i) = (ggx.lambda(wo.z), ggx.lambda(wi.z));
    (density / (1.0 + lambda_o + lambda_i), density / (1.0 + lambda_o))
}

/// A direction at least [`MIN_COS`] over the horizon.
fn lifted(wo: Vec3) -> Vec3 {
    if wo.z >= MIN_COS { wo } else { Vec3::new(wo.x, wo.y, MIN_COS).normalize_or(Vec3::Z) }
}

fn active_mask(p: &SurfaceParameters) -> Vec3 {
    Vec3::from_array(p.subsurface_active.map(|a| if a { 1.0 } else { 0.0 }))
}

fn mean(c: Vec3) -> f32 {
    (c.x + c.y + c.z) * (1.0 / 3.0)
}
