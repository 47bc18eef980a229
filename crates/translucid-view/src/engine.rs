//! The renderer's thread: always at work on what the pages want to see next.
//!
//! ```text
//! loop:
//!     take what is wanted; edit the prepared scene by what differs, and no more
//!     while something moves: one sample a pixel, at the fraction of the resolution that is soon enough
//!     else: samples, side by side in turns where two are compared
//!     show what there is
//! ```
//!
//! Anything that a page changes interrupts it within the time of a path. Both sides share one prepared scene, which is
//! edited back and forth: their materials cost less than a millisecond, another hierarchy would cost its memory.

#[cfg(any(test, target_family = "wasm"))]
mod crew;
#[cfg(test)]
mod device_tests;
mod devices;
mod header;
#[cfg(any(test, target_family = "wasm"))]
mod script;
#[cfg(test)]
mod script_tests;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::{Value, json};
use translucid_laboratory::picture as laboratory;
use translucid_load::Orientation;
use translucid_render::device::TracingDevice;
use translucid_render::{
    Edit, FilmLayer, FilmSums, Fraction, LiveFilm, OnDevice, Outcome, PointCloud, PointPass, PointProgress,
    PreparedScene, View, available_memory,
};
use translucid_scene::{Film, SubsurfaceMethod};

use crate::clock::Instant;
use crate::look::Look;
use crate::message::Side;
use crate::shared::{Frame, Shared, SideFilm};
use crate::smooth::{PREVIEW_LEVELS, SmoothLight, levels};
use crate::studio::{MOTION_ENDS, Wanted};
use crate::view::{Light, Shown, comparable, comparison_codes, layer_codes, thinned};
use header::Header;

/// Time for a picture while something moves \[s\].
const MOTION_BUDGET: f64 = 0.03;
/// Time for a finer picture once nothing new has come \[s\].
const PAUSE_BUDGET: f64 = 0.15;
/// A look at a quarter of the resolution comes before samples that take longer than this, and one at half of it before those
/// that take four times as long \[s\].
const SLOW_SAMPLE: f64 = 0.4;
/// Samples between two pictures take about so long at most \[s\].
const SLICE: f64 = 1.0;
/// Least and longest time between two pictures of a film that grows.
const LEAST_PAUSE: Duration = Duration::from_millis(250);
const LONGEST_PAUSE: Duration = Duration::from_secs(5);
/// Least time between two pictures over the time that one takes.
const PAUSE_PER_FRAME: u32 = 50;
/// The same of denoised pictures.
const PAUSE_PER_DENOISED_FRAME: u32 = 8;
/// Least time between two reports while samples are added.
const REPORT_PAUSE: Duration = Duration::from_millis(200);
/// Time of a path before anything is known \[s\].
const FIRST_GUESS: f64 = 3e-6;
/// How often a waiting renderer looks whether the program ends.
#[cfg(not(target_family = "wasm"))]
const NAP: Duration = Duration::from_millis(100);

/// What is known and done of one side.
struct SideWork {
    look: Arc<Look>,
    view: View,
    film: Arc<LiveFilm>,
    /// Time of its samples \[s\].
    seconds: f64,
    /// The part of it since all pixels got a sample last \[s\].
    unfinished_seconds: f64,
    /// One sample a pixel at a fraction of the resolution, until the film has samples.
    preview: Option<(Fraction, FilmSums)>,
    /// Some of the film's pixels as they were at about half of its samples, for an estimate of its noise.
    half: Option<(laboratory::Picture, u32)>,
    noise: Option<f64>,
    points: Option<PointCloud>,
    /// Who traces paths in the processor's place.
    on_device: Option<OnDevice>,
    /// Why it does not.
    refusal: Option<String>,
    /// Whether the script's device has the scene, or cannot take it.
    #[cfg(any(test, target_family = "wasm"))]
    on_script: script::Scene,
    /// What other workers were given of it to trace.
    #[cfg(any(test, target_family = "wasm"))]
    dealt: crew::Dealt,
    /// Time of a path \[s\].
    cost: f64,
    shown: Option<LastShown>,
}

/// When a side was shown last, with how many samples, and in which version.
#[derive(Clone, Copy)]
struct LastShown {
    at: Instant,
    samples: u32,
    version: u32,
}

/// The next thing to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Work {
    Preview(usize, Fraction),
    Points(usize),
    Samples(usize),
    Wait(Duration),
    /// Until something changes; in a word.
    Rest(&'static str),
}

