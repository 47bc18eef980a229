//! The lights of a scene: which directions to try at a point, and how likely each was tried.
//!
//! [`LightSet::sample`] selects one light in proportion to an estimate of what it contributes at the point and
//! draws a direction toward it.
//! The query functions tell with which density it would have drawn a direction found otherwise (by a
//! BSDF); they give the same numbers as the sample itself, so that the two strategies can be combined
//! [Veach & Guibas 1995].
//!
//! All light from infinity, that is the environment and the discs of distant lights, adds up: wherever one of
//! them is asked for, radiance and density are those of all of them together.

mod beam;
mod directions;
mod distant;
mod distribution;
mod environment;
mod environment_map;
mod receiver;
mod rectangle;
mod selection;
mod sphere;
mod spot;
mod triangle;

use glam::Vec3;
use translucid_scene::{Light, Scene};

use beam::Beam;
use distant::Distant;
use environment::Environment;
use receiver::Receiver;
use rectangle::Rectangle;
use selection::{Odds, Selection};
use sphere::Sphere;
use spot::Spot;
use triangle::Mesh;

pub use triangle::EmissiveTriangle;

/// A direction to try for light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction toward the light.
    pub direction: Vec3,
    /// Distance to the light \[L\], infinite for lights at infinity.
    pub distance: f32,
    /// Radiance from the direction; of a delta light the irradiance on a surface that faces it.
    /// Either way BSDF × cosine × radiance / pdf estimates the reflected light.
    pub radiance: Vec3,
    /// Solid-angle density \[1/sr\], selection included; of a delta light the probability of its selection.
    pub pdf: f32,
    /// Whether no direction found otherwise can meet the light.
    pub is_delta: bool,
    /// The emissive triangle, if it is one: its `radiance` is the triangle's mean.
    pub primitive: Option<u32>,
}

impl LightSample {
    fn new(direction: Vec3, distance: f32, radiance: Vec3, pdf: f32) -> Self {
        Self { direction, distance, radiance, pdf, is_delta: false, primitive: None }
    }

    fn delta(direction: Vec3, distance: f32, irradiance: Vec3) -> Self {
        Self { direction, distance, radiance: irradiance, pdf: 1.0, is_delta: true, primitive: None }
    }

    /// Whether a contribution can be computed from it.
    fn is_usable(&self) -> bool {
        let directed = self.direction.is_finite() && self.distance >= 0.0;
        directed && self.pdf > 0.0 && self.pdf.is_finite() && self.radiance.is_finite()
    }
}

/// A rectangle or sphere light that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightHit {
    /// Distance along the ray \[L\].
    pub t: f32,
    /// Emitted radiance.
    pub radiance: Vec3,
    /// Whether the camera sees the light directly.
    pub visible: bool,
    position: Vec3,
    source: usize,
}

impl LightHit {
    /// Solid-angle density with which [`LightSet::sample`] at a point with a normal makes the direction toward
    /// this hit, selection included.
    #[must_use]
    pub fn pdf(&self, lights: &LightSet, point: Vec3, normal: Vec3) -> f32 {
        let density = match lights.sources.get(self.source) {
            Some(Source::Rectangle(rectangle)) => rectangle.pdf(point, self.position),
            Some(Source::Sphere(sphere)) => sphere.pdf(point),
            _ => 0.0,
        };
        let receiver = Receiver { point, normal };
        finite_product(lights.odds(&receiver).probability(self.source), density)
    }
}

/// Any light.
#[derive(Clone, Debug)]
enum Source {
    Rectangle(Rectangle),
    Sphere(Sphere),
    Distant(Distant),
    Spot(Spot),
    Beam(Beam),
    Mesh(Mesh),
    Environment(Environment),
}

impl Source {
    /// None if the light can shed no light.
    fn new(light: &Light) -> Option<Self> {
        match *light {
            Light::Rectangle { center, edge_x, edge_y, radiance, visible } => {
                Rectangle::new(center, edge_x, edge_y, radiance, visible).map(Self::Rectangle)
            }
            Light::Sphere { center, radius, radiance, visible } => {
                Sphere::new(center, radius, radiance, visible).map(Self::Sphere)
            }
            Light::Distant { direction, angular_radius, irradiance } => {
                Distant::new(direction, angular_radius, irradiance).map(Self::Distant)
            }
            Light::Spot { position, direction, intensity, inner_angle, outer_angle } => {
                Spot::new(position, direction, intensity, inner_angle, outer_angle).map(Self::Spot)
            }
            Light::Beam { origin, direction, radius, power } => {
                Beam::new(origin, direction, radius, power).map(Self::Beam)
            }
        }
    }

