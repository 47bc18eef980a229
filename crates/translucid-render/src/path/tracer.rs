//! The loop over a path's vertices.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_scene::{CameraVisibility, Material};

use super::emission::{add_emission, add_environment, add_light_in_the_way};
use super::shadow_catcher::missing_light;
use super::vertex::Vertex;
use crate::ray::{Hit, Ray, SurfacePoint};
use crate::sampling::{Reserved, Sampler};
use crate::subsurface::{ExitPoint, Subsurface, Tracer, TransportScratch, Transports};
use crate::surface;
use crate::surface::bsdf::{Bsdf, BsdfSample, LightBelow, SurfaceParameters};
use crate::world::{
    BlockPlace, Layer, PathState, PixelSample, PixelWidth, ShadowMedium, World, absorbed, absorption_behind,
    power_heuristic, straight_transmittance, weighed,
};

/// Scattering events after which paths of little throughput are ended at random.
const ROULETTE_AFTER: u32 = 3;

/// Probability with which a reflection that is followed beside light from below goes on at a surface, over its share of the
/// light.
///
/// The sky, and lamps, it meets in any case. With 1 nothing is gained.
const ROULETTE_BESIDE: f32 = 3.0;

/// Share of the light from which on both what a smooth clear surface reflects and what it lets through are followed.
///
/// Drawn at random, a lamp's mirror image in a glass is a few bright samples.
const LEAST_SPLIT: f32 = 0.01;

/// Traces paths; one for each thread, because it keeps scratch memory.
pub(crate) struct PathTracer<'a> {
    world: &'a World,
    transports: &'a Transports,
    scratch: TransportScratch<'a>,
    pixel_width: PixelWidth,
}

impl<'a> Tracer<'a> for PathTracer<'a> {
    fn scratch(&mut self) -> &mut TransportScratch<'a> {
        &mut self.scratch
    }

    fn follow(&mut self, path: &mut PathState, sampler: &mut Sampler) {
        while self.step(path, sampler) {}
    }

    fn shape_factor(&mut self, exit: &ExitPoint<'_>) -> Vec3 {
        self.transports.shape_factor(&self.world.scene, exit, &mut self.scratch.points)
    }

    fn pixel_width(&self) -> PixelWidth {
        self.pixel_width
    }
}

impl<'a> PathTracer<'a> {
    /// A tracer for pixels of a width.
    pub(crate) fn new(world: &'a World, transports: &'a Transports, pixel_width: PixelWidth) -> Self {
        Self { world, transports, scratch: TransportScratch::default(), pixel_width }
    }

    /// Light that arrives at the ray's origin along the ray.
    pub(crate) fn trace(&mut self, ray: Ray, sampler: &mut Sampler) -> PixelSample {
        let mut path = PathState::new(ray);
        self.follow(&mut path, sampler);
        path.sample
    }

    /// Traces the sample of a pixel in a block. Light that has entered below others in the block comes with
    /// [`finish_block`](Self::finish_block).
    pub(crate) fn trace_in_block(
        &mut self,
        ray: Ray,
        sampler: &mut Sampler,
        place: BlockPlace,
    ) -> PixelSample {
        let mut path = PathState::new(ray);
        path.in_block = Some(place);
        self.follow(&mut path, sampler);
        path.sample
    }

    /// Adds the light that the samples of a block share; some of it, if stopped.
    pub(crate) fn finish_block(&mut self, samples: &mut [PixelSample], stop: &AtomicBool) {
        self.scratch.finish_block(stop, |number, layer, light| layer.add(&mut samples[number], light));
    }

    /// Forgets a block that is not to be finished.
    pub(crate) fn drop_block(&mut self) {
        self.scratch.drop_block();
    }

