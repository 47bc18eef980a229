//! A rendering from start to end: threads, checkpoints, Ctrl-C, files.

use std::fs;
use std::time::{Duration, Instant};

use translucid_render::{
    CheckpointInfo, FilmSums, Goal, ImageInfo, Outcome, Renderer, layer, load_checkpoint, save_checkpoint,
};
use translucid_scene::Scene;

use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::progress::{Meter, Unit, duration};
use crate::{interrupt, machine, messages};

/// Time between two checkpoints: what a power cut may cost.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(30);

/// Memory that a pixel takes: its sums, and while it is written its values in all channels.
pub(crate) const BYTES_PER_PIXEL: u64 = 8 * layer::COUNT as u64 + 64;

/// How a scene is to be rendered, besides its own settings.
#[derive(Debug)]
pub(crate) struct Session {
    /// Name for messages and metadata.
    pub(crate) scene_name: String,
    /// Files to write.
    pub(crate) outputs: Outputs,
    /// Longest time for rendering.
    pub(crate) limit: Option<Duration>,
    /// Number of threads; 0 is one per processor.
    pub(crate) threads: usize,
    /// Whether to go on from a checkpoint, and to keep one.
    pub(crate) resume: bool,
    /// Whether to print errors and warnings only.
    pub(crate) quiet: bool,
    /// Whether to print what takes how long.
    pub(crate) verbose: bool,
}

/// Renders a scene and writes its files.
pub(crate) fn render(scene: Scene, session: &Session) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(session.threads)
        .build()
        .map_err(|error| Failure::work(format!("cannot start the threads: {error}")))?;
    interrupt::catch("\nstopping; press Ctrl-C again to lose the work")?;
    pool.install(|| {
        let start = Instant::now();
        let renderer = Renderer::new(scene);
        renderer.notes().iter().for_each(|note| messages::print_note(note));
        if session.verbose {
            let seconds = start.elapsed().as_secs_f64();
            messages::line(&format!("prepared the scene (hierarchy, lights, profiles) in {seconds:.2} s"));
        }
        let work = Work::start(&renderer, session)?;
        work.finish()
    })
}

/// A film on its way.
struct Work<'a> {
    renderer: &'a Renderer,
    session: &'a Session,
    /// Of scene and settings.
    fingerprint: u64,
    film: FilmSums,
    /// Seconds that earlier runs spent.
    seconds_before: f64,
}

impl<'a> Work<'a> {
    /// An empty film, or that of the checkpoint.
    fn start(renderer: &'a Renderer, session: &'a Session) -> Result<Self, Failure> {
        let size = &renderer.scene().film;
        let fingerprint = renderer.fingerprint();
        let (film, seconds_before) = match checkpoint(session, fingerprint)? {
            Some((film, info)) => (film, info.elapsed_seconds),
            None => (FilmSums::new(size.width, size.height), 0.0),
        };
        Ok(Self { renderer, session, fingerprint, film, seconds_before })
    }

    /// Renders until the goal, the time limit or Ctrl-C, then writes the files.
    fn finish(mut self) -> Result<(), Failure> {
        let cpu_before = machine::cpu_seconds();
        let paths_before = self.paths();
        let deadline = self.session.limit.and_then(|limit| Instant::now().checked_add(limit));
        let meter = if self.session.quiet {
            Meter::quiet(Unit::Samples, paths_before, deadline)
        } else {
            Meter::new(Unit::Samples, paths_before, deadline)
        };
        let outcome = self.render_in_slices(&meter, deadline);
        let seconds = meter.elapsed().as_secs_f64();
        let cpu_seconds = cpu_before.zip(machine::cpu_seconds()).map(|(before, after)| after - before);
        meter.finish();
        let outcome = outcome?;
        if self.paths() == 0 {
            // An empty picture must not take the place of one that may be there.
            let message = "the rendering ended before its first samples, so nothing was written";
            return Err(Failure::work(message).with_help("give it more time"));
        }

        self.write_images(seconds)?;
        self.settle_checkpoint(outcome, seconds)?;
        if !self.session.quiet {
            self.print_summary(seconds, cpu_seconds, self.paths() - paths_before);
        }
        if outcome == Outcome::Interrupted {
            let checkpoint = self.session.outputs.checkpoint.display();
            let help = format!("repeat the command with --resume to go on from {checkpoint}");
            return Err(Failure::Interrupted { help });
        }
        Ok(())
    }

