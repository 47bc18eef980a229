//! Spherical light, sampled uniformly in the cone that it fills.

use std::f32::consts::PI;

use glam::Vec3;

use super::LightSample;
use super::bounds::LightBounds;
use super::cone::SpotCone;
use super::directions::{uniform_cone, uniform_cone_pdf};
use super::receiver::{Receiver, luminance};

/// Cosine up to which a place behind the horizon counts as seen, for rounding.
const HORIZON: f32 = 1e-3;

/// Room for the rounding of cosines.
const ROUNDING: f32 = 1e-6;

/// See [`translucid_scene::Light::Sphere`], and [`translucid_scene::Light::Spot`] with a radius: each of its points shines
/// into the cone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
    pub(crate) radiance: Vec3,
    luminance: f32,
    pub(crate) cone: Option<SpotCone>,
    pub(crate) visible: bool,
}

impl Sphere {
    /// None if it has no size or emits nothing.
    pub(crate) fn new(center: Vec3, radius: f32, radiance: Vec3, visible: bool) -> Option<Self> {
        let valid = radius > 0.0 && radius.is_finite() && luminance(radiance) > 0.0;
        let luminance = luminance(radiance);
        valid.then_some(Self { center, radius, radiance, luminance, cone: None, visible })
    }

    /// A spot: none if it has no size or emits nothing.
    pub(crate) fn of_spot(
        center: Vec3,
        radius: f32,
        intensity: Vec3,
        cone: SpotCone,
        visible: bool,
    ) -> Option<Self> {
        let sphere = Self::new(center, radius, intensity / (PI * radius * radius), visible)?;
        Some(Self { cone: Some(cone), ..sphere })
    }

    /// Radiance that it sends in a unit direction.
    pub(crate) fn radiance_toward(&self, direction: Vec3) -> Vec3 {
        self.radiance * self.cone.map_or(1.0, |cone| cone.falloff(direction.dot(cone.axis)))
    }

    /// Intensity (luminance), of a spot that on its axis.
    fn strength(&self) -> f32 {
        PI * self.radius * self.radius * self.luminance
    }

    /// Emitted power (luminance), not less than the true one.
    pub(crate) fn power(&self) -> f32 {
        2.0 * PI * self.cone.map_or(2.0, |cone| cone.one_minus_cos()) * self.strength()
    }

    pub(crate) fn bounds(&self) -> LightBounds {
        let (low, high) = (self.center - self.radius, self.center + self.radius);
        match &self.cone {
            None => LightBounds::everywhere(low, high, self.strength()),
            Some(cone) => LightBounds::cone(low, high, cone, self.strength()),
        }
    }

    /// Estimate of the irradiance; 0 only from inside, outside the cone of all points and below the horizon.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let to_center = self.center - receiver.point;
        let per_distance = 1.0 / to_center.length();
        let sin = self.radius * per_distance;
        let highest = receiver.normal.dot(to_center) + self.radius;
        let cosine = if receiver.has_normal() { highest * per_distance } else { 1.0 };
        if sin >= 1.0 || cosine <= 0.0 {
            return 0.0;
        }
        // The brightest direction within the angle that the sphere subtends
        let falloff = self.cone.map_or(1.0, |cone| {
            let angle = libm::acosf((-to_center.dot(cone.axis) * per_distance).clamp(-1.0, 1.0));
            cone.falloff(libm::cosf((angle - libm::asinf(sin)).max(0.0)) + ROUNDING)
        });
        if falloff <= 0.0 {
            return 0.0;
        }
        (PI * self.luminance * sin * sin * cosine.min(1.0) * falloff).max(f32::MIN_POSITIVE)
    }

    /// Draws a direction; the selection is not in its density.
    pub(crate) fn sample(&self, point: Vec3, v: [f32; 2]) -> Option<LightSample> {
        let subtended = one_minus_cos(self.sin2(point)?);
        let to_center = self.center - point;
        let (axis, one_minus_cos, distance) = match self.cone.filter(|cone| cone.one_minus_cos() < subtended)
        {
            Some(cone) => (-cone.axis, cone.one_minus_cos(), None),
            // At the rim rounding may let the ray miss: the foot of the perpendicular is then the nearest point.
            None => (to_center.try_normalize()?, subtended, Some(to_center)),
        };
        let direction = uniform_cone(axis, one_minus_cos, v);
        let distance =
            self.intersect(point, direction).or(distance.map(|to_center| to_center.dot(direction)))?;
        let radiance = self.radiance_toward(-direction);
        Some(LightSample::new(direction, distance, radiance, uniform_cone_pdf(one_minus_cos)))
    }

    /// Unit normal at a place of the sphere.
    pub(crate) fn normal_at(&self, place: Vec3) -> Option<Vec3> {
        (place - self.center).try_normalize()
    }

    /// Solid-angle density with which `sample` makes the direction from `point` to `hit`; 0 behind the horizon.
    pub(crate) fn pdf(&self, point: Vec3, hit: Vec3) -> f32 {
        let (outward, toward) = (hit - self.center, point - hit);
        if outward.dot(toward) < -HORIZON * self.radius * toward.length() {
            return 0.0;
        }
        let Some(sin2) = self.sin2(point) else { return 0.0 };
        let subtended = one_minus_cos(sin2);
        match self.cone.filter(|cone| cone.one_minus_cos() < subtended) {
            Some(cone) if toward.normalize_or_zero().dot(cone.axis) < cone.cos_outer => 0.0,
            Some(cone) => uniform_cone_pdf(cone.one_minus_cos()),
            None => uniform_cone_pdf(subtended),
        }
    }

    /// Distance at which a ray from outside meets the sphere.
    pub(crate) fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let to_center = self.center - origin;
        let along = to_center.dot(direction);
        // By the perpendicular: b² − c would cancel for spheres that are far away
        // [Haines, Günther & Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection"].
        let across = (to_center - direction * along).length_squared();
        let inside = to_center.length_squared() <= self.radius * self.radius;
        let half_chord2 = self.radius * self.radius - across;
        // A NaN fails the comparison.
        let hits = half_chord2 >= 0.0 && along > 0.0 && !inside;
        hits.then(|| along - half_chord2.sqrt()).filter(|t| t.is_finite()).map(|t| t.max(0.0))
    }

    /// Squared sine of the half-angle that the sphere subtends, in (0, 1); none from inside.
    fn sin2(&self, point: Vec3) -> Option<f32> {
        // Dividing before squaring keeps tiny and huge spheres in range.
        let sin = self.radius / (self.center - point).length();
        let sin2 = sin * sin;
        (sin2 > 0.0 && sin2 < 1.0).then_some(sin2)
    }
}

/// 1 − cos α from sin² α, exact for small angles.
pub(crate) fn one_minus_cos(sin2: f32) -> f32 {
    sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt())
}
