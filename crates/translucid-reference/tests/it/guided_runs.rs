//! Runs of the guided walk: reproducible, and refused where the guide does not serve.

use translucid_reference::walk::{GuidedWalk, Parameters, PhaseFunction, Problem};
use translucid_reference::{Estimate, Incidence};

const RADII: [f64; 4] = [0.1, 0.7, 3.0, 8.0];

/// Bits of all figures.
fn bits(walk: &GuidedWalk) -> Vec<[u64; 2]> {
    let rings = (0..=RADII.len()).flat_map(|i| [walk.ring(i), walk.reflectance(i), walk.enclosed(i)]);
    rings.chain([walk.total()]).map(|figure| [figure.value.to_bits(), figure.error.to_bits()]).collect()
}

#[test]
fn guided_runs_do_not_depend_on_threads() {
    let problem = Problem::new(Parameters::default()).unwrap();
    for alpha in [0.1, 0.6, 0.999] {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| GuidedWalk::run(&problem, alpha, &RADII, 5, 100).unwrap())
        };
        let one = run(1);
        assert_eq!(one.photons(), 100 * GuidedWalk::CHUNK);
        for threads in [2, 5] {
            let other = run(threads);
            assert_eq!(bits(&other), bits(&one), "α = {alpha}, {threads} threads");
            assert_eq!(other.mean_collisions(), one.mean_collisions());
        }
    }
}

#[test]
fn guided_walk_refuses_what_it_is_not_made_for() {
    let refused = |parameters: Parameters| {
        let problem = Problem::new(parameters).unwrap();
        GuidedWalk::run(&problem, 0.5, &[1.0], 1, 1).unwrap_err()
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
        assert_eq!(
            GuidedWalk::run(&problem, alpha, &[], 1, 1).unwrap_err().parameter,
            "single_scattering_albedo"
        );
    }
    for radii in [[1.0, 1.0], [2.0, 1.0], [0.0, 1.0], [1.0, f64::INFINITY], [f64::NAN, 1.0]] {
        assert_eq!(GuidedWalk::run(&problem, 0.5, &radii, 1, 1).unwrap_err().parameter, "radius");
    }
}

#[test]
fn guided_figures_are_numbers_at_the_ends() {
    for incidence in [Incidence::NORMAL, Incidence::Cosine, Incidence::UniformCosine] {
        let problem = Problem::new(Parameters { incidence, ..Parameters::default() }).unwrap();
        for alpha in [1e-300, 1e-10, 0.1379, 0.1381, 0.91, 1.0 - 1e-6] {
            for radii in [&[][..], &[1e-15], &[1e-15, 1e-3, 1.0], &[10.0]] {
                let none = GuidedWalk::run(&problem, alpha, radii, 1, 0).unwrap();
                assert_eq!(none.total().error, f64::INFINITY);
                let walk = GuidedWalk::run(&problem, alpha, radii, 1, 2).unwrap();
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
