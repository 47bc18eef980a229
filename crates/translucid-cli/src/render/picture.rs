//! A picture from a scene: the words and files around a session.

use std::fs;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use translucid_gpu::Choice;
use translucid_image::{Denoiser, OutputError, Picture, PixelRect};
use translucid_render::{
    CheckpointPlan, Event, FilmSums, ImageInfo, Outcome, Plan, PreparedScene, Session, ShardNotes, ShardRun,
    content_hash,
};
use translucid_scene::{Scene, SubsurfaceModel};

use super::outputs::Outputs;
use super::showing::Showing;
use super::statistics::{self, Statistics};
use super::tev::Tev;
use super::tone::Exposure;
use super::{Arguments, MAX_SAMPLES, points, preview, scene_name};
use crate::failure::Failure;
use crate::progress::{Meter, Unit, duration};
use crate::{command_line, interrupt, machine, messages};

/// How a scene is to be rendered, besides its own settings.
#[derive(Debug)]
pub(crate) struct Task<'a> {
    pub(crate) arguments: &'a Arguments,
    /// Files to write.
    pub(crate) outputs: Outputs,
    /// Denoiser of the finished picture, if that is asked for.
    pub(crate) denoiser: Option<Arc<Denoiser>>,
    /// The tev that shows the picture as it grows, if that is asked for.
    pub(crate) tev: Option<&'a Tev>,
    /// Its place among several renderings that belong together.
    pub(crate) part: Option<Part>,
    /// How its picture is exposed.
    pub(crate) exposure: &'a Exposure,
    /// Time that the scene took to load.
    pub(crate) loading: Duration,
}

impl Task<'_> {
    /// Whether anybody wants to know what it took.
    fn wants_statistics(&self) -> bool {
        self.arguments.watch.stats.is_some() || messages::is_json()
    }
}

/// One of several renderings that belong together.
///
/// It keeps its checkpoint, so that all can go on where one was interrupted, and its time limit holds for all runs
/// together, so that they stay comparable.
#[derive(Debug)]
pub(crate) struct Part {
    /// Name that the progress line shows.
    pub(crate) label: String,
    /// Where the film with the first half of the samples is kept, for those who go on in the second.
    pub(crate) first_half: PathBuf,
}

/// A rendering whose images are written.
pub(crate) struct Rendering {
    /// The sums of all samples.
    pub(crate) film: FilmSums,
    /// The sums after half of the samples, if that is known and was asked for.
    pub(crate) first_half: Option<FilmSums>,
    /// Whether every pixel has its samples.
    pub(crate) is_finished: bool,
    /// Time spent rendering in all runs \[s\].
    pub(crate) seconds: f64,
    /// CPU time of all threads \[s\]; none where it is not known, or an earlier run had a part in it.
    pub(crate) cpu_seconds: Option<f64>,
}

/// Renders a scene on the current pool and writes its files.
pub(crate) fn render(scene: Scene, task: &Task<'_>) -> Result<Rendering, Failure> {
    let arguments = task.arguments;
    let start = Instant::now();
    let prepared = PreparedScene::new(scene)?;
    // Until here there is nothing that Ctrl-C could lose
    interrupt::catch("\nstopping; press Ctrl-C again to lose the work")?;
    prepared.notes().iter().for_each(|note| messages::print_note(&note.to_string()));
    if messages::is_verbose() {
        let seconds = start.elapsed().as_secs_f64();
        messages::line(&format!("prepared the scene (hierarchy, lights, profiles) in {seconds:.2} s"));
        print_models(prepared.scene());
        print_open_bodies(prepared.scene());
    }
    let view = prepared.view()?;
    let view = arguments.region.map_or(Ok(view.clone()), |region| view.with_region(region))?;
    let prepared = points::prepare(prepared, &view)?;
    let mut session = Session::new(prepared, view);
    set_device(&mut session, arguments.device.as_deref().unwrap_or("cpu"))?;
    Work::start(session, task, start.elapsed())?.finish()
}

