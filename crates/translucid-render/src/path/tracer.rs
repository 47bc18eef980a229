//! The path tracer: next-event estimation and multiple importance sampling at every vertex.
//!
//! ```text
//! loop
//!   follow the ray to the nearest surface or light; add its emission, weighted by MIS
//!   at a surface: add light from one sampled light, weighted by MIS
//!   draw what happens next:
//!     a direction            → go on from here
//!     subsurface scattering  → draw the entry point by a probe, add light from one sampled light there,
//!                              draw a cosine direction, go on from there
//!                              (or walk there through the volume, see `random_walk`)
//! ```
//!
//! With `caustics` off, clear surfaces let light that falls on a matte surface pass straight through, with
//! their Fresnel transmittance and color: shadow rays of matte surfaces pass, and so do paths from there
//! on. Later reflections of such *soft* paths are roughened. No energy is dropped, but no light is
//! focused. What shadow rays pass and what paths pass has to be the same for MIS to be right.

use glam::Vec3;
use translucid_scene::{Material, Scene};

use crate::light::{LightSample, LightSet};
use crate::ray::Ray;
use crate::ray::{Geometry, Hit, SurfacePoint};
use crate::render::film::PixelSample;
use crate::sampling::Frame;
use crate::sampling::Sampler;
use crate::subsurface::kernel::cut::Truncation;
use crate::subsurface::kernel::direction::{Directionality, Directions, Passage};
use crate::subsurface::kernel::tables::ProfileSource;
use crate::subsurface::normalization::Normalizer;
use crate::subsurface::transport::points::{Gatherer, Leaving, Scratch};
use crate::subsurface::transport::probes::{Entry, Exit, Found, Prober, Shareable};
use crate::subsurface::transport::shared::{self, Arrival, EntryLight, Kind, Pool, Waiting};
use crate::surface::bsdf::{Bsdf, BsdfSample, EntryBsdf, Lobe, SurfaceParameters};
use crate::surface::material::{self, Materials, Subsurface};
use crate::world::shadow::{self, Medium};

/// Least roughness of reflections that a diffusely scattered path sees with caustics off.
const ROUGHNESS_AFTER_DIFFUSE: f32 = 0.5;

/// Scattering events after which paths of little throughput are ended at random.
const ROULETTE_AFTER: u32 = 3;

/// Surfaces that a path may pass straight through in a row, against endless loops.
const MOST_PASSES: u32 = 256;

/// Light beyond this is cut off: that of a point light at a distance of 1e-7, say, which may shine with 1e12.
/// Products with what comes after it stay finite, and a black channel stays black.
const GREATEST_LIGHT: f32 = 1e26;

/// Everything that paths need to know, shared by all threads.
pub(crate) struct World {
    pub(crate) scene: Scene,
    pub(crate) geometry: Geometry,
    pub(crate) materials: Materials,
    pub(crate) lights: LightSet,
    pub(crate) axis_probes: [f32; 3],
    /// Points to gather light from in place of probes.
    pub(crate) points: Option<Gatherer>,
    /// What materials with a normalization are normalized by.
    pub(crate) normalizer: Option<Normalizer>,
}

impl World {
    pub(crate) fn material(&self, point: &SurfacePoint) -> (usize, &Material) {
        let index = self.scene.objects[point.object as usize].material;
        (index, &self.scene.materials[index])
    }
}

/// Traces paths; one for each thread, because it keeps scratch memory.
pub(crate) struct PathTracer<'a> {
    pub(crate) world: &'a World,
    prober: Prober,
    scratch: Scratch,
    pool: Pool<'a>,
    /// Width of a pixel over the distance of what it shows.
    pixel_angle: f32,
}

/// Which layer of the image a path brings light to: the first scattering event decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Layer {
    Emission,
    /// Reflected or transmitted by the surface; the share that is matte, per channel.
    Surface(Vec3),
    Subsurface,
}

impl Layer {
    fn add(self, sample: &mut PixelSample, light: Vec3) {
        match self {
            Self::Emission => sample.emission += light,
            Self::Surface(diffuse_share) => {
                sample.diffuse += light * diffuse_share;
                sample.specular += light * (1.0 - diffuse_share);
            }
            Self::Subsurface => sample.subsurface += light,
        }
    }
}

