//! Skins, morph targets and visibility: the pose in which a file shows its meshes.

use glam::{Mat4, Quat, Vec3};
use serde_json::{Value, json};
use translucid_scene::{Mesh, Unit};

use super::builder::{File, parse};

/// The tetrahedron in node 0 with the skin of the nodes 1 and on, whose weights are bytes.
fn skinned(joints: &[Value], numbers: [[u8; 4]; 4], weights: [[u8; 4]; 4]) -> File {
    let mut file = File::tetrahedron();
    let numbers = file.accessor("VEC4", 5121, 16, numbers.as_flattened());
    let weights = file.accessor("VEC4", 5121, 16, weights.as_flattened());
    file.json["accessors"][weights]["normalized"] = json!(true);
    file.attribute("JOINTS_0", numbers);
    file.attribute("WEIGHTS_0", weights);
    let joints: Vec<usize> = joints.iter().map(|joint| file.push("nodes", joint.clone())).collect();
    file.push("skins", json!({ "joints": joints }));
    file.json["nodes"][0]["skin"] = json!(0);
    file
}

fn bind(file: &mut File, matrices: &[Mat4]) {
    let numbers: Vec<f32> = matrices.iter().flat_map(Mat4::to_cols_array).collect();
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let accessor =
        json!({ "bufferView": view, "componentType": 5126, "type": "MAT4", "count": matrices.len() });
    file.json["skins"][0]["inverseBindMatrices"] = json!(file.json["accessors"].as_array().unwrap().len());
    file.push("accessors", accessor);
}

fn near(mesh: &Mesh, expected: [Vec3; 4]) {
    let are_near =
        mesh.positions.iter().zip(expected).all(|(found, expected)| found.abs_diff_eq(expected, 1e-5));
    assert!(are_near, "{:?}, not {expected:?}", mesh.positions);
}

const WHOLE: [[u8; 4]; 4] = [[255, 0, 0, 0]; 4];

/// As Blender and Maya write a character in centimeters: its node is 100 times as large, and the bindings undo it.
#[test]
fn the_node_of_a_skin_does_not_count() {
    let joint = json!({ "translation": [1, 2, 3], "scale": [2, 2, 2] });
    let mut file = skinned(&[joint], [[0; 4]; 4], WHOLE);
    file.json["nodes"][0]["scale"] = json!([100, 100, 100]);
    file.json["nodes"][0]["translation"] = json!([7, 0, 0]);
    let moved = Vec3::new(1.0, 2.0, 3.0);
    near(file.load().mesh(), [moved, moved + 2.0 * Vec3::X, moved + 2.0 * Vec3::Y, moved + 2.0 * Vec3::Z]);
    bind(&mut file, &[Mat4::from_translation(-Vec3::X)]);
    let loaded = file.load_in(Unit::Centimeter);
    let at = |p: Vec3| 100.0 * (moved + 2.0 * (p - Vec3::X));
    let found = loaded.scene.origin.as_vec3() + loaded.mesh().positions[2];
    assert!(found.abs_diff_eq(at(Vec3::Y), 1e-3), "{found}");
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
}

#[test]
fn joints_blend_by_weight_and_are_moved_by_their_parents() {
    let joints = [json!({ "translation": [0, 0, 10] }), json!({ "translation": [0, 4, 0] })];
    let weights = [[255, 0, 0, 0], [0, 255, 0, 0], [51, 204, 0, 0], [51, 0, 204, 0]];
    let mut file = skinned(&joints, [[0, 1, 1, 9]; 4], weights);
    file.push("nodes", json!({ "children": [1, 2], "translation": [1, 0, 0] }));
    let shifted = Vec3::X + 0.2 * 10.0 * Vec3::Z + 0.8 * 4.0 * Vec3::Y;
    let expected =
        [Vec3::new(1.0, 0.0, 10.0), Vec3::new(2.0, 4.0, 0.0), Vec3::Y + shifted, Vec3::Z + shifted];
    near(file.load().mesh(), expected);
    // A second set of joints counts besides
    let more = file.accessor("VEC4", 5121, 16, &[0; 16]);
    let half: Vec<f32> = [0.25, 0.0, 0.0, 0.0].repeat(4);
    let weights = file.floats("VEC4", &half);
    file.attribute("JOINTS_1", more);
    file.attribute("WEIGHTS_1", weights);
    let loaded = file.load();
    assert!(loaded.warned_of("do not add up to 1"), "{:?}", loaded.warnings);
    let second = Vec3::X + Vec3::X + (4.0 * Vec3::Y + 0.25 * 10.0 * Vec3::Z) / 1.25;
    assert!(loaded.mesh().positions[1].abs_diff_eq(second, 1e-5), "{}", loaded.mesh().positions[1]);
}

