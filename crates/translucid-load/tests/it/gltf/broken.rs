//! Broken files: each is refused with a message that names the file and the place in it.

use serde_json::{Value, json};
use translucid_load::load_gltf;
use translucid_scene::Unit;

use super::builder::{File, glb, parse};

/// Asserts that bytes are refused, and that the message names the file and contains some words.
#[track_caller]
pub(crate) fn refused(bytes: &[u8], words: &[&str]) {
    let message = parse(bytes, Unit::Meter).err().expect("the file is broken, but it was read");
    assert!(message.starts_with("nowhere/x.gltf, "), "{message}");
    for word in words {
        assert!(message.contains(word), "no \"{word}\" in: {message}");
    }
    assert!(message.len() < 400, "{} characters: {message}", message.len());
}

/// The tetrahedron with a change must be refused.
#[track_caller]
fn refused_after(change: impl FnOnce(&mut File), words: &[&str]) {
    let mut file = File::tetrahedron();
    change(&mut file);
    refused(&file.glb(), words);
    refused(&file.gltf(), words);
}

/// Whatever of these values stands at its place in the tetrahedron's JSON must be refused.
#[track_caller]
fn refused_with(cases: &[(&str, Value, &[&str])]) {
    for (pointer, value, words) in cases {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let put = |file: &mut File| match file.json.pointer_mut(parent).unwrap() {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value.clone(),
            object => object[key] = value.clone(),
        };
        refused_after(put, words);
    }
}

#[test]
fn truncated_glb() {
    let bytes = File::tetrahedron().glb();
    for length in [4, 11, 12, 19, 30, bytes.len() - 1] {
        refused(&bytes[..length], &["byte "]);
    }
    refused(&bytes[..bytes.len() - 1], &["byte 8", "the GLB header states a length of"]);
    refused(&[], &["line 1 column 0"]);
    refused(b"glT", &["line 1 column 1", "this is not glTF"]);
}

#[test]
fn truncated_json() {
    let bytes = File::tetrahedron().gltf();
    refused(&bytes[..bytes.len() / 2], &["line 1 column ", "this is not glTF"]);
}

#[test]
fn wrong_chunk_lengths() {
    let good = File::tetrahedron().glb();
    let with = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    refused(&with(8, u32::MAX), &["byte 8", "4294967295"]);
    refused(&with(8, 0), &["byte 8"]);
    refused(&with(12, u32::MAX), &["byte 12", "a chunk states 4294967295 bytes"]);
    refused(&with(12, 10), &["byte 30: a chunk states"]);
    refused(&with(4, 1), &["byte 4", "version is 1"]);
    refused(&with(16, 0), &["byte 12", "must be \"JSON\""]);
}

#[test]
fn no_binary_chunk() {
    let file = File::tetrahedron();
    let mut json = file.json.clone();
    json["buffers"] = json!([{ "byteLength": 96, "name": "vertices" }]);
    let text = serde_json::to_vec(&json).unwrap();
    let words = ["buffer 0 \"vertices\"", "neither a URI nor a GLB binary chunk"];
    refused(&glb(&[(b"JSON", &text)]), &words);
    refused(&text, &words);
}

#[test]
fn another_version() {
    refused_with(&[("/asset/version", json!("1.0"), &["asset", "glTF version \"1.0\" is not read"])]);
    refused(b"{\"format\": 3}", &["asset", "\"version\" is missing"]);
}

#[test]
fn other_text() {
    refused(b"ply\nformat ascii 1.0\n", &["line 1 column 1", "this is not glTF"]);
    refused(b"{\n \"asset\": {\n", &["line 3 column 0"]);
    refused(b"[]", &["this is not glTF"]);
    refused(b"\xff\xfe\0\0", &["this is not glTF"]);
}

