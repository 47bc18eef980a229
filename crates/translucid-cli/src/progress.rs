//! Progress of long work on stderr: a bar on a terminal, JSON for programs, a line now and then elsewhere.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use crate::messages;

/// Least time between two lines where there is no terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(5);
/// Least time between two lines in parts of the time passed: an hour has 27 of them.
const LINE_SHARE: u32 = 4;
/// Time between two objects for a program.
const EVENT_INTERVAL: Duration = Duration::from_millis(500);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// Unit that work is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    /// Camera paths of a rendering.
    Samples,
    /// Photons of a walk.
    Photons,
    /// Albedos of a table.
    Albedos,
    /// Parts of work that has no natural unit.
    Parts,
}

impl Unit {
    /// The unit's name for programs.
    fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Photons => "photons",
            Self::Albedos => "albedos",
            Self::Parts => "parts",
        }
    }
}

/// Shows how far a piece of work is.
pub(crate) struct Meter {
    unit: Unit,
    start: Instant,
    /// Units that an earlier run has done.
    done_before: u64,
    /// When the time is up, if it is limited.
    deadline: Option<Instant>,
    /// Name of the piece of work, where there are several.
    name: Option<String>,
    display: Display,
}

enum Display {
    Quiet,
    Bar(ProgressBar),
    Lines { next: Mutex<Instant> },
    Events { next: Mutex<Instant> },
}

impl Meter {
    /// A meter that draws a bar on a terminal and prints lines elsewhere, unless it is to be quiet.
    pub(crate) fn new(unit: Unit) -> Self {
        let display = if messages::is_quiet() {
            Display::Quiet
        } else if messages::is_json() {
            Display::Events { next: Mutex::new(Instant::now()) }
        } else if messages::is_interactive() {
            let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{bar:32} {percent:>3} % {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            Display::Bar(bar)
        } else {
            Display::Lines { next: Mutex::new(Instant::now() + LINE_INTERVAL) }
        };
        Self { unit, start: Instant::now(), done_before: 0, deadline: None, name: None, display }
    }

    /// The meter of work that goes on from what an earlier run has done, and that may end with the time.
    pub(crate) fn between(self, done_before: u64, deadline: Option<Instant>) -> Self {
        Self { done_before, deadline, ..self }
    }

    /// The meter with the name of what is being worked at before everything it shows.
    pub(crate) fn named(self, name: &str) -> Self {
        Self { name: Some(name.to_owned()), ..self }
    }

    /// Shows that `done` of `total` units are done. Any thread may call it at any time.
    pub(crate) fn update(&self, done: u64, total: u64) {
        match &self.display {
            Display::Quiet => {}
            Display::Bar(bar) => {
                let state = self.state(done, total);
                bar.set_position((state.fraction * STEPS as f64) as u64);
                bar.set_message(format!("{}{}", self.title(), state.text(self.unit)));
            }
            Display::Lines { next } => {
                let interval = line_interval(self.start.elapsed());
                if is_time(next, interval) {
                    let state = self.state(done, total);
                    let (title, percent) = (self.title(), 100.0 * state.fraction);
                    messages::line(&format!("{title}{percent:3.0} % {}", state.text(self.unit)));
                }
            }
            Display::Events { next } => {
                if is_time(next, EVENT_INTERVAL) {
                    messages::event("progress", self.fields(done, total));
                }
            }
        }
    }

    /// The state for a program.
    fn fields(&self, done: u64, total: u64) -> Value {
        let state = self.state(done, total);
        let mut fields = json!({
            "unit": self.unit.name(),
            "done": done,
            "total": total,
            "fraction": state.fraction,
            "seconds": state.elapsed,
            "seconds_left": state.left,
        });
        if let Some(name) = &self.name {
            fields["label"] = name.as_str().into();
        }
        fields
    }

    /// The name before everything that is shown.
    fn title(&self) -> String {
        self.name.as_ref().map_or_else(String::new, |name| format!("{name}: "))
    }

    /// Does something that prints without the bar in its way.
    pub(crate) fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        match &self.display {
            Display::Bar(bar) => bar.suspend(print),
            _ => print(),
        }
    }

