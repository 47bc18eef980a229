//! Times of calls.

use std::hint::black_box;
use std::time::{Duration, Instant};

use translucid_profile::{Profile, TabulatedProfile, values};

use super::watch::{Progress, Stopped};
use super::{Contender, Group, Reference};

/// Quantity that is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Making the profile of a surface albedo and a mean free path.
    Build,
    /// R(r).
    Eval,
    /// Energy within r.
    Enclosed,
    /// Drawing a radius: in closed form where the model has one, or else by a search in its energies.
    Sample,
    /// Making a table of a profile.
    Tabulate,
    /// R(r) from the table.
    TableEval,
    /// Energy within r from the table.
    TableEnclosed,
    /// Drawing a radius from the table.
    TableSample,
}

impl Quantity {
    /// All with their names in files, in the order of the variants.
    const ROWS: [(Self, [&'static str; 1]); 8] = [
        (Self::Build, ["build"]),
        (Self::Eval, ["eval"]),
        (Self::Enclosed, ["enclosed"]),
        (Self::Sample, ["sample"]),
        (Self::Tabulate, ["tabulate"]),
        (Self::TableEval, ["table-eval"]),
        (Self::TableEnclosed, ["table-enclosed"]),
        (Self::TableSample, ["table-sample"]),
    ];

    /// All.
    pub const ALL: [Self; 8] = values(&Self::ROWS);

    /// Name in files.
    pub const fn name(self) -> &'static str {
        Self::ROWS[self as usize].1[0]
    }
}

/// Time of one call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// [`Contender::name`].
    pub contender: &'static str,
    /// Quantity that was called for.
    pub quantity: Quantity,
    /// Nanoseconds a call: the lower decile over the rounds.
    pub nanoseconds: f64,
    /// The median over the rounds: its excess over the decile shows how busy the machine was.
    pub median: f64,
    /// Number of rounds.
    pub rounds: usize,
}

/// Arguments a task goes through.
const COUNT: usize = 1024;
/// Time one task gets in one round, or one call where that takes longer.
const TURN: Duration = Duration::from_micros(100);

/// Something that is timed, and its nanoseconds per call in each round.
struct Task<'a> {
    contender: &'static str,
    quantity: Quantity,
    call: Box<dyn Fn(usize) -> f64 + 'a>,
    calls: usize,
    rounds: Vec<f64>,
}

/// Milliseconds that timing takes.
pub(super) fn work(contenders: &[Contender], rounds: usize) -> u64 {
    let tasks = contenders.iter().filter(|one| is_timed(one)).count() * Quantity::ALL.len();
    (tasks * rounds) as u64 * TURN.as_micros() as u64 / 1000
}

/// Times all calls of contenders that are not fits, on this thread; none without rounds.
///
/// All tasks take turns of a tenth of a millisecond, round after round, and the lower decile over the rounds counts:
/// what else the machine does meanwhile falls on all alike, and little of it is left.
/// Calls follow one another without depending on each other, behind a `dyn Profile`, as a renderer that swaps models
/// has them; every figure includes a nanosecond or two of an empty call.
/// Radii are drawn from the profile itself.
pub(super) fn timed(
    contenders: &[Contender],
    reference: &Reference,
    rounds: usize,
    progress: &Progress<'_>,
) -> Result<Vec<Timing>, Stopped> {
    if rounds == 0 {
        return Ok(Vec::new());
    }
    let timed = contenders.iter().filter(|one| is_timed(one) && one.knows(reference.configuration));
    let mut tasks: Vec<Task<'_>> = timed.flat_map(|one| tasks_of(one, reference)).collect();
    for task in &mut tasks {
        progress.check()?;
        task.calls = calls_in_a_turn(&*task.call);
    }
    for _ in 0..rounds {
        progress.check()?;
        for task in &mut tasks {
            task.rounds.push(nanoseconds(&*task.call, task.calls) / task.calls as f64);
        }
        progress.add(work(contenders, 1));
    }
    Ok(tasks.iter_mut().map(Task::timing).collect())
}

/// Fits are searches of milliseconds that nobody would make in a renderer.
fn is_timed(contender: &Contender) -> bool {
    contender.group != Group::Fit
}

impl Task<'_> {
    fn timing(&mut self) -> Timing {
        self.rounds.sort_by(f64::total_cmp);
        let rounds = self.rounds.len();
        let of = |place: usize| self.rounds.get(place).copied().unwrap_or(f64::NAN);
        let (nanoseconds, median) = (of(rounds / 10), of(rounds / 2));
        Timing { contender: self.contender, quantity: self.quantity, nanoseconds, median, rounds }
    }
}

/// Tasks of a model; none where it does not reach the surface albedo.
fn tasks_of<'a>(contender: &'a Contender, reference: &'a Reference) -> Vec<Task<'a>> {
    let make = move || contender.profile(black_box(reference)).ok();
    let (Some(profile), Some(for_eval), Some(for_enclosed), Some(for_sample)) =
        (make(), make(), make(), make())
    else {
        return Vec::new();
    };
    let uniforms = uniforms();
    let table = TabulatedProfile::new(&*profile);
    let radii: Vec<f64> = uniforms.iter().map(|u| table.sample(*u)).collect();
    let task = |quantity: Quantity, call: Box<dyn Fn(usize) -> f64 + 'a>| Task {
        contender: contender.name,
        quantity,
        call,
        calls: 1,
        rounds: Vec::new(),
    };

    let mut tasks =
        vec![task(Quantity::Build, Box::new(move |_| make().map_or(0.0, |one| one.surface_albedo())))];
    let at = radii.clone();
    tasks.push(task(Quantity::Eval, Box::new(move |i| for_eval.eval(at[i]))));
    let at = radii.clone();
    tasks.push(task(Quantity::Enclosed, Box::new(move |i| for_enclosed.enclosed(at[i]))));
    let at = uniforms.clone();
    tasks.push(task(Quantity::Sample, Box::new(move |i| for_sample.sample(at[i]))));
    tasks
        .push(task(Quantity::Tabulate, Box::new(move |_| TabulatedProfile::new(&*profile).surface_albedo())));
    let (boxed, at): (Box<dyn Profile>, _) = (Box::new(table.clone()), radii.clone());
    tasks.push(task(Quantity::TableEval, Box::new(move |i| boxed.eval(at[i]))));
    let (boxed, at): (Box<dyn Profile>, _) = (Box::new(table.clone()), radii);
    tasks.push(task(Quantity::TableEnclosed, Box::new(move |i| boxed.enclosed(at[i]))));
    tasks.push(task(Quantity::TableSample, Box::new(move |i| table.sample(uniforms[i]))));
    tasks
}

/// Uniform numbers in (0, 1), the golden-ratio sequence.
fn uniforms() -> Vec<f64> {
    (1..=COUNT as u64)
        .map(|i| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1u64 << 53) as f64)
        .collect()
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