pub(crate) struct Engine<'a> {
    shared: &'a Shared,
    prepared: PreparedScene,
    /// The look that the prepared scene has now.
    look: Arc<Look>,
    images: usize,
    /// How the bare mesh is turned, if the scene is one.
    orientation: Option<Orientation>,
    /// The device that traces in the processor's place, and its name.
    device: Option<Arc<dyn TracingDevice>>,
    device_name: String,
    /// Why it cannot be used.
    device_fault: Option<String>,
    /// What a page's script traces.
    #[cfg(any(test, target_family = "wasm"))]
    script: script::Script,
    /// Films that were begun.
    #[cfg(any(test, target_family = "wasm"))]
    films: u32,
    wanted: Wanted,
    sides: [Option<SideWork>; 2],
    difference: Value,
    frame_number: u32,
    /// Time that measuring and showing took last.
    frame_time: Duration,
    reported: Instant,
    /// What was done to the picture that was shown last, in words.
    shown_as: &'static str,
    rested: Option<u32>,
    quit: &'a AtomicBool,
}

impl<'a> Engine<'a> {
    pub(crate) fn new(shared: &'a Shared, prepared: PreparedScene, quit: &'a AtomicBool) -> Self {
        let look = Arc::new(Look::of(prepared.scene()));
        let wanted = shared.take_wanted();
        let mut engine = Self {
            shared,
            prepared,
            look,
            images: 0,
            orientation: wanted.orientation,
            device: shared.settings.devices.first.clone(),
            device_name: wanted.device.clone(),
            device_fault: None,
            #[cfg(any(test, target_family = "wasm"))]
            script: script::Script::default(),
            #[cfg(any(test, target_family = "wasm"))]
            films: 0,
            wanted: wanted.clone(),
            sides: [None, None],
            difference: Value::Null,
            frame_number: 0,
            frame_time: Duration::ZERO,
            reported: Instant::now(),
            shown_as: "",
            rested: None,
            quit,
        };
        engine.renew(wanted);
        engine
    }

