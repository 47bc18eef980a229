//! Sums of Gaussians against an evaluation that shares no code with them.
//!
//! In the limit A → 0 all light that leaves was scattered once, and the profile of a pencil is an integral over the
//! cosine μ of the direction towards the surface. From depth z it reaches the surface at the distance z √(1−μ²)/μ, so
//!
//! ```text
//! 2πr R(r) = (α/2) ∫₀¹ μ/(1+μ) λ e^{−λr} dμ,      λ = √((1+μ)/(1−μ))
//! ```
//!
//! Here that profile is fitted by brute force: a grid and golden sections.

use std::f64::consts::PI;

use translucid_profile::{Configuration, Parameterization, Profile, SumOfGaussians};

/// 2πr R(r) of light scattered once, over its total (1 − ln 2)/2 · α.
fn single_scattering(r: f64) -> f64 {
    // μ = 1 − s²: λ is infinite at μ = 1
    let steps = 4000;
    let term = |i: u32| {
        let s = (f64::from(i) + 0.5) / f64::from(steps);
        let mu = 1.0 - s * s;
        let lambda = ((1.0 + mu) / (1.0 - mu)).sqrt();
        mu / (1.0 + mu) * lambda * (-lambda * r).exp() * 2.0 * s / f64::from(steps)
    };
    (0..steps).map(term).sum::<f64>() / (1.0 - 2f64.ln())
}

/// Radii with equal steps in the logarithm, and r times the profile's density there.
fn target() -> Vec<(f64, f64)> {
    (-160..=40).map(|i| (f64::from(i) / 10.0).exp()).map(|r| (r, r * single_scattering(r))).collect()
}

/// r times the density per length of a Gaussian of standard deviation s.
fn kernel(r: f64, s: f64) -> f64 {
    r * r / (s * s) * (-r * r / (2.0 * s * s)).exp()
}

/// Least value of f on [a, b] and where it is, by golden sections.
fn golden(mut a: f64, mut b: f64, f: &dyn Fn(f64) -> f64) -> (f64, f64) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..50 {
        let (left, right) = (b - golden * (b - a), a + golden * (b - a));
        if f(left) < f(right) { b = right } else { a = left }
    }
    (f(0.5 * (a + b)), 0.5 * (a + b))
}

/// Least squares of one Gaussian: its standard deviation.
fn one_gaussian(target: &[(f64, f64)]) -> f64 {
    let misfit = |ln_s: f64| target.iter().map(|(r, y)| (kernel(*r, ln_s.exp()) - y).powi(2)).sum();
    golden(-3.0, 1.0, &misfit).1.exp()
}

/// Weight and misfit of the first of two Gaussians: for given scales the misfit is a parabola.
fn best_weight(target: &[(f64, f64)], s: [f64; 2]) -> (f64, f64) {
    let (mut up, mut down) = (0.0, 0.0);
    for (r, y) in target {
        let [a, b] = s.map(|s| kernel(*r, s));
        up += (y - b) * (a - b);
        down += (a - b) * (a - b);
    }
    let weight = up / down;
    let misfit = |(r, y): &(f64, f64)| weight * kernel(*r, s[0]) + (1.0 - weight) * kernel(*r, s[1]) - y;
    (weight, target.iter().map(|point| misfit(point).powi(2)).sum())
}

fn limit(terms: usize) -> SumOfGaussians {
    let (mfp, searchlight) = (Parameterization::Mfp, Configuration::Searchlight);
    SumOfGaussians::new(0.0, 1.0, mfp, searchlight, terms).expect("valid parameters")
}

#[test]
fn one_gaussian_is_the_brute_force_fit() {
    let s = one_gaussian(&target());
    let gaussian = limit(1);
    assert_eq!(gaussian.weights(), [1.0]);
    let found = gaussian.standard_deviations()[0];
    assert!((found / s - 1.0).abs() < 1e-5, "{found} {s}");
    for r in [0.0, 0.1, 0.3, 1.0, 2.0] {
        let expected = (-r * r / (2.0 * s * s)).exp() / (2.0 * PI * s * s);
        assert!((gaussian.pdf_area(r) / expected - 1.0).abs() < 1e-4, "{r}");
    }
}

#[test]
fn two_gaussians_are_the_brute_force_fit() {
    let target = target();
    let narrow_for = |ln_wide: f64| {
        golden(-4.0, -1.2, &|ln_narrow| best_weight(&target, [ln_narrow.exp(), ln_wide.exp()]).1)
    };
    let ln_wide = golden(-1.1, 0.5, &|ln_wide| narrow_for(ln_wide).0).1;
    let s = [narrow_for(ln_wide).1.exp(), ln_wide.exp()];
    let (weight, _) = best_weight(&target, s);
    let gaussians = limit(2);
    let weights = [weight, 1.0 - weight];
    for k in 0..2 {
        assert!((gaussians.weights()[k] - weights[k]).abs() < 1e-5, "{:?} {weights:?}", gaussians.weights());
        let found = gaussians.standard_deviations()[k];
        assert!((found / s[k] - 1.0).abs() < 1e-5, "{found} {}", s[k]);
    }
    for r in [0.0, 0.05, 0.2, 0.7, 1.5] {
        let term = |k: usize| weights[k] * (-r * r / (2.0 * s[k] * s[k])).exp() / (2.0 * PI * s[k] * s[k]);
        assert!((gaussians.pdf_area(r) / (term(0) + term(1)) - 1.0).abs() < 1e-4, "{r}");
    }
}

/// Integral of f over [a, b] by the midpoint rule.
fn midpoint(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let steps = 200_000;
    let step = (b - a) / f64::from(steps);
    (0..steps).map(|i| f(a + step * (f64::from(i) + 0.5))).sum::<f64>() * step
}

#[test]
fn values_and_energies_are_those_of_the_terms() {
    for (a, mfp, terms) in [(0.2, 0.5, 3), (0.5, 1.0, 6), (0.8, 3.0, 4), (0.97, 1.0, 5), (1.0, 2.0, 6)] {
        let (parameter, diffuse) = (Parameterization::Mfp, Configuration::Diffuse);
        let gaussians = SumOfGaussians::new(a, mfp, parameter, diffuse, terms).expect("valid parameters");
        let pairs: Vec<(f64, f64)> = gaussians.weights().iter().copied().zip(gaussians.variances()).collect();
        let value = |r: f64| {
            pairs.iter().map(|(w, v)| a * w / (2.0 * PI * v) * (-r * r / (2.0 * v)).exp()).sum::<f64>()
        };
        for r in [0.02, 0.3, 1.0, 4.0] {
            assert!((gaussians.eval(r) / value(r) - 1.0).abs() < 1e-12, "{a} {r}");
            assert!((gaussians.eval_times_r(r) / (r * value(r)) - 1.0).abs() < 1e-12, "{a} {r}");
            let enclosed = midpoint(0.0, r, |r| 2.0 * PI * r * value(r));
            assert!((gaussians.enclosed(r) / enclosed - 1.0).abs() < 1e-6, "{a} {r}");
            let density = |r: f64| 2.0 * PI * r * value(r);
            let beyond = midpoint(r, 5.0 * mfp, density) + midpoint(5.0 * mfp, 300.0 * mfp, density);
            assert!((gaussians.beyond(r) - beyond).abs() < 1e-6, "{a} {r}: {beyond}");
        }
    }
}
