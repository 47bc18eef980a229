//! Random scenes of extreme but valid parameters, as files: every scene that the loader admits renders to its end without
//! a panic, and every sum of the film is finite.
//!
//! ```text
//! cargo test -p translucid-workbench --test it fuzzed_scenes                                   those of every run
//! TRANSLUCID_FUZZ_SEEDS=17 cargo test -p translucid-workbench --test it fuzzed_scenes          one; its files are kept
//! TRANSLUCID_FUZZ_SEEDS=1000..9000 cargo test -p translucid-workbench --test it fuzzed_scenes  others
//! ```

#![allow(clippy::print_stdout, reason = "the harness shows what a failed or watched run has printed")]

mod images;
mod lights;
mod materials;
mod meshes;
mod random;
mod scenes;
mod text;

use std::fs;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use glam::Vec3;
use translucid_load::{LoadOptions, load_scene};
use translucid_render::{FilmSums, Outcome, layer};
use translucid_scene::description::SceneSlot;
use translucid_scene::{Light, Object, Pixels, Scene};
use translucid_testing::is_thorough;

use crate::common::{prepare_with_points, render};

/// Scenes of a thorough run; of some the loader refuses a mesh. Others take the first in [`QUICK`].
const SCENES: u64 = 1195;
/// How many of them are rendered at least.
const LEAST_RENDERED: u64 = 960;
const QUICK: u64 = 16;

/// Most CPU time that a scene may take, 10 ms for each of its 2¹⁴ paths; they take a twentieth of a second on average.
///
/// A path that is scattered a thousand times, below white surfaces with g = 0.99, and asks three dozen lamps each time,
/// takes 5 ms.
const MOST_CPU_SECONDS: f64 = 160.0;

/// Time on the clock after which a scene is taken to hang, on a machine that may have much else to do.
const HANG: Duration = Duration::from_secs(1800);

/// Memory for points: some dozens of them, each of which may take thousands of samples.
const MOST_POINT_BYTES: u64 = 1 << 14;

/// Outcome of a scene.
enum Verdict {
    /// Rendered; the CPU time that it took, where the system reports it.
    Good(Option<f64>),
    /// Refused, and why.
    Refused(String),
    Bad(String),
}

/// Seeds yet to come, and the seed that each thread is working on.
struct Work {
    directory: PathBuf,
    next: AtomicU64,
    end: u64,
    /// Removes the files of scenes that have nothing wrong.
    tidy: bool,
    /// Seed at hand and when it was begun, for each thread.
    at_hand: Vec<Mutex<Option<(u64, Instant)>>>,
}

#[test]
fn extreme_scenes_end_and_stay_finite() {
    let seeds = seeds();
    let count = seeds.end - seeds.start;
    let directory = tempfile::Builder::new().prefix("fuzzed_scenes").tempdir_in(env!("CARGO_TARGET_TMPDIR"));
    let directory = directory.expect("a directory for the scenes").keep();
    images::write(&directory);
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let work = Arc::new(Work {
        directory: directory.clone(),
        next: AtomicU64::new(seeds.start),
        end: seeds.end,
        tidy: count > 1,
        at_hand: (0..threads).map(|_| Mutex::new(None)).collect(),
    });
    let (sender, verdicts) = channel();
    for index in 0..threads {
        let (work, sender) = (Arc::clone(&work), sender.clone());
        thread::spawn(move || work.run(index, &sender));
    }
    drop(sender);
    let outcome = collect(&verdicts, &work, count);
    println!("{}", outcome.summary(count));
    assert!(
        outcome.failures.is_empty(),
        "{}\n{}\nThe files of the first are kept as {}",
        outcome.failures.join("\n"),
        reproduction(&outcome),
        directory.join(format!("scene-{}.toml", outcome.failed.first().unwrap_or(&0))).display(),
    );
    let rendered = count - outcome.refused;
    assert!(
        seeds != usual_seeds() || rendered >= share(LEAST_RENDERED),
        "only {rendered} scenes were rendered"
    );
    if count > 1 {
        fs::remove_dir_all(&directory).expect("a directory of our own");
    }
}

