//! The tangent plane of a body at the exit point of a walk: near it most flights end on surfaces.
//!
//! Let a flight from below the plane in a direction ω get to it after d_p(ω), and to the surface after d_s(ω). With
//!
//! ```text
//! φ = e^{−σ_t max(d_p − d_s, 0)}      on surfaces
//! φ = 1 beyond the plane, 0 below     inside
//! ```
//!
//! and 0 in directions that lead away from the plane, the integral of KVφ over all ends of flights in that direction is
//! e^{−σ_t d_p}/4π for any surface, if all of them end. Over all directions it is E₂(σ_t h)/2, where h is the distance of
//! the plane.

use glam::Vec3;

use super::attenuation::{attenuation, exponential_integral_2};
use super::flight_kernel::FlightKernel;
use crate::subsurface::transport::gathering::{COORDINATES, LANES};
use crate::subsurface::transport::simd_loop::{SimdLoop, in_widest_vectors};

/// Longest way \[L\] that counts; nothing passes it.
const LONGEST: f32 = 1e18;

/// A plane above the start of flights.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExitPlane {
    /// Unit vector toward it; 0 where the flights start above it.
    normal: Vec3,
    /// Its distance \[L\].
    height: f32,
}

impl ExitPlane {
    /// The plane through a point, with a unit normal that points outward, as seen from the start of flights.
    pub(super) fn new(on: Vec3, normal: Vec3, from: Vec3) -> Self {
        let height = (on - from).dot(normal);
        if height > 0.0 { Self { normal, height } } else { Self { normal: Vec3::ZERO, height: LONGEST } }
    }

    /// Part of the flights that would pass it in an infinite medium, by channel.
    pub(super) fn flights_beyond(&self, kernel: &FlightKernel) -> Vec3 {
        if self.normal == Vec3::ZERO {
            return Vec3::ZERO;
        }
        Vec3::from_array(kernel.sigma_t().map(|sigma_t| 0.5 * exponential_integral_2(sigma_t * self.height)))
    }

    /// φ at places, one channel after the other; those from `split` on are on surfaces.
    pub(super) fn fill(
        &self,
        kernel: &FlightKernel,
        places: [&[f32]; COORDINATES],
        split: usize,
        part: &mut [f32],
    ) {
        in_widest_vectors(PlaneParts {
            normal: self.normal.to_array(),
            height: self.height,
            from: kernel.from().to_array(),
            sigma_t: kernel.sigma_t(),
            places,
            split,
            part,
        });
    }
}

/// φ at places.
struct PlaneParts<'a> {
    normal: [f32; 3],
    height: f32,
    from: [f32; 3],
    sigma_t: [f32; 3],
    places: [&'a [f32]; COORDINATES],
    split: usize,
    part: &'a mut [f32],
}

