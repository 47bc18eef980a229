//! A material in the numbers of other systems, the systems, and presets.

use serde_json::{Map, Value, json};
use translucid_profile::Configuration;
use translucid_profile::convention::{
    self, ArgumentNames, Conversion, ConvertedNumber, Parameter, Preset, Role, Setting, System, Unit,
};

use crate::options::{Options, numbers, unknown};

const NAMES: ArgumentNames =
    ArgumentNames { from: "source", surface_albedo: "surfaceAlbedo", to: "to", set: "settings" };

/// The rows of a conversion, and its notes.
pub(crate) fn convert(mut options: Options) -> Result<Value, String> {
    let source = options.text("source")?.ok_or("source is missing")?;
    let parameters = options.take("parameters").unwrap_or(Value::Object(Map::new()));
    let from = settings(NAMES.from, &source, Options::new("parameters", parameters)?)?;
    let surface_albedo = options.numbers(NAMES.surface_albedo)?.unwrap_or_default();
    let own_unit = unit("unit", options.text("unit")?)?.unwrap_or(Unit::Millimeter);
    let to_unit = unit("toUnit", options.text("toUnit")?)?.unwrap_or(own_unit);
    let to = options.texts(NAMES.to)?.unwrap_or_default();
    let to: Vec<&str> = to.iter().map(String::as_str).collect();
    let mut set = Vec::new();
    if let Some(of_systems) = options.take(NAMES.set) {
        for (system, parameters) in Options::new(NAMES.set, of_systems)?.into_entries() {
            let parameters = Options::new(&format!("settings.{system}"), parameters)?;
            set.extend(settings(NAMES.set, &system, parameters)?);
        }
    }
    let configuration = options.configuration()?.unwrap_or(Configuration::Diffuse);
    options.finish()?;
    let converted = Conversion {
        from: &from,
        surface_albedo: &surface_albedo,
        unit: own_unit,
        to_unit,
        to: &to,
        set: &set,
        configuration,
        names: NAMES,
    };
    let converted = converted.run().map_err(|error| error.to_string())?;
    let rows: Vec<Value> = converted.numbers.iter().map(row).collect();
    Ok(json!({ "numbers": rows, "notes": converted.notes }))
}

fn row(number: &ConvertedNumber) -> Value {
    let ConvertedNumber { system, parameter, channel, value, unit, equal } = number;
    json!({
        "system": system.name,
        "parameter": parameter,
        "channel": channel,
        "value": value,
        "unit": unit,
        "equal": equal,
        "source": format!("{}: {}", system.source.kind, system.source.place),
    })
}

fn settings(argument: &str, system: &str, parameters: Options) -> Result<Vec<Setting>, String> {
    let setting = |(name, value): (String, Value)| {
        Setting::new(argument, system, &name, numbers(&name, &value)?).map_err(|error| error.to_string())
    };
    parameters.into_entries().into_iter().map(setting).collect()
}

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
