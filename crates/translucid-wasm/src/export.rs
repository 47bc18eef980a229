//! Profiles as text for shaders and renderers: the bytes that `translucid export` writes.

use std::fmt::Write;

use serde_json::Value;
use translucid_export::{Export, ExportError, Material, Sizes, Subject, Target};
use translucid_profile::convention::{Unit, preset};
use translucid_profile::{Configuration, Model, Parameterization};
use translucid_words::Spelling;

use crate::conversion::unit;
use crate::options::{self, Options, unknown};

/// The export that options describe.
pub(crate) fn export(mut options: Options) -> Result<Value, String> {
    // Read what is to be written, and say it as a command on the way
    let mut command = String::from("translucid export");
    let mut say = |option: &str, value: &str| {
        // Writing to a text cannot fail
        let _ = write!(command, " --{option} {value}");
    };
    let to = options.text("to")?.ok_or("to is missing")?;
    let target = Target::ALL.into_iter().find(|target| target.name() == to);
    let target = target.ok_or_else(|| unknown("to", &to, &Target::ALL.map(Target::name)))?;
    say("to", &to);
    let what = options.texts("what")?.ok_or("what is missing")?;
    let subject = |name: &String| {
        let found = Subject::ALL.into_iter().find(|subject| subject.name() == name);
        found.ok_or_else(|| unknown("what", name, &Subject::ALL.map(Subject::name)))
    };
    let subjects: Vec<Subject> = what.iter().map(subject).collect::<Result<_, _>>()?;
    say("what", &what.join(","));
    let models = match options.texts("model")? {
        None => vec![Model::NormalizedDiffusion],
        Some(names) => {
            say("model", &names.join(","));
            names.iter().map(|name| options::model(name)).collect::<Result<_, _>>()?
        }
    };
    let material = material(&mut options, &mut say)?;
    let given_configuration = options.configuration()?;
    if let Some(configuration) = given_configuration {
        say("configuration", configuration.name());
    }
    let mut number = |name: &'static str, option: &str| -> Result<Option<f64>, String> {
        let found = options.number(name)?;
        if let Some(x) = found {
            say(option, &x.to_string());
        }
        Ok(found)
    };
    let (g, eta) = (number("g", "g")?.unwrap_or(0.0), number("eta", "eta")?.unwrap_or(1.0));
    let usual = Sizes::default();
    let taps = number("taps", "taps")?.map_or(Ok(usual.taps), |taps| whole("taps", taps))?;
    let lut = match options.numbers("size")?.as_deref() {
        None => usual.lut,
        Some(&[width, height]) => {
            say("size", &format!("{width}x{height}"));
            [whole("size", width)?, whole("size", height)?]
        }
        Some(other) => return Err(format!("size has {} numbers, but must have two", other.len())),
    };
    let most_curvature = options.number("mostCurvature")?;
    if let Some(curvature) = most_curvature {
        say("most-curvature", &curvature.to_string());
    }
    options.finish()?;

    let is_dmfp = material.is_some_and(|material| material.parameterization == Parameterization::Dmfp);
    let by_default = if is_dmfp { Configuration::Searchlight } else { Configuration::Diffuse };
    let export = Export {
        target,
        subjects: &subjects,
        models: &models,
        material,
        configuration: given_configuration.unwrap_or(by_default),
        g,
        eta,
        sizes: Sizes { taps, lut, most_curvature, ..usual },
        command: &command,
    };
    let bytes = export.bytes().map_err(|error| message(&error, is_dmfp))?;
    Ok(String::from_utf8_lossy(&bytes).into())
}

/// The material that options describe, if they do.
fn material(options: &mut Options, say: &mut impl FnMut(&str, &str)) -> Result<Option<Material>, String> {
    let name = options.text("preset")?;
    let unit_name = options.text("unit")?;
    let albedos = options.numbers("surfaceAlbedo")?;
    let (mfp, dmfp) = (options.numbers("mfp")?, options.numbers("dmfp")?);
    if let Some(name) = name {
        if albedos.is_some() || mfp.is_some() || dmfp.is_some() {
            return Err(String::from("a preset has its own surfaceAlbedo and mfp: leave them out"));
        }
        let preset = preset(&name).map_err(|error| error.to_string())?;
        say("preset", &name);
        if let Some(name) = &unit_name {
            say("unit", name);
        }
        let millimeters = unit("unit", unit_name)?.unwrap_or(Unit::Millimeter).in_millimeters();
        return Ok(Some(Material::of_preset(preset, millimeters)));
    }
    if unit_name.is_some() {
        return Err(String::from("unit is that of a preset's lengths: it needs a preset"));
    }
    let (name, lengths, parameterization) = match (mfp, dmfp) {
        (Some(mfp), None) => ("mfp", mfp, Parameterization::Mfp),
        (None, Some(dmfp)) => ("dmfp", dmfp, Parameterization::Dmfp),
        (None, None) if albedos.is_none() => return Ok(None),
        _ => return Err(String::from("a material has a surfaceAlbedo and one of mfp and dmfp")),
    };
    let albedos = albedos.ok_or("a material has a surfaceAlbedo and one of mfp and dmfp")?;
    Ok(Some(Material {
        surface_albedo: of_channels("surfaceAlbedo", &albedos, say)?,
        length: of_channels(name, &lengths, say)?,
        parameterization,
        surface: None,
    }))
}

/// One number for all channels, or one for each.
fn of_channels(name: &str, numbers: &[f64], say: &mut impl FnMut(&str, &str)) -> Result<[f64; 3], String> {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    say(if name == "surfaceAlbedo" { "surface-albedo" } else { name }, &words.join(","));
    match numbers {
        [all] => Ok([*all; 3]),
        [red, green, blue] => Ok([*red, *green, *blue]),
        _ => Err(format!("{name} has {} numbers, but must have one or three", numbers.len())),
    }
}

fn whole(name: &str, x: f64) -> Result<usize, String> {
    if x.fract() == 0.0 && (0.0..1e9).contains(&x) {
        return Ok(x as usize);
    }
    Err(format!("{name} is {x}, but must be a whole number"))
}

/// The message of an error, with its parameter's name in the spelling of JavaScript.
fn message(error: &ExportError, is_dmfp: bool) -> String {
    let parameter = match error.parameter {
        "length" if is_dmfp => String::from("dmfp"),
        "length" => String::from("mfp"),
        other => Spelling::Camel.of(other),
    };
    format!("{parameter} is {}, but must be {}", error.found, error.allowed)
}
