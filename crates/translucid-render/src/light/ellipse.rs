//! One-sided elliptical light, sampled by strips of the rectangle around it.
//!
//! The rectangle is divided into strips of equal solid angle across its width, as in [Ureña, Fajardo & King 2013]; a strip is
//! drawn as often as a disk has area in it, and in it a direction uniform in solid angle. From afar that is uniform in solid
//! angle, and from near it differs little: no draw is in vain.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::{DVec3, Vec3};
use translucid_law::Receiver;

use super::LightSample;
use super::bounds::LightBounds;
use super::rectangle::{LocalRectangle, Rectangle, SphericalRectangle};
use crate::sampling::concentric_disk;

/// See [`translucid_scene::Light::Ellipse`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipse {
    /// The rectangle whose edges it touches in their middles.
    pub(crate) around: Rectangle,
}

impl Ellipse {
    /// None if it has no area or emits nothing.
    pub(crate) fn new(
        center: Vec3,
        edge_x: Vec3,
        edge_y: Vec3,
        radiance: Vec3,
        visible: bool,
    ) -> Option<Self> {
        Some(Self { around: Rectangle::new(center, edge_x, edge_y, radiance, visible)? })
    }

    pub(crate) fn radiance(&self) -> Vec3 {
        self.around.radiance
    }

    pub(crate) fn visible(&self) -> bool {
        self.around.visible
    }

    /// Unit normal on the side that emits.
    pub(crate) fn normal(&self) -> Vec3 {
        self.around.normal()
    }

    /// Emitted power (luminance).
    pub(crate) fn power(&self) -> f32 {
        FRAC_PI_4 as f32 * self.around.power()
    }

    pub(crate) fn bounds(&self) -> LightBounds {
        let LightBounds { low, high, strength, .. } = self.around.bounds();
        LightBounds::one_sided(low, high, self.normal(), FRAC_PI_4 as f32 * strength)
    }

    /// Estimate of the irradiance; 0 only where the rectangle around it cannot shine.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        FRAC_PI_4 as f32 * self.around.importance(receiver)
    }

    /// Draws a direction; the selection is not in its density.
    pub(crate) fn sample(&self, point: Vec3, v: [f32; 2]) -> Option<LightSample> {
        let view = LocalRectangle::new(self.around.local_corner(point), self.around.size)?;
        let [p, q] = concentric_disk(v).map(f64::from);
        let (offset, pdf) = match view.spherical() {
            Some(spherical) => {
                let share = 0.5 * (p + 1.0);
                let x = spherical.x_at(&view, share);
                let across = 0.5 * (q / (1.0 - p * p).max(1e-300).sqrt() + 1.0);
                let offset = view.on_line(x, chord(&view, x), across.clamp(0.0, 1.0));
                (offset, strip_pdf(&view, &spherical, x, share))
            }
            None => {
                let x = view.x0 + 0.5 * (p + 1.0) * (view.x1 - view.x0);
                let y = view.y0 + 0.5 * (q + 1.0) * (view.y1 - view.y0);
                let offset = DVec3::new(x, y, view.z0);
                (offset, view.area_pdf(offset) / FRAC_PI_4 as f32)
            }
        };
        let distance = offset.length();
        let local = (offset / distance).as_vec3();
        let Rectangle { x, y, normal, .. } = self.around;
        let direction = x * local.x + y * local.y + normal * local.z;
        Some(LightSample::new(direction, distance as f32, self.radiance(), pdf))
    }

    /// Solid-angle density with which `sample` makes the direction from `point` to `hit`.
    pub(crate) fn pdf(&self, point: Vec3, hit: Vec3) -> f32 {
        let Some(view) = LocalRectangle::new(self.around.local_corner(point), self.around.size) else {
            return 0.0;
        };
        let offset = hit - point;
        let Rectangle { x, y, normal, .. } = self.around;
        let local = Vec3::new(offset.dot(x), offset.dot(y), offset.dot(normal)).as_dvec3();
        match view.spherical() {
            Some(spherical) => {
                let left =
                    SphericalRectangle::new(&LocalRectangle { x1: local.x.clamp(view.x0, view.x1), ..view });
                let share = left.solid_angle / spherical.solid_angle;
                strip_pdf(&view, &spherical, local.x, share)
            }
            None => view.area_pdf(local) / FRAC_PI_4 as f32,
        }
    }

    /// Distance at which a ray meets the emitting side.
    pub(crate) fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let t = self.around.intersect(origin, direction)?;
        let Rectangle { x, y, size, .. } = self.around;
        let on_plane = direction * t - (self.around.corner - origin);
        let [p, q] = [on_plane.dot(x) / size[0], on_plane.dot(y) / size[1]].map(|at| 2.0 * at - 1.0);
        (p * p + q * q <= 1.0).then_some(t)
    }
}

/// Ends of the ellipse at x.
fn chord(view: &LocalRectangle, x: f64) -> [f64; 2] {
    let at = (2.0 * x - view.x0 - view.x1) / (view.x1 - view.x0);
    let half = 0.5 * (view.y1 - view.y0) * (1.0 - at * at).max(0.0).sqrt();
    let middle = 0.5 * (view.y0 + view.y1);
    [middle - half, middle + half]
}

/// Solid-angle density of the strip at x, up to which such a share of the rectangle's solid angle lies.
fn strip_pdf(view: &LocalRectangle, spherical: &SphericalRectangle, x: f64, share: f64) -> f32 {
    // A disk's density over its width
    let density = 8.0 / PI * (share * (1.0 - share)).max(0.0).sqrt();
    let [low, high] = view.sines(x, [view.y0, view.y1]);
    let [first, last] = view.sines(x, chord(view, x));
    (density * (high - low) / ((last - first) * spherical.solid_angle)) as f32
}