/// The last point at which the path was scattered, for MIS.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin {
    pub(crate) point: Vec3,
    /// Normal given to the light selection.
    pub(crate) normal: Vec3,
    /// Solid-angle density of the direction taken; infinite where lights could not be sampled instead.
    pub(crate) pdf: f32,
}

pub(crate) struct Path {
    pub(crate) ray: Ray,
    pub(crate) throughput: Vec3,
    layer: Layer,
    pub(crate) origin: Origin,
    depth: u32,
    pub(crate) diffuse_depth: u32,
    passes: u32,
    /// Whether the path left a matte surface with caustics off; see the head of the file.
    pub(crate) soft: bool,
    /// Number of the vertex, the camera's being 0.
    vertex: u32,
    /// Absorption coefficient of the clear medium around the ray [1/L].
    pub(crate) absorption: Vec3,
    sample: PixelSample,
    /// Number of the sample in its block, until its light under a surface is left to the pool.
    in_block: Option<usize>,
}

impl Path {
    fn new(ray: Ray) -> Self {
        Self {
            ray,
            throughput: Vec3::ONE,
            layer: Layer::Emission,
            origin: Origin { point: ray.origin, normal: Vec3::ZERO, pdf: f32::INFINITY },
            depth: 0,
            diffuse_depth: 0,
            passes: 0,
            soft: false,
            vertex: 0,
            absorption: Vec3::ZERO,
            sample: PixelSample::default(),
            in_block: None,
        }
    }

    /// Adds light of the given radiance at the path's end to its layer.
    fn add(&mut self, radiance: Vec3) {
        let light = self.throughput * radiance;
        self.add_to(self.layer, light);
    }

    pub(crate) fn add_to(&mut self, layer: Layer, light: Vec3) {
        layer.add(&mut self.sample, light);
    }

    /// The layer, given the kind of the event at hand.
    pub(crate) fn layer_after(&self, event: Layer) -> Layer {
        if self.layer == Layer::Emission { event } else { self.layer }
    }

    /// Goes on in a new direction.
    pub(crate) fn scatter(&mut self, event: Layer, ray: Ray, weight: Vec3, origin: Origin) {
        self.layer = self.layer_after(event);
        self.throughput *= weight;
        self.ray = ray;
        self.origin = origin;
        self.depth += 1;
        self.passes = 0;
    }

    /// Goes on behind the surface in the same direction; the MIS origin stays.
    pub(crate) fn pass(&mut self, point: &SurfacePoint, transmittance: Vec3) -> bool {
        self.throughput *= transmittance;
        self.ray = Ray::new(point.ray_origin(self.ray.direction), self.ray.direction);
        self.passes += 1;
        self.passes < MOST_PASSES && self.throughput != Vec3::ZERO
    }
}

impl<'a> PathTracer<'a> {
    pub(crate) fn new(world: &'a World) -> Self {
        let truncation = Truncation::new(world.scene.integrator.subsurface_tail);
        let prober = Prober::new(truncation, world.axis_probes);
        let half = 0.5 * world.scene.camera.horizontal_fov.to_radians();
        let pixel_angle = 2.0 * half.tan() / world.scene.film.width as f32;
        Self { world, prober, scratch: Scratch::default(), pool: Pool::new(), pixel_angle }
    }

    /// Light that arrives at the ray's origin along the ray.
    pub(crate) fn trace(&mut self, ray: Ray, sampler: &mut Sampler) -> PixelSample {
        let mut path = Path::new(ray);
        while self.step(&mut path, sampler) {}
        path.sample
    }

    /// The same for the rays of a block of pixels, whose samples go to `samples`: light that has entered below one
    /// serves the others, too.
    pub(crate) fn trace_block(
        &mut self,
        rays: impl Iterator<Item = (Ray, Sampler)>,
        samples: &mut Vec<PixelSample>,
    ) {
        for (number, (ray, mut sampler)) in rays.enumerate() {
            let mut path = Path::new(ray);
            path.in_block = Some(number);
            while self.step(&mut path, &mut sampler) {}
            samples.push(path.sample);
        }
        self.pool.resolve(|number, layer, light| layer.add(&mut samples[number], light));
    }

