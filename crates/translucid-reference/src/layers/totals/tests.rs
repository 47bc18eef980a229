//! What judges the totals: closed solutions, other programs, published figures, laws.

use std::sync::atomic::{AtomicBool, Ordering};

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_testing::is_thorough;

use super::*;
use crate::exact::HalfSpace;
use crate::specular_reflectance;
use crate::walk::{Control, Layout, Parameters, PhaseFunction, Problem, Side, WhiteTable};

const OBLIQUE: Incidence = Incidence::Pencil { cos_theta: 0.4 };
const INCIDENCES: [Incidence; 3] = [Incidence::NORMAL, OBLIQUE, Incidence::Cosine];

fn solve(eta: f64, layers: Vec<Layer>, ground: Ground, incidence: Incidence) -> Totals {
    Layers::new(eta, layers, ground).expect("valid").totals(incidence).expect("valid")
}

#[test]
fn half_space_has_the_exact_totals() {
    for (alpha, eta, incidence) in [
        (0.5, 1.0, Incidence::NORMAL),
        (0.9, 1.0, Incidence::Cosine),
        (0.999, 1.0, OBLIQUE),
        (0.9, 1.4, Incidence::NORMAL),
        (0.99, 1.4, Incidence::Cosine),
        (0.7, 1.5, OBLIQUE),
        (0.9, 0.8, Incidence::NORMAL),
    ] {
        let layer = Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_eta(eta);
        let totals = solve(1.0, vec![layer.clone()], Ground::None, incidence);
        let exact = HalfSpace::with_boundary(alpha, eta, incidence).unwrap().total();
        let specular = specular_reflectance(incidence, eta);
        let expected = (1.0 - specular) * exact.value;
        let off = (totals.diffuse_reflectance - expected).abs();
        assert!(off < totals.error + exact.error && totals.error < 1e-6, "{alpha} {eta}: {totals:?} {off:e}");
        assert!((totals.specular_reflectance - specular).abs() < totals.error);
        // A thick layer is nearly infinite
        let thick = solve(1.0, vec![Layer { thickness: 1e4, ..layer }], Ground::BLACK, incidence);
        assert!((thick.diffuse_reflectance - totals.diffuse_reflectance).abs() < 1e-9, "{thick:?}");
    }
}

/// Total reflectance and transmittance of the normal beam and of diffuse light: a, b, g, η of the slab, η of glass slides
/// on both sides, and figures of S. Prahl's iadpython 0.5.3, with 16 points where no face reflects and with 32 elsewhere:
/// its best ones, known to some 2e-5 and 2e-4. `benches/peers/adding_doubling.py` prints them.
const ADDING_DOUBLING: [([f64; 5], [f64; 4]); 8] = [
    ([0.9, 1.0, 0.0, 1.0, 1.0], [0.267410340, 0.591625139, 0.352712128, 0.474745703]),
    ([0.9, 1.0, 0.8, 1.0, 1.0], [0.042365485, 0.845378621, 0.116619416, 0.710550436]),
    ([0.5, 2.0, 0.0, 1.0, 1.0], [0.112833209, 0.189321240, 0.145085402, 0.107054977]),
    ([0.99, 5.0, 0.5, 1.0, 1.0], [0.518694195, 0.382600562, 0.609236811, 0.299055727]),
    ([0.9, 1.0, 0.0, 1.4, 1.0], [0.223132895, 0.527009131, 0.281780857, 0.457993801]),
    ([0.95, 2.0, 0.0, 1.5, 1.0], [0.332578478, 0.361922530, 0.382062441, 0.318202534]),
    ([0.9, 4.0, 0.6, 1.4, 1.0], [0.157689246, 0.215752922, 0.211270094, 0.177264745]),
    ([0.9, 2.0, 0.0, 1.33, 1.5], [0.288560319, 0.305659504, 0.343200729, 0.255604292]),
];

