//! The renderer: a scene made ready, and the loop over samples and blocks of pixels.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use glam::Vec3;
use rayon::prelude::*;
use translucid_scene::{Scene, SubsurfaceMethod};

use crate::light::{EmissiveTriangle, LightSelection, LightSet};
use crate::path::tracer::{PathTracer, World};
use crate::ray::Geometry;
use crate::ray::Ray;
use crate::render::camera::CameraRays;
use crate::render::film::{FilmSums, PixelSample, layer};
use crate::render::fingerprint::{fingerprint, fingerprint_of_points};
use crate::render::pixel_blocks::{BlockGrid, PixelRect, tiles_of};
use crate::sampling::Sampler;
use crate::subsurface::normalization::Normalizer;
use crate::subsurface::transport::points::{PointCloud, PointProgress, PointsError};
use crate::subsurface::transport::probes::AXIS_PROBES;
use crate::surface::material::{self, Materials};

/// Samples that may wait until all before them are done, in pixels: 84 MB, or one sample of each pixel if that is more.
const MOST_PENDING: u64 = 1 << 20;

/// A scene made ready to render: the hierarchy built, lights and materials tabulated.
pub struct Renderer {
    world: World,
    camera: CameraRays,
}

/// When a rendering is done.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Samples that each pixel shall have in the end.
    pub samples: u32,
    /// When to stop even if they are not reached.
    pub deadline: Option<Instant>,
}

/// How far a rendering is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Camera paths done, those of an earlier run included.
    pub samples_done: u64,
    /// Camera paths in all.
    pub samples_total: u64,
}

/// Why a rendering ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every pixel has its samples.
    Finished,
    /// The deadline came first.
    TimeUp,
    /// The caller asked to stop.
    Interrupted,
}

impl Renderer {
    /// Prepares a scene.
    #[must_use]
    pub fn new(scene: Scene) -> Self {
        // Neither needs the other; the tree leaves threads idle now and then.
        let (geometry, materials) = rayon::join(|| Geometry::new(&scene.objects), || Materials::new(&scene));
        let lights = LightSet::new(&scene, emissive_triangles(&scene, &geometry), geometry.bounds());
        let camera = CameraRays::new(&scene.camera, &scene.film);
        let axis_probes = AXIS_PROBES;
        let mut world =
            World { scene, geometry, materials, lights, axis_probes, points: None, normalizer: None };
        match Normalizer::new(&world) {
            Ok(normalizer) => world.normalizer = normalizer,
            Err(error) => {
                let note = format!("subsurface_normalization is left out: {error}");
                world.materials.add_note(note);
            }
        }
        Self { world, camera }
    }

