//! The medium behind a surface albedo, which renderers walk through, against the exact solution and plain walks.
//!
//! The walk is scalar and analog; its mean is that of 100,000 photons, and each of the ten comparisons allows four
//! standard errors (a false alarm in 16,000, in all of them in 1,600) beside the table's 2e-5.

use std::f64::consts::TAU;

use translucid_profile::{AlbedoInversion, Configuration, fresnel_from_inside, fresnel_from_outside};
use translucid_reference::Incidence;
use translucid_reference::exact::single_scattering_albedo;
use translucid_testing::{SplitMix, power};

use crate::plain_walk::Random;

const CONFIGURATIONS: [(Configuration, Incidence); 2] =
    [(Configuration::Searchlight, Incidence::NORMAL), (Configuration::Diffuse, Incidence::Cosine)];

/// The surface albedo of the medium's exact solution is A to 3e-5: its single-scattering albedo lies between those of
/// A − 3e-5 and of A + 3e-5, between which the exact solution rises.
#[test]
fn isotropic_medium_has_the_exact_albedo() {
    for (configuration, incidence) in CONFIGURATIONS {
        for eta in [1.0, 1.4] {
            let inversion = AlbedoInversion::new(0.0, eta, configuration).unwrap();
            for a in [0.05, 0.5, 0.95] {
                let alpha = inversion.single_scattering_albedo(a);
                let exact = |a| single_scattering_albedo(a, eta, incidence).unwrap();
                let allowed = exact(a - 3e-5)..exact(a + 3e-5);
                assert!(allowed.contains(&alpha), "{configuration:?} eta {eta} A {a}: {alpha} {allowed:?}");
            }
        }
    }
}

/// Cosine to the normal inside, of light that enters.
fn entering_cosine(configuration: Configuration, eta: f64, random: &mut Random) -> f64 {
    match configuration {
        Configuration::Searchlight => 1.0,
        Configuration::Diffuse => loop {
            let outside = random.next().sqrt();
            if random.next() > fresnel_from_outside(outside, eta) {
                return (1.0 - (1.0 - outside * outside) / (eta * eta)).sqrt();
            }
        },
    }
}

/// Tells whether a photon leaves again: depth and cosine (inward) are all that counts.
fn leaves(alpha: f64, g: f64, eta: f64, mut cosine: f64, random: &mut Random) -> bool {
    let mut depth = 0.0;
    loop {
        depth -= random.next().ln() * cosine;
        while depth < 0.0 {
            if random.next() > fresnel_from_inside(cosine, eta) {
                return true;
            }
            (depth, cosine) = (-depth, -cosine);
        }
        if random.next() > alpha {
            return false;
        }
        // L. G. Henyey and J. L. Greenstein 1941
        let xi = 2.0 * random.next() - 1.0;
        let turn =
            if g == 0.0 { xi } else { (1.0 + g * g - ((1.0 - g * g) / (1.0 + g * xi)).powi(2)) / (2.0 * g) };
        let sines = ((1.0 - turn * turn) * (1.0 - cosine * cosine)).max(0.0).sqrt();
        cosine = (turn * cosine + sines * (TAU * random.next()).cos()).clamp(-1.0, 1.0);
    }
}

#[test]
fn medium_has_the_albedo_of_a_walk() {
    let photons = power(100_000);
    let cases = [(0.8, 1.0, 0.3), (-0.5, 1.0, 0.6), (0.9, 1.5, 0.3), (0.5, 1.4, 0.8), (0.95, 1.0, 0.5)];
    for (number, (g, eta, a)) in cases.into_iter().enumerate() {
        for (configuration, _) in CONFIGURATIONS {
            let inversion = AlbedoInversion::new(g, eta, configuration).unwrap();
            let alpha = inversion.single_scattering_albedo(a);
            let mut random = Random(SplitMix((number as u64) << 40));
            let mut count = 0_u64;
            for _ in 0..photons {
                let cosine = entering_cosine(configuration, eta, &mut random);
                count += u64::from(leaves(alpha, g, eta, cosine, &mut random));
            }
            let found = count as f64 / photons as f64;
            let error = (a * (1.0 - a) / photons as f64).sqrt();
            assert!(
                (found - a).abs() < 4.0 * error + 2e-5,
                "{configuration:?} g {g} eta {eta} A {a}: {found}"
            );
        }
    }
}
