//! *convert*: the same material in every other system's numbers, the thin wall that stands for a slab, and the slab of a wall.

use translucid_laboratory::stack::{thin_wall_numbers, wall_slab_numbers};
use translucid_profile::convention::{
    ArgumentNames, ColorSpaces, Conversion, Converted, LINEAR_SPACES, Setting, Unit, conversion_system_names,
};
use translucid_profile::{Configuration, ParameterError};
use translucid_words::{
    Context, DataTable, Entry, Error, Fallback, Interval, Rule, Thing, field, numbers, optional,
    optional_word, text, texts, word,
};

use crate::answer::{About, Answer, Control, Form, Question, Unanswered};
use crate::conversion_table::{COLUMNS, cells, list, paragraphs};

use Fallback::{Plain, Words};

/// A material, and what it becomes.
#[derive(Clone, Debug)]
pub struct AskedConversion {
    from: Vec<String>,
    surface_albedo: Vec<f64>,
    unit: Unit,
    to_unit: Option<Unit>,
    to: Vec<String>,
    set: Vec<String>,
    configuration: Configuration,
    color_space: Option<String>,
    from_color_space: Option<String>,
    thin: Option<f64>,
    wall_color: Vec<f64>,
    wall_balance: Vec<f64>,
    g: Option<f64>,
    eta: Option<f64>,
}

const SETTING: &str = "SYSTEM:PARAMETER=VALUE";
const SPACES: &str = "a linear color space";
const SHARE: Interval = Interval::above(0.0, 1.0);
const OF_WALLS: &str = "slabs and thin walls have numbers of their own";
const OF_MATERIAL: &str = "a wall leads to the slab's material";

