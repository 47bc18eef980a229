//! SplitMix64 [Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom Number Generators"].

/// Difference of two successive states.
pub(crate) const SPLIT_MIX_STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// The number that follows a state: a bijection of 64 bits with good avalanche.
pub(crate) fn split_mix(state: u64) -> u64 {
    let x = state.wrapping_add(SPLIT_MIX_STEP);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