#[test]
fn slabs_are_those_of_another_adding_doubling() {
    for ([a, b, g, eta, slide], expected) in ADDING_DOUBLING {
        let slab = Layer::new(a, 1.0 - a, b).with_g(g).with_eta(eta);
        let glass = Layer::new(0.0, 0.0, 1.0).with_eta(slide);
        let layers = if slide == 1.0 { vec![slab] } else { vec![glass.clone(), slab, glass] };
        for (incidence, expected) in [Incidence::NORMAL, Incidence::Cosine].iter().zip(expected.chunks(2)) {
            let totals = solve(1.0, layers.clone(), Ground::AIR, *incidence);
            let found = [
                totals.specular_reflectance + totals.diffuse_reflectance,
                totals.collimated_transmittance + totals.diffuse_transmittance,
            ];
            for (found, expected) in found.iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 6e-4,
                    "{a} {b} {g} {eta} {incidence:?}: {found} {expected}"
                );
            }
        }
    }
}

/// R. G. Giovanelli 1955, *Reflection by semi-infinite diffusers*: 0.2600 for the index 1.5, specular light included.
#[test]
fn published_reflectance_of_a_half_space() {
    let layer = Layer::new(0.9, 0.1, f64::INFINITY).with_eta(1.5);
    let totals = solve(1.0, vec![layer], Ground::None, Incidence::NORMAL);
    assert!((totals.specular_reflectance + totals.diffuse_reflectance - 0.2599185699).abs() < 1e-7);
}

/// The crate's walk in a slab; its errors are standard errors, and 5 of them are exceeded once in 10⁶.
#[test]
fn slab_is_that_of_the_walk() {
    for (g, eta, thickness, incidence) in
        [(0.8, 1.4, 3.0, Incidence::NORMAL), (0.5, 1.0, 1.0, OBLIQUE), (-0.4, 1.3, 2.0, Incidence::Cosine)]
    {
        let phase_function = PhaseFunction::HenyeyGreenstein { g };
        let problem =
            Problem::new(Parameters { phase_function, eta, thickness, incidence, ..Parameters::default() })
                .unwrap();
        let mut table = WhiteTable::new(problem, Layout::new(&[1.0], 1).unwrap(), 0.99).unwrap();
        table.run(5, if is_thorough() { 8_000_000 } else { 400_000 }, &Control::default()).unwrap();
        let walk = table.at_albedo(0.95).unwrap();
        let slab = Layer::new(0.95, 0.05, thickness).with_g(g).with_eta(eta);
        let totals = solve(1.0, vec![slab], Ground::AIR, incidence);
        // The walk counts what has entered, and what passed straight through as transmitted
        let specular = specular_reflectance(incidence, eta);
        let leaving = [
            totals.specular_reflectance + totals.diffuse_reflectance - specular,
            totals.collimated_transmittance + totals.diffuse_transmittance,
        ];
        for (found, side) in leaving.into_iter().zip([Side::Reflected, Side::Transmitted]) {
            let (found, expected) = (found / (1.0 - specular), walk.total(side));
            let off = (found - expected.value).abs();
            assert!(off < 5.0 * expected.error, "{g} {eta} {side:?}: {found} {expected:?}");
        }
    }
}

#[test]
fn equal_layers_are_one() {
    for incidence in INCIDENCES {
        let part = |thickness: f64| Layer::new(2.0, 0.3, thickness).with_g(0.6).with_eta(1.4);
        let ground = Ground::Lambertian { reflectance: 0.4 };
        let one = solve(1.0, vec![part(1.0)], ground, incidence);
        let many = solve(1.0, vec![part(0.1), part(0.3), part(0.6)], ground, incidence);
        assert!((one.diffuse_reflectance - many.diffuse_reflectance).abs() < 1e-11);
        assert!((one.absorbed_by_ground - many.absorbed_by_ground).abs() < 1e-11);
        assert!((one.absorbed[0] - many.absorbed.iter().sum::<f64>()).abs() < 1e-11);
    }
}

fn stack() -> Vec<Layer> {
    vec![
        Layer::new(3.0, 0.2, 0.1).with_g(0.7).with_eta(1.5),
        Layer::new(0.0, 0.1, 0.5).with_eta(1.3),
        Layer::new(5.0, 0.01, 0.4).with_g(-0.3).with_eta(1.4),
        Layer::new(1.0, 1.0, 0.2).with_eta(1.4),
    ]
}