/// Sets who traces paths.
fn set_device(session: &mut Session, name: &str) -> Result<(), Failure> {
    let choice = Choice::open_for_pictures(name).map_err(no_device)?;
    choice.note.iter().for_each(|note| messages::print_note(note));
    session
        .set_device(choice.on_device())
        .map_err(|error| Failure::from(error).with_help("--device cpu renders it"))?;
    if let Some(reason) = session.refusal() {
        messages::print_note(&format!("the processor traces: {reason}"));
    }
    Ok(())
}

/// The failure where a device cannot be had, for a reason.
pub(crate) fn no_device(reason: String) -> Failure {
    Failure::input(reason).with_help("`translucid devices` lists them; --device cpu is always there")
}

/// The model of each material that light goes under.
fn print_models(scene: &Scene) {
    for material in scene.materials.iter().filter(|material| material.has_subsurface()) {
        let model = material.model(&scene.integrator).name();
        let is_named = material.subsurface_model != SubsurfaceModel::Default;
        let choice = if is_named { "" } else { ", by default" };
        messages::line(&format!("material {}: {model}{choice}", material.name));
    }
}

/// Open bodies that lines are about at most.
const MOST_OPEN: usize = 8;

/// How open the bodies are that light walks under, and what that costs.
fn print_open_bodies(scene: &Scene) {
    let open = scene.open_bodies();
    open.iter().take(MOST_OPEN).for_each(|body| messages::line(&body.to_string()));
    if open.len() > MOST_OPEN {
        messages::line(&format!("{} more objects are open like that", open.len() - MOST_OPEN));
    }
}

/// A picture on its way.
struct Work<'a> {
    session: Session,
    task: &'a Task<'a>,
    /// The film after half of its samples, for a part of several renderings.
    first_half: Option<FilmSums>,
    /// Seconds that earlier runs spent.
    seconds_before: f64,
    /// Whether it has been said that the rendering cannot be saved.
    is_warned: AtomicBool,
    /// Time that the scene took to be prepared.
    preparing: Duration,
}

impl<'a> Work<'a> {
    /// An empty film, or that of the checkpoint.
    fn start(mut session: Session, task: &'a Task<'a>, preparing: Duration) -> Result<Self, Failure> {
        let run = ShardRun {
            host: machine::host(),
            threads: rayon::current_num_threads(),
            began: SystemTime::UNIX_EPOCH.elapsed().map_or(0, |since| since.as_secs()),
            seconds: 0.0,
            preparing: (task.loading + preparing).as_secs_f64(),
        };
        session.set_notes(notes(task, session.prepared().scene()), run);
        if is_to_resume(task, &session) {
            session.resume(&task.outputs.checkpoint)?;
            messages::line(&format!("continuing from {} samples per pixel", session.film().samples()));
        }
        let seconds_before = session.seconds();
        let is_warned = AtomicBool::new(false);
        let mut work = Self { session, task, first_half: None, seconds_before, is_warned, preparing };
        work.first_half = work.load_first_half();
        Ok(work)
    }

    /// Numbers of the samples that each pixel shall have.
    fn goal(&self) -> Range<u32> {
        goal(self.task, &self.session)
    }

    /// Number of samples after which the film is kept as its first half; none where there is no use for it.
    fn half(&self) -> Option<u32> {
        // Without a goal of its own, work that ends with the time has no middle
        let task = self.task;
        // A denoised picture would be denoised in its middle, too
        let is_wanted =
            task.part.is_some() || task.arguments.watch.stats.is_some() && task.denoiser.is_none();
        let Range { start, end } = self.goal();
        (is_wanted && task.arguments.time.is_none() && start == 0 && end > 1).then_some(end / 2)
    }

    /// The first half that an earlier run has left, where this one begins beyond it.
    fn load_first_half(&self) -> Option<FilmSums> {
        let (part, half) = self.task.part.as_ref().zip(self.half())?;
        let is_beyond = self.session.film().sums().tiles.iter().any(|tile| tile.samples() > half);
        // Without it only the estimate of the noise is missing
        let (film, _) = is_beyond.then(|| self.session.load(&part.first_half).ok()).flatten()?;
        film.tiles.iter().all(|tile| tile.samples() == half).then_some(film)
    }

