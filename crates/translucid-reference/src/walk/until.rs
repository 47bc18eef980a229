//! Runs that end when an error is small enough.

use std::time::{Duration, Instant};

use super::{Control, Forecast, Goal, TableError};

/// What photons can be added to.
pub(super) trait Extensible {
    /// Photons that it holds.
    fn photons(&self) -> u64;

    /// Adds photons of a seed, and returns how many: fewer where the run was stopped.
    fn add_photons(&mut self, seed: u64, photons: u64, control: &Control) -> Result<u64, TableError>;
}

/// Photons before an error is first looked at.
const FIRST_ROUND: u64 = 1 << 16;
/// Time after which it is looked at again.
const ROUND_TIME: Duration = Duration::from_secs(5);

/// Adds photons until `error` is small enough, and returns how many.
pub(super) fn run_until<W: Extensible>(
    walk: &mut W,
    seed: u64,
    goal: Goal,
    control: &Control,
    error: &dyn Fn(&W) -> f64,
    report: &mut dyn FnMut(&W, &Forecast),
) -> Result<u64, TableError> {
    let start = Instant::now();
    let mut done = 0;
    loop {
        // Judge what there is
        let enough = walk.photons() >= FIRST_ROUND;
        let relative_error = if enough { error(walk) } else { f64::INFINITY };
        let wanted = photons_wanted(walk.photons(), relative_error, goal.relative_error);
        let photons_left = wanted.min(goal.photons.saturating_sub(done));
        if done > 0 {
            let seconds = start.elapsed().as_secs_f64() * photons_left as f64 / done as f64;
            let time_left = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
            report(walk, &Forecast { relative_error, photons_done: done, photons_left, time_left });
        }
        if photons_left == 0 || control.stops() {
            return Ok(done);
        }

        // Do the rest, but no more than doubles what there is: an error estimated from few photons is itself far off
        let round = photons_left.min(walk.photons().max(FIRST_ROUND));
        let end = Instant::now() + ROUND_TIME;
        let deadline = Some(control.deadline.map_or(end, |deadline| deadline.min(end)));
        let progress = |more: u64| (control.progress)(done + more);
        done += walk.add_photons(seed, round, &Control { progress: &progress, deadline, ..*control })?;
    }
}

/// Photons that a table of some photons wants in addition, to bring its relative error down to a goal.
fn photons_wanted(photons: u64, relative_error: f64, goal: f64) -> u64 {
    if relative_error <= goal {
        return 0;
    }
    // 1 % more than the square root law says, or the last rounds would get ever shorter. Casts saturate.
    let factor = 1.01 * (relative_error / goal).powi(2) - 1.0;
    if factor.is_nan() { u64::MAX } else { (factor * photons.max(1) as f64).ceil() as u64 }
}
