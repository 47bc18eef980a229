//! Spherical light, sampled uniformly in the cone that it fills; and the spot with a radius, each of whose points shines into
//! the spot's cone.

use std::f32::consts::PI;

use glam::Vec3;

use crate::cone::SpotCone;
use crate::directions::{one_minus_cos, uniform_cone, uniform_cone_pdf};
use crate::elementary::{is_finite, unit_or};
use crate::receiver::{LightDraw, Receiver, luminance};
use crate::words::words;

/// Cosine up to which a place behind the horizon counts as seen, for rounding.
const HORIZON: f32 = 1e-3;

/// Room for the rounding of cosines.
const COSINE_ROUNDING: f32 = 1e-6;

/// A sphere that emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// Its center.
    pub center: Vec3,
    /// Its radius > 0.
    pub radius: f32,
    /// Radiance, of a spot on its axis.
    pub radiance: Vec3,
    /// Luminance of that.
    pub luminance: f32,
    /// `true` if its points shine into the cone only.
    pub has_cone: bool,
    /// That cone.
    pub cone: SpotCone,
    /// `true` if the camera sees it.
    pub visible: bool,
}

words!(SphereLight { center, radius, radiance, luminance, has_cone, cone, visible });

impl SphereLight {
    /// A light that shines to all sides; none if it has no size or emits nothing.
    pub fn new(center: Vec3, radius: f32, radiance: Vec3, visible: bool) -> Option<Self> {
        let luminance = luminance(radiance);
        let valid = radius > 0.0 && radius.is_finite() && luminance > 0.0;
        let cone = SpotCone { axis: Vec3::Z, cos_inner: -1.0, cos_outer: -2.0 };
        valid.then_some(Self { center, radius, radiance, luminance, has_cone: false, cone, visible })
    }

    /// A spot; none if it has no size or emits nothing.
    pub fn of_spot(
        center: Vec3,
        radius: f32,
        intensity: Vec3,
        cone: SpotCone,
        visible: bool,
    ) -> Option<Self> {
        let sphere = Self::new(center, radius, intensity / (PI * radius * radius), visible)?;
        Some(Self { has_cone: true, cone, ..sphere })
    }

    /// Intensity (luminance), of a spot that on its axis.
    pub fn strength(&self) -> f32 {
        PI * self.radius * self.radius * self.luminance
    }

    /// Emitted power (luminance), not less than the true one.
    pub fn power(&self) -> f32 {
        2.0 * PI * self.cone.one_minus_cos() * self.strength()
    }

    /// Radiance that it sends in a unit direction.
    #[inline]
    pub fn radiance_toward(&self, direction: Vec3) -> Vec3 {
        if !self.has_cone {
            return self.radiance;
        }
        self.radiance * self.cone.falloff(direction.dot(self.cone.axis))
    }

    /// Estimate of the irradiance; 0 only from inside, outside the cone of all points and below the horizon.
    #[inline]
    pub fn importance(&self, receiver: &Receiver) -> f32 {
        let to_center = self.center - receiver.point;
        let per_distance = 1.0 / to_center.length();
        let sine = self.radius * per_distance;
        let highest = receiver.normal.dot(to_center) + self.radius;
        let cosine = if receiver.has_normal() { highest * per_distance } else { 1.0 };
        if sine >= 1.0 || cosine <= 0.0 {
            return 0.0;
        }
        let mut falloff = 1.0;
        if self.has_cone {
            // The brightest direction within the angle that the sphere subtends
            let axis_cosine = (-to_center.dot(self.cone.axis) * per_distance).clamp(-1.0, 1.0);
            let rim_cosine = ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt();
            let mut best = 1.0;
            if axis_cosine < rim_cosine {
                let axis_sine = ((1.0 - axis_cosine) * (1.0 + axis_cosine)).sqrt();
                best = axis_cosine * rim_cosine + axis_sine * sine;
            }
            falloff = self.cone.falloff(best + COSINE_ROUNDING);
        }
        if falloff <= 0.0 {
            return 0.0;
        }
        (PI * self.luminance * sine * sine * cosine.min(1.0) * falloff).max(f32::MIN_POSITIVE)
    }

    /// Draws a direction; the selection is not in its density.
    #[inline]
    pub fn draw(&self, point: Vec3, v: [f32; 2]) -> LightDraw {
        let sin2 = self.sin2(point);
        if sin2 <= 0.0 {
            return LightDraw::none();
        }
        let to_center = self.center - point;
        let mut width = one_minus_cos(sin2);
        let is_of_cone = self.has_cone && self.cone.one_minus_cos() < width;
        let mut axis = unit_or(to_center, Vec3::Z);
        if is_of_cone {
            width = self.cone.one_minus_cos();
            axis = -self.cone.axis;
        }
        let direction = uniform_cone(axis, width, v);
        let mut t = self.distance(point, direction);
        if t < 0.0 {
            if is_of_cone {
                return LightDraw::none();
            }
            // At the rim rounding may let the ray miss: the foot of the perpendicular is then the nearest point
            t = to_center.dot(direction);
        }
        let radiance = self.radiance_toward(-direction);
        LightDraw { direction, distance: t, radiance, pdf: uniform_cone_pdf(width) }
    }

    /// Solid-angle density with which [`draw`](Self::draw) makes the direction from `point` to `hit`; 0 behind the horizon.
    #[inline]
    pub fn pdf(&self, point: Vec3, hit: Vec3) -> f32 {
        let (outward, toward) = (hit - self.center, point - hit);
        if outward.dot(toward) < -HORIZON * self.radius * toward.length() {
            return 0.0;
        }
        let sin2 = self.sin2(point);
        if sin2 <= 0.0 {
            return 0.0;
        }
        let subtended = one_minus_cos(sin2);
        let of_cone = self.cone.one_minus_cos();
        if self.has_cone && of_cone < subtended {
            let is_outside = unit_or(toward, Vec3::ZERO).dot(self.cone.axis) < self.cone.cos_outer;
            return if is_outside { 0.0 } else { uniform_cone_pdf(of_cone) };
        }
        uniform_cone_pdf(subtended)
    }

    /// Distance at which a ray from outside meets the sphere; below 0 if it misses it.
    #[inline]
    pub fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        let to_center = self.center - origin;
        let along = to_center.dot(direction);
        // By the perpendicular: b² − c would cancel for spheres that are far away
        // [Haines, Günther & Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection"].
        let across = to_center - direction * along;
        let radius2 = self.radius * self.radius;
        let half_chord2 = radius2 - across.dot(across);
        // A NaN fails the comparison
        if half_chord2 >= 0.0 && along > 0.0 && to_center.dot(to_center) > radius2 {
            let t = along - half_chord2.sqrt();
            if is_finite(t) {
                return t.max(0.0);
            }
        }
        -1.0
    }

    /// Squared sine of the half-angle that the sphere subtends, in (0, 1); 0 from inside.
    #[inline]
    pub fn sin2(&self, point: Vec3) -> f32 {
        // Dividing before squaring keeps tiny and huge spheres in range
        let sine = self.radius / (self.center - point).length();
        let sin2 = sine * sine;
        if sin2 < 1.0 { sin2 } else { 0.0 }
    }
}
