//! Guided runs that end when an error is small enough.

use super::guided::GuidedWalk;
use super::until::{self, Extensible};
use super::{Control, Forecast, Goal, TableError};

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
        until::run_until(self, seed, goal, control, error, report)
    }
}

impl Extensible for GuidedWalk {
    fn photons(&self) -> u64 {
        self.photons()
    }

    fn add_photons(&mut self, seed: u64, photons: u64, control: &Control) -> Result<u64, TableError> {
        self.run(seed, photons, control)
    }
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
