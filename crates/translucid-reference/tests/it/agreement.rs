//! The walk and the exact solution, which share no line of code, agree ring by ring; and both with others.
//!
//! A ring's photons at the reference albedo are counts of a multinomial distribution, so Pearson's χ² against the
//! exact energies follows its distribution but for its own approximation. Seeds are fixed; a test of a right program
//! fails with the probability that it states.

use translucid_profile::Configuration;
use translucid_reference::exact::HalfSpace;
use translucid_reference::walk::{
    Control, Layout, Parameters, PhaseFunction, Problem, Region, Side, WhiteTable,
};
use translucid_reference::{Incidence, specular_reflectance};
use translucid_testing::{bound, is_thorough, power};

use crate::solutions::half_space;
use crate::statistics::{chi_square_exceedance, is_coverage_of_95_percent, runs_of_coverage};

const RADII: [f64; 14] = [0.01, 0.03, 0.1, 0.2, 0.35, 0.6, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 14.0];

fn walk(parameters: Parameters, albedo: f64, radii: &[f64], seed: u64, photons: u64) -> WhiteTable {
    let layout = Layout::new(radii, 1).unwrap();
    let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, albedo).unwrap();
    table.run(seed, photons, &Control::default()).unwrap();
    table
}

/// χ² probability of the rings of a walk against a solution, rings with less than 20 photons expected taken into
/// the rest, absorbed photons included.
fn agreement(table: &WhiteTable, solution: &HalfSpace) -> f64 {
    let photons = table.photons() as f64;
    let mut cells: Vec<(f64, f64)> = Vec::new();
    let mut inside = 0.0;
    for (ring, &radius) in table.layout().radii().iter().enumerate() {
        let enclosed = solution.enclosed(radius).value;
        let count = table.exits(Side::Reflected, Region::Ring(ring)) as f64;
        cells.push((count, photons * (enclosed - inside)));
        inside = enclosed;
    }
    cells.retain(|&(_, expected)| expected >= 20.0);
    let (counted, expected) = cells.iter().fold((0.0, 0.0), |sum, cell| (sum.0 + cell.0, sum.1 + cell.1));
    let freedom = cells.len();
    cells.push((photons - counted, photons - expected));
    let chi_square = cells.iter().map(|(count, expected)| (count - expected).powi(2) / expected).sum();
    chi_square_exceedance(chi_square, freedom)
}

/// All of four indices, two directions of light and two albedos, with tilted beams beside, when tests run with their
/// whole power; else a choice in which each of them has its turn. False alarm: 0.001 for each of 18 tables, 1.8 % for
/// any.
#[test]
fn rings_of_the_walk_are_those_of_the_exact_solution() {
    let tilted = Incidence::Pencil { cos_theta: 60f64.to_radians().cos() };
    let mut cases = Vec::new();
    if is_thorough() {
        for eta in [1.0, 1.33, 1.4, 1.5] {
            for incidence in [Incidence::NORMAL, Incidence::Cosine] {
                cases.extend([0.5, 0.95].map(|albedo| (eta, incidence, albedo)));
            }
        }
        cases.push((1.0, tilted, 0.9));
    } else {
        cases.extend([0.5, 0.95].map(|albedo| (1.0, Incidence::NORMAL, albedo)));
        cases.push((1.0, Incidence::Cosine, 0.95));
        cases.extend([(1.33, Incidence::NORMAL, 0.95), (1.4, Incidence::Cosine, 0.5)]);
        cases.push((1.5, Incidence::NORMAL, 0.9));
    }
    cases.push((1.4, tilted, 0.9));
    for (eta, incidence, albedo) in cases {
        let parameters = Parameters { eta, incidence, ..Parameters::default() };
        let table = walk(parameters, albedo, &RADII, 11, power(2_000_000));
        let p = agreement(&table, &half_space(albedo, eta, incidence));
        assert!(p > 0.001, "eta {eta}, {incidence:?}, albedo {albedo}: p = {p}");
    }
}

/// The χ² above has teeth: it tells an albedo from another that is 0.3 % off.
#[test]
fn rings_of_another_albedo_do_not_agree() {
    let table = walk(Parameters::default(), 0.9, &RADII, 11, power(2_000_000));
    let p = agreement(&table, &HalfSpace::new(0.9 - bound(0.003), Incidence::NORMAL).unwrap());
    assert!(p < 1e-6, "{p}");
}

