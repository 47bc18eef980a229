//! Fits of a medium with its second similarity parameter γ: to solved profiles, to walks, and to other phase functions.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use translucid_fit::{Errors, Estimate, MediumFit, MediumGrid, MediumProfile, Sample};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_reference::layers::{Ground, Layer, Layers, LayersProfile};
use translucid_reference::walk::{Control, Layout, Parameters, PhaseFunction, Problem, Side, WhiteTable};
use translucid_testing::power;

fn of_gamma(gamma: f64) -> PhaseFunction {
    PhaseFunction::TwoTerm { weight: MediumGrid::weight(gamma), g1: MediumGrid::PEAK, g2: 0.0 }
}

/// A half space of α' in transport mean free paths.
fn solved(alpha: f64, phase_function: PhaseFunction, tolerance: f64) -> LayersProfile {
    let scattering = alpha / (1.0 - phase_function.mean_cosine());
    let layer = Layer::new(scattering, 1.0 - alpha, f64::INFINITY).with_phase_function(phase_function);
    let layers = Layers::new(1.0, vec![layer], Ground::None).unwrap();
    layers.profile_within(tolerance, &Control::default()).unwrap().unwrap()
}

/// Nodes of the grid that any test has asked for: solving them is nearly all of the work.
static NODES: Mutex<BTreeMap<[u64; 2], Arc<LayersProfile>>> = Mutex::new(BTreeMap::new());

fn node(alpha: f64, gamma: f64) -> Box<dyn Fn(f64) -> Estimate> {
    let mut nodes = NODES.lock().unwrap();
    let node = nodes.entry([alpha, gamma].map(f64::to_bits));
    let profile = Arc::clone(node.or_insert_with(|| Arc::new(solved(alpha, of_gamma(gamma), 5e-3))));
    Box::new(move |r| {
        let found = profile.reflectance(r);
        Estimate { value: found.value, error: found.error }
    })
}

/// Radii, even in ln r.
fn radii(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| low * libm::pow(high / low, i as f64 / (count - 1) as f64)).collect()
}

/// Samples of a profile without noise, of a transport mean free path and a relative error.
fn samples(radii: &[f64], mfp: f64, error: f64, profile: impl Fn(f64) -> f64) -> Vec<Sample> {
    let sample = |r: &f64| {
        let reflectance = profile(*r) / (mfp * mfp);
        Sample { r: r * mfp, reflectance, error: error * reflectance }
    };
    radii.iter().map(sample).collect()
}

#[test]
fn grid_is_close_to_what_is_solved() {
    let grid = MediumGrid::new(&node);
    for (alpha, gamma) in [(0.993, 1.45), (0.9, 1.75), (0.6, 1.2)] {
        let (row, truth) = (grid.row(alpha, gamma), solved(alpha, of_gamma(gamma), 1e-4));
        for r in [0.055, 0.1, 0.3, 1.0, 3.0, 8.0] {
            let truth = truth.reflectance(r);
            let off = row.eval(r) / truth.value - 1.0;
            let most = 3.0 * MediumGrid::error(r) + 3.0 * truth.error / truth.value;
            assert!(off.abs() < most, "{alpha} {gamma} {r}: {off:e}");
        }
    }
}

/// R(r) of a walk of a half space of α' and ℓ* = 1.
fn walked(alpha: f64, phase_function: &PhaseFunction, radii: &[f64], seed: u64) -> Vec<Sample> {
    let scattering = alpha / (1.0 - phase_function.mean_cosine());
    let extinction = scattering + 1.0 - alpha;
    let parameters = Parameters {
        phase_function: phase_function.clone(),
        incidence: Incidence::NORMAL,
        ..Parameters::default()
    };
    let at: Vec<f64> = radii.iter().map(|r| r * extinction).collect();
    let albedo = scattering / extinction;
    let mut table =
        WhiteTable::new(Problem::new(parameters).unwrap(), Layout::around(&at).unwrap(), albedo).unwrap();
    table.run(seed, power(40_000_000), &Control::default()).unwrap();
    let table = table.at_albedo(albedo).unwrap();
    let sample = |(r, at): (&f64, &f64)| {
        let found = table.at_radius(Side::Reflected, *at).unwrap().reflectance;
        let scale = extinction * extinction;
        Sample { r: *r, reflectance: found.value * scale, error: found.error * scale }
    };
    radii.iter().zip(&at).map(sample).collect()
}

