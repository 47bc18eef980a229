//! Scenes far from the world's origin: the same as near it, but for where they are.

use glam::{DVec3, Vec3};
use translucid_scene::{Light, Scene};

use super::load;
use crate::{ExtendedBase, LoadOptions, UpAxis, load_scene};

/// A lit torus that a camera looks at, all of it moved.
fn moved(by: DVec3, camera: &str) -> String {
    let at =
        |x: f64, y: f64, z: f64| (by + DVec3::new(x, y, z)).to_array().map(|x| format!("{x:?}")).join(", ");
    let camera = camera.replace("TARGET", &at(0.0, 0.0, 0.0)).replace("POSITION", &at(0.0, 0.0, 10.0));
    format!(
        "unit = \"mm\"\n{camera}[[object]]\nshape = \"torus\"\nradius = 0.7\ntube_radius = 0.3\nrotate = [60, 20, 0]\n\
         translate = [{}]\n[[object]]\nshape = \"sphere\"\nmatrix = [0.1, 0, 0, {}, 0, 0.1, 0, {}, 0, 0, 0.1, {}, 0, 0, 0, 1]\n\
         transforms = [{{ translate = [0, 0, 0.25] }}, {{ rotate = [0, 0, 0] }}]\n\
         [[light]]\ntype = \"sphere\"\ncenter = [{}]\nradius = 0.5\nradiance = 1\n",
        at(0.0, 0.0, 0.0),
        by.x + 1.5,
        by.y,
        by.z - 0.5,
        at(3.0, 1.5, 0.75),
    )
}

const CAMERA: &str = "[camera]\nposition = [POSITION]\ntarget = [TARGET]\n";

/// The greatest distance between what both scenes have.
fn difference(a: &Scene, b: &Scene) -> f32 {
    let mut pairs = vec![(a.camera.position, b.camera.position), (a.camera.target, b.camera.target)];
    let shift = (a.origin - b.origin).as_vec3();
    for (one, other) in a.objects.iter().zip(&b.objects) {
        assert_eq!(one.mesh.triangles, other.mesh.triangles);
        pairs.extend((0..one.mesh.positions.len() as u32).map(|i| (one.position(i), other.position(i))));
    }
    for pair in a.lights.iter().zip(&b.lights) {
        if let (Light::Sphere { center: one, .. }, Light::Sphere { center: other, .. }) = pair {
            pairs.push((*one, *other));
        }
    }
    let shifted = pairs.into_iter().map(|(one, other)| (one - other + shift).length());
    shifted.fold(0.0, f32::max)
}

/// The scene as if it were where another is.
fn brought_back(scene: Scene, by: DVec3) -> Scene {
    Scene { origin: scene.origin - by, ..scene }
}

#[test]
fn scenes_are_the_same_wherever_they_are() {
    for camera in [CAMERA, ""] {
        let near = load(&moved(DVec3::ZERO, camera));
        assert_eq!(near.origin, DVec3::ZERO);
        for by in [DVec3::splat(10_000.0), DVec3::new(1e6, -2e6, 3.0), DVec3::new(5e8, 0.0, 5e8)] {
            let far = brought_back(load(&moved(by, camera)), by);
            let difference = difference(&far, &near);
            // Half a step of double precision at 5 × 10⁸, and one of single precision near the origin
            assert!(difference < 2e-6, "{by} {camera}: {difference}");
        }
    }
}

