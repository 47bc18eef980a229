//! A material in the numbers of other systems, the systems, and presets.

use serde_json::{Map, Value, json};
use translucid_laboratory::stack::{thin_wall_numbers, wall_slab_numbers};
use translucid_profile::convention::{
    self, ArgumentNames, ColorSpaces, Conversion, Converted, ConvertedNumber, CyclesMaterial, CyclesMethod,
    LINEAR_SPACES, Parameter, Preset, Role, Setting, System, Unit,
};
use translucid_profile::{Configuration, ParameterError};

use crate::options::{Options, message, numbers, require, unknown};

const NAMES: ArgumentNames = ArgumentNames {
    from: "source",
    surface_albedo: "surfaceAlbedo",
    to: "to",
    set: "settings",
    color_space: "colorSpace",
    from_color_space: "fromColorSpace",
};

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
    let color_spaces = [options.text(NAMES.from_color_space)?, options.text(NAMES.color_space)?];
    let color_space = match &color_spaces {
        [from, Some(to)] => Some(ColorSpaces { from: from.as_deref().unwrap_or(LINEAR_SPACES[0]), to }),
        [Some(_), None] => return Err(String::from("colorSpace is missing, which fromColorSpace needs")),
        [None, None] => None,
    };
    let thin = options.number("thin")?;
    let (g, eta) = (options.number("g")?, options.number("eta")?);
    options.finish()?;
    let conversion = Conversion {
        from: &from,
        surface_albedo: &surface_albedo,
        unit: own_unit,
        to_unit,
        to: &to,
        set: &set,
        configuration,
        color_space,
        names: NAMES,
    };
    let Some(thickness) = thin else {
        if let Some((name, _)) = [("g", g), ("eta", eta)].into_iter().find(|(_, value)| value.is_some()) {
            return Err(format!("{name} is that of a slab, but there is none (give thin, its thickness)"));
        }
        return Ok(answer(&conversion.run().map_err(|error| error.to_string())?));
    };
    if !to.is_empty() || !set.is_empty() || to_unit != own_unit {
        return Err(String::from("thin gives the numbers of thin walls (leave out to, toUnit and settings)"));
    }
    let (channels, shares) = conversion.material().map_err(|error| error.to_string())?;
    let converted = thin_wall_numbers(&channels, thickness, g.unwrap_or(0.0), eta.unwrap_or(1.0));
    let mut converted = converted.map_err(|error| of_slab(&error))?;
    converted.numbers.extend(shares);
    Ok(answer(&converted))
}

/// The rows of the slab that has the light of a thin wall, and its notes.
pub(crate) fn slab(mut options: Options) -> Result<Value, String> {
    let color = options.numbers("color")?.ok_or("color is missing")?;
    let balance = options.numbers("balance")?.ok_or("balance is missing")?;
    let thickness = options.number("thin")?;
    let (g, eta) = (options.number("g")?, options.number("eta")?);
    options.finish()?;
    let found = wall_slab_numbers(&color, &balance, thickness, g.unwrap_or(0.0), eta.unwrap_or(1.0));
    Ok(answer(&found.map_err(|error| of_slab(&error))?))
}

/// The message of an error of a slab, whose thickness JavaScript calls thin.
fn of_slab(error: &ParameterError) -> String {
    error.to_string().replacen("thickness", "thin", 1)
}

fn answer(converted: &Converted) -> Value {
    let rows: Vec<Value> = converted.numbers.iter().map(row).collect();
    json!({ "numbers": rows, "notes": converted.notes })
}

fn row(number: &ConvertedNumber) -> Value {
    let ConvertedNumber { system, parameter, channel, value, unit, equal, source, .. } = number;
    json!({
        "system": system,
        "parameter": parameter,
        "channel": channel,
        "value": value,
        "unit": unit,
        "equal": equal,
        "source": source,
    })
}

fn settings(argument: &str, system: &str, parameters: Options) -> Result<Vec<Setting>, String> {
    let setting = |(name, value): (String, Value)| {
        Setting::new(argument, system, &name, numbers(&name, &value)?).map_err(|error| error.to_string())
    };
    parameters.into_entries().into_iter().map(setting).collect()
}

/// The keys of a material whose subsurface looks like that of Blender Cycles.
pub(crate) fn cycles_material(mut options: Options) -> Result<Value, String> {
    let method = options.text("method")?.ok_or("method is missing")?;
    let version = options.numbers("version")?.unwrap_or(vec![5.0, 2.0]);
    let version: Vec<u32> = version.into_iter().map(|number| number as u32).collect();
    let mut channels = |name| {
        let given = options.numbers(name)?.ok_or_else(|| format!("{name} is missing"))?;
        require(name, &given, given.len() == 1, |x| x.is_finite() && x >= 0.0, "finite and at least 0")?;
        match given[..] {
            [all] => Ok([all; 3]),
            [r, g, b] => Ok([r, g, b]),
            _ => Err(format!("{name} has {} numbers, but must have one or three", given.len())),
        }
    };
    let (colors, radii) = (channels("baseColor")?, channels("radius")?);
    let ior = options.number("ior")?.unwrap_or(1.4);
    let anisotropy = options.number("anisotropy")?.unwrap_or(0.0);
    let alpha = options.number("alpha")?.unwrap_or(1.0);
    options.finish()?;
    let method = CyclesMethod::named(&version, &method).map_err(|error| error.to_string())?;
    let wrong = |error: ParameterError| message(&error);
    let material = CyclesMaterial::new(method, &version, ior, anisotropy, alpha).map_err(wrong)?;
    let (albedos, mfps) = material.media(&colors).map_err(wrong)?;
    let mfps = [0, 1, 2].map(|i| radii[i] * mfps[i.min(mfps.len() - 1)]);
    let greatest = mfps.into_iter().fold(0.0, f64::max);
    let shares = mfps.map(|mfp| if greatest > 0.0 { mfp / greatest } else { 1.0 });
    let (names, numbers) = material.keys();
    let mut keys = json!({ "subsurface_color": albedos, "subsurface_radius": greatest, "subsurface_radius_scale": shares });
    names.into_iter().for_each(|(key, name)| keys[key] = name.into());
    numbers.into_iter().for_each(|(key, number)| keys[key] = number.into());
    Ok(keys)
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
