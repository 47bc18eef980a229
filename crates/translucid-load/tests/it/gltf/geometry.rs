//! Buffers, accessors and primitives.

use glam::{Vec2, Vec3};
use serde_json::json;
use translucid_load::load_gltf;
use translucid_scene::Unit;

use super::builder::{CORNERS, FACES, File, parse};

#[test]
fn gltf_glb_and_external_buffers_are_the_same_scene() {
    let file = File::tetrahedron();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("the data.bin"), &file.bytes).unwrap();
    let path = folder.path().join("x.gltf");
    std::fs::write(&path, file.gltf_with_external("the%20data.bin")).unwrap();
    let external = load_gltf(&path, Unit::Meter, &mut Vec::new()).unwrap();
    for bytes in [file.gltf(), file.glb()] {
        let loaded = parse(&bytes, Unit::Meter).unwrap();
        assert_eq!(loaded.mesh(), &*external.objects[0].mesh);
        assert_eq!(loaded.scene.objects[0].name, "body");
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    }
    assert_eq!(
        external.objects[0].mesh.positions,
        CORNERS.chunks(3).map(Vec3::from_slice).collect::<Vec<_>>()
    );
    assert_eq!(external.objects[0].mesh.triangles.as_flattened(), FACES);
}

#[test]
fn lengths_become_scene_units() {
    let file = File::tetrahedron();
    for (unit, meter) in [(Unit::Millimeter, 1000.0), (Unit::Centimeter, 100.0), (Unit::Meter, 1.0)] {
        assert_eq!(file.load_in(unit).mesh().bounds().1, Vec3::splat(meter));
    }
}

#[test]
fn every_index_type_is_read() {
    let reference = File::tetrahedron().load();
    for (component, bytes) in [
        (5121, FACES.iter().map(|&i| i as u8).collect::<Vec<u8>>()),
        (5123, FACES.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect()),
    ] {
        let mut file = File::tetrahedron();
        let indices = file.accessor("SCALAR", component, FACES.len(), &bytes);
        file.primitive()["indices"] = json!(indices);
        assert_eq!(file.load().mesh(), reference.mesh());
    }
}

#[test]
fn without_indices_every_three_vertices_are_a_triangle() {
    let mut file = File::tetrahedron();
    file.primitive().as_object_mut().unwrap().remove("indices");
    let loaded = file.load();
    assert_eq!(loaded.mesh().triangles, [[0, 1, 2]]);
    assert!(loaded.warned_of("4 indices are no whole number of triangles"), "{:?}", loaded.warnings);
}

#[test]
fn strips_and_fans_become_triangles() {
    for (mode, expected) in [(5, [[0, 1, 2], [1, 3, 2]]), (6, [[1, 2, 0], [2, 3, 0]])] {
        let mut file = File::tetrahedron();
        let indices = file.indices_u32(&[0, 1, 2, 3]);
        file.primitive()["indices"] = json!(indices);
        file.primitive()["mode"] = json!(mode);
        assert_eq!(file.load().mesh().triangles, expected, "mode {mode}");
    }
}

#[test]
fn points_and_lines_are_left_out_with_a_warning() {
    let mut file = File::tetrahedron();
    for mode in 0..4 {
        let mut primitive = file.primitive().clone();
        primitive["mode"] = json!(mode);
        file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    }
    let loaded = file.load();
    assert_eq!(loaded.scene.objects.len(), 1);
    assert!(
        loaded.warned_of("mesh 0 \"tetrahedron\" primitive 1 of node 0 \"body\": points have no surface")
    );
    assert!(
        loaded.warned_of("lines have no surface: left out (3 times, here first)"),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn interleaved_attributes_are_read_by_their_stride() {
    let mut file = File::tetrahedron();
    let vertices: Vec<u8> =
        CORNERS.chunks(3).flat_map(|p| [p[0], p[1], p[2], 0.5, 0.25]).flat_map(f32::to_le_bytes).collect();
    let view = file.view(&vertices);
    file.json["bufferViews"][view]["byteStride"] = json!(20);
    let position = json!({ "bufferView": view, "componentType": 5126, "type": "VEC3", "count": 4 });
    let uv =
        json!({ "bufferView": view, "byteOffset": 12, "componentType": 5126, "type": "VEC2", "count": 4 });
    for (name, accessor) in [("POSITION", position), ("TEXCOORD_0", uv)] {
        let index = file.push("accessors", accessor);
        file.attribute(name, index);
    }
    let loaded = file.load();
    assert_eq!(loaded.mesh().positions, File::tetrahedron().load().mesh().positions);
    assert_eq!(loaded.mesh().uvs, [Vec2::new(0.5, 0.75); 4]);
}

#[test]
fn quantized_positions_and_normalized_attributes_are_read() {
    let mut file = File::tetrahedron();
    // Components in pairs of (normalized, type, bytes, value of the largest).
    let shorts =
        |value: i16| CORNERS.iter().flat_map(|&c| (c as i16 * value).to_le_bytes()).collect::<Vec<u8>>();
    let bytes = |value: i8| CORNERS.iter().map(|&c| (c as i8 * value) as u8).collect::<Vec<u8>>();
    for (normalized, component, data, size) in [
        (true, 5122, shorts(32767), 1.0),
        (true, 5122, shorts(-32768), -1.0),
        (false, 5122, shorts(300), 300.0),
        (true, 5120, bytes(127), 1.0),
        (true, 5120, bytes(-128), -1.0),
        (false, 5120, bytes(-128), -128.0),
        (true, 5121, bytes(-1), 1.0),
        (false, 5123, shorts(-1), 65535.0),
    ] {
        let position = file.accessor("VEC3", component, 12, &data);
        file.json["accessors"][position]["normalized"] = json!(normalized);
        file.attribute("POSITION", position);
        let loaded = file.load();
        let positions = &loaded.mesh().positions;
        assert_eq!(positions[1], size * Vec3::X, "{component} {normalized}");
        assert_eq!(positions[0], Vec3::ZERO);
    }
}

#[test]
fn vertex_colors_are_read_with_and_without_alpha() {
    let expected = [Vec3::new(1.0, 0.0, 51.0 / 255.0); 4];
    for (shape, color) in [("VEC3", vec![255, 0, 51]), ("VEC4", vec![255, 0, 51, 128])] {
        let mut file = File::with_material(json!({}));
        let bytes = color.repeat(4);
        let colors = file.accessor(shape, 5121, bytes.len(), &bytes);
        file.json["accessors"][colors]["normalized"] = json!(true);
        file.attribute("COLOR_0", colors);
        let loaded = file.load();
        assert!(loaded.mesh().colors.iter().zip(expected).all(|(c, e)| c.abs_diff_eq(e, 1e-7)), "{shape}");
        assert!(loaded.scene.materials[0].base_color.vertex_color);
    }
}

#[test]
fn sparse_values_replace_those_of_the_base_or_zeros() {
    let mut file = File::tetrahedron();
    let values = file.view(&[2.0f32, 0.0, 0.0, 0.0, 0.0, 5.0].map(f32::to_le_bytes).concat());
    let indices = file.view(&[1, 3]);
    let sparse = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values }
    });
    file.json["accessors"][0]["sparse"] = sparse.clone();
    assert_eq!(file.load().mesh().positions, [Vec3::ZERO, 2.0 * Vec3::X, Vec3::Y, 5.0 * Vec3::Z]);

    file.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let loaded = file.load();
    // Vertex 2 is now at the origin: only the triangle 0, 1, 3 and its double 1, 2, 3 have an area.
    assert_eq!(loaded.mesh().triangles.len(), 2);
    assert_eq!(loaded.mesh().bounds(), (Vec3::ZERO, Vec3::new(2.0, 0.0, 5.0)));
    assert!(loaded.warned_of("2 triangles"), "{:?}", loaded.warnings);
}