/// Seeds that the environment names, else the usual ones.
fn seeds() -> Range<u64> {
    let Ok(text) = std::env::var("TRANSLUCID_FUZZ_SEEDS") else { return usual_seeds() };
    let number =
        |text: &str| text.parse::<u64>().expect("TRANSLUCID_FUZZ_SEEDS is a number, or two with .. between");
    match text.split_once("..") {
        Some((start, end)) => number(start)..number(end),
        None => number(&text)..number(&text) + 1,
    }
}

fn usual_seeds() -> Range<u64> {
    0..share(SCENES)
}

fn share(scenes: u64) -> u64 {
    if is_thorough() { scenes } else { scenes / QUICK }
}

/// Outcomes of all scenes.
#[derive(Default)]
struct Totals {
    failures: Vec<String>,
    failed: Vec<u64>,
    refused: u64,
    cpu_seconds: f64,
    slowest: (f64, u64),
}

impl Totals {
    fn summary(&self, count: u64) -> String {
        let (slowest, seed) = self.slowest;
        format!(
            "{count} scenes, {} refused, {} with a defect; {:.1} s of CPU, the slowest (seed {seed}) {slowest:.2} s",
            self.refused,
            self.failed.len(),
            self.cpu_seconds,
        )
    }

    fn fail(&mut self, seed: u64, what: &str) {
        self.failed.push(seed);
        self.failures.push(format!("seed {seed}: {what}"));
    }
}

fn reproduction(totals: &Totals) -> String {
    let seed = totals.failed.first().unwrap_or(&0);
    format!("TRANSLUCID_FUZZ_SEEDS={seed} cargo test -p translucid-workbench --test it fuzzed_scenes")
}

/// Gathers verdicts until all are there, or a scene hangs.
fn collect(verdicts: &Receiver<(u64, Verdict)>, work: &Work, count: u64) -> Totals {
    let mut totals = Totals::default();
    let mut missing = count;
    while missing > 0 {
        match verdicts.recv_timeout(Duration::from_secs(1)) {
            Ok((seed, Verdict::Good(cpu_seconds))) => {
                let seconds = cpu_seconds.unwrap_or(0.0);
                totals.cpu_seconds += seconds;
                if seconds > totals.slowest.0 {
                    totals.slowest = (seconds, seed);
                }
                if seconds > MOST_CPU_SECONDS {
                    totals.fail(seed, &format!("takes {seconds:.1} s of CPU, more than {MOST_CPU_SECONDS}"));
                }
                missing -= 1;
            }
            Ok((seed, Verdict::Refused(why))) => {
                println!("seed {seed} is refused: {why}");
                totals.refused += 1;
                missing -= 1;
            }
            Ok((seed, Verdict::Bad(what))) => {
                totals.fail(seed, &what);
                missing -= 1;
            }
            Err(_) => {
                if let Some(seed) = work.hanging() {
                    totals.fail(seed, &format!("has not ended after {HANG:?}"));
                    return totals;
                }
            }
        }
    }
    totals
}

impl Work {
    /// Renders one scene after the other, on one thread.
    fn run(&self, index: usize, verdicts: &Sender<(u64, Verdict)>) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        pool.install(|| {
            loop {
                let seed = self.next.fetch_add(1, Ordering::Relaxed);
                if seed >= self.end {
                    return;
                }
                *self.at_hand[index].lock().expect("no thread panics here") = Some((seed, Instant::now()));
                // A panic, too, has to show its seed.
                let verdict = catch_unwind(AssertUnwindSafe(|| judge(seed, &self.directory)));
                let verdict =
                    verdict.unwrap_or_else(|panic| Verdict::Bad(format!("panics: {}", message(&*panic))));
                *self.at_hand[index].lock().expect("no thread panics here") = None;
                if self.tidy && !matches!(verdict, Verdict::Bad(_)) {
                    scenes::remove(seed, &self.directory);
                }
                if verdicts.send((seed, verdict)).is_err() {
                    return;
                }
            }
        });
    }

    /// The seed of a scene that was begun too long ago.
    fn hanging(&self) -> Option<u64> {
        self.at_hand.iter().find_map(|at_hand| {
            let (seed, start) = (*at_hand.lock().expect("no thread panics here"))?;
            (start.elapsed() > HANG).then_some(seed)
        })
    }
}

