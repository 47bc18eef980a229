//! Progress of a solution, and its end before time.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::walk::Control;

/// Counts wave numbers that are solved, in equal parts.
pub(super) struct Watch<'a> {
    control: &'a Control<'a>,
    parts: u64,
    /// Parts begun, wave numbers of the present one, and those done.
    counts: [AtomicU64; 3],
}

impl<'a> Watch<'a> {
    /// Watches the solution of a number of parts.
    pub(super) fn new(control: &'a Control<'a>, parts: u64) -> Self {
        Self { control, parts, counts: [const { AtomicU64::new(0) }; 3] }
    }

    /// Begins a part of so many wave numbers.
    pub(super) fn expect(&self, count: usize) {
        self.counts[0].fetch_add(1, Ordering::Relaxed);
        self.counts[1].store(count as u64, Ordering::Relaxed);
        self.counts[2].store(0, Ordering::Relaxed);
    }

    /// Solves for one wave number, unless it is to end.
    pub(super) fn step<T>(&self, solve: impl FnOnce() -> T) -> Option<T> {
        if self.control.stops() {
            return None;
        }
        let solved = solve();
        let done = self.counts[2].fetch_add(1, Ordering::Relaxed) + 1;
        let [begun, expected] = [0, 1].map(|i| self.counts[i].load(Ordering::Relaxed));
        (self.control.progress)((1000 * (begun - 1) + 1000 * done / expected.max(1)) / self.parts);
        Some(solved)
    }
}
