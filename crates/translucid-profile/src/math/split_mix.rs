//! SplitMix64's function of a state, for what draws random numbers outside this crate.
//!
//! G. L. Steele, D. Lea and C. H. Flood, *Fast Splittable Pseudorandom Number Generators*, 2014.

/// Difference of two successive states.
pub const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// The number that follows a state.
#[inline]
#[must_use]
pub fn split_mix(state: u64) -> u64 {
    mix(state.wrapping_add(STEP))
}

/// A bijection of 64 bits that leaves no pattern of its input: variant 13 of D. Stafford, *Better Bit Mixing*, 2011.
#[inline]
#[must_use]
pub fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_mix_is_that_of_its_authors() {
        // The first numbers of their Java
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        let found = [0, 1, 2].map(|step| split_mix(STEP.wrapping_mul(step).wrapping_add(1_234_567)));
        assert_eq!(found, expected);
    }
}
