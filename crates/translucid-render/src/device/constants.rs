//! Constants of the layout, which are written in front of the shaders.

use super::instances::INSTANCE_WORDS;
use super::lights::LIGHT_CONSTANTS;
use super::material_words::material_constants;
use super::materials::{ALBEDOS, TEXTURE_WORDS};
use super::scene::Header;
use super::triangles::MOST_LEVELS;
use crate::render::FILTER_TABLE;
use crate::subsurface::transport::points::smooth_profile::{CELL_BITS, OCTAVES_ABOVE, OCTAVES_BELOW};
use crate::subsurface::transport::points::words::{CLUSTER_WORDS, GROUP_WORDS, SURFEL_WORDS};

/// Places of the header, by their names in the shaders.
const HEADER: [(&str, Header); Header::Count as usize - 2] = [
    ("MATERIALS", Header::Materials),
    ("TEXTURES", Header::Textures),
    ("MEDIA", Header::Media),
    ("LIGHTS", Header::Lights),
    ("FILTER", Header::Filter),
    ("SOBOL", Header::Sobol),
    ("IMAGES", Header::Images),
    ("MAX_DEPTH", Header::MaxDepth),
    ("MAX_DIFFUSE_DEPTH", Header::MaxDiffuseDepth),
    ("CAUSTICS", Header::Caustics),
    ("ATTRIBUTE_WORDS", Header::AttributeWords),
    ("UV", Header::Uv),
    ("TANGENT", Header::Tangent),
    ("COLOR", Header::Color),
    // Three words
    ("MIDDLE", Header::Middle),
    ("FARTHEST", Header::Farthest),
    ("SHADOWS_LOOK", Header::ShadowsLook),
    ("DIAGONAL", Header::Diagonal),
    ("INSTANCES", Header::Instances),
    ("TANGENTS", Header::Tangents),
    ("SHAPES", Header::Shapes),
];

/// Words of other things.
const OTHERS: [(&str, usize); 11] = [
    ("TEXTURE_WORDS", TEXTURE_WORDS),
    ("FILTER_INTERVALS", FILTER_TABLE),
    ("ALBEDOS", ALBEDOS),
    // Rows of four words
    ("INSTANCE_ROWS", INSTANCE_WORDS / 4),
    ("STACK", MOST_LEVELS as usize),
    ("GROUP_WORDS", GROUP_WORDS),
    ("CLUSTER_WORDS", CLUSTER_WORDS),
    ("SURFEL_WORDS", SURFEL_WORDS),
    ("CELL_BITS", CELL_BITS as usize),
    ("OCTAVES_BELOW", OCTAVES_BELOW as usize),
    ("OCTAVES_ABOVE", OCTAVES_ABOVE as usize),
];

/// Constants of the layout of a [`DeviceScene`](super::DeviceScene) by their names in the shaders.
pub fn shader_constants() -> impl Iterator<Item = (String, usize)> {
    let header = HEADER.into_iter().map(|(name, place)| (name, place as usize));
    let named = header.chain(OTHERS).chain(LIGHT_CONSTANTS).map(|(name, value)| (name.to_owned(), value));
    named.chain(material_constants())
}
