//! Nodes, scenes, instances, lights and cameras.

use glam::{DVec3, Mat4, Quat, Vec3};
use serde_json::{Value, json};
use translucid_load::NamedCamera;
use translucid_scene::{Light, Mesh, Projection, Unit};

use super::builder::File;

/// Signed volume; positive if the triangles wind outward.
fn volume(mesh: &Mesh) -> f64 {
    let cone = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        DVec3::dot(a, b.cross(c)) / 6.0
    };
    mesh.triangles.iter().map(cone).sum()
}

fn with_node(node: Value) -> File {
    let mut file = File::tetrahedron();
    file.json["nodes"][0] = node;
    file
}

#[test]
fn transforms_apply_scale_then_rotation_then_translation_then_the_parents() {
    // Half a turn about z; the parent is a quarter turn about x, as a matrix with a translation.
    let child = json!({ "mesh": 0, "scale": [2, 3, 4], "rotation": [0, 0, 1, 0], "translation": [10, 0, 0] });
    let parent =
        Mat4::from_translation(Vec3::Y) * Mat4::from_quat(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
    let mut file = with_node(child);
    file.push("nodes", json!({ "children": [0], "matrix": parent.to_cols_array() }));
    let loaded = file.load();
    for (corner, expected) in [
        (0, Vec3::new(10.0, 1.0, 0.0)),
        (1, Vec3::new(8.0, 1.0, 0.0)),
        (2, Vec3::new(10.0, 1.0, -3.0)),
        (3, Vec3::new(10.0, -3.0, 0.0)),
    ] {
        let found = loaded.mesh().positions[corner];
        assert!(found.abs_diff_eq(expected, 1e-5), "corner {corner}: {found}");
    }
}

#[test]
fn mirrored_nodes_keep_the_winding_outward() {
    for scale in [[-1.0, 1.0, 1.0], [-2.0, -1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]] {
        let loaded = with_node(json!({ "mesh": 0, "scale": scale })).load();
        let expected = f64::abs(scale[0] * scale[1] * scale[2]) / 6.0;
        assert!((volume(loaded.mesh()) - expected).abs() < 1e-6, "{scale:?}");
    }
}

#[test]
fn non_uniform_scale_keeps_normals_perpendicular_to_the_surface() {
    let mut file = with_node(json!({ "mesh": 0, "scale": [1, 1, 5] }));
    // Normals of the slanted face for all corners.
    let normal = Vec3::ONE.normalize().to_array().repeat(4);
    let normals = file.floats("VEC3", &normal);
    file.attribute("NORMAL", normals);
    let loaded = file.load();
    let mesh = loaded.mesh();
    let [a, b, c] = [1, 2, 3].map(|i: usize| mesh.positions[i]);
    let geometric = (b - a).cross(c - a).normalize();
    assert!(mesh.normals[1].abs_diff_eq(geometric, 1e-6), "{} {geometric}", mesh.normals[1]);
}

#[test]
fn instances_are_objects_of_their_own_and_primitives_share_a_group() {
    let mut file = File::tetrahedron();
    let primitive = file.primitive().clone();
    let mut other = primitive.clone();
    other["mode"] = json!(4);
    // One that repeats another is left out
    file.json["meshes"][0]["primitives"] = json!([primitive, other, primitive]);
    file.push("nodes", json!({ "mesh": 0, "translation": [5, 0, 0] }));
    let loaded = file.load();
    assert!(loaded.warned_of("primitives that repeat another one are left out"), "{:?}", loaded.warnings);
    let scene = loaded.scene;
    let groups: Vec<u32> = scene.objects.iter().map(|object| object.subsurface_group).collect();
    assert_eq!(groups, [0, 0, 1, 1]);
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["body", "body", "tetrahedron", "tetrahedron"]);
    assert_eq!(scene.objects[2].mesh.bounds().0, 5.0 * Vec3::X);
}

#[test]
fn gpu_instancing_places_a_mesh_at_every_instance() {
    let mut file = File::tetrahedron();
    let translation = file.floats("VEC3", &[0.0, 0.0, 0.0, 7.0, 0.0, 0.0]);
    let scale = file.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let quarter: Vec<u8> = [0, 0, 0, 32767, 0, 0, 23170, 23170i16].map(i16::to_le_bytes).concat();
    let rotation = file.accessor("VEC4", 5122, 8, &quarter);
    file.json["accessors"][rotation]["normalized"] = json!(true);
    let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale });
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json!({ "attributes": attributes });
    let scene = file.load().scene;
    assert_eq!(scene.objects.len(), 2);
    assert_eq!(scene.objects[0].mesh.positions[1], Vec3::X);
    let turned = scene.objects[1].mesh.positions[1];
    assert!(turned.abs_diff_eq(Vec3::new(7.0, 2.0, 0.0), 1e-4), "{turned}");
    assert_eq!(scene.objects[1].subsurface_group, 1);
}