    /// Estimate of the irradiance (luminance) at a point; 0 only if the light cannot contribute.
    fn importance(&self, receiver: &Receiver) -> f32 {
        match self {
            Self::Rectangle(light) => light.importance(receiver),
            Self::Sphere(light) => light.importance(receiver),
            Self::Distant(light) => light.importance(receiver),
            Self::Spot(light) => light.importance(receiver),
            Self::Beam(light) => light.importance(receiver),
            Self::Mesh(light) => light.importance(receiver),
            Self::Environment(light) => light.importance(receiver),
        }
    }

    /// Power (luminance) that a scene of this cross section [L²] receives at most.
    fn power(&self, cross_section: f32) -> f32 {
        match self {
            Self::Rectangle(light) => light.power(),
            Self::Sphere(light) => light.power(),
            Self::Distant(light) => light.greatest_irradiance() * cross_section,
            Self::Spot(light) => light.power(),
            Self::Beam(light) => light.power(),
            Self::Mesh(light) => light.power(),
            Self::Environment(light) => {
                let everywhere = Receiver { point: Vec3::ZERO, normal: Vec3::ZERO };
                4.0 * light.importance(&everywhere) * cross_section
            }
        }
    }
}

/// What kind of light it is, if no ray can meet it.
pub(crate) fn kind_without_size(light: &Light) -> Option<&'static str> {
    match Source::new(light)? {
        Source::Spot(_) => Some("spot"),
        Source::Beam(_) => Some("beam"),
        Source::Distant(light) if !light.is_disc() => Some("distant"),
        _ => None,
    }
}

/// All lights of a scene, ready to be sampled from any thread.
#[derive(Clone, Debug)]
pub struct LightSet {
    sources: Vec<Source>,
    selection: Selection,
    /// Rectangles and spheres among the sources.
    surfaces: Vec<usize>,
    /// The environment and the discs among the sources.
    infinite: Vec<usize>,
    mesh: Option<usize>,
    environment: Option<usize>,
    environment_visible: bool,
}

impl LightSet {
    /// The lights of a scene, given its emissive triangles and its bounds (lowest and highest corner) \[L\].
    ///
    /// Lights that are black or have no size are left out.
    #[must_use]
    pub fn new(scene: &Scene, emissive: Vec<EmissiveTriangle>, scene_bounds: (Vec3, Vec3)) -> Self {
        let mut sources: Vec<Source> = scene.lights.iter().filter_map(Source::new).collect();
        sources.extend(Mesh::new(emissive).map(Source::Mesh));
        sources.extend(Environment::new(scene).map(Source::Environment));
        let cross_section = (scene_bounds.1 - scene_bounds.0).length_squared().max(f32::MIN_POSITIVE);
        let powers: Vec<f32> = sources.iter().map(|source| source.power(cross_section)).collect();
        let indices = |is_wanted: fn(&Source) -> bool| {
            (0..sources.len()).filter(|&index| is_wanted(&sources[index])).collect::<Vec<_>>()
        };
        Self {
            selection: Selection::new(&powers),
            surfaces: indices(|source| matches!(source, Source::Rectangle(_) | Source::Sphere(_))),
            infinite: indices(|source| match source {
                Source::Distant(light) => light.is_disc(),
                _ => matches!(source, Source::Environment(_)),
            }),
            mesh: indices(|source| matches!(source, Source::Mesh(_))).pop(),
            environment: indices(|source| matches!(source, Source::Environment(_))).pop(),
            environment_visible: scene.environment.is_some_and(|environment| environment.visible),
            sources,
        }
    }

    /// Whether nothing sheds light.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// Selects a light by `u` and draws a direction toward it by `v`, all in [0, 1).
    ///
    /// `normal` is the unit normal of the hemisphere from which light matters: lights and directions below
    /// its horizon may be left out. The zero vector stands for all directions.
    /// None if no light was found: the estimate is 0.
    #[must_use]
    pub fn sample(&self, point: Vec3, normal: Vec3, u: f32, v: [f32; 2]) -> Option<LightSample> {
        let receiver = Receiver { point, normal };
        let odds = self.odds(&receiver);
        let (index, probability, rest) = odds.choose(u)?;
        let sample = match &self.sources[index] {
            Source::Rectangle(light) => light.sample(point, v),
            Source::Sphere(light) => light.sample(point, v),
            Source::Spot(light) => light.sample(point),
            Source::Beam(light) => light.sample(point),
            Source::Mesh(light) => light.sample(point, rest, v),
            Source::Distant(light) if !light.is_disc() => Some(light.sample_direction()),
            Source::Distant(light) => {
                return self.infinite_sample(&receiver, &odds, light.sample_disc(v)?);
            }
            Source::Environment(light) => {
                return self.infinite_sample(&receiver, &odds, light.sample(&receiver, v));
            }
        };
        let mut sample = sample?;
        sample.pdf *= probability;
        sample.is_usable().then_some(sample)
    }