    /// Number of the object that [`trace`](Self::trace) with the same random numbers sees first; `None` where that is a
    /// light, a shadow catcher or the background.
    pub(crate) fn first_object(&self, ray: Ray, sampler: &mut Sampler) -> Option<u32> {
        let world = self.world;
        let mut path = PathState::new(ray);
        loop {
            path.vertex += 1;
            sampler.start_vertex(path.vertex);
            let hit = world.geometry.closest(&path.ray)?;
            if world.lights.intersect_visible(path.ray.origin, path.ray.direction, hit.t).is_some() {
                return None;
            }
            let point = world.surface_point(&hit);
            let (_, material) = world.material(&point);
            match meeting(world, &path, &point, material, Choices(sampler.reserve())) {
                Meeting::Surface => return Some(point.object),
                Meeting::Passing if path.pass(&point, Vec3::ONE) => {}
                Meeting::Passing | Meeting::Shadow => return None,
            }
        }
    }

    /// Follows the ray to its end and draws the next one; false when the path is over.
    fn step(&mut self, path: &mut PathState, sampler: &mut Sampler) -> bool {
        let world = self.world;
        path.vertex += 1;
        sampler.start_vertex(path.vertex);
        let hit = world.geometry.closest(&path.ray);
        let t_max = hit.map_or(f32::INFINITY, |hit| hit.t);
        if add_light_in_the_way(world, path, t_max) {
            return false;
        }
        let Some(hit) = hit else {
            add_environment(world, path);
            return false;
        };
        path.throughput *= absorbed(path.absorption, hit.t);
        let point = world.surface_point(&hit);
        self.interact(path, &point, &hit, sampler)
    }

    /// Scatters the path at the surface that it has met; false when it is over.
    fn interact(
        &mut self,
        path: &mut PathState,
        point: &SurfacePoint,
        hit: &Hit,
        sampler: &mut Sampler,
    ) -> bool {
        let world = self.world;
        let (index, material) = world.material(point);
        let u = Choices(sampler.reserve());
        // Before it is passed: light samples of it bring all of its emission, too
        if matches!(meeting_where_opaque(path, material), Meeting::Surface) {
            add_emission(world, path, point, material, hit);
        }
        if let Some(goes_on) = pass_or_hide(world, path, point, material, u, sampler) {
            return goes_on;
        }
        let stated = surface::parameters_at(&world.scene, material, point);
        if path.soft && stated.clear_part() > 0.0 && u.of_clearness() < stated.clear_part() {
            return pass_clear(path, point, material, &stated);
        }
        let vertex = Vertex::new(world, path, point, &stated);
        let (surface, subsurface) = self.surface_as_seen(path, &vertex, stated);
        let mut bsdf =
            Bsdf::new(&surface, world.surfaces.of(index), vertex.frame.to_local(-path.ray.direction));
        if path.depth == 0 && path.sample.alpha == 0.0 {
            see_first(path, &vertex, bsdf.albedo());
        }
        let is_clear = path.is_mirrored && bsdf.is_clear();
        if !vertex.can_scatter() || !is_clear && !survives(path, || u.of_roulette()) {
            return false;
        }
        if is_clear && !vertex.is_depth_spent {
            let least = LEAST_SPLIT / path.throughput.max_element();
            if let Some([less, more]) =
                bsdf.mirrors().filter(|[less, _]| less.weight().max_element() >= least)
            {
                self.follow_beside(path, &vertex, &less, sampler);
                return vertex.follow(path, &more);
            }
        }
        let below = if path.is_mirrored { bsdf.split_below() } else { None };
        if !vertex.is_depth_spent && !bsdf.is_smooth_only() {
            self.add_direct_light(path, &vertex, &bsdf, sampler.next_4d());
        }
        self.choose(path, &vertex, (&bsdf, below), subsurface, sampler)
    }