/// One walk at 0.9999 serves every albedo below. Totals over 15 albedos: |z| < 4, false alarm 0.2 % in all; energies
/// within 14 radii: |z| < 5, 2e-4 in all. They share their photons, so there is no χ² over them; the next test has
/// tables of their own.
#[test]
fn one_walk_serves_every_albedo() {
    let albedos = [0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 0.999, 0.9999];
    for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
        let parameters = Parameters { incidence: configuration.into(), ..Parameters::default() };
        let table = walk(parameters.clone(), 0.9999, &RADII, 13, power(1_000_000));
        for albedo in albedos {
            let at = table.at_albedo(albedo).unwrap();
            let exact = HalfSpace::new(albedo, parameters.incidence).unwrap();
            for (index, &radius) in RADII.iter().enumerate() {
                let (found, expected) = (at.enclosed(Side::Reflected, index), exact.enclosed(radius).value);
                // With few photons the error itself is uncertain
                if at.effective_photons(Side::Reflected, Region::Within(index)) > 100.0 {
                    let z = (found.value - expected) / found.error;
                    assert!(z.abs() < 5.0, "{configuration:?} {albedo} r {radius}: {found:?} {expected}");
                }
            }
            let (found, expected) = (at.total(Side::Reflected), exact.total().value);
            let z = (found.value - expected) / found.error;
            assert!(z.abs() < 4.0, "{configuration:?} {albedo}: {found:?} {expected}, z = {z}");
        }
    }
}

/// A walk of its own for each of 15 albedos: χ² of the 15 totals, 0.001 < p < 0.999 for both entries, false alarm
/// 0.4 %; |z| < 4 each, 0.2 %.
#[test]
fn totals_of_many_walks_scatter_as_they_say() {
    let albedos = [0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 0.995, 0.999];
    for incidence in [Incidence::NORMAL, Incidence::Cosine] {
        let mut chi_square = 0.0;
        for (seed, albedo) in albedos.into_iter().enumerate() {
            let parameters = Parameters { incidence, ..Parameters::default() };
            // Little light comes back at low albedos, and photons end soon
            let photons = if albedo < 0.2 { 300_000 } else { power(300_000) };
            let table = walk(parameters, albedo, &[1.0], seed as u64, photons);
            let found = table.at_albedo(albedo).unwrap().total(Side::Reflected);
            let z = (found.value - HalfSpace::new(albedo, incidence).unwrap().total().value) / found.error;
            assert!(z.abs() < 4.0, "{incidence:?} {albedo}: z = {z}");
            chi_square += z * z;
        }
        let p = chi_square_exceedance(chi_square, 15);
        assert!(p > 0.001 && p < 0.999, "{incidence:?}: p = {p}");
    }
}

/// Coverage: of many walks the 95 % intervals of totals and rings hold the exact value; seven figures, false alarm
/// 0.2 %.
#[test]
fn standard_errors_are_honest() {
    let rings = [0.1, 0.5, 1.0, 3.0, 8.0];
    let exact = HalfSpace::new(0.8, Incidence::NORMAL).unwrap();
    let mut covered = [0; 7];
    for seed in 0..runs_of_coverage() {
        let table = walk(Parameters::default(), 0.9, &rings, 1000 + seed, 20_000);
        let at = table.at_albedo(0.8).unwrap();
        let mut inside = 0.0;
        for (ring, &radius) in rings.iter().enumerate() {
            let enclosed = exact.enclosed(radius).value;
            let found = at.ring(Side::Reflected, ring);
            covered[ring] += u64::from((found.value - (enclosed - inside)).abs() < 1.96 * found.error);
            inside = enclosed;
        }
        let found = at.enclosed(Side::Reflected, 3);
        covered[5] += u64::from((found.value - exact.enclosed(3.0).value).abs() < 1.96 * found.error);
        let found = at.total(Side::Reflected);
        covered[6] += u64::from((found.value - exact.total().value).abs() < 1.96 * found.error);
    }
    assert!(covered.into_iter().all(is_coverage_of_95_percent), "{covered:?}");
}

