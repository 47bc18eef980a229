//! Densities of the ends of flights from a point: at a collision, or at a surface.

use std::f32::consts::PI;

use glam::Vec3;

use super::attenuation::attenuation;
use super::tilt::Tilt;
use crate::subsurface::transport::gathering::{COORDINATES, LANES};
use crate::subsurface::transport::simd_loop::{SimdLoop, in_widest_vectors};

/// Distances below this part of the shortest mean free path count as this.
const LEAST_DISTANCE: f32 = 1e-9;

/// The end of a flight: a collision, or a point of the surface with its normal, which is 0 at collisions.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlightPlace {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
}

/// Densities of the ends of flights from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlightKernel {
    from: Vec3,
    /// Extinction coefficients \[L⁻¹\].
    sigma_t: [f32; 3],
    /// Shares of the channels in all flights.
    shares: [f32; 3],
    tilt: Tilt,
    least_squared: f32,
}

impl FlightKernel {
    /// Flights from a point whose channels are chosen in proportion to a throughput, whose directions are tilted, and that
    /// are such a `share` of all.
    pub(super) fn new(from: Vec3, sigma_t: Vec3, throughput: Vec3, tilt: Tilt, share: f32) -> Self {
        let least = LEAST_DISTANCE / sigma_t.max_element();
        let shares = (throughput * (share / throughput.element_sum())).to_array();
        Self { from, sigma_t: sigma_t.to_array(), shares, tilt, least_squared: least * least }
    }

    /// Point that the flights start from.
    pub(super) fn from(&self) -> Vec3 {
        self.from
    }

    /// Extinction coefficients \[L⁻¹\].
    pub(super) fn sigma_t(&self) -> [f32; 3] {
        self.sigma_t
    }

    /// Density of each channel's isotropic flights at a place, \[L⁻³\], or on a surface \[L⁻²\], by the place's coordinates,
    /// and the factor of the tilt.
    ///
    /// Without fused operations, so that every processor has the same bits.
    #[inline(always)]
    fn densities(&self, [x, y, z, nx, ny, nz, is_inside]: [f32; COORDINATES]) -> ([f32; 3], f32) {
        let (dx, dy, dz) = (x - self.from.x, y - self.from.y, z - self.from.z);
        let squared = (dx * dx + dy * dy + dz * dz).max(self.least_squared);
        let d = squared.sqrt().min(f32::MAX);
        // One division serves all: they take longer than all else
        let per_square = squared.recip();
        let per_length = d * per_square;
        let cosine = (nx * dx + ny * dy + nz * dz) * per_length;
        let factor = (cosine + is_inside).max(0.0) * per_square * (0.25 / PI);
        let [a, b, c] = self.sigma_t;
        let is_surface = 1.0 - is_inside;
        let densities = [
            (is_inside * a + is_surface) * attenuation(a * d) * factor,
            (is_inside * b + is_surface) * attenuation(b * d) * factor,
            (is_inside * c + is_surface) * attenuation(c * d) * factor,
        ];
        (densities, self.tilt.factor([dx, dy, dz], per_length))
    }

    /// Densities of each channel's isotropic flights at places, one channel after the other; adds those of all flights to the
    /// sums.
    pub(super) fn fill(&self, places: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]) {
        in_widest_vectors(DensityRow { kernel: *self, places, row, sums });
    }
}

/// Densities of flights at places, and the sums over all flights.
struct DensityRow<'a> {
    kernel: FlightKernel,
    places: [&'a [f32]; COORDINATES],
    row: &'a mut [f32],
    sums: &'a mut [f32],
}

impl SimdLoop for DensityRow<'_> {
    #[inline(always)]
    fn run(self) {
        let sums = self.sums.as_chunks_mut::<LANES>().0;
        let n = sums.len();
        let row = &mut self.row.as_chunks_mut::<LANES>().0[..3 * n];
        let (red, rest) = row.split_at_mut(n);
        let (green, blue) = rest.split_at_mut(n);
        let (green, blue) = (&mut green[..n], &mut blue[..n]);
        let [x, y, z, nx, ny, nz, is_inside] = self.places.map(|column| &column.as_chunks::<LANES>().0[..n]);
        let [red_share, green_share, blue_share] = self.kernel.shares;
        for i in 0..n {
            for k in 0..LANES {
                let place = [x[i][k], y[i][k], z[i][k], nx[i][k], ny[i][k], nz[i][k], is_inside[i][k]];
                let ([r, g, b], tilt) = self.kernel.densities(place);
                (red[i][k], green[i][k], blue[i][k]) = (r, g, b);
                sums[i][k] += (red_share * r + green_share * g + blue_share * b) * tilt;
            }
        }
    }
}

