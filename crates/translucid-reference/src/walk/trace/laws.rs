//! Laws of the kernel: partitions, ends, extremes, instruction sets and totals.

use std::sync::atomic::Ordering;

use super::super::instruction_sets::narrower_levels;
use super::super::photon_exit::Side;
use super::super::problem::Parameters;
use super::*;
use crate::Incidence;
use crate::phase_function::PhaseFunction;

fn problems() -> Vec<Problem> {
    let hg = |g| PhaseFunction::HenyeyGreenstein { g };
    let parameters = Parameters::default();
    [
        parameters.clone(),
        Parameters { eta: 1.4, incidence: Incidence::Cosine, spot_radius: 0.5, ..parameters.clone() },
        Parameters { eta: 0.8, phase_function: hg(-0.5), ..parameters.clone() },
        Parameters { thickness: 0.3, phase_function: hg(0.9), eta: 1.5, ..parameters.clone() },
        Parameters { thickness: 1e-3, incidence: Incidence::UniformCosine, ..parameters.clone() },
        Parameters { phase_function: PhaseFunction::Rayleigh, thickness: 5.0, ..parameters.clone() },
        Parameters {
            phase_function: PhaseFunction::Moments([0.5, 0.2].into()),
            thickness: 5.0,
            ..parameters
        },
    ]
    .map(|parameters| Problem::new(parameters).unwrap())
    .to_vec()
}

/// Exits in an order that does not depend on the walk, and the counts.
fn exits(problem: &Problem, albedo: f64, seed: u64, ranges: &[Range<u64>]) -> (Vec<[u32; 5]>, PhotonCounts) {
    let mut found = Vec::new();
    let mut counts = PhotonCounts::default();
    for range in ranges {
        let part = trace(problem, albedo, seed, range.clone(), &mut |exits| {
            found.extend(exits.iter().map(|exit| {
                let side = u32::from(exit.side == Side::Transmitted);
                [exit.order, exit.x.to_bits(), exit.y.to_bits(), exit.cos_theta.to_bits(), side]
            }));
        });
        counts.launched += part.launched;
        counts.absorbed += part.absorbed;
        counts.collisions += part.collisions;
    }
    found.sort_unstable();
    (found, counts)
}

#[test]
#[allow(clippy::single_range_in_vec_init, reason = "one range is one of the partitions")]
fn exits_do_not_depend_on_the_partition() {
    for problem in problems() {
        let whole = exits(&problem, 0.95, 11, &[5..4005]);
        assert_eq!(whole.0.len() as u64 + whole.1.absorbed, 4000);
        let parts = exits(&problem, 0.95, 11, &[5..6, 3000..3001, 6..700, 3001..4005, 700..3000, 9..9]);
        assert_eq!(whole, parts);
        let other = exits(&problem, 0.95, 12, &[5..4005]);
        assert_ne!(whole, other);
    }
}

/// A walk that is stopped has launched the first photons of its range, few after the stop, and all of them have ended.
#[test]
fn stopped_walk_is_that_of_fewer_photons() {
    for problem in problems() {
        for albedo in [0.3, 0.9, 0.9999] {
            let stop = AtomicBool::new(false);
            let mut found = 0;
            let counts = trace_until(&stop, &problem, albedo, 11, 5..u64::MAX, &mut |exits| {
                found += exits.len();
                stop.store(found > 5000, Ordering::Relaxed);
            });
            let fewer = 5..5 + counts.launched;
            assert!((5000..200_000).contains(&counts.launched), "{counts:?}");
            let (exits, counts_of_fewer) = exits(&problem, albedo, 11, std::slice::from_ref(&fewer));
            assert_eq!((exits.len(), counts_of_fewer), (found, counts));
        }
    }
}

#[test]
fn every_photon_ends_as_exit_or_absorbed() {
    for problem in problems() {
        for albedo in [0.0, 0.3, 0.9, 0.999] {
            let range = u64::MAX - 3000..u64::MAX - 1000;
            let (found, counts) = exits(&problem, albedo, 3, std::slice::from_ref(&range));
            assert_eq!(counts.launched, 2000);
            assert_eq!(found.len() as u64 + counts.absorbed, 2000);
            let orders: u64 = found.iter().map(|exit| u64::from(exit[0])).sum();
            assert!(counts.collisions >= orders + counts.absorbed);
            if albedo == 0.0 {
                assert!(found.iter().all(|exit| exit[0] == 0));
                assert_eq!(counts.collisions, counts.absorbed);
            }
        }
    }
}

