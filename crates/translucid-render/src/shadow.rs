//! How much light comes through between two points.

use glam::Vec3;

use crate::bsdf::{SurfaceParameters, fresnel_dielectric};
use crate::geometry::SurfacePoint;
use crate::material;
use crate::path::World;
use crate::triangle::Ray;

/// Surfaces that light may pass on the way to a point.
const MOST_SURFACES: u32 = 256;

/// Transmittance of the segment: 0 or 1 between opaque things, a color where partly opaque ones or, for
/// soft light, clear ones are in the way.
pub(crate) fn transmittance(world: &World, ray: &Ray, soft: bool) -> Vec3 {
    if world.materials.any_lets_light_through() {
        through_surfaces(world, *ray, soft)
    } else if world.geometry.occluded(ray) {
        Vec3::ZERO
    } else {
        Vec3::ONE
    }
}

/// Marches from surface to surface.
fn through_surfaces(world: &World, mut ray: Ray, soft: bool) -> Vec3 {
    let scene = &world.scene;
    let mut result = Vec3::ONE;
    for _ in 0..MOST_SURFACES {
        let Some(hit) = world.geometry.closest(&ray) else { return result };
        let index = scene.objects[world.geometry.object(&hit) as usize].material;
        if !world.materials.lets_light_through(index) {
            return Vec3::ZERO;
        }
        let material = &scene.materials[index];
        let point = world.geometry.surface_point(scene, &hit);
        let opacity = material::opacity_at(scene, material, &point);
        let subsurface = material::subsurface_at(scene, material, &point);
        let surface = material::surface_at(scene, material, &point, &subsurface);
        let clear = if soft { surface.transmission_weight * (1.0 - surface.metalness) } else { 0.0 };
        if ray.direction.dot(point.geometric_normal) > 0.0 && clear > 0.0 {
            // Leaving a clear body: what lies behind was inside.
            result *= (-material::absorption(material) * hit.t).exp();
        }
        let straight = straight_transmittance(&surface, &point, ray.direction);
        result *= Vec3::splat(1.0 - opacity) + straight * (opacity * clear);
        if result.max_element() < 1e-6 {
            return Vec3::ZERO;
        }
        let rest = ray.t_max - hit.t;
        ray = Ray::segment(point.ray_origin(ray.direction), ray.direction, rest);
    }
    Vec3::ZERO
}

/// Transmittance of a clear surface that is passed without refraction: Fresnel and tint, as of a wall
/// whose faces are parallel.
pub(crate) fn straight_transmittance(
    surface: &SurfaceParameters,
    point: &SurfacePoint,
    direction: Vec3,
) -> Vec3 {
    let cosine = direction.dot(point.shading_normal).abs();
    let reflected = surface.specular_weight * fresnel_dielectric(cosine, surface.specular_ior);
    surface.transmission_tint * (1.0 - reflected)
}
