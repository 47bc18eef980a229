//! Time per call of normalized diffusion, alone and in slices, beside a Newton inversion of the same cdf.
//!
//! `cargo bench -p translucid-profile`.
//! Every figure is for 4,096 calls on random arguments: divide by 4,096, or take the reciprocal of `item/s`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use translucid_profile::NormalizedDiffusion;
use translucid_testing::golden_uniforms;

const COUNT: usize = 4096;

fn main() {
    divan::main();
}

fn profile() -> NormalizedDiffusion {
    NormalizedDiffusion::from_d(0.8, black_box(0.7)).expect("valid parameters")
}

fn radii() -> Vec<f64> {
    let mut radii = vec![0.0; COUNT];
    profile().quantile_slice(&golden_uniforms(COUNT), &mut radii);
    radii
}

/// Calls f on every element, one at a time: `black_box` keeps the loop from becoming vector code.
fn call_each(bencher: Bencher<'_, '_>, arguments: &[f64], f: impl Fn(f64) -> f64) {
    bencher.counter(ItemsCount::new(arguments.len())).bench_local(|| {
        for argument in arguments {
            black_box(f(black_box(*argument)));
        }
    });
}

/// Calls f on the whole slice.
fn call_on_all(bencher: Bencher<'_, '_>, arguments: &[f64], f: impl Fn(&[f64], &mut [f64])) {
    let mut results = arguments.to_vec();
    bencher.counter(ItemsCount::new(arguments.len())).bench_local(|| {
        f(black_box(arguments), &mut results);
        black_box(&mut results);
    });
}

/// The yardstick: Newton's iteration on the cdf with the platform's exponential, from the exponential's
/// median, to the rounding of its precision; what one writes without the closed form.
fn newton_quantile(u: f64, three_d: f64) -> f64 {
    let mut t = if u < 0.9 { 0.66 * u / (1.0 - 0.8 * u) } else { -((1.0 - u) * (4.0 / 3.0)).ln() };
    for _ in 0..20 {
        let x = (-t).exp();
        let step = (0.25 * x * (3.0 + x * x) - (1.0 - u)) / (0.75 * x * (1.0 + x * x));
        t += step;
        if step.abs() <= 1e-14 * t {
            break;
        }
    }
    three_d * t
}

mod one_by_one {
    use super::*;

    #[divan::bench]
    fn eval(bencher: Bencher<'_, '_>) {
        let p = profile();
        call_each(bencher, &radii(), |r| p.eval(r));
    }

    #[divan::bench]
    fn quantile(bencher: Bencher<'_, '_>) {
        let p = profile();
        call_each(bencher, &golden_uniforms(COUNT), |u| p.quantile(u));
    }

    #[divan::bench]
    fn quantile_by_newton(bencher: Bencher<'_, '_>) {
        let three_d = black_box(2.1);
        call_each(bencher, &golden_uniforms(COUNT), |u| newton_quantile(u, three_d));
    }

    #[divan::bench]
    fn sample(bencher: Bencher<'_, '_>) {
        let p = profile();
        call_each(bencher, &golden_uniforms(COUNT), |u| p.sample(u));
    }
}

mod slices {
    use super::*;

    #[divan::bench]
    fn eval(bencher: Bencher<'_, '_>) {
        call_on_all(bencher, &radii(), |from, to| profile().eval_slice(from, to));
    }

    #[divan::bench]
    fn quantile(bencher: Bencher<'_, '_>) {
        call_on_all(bencher, &golden_uniforms(COUNT), |from, to| profile().quantile_slice(from, to));
    }

    #[divan::bench]
    fn sample(bencher: Bencher<'_, '_>) {
        call_on_all(bencher, &golden_uniforms(COUNT), |from, to| profile().sample_slice(from, to));
    }
}