#[test]
fn texture_coordinates_point_up_and_follow_the_material_s_set() {
    let mut file = File::with_material(json!({ "normalTexture": { "index": 0, "texCoord": 1 } }));
    let image = file.view(&super::builder::png(1, 1, &[[128, 128, 255, 255]]));
    file.push("images", json!({ "bufferView": image, "mimeType": "image/png" }));
    file.push("textures", json!({ "source": 0 }));
    let second = file.floats("VEC2", &[0.25, 0.125, 0.5, 0.5, 0.0, 0.0, 1.0, 1.0]);
    file.attribute("TEXCOORD_1", second);
    assert_eq!(file.load().mesh().uvs[0], Vec2::new(0.25, 0.875));
    file.json["materials"][0]["normalTexture"]["texCoord"] = json!(0);
    assert_eq!(file.load().mesh().uvs[2], Vec2::new(0.0, 0.25));
    file.json["materials"][0]["normalTexture"]["texCoord"] = json!(7);
    let loaded = file.load();
    assert!(loaded.mesh().uvs.is_empty());
    assert!(loaded.warned_of("its material has textures, but it has no TEXCOORD_7"), "{:?}", loaded.warnings);
}

#[test]
fn normals_and_tangents_are_read() {
    let mut file = File::tetrahedron();
    let normals = file.floats("VEC3", &[0.0, 0.0, 2.0].repeat(4));
    let tangents = file.floats("VEC4", &[1.0, 0.0, 0.0, -1.0].repeat(4));
    file.attribute("NORMAL", normals);
    file.attribute("TANGENT", tangents);
    let loaded = file.load();
    assert_eq!(loaded.mesh().normals, [Vec3::Z; 4]);
    assert_eq!(loaded.mesh().tangents, [Vec3::X.extend(-1.0); 4]);
}

/// Both files are the ball of tests/data/README.md.
#[test]
fn meshopt_files_unfold_to_the_ball_that_was_packed() {
    for file in
        [&include_bytes!("../../data/meshopt_ext.glb")[..], include_bytes!("../../data/meshopt_khr.glb")]
    {
        let loaded = parse(file, Unit::Meter).unwrap();
        let mesh = loaded.mesh();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (42, 80));
        for ((position, normal), color) in mesh.positions.iter().zip(&mesh.normals).zip(&mesh.colors) {
            assert!((position.length() - 1.0).abs() < 1e-3, "{position}");
            assert!(position.abs_diff_eq(*normal, 0.02), "{position} {normal}");
            assert!(color.abs_diff_eq(0.5 * *position + 0.5, 0.02), "{position} {color}");
        }
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            assert!((b - a).cross(c - a).dot(a) > 0.1, "{triangle:?}");
        }
    }
}

#[test]
fn damaged_meshopt_data_is_refused_or_read_and_never_panics() {
    for file in
        [&include_bytes!("../../data/meshopt_ext.glb")[..], include_bytes!("../../data/meshopt_khr.glb")]
    {
        for mutant in translucid_testing::mutants(file, 4_000) {
            drop(parse(&mutant, Unit::Meter));
        }
    }
}

#[test]
fn one_unusable_mesh_does_not_spoil_the_others() {
    let mut file = File::tetrahedron();
    let flat = file.floats("VEC3", &[1.0; 9]);
    file.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": flat } }] }));
    file.push("nodes", json!({ "mesh": 1 }));
    let loaded = file.load();
    assert_eq!(loaded.scene.objects.len(), 1);
    assert!(loaded.warned_of("mesh 1 primitive 0 of node 1: left out"), "{:?}", loaded.warnings);
}