    /// Renders on the current rayon pool until the program is to end.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn run(&mut self) {
        while !self.quit.load(Ordering::Relaxed) {
            if let Some(time) = self.step(None) {
                self.shared.wait(self.wanted.version, time.min(NAP));
            }
        }
    }

    /// Does what comes next: how long nothing is left to do unless something changes; none where there is more.
    ///
    /// `slice` ends the addition of samples, for callers that have one thread for this and for what pages say. What was
    /// traced is kept for the next step.
    pub(crate) fn step(&mut self, slice: Option<Duration>) -> Option<Duration> {
        self.follow();
        match self.next_work() {
            #[cfg(any(test, target_family = "wasm"))]
            Work::Preview(side, _) | Work::Samples(side) if self.is_for_script(side) => {
                return Some(script::PATIENCE);
            }
            Work::Preview(side, fraction) => self.preview(side, fraction),
            Work::Points(side) => self.make_points(side),
            Work::Samples(side) => self.sample(side, slice),
            Work::Wait(time) => return Some(time),
            Work::Rest(phase) => {
                if self.rested != Some(self.wanted.version) {
                    self.rested = Some(self.wanted.version);
                    self.measure();
                    self.show_version();
                    if self.wanted.shown == Shown::Flip {
                        self.show_comparison(Shown::Flip);
                    }
                    self.report(phase, "");
                }
                return Some(Duration::MAX);
            }
        }
        None
    }

    /// Takes over what is wanted, if that has changed.
    fn follow(&mut self) {
        if self.shared.stop.load(Ordering::Relaxed) {
            let wanted = self.shared.take_wanted();
            self.renew(wanted);
        }
    }

    /// Takes over what is wanted: films that show something else begin anew.
    fn renew(&mut self, wanted: Wanted) {
        let before = std::mem::replace(&mut self.wanted, wanted);
        let same_display = before.film == self.wanted.film
            && before.shown == self.wanted.shown
            && before.is_denoised == self.wanted.is_denoised;
        self.bring_images();
        self.turn();
        if self.wanted.device != self.device_name {
            self.change_device();
        }
        for side in 0..2 {
            let Some(look) = self.wanted.looks[side].clone() else {
                self.sides[side] = None;
                continue;
            };
            let old = self.sides[side].take();
            let is_same = old.as_ref().is_some_and(|old| self.goes_on(old, &look));
            self.sides[side] = match old {
                Some(old) if is_same => Some(SideWork { look, ..old }),
                old => self.begin(old, look),
            };
        }
        self.share_films();
        let are_whole = self.sides.iter().flatten().all(|side| side.shown.is_some());
        if !same_display && are_whole || before.looks[1].is_some() != self.wanted.looks[1].is_some() {
            self.measure();
            self.show_all();
        }
    }

    /// Whether a side's film is still one of what is wanted.
    fn goes_on(&self, old: &SideWork, look: &Look) -> bool {
        !old.look.differs(look)
            && *old.view.camera() == self.wanted.camera
            && same_pixels(old.view.film(), &self.wanted.film)
            && may_become(&old.film.sums(), look.integrator.samples_per_pixel)
    }

    /// A side without samples. It knows what a path costs, and its points, from the one before.
    fn begin(&mut self, old: Option<SideWork>, look: Arc<Look>) -> Option<SideWork> {
        let Wanted { camera, film, .. } = self.wanted;
        let seed = look.integrator.seed;
        let reusable = old.as_ref().map(|old| &old.view);
        let reusable = reusable.filter(|view| view.seed() == seed && same_pixels(view.film(), &film));
        let view = match reusable {
            Some(view) => view.with_camera(camera),
            None => View::new(camera, film, seed),
        };
        // The studio has checked camera and film
        let view = view.ok()?;
        let region = view.region();
        let other_cost = self.sides.iter().flatten().map(|side| side.cost).next();
        let cost = old.as_ref().map(|old| old.cost).or(other_cost).unwrap_or(FIRST_GUESS);
        let old = old.filter(|old| !old.look.differs(&look));
        // The filter belongs to what devices have of a scene
        let has_same_filter = old.as_ref().is_some_and(|old| same_filter(old.view.film(), &film));
        #[cfg(any(test, target_family = "wasm"))]
        let on_script = old.as_ref().filter(|_| has_same_filter).map(|old| old.on_script).unwrap_or_default();
        let (points, on_device, refusal) =
            old.map_or((None, None, None), |old| (old.points, old.on_device, old.refusal));
        let on_device = on_device.filter(|_| has_same_filter);
        let points = points.filter(|points| self.prepared.points_serve(points, &view));
        let on_device = on_device.or_else(|| self.device.clone().map(OnDevice::preferred));
        #[cfg(any(test, target_family = "wasm"))]
        let dealt = {
            self.films += 1;
            crew::Dealt::nothing(self.films, view.block_count(0))
        };
        Some(SideWork {
            look,
            #[cfg(any(test, target_family = "wasm"))]
            dealt,
            view,
            film: Arc::new(LiveFilm::new(FilmSums::new(region.width, region.height))),
            seconds: 0.0,
            unfinished_seconds: 0.0,
            preview: None,
            half: None,
            noise: None,
            points,
            on_device,
            refusal,
            #[cfg(any(test, target_family = "wasm"))]
            on_script,
            cost,
            shown: None,
        })
    }

    /// Gives the prepared scene the images that pages have brought since.
    fn bring_images(&mut self) {
        let new: Vec<_> = self.wanted.images.iter().skip(self.images).map(Arc::clone).collect();
        self.images += new.len();
        new.into_iter().for_each(|image| self.edit(Edit::AddImage(image)));
    }

    /// Turns the bare mesh as it is wanted: everything is traced anew.
    fn turn(&mut self) {
        if self.wanted.orientation == self.orientation {
            return;
        }
        self.orientation = self.wanted.orientation;
        let turned = self.orientation.map(|orientation| self.shared.take_turned(orientation));
        match turned {
            Some(Ok(scene)) => {
                self.edit(Edit::Objects(scene.objects));
                self.shared.set_picker(self.prepared.picker());
                self.tell_notes();
            }
            Some(Err(error)) => self.shared.set_notes(vec![format!("the mesh is not turned: {error}")]),
            None => {}
        }
        self.sides = [None, None];
    }

    fn edit(&mut self, edit: Edit) {
        if let Err(error) = self.prepared.edit(edit) {
            // The studio has checked it: a defect, which must not pass in silence
            self.shared.set_notes(vec![format!("a defect: an edit was refused: {error}")]);
        }
    }

    /// Gives the prepared scene the look and the points of a side.
    fn prepare(&mut self, side: usize) {
        let Some(work) = &self.sides[side] else { return };
        let look = Arc::clone(&work.look);
        let edits = self.look.edits_to(&look);
        if !edits.is_empty() {
            edits.into_iter().for_each(|edit| self.edit(edit));
            self.tell_notes();
        }
        self.look = look;
        if self.prepared.wants_points()
            && let Some(points) = self.sides[side].as_ref().and_then(|side| side.points.as_ref())
        {
            self.prepared.set_points(points);
        }
    }

    fn next_work(&self) -> Work {
        let order = if self.wanted.active == Side::A { [0, 1] } else { [1, 0] };
        let sides =
            || order.into_iter().filter_map(|index| self.sides[index].as_ref().map(|side| (index, side)));

        // Everything is shown at once, however coarse
        if let Some((index, side)) = sides().find(|(_, side)| side.shown.is_none()) {
            return match self.fraction_within(MOTION_BUDGET) {
                // Samples that are taken without points would stay in the film
                Fraction::Whole if !side.wants_points() => Work::Samples(index),
                fraction => Work::Preview(index, fraction),
            };
        }
        if self.wanted.is_paused {
            return Work::Rest("paused");
        }

        // What moves waits for more to come, and becomes finer meanwhile
        let coarse = || sides().filter_map(|(index, side)| Some((index, side.preview.as_ref()?.0)));
        let still_moving = self.wanted.moving.and_then(|last| MOTION_ENDS.checked_sub(last.elapsed()));
        if let Some(left) = still_moving {
            let best = self.fraction_within(PAUSE_BUDGET);
            let finer = coarse().find(|(_, fraction)| best.divisor() < fraction.divisor());
            return match finer {
                Some((index, _)) if best != Fraction::Whole => Work::Preview(index, best),
                _ => Work::Wait(left),
            };
        }

        // Where a sample takes long, better looks come first: a sixteenth of its time, then a quarter
        let whole = self.seconds_of(Fraction::Whole);
        let better = |fraction| match fraction {
            Fraction::Eighth if whole > SLOW_SAMPLE => Some(Fraction::Quarter),
            Fraction::Quarter if whole > 4.0 * SLOW_SAMPLE => Some(Fraction::Half),
            _ => None,
        };
        if let Some((index, fraction)) =
            coarse().find_map(|(index, fraction)| Some((index, better(fraction)?)))
        {
            return Work::Preview(index, fraction);
        }
        let unfinished = sides().filter(|(_, side)| side.film.samples() < side.goal());
        match unfinished.min_by_key(|(_, side)| side.film.samples()) {
            Some((index, side)) if side.wants_points() => Work::Points(index),
            Some((index, _)) => Work::Samples(index),
            None => Work::Rest("done"),
        }
    }

    /// Time that one sample of each pixel takes on all sides together \[s\].
    fn seconds_of(&self, fraction: Fraction) -> f64 {
        let sides = self.sides.iter().flatten();
        let seconds = sides.map(|side| side.cost * side.view.at(fraction).region().area() as f64);
        seconds.sum()
    }

    /// The finest resolution at which one sample of each pixel is there within a time.
    fn fraction_within(&self, seconds: f64) -> Fraction {
        let finest = [Fraction::Whole, Fraction::Half, Fraction::Quarter];
        let soon = finest.into_iter().find(|fraction| self.seconds_of(*fraction) <= seconds);
        soon.unwrap_or(Fraction::Eighth)
    }

    fn preview(&mut self, side: usize, fraction: Fraction) {
        self.prepare(side);
        let Some(work) = &self.sides[side] else { return };
        let view = work.view.at(fraction);
        let region = view.region();
        let film = LiveFilm::new(FilmSums::new(region.width, region.height));
        let (outcome, seconds) = self.render(side, &view, &film, 1, None);
        if outcome == Outcome::Finished {
            self.show_preview(side, fraction, film.into_sums(), seconds / region.area() as f64);
        }
    }

    /// Shows one sample a pixel at a fraction of the resolution, whose paths took so long each \[s\].
    fn show_preview(&mut self, side: usize, fraction: Fraction, sums: FilmSums, cost: f64) {
        let Some(work) = &mut self.sides[side] else { return };
        work.cost = cost;
        work.preview = Some((fraction, sums));
        self.show(side);
        self.report("preview", "");
    }

    fn make_points(&mut self, side: usize) {
        self.prepare(side);
        let allowed = u64::from(self.look.integrator.point_memory) << 20;
        let memory = available_memory().map_or(allowed, |available| allowed.min(available));
        self.report("points", "points all over the surface");
        let reported = Mutex::new(self.reported);
        let watch = |progress: PointProgress| {
            if self.quit.load(Ordering::Relaxed) {
                self.shared.stop.store(true, Ordering::Relaxed);
            }
            if let Ok(mut reported) = reported.try_lock()
                && reported.elapsed() > REPORT_PAUSE
            {
                *reported = Instant::now();
                self.tell("points", &words_of(progress));
            }
        };
        let Some(view) = self.sides[side].as_ref().map(|work| work.view.clone()) else { return };
        match self.prepared.make_points(&view, memory, &watch, &self.shared.stop) {
            Ok(Some(points)) => {
                if let Some(work) = &mut self.sides[side] {
                    work.points = Some(points);
                }
            }
            Ok(None) => {}
            Err(error) => {
                // Probes find the light then, as the note says
                self.shared.set_notes(vec![error.to_string()]);
                if let Some(work) = &mut self.sides[side] {
                    let mut look = (*work.look).clone();
                    look.integrator.subsurface_method = SubsurfaceMethod::RayTraced;
                    work.look = Arc::new(look);
                }
            }
        }
    }

    fn sample(&mut self, side: usize, slice: Option<Duration>) {
        self.prepare(side);
        let Some(work) = &self.sides[side] else { return };
        let (view, film) = (work.view.clone(), Arc::clone(&work.film));
        let (before, next) = (film.samples(), work.next_samples());
        let (outcome, seconds) = self.render(side, &view, &film, next, slice);
        self.follow_samples(side, before, seconds, outcome);
    }

    /// Shows and tells what has become of a film that had fewer samples, which took so long \[s\].
    fn follow_samples(&mut self, side: usize, before: u32, seconds: f64, outcome: Outcome) {
        let Some(work) = &mut self.sides[side] else { return };
        let film = Arc::clone(&work.film);
        work.seconds += seconds;
        work.unfinished_seconds += seconds;
        let samples = film.samples();
        if samples > before {
            let paths = u64::from(samples - before) * work.view.region().area();
            work.cost = std::mem::take(&mut work.unfinished_seconds) / paths as f64;
            work.preview = None;
        }
        self.share_films();
        let Some(work) = &mut self.sides[side] else { return };
        if samples == before || outcome == Outcome::Interrupted && samples < work.goal() {
            return;
        }
        if samples.is_power_of_two() && samples < work.goal() {
            work.half = Some((thinned(&film.sums()), samples));
        }
        let (is_last, shown) = (samples >= work.goal(), work.shown);
        if is_last || shown.is_none_or(|last| self.is_due(last, samples)) {
            let start = Instant::now();
            self.measure();
            self.show(side);
            self.frame_time = start.elapsed();
        }
        if self.reported.elapsed() > REPORT_PAUSE {
            self.report("rendering", self.shown_as);
        }
    }

    /// Whether a film with so many samples is worth another picture: one whose noise is less by a step that is seen, and
    /// that does not hold up the samples.
    fn is_due(&self, last: LastShown, samples: u32) -> bool {
        let pause = last.at.elapsed();
        let per_frame = if self.denoises() { PAUSE_PER_DENOISED_FRAME } else { PAUSE_PER_FRAME };
        let is_finer = samples as f32 >= std::f32::consts::SQRT_2 * last.samples as f32;
        last.samples == 0
            || pause > LEAST_PAUSE.max(per_frame * self.frame_time) && (is_finer || pause > LONGEST_PAUSE)
    }

    /// Estimates noise and difference.
    fn measure(&mut self) {
        let display = self.wanted.film;
        let mut halves = Vec::new();
        for work in self.sides.iter_mut().flatten() {
            let samples = work.film.samples();
            if let Some((half, count)) = work.half.as_ref().filter(|(_, count)| *count < samples) {
                let (picture, counts) = (thinned(&work.film.sums()), [*count, samples]);
                let noise = laboratory::relative_noise([&picture, half], counts, &picture);
                work.noise = noise.is_finite().then_some(noise);
                halves.push((picture, half, counts));
            }
        }
        // Both have the same random numbers, so that much of their noise is the same
        let noise = match &halves[..] {
            [(a, a_half, counts), (b, b_half, others)] if counts == others => {
                Some(laboratory::relative_noise_of_difference([a, a_half], [b, b_half], *counts))
            }
            _ => None,
        };
        self.difference = Value::Null;
        if let [Some(a), Some(b)] = &self.sides
            && a.film.samples().min(b.film.samples()) > 0
        {
            let [picture, reference] = [a, b].map(|side| comparable(&side.film.sums(), &display));
            self.difference = json!({
                "relative_mse": laboratory::relative_mse(&picture, &reference),
                "noise": noise.filter(|noise| noise.is_finite()),
                "mean_flip": null,
            });
        }
    }

    /// Whether the noise is taken out of pictures that are not finished: only for the eye, and not in comparisons.
    fn cleans(&self) -> bool {
        let Wanted { shown, is_denoised, looks, .. } = &self.wanted;
        *shown == Shown::Layer(FilmLayer::Radiance) && *is_denoised && looks[1].is_none()
    }

    /// Whether a denoiser does that, which takes too long while something moves.
    fn denoises(&self) -> bool {
        self.cleans() && self.wanted.moving.is_none() && self.shared.denoiser.is_some()
    }

    /// Sends what there is of a side, and the map of the comparison if that is looked at.
    fn show(&mut self, side: usize) {
        let (shown, cleans, denoises) = (self.wanted.shown, self.cleans(), self.denoises());
        let Some(work) = &mut self.sides[side] else { return };
        let layer = if let Shown::Layer(layer) = shown { layer } else { FilmLayer::Radiance };
        let whole = work.film.sums();
        let (fraction, sums) = match &work.preview {
            Some((fraction, sums)) => (*fraction, sums),
            None => (Fraction::Whole, &*whole),
        };
        let samples = whole.samples();
        let is_last = samples >= work.goal();
        if side == Side::A as usize
            && let Some(exposure) = self.shared.meter(sums, is_last)
        {
            self.wanted.film.exposure = exposure;
        }
        let cleans = cleans && !is_last && sums.samples() > 0;
        let denoiser = self.shared.denoiser.as_ref().filter(|_| denoises && cleans);
        // Where denoising fails, the picture is shown as without a denoiser
        let denoised = denoiser.and_then(|denoiser| sums.denoise(denoiser, 0).ok());
        let levels = if fraction == Fraction::Whole { levels(samples) } else { Some(PREVIEW_LEVELS) };
        let (light, shown_as) = match (denoised, levels.filter(|_| cleans)) {
            (Some(denoised), _) => (Light::Denoised(denoised), "shown denoised"),
            (None, Some(levels)) => (Light::Smoothed(SmoothLight::new(sums, levels)), "shown smoothed"),
            (None, None) => (Light::AsRendered, ""),
        };
        self.shown_as = shown_as;
        let codes = layer_codes(sums, layer, &self.wanted.film, light);
        let header = Header {
            kind: side as u8,
            divisor: fraction.divisor() as u8,
            is_last,
            number: self.frame_number + 1,
            version: self.wanted.version,
            size: [sums.width, sums.height],
            samples: sums.samples(),
            seconds: work.seconds as f32,
        };
        drop(whole);
        work.shown = Some(LastShown { at: Instant::now(), samples, version: self.wanted.version });
        self.frame_number += 1;
        let frame = Frame { number: header.number, bytes: header.before(&codes) };
        self.shared.frames[side].send_replace(Some(frame));
        if shown.compares() {
            self.show_comparison(shown);
        }
    }

    fn show_comparison(&mut self, shown: Shown) {
        let [Some(a), Some(b)] = &self.sides else { return };
        let sums = |side: &SideWork| match &side.preview {
            Some((fraction, sums)) => (*fraction, comparable(sums, &self.wanted.film)),
            None => (Fraction::Whole, comparable(&side.film.sums(), &self.wanted.film)),
        };
        let [(fraction, picture), (other, reference)] = [a, b].map(sums);
        if fraction != other {
            return;
        }
        let Some((codes, mean)) = comparison_codes(shown, [&picture, &reference]) else { return };
        if let (Some(mean), Some(object)) = (mean, self.difference.as_object_mut()) {
            object.insert("mean_flip".to_owned(), json!(mean));
        }
        self.frame_number += 1;
        let header = Header {
            kind: 2,
            divisor: fraction.divisor() as u8,
            is_last: [a, b].iter().all(|side| side.film.samples() >= side.goal()),
            number: self.frame_number,
            version: self.wanted.version,
            size: [picture.width() as u32, picture.height() as u32],
            samples: a.film.samples().min(b.film.samples()),
            seconds: (a.seconds + b.seconds) as f32,
        };
        let frame = Frame { number: header.number, bytes: header.before(&codes) };
        self.shared.frames[2].send_replace(Some(frame));
    }

    /// What changes no pixel has a picture of its version, too: pages wait for it.
    fn show_version(&mut self) {
        let version = self.wanted.version;
        let is_shown = |side: &SideWork| side.shown.is_some_and(|last| last.version == version);
        if !self.sides.iter().flatten().all(is_shown) {
            self.show_all();
        }
    }

    fn show_all(&mut self) {
        (0..2).for_each(|side| self.show(side));
        for (side, work) in self.sides.iter().enumerate() {
            if work.is_none() {
                self.shared.frames[side].send_replace(None);
            }
        }
        if !self.wanted.shown.compares() {
            self.shared.frames[2].send_replace(None);
        }
    }

    fn share_films(&self) {
        let film = |work: &SideWork| SideFilm {
            view: work.view.clone(),
            film: Arc::clone(&work.film),
            seconds: work.seconds,
        };
        self.shared.set_films([0, 1].map(|side| self.sides[side].as_ref().map(film)));
    }

    fn report(&mut self, phase: &str, detail: &str) {
        self.reported = Instant::now();
        self.tell(phase, detail);
    }

    fn tell(&self, phase: &str, detail: &str) {
        let side = |index: usize| {
            let work = self.sides[index].as_ref()?;
            Some(json!({
                "samples": work.film.samples(),
                "goal": work.goal(),
                "seconds": work.seconds,
                "samples_per_second": 1.0 / work.cost,
                "noise": work.noise,
            }))
        };
        let status = json!({
            "type": "status",
            "version": self.wanted.version,
            "phase": phase,
            "detail": detail,
            "sides": { "a": side(0), "b": side(1) },
            "difference": self.difference,
        });
        self.shared.status.send_replace(status.to_string().into());
    }
}

