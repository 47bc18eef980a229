//! A rendering from start to end: threads, checkpoints, Ctrl-C, files.

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use translucid_image::Denoiser;
use translucid_render::{
    CheckpointInfo, FilmSums, Goal, ImageInfo, Outcome, Renderer, layer, load_checkpoint, save_checkpoint,
};
use translucid_scene::Scene;

use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::points::{self, PointOptions};
use crate::progress::{Meter, Unit, duration};
use crate::{interrupt, machine, messages};

/// Memory that a pixel takes: its sums, and a sample that waits, or while it is written its values in all channels.
pub(crate) const BYTES_PER_PIXEL: u64 = 8 * layer::COUNT as u64 + 84;

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
    /// Time between two checkpoints: what a power cut may cost.
    pub(crate) checkpoint_interval: Duration,
    /// File of the points that the point-based method needs.
    pub(crate) points: Option<PathBuf>,
    /// What denoises the picture at the end, if that is asked for.
    pub(crate) denoiser: Option<Denoiser>,
    /// Whether to print errors and warnings only.
    pub(crate) quiet: bool,
    /// Whether to print what takes how long.
    pub(crate) verbose: bool,
    /// What is different where several renderings belong together.
    pub(crate) part: Option<Part>,
}

/// One of several renderings that belong together.
///
/// It keeps its checkpoint, so that all can go on where one was interrupted, and its time limit holds for all runs
/// together, so that they stay comparable.
#[derive(Debug)]
pub(crate) struct Part {
    /// What to call it while it goes on.
    pub(crate) label: String,
    /// Where the film with the first half of the samples is kept, for those who go on in the second.
    pub(crate) first_half: PathBuf,
}

/// What a rendering has come to; its images are written.
pub(crate) struct Rendering {
    /// The sums of all samples.
    pub(crate) film: FilmSums,
    /// The same as they were after half of the samples, if that is known and was asked for.
    pub(crate) first_half: Option<FilmSums>,
    /// Whether every pixel has its samples.
    pub(crate) is_finished: bool,
    /// Time spent rendering in all runs \[s\].
    pub(crate) seconds: f64,
    /// CPU time of all threads \[s\]; none where it is not known, or an earlier run had a part in it.
    pub(crate) cpu_seconds: Option<f64>,
}

