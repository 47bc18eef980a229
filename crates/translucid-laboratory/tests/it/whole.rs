//! The comparison of everything that the documentation shows, for all tests.

use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use translucid_laboratory::comparison::{Comparison, Watch};

use crate::documents::generated;

/// The comparison, and the last progress that it told.
pub(crate) static WHOLE: LazyLock<(Comparison, f64)> = LazyLock::new(|| {
    let stop = AtomicBool::new(false);
    let last = AtomicU64::new(0);
    let progress = |done: f64| {
        assert!((0.0..=1.0).contains(&done));
        last.fetch_max(done.to_bits(), Ordering::Relaxed);
    };
    let watch = Watch { stop: &stop, progress: &progress };
    let comparison = Comparison::new(generated::settings(false), watch).unwrap();
    (comparison, f64::from_bits(last.into_inner()))
});