impl SideWork {
    /// Samples that each pixel shall have.
    fn goal(&self) -> u32 {
        self.look.integrator.samples_per_pixel
    }

    fn wants_points(&self) -> bool {
        self.look.integrator.subsurface_method == SubsurfaceMethod::PointBased && self.points.is_none()
    }

    /// Samples that each pixel shall have when the next picture is due: at most half as many more, so that there is always
    /// something new to see.
    fn next_samples(&self) -> u32 {
        let samples = self.film.samples();
        let soon = SLICE / (self.cost * self.view.region().area() as f64);
        let more = (soon as u32).clamp(1, (samples / 2).clamp(1, 16));
        // Every power of two is met, for the estimate of noise
        samples.saturating_add(more).min((samples + 1).next_power_of_two()).min(self.goal())
    }
}

/// Whether pixels are filtered alike.
fn same_filter(a: &Film, b: &Film) -> bool {
    (a.filter, a.filter_radius) == (b.filter, b.filter_radius)
}

/// Whether no pixel has more than so many samples, which could not be taken away again: where a rendering was interrupted,
/// some tiles have more than others.
fn may_become(film: &FilmSums, samples: u32) -> bool {
    film.tiles.iter().all(|tile| tile.samples() <= samples)
}

fn words_of(PointProgress { pass, part, .. }: PointProgress) -> String {
    let percent = (100.0 * part) as u32;
    match pass {
        PointPass::Points => format!("points all over the surface, {percent} %"),
        PointPass::Irradiance => format!("light at the points, {percent} %"),
    }
}

/// Whether films have the same pixels, however they are displayed.
fn same_pixels(a: &Film, b: &Film) -> bool {
    let pixels = |film: &Film| (film.width, film.height, film.filter, film.filter_radius);
    pixels(a) == pixels(b)
}

#[cfg(test)]
mod tests {
    use translucid_render::SampleRanges;

    use super::*;

    #[test]
    fn interrupted_film_becomes_none_of_fewer_samples() {
        let mut film = FilmSums::new(64, 64);
        assert!(film.tiles.len() > 1 && may_become(&film, 1));
        let first = |count| SampleRanges::from(0..count);
        film.tiles.iter_mut().for_each(|tile| tile.taken = first(4));
        film.tiles[1].taken = first(5);
        assert!(film.samples() == 4 && !may_become(&film, 4) && may_become(&film, 5));
    }
}
