//! One-sided rectangular light, sampled uniformly in solid angle
//! [C. Ureña, M. Fajardo & A. King 2013, "An Area-Preserving Parametrization for Spherical Rectangles",
//! Computer Graphics Forum 32(4)].

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use translucid_law::{Receiver, luminance};

use super::LightSample;
use super::bounds::LightBounds;

/// Rectangles that look smaller than about this solid angle \[sr\] are drawn from uniformly in area: the density
/// then varies by a tenth over the rectangle, which is little beside the cosine at the receiver, and no
/// angle need be computed.
const LEAST_SOLID_ANGLE: f64 = 3e-3;

/// See [`translucid_scene::Light::Rectangle`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    pub(crate) corner: Vec3,
    /// Unit vectors along the edges, and the normal on the side that emits.
    pub(crate) x: Vec3,
    pub(crate) y: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) size: [f32; 2],
    pub(crate) radiance: Vec3,
    pub(super) luminance: f32,
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
        let luminance = luminance(radiance);
        valid.then_some(Self { corner, x, y, normal, size, radiance, luminance, visible })
    }

    /// Unit normal on the side that emits.
    pub(crate) fn normal(&self) -> Vec3 {
        self.normal
    }

    pub(super) fn area(&self) -> f32 {
        self.size[0] * self.size[1]
    }

    /// Emitted power (luminance).
    pub(crate) fn power(&self) -> f32 {
        std::f32::consts::PI * self.area() * self.luminance
    }

    pub(crate) fn bounds(&self) -> LightBounds {
        let (a, x, y) = (self.corner, self.x * self.size[0], self.y * self.size[1]);
        let corners = [a, a + x, a + y, a + x + y];
        let low = corners.into_iter().fold(a, Vec3::min);
        let high = corners.into_iter().fold(a, Vec3::max);
        LightBounds::one_sided(low, high, self.normal, self.area() * self.luminance)
    }

    /// Estimate of the irradiance; 0 only if the point is behind the rectangle or the rectangle below the
    /// horizon.
    #[inline]
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let corner = self.local_corner(receiver.point);
        let highest = if receiver.has_normal() { self.highest(receiver) } else { f32::INFINITY };
        // A NaN passes, so that no light is lost by overflow.
        if corner.z >= 0.0 || highest <= 0.0 {
            return 0.0;
        }
        // In double precision cubes of distances neither overflow nor vanish.
        let [x, y, z] = corner.as_dvec3().to_array();
        let [width, height] = self.size.map(f64::from);
        let outside = |begin: f64, size: f64| begin.max(0.0).max(-(begin + size));
        let (to_x, to_y) = (outside(x, width), outside(y, height));
        let nearest2 = to_x * to_x + to_y * to_y + z * z;
        let (middle_x, middle_y) = (x + 0.5 * width, y + 0.5 * height);
        let middle = (middle_x * middle_x + middle_y * middle_y + z * z).sqrt();
        // Solid angle, seen from afar A cos/d², from near up to 2π; and the height of the highest corner above the
        // horizon over the distance of the middle, at most 1.
        let flux = width * height * -z;
        let cosine_distance = f64::from(highest).min(middle);
        let solid_angle_cosine = flux * cosine_distance / (middle * (nearest2 * middle + flux * (1.0 / TAU)));
        (self.luminance * solid_angle_cosine as f32).max(f32::MIN_POSITIVE)
    }

    /// Height of the highest corner above the horizon.
    fn highest(&self, receiver: &Receiver) -> f32 {
        let rise = |edge: Vec3, size: f32| (receiver.normal.dot(edge) * size).max(0.0);
        receiver.normal.dot(self.corner - receiver.point)
            + rise(self.x, self.size[0])
            + rise(self.y, self.size[1])
    }

    /// Draws a direction; the selection is not in its density.
    pub(crate) fn sample(&self, point: Vec3, v: [f32; 2]) -> Option<LightSample> {
        let view = LocalRectangle::new(self.local_corner(point), self.size)?;
        let (offset, pdf) = match view.spherical() {
            Some(spherical) => (spherical.sample(&view, v), 1.0 / spherical.solid_angle as f32),
            None => view.sample_area(v),
        };
        let distance = offset.length();
        let local = (offset / distance).as_vec3();
        let direction = self.x * local.x + self.y * local.y + self.normal * local.z;
        Some(LightSample::new(direction, distance as f32, self.radiance, pdf))
    }

    /// Solid-angle density with which `sample` makes the direction from `point` to `hit`.
    pub(crate) fn pdf(&self, point: Vec3, hit: Vec3) -> f32 {
        let Some(view) = LocalRectangle::new(self.local_corner(point), self.size) else { return 0.0 };
        if let Some(spherical) = view.spherical() {
            return 1.0 / spherical.solid_angle as f32;
        }
        let offset = hit - point;
        let local = Vec3::new(offset.dot(self.x), offset.dot(self.y), offset.dot(self.normal));
        view.area_pdf(local.as_dvec3())
    }

    /// Distance at which a ray meets the emitting side.
    pub(crate) fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let approach = direction.dot(self.normal);
        if approach >= 0.0 {
            return None;
        }
        let to_corner = self.corner - origin;
        let t = to_corner.dot(self.normal) / approach;
        // A NaN fails the comparison.
        if !(t > 0.0 && t.is_finite()) {
            return None;
        }
        let on_plane = direction * t - to_corner;
        let (x, y) = (on_plane.dot(self.x), on_plane.dot(self.y));
        let inside = (0.0..=self.size[0]).contains(&x) && (0.0..=self.size[1]).contains(&y);
        inside.then_some(t)
    }

    /// The corner as seen from a point, in the rectangle's frame.
    pub(super) fn local_corner(&self, point: Vec3) -> Vec3 {
        let offset = self.corner - point;
        Vec3::new(offset.dot(self.x), offset.dot(self.y), offset.dot(self.normal))
    }
}

