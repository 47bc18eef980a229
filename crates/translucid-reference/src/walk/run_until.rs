//! Runs that end when an error is small enough.

use std::time::{Duration, Instant};

use super::run::Control;
use super::table_error::TableError;
use super::white_table::WhiteTable;

/// Goal of [`WhiteTable::run_until`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Relative standard error to be reached.
    pub relative_error: f64,
    /// Greatest number of photons to run.
    pub photons: u64,
}

/// Forecast by [`WhiteTable::run_until`] of the rest of its run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Relative standard error so far; infinite if something has not been seen yet.
    pub relative_error: f64,
    /// Photons done since the run started.
    pub photons_done: u64,
    /// Photons still to do, as the error falls with the square root of their number.
    pub photons_left: u64,
    /// Time for these at the pace so far.
    pub time_left: Duration,
}

/// Photons before an error is first looked at.
const FIRST_ROUND: u64 = 1 << 16;
/// Time after which it is looked at again.
const ROUND_TIME: Duration = Duration::from_secs(5);

impl WhiteTable {
    /// Walks photons of a seed until a relative standard error is reached, and returns how many were done.
    ///
    /// `error` computes this error from the table: the greatest of those that matter. It is asked after 2¹⁶ photons
    /// at the earliest, then at most every few seconds, and so is `report` called, with the table as it is by then
    /// (to show the time left, or to save the table).
    ///
    /// Stopping as soon as an estimated error is small favors runs that underestimate it. With many photons this
    /// is a small part of the error; it is no concern unless rare photons decide.
    ///
    /// # Errors
    /// As for [`run`](Self::run); the table then holds what was done before.
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
            let wanted = photons_wanted(self.photons(), relative_error, goal.relative_error);
            let photons_left = wanted.min(goal.photons.saturating_sub(done));
            if done > 0 {
                let seconds = start.elapsed().as_secs_f64() * photons_left as f64 / done as f64;
                let time_left = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
                report(self, &Forecast { relative_error, photons_done: done, photons_left, time_left });
            }
            if photons_left == 0 || control.stops() {
                return Ok(done);
            }

            // Do the rest, but no more than doubles what there is: an error estimated from few photons is itself far off
            let round = photons_left.min(self.photons().max(FIRST_ROUND));
            let end = Instant::now() + ROUND_TIME;
            let deadline = Some(control.deadline.map_or(end, |deadline| deadline.min(end)));
            let progress = |more: u64| (control.progress)(done + more);
            done += self.run(seed, round, &Control { progress: &progress, deadline, ..*control })?;
        }
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::super::{Layout, OrderBins, Parameters, Problem, Side};
    use super::*;

    fn empty(reference_albedo: f64) -> WhiteTable {
        let bins = OrderBins::new(0.125).unwrap();
        let layout = Layout::with_order_bins(&[0.3, 1.0, 3.0], 3, bins).unwrap();
        WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, reference_albedo).unwrap()
    }

    #[test]
    fn run_until_reaches_its_goal() {
        let worst = |table: &WhiteTable| {
            let at = table.at_albedo(0.9).unwrap();
            at.total(Side::Reflected).relative_error().max(at.ring(Side::Reflected, 1).relative_error())
        };
        let goal = Goal { relative_error: 2e-3, photons: u64::MAX };
        let (mut table, mut forecasts) = (empty(0.95), Vec::new());
        let mut report = |_: &WhiteTable, forecast: &Forecast| forecasts.push(*forecast);
        let done = table.run_until(1, goal, &Control::default(), &worst, &mut report).unwrap();
        assert_eq!(done, table.photons());
        assert!(worst(&table) <= 2e-3 && worst(&table) > 1.9e-3, "{}", worst(&table));
        let (first, last) = (forecasts[0], forecasts[forecasts.len() - 1]);
        assert_eq!((last.photons_left, last.time_left), (0, Duration::ZERO));
        let expected = first.photons_done + first.photons_left;
        assert!((expected as f64 / done as f64 - 1.0).abs() < 0.1, "{first:?} {done}");
        // There is nothing more to do.
        assert_eq!(table.run_until(1, goal, &Control::default(), &worst, &mut |_, _| ()).unwrap(), 0);
    }

    #[test]
    fn run_until_keeps_its_limits() {
        for error in [f64::INFINITY, f64::NAN, 1.0] {
            let mut table = empty(0.9);
            let goal = Goal { relative_error: 1e-9, photons: 150_000 };
            let done = table.run_until(1, goal, &Control::default(), &|_| error, &mut |_, _| ()).unwrap();
            assert_eq!((done, table.photons()), (150_000, 150_000));
        }
        let stop = AtomicBool::new(true);
        let goal = Goal { relative_error: 0.0, photons: u64::MAX };
        let control = Control { stop: &stop, ..Control::default() };
        assert_eq!(empty(0.9).run_until(1, goal, &control, &|_| 1.0, &mut |_, _| ()).unwrap(), 0);
    }
}
