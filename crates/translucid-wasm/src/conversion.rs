//! Systems that a material is converted to, and presets.

use serde_json::{Map, Value, json};
use translucid_profile::convention::{self, Parameter, Preset, Role, System, Unit};

use crate::options::{Options, unknown};

/// The unit of lengths of a name.
pub(crate) fn unit(name: &str, text: Option<String>) -> Result<Option<Unit>, String> {
    let read = |text: String| Unit::from_name(&text).ok_or_else(|| unknown(name, &text, &["mm", "cm", "m"]));
    text.map(read).transpose()
}

/// Every system in the ways that it is told a material.
pub(crate) fn systems() -> Value {
    let parameter = |Parameter { name, role }: &Parameter| {
        let default = match role {
            Role::Factor { default, .. } | Role::Setting { default, .. } => Some(*default),
            _ => None,
        };
        ((*name).to_owned(), json!(default))
    };
    let describe = |system: &System| {
        let unit = system.unit.name().unwrap_or("scene");
        json!({
            "name": system.name,
            "title": system.title,
            "version": system.version,
            "unit": unit,
            "parameters": system.parameters.iter().map(parameter).collect::<Map<_, _>>(),
            "rule": system.formula,
        })
    };
    System::ALL.iter().map(describe).collect()
}

/// Every preset.
pub(crate) fn presets() -> Value {
    convention::presets().iter().map(described).collect()
}

/// The preset of a name.
pub(crate) fn preset(mut options: Options) -> Result<Value, String> {
    let name = options.text("name")?.ok_or("name is missing")?;
    convention::preset(&name).map(described).map_err(|error| error.to_string())
}

fn described(preset: &Preset) -> Value {
    json!({
        "name": preset.name,
        "source": preset.source,
        "surfaceAlbedo": preset.surface_albedo(),
        "mfp": preset.mfp_in_millimeters(),
        "eta": decimal(preset.eta),
        "roughness": decimal(preset.roughness),
    })
}

/// The number that is written like one in single precision.
fn decimal(x: f32) -> f64 {
    x.to_string().parse().unwrap_or_else(|_| f64::from(x))
}