    /// Follows the ray to its end and draws the next one; false when the path is over.
    fn step(&mut self, path: &mut Path, sampler: &mut Sampler) -> bool {
        let world = self.world;
        path.vertex += 1;
        sampler.start_vertex(path.vertex);
        let hit = world.geometry.closest(&path.ray);
        let t_max = hit.map_or(f32::INFINITY, |hit| hit.t);
        if self.add_light_in_the_way(path, t_max) {
            return false;
        }
        let Some(hit) = hit else {
            self.add_environment(path);
            return false;
        };
        path.throughput *= shadow::absorbed(path.absorption, hit.t);
        let point = world.geometry.surface_point(&world.scene, &hit);
        self.interact(path, &point, &hit, sampler)
    }

    /// What happens at a surface.
    fn interact(&mut self, path: &mut Path, point: &SurfacePoint, hit: &Hit, sampler: &mut Sampler) -> bool {
        let world = self.world;
        let (index, material) = world.material(point);
        let u = sampler.reserve();
        let opacity = material::opacity_at(&world.scene, material, point);
        if opacity < 1.0 && u.numbers()[3] >= opacity {
            return path.pass(point, Vec3::ONE);
        }
        // Before a clear surface is passed: light samples of it bring all of its emission, too.
        self.add_emission(path, point, material, hit);
        let subsurface = material::subsurface_at(&world.scene, &world.materials, index, point);
        let mut surface = material::surface_at(&world.scene, material, point, &subsurface);
        if path.soft {
            let clear = surface.transmission_weight * (1.0 - surface.metalness);
            if clear > 0.0 && u.numbers()[2] < clear {
                return self.pass_clear(path, point, material, &surface);
            }
            surface.transmission_weight = 0.0;
            surface.specular_roughness = surface.specular_roughness.max(ROUGHNESS_AFTER_DIFFUSE);
            surface.coat_roughness = surface.coat_roughness.max(ROUGHNESS_AFTER_DIFFUSE);
        }
        if path.diffuse_depth >= world.scene.integrator.max_diffuse_depth {
            // A black matte base: light samples and paths then leave out the same.
            surface.subsurface_weight = 1.0;
            surface.subsurface_color = Vec3::ZERO;
            surface.subsurface_active = [false; 3];
        }
        let normal = material::shading_normal_at(&world.scene, material, point);
        if let Some(pairing) = world.materials.pairing(index)
            && path.ray.direction.dot(normal) < 0.0
        {
            pairing.brighten(&mut surface);
        }
        let is_matte = surface.metalness < 1.0 && surface.transmission_weight < 1.0;
        let soft = path.soft || (is_matte && !world.scene.integrator.caustics);
        let frame = Frame::from_normal(normal);
        let bsdf = Bsdf::new(&surface, world.materials.tables(index), frame.to_local(-path.ray.direction));
        if path.depth == 0 && path.sample.alpha == 0.0 {
            path.sample.alpha = 1.0;
            path.sample.albedo = bsdf.albedo();
            path.sample.normal = normal;
            // From the lens, also if surfaces that are partly opaque were passed.
            path.sample.depth = point.position.distance(path.origin.point);
        }
        if path.depth >= world.scene.integrator.max_depth || !survives(path, || u.numbers()[1]) {
            return false;
        }
        let vertex = Vertex { point, frame, normal, subsurface, material, soft };
        if !bsdf.is_smooth_only() {
            self.add_direct_light(path, &vertex, &bsdf, sampler.next_4d());
        }
        let v = sampler.next_4d();
        match bsdf.sample(v[0], [v[1], v[2]]) {
            None => false,
            Some(BsdfSample::Direction { wi, weight, diffuse_share, pdf, lobe, transmitted }) => {
                let layer = Layer::Surface(diffuse_share);
                let next = Next { wi, weight, pdf, layer, is_diffuse: lobe == Lobe::Diffuse, transmitted };
                self.follow(path, &vertex, &next)
            }
            Some(BsdfSample::Subsurface { weight }) => {
                path.throughput *= weight;
                self.scatter_below(path, &vertex, sampler)
            }
        }
    }

