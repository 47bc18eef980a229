//! `translucid sample`: radii drawn from a profile.

use clap::Args;

use crate::failure::Failure;
use crate::model::ModelArguments;
use crate::table::TableArguments;

const EXAMPLES: &str = "\
Column: r, in the unit of --mfp or --dmfp, with --sigma-a and --sigma-s in its inverse.
Its density is 2 pi r R(r) / A.
normalized-diffusion is sampled in closed form, every other model by a table of its cdf (error below 1e-4).
Number i of a seed is the same whatever the count.

Examples:
  translucid sample --surface-albedo 0.8 --mfp 1 --count 1000
  translucid sample --surface-albedo 0.8 --mfp 1 --count 1000000 --seed 7 -o radii.csv
  translucid sample --model dipole --sigma-a 0.0021 --sigma-s 2.19 --count 1000
  translucid sample --table measured.csv --surface-albedo 0.8 --mfp 2 --count 1000";

/// Draws radii from a reflectance profile
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Number of radii
    #[arg(long, value_name = "N")]
    count: u64,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    table: TableArguments,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.table.spare(arguments.model.table_file())?;
    let sampler = arguments.model.sampler()?;
    let radius = |index| [sampler.sample(random(arguments.seed, index))];
    arguments.table.write(["r"], (0..arguments.count).map(radius))
}

/// Random number of a seed and an index, uniform on (0, 1).
fn random(seed: u64, index: u64) -> f64 {
    // The middles of 2⁵² intervals: neither 0 nor 1, every one exact.
    let bits = mix(index.wrapping_add(mix(seed)).wrapping_mul(0x9e37_79b9_7f4a_7c15)) >> 12;
    (bits as f64 + 0.5) * 2.0_f64.powi(-52)
}

/// A bijection of 64 bits that leaves no pattern of its input: the finalizer of SplitMix64, variant 13
/// [D. Stafford 2011, "Better Bit Mixing"; Steele, Lea, Flood 2014].
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_fills_the_unit_interval_evenly() {
        // Kolmogorov–Smirnov over 10⁵ numbers of several seeds: √n D > 2.23 has probability 1e-4 each.
        for seed in [0, 1, 2, u64::MAX] {
            let mut numbers: Vec<f64> = (0..100_000).map(|index| random(seed, index)).collect();
            assert!(numbers.iter().all(|u| (0.0..1.0).contains(u) && *u > 0.0));
            numbers.sort_by(f64::total_cmp);
            let n = numbers.len() as f64;
            let distance =
                |(i, u): (usize, &f64)| (u - i as f64 / n).abs().max(((i + 1) as f64 / n - u).abs());
            let worst = numbers.iter().enumerate().map(distance).fold(0.0, f64::max);
            assert!(n.sqrt() * worst < 2.23, "seed {seed}: {worst}");
        }
    }

    #[test]
    fn random_differs_between_seeds() {
        let equal =
            (0..1000).filter(|&i| random(0, i) == random(1, i) || random(0, i) == random(0, i + 1)).count();
        assert_eq!(equal, 0);
    }
}
