//! The Python module `translucid._translucid`, which the package `translucid` in `python/` re-exports.
//!
//! Numbers come and go as NumPy arrays; every mistake of a caller is an exception that names the argument, and work that
//! takes long runs without the interpreter and ends with Ctrl-C.

mod arrays;
mod convert;
mod fit;
mod long_work;
mod names;
mod profile;
mod reference;
mod white_table;

use pyo3::prelude::*;

#[pymodule]
fn _translucid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("models", translucid_profile::Model::ALL.map(translucid_profile::Model::name).to_vec())?;
    module.add_class::<profile::Profile>()?;
    module.add_class::<fit::Fit>()?;
    module.add_class::<convert::Preset>()?;
    module.add_class::<white_table::WhiteTable>()?;
    for function in [
        wrap_pyfunction!(fit::fit, module)?,
        wrap_pyfunction!(fit::fit_scaling, module)?,
        wrap_pyfunction!(convert::_convert, module)?,
        wrap_pyfunction!(convert::_conversion_systems, module)?,
        wrap_pyfunction!(convert::_preset, module)?,
        wrap_pyfunction!(convert::_preset_names, module)?,
        wrap_pyfunction!(reference::exact, module)?,
        wrap_pyfunction!(reference::exact_enclosed, module)?,
        wrap_pyfunction!(reference::exact_beyond, module)?,
        wrap_pyfunction!(reference::exact_total, module)?,
        wrap_pyfunction!(white_table::walk, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