    /// Passes a clear surface without refraction, after a diffuse event with caustics off.
    fn pass_clear(
        &self,
        path: &mut Path,
        point: &SurfacePoint,
        material: &Material,
        surface: &SurfaceParameters,
    ) -> bool {
        path.absorption = shadow::absorption_behind(material, point, path.ray.direction);
        path.pass(point, shadow::straight_transmittance(surface, point, path.ray.direction))
    }

    /// Goes on in a direction drawn from the surface's BSDF.
    fn follow(&self, path: &mut Path, vertex: &Vertex<'_>, next: &Next) -> bool {
        let direction = vertex.frame.to_world(next.wi).normalize();
        let geometric = vertex.point.geometric_normal;
        let to = direction.dot(geometric);
        // The shading normal promised one side, the geometry has another: such light cannot be.
        if (-path.ray.direction.dot(geometric) * to < 0.0) != next.transmitted {
            return false;
        }
        if next.transmitted {
            path.absorption = shadow::absorption_behind(vertex.material, vertex.point, direction);
        }
        let origin = Origin {
            point: vertex.point.position,
            normal: vertex.light_normal(path.ray.direction),
            pdf: if next.pdf > 0.0 { next.pdf } else { f32::INFINITY },
        };
        let ray = Ray::new(vertex.point.ray_origin(direction), direction);
        path.diffuse_depth += u32::from(next.is_diffuse);
        // A mirror direction takes no part in MIS and sees clear bodies as they are.
        path.soft |= vertex.soft && next.pdf > 0.0;
        path.scatter(next.layer, ray, next.weight, origin);
        path.throughput != Vec3::ZERO
    }

    /// Light that enters the volume at a point of a triangle, on its outside: one sample of
    /// ∫ L T(ωi) cosθ / (π T̄) dω, as after an event under a surface that was seen.
    pub(crate) fn entering_light(
        &mut self,
        primitive: u32,
        position: Vec3,
        [x, y]: [u32; 2],
        index: u32,
    ) -> Vec3 {
        let world = self.world;
        let mut sampler = Sampler::new(world.scene.integrator.seed, x, y, index);
        let point = world.geometry.point_on(&world.scene, primitive, position);
        let (_, material) = world.material(&point);
        let entrance = Entrance {
            point: &point,
            normal: material::shading_normal_at(&world.scene, material, &point),
            geometric: point.geometric_normal,
            entry: self.entry(&point),
            directionality: Directionality::Radial,
        };
        let mut path = Path::new(Ray::new(point.position, -point.geometric_normal));
        let mut goes_on = self.enter(&mut path, &entrance, &mut sampler);
        while goes_on {
            goes_on = self.step(&mut path, &mut sampler);
        }
        path.sample.radiance()
    }