/// Phase functions of other forms: Henyey and Greenstein's, sums of two, and one with a cosine squared (Bevilacqua and
/// Depeursinge 1999).
fn others() -> [(&'static str, PhaseFunction); 4] {
    let moment = |l: i32| 0.9 * 0.85_f64.powi(l) + if l == 2 { 0.04 } else { 0.0 };
    [
        ("Henyey–Greenstein 0.6", PhaseFunction::HenyeyGreenstein { g: 0.6 }),
        ("`two-term:0.95,0.85,-0.3`", PhaseFunction::TwoTerm { weight: 0.95, g1: 0.85, g2: -0.3 }),
        ("`two-term:0.9,0.8,-0.4`", PhaseFunction::TwoTerm { weight: 0.9, g1: 0.8, g2: -0.4 }),
        ("0.9 Henyey–Greenstein 0.85 + 0.1 cos²θ", PhaseFunction::Moments((1..=80).map(moment).collect())),
    ]
}

/// Samples without noise of the form that is assumed, and what is no table for it.
#[test]
fn medium_comes_back_with_its_gamma() {
    let grid = MediumGrid::new(&node);
    let fit = |samples: &[Sample]| MediumFit::with_gamma(samples, Errors::Known, &grid);
    for (alpha, gamma, mfp) in [(0.98, 1.45, 0.7), (0.9, 1.7, 3.0), (0.97, 1.0, 1.0)] {
        let truth = solved(alpha, of_gamma(gamma), 1e-4);
        let fit = fit(&samples(&radii(0.1, 8.0, 30), mfp, 0.01, |r| truth.reflectance(r).value)).unwrap();
        let found = fit.gamma().unwrap();
        assert!((found.value - gamma).abs() < 0.005 && found.error < 0.02, "{gamma}: {found:?}");
        assert!((fit.sigma_a().value * mfp / (1.0 - alpha) - 1.0).abs() < 0.01, "{:?}", fit.sigma_a());
        assert!((fit.sigma_s().value * mfp / alpha - 1.0).abs() < 3e-3, "{:?}", fit.sigma_s());
        let correlations = fit.correlations().unwrap();
        assert!((0..3).all(|i| (correlations[i][i] - 1.0).abs() < 1e-9), "{correlations:?}");
        assert_eq!(correlations[0][2], correlations[2][0]);
    }

    // Far from the light, 10 % leave gamma open
    let truth = solved(0.98, of_gamma(1.5), 1e-4);
    let far = fit(&samples(&radii(5.0, 12.0, 20), 1.0, 0.1, |r| truth.reflectance(r).value)).unwrap();
    assert!(!far.gamma_is_determined(), "{:?}", far.gamma());

    let profile = grid.row(0.98, 2.3);
    let near = samples(&radii(0.1, 8.0, 20), 1.0, 0.01, |r| profile.eval(r));
    for (samples, says) in [
        (&near[..3], "number of samples is 3, but must be in [4, 2000] with gamma"),
        (&near, "gamma is 1.95"),
        (&[&near[..], &[Sample { r: 40.0, ..near[19] }]].concat(), "r over the transport mean free path is"),
    ] {
        let message = fit(samples).unwrap_err().to_string();
        assert!(message.starts_with(says), "{message}");
    }
}

/// Higher moments than are assumed shift a fit as the guide's table says.
#[test]
fn other_phase_functions_shift_the_fit() {
    const ALBEDO: f64 = 0.98;
    let grid = MediumGrid::new(&node);
    let isotropic = |alpha: f64| -> MediumProfile {
        let half_space = HalfSpace::new(alpha, Incidence::NORMAL).unwrap();
        Box::new(move |r| half_space.eval(r).value)
    };
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/numbers.md");
    let guide = std::fs::read_to_string(path).unwrap();
    let mut missing = String::new();
    for (name, phase_function) in others() {
        let truth = solved(ALBEDO, phase_function.clone(), 1e-4);
        for (low, high) in [(0.1, 8.0), (0.5, 8.0), (2.0, 8.0)] {
            let samples = samples(&radii(low, high, 30), 1.0, 0.01, |r| truth.reflectance(r).value);
            let fit = MediumFit::with_gamma(&samples, Errors::Known, &grid).unwrap();
            let without = MediumFit::new(&samples, Errors::Known, &isotropic).unwrap();
            let off = |fit: &MediumFit| {
                let [a, s] = [fit.sigma_a().value / (1.0 - ALBEDO), fit.sigma_s().value / ALBEDO];
                // No negative zero
                [a, s].map(|part| format!("{:+}", (100.0 * (part - 1.0)).round() + 0.0)).join(" | ")
            };
            let (found, gamma) = (fit.gamma().unwrap(), phase_function.gamma());
            let shift = found.value - gamma;
            assert!(shift.abs() < if low < 0.3 { 0.2 } else { 0.13 }, "{name} {low}: {shift}");
            let row = format!(
                "| {name} | {gamma:.2} | {low}–{high} | {shift:+.2} ± {:.2} | {} | {} |\n",
                found.error,
                off(&fit),
                off(&without)
            );
            missing += if guide.contains(&row) { "" } else { &row };
        }
    }
    assert!(missing.is_empty(), "the guide has not\n{missing}");
}

/// σ_a, σ_s' and γ of two walks of the form that is assumed, |z| < 4.5 each, and γ of one of another form within 0.06 and 4.5
/// standard errors: false alarm 5e-5 in all.
#[test]
fn fits_agree_with_walks() {
    let grid = MediumGrid::new(&node);
    let fit = |alpha: f64, phase_function: &PhaseFunction, seed: u64| {
        let samples = walked(alpha, phase_function, &radii(0.15, 6.0, 16), seed);
        MediumFit::with_gamma(&samples, Errors::Known, &grid).unwrap()
    };
    for (alpha, gamma) in [(0.97, 1.4), (0.9, 1.65)] {
        let fit = fit(alpha, &of_gamma(gamma), 900);
        let pairs = [(fit.gamma().unwrap(), gamma), (fit.sigma_a(), 1.0 - alpha), (fit.sigma_s(), alpha)];
        for (found, truth) in pairs {
            let z = (found.value - truth) / found.error;
            assert!(z.abs() < 4.5, "{alpha} {gamma}: {found:?}, z = {z}");
        }
    }
    let (_, other) = &others()[1];
    let found = fit(0.95, other, 902).gamma().unwrap();
    assert!((found.value - other.gamma()).abs() < 0.06 + 4.5 * found.error, "{found:?} {}", other.gamma());
}