    /// The surface at a point, and the medium below, as the path sees them.
    ///
    /// Each rule changes the parameters that the rules above it have left:
    ///
    /// | condition | change |
    /// |---|---|
    /// | the path has left a diffuse surface; probes on the disks of Cycles | every channel is Lambertian |
    /// | it is thin-walled | what is scattered leaves on both sides |
    /// | the path is [soft](crate::path) | no clear part, rough reflections |
    /// | its diffuse depth is spent; light may pass the body straight | no matte base |
    /// | its diffuse depth is spent; any other surface | a black base |
    /// | it arrives from outside | A is raised where entry points, or layers, may be brighter than the exit |
    fn surface_as_seen(
        &self,
        path: &PathState,
        vertex: &Vertex<'_>,
        stated: SurfaceParameters,
    ) -> (SurfaceParameters, Subsurface) {
        let scene = &self.world.scene;
        let transport = self.transports.of(vertex.index);
        let mut subsurface = transport.at(scene, vertex.material, vertex.point);
        if path.diffuse_depth > 0 && transport.is_lambertian_behind_diffuse() {
            subsurface.length = Vec3::ZERO;
        }
        let mut seen = stated.with_subsurface(subsurface.surface_albedo, subsurface.length.cmpgt(Vec3::ZERO));
        if vertex.material.geometry_thin_walled {
            seen = seen.scattered_to_both_sides(vertex.material.subsurface_scatter_anisotropy);
        }
        if path.soft {
            seen = seen.seen_softly();
        }
        if path.diffuse_depth >= scene.integrator.max_diffuse_depth {
            let keeps_body = vertex.can_be_passed && seen.metalness == 0.0;
            seen = if keeps_body { seen.without_matte() } else { seen.without_diffuse() };
        }
        if path.ray.direction.dot(vertex.normal) < 0.0 {
            transport.brighten(&mut seen);
        }
        (seen, subsurface)
    }

    /// Draws how the path goes on, and takes it there; false when it is over.
    fn choose(
        &mut self,
        path: &mut PathState,
        vertex: &Vertex<'_>,
        (bsdf, below): (&Bsdf<'_>, Option<LightBelow>),
        subsurface: Subsurface,
        sampler: &mut Sampler,
    ) -> bool {
        let v = sampler.next_4d();
        let mut drawn = bsdf.sample(v[0], [v[1], v[2]]);
        if vertex.is_depth_spent {
            drawn = drawn.filter(|drawn| match drawn {
                BsdfSample::Direction { lobe, transmitted, .. } => {
                    vertex.lets_straight_through(path, *lobe, *transmitted)
                }
                BsdfSample::Subsurface { .. } => true,
            });
        }
        if let Some(below) = below.filter(|below| v[3] < below.probability) {
            if let Some(drawn) = drawn {
                self.follow_beside(path, vertex, &drawn, sampler);
            }
            drawn = Some(BsdfSample::Subsurface { weight: below.weight });
        }
        match drawn {
            None => false,
            Some(BsdfSample::Subsurface { weight }) => {
                path.throughput *= weight;
                let exit = vertex.exit_point(path.ray.direction, subsurface);
                self.transports.scatter(self, self.world, path, &exit, sampler)
            }
            Some(direction) => vertex.follow(path, &direction),
        }
    }

    /// Follows a path that the surface reflects to its end, beside the one that goes on under it.
    ///
    /// If each sample drew either light from below or a reflection, the choice would be much of a glossy picture's noise.
    fn follow_beside(
        &mut self,
        path: &mut PathState,
        vertex: &Vertex<'_>,
        drawn: &BsdfSample,
        sampler: &Sampler,
    ) {
        let mut beside = path.beside();
        if vertex.follow(&mut beside, drawn) {
            self.follow(&mut beside, &mut sampler.clone());
        }
        path.sample = beside.sample;
    }

    /// Adds light from one sampled light, reflected or transmitted by a surface.
    fn add_direct_light(&self, path: &mut PathState, vertex: &Vertex<'_>, bsdf: &Bsdf<'_>, u: [f32; 4]) {
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
            absorption_behind(vertex.material, vertex.point, light.direction, path.absorption)
        };
        let medium = ShadowMedium { absorption, soft: vertex.soft, random: u[3] };
        let light = weighed(world.unoccluded(vertex.point, &light, medium), mis / light.pdf);
        let received = light * path.throughput;
        if received != Vec3::ZERO {
            path.add_to(path.layer_after(Layer::Surface(Vec3::ONE)), received * value.diffuse);
            path.add_to(path.layer_after(Layer::Surface(Vec3::ZERO)), received * value.specular);
        }
    }
}

