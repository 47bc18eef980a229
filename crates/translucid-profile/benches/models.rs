//! Time per call of every model, by itself and as a table, beside normalized diffusion.
//!
//! `cargo bench -p translucid-profile --bench models` prints Markdown.
//! All tasks take turns of a third of a millisecond, round after round, and every figure is the lower decile over the
//! rounds: what else the machine does meanwhile falls on all alike, and little of it is left.
//! Calls follow one another without depending on each other, behind a `dyn Profile` as a renderer that swaps models
//! has them; normalized diffusion and tables also as their own types, which is how an inner loop would have them.
//! A model is one [`Row`] of [`rows`].

#![allow(clippy::print_stdout, reason = "the tables are what this program is for")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use translucid_profile::{
    Appearance, BetterDipole, Configuration, DirectionalDipoleAverage, ExactProfile, NormalizedDiffusion,
    Parameterization, PhotonBeamDiffusion, Profile, QuantizedDiffusion, RefinedDiffusion,
    RefinedDiffusionF32, StandardDipole, SumOfGaussians, TabulatedProfile,
};
use translucid_testing::golden_uniforms;

/// Arguments a task goes through.
const COUNT: usize = 1024;
/// Time one task gets in one round, or one call where that takes longer.
const TURN: Duration = Duration::from_micros(300);
const ROUNDS: usize = 200;

/// The talk's boundary and phase function, at a middling albedo.
const APPEARANCE: Appearance =
    Appearance { surface_albedo: 0.8, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };

/// A model: its name, and how it is made for an η.
struct Row {
    name: &'static str,
    make: fn(f64) -> Box<dyn Profile>,
    /// Whether η and g are parameters.
    knows_boundary: bool,
}

/// The row that the ratios refer to.
const YARDSTICK: &str = "normalized diffusion";

fn rows() -> Vec<Row> {
    let physical = |name, make| Row { name, make, knows_boundary: true };
    vec![
        Row { name: YARDSTICK, make: |_| Box::new(normalized_diffusion()), knows_boundary: false },
        Row { name: "normalized diffusion, refined", make: |_| Box::new(refined()), knows_boundary: false },
        Row { name: "two Gaussians", make: |_| Box::new(gaussians(2)), knows_boundary: false },
        Row { name: "six Gaussians", make: |_| Box::new(gaussians(6)), knows_boundary: false },
        Row { name: "exact, from its table", make: |_| Box::new(exact()), knows_boundary: false },
        physical("standard dipole", |eta| Box::new(StandardDipole::new(&appearance(), eta).expect(VALID))),
        physical("better dipole", |eta| Box::new(BetterDipole::new(&appearance(), eta).expect(VALID))),
        physical("directional dipole, averaged", |eta| {
            Box::new(DirectionalDipoleAverage::new(&appearance(), eta).expect(VALID))
        }),
        physical("quantized diffusion", |eta| {
            Box::new(QuantizedDiffusion::new(&appearance(), eta).expect(VALID))
        }),
        physical("photon beam diffusion", |eta| {
            Box::new(PhotonBeamDiffusion::new(&appearance(), eta).expect(VALID))
        }),
    ]
}

const VALID: &str = "valid parameters";

fn appearance() -> Appearance {
    black_box(APPEARANCE)
}

fn normalized_diffusion() -> NormalizedDiffusion {
    let Appearance { surface_albedo, length, parameterization, .. } = appearance();
    NormalizedDiffusion::new(surface_albedo, length, parameterization, Configuration::Searchlight)
        .expect(VALID)
}

fn refined() -> RefinedDiffusion {
    let Appearance { surface_albedo, length, parameterization, .. } = appearance();
    RefinedDiffusion::new(surface_albedo, length, parameterization, Configuration::Searchlight).expect(VALID)
}

fn refined_twin() -> RefinedDiffusionF32 {
    let Appearance { surface_albedo, length, .. } = appearance();
    RefinedDiffusionF32::new(surface_albedo as f32, length as f32, Configuration::Searchlight)
}

fn gaussians(terms: usize) -> SumOfGaussians {
    let Appearance { surface_albedo, length, parameterization, .. } = appearance();
    SumOfGaussians::new(surface_albedo, length, parameterization, Configuration::Searchlight, terms)
        .expect(VALID)
}

