//! The fits behind `SumOfGaussians`, made again.

use translucid_fit::{Exponential, Fit, Gaussian, Judge, Mixture, Target, fit, l1_error};
use translucid_profile::{Configuration, Parameterization, Profile, SumOfGaussians};
use translucid_reference::exact::HalfSpaceProfile;

const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];

fn exact_half_space(surface_albedo: f64, configuration: Configuration) -> HalfSpaceProfile {
    HalfSpaceProfile::from_surface_albedo(surface_albedo, configuration).expect("a surface albedo in (0, 1]")
}

fn embedded(surface_albedo: f64, configuration: Configuration, terms: usize) -> SumOfGaussians {
    let mfp = Parameterization::Mfp;
    SumOfGaussians::new(surface_albedo, 1.0, mfp, configuration, terms).expect("valid parameters")
}

fn target(surface_albedo: f64, configuration: Configuration) -> Target {
    Target::new(&exact_half_space(surface_albedo, configuration)).expect("an exact profile has energy")
}

fn fits(surface_albedo: f64, configuration: Configuration) -> Vec<Fit<Gaussian>> {
    target(surface_albedo, configuration).fit(6).expect("6 terms are few enough")
}

/// At the nodes of the table, A = 1 − (1 − i/24)².
#[test]
fn refitting_reproduces_the_embedded_coefficients() {
    for configuration in CONFIGURATIONS {
        for i in [3, 15, 24] {
            let root = 1.0 - f64::from(i) / 24.0;
            let surface_albedo = 1.0 - root * root;
            for (terms, fit) in (1..).zip(fits(surface_albedo, configuration)) {
                let embedded = embedded(surface_albedo, configuration, terms);
                for (found, expected) in embedded.weights().iter().zip(fit.mixture.weights()) {
                    assert!((found - expected).abs() < 2e-7, "{surface_albedo}, {terms}: {found} {expected}");
                }
                for (found, expected) in embedded.standard_deviations().iter().zip(fit.mixture.scales()) {
                    assert!((found / expected - 1.0).abs() < 4e-7, "{terms}: {found} {expected}");
                }
            }
        }
    }
}

/// Between the nodes a sum is as good as the optimum next to it, and nearly the same.
#[test]
fn interpolation_adds_little_error() {
    for configuration in CONFIGURATIONS {
        for surface_albedo in [0.003, 0.3, 0.5, 0.77, 0.95, 0.9995] {
            let exact = exact_half_space(surface_albedo, configuration);
            let judge = Judge::new(&exact);
            let target = Target::new(&exact).expect("an exact profile has energy");
            for terms in 1..=6 {
                let embedded = embedded(surface_albedo, configuration, terms);
                let pairs = embedded.weights().iter().zip(embedded.standard_deviations());
                let pairs: Vec<(f64, f64)> = pairs.map(|(weight, scale)| (*weight, *scale)).collect();
                let start = Mixture::<Gaussian>::new(surface_albedo, &pairs).expect("valid terms");
                let fit = target.refine(&start);
                let direct = judge.l1_error(&fit.mixture, f64::INFINITY);
                let extra = judge.l1_error(&embedded, f64::INFINITY) - direct;
                assert!(extra.abs() < 1e-5, "{surface_albedo}, {terms}: {extra:e}");
                assert!(l1_error(&embedded, &fit.mixture, f64::INFINITY) < 1e-3);
            }
        }
    }
}

#[test]
fn more_terms_are_better() {
    for configuration in CONFIGURATIONS {
        for surface_albedo in [0.01, 0.5, 0.99] {
            let judge = Judge::new(&exact_half_space(surface_albedo, configuration));
            let fits = fits(surface_albedo, configuration);
            for pair in fits.windows(2) {
                assert!(pair[1].residual < 0.8 * pair[0].residual);
                let errors = [&pair[0], &pair[1]].map(|fit| judge.l1_error(&fit.mixture, f64::INFINITY));
                assert!(errors[1] < 0.8 * errors[0], "{errors:?}");
            }
        }
    }
}

