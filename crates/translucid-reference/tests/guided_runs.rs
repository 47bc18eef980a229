//! Runs of the guided walk: reproducible, mergeable, stoppable, and refused where the guide does not serve.

use std::sync::atomic::{AtomicBool, Ordering};

use translucid_reference::walk::{
    Control, GuidedWalk, Parameters, PhaseFunction, PhotonRange, Problem, TableError,
};
use translucid_reference::{Estimate, Incidence};

const RADII: [f64; 4] = [0.1, 0.7, 3.0, 8.0];

fn empty(alpha: f64) -> GuidedWalk {
    GuidedWalk::new(&Problem::new(Parameters::default()).unwrap(), alpha, &RADII).unwrap()
}

/// The bits of all figures.
fn bits(walk: &GuidedWalk) -> Vec<[u64; 2]> {
    let rings = (0..=RADII.len()).flat_map(|i| [walk.ring(i), walk.reflectance(i), walk.enclosed(i)]);
    rings.chain([walk.total()]).map(|figure| [figure.value.to_bits(), figure.error.to_bits()]).collect()
}

fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

#[test]
fn guided_runs_do_not_depend_on_threads_or_pieces() {
    for alpha in [0.1, 0.6, 0.999] {
        let mut once = empty(alpha);
        assert_eq!(
            once.run(5, 100 * GuidedWalk::CHUNK - 7, &Control::default()).unwrap(),
            100 * GuidedWalk::CHUNK
        );
        for threads in [1, 2, 5] {
            let mut pieces = empty(alpha);
            on_threads(threads, || {
                for chunks in [1, 0, 40, 17, 42] {
                    let done = pieces.run(5, chunks * GuidedWalk::CHUNK, &Control::default()).unwrap();
                    assert_eq!(done, chunks * GuidedWalk::CHUNK);
                }
            });
            assert_eq!(bits(&pieces), bits(&once), "α = {alpha}, {threads} threads");
            assert_eq!(pieces.mean_collisions(), once.mean_collisions());
        }
    }
}

#[test]
fn guided_walks_merge_exactly() {
    let run = |seed: u64, chunks: u64| {
        let mut walk = empty(0.8);
        walk.run(seed, chunks * GuidedWalk::CHUNK, &Control::default()).unwrap();
        walk
    };
    let parts = [run(1, 30), run(2, 20), run(9, 50)];
    let merged = |order: [usize; 3]| {
        let mut whole = empty(0.8);
        order.iter().for_each(|&i| whole.merge(&parts[i]).unwrap());
        whole
    };
    let whole = merged([0, 1, 2]);
    assert_eq!(bits(&merged([2, 0, 1])), bits(&whole));
    let mut one = run(1, 30);
    one.run(2, 20 * GuidedWalk::CHUNK, &Control::default()).unwrap();
    one.run(9, 50 * GuidedWalk::CHUNK, &Control::default()).unwrap();
    assert_eq!(bits(&one), bits(&whole));
    assert_eq!(one.photon_ranges()[1], PhotonRange { seed: 2, start: 0, end: 20 * GuidedWalk::CHUNK });

    // No photon twice, no other walk
    let before = bits(&one);
    assert!(matches!(one.merge(&parts[1]), Err(TableError::Repeated(_))));
    assert!(matches!(one.merge(&empty(0.81)), Err(TableError::Differs { .. })));
    let problem = *one.problem();
    let other = GuidedWalk::new(&problem, 0.8, &[1.0]).unwrap();
    assert!(matches!(one.merge(&other), Err(TableError::Differs { .. })));
    let cosine = Problem::new(Parameters { incidence: Incidence::Cosine, ..Parameters::default() }).unwrap();
    let other = GuidedWalk::new(&cosine, 0.8, &RADII).unwrap();
    assert!(matches!(one.merge(&other), Err(TableError::Differs { .. })));
    assert_eq!(bits(&one), before);
}