#[test]
fn wrong_types_in_json() {
    refused_with(&[
        ("/nodes/0/mesh", json!("0"), &["node 0 \"body\"", "invalid type"]),
        ("/nodes/0/matrix", json!([1, 2, 3]), &["node 0 \"body\"", "invalid length 3"]),
        ("/meshes", json!({ "a": 1 }), &["\"meshes\"", "invalid type"]),
        ("/accessors/0/count", json!(-4), &["accessor 0", "-4"]),
        ("/accessors/1/count", json!(1.5), &["accessor 1", "1.5"]),
        ("/scene", json!(-1), &["\"scene\"", "-1"]),
        (
            "/accessors/0",
            json!({ "componentType": 5126, "type": "VEC3" }),
            &["accessor 0", "missing field `count`"],
        ),
    ]);
}

#[test]
fn missing_buffer_file() {
    let file = File::tetrahedron();
    refused(&file.gltf_with_external("gone.bin"), &["buffer 0", "nowhere/gone.bin cannot be read"]);
    refused(
        &file.gltf_with_external("https://example.org/a.bin"),
        &["buffer 0", "not a path relative to the glTF file"],
    );
    refused(&file.gltf_with_external("/dev/zero"), &["buffer 0", "not a path relative to the glTF file"]);
}

#[test]
fn broken_data_uri() {
    let file = File::tetrahedron();
    refused(
        &file.gltf_with_external("data:application/octet-stream;base64,AA*A"),
        &["buffer 0", "base64", "character 3"],
    );
    refused(&file.gltf_with_external("data:text/plain,hello"), &["buffer 0", "only base64 is read"]);
    refused(&file.gltf_with_external("data:;base64,AAAA"), &["buffer 0", "byteLength is 96", "has 3 bytes"]);
}

#[test]
fn wrong_byte_length() {
    let long = |file: &mut File| file.json["buffers"] = json!([{ "byteLength": u64::MAX }]);
    let mut file = File::tetrahedron();
    long(&mut file);
    refused(&file.glb(), &["buffer 0", "byteLength is 18446744073709551615", "has 96 bytes"]);
    file.json["buffers"] = json!([{ "byteLength": 8 }]);
    refused(&file.glb(), &["bufferView 0", "byteOffset 0 and byteLength 48", "buffer 0 has 8 bytes"]);
}

#[test]
fn wrong_buffer_views() {
    let strided = "accessor 0, POSITION of mesh 0";
    refused_with(&[
        ("/bufferViews/0/buffer", json!(5), &["bufferView 0", "buffer 5", "the file has 1"]),
        ("/bufferViews/1/byteLength", json!(u64::MAX), &["bufferView 1", "byteLength"]),
        ("/bufferViews/1/byteOffset", json!(u64::MAX), &["bufferView 1", "byteOffset"]),
        ("/bufferViews/0/byteStride", json!(4), &[strided, "4 bytes apart"]),
        ("/bufferViews/0/byteStride", json!(0), &[strided, "0 bytes apart"]),
        ("/bufferViews/0/byteStride", json!(u64::MAX), &[strided, "do not fit"]),
    ]);
}

#[test]
fn wrong_counts() {
    let place = "accessor 0, POSITION of mesh 0 \"tetrahedron\" primitive 0 of node 0 \"body\"";
    refused_with(&[
        ("/accessors/0/count", json!(5), &[place, "5 elements of 12 bytes"]),
        ("/accessors/0/count", json!(0), &[place, "count is 0"]),
        ("/accessors/0/count", json!(u64::MAX), &["mesh 0", "more than 268435456"]),
        ("/accessors/0/count", json!(1 << 27), &[place, "do not fit"]),
        ("/accessors/0/byteOffset", json!(4), &[place, "byteOffset 4"]),
        ("/accessors/0/byteOffset", json!(u64::MAX), &[place, "byteOffset 18446744073709551615"]),
        ("/accessors/1/count", json!(13), &["accessor 1, indices of mesh 0", "13 elements"]),
    ]);
}

