//! Who traces the paths of a page's pictures: the processor, or a device that a page has chosen.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use translucid_render::{Goal, LiveFilm, Outcome, View};

use super::Engine;
use crate::clock::Instant;
use crate::settings::Devices;

/// The first look at something new is finished though there is something newer, or what moves all the time would never be
/// seen; but it takes so long at most.
const MOST_HELD: Duration = Duration::from_secs(1);

impl Engine<'_> {
    /// Opens the device that is wanted; all films begin anew.
    pub(super) fn change_device(&mut self) {
        self.sides = [None, None];
        self.device_name.clone_from(&self.wanted.device);
        let devices = &self.shared.settings.devices;
        let by_script = devices.by_script.as_ref().is_some_and(|device| device.name == self.device_name);
        let is_processor = self.device_name == Devices::PROCESSOR || by_script;
        let opened = (!is_processor).then(|| (self.shared.settings.devices.open)(&self.device_name));
        self.device_fault = opened.as_ref().and_then(|opened| opened.as_ref().err().cloned());
        self.device = opened.and_then(Result::ok);
        #[cfg(any(test, target_family = "wasm"))]
        self.recall_loss();
        self.tell_notes();
    }

    /// Tells pages all notes of the scene, and why the processor traces in place of a device.
    pub(super) fn tell_notes(&self) {
        let mut notes: Vec<String> = self.prepared.notes().iter().map(ToString::to_string).collect();
        let refusals = self.sides.iter().flatten().filter_map(|work| work.refusal.as_ref());
        for reason in self.device_fault.iter().chain(refusals) {
            let note = format!("the processor traces: {reason}");
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        self.shared.set_notes(notes);
    }

    /// Renders into a film until each pixel has so many samples, or a slice of time is over; how long it took \[s\].
    pub(super) fn render(
        &mut self,
        side: usize,
        view: &View,
        film: &LiveFilm,
        samples: u32,
        slice: Option<Duration>,
    ) -> (Outcome, f64) {
        let start = Instant::now();
        let work = self.sides[side].as_mut();
        let (mut on_device, mut refusal) =
            work.map_or((None, None), |work| (work.on_device.take(), work.refusal.clone()));
        let is_over = AtomicBool::new(false);
        // What is not on the screen yet is finished first
        let is_held = self.sides[side].as_ref().is_some_and(|work| work.shown.is_none());
        let held = AtomicBool::new(false);
        let stop = if is_held { &held } else { &self.shared.stop };
        let watch = |_| {
            is_over.store(slice.is_some_and(|slice| start.elapsed() >= slice), Ordering::Relaxed);
            let is_late = start.elapsed() >= MOST_HELD && self.shared.stop.load(Ordering::Relaxed);
            if is_over.load(Ordering::Relaxed) || is_late || self.quit.load(Ordering::Relaxed) {
                stop.store(true, Ordering::Relaxed);
            }
        };
        let goal = Goal { samples: 0..samples, deadline: None };
        let on_processor = || self.prepared.render(view, film, &goal, &watch, stop);
        let outcome = match &mut on_device {
            None => on_processor(),
            Some(device) => {
                let result = device.render(&self.prepared, view, film, &goal, &watch, stop);
                refusal = device.refusal().map(str::to_owned);
                result.unwrap_or_else(|error| {
                    // A device that has failed is not asked again before something changes
                    (refusal, on_device) = (Some(error.to_string()), None);
                    on_processor()
                })
            }
        };
        if let Some(work) = &mut self.sides[side] {
            let is_told = work.refusal == refusal;
            (work.on_device, work.refusal) = (on_device, refusal);
            if !is_told {
                self.tell_notes();
            }
        }
        let outcome = if is_over.into_inner() { Outcome::TimeUp } else { outcome };
        (outcome, start.elapsed().as_secs_f64())
    }
}
