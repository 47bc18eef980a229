//! Views of a prepared scene: a camera, a film, a region of it, a seed.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use translucid_image::PixelRect;
use translucid_scene::{Camera, Film, FilterKind, Projection, Scene, SceneError};

use crate::ray::Ray;
use crate::sampling::{Frame, concentric_disk};
use crate::world::PixelWidth;

/// Entries of the inverse filter table.
pub(crate) const FILTER_TABLE: usize = 2048;

/// Offsets in pixels at which a filter's cdf is 0, 1/n, … 1.
type InverseFilter = [f32; FILTER_TABLE + 1];

/// A part of the resolution, for a first look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fraction {
    /// Every pixel.
    #[default]
    Whole,
    /// One pixel for each square of 2×2.
    Half,
    /// One pixel for each square of 4×4.
    Quarter,
    /// One pixel for each square of 8×8.
    Eighth,
}

impl Fraction {
    /// Pixels of the film along the edge of one pixel.
    pub fn divisor(self) -> u32 {
        match self {
            Self::Whole => 1,
            Self::Half => 2,
            Self::Quarter => 4,
            Self::Eighth => 8,
        }
    }
}

/// A camera and a film, ready to make rays; changing them prepares nothing of the scene.
///
/// The filter is sampled in proportion to its (positive) values, so every sample belongs to one pixel
/// with weight one: pixels are independent of each other and of the order of work.
#[derive(Clone, Debug)]
pub struct View {
    camera: Camera,
    film: Film,
    seed: u64,
    region: PixelRect,
    fraction: Fraction,
    frame: Frame,
    /// Half the width and height of the picture at depth 1, and the point in its middle.
    half_width: f32,
    half_height: f32,
    middle: [f32; 2],
    /// Width and height in pixels of the film, and the edge of a pixel in these.
    size: [f32; 2],
    step: f32,
    filter: Arc<InverseFilter>,
}

impl View {
    /// The whole film of a camera; `seed` is that of all random numbers.
    ///
    /// # Errors
    /// A number of camera or film is out of its range.
    pub fn new(camera: Camera, film: Film, seed: u64) -> Result<Self, SceneError> {
        camera.validate()?;
        film.validate()?;
        let filter = Arc::new(inverse_filter(film.filter, film.filter_radius));
        Ok(Self::with_filter(camera, film, seed, filter))
    }

    /// The view that a scene states.
    ///
    /// # Errors
    /// A number of camera or film is out of its range.
    pub fn of(scene: &Scene) -> Result<Self, SceneError> {
        Self::new(scene.camera, scene.film, scene.integrator.seed)
    }

    fn with_filter(camera: Camera, film: Film, seed: u64, filter: Arc<InverseFilter>) -> Self {
        // In double precision: squares of the least and the greatest lengths.
        let view = (camera.target.as_dvec3() - camera.position.as_dvec3()).normalize();
        let right = view.cross(camera.up.as_dvec3()).try_normalize();
        let forward = view.as_vec3();
        let x = right.map_or_else(|| Frame::from_normal(forward).x, DVec3::as_vec3);
        let (width, height) = (film.width as f32, film.height as f32);
        let half_width = match camera.projection {
            Projection::Perspective { horizontal_fov } => libm::tanf(horizontal_fov.to_radians() * 0.5),
            Projection::Orthographic { width } => 0.5 * width,
        };
        Self {
            region: PixelRect::whole([film.width, film.height]),
            fraction: Fraction::Whole,
            frame: Frame { x, y: forward.cross(x), z: forward },
            half_width,
            half_height: half_width * height / width,
            middle: [camera.shift.x, -camera.shift.y].map(|widths| 2.0 * half_width * widths),
            size: [width, height],
            step: 1.0,
            filter,
            camera,
            film,
            seed,
        }
    }

