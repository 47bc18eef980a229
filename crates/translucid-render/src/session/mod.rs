//! A rendering from start to end: points, previews, passes, checkpoints.
//!
//! ```text
//! prepared scene + view → Session → run(plan, observer, stop) → film
//!                            ↑ edit, set_view                    ↓ read at any time
//! ```
//!
//! A session has no terminal and no page: its caller follows its progress through an [`Observer`] and reads its film while
//! it is rendered. [`Session::start`] runs it on threads of its own, so that it can be stopped within milliseconds, edited
//! and started again.

mod memory;
mod on_device;
mod running;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use translucid_image::{Denoised, Denoiser, OutputError};
use translucid_scene::SceneError;

use crate::render::{
    Edit, FilmSums, Fingerprint, Fraction, Goal, LiveFilm, Outcome, PreparedScene, Renewed, SampleProgress,
    ShardNotes, ShardReader, ShardRun, View, save_shard,
};
use crate::subsurface::transport::points::{PointCloud, PointProgress};

pub use memory::available_memory;
pub use on_device::OnDevice;
pub use running::RunningSession;

/// Something that happens in a session.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// Points are being made.
    Points(PointProgress),
    /// Samples were added.
    Samples(SampleProgress),
    /// One sample of each pixel at a fraction of the resolution is there.
    Preview(Fraction, &'a FilmSums),
    /// The film was saved for a later run.
    Checkpoint(&'a Path),
    /// The film could not be saved for a later run; the rendering goes on, and tries again after the same time.
    Unsaved(&'a OutputError),
    /// All samples are there, and the picture is being denoised.
    Denoising,
}

/// Receives the events of a session, from any of its threads.
pub type Observer<'a> = dyn Fn(&Event<'_>) + Sync + 'a;

/// The goal of a session, and its work on the way.
#[derive(Debug)]
pub struct Plan {
    /// Numbers of the samples that each pixel shall have in the end.
    pub samples: Range<u32>,
    /// When to stop even if they are not reached.
    pub deadline: Option<Instant>,
    /// Where and how often the film is saved for a later run.
    pub checkpoint: Option<CheckpointPlan>,
    /// Resolutions at which one sample of each pixel is rendered first.
    pub previews: Vec<Fraction>,
    /// Bytes that points may take, where the scene asks for points.
    pub point_memory: u64,
    /// Denoiser of the picture at the end, however the rendering ended.
    pub denoiser: Option<Arc<Denoiser>>,
}

impl Plan {
    /// A number of samples, and nothing else.
    pub fn samples(samples: u32) -> Self {
        Self {
            samples: 0..samples,
            deadline: None,
            checkpoint: None,
            previews: Vec::new(),
            point_memory: u64::MAX,
            denoiser: None,
        }
    }
}

/// Where and how often a film is saved.
#[derive(Clone, Debug)]
pub struct CheckpointPlan {
    /// The file.
    pub path: PathBuf,
    /// Time between two savings, which a power cut may cost.
    pub interval: Duration,
}

/// A prepared scene, a view of it and its film.
pub struct Session {
    prepared: PreparedScene,
    view: View,
    film: Arc<LiveFilm>,
    /// Time spent rendering in all runs \[s\].
    seconds: f64,
    /// Notes for the film's file; the last of its runs is this one, which has no time yet.
    notes: ShardNotes,
    denoised: Option<Result<Denoised, OutputError>>,
    on_device: Option<OnDevice>,
}

impl Session {
    /// A session with an empty film.
    pub fn new(prepared: PreparedScene, view: View) -> Self {
        let film = Arc::new(empty_film(&view));
        let notes = ShardNotes { runs: vec![ShardRun::default()], ..ShardNotes::default() };
        Self { film, prepared, view, seconds: 0.0, notes, denoised: None, on_device: None }
    }

    /// The scene.
    pub fn prepared(&self) -> &PreparedScene {
        &self.prepared
    }

    /// The view.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The film, which can be read while the session runs. After an edit or another view it is another one.
    pub fn film(&self) -> Arc<LiveFilm> {
        Arc::clone(&self.film)
    }

    /// Time spent rendering in all runs, that of a checkpoint included \[s\].
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Changes the scene; the film begins anew.
    ///
    /// # Errors
    /// As [`PreparedScene::edit`]; scene and film then stay as they were.
    pub fn edit(&mut self, edit: Edit) -> Result<Renewed, SceneError> {
        let renewed = self.prepared.edit(edit)?;
        self.on_device.iter_mut().for_each(OnDevice::renew);
        self.restart();
        Ok(renewed)
    }

    /// Sets the device that traces paths, or none for the processor; the film begins anew.
    ///
    /// Both find the same light by other paths: means are equal, samples are not.
    ///
    /// # Errors
    /// The device is required, and the scene needs something that devices lack, or is too large; the session then stays as it
    /// was.
    pub fn set_device(&mut self, mut device: Option<OnDevice>) -> Result<(), SceneError> {
        device.iter_mut().try_for_each(|device| device.open(&self.prepared, &self.view))?;
        self.on_device = device;
        self.restart();
        Ok(())
    }

    /// Why the processor traces in place of the preferred device, in words.
    pub fn refusal(&self) -> Option<&str> {
        self.on_device.as_ref().and_then(OnDevice::refusal)
    }

    /// Sets another view; the film begins anew.
    pub fn set_view(&mut self, view: View) {
        self.prepared.keep_points_for(&view);
        let filter = |view: &View| (view.film().filter, view.film().filter_radius);
        if filter(&view) != filter(&self.view) {
            self.on_device.iter_mut().for_each(OnDevice::renew);
        }
        self.view = view;
        self.restart();
    }

    fn restart(&mut self) {
        self.film = Arc::new(empty_film(&self.view));
        self.seconds = 0.0;
        self.notes.runs.drain(..self.notes.runs.len() - 1);
    }

    /// Sets the notes for files of the film, and those on this run of the program.
    pub fn set_notes(&mut self, notes: ShardNotes, run: ShardRun) {
        self.notes = ShardNotes { runs: vec![run], ..notes };
    }

    /// Sets the points that the scene asks for.
    pub fn set_points(&mut self, points: &PointCloud) {
        self.prepared.set_points(points);
    }

    /// Continues the film that an earlier run has saved.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or belongs to another scene or view.
    pub fn resume(&mut self, path: &Path) -> Result<(), OutputError> {
        let (film, notes) = self.load(path)?;
        self.film = Arc::new(LiveFilm::new(film));
        self.seconds = notes.seconds();
        let runs = notes.runs.into_iter().chain(self.notes.runs.pop());
        self.notes.runs = runs.collect();
        Ok(())
    }

    /// The film that an earlier run of this scene and view has saved, and its notes.
    ///
    /// # Errors
    /// As [`resume`](Self::resume).
    pub fn load(&self, path: &Path) -> Result<(FilmSums, ShardNotes), OutputError> {
        self.open(path)?.film().map(|(film, header)| (film, header.notes))
    }

    /// A shard that an earlier run of this scene and view has saved, its header read.
    ///
    /// # Errors
    /// As [`resume`](Self::resume), but for the sums, which are not read.
    pub fn open(&self, path: &Path) -> Result<ShardReader, OutputError> {
        let shard = ShardReader::open(path)?;
        let refusal = |difference: &str| {
            OutputError::new(path, format!("is of another scene or other settings: {difference}"))
                .with_help("use the settings that it was made with, or delete it to render from the start")
        };
        let fingerprint = self.fingerprint();
        if let Some(difference) = shard.header().fingerprint.difference(&fingerprint) {
            return Err(refusal(&difference));
        }
        if shard.header().rect() != self.view.region() {
            return Err(refusal("the region differs"));
        }
        Ok(shard)
    }

    /// Fingerprint of everything that the samples depend on: see [`PreparedScene::fingerprint`].
    fn fingerprint(&self) -> Fingerprint {
        let fingerprint = self.prepared.fingerprint(&self.view);
        match self.on_device.as_ref().and_then(OnDevice::name) {
            Some(device) => fingerprint.traced_by(device),
            None => fingerprint,
        }
    }

    /// Saves the film so that a later run can continue it, and others can be joined with it.
    ///
    /// # Errors
    /// The file cannot be written; an older one is then still whole.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        self.save_after(path, 0.0)
    }

    fn save_after(&self, path: &Path, seconds: f64) -> Result<(), OutputError> {
        let mut notes = self.notes.clone();
        let now = self.seconds + seconds - notes.seconds();
        notes.runs.last_mut().into_iter().for_each(|run| run.seconds = now);
        let place = (self.view.region(), self.view.whole_size());
        save_shard(path, &self.film.sums(), self.fingerprint(), place, notes)
    }

    /// Renders on the current rayon pool until the plan is fulfilled, its deadline has come, or `stop` is true.
    ///
    /// A stopped session continues where it was, with the bits of one that was not stopped.
    ///
    /// # Errors
    /// Points do not fit into memory.
    pub fn run(
        &mut self,
        plan: &Plan,
        observer: &Observer<'_>,
        stop: &AtomicBool,
    ) -> Result<Outcome, SceneError> {
        if !self.make_points(plan, observer, stop)? {
            return Ok(Outcome::Interrupted);
        }
        let start = Instant::now();
        let outcome = self
            .preview(plan, observer, stop)
            .and_then(|()| self.render_in_slices(plan, observer, stop, start));
        self.seconds += start.elapsed().as_secs_f64();
        let outcome = outcome?;
        self.denoise(plan, observer);
        Ok(outcome)
    }

    fn denoise(&mut self, plan: &Plan, observer: &Observer<'_>) {
        let denoiser = plan.denoiser.as_ref().filter(|_| self.film.sums().paths() > 0);
        self.denoised = denoiser.map(|denoiser| {
            observer(&Event::Denoising);
            self.film.sums().denoise(denoiser, rayon::current_num_threads())
        });
    }

    /// The picture denoised, if the last run's plan asked for it.
    ///
    /// # Errors
    /// As [`Denoiser::denoise`].
    pub fn take_denoised(&mut self) -> Result<Option<Denoised>, OutputError> {
        self.denoised.take().transpose()
    }

    /// Runs on `threads` threads of its own (0: one per processor), which [`RunningSession`] stops.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub fn start(
        self,
        plan: Plan,
        threads: usize,
        observer: impl Fn(&Event<'_>) + Sync + Send + 'static,
    ) -> std::io::Result<RunningSession> {
        RunningSession::start(self, plan, threads, observer)
    }

    /// Makes the points that the scene asks for; false when stopped.
    fn make_points(
        &mut self,
        plan: &Plan,
        observer: &Observer<'_>,
        stop: &AtomicBool,
    ) -> Result<bool, SceneError> {
        if !self.prepared.wants_points() {
            return Ok(true);
        }
        let allowed = u64::from(self.prepared.scene().integrator.point_memory) << 20;
        let report = |progress| observer(&Event::Points(progress));
        let points = self.prepared.make_points(&self.view, allowed.min(plan.point_memory), &report, stop);
        let Some(points) = points? else { return Ok(false) };
        self.prepared.set_points(&points);
        Ok(true)
    }

    /// Renders the previews of an empty film.
    fn preview(&mut self, plan: &Plan, observer: &Observer<'_>, stop: &AtomicBool) -> Result<(), SceneError> {
        if self.film.sums().paths() > 0 {
            return Ok(());
        }
        for &fraction in &plan.previews {
            let view = self.view.at(fraction);
            let film = empty_film(&view);
            let goal = Goal { samples: 0..1, deadline: plan.deadline };
            if self.render(&view, &film, &goal, &|_| {}, stop)? != Outcome::Finished {
                break;
            }
            observer(&Event::Preview(fraction, &film.sums()));
        }
        Ok(())
    }

    /// Adds samples to a film, on the device if there is one.
    fn render(
        &mut self,
        view: &View,
        film: &LiveFilm,
        goal: &Goal,
        progress: &(dyn Fn(SampleProgress) + Sync),
        stop: &AtomicBool,
    ) -> Result<Outcome, SceneError> {
        match &mut self.on_device {
            Some(device) => device.render(&self.prepared, view, film, goal, progress, stop),
            None => Ok(self.prepared.render(view, film, goal, progress, stop)),
        }
    }

    /// Renders with a checkpoint now and then.
    fn render_in_slices(
        &mut self,
        plan: &Plan,
        observer: &Observer<'_>,
        stop: &AtomicBool,
        start: Instant,
    ) -> Result<Outcome, SceneError> {
        let (view, film) = (self.view.clone(), self.film());
        let mut interval = plan.checkpoint.as_ref().map(|checkpoint| checkpoint.interval);
        loop {
            let paths = self.film.sums().paths();
            let slice = interval.and_then(|interval| Instant::now().checked_add(interval));
            let goal = Goal {
                samples: plan.samples.clone(),
                deadline: plan.deadline.into_iter().chain(slice).min(),
            };
            let report = |progress| observer(&Event::Samples(progress));
            let outcome = self.render(&view, &film, &goal, &report, stop)?;
            let time_is_up = plan.deadline.is_some_and(|deadline| Instant::now() >= deadline);
            let Some(checkpoint) = &plan.checkpoint else { return Ok(outcome) };
            if outcome != Outcome::TimeUp || time_is_up || stop.load(Ordering::Relaxed) {
                return Ok(outcome);
            }
            if self.film.sums().paths() == paths {
                // Not even time for one tile: a longer slice will do.
                interval = interval.map(|interval| interval * 2);
                continue;
            }
            let seconds = start.elapsed().as_secs_f64();
            match self.save_after(&checkpoint.path, seconds) {
                Ok(()) => observer(&Event::Checkpoint(&checkpoint.path)),
                Err(error) => observer(&Event::Unsaved(&error)),
            }
        }
    }
}

/// A film of the size of a view's region.
fn empty_film(view: &View) -> LiveFilm {
    let region = view.region();
    LiveFilm::new(FilmSums::new(region.width, region.height))
}
