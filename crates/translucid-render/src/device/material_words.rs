//! The words of a material, and the constants by which the shaders find them: both follow from one list.
//!
//! ```text
//! inputs    fields that textures may vary, INPUT_WORDS each
//! numbers   other fields, a word each
//! derived   DERIVED, what follows from several fields or from other things of the scene
//! ```
//!
//! Fields are those of [`Material::DESCRIPTION`], and their constants bear the keys in capitals. The constant of an input is its
//! number among the inputs, any other is a place behind the first word of the material.

use std::cmp::Reverse;

use glam::Vec3;
use translucid_scene::description::{Choice, SceneSlot};
use translucid_scene::{CameraVisibility, Material, ScalarInput, TextureRef, WalkSurface};

use crate::subsurface::transport::SubsurfaceTransport;
use crate::surface::{self, WalkMedium};
use crate::world::World;
use Value::{Color, Number, Walk};

/// Words of an input: three factors, a texture (below 0: none), what of it counts: 0 its color, 1 that and vertex colors, from 2
/// on a channel.
const INPUT_WORDS: usize = 5;

/// Fields without words: they have their say in [`DERIVED`], in the tables of what is below the surface, and the tint in the
/// color that is that of crossings.
const FIELDS_BELOW: [&str; 10] = [
    "layer",
    "subsurface_model",
    "subsurface_parameter",
    "subsurface_configuration",
    "subsurface_texture_at",
    "subsurface_normalization",
    "subsurface_eta",
    "subsurface_flights",
    "transmission_depth",
    "transmission_tint",
];

/// Kinds of what is below a surface; 0 is nothing.
const WALK_BELOW: usize = 1;
const PROFILE_BELOW: usize = 2;

/// Words besides those of fields, by their names in the shaders.
const DERIVED: [(&str, Value); 13] = [
    ("NORMAL_SCALE", Number(|of| of.material.geometry_normal.as_ref().map_or(1.0, |map| map.scale))),
    ("BELOW_KIND", Number(|of| below_kind(of.transport) as f32)),
    ("WALK_SURFACE", Walk(|medium| f32::from(medium.surface as u8))),
    ("WALK_ETA", Walk(|medium| medium.eta)),
    ("WALK_G", Walk(|medium| medium.g)),
    ("MOST_FLIGHTS", Walk(|medium| medium.most_flights as f32)),
    // Tables of the walk's medium, or of the profile's kernel: this and the next two are places behind the media
    ("MEDIUM", Number(|of| of.below_at as f32)),
    // The pairing of a profile's exits and entries, 0 where exits count alone
    ("PAIRING", Number(|of| of.pairing_at as f32)),
    // The smooth profile by which shapes are normalized, 0 for none
    ("NORMALIZATION", Number(|of| of.smooth_at as f32)),
    ("REFLECTANCES", Number(|of| of.reflectances_at as f32)),
    ("LETS_LIGHT_THROUGH", Number(|of| flag(of.world.surfaces.lets_light_through(of.index)))),
    ("IS_MATCHED", Number(|of| flag(of.world.media.of(of.index).is_some()))),
    ("ABSORPTION", Color(|of| surface::absorption(of.material))),
];