    /// The view with another camera.
    ///
    /// # Errors
    /// A number of the camera is out of its range.
    pub fn with_camera(&self, camera: Camera) -> Result<Self, SceneError> {
        camera.validate()?;
        let Self { region, fraction, step, .. } = *self;
        let new = Self::with_filter(camera, self.film, self.seed, Arc::clone(&self.filter));
        Ok(Self { region, fraction, step, ..new })
    }

    /// The view of a rectangle of pixels only, half-open: from (x0, y0) to just before (x1, y1). Its pixels are those of the
    /// whole picture, bit for bit.
    ///
    /// # Errors
    /// The region is empty, or reaches beyond the film.
    pub fn with_region(&self, [x0, y0, x1, y1]: [u32; 4]) -> Result<Self, SceneError> {
        let [width, height] = self.whole_size();
        if x0 >= x1 || y0 >= y1 || x1 > width || y1 > height {
            let message = format!(
                "region = {x0},{y0},{x1},{y1}: must be x0,y0,x1,y1 with 0 ≤ x0 < x1 ≤ {width} and 0 ≤ y0 < y1 ≤ {height}"
            );
            return Err(SceneError::new(message));
        }
        let region = PixelRect { left: x0, top: y0, width: x1 - x0, height: y1 - y0 };
        Ok(Self { region, ..self.clone() })
    }

