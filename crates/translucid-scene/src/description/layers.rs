//! The layers below a surface: `[[material.layer]]`.

use glam::Vec3;
use translucid_words::{Content, Entry, Fallback, Interval, Item, Key, Table, Value};

use super::vectors::Vectors;
use crate::{LayerMedium, SceneError, SubsurfaceLayer};

const THICKNESS: Interval = Interval::above(0.0, 1e9);
const MFP: Interval = Interval::closed(1e-9, 1e9);
const COEFFICIENT: Interval = Interval::closed(0.0, 1e9);
const COSINE: Interval = Interval::open(-1.0, 1.0);
/// Mean cosines for which a surface albedo is known.
const COSINE_OF_ALBEDO: Interval = Interval::closed(-0.95, 0.95);

impl SubsurfaceLayer {
    /// The keys of a layer.
    pub const KEYS: &[Key] = &[
        Key::new(
            "thickness",
            "length in (0, 1e9]: how far from the last layer, or the surface, the layer reaches",
            Fallback::Required,
        ),
        Key::new(
            "surface_albedo",
            "color in [0, 1], with `mfp`: the share of diffuse light that an endless layer of this medium would return without a boundary",
            Fallback::Words("must be given, or `scattering`"),
        ),
        Key::new(
            "mfp",
            "color, a length in [1e-9, 1e9]: mean free path of each channel",
            Fallback::Words("–"),
        ),
        Key::new(
            "scattering",
            "color in [0, 1e9], with `absorption`: coefficient σ_s of each channel, per unit of length",
            Fallback::Words("–"),
        ),
        Key::new(
            "absorption",
            "color in [0, 1e9]: coefficient σ_a of each channel, per unit of length",
            Fallback::Words("–"),
        ),
        Key::new(
            "g",
            "number in (-1, 1), beside `surface_albedo` in [-0.95, 0.95]: mean cosine of the phase function",
            Fallback::Number(0.0),
        ),
    ];

    /// The mean cosines that are allowed.
    fn cosines(&self) -> Interval {
        match self.medium {
            LayerMedium::Appearance { .. } => COSINE_OF_ALBEDO,
            LayerMedium::Coefficients { .. } => COSINE,
        }
    }

    fn read(table: Table<'_>) -> Result<Self, SceneError> {
        let keys: Vec<&str> = Self::KEYS.iter().map(|key| key.name).collect();
        let table = table.allow(&keys)?;
        let numbers = |key, range: Interval| match table.require(key)? {
            item if item.as_text().is_some() => Err(item.mismatch("a number or three numbers")),
            item => item.color(range),
        };
        let thickness = table.require("thickness")?.number(THICKNESS)?;
        let has_albedo = table.get("surface_albedo").or(table.get("mfp"));
        let has_coefficients = table.get("scattering").or(table.get("absorption"));
        let medium = match (has_albedo, has_coefficients) {
            (Some(_), None) => LayerMedium::Appearance {
                surface_albedo: table.require("surface_albedo")?.color(Interval::UNIT)?,
                mfp: numbers("mfp", MFP)?,
            },
            (None, Some(_)) => LayerMedium::Coefficients {
                scattering: numbers("scattering", COEFFICIENT)?,
                absorption: numbers("absorption", COEFFICIENT)?,
            },
            (Some(one), Some(other)) => {
                let message = format!(
                    "{} and {} are given, but a layer has surface_albedo and mfp, or scattering and absorption",
                    one.path(),
                    other.path()
                );
                return Err(other.error(message));
            }
            (None, None) => {
                let path = table.path();
                let message = format!("{path} needs surface_albedo and mfp, or scattering and absorption");
                return Err(table.error(message));
            }
        };
        let layer = Self { thickness, medium, g: 0.0 };
        Ok(Self { g: table.read("g", 0.0, |item| item.number(layer.cosines()))?, ..layer })
    }

    fn write(&self) -> Value {
        let medium = match self.medium {
            LayerMedium::Appearance { surface_albedo, mfp } => {
                [("surface_albedo", surface_albedo), ("mfp", mfp)]
            }
            LayerMedium::Coefficients { scattering, absorption } => {
                [("scattering", scattering), ("absorption", absorption)]
            }
        };
        let mut entries = vec![Entry::new("thickness", self.thickness)];
        entries.extend(medium.map(|(key, color)| Entry::new(key, Value::color(color.to_array()))));
        entries.push(Entry::new("g", self.g));
        entries.into()
    }

    fn visit(&mut self, name: &str, visit: &mut dyn FnMut(&str, &mut f32, Interval)) {
        let cosines = self.cosines();
        let colors: [(&str, &mut Vec3, Interval); 2] = match &mut self.medium {
            LayerMedium::Appearance { surface_albedo, mfp } => {
                [("surface_albedo", surface_albedo, Interval::UNIT), ("mfp", mfp, MFP)]
            }
            LayerMedium::Coefficients { scattering, absorption } => {
                [("scattering", scattering, COEFFICIENT), ("absorption", absorption, COEFFICIENT)]
            }
        };
        visit(&format!("{name}.thickness"), &mut self.thickness, THICKNESS);
        for (key, color, range) in colors {
            for (c, number) in color.as_mut().iter_mut().enumerate() {
                visit(&format!("{name}.{key}[{c}]"), number, range);
            }
        }
        visit(&format!("{name}.g"), &mut self.g, cosines);
    }
}

/// Layers from the surface inwards; the word "none" takes away those of a base.
pub(super) fn read_layers(item: &Item<'_>) -> Result<Vec<SubsurfaceLayer>, SceneError> {
    match item.content() {
        Content::Text(_) if item.is_none() => Ok(Vec::new()),
        Content::List(list) if list.is_empty() => Err(item.refuse("one layer or more, or \"none\"")),
        Content::List(_) => {
            item.tables(SubsurfaceLayer::MOST)?.into_iter().map(SubsurfaceLayer::read).collect()
        }
        _ => Err(item.mismatch("an array of tables, each with the header [[material.layer]]")),
    }
}

/// The value that [`read_layers`] reads.
pub(super) fn write_layers(layers: &[SubsurfaceLayer]) -> Value {
    if layers.is_empty() {
        return "none".into();
    }
    layers.iter().map(SubsurfaceLayer::write).collect::<Vec<_>>().into()
}

/// Visits every number of layers.
pub(super) fn visit_layers(
    key: &str,
    layers: &mut [SubsurfaceLayer],
    visit: &mut dyn FnMut(&str, &mut f32, Interval),
) {
    for (number, layer) in layers.iter_mut().enumerate() {
        layer.visit(&format!("{key}[{number}]"), visit);
    }
}