#[test]
fn nothing_comes_of_nothing() {
    for problem in problems() {
        assert_eq!(exits(&problem, 0.9, 1, &[]), (vec![], PhotonCounts::default()));
        let reversed = Range { start: 7, end: 3 };
        assert_eq!(exits(&problem, 0.9, 1, std::slice::from_ref(&reversed)).0, Vec::<[u32; 5]>::new());
    }
}

/// Without absorption everything leaves a slab.
#[test]
fn slab_without_absorption_keeps_nothing() {
    for problem in problems().into_iter().filter(|p| p.parameters().thickness.is_finite()) {
        let (found, counts) = exits(&problem, 1.0, 1, std::slice::from_ref(&(0..3000)));
        assert_eq!((found.len(), counts.absorbed), (3000, 0));
    }
}

/// The greatest and the least of everything: numbers come out, and an end comes.
#[test]
fn extreme_problems_end_in_numbers() {
    let near = 1.0 - f64::EPSILON / 2.0;
    let entries = [
        Incidence::Pencil { cos_theta: 1e-300 },
        Incidence::Pencil { cos_theta: 1.0 },
        Incidence::Cosine,
        Incidence::UniformCosine,
    ];
    for g in [-near, 0.0, near] {
        for eta in [0.1, near, 1.0, 10.0] {
            for thickness in [1e-300, 1e-3, 1e300, f64::INFINITY] {
                for (incidence, spot_radius) in entries.into_iter().zip([0.0, 1e30, 0.0, 1e-30]) {
                    let phase_function = PhaseFunction::HenyeyGreenstein { g };
                    let parameters = Parameters { phase_function, eta, thickness, incidence, spot_radius };
                    let Ok(problem) = Problem::new(parameters.clone()) else { continue };
                    for albedo in [f64::NAN, -1.0, 0.0, 0.9] {
                        let counts = trace(&problem, albedo, 1, 0..50, &mut |exits| {
                            for exit in exits {
                                assert!(exit.x.is_finite() && exit.y.is_finite(), "{parameters:?} {exit:?}");
                                let cosine = exit.cos_theta;
                                assert!(cosine > 0.0 && cosine <= 1.000001, "{parameters:?} {exit:?}");
                            }
                        });
                        assert_eq!(counts.launched, 50);
                    }
                }
            }
        }
    }
}

/// Every instruction set walks every photon to the same bits.
#[test]
fn instruction_sets_agree() {
    for problem in problems() {
        let run = |level: Level| {
            let mut exits = Vec::new();
            let never = AtomicBool::new(false);
            let counts = trace_at_level(level, &never, &problem, 0.9, 4, 0..20_000, &mut |batch| {
                exits.extend_from_slice(batch);
            });
            exits.sort_by_key(|exit| (exit.order, exit.x.to_bits(), exit.y.to_bits()));
            (exits, counts)
        };
        let widest = run(Level::new());
        for level in narrower_levels() {
            assert_eq!(run(level), widest, "{level:?}");
        }
    }
}

/// R of the exact half space (physics.md §3): |z| < 4 each, false alarm 6e-5 each.
#[test]
fn totals_are_exact() {
    let half_space = Parameters::default();
    let cosine = Parameters { incidence: Incidence::Cosine, ..half_space.clone() };
    for (parameters, albedo, exact) in [
        (half_space.clone(), 0.5, 0.11522587770720),
        (half_space.clone(), 0.9, 0.41494747913082),
        (half_space.clone(), 0.99, 0.75272071716030),
        (cosine, 0.9, 0.47802448922824),
        (Parameters { eta: 1.4, ..half_space.clone() }, 0.9, 0.25775574627),
    ] {
        let photons = 200_000;
        let counts = trace(&Problem::new(parameters.clone()).unwrap(), albedo, 2, 0..photons, &mut |_| {});
        let found = 1.0 - counts.absorbed as f64 / photons as f64;
        let z = (found - exact) / (exact * (1.0 - exact) / photons as f64).sqrt();
        assert!(z.abs() < 4.0, "{parameters:?} {albedo}: {found} {exact}, z = {z}");
    }
}
