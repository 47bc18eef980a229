//! Random numbers that are functions of a seed and an index, so that no order and no thread shows in them.

use translucid_profile::split_mix::{STEP, mix};

/// Random number of a seed and an index, uniform on (0, 1), both ends excluded.
pub fn random(seed: u64, index: u64) -> f64 {
    // The middles of 2⁵² intervals: neither 0 nor 1, every one exact.
    let bits = mix(index.wrapping_add(mix(seed)).wrapping_mul(STEP)) >> 12;
    (bits as f64 + 0.5) * 2.0_f64.powi(-52)
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
