//! A triangle that emits, sampled uniformly in area.

use std::f32::consts::PI;

use glam::Vec3;
use translucid_law::{Receiver, luminance, triangle_importance, uniform_triangle};

use super::LightSample;
use super::bounds::LightBounds;

/// A triangle that emits on the side from which its vertices are seen counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissiveTriangle {
    /// Corners in world space \[L\].
    pub vertices: [Vec3; 3],
    /// Emitted radiance, mean over the triangle.
    pub radiance: Vec3,
    /// Number that the renderer knows the triangle by.
    pub primitive: u64,
}

/// Those that emit, by their primitive's number.
pub(crate) fn emitting(mut triangles: Vec<EmissiveTriangle>) -> Vec<EmissiveTriangle> {
    triangles.retain(|triangle| {
        // The product may be too small for single precision.
        let power = f64::from(triangle.area()) * f64::from(luminance(triangle.radiance));
        power > 0.0 && triangle.power().is_finite()
    });
    triangles.sort_by_key(|triangle| triangle.primitive);
    triangles
}

impl EmissiveTriangle {
    /// Twice the area times the unit normal.
    fn cross(&self) -> Vec3 {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a)
    }

    /// Unit normal on the side that emits.
    pub(crate) fn normal(&self) -> Option<Vec3> {
        self.cross().try_normalize()
    }

    fn area(&self) -> f32 {
        0.5 * self.cross().length()
    }

    /// Emitted power (luminance).
    pub(crate) fn power(&self) -> f32 {
        PI * self.area() * luminance(self.radiance)
    }

    pub(crate) fn bounds(&self) -> LightBounds {
        let [a, b, c] = self.vertices;
        let normal = self.cross().normalize_or(Vec3::Z);
        let strength = self.area() * luminance(self.radiance);
        LightBounds::one_sided(a.min(b).min(c), a.max(b).max(c), normal, strength)
    }

    /// Estimate of the irradiance.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let [a, b, c] = self.vertices;
        triangle_importance(a, b, c, luminance(self.radiance), receiver)
    }

    /// Draws a point; the selection is not in its density.
    pub(crate) fn sample(&self, point: Vec3, v: [f32; 2]) -> Option<LightSample> {
        let [a, b, c] = self.vertices;
        // From the corner a, so that far from the origin the offsets keep their digits.
        let [s, t] = uniform_triangle(v);
        let offset = (a - point) + (b - a) * s + (c - a) * t;
        let direction = offset.try_normalize()?;
        let pdf = self.pdf(offset, self.cross().normalize_or_zero());
        let mut sample = LightSample::new(direction, offset.length(), self.radiance, pdf);
        sample.primitive = Some(self.primitive);
        Some(sample)
    }

    /// Solid-angle density with which `sample` makes the direction to a point of the triangle at this offset, the
    /// unit normal there given: distance² / (area × cosine); 0 from behind.
    pub(crate) fn pdf(&self, offset: Vec3, normal: Vec3) -> f32 {
        let offset = offset.as_dvec3();
        // −offset·normal = distance × cosine.
        let facing = -offset.dot(normal.as_dvec3());
        let distance2 = offset.length_squared();
        if facing > 0.0 {
            (distance2 * distance2.sqrt() / (f64::from(self.area()) * facing)) as f32
        } else {
            0.0
        }
    }
}
