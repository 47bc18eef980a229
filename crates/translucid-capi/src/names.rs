//! Names as the command and the Python module spell them, and lists of them.

use std::ffi::{CString, c_char};
use std::ptr::null;
use std::sync::OnceLock;

use translucid_profile::{Configuration, Model};
use translucid_reference::Incidence;

use crate::ffi_guard::Caller;
use crate::status::Failure;

/// Names that last as long as the program.
pub(crate) type Names = OnceLock<Vec<CString>>;

/// The name of an index; NULL behind the last.
pub(crate) fn name_of(list: &Names, index: usize, all: impl FnOnce() -> Vec<&'static str>) -> *const c_char {
    let text = |name: &str| CString::new(name).unwrap_or_default();
    let names = list.get_or_init(|| all().into_iter().map(text).collect());
    names.get(index).map_or(null(), |name| name.as_ptr())
}

/// A model; the default for NULL.
pub(crate) fn model(caller: &Caller, name: *const c_char) -> Result<Model, Failure> {
    let name = caller.text_or("model", name, Model::default().name())?;
    Model::from_name(name).ok_or_else(|| Failure::unknown("model", name, &Model::ALL.map(Model::name)))
}

/// A configuration, if one is named.
pub(crate) fn configuration(caller: &Caller, name: *const c_char) -> Result<Option<Configuration>, Failure> {
    let text = caller.text_or("configuration", name, "")?;
    let known = Configuration::WORDS.map(|(word, _)| word);
    match Configuration::from_name(text) {
        None if !name.is_null() => Err(Failure::unknown("configuration", text, &known)),
        found => Ok(found),
    }
}

/// How light enters: as configured, or as a beam at an angle in degrees.
pub(crate) fn incidence(
    caller: &Caller,
    configuration: *const c_char,
    angle: f64,
    eta: f64,
) -> Result<Incidence, Failure> {
    let configuration = self::configuration(caller, configuration)?;
    if angle == 0.0 {
        return Ok(configuration.map_or(Incidence::Cosine, Incidence::from));
    }
    if configuration == Some(Configuration::Diffuse) {
        let message = "incidence_angle belongs to a beam, but configuration is \"diffuse\"";
        return Err(Failure::argument(message));
    }
    let is_good = (0.0..90.0).contains(&angle);
    if !is_good {
        return Err(Failure::argument(format_args!("incidence_angle is {angle}, but must be in [0, 90)")));
    }
    let cos_theta = angle.to_radians().cos();
    if eta < 1.0 && (eta - 1.0) * (eta + 1.0) + cos_theta * cos_theta <= 0.0 {
        let limit = eta.asin().to_degrees();
        return Err(Failure::argument(format_args!(
            "incidence_angle is {angle}, but must be below asin(eta) = {limit:.4}: no light enters beyond"
        )));
    }
    Ok(Incidence::Pencil { cos_theta })
}

/// A number, or what 0 stands for.
pub(crate) fn number_or(number: f64, default: f64) -> f64 {
    if number == 0.0 { default } else { number }
}