impl FlightPlace {
    /// (position, normal, 1 inside and 0 on a surface).
    pub(super) fn coordinates(&self) -> [f32; COORDINATES] {
        let ([x, y, z], [nx, ny, nz]) = (self.position.to_array(), self.normal.to_array());
        [x, y, z, nx, ny, nz, if self.normal == Vec3::ZERO { 1.0 } else { 0.0 }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIGMA_T: Vec3 = Vec3::new(0.5, 2.0, 9.0);

    fn kernel(share: f32) -> FlightKernel {
        let tilt = Tilt::toward(Vec3::X, 0.8, 0.5);
        FlightKernel::new(Vec3::new(1.0, -2.0, 0.5), SIGMA_T, Vec3::new(0.7, 0.1, 0.4), tilt, share)
    }

    /// Densities of each channel's flights at a place, and of all.
    fn densities(kernel: &FlightKernel, place: &FlightPlace) -> (Vec3, f32) {
        let columns = place.coordinates().map(|x| [x; LANES]);
        let (mut row, mut sums) = ([0.0; 3 * LANES], [0.0; LANES]);
        kernel.fill(columns.each_ref().map(<[f32; LANES]>::as_slice), &mut row, &mut sums);
        (Vec3::new(row[0], row[LANES], row[2 * LANES]), sums[0])
    }

    /// All flights end somewhere; those toward a plane at a distance h that get there are E₂(σ_t h)/2 of all.
    #[test]
    fn densities_have_the_right_integrals() {
        let kernel = kernel(0.25);
        let share_of = |place: &dyn Fn(f32) -> FlightPlace, measure: &dyn Fn(f32) -> f32| {
            let (n, longest) = (400_000, 40.0);
            let step = longest / n as f32;
            let mut sums = (glam::DVec3::ZERO, 0.0);
            for i in 0..n {
                let r = (i as f32 + 0.5) * step;
                let (place, weight) = (place(r), f64::from(measure(r) * step));
                let (channels, all) = densities(&kernel, &place);
                sums.0 += channels.as_dvec3() * weight;
                sums.1 += f64::from(all) * weight;
            }
            sums
        };
        let inside = |r| FlightPlace { position: kernel.from + Vec3::Y * r, normal: Vec3::ZERO };
        let (channels, all) = share_of(&inside, &|r| 4.0 * PI * r * r);
        assert!((channels - 1.0).abs().max_element() < 1e-4, "{channels}");
        assert!((all - 0.25).abs() < 1e-4, "{all}");
        let height = 0.3;
        let plane = |r| FlightPlace { position: kernel.from + Vec3::new(r, 0.0, height), normal: Vec3::Z };
        let (channels, _) = share_of(&plane, &|r| 2.0 * PI * r);
        // E₂ of 0.15, 0.6 and 2.7 [Abramowitz & Stegun 1964, table 5.1: E₂(x) = e^{−x} − x E₁(x)]
        let e1 = [1.464_461_67, 0.454_379_50, 0.019_182_37];
        for (c, e1) in e1.into_iter().enumerate() {
            let x = f64::from(SIGMA_T[c] * height);
            let expected = 0.5 * ((-x).exp() - x * e1);
            assert!((channels[c] - expected).abs() < 1e-4, "{c}: {} {expected}", channels[c]);
        }
        let behind = FlightPlace { position: kernel.from + Vec3::Z, normal: -Vec3::Z };
        assert_eq!(densities(&kernel, &behind).0, Vec3::ZERO, "a surface that is entered there");
    }

    /// Every processor has to make the same picture.
    #[test]
    fn densities_are_the_same_in_vectors() {
        let kernel = kernel(1.0);
        let mut columns: [Vec<f32>; COORDINATES] = Default::default();
        for i in 0..4096_u16 {
            let t = f32::from(i);
            let normal = if i % 3 == 0 { Vec3::ZERO } else { Vec3::new(t.sin(), 0.3, t.cos()).normalize() };
            let position = kernel.from + Vec3::new(t.cos(), 0.2, t.sin()) * ((t * 0.01).exp() * 1e-9 - 1e-9);
            let place = FlightPlace { position, normal };
            columns.iter_mut().zip(place.coordinates()).for_each(|(column, x)| column.push(x));
        }
        let places = columns.each_ref().map(Vec::as_slice);
        let bits = |run: fn(DensityRow<'_>)| {
            let (mut row, mut sums) = (vec![0.0; 3 * 4096], vec![0.0; 4096]);
            run(DensityRow { kernel, places, row: &mut row, sums: &mut sums });
            assert!(row.iter().chain(&sums).all(|density| density.is_finite() && *density >= 0.0));
            row.into_iter().chain(sums).map(f32::to_bits).collect::<Vec<_>>()
        };
        assert_eq!(bits(|row| row.run()), bits(|row| in_widest_vectors(row)));
    }

    #[test]
    fn extremes_stay_finite() {
        for sigma_t in [Vec3::splat(1e5), Vec3::splat(1e-5), Vec3::new(0.0, 1e-5, 1e5)] {
            let kernel =
                FlightKernel::new(Vec3::ZERO, sigma_t, Vec3::ONE, Tilt::toward(Vec3::X, 0.8, 0.0), 1.0);
            for distance in [0.0, 1e-30, 1e-12, 1.0, 1e10, 1e18] {
                for normal in [Vec3::ZERO, Vec3::X] {
                    let place = FlightPlace { position: Vec3::X * distance, normal };
                    let (channels, all) = densities(&kernel, &place);
                    let is_usual = channels.is_finite() && channels.min_element() >= 0.0 && all.is_finite();
                    assert!(is_usual && all >= 0.0, "{sigma_t} {distance}: {channels} {all}");
                }
            }
        }
    }
}