    /// Takes the bar away, so that messages start on a clean line.
    pub(crate) fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    fn state(&self, done: u64, total: u64) -> State {
        let elapsed = self.start.elapsed().as_secs_f64();
        let rate = done.saturating_sub(self.done_before) as f64 / elapsed.max(1e-3);
        let by_samples = total.saturating_sub(done) as f64 / rate.max(1e-3);
        let by_time = self.deadline.map_or(f64::INFINITY, |deadline| {
            deadline.saturating_duration_since(Instant::now()).as_secs_f64()
        });
        let fraction = if by_time < by_samples {
            elapsed / (elapsed + by_time)
        } else {
            done as f64 / total.max(1) as f64
        };
        State { fraction: fraction.clamp(0.0, 1.0), rate, elapsed, left: by_samples.min(by_time) }
    }
}

/// Whether something is to be shown; if so, the next time is later by the interval.
fn is_time(next: &Mutex<Instant>, interval: Duration) -> bool {
    // Another thread that is printing has just said the same.
    let Ok(mut next) = next.try_lock() else { return false };
    let now = Instant::now();
    let is_time = now >= *next;
    if is_time {
        *next = now + interval;
    }
    is_time
}

/// Time from one line to the next, some time after the start.
fn line_interval(elapsed: Duration) -> Duration {
    LINE_INTERVAL.max(elapsed / LINE_SHARE)
}

/// State of the work, as it is shown.
struct State {
    /// Part of the work done, in [0, 1].
    fraction: f64,
    /// Units per second.
    rate: f64,
    /// Seconds since the start.
    elapsed: f64,
    /// Seconds that remain, as far as one can tell.
    left: f64,
}

impl State {
    fn text(&self, unit: Unit) -> String {
        let rate = match unit {
            Unit::Samples => format!("{:.2} M samples/s, ", self.rate * 1e-6),
            Unit::Photons => format!("{:.2} M photons/s, ", self.rate * 1e-6),
            Unit::Albedos => format!("{:.1} albedos/s, ", self.rate),
            Unit::Parts => String::new(),
        };
        format!("{rate}{} passed, {} left", duration(self.elapsed), duration(self.left))
    }
}

/// A duration in the units that one would say it in.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() || s >= 360_000.0 => String::from("many hours"),
        s if s >= 3600.0 => format!("{} h {:02} min", s as u64 / 3600, s as u64 % 3600 / 60),
        s if s >= 100.0 => format!("{} min {:02} s", s as u64 / 60, s as u64 % 60),
        s if s >= 10.0 => format!("{s:.0} s"),
        s => format!("{s:.1} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duration_reads_well() {
        for (seconds, text) in [
            (0.04, "0.0 s"),
            (9.94, "9.9 s"),
            (42.0, "42 s"),
            (130.0, "2 min 10 s"),
            (7260.0, "2 h 01 min"),
            (f64::INFINITY, "many hours"),
            (f64::NAN, "many hours"),
        ] {
            assert_eq!(duration(seconds), text);
        }
    }

    #[test]
    fn lines_come_soon_and_then_ever_more_rarely() {
        // Lines of work that takes a minute, five, and an hour
        for (minutes, expected) in [(1, 8), (5, 16), (60, 27)] {
            let (mut time, mut lines) = (LINE_INTERVAL, 0);
            while time < Duration::from_secs(60 * minutes) {
                lines += 1;
                time += line_interval(time);
            }
            assert_eq!(lines, expected, "{minutes} minutes");
        }
    }

    #[test]
    fn state_counts_only_what_this_run_did() {
        let meter = Meter::new(Unit::Samples).between(500, None);
        std::thread::sleep(Duration::from_millis(20));
        let state = meter.state(750, 1000);
        assert_eq!(state.fraction, 0.75);
        // 250 paths took as long as the 250 that remain will.
        assert!((state.left / state.elapsed - 1.0).abs() < 1e-9);
    }

    #[test]
    fn state_goes_by_the_clock_when_that_ends_first() {
        let meter = Meter::new(Unit::Samples).between(0, Some(Instant::now() + Duration::from_secs(100)));
        let state = meter.state(1, u64::MAX);
        assert!(state.fraction < 0.01 && (99.0..=100.0).contains(&state.left));
    }
}
