//! One-sided rectangular light, sampled uniformly in solid angle
//! [C. Ureña, M. Fajardo & A. King 2013, "An Area-Preserving Parametrization for Spherical Rectangles",
//! Computer Graphics Forum 32(4)].

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::LightSample;
use super::receiver::{Receiver, luminance};

/// Below this solid angle [sr] points are drawn uniformly in area: there the cosine and the distance hardly
/// vary, and the spherical excess, a difference of angles, loses its digits.
const LEAST_SOLID_ANGLE: f64 = 1e-5;

/// See [`translucid_scene::Light::Rectangle`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    corner: Vec3,
    /// Unit vectors along the edges, and the normal on the side that emits.
    x: Vec3,
    y: Vec3,
    normal: Vec3,
    size: [f32; 2],
    pub(crate) radiance: Vec3,
    pub(crate) visible: bool,
}

impl Rectangle {
    /// None if it has no area or emits nothing.
    pub(crate) fn new(
        center: Vec3,
        edge_x: Vec3,
        edge_y: Vec3,
        radiance: Vec3,
        visible: bool,
    ) -> Option<Self> {
        let x = edge_x.try_normalize()?;
        let normal = x.cross(edge_y.try_normalize()?).try_normalize()?;
        let y = normal.cross(x);
        let size = [edge_x.length(), edge_y.dot(y)];
        let corner = center - x * (0.5 * size[0]) - y * (0.5 * size[1]);
        let area = size[0] * size[1];
        let valid = area > 0.0 && area.is_finite() && corner.is_finite() && luminance(radiance) > 0.0;
        valid.then_some(Self { corner, x, y, normal, size, radiance, visible })
    }

    fn area(&self) -> f32 {
        self.size[0] * self.size[1]
    }

    /// Emitted power (luminance).
    pub(crate) fn power(&self) -> f32 {
        std::f32::consts::PI * self.area() * luminance(self.radiance)
    }

    /// Estimate of the irradiance; 0 only if the point is behind the rectangle or the rectangle below the
    /// horizon.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let local = self.local_corner(receiver.point);
        let [width, height] = self.size;
        let elevation = -local.z;
        if elevation <= 0.0 {
            return 0.0;
        }
        let outside = |begin: f32, size: f32| (begin.max(0.0)).max(-(begin + size));
        let nearest = Vec3::new(outside(local.x, width), outside(local.y, height), elevation).length();
        let middle = Vec3::new(local.x + 0.5 * width, local.y + 0.5 * height, elevation).length();
        // Solid angle, seen from afar A cos/d², from near up to 2π.
        let far = self.area() * (elevation / nearest) / (nearest * middle);
        let solid_angle = 1.0 / (1.0 / far + 1.0 / std::f32::consts::TAU);
        luminance(self.radiance) * solid_angle * self.cosine_bound(receiver, middle)
    }

    /// Height of the highest corner above the horizon over the distance of the middle, at most 1.
    fn cosine_bound(&self, receiver: &Receiver, distance: f32) -> f32 {
        if !receiver.has_normal() {
            return 1.0;
        }
        let rise = |edge: Vec3, size: f32| (receiver.normal.dot(edge) * size).max(0.0);
        let highest = receiver.normal.dot(self.corner - receiver.point)
            + rise(self.x, self.size[0])
            + rise(self.y, self.size[1]);
        (highest / distance).clamp(0.0, 1.0)
    }

    /// Draws a direction; the selection is not in its density.
    pub(crate) fn sample(&self, point: Vec3, v: [f32; 2]) -> Option<LightSample> {
        let view = SphericalRectangle::new(self.local_corner(point), self.size)?;
        let (offset, pdf) = if view.solid_angle >= LEAST_SOLID_ANGLE {
            (view.sample(v), 1.0 / view.solid_angle as f32)
        } else {
            let offset = view.sample_area(v);
            (offset, view.area_pdf(offset))
        };
        let distance = offset.length();
        let local = (offset / distance).as_vec3();
        let direction = (self.x * local.x + self.y * local.y + self.normal * local.z).try_normalize()?;
        Some(LightSample::new(direction, distance as f32, self.radiance, pdf))
    }

    /// Solid-angle density with which `sample` makes the direction from `point` to `hit`.
    pub(crate) fn pdf(&self, point: Vec3, hit: Vec3) -> f32 {
        let Some(view) = SphericalRectangle::new(self.local_corner(point), self.size) else { return 0.0 };
        if view.solid_angle >= LEAST_SOLID_ANGLE {
            return 1.0 / view.solid_angle as f32;
        }
        let offset = hit - point;
        let local = Vec3::new(offset.dot(self.x), offset.dot(self.y), offset.dot(self.normal));
        view.area_pdf(local.as_dvec3())
    }

    /// Distance at which a ray meets the emitting side.
    pub(crate) fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let approach = direction.dot(self.normal);
        let to_corner = self.corner - origin;
        let t = to_corner.dot(self.normal) / approach;
        // A NaN fails the comparison.
        if !(approach < 0.0 && t > 0.0 && t.is_finite()) {
            return None;
        }
        let on_plane = direction * t - to_corner;
        let (x, y) = (on_plane.dot(self.x), on_plane.dot(self.y));
        let inside = (0.0..=self.size[0]).contains(&x) && (0.0..=self.size[1]).contains(&y);
        inside.then_some(t)
    }

    /// The corner as seen from a point, in the rectangle's frame.
    fn local_corner(&self, point: Vec3) -> Vec3 {
        let offset = self.corner - point;
        Vec3::new(offset.dot(self.x), offset.dot(self.y), offset.dot(self.normal))
    }
}

