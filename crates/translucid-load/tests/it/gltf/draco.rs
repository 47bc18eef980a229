//! Primitives compressed by KHR_draco_mesh_compression: the files are those of tests/data/README.md.

use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};
use translucid_scene::Unit;

use super::broken::refused;
use super::builder::{File, parse};

const EDGEBREAKER: &[u8] = include_bytes!("../../data/draco_edgebreaker.glb");
const SEQUENTIAL: &[u8] = include_bytes!("../../data/draco_sequential.glb");

/// Half a step of `bits` over an extent.
fn half_step(extent: f32, bits: i32) -> f32 {
    0.501 * extent / (2_f32.powi(bits) - 1.0)
}

/// The vertices of an icosahedron in the ball of radius 1, subdivided once or not.
fn ball(is_subdivided: bool) -> Vec<Vec3> {
    let golden = f32::midpoint(1.0, 5_f32.sqrt());
    let mut found = Vec::new();
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        found.extend([Vec3::new(a, b, 0.0), Vec3::new(0.0, a, b), Vec3::new(b, 0.0, a)]);
    }
    let corners = found.clone();
    for (i, a) in corners.iter().enumerate().filter(|_| is_subdivided) {
        let neighbors = corners[i + 1..].iter().filter(|b| a.distance(**b) < 2.1);
        found.extend(neighbors.map(|b| *a + *b));
    }
    found.into_iter().map(Vec3::normalize).collect()
}

/// Encoded with 14 bits for positions, 10 for normals, 12 for texture coordinates and 8 for colors.
#[test]
fn edgebreaker_gives_the_ball_that_was_compressed() {
    let loaded = parse(EDGEBREAKER, Unit::Meter).unwrap();
    let mesh = loaded.mesh();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (42, 80));
    let mut left = ball(true);
    for vertex in 0..42 {
        let position = mesh.positions[vertex];
        let nearest = left.iter().position(|p| p.abs_diff_eq(position, half_step(2.0, 14)));
        let p = left.swap_remove(nearest.unwrap_or_else(|| panic!("{position} is no vertex of the ball")));
        assert!(mesh.normals[vertex].angle_between(p) < 0.004, "{p} {}", mesh.normals[vertex]);
        let uv = Vec2::new(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y);
        assert!(mesh.uvs[vertex].abs_diff_eq(uv, half_step(1.0, 12)), "{p} {}", mesh.uvs[vertex]);
        let color = 0.5 + 0.5 * p;
        assert!(mesh.colors[vertex].abs_diff_eq(color, half_step(1.0, 8)), "{p} {}", mesh.colors[vertex]);
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        assert!((b - a).cross(c - a).dot(a) > 0.1, "{triangle:?}");
    }
}

/// Morph targets are not compressed, and are in the order of the vertices that are.
#[test]
fn sequential_gives_the_skin_and_the_tangents_that_were_compressed() {
    let loaded = parse(SEQUENTIAL, Unit::Meter).unwrap();
    let mesh = loaded.mesh();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (12, 20));
    let mut left = ball(false);
    for vertex in 0..12 {
        let Vec3 { x, y, z } = mesh.positions[vertex];
        let raised = if y > 1.0 { 2.0 } else { 0.0 };
        let rest = Vec3::new(x, y - raised, 0.5 * z);
        let nearest = left.iter().position(|p| p.abs_diff_eq(rest, half_step(1.702, 14)));
        let p = left.swap_remove(nearest.unwrap_or_else(|| panic!("{rest} is no vertex of the ball")));
        assert_eq!(raised > 0.0, p.y > 0.1, "{p}");
        let tangent = Vec3::new(p.z, 0.0, -p.x).normalize().extend(-1.0);
        let found: Vec4 = mesh.tangents[vertex];
        assert!(found.abs_diff_eq(tangent, 0.01), "{p} {found}");
    }
}

/// The ball with the value of a member of its document; null removes it.
fn changed(pointer: &str, value: Value) -> File {
    let mut file = File::of_glb(EDGEBREAKER);
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match file.json.pointer_mut(parent).unwrap() {
        Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
        Value::Object(members) if value.is_null() => drop(members.remove(key)),
        object => object[key] = value,
    }
    file
}

#[test]
fn streams_that_are_not_as_the_document_states_are_refused() {
    let primitive = "/meshes/0/primitives/0";
    let compressed = format!("{primitive}/extensions/KHR_draco_mesh_compression");
    let help = "gltf-transform copy";
    let of_primitive = "mesh 0 primitive 0";
    for (pointer, value, words) in [
        (
            "/accessors/1/count",
            json!(41),
            ["accessor 1, POSITION of mesh 0 primitive 0", "41, but its Draco data has 42", help],
        ),
        ("/accessors/1/count", json!(1_u64 << 40), ["accessor 1, POSITION", "256 times its size", ""]),
        ("/accessors/0/count", json!(243), ["accessor 0, indices", "243, but its Draco data has 240", help]),
        ("/accessors/0/count", json!(237), [of_primitive, "more than its accessors state", help]),
        (
            "/accessors/1/componentType",
            json!(5123),
            ["accessor 1, POSITION", "3 numbers of type Float32", help],
        ),
        ("/accessors/4/componentType", json!(5120), ["accessor 4, COLOR_0", "3 numbers of type Uint8", help]),
        ("/accessors/2/type", json!("VEC4"), ["accessor 2, NORMAL", "it is VEC4", help]),
        ("/accessors/2/bufferView", json!(0), [of_primitive, "some of its compressed accessors have", help]),
        ("/bufferViews/0/byteLength", json!(700), [of_primitive, "its Draco data is damaged", ""]),
        (&format!("{primitive}/mode"), json!(5), [of_primitive, "of triangle lists only", help]),
        (&format!("{primitive}/indices"), Value::Null, [of_primitive, "but no indices", help]),
        (&format!("{compressed}/bufferView"), json!(7), [of_primitive, "refers to bufferView 7", ""]),
        (
            &format!("{compressed}/attributes/NORMAL"),
            json!(9),
            ["accessor 2, NORMAL", "no attribute 9", help],
        ),
        (&format!("{compressed}/attributes"), Value::Null, [of_primitive, "missing field `attributes`", ""]),
    ] {
        refused(&changed(pointer, value).glb(), &words);
    }
    let mut file = File::of_glb(EDGEBREAKER);
    file.push("bufferViews", json!({ "buffer": 0, "byteLength": 723 }));
    let mut second = file.primitive().clone();
    second["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = json!(1);
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    refused(&file.glb(), &["mesh 0 primitive 1", "it stands for two arrays"]);
}

#[test]
fn a_fallback_is_read_in_place_of_the_stream() {
    let mut file = File::tetrahedron();
    file.primitive()["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    let loaded = file.load();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!(loaded.mesh(), File::tetrahedron().load().mesh());
}

/// A stream is decoded once for all primitives that share it.
#[test]
fn primitives_share_a_stream() {
    let mut file = File::of_glb(EDGEBREAKER);
    let mut second = file.primitive().clone();
    let material = file.push("materials", json!({}));
    second["material"] = json!(material);
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let loaded = file.load();
    assert_eq!(loaded.scene.objects.len(), 2);
    assert_eq!(loaded.scene.objects[0].mesh.positions, loaded.scene.objects[1].mesh.positions);
}

#[test]
fn damaged_streams_are_refused_or_read_and_never_panic() {
    for file in [EDGEBREAKER, SEQUENTIAL] {
        for mutant in translucid_testing::mutants(file, 4_000) {
            drop(parse(&mutant, Unit::Meter));
        }
    }
}
