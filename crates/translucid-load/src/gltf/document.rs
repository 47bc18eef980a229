//! The JSON text as data: the parts of the glTF 2.0 schema that make a picture.
//!
//! Each array's elements are parsed one by one, so that a message can name the element; indices are
//! checked where they are used ([`Document::get`]).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::{Map, Value};
use translucid_scene::{Place, SceneError};

use super::uri::clip;
use crate::result::Result;

/// Extension objects by name.
pub(super) type Extensions = Map<String, Value>;

/// Accessor indices by attribute name.
pub(super) type Attributes = BTreeMap<String, usize>;

/// An element of one of the document's arrays.
pub(super) trait Element: DeserializeOwned {
    /// Name in messages.
    const KIND: &'static str;

    /// Key of its array in the document.
    const KEY: &'static str;
}

macro_rules! elements {
    ($($type:ident $kind:literal $key:literal;)*) => {
        $(impl Element for $type {
            const KIND: &'static str = $kind;
            const KEY: &'static str = $key;
        })*
    };
}

elements! {
    Accessor "accessor" "accessors";
    Buffer "buffer" "buffers";
    BufferView "bufferView" "bufferViews";
    Camera "camera" "cameras";
    Image "image" "images";
    Material "material" "materials";
    Mesh "mesh" "meshes";
    Node "node" "nodes";
    PunctualLight "light" "lights";
    Sampler "sampler" "samplers";
    Scene "scene" "scenes";
    Skin "skin" "skins";
    Texture "texture" "textures";
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparseArray,
    pub(super) values: SparseArray,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseArray {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    /// Component type of indices alone; 0 is no type.
    #[serde(default)]
    pub(super) component_type: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: usize,
    pub(super) uri: Option<String>,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

#[derive(Deserialize)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) perspective: Option<Perspective>,
    pub(super) orthographic: Option<Orthographic>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Perspective {
    pub(super) aspect_ratio: Option<f64>,
    pub(super) yfov: f64,
}

/// Half the width and height of what a camera sees \[m\].
#[derive(Deserialize)]
pub(super) struct Orthographic {
    pub(super) xmag: f64,
    pub(super) ymag: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Material {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: MetallicRoughness,
    pub(super) normal_texture: Option<TextureInfo>,
    pub(super) emissive_texture: Option<TextureInfo>,
    pub(super) emissive_factor: [f32; 3],
    pub(super) alpha_mode: AlphaMode,
    pub(super) alpha_cutoff: Option<f32>,
    pub(super) extensions: Extensions,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Default)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum AlphaMode {
    #[default]
    Opaque,
    Mask,
    Blend,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct MetallicRoughness {
    pub(super) base_color_factor: Option<[f32; 4]>,
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: Option<f32>,
    pub(super) roughness_factor: Option<f32>,
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: usize,
    #[serde(default)]
    pub(super) tex_coord: usize,
    /// Strength of the bumps, in normal textures alone.
    #[serde(default = "one")]
    pub(super) scale: f32,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) primitives: Vec<Primitive>,
    #[serde(default)]
    pub(super) weights: Vec<f64>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    #[serde(default)]
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    pub(super) mode: Option<u32>,
    #[serde(default)]
    pub(super) targets: Vec<Attributes>,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

#[derive(Deserialize)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) camera: Option<usize>,
    pub(super) skin: Option<usize>,
    /// Weights of the mesh's morph targets at this node, in place of the mesh's own.
    pub(super) weights: Option<Vec<f64>>,
    pub(super) matrix: Option<[f64; 16]>,
    #[serde(default)]
    pub(super) translation: [f64; 3],
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

/// An element of KHR_lights_punctual.
#[derive(Deserialize)]
pub(super) struct PunctualLight {
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) color: Option<[f64; 3]>,
    #[serde(default = "one")]
    pub(super) intensity: f64,
    pub(super) spot: Option<SpotCone>,
}

#[derive(Clone, Copy, Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct SpotCone {
    pub(super) inner_cone_angle: f64,
    pub(super) outer_cone_angle: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Sampler {
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
    pub(super) mag_filter: Option<u32>,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) inverse_bind_matrices: Option<usize>,
    /// The nodes that move the skin.
    pub(super) joints: Vec<usize>,
}

#[derive(Deserialize)]
pub(super) struct Texture {
    pub(super) sampler: Option<usize>,
    pub(super) source: Option<usize>,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

fn one<T: From<f32>>() -> T {
    T::from(1.0)
}

/// An array of the document with the elements' names.
pub(super) struct Elements<T> {
    items: Vec<T>,
    names: Vec<Option<String>>,
    /// The file, for messages.
    path: PathBuf,
}

impl<T: Element> Elements<T> {
    /// An element by an index in the file, which may be anything.
    ///
    /// # Errors
    /// There is no such element; `user` is the part of the file that refers to it.
    pub(super) fn get(&self, index: usize, user: &str) -> Result<&T> {
        self.items.get(index).ok_or_else(|| {
            let message = format!("refers to {} {index}, but the file has {}", T::KIND, self.items.len());
            SceneError::at(Place::part(&self.path, user), message)
        })
    }

    pub(super) fn as_slice(&self) -> &[T] {
        &self.items
    }

    pub(super) fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Name of an element in messages: its kind, index and name.
    pub(super) fn label(&self, index: usize) -> String {
        label(T::KIND, index, self.names.get(index).and_then(Option::as_deref))
    }
}

fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("{kind} {index} \"{}\"", clip(name)),
        None => format!("{kind} {index}"),
    }
}

/// A parsed document.
pub(super) struct Document {
    pub(super) accessors: Elements<Accessor>,
    pub(super) buffers: Elements<Buffer>,
    pub(super) views: Elements<BufferView>,
    pub(super) cameras: Elements<Camera>,
    pub(super) images: Elements<Image>,
    pub(super) materials: Elements<Material>,
    pub(super) meshes: Elements<Mesh>,
    pub(super) nodes: Elements<Node>,
    pub(super) lights: Elements<PunctualLight>,
    pub(super) samplers: Elements<Sampler>,
    pub(super) scenes: Elements<Scene>,
    pub(super) skins: Elements<Skin>,
    pub(super) textures: Elements<Texture>,
    /// Index of the default scene.
    pub(super) scene: Option<usize>,
    pub(super) extensions_required: Vec<String>,
    /// Number of animations.
    pub(super) animations: usize,
}

impl Document {
    /// Parses the JSON text.
    pub(super) fn parse(json: &[u8], path: &Path) -> Result<Self> {
        let mut root: Extensions =
            serde_json::from_slice(json).map_err(|error| syntax_error(&error, path))?;
        check_version(&root, path)?;
        let extensions: Extensions = field(&mut root, "extensions", path)?.unwrap_or_default();
        let mut lights = match extensions.get("KHR_lights_punctual") {
            Some(Value::Object(object)) => object.clone(),
            _ => Extensions::new(),
        };
        Ok(Self {
            accessors: elements(&mut root, path)?,
            buffers: elements(&mut root, path)?,
            views: elements(&mut root, path)?,
            cameras: elements(&mut root, path)?,
            images: elements(&mut root, path)?,
            materials: elements(&mut root, path)?,
            meshes: elements(&mut root, path)?,
            nodes: elements(&mut root, path)?,
            lights: elements(&mut lights, path)?,
            samplers: elements(&mut root, path)?,
            scenes: elements(&mut root, path)?,
            skins: elements(&mut root, path)?,
            textures: elements(&mut root, path)?,
            scene: field(&mut root, "scene", path)?,
            extensions_required: field(&mut root, "extensionsRequired", path)?.unwrap_or_default(),
            animations: field::<Vec<IgnoredAny>>(&mut root, "animations", path)?.map_or(0, |all| all.len()),
        })
    }
}

fn syntax_error(error: &serde_json::Error, path: &Path) -> SceneError {
    let text = error.to_string();
    let reason = text.split(" at line ").next().unwrap_or(&text);
    let place =
        Place::part(path, format!("line {} column {} of the JSON text", error.line(), error.column()));
    SceneError::at(place, format!("this is not glTF: {reason}"))
}

/// A parser's message; it quotes what it found, however long that is.
pub(super) fn reason(error: &serde_json::Error) -> String {
    let mut text = error.to_string();
    if let Some((cut, _)) = text.char_indices().nth(200) {
        text.truncate(cut);
        text.push('…');
    }
    text
}

fn check_version(root: &Extensions, path: &Path) -> Result<()> {
    let place = || Place::part(path, "asset");
    let stated = |key: &str| root.get("asset").and_then(|asset| asset.get(key)).and_then(Value::as_str);
    match (stated("version"), stated("minVersion")) {
        (Some(_), Some(least)) if least != "2.0" => {
            let message = format!("the file needs a reader of glTF {}, but this one reads 2.0", clip(least));
            Err(SceneError::at(place(), message))
        }
        (Some(version), _) if version.starts_with("2.") => Ok(()),
        (Some(version), _) => {
            Err(SceneError::at(place(), format!("glTF version \"{}\" is not read, only 2.x", clip(version))))
        }
        (None, _) => Err(SceneError::at(place(), "this is not glTF: \"version\" is missing")),
    }
}

/// A top-level value.
fn field<T: DeserializeOwned>(root: &mut Extensions, key: &str, path: &Path) -> Result<Option<T>> {
    let Some(value) = root.remove(key) else { return Ok(None) };
    serde_json::from_value(value)
        .map(Some)
        .map_err(|error| SceneError::at(Place::part(path, format!("\"{key}\"")), reason(&error)))
}

/// A top-level array; none is an empty one.
fn elements<T: Element>(root: &mut Extensions, path: &Path) -> Result<Elements<T>> {
    let values: Vec<Value> = field(root, T::KEY, path)?.unwrap_or_default();
    let mut found =
        Elements { items: Vec::with_capacity(values.len()), names: Vec::new(), path: path.to_owned() };
    for (index, value) in values.into_iter().enumerate() {
        let name = value.get("name").and_then(Value::as_str).map(String::from);
        let item = serde_json::from_value(value).map_err(|error| {
            let place = Place::part(path, label(T::KIND, index, name.as_deref()));
            SceneError::at(place, reason(&error))
        })?;
        found.items.push(item);
        found.names.push(name);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(json: &str) -> String {
        Document::parse(json.as_bytes(), Path::new("x.gltf")).err().map(|e| e.to_string()).expect("an error")
    }

    #[test]
    fn labels_are_kind_index_and_name() {
        let json = r#"{"asset":{"version":"2.0"},"materials":[{}],"nodes":[{"name":"a"}]}"#;
        let document = Document::parse(json.as_bytes(), Path::new("x.gltf")).unwrap();
        assert_eq!(document.nodes.label(0), "node 0 \"a\"");
        assert_eq!(document.materials.label(0), "material 0");
    }

    #[test]
    fn parse_names_the_element_of_every_fault() {
        let with = |rest: &str| failure(&format!(r#"{{"asset":{{"version":"2.0"}},{rest}}}"#));
        assert_eq!(
            with(r#""accessors":[{"componentType":5126,"type":"VEC3","count":1},{"name":"b"}]"#),
            "x.gltf, accessor 1 \"b\": missing field `componentType`"
        );
        assert!(
            with(r#""nodes":[{"children":[-1]}]"#).starts_with("x.gltf, node 0: invalid value: integer `-1`")
        );
        assert!(with(r#""nodes":{}"#).starts_with("x.gltf, \"nodes\": invalid type: map"));
        assert!(
            with(r#""materials":[{"alphaMode":"GLASS"}]"#).contains("material 0: unknown variant `GLASS`")
        );
        assert!(with(r#""scene":"first""#).starts_with("x.gltf, \"scene\": invalid type"));
    }

    #[test]
    fn parse_names_line_and_column_of_broken_json() {
        assert_eq!(
            failure("{\n  \"asset\": nonsense\n}"),
            "x.gltf, line 2 column 13 of the JSON text: this is not glTF: expected ident"
        );
        assert!(failure("").contains("line 1 column 0"));
        assert!(failure(&"[".repeat(100_000)).contains("this is not glTF"));
        assert!(failure(r#"{"asset":{"version":"1.0"}}"#).contains("glTF version \"1.0\" is not read"));
        assert!(failure("{}").contains("\"version\" is missing"));
        let later = failure(r#"{"asset":{"version":"2.1","minVersion":"2.1"}}"#);
        assert!(later.contains("the file needs a reader of glTF 2.1, but this one reads 2.0"), "{later}");
    }
}
