//! CPU time of the walks' kernels, per collision and per photon.
//!
//! `cargo bench -p translucid-reference --bench walk` runs all rows, `-- 'g=0.8'` those whose name contains the
//! word. Times are of this thread's CPU, the best of several runs, with nothing done with the exits.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use translucid_reference::Incidence;
use translucid_reference::layers::{Grid, Ground, Layer, Layers};
use translucid_reference::walk::{Control, Parameters, PhaseFunction, Problem, Walker};
use translucid_testing::thread_cpu_seconds;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let hg = |g| PhaseFunction::HenyeyGreenstein { g };
    let matched = Parameters::default();
    let cosine = Parameters { incidence: Incidence::Cosine, ..matched.clone() };
    let milk = Parameters { eta: 1.4, phase_function: hg(0.8), ..matched.clone() };
    let two_term = PhaseFunction::TwoTerm { weight: 0.9, g1: 0.8, g2: -0.3 };
    println!("{:32} {:>8} {:>12} {:>13} {:>10}", "", "albedo", "collisions", "ns/collision", "ns/photon");
    for (name, parameters, albedos) in [
        ("g=0 eta=1", matched.clone(), &[0.5, 0.9, 0.99, 0.999, 0.9999][..]),
        ("g=0 eta=1 cosine", cosine.clone(), &[0.5, 0.9]),
        ("g=0 eta=1.4", Parameters { eta: 1.4, ..matched.clone() }, &[0.5, 0.9, 0.999]),
        ("g=0 eta=1.4 cosine", Parameters { eta: 1.4, ..cosine.clone() }, &[0.5, 0.9]),
        ("g=0.8 eta=1", Parameters { phase_function: hg(0.8), ..matched.clone() }, &[0.9, 0.999]),
        ("g=0.8 eta=1.4", milk.clone(), &[0.5, 0.9, 0.999]),
        ("g=0.8 eta=1.4 slab 2", Parameters { thickness: 2.0, ..milk.clone() }, &[0.9, 0.999]),
        ("two-term eta=1", Parameters { phase_function: two_term, ..matched.clone() }, &[0.9, 0.999]),
        (
            "Rayleigh eta=1",
            Parameters { phase_function: PhaseFunction::Rayleigh, ..matched.clone() },
            &[0.9, 0.999],
        ),
    ] {
        for &albedo in albedos {
            for (walker, kind) in
                [(Walker::Kernel, "kernel"), (Walker::Avx2, "AVX2"), (Walker::Baseline, "baseline")]
            {
                let row = format!("{name} {kind}");
                if words.iter().all(|word| row.contains(word)) {
                    measure(&row, walker, &Problem::new(parameters.clone()).unwrap(), albedo);
                }
            }
        }
    }
    measure_layers(&words);
}

/// Prints the rows of the walk through layers: without and with a map of where light is absorbed.
fn measure_layers(words: &[String]) {
    let milk = |thickness| Layer::new(0.9, 0.1, thickness).with_g(0.8).with_eta(1.4);
    let plain = |absorption| Layer::new(1.0 - absorption, absorption, f64::INFINITY);
    let skin = vec![
        Layer::new(100.0, 1.0, 0.1).with_g(0.9).with_eta(1.37),
        Layer::new(10.0, 1.0, 0.1).with_eta(1.37),
        Layer::new(10.0, 2.0, 0.2).with_g(0.7).with_eta(1.37),
    ];
    let map = Grid { dz: 0.01, dr: 0.01, nz: 40, nr: 50, na: 30 };
    for (name, albedo, list, ground) in [
        ("g=0 eta=1", 0.9, vec![plain(0.1)], Ground::None),
        ("g=0 eta=1", 0.999, vec![plain(0.001)], Ground::None),
        ("g=0.8 eta=1.4", 0.9, vec![milk(f64::INFINITY)], Ground::None),
        ("g=0.8 eta=1.4 in two", 0.9, vec![milk(2.0), milk(f64::INFINITY)], Ground::None),
        ("MCML's example", 0.9, skin, Ground::AIR),
    ] {
        let layers = Layers::new(1.0, list, ground).unwrap();
        for (kind, grid) in [("layers", Grid::TOTALS), ("layers with a map", map)] {
            let row = format!("{name} {kind}");
            if words.iter().all(|word| row.contains(word)) {
                measure_layered(&row, &layers, albedo, grid);
            }
        }
    }
}

fn measure_layered(row: &str, layers: &Layers, albedo: f64, grid: Grid) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let timed = |photons: u64| {
        let before = thread_cpu_seconds();
        let tally = layers.walk(Incidence::NORMAL, grid, photons, 1, &Control::default()).unwrap();
        (thread_cpu_seconds() - before, tally.collisions())
    };
    pool.install(|| {
        let photons = (200_000.0 * 0.2 / timed(200_000).0) as u64;
        let runs = (0..7).map(|_| timed(photons));
        let best = runs.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 1));
        print_row(row, albedo, best, photons);
    });
}

/// Prints one row: the best of seven runs of some 50 ms.
fn measure(row: &str, walker: Walker, problem: &Problem, albedo: f64) {
    let timed = |photons: u64| {
        let before = thread_cpu_seconds();
        let (collisions, _) = walker.collisions_and_exits(problem, albedo, 0..photons)?;
        Some((thread_cpu_seconds() - before, collisions))
    };
    let Some((trial, _)) = timed(20_000) else { return };
    let photons = (20_000.0 * 0.05 / trial.max(1e-6)) as u64;
    let runs = (0..7).filter_map(|_| timed(photons));
    let (seconds, collisions) = runs.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 1));
    print_row(row, albedo, (seconds, collisions), photons);
}

fn print_row(row: &str, albedo: f64, (seconds, collisions): (f64, u64), photons: u64) {
    println!(
        "{row:32} {albedo:8} {:12.2} {:13.2} {:10.1}",
        collisions as f64 / photons as f64,
        1e9 * seconds / collisions as f64,
        1e9 * seconds / photons as f64
    );
}
