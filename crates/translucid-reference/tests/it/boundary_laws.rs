//! Laws that the exact half space obeys under oblique beams and a reflecting boundary, and values from elsewhere.

use std::f64::consts::PI;

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_reference::Incidence;
use translucid_reference::exact::{HalfSpace, ObliqueHalfSpace};
use translucid_testing::is_thorough;

use crate::solutions::{half_space, oblique};

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found:.14e}, expected {expected:.14e}");
}

/// Numbers of another program for the same equation, confirmed by Monte Carlo.
#[test]
fn boundary_matches_check_values() {
    let solution = half_space(0.9, 1.4, Incidence::NORMAL);
    assert_close(solution.total().value, 0.25775574626, 1e-10, "total");
    assert_close(solution.eval(1.0).value, 1.159402e-2, 1e-6, "R(1)");
}

#[test]
fn boundary_without_contrast_is_the_matched_solution() {
    let directions =
        if is_thorough() { &[Incidence::NORMAL, Incidence::Cosine][..] } else { &[Incidence::Cosine] };
    for &incidence in directions {
        let matched = HalfSpace::new(0.9, incidence).expect("valid");
        let same = HalfSpace::with_boundary(0.9, 1.0, incidence).expect("valid");
        assert_eq!(same.eval(0.7), matched.eval(0.7));
        // The critical angle moves like √(η − 1), and so does what it reflects, times its cosine
        let mut last = f64::INFINITY;
        for excess in [0.1, 0.01] {
            let close = half_space(0.9, 1.0 + excess, incidence);
            let off = (close.eval(0.7).value / matched.eval(0.7).value - 1.0).abs();
            assert!(off < 0.25 * last && off < 4.0 * excess, "{incidence:?} {excess}: {off}");
            last = off;
        }
    }
}

#[test]
fn oblique_beam_along_the_normal_is_the_normal_beam() {
    let matched = HalfSpace::new(0.9, Incidence::NORMAL).expect("valid");
    let oblique = ObliqueHalfSpace::new(0.9, 1.0, 1.0).expect("valid");
    for r in [1e-3, 0.1, 1.0, 10.0, 30.0] {
        for phi in [0.0, 2.0] {
            assert_close(oblique.eval(r, phi).value, matched.eval(r).value, 1e-9, &format!("r = {r}"));
        }
        assert_close(oblique.enclosed(r).value, matched.enclosed(r).value, 1e-9, &format!("within {r}"));
        assert_close(oblique.beyond(r).value, matched.beyond(r).value, 1e-9, &format!("beyond {r}"));
    }
    assert_close(oblique.total().value, matched.total().value, 1e-10, "total");
    // Close to the normal the profile tilts in proportion to the angle
    let tilted = ObliqueHalfSpace::new(0.9, 1.0, 1e-3f64.cos()).expect("valid");
    let tilt = |phi: f64| tilted.eval(1.0, phi).value / matched.eval(1.0).value - 1.0;
    assert_close(tilt(0.0), -tilt(PI), 1e-2, "tilt");
    assert!(tilt(0.0) > 1e-4 && tilt(0.0) < 2e-3 && tilt(0.5 * PI).abs() < 1e-5, "{}", tilt(0.0));
}

/// S. Chandrasekhar 1950: 1 − H(μ₀) √(1−α), with H from its integral equation.
#[test]
fn oblique_total_is_chandrasekhars() {
    let alpha = 0.9;
    // Graded towards grazing, where H has terms like μ ln μ
    let rule: Vec<(f64, f64)> = gauss_legendre(80)
        .into_iter()
        .map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w))
        .map(|(x, w)| (x.powi(4), 4.0 * x.powi(3) * w))
        .collect();
    // 1/H = √(1−α) + (α/2) ∫ μ' H(μ')/(μ + μ') dμ', by iteration
    let inverse = |mu: f64, h: &[f64]| {
        let sum: f64 = rule.iter().zip(h).map(|(&(x, w), h)| w * x * h / (mu + x)).sum();
        (1.0f64 - alpha).sqrt() + 0.5 * alpha * sum
    };
    let mut h = vec![1.0; rule.len()];
    for _ in 0..60 {
        h = rule.iter().map(|&(mu, _)| 1.0 / inverse(mu, &h)).collect();
    }
    for cos in [1e-8, 1e-5, 1e-3, 0.05, 0.3, 0.8] {
        let expected = 1.0 - (1.0f64 - alpha).sqrt() / inverse(cos, &h);
        let solution = ObliqueHalfSpace::new(alpha, 1.0, cos).expect("valid");
        let total = solution.total();
        // The solver's rule over directions is least good in the layer μ ~ cos, of little weight
        let tolerance = if cos < 1e-4 { 3e-8 } else { 1e-9 };
        assert_close(total.value, expected, tolerance, &format!("cosine {cos}"));
        assert!((total.value - expected).abs() < total.error, "cosine {cos}: {total:?}, expected {expected}");
    }
}

