//! The two hot kernels of the laboratory's side, the photon walk and the profiles, against what the processor can do.
//!
//! ```text
//! cargo bench -p translucid-reference --bench kernels [-- --write]
//! ```
//!
//! Prints the tables of `docs/speed/kernels.md`, which says what their columns are; `--write` puts them there.
//! Times are CPU times of the threads, the best of several runs.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use std::hint::black_box;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use translucid_profile::{
    AlbedoTable, AlbedoTableF32, Appearance, BetterDipole, NormalizedDiffusion, ParameterError,
    Parameterization, Profile, TabulatedProfile,
};
use translucid_reference::walk::{Parameters, Problem, Walker};
use translucid_testing::{golden_uniforms, thread_cpu_seconds, write_measured};

/// Vector instructions of the walk's step for 16 photons of η = 1 and g = 0, counted in its source: three random
/// words 27, exponential flight 21, circle 20, polar angle 7, direction and place 5, end of the flight 4.
const OPERATIONS_OF_WALK: f64 = 84.0;
/// Vector instructions of normalized diffusion's `eval` for one element of a slice, counted in its source: argument, exponential
/// or logarithm with its polynomial, factors. Comparisons and selections count, divisions count once.
const OPERATIONS_OF_EVAL: f64 = 52.0;
/// The same for a sample.
const OPERATIONS_OF_SAMPLE: f64 = 55.0;

/// A line of the cache: a table's cell is one, in either precision.
const BYTES_OF_LINE: f64 = 64.0;

/// Runs of each measurement, of which the best counts.
const RUNS: usize = 9;
/// Numbers in a slice: arguments and results stay in the first cache.
const COUNT: usize = 1024;

fn main() {
    let rates = Rates::measure();
    let mut text = String::new();
    text += &rates.table();
    text += &walk_table(&rates);
    text += &profile_table(&rates);
    println!("{text}");
    if std::env::args().any(|word| word == "--write") {
        write_measured(
            "docs/speed/kernels.md",
            "cargo bench -p translucid-reference --bench kernels -- --write",
            &text,
        );
    }
}

/// Peak rates of one core, in operations on single elements of a vector per nanosecond, and bytes per nanosecond.
struct Rates {
    /// Single precision with the widest instructions, AVX2 and the baseline.
    single: [Option<f64>; 3],
    /// Double precision with AVX2, or else the baseline, multiplications and additions apart.
    double: f64,
    /// Reading memory that is in no cache.
    memory: f64,
}

impl Rates {
    fn measure() -> Self {
        let wide = avx2().unwrap_or(Level::baseline());
        Self {
            single: [
                Some(single_rate(Level::new())),
                avx2().map(single_rate),
                Some(single_rate(Level::baseline())),
            ],
            double: double_rate(wide),
            memory: memory_rate(),
        }
    }

    fn table(&self) -> String {
        let [widest, avx2, baseline] =
            self.single.map(|rate| rate.map_or("–".into(), |r| format!("{r:.0}")));
        let processor = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(": ")?.1.to_owned())
        });
        format!(
            "{}, {} threads; its widest instruction set is {}.\n\n\
             | one core | operations on elements per ns |\n|---|---|\n\
             | single precision, fused, widest | {widest} |\n| … AVX2 | {avx2} |\n| … baseline, not fused | {baseline} |\n\
             | double precision, AVX2, not fused | {:.0} |\n| bytes read from memory per ns | {:.1} |\n\n",
            processor.as_deref().unwrap_or("unknown processor"),
            threads(),
            format!("{:?}", Level::new()).split('(').next().unwrap_or_default(),
            self.double,
            self.memory
        )
    }
}

