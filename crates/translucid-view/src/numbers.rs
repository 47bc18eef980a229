//! A material in the numbers of other renderers.

use serde_json::{Value, json};
use translucid_laboratory::stack::thin_wall_numbers;
use translucid_profile::InputError;
use translucid_profile::convention::{
    ArgumentNames, ColorSpaces, Conversion, Converted, LINEAR_SPACES, Setting,
};
use translucid_scene::{Material, Unit};

/// How numbers are to be printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Wish {
    /// Linear color space, if it is not that of the scene.
    pub(crate) color_space: Option<String>,
    /// Thickness of a slab, whose thin walls take the place of the systems.
    pub(crate) thin: Option<f64>,
}

/// The answer to `numbers`: as `translucid convert` prints it, with its command line.
pub(crate) fn numbers(material: &Material, unit: Unit, wish: &Wish) -> Value {
    let albedo = material.subsurface_color.factor.to_array().map(f64::from);
    let length = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    let length = length.to_array().map(f64::from);
    let parameter = material.subsurface_parameter.name();
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
    let rows = match convert(material, albedo, parameter, length, unit, wish) {
        Ok(converted) => {
            notes.extend(converted.notes);
            converted.numbers
        }
        Err(error) => {
            notes.push(error);
            Vec::new()
        }
    };
    let rows: Vec<Value> = rows
        .iter()
        .map(|row| {
            json!({
                "system": row.system,
                "title": row.way.map_or(row.system, |way| way.title),
                "parameter": row.parameter,
                "channel": row.channel,
                "value": rounded(row.value),
                "unit": row.unit,
            })
        })
        .collect();
    let list = |values: [f64; 3]| values.map(rounded).join(",");
    let mut command = format!(
        "translucid convert --from translucid:{parameter}={} --surface-albedo {} --unit {} --configuration {} --format text",
        list(length),
        list(albedo),
        unit.name(),
        material.subsurface_configuration.name(),
    );
    if let Some(space) = &wish.color_space {
        command += &format!(" --color-space {space}");
    }
    if let Some(thickness) = wish.thin {
        command += &format!(" --thin {thickness} --eta {}", interface(material));
    }
    json!({ "type": "numbers", "rows": rows, "notes": notes, "command": command })
}

fn convert(
    material: &Material,
    albedo: [f64; 3],
    parameter: &str,
    length: [f64; 3],
    unit: Unit,
    wish: &Wish,
) -> Result<Converted, String> {
    let words = |error: InputError| error.to_string();
    let from = [Setting::new("from", "translucid", parameter, length.to_vec()).map_err(words)?];
    let conversion = Conversion {
        from: &from,
        surface_albedo: &albedo,
        unit,
        to_unit: unit,
        to: &[],
        set: &[],
        configuration: material.subsurface_configuration,
        color_space: wish.color_space.as_deref().map(|to| ColorSpaces { from: LINEAR_SPACES[0], to }),
        names: ArgumentNames {
            from: "the material",
            surface_albedo: "subsurface_color",
            ..ArgumentNames::FIELDS
        },
    };
    let Some(thickness) = wish.thin else { return conversion.run().map_err(words) };
    let (channels, shares) = conversion.material().map_err(words)?;
    let walls = thin_wall_numbers(&channels, thickness, 0.0, interface(material));
    let mut converted = walls.map_err(|error| error.to_string())?;
    converted.numbers.extend(shares);
    Ok(converted)
}

/// Index of refraction of the material's interface; 1 where it has none.
fn interface(material: &Material) -> f64 {
    let ior: f64 = material.specular_ior.to_string().parse().unwrap_or(1.0);
    if material.specular_weight.factor > 0.0 { ior.clamp(1.0, 3.0) } else { 1.0 }
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
        let value = numbers(&skin, Unit::Millimeter, &Wish::default());
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
    fn wishes_are_answered_and_are_in_the_command() {
        let skin = Material::of_preset(preset("skin1").unwrap(), Unit::Millimeter);
        let wish = Wish { color_space: Some("acescg".to_owned()), thin: Some(0.5) };
        let value = numbers(&skin, Unit::Millimeter, &wish);
        let systems: Vec<&str> =
            value["rows"].as_array().unwrap().iter().map(|row| row["system"].as_str().unwrap()).collect();
        for system in ["slab", "openpbr", "color space"] {
            assert!(systems.contains(&system), "{system}: {systems:?}");
        }
        let command = value["command"].as_str().unwrap();
        assert!(command.ends_with("--color-space acescg --thin 0.5 --eta 1.3"), "{command}");
        let wrong = Wish { color_space: Some("srgb".to_owned()), thin: None };
        let notes = numbers(&skin, Unit::Millimeter, &wrong)["notes"].to_string();
        assert!(notes.contains("must be one of lin_rec709"), "{notes}");
        let notes = numbers(&skin, Unit::Millimeter, &Wish { thin: Some(-1.0), ..Wish::default() })["notes"]
            .to_string();
        assert!(notes.contains("thickness is -1, but must be finite and above 0"), "{notes}");
    }

    #[test]
    fn what_cannot_be_converted_says_why() {
        let value = numbers(
            &Material {
                subsurface_radius: translucid_scene::ScalarInput::constant(0.0),
                ..Material::default()
            },
            Unit::Meter,
            &Wish::default(),
        );
        assert_eq!(value["rows"], json!([]));
        assert!(!value["notes"].as_array().unwrap().is_empty());
    }
}
