//! The loop over a path's vertices.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_scene::{CameraVisibility, Material};

use super::emission::{add_emission, add_environment, add_light_in_the_way};
use super::shadow_catcher::missing_light;
use crate::ray::{Hit, Ray, SurfacePoint};
use crate::sampling::{Frame, Reserved, Sampler};
use crate::subsurface::{ExitPoint, SubsurfaceSet, Tracing, TransportScratch};
use crate::surface;
use crate::surface::bsdf::{Bsdf, BsdfSample, Lobe, SurfaceParameters};
use crate::world::{
    BlockPlace, Layer, Origin, PathState, PixelSample, PixelWidth, ShadowMedium, World, absorbed,
    absorption_behind, power_heuristic, straight_transmittance, weighed,
};

/// Scattering events after which paths of little throughput are ended at random.
const ROULETTE_AFTER: u32 = 3;

/// Traces paths; one for each thread, because it keeps scratch memory.
pub(crate) struct PathTracer<'a> {
    world: &'a World,
    subsurface: &'a SubsurfaceSet,
    scratch: TransportScratch<'a>,
    pixel_width: PixelWidth,
}

impl<'a> Tracing<'a> for PathTracer<'a> {
    fn scratch(&mut self) -> &mut TransportScratch<'a> {
        &mut self.scratch
    }

    fn follow(&mut self, path: &mut PathState, sampler: &mut Sampler) {
        while self.step(path, sampler) {}
    }

    fn shape_factor(&mut self, exit: &ExitPoint<'_>) -> Vec3 {
        self.subsurface.shape_factor(&self.world.scene, exit, &mut self.scratch.points)
    }

    fn shape_factor_of(&self, exit: &ExitPoint<'_>, energy: Vec3) -> Vec3 {
        SubsurfaceSet::shape_factor_of(&self.world.scene, exit, energy)
    }

    fn pixel_width(&self) -> PixelWidth {
        self.pixel_width
    }
}

impl<'a> PathTracer<'a> {
    /// A tracer for pixels of a width.
    pub(crate) fn new(world: &'a World, subsurface: &'a SubsurfaceSet, pixel_width: PixelWidth) -> Self {
        Self { world, subsurface, scratch: TransportScratch::default(), pixel_width }
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

    /// Meets a surface: emission, light from one sampled light, the next direction.
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

        // Pass surfaces that are not there
        let opacity = surface::opacity_at(&world.scene, material, point);
        if opacity < 1.0 && u.of_opacity() >= opacity {
            return path.pass(point, Vec3::ONE);
        }

        // Show the camera what it is to see, if that is not the surface
        if path.depth == 0 && material.camera_visibility != CameraVisibility::Surface {
            if material.camera_visibility == CameraVisibility::None {
                return path.pass(point, Vec3::ONE);
            }
            // As far as it is seen: a body that light passes may lie before it
            let seen = (path.throughput.element_sum() / 3.0).min(1.0);
            path.sample.alpha = 1.0 - seen * (1.0 - missing_light(world, path, point, sampler.next_4d()));
            return false;
        }

        // Add emission before a clear surface is passed: light samples of it bring all of its emission, too
        add_emission(world, path, point, material, hit);

        // Evaluate the material as this path sees it
        let normal = surface::shading_normal_at(&world.scene, material, point);
        let normal = surface::facing(normal, point.geometric_normal, -path.ray.direction);
        let mut subsurface = self.subsurface.at(&world.scene, index, point);
        if path.diffuse_depth > 0 && self.subsurface.transports()[index].is_lambertian_behind_diffuse() {
            subsurface.length = Vec3::ZERO;
        }
        let mut surface = surface::parameters_at(&world.scene, material, point)
            .with_subsurface(subsurface.surface_albedo, subsurface.length.cmpgt(Vec3::ZERO));
        if path.soft {
            let clear = surface.transmission_weight * (1.0 - surface.metalness);
            if clear > 0.0 && u.of_clearness() < clear {
                return pass_clear(path, point, material, &surface);
            }
            surface = surface.seen_softly();
        }
        let may_pass = world.media.of(index).is_some();
        if path.diffuse_depth >= world.scene.integrator.max_diffuse_depth {
            surface = if may_pass && surface.metalness == 0.0 {
                without_matte(surface)
            } else {
                without_diffuse(surface)
            };
        }
        if path.ray.direction.dot(normal) < 0.0 {
            self.subsurface.brighten(index, &mut surface);
        }
        let is_matte = surface.metalness < 1.0 && surface.transmission_weight < 1.0;
        let soft = path.soft || (is_matte && !world.scene.integrator.caustics);
        let frame = Frame::from_normal(normal);
        let bsdf = Bsdf::new(&surface, world.surfaces.of(index), frame.to_local(-path.ray.direction));
        if path.depth == 0 && path.sample.alpha == 0.0 {
            see_first(path, point, normal, bsdf.albedo());
        }

        // End the path by its depth, unless it may pass a body straight, or by Russian roulette
        let is_over = path.depth >= world.scene.integrator.max_depth;
        if (is_over && !may_pass) || !survives(path, || u.of_roulette()) {
            return false;
        }

        // Add light from one sampled light
        let vertex = Vertex { point, frame, normal, material, soft };
        if !is_over && !bsdf.is_smooth_only() {
            self.add_direct_light(path, &vertex, &bsdf, sampler.next_4d());
        }

        // Draw the next direction from the BSDF
        let v = sampler.next_4d();
        let mut drawn = bsdf.sample(v[0], [v[1], v[2]]);
        if is_over && matches!(drawn, Some(BsdfSample::Direction { .. })) {
            drawn = None;
        }
        if path.depth == 0
            && let Some(below) = bsdf.sample_below(v[0])
        {
            if let Some(drawn) = drawn {
                self.follow_beside(path, &vertex, &drawn, sampler);
            }
            drawn = Some(below);
        }
        match drawn {
            None => false,
            Some(BsdfSample::Subsurface { weight }) => {
                path.throughput *= weight;
                let side = if path.ray.direction.dot(point.geometric_normal) > 0.0 { -1.0 } else { 1.0 };
                let exit = ExitPoint { point, material: index, normal, side, subsurface };
                let transport = &self.subsurface.transports()[index];
                transport.scatter(self, world, path, &exit, sampler)
            }
            Some(direction) => follow_surface(path, &vertex, &direction),
        }
    }

