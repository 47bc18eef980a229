//! The lights of a scene: a direction toward one of them from a point, and the density of drawing it.
//!
//! [`LightSet::sample`] selects one light in proportion to an estimate of its contribution at the point and draws a
//! direction toward it.
//! The query functions give the density with which it would have drawn a direction found otherwise (by a BSDF). They give
//! the same numbers as the sample itself, so that MIS can combine the two strategies [Veach & Guibas 1995].
//!
//! Each light is a type with these functions, most of them in `translucid-law`; rectangles, ellipses and triangles are here:
//!
//! ```text
//! every light       new(…) -> Option<Self>                      None if it sheds no light
//!                   importance(receiver) -> f32                 about its irradiance (luminance); 0 only if it brings none
//!                   power() -> f32                              emitted power (luminance), rather too high than too low
//! with a surface    draw(point, v) or sample(point, v)          a direction, its radiance, its density
//! (rectangle …)     pdf(point, on_light) -> f32                 the density of sample for a direction found otherwise
//!                   distance or intersect(origin, direction)    distance at which a ray meets the emitting side
//! from infinity     direction(v), pdf, radiance                 as above, by direction
//! delta lights      draw(point)                                 the one direction, which no ray meets by chance
//! ```
//!
//! `emitters.rs` puts them side by side in `PlacedLight`, `surfaces.rs` intersects them, and `tests/` holds them to the
//! same laws.
//!
//! Light from infinity, which is the environment and the discs of distant lights, adds up: radiance and density of one of
//! them are always those of all of them together.

mod bounds;
mod distribution;
mod ellipse;
mod emitters;
mod environment;
mod rectangle;
mod refracted;
mod selection;
mod surfaces;
mod tree;
mod triangle;
mod weights;

use glam::Vec3;
pub(crate) use translucid_law::luminance;
use translucid_law::{DistantLight, LightDraw, Receiver};
use translucid_scene::Scene;

use crate::ray::Geometry;

use emitters::Emitters;
pub(crate) use emitters::PlacedLight;
use environment::Environment;
pub(crate) use environment::{EnvironmentMap, Sky};
pub(crate) use rectangle::Rectangle;
use refracted::DeltaLights;
pub(crate) use refracted::refracted_pdf;
pub(crate) use selection::MOST_WEIGHED;
use selection::Selection;
use surfaces::Surfaces;
pub(crate) use tree::{LANE_WORDS, LightTree};

pub use selection::LightSelection;
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
    /// No direction found otherwise can meet the light.
    pub is_delta: bool,
    /// The emissive triangle, if it is one: its `radiance` is the triangle's mean.
    pub primitive: Option<u64>,
}

impl LightSample {
    fn new(direction: Vec3, distance: f32, radiance: Vec3, pdf: f32) -> Self {
        Self { direction, distance, radiance, pdf, is_delta: false, primitive: None }
    }

    fn delta(direction: Vec3, distance: f32, irradiance: Vec3) -> Self {
        Self { direction, distance, radiance: irradiance, pdf: 1.0, is_delta: true, primitive: None }
    }

    /// What a law has drawn, if it is something.
    fn of(draw: LightDraw) -> Option<Self> {
        let LightDraw { direction, distance, radiance, pdf } = draw;
        (pdf > 0.0).then(|| Self::new(direction, distance, radiance, pdf))
    }

    /// The same of a light that no ray meets.
    fn of_delta(draw: LightDraw) -> Option<Self> {
        (draw.pdf > 0.0).then(|| Self::delta(draw.direction, draw.distance, draw.radiance))
    }

    /// The one direction of a distant light that is no disc.
    fn at_infinity(light: &DistantLight) -> Self {
        Self::delta(light.direction, f32::INFINITY, light.irradiance)
    }

    /// Returns `true` if a contribution can be computed from it.
    fn is_usable(&self) -> bool {
        let directed = self.direction.is_finite() && self.distance >= 0.0;
        directed && self.pdf > 0.0 && self.pdf.is_finite() && self.radiance.is_finite()
    }
}

/// A light with a surface that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightHit {
    /// Distance along the ray \[L\].
    pub t: f32,
    /// Emitted radiance.
    pub radiance: Vec3,
    position: Vec3,
    /// Number of the light.
    light: usize,
}