#[test]
fn wrong_accessor_types() {
    let without_view = json!({ "componentType": 5126, "type": "VEC3", "count": 4 });
    refused_with(&[
        ("/accessors/0/componentType", json!(5124), &["accessor 0", "componentType is 5124"]),
        ("/accessors/0/type", json!("VEC2"), &["accessor 0, POSITION", "type is VEC2", "3 components"]),
        ("/accessors/0/type", json!("BOX"), &["accessor 0", "type is BOX"]),
        ("/accessors/1/type", json!("VEC3"), &["accessor 1, indices", "SCALAR"]),
        ("/accessors/1/componentType", json!(5126), &["accessor 1, indices", "5125"]),
        ("/accessors/0", without_view, &["accessor 0", "neither a bufferView nor sparse"]),
    ]);
}

#[test]
fn references_to_nothing() {
    let primitive = "mesh 0 \"tetrahedron\" primitive 0";
    let light = json!({ "KHR_lights_punctual": { "light": 2 } });
    refused_with(&[
        ("/nodes/0/mesh", json!(9), &["node 0 \"body\"", "refers to mesh 9, but the file has 1"]),
        ("/nodes/0/children", json!([4]), &["node 0 \"body\"", "refers to node 4"]),
        ("/nodes/0/camera", json!(0), &["node 0 \"body\"", "refers to camera 0, but the file has 0"]),
        ("/nodes/0/skin", json!(0), &["node 0 \"body\"", "refers to skin 0"]),
        ("/scene", json!(0), &["\"scene\"", "refers to scene 0"]),
        ("/scenes", json!([{ "nodes": [7] }]), &["scene 0", "refers to node 7"]),
        ("/meshes/0/primitives/0/indices", json!(77), &[primitive, "refers to accessor 77"]),
        (
            "/meshes/0/primitives/0/attributes/NORMAL",
            json!(1_u64 << 32),
            &["NORMAL of mesh 0", "refers to accessor 4294967296"],
        ),
        ("/meshes/0/primitives/0/material", json!(3), &[primitive, "refers to material 3"]),
        ("/accessors/0/bufferView", json!(44), &["accessor 0", "refers to bufferView 44"]),
        ("/nodes/0/extensions", light, &["node 0 \"body\"", "refers to light 2"]),
    ]);
}

#[test]
fn texture_references_to_nothing() {
    let textured = |rest: &[(&str, Value)], words: &[&str]| {
        let mut file = File::with_material(json!({ "name": "skin", "normalTexture": { "index": 0 } }));
        for (key, value) in rest {
            file.json[*key] = value.clone();
        }
        refused(&file.glb(), words);
    };
    textured(&[], &["material 0 \"skin\"", "refers to texture 0, but the file has 0"]);
    textured(&[("textures", json!([{ "source": 3 }]))], &["texture 0", "refers to image 3"]);
    let textures = json!([{ "source": 0, "sampler": 1 }]);
    textured(
        &[("textures", textures), ("images", json!([{ "uri": "a.png" }]))],
        &["texture 0", "refers to sampler 1"],
    );
}

#[test]
fn cyclic_nodes() {
    let ring = json!([{ "children": [1], "name": "a" }, { "children": [2] }, { "children": [0] }]);
    refused_with(&[
        ("/nodes/0/children", json!([0]), &["node 0 \"body\"", "its own ancestor"]),
        ("/nodes", ring, &["node 0 \"a\"", "its own ancestor"]),
    ]);
}

#[test]
fn nodes_with_two_parents() {
    let nodes = json!([{ "mesh": 0 }, { "children": [0], "name": "a" }, { "children": [0], "name": "b" }]);
    let twice = json!([{ "mesh": 0 }, { "children": [0, 0] }]);
    refused_with(&[
        ("/nodes", nodes, &["node 0", "child of both node 1 \"a\" and node 2 \"b\""]),
        ("/nodes", twice, &["node 0", "child of both node 1 and node 1"]),
        ("/scenes", json!([{ "nodes": [0, 0] }]), &["scene 0", "twice"]),
    ]);
    refused_after(
        |file| {
            file.push("nodes", json!({ "children": [0] }));
            file.json["scenes"] = json!([{ "nodes": [0] }]);
        },
        &["scene 0", "it lists node 0 \"body\", which is another node's child"],
    );
}