#[test]
fn oblique_profile_keeps_its_energy() {
    let (radii, azimuths) = (gauss_legendre(12), gauss_legendre(24));
    for (alpha, eta, cos) in [(0.9, 1.0, 0.5), (1.0, 1.0, 0.7), (1.0, 1.5, 0.5)] {
        let solution = oblique(alpha, eta, cos);
        let total = solution.total();
        if alpha == 1.0 {
            assert_close(total.value, 1.0, 1e-8, "nothing is absorbed");
        }
        for r in [0.05, 1.0, 20.0] {
            let sum = solution.enclosed(r).value + solution.beyond(r).value;
            assert_close(sum, total.value, 1e-8, &format!("{alpha} {eta}: within and beyond {r}"));
        }
        let ring = integrate(&radii, 0.5, 1.0, |r| {
            2.0 * r * integrate(&azimuths, 0.0, PI, |phi| solution.eval(r, phi).value)
        });
        let expected = solution.enclosed(1.0).value - solution.enclosed(0.5).value;
        assert_close(ring, expected, 1e-7, &format!("{alpha} {eta}: ring"));
        let mean = integrate(&azimuths, 0.0, PI, |phi| solution.eval(0.3, phi).value) / PI;
        assert_close(mean, solution.eval_mean(0.3).value, 1e-7, &format!("{alpha} {eta}: mean"));
    }
}

#[test]
fn boundary_profile_keeps_its_energy() {
    let radii = gauss_legendre(16);
    for (alpha, eta, incidence) in
        [(0.95, 1.33, Incidence::NORMAL), (1.0, 1.4, Incidence::Cosine), (0.5, 1.2, Incidence::UniformCosine)]
    {
        let solution = half_space(alpha, eta, incidence);
        let total = solution.total().value;
        if alpha == 1.0 {
            assert_close(total, 1.0, 1e-8, "nothing is absorbed");
        }
        assert_close(solution.enclosed(0.7).value + solution.beyond(0.7).value, total, 1e-8, "total");
        assert_close(solution.hankel(0.0).value, total, 1e-12, "transform");
        let ring = integrate(&radii, 0.5, 1.0, |r| 2.0 * PI * r * solution.eval(r).value);
        assert_close(ring, solution.enclosed(1.0).value - solution.enclosed(0.5).value, 1e-8, "ring");
    }
}

#[test]
fn oblique_mean_is_the_radial_profile() {
    let oblique = ObliqueHalfSpace::new(0.7, 1.4, 0.6).expect("valid");
    let radial = HalfSpace::with_boundary(0.7, 1.4, Incidence::Pencil { cos_theta: 0.6 }).expect("valid");
    assert_eq!(oblique.eval_mean(0.4), radial.eval(0.4));
    assert_eq!(oblique.total(), radial.total());
}

#[test]
fn profiles_of_any_argument_are_numbers() {
    let oblique = ObliqueHalfSpace::new(0.9, 1.4, 0.4).expect("valid");
    let radial = HalfSpace::with_boundary(0.9, 1.4, Incidence::Cosine).expect("valid");
    for r in [0.0, -1.0, 1e-300, 1e-9, 1e3, 1e9, f64::INFINITY, f64::NAN] {
        for estimate in [
            oblique.eval(r, 1.0),
            oblique.eval(r, f64::NAN),
            oblique.eval_mean(r),
            oblique.enclosed(r),
            oblique.beyond(r),
            radial.eval(r),
            radial.enclosed(r),
            radial.beyond(r),
            radial.hankel(r),
        ] {
            assert!(!estimate.value.is_nan() && estimate.error >= 0.0, "{r}: {estimate:?}");
        }
    }
}

#[test]
fn parameters_out_of_range_are_refused() {
    let message = |error: translucid_profile::ParameterError| error.to_string();
    for (alpha, eta, cos, expected) in [
        (0.0, 1.4, 1.0, "single_scattering_albedo is 0, but must be in (0, 1]"),
        (1.1, 1.4, 1.0, "single_scattering_albedo is 1.1, but must be in (0, 1]"),
        (0.9, 0.3, 1.0, "eta is 0.3, but must be in [0.5, 3] for the exact solution"),
        (0.9, f64::NAN, 1.0, "eta is NaN, but must be in [0.5, 3] for the exact solution"),
        (0.9, 1.4, 0.0, "cos_theta is 0, but must be in (0, 1]"),
        (0.9, 0.8, 0.5, "cos_theta is 0.5, but must be above that of total reflection, sqrt(1 - eta^2)"),
    ] {
        let error = ObliqueHalfSpace::new(alpha, eta, cos).expect_err("out of range");
        assert_eq!(message(error), expected);
        let incidence = Incidence::Pencil { cos_theta: cos };
        let error = HalfSpace::with_boundary(alpha, eta, incidence).expect_err("out of range");
        assert_eq!(message(error), expected);
    }
}
