//! The command, in this process.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the `translucid` command and returns its exit code.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| translucid_cli::run(words))
}
