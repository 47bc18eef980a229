//! Small glTF files made in memory.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use translucid_load::{MeshFile, parse_gltf};
use translucid_scene::{Mesh, Unit, Warning};

/// A document with one buffer.
#[derive(Clone)]
pub(crate) struct File {
    pub(crate) json: Value,
    pub(crate) bytes: Vec<u8>,
}

/// Result of reading a file.
pub(crate) struct Loaded {
    pub(crate) scene: MeshFile,
    pub(crate) warnings: Vec<String>,
}

impl Loaded {
    pub(crate) fn mesh(&self) -> &Mesh {
        &self.scene.objects[0].mesh
    }

    pub(crate) fn warned_of(&self, text: &str) -> bool {
        self.warnings.iter().any(|warning| warning.contains(text))
    }
}

/// Four corners of a tetrahedron.
pub(crate) const CORNERS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// Its faces, outward.
pub(crate) const FACES: [u32; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];

impl File {
    /// No mesh, no node.
    pub(crate) fn empty() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "buffers": [], "bufferViews": [], "accessors": [], "meshes": [], "nodes": []
        });
        Self { json, bytes: Vec::new() }
    }

    /// The two chunks of a GLB.
    pub(crate) fn of_glb(bytes: &[u8]) -> Self {
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let json = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
        Self { json, bytes: bytes[28 + length..].to_vec() }
    }

    /// A tetrahedron in one node.
    pub(crate) fn tetrahedron() -> Self {
        let mut file = Self::empty();
        let position = file.floats("VEC3", &CORNERS);
        let indices = file.indices_u32(&FACES);
        file.push(
            "meshes",
            json!({
                "name": "tetrahedron",
                "primitives": [{ "attributes": { "POSITION": position }, "indices": indices }]
            }),
        );
        file.push("nodes", json!({ "name": "body", "mesh": 0 }));
        file
    }

    /// The tetrahedron with texture coordinates and a material.
    pub(crate) fn with_material(material: Value) -> Self {
        let mut file = Self::tetrahedron();
        let uv = file.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 0.75, 1.0, 1.0]);
        file.attribute("TEXCOORD_0", uv);
        file.push("materials", material);
        file.primitive()["material"] = json!(0);
        file
    }

    /// Appends to a top-level array.
    pub(crate) fn push(&mut self, key: &str, value: Value) -> usize {
        let array = &mut self.json[key];
        if array.is_null() {
            *array = json!([]);
        }
        let array = array.as_array_mut().unwrap();
        array.push(value);
        array.len() - 1
    }

    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    pub(crate) fn attribute(&mut self, name: &str, accessor: usize) {
        self.primitive()["attributes"][name] = json!(accessor);
    }

    /// Appends bytes, aligned to 4, and a view of them.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    pub(crate) fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(shape, 5126, values.len(), &bytes)
    }

    pub(crate) fn indices_u32(&mut self, values: &[u32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor("SCALAR", 5125, values.len(), &bytes)
    }

    /// An accessor over its own view; `numbers` is how many numbers the bytes hold.
    pub(crate) fn accessor(&mut self, shape: &str, component: u32, numbers: usize, bytes: &[u8]) -> usize {
        let components = match shape {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let view = self.view(bytes);
        let count = numbers / components;
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "type": shape, "count": count }),
        )
    }

    /// The file as JSON with its buffer in a data URI.
    pub(crate) fn gltf(&self) -> Vec<u8> {
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        self.with_buffer(&json!({ "byteLength": self.bytes.len(), "uri": uri }))
    }

    /// The file as JSON with its buffer under a name.
    pub(crate) fn gltf_with_external(&self, uri: &str) -> Vec<u8> {
        self.with_buffer(&json!({ "byteLength": self.bytes.len(), "uri": uri }))
    }

    /// The file as GLB.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut json = self.with_buffer(&json!({ "byteLength": self.bytes.len() }));
        json.resize(json.len().next_multiple_of(4), b' ');
        glb(&[(b"JSON", &json), (b"BIN\0", &self.bytes)])
    }

    fn with_buffer(&self, buffer: &Value) -> Vec<u8> {
        let mut json = self.json.clone();
        // A test of broken buffers brings its own.
        if json["buffers"].as_array().is_some_and(Vec::is_empty) {
            json["buffers"] = json!([buffer]);
        }
        serde_json::to_vec(&json).unwrap()
    }

    pub(crate) fn load(&self) -> Loaded {
        self.load_in(Unit::Meter)
    }

    pub(crate) fn load_in(&self, unit: Unit) -> Loaded {
        parse(&self.glb(), unit).unwrap()
    }
}

/// Reads bytes as the file `x.gltf` of a folder that does not exist.
pub(crate) fn parse(bytes: &[u8], unit: Unit) -> Result<Loaded, String> {
    let mut warnings: Vec<Warning> = Vec::new();
    let scene =
        parse_gltf(bytes, Path::new("nowhere/x.gltf"), unit, &mut warnings).map_err(|e| e.to_string())?;
    Ok(Loaded { scene, warnings: warnings.iter().map(ToString::to_string).collect() })
}

pub(crate) fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut body = Vec::new();
    for (kind, data) in chunks {
        body.extend((data.len() as u32).to_le_bytes());
        body.extend(*kind);
        body.extend(*data);
    }
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((12 + body.len() as u32).to_le_bytes());
    bytes.extend(body);
    bytes
}

/// A PNG of RGBA pixels.
pub(crate) fn png(width: u32, height: u32, pixels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(pixels.as_flattened()).unwrap();
    bytes
}
