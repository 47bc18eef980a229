//! Light that reaches a point straight from a light.

use glam::Vec3;

use super::World;
use super::shadow::{SHORT_OF_LIGHT, ShadowMedium, transmittance};
use crate::light::LightSample;
use crate::ray::{Ray, SurfacePoint};
use crate::surface;

/// Light beyond this is cut off, for example that of a point light of 1e12 at a distance of 1e-7.
/// Later products stay finite, and a black channel stays black.
const GREATEST_LIGHT: f32 = 1e26;

impl World {
    /// Radiance of a light sample as it sets out for the point.
    pub(crate) fn sent(&self, point: &SurfacePoint, light: &LightSample) -> Vec3 {
        let target = point.position + light.direction * light.distance;
        match light.primitive {
            Some(primitive) => self.emitted_at(primitive, target),
            None => light.radiance,
        }
    }

    /// Radiance of a light sample that reaches the point.
    pub(crate) fn unoccluded(&self, point: &SurfacePoint, light: &LightSample, medium: ShadowMedium) -> Vec3 {
        let target = point.position + light.direction * light.distance;
        let radiance = self.sent(point, light);
        if radiance == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let origin = point.ray_origin(light.direction);
        let (direction, length) = if light.distance.is_finite() {
            // Aimed anew: parallel to the old direction, a ray from beside the point would meet the light
            // beside the target, and at a slant early enough for the light to shadow itself.
            let (direction, whole) = (target - origin).normalize_and_length();
            (direction, whole - (SHORT_OF_LIGHT * whole).max(point.offset))
        } else {
            (light.direction, f32::INFINITY)
        };
        if length <= 0.0 {
            return radiance;
        }
        radiance * transmittance(self, &Ray::segment(origin, direction, length), medium)
    }

    /// Emission of a triangle at a point of it, on average: none where the surface is not there.
    fn emitted_at(&self, primitive: u64, position: Vec3) -> Vec3 {
        let point = self.point_on(primitive, position);
        let (_, material) = self.material(&point);
        let opacity = surface::opacity_at(&self.scene, material, &point);
        surface::emission_at(&self.scene, material, &point) * opacity
    }
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