#[test]
fn stopped_guided_runs_go_on_where_they_were() {
    let photons = 200 * GuidedWalk::CHUNK;
    let mut whole = empty(0.95);
    whole.run(3, photons, &Control::default()).unwrap();
    let mut walk = empty(0.95);
    let mut rounds = 0;
    while walk.photons() < photons {
        let stop = AtomicBool::new(false);
        let progress = |done: u64| {
            if done >= 30_000 {
                stop.store(true, Ordering::Relaxed);
            }
        };
        let before = walk.photons();
        let control = Control { stop: &stop, progress: &progress, ..Control::default() };
        let done = walk.run(3, photons - before, &control).unwrap();
        assert_eq!(walk.photons() - before, done);
        rounds += 1;
    }
    assert!(rounds > 1);
    assert_eq!(bits(&walk), bits(&whole));
}

#[test]
fn guided_walk_refuses_what_it_is_not_made_for() {
    let refused = |parameters: Parameters| {
        let problem = Problem::new(parameters).unwrap();
        GuidedWalk::new(&problem, 0.5, &[1.0]).unwrap_err()
    };
    let matched = Parameters::default();
    let anisotropic = PhaseFunction::HenyeyGreenstein { g: 0.5 };
    for (parameters, name) in [
        (Parameters { phase_function: anisotropic, ..matched }, "g"),
        (Parameters { phase_function: PhaseFunction::Rayleigh, ..matched }, "g"),
        (Parameters { eta: 1.4, ..matched }, "eta"),
        (Parameters { thickness: 5.0, ..matched }, "thickness"),
        (Parameters { spot_radius: 0.1, ..matched }, "spot_radius"),
        (Parameters { incidence: Incidence::Pencil { cos_theta: 0.5 }, ..matched }, "cos_theta"),
    ] {
        let error = refused(parameters);
        assert_eq!(error.parameter, name);
        assert!(error.to_string().contains("use the white walk"), "{error}");
    }
    let problem = Problem::new(matched).unwrap();
    for alpha in [0.0, 1.0, -1.0, f64::NAN] {
        assert_eq!(GuidedWalk::new(&problem, alpha, &[]).unwrap_err().parameter, "single_scattering_albedo");
    }
    for radii in [[1.0, 1.0], [2.0, 1.0], [0.0, 1.0], [1.0, f64::INFINITY], [f64::NAN, 1.0]] {
        assert_eq!(GuidedWalk::new(&problem, 0.5, &radii).unwrap_err().parameter, "radius");
    }
    let mut walk = empty(0.5);
    for photons in [u64::MAX, (1 << 63) + 1] {
        assert!(matches!(walk.run(1, photons, &Control::default()), Err(TableError::TooMany)));
    }
    assert_eq!(walk.photons(), 0);
}

#[test]
fn guided_figures_are_numbers_at_the_ends() {
    for incidence in [Incidence::NORMAL, Incidence::Cosine, Incidence::UniformCosine] {
        let problem = Problem::new(Parameters { incidence, ..Parameters::default() }).unwrap();
        for alpha in [1e-300, 1e-10, 0.1379, 0.1381, 0.91, 1.0 - 1e-6] {
            for radii in [&[][..], &[1e-15], &[1e-15, 1e-3, 1.0], &[10.0]] {
                let mut walk = GuidedWalk::new(&problem, alpha, radii).unwrap();
                assert_eq!(walk.total().error, f64::INFINITY);
                walk.run(1, 2 * GuidedWalk::CHUNK, &Control::default()).unwrap();
                for ring in 0..radii.len() + 2 {
                    for figure in [walk.ring(ring), walk.reflectance(ring), walk.enclosed(ring)] {
                        assert!(
                            figure.value.is_finite() && figure.error.is_finite(),
                            "{alpha} {radii:?} {figure:?}"
                        );
                    }
                }
                assert_eq!(walk.ring(radii.len() + 1), Estimate::ZERO);
                assert_eq!(walk.enclosed(radii.len()), walk.total());
                assert!(walk.total().value > 0.0 && walk.total().value < 1.0);
            }
        }
    }
}