    /// Renders until the goal, the time limit or Ctrl-C, then writes the files.
    fn finish(mut self) -> Result<Rendering, Failure> {
        let cpu_before = machine::cpu_seconds();
        let paths_before = self.session.film().sums().paths();
        let deadline = self.limit().and_then(|limit| Instant::now().checked_add(limit));
        let mut meter = Meter::new(Unit::Samples).between(paths_before, deadline);
        if let Some(part) = &self.task.part {
            meter = meter.named(&part.label);
        }
        let showings = self.show()?;
        let outcome = self.render_to_the_end(&meter, deadline);
        let cpu_seconds = cpu_before.zip(machine::cpu_seconds()).map(|(before, after)| after - before);
        meter.finish();
        let outcome = outcome?;
        let paths = self.session.film().sums().paths();
        self.require_paths(paths, outcome)?;
        let start = Instant::now();
        self.write_images()?;
        let is_kept = self.settle_checkpoint(outcome)?;
        let writing = start.elapsed();
        showings.into_iter().for_each(Showing::finish);
        if self.task.wants_statistics() {
            self.write_statistics(outcome, [paths_before, paths], writing, cpu_seconds)?;
        }
        self.print_summary(cpu_seconds, paths - paths_before, is_kept);
        if outcome == Outcome::Interrupted {
            let checkpoint = self.task.outputs.checkpoint.display();
            let help = match is_kept {
                true => format!("repeat the command with --resume to go on from {checkpoint}"),
                false => String::from("the picture was written as far as it is"),
            };
            return Err(Failure::interrupted(help));
        }
        Ok(Rendering {
            is_finished: outcome == Outcome::Finished,
            seconds: self.session.seconds(),
            cpu_seconds: cpu_seconds.filter(|_| self.seconds_before == 0.0),
            film: self.session.film().sums().clone(),
            first_half: self.first_half,
        })
    }

    /// Begins to show the film in a tev, by the name of its file, and in a preview, as far as they are asked for.
    fn show(&self) -> Result<Vec<Showing>, Failure> {
        let (outputs, view) = (&self.task.outputs, self.session.view());
        let region = view.region();
        let place = view.place().unwrap_or((region, [region.width, region.height]));
        let mut showings = Vec::new();
        if let Some(tev) = self.task.tev {
            let name = outputs.main().to_string_lossy();
            showings.push(tev.show(&name, self.session.film(), place)?);
        }
        if let Some(path) = &self.task.arguments.watch.preview {
            let (film, exposure) = (self.session.prepared().scene().film, self.task.exposure.clone());
            let display = move |picture: &Picture<'_>| exposure.preview(&film, picture);
            showings.push(preview::show(path, self.session.film(), place, display)?);
        }
        Ok(showings)
    }

    /// Writes what the rendering took, to the file and the program that ask for it.
    fn write_statistics(
        &self,
        outcome: Outcome,
        [paths_before, paths]: [u64; 2],
        writing: Duration,
        cpu_seconds: Option<f64>,
    ) -> Result<(), Failure> {
        let (film, scene) = (self.session.film(), self.session.prepared().scene());
        let mut files: Vec<String> =
            self.task.outputs.images().map(|path| path.display().to_string()).collect();
        if self.task.outputs.is_shard() {
            files.push(self.task.outputs.main().display().to_string());
        }
        let statistics = Statistics {
            scene_name: scene_name(self.task.arguments),
            label: self.task.part.as_ref().map(|part| part.label.clone()),
            files,
            outcome,
            threads: rayon::current_num_threads(),
            loading: self.task.loading.as_secs_f64(),
            preparing: self.preparing.as_secs_f64(),
            rendering: self.session.seconds() - self.seconds_before,
            rendering_before: self.seconds_before,
            writing: writing.as_secs_f64(),
            cpu_seconds,
            samples_now: paths - paths_before,
            first_half: self.first_half.as_ref(),
        };
        let statistics = statistics.json(scene, &film.sums());
        statistics::write(self.task.arguments.watch.stats.as_deref(), statistics)
    }

