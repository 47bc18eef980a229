//! The kernel alone, with nothing behind it, for benches.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use fearless_simd::Level;

use super::trace::trace_at_level;
use super::{PhotonCounts, Problem};

/// Code that walks photons.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walker {
    /// The kernel with the widest instruction set of this machine.
    Kernel,
    /// The kernel with AVX2, if there is such.
    Avx2,
    /// The kernel with SSE2 or what else every machine of this architecture has.
    Baseline,
}

impl Walker {
    /// Walks photons; the number of collisions and of exits. Nothing if the machine lacks the instructions.
    #[doc(hidden)]
    pub fn collisions_and_exits(
        self,
        problem: &Problem,
        albedo: f64,
        photons: Range<u64>,
    ) -> Option<(u64, u64)> {
        let (seed, never) = (1, AtomicBool::new(false));
        let kernel =
            |level| trace_at_level(level, &never, problem, albedo, seed, photons.clone(), &mut |_| {});
        let counts: PhotonCounts = match self {
            Self::Kernel => kernel(Level::new()),
            Self::Avx2 => kernel(avx2()?),
            Self::Baseline => kernel(Level::baseline()),
        };
        Some((counts.collisions, counts.launched - counts.absorbed))
    }
}

#[cfg(target_arch = "x86_64")]
fn avx2() -> Option<Level> {
    Level::new().as_avx2().map(Level::Avx2)
}

#[cfg(not(target_arch = "x86_64"))]
fn avx2() -> Option<Level> {
    None
}
