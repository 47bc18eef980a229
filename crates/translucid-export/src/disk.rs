//! Disk of taps for screen-space scattering: where to look around a pixel, and how much each channel takes from there.
//!
//! Taps are importance-sampled after the mean of the channels' profiles, as J. Jimenez et al. and E. Golubev (*Efficient
//! Screen-Space Subsurface Scattering Using Burley's Normalized Diffusion in Real-Time*, SIGGRAPH 2018) do for a single
//! one: radii by strata of its energy, azimuths by the golden angle.

use std::f64::consts::{PI, TAU};

use translucid_profile::{Profile, roots};

use crate::language::Language;

/// The taps of a material, and how good they are.
pub(crate) struct Disk {
    /// x and y \[L\].
    offsets: Vec<[f64; 2]>,
    /// Red, green, blue, each of sum 1.
    weights: Vec<[f64; 3]>,
    /// Largest error of the light across an edge of light, for red, green, blue; 1 is the light itself.
    edge_errors: [f64; 3],
}

impl Disk {
    pub(crate) fn new(profiles: &[Box<dyn Profile>; 3], taps: usize) -> Self {
        let golden = PI * (3.0 - 5f64.sqrt());
        let mean = |f: &dyn Fn(&dyn Profile) -> f64| profiles.iter().map(|p| f(&**p)).sum::<f64>() / 3.0;
        let longest = profiles.iter().map(|p| p.scale()).fold(0.0, f64::max);
        let radius = |share: f64| {
            // Of x = scale/(scale + r), with which the share beyond r rises
            let r = |x: f64| longest * (1.0 - x) / x.max(1e-12);
            r(roots::falling_root(|x| mean(&|p| p.cdf(r(x))) - share, [1.0 - share, -share], |_| 1e-12))
        };
        let mut offsets = Vec::new();
        let mut weights = Vec::new();
        for i in 0..taps {
            let r = radius((i as f64 + 0.5) / taps as f64);
            let (sin, cos) = (i as f64 * golden).sin_cos();
            offsets.push([r * cos, r * sin]);
            let density = mean(&|p| p.pdf_area(r));
            weights.push([0, 1, 2].map(|c| profiles[c].pdf_area(r) / density));
        }
        for c in 0..3 {
            let sum: f64 = weights.iter().map(|row| row[c]).sum();
            weights.iter_mut().for_each(|row| row[c] /= sum);
        }
        let edge_errors = [0, 1, 2].map(|c| {
            let taps = offsets.iter().zip(&weights).map(|(offset, weight)| (offset[0], weight[c]));
            edge_error(&*profiles[c], &taps.collect::<Vec<_>>())
        });
        Self { offsets, weights, edge_errors }
    }

    pub(crate) fn text(&self, language: Language) -> String {
        let [red, green, blue] = self.edge_errors;
        let comment = format!(
            "// Disk of {} taps. The light that leaves at x is sum_i WEIGHTS[i] * arriving(x + OFFSETS[i]), channel by channel,
// times the surface albedo. Offsets are lengths on the surface; turn them by a random angle for each pixel.
// Across an edge of light it is off by at most {red:.3}, {green:.3}, {blue:.3} of the light without turning.
",
            self.offsets.len()
        );
        comment
            + &language.table("DISK_OFFSETS", &self.offsets)
            + &language.table("DISK_WEIGHTS", &self.weights)
    }
}

/// Largest error, over where an edge of light is, of taps given by their distance to it and weight.
fn edge_error(profile: &dyn Profile, taps: &[(f64, f64)]) -> f64 {
    const SHARES: usize = 512;
    let radii: Vec<f64> = (0..SHARES).map(|i| profile.quantile((i as f64 + 0.5) / SHARES as f64)).collect();
    // Of a ring of radius r the part beyond x is acos(x/r)/π
    let beyond =
        |x: f64| radii.iter().map(|r| (x / r).clamp(-1.0, 1.0).acos() / PI).sum::<f64>() / SHARES as f64;
    let tapped = |x: f64| taps.iter().filter(|tap| tap.0 > x).map(|tap| tap.1).sum::<f64>();
    // At a tap the sum leaps: the error is largest on one of its sides
    let errors = taps.iter().flat_map(|&(x, weight)| {
        let (exact, after) = (beyond(x), tapped(x));
        [(exact - after).abs(), (exact - after - weight).abs()]
    });
    errors.fold(0.0, f64::max)
}

/// Points and their share of a full turn, for sums over a plane: n points of a profile, evenly by energy.
pub(crate) fn points_of(profile: &dyn Profile, n: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    (0..n).map(move |i| {
        let r = profile.quantile((i as f64 + 0.5) / n as f64);
        let (sin, cos) = (TAU * (i as f64 * golden).fract()).sin_cos();
        [r * cos, r * sin]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use translucid_profile::NormalizedDiffusion;

    fn profiles() -> [Box<dyn Profile>; 3] {
        [2.0, 1.0, 0.5].map(|d| Box::new(NormalizedDiffusion::from_d(0.8, d).unwrap()) as Box<dyn Profile>)
    }

    #[test]
    fn weights_are_shares_of_each_channel() {
        let disk = Disk::new(&profiles(), 32);
        for c in 0..3 {
            let sum: f64 = disk.weights.iter().map(|row| row[c]).sum();
            assert!((sum - 1.0).abs() < 1e-14);
            assert!(disk.weights.iter().all(|row| row[c] >= 0.0));
        }
        // Light that reaches farther takes more from far away
        assert!(disk.weights[31][0] > 10.0 * disk.weights[31][2], "{:?}", disk.weights[31]);
    }

    #[test]
    fn edges_of_light_come_right_with_many_taps() {
        let errors = |taps| Disk::new(&profiles(), taps).edge_errors;
        assert!(errors(1024).iter().all(|error| *error < 0.02), "{:?}", errors(1024));
        assert!(errors(16).iter().all(|error| (0.03..0.5).contains(error)), "{:?}", errors(16));
    }

    #[test]
    fn equal_channels_have_equal_weights() {
        let one = || Box::new(NormalizedDiffusion::from_d(0.8, 1.0).unwrap()) as Box<dyn Profile>;
        let disk = Disk::new(&[one(), one(), one()], 8);
        assert!(disk.weights.iter().flatten().all(|weight| (weight - 0.125).abs() < 1e-12));
    }
}
