//! The nearness of exits to entries, measured by their profiles.

use crate::subsurface::transport::simd_loop::{SimdLoop, in_widest_vectors};

/// Distances below this part of the longest count as this: too small to tell apart, but not 0.
const LEAST_DISTANCE: f32 = 1e-12;

/// Greatest 1 + r/a_c; larger ones are clamped, so that products of three fourth powers stay finite.
const FARTHEST: f32 = 300.0;

/// A stand-in for the sum of an exit's profiles over its channels,
///
/// ```text
/// g(r) = 1/r Σ_c s_c / (1 + r/a_c)⁴,      0 beyond the longest probe
/// ```
///
/// With s_c = 3/a_c and a_c = 6d it is within 11 % of normalized diffusion for r ≤ 10 d, which has 97 % of the energy,
/// and greater beyond.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearness {
    /// 1/a_c \[L⁻¹\].
    inverse_scale: [f32; 3],
    /// s_c, 0 in channels that are not probed.
    share: [f32; 3],
    longest: f32,
}

impl Nearness {
    /// The stand-in for channels of these weights whose profiles, cut where the energy `tail` is outside, reach so far
    /// \[L\]. Channels without weight or length are left out.
    pub(crate) fn new(weights: [f32; 3], reaches: [f32; 3], tail: f32) -> Self {
        // Normalized diffusion has R_m = 3d ln(¾ / tail)
        let scale_of_reach = 2.0 / libm::logf(0.75 / tail);
        let mut new = Self { inverse_scale: [0.0; 3], share: [0.0; 3], longest: 0.0 };
        for c in 0..3 {
            if weights[c] > 0.0 && reaches[c] > 0.0 {
                new.inverse_scale[c] = 1.0 / (scale_of_reach * reaches[c]);
                new.share[c] = weights[c] * new.inverse_scale[c];
                new.longest = new.longest.max(reaches[c]);
            }
        }
        new
    }

    /// Ends the stand-in at a radius \[L\].
    pub(crate) fn ending_at(self, longest: f32) -> Self {
        Self { longest, ..self }
    }

    /// Mean radius of the widest channel's stand-in: 5/12 a, as of normalized diffusion \[L\].
    pub(crate) fn mean_radius(&self) -> f32 {
        let least = (0..3).filter(|&c| self.share[c] > 0.0).map(|c| self.inverse_scale[c]);
        (5.0 / 12.0) / least.fold(f32::INFINITY, f32::min)
    }

    /// Distance at which profiles are evaluated, never 0.
    #[inline(always)]
    pub(crate) fn distance(&self, distance: f32) -> f32 {
        distance.max(LEAST_DISTANCE * self.longest)
    }

    /// g at a squared distance.
    ///
    /// Without fused operations, so that every processor has the same bits.
    #[inline(always)]
    pub(crate) fn at(&self, squared: f32) -> f32 {
        let [a, b, c] = self.inverse_scale;
        let [sa, sb, sc] = self.share;
        // Infinity is beyond, however long it is
        let longest_squared = (self.longest * self.longest).min(f32::MAX);
        let r = squared.sqrt().max(LEAST_DISTANCE * self.longest);
        let fourth = |inverse: f32| {
            let q = (1.0 + r * inverse).min(FARTHEST);
            let q2 = q * q;
            q2 * q2
        };
        // On one denominator: a division takes longer than all else
        let (fa, fb, fc) = (fourth(a), fourth(b), fourth(c));
        let (fab, fbc) = (fa * fb, fb * fc);
        let g = (sa * fbc + sb * (fa * fc) + sc * fab) / (fab * (fc * r));
        if squared <= longest_squared { g } else { 0.0 }
    }

    /// g at points with these coordinates, with the widest vectors that the processor has; adds it to the sums, too.
    #[inline]
    pub(super) fn fill(&self, exit: [f32; 3], points: [&[f32]; 3], row: &mut [f32], sums: &mut [f32]) {
        in_widest_vectors(NearnessRow { nearness: *self, exit, points, row, sums });
    }
}

/// g of an exit at points, and the sums that it is added to.
struct NearnessRow<'a> {
    nearness: Nearness,
    exit: [f32; 3],
    points: [&'a [f32]; 3],
    row: &'a mut [f32],
    sums: &'a mut [f32],
}

impl SimdLoop for NearnessRow<'_> {
    #[inline(always)]
    fn run(self) {
        let n = self.row.len();
        let [x, y, z] = self.exit;
        let [px, py, pz] = self.points.map(|p| &p[..n]);
        let sums = &mut self.sums[..n];
        for i in 0..n {
            let (dx, dy, dz) = (px[i] - x, py[i] - y, pz[i] - z);
            let g = self.nearness.at(dx * dx + dy * dy + dz * dz);
            self.row[i] = g;
            sums[i] += g;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use translucid_profile::NormalizedDiffusion;

    use super::*;

    const TAIL: f32 = 1e-3;

    fn values(nearness: &Nearness, radii: &[f32], run: fn(NearnessRow<'_>)) -> Vec<f32> {
        let zeros = vec![0.0; radii.len()];
        let (mut row, mut sums) = (zeros.clone(), zeros.clone());
        let points = [radii, &zeros, &zeros];
        run(NearnessRow { nearness: *nearness, exit: [0.0; 3], points, row: &mut row, sums: &mut sums });
        assert_eq!(row, sums);
        row
    }

    #[test]
    fn nearness_is_like_normalized_diffusion() {
        let d = 0.7;
        let profile = NormalizedDiffusion::from_d(1.0, f64::from(d)).unwrap();
        let nearness = Nearness::new(
            [1.0, 0.0, 0.0],
            [profile.quantile_complement(f64::from(TAIL)) as f32, 5.0, 0.0],
            TAIL,
        );
        let radii: Vec<f32> = (0..160).map(|i| i as f32 / 16.0 * d + 1e-3).collect();
        for (r, value) in radii.iter().zip(values(&nearness, &radii, |row| row.run())) {
            // Weights are relative: 3/a is the height of a density
            let ratio = 3.0 * value / (TAU * profile.pdf_area(f64::from(*r)) as f32);
            assert!((0.89..1.12).contains(&ratio), "{ratio} at {} d", r / d);
        }
    }

    /// Every processor has to make the same picture.
    #[test]
    fn nearness_is_the_same_in_vectors() {
        let nearness = Nearness::new([0.9, 0.2, 0.4], [3.0, 0.1, 70.0], TAIL);
        let radii: Vec<f32> = (0..4096).map(|i| (i as f32 * 0.005).exp() * 1e-7 - 1e-7).collect();
        let bits = |fill| values(&nearness, &radii, fill).into_iter().map(f32::to_bits).collect::<Vec<_>>();
        assert_eq!(bits(|row| row.run()), bits(|row| in_widest_vectors(row)));
    }

    #[test]
    fn nearness_ends_where_probes_do() {
        let nearness = Nearness::new([0.5, 0.0, 0.5], [1.0, 9.0, 2.0], TAIL);
        let near =
            values(&nearness, &[0.0, 1.0, 1.999, 2.001, 5.0, f32::INFINITY, 1e30, 3.0], |row| row.run());
        assert!(near[..3].iter().all(|g| *g > 0.0 && g.is_finite()), "{near:?}");
        assert!(near[3..].iter().all(|g| *g == 0.0), "{near:?}");
    }
}
