//! The extensions of glTF: what becomes of each, and the members of their objects.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use translucid_scene::{Place, SceneError};

use super::document::{Extensions, reason};
use crate::result::Result;

/// The part of a file in which an extension is read, or why it is not.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Support {
    /// It is read with the material that has it.
    OfMaterials,
    /// It is read where it stands.
    Elsewhere,
    /// It changes nothing of what a file shows at first.
    OfNoEffect,
    /// It is not read; the help is a way to do without it.
    NotRead(&'static str),
}

use Support::{Elsewhere, NotRead, OfMaterials, OfNoEffect};

const EXTENSIONS: [(&str, Support); 29] = [
    ("EXT_mesh_gpu_instancing", Elsewhere),
    ("EXT_meshopt_compression", Elsewhere),
    (
        "EXT_texture_avif",
        NotRead("gltf-transform png IN.glb OUT.glb --formats '*' makes PNG images of its textures"),
    ),
    ("EXT_texture_webp", Elsewhere),
    ("KHR_animation_pointer", OfNoEffect),
    ("KHR_draco_mesh_compression", Elsewhere),
    ("KHR_interactivity", OfNoEffect),
    ("KHR_lights_punctual", Elsewhere),
    ("KHR_materials_clearcoat", OfMaterials),
    ("KHR_materials_diffuse_transmission", OfMaterials),
    ("KHR_materials_emissive_strength", OfMaterials),
    ("KHR_materials_ior", OfMaterials),
    (
        "KHR_materials_pbrSpecularGlossiness",
        NotRead("gltf-transform metalrough IN.glb OUT.glb makes the materials ones that are read"),
    ),
    ("KHR_materials_scatter", OfMaterials),
    ("KHR_materials_specular", OfMaterials),
    ("KHR_materials_transmission", OfMaterials),
    ("KHR_materials_unlit", OfMaterials),
    ("KHR_materials_variants", OfNoEffect),
    ("KHR_materials_volume", OfMaterials),
    ("KHR_materials_volume_scatter", OfMaterials),
    ("KHR_mesh_quantization", Elsewhere),
    ("KHR_meshopt_compression", Elsewhere),
    ("KHR_node_hoverability", OfNoEffect),
    ("KHR_node_selectability", OfNoEffect),
    ("KHR_node_visibility", Elsewhere),
    (
        "KHR_texture_basisu",
        NotRead(
            "gltf-transform ktxdecompress IN.glb OUT.glb makes PNG images of its textures, by KTX-Software",
        ),
    ),
    ("KHR_texture_transform", Elsewhere),
    ("KHR_xmp", OfNoEffect),
    ("KHR_xmp_json_ld", OfNoEffect),
];

/// Returns whether the extension of a name is read, and where.
pub(super) fn support(name: &str) -> Support {
    const UNKNOWN: Support = NotRead(
        "without its name in extensionsRequired the file is read, and what the extension adds is left out",
    );
    EXTENSIONS.iter().find(|(known, _)| *known == name).map_or(UNKNOWN, |(_, support)| *support)
}

/// The members of an extension object.
pub(super) struct Members<'a> {
    members: Map<String, Value>,
    /// Part of the file that the object is, for messages.
    part: String,
    path: &'a Path,
}

impl<'a> Members<'a> {
    /// Members of the extension of a name, if it is there.
    ///
    /// # Errors
    /// It is there, but is no object.
    pub(super) fn of(
        extensions: &Extensions,
        name: &str,
        part: &str,
        path: &'a Path,
    ) -> Result<Option<Self>> {
        let Some(value) = extensions.get(name) else { return Ok(None) };
        let part = format!("{part}, {name}");
        match Map::deserialize(value) {
            Ok(members) => Ok(Some(Self { members, part, path })),
            Err(error) => Err(SceneError::at(Place::part(path, part), reason(&error))),
        }
    }

    /// A member; none where it is missing or null.
    ///
    /// # Errors
    /// It is not what its specification says.
    pub(super) fn get<T: DeserializeOwned>(&self, key: &str) -> Result<Option<T>> {
        Option::deserialize(self.members.get(key).unwrap_or(&Value::Null)).map_err(|error| {
            SceneError::at(Place::part(self.path, format!("{}, {key}", self.part)), reason(&error))
        })
    }

    /// A member that the extension is nothing without.
    ///
    /// # Errors
    /// As [`get`](Self::get), or it is missing.
    pub(super) fn require<T: DeserializeOwned>(&self, key: &str) -> Result<T> {
        let missing = || SceneError::at(Place::part(self.path, &self.part), format!("missing field `{key}`"));
        self.get(key)?.ok_or_else(missing)
    }
}
