//! Tests of the profiles: by the exact half space, equal layers, totals, and a slow walk in layers.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

use translucid_testing::is_thorough;

use super::super::Layer;
use super::*;
use crate::Incidence;
use crate::body::layered::arriving;
use crate::body::photon::Fate;
use crate::exact::HalfSpace;
use crate::split_mix::SplitMix;

fn profile(layers: Vec<Layer>, ground: Ground) -> LayersProfile {
    Layers::new(1.0, layers, ground).expect("valid").profile().expect("solvable")
}

const RADII: [f64; 11] = [1e-4, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];

#[test]
fn half_space_has_the_exact_profile() {
    for alpha in [0.3, 0.9, 0.999, 1.0] {
        // In another unit of length
        let layer = Layer::new(5.0 * alpha, 5.0 * (1.0 - alpha), f64::INFINITY);
        let profile = profile(vec![layer], Ground::None);
        let exact = HalfSpace::new(alpha, Incidence::NORMAL).unwrap();
        for r in RADII {
            let (found, expected) = (profile.reflectance(r / 5.0), 25.0 * exact.eval(r).value);
            let off = (found.value / expected - 1.0).abs();
            // Far out without absorption less is known, and said so
            let allowed = if r > 30.0 { 3e-3 } else { 1e-4 };
            assert!(off < allowed, "{alpha} {r}: {found:?} {expected} {off:e}");
            assert!(off < found.relative_error(), "{alpha} {r}: {found:?} {expected} {off:e}");
        }
    }
}

#[test]
fn equal_layers_are_one() {
    let part = |thickness: f64| Layer::new(2.0, 0.1, thickness);
    for ground in [Ground::AIR, Ground::Lambertian { reflectance: 0.6 }] {
        let one = profile(vec![part(1.0)], ground);
        let parts = profile(vec![part(0.1), part(0.55), part(0.35)], ground);
        for r in RADII.iter().take(9) {
            for function in [LayersProfile::reflectance, LayersProfile::transmittance] {
                let [one, parts] = [&one, &parts].map(|profile| function(profile, *r));
                let off = (one.value - parts.value).abs();
                assert!(off <= one.error + parts.error, "{r}: {one:?} {parts:?}");
                assert!(off <= 1e-4 * one.value, "{r}: {one:?} {parts:?}");
            }
        }
    }
    // With g and faces, by other panels of depths
    let part = |thickness: f64| Layer::new(2.0, 0.1, thickness).with_g(0.5).with_eta(1.4);
    let one = profile(vec![part(1.0)], Ground::AIR);
    let parts = profile(vec![part(0.3), part(0.7)], Ground::AIR);
    for r in [0.1, 0.3, 1.0, 3.0] {
        for function in [LayersProfile::reflectance, LayersProfile::transmittance] {
            let [one, parts] = [&one, &parts].map(|profile| function(profile, r));
            assert!((one.value / parts.value - 1.0).abs() < 1e-3, "{r}: {one:?} {parts:?}");
            assert!((one.value - parts.value).abs() <= one.error, "{r}: {one:?} {parts:?}");
        }
    }
    let thick = profile(vec![Layer::new(0.9, 0.1, 40.0)], Ground::BLACK);
    let endless = profile(vec![Layer::new(0.9, 0.1, f64::INFINITY)], Ground::None);
    for r in RADII.iter().take(9) {
        let [thick, endless] = [&thick, &endless].map(|profile| profile.reflectance(*r).value);
        assert!((thick / endless - 1.0).abs() < 1e-4, "{r}: {thick} {endless}");
    }
}

/// Stacks of unequal layers: a thin dense one, a clear and an absorbing one between, a weak one below.
fn stacks() -> [(Vec<Layer>, Ground); 4] {
    let [dense, weak] = [Layer::new(4.0, 0.02, 0.2), Layer::new(0.8, 0.1, 1.5)];
    [
        (vec![dense.clone(), weak.clone()], Ground::AIR),
        (
            vec![dense.clone(), Layer::new(0.0, 0.0, 0.3), weak.clone()],
            Ground::Lambertian { reflectance: 0.8 },
        ),
        (vec![weak.clone(), Layer::new(0.0, 0.5, 0.2), dense.clone()], Ground::BLACK),
        (vec![dense, Layer { thickness: f64::INFINITY, ..weak }], Ground::None),
    ]
}