/// Light and detector change places: η² times the transmittance of diffuse light is the same both ways.
#[test]
fn light_and_detector_change_places() {
    let all = |totals: &Totals| totals.collimated_transmittance + totals.diffuse_transmittance;
    let down = solve(1.0, stack(), Ground::Medium { eta: 1.2 }, Incidence::Cosine);
    let up = solve(1.2, stack().into_iter().rev().collect(), Ground::AIR, Incidence::Cosine);
    let off = (all(&down) - 1.44 * all(&up)).abs();
    assert!(off < 1e-7, "{down:?} {up:?} {off:e}");
}

/// Whatever is not absorbed leaves: between mirrors, under total reflection, in clear, thin and thick layers.
#[test]
fn energy_is_kept() {
    let white = |layer: Layer| Layer { absorption: 0.0, ..layer };
    let stacks = [
        stack(),
        stack().into_iter().map(white).collect(),
        vec![Layer::new(1.0, 0.0, 1e9).with_g(0.9)],
        vec![Layer::new(1e-9, 0.0, 1e-3), Layer::new(0.0, 0.0, 1.0).with_eta(3.0), Layer::new(0.0, 0.0, 1.0)],
        vec![Layer::new(0.0, 0.0, 1.0).with_eta(0.5), Layer::new(2.0, 0.0, 1.0).with_eta(1.01)],
        (0..100)
            .map(|i| {
                Layer::new(f64::from(i % 7), 0.0, 0.1).with_g(0.5).with_eta(1.0 + 0.1 * f64::from(i % 3))
            })
            .collect(),
    ];
    for stack in stacks {
        for ground in [Ground::AIR, Ground::Medium { eta: 1.6 }, Ground::Lambertian { reflectance: 1.0 }] {
            for incidence in INCIDENCES {
                let totals = solve(1.0, stack.clone(), ground, incidence);
                let off = (totals.sum() - 1.0).abs();
                assert!(off < 1e-9, "{} {ground:?} {incidence:?}: {totals:?} {off:e}", stack.len());
                assert!(totals.parts().all(|part| part >= 0.0), "{totals:?}");
            }
        }
    }
}

/// Beer's law between faces: all reflections to and fro of one ray.
#[test]
fn clear_layers_are_a_pile_of_plates() {
    let layers = vec![Layer::new(0.0, 0.0, 3.0).with_eta(1.5)];
    let totals = solve(1.0, layers, Ground::AIR, Incidence::NORMAL);
    assert!((totals.specular_reflectance - 2.0 * 0.04 / 1.04).abs() < 1e-12, "{totals:?}");
    let layers = vec![Layer::new(0.0, 0.7, 2.0)];
    let totals = solve(1.0, layers, Ground::Lambertian { reflectance: 0.5 }, OBLIQUE);
    let arriving = (-1.4f64 / 0.4).exp();
    assert!((totals.absorbed_by_ground - 0.5 * arriving).abs() < 1e-9, "{totals:?}");
    // 2 E₃(1.4)
    let back = integrate(&gauss_legendre(100), 0.0, 1.0, |mu| 2.0 * mu * (-1.4 / mu).exp());
    assert!((totals.diffuse_reflectance - 0.5 * arriving * back).abs() < totals.error, "{totals:?}");
}

#[test]
fn moments_are_a_phase_function() {
    let named = Layer::new(4.0, 0.1, 1.0).with_g(0.7);
    let moments = named.clone().with_moments((1..200).map(|l| 0.7f64.powi(l)).collect());
    let [named, moments] =
        [named, moments].map(|layer| solve(1.0, vec![layer], Ground::AIR, Incidence::NORMAL));
    assert!((named.diffuse_reflectance - moments.diffuse_reflectance).abs() < 1e-13);
}

