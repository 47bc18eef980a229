//! How much the project's tests count, the meshes that some of them need, and what tests and benches of several crates share.
//!
//! A test whose power is a number of photons, samples or repeats runs at an eighth of it, with bounds that are wider
//! in proportion, unless the environment variable `TRANSLUCID_THOROUGH` is `1`.
//!
//! # Out of scope
//! Helpers of one crate's tests stay in that crate.

mod cpu_time;
mod measured;
mod mutants;
mod split_mix;

use std::path::PathBuf;
use std::sync::LazyLock;

pub use cpu_time::{cpu_seconds, thread_cpu_seconds};
pub use measured::write_measured;
pub use mutants::mutants;
pub use split_mix::{SplitMix, golden_uniforms};

/// Factor between the number of repeats of a thorough test and of a quick one.
const QUICK: u32 = 8;

static THOROUGH: LazyLock<bool> =
    LazyLock::new(|| std::env::var_os("TRANSLUCID_THOROUGH").is_some_and(|value| value == "1"));

/// Tells whether tests run with their whole power.
#[must_use]
pub fn is_thorough() -> bool {
    *THOROUGH
}

/// Number of photons, samples or repeats in this run for a test whose whole power is `full`: that, or an eighth, at
/// least 1.
#[must_use]
pub fn power(full: u64) -> u64 {
    if is_thorough() { full } else { (full / u64::from(QUICK)).max(1) }
}

/// Error bound in this run for a test that has the bound `thorough` at its whole power: a standard error goes as the
/// inverse square root of the number of repeats.
#[must_use]
pub fn bound(thorough: f64) -> f64 {
    if is_thorough() { thorough } else { thorough * f64::from(QUICK).sqrt() }
}

/// Path of a file in the folder `shared/assets` beside the workspace, which tests in [`with_shared_assets!`] may
/// expect to be there.
#[must_use]
pub fn asset(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/assets")).join(name)
}

/// Defines tests that need the folder `shared/assets` beside the workspace; where it is missing, they are ignored and
/// say so.
///
/// ```
/// translucid_testing::with_shared_assets! {
///     fn head_has_its_triangles() {
///         assert!(translucid_testing::asset("head/head_70k.ply").exists());
///     }
/// }
/// ```
#[cfg(shared_assets)]
#[macro_export]
macro_rules! with_shared_assets {
    ($($test:item)*) => { $(#[test] $test)* };
}

/// Defines tests that need the folder `shared/assets` beside the workspace; where it is missing, they are ignored and
/// say so.
#[cfg(not(shared_assets))]
#[macro_export]
macro_rules! with_shared_assets {
    ($($test:item)*) => { $(#[test] #[ignore = "needs the folder shared/assets beside the workspace"] $test)* };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bound_grows_as_power_falls() {
        let repeats = power(8000) as f64 / 8000.0;
        assert!((bound(0.1) - 0.1 / repeats.sqrt()).abs() < 1e-12);
        assert_eq!(power(3), if is_thorough() { 3 } else { 1 });
    }

    with_shared_assets! {
        fn asset_is_found() {
            assert!(asset("head").is_dir());
        }
    }
}