impl LightHit {
    /// Solid-angle density with which [`LightSet::sample`] at a point with a normal makes the direction toward
    /// this hit, selection included.
    pub fn pdf(&self, lights: &LightSet, point: Vec3, normal: Vec3) -> f32 {
        let source = lights.emitters.sources.get(self.light);
        let density = source.map_or(0.0, |source| source.pdf(point, self.position));
        finite_product(lights.probability(&Receiver { point, normal }, self.light), density)
    }
}

/// All lights of a scene, ready to be sampled from any thread.
#[derive(Clone, Debug)]
pub struct LightSet {
    pub(crate) emitters: Emitters,
    pub(crate) selection: Selection,
    surfaces: Surfaces,
    delta: Option<DeltaLights>,
    /// The environment and the discs among the sources.
    pub(crate) infinite: Vec<usize>,
    pub(crate) environment: Option<usize>,
    environment_visible: bool,
    /// Cross section of the scene \[L²\].
    pub(crate) cross_section: f32,
}

impl LightSet {
    /// The lights of a scene, given its emissive triangles and its bounds (lowest and highest corner) \[L\].
    ///
    /// Lights that are black or have no size are left out.
    pub fn new(scene: &Scene, emissive: Vec<EmissiveTriangle>, scene_bounds: (Vec3, Vec3)) -> Self {
        let emitters = Emitters::new(scene, emissive);
        let cross_section = (scene_bounds.1 - scene_bounds.0).length_squared().max(f32::MIN_POSITIVE);
        let indices = |is_wanted: fn(&PlacedLight) -> bool| {
            let all = emitters.sources.iter().enumerate();
            all.filter(|(_, source)| is_wanted(source)).map(|(index, _)| index).collect::<Vec<_>>()
        };
        Self {
            selection: Selection::new(&emitters, cross_section, LightSelection::Automatic),
            surfaces: Surfaces::new(&emitters.sources),
            delta: DeltaLights::new(&emitters, cross_section),
            infinite: indices(PlacedLight::is_infinite),
            environment: indices(|source| matches!(source, PlacedLight::Environment(_))).pop(),
            environment_visible: scene.environment.is_some_and(|environment| environment.visible),
            cross_section,
            emitters,
        }
    }

    /// Looks for openings through which the environment shines into the rooms of a scene.
    pub(crate) fn look_for_openings(&mut self, geometry: &Geometry) {
        if let Some(environment) = self.environment_mut() {
            environment.look_for_openings(geometry);
        }
    }

    /// Takes the openings that the same environment has in the same geometry.
    pub(crate) fn keep_openings(&mut self, old: &mut Self) {
        if let (Some(new), Some(old)) = (self.environment_mut(), old.environment_mut()) {
            new.keep_openings(old);
        }
    }

    fn environment_mut(&mut self) -> Option<&mut Environment> {
        match self.emitters.sources.get_mut(self.environment?)? {
            PlacedLight::Environment(environment) => Some(environment),
            _ => None,
        }
    }

    /// Selects lights in the given way, for measuring.
    #[must_use]
    pub fn with_selection(mut self, way: LightSelection) -> Self {
        self.selection = Selection::new(&self.emitters, self.cross_section, way);
        self
    }

    /// Returns `true` if nothing sheds light.
    pub fn is_empty(&self) -> bool {
        self.emitters.len() == 0
    }

    /// Selects a light by `u` and draws a direction toward it by `v`, all in [0, 1).
    ///
    /// `normal` is the unit normal of the hemisphere from which light matters: lights and directions below
    /// its horizon may be left out. The zero vector stands for all directions.
    /// None if no light was found: the estimate is 0.
    pub fn sample(&self, point: Vec3, normal: Vec3, u: f32, v: [f32; 2]) -> Option<LightSample> {
        let receiver = Receiver { point, normal };
        let (light, probability) = self.selection.choose(&self.emitters, &receiver, f64::from(u))?;
        self.sample_of(&receiver, (light, probability), v)
    }

