//! Time of the exact solution on one core, and of layers, whose profiles take all cores.
//!
//! `cargo bench -p translucid-reference --bench exact`.
//! The goals are 10 ms for `one_albedo` and 1 s for `set_of_albedos`.

use divan::{Bencher, black_box};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_reference::layers::{DiffuseProfile, Ground, Layer, Layers, LayersProfile, Totals};

fn main() {
    divan::main();
}

const INCIDENCES: [(&str, Incidence); 3] = [
    ("searchlight", Incidence::NORMAL),
    ("diffuse", Incidence::Cosine),
    ("uniform", Incidence::UniformCosine),
];

fn incidence(name: &str) -> Incidence {
    INCIDENCES.iter().find(|(known, _)| *known == name).expect("a name of the list").1
}

fn names() -> impl Iterator<Item = &'static str> {
    INCIDENCES.iter().map(|(name, _)| *name)
}

/// 200 radii from 1e-3 to 100 mean free paths, evenly spaced in the logarithm.
fn radii() -> impl Iterator<Item = f64> {
    (0..200).map(|i| 10f64.powf(f64::from(i) / 199.0 * 5.0 - 3.0))
}

/// Solves for α = 0.9.
#[divan::bench(args = names())]
fn solve(name: &str) -> HalfSpace {
    HalfSpace::new(black_box(0.9), incidence(name)).expect("valid parameters")
}

/// R(r) at 200 radii of a solved half space.
#[divan::bench]
fn eval_at_200_radii(bencher: Bencher<'_, '_>) {
    let half_space = HalfSpace::new(0.9, Incidence::NORMAL).expect("valid parameters");
    bencher.bench_local(|| radii().map(|r| half_space.eval(black_box(r)).value).sum::<f64>());
}

/// Enclosed energy at 200 radii of a solved half space.
#[divan::bench]
fn enclosed_at_200_radii(bencher: Bencher<'_, '_>) {
    let half_space = HalfSpace::new(0.9, Incidence::NORMAL).expect("valid parameters");
    bencher.bench_local(|| radii().map(|r| half_space.enclosed(black_box(r)).value).sum::<f64>());
}

/// One albedo from scratch, R(r) at 200 radii.
#[divan::bench(args = names())]
fn one_albedo(name: &str) -> f64 {
    let half_space = HalfSpace::new(black_box(0.9), incidence(name)).expect("valid parameters");
    radii().map(|r| half_space.eval(r).value).sum()
}

/// Surface albedos 0.01, 0.02, … 0.99, each inverted, solved and evaluated at 200 radii.
#[divan::bench(args = names(), sample_count = 3, sample_size = 1)]
fn set_of_albedos(name: &str) -> f64 {
    (1..100)
        .map(|i| {
            let half_space = HalfSpace::from_surface_albedo(f64::from(i) / 100.0, incidence(name));
            let half_space = half_space.expect("valid parameters");
            radii().map(|r| half_space.eval(r).value).sum::<f64>()
        })
        .sum()
}

/// Paint, a primer and wood.
fn three_layers(g: f64, eta: f64) -> Layers {
    let layers = [(20.0, 0.1, 0.1), (5.0, 0.5, 0.2), (2.0, 0.2, f64::INFINITY)];
    let layer = |(scattering, absorption, thickness)| {
        Layer::new(scattering, absorption, thickness).with_g(g).with_eta(eta)
    };
    Layers::new(1.0, layers.map(layer).into(), Ground::None).expect("valid layers")
}

/// Totals of three layers, by g and η.
#[divan::bench(args = [(0.0, 1.0), (0.8, 1.0), (0.0, 1.4), (0.8, 1.4)])]
fn totals_of_three_layers((g, eta): (f64, f64)) -> Totals {
    three_layers(black_box(g), eta).totals(Incidence::NORMAL).expect("valid incidence")
}

/// R(r) of three layers, by g and η.
#[divan::bench(sample_count = 3, sample_size = 1, args = [(0.0, 1.0), (0.0, 1.4), (0.8, 1.0), (0.8, 1.4)])]
fn profile_of_three_layers((g, eta): (f64, f64)) -> LayersProfile {
    three_layers(black_box(g), eta).profile().expect("solvable layers")
}

/// R(r) of three layers in diffuse light, for pictures, by g and η.
#[divan::bench(sample_count = 10, sample_size = 1, args = [(0.0, 1.0), (0.0, 1.4), (0.8, 1.0), (0.8, 1.4)])]
fn diffuse_profile_of_three_layers((g, eta): (f64, f64)) -> DiffuseProfile {
    three_layers(black_box(g), eta).diffuse_profile().expect("solvable layers")
}

/// R(r) at 200 radii of three solved layers.
#[divan::bench(args = [(0.0, 1.0), (0.8, 1.4)])]
fn eval_of_layers_at_200_radii(bencher: Bencher<'_, '_>, layers: (f64, f64)) {
    let profile = profile_of_three_layers(layers);
    bencher.bench_local(|| radii().map(|r| profile.reflectance(black_box(r)).value).sum::<f64>());
}
