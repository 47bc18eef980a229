//! Parts of the renderer for tests and benches: single rays, lights and surfaces, which no picture asks for.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_scene::SceneError;

use crate::ray::Ray;
use crate::render::{FilmSums, Goal, LiveFilm, PreparedScene};
use crate::sampling::Sampler;
use crate::world::{PixelSample, PixelWidth};

pub use crate::light::{EmissiveTriangle, LightHit, LightSample, LightSelection, LightSet};
pub use crate::sampling::Frame;
pub use crate::surface::bsdf;

/// Traces one path into the scene: sample `index` of the pixel (0, 0) of the given seed, but along this ray. For measuring
/// the renderer against exact answers.
pub fn sample_ray(
    prepared: &PreparedScene,
    origin: Vec3,
    direction: Vec3,
    seed: u64,
    index: u32,
) -> PixelSample {
    let mut sampler = Sampler::new(seed, 0, 0, index);
    prepared.tracer(PixelWidth::default()).trace(Ray::new(origin, direction), &mut sampler)
}

/// Renders the view that the scene states until each pixel of its film has so many samples.
pub fn add_samples(prepared: &PreparedScene, film: &mut FilmSums, samples: u32) -> Result<(), SceneError> {
    let live = LiveFilm::new(std::mem::replace(film, FilmSums::new(1, 1)));
    let goal = Goal { samples: 0..samples, deadline: None };
    prepared.render(&prepared.view()?, &live, &goal, &|_| {}, &AtomicBool::new(false));
    *film = live.into_sums();
    Ok(())
}

/// Overrides the way in which lights are selected. The picture stays the same except for its noise.
pub fn select_lights(prepared: &mut PreparedScene, way: LightSelection) {
    let lights = &mut prepared.world_mut().lights;
    *lights = lights.clone().with_selection(way);
}

/// Sets the probabilities, in [0, 1], of probing along (tangent, tangent, normal) at an exit point.
/// Every choice has the same mean where no surface is parallel to all axes in use. Points that were set are forgotten.
pub fn set_probe_axes(prepared: &mut PreparedScene, probabilities: [f32; 3]) {
    prepared.set_probe_axes(probabilities);
}
