//! A material's parameters at a point of its surface, clamped to their ranges.

use glam::Vec3;
use translucid_scene::{ColorInput, Material, ScalarInput, Scene};

use super::bsdf::SurfaceParameters;
use super::texture::{color, scalar};
use crate::ray::SurfacePoint;

/// Surface albedo A in [0, 1] of the medium below.
pub(crate) fn surface_albedo_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    color(scene, &material.subsurface_color, point).clamp(Vec3::ZERO, Vec3::ONE)
}

/// Length that the material states, per channel \[L\]: a mean free path or a diffuse one.
pub(crate) fn stated_length_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    let radius = scalar(scene, &material.subsurface_radius, point).max(0.0);
    color(scene, &material.subsurface_radius_scale, point).max(Vec3::ZERO) * radius
}

/// Parameters of the surface itself; below it is no light yet (see [`SurfaceParameters::with_subsurface`]).
pub(crate) fn parameters_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> SurfaceParameters {
    let unit_scalar = |input: &ScalarInput| scalar(scene, input, point).clamp(0.0, 1.0);
    let unit_color = |input: &ColorInput| color(scene, input, point).clamp(Vec3::ZERO, Vec3::ONE);
    SurfaceParameters {
        base_color: unit_color(&material.base_color) * material.base_weight,
        metalness: unit_scalar(&material.base_metalness),
        specular_weight: unit_scalar(&material.specular_weight),
        specular_color: unit_color(&material.specular_color),
        specular_roughness: unit_scalar(&material.specular_roughness),
        specular_ior: material.specular_ior,
        transmission_weight: unit_scalar(&material.transmission_weight),
        transmission_tint: unit_color(material.crossing_tint()),
        subsurface_weight: unit_scalar(&material.subsurface_weight),
        surface_albedo: Vec3::ZERO,
        subsurface_active: Vec3::ZERO,
        thin: material.geometry_thin_walled.into(),
        thin_albedo: Vec3::ZERO,
        coat_weight: unit_scalar(&material.coat_weight),
        coat_color: unit_color(&material.coat_color),
        coat_roughness: unit_scalar(&material.coat_roughness),
        coat_ior: material.coat_ior,
    }
}

/// Share of light that the surface stops, in [0, 1].
pub(crate) fn opacity_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> f32 {
    scalar(scene, &material.geometry_opacity, point).clamp(0.0, 1.0)
}

/// Largest color of an emission, as scene files have it.
const GREATEST_FACTOR: f32 = 1e6;

/// Emitted radiance.
pub(crate) fn emission_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    if material.emission_luminance <= 0.0 {
        return Vec3::ZERO;
    }
    let color = color(scene, &material.emission_color, point).clamp(Vec3::ZERO, Vec3::splat(GREATEST_FACTOR));
    color * material.emission_luminance
}

/// Absorption coefficient of a clear material [1/L]; zero where its color is a tint of the surface.
pub(crate) fn absorption(material: &Material) -> Vec3 {
    if material.transmission_depth <= 0.0 {
        return Vec3::ZERO;
    }
    let color = material.transmission_color.factor.clamp(Vec3::splat(1e-6), Vec3::ONE);
    -Vec3::new(libm::logf(color.x), libm::logf(color.y), libm::logf(color.z)) / material.transmission_depth
}
