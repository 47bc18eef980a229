//! Random numbers for the slow and obvious walks.

use translucid_profile::split_mix::{STEP, split_mix};

/// SplitMix64.
pub(crate) struct SplitMix(u64);

impl SplitMix {
    /// The numbers of one photon: a function of the seed and the photon's number alone.
    pub(crate) fn of_photon(seed: u64, index: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0xd134_2543_de82_ef95) ^ index);
        Self(random.next() ^ random.next().rotate_left(32))
    }

    fn next(&mut self) -> u64 {
        let bits = split_mix(self.0);
        self.0 = self.0.wrapping_add(STEP);
        bits
    }

    /// Uniform in (0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.next() >> 12) as f64 + 0.5) / 4_503_599_627_370_496.0
    }
}