impl SimdLoop for PlaneParts<'_> {
    #[inline(always)]
    fn run(self) {
        let part = self.part.as_chunks_mut::<LANES>().0;
        let n = part.len() / 3;
        let (red, rest) = part.split_at_mut(n);
        let (green, blue) = rest.split_at_mut(n);
        let (green, blue) = (&mut green[..n], &mut blue[..n]);
        let [x, y, z, ..] = self.places.map(|column| &column.as_chunks::<LANES>().0[..n]);
        let ([from_x, from_y, from_z], [a, b, c]) = (self.from, self.normal);
        let [red_sigma, green_sigma, blue_sigma] = self.sigma_t;
        // The way to a place, and its length toward the plane
        let way = |i: usize, k: usize| [x[i][k] - from_x, y[i][k] - from_y, z[i][k] - from_z];
        let up = |[x, y, z]: [f32; 3]| a * x + b * y + c * z;
        let split = (self.split / LANES).min(n);
        for i in 0..split {
            for k in 0..LANES {
                let is_beyond = if up(way(i, k)) > self.height { 1.0 } else { 0.0 };
                (red[i][k], green[i][k], blue[i][k]) = (is_beyond, is_beyond, is_beyond);
            }
        }
        for i in split..n {
            for k in 0..LANES {
                let way = way(i, k);
                let up = up(way);
                // d_p − d_s, both of which are in proportion to the way
                let d = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
                let more = (d * ((self.height - up) / up.max(1.0 / LONGEST))).clamp(0.0, LONGEST);
                let toward = if up > 0.0 { 1.0 } else { 0.0 };
                red[i][k] = toward * attenuation(red_sigma * more);
                green[i][k] = toward * attenuation(green_sigma * more);
                blue[i][k] = toward * attenuation(blue_sigma * more);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::super::flight_kernel::FlightPlace;
    use super::super::tilt::Tilt;
    use super::*;

    const SIGMA_T: Vec3 = Vec3::new(0.5, 2.0, 5.0);

    /// K and φ by channel at a place.
    fn kernel_and_part(kernel: &FlightKernel, plane: &ExitPlane, place: &FlightPlace) -> (Vec3, Vec3) {
        let columns = place.coordinates().map(|x| [x; LANES]);
        let places = columns.each_ref().map(<[f32; LANES]>::as_slice);
        let (mut row, mut part, mut sums) = ([0.0; 3 * LANES], [0.0; 3 * LANES], [0.0; LANES]);
        kernel.fill(places, &mut row, &mut sums);
        plane.fill(kernel, places, if place.normal == Vec3::ZERO { LANES } else { 0 }, &mut part);
        let first = |all: [f32; 3 * LANES]| Vec3::new(all[0], all[LANES], all[2 * LANES]);
        (first(row), first(part))
    }

    /// ∫ Kφ over the ends of flights in a body whose surface is in part beyond the plane and in part before it.
    #[test]
    fn integral_does_not_depend_on_the_surface() {
        let from = Vec3::new(0.3, -0.2, 0.1);
        let kernel = FlightKernel::new(from, SIGMA_T, Vec3::ONE, Tilt::NONE, 1.0);
        let plane = ExitPlane::new(from + Vec3::new(5.0, 3.0, 0.4), Vec3::Z, from);
        let exact = plane.flights_beyond(&kernel);
        // Rotated about the normal: distance of the surface by the angle from the plane's normal
        for surface in [|_| 2.0, |t: f32| 0.2 + 0.1 * t, |t: f32| 0.5 + 0.3 * (3.0 * t).sin()] {
            let (mut sum, n) = (glam::DVec3::ZERO, 2_000_u16);
            for i in 0..n {
                let t = (f32::from(i) + 0.5) / f32::from(n) * std::f32::consts::PI;
                let direction = Vec3::new(t.sin(), 0.0, t.cos());
                let solid_angle = TAU * t.sin() * std::f32::consts::PI / f32::from(n);
                let end: f32 = surface(t);
                // A facet across the way: cos θ dA = d² dω
                let place = FlightPlace { position: from + direction * end, normal: direction };
                let (k, part) = kernel_and_part(&kernel, &plane, &place);
                sum += (k * part * (solid_angle * end * end)).as_dvec3();
                let steps = 200_u16;
                for j in 0..steps {
                    let d = (f32::from(j) + 0.5) / f32::from(steps) * end;
                    let place = FlightPlace { position: from + direction * d, normal: Vec3::ZERO };
                    let (k, part) = kernel_and_part(&kernel, &plane, &place);
                    sum += (k * part * (solid_angle * d * d * end / f32::from(steps))).as_dvec3();
                }
            }
            // The step at the plane is met to half of one of 200
            assert!((sum - exact.as_dvec3()).abs().max_element() < 2e-4, "{sum} {exact}");
        }
    }

    #[test]
    fn starts_above_the_plane_have_no_part() {
        let from = Vec3::Z;
        let kernel = FlightKernel::new(from, SIGMA_T, Vec3::ONE, Tilt::NONE, 1.0);
        for height in [0.0, -1.0, f32::NAN] {
            let plane = ExitPlane::new(from + Vec3::Z * height, Vec3::Z, from);
            assert_eq!(plane.flights_beyond(&kernel), Vec3::ZERO);
            for normal in [Vec3::ZERO, Vec3::Z] {
                for position in [from, from + Vec3::Z, Vec3::splat(1e18)] {
                    let place = FlightPlace { position, normal };
                    assert_eq!(kernel_and_part(&kernel, &plane, &place).1, Vec3::ZERO, "{height} {place:?}");
                }
            }
        }
    }

    #[test]
    fn extremes_stay_between_0_and_1() {
        for sigma_t in [Vec3::splat(1e5), Vec3::splat(1e-5), Vec3::new(0.0, 1e-5, 1e5)] {
            let kernel = FlightKernel::new(Vec3::ZERO, sigma_t, Vec3::ONE, Tilt::NONE, 1.0);
            for height in [1e-30, 1e-12, 1.0, 1e10] {
                let plane = ExitPlane::new(Vec3::Z * height, Vec3::Z, Vec3::ZERO);
                for position in [Vec3::ZERO, Vec3::Z * 1e-30, Vec3::X, Vec3::splat(1e18), -Vec3::Z] {
                    for normal in [Vec3::ZERO, Vec3::Z] {
                        let (_, part) = kernel_and_part(&kernel, &plane, &FlightPlace { position, normal });
                        assert!(part.cmpge(Vec3::ZERO).all() && part.cmple(Vec3::ONE).all(), "{part}");
                    }
                }
            }
        }
    }
}