/// A rectangle projected on the unit sphere, in the names of the paper; double precision because the
/// angles nearly cancel.
struct SphericalRectangle {
    x0: f64,
    x1: f64,
    y0: f64,
    y1: f64,
    /// Height of the rectangle's plane, < 0.
    z0: f64,
    /// z of the normals of the planes through the edges y0 and y1.
    b0: f64,
    b1: f64,
    k: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// `corner` relative to the point in the rectangle's frame; none if the point is not in front.
    fn new(corner: Vec3, size: [f32; 2]) -> Option<Self> {
        let corner = corner.as_dvec3();
        let (x0, y0, z0) = (corner.x, corner.y, corner.z);
        if !(z0 < 0.0 && corner.is_finite()) {
            return None;
        }
        let (x1, y1) = (x0 + f64::from(size[0]), y0 + f64::from(size[1]));
        let normal_z = |edge: f64| edge / z0.hypot(edge);
        let (n0, n1, n2, n3) = (-normal_z(y0), normal_z(x1), normal_z(y1), -normal_z(x0));
        let angle = |a: f64, b: f64| (-a * b).acos();
        let k = TAU - angle(n2, n3) - angle(n3, n0);
        let solid_angle = angle(n0, n1) + angle(n1, n2) - k;
        Some(Self { x0, x1, y0, y1, z0, b0: n0, b1: n2, k, solid_angle })
    }

    /// Offset from the point to a point of the rectangle, uniform in solid angle.
    fn sample(&self, v: [f32; 2]) -> DVec3 {
        // Find x: the area left of it is the share v[0] of the solid angle.
        let au = f64::from(v[0]) * self.solid_angle + self.k;
        let (sin, cos) = au.sin_cos();
        let fu = (cos * self.b0 - self.b1) / sin;
        let cu = (1.0_f64.copysign(fu) / fu.hypot(self.b0)).clamp(-1.0, 1.0);
        let x = (-(cu * self.z0) / (1.0 - cu * cu).max(1e-300).sqrt()).clamp(self.x0, self.x1);
        // Find y: uniform in the sine of the elevation along that line.
        let d = x.hypot(self.z0);
        let (h0, h1) = (self.y0 / d.hypot(self.y0), self.y1 / d.hypot(self.y1));
        let h = h0 + f64::from(v[1]) * (h1 - h0);
        let y = (h * d / (1.0 - h * h).max(1e-300).sqrt()).clamp(self.y0, self.y1);
        DVec3::new(x, y, self.z0)
    }

    /// Offset from the point to a point of the rectangle, uniform in area.
    fn sample_area(&self, v: [f32; 2]) -> DVec3 {
        let x = self.x0 + f64::from(v[0]) * (self.x1 - self.x0);
        let y = self.y0 + f64::from(v[1]) * (self.y1 - self.y0);
        DVec3::new(x, y, self.z0)
    }

    /// Solid-angle density of `sample_area`.
    fn area_pdf(&self, offset: DVec3) -> f32 {
        let area = (self.x1 - self.x0) * (self.y1 - self.y0);
        let distance = offset.length();
        (distance.powi(3) / (-self.z0 * area)) as f32
    }
}
