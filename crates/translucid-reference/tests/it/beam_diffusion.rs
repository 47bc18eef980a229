//! Photon beam diffusion against the exact half space: single scattering, which it has exactly, and how far off
//! the whole is.

use std::f64::consts::PI;

use translucid_profile::{
    Appearance, BeamSingleScattering, Medium, ObliquePhotonBeamDiffusion, Parameterization,
    PhotonBeamDiffusion, Profile,
};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_testing::is_thorough;

use crate::solutions::oblique;

fn appearance(surface_albedo: f64) -> Appearance {
    Appearance { surface_albedo, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 }
}

#[test]
fn single_scattering_is_exact() {
    for alpha in [0.3, 0.99] {
        let exact = HalfSpace::new(alpha, Incidence::NORMAL).expect("valid");
        let exact = exact.single_scattering();
        let medium = Medium::from_mfp(alpha, 1.0, 0.0).expect("valid");
        let single = BeamSingleScattering::from_medium(&medium, 1.0).expect("valid");
        assert!((single.total() / exact.total().value - 1.0).abs() < 1e-12);
        for r in [1e-9, 1e-4, 0.01, 0.3, 1.0, 5.0, 20.0, 50.0] {
            let pairs = [
                (single.eval(r), exact.eval(r).value),
                (single.enclosed(r), exact.enclosed(r).value),
                (single.beyond(r), exact.beyond(r).value),
            ];
            for (found, expected) in pairs {
                assert!((found / expected - 1.0).abs() < 1e-11, "{r}: {found:e} {expected:e}");
            }
        }
    }
}

/// With a boundary the exact solution does not tell single scattering apart, but near the entry there is little
/// else: a few units of R in 1e4 to 1e5.
#[test]
fn single_scattering_under_a_boundary_is_the_limit_at_the_entry() {
    let indices = if is_thorough() { &[0.8, 1.4][..] } else { &[1.4] };
    for &eta in indices {
        let medium = Medium::from_mfp(0.9, 1.0, 0.0).expect("valid");
        let exact = oblique(0.9, eta, 0.7);
        let beam = ObliquePhotonBeamDiffusion::from_medium(&medium, eta, 0.7).expect("valid");
        for phi in [0.0, 0.8, PI] {
            let (found, expected) = (beam.single_scattering(1e-6, phi), exact.eval(1e-6, phi).value);
            assert!((found / expected - 1.0).abs() < 1e-4, "{eta} {phi}: {found} {expected}");
        }
    }
}

/// Radii of a trapezoidal rule in ln r, and its step.
fn radii(first: f64, last: f64, count: i32) -> (impl Iterator<Item = f64>, f64) {
    let step = (last / first).ln() / f64::from(count - 1);
    ((0..count).map(move |i| first * (f64::from(i) * step).exp()), step)
}

/// ∫ |R − R_exact| 2πr dr/A at the same surface albedo and mean free path.
#[test]
fn mean_error_is_as_stated() {
    for (a, stated) in [(0.2, 0.0285), (0.5, 0.0714), (0.8, 0.129)] {
        let exact = HalfSpace::from_surface_albedo(a, Incidence::NORMAL).expect("valid");
        let profile = PhotonBeamDiffusion::new(&appearance(a), 1.0).expect("valid");
        let (radii, step) = radii(1e-4, 60.0, 160);
        let error: f64 =
            radii.map(|r| (profile.eval(r) - exact.eval(r).value).abs() * 2.0 * PI * r * r * step / a).sum();
        assert!((error / stated - 1.0).abs() < 0.01, "{a}: {error}");
    }
}

/// Checks the mean error over the plane, as a part of the exact surface albedo at that angle; A is the
/// surface albedo along the normal.
fn assert_mean_error_of_oblique_beam(a: f64, cos_theta: f64, stated: f64) {
    let alpha =
        HalfSpace::from_surface_albedo(a, Incidence::NORMAL).expect("valid").single_scattering_albedo();
    let exact = oblique(alpha, 1.0, cos_theta);
    let beam = ObliquePhotonBeamDiffusion::new(&appearance(a), 1.0, cos_theta).expect("valid");
    let (radii, step) = radii(1e-3, 40.0, 40);
    let mut error = 0.0;
    for r in radii {
        for j in 0..8 {
            let phi = PI * (f64::from(j) + 0.5) / 8.0;
            let off = (beam.eval(r, phi) - exact.eval(r, phi).value).abs();
            error += off * 2.0 * PI * r * r * step / 8.0;
        }
    }
    error /= exact.total().value;
    assert!((error / stated - 1.0).abs() < 0.01, "{a} {cos_theta}: {error}");
}

#[test]
fn mean_error_of_an_oblique_beam_is_as_stated() {
    assert_mean_error_of_oblique_beam(0.5, 0.5, 0.105);
}

/// Seconds for each beam, when tests run with their whole power.
#[test]
fn mean_errors_of_oblique_beams_are_as_stated() {
    if !is_thorough() {
        return;
    }
    for (a, cos_theta, stated) in [(0.2, 0.5, 0.0506), (0.5, 0.8, 0.0807), (0.8, 0.5, 0.157)] {
        assert_mean_error_of_oblique_beam(a, cos_theta, stated);
    }
}