#[test]
fn more_terms_are_never_worse_even_where_one_is_enough() {
    let one = Mixture::<Gaussian>::new(0.3, &[(1.0, 2.0)]).expect("valid terms");
    let fits = fit::<Gaussian>(&one, 4).expect("valid");
    assert!(fits.iter().all(|fit| fit.residual < 1e-10));
}

#[test]
fn weights_are_shares_and_scales_rise() {
    for configuration in CONFIGURATIONS {
        for Fit { mixture, .. } in fits(0.6, configuration) {
            assert!(mixture.weights().iter().all(|weight| *weight >= 0.0));
            assert!((mixture.weights().iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(mixture.scales().is_sorted() && mixture.scales()[0] > 0.0);
            assert!((mixture.surface_albedo() - 0.6).abs() < 1e-12);
        }
    }
}

#[test]
fn known_mixtures_are_recovered_in_any_unit() {
    for unit in [1e-100, 1.0, 1e100] {
        let terms = [(0.2, 0.05 * unit), (0.5, 0.4 * unit), (0.3, 2.0 * unit)];
        let known = Mixture::<Gaussian>::new(0.8, &terms).expect("valid terms");
        let found = &fit::<Gaussian>(&known, 3).expect("valid")[2];
        assert!(found.residual < 1e-12, "{unit:e}: {:e}", found.residual);
        for (found, expected) in found.mixture.terms().zip(known.terms()) {
            assert!((found.0 - expected.0).abs() < 1e-10 && (found.1 / expected.1 - 1.0).abs() < 1e-10);
        }
    }
}

/// Moving any one weight or scale raises the residual, in proportion to the square of the move.
#[test]
fn fits_are_local_optima() {
    for surface_albedo in [0.1, 0.9] {
        let target = target(surface_albedo, Configuration::Searchlight);
        for fit in target.fit::<Gaussian>(6).expect("valid") {
            let terms: Vec<(f64, f64)> = fit.mixture.terms().collect();
            for k in 0..terms.len() {
                for factor in [0.999, 1.001] {
                    let (mut lighter, mut wider) = (terms.clone(), terms.clone());
                    lighter[k].0 *= factor;
                    wider[k].1 *= factor;
                    for moved in [lighter, wider] {
                        if moved.len() == 1 && moved[0].1 == terms[0].1 {
                            continue; // one weight is always 1
                        }
                        let moved = Mixture::<Gaussian>::new(surface_albedo, &moved).expect("valid terms");
                        let (here, there) = (fit.residual.powi(2), target.residual(&moved).powi(2));
                        assert!(there > here, "{terms:?} {k}: {here:e} {there:e}");
                        assert!(there - here < 1e-4, "{here:e} {there:e}");
                    }
                }
            }
        }
    }
}

/// No start of 25 that are drawn at random ends lower.
///
/// That is no proof; but an optimum that draws a share q of starts is missed with probability (1 − q)²⁵.
#[test]
fn random_starts_find_nothing_better() {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for surface_albedo in [0.3, 0.95] {
        let target = target(surface_albedo, Configuration::Searchlight);
        let gaussians = target.fit::<Gaussian>(4).expect("valid");
        let exponentials = target.fit::<Exponential>(3).expect("valid");
        for _ in 0..25 {
            let start: Vec<(f64, f64)> =
                (0..4).map(|_| (random() + 1e-3, (8.0 * random() - 6.0).exp())).collect();
            for (k, best) in gaussians.iter().enumerate() {
                let start = Mixture::new(1.0, &start[..=k]).expect("valid terms");
                assert!(target.refine::<Gaussian>(&start).residual > best.residual - 1e-9);
            }
            for (k, best) in exponentials.iter().enumerate() {
                let start = Mixture::new(1.0, &start[..=k]).expect("valid terms");
                assert!(target.refine::<Exponential>(&start).residual > best.residual - 1e-9);
            }
        }
    }
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let black = embedded(0.0, Configuration::Diffuse, 3);
    assert_eq!(fit::<Gaussian>(&black, 2).unwrap_err().parameter, "total");
    let grey = embedded(0.5, Configuration::Diffuse, 3);
    assert_eq!(fit::<Gaussian>(&grey, 0).unwrap_err().parameter, "terms");
    assert_eq!(fit::<Gaussian>(&grey, 17).unwrap_err().parameter, "terms");
}
