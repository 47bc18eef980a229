//! Photon beam diffusion against the exact half space: single scattering, which it has exactly, and how far off
//! the whole is.

use std::f64::consts::PI;

use translucid_profile::{
    Appearance, BeamSingleScattering, Medium, Parameterization, PhotonBeamDiffusion, Profile,
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
        assert!((single.surface_albedo() / exact.total().value - 1.0).abs() < 1e-8);
        for r in [1e-9, 1e-4, 0.01, 0.3, 1.0, 5.0, 20.0, 50.0] {
            let pairs = [
                (single.eval(r), exact.eval(r).value),
                (single.enclosed(r), exact.enclosed(r).value),
                (single.beyond(r), exact.beyond(r).value),
            ];
            for (found, expected) in pairs {
                assert!((found / expected - 1.0).abs() < 1e-7, "{r}: {found:e} {expected:e}");
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
        let exact = oblique(0.9, eta, 1.0);
        let single = BeamSingleScattering::from_medium(&medium, eta).expect("valid");
        let (found, expected) = (single.eval(1e-6), exact.eval(1e-6, 0.0).value);
        assert!((found / expected - 1.0).abs() < 1e-4, "{eta}: {found} {expected}");
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
