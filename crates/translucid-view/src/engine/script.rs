//! Pictures that a page's script has a graphics processor trace, by WebGPU.
//!
//! A script cannot be waited for: the engine gives it a job, goes on hearing what pages say, and takes the samples once they
//! are there. A job of a film that is not wanted any more is given up.

use std::ops::Range;
use std::time::Duration;

use translucid_gpu::program;
use translucid_render::device::{DeviceScene, DeviceTrees};
use translucid_render::{AT_ONCE, FilmSums, Fraction, LiveFilm, Outcome, View, add_samples};

use super::{Engine, Work};
use crate::clock::Instant;

/// How long the engine rests while a script is at work, unless that comes back.
pub(super) const PATIENCE: Duration = Duration::from_secs(1);

/// What the script's device has of a side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Scene {
    #[default]
    Stale,
    Given,
    /// The device cannot take it.
    Refused,
}

/// What a script traces.
#[derive(Default)]
pub(super) struct Script {
    jobs: u32,
    job: Option<Job>,
    state: State,
    /// The trees of the scene that the device was given last.
    trees: DeviceTrees,
}

/// Whether a script's device can trace.
#[derive(Clone, Debug, Default, PartialEq)]
enum State {
    /// Its kernels are not made yet.
    #[default]
    Unready,
    Ready,
    /// The device is lost, for a reason in words.
    Lost(String),
}

struct Job {
    number: u32,
    side: usize,
    /// Number of the film.
    film: u32,
    view: View,
    numbers: Range<u32>,
    preview: Option<Fraction>,
    start: Instant,
}

impl Engine<'_> {
    /// Whether the device is wanted whose kernels the script has not made yet; the processor traces until they are.
    pub(crate) fn wants_kernels(&mut self) -> bool {
        self.follow();
        let wants = self.is_by_script() && self.script.state == State::Unready;
        if wants {
            self.device_fault = Some("the graphics processor's programs are being made".to_owned());
            self.tell_notes();
        }
        wants
    }

    /// Lets the script trace, whose kernels are made.
    pub(crate) fn begin_script(&mut self) {
        self.script.state = State::Ready;
        self.device_fault = None;
        self.tell_notes();
    }

    fn is_by_script(&self) -> bool {
        let by_script = self.shared.settings.devices.by_script.as_ref();
        by_script.is_some_and(|device| device.name == self.device_name)
    }

    /// Whether a side's paths are traced by the script.
    pub(super) fn is_for_script(&self, side: usize) -> bool {
        self.is_by_script()
            && self.script.state == State::Ready
            && self.sides[side].as_ref().is_some_and(|work| work.on_script != Scene::Refused)
    }

    /// The next job for the script as words, unless it has one: number of the job, side, items, whether a scene follows; the
    /// settings; of the scene's five arrays the number of words, and the words. None where nothing is to be traced.
    pub(crate) fn next_job(&mut self) -> Option<Vec<u32>> {
        self.follow();
        let (side, preview) = match self.next_work() {
            Work::Samples(side) => (side, None),
            Work::Preview(side, fraction) => (side, Some(fraction)),
            _ => return None,
        };
        if self.script.job.is_some() || !self.is_for_script(side) {
            return None;
        }
        self.prepare(side);
        let mut scene = Vec::new();
        let work = self.sides[side].as_ref()?;
        let is_new = work.on_script == Scene::Stale;
        if is_new {
            let device = self.shared.settings.devices.by_script.as_ref()?;
            let taken =
                DeviceScene::edited(&self.prepared, &work.view, &device.limits, &mut self.script.trees);
            let work = self.sides[side].as_mut()?;
            work.refusal = taken.as_ref().err().map(ToString::to_string);
            work.on_script = if work.refusal.is_none() { Scene::Given } else { Scene::Refused };
            self.tell_notes();
            scene = arrays(taken.ok()?);
        }

        let work = self.sides[side].as_ref()?;
        let (view, numbers) = match preview {
            Some(fraction) => (work.view.at(fraction), 0..1),
            None => {
                let (first, view) = (work.film.samples(), work.view.clone());
                let most = (AT_ONCE / view.region().area().max(1)).max(1) as u32;
                (view, first..work.next_samples().min(first + most))
            }
        };
        let number = self.script.jobs + 1;
        let items = (view.region().area() * numbers.len() as u64) as u32;
        let mut words = vec![number, side as u32, items, is_new.into()];
        words.extend(program::settings(&view, numbers.start, items, program::SLOTS.0));
        words.append(&mut scene);
        let film = work.dealt.film();
        let start = Instant::now();
        self.script.jobs = number;
        self.script.job = Some(Job { number, side, film, view, numbers, preview, start });
        Some(words)
    }

    /// Whether the samples of the job of a number are still of use.
    pub(crate) fn wants_job(&mut self, number: u32) -> bool {
        self.follow();
        self.script.job.as_ref().is_some_and(|job| job.number == number && self.is_of_film(job))
    }

    fn is_of_film(&self, job: &Job) -> bool {
        self.sides[job.side].as_ref().is_some_and(|work| work.dealt.film() == job.film)
            && self.is_for_script(job.side)
    }

    /// Takes the samples of the job that the script has, or that there are none.
    pub(crate) fn finish_job(&mut self, number: u32, words: &[u32]) {
        self.follow();
        let Some(job) = self.script.job.take_if(|job| job.number == number) else { return };
        let samples = program::samples(words);
        let region = job.view.region();
        let is_whole = samples.len() as u64 == region.area() * job.numbers.len() as u64;
        if !is_whole || !self.is_of_film(&job) {
            return;
        }
        let seconds = job.start.elapsed().as_secs_f64();
        if let Some(fraction) = job.preview {
            let film = LiveFilm::new(FilmSums::new(region.width, region.height));
            add_samples(&film, region, job.numbers, &samples);
            return self.show_preview(job.side, fraction, film.into_sums(), seconds / region.area() as f64);
        }
        let Some(film) = self.sides[job.side].as_ref().map(|work| work.film.clone()) else { return };
        let before = film.samples();
        add_samples(&film, region, job.numbers, &samples);
        self.follow_samples(job.side, before, seconds, Outcome::Finished);
    }

    /// Leaves the script's job, and all pictures from now on, to the processor, for a reason in words.
    pub(crate) fn lose_script(&mut self, reason: &str) {
        (self.script.job, self.script.state) = (None, State::Lost(reason.to_owned()));
        self.recall_loss();
        self.tell_notes();
    }

    /// A device that is lost is still so where it is chosen again.
    pub(super) fn recall_loss(&mut self) {
        if let State::Lost(reason) = &self.script.state
            && self.is_by_script()
        {
            self.device_fault = Some(reason.clone());
        }
    }
}

/// A scene's arrays, each behind its number of words.
fn arrays(mut scene: DeviceScene) -> Vec<u32> {
    if scene.nodes.is_empty() {
        scene.nodes = program::EMPTY_NODE.to_vec();
    }
    let floats = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let arrays =
        [scene.nodes, scene.triangles, floats(&scene.attributes), floats(&scene.tables), scene.images];
    let counts = arrays.iter().map(|array| array.len() as u32).collect();
    std::iter::once(counts).chain(arrays).flatten().collect()
}