/// A ball in the coordinates of a map [m], as OBJ, and as PLY of doubles.
fn files(by: DVec3) -> [(&'static str, String); 2] {
    let corners = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let corner = |sign: usize, axis: usize| axis + 3 * (sign >> axis & 1);
    let faces: Vec<[usize; 3]> = (0..8)
        .map(|sign: usize| {
            let [a, b, c] = [0, 1, 2].map(|axis| corner(sign, axis));
            if sign.count_ones().is_multiple_of(2) { [a, b, c] } else { [a, c, b] }
        })
        .collect();
    let lines = |before: &str| -> String {
        let line =
            |p: &DVec3| format!("{before}{} {} {}\n", by.x + 0.3 * p.x, by.y + 0.3 * p.y, by.z + 0.3 * p.z);
        corners.iter().map(line).collect()
    };
    let of_faces = |before: &str, first: usize| -> String {
        faces
            .iter()
            .map(|f| format!("{before}{} {} {}\n", f[0] + first, f[1] + first, f[2] + first))
            .collect()
    };
    let header = "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n\
                  element face 8\nproperty list uchar int vertex_indices\nend_header\n";
    [
        ("ball.obj", lines("v ") + &of_faces("f ", 1)),
        ("ball.ply", header.to_owned() + &lines("") + &of_faces("3 ", 0)),
    ]
}

#[test]
fn meshes_are_the_same_wherever_they_are() {
    let by = DVec3::new(512_345.25, 4_634_567.5, 231.0);
    for ((name, near), (_, far)) in files(DVec3::ZERO).into_iter().zip(files(by)) {
        let folder = tempfile::tempdir().unwrap();
        let load = |sub: &str, mesh: &str, scene: Option<&str>| {
            let folder = folder.path().join(sub);
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join(name), mesh).unwrap();
            let path = folder.join(if scene.is_some() { "scene.toml" } else { name });
            if let Some(text) = scene {
                std::fs::write(&path, text).unwrap();
            }
            let options = LoadOptions {
                unit: scene.is_none().then_some(translucid_scene::Unit::Meter),
                up: scene.is_none().then_some(UpAxis::Y),
                ..LoadOptions::default()
            };
            let mut warnings = Vec::new();
            let scene = load_scene(&path, &options, &mut warnings).unwrap();
            assert!(warnings.is_empty(), "{warnings:?}");
            scene
        };
        let bare = [load("near", &near, None), brought_back(load("far", &far, None), by)];
        // Cameras that are chosen stand some meters off
        assert!(difference(&bare[0], &bare[1]) < 5e-6, "{name}: {}", difference(&bare[0], &bare[1]));
        // As a part of a scene without a camera, and with one, beside a shape
        let text = |by: DVec3, camera: bool| {
            let center = format!("[{:?}, {:?}, {:?}]", by.x, by.y, by.z);
            let camera = if camera {
                format!(
                    "[camera]\nposition = [{:?}, {:?}, {:?}]\ntarget = {center}\n",
                    by.x,
                    by.y,
                    by.z + 2.0
                )
            } else {
                String::new()
            };
            format!(
                "unit = \"m\"\n{camera}[[object]]\nfile = \"{name}\"\n[[object]]\nshape = \"box\"\nscale = 0.1\ntranslate = {center}\n"
            )
        };
        for camera in [false, true] {
            let near = load("near", &near, Some(&text(DVec3::ZERO, camera)));
            let far = brought_back(load("far", &far, Some(&text(by, camera))), by);
            assert!(difference(&near, &far) < 5e-6, "{name} {camera}: {}", difference(&near, &far));
        }
    }
}

/// What is written of an edited scene has the world's coordinates, and gives the scene again.
#[test]
fn far_scenes_are_written_in_the_worlds_coordinates() {
    let by = DVec3::new(512_345.25, 4_634_567.5, 231.0);
    let from = load(&moved(by, CAMERA));
    assert_ne!(from.origin, DVec3::ZERO);
    let mut to = from.clone();
    to.camera.position += Vec3::new(0.1, -3.3e-3, 0.7);
    let Light::Sphere { center, .. } = &mut to.lights[0] else { panic!("{:?}", to.lights) };
    center.y += 0.123_456_7;
    let base = ExtendedBase { extends: "base.toml".into(), ..ExtendedBase::default() };
    let text = base.write(&from, &to, None).unwrap();
    for number in ["position = [512345.35, 4634567.4967, 241.7]", "4634569.1234567"] {
        assert!(text.contains(number), "{text}");
    }
}
