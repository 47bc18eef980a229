//! How much the project's tests count, the scans that some of them need, and helpers that tests and benches of several
//! crates share.
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

/// Returns whether tests run with their whole power.
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

/// Path of a file or folder of the scans that are not part of the project, in the folder that the environment variable
/// `TRANSLUCID_ASSETS` names; `None` where that is not set, or nothing is there.
///
/// `docs/inside/scans.md` lists the files and their sources. Tests of scans are ignored unless they are asked for, as
/// `.ci/scans` does, so that the variable changes nothing of what is compiled.
#[must_use]
pub fn asset(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(std::env::var_os("TRANSLUCID_ASSETS")?).join(name);
    path.exists().then_some(path)
}

/// Path of a file that [`asset`] finds, for a test that cannot do without.
///
/// # Panics
/// The file is not there.
#[must_use]
pub fn scan(name: &str) -> PathBuf {
    asset(name).unwrap_or_else(|| panic!("{name} is not in TRANSLUCID_ASSETS, the absolute path of a folder"))
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
}
