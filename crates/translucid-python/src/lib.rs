//! The Python module `translucid._translucid`, which the package `translucid` in `python/` re-exports.
//!
//! Numbers come and go as NumPy arrays; every mistake of a caller is an exception that names the argument, and work that
//! takes long runs without the interpreter and ends with Ctrl-C.

mod arrays;
mod ask;
mod command;
mod convert;
mod fit;
mod keys;
mod layers;
mod live_session;
mod long_work;
mod mattes;
mod measure;
mod names;
mod phase_function;
mod photons;
mod pictures;
mod profile;
mod profile_pickle;
mod profile_table;
mod profiles;
mod reference;
mod scene;
mod scene_error;
mod session;
mod session_arguments;
mod session_state;
mod white_table;

use pyo3::prelude::*;

#[pymodule]
fn _translucid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    // A denoiser is looked for where Python would import it from
    let path = module.py().import("sys")?.getattr("path")?;
    translucid_image::import_packages_from(path.extract().unwrap_or_default());
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("models", translucid_profile::Model::ALL.map(translucid_profile::Model::name).to_vec())?;
    module.add_class::<profile::Profile>()?;
    module.add_class::<fit::Fit>()?;
    module.add_class::<convert::Preset>()?;
    module.add_class::<white_table::WhiteTable>()?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<session::Session>()?;
    module.add("LAYERS", translucid_render::FilmLayer::ALL.map(translucid_render::FilmLayer::name))?;
    module.add("SceneError", module.py().get_type::<scene_error::SceneError>())?;
    for function in [
        wrap_pyfunction!(ask::_ask, module)?,
        wrap_pyfunction!(ask::_wrong_questions, module)?,
        wrap_pyfunction!(fit::fit, module)?,
        wrap_pyfunction!(fit::fit_scaling, module)?,
        wrap_pyfunction!(convert::_conversion_systems, module)?,
        wrap_pyfunction!(convert::_cycles_material, module)?,
        wrap_pyfunction!(convert::_preset, module)?,
        wrap_pyfunction!(convert::_preset_names, module)?,
        wrap_pyfunction!(reference::exact, module)?,
        wrap_pyfunction!(reference::exact_enclosed, module)?,
        wrap_pyfunction!(reference::exact_beyond, module)?,
        wrap_pyfunction!(reference::exact_total, module)?,
        wrap_pyfunction!(layers::layers, module)?,
        wrap_pyfunction!(layers::layers_profile, module)?,
        wrap_pyfunction!(layers::layers_walk, module)?,
        wrap_pyfunction!(white_table::walk, module)?,
        wrap_pyfunction!(mattes::cryptomatte_id, module)?,
        wrap_pyfunction!(mattes::_cryptomatte_hash, module)?,
        wrap_pyfunction!(measure::_measure, module)?,
        wrap_pyfunction!(measure::_measure_scene, module)?,
        wrap_pyfunction!(pictures::tonemap, module)?,
        wrap_pyfunction!(pictures::png_bytes, module)?,
        wrap_pyfunction!(pictures::write_exr, module)?,
        wrap_pyfunction!(pictures::read_exr, module)?,
        wrap_pyfunction!(command::command, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