/// Renders a scene and writes its files.
pub(crate) fn render(scene: Scene, session: &Session) -> Result<Rendering, Failure> {
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
        let points = PointOptions { file: session.points.as_deref(), quiet: session.quiet };
        let renderer = points::prepare(renderer, points)?;
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
    /// The film after half of its samples, for a part of several renderings.
    first_half: Option<FilmSums>,
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
        let mut work = Self { renderer, session, fingerprint, film, first_half: None, seconds_before };
        work.first_half = work.load_first_half();
        Ok(work)
    }

    /// Number of samples after which the film is kept as its first half; none where there is no use for it.
    fn half(&self) -> Option<u32> {
        let samples = self.renderer.scene().integrator.samples_per_pixel;
        // Without a goal of its own, work that ends with the time has no middle
        (self.session.part.is_some() && self.session.limit.is_none() && samples > 1).then_some(samples / 2)
    }

    /// The first half that an earlier run has left, where this one begins beyond it.
    fn load_first_half(&self) -> Option<FilmSums> {
        let (part, half) = self.session.part.as_ref().zip(self.half())?;
        let is_beyond = self.film.tiles.iter().any(|tile| tile.samples > half);
        // Without it only the estimate of the noise is missing
        let (film, _) =
            is_beyond.then(|| load_checkpoint(&part.first_half, self.fingerprint).ok()).flatten()?;
        film.tiles.iter().all(|tile| tile.samples == half).then_some(film)
    }

    /// Renders until the goal, the time limit or Ctrl-C, then writes the files.
    fn finish(mut self) -> Result<Rendering, Failure> {
        let cpu_before = machine::cpu_seconds();
        let paths_before = self.paths();
        let deadline = self.limit().and_then(|limit| Instant::now().checked_add(limit));
        let mut meter = if self.session.quiet {
            Meter::quiet(Unit::Samples, paths_before, deadline)
        } else {
            Meter::new(Unit::Samples, paths_before, deadline)
        };
        if let Some(part) = &self.session.part {
            meter = meter.named(&part.label);
        }
        let outcome = self.render_to_the_end(&meter, deadline);
        let seconds = meter.elapsed().as_secs_f64();
        let cpu_seconds = cpu_before.zip(machine::cpu_seconds()).map(|(before, after)| after - before);
        meter.finish();
        let outcome = outcome?;
        if self.paths() == 0 && outcome == Outcome::Interrupted {
            let help = match self.session.part {
                Some(_) => "repeat the command with --resume to go on",
                None => "the rendering had not begun, so nothing was written",
            };
            return Err(Failure::Interrupted { help: help.into() });
        }
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
        Ok(Rendering {
            is_finished: outcome == Outcome::Finished,
            seconds: self.seconds_before + seconds,
            cpu_seconds: cpu_seconds.filter(|_| self.seconds_before == 0.0),
            film: self.film,
            first_half: self.first_half,
        })
    }

    /// How long this run may take.
    fn limit(&self) -> Option<Duration> {
        let before = if self.session.part.is_some() { self.seconds_before } else { 0.0 };
        let limit = self.session.limit?;
        Some(
            Duration::try_from_secs_f64(before).map_or(Duration::ZERO, |before| limit.saturating_sub(before)),
        )
    }

    /// Renders until the goal, by way of the first half where that is to be kept.
    fn render_to_the_end(&mut self, meter: &Meter, deadline: Option<Instant>) -> Result<Outcome, Failure> {
        let samples = self.renderer.scene().integrator.samples_per_pixel;
        if let (Some(part), Some(half)) = (&self.session.part, self.half())
            && self.film.tiles.iter().all(|tile| tile.samples <= half)
        {
            let outcome = self.render_in_slices(half, meter, deadline)?;
            if outcome != Outcome::Finished {
                return Ok(outcome);
            }
            let info = self.checkpoint_info(meter.elapsed().as_secs_f64());
            save_checkpoint(&part.first_half, &self.film, &info).map_err(Failure::late)?;
            self.first_half = Some(self.film.clone());
        }
        self.render_in_slices(samples, meter, deadline)
    }

    /// Renders until a number of samples with a checkpoint now and then.
    fn render_in_slices(
        &mut self,
        samples: u32,
        meter: &Meter,
        deadline: Option<Instant>,
    ) -> Result<Outcome, Failure> {
        let total = u64::from(self.renderer.scene().integrator.samples_per_pixel) * self.pixels();
        let mut interval = self.session.checkpoint_interval;
        loop {
            let paths = self.paths();
            let slice = Instant::now().checked_add(interval);
            let goal = Goal { samples, deadline: deadline.into_iter().chain(slice).min() };
            let outcome = self.renderer.render(
                &mut self.film,
                goal,
                &|progress| meter.update(progress.samples_done, total),
                &interrupt::STOP,
            );
            let time_is_up = deadline.is_some_and(|deadline| Instant::now() >= deadline);
            if outcome != Outcome::TimeUp || time_is_up {
                return Ok(outcome);
            }
            if self.paths() == paths {
                // Not even time for one tile: a longer slice will do.
                interval *= 2;
                continue;
            }
            self.save_checkpoint(meter.elapsed().as_secs_f64())?;
        }
    }

    /// Keeps the state where there is something to go on with, else removes what an earlier slice left.
    fn settle_checkpoint(&self, outcome: Outcome, seconds: f64) -> Result<(), Failure> {
        if outcome != Outcome::Finished || self.session.resume || self.session.part.is_some() {
            return self.save_checkpoint(seconds);
        }
        // It is not there when the rendering was short.
        let _ = fs::remove_file(&self.session.outputs.checkpoint);
        Ok(())
    }

    fn save_checkpoint(&self, seconds: f64) -> Result<(), Failure> {
        let info = self.checkpoint_info(seconds);
        save_checkpoint(&self.session.outputs.checkpoint, &self.film, &info).map_err(Failure::late)
    }

    fn checkpoint_info(&self, seconds: f64) -> CheckpointInfo {
        CheckpointInfo {
            fingerprint: self.fingerprint,
            seed: self.renderer.scene().integrator.seed,
            elapsed_seconds: self.seconds_before + seconds,
        }
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
        let outputs = &self.session.outputs;
        let Some(denoiser) = &self.session.denoiser else {
            return outputs.write(&self.film, &scene.film, &info).map_err(Failure::late);
        };
        let start = Instant::now();
        match denoiser.denoise(&self.film.layers_picture(&info), self.session.threads) {
            Ok(denoised) => {
                if self.session.verbose {
                    let seconds = start.elapsed().as_secs_f64();
                    messages::line(&format!("denoised the picture by {} in {seconds:.2} s", denoised.by));
                }
                outputs.write_denoised(&self.film, &denoised, &scene.film, &info).map_err(Failure::late)
            }
            Err(error) => {
                // The noisy picture is what the time went into.
                outputs.write(&self.film, &scene.film, &info).map_err(Failure::late)?;
                let help = "the picture was written as it was rendered";
                Err(Failure::work(error.to_string()).with_help(help))
            }
        }
    }

    fn pixels(&self) -> u64 {
        u64::from(self.film.width) * u64::from(self.film.height)
    }

    /// Camera paths in the film.
    fn paths(&self) -> u64 {
        self.film.tiles.iter().map(|tile| u64::from(tile.samples) * tile.pixels.len() as u64).sum()
    }

    fn print_summary(&self, seconds: f64, cpu_seconds: Option<f64>, paths: u64) {
        let FilmSums { width, height, .. } = self.film;
        let label = self.session.part.as_ref().map_or_else(String::new, |part| format!("{}: ", part.label));
        let mut text = format!(
            "{label}{} samples per pixel at {width}x{height} in {}",
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
        if self.session.part.is_none() && self.session.outputs.checkpoint.exists() {
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
