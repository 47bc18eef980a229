//! Camera rays: perspective, thin lens, pixel filter.

use glam::{DVec3, Vec3};
use translucid_scene::{Camera, Film, FilterKind};

use crate::ray::Ray;
use crate::sampling::{Frame, concentric_disk};

/// Entries of the inverse filter table.
const FILTER_TABLE: usize = 2048;

/// A camera prepared for an image size, with its pixel filter.
///
/// The filter is sampled in proportion to its (positive) values, so every sample belongs to one pixel
/// with weight one: pixels are independent of each other and of the order of work.
pub(crate) struct CameraRays {
    position: Vec3,
    frame: Frame,
    /// Half the image plane's width and height at distance 1.
    half_width: f32,
    half_height: f32,
    width: f32,
    height: f32,
    lens_radius: f32,
    focus_distance: f32,
    /// Inverse cdf of the filter over [0, 1]: offsets in pixels.
    filter: Box<[f32; FILTER_TABLE + 1]>,
}

impl CameraRays {
    pub(crate) fn new(camera: &Camera, film: &Film) -> Self {
        // In double precision: squares of the least and the greatest lengths.
        let view = (camera.target.as_dvec3() - camera.position.as_dvec3()).normalize();
        let right = view.cross(camera.up.as_dvec3()).try_normalize();
        let forward = view.as_vec3();
        let x = right.map_or_else(|| Frame::from_normal(forward).x, DVec3::as_vec3);
        let (width, height) = (film.width as f32, film.height as f32);
        let half_width = (camera.horizontal_fov.to_radians() * 0.5).tan();
        Self {
            position: camera.position,
            frame: Frame { x, y: forward.cross(x), z: forward },
            half_width,
            half_height: half_width * height / width,
            width,
            height,
            lens_radius: camera.lens_radius,
            focus_distance: camera.focus_distance,
            filter: inverse_filter(film.filter, film.filter_radius),
        }
    }

    /// A ray through the pixel (x, y) with its origin on the lens.
    pub(crate) fn ray(&self, x: u32, y: u32, u: [f32; 4]) -> Ray {
        let px = (x as f32 + 0.5 + self.filter_offset(u[0])) / self.width * 2.0 - 1.0;
        let py = (y as f32 + 0.5 + self.filter_offset(u[1])) / self.height * 2.0 - 1.0;
        let local = Vec3::new(px * self.half_width, py * self.half_height, 1.0);
        if self.lens_radius == 0.0 {
            return Ray::new(self.position, self.frame.to_world(local).normalize());
        }
        let [lens_x, lens_y] = concentric_disk([u[2], u[3]]);
        let lens = Vec3::new(lens_x, lens_y, 0.0) * self.lens_radius;
        let focus = local.as_dvec3() * f64::from(self.focus_distance);
        let direction = (focus - lens.as_dvec3()).normalize().as_vec3();
        let origin = self.position + self.frame.to_world(lens);
        Ray::new(origin, self.frame.to_world(direction).normalize())
    }

    fn filter_offset(&self, u: f32) -> f32 {
        let place = u * FILTER_TABLE as f32;
        let index = (place as usize).min(FILTER_TABLE - 1);
        let fraction = place - index as f32;
        self.filter[index] * (1.0 - fraction) + self.filter[index + 1] * fraction
    }
}

