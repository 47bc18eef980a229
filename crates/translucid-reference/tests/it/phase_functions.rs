//! Phase functions other than Henyey and Greenstein's: the walk against the solution by moments, which share only the
//! phase function, and a table of Henyey and Greenstein's against themselves.

use std::sync::Arc;

use translucid_reference::Incidence;
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_reference::walk::{
    Control, Layout, Parameters, PhaseFunction, PhaseTable, Problem, Side, WhiteTable,
};
use translucid_testing::power;

const ALBEDO: f64 = 0.95;

fn henyey_greenstein_in_a_table(g: f64) -> PhaseFunction {
    let exact = PhaseFunction::HenyeyGreenstein { g };
    let row = |tenth: i32| {
        let angle = f64::from(tenth) / 10.0;
        [angle, exact.eval(angle.to_radians().cos())]
    };
    let rows: Vec<[f64; 2]> = (0..=1800).map(row).collect();
    PhaseFunction::Table(Arc::new(PhaseTable::from_degrees(&rows).unwrap()))
}

/// A forward peak, a flank and a glory.
fn mie_like() -> PhaseFunction {
    let row = |i: i32| {
        let x = f64::from(i) / 500.0 - 1.0;
        [x, (8.0 * (x - 1.0)).exp() + 0.01 + 0.05 * (-30.0 * (x + 1.0)).exp()]
    };
    PhaseFunction::Table(Arc::new(PhaseTable::new((0..=1000).map(row).collect()).unwrap()))
}

fn walked(phase_function: &PhaseFunction, eta: f64, radii: &[f64], seed: u64) -> WhiteTable {
    let phase_function = phase_function.clone();
    let parameters =
        Parameters { phase_function, eta, incidence: Incidence::NORMAL, ..Parameters::default() };
    let layout = Layout::around(radii).unwrap();
    let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, ALBEDO).unwrap();
    table.run(seed, power(40_000_000), &Control::default()).unwrap();
    table
}

fn solved(phase_function: &PhaseFunction, eta: f64) -> Layers {
    let layer = Layer::new(ALBEDO, 1.0 - ALBEDO, f64::INFINITY).with_eta(eta);
    Layers::new(1.0, vec![layer.with_phase_function(phase_function.clone())], Ground::None).unwrap()
}

/// Totals and R at four radii of six walks, |z| < 4.5 each: false alarm 2e-4 in all. Two of the walks know the phase function
/// of the solution by another description.
#[test]
fn walk_agrees_with_the_solution_by_moments() {
    let hg = |g| PhaseFunction::HenyeyGreenstein { g };
    let two_term = PhaseFunction::TwoTerm { weight: 0.9, g1: 0.8, g2: -0.4 };
    let moments = |count: usize| PhaseFunction::Moments((1..=count).map(|l| two_term.moment(l)).collect());
    let rayleigh = PhaseFunction::Moments([0.0, 0.1].into());
    for (seed, (walk, solution, eta)) in [
        (henyey_greenstein_in_a_table(0.8), hg(0.8), 1.0),
        (two_term.clone(), moments(120), 1.0),
        (moments(120), two_term.clone(), 1.4),
        (rayleigh.clone(), PhaseFunction::Rayleigh, 1.0),
        (PhaseFunction::Rayleigh, rayleigh, 1.4),
        (mie_like(), mie_like(), 1.0),
    ]
    .into_iter()
    .enumerate()
    {
        let transport = 1.0 / (1.0 - ALBEDO * solution.mean_cosine());
        let radii = [0.2, 0.6, 1.5, 4.0].map(|r| r * transport);
        let at = walked(&walk, eta, &radii, 700 + seed as u64);
        let at = at.at_albedo(ALBEDO).unwrap();
        let layers = solved(&solution, eta);
        let entering = 1.0 - translucid_reference::specular_reflectance(Incidence::NORMAL, eta);
        let judge = |what: &str, found: f64, error: f64, expected: f64, doubt: f64| {
            let z = (found - expected) / error.hypot(doubt);
            assert!(z.abs() < 4.5, "{walk:?} {what}: {found} {expected}, z = {z}");
        };
        let (total, totals) = (at.total(Side::Reflected), layers.totals(Incidence::NORMAL).unwrap());
        judge("total", total.value, total.error, totals.diffuse_reflectance / entering, totals.error);
        let profile = layers.profile_within(5e-3, &Control::default()).unwrap().unwrap();
        for r in radii {
            let found = at.at_radius(Side::Reflected, r).unwrap().reflectance;
            let expected = profile.reflectance(r);
            judge(
                &format!("r {r:.3}"),
                found.value,
                found.error,
                expected.value / entering,
                expected.error / entering,
            );
        }
    }
}

/// At equal g, light near the source is brighter where γ is smaller: by a quarter at a tenth of a transport mean free path, z
/// of the difference above 5.
#[test]
fn gamma_orders_light_near_the_source() {
    let small = PhaseFunction::TwoTerm { weight: 0.9, g1: 0.8, g2: 0.0 };
    let great = PhaseFunction::HenyeyGreenstein { g: small.mean_cosine() };
    assert!(great.gamma() > small.gamma() + 0.2);
    let r = 0.1 / (1.0 - ALBEDO * small.mean_cosine());
    let [small, great] = [&small, &great].map(|phase_function| {
        let table = walked(phase_function, 1.0, &[r], 31);
        table.at_albedo(ALBEDO).unwrap().at_radius(Side::Reflected, r).unwrap().reflectance
    });
    let z = (small.value - great.value) / small.error.hypot(great.error);
    assert!(z > 5.0, "{small:?} {great:?}");
}