/// Message of a panic.
fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default()
}

/// Writes, loads and renders the scene of a seed.
fn judge(seed: u64, directory: &Path) -> Verdict {
    let before = thread_cpu_seconds();
    let path = scenes::write(seed, directory);
    let scene = match load_scene(&path, &LoadOptions::default(), &mut Vec::new()) {
        Ok(scene) => scene,
        Err(error) if error.message.is_empty() || error.place.is_none() => {
            return Verdict::Bad(format!("is refused without a reason or a place: {error}"));
        }
        Err(error) => return Verdict::Refused(error.message),
    };
    let (dark, signed) = (is_dark(&scene), is_sky_signed(&scene));
    let renderer = match prepare_with_points(scene, MOST_POINT_BYTES) {
        Ok(renderer) => renderer,
        Err(error) => return Verdict::Refused(error.message),
    };
    let mut film = FilmSums::new(64, 64);
    let outcome = render(&renderer, &mut film, 4);
    if outcome != Outcome::Finished {
        return Verdict::Bad(format!("ends as {outcome:?}"));
    }
    match complaint(&film, dark, signed) {
        Some(what) => Verdict::Bad(what),
        None => Verdict::Good(before.zip(thread_cpu_seconds()).map(|(before, after)| after - before)),
    }
}

/// Returns `true` if nothing in the scene shines.
fn is_dark(scene: &Scene) -> bool {
    let emits = |object: &Object| scene.materials[object.material].emission_luminance > 0.0;
    let is_black = |light: &Light| {
        let mut light = *light;
        light.description().fields.iter().all(|field| match (field.slot)(&mut light) {
            SceneSlot::Radiance(color) | SceneSlot::Power(color) => *color == Vec3::ZERO,
            _ => true,
        })
    };
    let sky = scene.environment.map_or(Vec3::ZERO, |environment| environment.radiance);
    sky == Vec3::ZERO && scene.lights.iter().all(is_black) && !scene.objects.iter().any(emits)
}

/// Returns `true` if the sky has negative values, as colors beyond the primaries do: behind everything they are seen as they
/// are.
fn is_sky_signed(scene: &Scene) -> bool {
    let image =
        scene.environment.and_then(|environment| environment.image).map(|index| &scene.images[index].pixels);
    matches!(image, Some(Pixels::Float(pixels)) if pixels.iter().flatten().any(|value| *value < 0.0))
}

/// Defect of a film, if it has one.
fn complaint(film: &FilmSums, dark: bool, is_sky_signed: bool) -> Option<String> {
    let light = layer::DIFFUSE.start..layer::EMISSION.end;
    let good = |index: usize, sum: f64| {
        let signed = layer::NORMAL.contains(&index) || is_sky_signed && layer::EMISSION.contains(&index);
        let black = !(dark && light.contains(&index)) || sum == 0.0;
        sum.is_finite() && (signed || sum >= 0.0) && black
    };
    film.tiles.iter().flat_map(|tile| tile.pixels()).enumerate().find_map(|(number, sums)| {
        let all_good = sums.iter().enumerate().all(|(index, &sum)| good(index, sum));
        (!all_good).then(|| format!("sums of pixel {number}, dark: {dark}: {sums:?}"))
    })
}

/// CPU time of this thread, where the system reports it.
fn thread_cpu_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split_whitespace().next()?.parse::<u64>().ok()?;
    Some(nanoseconds as f64 * 1e-9)
}