/// Offsets at which the filter's cdf is 0, 1/n, … 1.
fn inverse_filter(kind: FilterKind, radius: f32) -> Box<[f32; FILTER_TABLE + 1]> {
    const FINE: usize = 1 << 14;
    let value = |t: f64| match kind {
        FilterKind::Box => 1.0,
        FilterKind::Gaussian => (-0.5 * (3.0 * t).powi(2)).exp(),
        FilterKind::BlackmanHarris => {
            // Four-term window [Harris 1978, table I, 92 dB].
            let a = std::f64::consts::PI * (t + 1.0);
            0.35875 - 0.48829 * a.cos() + 0.14128 * (2.0 * a).cos() - 0.01168 * (3.0 * a).cos()
        }
    };
    let mut cumulative = vec![0.0; FINE + 1];
    for i in 0..FINE {
        let t = (i as f64 + 0.5) / FINE as f64 * 2.0 - 1.0;
        cumulative[i + 1] = cumulative[i] + value(t);
    }
    let total = cumulative[FINE];
    Box::new(std::array::from_fn(|k| {
        let goal = total * k as f64 / FILTER_TABLE as f64;
        let i = cumulative.partition_point(|&c| c < goal).clamp(1, FINE);
        let fraction = (goal - cumulative[i - 1]) / (cumulative[i] - cumulative[i - 1]);
        let t = (i as f64 - 1.0 + fraction.clamp(0.0, 1.0)) / FINE as f64 * 2.0 - 1.0;
        t as f32 * radius
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            position: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            horizontal_fov: 90.0,
            lens_radius: 0.0,
            focus_distance: 5.0,
        }
    }

    fn film(filter: FilterKind, filter_radius: f32) -> Film {
        Film { width: 200, height: 100, filter, filter_radius, ..Film::default() }
    }

    #[test]
    fn ray_spans_the_field_of_view_upright() {
        let rays = CameraRays::new(&camera(), &film(FilterKind::Box, 0.5));
        let left = rays.ray(0, 50, [0.0, 0.0, 0.5, 0.5]).direction;
        assert!((left.x / -left.z + 1.0).abs() < 1e-5, "x = −tan 45° at the left edge: {left}");
        let top = rays.ray(100, 0, [0.0, 0.0, 0.5, 0.5]).direction;
        assert!(top.y > 0.0 && (top.y / -top.z - 0.5).abs() < 1e-5, "row 0 is the top: {top}");
    }

    #[test]
    fn ray_meets_the_focus_point_from_all_of_the_lens() {
        let lens = Camera { lens_radius: 0.4, ..camera() };
        let rays = CameraRays::new(&lens, &film(FilterKind::Box, 0.5));
        let sharp = CameraRays::new(&camera(), &film(FilterKind::Box, 0.5)).ray(30, 20, [0.3, 0.6, 0.0, 0.0]);
        let point = sharp.at(5.0 / -sharp.direction.z);
        for (a, b) in [(0.1, 0.2), (0.9, 0.4), (0.5, 0.99)] {
            let ray = rays.ray(30, 20, [0.3, 0.6, a, b]);
            let distance = (point - ray.origin).cross(ray.direction).length();
            assert!(distance < 1e-4, "{distance}");
        }
    }

    #[test]
    fn ray_has_a_direction_for_every_lens_and_view() {
        let film = film(FilterKind::Box, 0.5);
        let extents = [f32::from_bits(1), 1e-40, 1e-20, 1.0, 1e9];
        for (lens_radius, focus_distance, fov) in extents.into_iter().flat_map(|lens| {
            extents.into_iter().flat_map(move |focus| [1e-40, 179.999].map(|fov| (lens, focus, fov)))
        }) {
            for target in [Vec3::new(0.0, 0.0, 5.0 - 5e-7), Vec3::new(1e-30, 0.0, 0.0), Vec3::splat(1e9)] {
                let position = if target.x == 1e-30 { Vec3::ZERO } else { Vec3::new(0.0, 0.0, 5.0) };
                let camera =
                    Camera { position, target, lens_radius, focus_distance, horizontal_fov: fov, ..camera() };
                let ray = CameraRays::new(&camera, &film).ray(7, 93, [0.1, 0.9, 0.3, 0.8]);
                assert!(ray.direction.is_normalized() && ray.origin.is_finite(), "{camera:?}");
            }
        }
    }

    #[test]
    fn filter_has_the_variance_of_its_shape() {
        // Variances over [−1, 1]. Box: 1/3. Gaussian cut at 3σ: (1 − 6φ(3)/(2Φ(3) − 1))/9.
        // Blackman–Harris: 1/3 + Σ (−1)ⁿ 2aₙ/(a₀ π² n²) with the signed window coefficients aₙ about t = 0.
        for (kind, expected) in [
            (FilterKind::Box, 1.0 / 3.0),
            (FilterKind::Gaussian, 0.108_148),
            (FilterKind::BlackmanHarris, 0.0767371),
        ] {
            let rays = CameraRays::new(&camera(), &film(kind, 1.0));
            let n = 100_000;
            let variance = (0..n)
                .map(|i| f64::from(rays.filter_offset((i as f32 + 0.5) / n as f32)).powi(2))
                .sum::<f64>()
                / f64::from(n);
            assert!((variance / expected - 1.0).abs() < 2e-3, "{kind:?}: {variance}");
        }
    }
}