    /// The view at a part of the resolution, its region along with it: as many pixels as cover the same picture.
    pub fn at(&self, fraction: Fraction) -> Self {
        let (from, to) = (self.fraction.divisor(), fraction.divisor());
        let first = |x: u32| x * from / to;
        let end = |x: u32| (x * from).div_ceil(to);
        let PixelRect { left, top, width, height } = self.region;
        let (x0, y0) = (first(left), first(top));
        let (x1, y1) = (end(left + width), end(top + height));
        let mut new = self.clone();
        new.fraction = fraction;
        new.step = to as f32;
        let [most_x, most_y] = new.whole_size();
        new.region = PixelRect { left: x0, top: y0, width: x1.min(most_x) - x0, height: y1.min(most_y) - y0 };
        new
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The film; at a fraction of the resolution still the whole one.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The pixels that are rendered.
    pub fn region(&self) -> PixelRect {
        self.region
    }

    /// Width and height in pixels of the whole picture that the region is a part of.
    pub fn whole_size(&self) -> [u32; 2] {
        [self.film.width, self.film.height].map(|edge| edge.div_ceil(self.fraction.divisor()))
    }

    /// Where the region lies in the whole picture, and that one's width and height; `None` where it is all of it.
    pub fn place(&self) -> Option<(PixelRect, [u32; 2])> {
        let whole = self.whole_size();
        (self.region != PixelRect::whole(whole)).then_some((self.region, whole))
    }

    /// Resolution of the picture.
    pub fn fraction(&self) -> Fraction {
        self.fraction
    }

    /// Frame of the camera, half the size of the picture and its middle at depth 1, size of the film, and edge of a pixel.
    pub(crate) fn projection(&self) -> (Frame, [f32; 2], [f32; 2], [f32; 2], f32) {
        (self.frame, [self.half_width, self.half_height], self.middle, self.size, self.step)
    }

    /// Offsets in pixels at which the filter's cdf is 0, 1/n, … 1.
    pub(crate) fn filter(&self) -> &[f32] {
        &*self.filter
    }

    /// Width of a pixel on the surface that it shows.
    pub(crate) fn pixel_width(&self) -> PixelWidth {
        let width = 2.0 * self.half_width / self.size[0] * self.step;
        match self.camera.projection {
            Projection::Perspective { .. } => PixelWidth::per_distance(width),
            Projection::Orthographic { .. } => PixelWidth::constant(width),
        }
    }

    /// A ray through the pixel (x, y) of the whole picture with its origin on the lens.
    pub(crate) fn ray(&self, x: u32, y: u32, u: [f32; 4]) -> Ray {
        let [width, height] = self.size;
        let Camera { lens_radius, focus_distance, .. } = self.camera;
        let px = (x as f32 + 0.5 + self.filter_offset(u[0])) * self.step / width * 2.0 - 1.0;
        let py = (y as f32 + 0.5 + self.filter_offset(u[1])) * self.step / height * 2.0 - 1.0;
        let (start, sight) = self.line_of_sight([px, py]);
        if lens_radius == 0.0 {
            return self.world_ray(start, sight);
        }
        let [lens_x, lens_y] = concentric_disk([u[2], u[3]]);
        let lens = Vec3::new(lens_x, lens_y, 0.0) * lens_radius;
        let focus = sight.as_dvec3() * f64::from(focus_distance);
        self.world_ray(start + lens, (focus - lens.as_dvec3()).normalize().as_vec3())
    }

    /// The ray from the middle of the lens through a point of the film, in pixels of the film from its upper left.
    pub(crate) fn ray_through(&self, [x, y]: [f32; 2]) -> Ray {
        let [width, height] = self.size;
        let (start, sight) = self.line_of_sight([x / width, y / height].map(|share| share * 2.0 - 1.0));
        self.world_ray(start, sight)
    }

    /// Start and direction, of depth 1, of the line of sight through a point of the picture, ±1 at its edges, in the
    /// camera's frame.
    fn line_of_sight(&self, [px, py]: [f32; 2]) -> (Vec3, Vec3) {
        let x = px * self.half_width + self.middle[0];
        let y = py * self.half_height + self.middle[1];
        match self.camera.projection {
            Projection::Perspective { .. } => (Vec3::ZERO, Vec3::new(x, y, 1.0)),
            Projection::Orthographic { .. } => (Vec3::new(x, y, 0.0), Vec3::Z),
        }
    }

    fn world_ray(&self, start: Vec3, direction: Vec3) -> Ray {
        let origin = self.camera.position + self.frame.to_world(start);
        Ray::new(origin, self.frame.to_world(direction).normalize())
    }

    fn filter_offset(&self, u: f32) -> f32 {
        let place = u * FILTER_TABLE as f32;
        let index = (place as usize).min(FILTER_TABLE - 1);
        let fraction = place - index as f32;
        self.filter[index] * (1.0 - fraction) + self.filter[index + 1] * fraction
    }
}

fn inverse_filter(kind: FilterKind, radius: f32) -> InverseFilter {
    const FINE: usize = 1 << 14;
    let value = |t: f64| match kind {
        FilterKind::Box => 1.0,
        FilterKind::Gaussian => libm::exp(-0.5 * (3.0 * t).powi(2)),
        FilterKind::BlackmanHarris => {
            // Four-term window [Harris 1978, table I, 92 dB].
            let a = std::f64::consts::PI * (t + 1.0);
            0.35875 - 0.48829 * libm::cos(a) + 0.14128 * libm::cos(2.0 * a) - 0.01168 * libm::cos(3.0 * a)
        }
    };
    let mut cumulative = vec![0.0; FINE + 1];
    for i in 0..FINE {
        let t = (i as f64 + 0.5) / FINE as f64 * 2.0 - 1.0;
        cumulative[i + 1] = cumulative[i] + value(t);
    }
    let total = cumulative[FINE];
    std::array::from_fn(|k| {
        let goal = total * k as f64 / FILTER_TABLE as f64;
        let i = cumulative.partition_point(|&c| c < goal).clamp(1, FINE);
        let fraction = (goal - cumulative[i - 1]) / (cumulative[i] - cumulative[i - 1]);
        let t = (i as f64 - 1.0 + fraction.clamp(0.0, 1.0)) / FINE as f64 * 2.0 - 1.0;
        t as f32 * radius
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    fn camera() -> Camera {
        Camera {
            position: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Perspective { horizontal_fov: 90.0 },
            ..Camera::default()
        }
    }

    fn film(filter: FilterKind, filter_radius: f32) -> Film {
        Film { width: 200, height: 100, filter, filter_radius, ..Film::default() }
    }

    fn view(camera: Camera, film: Film) -> View {
        View::new(camera, film, 0).expect("camera and film are valid")
    }

    #[test]
    fn ray_spans_the_field_of_view_upright() {
        let rays = view(camera(), film(FilterKind::Box, 0.5));
        let left = rays.ray(0, 50, [0.0, 0.0, 0.5, 0.5]).direction;
        assert!((left.x / -left.z + 1.0).abs() < 1e-5, "x = −tan 45° at the left edge: {left}");
        let top = rays.ray(100, 0, [0.0, 0.0, 0.5, 0.5]).direction;
        assert!(top.y > 0.0 && (top.y / -top.z - 0.5).abs() < 1e-5, "row 0 is the top: {top}");
    }

    /// Cameras of both projections, seen along an oblique axis, with and without shift.
    fn cameras() -> impl Iterator<Item = Camera> {
        let projections =
            [Projection::Perspective { horizontal_fov: 50.0 }, Projection::Orthographic { width: 6.0 }];
        let shifts = [Vec2::ZERO, Vec2::new(0.3, -0.7)];
        projections.into_iter().flat_map(move |projection| {
            shifts.map(|shift| Camera {
                position: Vec3::new(3.0, -4.0, 5.0),
                target: Vec3::new(-1.0, 0.5, 0.25),
                up: Vec3::new(0.2, 0.9, 0.1),
                projection,
                shift,
                ..camera()
            })
        })
    }

    #[test]
    fn ray_goes_through_the_points_that_project_to_its_pixel() {
        for camera in cameras() {
            let rays = view(camera, film(FilterKind::Box, 0.5));
            let [position, target, up] = [camera.position, camera.target, camera.up].map(Vec3::as_dvec3);
            let forward = (target - position).normalize();
            let right = forward.cross(up).normalize();
            for (x, y, u, v) in [(0, 0, 0.0, 0.0), (199, 99, 0.99, 0.5), (30, 20, 0.25, 0.75)] {
                let ray = rays.ray(x, y, [u, v, 0.5, 0.5]);
                for distance in [0.5, 7.0] {
                    // The picture is 200 × 100; it shows so much at the depth of the point, and the axis is off its middle
                    let offset = ray.at(distance).as_dvec3() - position;
                    let depth = offset.dot(forward);
                    let width = match camera.projection {
                        Projection::Perspective { .. } => 2.0 * depth * 25f64.to_radians().tan(),
                        Projection::Orthographic { width } => f64::from(width),
                    };
                    let right = offset.dot(right) / width - f64::from(camera.shift.x);
                    let upward = offset.dot(right_angle(forward, up)) / width - f64::from(camera.shift.y);
                    let pixel = [100.0 + 200.0 * right, 50.0 - 200.0 * upward];
                    let expected = [f64::from(x) + f64::from(u), f64::from(y) + f64::from(v)];
                    let error = (pixel[0] - expected[0]).hypot(pixel[1] - expected[1]);
                    assert!(error < 1e-3, "{camera:?}: {pixel:?} is not {expected:?}");
                }
            }
        }
    }

    /// Unit vector nearest to `up` among those perpendicular to `forward`.
    fn right_angle(forward: DVec3, up: DVec3) -> DVec3 {
        (up - forward * up.dot(forward)).normalize()
    }

    #[test]
    fn orthographic_pictures_are_those_of_a_distant_perspective() {
        let camera = cameras().find(|camera| matches!(camera.projection, Projection::Orthographic { .. }));
        let camera = camera.expect("there is one");
        let film = film(FilterKind::Gaussian, 1.5);
        let backward = (camera.position - camera.target).as_dvec3().normalize();
        let far = 1e4;
        let position = (camera.position.as_dvec3() + backward * far).as_vec3();
        let horizontal_fov = 2.0 * (0.5 * 6.0 / far).atan().to_degrees();
        let projection = Projection::Perspective { horizontal_fov: horizontal_fov as f32 };
        let distant = view(Camera { position, projection, ..camera }, film);
        let near = view(camera, film);
        for (x, y) in [(0, 0), (150, 20), (60, 99)] {
            let [near, distant] = [&near, &distant].map(|rays| rays.ray(x, y, [0.2, 0.7, 0.5, 0.5]));
            assert!(near.direction.distance(distant.direction) < 1e-3);
            let off = (near.origin - distant.origin).cross(distant.direction).length();
            assert!(off < 0.01, "{off} of a picture of width 6");
        }
    }

    #[test]
    fn ray_meets_the_focus_point_from_all_of_the_lens() {
        // The widest lens is off by up to a pixel of the largest film, a 16,384th of the distance
        for (camera, (lens_radius, room)) in
            cameras().flat_map(|camera| [(0.4, 1e-4), (1280.0, 5.0 / 16384.0)].map(|lens| (camera, lens)))
        {
            let lens = Camera { lens_radius, focus_distance: 5.0, ..camera };
            let rays = view(lens, film(FilterKind::Box, 0.5));
            let sharp = view(camera, film(FilterKind::Box, 0.5)).ray(30, 20, [0.3, 0.6, 0.0, 0.0]);
            let forward = (camera.target - camera.position).normalize();
            let point = sharp.at(5.0 / sharp.direction.dot(forward));
            for (a, b) in [(0.1, 0.2), (0.9, 0.4), (0.5, 0.99)] {
                let ray = rays.ray(30, 20, [0.3, 0.6, a, b]);
                let [way, direction] = [point - ray.origin, ray.direction].map(Vec3::as_dvec3);
                let distance = way.cross(direction).length();
                assert!(distance < room, "{distance}");
                let most = 1.0001 * lens_radius + 1e-4;
                assert!(ray.origin.distance(sharp.origin) <= most && ray.origin != sharp.origin);
            }
        }
    }

    #[test]
    fn ray_has_a_direction_for_every_lens_and_view() {
        let film = film(FilterKind::Box, 0.5);
        let filter = Arc::new(inverse_filter(film.filter, film.filter_radius));
        let extents = [f32::from_bits(1), 1e-40, 1e-20, 1.0, 1e9];
        for (lens_radius, focus_distance, fov) in extents.into_iter().flat_map(|lens| {
            extents.into_iter().flat_map(move |focus| [1e-40, 179.999].map(|fov| (lens, focus, fov)))
        }) {
            for target in [Vec3::new(0.0, 0.0, 5.0 - 5e-7), Vec3::new(1e-30, 0.0, 0.0), Vec3::splat(1e9)] {
                let position = if target.x == 1e-30 { Vec3::ZERO } else { Vec3::new(0.0, 0.0, 5.0) };
                let camera = Camera { position, target, lens_radius, focus_distance, ..camera() };
                for projection in [
                    Projection::Perspective { horizontal_fov: fov },
                    Projection::Orthographic { width: focus_distance },
                ] {
                    for shift in [Vec2::ZERO, Vec2::new(-100.0, 100.0)] {
                        let camera = Camera { projection, shift, ..camera };
                        let view = View::with_filter(camera, film, 0, Arc::clone(&filter));
                        let ray = view.ray(7, 93, [0.1, 0.9, 0.3, 0.8]);
                        assert!(ray.direction.is_normalized() && ray.origin.is_finite(), "{camera:?}");
                    }
                }
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
            let rays = view(camera(), film(kind, 1.0));
            let n = 100_000;
            let variance = (0..n)
                .map(|i| f64::from(rays.filter_offset((i as f32 + 0.5) / n as f32)).powi(2))
                .sum::<f64>()
                / f64::from(n);
            assert!((variance / expected - 1.0).abs() < 2e-3, "{kind:?}: {variance}");
        }
    }
}