#[test]
fn normals_follow_their_joints_by_the_inverse_transpose_and_mirrors_turn_triangles() {
    let joint = json!({ "scale": [1, 1, -5] });
    let mut file = skinned(&[joint], [[0; 4]; 4], WHOLE);
    let normal = Vec3::ONE.normalize().to_array().repeat(4);
    let normals = file.floats("VEC3", &normal);
    file.attribute("NORMAL", normals);
    let loaded = file.load();
    let mesh = loaded.mesh();
    let [a, b, c] = mesh.triangles[3].map(|vertex| mesh.positions[vertex as usize]);
    let geometric = (b - a).cross(c - a).normalize();
    assert!(geometric.z < 0.0 && geometric.x > 0.0, "outward: {geometric}");
    assert!(mesh.normals[1].abs_diff_eq(geometric, 1e-5), "{} {geometric}", mesh.normals[1]);
}

#[test]
fn meshes_are_shared_by_skins_and_joints_may_lie_outside_the_scene() {
    let mut file = skinned(&[json!({ "translation": [5, 0, 0] })], [[0; 4]; 4], WHOLE);
    let other = file.push("nodes", json!({ "translation": [0, 5, 0] }));
    file.push("skins", json!({ "joints": [other], "skeleton": 0 }));
    let second = file.push("nodes", json!({ "mesh": 0, "skin": 1 }));
    let plain = file.push("nodes", json!({ "mesh": 0 }));
    file.push("scenes", json!({ "nodes": [0, second, plain] }));
    let scene = file.load().scene;
    let first: Vec<Vec3> = scene.objects.iter().map(|object| object.mesh.positions[0]).collect();
    assert_eq!(first, [5.0 * Vec3::X, 5.0 * Vec3::Y, Vec3::ZERO]);
}

/// A skin on a map: its joints are as far from the origin as the scene that it stands in.
#[test]
fn skins_far_from_the_origin_keep_their_digits() {
    let far = [512_344.987_134, 0.0, -4_634_567.925_325];
    let file = skinned(&[json!({ "translation": far })], [[0; 4]; 4], WHOLE);
    let loaded = file.load();
    let back = |corner: usize| loaded.scene.origin + loaded.mesh().positions[corner].as_dvec3();
    assert!((back(0) - glam::DVec3::from_array(far)).length() < 1e-5, "{}", back(0));
    assert!((back(1) - back(0) - glam::DVec3::X).length() < 1e-5);
}