    /// The scene as it was given.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.world.scene
    }

    /// What a user should know of the scene as it was made ready, a sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        self.world.materials.profile_tables().notes()
    }

    /// A number that differs when the picture would: two runs with the same one may be joined.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        fingerprint(&self.world.scene)
    }

    #[cfg(test)]
    pub(crate) fn world(&self) -> &World {
        &self.world
    }

    /// Whether the scene asks for points that it does not have yet.
    #[must_use]
    pub fn wants_points(&self) -> bool {
        self.world.scene.integrator.subsurface_method == SubsurfaceMethod::PointBased
            && self.world.points.is_none()
    }

    /// A number that differs when the points would: clouds with the same one may stand in for each other.
    #[must_use]
    pub fn points_fingerprint(&self) -> u64 {
        fingerprint_of_points(&self.world.scene)
    }

    /// Makes the points of the point-based method on the current rayon pool; `None` when stopped.
    ///
    /// The points and their light do not depend on the number of threads.
    ///
    /// # Errors
    /// The points would take more than so many bytes of memory.
    pub fn make_points(
        &self,
        memory: u64,
        progress: &(dyn Fn(PointProgress) + Sync),
        stop: &AtomicBool,
    ) -> Result<Option<PointCloud>, PointsError> {
        PointCloud::new(&self.world, self.points_fingerprint(), memory, progress, stop)
    }

    /// Gathers light under surfaces from points, which are this scene's, in place of probing for it.
    ///
    /// A renderer without points, or whose points leave a subsurface group out, uses probes.
    #[must_use]
    pub fn with_points(mut self, points: &PointCloud) -> Self {
        self.world.points = Some(points.gatherer(&self.world));
        self
    }

    /// Adds samples to the film until the goal is reached, on the current rayon pool.
    ///
    /// Every pixel's samples are added in the order of their numbers, and who shares light with whom depends on their
    /// numbers alone, so the sums depend neither on the number of threads nor on where the work was interrupted.
    pub fn render(
        &self,
        film: &mut FilmSums,
        goal: Goal,
        progress: &(dyn Fn(Progress) + Sync),
        stop: &AtomicBool,
    ) -> Outcome {
        let pixels = u64::from(film.width) * u64::from(film.height);
        let total = pixels * u64::from(goal.samples);
        let done = AtomicU64::new(
            film.tiles
                .iter()
                .map(|tile| u64::from(tile.samples.min(goal.samples)) * tile.pixels.len() as u64)
                .sum(),
        );
        let late = || goal.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        let has_to_stop = || stop.load(Ordering::Relaxed) || late();
        let tracers = Mutex::new(Vec::new());
        let most = (MOST_PENDING / pixels.max(1)).max(1);
        while film.samples() < goal.samples {
            let first = film.samples();
            // A first picture comes soon, and later the threads seldom wait for each other.
            let count = most.min(u64::from(first / 2).clamp(1, 16)) as u32;
            let numbers = first..first.saturating_add(count).min(goal.samples);
            let grids: Vec<BlockGrid> =
                numbers.clone().map(|number| BlockGrid::new((film.width, film.height), number)).collect();
            let blocks: Vec<(usize, u32, usize)> = numbers
                .clone()
                .zip(&grids)
                .enumerate()
                .flat_map(|(place, (number, grid))| (0..grid.len()).map(move |block| (place, number, block)))
                .collect();
            let samples: Vec<Option<Vec<PixelSample>>> = blocks
                .par_iter()
                .map(|&(place, number, block)| {
                    let rect = grids[place].rect(block);
                    let is_wanted = tiles_of(rect, film.width).any(|tile| film.tiles[tile].samples <= number);
                    if !is_wanted || has_to_stop() {
                        return None;
                    }
                    let tracer = tracers.lock().unwrap_or_else(PoisonError::into_inner).pop();
                    let mut tracer = tracer.unwrap_or_else(|| PathTracer::new(&self.world));
                    let samples = self.trace_block(&mut tracer, rect, number);
                    tracers.lock().unwrap_or_else(PoisonError::into_inner).push(tracer);
                    let added = samples.len() as u64;
                    let samples_done = (done.fetch_add(added, Ordering::Relaxed) + added).min(total);
                    progress(Progress { samples_done, samples_total: total });
                    Some(samples)
                })
                .collect();
            let mut samples = samples.as_slice();
            for (number, grid) in numbers.zip(&grids) {
                let (own, others) = samples.split_at(grid.len());
                add_samples(film, number, grid, own);
                samples = others;
            }
            if stop.load(Ordering::Relaxed) {
                return Outcome::Interrupted;
            }
            if film.samples() < goal.samples && late() {
                return Outcome::TimeUp;
            }
        }
        Outcome::Finished
    }

    /// Traces sample `number` of every pixel of a rectangle, row by row.
    fn trace_block(
        &self,
        tracer: &mut PathTracer<'_>,
        (left, top, width, height): PixelRect,
        number: u32,
    ) -> Vec<PixelSample> {
        let pixels = (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y)));
        let rays = pixels.map(|(x, y)| {
            let mut sampler = Sampler::new(self.world.scene.integrator.seed, x, y, number);
            (self.camera.ray(x, y, sampler.next_4d()), sampler)
        });
        let mut samples = Vec::with_capacity((width * height) as usize);
        if self.world.scene.integrator.subsurface_sharing {
            tracer.trace_block(rays, &mut samples);
        } else {
            samples.extend(rays.map(|(ray, mut sampler)| tracer.trace(ray, &mut sampler)));
        }
        samples
    }

    /// Traces one path into the scene: sample `index` of the pixel (0, 0) of the given seed, but along
    /// this ray. For measuring the renderer against exact answers.
    #[must_use]
    pub fn sample_ray(&self, origin: Vec3, direction: Vec3, seed: u64, index: u32) -> PixelSample {
        let mut sampler = Sampler::new(seed, 0, 0, index);
        PathTracer::new(&self.world).trace(Ray::new(origin, direction), &mut sampler)
    }

    /// Selects lights in another way than what suits their number. For measuring: the picture stays the same but for
    /// its noise.
    #[must_use]
    pub fn with_light_selection(mut self, way: LightSelection) -> Self {
        self.world.lights = self.world.lights.with_selection(way);
        self
    }

    /// Sets the probabilities, in [0, 1], of probing along (tangent, tangent, normal) at an exit point.
    /// Every choice has the same mean where no surface is parallel to all axes in use.
    #[must_use]
    pub fn with_probe_axes(mut self, probabilities: [f32; 3]) -> Self {
        self.world.axis_probes = probabilities;
        self
    }
}

