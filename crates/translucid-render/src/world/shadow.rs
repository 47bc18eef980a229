//! Transmittance between two points.

use glam::Vec3;
use translucid_scene::Material;

use super::World;
use super::passage::{Passage, Reach};
use crate::ray::{Ray, SurfacePoint};
use crate::sampling::Frame;
use crate::surface;
use crate::surface::bsdf::{Bsdf, SurfaceParameters};

/// Surfaces that light may pass on the way to a point.
const MOST_SURFACES: u32 = 256;

/// Part of the way to a light short of which shadow rays end, so that the light itself does not count as an obstacle.
pub(super) const SHORT_OF_LIGHT: f32 = 1e-4;

/// Transmittance below which nothing is left of light.
const LEAST: f32 = 1e-6;

/// The clear medium that a shadow ray starts in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowMedium {
    /// Absorption coefficient of the clear medium around its origin [1/L].
    pub(crate) absorption: Vec3,
    /// The light may come straight through clear surfaces.
    pub(crate) soft: bool,
    /// A number that differs from sample to sample, for light through media that are not the same everywhere.
    pub(crate) random: f32,
}

/// Transmittance of the segment: 0 or 1 between opaque things, a color where partly opaque ones, clear
/// media, bodies that light may pass straight or, for soft light, clear surfaces are in the way.
///
/// Paths end at rectangle and sphere lights, so shadow rays end there, too.
pub(crate) fn transmittance(world: &World, ray: &Ray, medium: ShadowMedium) -> Vec3 {
    if world.surfaces.any_lets_light_through() || world.media.any() {
        through_surfaces(world, *ray, medium)
    } else if light_in_the_way(world, ray).is_some() || world.geometry.occluded(ray) {
        Vec3::ZERO
    } else {
        absorbed(medium.absorption, ray.t_max)
    }
}

/// Distance to the nearest rectangle or sphere light.
fn light_in_the_way(world: &World, ray: &Ray) -> Option<f32> {
    Some(world.lights.intersect(ray.origin, ray.direction, ray.t_max)?.t)
}

/// Marches from surface to surface as paths do: a shadow ray has to lose the same light as a path.
fn through_surfaces(
    world: &World,
    mut ray: Ray,
    ShadowMedium { mut absorption, soft, random }: ShadowMedium,
) -> Vec3 {
    let scene = &world.scene;
    let mut result = Vec3::ONE;
    // Along the original ray: a ray that starts beside a surface may meet the light that it is meant for
    let mut light = light_in_the_way(world, &ray);
    let mut done = 0.0;
    // Bodies may end between the ray's end and the light, short of which it ends
    let beyond = if ray.t_max.is_finite() { ray.t_max * SHORT_OF_LIGHT } else { 0.0 };
    for _ in 0..MOST_SURFACES {
        let hit = world.geometry.closest(&ray);
        let way = hit.map_or(ray.t_max, |hit| hit.t);
        if light.is_some_and(|light| light <= done + way) {
            return Vec3::ZERO;
        }
        let Some(hit) = hit else {
            return result * absorbed(absorption, ray.t_max);
        };
        let index = scene.objects[world.geometry.object(&hit) as usize].material;
        let medium = world.media.of(index);
        if medium.is_none() && !world.surfaces.lets_light_through(index) {
            return Vec3::ZERO;
        }
        let material = &scene.materials[index];
        let point = world.surface_point(&hit);
        let rest = ray.t_max - hit.t;
        if let Some(medium) = medium.filter(|_| world.is_passed_by_shadow_rays(&point, soft)) {
            result *= absorbed(absorption, hit.t);
            let transmittance = LEAST / result.max_element();
            let reach = Reach { distance: rest + beyond, transmittance, random };
            let passage = world.pass_straight(medium, &point, ray.direction, soft, reach);
            let Some(Passage { transmittance, distance, end }) = passage else { return Vec3::ZERO };
            result *= transmittance;
            if result.max_element() < LEAST {
                return Vec3::ZERO;
            }
            if distance >= rest {
                return result;
            }
            done += hit.t + distance;
            ray = Ray::segment(end.ray_origin(ray.direction), ray.direction, rest - distance);
            // Lights inside are behind
            if light.is_some_and(|light| light < done) {
                light = light_in_the_way(world, &ray).map(|light| done + light);
            }
            continue;
        }
        let opacity = surface::opacity_at(scene, material, &point);
        let surface = surface::parameters_at(scene, material, &point);
        let clear = if soft { surface.clear_part() } else { 0.0 };
        result *= absorbed(absorption, hit.t);
        if clear > 0.0 {
            absorption = absorption_behind(material, &point, ray.direction, absorption);
        }
        let mut passed = straight_transmittance(&surface, &point, ray.direction) * (opacity * clear);
        if material.geometry_thin_walled && !soft {
            passed = through_wall(world, index, &surface, &point, ray.direction) * opacity;
        }
        result *= Vec3::splat(1.0 - opacity) + passed;
        if result.max_element() < LEAST {
            return Vec3::ZERO;
        }
        done += hit.t;
        ray = Ray::segment(point.ray_origin(ray.direction), ray.direction, rest);
    }
    Vec3::ZERO
}

/// The share of light that a path takes straight through a thin wall.
fn through_wall(
    world: &World,
    index: usize,
    surface: &SurfaceParameters,
    point: &SurfacePoint,
    direction: Vec3,
) -> Vec3 {
    let normal = surface::shading_normal_at(&world.scene, &world.scene.materials[index], point);
    let frame = Frame::from_normal(surface::facing(normal, point.geometric_normal, -direction));
    Bsdf::new(surface, world.surfaces.of(index), frame.to_local(-direction)).straight_through_wall()
}

/// Absorption coefficient of the clear medium that a direction across a surface leads into from one of coefficient `before`
/// [1/L].
pub(crate) fn absorption_behind(
    material: &Material,
    point: &SurfacePoint,
    direction: Vec3,
    before: Vec3,
) -> Vec3 {
    if material.geometry_thin_walled {
        return before;
    }
    if direction.dot(point.geometric_normal) < 0.0 { surface::absorption(material) } else { Vec3::ZERO }
}

/// Transmittance of a clear medium over a distance; an infinite one (in an open mesh) absorbs nothing.
pub(crate) fn absorbed(absorption: Vec3, distance: f32) -> Vec3 {
    if absorption == Vec3::ZERO || distance == f32::INFINITY {
        Vec3::ONE
    } else {
        (-absorption * distance.max(0.0)).exp()
    }
}

/// Transmittance of a clear surface that is passed without refraction.
pub(crate) fn straight_transmittance(
    surface: &SurfaceParameters,
    point: &SurfacePoint,
    direction: Vec3,
) -> Vec3 {
    let cosine = direction.dot(point.shading_normal).abs();
    surface.straight_transmittance(cosine)
}
