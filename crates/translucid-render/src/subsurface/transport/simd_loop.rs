//! Loops compiled for the widest vectors of the processor at hand.

/// A loop whose iterations are independent and without fused operations, so that every processor gives the same bits.
pub(super) trait SimdLoop {
    /// Runs it, with `#[inline(always)]`: otherwise it is compiled for narrow vectors.
    fn run(self);
}

/// Runs a loop with the widest vectors that the processor has.
#[inline]
pub(super) fn in_widest_vectors(body: impl SimdLoop) {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor was found to have AVX-512.
            return unsafe { run_avx512(body) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor was found to have AVX2.
            return unsafe { run_avx2(body) };
        }
    }
    body.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn run_avx512(body: impl SimdLoop) {
    body.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2(body: impl SimdLoop) {
    body.run();
}
