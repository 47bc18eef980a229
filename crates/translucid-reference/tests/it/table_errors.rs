//! Standard errors of tables are honest: intervals of ±1.96 of them hold the exact value in 95 % of cases.
//!
//! Runs of different seeds against exact solutions. With 200 runs, the number of intervals that hold is binomial with
//! p = 0.95 if the errors are right; fewer than 175 or all 200 happen with a probability of 4.4e-5. The sum of squares
//! of z = (found − exact)/error follows χ², and is outside its interval with a probability of 7e-5; the mean of z times
//! √200 is normal, and beyond ±4.5 with 7e-6. 93 figures are tested: a false alarm has a probability of 1.1 %, once,
//! for seeds are fixed. With an eighth of the power 25 runs are judged in the same way, and fewer than 18 of 25 happen
//! with a probability of 2e-5.

use std::f64::consts::LN_2;

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_profile::{Configuration, half_space_single_scattering_albedo, half_space_surface_albedo};
use translucid_reference::exact::HalfSpace;
use translucid_reference::walk::{Control, Layout, Parameters, Problem, Region, Side, WhiteTable};
use translucid_reference::{Estimate, Incidence};

use crate::statistics::{chi_square_deviate, runs_of_coverage};

const REFERENCE: f64 = 0.99;

/// Runs a problem many times and judges figures by their exact values.
#[allow(clippy::print_stdout, reason = "--nocapture shows how well the errors hold")]
fn judge(
    incidence: Incidence,
    radii: &[f64],
    photons: u64,
    figures: &[(String, f64)],
    find: impl Fn(&WhiteTable) -> Vec<Estimate>,
) {
    let runs = runs_of_coverage();
    let problem = Problem::new(Parameters { incidence, ..Parameters::default() }).unwrap();
    let mut hits = vec![0; figures.len()];
    let mut squares = vec![0.0; figures.len()];
    let mut sums = vec![0.0; figures.len()];
    for repeat in 0..runs {
        let mut table = WhiteTable::new(problem.clone(), Layout::new(radii, 1).unwrap(), REFERENCE).unwrap();
        table.run(1000 + repeat, photons, &Control::default()).unwrap();
        let found = find(&table);
        assert_eq!(found.len(), figures.len());
        for (index, (found, (_, exact))) in found.iter().zip(figures).enumerate() {
            let z = (found.value - exact) / found.error;
            hits[index] += i32::from(z.abs() <= 1.96);
            squares[index] += z * z;
            sums[index] += z;
        }
    }
    for (index, (name, exact)) in figures.iter().enumerate() {
        let (hits, squares) = (hits[index], squares[index]);
        let mean = sums[index] / (runs as f64).sqrt();
        println!("{name} = {exact:.6}: {hits} of {runs} intervals, chi square {squares:.1}, mean {mean:.2}");
        let few = if runs == 200 { hits < 175 || hits == 200 } else { hits < 18 };
        assert!(!few, "{name}: {hits} of {runs} intervals hold {exact}");
        let deviate = chi_square_deviate(squares, runs as usize);
        assert!(deviate.abs() < 3.98, "{name}: chi square {squares} of {runs}");
        assert!(mean.abs() < 4.5, "{name}: off by {mean} standard errors of the mean");
    }
}

/// Surface albedo, its derivative, and the single-scattering albedo that belongs to it.
#[test]
fn totals_of_the_half_space_are_within_their_errors() {
    let alphas = [0.1, 0.5, 0.9, 0.97, REFERENCE];
    let surface_albedos = [0.05, 0.3, 0.7];
    for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
        let total = |alpha| half_space_surface_albedo(alpha, configuration);
        // Central differences, good to 1e-7
        let slope = |alpha: f64| {
            let step = 1e-3 * (1.0 - alpha);
            (total(alpha + step) - total(alpha - step)) / (2.0 * step)
        };
        let mut figures: Vec<_> =
            alphas.iter().map(|&a| (format!("{configuration:?} R({a})"), total(a))).collect();
        figures.extend(alphas.iter().map(|&a| (format!("{configuration:?} dR/dα({a})"), slope(a))));
        figures.extend(surface_albedos.iter().map(|&a| {
            (format!("{configuration:?} α({a})"), half_space_single_scattering_albedo(a, configuration))
        }));
        judge(configuration.into(), &[1.0], 20_000, &figures, |table| {
            let at = |alpha| table.at_albedo(alpha).unwrap();
            let totals = alphas.iter().map(|&a| at(a).total(Side::Reflected));
            let slopes = alphas.iter().map(|&a| at(a).derivative(Side::Reflected, Region::Everywhere));
            let inverse = surface_albedos.iter().map(|&a| table.single_scattering_albedo(a).unwrap());
            totals.chain(slopes).chain(inverse).collect()
        });
    }
}