    /// Follows a path that the surface reflects to its end, beside the one that goes on under it.
    ///
    /// Light from below is most of what the camera sees of a translucent surface. If each sample drew either that or a
    /// reflection, the choice would be much of a glossy picture's noise.
    fn follow_beside(
        &mut self,
        path: &mut PathState,
        vertex: &Vertex<'_>,
        drawn: &BsdfSample,
        sampler: &Sampler,
    ) {
        let mut beside = path.beside();
        if follow_surface(&mut beside, vertex, drawn) {
            self.follow(&mut beside, &mut sampler.clone());
        }
        path.sample = beside.sample;
    }

    /// Light from one sampled light, reflected or transmitted by a surface.
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
            absorption_behind(vertex.material, vertex.point, light.direction)
        };
        let medium = ShadowMedium { absorption, soft: vertex.soft };
        let light = weighed(world.unoccluded(vertex.point, &light, medium), mis / light.pdf);
        let received = light * path.throughput;
        if received != Vec3::ZERO {
            path.add_to(path.layer_after(Layer::Surface(Vec3::ONE)), received * value.diffuse);
            path.add_to(path.layer_after(Layer::Surface(Vec3::ZERO)), received * value.specular);
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
    path.absorption = absorption_behind(material, point, path.ray.direction);
    path.pass(point, straight_transmittance(surface, point, path.ray.direction))
}

/// A surface with a black matte base: light samples and paths then leave out the same.
fn without_diffuse(surface: SurfaceParameters) -> SurfaceParameters {
    SurfaceParameters {
        subsurface_weight: 1.0,
        surface_albedo: Vec3::ZERO,
        subsurface_active: [false; 3],
        ..surface
    }
}

/// A surface without its matte base above a body that light may pass straight.
fn without_matte(surface: SurfaceParameters) -> SurfaceParameters {
    let surface_albedo = surface.subsurface_albedo_active();
    SurfaceParameters { base_color: Vec3::ZERO, surface_albedo, ..surface }
}

/// Keeps what the camera sees first.
fn see_first(path: &mut PathState, point: &SurfacePoint, normal: Vec3, albedo: Vec3) {
    path.sample.alpha = 1.0;
    path.sample.albedo = albedo;
    path.sample.normal = normal;
    // From the lens, also if surfaces that are partly opaque were passed.
    path.sample.depth = point.position.distance(path.origin.point);
}

/// Random numbers that decide what a path sees of a surface, made when they are needed.
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

/// Goes on in a direction drawn from the surface's BSDF; false where the path is over.
fn follow_surface(path: &mut PathState, vertex: &Vertex<'_>, drawn: &BsdfSample) -> bool {
    let BsdfSample::Direction { wi, weight, diffuse_share, pdf, lobe, transmitted } = *drawn else {
        return false;
    };
    let direction = vertex.frame.to_world(wi).normalize();
    let geometric = vertex.point.geometric_normal;
    let to = direction.dot(geometric);
    // The shading normal promised one side, the geometry has another: such light cannot be.
    if (-path.ray.direction.dot(geometric) * to < 0.0) != transmitted {
        return false;
    }
    if transmitted {
        path.absorption = absorption_behind(vertex.material, vertex.point, direction);
    }
    let origin = Origin {
        point: vertex.point.position,
        normal: vertex.light_normal(path.ray.direction),
        pdf: if pdf > 0.0 { pdf } else { f32::INFINITY },
        is_bent: false,
    };
    let ray = Ray::new(vertex.point.ray_origin(direction), direction);
    path.diffuse_depth += u32::from(lobe == Lobe::Diffuse);
    // A mirror direction takes no part in MIS and sees clear bodies as they are.
    path.soft |= vertex.soft && pdf > 0.0;
    path.scatter(Layer::Surface(diffuse_share), ray, weight, origin);
    path.throughput != Vec3::ZERO
}

/// A surface point with what was worked out about it.
struct Vertex<'a> {
    point: &'a SurfacePoint,
    frame: Frame,
    /// Shading normal on the outside.
    normal: Vec3,
    material: &'a Material,
    /// Whether light that falls here has come straight through clear surfaces.
    soft: bool,
}

impl Vertex<'_> {
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
fn survives(path: &mut PathState, u: impl Fn() -> f32) -> bool {
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
