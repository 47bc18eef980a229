//! The Python module `translucid._translucid`, which the package `translucid` in `python/` re-exports.
//!
//! Numbers come and go as NumPy arrays; every mistake of a caller is an exception that names the argument, and work that
//! takes long runs without the interpreter and ends with Ctrl-C.

mod arrays;
mod command;
mod keys;
mod long_work;
mod names;
mod pictures;
mod profile;
mod scene;
mod scene_error;
mod session;

use pyo3::prelude::*;

#[pymodule]
fn _translucid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<profile::Profile>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<session::Session>()?;
    module.add("LAYERS", translucid_render::FilmLayer::ALL.map(translucid_render::FilmLayer::name))?;
    module.add("SceneError", module.py().get_type::<scene_error::SceneError>())?;
    module.add_function(wrap_pyfunction!(pictures::tonemap, module)?)?;
    module.add_function(wrap_pyfunction!(pictures::png_bytes, module)?)?;
    module.add_function(wrap_pyfunction!(pictures::write_exr, module)?)?;
    module.add_function(wrap_pyfunction!(pictures::read_exr, module)?)?;
    module.add_function(wrap_pyfunction!(command::command, module)?)
}