/// *convert*.
#[rustfmt::skip]
pub static CONVERT: Question<AskedConversion> = Question {
    thing: Thing {
        name: "convert",
        doc: "Converts a material to the parameters of other renderers and engines",
        plain: || AskedConversion {
            from: Vec::new(), surface_albedo: Vec::new(), unit: Unit::Millimeter, to_unit: None, to: Vec::new(), set: Vec::new(),
            configuration: Configuration::Diffuse, color_space: None, from_color_space: None, thin: None,
            wall_color: Vec::new(), wall_balance: Vec::new(), g: None, eta: None,
        },
        fields: &[
            field!(AskedConversion { from } => texts(from, SETTING),
                "A parameter of the source system, a number or three with commas between; repeated for each parameter; or `list` for all systems", Words("none")),
            field!(AskedConversion { surface_albedo } => numbers(surface_albedo, Interval::UNIT, [1, 3]),
                "Surface albedo A, {range}: one or three; coefficients determine it", Words("none")),
            field!(AskedConversion { unit } => word(unit, &Unit::WORDS),
                "Unit of lengths in the source scene, for systems without a unit of their own: millimeters, centimeters or meters", Plain),
            field!(AskedConversion { to_unit } => optional_word(to_unit, &Unit::WORDS),
                "Unit of lengths in the target scene", Words("that of the source")),
            field!(AskedConversion { to } => texts(to, "SYSTEMS"), "Systems to print, comma-separated", Words("all")),
            field!(AskedConversion { set } => texts(set, SETTING),
                "A fixed parameter of a printed system; repeated for each parameter", Words("none")),
            field!(AskedConversion { configuration } => word(configuration, &Configuration::WORDS),
                "How light enters, for the fit between the width of a profile and the mean free path of a medium: a pencil beam perpendicularly, or light with a cosine distribution", Plain),
            field!(AskedConversion { color_space } => text(color_space, SPACES),
                "Linear color space of the printed numbers", Words("that of the material")),
            field!(AskedConversion { from_color_space } => text(from_color_space, SPACES),
                "Linear color space of the material's numbers", Words("lin_rec709")),
            field!(AskedConversion { thin } => optional(thin, Interval::closed(f64::MIN_POSITIVE, f64::MAX)),
                "Thickness of a slab, in the unit of the source's lengths, {range}: prints the thin-walled surface that stands for it, in place of the systems' numbers", Words("none")),
            field!(AskedConversion { wall_color } => numbers(wall_color, SHARE, [1, 3]),
                "Color of a thin-walled surface, one or three, {range}: prints the slab that has its light, of the slab's thickness if that is given", Words("none")),
            field!(AskedConversion { wall_balance } => numbers(wall_balance, SHARE, [1, 3]),
                "Share of the surface's light that goes to the other side, {range}, one or three", Words("none")),
            field!(AskedConversion { g } => optional(g, Interval::closed(-0.95, 0.95)),
                "Mean cosine of the slab's phase function, {range}", Words("0")),
            field!(AskedConversion { eta } => optional(eta, Interval::closed(1.0, 3.0)),
                "Index of refraction of the slab, {range}", Words("1")),
        ],
        rules: &[
            Rule::OneOf(&[&["from"], &["wall_color", "wall_balance"]]),
            Rule::NotWith(&["wall_color", "surface_albedo"], OF_MATERIAL),
            Rule::NotWith(&["wall_color", "color_space"], OF_MATERIAL),
            Rule::NotWith(&["wall_color", "to"], OF_WALLS),
            Rule::NotWith(&["wall_color", "set"], OF_WALLS),
            Rule::NotWith(&["wall_color", "to_unit"], OF_WALLS),
            Rule::NotWith(&["thin", "to"], OF_WALLS),
            Rule::NotWith(&["thin", "set"], OF_WALLS),
            Rule::NotWith(&["thin", "to_unit"], OF_WALLS),
            Rule::OnlyWith("g", &["thin", "wall_color"]),
            Rule::OnlyWith("eta", &["thin", "wall_color"]),
            Rule::OnlyWith("from_color_space", &["color_space"]),
        ],
    },
    about: About {
        more: "A value is one number for all channels, or three for red, green and blue. A missing length or color is 1, but for the color that light has behind a distance (glTF, Substrate), which needs both; a missing factor is the system's default (RenderMan's unitLength 0.1).\n\nA conversion keeps the width d between systems that draw Burley's profile, and the transport mean free path between systems that walk or solve a medium. From one kind to the other d = mfp/s(A), by the fit of the --configuration. It keeps the surface albedo, except for the random walks of Cycles. Scattering is isotropic; a g of pbrt, RISE, glTF or Cycles' walks is replaced by the similar isotropic medium.\n\nLengths are in --unit if a system takes scene units; Unreal's are always in cm, Unity HDRP's in mm and glTF's in m.\n\n--thin prints what a slab of the material reflects and passes, exactly, the thin-walled surface of OpenPBR, Blender and glTF that stands for it, and the errors of that, all as shares of the light that arrives. --wall-color and --wall-balance lead back: from the color of a thin wall, and the share of its light that goes to the other side, (1 + a)/2 of OpenPBR's subsurface_scatter_anisotropy a, to the slab that has such a reflectance and transmittance.\n\n--color-space prints the numbers for channels of other primaries: surface albedos change as colors do, and each new channel is the medium nearest to the mixture of old channels that it is. The rows `color space` have the share of the light that leaves at another radius than that mixture's: so, if lengths were kept, and if they changed as colors do. With --albedo-texture and --mfp-texture each texel is converted so, and two OpenEXR files are written; integers of the first are albedos by the curve of sRGB, in the primaries of --from-color-space. Linear color spaces: lin_rec709, acescg, lin_displayp3, lin_rec2020, lin_adobergb.\n\nSystems: translucid, cycles-burley, cycles-walk, cycles-walk-legacy, cycles-skin, cycles-2.9, eevee, pbrt, pbrt-v3-disney, appleseed, appleseed-random-walk, moonray, renderman, arnold, unreal, unreal-5.0, unreal-signed, substrate, hdrp, openpbr, gltf, adobe, karma, vray, materialx, rise, sort. Their parameters and rules: --from list, and docs/guide/conventions.md.",
        source: "Rules of systems as their rows cite them.",
        is_by_element: false,
        right: || {
            let material = || vec![Entry::new("from", "translucid:mfp=0.2"), Entry::new("surface_albedo", 0.6)];
            let said = |keys: [(&str, &str); 3]| keys.map(|(key, text)| Entry::new(key, text));
            let wall = ["wall_color", "wall_balance"].map(|key| Entry::new(key, 0.5));
            vec![
                [material(), vec![Entry::new("color_space", "acescg"), Entry::new("thin", 0.1)]].concat(),
                [&material()[..], &said([("to", "renderman"), ("set", "renderman:unitLength=1"), ("to_unit", "cm")])].concat(),
                wall.to_vec(),
            ]
        },
        examples: &[
            "--from list",
            "--from renderman:dmfp=8 --from renderman:dmfpColor=1,0.4,0.2 --surface-albedo 0.8,0.5,0.4 --unit cm",
            "--from cycles-burley:subsurface_radius=1,0.2,0.1 --from cycles-burley:subsurface_scale=0.05 --surface-albedo 0.8 --unit m --to unreal,hdrp --format text",
            "--from pbrt:sigma_a=0.0021,0.0041,0.0071 --from pbrt:sigma_s=2.19,2.62,3.00",
            "--from translucid:mfp=1 --surface-albedo 0.5 --to renderman --set renderman:unitLength=1",
            "--from translucid:mfp=0.3,0.2,0.1 --surface-albedo 0.8,0.6,0.3 --thin 0.2 --format text",
            "--wall-color 0.7,0.5,0.3 --wall-balance 0.4 --thin 0.2 --format text",
            "--from translucid:mfp=3.7,1.4,0.7 --surface-albedo 0.44,0.22,0.13 --color-space acescg --to openpbr",
            "--albedo-texture albedo.png --mfp-texture mfp.exr --color-space acescg -o textures",
        ],
        columns: &COLUMNS,
        formats: &["csv", "json", "text"],
    },
    form: |_| Form::Table,
    answer,
};

