//! A material in the numbers of other renderers.

use serde_json::{Value, json};
use translucid_profile::InputError;
use translucid_profile::convention::{ArgumentNames, Conversion, Converted, Setting};
use translucid_scene::description::Choice;
use translucid_scene::{Material, SubsurfaceParameter, Unit};

/// The answer to `numbers`: as `translucid convert` prints it, with its command line.
pub(crate) fn numbers(material: &Material, unit: Unit) -> Value {
    let albedo = material.subsurface_color.factor.to_array().map(f64::from);
    let length = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    let length = length.to_array().map(f64::from);
    let parameter = match material.subsurface_parameter {
        SubsurfaceParameter::Mfp => "mfp",
        SubsurfaceParameter::Dmfp => "dmfp",
    };
    let mut notes = Vec::new();
    let color = &material.subsurface_color;
    if color.texture.is_some() || color.vertex_color || material.subsurface_radius.texture.is_some() {
        notes.push(
            "images and vertex colors stay what they are: these are the numbers of the factors".to_owned(),
        );
    }
    if material.subsurface_scatter_anisotropy != 0.0 {
        notes.push("the conversion is for isotropic scattering (g = 0)".to_owned());
    }
    if !material.layers.is_empty() {
        notes.push("these are the numbers of the innermost medium, without the layers".to_owned());
    }
    let rows = match convert(material, albedo, parameter, length, unit) {
        Ok(converted) => {
            notes.extend(converted.notes);
            converted.numbers
        }
        Err(error) => {
            notes.push(error.to_string());
            Vec::new()
        }
    };
    let rows: Vec<Value> = rows
        .iter()
        .map(|row| {
            json!({
                "system": row.system.name,
                "title": row.system.title,
                "parameter": row.parameter,
                "channel": row.channel,
                "value": rounded(row.value),
                "unit": row.unit,
            })
        })
        .collect();
    let list = |values: [f64; 3]| values.map(rounded).join(",");
    let command = format!(
        "translucid convert --from translucid:{parameter}={} --surface-albedo {} --unit {} --configuration {} --format text",
        list(length),
        list(albedo),
        unit.name(),
        configuration(material),
    );
    json!({ "type": "numbers", "rows": rows, "notes": notes, "command": command })
}

fn convert(
    material: &Material,
    albedo: [f64; 3],
    parameter: &str,
    length: [f64; 3],
    unit: Unit,
) -> Result<Converted, InputError> {
    let from = [Setting::new("from", "translucid", parameter, length.to_vec())?];
    Conversion {
        from: &from,
        surface_albedo: &albedo,
        unit,
        to_unit: unit,
        to: &[],
        set: &[],
        configuration: material.subsurface_configuration,
        names: ArgumentNames {
            from: "the material",
            surface_albedo: "subsurface_color",
            to: "to",
            set: "set",
        },
    }
    .run()
}

fn configuration(material: &Material) -> &'static str {
    Choice::name(&material.subsurface_configuration)
}

/// A number to six digits, as people type it.
fn rounded(value: f64) -> String {
    let six: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    six.to_string()
}

#[cfg(test)]
mod tests {
    use translucid_profile::convention::preset;

    use super::*;

    #[test]
    fn numbers_are_those_of_the_conversion() {
        let skin = Material::of_preset(preset("skin1").unwrap(), Unit::Millimeter);
        let value = numbers(&skin, Unit::Millimeter);
        let rows = value["rows"].as_array().unwrap();
        let find = |system: &str, parameter: &str, channel: &str| {
            let row = rows.iter().find(|row| {
                row["system"] == system && row["parameter"] == parameter && row["channel"] == channel
            });
            row.unwrap_or_else(|| panic!("{system} {parameter} {channel}: {rows:?}"))["value"]
                .as_str()
                .unwrap()
        };
        let mfp = skin.subsurface_radius.factor * skin.subsurface_radius_scale.factor;
        let own: f32 = find("translucid", "mfp", "r").parse().unwrap();
        assert!((own / mfp.x - 1.0).abs() < 1e-5, "{own} {mfp}");
        assert!(rows.iter().any(|row| row["system"] == "renderman"));
        assert!(
            value["command"].as_str().unwrap().starts_with("translucid convert --from translucid:mfp=1.29")
        );
    }

    #[test]
    fn what_cannot_be_converted_says_why() {
        let value = numbers(
            &Material {
                subsurface_radius: translucid_scene::ScalarInput::constant(0.0),
                ..Material::default()
            },
            Unit::Meter,
        );
        assert_eq!(value["rows"], json!([]));
        assert!(!value["notes"].as_array().unwrap().is_empty());
    }
}