/// ∫ R 2πr dr, by radii evenly spaced in ln r.
#[test]
fn profiles_have_the_totals() {
    for (layers, ground) in stacks() {
        let layers = Layers::new(1.0, layers, ground).unwrap();
        let (profile, totals) = (layers.profile().unwrap(), layers.totals(Incidence::NORMAL).unwrap());
        let step = 0.1;
        let sum = |function: fn(&LayersProfile, f64) -> Estimate| -> f64 {
            let ring = |i: i32| {
                let r = (step * f64::from(i)).exp();
                2.0 * PI * r * r * step * function(&profile, r).value
            };
            (-160..60).map(ring).sum()
        };
        for (sum, total) in [
            (sum(LayersProfile::reflectance), totals.diffuse_reflectance),
            (sum(LayersProfile::transmittance), totals.diffuse_transmittance),
        ] {
            assert!((sum - total).abs() < 2e-6, "{ground:?}: {sum} {total}");
        }
    }
}

/// Counts in rings, each within 5 standard errors: once in 10⁵ runs one of the 56 is farther off by chance.
#[test]
fn layers_are_those_of_a_slow_walk() {
    let photons = if is_thorough() { 20_000_000 } else { 1_000_000 };
    let ends = [0.0, 0.02, 0.05, 0.15, 0.4, 0.8, 1.5, 3.0];
    for (layers, ground) in stacks() {
        let layers = Layers::new(1.0, layers, ground).unwrap();
        let mut random = SplitMix::of_photon(7, 0);
        let mut counts = [[0.0; 7]; 2];
        for _ in 0..photons {
            let end = arriving(&layers, Incidence::NORMAL, &mut random).expect("no face reflects");
            let [x, y, _] = end.ray.position;
            let ring = ends.partition_point(|end| *end <= x.hypot(y)) - 1;
            // Light that goes straight through is a beam, and not in the profile
            if let Fate::Left(side) = end.fate
                && ring < 7
                && x != 0.0
            {
                counts[side][ring] += 1.0;
            }
        }
        let profile = layers.profile().unwrap();
        for (side, function) in [LayersProfile::reflectance, LayersProfile::transmittance].iter().enumerate()
        {
            for (ring, end) in ends.windows(2).enumerate() {
                let rule = translucid_profile::quadrature::gauss_legendre(12);
                let expected = translucid_profile::quadrature::integrate(&rule, end[0], end[1], |r| {
                    2.0 * PI * r * function(&profile, r).value
                });
                let found = counts[side][ring] / f64::from(photons);
                let error = (expected * (1.0 - expected) / f64::from(photons)).sqrt();
                let off = (found - expected).abs();
                assert!(
                    off <= 5.0 * error + 1e-12,
                    "{ground:?} {side} {end:?}: {found} {expected} ± {error}"
                );
            }
        }
    }
}

#[test]
fn profiles_that_are_not_solved_are_refused() {
    let refused = |layers: Vec<Layer>, ground| {
        Layers::new(1.0, layers, ground).unwrap().profile().unwrap_err().to_string()
    };
    let plain = Layer::new(1.0, 0.1, 1.0);
    assert!(
        refused(vec![plain.clone(), plain.clone().with_g(0.95)], Ground::AIR)
            .starts_with("layer 2: moment 32 of the phase function is 0.19371")
    );
    assert!(
        refused(vec![plain.clone().with_eta(1.4), Layer::new(1e4, 0.0, 1.0)], Ground::AIR)
            .contains("greatest extinction over the least is")
    );
    assert!(
        refused(vec![plain.clone().with_eta(1.4); 11], Ground::AIR).contains("layers that scatter is 11")
    );
    let layers = [1.1, 1.2, 1.3, 1.4].map(|eta| plain.clone().with_eta(eta));
    assert!(refused(layers.into(), Ground::AIR).contains("number of different eta is 5"));
    assert!(refused(vec![plain; 100], Ground::AIR).contains("number of depths that the layers need is"));
    // Light of a spot on the ground is as sharp as the layers are thin
    let white = Ground::Lambertian { reflectance: 0.9 };
    for thin in [
        vec![Layer::new(1.0, 0.1, 0.01).with_g(0.3).with_eta(1.5)],
        vec![Layer::new(0.0, 0.0, 1e-3).with_eta(1.5)],
    ] {
        assert!(refused(thin.clone(), white).contains("that the ground is deep is 0"));
        assert!(Layers::new(1.0, thin, Ground::BLACK).unwrap().profile().is_ok());
    }
}

/// Faces, by the exact half space under a boundary.
#[test]
fn half_space_under_a_face_has_the_exact_profile() {
    for (alpha, eta) in [(0.9, 1.4), (0.6, 0.8), (0.99, 1.5)] {
        let layer = Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_eta(eta);
        let profile = profile(vec![layer], Ground::None);
        let exact = HalfSpace::with_boundary(alpha, eta, Incidence::NORMAL).unwrap();
        let entered = 1.0 - crate::specular_reflectance(Incidence::NORMAL, eta);
        for r in [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0] {
            let (found, expected) = (profile.reflectance(r), entered * exact.eval(r).value);
            let off = (found.value / expected - 1.0).abs();
            assert!(off < found.relative_error(), "{alpha} {eta} {r}: {found:?} {expected} {off:e}");
            assert!(
                off < if r > 5.0 { 1e-2 } else { 5e-4 },
                "{alpha} {eta} {r}: {found:?} {expected} {off:e}"
            );
        }
    }
}