/// How a path meets a surface that its ray hits.
enum Meeting {
    /// The surface scatters it.
    Surface,
    /// It goes on behind the surface.
    Passing,
    /// The camera sees only shadows there.
    Shadow,
}

fn meeting(
    world: &World,
    path: &PathState,
    point: &SurfacePoint,
    material: &Material,
    u: Choices,
) -> Meeting {
    let opacity = surface::opacity_at(&world.scene, material, point);
    if opacity < 1.0 && u.of_opacity() >= opacity {
        return Meeting::Passing;
    }
    meeting_where_opaque(path, material)
}

fn meeting_where_opaque(path: &PathState, material: &Material) -> Meeting {
    match material.camera_visibility {
        CameraVisibility::None if path.is_of_camera() => Meeting::Passing,
        // Also behind a body, which covers as much as it keeps
        CameraVisibility::Shadow if path.depth == 0 => Meeting::Shadow,
        _ => Meeting::Surface,
    }
}

/// Passes a surface that is not there, or hides it from the camera; returns whether the path goes on. `None` where the
/// path meets the surface.
fn pass_or_hide(
    world: &World,
    path: &mut PathState,
    point: &SurfacePoint,
    material: &Material,
    u: Choices,
    sampler: &mut Sampler,
) -> Option<bool> {
    match meeting(world, path, point, material, u) {
        Meeting::Surface => None,
        Meeting::Passing => Some(path.pass(point, Vec3::ONE)),
        Meeting::Shadow => {
            // Coverage counts as far as the surface is seen: a body that light passes may lie before it
            let seen = (path.throughput.element_sum() / 3.0).min(1.0);
            path.sample.alpha = 1.0 - seen * (1.0 - missing_light(world, path, point, sampler.next_4d()));
            Some(false)
        }
    }
}

/// Passes a clear surface without refraction, after a diffuse event with caustics off.
fn pass_clear(
    path: &mut PathState,
    point: &SurfacePoint,
    material: &Material,
    surface: &SurfaceParameters,
) -> bool {
    path.absorption = absorption_behind(material, point, path.ray.direction, path.absorption);
    path.pass(point, straight_transmittance(surface, point, path.ray.direction))
}

/// Keeps the first surface that the camera sees.
fn see_first(path: &mut PathState, vertex: &Vertex<'_>, albedo: Vec3) {
    path.has_met = true;
    path.sample.alpha = 1.0;
    path.sample.albedo = albedo;
    path.sample.normal = vertex.normal;
    // From the lens, even where the path has passed partly opaque surfaces
    path.sample.depth = vertex.point.position.distance(path.origin.point);
}

/// Random numbers for choices at a surface, made when they are needed.
#[derive(Clone, Copy)]
struct Choices(Reserved);

impl Choices {
    fn of_roulette(self) -> f32 {
        self.0.numbers()[1]
    }

    fn of_clearness(self) -> f32 {
        self.0.numbers()[2]
    }

    fn of_opacity(self) -> f32 {
        self.0.numbers()[3]
    }
}

/// Plays Russian roulette with the throughput; returns whether the path goes on.
///
/// No factor η² is needed where the index changes: the throughput carries basic radiance L/n², so refraction does not
/// change it (see [`bsdf`](crate::surface::bsdf)).
fn survives(path: &mut PathState, u: impl Fn() -> f32) -> bool {
    let survival = if std::mem::take(&mut path.is_beside) || path.is_mirrored && path.depth > 0 {
        let share = path.throughput.max_element() / path.sample.albedo.max_element();
        (ROULETTE_BESIDE * share).min(1.0)
    } else if path.depth < ROULETTE_AFTER {
        return true;
    } else {
        // More paths than in proportion: those that go on have less weight, and indirect light less noise
        path.throughput.max_element().sqrt().min(0.95)
    };
    if u() >= survival {
        return false;
    }
    path.throughput /= survival;
    true
}