    /// What a surface lets enter.
    pub(crate) fn entry(&self, point: &SurfacePoint) -> EntryBsdf<'a> {
        let world = self.world;
        let (index, material) = world.material(point);
        // What lies below has been dealt with: only the surface counts here
        let source = world.materials.profile_source(index);
        let below = Subsurface { albedo: Vec3::ONE, length: Vec3::ONE, source };
        let surface = material::surface_at(&world.scene, material, point, &below);
        EntryBsdf::new(&surface, world.materials.tables(index))
    }

    /// Leaves the surface through the volume below by the sum over all points; false where there are none.
    fn gather_below(&mut self, path: &mut Path, vertex: &Vertex<'_>) -> bool {
        let Some(points) = &self.world.points else { return false };
        let tables = self.world.materials.profile_tables();
        let Some(gathered) = points.gather(tables, &vertex.leaving(), &mut self.scratch) else {
            return false;
        };
        let factor = Normalizer::factor_of(vertex.material, gathered.energy);
        path.add_to(path.layer_after(Layer::Subsurface), path.throughput * gathered.light * factor);
        true
    }

    /// Leaves the surface through the volume below: probe, light at the entry, cosine direction.
    fn scatter_below(&mut self, path: &mut Path, vertex: &Vertex<'_>, sampler: &mut Sampler) -> bool {
        if let ProfileSource::RandomWalk(medium) = vertex.subsurface.source {
            return self.walk_below(path, vertex, medium, sampler);
        }
        if self.gather_below(path, vertex) {
            return false;
        }
        let world = self.world;
        let side = if path.ray.direction.dot(vertex.point.geometric_normal) > 0.0 { -1.0 } else { 1.0 };
        let exit = Exit {
            point: vertex.point,
            material: world.material(vertex.point).0,
            subsurface: vertex.subsurface,
            importance: path.throughput,
        };
        let tables = world.materials.profile_tables();
        let entry = if let Some(number) = path.in_block.take()
            && world.materials.pairing(exit.material).is_none()
            && shared::can_share(tables, &vertex.subsurface, path.throughput)
        {
            let Some(shareable) = self.prober.sample_to_share(world, &exit, sampler) else { return false };
            if shareable.nearness.mean_radius() >= shared::LEAST_PIXELS * self.pixel_angle * path.sample.depth
            {
                self.share_below(path, vertex, shareable, side, number, sampler);
                return false;
            }
            let subsurface = vertex.subsurface;
            shareable.found.map(|found| Entry { hit: found.hit, weight: found.weight, subsurface })
        } else {
            self.prober.sample(world, &exit, sampler)
        };
        let Some(found) = entry else { return false };
        path.throughput *= found.weight;
        if let Some(normalizer) = &world.normalizer {
            let scratch = &mut self.scratch;
            path.throughput *= normalizer.factor(tables, vertex.material, &vertex.leaving(), scratch);
        }
        let point = world.geometry.surface_point(&world.scene, &found.hit);
        let (_, material) = world.material(&point);
        let entry = self.entry(&point);
        // Seen from inside an open mesh, light enters from inside, too.
        let normal = material::shading_normal_at(&world.scene, material, &point) * side;
        let geometric = point.geometric_normal * side;
        let passage = Passage {
            offset: vertex.point.position - point.position,
            entry_normal: normal,
            exit_normal: vertex.normal * side,
        };
        let directionality = Directions::new(tables, &found.subsurface).along(passage);
        let entrance = Entrance { point: &point, normal, geometric, entry, directionality };
        self.enter(path, &entrance, sampler)
    }

    /// Leaves the light of an exit to the pool, and what enters where its own probe has hit to all exits there.
    fn share_below(
        &mut self,
        path: &Path,
        vertex: &Vertex<'_>,
        Shareable { profiles, nearness, found }: Shareable<'a>,
        side: f32,
        sample: usize,
        sampler: &mut Sampler,
    ) {
        let world = self.world;
        let random = (sampler.fork() >> 40) as f32 * (1.0 / (1 << 24) as f32);
        let mut throughput = path.throughput;
        if let Some(normalizer) = &world.normalizer {
            let tables = world.materials.profile_tables();
            throughput *= normalizer.factor(tables, vertex.material, &vertex.leaving(), &mut self.scratch);
        }
        let entry = found.map(|found| self.light_of(path, &found, side, sampler));
        self.pool.push(Waiting {
            sample,
            kind: Kind {
                group: vertex.point.group,
                outside: side > 0.0,
                depth: path.depth,
                diffuse_depth: path.diffuse_depth,
                soft: path.soft,
                absorption: path.absorption.to_array().map(f32::to_bits),
            },
            position: vertex.point.position,
            normal: vertex.normal * side,
            throughput,
            layer: path.layer_after(Layer::Subsurface),
            albedo: vertex.subsurface.scattering(),
            directions: Directions::new(world.materials.profile_tables(), &vertex.subsurface),
            profiles,
            nearness,
            random,
            entry,
        });
    }

    /// The light that enters where a probe has hit.
    fn light_of(&mut self, path: &Path, found: &Found, side: f32, sampler: &mut Sampler) -> EntryLight {
        let world = self.world;
        let point = world.geometry.surface_point(&world.scene, &found.hit);
        let (_, material) = world.material(&point);
        let normal = material::shading_normal_at(&world.scene, material, &point) * side;
        let geometric = point.geometric_normal * side;
        let entry = self.entry(&point);
        let entrance =
            Entrance { point: &point, normal, geometric, entry, directionality: Directionality::Radial };
        let direct = self.entering_sample(path.absorption, &entrance, sampler.next_4d());
        // What the light is worth to the path that has found it decides how far it is followed. Others may see more of
        // a color: none is followed as if it were worth nothing.
        let worth = path.throughput * found.weight;
        let most = worth.max_element();
        let worth = if most > 1e-30 {
            worth.max(Vec3::splat(0.1 * most)) * (most.clamp(0.05, 1.0) / most)
        } else {
            Vec3::ONE
        };
        let mut onward = Path {
            throughput: worth,
            layer: Layer::Subsurface,
            sample: PixelSample::default(),
            in_block: None,
            ..*path
        };
        let mut indirect = Arrival::NONE;
        if let Some((direction, weight)) = self.head_off(&mut onward, &entrance, sampler.next_4d()) {
            onward.throughput *= weight;
            while self.step(&mut onward, sampler) {}
            indirect = Arrival { direction, light: onward.sample.radiance() / worth };
        }
        EntryLight {
            position: point.position,
            normal,
            contribution: found.contribution,
            arrivals: [direct.unwrap_or(Arrival::NONE), indirect],
        }
    }

    /// Goes on where light enters the volume: light from one sampled light, a cosine direction.
    fn enter(&self, path: &mut Path, entrance: &Entrance<'_>, sampler: &mut Sampler) -> bool {
        let directionality = &entrance.directionality;
        if let Some(arrival) = self.entering_sample(path.absorption, entrance, sampler.next_4d()) {
            let light = arrival.light * directionality.weight(arrival.direction) * path.throughput;
            path.add_to(path.layer_after(Layer::Subsurface), light);
        }
        let Some((direction, weight)) = self.head_off(path, entrance, sampler.next_4d()) else {
            return false;
        };
        path.throughput *= weight * directionality.weight(direction);
        path.throughput != Vec3::ZERO
    }

    /// Sets the path on its way in a cosine direction that light enters from; returns it and its weight, which the path
    /// does not have yet.
    fn head_off(&self, path: &mut Path, entrance: &Entrance<'_>, v: [f32; 4]) -> Option<(Vec3, Vec3)> {
        let Entrance { point, normal, geometric, ref entry, .. } = *entrance;
        let (wi, weight) = entry.sample([v[0], v[1]]);
        let direction = Frame::from_normal(normal).to_world(wi).normalize();
        if direction.dot(geometric) <= 0.0 {
            return None;
        }
        let origin = Origin { point: point.position, normal, pdf: EntryBsdf::pdf(wi.z) };
        path.diffuse_depth += 1;
        path.soft |= !self.world.scene.integrator.caustics;
        let ray = Ray::new(point.ray_origin(direction), direction);
        path.scatter(Layer::Subsurface, ray, Vec3::ONE, origin);
        (weight != Vec3::ZERO).then_some((direction, weight))
    }

    /// Light from one sampled light, reflected or transmitted by a surface.
    fn add_direct_light(&self, path: &mut Path, vertex: &Vertex<'_>, bsdf: &Bsdf<'_>, u: [f32; 4]) {
        let world = self.world;
        let normal = vertex.light_normal(path.ray.direction);
        let Some(light) = world.lights.sample(vertex.point.position, normal, u[0], [u[1], u[2]]) else {
            return;
        };
        let value = bsdf.eval(vertex.frame.to_local(light.direction));
        let geometric = vertex.point.geometric_normal;
        let same_side = -path.ray.direction.dot(geometric) * light.direction.dot(geometric) > 0.0;
        let shading_side = -path.ray.direction.dot(vertex.normal) * light.direction.dot(vertex.normal) > 0.0;
        if same_side != shading_side || (value.diffuse + value.specular) == Vec3::ZERO {
            return;
        }
        let mis = if light.is_delta { 1.0 } else { power_heuristic(light.pdf, value.pdf) };
        let absorption = if same_side {
            path.absorption
        } else {
            shadow::absorption_behind(vertex.material, vertex.point, light.direction)
        };
        let medium = Medium { absorption, soft: vertex.soft };
        let light = weighed(self.unoccluded(vertex.point, &light, medium), mis / light.pdf);
        let received = light * path.throughput;
        if received != Vec3::ZERO {
            path.add_to(path.layer_after(Layer::Surface(Vec3::ONE)), received * value.diffuse);
            path.add_to(path.layer_after(Layer::Surface(Vec3::ZERO)), received * value.specular);
        }
    }

    /// Light from one sampled light that enters the volume at a point, whatever its direction changes.
    fn entering_sample(&self, absorption: Vec3, entrance: &Entrance<'_>, u: [f32; 4]) -> Option<Arrival> {
        let Entrance { point, normal, geometric, ref entry, .. } = *entrance;
        let light = self.world.lights.sample(point.position, normal, u[0], [u[1], u[2]])?;
        let direction = light.direction;
        let cosine = direction.dot(normal);
        if cosine <= 0.0 || direction.dot(geometric) <= 0.0 {
            return None;
        }
        let mis = if light.is_delta { 1.0 } else { power_heuristic(light.pdf, EntryBsdf::pdf(cosine)) };
        let medium = Medium { absorption, soft: !self.world.scene.integrator.caustics };
        let light = weighed(self.unoccluded(point, &light, medium), mis / light.pdf) * entry.eval(cosine);
        Some(Arrival { direction, light })
    }

    /// Radiance of a light sample that reaches the point.
    pub(crate) fn unoccluded(&self, point: &SurfacePoint, light: &LightSample, medium: Medium) -> Vec3 {
        let world = self.world;
        let target = point.position + light.direction * light.distance;
        let radiance = match light.primitive {
            Some(primitive) => self.emitted_at(primitive, target),
            None => light.radiance,
        };
        if radiance == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let origin = point.ray_origin(light.direction);
        let (direction, length) = if light.distance.is_finite() {
            // Aimed anew: parallel to the old direction, a ray from beside the point would meet the light
            // beside the target, and at a slant early enough for the light to shadow itself.
            let (direction, whole) = (target - origin).normalize_and_length();
            // Ends short of the light, so that the light itself does not count as an obstacle.
            (direction, whole - (1e-4 * whole).max(point.offset))
        } else {
            (light.direction, f32::INFINITY)
        };
        if length <= 0.0 {
            return radiance;
        }
        // Paths end at rectangle and sphere lights, so what shadow rays bring has to end there, too.
        if world.lights.intersect(origin, direction, length).is_some() {
            return Vec3::ZERO;
        }
        radiance * shadow::transmittance(world, &Ray::segment(origin, direction, length), medium)
    }

    /// Emission of a triangle at a point of it, on average: none where the surface is not there.
    fn emitted_at(&self, primitive: u32, position: Vec3) -> Vec3 {
        let world = self.world;
        let point = world.geometry.point_on(&world.scene, primitive, position);
        let (_, material) = world.material(&point);
        let opacity = material::opacity_at(&world.scene, material, &point);
        material::emission_at(&world.scene, material, &point) * opacity
    }

    /// Emission of the surface that the path has met.
    fn add_emission(&self, path: &mut Path, point: &SurfacePoint, material: &Material, hit: &Hit) {
        if material.emission_luminance <= 0.0 || path.ray.direction.dot(point.geometric_normal) >= 0.0 {
            return;
        }
        let radiance = material::emission_at(&self.world.scene, material, point);
        let weight = if path.origin.pdf.is_finite() {
            let primitive = self.world.geometry.primitive(point.object, point.triangle);
            let Origin { point: from, normal, pdf } = path.origin;
            let position = self.world.geometry.position(hit);
            let light =
                self.world.lights.triangle_pdf(primitive, from, normal, position, point.geometric_normal);
            power_heuristic(pdf, light)
        } else {
            1.0
        };
        path.add(radiance * weight);
    }

    /// Adds an analytic light nearer than any surface; true if there is one.
    fn add_light_in_the_way(&self, path: &mut Path, t_max: f32) -> bool {
        let ray = &path.ray;
        let Origin { point, normal, pdf } = path.origin;
        let lights = &self.world.lights;
        let light = if path.depth == 0 {
            lights.intersect_visible(ray.origin, ray.direction, t_max)
        } else {
            lights.intersect(ray.origin, ray.direction, t_max)
        };
        let Some(light) = light else { return false };
        let weight =
            if pdf.is_finite() { power_heuristic(pdf, light.pdf(lights, point, normal)) } else { 1.0 };
        let absorbed = shadow::absorbed(path.absorption, light.t);
        if path.depth == 0 {
            path.sample.alpha = 1.0;
        }
        path.add(light.radiance * absorbed * weight);
        true
    }

    /// Adds the environment behind everything.
    fn add_environment(&self, path: &mut Path) {
        let lights = &self.world.lights;
        let Origin { point, normal, pdf } = path.origin;
        if path.depth == 0 && !lights.environment_visible() {
            return;
        }
        let direction = path.ray.direction;
        let radiance = if path.depth == 0 {
            lights.background_radiance(direction)
        } else {
            lights.environment_radiance(direction)
        };
        let weight = if pdf.is_finite() {
            power_heuristic(pdf, lights.environment_pdf(point, normal, direction))
        } else {
            1.0
        };
        if path.depth == 0 {
            path.sample.alpha = 1.0;
        }
        path.add(radiance * weight);
    }
}

