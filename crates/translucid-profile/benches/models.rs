//! Time per call of every model, by itself and as a table, beside normalized diffusion.
//!
//! `cargo bench -p translucid-profile --bench models` prints Markdown.
//! All tasks take turns of a third of a millisecond, round after round, and every figure is the lower quartile over the
//! rounds: what else the machine does meanwhile falls on all alike, and little of it is left.
//! Calls follow one another without depending on each other, behind a `dyn Profile` as a renderer that swaps models
//! has them; normalized diffusion and tables also as their own types, which is how an inner loop would have them.

#![allow(clippy::print_stdout, reason = "the tables are what this program is for")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use translucid_profile::roots::falling_root;
use translucid_profile::{
    Appearance, Configuration, Model, NormalizedDiffusion, Parameterization, Profile, TabulatedProfile,
};

/// Arguments a task goes through.
const COUNT: usize = 1024;
/// Time one task gets in one round, or one call where that takes longer.
const TURN: Duration = Duration::from_micros(300);
const ROUNDS: usize = 200;
/// Share of the energy to which a model without a closed inverse is sampled.
const SAMPLE_TOLERANCE: f64 = 1e-6;

/// The talk's boundary and phase function, at a middling albedo.
const APPEARANCE: Appearance =
    Appearance { surface_albedo: 0.8, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };

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

    let mut tasks: Vec<Task> = Model::ALL.into_iter().flat_map(tasks_of).collect();
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

fn profile(model: Model, eta: f64) -> Box<dyn Profile> {
    model
        .profile(black_box(&APPEARANCE), Configuration::Searchlight, black_box(eta))
        .expect("valid parameters")
}

/// What is timed of a model.
fn tasks_of(model: Model) -> Vec<Task> {
    let row = model.name();
    let uniforms = uniforms();
    let table = TabulatedProfile::new(&*profile(model, 1.0));
    let radii: Vec<f64> = uniforms.iter().map(|u| table.sample(*u)).collect();

    let mut tasks = vec![task(row, "build", move |_| profile(model, 1.0).total())];
    if model.knows_boundary() {
        tasks.push(task(row, "build, η = 1.4", move |_| profile(model, 1.4).total()));
    }
    let (source, at) = (profile(model, 1.0), radii.clone());
    tasks.push(task(row, "eval", move |i| source.eval(at[i])));
    let (source, at) = (profile(model, 1.0), radii.clone());
    tasks.push(task(row, "enclosed", move |i| source.enclosed(at[i])));
    let (source, at) = (profile(model, 1.0), uniforms.clone());
    tasks.push(if model == Model::NormalizedDiffusion {
        let source = normalized_diffusion();
        task(row, "sample", move |i| source.sample(at[i]))
    } else {
        task(row, "sample", move |i| sample_by_search(&*source, at[i]))
    });

    let source = profile(model, 1.0);
    tasks.push(task(row, "tabulate", move |_| TabulatedProfile::new(&*source).surface_albedo()));
    let (source, at): (Box<dyn Profile>, _) = (Box::new(table.clone()), radii.clone());
    tasks.push(task(row, "table eval", move |i| source.eval(at[i])));
    let (source, at): (Box<dyn Profile>, _) = (Box::new(table.clone()), radii);
    tasks.push(task(row, "table enclosed", move |i| source.enclosed(at[i])));
    tasks.push(task(row, "table sample", move |i| table.sample(uniforms[i])));
    tasks
}

/// What is timed behind no `dyn`.
fn tasks_of_types() -> Vec<Task> {
    let p = normalized_diffusion();
    let radii: Vec<f64> = uniforms().into_iter().map(|u| p.quantile(u)).collect();
    let row = "normalized diffusion, its own type";
    let own = |f: fn(NormalizedDiffusion, f64) -> f64, at: Vec<f64>| move |i: usize| f(p, at[i]);
    let table = TabulatedProfile::new(&p);
    let table_row = "a table, its own type";
    let (a, b, c) = (table.clone(), table.clone(), table);
    let (at, at_too, uniform) = (radii.clone(), radii.clone(), uniforms());
    vec![
        task(row, "build", |_| normalized_diffusion().d()),
        task(row, "eval", own(|p, r| p.eval(r), radii.clone())),
        task(row, "enclosed", own(|p, r| p.enclosed(r), radii)),
        task(row, "sample", own(|p, u| p.sample(u), uniforms())),
        task("an empty call", "eval", |i| i as f64),
        task(table_row, "eval", move |i| a.eval(at[i])),
        task(table_row, "enclosed", move |i| b.enclosed(at_too[i])),
        task(table_row, "sample", move |i| c.sample(uniform[i])),
    ]
}

fn normalized_diffusion() -> NormalizedDiffusion {
    let Appearance { surface_albedo, length, parameterization, .. } = black_box(APPEARANCE);
    NormalizedDiffusion::new(surface_albedo, length, parameterization, Configuration::Searchlight)
        .expect("valid parameters")
}

/// Uniform numbers in (0, 1), the golden-ratio sequence.
fn uniforms() -> Vec<f64> {
    (1..=COUNT as u64)
        .map(|i| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1u64 << 53) as f64)
        .collect()
}

/// Radius within which the share u leaves, for a model that can only say its `enclosed`: a search in r/(r + scale).
fn sample_by_search(profile: &dyn Profile, u: f64) -> f64 {
    let radius = |x: f64| profile.scale() * (1.0 - x) / x;
    let (target, total) = (u * profile.total(), profile.total());
    let x = falling_root(
        |x| profile.enclosed(radius(x)) - target,
        [total - target, -target],
        |_| SAMPLE_TOLERANCE * total,
    );
    radius(x)
}

/// Nanoseconds for some calls, whose arguments repeat after [`COUNT`].
fn nanoseconds(call: &dyn Fn(usize) -> f64, calls: usize) -> f64 {
    let start = Instant::now();
    for i in 0..calls {
        black_box(call(black_box(i % COUNT)));
    }
    start.elapsed().as_nanos() as f64
}

/// How many calls fill a turn.
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

fn lower_quartile(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 4]
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
        "\n`sample` is exact for normalized diffusion and for tables, and else a search for {SAMPLE_TOLERANCE:e} of the \
         energy."
    );
}

/// Rows that have any of the columns; each ratio is to the column of normalized diffusion that is named beside it.
fn print_table(tasks: &[Task], rows: &[&str], columns: &[&str], against: &[&str]) {
    let time = |row: &str, column: &str| {
        tasks.iter().find(|t| t.row == row && t.column == column).map(|t| lower_quartile(&t.rounds))
    };
    println!("| model | {} |", columns.join(" | "));
    println!("|---|{}", "---|".repeat(columns.len()));
    for row in rows.iter().filter(|row| columns.iter().any(|c| time(row, c).is_some())) {
        let cell =
            |(column, base): (&&str, &&str)| match (time(row, column), time(Model::default().name(), base)) {
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
