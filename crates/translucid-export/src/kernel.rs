//! Separable kernel for screen-space scattering: two blurs along a line each in place of one over a disk.
//!
//! J. Jimenez, K. Zsolnai, A. Jarabo, C. Freude, T. Auzinger, X.-C. Wu, J. von der Pahlen, M. Wimmer and D. Gutierrez,
//! *Separable Subsurface Scattering*, Computer Graphics Forum 34, 2015, section 4: the profile's best approximation of
//! rank 1, by its singular value decomposition.

use translucid_profile::Profile;

use crate::disk::points_of;
use crate::language::Language;

/// Share of the light of the widest channel beyond the last tap, in any direction.
const BEYOND: f64 = 0.02;
/// Points of the profile that are counted in cells.
const POINTS: usize = 1 << 16;
/// Steps to the largest eigenvalue; the next is a tenth of it or less.
const STEPS: usize = 60;

/// The taps of a material, and how good they are.
pub(crate) struct Kernel {
    /// Weights of red, green, blue, each of sum 1, and the offset \[L\].
    taps: Vec<[f64; 4]>,
    /// Light that is not where the profile has it, for red, green, blue; a share.
    errors: [f64; 3],
}

impl Kernel {
    /// `taps` is odd.
    pub(crate) fn new(profiles: &[Box<dyn Profile>; 3], taps: usize) -> Self {
        let end = profiles.iter().map(|p| p.quantile_complement(BEYOND)).fold(0.0, f64::max);
        let middle = (taps / 2) as f64;
        // Denser where the profile is steep, as the authors do
        let offsets: Vec<f64> = (0..taps)
            .map(|i| {
                let t = (i as f64 - middle) / middle;
                end * t * t.abs()
            })
            .collect();
        let fits = [0, 1, 2].map(|c| rank_one(&*profiles[c], &offsets));
        let tap = |i: usize| [fits[0].0[i], fits[1].0[i], fits[2].0[i], offsets[i]];
        Self { taps: (0..taps).map(tap).collect(), errors: [0, 1, 2].map(|c| fits[c].1) }
    }

    pub(crate) fn text(&self, language: Language) -> String {
        let [red, green, blue] = self.errors;
        let comment = format!(
            "// Separable kernel of {} taps: red, green, blue, and the offset along x, then along y, a length on the surface.
// Blur the arriving light along x, the result along y, and multiply by the surface albedo. {:.0} % of the widest channel's
// light goes farther than the last tap and is left to the others. Of the light {red:.3}, {green:.3}, {blue:.3} is not
// where the profile has it (half of the sum of absolute differences over the cells between taps).
",
            self.taps.len(),
            100.0 * BEYOND
        );
        comment + &language.table("KERNEL", &self.taps)
    }
}

/// Weights whose products are next to the profile's energies in the cells around taps, and how far those are.
fn rank_one(profile: &dyn Profile, offsets: &[f64]) -> (Vec<f64>, f64) {
    let n = offsets.len();
    // Count the profile's energy in each cell, alike in all quadrants and in x and y
    let edges: Vec<f64> = offsets.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let cell = |x: f64| edges.partition_point(|edge| *edge < x);
    let mut energies = vec![vec![0.0; n]; n];
    for [x, y] in points_of(profile, POINTS) {
        for (x, y) in [(x, y), (-x, y), (x, -y), (-x, -y)] {
            energies[cell(x)][cell(y)] += 0.125 / POINTS as f64;
            energies[cell(y)][cell(x)] += 0.125 / POINTS as f64;
        }
    }
    // Power iteration: the cells' matrix is symmetric, and no energy is negative
    let mut weights = vec![1.0 / n as f64; n];
    for _ in 0..STEPS {
        let next: Vec<f64> =
            energies.iter().map(|row| row.iter().zip(&weights).map(|(e, w)| e * w).sum()).collect();
        let sum: f64 = next.iter().sum();
        weights = next.into_iter().map(|w| w / sum).collect();
    }
    let off: f64 = energies
        .iter()
        .zip(&weights)
        .flat_map(|(row, u)| row.iter().zip(&weights).map(move |(e, v)| (e - u * v).abs()))
        .sum();
    (weights, 0.5 * off)
}

#[cfg(test)]
mod tests {
    use super::*;
    use translucid_profile::{NormalizedDiffusion, SumOfGaussians};

    /// A Gaussian is the one profile that is a product.
    #[test]
    fn a_gaussian_is_separable() {
        let gaussian =
            || Box::new(SumOfGaussians::from_terms(&[1.0], &[2.0], 0.5).unwrap()) as Box<dyn Profile>;
        let kernel = Kernel::new(&[gaussian(), gaussian(), gaussian()], 17);
        assert!(kernel.errors.iter().all(|error| *error < 3e-3), "{:?}", kernel.errors);
        let variance: f64 = kernel.taps.iter().map(|tap| tap[0] * tap[3] * tap[3]).sum();
        assert!((variance / 2.0 - 1.0).abs() < 0.1, "{variance}");
    }

    #[test]
    fn weights_are_shares_and_even() {
        let diffusion = |d| Box::new(NormalizedDiffusion::from_d(0.8, d).unwrap()) as Box<dyn Profile>;
        let kernel = Kernel::new(&[diffusion(2.0), diffusion(1.0), diffusion(0.5)], 25);
        for c in 0..3 {
            let sum: f64 = kernel.taps.iter().map(|tap| tap[c]).sum();
            assert!((sum - 1.0).abs() < 1e-12);
            for (tap, mirrored) in kernel.taps.iter().zip(kernel.taps.iter().rev()) {
                assert!((tap[c] - mirrored[c]).abs() < 1e-12 && tap[3] == -mirrored[3]);
            }
        }
        // A profile that grows like 1/r is far from a product
        assert!(kernel.errors.iter().all(|error| (0.05..0.35).contains(error)), "{:?}", kernel.errors);
    }
}