/// A direction to go on in.
struct Next {
    /// Local direction.
    wi: Vec3,
    weight: Vec3,
    /// Solid-angle density, 0 for a mirror direction.
    pdf: f32,
    layer: Layer,
    is_diffuse: bool,
    transmitted: bool,
}

/// A point where light enters the volume.
struct Entrance<'a> {
    point: &'a SurfacePoint,
    /// Shading normal on the side that is seen.
    normal: Vec3,
    /// Geometric normal on that side.
    geometric: Vec3,
    entry: EntryBsdf<'a>,
    directionality: Directionality,
}

/// A surface point with what was worked out about it.
pub(crate) struct Vertex<'a> {
    pub(crate) point: &'a SurfacePoint,
    frame: Frame,
    /// Shading normal on the outside.
    normal: Vec3,
    pub(crate) subsurface: Subsurface,
    material: &'a Material,
    /// Whether light that falls here has come straight through clear surfaces.
    soft: bool,
}

impl Vertex<'_> {
    /// The point as one that light leaves.
    fn leaving(&self) -> Leaving {
        let SurfacePoint { position, geometric_normal: normal, group, .. } = *self.point;
        Leaving { position, normal, group, subsurface: self.subsurface }
    }

    /// The normal that light selection may rely on: none where light from both sides counts.
    fn light_normal(&self, incoming: Vec3) -> Vec3 {
        if self.material.transmission_weight.factor > 0.0 {
            Vec3::ZERO
        } else if incoming.dot(self.normal) > 0.0 {
            -self.normal
        } else {
            self.normal
        }
    }
}