fn avx2() -> Option<Level> {
    #[cfg(target_arch = "x86_64")]
    return Level::new().as_avx2().map(Level::Avx2);
    #[cfg(not(target_arch = "x86_64"))]
    None
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Steps of a chain of dependent operations.
const STEPS: usize = 200_000;
/// Chains side by side: enough to hide the latency, few enough for sixteen registers.
const CHAINS: usize = 12;

fn single_rate(level: Level) -> f64 {
    // Without a fused instruction each step is two.
    let fused = !is_baseline(level);
    let (lanes, seconds) = best(|| dispatch!(level, simd => single_chains(simd)));
    (STEPS * CHAINS * lanes * if fused { 1 } else { 2 }) as f64 / (1e9 * seconds)
}

fn double_rate(level: Level) -> f64 {
    let (lanes, seconds) = best(|| dispatch!(level, simd => double_chains(simd)));
    (STEPS * CHAINS * lanes * 2) as f64 / (1e9 * seconds)
}

fn is_baseline(level: Level) -> bool {
    #[cfg(target_arch = "x86_64")]
    return level.as_avx2().is_none();
    #[cfg(not(target_arch = "x86_64"))]
    level.is_fallback()
}

#[inline(always)]
fn single_chains<S: Simd>(simd: S) -> usize {
    let (a, b) = (S::f32s::splat(simd, black_box(0.999)), S::f32s::splat(simd, black_box(0.001)));
    let mut chains = [a; CHAINS];
    for _ in 0..STEPS {
        for chain in &mut chains {
            *chain = chain.mul_add(a, b);
        }
    }
    black_box(chains);
    a.as_slice().len()
}

#[inline(always)]
fn double_chains<S: Simd>(simd: S) -> usize {
    let (a, b) = (S::f64s::splat(simd, black_box(0.999)), S::f64s::splat(simd, black_box(0.001)));
    let mut chains = [a; CHAINS];
    for _ in 0..STEPS {
        for chain in &mut chains {
            *chain = *chain * a + b;
        }
    }
    black_box(chains);
    a.as_slice().len()
}

fn memory_rate() -> f64 {
    let memory = vec![1_u64; 32 << 20];
    let sum = || {
        memory.chunks_exact(8).fold([0_u64; 8], |mut sums, chunk| {
            sums.iter_mut().zip(chunk).for_each(|(sum, word)| *sum = sum.wrapping_add(*word));
            sums
        })
    };
    let (_, seconds) = best(|| black_box(sum()));
    (memory.len() * 8) as f64 / (1e9 * seconds)
}

/// The result and the least CPU time of some runs.
fn best<T>(mut f: impl FnMut() -> T) -> (T, f64) {
    let mut timed = || {
        let before = thread_cpu_seconds();
        let result = f();
        (result, thread_cpu_seconds() - before)
    };
    let mut best = timed();
    for _ in 1..RUNS {
        let next = timed();
        if next.1 < best.1 {
            best = next;
        }
    }
    best
}

fn walk_table(rates: &Rates) -> String {
    const ALBEDO: f64 = 0.9;
    let mut text = String::from(
        "| walk, half space, n = 1, g = 0 | α | ns per collision | million photons per s | roofline, ns | reached |\n\
         |---|---|---|---|---|---|\n",
    );
    let bound = |rate: Option<f64>| rate.map(|rate| OPERATIONS_OF_WALK / rate);
    let widest = bound(rates.single[0]);
    for (name, walker, albedo, bound) in [
        ("baseline", Walker::Baseline, ALBEDO, bound(rates.single[2])),
        ("AVX2", Walker::Avx2, ALBEDO, bound(rates.single[1])),
        ("widest", Walker::Kernel, ALBEDO, widest),
        ("widest", Walker::Kernel, 0.999, widest),
    ] {
        let (result, seconds) = best(|| walk(walker, albedo, 0));
        if let Some(collisions) = result {
            text += &walk_row(name, albedo, 1e9 * seconds / collisions as f64, collisions, bound);
        }
    }
    for albedo in [ALBEDO, 0.999] {
        // Collisions per second of each thread's own CPU, added up
        let together = (0..RUNS).map(|_| rate_of_threads(albedo)).fold(0.0, f64::max);
        let collisions = walk(Walker::Kernel, albedo, 0).unwrap_or(1);
        let name = format!("widest, {} threads", threads());
        let bound = widest.map(|bound| bound / threads() as f64);
        text += &walk_row(&name, albedo, 1e9 / together, collisions, bound);
    }
    text += "| MCML 1.2.2, one core, measured apart (±20 %) | 0.9 | 77 | 0.49 | – | – |\n";
    text += "| PyXOpto, OpenCL on the processor, measured apart (±20 %) | 0.9 | 45 | 2.75 | – | – |\n\n";
    text
}

/// Photons of each run.
const PHOTONS: u64 = 200_000;

/// Walks photons from the number `first` on: the collisions, if the machine has the instructions.
fn walk(walker: Walker, albedo: f64, first: u64) -> Option<u64> {
    let problem = Problem::new(Parameters::default()).expect("the default is valid");
    walker.collisions_and_exits(&problem, albedo, first..first + PHOTONS).map(|(collisions, _)| collisions)
}

/// Collisions per second of CPU of all threads at work, added up.
fn rate_of_threads(albedo: f64) -> f64 {
    let rate = move |thread: u64| {
        let before = thread_cpu_seconds();
        let collisions = walk(Walker::Kernel, albedo, thread * PHOTONS).unwrap_or(0);
        collisions as f64 / (thread_cpu_seconds() - before)
    };
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads() as u64).map(|thread| scope.spawn(move || rate(thread))).collect();
        handles.into_iter().map(|handle| handle.join().unwrap_or(0.0)).sum()
    })
}