    /// Renders with a checkpoint now and then.
    fn render_in_slices(&mut self, meter: &Meter, deadline: Option<Instant>) -> Result<Outcome, Failure> {
        let samples = self.renderer.scene().integrator.samples_per_pixel;
        loop {
            let slice = Instant::now() + CHECKPOINT_INTERVAL;
            let goal =
                Goal { samples, deadline: Some(deadline.map_or(slice, |deadline| deadline.min(slice))) };
            let outcome = self.renderer.render(
                &mut self.film,
                goal,
                &|progress| meter.update(progress.samples_done, progress.samples_total),
                &interrupt::STOP,
            );
            let time_is_up = deadline.is_some_and(|deadline| Instant::now() >= deadline);
            if outcome != Outcome::TimeUp || time_is_up {
                return Ok(outcome);
            }
            self.save_checkpoint(meter.elapsed().as_secs_f64())?;
        }
    }

    /// Keeps the state where there is something to go on with, else removes what an earlier slice left.
    fn settle_checkpoint(&self, outcome: Outcome, seconds: f64) -> Result<(), Failure> {
        if outcome != Outcome::Finished || self.session.resume {
            return self.save_checkpoint(seconds);
        }
        // It is not there when the rendering was short.
        let _ = fs::remove_file(&self.session.outputs.checkpoint);
        Ok(())
    }

    fn save_checkpoint(&self, seconds: f64) -> Result<(), Failure> {
        let info = CheckpointInfo {
            fingerprint: self.fingerprint,
            seed: self.renderer.scene().integrator.seed,
            elapsed_seconds: self.seconds_before + seconds,
        };
        save_checkpoint(&self.session.outputs.checkpoint, &self.film, &info).map_err(Failure::late)
    }

    fn write_images(&self, seconds: f64) -> Result<(), Failure> {
        let scene = self.renderer.scene();
        let info = ImageInfo {
            scene: self.session.scene_name.clone(),
            seed: scene.integrator.seed,
            samples: self.film.samples(),
            seconds: self.seconds_before + seconds,
            command: command_line(),
        };
        self.session.outputs.write(&self.film, &scene.film, &info).map_err(Failure::late)
    }

    /// Camera paths in the film.
    fn paths(&self) -> u64 {
        self.film.tiles.iter().map(|tile| u64::from(tile.samples) * tile.pixels.len() as u64).sum()
    }

    fn print_summary(&self, seconds: f64, cpu_seconds: Option<f64>, paths: u64) {
        let FilmSums { width, height, .. } = self.film;
        let mut text = format!(
            "{} samples per pixel at {width}x{height} in {}",
            self.film.samples(),
            duration(seconds + self.seconds_before)
        );
        if self.seconds_before > 0.0 {
            text += &format!(", {} of it now", duration(seconds));
        }
        if let Some(cpu_seconds) = cpu_seconds {
            text += &format!(" ({cpu_seconds:.1} s of CPU)");
        }
        text += &format!(", {:.3} M samples/s", paths as f64 / seconds.max(1e-3) * 1e-6);
        if let Some(bytes) = machine::peak_memory() {
            text += &format!(", {:.0} MiB peak memory", bytes as f64 / f64::from(1 << 20));
        }
        messages::line(&text);
        let files: Vec<String> =
            self.session.outputs.images().map(|path| path.display().to_string()).collect();
        messages::line(&format!("wrote {}", files.join(" and ")));
        if self.session.outputs.checkpoint.exists() {
            messages::line(&format!("kept {}", self.session.outputs.checkpoint.display()));
        }
    }
}

/// What an earlier run left, if it is wanted and there.
fn checkpoint(session: &Session, fingerprint: u64) -> Result<Option<(FilmSums, CheckpointInfo)>, Failure> {
    let path = &session.outputs.checkpoint;
    match (session.resume, path.exists()) {
        (true, true) => {
            let (film, info) = load_checkpoint(path, fingerprint)?;
            if !session.quiet {
                messages::line(&format!("going on from {} samples per pixel", film.samples()));
            }
            Ok(Some((film, info)))
        }
        (true, false) => {
            if !session.quiet {
                messages::line(&format!("there is no {} yet: starting anew", path.display()));
            }
            Ok(None)
        }
        (false, true) => {
            let message =
                format!("{} is there and will be replaced: --resume would go on from it", path.display());
            messages::print_note(&message);
            Ok(None)
        }
        (false, false) => Ok(None),
    }
}

/// The command as it was typed, with quotes where a shell needs them.
fn command_line() -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    let words = std::env::args_os().enumerate().map(|(index, word)| {
        let word = word.to_string_lossy().into_owned();
        match index {
            0 => String::from("translucid"),
            _ if !word.is_empty() && word.chars().all(plain) => word,
            _ => format!("'{}'", word.replace('\'', r"'\''")),
        }
    });
    words.collect::<Vec<_>>().join(" ")
}