    /// Refuses to write an empty picture, which must not take the place of one that may be there.
    fn require_paths(&self, paths: u64, outcome: Outcome) -> Result<(), Failure> {
        if paths > 0 {
            return Ok(());
        }
        if outcome == Outcome::Interrupted {
            let help = match self.task.part {
                Some(_) => Failure::GO_ON,
                None => "the rendering had not begun, so nothing was written",
            };
            return Err(Failure::interrupted(help));
        }
        let message = "the rendering ended before its first samples, so nothing was written";
        Err(Failure::work(message).with_help("give it more time"))
    }

    /// How long this run may take.
    fn limit(&self) -> Option<Duration> {
        let before = if self.task.part.is_some() { self.seconds_before } else { 0.0 };
        let limit = self.task.arguments.time?;
        Some(
            Duration::try_from_secs_f64(before).map_or(Duration::ZERO, |before| limit.saturating_sub(before)),
        )
    }

    /// Renders until the goal, by way of the first half where that is to be kept.
    fn render_to_the_end(&mut self, meter: &Meter, deadline: Option<Instant>) -> Result<Outcome, Failure> {
        if let Some(half) = self.half()
            && self.session.film().sums().tiles.iter().all(|tile| tile.samples() <= half)
        {
            let outcome = self.run(0..half, meter, deadline)?;
            if outcome != Outcome::Finished {
                return Ok(outcome);
            }
            // Without it a later run has no estimate of the noise
            if let Some(part) = &self.task.part {
                let saved = self.session.save(&part.first_half);
                let _ = saved.inspect_err(|error| warn_once(&self.is_warned, error));
            }
            self.first_half = Some(self.session.film().sums().clone());
        }
        self.run(self.goal(), meter, deadline)
    }

    /// Renders samples with a checkpoint now and then.
    fn run(
        &mut self,
        samples: Range<u32>,
        meter: &Meter,
        deadline: Option<Instant>,
    ) -> Result<Outcome, Failure> {
        let checkpoint = CheckpointPlan {
            path: self.task.outputs.checkpoint.clone(),
            interval: self.task.arguments.checkpoint_interval(),
        };
        let denoiser = self.task.denoiser.clone();
        let plan = Plan { deadline, checkpoint: Some(checkpoint), denoiser, ..Plan::samples(0) };
        let plan = Plan { samples, ..plan };
        let total = self.goal().len() as u64 * self.session.view().region().area();
        let is_warned = &self.is_warned;
        let observer = |event: &Event<'_>| match event {
            Event::Samples(progress) => meter.update(progress.samples_done, total),
            Event::Unsaved(error) => meter.suspend(|| warn_once(is_warned, error)),
            _ => {}
        };
        Ok(self.session.run(&plan, &observer, &interrupt::STOP)?)
    }

    /// Keeps the state where there is something to go on with, else removes what an earlier slice left. Says whether it
    /// is kept: a disk that has room for the picture only does not cost the picture.
    ///
    /// # Errors
    /// It is a shard, and cannot be written.
    fn settle_checkpoint(&self, outcome: Outcome) -> Result<bool, Failure> {
        let is_wanted =
            self.task.arguments.resume || self.task.part.is_some() || self.task.outputs.is_shard();
        if outcome != Outcome::Finished || is_wanted {
            let saved = self.session.save(&self.task.outputs.checkpoint);
            if self.task.outputs.is_shard() {
                return saved.map(|()| true).map_err(Failure::late);
            }
            return Ok(saved.inspect_err(|error| warn_once(&self.is_warned, error)).is_ok());
        }
        // It is not there when the rendering was short.
        let _ = fs::remove_file(&self.task.outputs.checkpoint);
        Ok(false)
    }

    fn write_images(&mut self) -> Result<(), Failure> {
        let (denoised, error) = match self.session.take_denoised() {
            Ok(denoised) => (denoised, None),
            // The noisy picture is what the time went into.
            Err(error) => (None, Some(error)),
        };
        let scene = self.session.prepared().scene();
        let film = self.session.film();
        let sums = film.sums();
        let arguments = self.task.arguments;
        if let Some(denoised) = denoised.as_ref().filter(|_| messages::is_verbose()) {
            messages::line(&format!("denoised the picture by {}", denoised.by));
        }
        let info = ImageInfo {
            scene: scene_name(arguments),
            seed: scene.integrator.seed,
            samples: sums.samples(),
            seconds: self.session.seconds(),
            command: command_line::shown(),
            place: self.session.view().place(),
            denoised,
        };
        let display = |picture: &Picture<'_>| self.task.exposure.display(&scene.film, picture);
        self.task.outputs.write(&sums, display, &info)?;
        error.map_or(Ok(()), |error| {
            Err(Failure::work(error.to_string()).with_help("the picture was written as it was rendered"))
        })
    }

    fn print_summary(&self, cpu_seconds: Option<f64>, paths: u64, is_kept: bool) {
        let seconds = self.session.seconds() - self.seconds_before;
        let PixelRect { width, height, .. } = self.session.view().region();
        let label = self.task.part.as_ref().map_or_else(String::new, |part| format!("{}: ", part.label));
        let mut text = format!(
            "{label}{} samples per pixel at {width}x{height} in {}",
            self.session.film().samples(),
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
        if self.task.outputs.is_shard() {
            return messages::line(&format!("wrote {}", self.task.outputs.main().display()));
        }
        let files: Vec<String> = self.task.outputs.images().map(|path| path.display().to_string()).collect();
        let exposure = self.task.exposure.metered();
        let exposure = exposure.map_or_else(String::new, |stops| format!(", exposed by {stops:+} stops"));
        messages::line(&format!("wrote {}{exposure}", files.join(" and ")));
        if self.task.part.is_none() && is_kept {
            messages::line(&format!("kept {}", self.task.outputs.checkpoint.display()));
        }
    }
}