    /// Draws a direction toward a light that was selected with a probability.
    fn sample_of(
        &self,
        receiver: &Receiver,
        (light, probability): (usize, f32),
        v: [f32; 2],
    ) -> Option<LightSample> {
        let direction = match self.emitters.sources.get(light) {
            Some(PlacedLight::Environment(light)) => Some(light.sample(receiver, v)),
            Some(PlacedLight::Distant(light)) => light.is_disc().then(|| light.direction_of_disc(v)),
            _ => None,
        };
        let sample = match direction {
            Some(direction) => {
                let radiance = self.environment_radiance(direction);
                let pdf = self.infinite_pdf(receiver, (light, probability), direction);
                LightSample::new(direction, f32::INFINITY, radiance, pdf)
            }
            None => {
                let mut sample = self.emitters.sample(light, receiver.point, v)?;
                sample.pdf *= probability;
                sample
            }
        };
        sample.is_usable().then_some(sample)
    }

    /// Nearest light with a surface that a ray meets, on the side that emits, before `t_max`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<LightHit> {
        self.surfaces.nearest(&self.emitters.sources, (origin, direction), t_max, |_| true)
    }

    /// Finds the nearest hit among the lights that the camera sees: it looks through the others.
    pub fn intersect_visible(&self, origin: Vec3, direction: Vec3, t_max: f32) -> Option<LightHit> {
        self.surfaces.nearest(&self.emitters.sources, (origin, direction), t_max, |is_visible| is_visible)
    }

    /// Density with which `sample` at a point with a normal makes the direction toward `hit` on an emissive
    /// triangle with unit normal `hit_normal`, selection included \[1/sr\]; 0 if it does not emit to there.
    pub fn triangle_pdf(
        &self,
        primitive: u64,
        point: Vec3,
        normal: Vec3,
        hit: Vec3,
        hit_normal: Vec3,
    ) -> f32 {
        let Some((light, triangle)) = self.emitters.of_primitive(primitive) else { return 0.0 };
        let density = triangle.pdf(hit - point, hit_normal);
        finite_product(self.probability(&Receiver { point, normal }, light), density)
    }

    /// Radiance that arrives from infinity, which scattered paths see: environment and discs of distant lights.
    pub fn environment_radiance(&self, direction: Vec3) -> Vec3 {
        let radiance = |&index: &usize| match &self.emitters.sources[index] {
            PlacedLight::Environment(light) => light.radiance(direction),
            PlacedLight::Distant(light) => light.radiance(direction),
            _ => Vec3::ZERO,
        };
        self.infinite.iter().map(radiance).sum()
    }

    /// Radiance of the environment alone, which the camera sees behind everything.
    pub fn background_radiance(&self, direction: Vec3) -> Vec3 {
        match self.environment.map(|index| &self.emitters.sources[index]) {
            Some(PlacedLight::Environment(light)) => light.radiance(direction),
            _ => Vec3::ZERO,
        }
    }

    /// Density with which `sample` at a point with a normal makes a direction to infinity, selection included
    /// \[1/sr\].
    pub fn environment_pdf(&self, point: Vec3, normal: Vec3, direction: Vec3) -> f32 {
        let Some(&first) = self.infinite.first() else { return 0.0 };
        let receiver = Receiver { point, normal };
        self.infinite_pdf(&receiver, (first, self.probability(&receiver, first)), direction)
    }

    /// Returns `true` if the camera sees the environment.
    pub fn environment_visible(&self) -> bool {
        self.environment_visible
    }

    /// The density of all lights at infinity together, given the probability of one of them.
    fn infinite_pdf(&self, receiver: &Receiver, known: (usize, f32), direction: Vec3) -> f32 {
        let density = |&index: &usize| {
            let density = match &self.emitters.sources[index] {
                PlacedLight::Environment(light) => light.pdf(receiver, direction),
                PlacedLight::Distant(light) => light.pdf(direction),
                _ => 0.0,
            };
            if density == 0.0 {
                return 0.0;
            }
            let probability = if index == known.0 { known.1 } else { self.probability(receiver, index) };
            probability * density
        };
        self.infinite.iter().map(density).sum()
    }

    fn probability(&self, receiver: &Receiver, light: usize) -> f32 {
        self.selection.probability(&self.emitters, receiver, light)
    }
}

/// The product of a probability and a density, 0 where that is not finite: no sample has it either.
fn finite_product(probability: f32, density: f32) -> f32 {
    let product = probability * density;
    if product.is_finite() { product } else { 0.0 }
}

#[cfg(test)]
mod tests;
