//! Guided runs that end when an error is small enough.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::guided::GuidedWalk;
use super::{Control, Forecast, Goal, TableError};

/// Photons before an error is first looked at: 64 chunks, whose scatter is known to 9 %.
const FIRST_ROUND: u64 = 64 * GuidedWalk::CHUNK;
/// Time after which it is looked at again.
const ROUND_TIME: Duration = Duration::from_secs(5);

impl GuidedWalk {
    /// Walks photons of a seed until a relative standard error is reached, and returns how many were done.
    ///
    /// `error` computes this error from the walk: the greatest of those that matter. It is asked after 2¹⁶ photons
    /// at the earliest, then at most every few seconds, and so is `report` called. As with
    /// [`WhiteTable::run_until`](super::WhiteTable::run_until), stopping as soon as an estimated error is small
    /// favors runs that underestimate it, by a small part of the error.
    ///
    /// # Errors
    /// As for [`run`](Self::run); the walk then holds what was done before.
    pub fn run_until(
        &mut self,
        seed: u64,
        goal: Goal,
        control: &Control,
        error: &dyn Fn(&Self) -> f64,
        report: &mut dyn FnMut(&Self, &Forecast),
    ) -> Result<u64, TableError> {
        let start = Instant::now();
        let mut done = 0;
        loop {
            // Judge what there is
            let enough = self.photons() >= FIRST_ROUND;
            let relative_error = if enough { error(self) } else { f64::INFINITY };
            let wanted = photons_wanted(self.photons(), relative_error / goal.relative_error);
            let photons_left = wanted.min(goal.photons.saturating_sub(done));
            if done > 0 {
                let seconds = start.elapsed().as_secs_f64() * photons_left as f64 / done as f64;
                let time_left = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
                report(self, &Forecast { relative_error, photons_done: done, photons_left, time_left });
            }
            let late = control.deadline.is_some_and(|deadline| Instant::now() >= deadline);
            if photons_left == 0 || late || control.stop.load(Ordering::Relaxed) {
                return Ok(done);
            }

            // Do the rest, but no more than doubles the walk: an error estimated from few chunks is itself far off
            let round = photons_left.min(self.photons().max(FIRST_ROUND));
            let end = Instant::now() + ROUND_TIME;
            let deadline = Some(control.deadline.map_or(end, |deadline| deadline.min(end)));
            let progress = |more: u64| (control.progress)(done + more);
            done += self.run(seed, round, &Control { progress: &progress, deadline, ..*control })?;
        }
    }
}

/// Photons that some photons want in addition, to bring their error down to the goal, of which it is `excess` times.
fn photons_wanted(photons: u64, excess: f64) -> u64 {
    if excess <= 1.0 {
        return 0;
    }
    // 1 % more than the square root law says, or the last rounds would get ever shorter. Casts saturate.
    let factor = 1.01 * excess * excess - 1.0;
    if factor.is_nan() { u64::MAX } else { (factor * photons.max(1) as f64).ceil() as u64 }
}

#[cfg(test)]
mod tests {
    use super::super::{Parameters, Problem};
    use super::*;

    #[test]
    fn run_until_reaches_the_error_or_the_number() {
        let problem = Problem::new(Parameters::default()).unwrap();
        let mut walk = GuidedWalk::new(&problem, 0.9, &[1.0, 3.0]).unwrap();
        let error = |walk: &GuidedWalk| walk.ring(1).relative_error();
        let goal = Goal { relative_error: 1e-3, photons: u64::MAX };
        let mut reports = 0;
        let done = walk.run_until(1, goal, &Control::default(), &error, &mut |_, _| reports += 1).unwrap();
        assert_eq!(walk.photons(), done);
        assert!(error(&walk) <= 1e-3 && error(&walk) > 0.7e-3, "{} after {done}", error(&walk));
        assert!(reports > 1);

        let goal = Goal { relative_error: 1e-9, photons: 100_000 };
        let done = walk.run_until(2, goal, &Control::default(), &error, &mut |_, _| ()).unwrap();
        assert!((100_000..100_000 + 2 * GuidedWalk::CHUNK).contains(&done), "{done}");
    }
}
