//! Scans, photographs and environments as others have made them: not part of the project, so that these tests run only
//! where they are asked for.

use glam::Vec3;
use translucid_load::{LoadOptions, load_gltf, load_image, load_obj, load_ply, load_scene};
use translucid_scene::{ColorSpace, Configuration, Light, Projection, Scene, SubsurfaceParameter, Unit};
use translucid_testing::scan;

/// A scene of the folder `scenes` with a mesh in place of its own.
fn example(name: &str, mesh: &str) -> Scene {
    let options = LoadOptions { mesh_overrides: vec![(None, scan(mesh))], ..LoadOptions::default() };
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/").to_owned() + name;
    load_scene(path.as_ref(), &options, &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
#[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
fn images_load() {
    for (name, size) in [
        ("env/interior.exr", None),
        ("env/studio.exr", None),
        ("env/spruit_sunrise_small.hdr", None),
        ("env/urban_alley_01_1k.hdr", Some((1024, 512))),
        ("head/color.jpg", None),
        ("head/normal.jpg", None),
        ("spot/spot.png", None),
    ] {
        let mut warnings = Vec::new();
        let image = load_image(&scan(name), ColorSpace::Srgb, &mut warnings).unwrap();
        assert_eq!(image.validate(), Ok(()));
        // Whoever has edited the photographs has left their color space open
        let expected = usize::from(name.ends_with(".jpg"));
        assert_eq!(warnings.len(), expected, "{name}: {warnings:?}");
        assert!(warnings.iter().all(|warning| warning.message.contains("uncalibrated")), "{warnings:?}");
        assert!(size.is_none_or(|size| size == (image.width, image.height)));
        let mean = image.mean();
        assert!(mean[..3].iter().all(|&mean| mean > 0.0 && mean < 100.0), "{name}: {mean:?}");
    }
}

#[test]
#[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
fn obj_files_load() {
    for (name, triangles) in [("head/head_70k.obj", 70_736), ("spot/spot.obj", 5_856)] {
        let mut warnings = Vec::new();
        let scene = load_obj(&scan(name), &mut warnings).unwrap();
        let found: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
        assert!(found <= triangles && found + 100 > triangles, "{name}: {found} {warnings:?}");
    }
}

#[test]
#[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
fn ply_scans_load() {
    for (name, triangles) in [("head/head_70k.ply", 70_736), ("dragon/dragon_870k.ply", 870_026)] {
        let mesh = load_ply(&scan(name), &mut Vec::new()).unwrap();
        assert!(mesh.triangles.len() <= triangles && mesh.triangles.len() + 100 > triangles);
        assert_eq!(mesh.normals.len(), mesh.positions.len());
        assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
        assert_eq!(mesh.validate(), Ok(()));
    }
}

#[test]
#[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
fn gltf_head_loads_with_its_textures() {
    let mut warnings = Vec::new();
    let path = scan("head/LeePerrySmith_plain.glb");
    let scene = load_gltf(&path, Unit::Centimeter, &mut warnings).unwrap();
    let [object] = &scene.objects[..] else { panic!("{} objects", scene.objects.len()) };
    assert_eq!(object.mesh.positions.len(), 9223);
    // Seven of the file's triangles have no area at all, too few to be news
    assert_eq!(object.mesh.triangles.len(), 53052 / 3 - 7);
    assert!(warnings.is_empty(), "{warnings:?}");
    let material = &scene.materials[object.material];
    assert_eq!(material.name, "skin");
    assert_eq!(material.specular_roughness.factor, 0.6);
    assert!(material.base_color.texture.is_some() && material.geometry_normal.is_some());
    assert_eq!(scene.images.len(), 2);
    let (low, high) = object.mesh.bounds();
    let [low, high] = [low, high].map(|point| scene.origin + point.as_dvec3());
    assert!((high.x - 427.632).abs() < 0.01 && (low.y + 397.255).abs() < 0.01, "{low} {high}");
}

#[test]
#[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
fn example_head_is_the_scene_of_the_comparisons() {
    let scene = example("head.toml", "head/head_70k.ply");
    assert_eq!(scene.objects[0].mesh.triangles.len(), 70_736);
    let material = &scene.materials[scene.objects[0].material];
    assert_eq!(material.subsurface_color.factor, Vec3::new(0.625, 0.3836, 0.2394));
    let mfp = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    assert_eq!(mfp, Vec3::new(2.5907, 1.9048, 1.3423));
    assert_eq!(material.specular_weight.factor, 0.0);
    assert_eq!(material.subsurface_parameter, SubsurfaceParameter::Mfp);
    assert_eq!(material.subsurface_configuration, Configuration::Diffuse);
    assert_eq!(
        (scene.camera.projection, scene.camera.target),
        (Projection::Perspective { horizontal_fov: 22.0 }, Vec3::new(6.0, 72.0, 0.0))
    );
    assert!(scene.environment.is_some_and(|e| !e.visible && e.radiance == Vec3::new(0.05, 0.055, 0.07)));
}

#[test]
#[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
fn example_dragon_stands_on_its_floor() {
    let scene = example("dragon.toml", "dragon/dragon_198k.ply");
    let floor = &scene.objects[1];
    let (low, high) = floor.mesh.bounds();
    assert!(low.distance(Vec3::new(-3000.0, 0.0, -3000.0)) < 1e-2, "{low}");
    assert!(high.distance(Vec3::new(3000.0, 0.0, 3000.0)) < 1e-2, "{high}");
    assert!(floor.mesh.normals.iter().all(|n| n.distance(Vec3::Y) < 1e-6));
    assert_eq!(scene.materials[floor.material].base_color.factor, Vec3::splat(0.25));
    assert_eq!(scene.objects[0].mesh.triangles.len(), 198_476);
    let Light::Rectangle { center, edge_x, edge_y, .. } = scene.lights[0] else { panic!() };
    let normal = edge_x.cross(edge_y).normalize();
    assert!(normal.distance((Vec3::new(0.0, 60.0, 0.0) - center).normalize()) < 1e-6);
    assert!((edge_x.length() - 160.0).abs() < 1e-3 && edge_x.y == 0.0);
}
