//! The kernel alone, with nothing behind it, for benches.

use std::ops::Range;

use super::{Problem, trace};

/// Walks photons and only counts: (collisions, exits). A sum over the exits keeps the compiler from leaving
/// them out.
#[doc(hidden)]
pub fn count_collisions_and_exits(problem: &Problem, albedo: f64, photons: Range<u64>) -> (u64, u64) {
    let mut exits = 0;
    let counts = trace(problem, albedo, 1, photons, &mut |batch| exits += batch.len() as u64);
    (counts.collisions, exits)
}
