//! The instruction sets that the walk is compiled for.

/// Does something with the vectors of a level, as `fearless_simd::dispatch!`, but on x86-64 with AVX-512 and AVX2 alone, and
/// something else with SSE2: `dispatched!(level, simd => f(simd), narrow => g(simd))`.
///
/// A machine with SSE4.2 and without AVX2, mostly one from before 2013, takes the code for SSE2: too few are left to compile
/// the kernel for them, too.
#[cfg(target_arch = "x86_64")]
macro_rules! dispatched {
    ($level:expr, $simd:ident => $call:expr, narrow => $narrow:expr) => {
        match $level {
            fearless_simd::Level::Avx512($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $call,
            ),
            fearless_simd::Level::Avx2($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $call,
            ),
            level => match level.as_sse2() {
                Some($simd) => $narrow,
                None => unreachable!("SSE2 is part of x86-64, this is {level:?}"),
            },
        }
    };
}

#[cfg(not(target_arch = "x86_64"))]
macro_rules! dispatched {
    ($level:expr, $simd:ident => $call:expr, narrow => $narrow:expr) => {
        fearless_simd::dispatch!($level, $simd => $call)
    };
}

pub(crate) use dispatched;

/// The instruction sets of this machine but for its widest one, the narrowest last.
#[cfg(test)]
pub(crate) fn narrower_levels() -> Vec<fearless_simd::Level> {
    use fearless_simd::Level;

    #[cfg(target_arch = "x86_64")]
    let levels = [
        Level::new().as_avx2().map(Level::Avx2),
        Level::new().as_sse4_2().map(Level::Sse4_2),
        Level::new().as_sse2().map(Level::Sse2),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [Some(Level::baseline())];
    levels.into_iter().flatten().collect()
}