/// A rectangle as it is seen from a point, in the rectangle's frame; double precision because angles nearly cancel.
pub(super) struct LocalRectangle {
    pub(super) x0: f64,
    pub(super) x1: f64,
    pub(super) y0: f64,
    pub(super) y1: f64,
    /// Height of the rectangle's plane, < 0.
    pub(super) z0: f64,
}

impl LocalRectangle {
    /// `corner` relative to the point; none if the point is not in front.
    #[inline]
    pub(super) fn new(corner: Vec3, size: [f32; 2]) -> Option<Self> {
        let corner = corner.as_dvec3();
        let (x0, y0, z0) = (corner.x, corner.y, corner.z);
        let (x1, y1) = (x0 + f64::from(size[0]), y0 + f64::from(size[1]));
        (z0 < 0.0 && corner.is_finite()).then_some(Self { x0, x1, y0, y1, z0 })
    }

    pub(super) fn area(&self) -> f64 {
        (self.x1 - self.x0) * (self.y1 - self.y0)
    }

    /// The projection on the unit sphere, unless it is small.
    #[inline]
    pub(super) fn spherical(&self) -> Option<SphericalRectangle> {
        // Area × cosine / distance² at the nearest point is no less than the solid angle.
        let outside = |begin: f64, end: f64| begin.max(0.0).max(-end);
        let (x, y) = (outside(self.x0, self.x1), outside(self.y0, self.y1));
        let nearest2 = x * x + y * y + self.z0 * self.z0;
        let looks_large = self.area() * -self.z0 > LEAST_SOLID_ANGLE * nearest2 * nearest2.sqrt();
        let spherical = looks_large.then(|| SphericalRectangle::new(self));
        // A strip seen end on still looks small, and would be lost in rounding.
        spherical.filter(|spherical| spherical.solid_angle >= 1e-3 * LEAST_SOLID_ANGLE)
    }

    /// Offset from the point to a point of the rectangle, uniform in area, and its solid-angle density.
    fn sample_area(&self, v: [f32; 2]) -> (DVec3, f32) {
        let x = self.x0 + f64::from(v[0]) * (self.x1 - self.x0);
        let y = self.y0 + f64::from(v[1]) * (self.y1 - self.y0);
        let offset = DVec3::new(x, y, self.z0);
        (offset, self.area_pdf(offset))
    }