#[test]
fn error_covers_finer_rules() {
    for stack in [stack(), vec![Layer::new(8.0, 0.4, 1.0).with_g(0.9).with_eta(1.4)]] {
        let layers = Layers::new(1.0, stack, Ground::Lambertian { reflectance: 0.7 }).unwrap();
        for incidence in INCIDENCES {
            let totals = layers.totals(incidence).unwrap();
            let finer = layers
                .totals_by(&Rays::new(&layers, 72, layers.beam(incidence).unwrap()), &mut || true)
                .unwrap();
            let off = totals.difference(&finer);
            assert!(off < totals.error && totals.error < 1e-6, "{totals:?} {off:e}");
        }
    }
    // Hard ones: hardly any deflection, and indices that hardly differ
    for [g, eta] in [[0.98, 1.4], [0.0, 1.001], [0.9, 1.01]] {
        let layer = Layer::new(8.0, 0.1, 1.0).with_g(g).with_eta(eta);
        let layers = Layers::new(1.0, vec![layer], Ground::AIR).unwrap();
        for incidence in INCIDENCES {
            let totals = layers.totals(incidence).unwrap();
            let finer = layers
                .totals_by(&Rays::new(&layers, 100, layers.beam(incidence).unwrap()), &mut || true)
                .unwrap();
            let off = totals.difference(&finer);
            assert!(off < totals.error && totals.error < 1e-5, "{g} {eta}: {totals:?} {off:e}");
        }
    }
}

#[test]
fn incidence_without_meaning_is_refused() {
    let layers = Layers::new(1.0, stack(), Ground::AIR).unwrap();
    for cos_theta in [0.0, -1.0, 1.1, f64::NAN] {
        assert!(layers.totals(Incidence::Pencil { cos_theta }).is_err());
    }
    assert!(layers.totals(Incidence::UniformCosine).is_err());
}

/// Light and layers for which the rules have no rays or numbers are refused, and no zeros are given in their place.
#[test]
fn what_the_rules_cannot_hold_is_refused() {
    let of = |layer: Layer, incidence| Layers::new(1.0, vec![layer], Ground::AIR).unwrap().totals(incidence);
    let error = of(Layer::new(1.0, 0.1, 1.0), Incidence::Pencil { cos_theta: 1e-7 }).unwrap_err();
    assert!(error.to_string().contains("cos_theta is 1e-7, but must be in [1e-4, 1]"), "{error}");
    let error = of(Layer::new(1e17, 0.0, 1.0), Incidence::NORMAL).unwrap_err();
    assert!(error.to_string().contains("optical thickness"), "{error}");
    for (scattering, absorption) in [(1e30, 1e30), (1e30, 1e-30), (20.0, 1e30), (1e-30, 0.0)] {
        let layers =
            Layers::new(1.0, vec![Layer::new(scattering, absorption, f64::INFINITY)], Ground::None).unwrap();
        for incidence in [Incidence::NORMAL, Incidence::Pencil { cos_theta: 1e-4 }, Incidence::Cosine] {
            let totals = layers.totals(incidence).unwrap();
            assert!((totals.sum() - 1.0).abs() <= totals.error, "{scattering} {absorption}: {totals:?}");
            assert!(totals.error < 1e-4, "{scattering} {absorption}: {totals:?}");
        }
    }
}

#[test]
fn totals_are_as_close_as_asked_for_and_can_be_stopped() {
    let layers: Vec<Layer> =
        (0..12).map(|i| Layer::new(3.0, 0.1, 0.2).with_g(0.7).with_eta(1.0 + 0.1 * f64::from(i))).collect();
    let layers = Layers::new(1.0, layers, Ground::AIR).unwrap();
    let [stop, most] = [AtomicBool::new(false), AtomicBool::new(false)];
    let progress = |part: u64| most.store(part >= 1000, Ordering::Relaxed);
    let control = Control { stop: &stop, progress: &progress, ..Control::default() };
    let fine = layers.totals_within(1e-12, Incidence::Cosine, &control).unwrap().unwrap();
    assert!(most.load(Ordering::Relaxed));
    let coarse = layers.totals_within(1e-2, Incidence::Cosine, &control).unwrap().unwrap();
    assert!(!most.load(Ordering::Relaxed), "the finest rule is left out");
    let off = (coarse.diffuse_reflectance - fine.diffuse_reflectance).abs();
    assert!(fine.error < coarse.error && coarse.error < 1e-2 && off < coarse.error, "{coarse:?} {fine:?}");
    stop.store(true, Ordering::Relaxed);
    assert_eq!(layers.totals_within(1e-2, Incidence::Cosine, &control).unwrap(), None);
    let error = layers.totals_within(f64::NAN, Incidence::Cosine, &control).unwrap_err().to_string();
    assert!(error.starts_with("tolerance is NaN"), "{error}");
}