/// Keys in backquotes, which doors see as they spell them.
const NAMES: ArgumentNames = ArgumentNames {
    from: "`from`",
    surface_albedo: "`surface_albedo`",
    to: "`to`",
    set: "`set`",
    color_space: "`color_space`",
    from_color_space: "`from_color_space`",
};

fn answer(asked: &AskedConversion, _: &Context, _: &Control<'_>) -> Result<Answer, Unanswered> {
    if asked.from == ["list"] {
        return Ok(Answer { text: Some(list()), ..Answer::default() });
    }
    let Converted { numbers, notes } = asked.converted()?;
    let rows = numbers.iter().map(cells).collect();
    let table = DataTable { rows, ..DataTable::of(&COLUMNS) };
    Ok(Answer { tables: vec![table], text: Some(paragraphs(&numbers)), notes, ..Answer::default() })
}

impl AskedConversion {
    fn converted(&self) -> Result<Converted, Error> {
        let (g, eta) = (self.g.unwrap_or(0.0), self.eta.unwrap_or(1.0));
        if !self.wall_color.is_empty() {
            let found = wall_slab_numbers(&self.wall_color, &self.wall_balance, self.thin, g, eta);
            return found.map_err(|error| of_slab(&error));
        }
        let from = self.from_color_space.as_deref().unwrap_or(LINEAR_SPACES[0]);
        let conversion = Conversion {
            from: &settings(NAMES.from, &self.from)?,
            surface_albedo: &self.surface_albedo,
            unit: self.unit,
            to_unit: self.to_unit.unwrap_or(self.unit),
            to: &self.to.iter().flat_map(|systems| systems.split(',')).map(str::trim).collect::<Vec<_>>(),
            set: &settings(NAMES.set, &self.set)?,
            configuration: self.configuration,
            color_space: self.color_space.as_deref().map(|to| ColorSpaces { from, to }),
            names: NAMES,
        };
        let Some(thickness) = self.thin else { return Ok(conversion.run()?) };
        let (channels, shares) = conversion.material()?;
        let mut converted =
            thin_wall_numbers(&channels, thickness, g, eta).map_err(|error| of_slab(&error))?;
        converted.numbers.extend(shares);
        Ok(converted)
    }
}

/// The error of a slab, by the key of its parameter.
fn of_slab(error: &ParameterError) -> Error {
    let key = match error.parameter {
        "thickness" => "`thin`",
        "g" => "`g`",
        "eta" => "`eta`",
        "color" => "`wall_color`",
        "balance" => "`wall_balance`",
        _ => return Error::new(format!("the slab cannot be solved: {error}")),
    };
    Error::new(error.to_string().replacen(error.parameter, key, 1))
}

/// Settings of systems: SYSTEM:PARAMETER=VALUE each.
fn settings(key: &str, texts: &[String]) -> Result<Vec<Setting>, Error> {
    texts.iter().map(|text| setting(key, text)).collect()
}

fn setting(key: &str, text: &str) -> Result<Setting, Error> {
    let parts = text.split_once(':').and_then(|(system, rest)| {
        let (parameter, values) = rest.split_once('=')?;
        Some((system.trim(), parameter.trim(), values))
    });
    let Some((system, parameter, values)) = parts else {
        let known = conversion_system_names().join(", ");
        return Err(Error::new(format!("{key} is \"{text}\", but must be {SETTING}"))
            .with_help(format!("for example renderman:dmfp=2; the systems are {known}")));
    };
    let numbers: Result<Vec<f64>, _> = values.split(',').map(|number| number.trim().parse()).collect();
    match numbers {
        Ok(numbers) if matches!(numbers.len(), 1 | 3) => Ok(Setting::new(key, system, parameter, numbers)?),
        _ => {
            // A system that is not known is the first thing to say
            Setting::new(key, system, parameter, vec![0.0])?;
            Err(Error::new(format!(
                "{key} {system}:{parameter} is \"{values}\", but must be a number, or three with commas between"
            )))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn setting_takes_spaces_and_three_values() {
        let found = setting("", "renderman: subsurface-DmfpColor =1, 0.5,0.2").unwrap();
        assert_eq!(
            found,
            Setting::new("", "renderman", "subsurface-DmfpColor", vec![1.0, 0.5, 0.2]).unwrap()
        );
    }

    #[test]
    fn setting_refuses_what_is_none() {
        for text in ["", "renderman", "renderman:dmfp", "renderman:dmfp=", "renderman:dmfp=1,2", "maya:x=1"] {
            assert!(setting("`from`", text).is_err(), "{text}");
        }
    }

    #[test]
    fn help_has_all_names() {
        for names in [conversion_system_names().join(", "), LINEAR_SPACES.join(", ")] {
            assert!(CONVERT.about.more.contains(&names), "{names}");
        }
    }
}