/// Russian roulette on the throughput: true if the path goes on.
fn survives(path: &mut Path, u: impl Fn() -> f32) -> bool {
    if path.depth < ROULETTE_AFTER {
        return true;
    }
    let survival = path.throughput.max_element().min(0.95);
    if u() >= survival {
        return false;
    }
    path.throughput /= survival;
    true
}

/// Light times the weight of its sample, up to the greatest.
pub(crate) fn weighed(light: Vec3, weight: f32) -> Vec3 {
    (light * weight.min(GREATEST_LIGHT)).min(Vec3::splat(GREATEST_LIGHT))
}

/// Weight of a sample made with density `own` that could have been made with density `other`, too
/// [Veach & Guibas 1995, power heuristic with exponent 2].
pub(crate) fn power_heuristic(own: f32, other: f32) -> f32 {
    if !own.is_finite() {
        return 1.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weighed_light_is_finite_and_black_stays_black() {
        let light = Vec3::new(0.0, 1e12, 3e38);
        for weight in [0.0, 1e-30, 1.0, 1e30, f32::MAX, f32::INFINITY] {
            let weighed = weighed(light, weight);
            assert!(weighed.is_finite() && weighed.x == 0.0, "{weight}: {weighed}");
            assert!(weighed.cmple(Vec3::splat(GREATEST_LIGHT)).all());
        }
        assert_eq!(weighed(Vec3::splat(2.0), 3.0), Vec3::splat(6.0));
    }
}