    /// Sines of the elevations of two points of the line at x, seen from the point.
    #[inline]
    pub(super) fn sines(&self, x: f64, ends: [f64; 2]) -> [f64; 2] {
        let d2 = x * x + self.z0 * self.z0;
        ends.map(|y| y / (d2 + y * y).sqrt())
    }

    /// The point of the line at x between two ends that lies at a share of the way in the sine of the elevation: uniform in
    /// solid angle over a narrow strip.
    #[inline]
    pub(super) fn on_line(&self, x: f64, ends: [f64; 2], share: f64) -> DVec3 {
        let [h0, h1] = self.sines(x, ends);
        let h = h0 + share * (h1 - h0);
        let d2 = x * x + self.z0 * self.z0;
        let y = (h * (d2 / (1.0 - h * h).max(1e-300)).sqrt()).clamp(ends[0], ends[1]);
        DVec3::new(x, y, self.z0)
    }

    /// Solid-angle density of `sample_area`.
    pub(super) fn area_pdf(&self, offset: DVec3) -> f32 {
        let distance2 = offset.length_squared();
        (distance2 * distance2.sqrt() / (-self.z0 * self.area())) as f32
    }
}

/// A rectangle projected on the unit sphere, in the names of the paper.
///
/// Where the paper adds angles, here numbers e^iγ are multiplied: one arc tangent does for four arc cosines.
pub(super) struct SphericalRectangle {
    /// z of the normals of the planes through the edges y0 and y1.
    b0: f64,
    b1: f64,
    /// Cosine and sine of k = 2π − γ₂ − γ₃.
    k: [f64; 2],
    pub(super) solid_angle: f64,
}

impl SphericalRectangle {
    #[inline]
    pub(super) fn new(view: &LocalRectangle) -> Self {
        let z2 = view.z0 * view.z0;
        let normal_z = |edge: f64| edge / (z2 + edge * edge).sqrt();
        let (n0, n1, n2, n3) = (-normal_z(view.y0), normal_z(view.x1), normal_z(view.y1), -normal_z(view.x0));
        // e^iγ of γ = acos(−a b), an inner angle of the spherical rectangle.
        let corner = |a: f64, b: f64| [-a * b, (1.0 - (a * b) * (a * b)).max(0.0).sqrt()];
        let first = times(corner(n0, n1), corner(n1, n2));
        let second = times(corner(n2, n3), corner(n3, n0));
        // The sum of the angles is 2π more than the solid angle, which lies in (0, 2π).
        let [cos, sin] = times(first, second);
        let angle = libm::atan2(sin, cos);
        // Just below 0 it is rounding, and so small that it counts as none.
        let solid_angle = if angle < -1e-9 { angle + TAU } else { angle };
        Self { b0: n0, b1: n2, k: [second[0], -second[1]], solid_angle }
    }

    /// Offset from the point to a point of the rectangle, uniform in solid angle.
    #[inline]
    fn sample(&self, view: &LocalRectangle, v: [f32; 2]) -> DVec3 {
        let x = self.x_at(view, f64::from(v[0]));
        view.on_line(x, [view.y0, view.y1], f64::from(v[1]))
    }

    /// The x up to which so great a share of the solid angle lies.
    #[inline]
    pub(super) fn x_at(&self, view: &LocalRectangle, share: f64) -> f64 {
        let (sin, cos) = libm::sincos(share * self.solid_angle);
        let [cos_au, sin_au] = times([cos, sin], self.k);
        let fu = (cos_au * self.b0 - self.b1) / sin_au;
        let cu = (1.0_f64.copysign(fu) / (fu * fu + self.b0 * self.b0).sqrt()).clamp(-1.0, 1.0);
        (-(cu * view.z0) / (1.0 - cu * cu).max(1e-300).sqrt()).clamp(view.x0, view.x1)
    }
}

/// Product of two complex numbers.
#[inline]
fn times([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}