/// The triangles of all objects that emit light.
fn emissive_triangles(scene: &Scene, geometry: &Geometry) -> Vec<EmissiveTriangle> {
    let mut found = Vec::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let material = &scene.materials[object.material];
        if material.emission_luminance <= 0.0 {
            continue;
        }
        for number in 0..object.mesh.triangles.len() as u32 {
            let primitive = geometry.primitive(index as u32, number);
            let corners = object.mesh.triangles[number as usize];
            let vertices = corners.map(|corner| object.mesh.positions[corner as usize]);
            let center = vertices.iter().sum::<Vec3>() / 3.0;
            let point = geometry.point_on(scene, primitive, center);
            let radiance = material::emission_at(scene, material, &point);
            // A textured emitter may be dark in the middle of a triangle and bright beside it.
            let floor = if material.emission_color.texture.is_some() {
                Vec3::splat(1e-3 * material.emission_luminance)
            } else {
                Vec3::ZERO
            };
            found.push(EmissiveTriangle { vertices, radiance: radiance.max(floor), primitive });
        }
    }
    found
}

/// Adds sample `number` to the tiles that have all before it, where every block that a tile has a part in was traced.
fn add_samples(film: &mut FilmSums, number: u32, grid: &BlockGrid, blocks: &[Option<Vec<PixelSample>>]) {
    let rects: Vec<PixelRect> = (0..film.tiles.len()).map(|index| film.tile_rect(index)).collect();
    film.tiles.par_iter_mut().zip(rects).for_each(|(tile, (left, top, width, height))| {
        let corners = [left, left + width - 1].map(|x| [top, top + height - 1].map(|y| grid.block_of(x, y)));
        if tile.samples != number || corners.iter().flatten().any(|&block| blocks[block].is_none()) {
            return;
        }
        for (index, sums) in tile.pixels.iter_mut().enumerate() {
            let (x, y) = (left + index as u32 % width, top + index as u32 / width);
            let block = grid.block_of(x, y);
            let (block_left, block_top, block_width, _) = grid.rect(block);
            let place = (y - block_top) * block_width + (x - block_left);
            if let Some(samples) = &blocks[block] {
                add(sums, &samples[place as usize]);
            }
        }
        tile.samples = number + 1;
    });
}

/// Adds a sample to a pixel's sums. A sample that is not finite would spoil the pixel for good; it counts
/// as black (and is a defect: debug builds stop).
fn add(sums: &mut [f64; layer::COUNT], sample: &PixelSample) {
    debug_assert!(sample.radiance().is_finite(), "a sample is not finite: {sample:?}");
    if !sample.radiance().is_finite() {
        return;
    }
    for (sum, value) in sums.iter_mut().zip(sample.layers()) {
        *sum += f64::from(value);
    }
}
