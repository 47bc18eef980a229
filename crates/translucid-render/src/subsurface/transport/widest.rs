//! Loops over places, compiled for the widest vectors that the processor has.

/// A loop whose numbers do not meet across places and are not fused, so that every processor has the same bits.
pub(super) trait Loop {
    /// Runs it, with `#[inline(always)]`: otherwise it is compiled for narrow vectors.
    fn run(self);
}

/// Runs a loop with the widest vectors that the processor has.
#[inline]
pub(super) fn in_widest_vectors(body: impl Loop) {
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
fn run_avx512(body: impl Loop) {
    body.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2(body: impl Loop) {
    body.run();
}