fn exact() -> ExactProfile {
    let Appearance { surface_albedo, length, parameterization, .. } = appearance();
    ExactProfile::new(surface_albedo, length, parameterization, Configuration::Searchlight).expect(VALID)
}

/// Something that is timed: a row, a column, and a call for the i-th argument.
struct Task {
    row: String,
    column: &'static str,
    call: Box<dyn Fn(usize) -> f64>,
    /// Calls in one turn.
    calls: usize,
    /// Nanoseconds per call in each round.
    rounds: Vec<f64>,
}

fn main() {
    // Under `cargo test --benches` only see that everything runs
    let in_earnest = std::env::args().any(|argument| argument == "--bench");

    let mut tasks: Vec<Task> = rows().iter().flat_map(tasks_of).collect();
    tasks.extend(tasks_of_types());
    if in_earnest {
        tasks.iter_mut().for_each(|task| task.calls = calls_in_a_turn(&*task.call));
    }
    for _ in 0..if in_earnest { ROUNDS } else { 1 } {
        for task in &mut tasks {
            task.rounds.push(nanoseconds(&*task.call, task.calls) / task.calls as f64);
        }
    }
    print_tables(&tasks);
}

fn task(row: impl Into<String>, column: &'static str, call: impl Fn(usize) -> f64 + 'static) -> Task {
    Task { row: row.into(), column, call: Box::new(call), calls: 1, rounds: Vec::new() }
}

/// Tasks of a model.
fn tasks_of(row: &Row) -> Vec<Task> {
    let Row { name, make, knows_boundary } = *row;
    let uniforms = golden_uniforms(COUNT);
    let table = TabulatedProfile::new(&*make(1.0));
    let radii: Vec<f64> = uniforms.iter().map(|u| table.sample(*u)).collect();

    let mut tasks = vec![task(name, "build", move |_| make(black_box(1.0)).surface_albedo())];
    if knows_boundary {
        tasks.push(task(name, "build, η = 1.4", move |_| make(black_box(1.4)).surface_albedo()));
    }
    let (source, at) = (make(1.0), radii.clone());
    tasks.push(task(name, "eval", move |i| source.eval(at[i])));
    let (source, at) = (make(1.0), radii.clone());
    tasks.push(task(name, "enclosed", move |i| source.enclosed(at[i])));
    let (source, at) = (make(1.0), uniforms.clone());
    tasks.push(task(name, "sample", move |i| source.sample(at[i])));

    let source = make(1.0);
    tasks.push(task(name, "tabulate", move |_| TabulatedProfile::new(&*source).surface_albedo()));
    let (source, at): (Box<dyn Profile>, _) = (Box::new(table.clone()), radii.clone());
    tasks.push(task(name, "table eval", move |i| source.eval(at[i])));
    let (source, at): (Box<dyn Profile>, _) = (Box::new(table.clone()), radii);
    tasks.push(task(name, "table enclosed", move |i| source.enclosed(at[i])));
    tasks.push(task(name, "table sample", move |i| table.sample(uniforms[i])));
    tasks
}