/// As gltfpack writes them: positions are counted in steps, which only the instances make meters.
#[test]
fn the_origin_of_instances_is_where_they_are() {
    let mut file = File::tetrahedron();
    let steps: Vec<u8> = [0_u16, 0, 16383, 0, 16383, 0, 16383, 0, 0, 16383, 16383, 0, 0, 0, 0, 0]
        .map(u16::to_le_bytes)
        .concat();
    let view = file.view(&steps);
    file.json["bufferViews"][view]["byteStride"] = json!(8);
    let accessor = json!({ "bufferView": view, "componentType": 5123, "type": "VEC3", "count": 4 });
    let position = file.push("accessors", accessor);
    file.attribute("POSITION", position);
    let translation = file.floats("VEC3", &[0.1, 0.2, 0.3]);
    let scale = file.floats("VEC3", &[1.0 / 16383.0; 3]);
    let attributes = json!({ "TRANSLATION": translation, "SCALE": scale });
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json!({ "attributes": attributes });
    let scene = file.load().scene;
    assert_eq!(scene.origin, DVec3::ZERO);
    let corner = scene.objects[0].mesh.positions[0];
    assert!(corner.abs_diff_eq(Vec3::new(0.1, 0.2, 1.3), 1e-6), "{corner}");
}

/// Where a mesh has many uses, by nodes or by instances of one, all share it: they stand where their copies would.
#[test]
fn meshes_of_many_uses_are_shared() {
    const COUNT: usize = 70_000;
    let mut file = File::tetrahedron();
    let places: Vec<f32> = (0..COUNT).flat_map(|i| [i as f32, 0.0, -2.0]).collect();
    let translation = file.floats("VEC3", &places);
    file.push(
        "nodes",
        json!({ "mesh": 0, "scale": [1, -2, 1], "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translation } } } }),
    );
    file.push("nodes", json!({ "mesh": 0, "translation": [0, 9, 0] }));
    for unit in [Unit::Meter, Unit::Centimeter] {
        let scene = file.load_in(unit).scene;
        let meter = 1000.0 / unit.in_millimeters() as f32;
        assert_eq!(scene.objects.len(), COUNT + 2);
        let mesh = &scene.objects[0].mesh;
        assert!(scene.objects.iter().all(|object| std::sync::Arc::ptr_eq(&object.mesh, mesh)));
        let groups: Vec<u32> = scene.objects.iter().map(|object| object.subsurface_group).collect();
        assert!(groups.iter().enumerate().all(|(i, group)| *group == i as u32));
        let (low, high) = scene.objects[12].bounds();
        let expected = [Vec3::new(11.0, -2.0, -2.0), Vec3::new(12.0, 0.0, -1.0)].map(|corner| corner * meter);
        assert!(
            low.distance(expected[0]) < 1e-4 * meter && high.distance(expected[1]) < 1e-4 * meter,
            "{low} {high}"
        );
        assert!(scene.objects[12].is_mirrored() && !scene.objects[COUNT + 1].is_mirrored());
        assert!(scene.objects[COUNT + 1].bounds().0.distance(Vec3::Y * 9.0 * meter) < 1e-4 * meter);
    }
}

/// Exporters write a mesh anew for each use, over the same accessors, with another material perhaps.
#[test]
fn meshes_of_the_same_accessors_are_shared() {
    const COUNT: usize = 70_000;
    let mut file = File::tetrahedron();
    file.json["materials"] = json!([{}, { "emissiveFactor": [1, 1, 1] }]);
    let primitive = file.json["meshes"][0]["primitives"][0].clone();
    let with_material = |material: usize| {
        let mut primitive = primitive.clone();
        primitive["material"] = json!(material);
        json!({ "primitives": [primitive] })
    };
    file.json["meshes"] = (0..COUNT).map(|i| with_material(i % 2)).collect();
    file.json["nodes"] = (0..COUNT).map(|i| json!({ "mesh": i, "translation": [i, 0, 0] })).collect();
    file.json["scenes"] = json!([{ "nodes": (0..COUNT).collect::<Vec<_>>() }]);
    let objects = file.load().scene.objects;
    assert_eq!(objects.len(), COUNT);
    assert!(objects.iter().all(|object| std::sync::Arc::ptr_eq(&object.mesh, &objects[0].mesh)));
    assert!([0, 1, 2].map(|i| objects[i].material) == [0, 1, 0]);
    assert_eq!(objects[3].bounds().0.x, 3.0);
    // Other indices are another mesh
    let indices = file.indices_u32(&[0, 1, 2]);
    file.json["meshes"][7]["primitives"][0]["indices"] = json!(indices);
    let objects = file.load().scene.objects;
    assert_eq!([6, 7, 8].map(|i| objects[i].mesh.triangles.len()), [4, 1, 4]);
}

#[test]
fn the_default_scene_is_read_else_the_first_else_every_root() {
    let mut file = File::tetrahedron();
    file.push("nodes", json!({ "name": "other", "mesh": 0 }));
    let names = |file: &File| -> Vec<String> {
        file.load().scene.objects.into_iter().map(|object| object.name).collect()
    };
    assert_eq!(names(&file), ["body", "other"]);
    file.json["scenes"] = json!([{ "nodes": [1] }, { "nodes": [0] }]);
    assert_eq!(names(&file), ["other"]);
    file.json["scene"] = json!(1);
    assert_eq!(names(&file), ["body"]);
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_is_read() {
    const LENGTH: usize = 100_000;
    let mut file = File::tetrahedron();
    let mut nodes: Vec<Value> =
        (1..LENGTH).map(|child| json!({ "children": [child], "translation": [0.5, 0, 0] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    file.json["nodes"] = json!(nodes);
    let loaded = file.load();
    let position = loaded.scene.origin.as_vec3() + loaded.mesh().positions[0];
    assert_eq!(position, 0.5 * (LENGTH - 1) as f32 * Vec3::X);
}

fn with_light(light: Value) -> File {
    let mut file = File::tetrahedron();
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([light]);
    // A quarter turn about x: the light's −z becomes +y.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    file.push(
        "nodes",
        json!({
            "translation": [1, 2, 3],
            "rotation": [half, 0, 0, half],
            "extensions": { "KHR_lights_punctual": { "light": 0 } }
        }),
    );
    file
}

/// Lux and candela are divided by 683 lm/W, as Blender's importer does.
#[test]
fn directional_lights_keep_their_irradiance_in_any_unit() {
    let file = with_light(json!({ "type": "directional", "color": [1, 0.5, 0], "intensity": 3 * 683 }));
    for unit in [Unit::Meter, Unit::Millimeter] {
        let scene = file.load_in(unit).scene;
        let [Light::Distant { direction, angular_radius, irradiance }] = scene.lights[..] else { panic!() };
        assert!(direction.abs_diff_eq(-Vec3::Y, 1e-6), "{direction}");
        assert_eq!((angular_radius, irradiance), (0.0, Vec3::new(3.0, 1.5, 0.0)));
    }
}

#[test]
fn point_lights_give_the_same_irradiance_in_any_unit() {
    let file = with_light(json!({ "type": "point", "intensity": 8 * 683 }));
    for unit in [Unit::Meter, Unit::Millimeter] {
        let scene = file.load_in(unit).scene;
        let [Light::Spot { position, intensity, outer_angle, .. }] = scene.lights[..] else { panic!() };
        let meter = 1000.0 / unit.in_millimeters() as f32;
        assert_eq!(outer_angle, 180.0);
        assert!(position.abs_diff_eq(meter * Vec3::new(1.0, 2.0, 3.0), 1e-3));
        // At two meters.
        assert!((intensity.x / (2.0 * meter).powi(2) - 2.0).abs() < 1e-5, "{intensity}");
    }
}

#[test]
fn spot_lights_have_their_cone_in_degrees_and_the_default_of_45() {
    let file =
        with_light(json!({ "type": "spot", "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } }));
    let [Light::Spot { direction, inner_angle, outer_angle, .. }] = file.load().scene.lights[..] else {
        panic!()
    };
    assert!(direction.abs_diff_eq(Vec3::Y, 1e-6), "{direction}");
    assert!((inner_angle - 14.323_945).abs() < 1e-4 && (outer_angle - 28.647_89).abs() < 1e-4);
    let file = with_light(json!({ "type": "spot" }));
    let [Light::Spot { inner_angle, outer_angle, .. }] = file.load().scene.lights[..] else { panic!() };
    assert_eq!((inner_angle, outer_angle), (0.0, 45.0));
    let file = with_light(json!({ "type": "spot", "spot": { "innerConeAngle": 3, "outerConeAngle": 0.5 } }));
    let loaded = file.load();
    let [Light::Spot { inner_angle, outer_angle, .. }] = loaded.scene.lights[..] else { panic!() };
    assert!(inner_angle < outer_angle);
    assert!(loaded.warned_of("light 0: its cone angles are not"), "{:?}", loaded.warnings);
}

#[test]
fn a_light_out_of_range_becomes_the_nearest_with_a_warning() {
    let loaded = with_light(json!({ "type": "point", "color": [1, -1, 1e300] })).load();
    let [Light::Spot { intensity, .. }] = loaded.scene.lights[..] else { panic!() };
    assert_eq!(intensity, Vec3::new((1.0_f64 / 683.0) as f32, 0.0, 1e12));
    assert!(loaded.warned_of("light 0: its color times its intensity is not in [0, 1e12]"));
}

fn with_camera(camera: Value) -> File {
    let mut file = File::tetrahedron();
    file.push("cameras", camera);
    file.push("nodes", json!({ "camera": 0, "translation": [0, 0, 4] }));
    file
}

#[test]
fn cameras_see_the_corners_of_their_picture_under_the_right_angles() {
    let yfov = 0.8f64;
    let file = with_camera(
        json!({ "type": "perspective", "perspective": { "yfov": yfov, "aspectRatio": 1.5, "znear": 0.1 } }),
    );
    let scene = file.load_in(Unit::Centimeter).scene;
    let [NamedCamera { name, camera, of_square }] = &scene.cameras[..] else { panic!() };
    assert_eq!(name, "camera 0");
    assert_eq!(camera.position, Vec3::new(0.0, 0.0, 400.0));
    assert!((camera.target - camera.position).normalize().abs_diff_eq(-Vec3::Z, 1e-6));
    assert_eq!(camera.up, Vec3::Y);
    // A picture 3 wide and 2 high at the distance where its height fills the vertical field of view.
    let distance = 1.0 / (yfov / 2.0).tan();
    assert!((camera.projection.width_at(distance) - 3.0).abs() < 1e-6);
    assert!((of_square.unwrap().width_at(distance) - 2.0).abs() < 1e-6);
    assert!(camera.focus_distance > 0.0 && camera.lens_radius == 0.0);
}

#[test]
fn cameras_without_aspect_ratio_fit_the_default_film() {
    let file = with_camera(json!({ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }));
    let width = file.load().scene.cameras[0].camera.projection.width_at(0.5);
    assert!((width - 0.5f64.tan() * 16.0 / 9.0).abs() < 1e-6);
}

#[test]
fn orthographic_cameras_see_twice_their_magnification() {
    let magnification = json!({ "xmag": 3, "ymag": 1.5, "znear": 0, "zfar": 1 });
    let file = with_camera(json!({ "type": "orthographic", "orthographic": magnification }));
    let scene = file.load_in(Unit::Centimeter).scene;
    let [NamedCamera { camera, of_square, .. }] = &scene.cameras[..] else { panic!() };
    assert_eq!(camera.position, Vec3::new(0.0, 0.0, 400.0));
    assert_eq!(camera.projection, Projection::Orthographic { width: 600.0 });
    assert_eq!(*of_square, Some(Projection::Orthographic { width: 300.0 }));
}

#[test]
fn cameras_of_other_types_are_left_out_with_a_warning_and_others_have_names() {
    let mut file = with_camera(json!({ "type": "fisheye" }));
    let loaded = file.load();
    assert!(loaded.scene.cameras.is_empty());
    assert!(loaded.warned_of("camera 0: a camera that is neither"));
    let perspective = json!({ "yfov": 1.0, "znear": 0.1 });
    file.push("cameras", json!({ "type": "perspective", "name": "wide", "perspective": perspective }));
    file.push("nodes", json!({ "camera": 1 }));
    file.push("nodes", json!({ "camera": 1, "name": "ear", "translation": [9, 9, 9] }));
    let loaded = file.load();
    let cameras: Vec<(&str, Vec3)> =
        loaded.scene.cameras.iter().map(|named| (named.name.as_str(), named.camera.position)).collect();
    assert_eq!(cameras, [("wide", Vec3::ZERO), ("ear", Vec3::splat(9.0))]);
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
}