    /// Completes a direction that was drawn from one of the lights at infinity.
    fn infinite_sample(&self, receiver: &Receiver, odds: &Odds<'_>, direction: Vec3) -> Option<LightSample> {
        let radiance = self.environment_radiance(direction);
        let pdf = self.infinite_pdf(receiver, odds, direction);
        let sample = LightSample::new(direction, f32::INFINITY, radiance, pdf);
        sample.is_usable().then_some(sample)
    }

    /// Nearest rectangle or sphere light that a ray meets, on the side that emits, before `t_max`.
    #[must_use]
    pub fn intersect(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<LightHit> {
        self.nearest(origin, direction, t_max, |_| true)
    }

    /// The same among the lights that the camera sees: it looks through the others.
    #[must_use]
    pub fn intersect_visible(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<LightHit> {
        self.nearest(origin, direction, t_max, |is_visible| is_visible)
    }

    fn nearest(
        &self,
        origin: Vec3,
        direction: Vec3,
        t_max: f32,
        counts: fn(bool) -> bool,
    ) -> Option<LightHit> {
        let mut nearest: Option<LightHit> = None;
        for &source in &self.surfaces {
            let (t, radiance, visible) = match &self.sources[source] {
                Source::Rectangle(light) => {
                    (light.intersect(origin, direction), light.radiance, light.visible)
                }
                Source::Sphere(light) => (light.intersect(origin, direction), light.radiance, light.visible),
                _ => continue,
            };
            let limit = nearest.map_or(t_max, |hit| hit.t);
            if let Some(t) = t.filter(|&t| t < limit && counts(visible)) {
                nearest = Some(LightHit { t, radiance, visible, position: origin + direction * t, source });
            }
        }
        nearest
    }

    /// Density with which `sample` at a point with a normal makes the direction toward `hit` on an emissive
    /// triangle with unit normal `hit_normal`, selection included \[1/sr\]; 0 if it does not emit to there.
    #[must_use]
    pub fn triangle_pdf(
        &self,
        primitive: u32,
        point: Vec3,
        normal: Vec3,
        hit: Vec3,
        hit_normal: Vec3,
    ) -> f32 {
        let Some(index) = self.mesh else { return 0.0 };
        let Source::Mesh(mesh) = &self.sources[index] else { return 0.0 };
        let density = mesh.pdf(primitive, hit - point, hit_normal);
        finite_product(self.odds(&Receiver { point, normal }).probability(index), density)
    }

    /// Radiance that arrives from infinity: environment and discs of distant lights. This is what a path sees
    /// that was scattered.
    #[must_use]
    pub fn environment_radiance(&self, direction: Vec3) -> Vec3 {
        let radiance = |&index: &usize| match &self.sources[index] {
            Source::Environment(light) => light.radiance(direction),
            Source::Distant(light) => light.radiance(direction),
            _ => Vec3::ZERO,
        };
        self.infinite.iter().map(radiance).sum()
    }

    /// Radiance of the environment alone: what the camera sees behind everything.
    #[must_use]
    pub fn background_radiance(&self, direction: Vec3) -> Vec3 {
        match self.environment.map(|index| &self.sources[index]) {
            Some(Source::Environment(light)) => light.radiance(direction),
            _ => Vec3::ZERO,
        }
    }

    /// Density with which `sample` at a point with a normal makes a direction to infinity, selection included
    /// \[1/sr\].
    #[must_use]
    pub fn environment_pdf(&self, point: Vec3, normal: Vec3, direction: Vec3) -> f32 {
        if self.infinite.is_empty() {
            return 0.0;
        }
        let receiver = Receiver { point, normal };
        self.infinite_pdf(&receiver, &self.odds(&receiver), direction)
    }

    /// Whether the camera sees the environment.
    #[must_use]
    pub fn environment_visible(&self) -> bool {
        self.environment_visible
    }

    fn infinite_pdf(&self, receiver: &Receiver, odds: &Odds<'_>, direction: Vec3) -> f32 {
        let density = |&index: &usize| {
            let density = match &self.sources[index] {
                Source::Environment(light) => light.pdf(receiver, direction),
                Source::Distant(light) => light.pdf(direction),
                _ => 0.0,
            };
            odds.probability(index) * density
        };
        self.infinite.iter().map(density).sum()
    }

    fn odds(&self, receiver: &Receiver) -> Odds<'_> {
        self.selection.odds(&self.sources, |source| source.importance(receiver))
    }
}

/// The product of a probability and a density, 0 where that is no usable number: no sample has it either.
fn finite_product(probability: f32, density: f32) -> f32 {
    let product = probability * density;
    if product.is_finite() { product } else { 0.0 }
}

#[cfg(test)]
mod tests;
