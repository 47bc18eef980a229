//! Objects in many places: what they share, what they are called, and what is refused.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};

use glam::{Affine3A, Vec3};
use translucid_scene::{Object, Scene, Unit};

use super::{load, parse};
use crate::{LoadOptions, LoadProgress, LoadWatch, Piece, SceneBuilder, load_scene};

/// A scene of an object, with lines of its table.
fn scene_of(lines: &str) -> String {
    format!("unit = \"mm\"\n[[object]]\n{lines}\n")
}

/// Places in a row, as many as there shall be.
fn row(count: usize) -> String {
    let places = (0..count).map(|i| format!("{{ translate = [{i}, 0, 0] }},\n"));
    format!("transforms = [{}]", places.collect::<String>())
}

fn meshes(scene: &Scene) -> usize {
    let mut addresses: Vec<_> = scene.objects.iter().map(|object| Arc::as_ptr(&object.mesh)).collect();
    addresses.sort();
    addresses.dedup();
    addresses.len()
}

#[test]
fn transforms_place_an_object_that_its_own_keys_have_placed() {
    let lines = "shape = \"box\"\nscale = 2\ntransforms = [{ translate = [5, 0, 0] }, { rotate = [0, 0, 90], scale = [1, 3, 1] }]";
    let scene = load(&scene_of(lines));
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["box[0]", "box[1]"]);
    assert_ne!(scene.objects[0].subsurface_group, scene.objects[1].subsurface_group);
    let boxes = [0, 1].map(|i| scene.objects[i].bounds());
    let expected = [([3.0, -2.0, -2.0], [7.0, 2.0, 2.0]), ([-6.0, -2.0, -2.0], [6.0, 2.0, 2.0])];
    for ((low, high), (a, b)) in boxes.into_iter().zip(expected) {
        assert!(low.distance(a.into()) < 1e-5 && high.distance(b.into()) < 1e-5, "{low} {high}");
    }
    let scene =
        load(&scene_of("shape = \"box\"\nsubsurface_group = \"a\"\ntransforms = [{}, { scale = 2 }]"));
    assert_eq!(scene.objects[0].subsurface_group, scene.objects[1].subsurface_group);
}

/// A thousand spheres are one mesh, whichever way they are written, and stand where their copies would.
#[test]
fn many_equal_shapes_are_made_once() {
    let in_one = load(&scene_of(&format!("shape = \"sphere\"\n{}", row(1000))));
    assert_eq!((in_one.objects.len(), meshes(&in_one)), (1000, 1));
    let sphere = |i: usize| format!("[[object]]\nshape = \"sphere\"\ntranslate = [{i}, 0, 0]\n");
    let apart = load(&format!("unit = \"mm\"\n{}", (0..1000).map(sphere).collect::<String>()));
    assert_eq!((apart.objects.len(), meshes(&apart)), (1000, 1));
    let single = load(&scene_of("shape = \"sphere\""));
    for scene in [&in_one, &apart] {
        let (shared, own) = (&scene.objects[700].mesh, &single.objects[0].mesh);
        assert!(shared.positions == own.positions && shared.triangles == own.triangles);
        assert_eq!(scene.objects[700].world_from_local, Affine3A::from_translation(Vec3::X * 700.0));
    }
    let other = format!(
        "{}[[object]]\nshape = \"sphere\"\nradius = 2\n",
        scene_of(&format!("shape = \"sphere\"\n{}", row(40)))
    );
    assert_eq!(meshes(&load(&other)), 2);
}

/// In code it is not known what is to come: what has come is shared from where it is worth it.
#[test]
fn shapes_that_are_added_one_by_one_are_shared() {
    let mut builder = SceneBuilder::new(Unit::Millimeter);
    let mut warnings = Vec::new();
    for i in 0..200 {
        let text = format!("name = 'ball {i}'\nshape = 'sphere'\ntranslate = [{i}, 0, 0]");
        builder.add_object(&Piece::parse("object", &text).unwrap(), &mut warnings).unwrap();
    }
    let own = builder.scene().objects.iter().filter(|object| !object.is_placed()).count();
    assert!(own < 40 && meshes(builder.scene()) == own + 1, "{own}");
    let torus = translucid_shapes::build_shape("torus", &translucid_shapes::ShapeParameters::new()).unwrap();
    let piece = Piece::parse("mesh many", &format!("name = 'many'\n{}", row(300))).unwrap();
    builder.add_mesh_object(&piece, torus, &mut warnings).unwrap();
    assert_eq!(meshes(builder.scene()), own + 2);
    builder.build(&LoadOptions::default()).unwrap();
}