#[test]
fn huge_and_impossible_transforms() {
    let unusable = "none of the mesh's 4 triangles can be used";
    let mut matrix = [0.0; 16];
    matrix[3] = 1.0;
    refused_with(&[
        ("/nodes/0/scale", json!([1e30, 1e30, 1e30]), &["node 0 \"body\"", unusable]),
        ("/nodes/0/scale", json!([0, 0, 0]), &["node 0 \"body\"", unusable]),
        ("/nodes/0/matrix", json!(matrix), &["node 0 \"body\"", "last row"]),
    ]);
    refused_after(
        |file| {
            file.json["nodes"][0]["scale"] = json!([1e200, 1e200, 1e200]);
            file.push("nodes", json!({ "children": [0], "scale": [1e200, 1, 1] }));
        },
        &["node 0 \"body\"", "too large"],
    );
    let text = String::from_utf8(File::tetrahedron().gltf())
        .unwrap()
        .replace("\"mesh\":0", "\"mesh\":0,\"scale\":[1e999,1,1]");
    refused(text.as_bytes(), &["line 1 column ", "number out of range"]);
}

#[test]
fn no_triangles_anywhere() {
    let nothing = |bytes: &[u8]| {
        let message = parse(bytes, Unit::Meter).err().expect("nothing to render");
        assert_eq!(message, "nowhere/x.gltf: the file's scene has no triangles");
    };
    nothing(br#"{"asset":{"version":"2.0"}}"#);
    let mut file = File::tetrahedron();
    file.json["meshes"][0]["primitives"] = json!([]);
    nothing(&file.glb());
    file.json["nodes"] = json!([{}]);
    nothing(&file.glb());
}

#[test]
fn nan_vertices() {
    let spoil = |count: usize| {
        move |file: &mut File| file.bytes[..12 * count].as_chunks_mut().0.fill(f32::NAN.to_le_bytes())
    };
    refused_after(spoil(4), &["mesh 0 \"tetrahedron\" primitive 0 of node 0 \"body\"", "NaN"]);
    let mut file = File::tetrahedron();
    spoil(1)(&mut file);
    let loaded = file.load();
    assert_eq!(loaded.mesh().triangles.len(), 1);
    assert!(
        loaded.warned_of("mesh 0 \"tetrahedron\" primitive 0 of node 0 \"body\": 3 triangles"),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn vertex_indices_out_of_range() {
    let spoil = |count: usize| {
        move |file: &mut File| file.bytes[48..48 + 4 * count].as_chunks_mut().0.fill(99u32.to_le_bytes())
    };
    refused_after(spoil(12), &["mesh 0 \"tetrahedron\" primitive 0 of node 0 \"body\"", "out of range"]);
    let mut file = File::tetrahedron();
    spoil(1)(&mut file);
    let loaded = file.load();
    assert_eq!(loaded.mesh().triangles.len(), 3);
    assert!(
        loaded.warned_of("mesh 0 \"tetrahedron\" primitive 0 of node 0 \"body\": 1 triangle"),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn attributes_of_another_length() {
    let mut file = File::tetrahedron();
    let normals = file.floats("VEC3", &[0.0, 0.0, 1.0]);
    file.attribute("NORMAL", normals);
    let loaded = file.load();
    assert!(loaded.mesh().normals.is_empty());
    assert!(
        loaded.warned_of("primitive 0 of node 0 \"body\": 1 normals for 4 vertices"),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn broken_sparse_accessors() {
    let sparse = |sparse: Value, words: &[&str]| {
        let mut file = File::tetrahedron();
        let indices = file.view(&[1, 200]);
        let values = file.view(&[0; 24]);
        assert_eq!((indices, values), (2, 3));
        file.json["accessors"][0]["sparse"] = sparse;
        refused(&file.glb(), words);
    };
    let with = |count: u64, component: u32, view: u32| json!({ "count": count, "indices": { "bufferView": 2, "componentType": component }, "values": { "bufferView": view } });
    sparse(with(2, 5121, 3), &["accessor 0, POSITION", "sparse values", "index 200 is out of range"]);
    sparse(with(3, 5121, 3), &["accessor 0, POSITION", "3 elements of 1 bytes", "bufferView 2"]);
    sparse(with(u64::MAX, 5121, 3), &["accessor 0, POSITION", "sparse values"]);
    sparse(with(1, 77, 3), &["accessor 0, POSITION", "componentType is 77"]);
    sparse(with(1, 5121, 9), &["accessor 0, POSITION", "bufferView 9"]);
    let mut file = File::tetrahedron();
    file.json["accessors"][0]["sparse"] = with(0, 5121, 0);
    file.json["accessors"][0]["count"] = json!(1 << 27);
    file.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    refused(
        &file.glb(),
        &["accessor 0, POSITION", "count is 134217728, but the file's buffers have 96 bytes"],
    );
}

#[test]
fn too_many_triangles() {
    // Stated, not there: the limit must be kept before anything is read or allocated.
    let mut file = File::tetrahedron();
    file.primitive()["mode"] = json!(5);
    file.json["accessors"][1]["count"] = json!(1u64 << 40);
    file.json["bufferViews"][1]["byteLength"] = json!(1u64 << 42);
    let words = ["mesh 0 \"tetrahedron\" primitive 0", "more than 268435456 triangles", "instances count"];
    refused(&file.glb(), &words);
}

#[test]
fn extensions_that_are_required_and_not_read() {
    for (name, help) in [
        ("KHR_texture_basisu", "gltf-transform ktxdecompress"),
        ("KHR_materials_pbrSpecularGlossiness", "gltf-transform metalrough"),
        ("ADOBE_materials_thin_transparency", "without its name in extensionsRequired the file is read"),
    ] {
        let required = json!(["KHR_mesh_quantization", name]);
        let words = ["extensionsRequired: the file needs", name, "which is not read", help];
        refused_with(&[("/extensionsRequired", required, &words)]);
    }
    let mut file = File::tetrahedron();
    file.json["extensionsRequired"] =
        json!(["KHR_materials_ior", "KHR_xmp_json_ld", "EXT_meshopt_compression"]);
    assert!(file.load().warnings.is_empty());
}

#[test]
fn compressed_geometry() {
    for (key, value, words) in [
        ("count", json!(5), "its meshopt data is damaged"),
        ("count", json!(1_u64 << 40), "256 times its size"),
        ("byteStride", json!(6), "cannot have 4 elements of 6 bytes"),
        ("mode", json!("TRIANGLES"), "cannot have 4 elements of 12 bytes"),
        ("filter", json!("OCTAHEDRAL"), "cannot have 4 elements of 12 bytes"),
        ("buffer", json!(7), "refers to buffer 7"),
        ("byteLength", json!(1_u64 << 40), "but buffer 0 has"),
        ("mode", json!("WAVELETS"), "unknown variant `WAVELETS`"),
    ] {
        let mut file = File::tetrahedron();
        file.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] =
            json!({ "buffer": 0, "byteLength": 48, "byteStride": 12, "count": 4, "mode": "ATTRIBUTES" });
        file.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
        refused(&file.glb(), &["bufferView 0", words]);
    }
    let mut file = File::tetrahedron();
    let fallback =
        json!({ "byteLength": 96, "extensions": { "EXT_meshopt_compression": { "fallback": true } } });
    file.json["buffers"] = json!([{ "byteLength": 0, "uri": "data:;base64," }, fallback]);
    refused(&file.gltf(), &["buffer 1", "neither a URI nor a GLB binary chunk"]);
}

#[test]
fn broken_extensions() {
    let light = json!({ "KHR_lights_punctual": {} });
    let words = ["node 0 \"body\", KHR_lights_punctual", "missing field `light`"];
    refused_with(&[("/nodes/0/extensions", light, &words)]);
    let instancing = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 0, "SCALE": 2 } } });
    refused_after(
        |file| {
            file.floats("VEC3", &[1.0; 6]);
            file.json["nodes"][0]["extensions"] = instancing;
        },
        &["node 0 \"body\", EXT_mesh_gpu_instancing", "different counts"],
    );
    let mut file =
        File::with_material(json!({ "name": "glass", "extensions": { "KHR_materials_volume": 3 } }));
    refused(&file.glb(), &["material 0 \"glass\", KHR_materials_volume", "invalid type"]);
    file.json["materials"][0] = json!({ "normalTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "scale": [1e39, 1] } } } });
    file.push("textures", json!({ "source": 0 }));
    refused(&file.glb(), &["material 0", "KHR_texture_transform is too large"]);
}

#[test]
fn broken_lights_and_cameras() {
    let with = |light: Value, camera: Value, words: &[&str]| {
        refused_after(
            |file| {
                file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([light]);
                file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = json!(0);
                file.push("cameras", camera);
                file.json["nodes"][0]["camera"] = json!(0);
            },
            words,
        );
    };
    let light = json!({ "type": "point" });
    let camera = |yfov: f64, aspect: f64| json!({ "type": "perspective", "name": "eye", "perspective": { "yfov": yfov, "aspectRatio": aspect, "znear": 1 } });
    with(
        json!({ "type": "laser", "name": "sun" }),
        camera(1.0, 1.0),
        &["light 0 \"sun\"", "type is \"laser\""],
    );
    for (yfov, aspect) in [(0.0, 1.0), (-1.0, 1.0), (3.2, 1.0), (1.0, 0.0), (1.0, -2.0)] {
        with(light.clone(), camera(yfov, aspect), &["camera 0 \"eye\"", "yfov is"]);
    }
    for (xmag, ymag) in [(0.0, 1.0), (1.0, 0.0), (1e300, 1e-300), (1e11, 1e11)] {
        let orthographic = json!({ "xmag": xmag, "ymag": ymag, "znear": 0, "zfar": 1 });
        let camera = json!({ "type": "orthographic", "name": "eye", "orthographic": orthographic });
        with(light.clone(), camera, &["camera 0 \"eye\"", "xmag is"]);
    }
    with(light, json!({ "perspective": {} }), &["camera 0", "missing field"]);
}

#[test]
fn a_mode_that_does_not_exist() {
    let words = ["mesh 0 \"tetrahedron\" primitive 0", "mode is 7"];
    refused_with(&[("/meshes/0/primitives/0/mode", json!(7), &words)]);
}

#[test]
fn files_that_cannot_be_opened() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("gone.glb"), folder.path().to_owned()] {
        let message = load_gltf(&path, Unit::Meter, &mut Vec::new()).unwrap_err().to_string();
        assert!(message.starts_with(&path.display().to_string()), "{message}");
        assert!(message.contains("cannot be read"), "{message}");
    }
}

#[test]
fn endless_names_are_clipped() {
    refused_after(
        |file| {
            file.json["nodes"][0]["name"] = json!("x".repeat(100_000));
            file.json["nodes"][0]["mesh"] = json!(1);
        },
        &["node 0 \"xxxx", "…"],
    );
    let mode = json!("x".repeat(100_000));
    refused(
        &File::with_material(json!({ "alphaMode": mode })).glb(),
        &["material 0", "unknown variant `xxxx", "…"],
    );
}