fn walk_row(name: &str, albedo: f64, ns: f64, collisions: u64, bound: Option<f64>) -> String {
    let photons = 1e3 / (ns * collisions as f64 / PHOTONS as f64);
    let bound = bound.map_or(String::from("– | –"), |b| format!("{b:.2} | {:.0} %", 100.0 * b / ns));
    format!("| {name} | {albedo} | {ns:.2} | {photons:.2} | {bound} |\n")
}

fn profile_table(rates: &Rates) -> String {
    let profile = NormalizedDiffusion::from_d(0.8, black_box(0.7)).expect("valid parameters");
    let uniforms = golden_uniforms(COUNT);
    let mut radii = vec![0.0; COUNT];
    profile.quantile_slice(&uniforms, &mut radii);

    let rows = [
        (
            "eval, f64",
            one_by_one(&radii, |r| profile.eval(r)),
            slice(&radii, |from, to| profile.eval_slice(from, to)),
            OPERATIONS_OF_EVAL,
        ),
        (
            "sample, f64",
            one_by_one(&uniforms, |u| profile.sample(u)),
            slice(&uniforms, |from, to| profile.sample_slice(from, to)),
            OPERATIONS_OF_SAMPLE,
        ),
    ];
    let mut text = String::from(
        "| normalized diffusion | alone, ns | in a slice, ns | roofline, ns | reached | million per s, one core |\n|---|---|---|---|---|---|\n",
    );
    for (name, alone, ns, operations) in rows {
        let bound = operations / rates.double;
        text += &format!(
            "| {name} | {alone:.2} | {ns:.2} | {bound:.2} | {:.0} % | {:.0} |\n",
            100.0 * bound / ns,
            1e3 / ns
        );
    }
    text + &table_rows(&uniforms, rates)
}

/// Tables, of which nothing is vector code: a search in buckets and a cell's formula.
fn table_rows(uniforms: &[f64], rates: &Rates) -> String {
    fn dipole(surface_albedo: f64) -> Result<Box<dyn Profile>, ParameterError> {
        let appearance =
            Appearance { surface_albedo, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
        Ok(Box::new(BetterDipole::new(&appearance, 1.0)?))
    }
    let source = dipole(0.8).expect("valid parameters");
    let table = TabulatedProfile::new(&*source);
    let radii: Vec<f64> = uniforms.iter().map(|u| table.quantile(*u)).collect();
    let albedos = AlbedoTableF32::from(&AlbedoTable::for_every_albedo(dipole).expect("every albedo"));
    let view = albedos.at(0.8, 1.0);
    let narrow = |values: &[f64]| values.iter().map(|v| *v as f32).collect::<Vec<f32>>();
    let mut text = String::from(
        "\n| table of the better dipole | alone, ns | cells from memory, ns | million per s, one core |\n|---|---|---|---|\n",
    );
    let from_memory = |lines: f64| lines * BYTES_OF_LINE / rates.memory;
    for (name, ns, bound) in [
        ("eval, f64", one_by_one(&radii, |r| table.eval(r)), 1.0),
        ("quantile, f64", one_by_one(uniforms, |u| table.quantile(u)), 1.0),
        ("pdf between two albedos, f32", one_by_one(&narrow(&radii), |r| view.pdf(r)), 2.0),
        ("sample between two albedos, f32", one_by_one(&narrow(uniforms), |u| view.sample(u)), 2.0),
    ] {
        text += &format!("| {name} | {ns:.2} | {:.1} | {:.0} |\n", from_memory(bound), 1e3 / ns);
    }
    text
}

/// Nanoseconds a call, one at a time: `black_box` keeps the loop from becoming vector code.
fn one_by_one<T: Copy>(arguments: &[T], f: impl Fn(T) -> T) -> f64 {
    const TIMES: usize = 200;
    let ((), seconds) = best(|| {
        for _ in 0..TIMES {
            for argument in arguments {
                black_box(f(black_box(*argument)));
            }
        }
    });
    1e9 * seconds / (TIMES * arguments.len()) as f64
}

/// Nanoseconds an element, in a slice.
fn slice<T: Copy>(arguments: &[T], f: impl Fn(&[T], &mut [T])) -> f64 {
    const TIMES: usize = 1000;
    let mut results = arguments.to_vec();
    let ((), seconds) = best(|| {
        for _ in 0..TIMES {
            f(black_box(arguments), &mut results);
            black_box(&mut results);
        }
    });
    1e9 * seconds / (TIMES * arguments.len()) as f64
}
