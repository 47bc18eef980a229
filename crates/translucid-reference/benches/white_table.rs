//! Cost of one walk for all albedos, and how it scales over the cores.
//!
//! `cargo bench -p translucid-reference --bench white_table`.
//! The first table is the set of surface albedos 0.01, 0.02, … 0.99 from a single run, until every ring that holds at
//! least 1 % of its albedo's energy is known to 0.3 %. The second repeats a run on one and on two threads in turn.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use std::time::Instant;

use translucid_reference::Incidence;
use translucid_reference::exact::single_scattering_albedo;
use translucid_reference::walk::{Control, Forecast, Goal, Layout, Parameters, Problem, Side, WhiteTable};
use translucid_testing::cpu_seconds;

/// Rings from 0.05 to 20 mean free paths, each a third wider than the one before.
fn radii() -> Vec<f64> {
    (0..22).map(|i| 0.05 * (4.0f64 / 3.0).powi(i)).collect()
}

fn table(incidence: Incidence, reference_albedo: f64) -> WhiteTable {
    let problem = Problem::new(Parameters { incidence, ..Parameters::default() }).expect("valid parameters");
    let layout = Layout::new(&radii(), 1).expect("increasing radii");
    WhiteTable::new(problem, layout, reference_albedo).expect("an albedo below 1")
}

fn main() {
    for (name, incidence) in [("searchlight", Incidence::NORMAL), ("diffuse", Incidence::Cosine)] {
        set_of_albedos(name, incidence);
    }
    scaling();
}

fn set_of_albedos(name: &str, incidence: Incidence) {
    let albedos: Vec<f64> = (1..100)
        .map(|i| single_scattering_albedo(f64::from(i) / 100.0, 1.0, incidence).expect("an albedo in (0, 1)"))
        .collect();
    let mut table = table(incidence, albedos[98]);
    let worst = |table: &WhiteTable| {
        let mut worst = 0.0f64;
        for &albedo in &albedos {
            let at = table.at_albedo(albedo).expect("at most the reference albedo");
            let total = at.total(Side::Reflected).value;
            let rings = (0..table.layout().rings()).map(|ring| at.ring(Side::Reflected, ring));
            let known = rings.filter(|ring| ring.value >= 0.01 * total).map(|ring| ring.relative_error());
            worst = known.fold(worst, f64::max);
        }
        worst
    };
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let goal = Goal { relative_error: 3e-3, photons: u64::MAX >> 1 };
    let mut report = |_: &WhiteTable, _: &Forecast| ();
    table.run_until(1, goal, &Control::default(), &worst, &mut report).expect("photons enough");
    println!(
        "99 albedos, {name}: {:.2e} photons, {:.0} collisions each, worst ring {:.2} %, {:.1} s, {:.1} s of CPU",
        table.photons() as f64,
        table.mean_collisions(),
        100.0 * worst(&table),
        start.elapsed().as_secs_f64(),
        cpu_seconds() - cpu,
    );
}

fn scaling() {
    for _ in 0..4 {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let mut table = table(Incidence::NORMAL, 0.99);
            let (start, cpu) = (Instant::now(), cpu_seconds());
            pool.install(|| table.run(1, 30_000_000, &Control::default())).expect("photons enough");
            (start.elapsed().as_secs_f64(), cpu_seconds() - cpu)
        });
        println!(
            "3e7 photons at 0.99: 1 thread {:.2} s ({:.2} s of CPU), 2 threads {:.2} s ({:.2} s of CPU), {:.2} times as fast",
            one.0,
            one.1,
            two.0,
            two.1,
            one.0 / two.0
        );
    }
}