/// Coarser rules keep to their errors, and to 0.005 for the layers of `profile_within`'s doc comment.
#[test]
fn quick_profiles_keep_to_their_errors() {
    let skin = |scattering, absorption, thickness| {
        Layer::new(scattering, absorption, thickness).with_g(0.8).with_eta(1.4)
    };
    let endless = (vec![skin(20.0, 1.5, 0.1), skin(15.0, 0.1, f64::INFINITY)], Ground::None);
    let mut stacks: Vec<(Vec<Layer>, Ground)> = stacks().into();
    stacks.extend([endless, (vec![skin(8.0, 0.2, 0.2), skin(10.0, 0.1, 0.3)], Ground::AIR)]);
    for (layers, ground) in stacks {
        let layers = Layers::new(1.0, layers, ground).unwrap();
        let quick = layers.profile_within(5e-3, &Control::default()).unwrap().unwrap();
        let fine = layers.profile().unwrap();
        for r in [0.005, 0.01, 0.03, 0.1, 0.3, 0.5] {
            for function in [LayersProfile::reflectance, LayersProfile::transmittance] {
                let [quick, fine] = [&quick, &fine].map(|profile| function(profile, r));
                let off = (quick.value - fine.value).abs();
                assert!(off <= quick.error + fine.error, "{ground:?} {r}: {quick:?} {fine:?}");
            }
            let [quick, fine] = [&quick, &fine].map(|profile| profile.reflectance(r).value);
            let off = (quick / fine - 1.0).abs();
            assert!(off < 5e-3 || r < 0.01, "{ground:?} {r}: {quick} {fine}");
        }
    }
}

#[test]
fn profiles_are_watched_and_stopped() {
    let face = vec![Layer::new(1.0, 0.1, 1.0).with_eta(1.4)];
    for layers in [face, vec![Layer::new(1.0, 0.1, 1.0)]] {
        let layers = Layers::new(1.0, layers, Ground::AIR).unwrap();
        let [stop, most] = [AtomicBool::new(false), AtomicBool::new(false)];
        let progress = |part: u64| most.store(part >= 1000, Ordering::Relaxed);
        let control = Control { stop: &stop, progress: &progress, ..Control::default() };
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert!(one.install(|| layers.profile_within(0.1, &control).unwrap().is_some()));
        assert!(most.load(Ordering::Relaxed));
        stop.store(true, Ordering::Relaxed);
        assert!(layers.profile_within(0.1, &control).unwrap().is_none());
        for tolerance in [0.0, f64::NAN, 0.2] {
            let error = layers.profile_within(tolerance, &control).unwrap_err().to_string();
            assert!(error.starts_with("tolerance is "), "{error}");
        }
    }
}

/// g with faces, by photons one by one in rings: the walk shares no code with the solution.
#[test]
fn layers_with_g_and_faces_are_those_of_the_walk() {
    let skin = |scattering: f64, absorption: f64, thickness: f64| {
        Layer::new(scattering, absorption, thickness).with_g(0.8).with_eta(1.4)
    };
    let stacks = [
        (vec![skin(20.0, 1.5, 0.1), skin(15.0, 0.5, f64::INFINITY)], Ground::None),
        (vec![skin(8.0, 0.2, 0.2), Layer::new(10.0, 0.1, 0.3).with_g(0.6).with_eta(1.5)], Ground::AIR),
    ];
    let photons = if is_thorough() { 100_000_000 } else { 300_000 };
    let rule = translucid_profile::quadrature::gauss_legendre(8);
    for (layers, ground) in stacks {
        let layers = Layers::new(1.0, layers, ground).unwrap();
        let profile = layers.profile().unwrap();
        let totals = layers.totals(Incidence::NORMAL).unwrap();
        let grid = crate::layers::Grid { dz: 1.0, dr: 0.08, nz: 1, nr: 10, na: 1 };
        let tally = layers.walk(Incidence::NORMAL, grid, photons, 5, &Control::default()).unwrap();
        for ring in 0..9 {
            let inner = grid.dr * ring as f64;
            let mean = |function: fn(&LayersProfile, f64) -> Estimate| {
                let part = |of: fn(Estimate) -> f64| {
                    let flux = |r: f64| 2.0 * PI * r * of(function(&profile, r));
                    translucid_profile::quadrature::integrate(&rule, inner, inner + grid.dr, flux)
                        / grid.ring_area(ring)
                };
                Estimate { value: part(|light| light.value), error: part(|light| light.error) }
            };
            let below = (ring > 0 && ground == Ground::AIR)
                .then(|| (mean(LayersProfile::transmittance), tally.transmittance(ring)));
            let above = (mean(LayersProfile::reflectance), tally.reflectance(ring));
            for (found, walked) in std::iter::once(above).chain(below) {
                let off = (found.value - walked.value).abs();
                assert!(off < 4.0 * walked.error + found.error, "{ground:?} {ring}: {found:?} {walked:?}");
                assert!(found.relative_error() < 3e-2, "{ground:?} {ring}: {found:?} {walked:?}");
            }
        }
        let step = 0.1;
        let sum = |function: fn(&LayersProfile, f64) -> Estimate| -> f64 {
            let ring = |i: i32| {
                let r = (step * f64::from(i)).exp();
                2.0 * PI * r * r * step * function(&profile, r).value
            };
            (-120..40).map(ring).sum()
        };
        let reflected = sum(LayersProfile::reflectance);
        assert!((reflected / totals.diffuse_reflectance - 1.0).abs() < 2e-3, "{reflected} {totals:?}");
        if ground == Ground::AIR {
            let transmitted = sum(LayersProfile::transmittance);
            assert!(
                (transmitted / totals.diffuse_transmittance - 1.0).abs() < 5e-3,
                "{transmitted} {totals:?}"
            );
        }
    }
}