#[test]
fn faults_of_skins_are_named() {
    let joint = json!({ "translation": [5, 0, 0] });
    let mut file = skinned(std::slice::from_ref(&joint), [[0, 3, 0, 0]; 4], [[255, 1, 0, 0]; 4]);
    let error = parse(&file.glb(), Unit::Meter).err().unwrap();
    assert!(error.contains("refers to joint 3, but its skin has 1"), "{error}");
    file.json["skins"][0]["joints"] = json!([9]);
    let error = parse(&file.glb(), Unit::Meter).err().unwrap();
    assert!(error.contains("skin 0") && error.contains("refers to node 9"), "{error}");

    let file = skinned(std::slice::from_ref(&joint), [[0; 4]; 4], [[0; 4]; 4]);
    let loaded = file.load();
    assert!(loaded.warned_of("vertices without weights follow their first joint"), "{:?}", loaded.warnings);
    assert_eq!(loaded.mesh().positions[0], 5.0 * Vec3::X);

    let mut file = skinned(&[joint.clone(), joint], [[0; 4]; 4], WHOLE);
    bind(&mut file, &[Mat4::IDENTITY]);
    let error = parse(&file.glb(), Unit::Meter).err().unwrap();
    assert!(error.contains("it has 1 inverse bind matrices, but 2 joints"), "{error}");
    file.primitive()["attributes"].as_object_mut().unwrap().remove("WEIGHTS_0");
    file.json["skins"][0].as_object_mut().unwrap().remove("inverseBindMatrices");
    let loaded = file.load();
    assert!(loaded.warned_of("a skin is left out: the primitive has no JOINTS_0 and WEIGHTS_0"));
    assert_eq!(loaded.mesh().positions[0], Vec3::ZERO);
}

#[test]
fn morph_targets_count_by_the_weights_of_the_mesh_and_of_the_node() {
    let mut file = File::tetrahedron();
    let changes = file.floats("VEC3", &[[0.0, 0.0, 2.0], [0.0; 3], [0.0; 3], [4.0, 0.0, 0.0]].concat());
    file.primitive()["targets"] = json!([{ "POSITION": changes }, { "POSITION": 0 }]);
    assert_eq!(file.load().mesh(), File::tetrahedron().load().mesh());
    file.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    near(file.load().mesh(), [Vec3::Z, Vec3::X, Vec3::Y, Vec3::new(2.0, 0.0, 1.0)]);
    file.json["nodes"][0]["weights"] = json!([0.5, 1]);
    near(file.load().mesh(), [Vec3::Z, 2.0 * Vec3::X, 2.0 * Vec3::Y, Vec3::new(2.0, 0.0, 2.0)]);
    file.json["animations"] = json!([{}]);
    assert!(file.load().warned_of("the pose is that of the nodes"));
}

#[test]
fn morphed_skins_are_morphed_first() {
    let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let mut file = skinned(&[json!({ "rotation": turn.to_array() })], [[0; 4]; 4], WHOLE);
    file.primitive()["targets"] = json!([{ "POSITION": 0 }]);
    file.json["meshes"][0]["weights"] = json!([1]);
    near(file.load().mesh(), [Vec3::ZERO, 2.0 * Vec3::Y, -2.0 * Vec3::X, 2.0 * Vec3::Z]);
}

/// KHR_node_visibility: what is below a hidden node is hidden, too, but for cameras.
#[test]
fn hidden_nodes_hide_meshes_and_lights_below_but_no_cameras() {
    let hidden = |visible: bool| json!({ "KHR_node_visibility": { "visible": visible } });
    let mut file = File::tetrahedron();
    file.json["extensionsRequired"] = json!(["KHR_node_visibility"]);
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([{ "type": "point" }]);
    file.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }));
    let mut lamp = hidden(true);
    lamp["KHR_lights_punctual"] = json!({ "light": 0 });
    let below = [file.push("nodes", json!({ "mesh": 0, "camera": 0, "extensions": lamp }))];
    file.push("nodes", json!({ "children": below, "extensions": hidden(false) }));
    let scene = file.load().scene;
    assert_eq!((scene.objects.len(), scene.lights.len(), scene.cameras.len()), (1, 0, 1));
    file.json["nodes"][2]["extensions"] = hidden(true);
    let scene = file.load().scene;
    assert_eq!((scene.objects.len(), scene.lights.len(), scene.cameras.len()), (2, 1, 1));
    file.json["nodes"][0]["extensions"] = hidden(false);
    file.json["nodes"][2]["extensions"] = hidden(false);
    let error = parse(&file.glb(), Unit::Meter).err().unwrap();
    assert!(error.contains("no triangles") && error.contains("KHR_node_visibility"), "{error}");
}