/// R. G. Giovanelli 1955, *Reflection by semi-infinite diffusers*: 0.2600 for α = 0.9, n = 1.5, light at the normal,
/// what the surface reflects included. To ten digits 0.2599185699, of which the exact solution must have all.
#[test]
fn giovanellis_case() {
    let specular = specular_reflectance(Incidence::NORMAL, 1.5);
    let with_surface = |total: f64| specular + (1.0 - specular) * total;
    let exact = half_space(0.9, 1.5, Incidence::NORMAL).total();
    assert!((with_surface(exact.value) - 0.2599185699).abs() < 6e-11, "{exact:?}");
    let table = walk(Parameters { eta: 1.5, ..Parameters::default() }, 0.9, &[1.0], 14, power(4_000_000));
    let found = table.at_albedo(0.9).unwrap().total(Side::Reflected);
    let z = (with_surface(found.value) - 0.2599185699) / found.error;
    // False alarm 6e-5
    assert!(z.abs() < 4.0, "{found:?}: z = {z}");
}

/// H. C. van de Hulst 1980, *Multiple Light Scattering*, table 35: g = 0.75, optical depth 2, α = 0.9, n = 1:
/// R = 0.09739, T = 0.66096, light that was not scattered included. The table rounds in the last digit.
/// False alarm 1e-4.
#[test]
fn van_de_hulsts_slab() {
    let slab = Parameters {
        phase_function: PhaseFunction::HenyeyGreenstein { g: 0.75 },
        thickness: 2.0,
        ..Parameters::default()
    };
    let table = walk(slab, 0.9, &[1.0], 15, power(4_000_000));
    let at = table.at_albedo(0.9).unwrap();
    for (side, expected) in [(Side::Reflected, 0.09739), (Side::Transmitted, 0.66096)] {
        let found = at.total(side);
        let off = (found.value - expected).abs();
        assert!(off < 4.0 * found.error + 5e-6, "{side:?}: {found:?} {expected}");
    }
}

/// Adding–doubling (S. A. Prahl, M. J. C. van Gemert and A. J. Welch 1993), computed with iadpython 0.5.3, `rt()` of
/// `Sample(a, b, g, n = 1, quad_pts = 16)`: reflectance and transmittance for normal (UR1, UT1) and for diffuse
/// light (URU, UTU). Its own error at 16 points is 1.5e-5 at g = 0.8; at g = 0.9 the change from 8 to 16 points,
/// 1.3e-4, bounds it. False alarm 36 × 6e-5.
#[test]
fn totals_agree_with_adding_doubling() {
    let infinite = f64::INFINITY;
    for (g, albedo, thickness, [ur1, ut1, uru, utu], own_error) in [
        (0.5, 0.9, infinite, [0.2777824054, 0.0, 0.3601516431, 0.0], 1.5e-5),
        (0.8, 0.9, infinite, [0.1362203699, 0.0, 0.2167229957, 0.0], 1.5e-5),
        (0.75, 0.9, 2.0, [0.0973997229, 0.6609569339, 0.1910900528, 0.5018161343], 1.5e-5),
        (0.5, 0.99, 2.0, [0.3052743827, 0.6603002337, 0.4302634502, 0.5309325010], 1.5e-5),
        (0.8, 0.99, infinite, [0.5219183027, 0.0, 0.6026476999, 0.0], 1.5e-5),
        (0.9, 0.99, infinite, [0.3995645059, 0.0, 0.4934144275, 0.0], 1.3e-4),
        (-0.5, 0.9, infinite, [0.5026724650, 0.0, 0.5468555942, 0.0], 1.5e-5),
        (0.5, 0.5, 1.0, [0.0382419911, 0.5200689166, 0.0742848499, 0.3611871852], 1.5e-5),
        (0.8, 0.5, infinite, [0.0147881040, 0.0, 0.0356650548, 0.0], 1.5e-5),
    ] {
        for (incidence, reflected, transmitted) in
            [(Incidence::NORMAL, ur1, ut1), (Incidence::Cosine, uru, utu)]
        {
            let phase_function = PhaseFunction::HenyeyGreenstein { g };
            let parameters = Parameters { phase_function, thickness, incidence, ..Parameters::default() };
            let table = walk(parameters, albedo, &[1.0], 16, power(2_000_000));
            let at = table.at_albedo(albedo).unwrap();
            for (side, expected) in [(Side::Reflected, reflected), (Side::Transmitted, transmitted)] {
                let found = at.total(side);
                let off = (found.value - expected).abs();
                assert!(
                    off <= 4.0 * found.error + own_error,
                    "g {g}, albedo {albedo}, {thickness} thick, {incidence:?}, {side:?}: {found:?} {expected}"
                );
            }
        }
    }
}
