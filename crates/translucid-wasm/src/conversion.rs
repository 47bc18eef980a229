//! Systems that a material is converted to, and presets.

use serde_json::{Map, Value, json};
use translucid_profile::ParameterError;
use translucid_profile::convention::{
    self, CyclesMaterial, CyclesMethod, Parameter, Preset, Role, System, Unit,
};

use crate::options::{Options, message, require, unknown};

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
        let unit = system.unit.map_or("scene", Unit::name);
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
        "eta": preset.eta,
        "roughness": preset.roughness,
        "coat": preset.coat[0],
        "coatRoughness": preset.coat[1],
        "group": preset.group.name(),
    })
}