/// The notes of a task's shard. Pictures are spared the hashes of files, which may be large: their checkpoints are their own.
fn notes(task: &Task<'_>, scene: &Scene) -> ShardNotes {
    // What cannot be read again has been read all the same
    let facts = |path: &PathBuf| {
        let content = fs::read(path).ok()?;
        Some((path.display().to_string(), (content.len() as u64, content_hash(&content))))
    };
    ShardNotes {
        scene: scene_name(task.arguments),
        seed: scene.integrator.seed,
        // Until the time is up is no number
        samples_per_pixel: Some(scene.integrator.samples_per_pixel)
            .filter(|all| *all < MAX_SAMPLES)
            .unwrap_or(0),
        exposure: task.exposure.stated(&scene.film),
        tone_mapping: scene.film.tone_mapping.name().to_owned(),
        inputs: scene.files.iter().filter(|_| task.outputs.is_shard()).filter_map(facts).collect(),
        runs: Vec::new(),
    }
}

/// Says, if it has not been said, that a rendering cannot be saved for a later run.
fn warn_once(is_warned: &AtomicBool, error: &OutputError) {
    if !is_warned.swap(true, Ordering::Relaxed) {
        let message = error.located_message();
        messages::print_warning(&format!(
            "{message}; the rendering continues, but --resume cannot continue from here"
        ));
    }
}

/// Numbers of the samples that each pixel of a task shall have.
fn goal(task: &Task<'_>, session: &Session) -> Range<u32> {
    let all = 0..session.prepared().scene().integrator.samples_per_pixel;
    task.arguments.samples.clone().unwrap_or(all)
}

/// Whether there is something of an earlier run to go on from, and that is wanted.
fn is_to_resume(task: &Task<'_>, session: &Session) -> bool {
    let path = &task.outputs.checkpoint;
    match (task.arguments.resume, path.exists()) {
        (true, true) => return true,
        (true, false) => {
            messages::line(&format!("there is no {} yet: starting anew", path.display()));
        }
        (false, true) => {
            let Range { start, end } = goal(task, session);
            let has_all = |[from, to]: &[u32; 2]| *from <= start && end <= *to;
            let kind = if task.outputs.is_shard() { "shard" } else { "rendering" };
            let thing = format!("{kind} {}", path.display());
            messages::print_note(&match session.open(path) {
                Ok(shard) if shard.header().samples.iter().any(has_all) => {
                    format!("the finished {thing} will be made anew; --resume keeps it")
                }
                Ok(_) => format!("the unfinished {thing} will be replaced; --resume continues it"),
                Err(error) => format!("{}; it will be replaced", error.located_message()),
            });
        }
        (_, false) => {}
    }
    false
}
