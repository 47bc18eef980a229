//! The numbers of a comparison against what is known without it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use translucid_laboratory::comparison::{
    Comparison, Contender, ErrorTable, Inversion, Quantity, Reference, SampleTest, Sampling, ScalingCase,
    Settings, Stopped, Watch, talk_albedos,
};
use translucid_profile::{Configuration, Model, Parameterization};

const SEARCHLIGHT: Configuration = Configuration::Searchlight;
const DIFFUSE: Configuration = Configuration::Diffuse;

fn contenders(names: &[&str]) -> Vec<Contender> {
    Contender::all().into_iter().filter(|one| names.contains(&one.name)).collect()
}

/// The talk states "about" 5.5, 3.9 and 7.7 %; these are the exact solution's own figures for its polynomials.
#[test]
fn errors_of_the_talks_polynomials_are_known() {
    let names = ["normalized-diffusion", "normalized-diffusion-from-dmfp"];
    let table =
        ErrorTable::new(&contenders(&names), &[SEARCHLIGHT, DIFFUSE], &talk_albedos(), &[], Watch::default())
            .unwrap();
    let own = Inversion::Own;
    for (name, configuration, expected) in [
        (names[0], SEARCHLIGHT, [4.84, 5.47, 6.22]),
        (names[0], DIFFUSE, [3.86, 4.34, 4.84]),
        (names[1], SEARCHLIGHT, [6.02, 6.83, 7.63]),
    ] {
        let summary = table.summary(name, configuration, own).unwrap();
        assert_eq!(summary.reached, 99);
        for (errors, expected) in summary.errors.iter().zip(expected) {
            assert!((100.0 * errors.mean - expected).abs() < 0.005, "{name}: {errors:?} {expected}");
        }
    }
    assert_eq!(table.summary(names[1], DIFFUSE, own), None);
    assert_eq!(table.summary(names[0], SEARCHLIGHT, Inversion::Exact), None);
    assert_eq!(table.rows.len(), 3 * 99);
}

/// The same figures by another way: fits of s(A), judged by the table of the exact solution.
#[test]
fn scaling_cases_reach_what_the_talk_states() {
    for ((length, configuration, stated), (expected, range)) in
        ScalingCase::TALK.into_iter().zip([(5.47, 1), (3.86, 0), (7.63, 2)])
    {
        let case = ScalingCase::new(length, configuration, f64::INFINITY).unwrap();
        assert_eq!(
            (case.stated, case.reproduction()),
            (Some(stated), Some((range, true))),
            "{}",
            case.name()
        );
        let mean = 100.0 * case.talk_errors[range].mean;
        assert!((mean - expected).abs() < 0.01 && (mean - 100.0 * stated).abs() < 0.5, "{mean}");
        for i in 0..3 {
            assert!(case.least_errors[i].mean < case.talk_errors[i].mean);
        }
        assert!(case.fitted_errors[2].mean < case.talk_errors[2].mean);
    }
    let other = ScalingCase::new(Parameterization::Dmfp, DIFFUSE, 8.0).unwrap();
    assert_eq!((other.stated, other.reproduction()), (None, None));
}

/// 6 figures of 14 to 20 rings each. |z| < 4.3 for all has a false-alarm rate of 0.2 %, each χ² one of 1e-4.
#[test]
fn photons_bear_out_the_exact_solution() {
    let settings =
        Settings { contenders: Vec::new(), photons: 1_000_000, seed: 3, samples: 0, ..Settings::default() };
    let comparison = Comparison::new(settings, Watch::default()).unwrap();
    assert_eq!(comparison.reflectances.len(), 6);
    for figure in &comparison.reflectances {
        let (chi_square, rings, probability) = figure.chi_square();
        let a = figure.surface_albedo;
        assert!((14..=20).contains(&rings), "{a}: {rings}");
        assert!(figure.greatest_deviate() < 4.3, "{a}: {:?}", figure.points);
        assert!(probability > 1e-4 && probability < 1.0 - 1e-4, "{a}: {chi_square} of {rings}");
        // The middle of a ring stands for the ring
        for point in &figure.points {
            assert!(point.standard_error < 0.2 * point.exact && point.photons >= 50.0, "{point:?}");
        }
    }
}

/// Of 9 models, each with a false-alarm rate of 1e-4 on either side.
#[test]
fn samples_are_as_the_density_promises() {
    let reference = Reference::new(0.5, SEARCHLIGHT).unwrap();
    let sampling = Sampling { seed: 1, count: 100_000 };
    let mut models = 0;
    for contender in Contender::all().iter().filter(|one| one.is_model()) {
        let test = SampleTest::new(contender, &reference, sampling).unwrap();
        assert_eq!((test.count(), test.counts.len()), (100_000, SampleTest::BINS + 1));
        assert!((test.expected.iter().sum::<f64>() - 1e5).abs() < 1e-3);
        let p = test.probability;
        assert!(p > 1e-4 && p < 1.0 - 1e-4, "{}: {} {p}", test.contender, test.chi_square);
        models += 1;
    }
    assert_eq!(models, contenders(&Model::ALL.map(Model::name)).len());
}

fn small_settings() -> Settings {
    Settings {
        contenders: contenders(&["normalized-diffusion", "dipole", "gaussians-2", "exponentials-2"]),
        surface_albedos: vec![0.3, 1.0],
        averaged: vec![0.3, 0.4],
        photons: 20_000,
        samples: 1000,
        max_radius: 4.0,
        ..Settings::default()
    }
}

#[test]
fn comparison_does_not_depend_on_threads() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Comparison::new(small_settings(), Watch::default())).unwrap()
    };
    let [one, two] = [on(1), on(2)];
    assert_eq!(one.errors, two.errors);
    assert_eq!(one.reflectances, two.reflectances);
    assert_eq!(one.samples, two.samples);
    assert_eq!(one.claims, two.claims);
    assert_eq!(one.mixtures, two.mixtures);
    // Nothing walks at A = 1, and a Dmfp profile does not exist there
    assert!(one.reflectances.iter().all(|figure| figure.points.is_empty() == (figure.surface_albedo == 1.0)));
    assert!(one.reflectances.iter().all(|figure| figure.radii.len() == 200));
    for timing in &one.timings {
        assert!(timing.nanoseconds > 0.0 && timing.nanoseconds <= timing.median, "{timing:?}");
    }
    let timed = one.timings.iter().filter(|timing| timing.quantity == Quantity::Eval).count();
    assert_eq!(timed, 3);
    assert_eq!(one.claims.len(), 3);
}

#[test]
fn comparison_tells_how_far_it_is_and_stops_when_told() {
    let stop = AtomicBool::new(false);
    let last = AtomicU64::new(0);
    let progress = |done: f64| {
        assert!((0.0..=1.0).contains(&done));
        last.fetch_max(done.to_bits(), Ordering::Relaxed);
    };
    let watch = Watch { stop: &stop, progress: &progress };
    Comparison::new(small_settings(), watch).unwrap();
    let end = f64::from_bits(last.load(Ordering::Relaxed));
    assert!((0.9..=1.0).contains(&end), "{end}");

    // From the first report on
    let stopping = |_: f64| stop.store(true, Ordering::Relaxed);
    let stopped = Comparison::new(small_settings(), Watch { stop: &stop, progress: &stopping });
    assert_eq!(stopped.err(), Some(Stopped));
}