/// Few copies stay what they were: their triangles are baked, to the last bit.
#[test]
fn few_copies_are_baked() {
    let scene = load(&scene_of(&format!("shape = \"sphere\"\n{}", row(3))));
    assert!(scene.objects.iter().all(|object| !object.is_placed()));
    let single = load(&scene_of("shape = \"sphere\"\ntranslate = [2, 0, 0]"));
    assert_eq!(*scene.objects[2].mesh, *single.objects[0].mesh);
}

/// Where a place distorts a shared mesh too much it is baked for that place.
#[test]
fn distorted_copies_are_baked() {
    let places = row(40).replace("translate = [7, 0, 0]", "translate = [7, 0, 0], scale = [1, 1, 0.001]");
    let scene = load(&scene_of(&format!("shape = \"sphere\"\n{places}")));
    assert_eq!(meshes(&scene), 2);
    let baked: Vec<usize> = (0..40).filter(|&i| !scene.objects[i].is_placed()).collect();
    assert!(baked.contains(&7), "{baked:?}");
}

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn files_in_many_places_are_read_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.obj"), TETRAHEDRON).unwrap();
    let path = folder.path().join("a.toml");
    let lines = |more: &str| scene_of(&format!("file = \"a.obj\"\nunit = \"cm\"\n{}\n{more}", row(70_000)));
    std::fs::write(&path, lines("scale = [-1, 1, 1]")).unwrap();
    let scene = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
    assert_eq!((scene.objects.len(), meshes(&scene)), (70_000, 1));
    assert_eq!(scene.objects[69_999].name, "a[69999]");
    let (low, high) = scene.objects[9].bounds();
    assert_eq!((low, high), (Vec3::new(-1.0, 0.0, 0.0), Vec3::new(9.0, 10.0, 10.0)));
    assert!(scene.objects.iter().all(Object::is_mirrored));
    let cross = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
    let outward = (0..4).all(|t| {
        let vertices = scene.objects[9].vertices(t);
        cross(vertices).dot(vertices[0] - Vec3::new(7.5, 2.5, 2.5)) > 0.0
    });
    assert!(outward);
}

#[test]
fn places_that_are_none_are_refused() {
    let refused = |transforms: &str| {
        parse(&scene_of(&format!("shape = \"box\"\ntransforms = {transforms}"))).map(drop).unwrap_err()
    };
    for (transforms, message) in [
        ("[]", "object[0].transforms is empty, but must have at least one table"),
        (
            "3",
            "object[0].transforms is a number, but must be an array of tables like { translate = [1, 0, 0] }",
        ),
        ("[3]", "object[0].transforms[0] is a number, but must be a table"),
        ("[{}, { moved = [1, 0, 0] }]", "object[0].transforms[1] has no key moved"),
        (
            "[{ scale = 0 }]",
            "object[0].transforms[0].scale is 0, but must be in [-1e9, 1e9] and at least 1e-9 away from zero",
        ),
        (
            "[{ translate = [nan, 0, 0] }]",
            "object[0].transforms[0].translate[0] is nan, but must be in [-1e9, 1e9]",
        ),
        (
            "[{ matrix = [1, 0, 0, 0,  1, 0, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1] }]",
            "object[0].transforms[0].matrix is [1, 0, 0, 0,  1, 0, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1], but must be invertible: its determinant is 0",
        ),
    ] {
        assert_eq!(refused(transforms).message, message);
    }
    let far = format!("shape = \"sphere\"\n{}", row(40).replace("[9, 0, 0]", "[1e9, 0, 0], scale = 900"));
    let error = parse(&scene_of(&far)).unwrap().load(&LoadOptions::default(), &mut Vec::new()).err().unwrap();
    assert!(error.message.contains("the object reaches to 1.0000009e9 in x, y or z"), "{error}");
}

