//! Light that a path meets by itself, weighted against samples of lights.

use translucid_scene::Material;

use crate::ray::{Hit, SurfacePoint};
use crate::surface;
use crate::world::{PathState, World, absorbed};

/// Emission of the surface that the path has met, on average over whether the surface is there.
pub(super) fn add_emission(
    world: &World,
    path: &mut PathState,
    point: &SurfacePoint,
    material: &Material,
    hit: &Hit,
) {
    if material.emission_luminance <= 0.0 || path.ray.direction.dot(point.geometric_normal) >= 0.0 {
        return;
    }
    let opacity = surface::opacity_at(&world.scene, material, point);
    let radiance = surface::emission_at(&world.scene, material, point) * opacity;
    let weight = path.origin.weight(|from, normal| {
        let primitive = world.geometry.primitive(point.object, point.triangle);
        let position = world.geometry.position(hit);
        world.lights.triangle_pdf(primitive, from, normal, position, point.geometric_normal)
    });
    path.add(radiance * weight);
}

/// Adds an analytic light nearer than any surface; true if there is one.
pub(super) fn add_light_in_the_way(world: &World, path: &mut PathState, t_max: f32) -> bool {
    let ray = &path.ray;
    let lights = &world.lights;
    let light = if path.is_of_camera() {
        lights.intersect_visible(ray.origin, ray.direction, t_max)
    } else {
        lights.intersect(ray.origin, ray.direction, t_max)
    };
    let Some(light) = light else { return false };
    let weight = path.origin.weight(|point, normal| light.pdf(lights, point, normal));
    let absorbed = absorbed(path.absorption, light.t);
    if path.is_of_camera() {
        path.sample.alpha = 1.0;
    }
    path.add(light.radiance * absorbed * weight);
    true
}

/// Adds the environment behind everything.
pub(super) fn add_environment(world: &World, path: &mut PathState) {
    let lights = &world.lights;
    if path.is_of_camera() && !lights.environment_visible() {
        return;
    }
    let direction = path.ray.direction;
    let radiance = if path.is_of_camera() {
        lights.background_radiance(direction)
    } else {
        lights.environment_radiance(direction)
    };
    let weight = path.origin.weight(|point, normal| lights.environment_pdf(point, normal, direction));
    if path.is_of_camera() {
        path.sample.alpha = 1.0;
    }
    path.add(radiance * weight);
}
