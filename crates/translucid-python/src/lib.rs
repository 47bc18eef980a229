//! The Python module `translucid._translucid`, which the package `translucid` in `python/` re-exports.
//!
//! Numbers come and go as NumPy arrays; every mistake of a caller is an exception that names the argument, and work that
//! takes long runs without the interpreter and ends with Ctrl-C.

mod arrays;
mod long_work;
mod names;
mod profile;

use pyo3::prelude::*;

#[pymodule]
fn _translucid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<profile::Profile>()
}