/// Scenes made in code are refused for places that files cannot have, and for more than a renderer can take.
#[test]
fn places_in_code_are_checked() {
    let mut scene = load(&scene_of("shape = \"sphere\""));
    let mut refused = |map: Affine3A| {
        scene.objects[0].world_from_local = map;
        scene.validate().unwrap_err().message
    };
    let scale = |x: f32, y: f32, z: f32| Affine3A::from_scale(Vec3::new(x, y, z));
    for (map, must_be) in [
        (scale(f32::NAN, 1.0, 1.0), "must be finite"),
        (scale(1.0, 0.0, 1.0), "must be invertible"),
        (
            scale(1.0, 1.0, 1e-3),
            "must be a map that stretches no direction more than 100 times as much as another, but it does 1000 times",
        ),
        (scale(1e-9, 1e-9, 1e-9), "must be a map that leaves every triangle an area"),
        (
            Affine3A::from_translation(Vec3::X * 2e9),
            "must be a map that leaves coordinates in [-1e9, 1e9], but one is 2e9",
        ),
    ] {
        let message = refused(map);
        assert!(
            message.starts_with("object sphere, world_from_local = [") && message.ends_with(must_be),
            "{message}"
        );
    }

    let mut scene = load(&scene_of("shape = \"sphere\""));
    let one = scene.objects[0].clone();
    let count = (1 << 28) / one.mesh.triangles.len() + 1;
    scene.objects = (0..count).map(|i| Object { name: format!("{i}"), ..one.clone() }).collect();
    assert_eq!(scene.validate(), Ok(()));
    scene.materials[0].emission_luminance = 1.0;
    let message = scene.validate().unwrap_err().message;
    assert!(
        message.contains("triangles that emit light, each placing of a mesh counted, but at most 268435456"),
        "{message}"
    );
}

/// A file that extends the scene reaches each of them by its name.
#[test]
fn one_of_many_can_be_changed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("base.toml"), scene_of(&format!("shape = \"sphere\"\n{}", row(40))))
        .unwrap();
    let path = folder.path().join("changed.toml");
    let text = "extends = \"base.toml\"\n[[material]]\nname = \"red\"\n[[object]]\nname = \"sphere[7]\"\nmaterial = \"red\"\n";
    std::fs::write(&path, text).unwrap();
    let scene = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
    let red: Vec<usize> =
        (0..40).filter(|&i| scene.materials[scene.objects[i].material].name == "red").collect();
    assert_eq!((red, meshes(&scene)), (vec![7], 1));
}

/// A glTF file of these nodes, with a triangle as mesh 0 and a lamp as light 0.
fn gltf(nodes: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{nodes}],
        "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "point"}}]}}}},
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "buffers": [{{"byteLength": 36, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}}]}}"#
    )
}

/// A small file must not ask for any number of lights.
#[test]
fn lights_of_too_many_places_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let lamp = r#"{"extensions": {"KHR_lights_punctual": {"light": 0}}}"#;
    std::fs::write(
        folder.path().join("a.gltf"),
        gltf(&format!(r#"{{"mesh": 0}}, {}"#, [lamp; 64].join(", "))),
    )
    .unwrap();
    let load = |places: usize| {
        let path = folder.path().join("a.toml");
        std::fs::write(&path, scene_of(&format!("file = \"a.gltf\"\n{}", row(places)))).unwrap();
        load_scene(&path, &LoadOptions::default(), &mut Vec::new()).map(|scene| scene.lights.len())
    };
    assert_eq!(load(100), Ok(6400));
    assert_eq!(load(20_000).unwrap_err().message, "the scene has more than 1048576 lights up to here");
}

/// Who waits for a scene hears of each object, and may end the loading between two of them; so with the nodes of a glTF file.
#[test]
fn loading_tells_how_far_it_is_and_can_be_stopped() {
    let objects = |count: usize| format!("unit = \"mm\"\n{}", "[[object]]\nshape = \"box\"\n".repeat(count));
    let gltf = gltf(&[r#"{"mesh": 0}"#; 70].join(", "));
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a.toml", objects(70)), ("a.gltf", gltf)] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let load_until = |last: usize| {
            let heard = Arc::new(Mutex::new(Vec::new()));
            let ears = Arc::clone(&heard);
            let watch = LoadWatch::new(move |LoadProgress { done, total }| {
                ears.lock().unwrap().push((done, total));
                if done == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            let options = LoadOptions { watch, ..LoadOptions::default() };
            let result = load_scene(&path, &options, &mut Vec::new());
            let heard = heard.lock().unwrap().clone();
            (result.map(|scene| scene.objects.len()), heard)
        };
        let (whole, heard) = load_until(usize::MAX);
        assert!(whole.is_ok_and(|objects| objects >= 70), "{name}");
        assert_eq!(heard, (0..70).map(|done| (done, 70)).collect::<Vec<_>>(), "{name}");
        let (stopped, heard) = load_until(40);
        assert!(stopped.unwrap_err().message.ends_with("loading was stopped"), "{name}");
        assert_eq!(heard.len(), 41, "{name}");
    }
}