#[test]
fn extremes_give_numbers() {
    for (layers, ground) in [
        (vec![Layer::new(0.0, 0.0, 1.0)], Ground::AIR),
        (vec![Layer::new(0.0, 1.0, 1.0)], Ground::Lambertian { reflectance: 1.0 }),
        (vec![Layer::new(1.0, 0.0, 1e6)], Ground::AIR),
        (vec![Layer::new(1e-6, 0.0, 1e-3), Layer::new(1e3, 1.0, 10.0)], Ground::BLACK),
        (vec![Layer::new(0.0, 0.0, 1.0).with_eta(1.5)], Ground::AIR),
        (vec![Layer::new(0.01, 0.0, 200.0).with_eta(1.5)], Ground::Lambertian { reflectance: 1.0 }),
        (vec![Layer::new(1.0, 0.0, 1e5).with_eta(1.3)], Ground::AIR),
        (vec![Layer::new(1e-3, 0.0, 1e-9).with_g(-0.5)], Ground::BLACK),
        (vec![Layer::new(1e-300, 0.0, 1.0)], Ground::AIR),
        (vec![Layer::new(1.0, 0.0, f64::INFINITY).with_moments(vec![0.0, 0.1])], Ground::None),
    ] {
        let profile = profile(layers, ground);
        for r in [f64::NAN, -1.0, 0.0, 1e-300, 1e-9, 1.0, 1e9, f64::INFINITY] {
            for function in [LayersProfile::reflectance, LayersProfile::transmittance] {
                let Estimate { value, error } = function(&profile, r);
                assert!(
                    value >= 0.0 && value.is_finite() && error >= 0.0 && error.is_finite(),
                    "{ground:?} {r}"
                );
            }
        }
    }
}

/// What a walk of two million photons counts between glass slides and above an air gap, where two solutions have an error in
/// common.
#[test]
fn errors_of_stacks_with_clear_layers_are_honest() {
    let glass = || Layer::new(0.0, 0.0, 0.2).with_eta(1.5);
    let slab = |eta| Layer::new(10.0, 0.1, 1.0).with_g(0.8).with_eta(eta);
    for (layers, r, walked, error) in [
        (vec![glass(), slab(1.33), glass()], 3.9, 3.766e-4, 4e-6),
        (vec![glass(), slab(1.33), glass()], 7.9, 3.92e-6, 3e-7),
        (vec![Layer::new(0.0, 0.0, 3.0), slab(1.4)], 11.85, 3.96e-5, 1.2e-6),
    ] {
        let found = profile(layers, Ground::AIR).reflectance(r);
        assert!((found.value - walked).abs() < found.error + 4.0 * error, "{r}: {found:?} {walked}");
    }
}

/// An endless layer that absorbs alone is a black ground.
#[test]
fn absorbers_below_are_black_ground() {
    let paint = Layer::new(5.0, 1.6, 0.1).with_g(0.7);
    let below = Layer::new(0.0, 2.0, f64::INFINITY);
    let found = profile(vec![paint.clone(), below], Ground::None);
    let black = profile(vec![paint], Ground::BLACK);
    for r in [0.05, 0.2, 0.5] {
        let [found, expected] = [&found, &black].map(|profile| profile.reflectance(r));
        let error = found.error + expected.error;
        assert!(
            (found.value - expected.value).abs() <= error && error < 0.1 * expected.value,
            "{r}: {found:?} {expected:?}"
        );
    }
}
