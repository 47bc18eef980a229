//! One function over many numbers, in vector registers as wide as the machine has.

/// A function of one number.
///
/// Unlike `Fn` it can promise to be inlined, without which a loop over it does not become vector code.
pub(crate) trait Elementwise {
    fn at(&self, x: f64) -> f64;
}

/// The method of a model as an [`Elementwise`] function: `elementwise!(model, Model, method)`.
macro_rules! elementwise {
    ($model:expr, $type:ty, $method:ident) => {{
        struct Method($type);
        impl crate::math::slices::Elementwise for Method {
            #[inline(always)]
            fn at(&self, x: f64) -> f64 {
                self.0.$method(x)
            }
        }
        Method($model)
    }};
}
pub(crate) use elementwise;

/// Applies a function element by element, as far as the shorter slice goes.
///
/// The functions of this crate run without branches, so that the loop becomes vector code; with AVX2 it
/// takes twice the lanes of the architecture's baseline.
/// Both give the same bits, since neither fuses a multiplication with an addition.
#[inline(always)]
pub(crate) fn map_slice(from: &[f64], to: &mut [f64], f: impl Elementwise) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2, as just asked.
        unsafe { map_slice_avx2(from, to, f) };
        return;
    }
    map_slice_baseline(from, to, f);
}

/// The loop for processors with AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn map_slice_avx2(from: &[f64], to: &mut [f64], f: impl Elementwise) {
    map_slice_baseline(from, to, f);
}

#[inline(always)]
#[allow(clippy::needless_pass_by_value, reason = "a copy in registers is what the loop wants")]
fn map_slice_baseline(from: &[f64], to: &mut [f64], f: impl Elementwise) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = f.at(*from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NormalizedDiffusion;

    #[test]
    fn map_slice_gives_the_bits_of_the_baseline() {
        let profile = NormalizedDiffusion::from_d(0.8, 0.7).unwrap();
        let from: Vec<f64> = (0..1003).map(|i| f64::from(i) / 1002.0).collect();
        let (mut wide, mut baseline) = (vec![0.0; 1003], vec![0.0; 1003]);
        map_slice(&from, &mut wide, elementwise!(profile, NormalizedDiffusion, quantile));
        map_slice_baseline(&from, &mut baseline, elementwise!(profile, NormalizedDiffusion, quantile));
        assert_eq!(wide, baseline);
        map_slice(&from, &mut wide, elementwise!(profile, NormalizedDiffusion, eval));
        map_slice_baseline(&from, &mut baseline, elementwise!(profile, NormalizedDiffusion, eval));
        assert_eq!(wide, baseline);
    }
}