/// A way to derive words.
enum Value {
    /// A word.
    Number(fn(&PlacedMaterial<'_>) -> f32),
    /// A word, which is 0 where there is no walk.
    Walk(fn(&WalkMedium) -> f32),
    /// Three words.
    Color(fn(&PlacedMaterial<'_>) -> Vec3),
}

/// A material in its scene, and the places of its tables.
pub(super) struct PlacedMaterial<'a> {
    pub(super) material: &'a Material,
    /// Number of the material.
    pub(super) index: usize,
    pub(super) world: &'a World,
    pub(super) transport: &'a SubsurfaceTransport,
    pub(super) below_at: usize,
    pub(super) pairing_at: usize,
    pub(super) smooth_at: usize,
    pub(super) reflectances_at: usize,
}

impl PlacedMaterial<'_> {
    /// The words, given the numbers of textures.
    pub(super) fn words(&self, number_of: &mut dyn FnMut(&TextureRef) -> usize) -> Vec<f32> {
        let mut words: Vec<f32> =
            fields(self.material, number_of).into_iter().flat_map(|(_, words)| words).collect();
        for (_, value) in DERIVED {
            match value {
                Number(number) => words.push(number(self)),
                Walk(number) => words.push(self.transport.medium().map_or(0.0, |medium| number(medium))),
                Color(color) => words.extend(color(self).to_array()),
            }
        }
        words
    }
}

/// The constants by their names in the shaders: places of words, their number, and what some of them may be.
pub(super) fn material_constants() -> Vec<(String, usize)> {
    let fields = fields(&Material::default(), &mut |_| 0);
    let inputs = fields.iter().filter(|(_, words)| words.len() == INPUT_WORDS).count();
    let (mut constants, mut place) = (Vec::new(), 0);
    for (number, (key, words)) in fields.iter().enumerate() {
        constants.push((key.to_uppercase(), if number < inputs { number } else { place }));
        place += words.len();
    }
    for (name, value) in DERIVED {
        constants.push((name.to_owned(), place));
        place += if matches!(value, Color(_)) { 3 } else { 1 };
    }
    let others = [
        ("INPUTS", inputs),
        ("INPUT_WORDS", INPUT_WORDS),
        ("MATERIAL_WORDS", place),
        ("NOT_SEEN", number_of_choice(&CameraVisibility::None)),
        ("SHADOWS_SEEN", number_of_choice(&CameraVisibility::Shadow)),
        ("WALK_BELOW", WALK_BELOW),
        ("PROFILE_BELOW", PROFILE_BELOW),
        ("CLEAR", WalkSurface::Clear as usize),
        ("DIFFUSE_SURFACE", WalkSurface::Diffuse as usize),
        ("ROUGH", WalkSurface::Rough as usize),
        ("SKIN", WalkSurface::Skin as usize),
    ];
    constants.extend(others.map(|(name, value)| (name.to_owned(), value)));
    constants
}

/// The fields that have words by their keys: inputs, then numbers.
fn fields(
    material: &Material,
    number_of: &mut dyn FnMut(&TextureRef) -> usize,
) -> Vec<(&'static str, Vec<f32>)> {
    let mut material = Material { transmission_color: *material.crossing_tint(), ..material.clone() };
    let fields = Material::DESCRIPTION.fields.iter().filter(|field| !FIELDS_BELOW.contains(&field.key()));
    let words = fields.map(|field| (field.key(), field_words((field.slot)(&mut material), number_of)));
    let mut words: Vec<_> = words.collect();
    words.sort_by_key(|(_, words)| Reverse(words.len()));
    words
}

/// The words of a field: those of an input, a number, or none where devices know nothing of its kind.
fn field_words(slot: SceneSlot<'_>, number_of: &mut dyn FnMut(&TextureRef) -> usize) -> Vec<f32> {
    let mut input = |factor: Vec3, texture: Option<TextureRef>, what_counts: usize| {
        let texture = texture.map_or(-1.0, |texture| number_of(&texture) as f32);
        vec![factor.x, factor.y, factor.z, texture, what_counts as f32]
    };
    match slot {
        SceneSlot::Color(color, _) => input(color.factor, color.texture, color.vertex_color.into()),
        SceneSlot::Scalar(ScalarInput { factor, texture }, _) => {
            let channel = texture.map_or(0, |(_, channel)| channel as usize);
            input(Vec3::splat(*factor), texture.map(|(texture, _)| texture), 2 + channel)
        }
        SceneSlot::NormalMap(map) => input(Vec3::ONE, map.map(|map| map.texture), 0),
        SceneSlot::Number(number, _) | SceneSlot::Length(number, _) => vec![*number],
        SceneSlot::Flag(is_set) => vec![flag(*is_set)],
        SceneSlot::Word(choice) => vec![number_of_choice(choice) as f32],
        _ => Vec::new(),
    }
}

fn number_of_choice(choice: &dyn Choice) -> usize {
    choice.names().iter().position(|name| *name == choice.name()).unwrap_or(0)
}

fn below_kind(transport: &SubsurfaceTransport) -> usize {
    match transport {
        SubsurfaceTransport::Lambertian => 0,
        SubsurfaceTransport::Walk(_) => WALK_BELOW,
        SubsurfaceTransport::Probes(_) | SubsurfaceTransport::Shared(_) => PROFILE_BELOW,
    }
}

fn flag(is_set: bool) -> f32 {
    f32::from(u8::from(is_set))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_has_words_or_is_below() {
        let constants = material_constants();
        for key in Material::DESCRIPTION.fields.iter().map(|field| field.key()) {
            let has_words = constants.iter().any(|(name, _)| *name == key.to_uppercase());
            assert_ne!(has_words, FIELDS_BELOW.contains(&key), "{key}");
        }
    }
}
