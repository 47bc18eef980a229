//! The entry point x_i of a BSSRDF, where light enters the body: the light that arrives there, and the path's way on.

use glam::Vec3;

use crate::ray::{Ray, SurfacePoint};
use crate::sampling::{Frame, Reserved};
use crate::surface;
use crate::surface::bsdf::EntryBsdf;
use crate::world::{Layer, MisOrigin, PathState, ShadowMedium, World, power_heuristic, weighed};

use super::kernel::DirectionalWeight;

/// Light from one direction at an entry point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    /// Unit direction toward where it comes from.
    pub(crate) direction: Vec3,
    /// Its contribution to E/π below the surface.
    pub(crate) light: Vec3,
}

impl Arrival {
    pub(crate) const NONE: Self = Self { direction: Vec3::Z, light: Vec3::ZERO };
}

/// The entry point x_i of light, found by probes or a walk.
#[doc(alias = "BSSRDF")]
pub(crate) struct EntryPoint<'a> {
    world: &'a World,
    pub(crate) point: SurfacePoint,
    /// Shading normal on the side that is seen.
    pub(crate) normal: Vec3,
    /// Geometric normal on that side.
    geometric: Vec3,
    bsdf: EntryBsdf<'a>,
}

/// The factor of a surface on light that enters there.
pub(crate) fn entry_bsdf<'a>(world: &'a World, point: &SurfacePoint) -> EntryBsdf<'a> {
    let (index, material) = world.material(point);
    EntryBsdf::new(&surface::parameters_at(&world.scene, material, point), world.surfaces.of(index))
}

impl<'a> EntryPoint<'a> {
    /// A point of a surface that is seen from its outside (`side` 1) or, in an open mesh, from its inside (−1).
    pub(crate) fn new(world: &'a World, point: SurfacePoint, side: f32) -> Self {
        let (_, material) = world.material(&point);
        Self {
            world,
            normal: surface::shading_normal_at(&world.scene, material, &point) * side,
            geometric: point.geometric_normal * side,
            bsdf: entry_bsdf(world, &point),
            point,
        }
    }

    /// A point of a flat surface, whose geometric normal counts for all directions.
    pub(crate) fn flat(world: &'a World, point: SurfacePoint, side: f32) -> Self {
        let geometric = point.geometric_normal * side;
        Self { world, normal: geometric, geometric, bsdf: entry_bsdf(world, &point), point }
    }

    /// Continues the path at the entry point: adds light from one sampled light, and draws a cosine direction. False where
    /// the path is over.
    pub(crate) fn enter(
        &self,
        path: &mut PathState,
        directional: &DirectionalWeight,
        [of_light, of_direction]: [Reserved; 2],
    ) -> bool {
        if let Some(arrival) = self.direct_light(path.absorption, of_light.numbers()) {
            let light = arrival.light * directional.weight(arrival.direction) * path.throughput;
            path.add_to(path.layer_after(Layer::Subsurface), light);
        }
        let Some((direction, weight)) = self.head_off(path, of_direction.numbers()) else {
            return false;
        };
        path.throughput *= weight * directional.weight(direction);
        path.throughput != Vec3::ZERO
    }

    /// Sets the path on its way in a cosine direction that light enters from; returns it and its weight, which the path
    /// does not have yet.
    pub(crate) fn head_off(&self, path: &mut PathState, v: [f32; 4]) -> Option<(Vec3, Vec3)> {
        let Self { ref point, normal, geometric, .. } = *self;
        let (wi, weight) = self.bsdf.sample([v[0], v[1]]);
        let direction = Frame::from_normal(normal).to_world(wi).normalize();
        if direction.dot(geometric) <= 0.0 {
            return None;
        }
        let origin =
            MisOrigin { point: point.position, normal, pdf: EntryBsdf::pdf(wi.z), is_refracted: false };
        path.diffuse_depth += 1;
        path.soft |= !self.world.scene.integrator.caustics;
        let ray = Ray::new(point.ray_origin(direction), direction);
        path.scatter(Layer::Subsurface, ray, Vec3::ONE, origin);
        (weight != Vec3::ZERO).then_some((direction, weight))
    }

    /// Mean light of several sampled lights that enters here; their random numbers are evenly shifted.
    pub(crate) fn mean_direct_light(&self, absorption: Vec3, of_light: Reserved, lights: u16) -> Vec3 {
        let part = 1.0 / f32::from(lights);
        let u = of_light.numbers();
        let light = |k| {
            let shifted = u.map(|u| (u + f32::from(k) * part).fract());
            self.direct_light(absorption, shifted).map_or(Vec3::ZERO, |arrival| arrival.light)
        };
        (0..lights).map(light).sum::<Vec3>() * part
    }

    /// Light from one sampled light that enters here, without the directional factor of the kernel.
    pub(crate) fn direct_light(&self, absorption: Vec3, u: [f32; 4]) -> Option<Arrival> {
        let Self { world, ref point, normal, geometric, ref bsdf } = *self;
        let light = world.lights.sample(point.position, normal, u[0], [u[1], u[2]])?;
        let direction = light.direction;
        let cosine = direction.dot(normal);
        if cosine <= 0.0 || direction.dot(geometric) <= 0.0 {
            return None;
        }
        let mis = if light.is_delta { 1.0 } else { power_heuristic(light.pdf, EntryBsdf::pdf(cosine)) };
        let medium = ShadowMedium { absorption, soft: !world.scene.integrator.caustics, random: u[3] };
        let light = weighed(world.unoccluded(point, &light, medium), mis / light.pdf) * bsdf.eval(cosine);
        Some(Arrival { direction, light })
    }
}
