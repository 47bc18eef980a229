//! CPU time of the walk's kernel per collision and per photon.
use std::time::Instant;

use translucid_reference::Entry;
use translucid_reference::walk::{Parameters, PhaseFunction, Problem, count_collisions_and_exits};

/// CPU time of this thread in seconds.
fn cpu_time(start: Instant) -> f64 {
    std::thread::yield_now(); // brings the account up to date
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = stat.and_then(|line| line.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

fn main() {
    let start = Instant::now();
    let filter: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let hg = |g| PhaseFunction::HenyeyGreenstein { g };
    let matched = Parameters::default();
    let milk = Parameters { eta: 1.4, phase_function: hg(0.8), ..matched };
    for (name, parameters) in [
        ("g=0 eta=1", matched),
        ("g=0 eta=1 cosine", Parameters { entry: Entry::Cosine, ..matched }),
        ("g=0 eta=1.4", Parameters { eta: 1.4, ..matched }),
        ("g=0.8 eta=1", Parameters { phase_function: hg(0.8), ..matched }),
        ("g=0.8 eta=1.4", milk),
        ("Rayleigh eta=1", Parameters { phase_function: PhaseFunction::Rayleigh, ..matched }),
        ("g=0.8 eta=1.4 slab 2", Parameters { thickness: 2.0, ..milk }),
    ] {
        if !filter.is_empty() && !filter.iter().any(|f| name == f) {
            continue;
        }
        let problem = Problem::new(parameters).unwrap();
        for albedo in [0.5, 0.9, 0.999] {
            let photons = (4e6 * (1.0f64 - albedo).powf(0.7)) as u64;
            let mut best = f64::INFINITY;
            let mut collisions = 0;
            for repeat in 0..7 {
                let before = cpu_time(start);
                collisions = count_collisions_and_exits(&problem, albedo, repeat..repeat + photons).0;
                best = best.min(cpu_time(start) - before);
            }
            let mean = collisions as f64 / photons as f64;
            println!(
                "{name:24} {albedo:<7} {mean:9.2} collisions, {:7.2} ns/collision {:9.1} ns/photon",
                1e9 * best / collisions as f64,
                1e9 * best / photons as f64
            );
        }
    }
}