/// Tasks of types of their own, behind no `dyn`.
fn tasks_of_types() -> Vec<Task> {
    let p = normalized_diffusion();
    let radii: Vec<f64> = golden_uniforms(COUNT).into_iter().map(|u| p.quantile(u)).collect();
    let row = "normalized diffusion, its own type";
    let own = |f: fn(NormalizedDiffusion, f64) -> f64, at: Vec<f64>| move |i: usize| f(p, at[i]);
    let (refined, twin) = (refined(), refined_twin());
    let [refined_row, twin_row] = ["normalized diffusion, refined, its own type", "its twin in f32"];
    let own_refined = |f: fn(RefinedDiffusion, f64) -> f64, at: Vec<f64>| move |i: usize| f(refined, at[i]);
    let of_twin = |f: fn(RefinedDiffusionF32, f32) -> f32, at: Vec<f64>| {
        let at: Vec<f32> = at.into_iter().map(|x| x as f32).collect();
        move |i: usize| f64::from(f(twin, at[i]))
    };
    let table = TabulatedProfile::new(&p);
    let table_row = "a table, its own type";
    let (a, b, c) = (table.clone(), table.clone(), table);
    let (at, at_too, uniform) = (radii.clone(), radii.clone(), golden_uniforms(COUNT));
    vec![
        task(row, "build", |_| normalized_diffusion().d()),
        task(row, "eval", own(|p, r| p.eval(r), radii.clone())),
        task(row, "enclosed", own(|p, r| p.enclosed(r), radii.clone())),
        task(row, "sample", own(|p, u| p.sample(u), golden_uniforms(COUNT))),
        task(refined_row, "eval", own_refined(|p, r| p.eval(r), radii.clone())),
        task(refined_row, "enclosed", own_refined(|p, r| p.enclosed(r), radii.clone())),
        task(refined_row, "sample", own_refined(|p, u| p.sample(u), golden_uniforms(COUNT))),
        task(twin_row, "eval", of_twin(|p, r| p.eval(r), radii.clone())),
        task(twin_row, "enclosed", of_twin(|p, r| p.cdf(r), radii)),
        task(twin_row, "sample", of_twin(|p, u| p.sample(u), golden_uniforms(COUNT))),
        task("an empty call", "eval", |i| i as f64),
        task(table_row, "eval", move |i| a.eval(at[i])),
        task(table_row, "enclosed", move |i| b.enclosed(at_too[i])),
        task(table_row, "sample", move |i| c.sample(uniform[i])),
    ]
}

/// Nanoseconds for some calls, whose arguments repeat after [`COUNT`].
fn nanoseconds(call: &dyn Fn(usize) -> f64, calls: usize) -> f64 {
    let start = Instant::now();
    for i in 0..calls {
        black_box(call(black_box(i % COUNT)));
    }
    start.elapsed().as_nanos() as f64
}

/// Number of calls that fill a turn.
fn calls_in_a_turn(call: &dyn Fn(usize) -> f64) -> usize {
    let turn = TURN.as_nanos() as f64;
    let mut calls = 1;
    loop {
        let time = nanoseconds(call, calls);
        if time > 0.25 * turn {
            return ((calls as f64 * turn / time) as usize).max(1);
        }
        calls *= 4;
    }
}

fn lower_decile(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 10]
}

/// One table for the models by themselves, one for their tables.
fn print_tables(tasks: &[Task]) {
    let mut rows: Vec<&str> = Vec::new();
    for task in tasks {
        if !rows.contains(&task.row.as_str()) {
            rows.push(&task.row);
        }
    }
    println!(
        "Nanoseconds per call at A = 0.8, ℓ = 1, g = 0, η = 1, and how many times normalized diffusion's:\n"
    );
    let by_itself = ["build", "build, η = 1.4", "eval", "enclosed", "sample"];
    print_table(tasks, &rows, &by_itself, &by_itself);
    println!("\nThe same through a table, against normalized diffusion by itself:\n");
    let tabulated = ["tabulate", "table eval", "table enclosed", "table sample"];
    print_table(tasks, &rows, &tabulated, &["build", "eval", "enclosed", "sample"]);
    println!(
        "\nEvery figure includes an empty call. `sample` is exact for normalized diffusion, Gaussians and tables, and \
         else a search."
    );
}

/// Rows that have any of the columns; each ratio is to the column of normalized diffusion that is named beside it.
fn print_table(tasks: &[Task], rows: &[&str], columns: &[&str], against: &[&str]) {
    let time = |row: &str, column: &str| {
        tasks.iter().find(|t| t.row == row && t.column == column).map(|t| lower_decile(&t.rounds))
    };
    println!("| model | {} |", columns.join(" | "));
    println!("|---|{}", "---|".repeat(columns.len()));
    for row in rows.iter().filter(|row| columns.iter().any(|c| time(row, c).is_some())) {
        let cell = |(column, base): (&&str, &&str)| match (time(row, column), time(YARDSTICK, base)) {
            (Some(ns), Some(base)) => format!("{} ({:.2}×)", digits(ns), ns / base),
            (Some(ns), None) => digits(ns),
            _ => "–".to_owned(),
        };
        let cells: Vec<String> = columns.iter().zip(against).map(cell).collect();
        println!("| {row} | {} |", cells.join(" | "));
    }
}

/// Three digits or the whole part.
fn digits(ns: f64) -> String {
    if ns < 10.0 { format!("{ns:.2}") } else { format!("{ns:.0}") }
}