/// Rings, discs and what is beyond them, of all orders, against the exact half space.
#[test]
fn rings_of_the_half_space_are_within_their_errors() {
    let radii = [0.05, 0.3, 1.0, 3.0];
    for incidence in [Incidence::NORMAL, Incidence::Cosine] {
        // Far out at low albedos there are too few photons for intervals of 95 %.
        let regions = |alpha: f64| {
            let rings = (0..if alpha < 0.8 { 4 } else { 5 }).map(Region::Ring);
            rings.chain([Region::Within(1), Region::Within(3), Region::Beyond(1)])
        };
        let alphas = [0.5, 0.9, 0.98];
        let mut figures = Vec::new();
        for alpha in alphas {
            let exact = HalfSpace::new(alpha, incidence).unwrap();
            let energy = |region| match region {
                Region::Ring(0) => exact.enclosed(radii[0]).value,
                Region::Ring(4) => exact.beyond(radii[3]).value,
                Region::Ring(ring) => {
                    exact.enclosed(radii[ring]).value - exact.enclosed(radii[ring - 1]).value
                }
                Region::Within(edge) => exact.enclosed(radii[edge]).value,
                Region::Beyond(edge) => exact.beyond(radii[edge]).value,
                _ => unreachable!("{region:?}"),
            };
            figures.extend(
                regions(alpha).map(|region| (format!("{incidence:?} {alpha} {region:?}"), energy(region))),
            );
        }
        judge(incidence, &radii, 20_000, &figures, |table| {
            let energy = |alpha| {
                let at = table.at_albedo(alpha).unwrap();
                regions(alpha).map(move |region| at.energy(Side::Reflected, region))
            };
            alphas.into_iter().flat_map(energy).collect()
        });
    }
}

/// Light that is scattered once and leaves within r (physics.md §3), for isotropic scattering without a boundary.
///
/// ```text
/// enclosed₁(r) = ½ ∫₀¹ μ/(1+μ) [1 − exp(−r √((1+μ)/(1−μ)))] dμ
/// ```
fn single_scattering_within(r: f64) -> f64 {
    // μ = 1 − w²: the root in the exponent is smooth in w, but for its pole
    let rule = gauss_legendre(200);
    0.5 * integrate(&rule, 0.0, 1.0, |w| {
        let mu = 1.0 - w * w;
        let path = r * ((1.0 + mu) / (w * w)).sqrt();
        mu / (1.0 + mu) * -(-path).exp_m1() * 2.0 * w
    })
}

#[test]
fn single_scattering_rings_are_within_their_errors() {
    let radii = [0.03, 0.2, 0.5, 1.0];
    assert!((single_scattering_within(1e9) - (1.0 - LN_2) / 2.0).abs() < 1e-12);
    let mut figures = Vec::new();
    let mut inner = 0.0;
    for (ring, &r) in radii.iter().enumerate() {
        let within = single_scattering_within(r);
        figures.push((format!("P₁ of ring {ring}"), within - inner));
        figures.push((format!("P₁ within {r}"), within));
        inner = within;
    }
    judge(Incidence::NORMAL, &radii, 20_000, &figures, |table| {
        let order = |region| table.order_probability(Side::Reflected, region, 1);
        (0..radii.len()).flat_map(|i| [order(Region::Ring(i)), order(Region::Within(i))]).collect()
    });
}

/// Orders of scattering of entry uniform in the cosine: Pₙ = 2(qₙ − qₙ₊₁), qₙ = C(2n,n)/4ⁿ; and their sum.
#[test]
fn orders_of_scattering_are_within_their_errors() {
    let alphas = [0.2f64, 0.8, 0.98];
    let total = |alpha: f64| 1.0 - 2.0 / alpha * ((1.0 - alpha).sqrt() - (1.0 - alpha));
    let mut figures: Vec<_> = alphas.iter().map(|&a| (format!("uniform R({a})"), total(a))).collect();
    let mut q = 1.0;
    for n in 0..=10u32 {
        let next = q * f64::from(2 * n + 1) / f64::from(2 * n + 2);
        if n > 0 {
            figures.push((format!("P_{n}"), 2.0 * (q - next)));
        }
        q = next;
    }
    judge(Incidence::UniformCosine, &[1.0], 20_000, &figures, |table| {
        let totals = alphas.iter().map(|&a| table.at_albedo(a).unwrap().total(Side::Reflected));
        let order = |n| table.order_probability(Side::Reflected, Region::Everywhere, n);
        totals.chain((1..=10).map(order)).collect()
    });
}
