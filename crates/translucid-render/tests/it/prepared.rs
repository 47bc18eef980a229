//! Edits of a prepared scene: its pictures are those of a scene that is prepared anew, and only changed parts are prepared.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use translucid_profile::Model;
use translucid_render::{Edit, FilmSums, PreparedScene, Renewed};
use translucid_scene::{
    Camera, ColorInput, ColorSpace, Environment, Image, Integrator, Light, Material, Mesh, Object, Pixels,
    Projection, ScalarInput, Scene, SubsurfaceMethod, SubsurfaceModel, SubsurfaceNormalization, TextureRef,
    WalkSurface,
};

use crate::common::{matte, quad, render, scene, sphere, uniform_environment};

fn wax(radius: f32) -> Material {
    Material {
        name: "wax".into(),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.6, 0.3)),
        subsurface_radius: ScalarInput::constant(radius),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique),
        ..Material::default()
    }
}

/// A ball of wax over a matte floor under a rectangle light and an even sky.
fn still() -> Scene {
    let floor = quad(Vec3::new(0.0, -1.0, 0.0), Vec3::X * 4.0, Vec3::NEG_Z * 4.0);
    let mut scene = scene(vec![sphere(1.0, 16), floor], wax(0.2));
    scene.materials.push(matte(Vec3::splat(0.6)));
    scene.objects[1].material = 1;
    scene.objects[1].subsurface_group = 1;
    scene.environment = uniform_environment(Vec3::splat(0.3));
    scene.lights = vec![light(2.0)];
    scene.integrator = Integrator { max_depth: 5, ..Integrator::default() };
    scene.camera = Camera { position: Vec3::new(0.0, 1.0, 6.0), target: Vec3::ZERO, ..scene.camera };
    scene
}

fn light(height: f32) -> Light {
    Light::Rectangle {
        center: Vec3::new(1.0, height, 1.0),
        edge_x: Vec3::X,
        edge_y: Vec3::Z,
        radiance: Vec3::splat(5.0),
        visible: true,
    }
}

/// Two pixels beside each other.
fn image(name: &str, [left, right]: [Vec3; 2]) -> Arc<Image> {
    Arc::new(Image {
        name: name.into(),
        path: None,
        width: 2,
        height: 1,
        color_space: ColorSpace::Linear,
        pixels: Pixels::Float([left, right].map(|color| color.extend(1.0).to_array()).into()),
    })
}

/// Wax whose surface albedo is the image of a number.
fn painted(number: usize) -> Material {
    let color = ColorInput { texture: Some(TextureRef::new(number)), ..ColorInput::constant(Vec3::ONE) };
    Material { subsurface_color: color, ..wax(0.3) }
}

/// Objects and materials that are moved, added and removed leave the pictures of a scene that is prepared anew.
#[test]
fn edited_objects_are_those_of_a_scene_prepared_anew() {
    let mut wanted = still();
    wanted.objects.iter_mut().for_each(|object| object.is_movable = true);
    let mut prepared = PreparedScene::new(wanted.clone()).expect("a valid scene");
    let check = |prepared: &PreparedScene, wanted: &Scene, what: &str| {
        let anew = PreparedScene::new(wanted.clone()).expect("a valid scene");
        assert_eq!(picture(prepared), picture(&anew), "{what}");
        let view = anew.view().expect("a view");
        assert_eq!(prepared.fingerprint(&view), anew.fingerprint(&view), "{what}");
    };
    check(&prepared, &wanted, "as it was");

    // One hierarchy over all triangles gives the same picture, but for rounding
    let baked = PreparedScene::new(still()).expect("a valid scene");
    let mean = |prepared: &PreparedScene| {
        let film = picture(prepared);
        let pixels = (0..16).flat_map(|y| (0..16).map(move |x| (x, y)));
        pixels.map(|(x, y)| film.mean(x, y)[..12].iter().sum::<f64>()).sum::<f64>()
    };
    assert!((mean(&prepared) / mean(&baked) - 1.0).abs() < 0.01, "{} {}", mean(&prepared), mean(&baked));

    let place = Affine3A::from_scale_rotation_translation(
        Vec3::new(1.0, 0.5, 1.5),
        Quat::from_rotation_z(0.4),
        Vec3::new(0.3, 0.2, 0.0),
    );
    wanted.objects[0].world_from_local = place;
    let renewed = prepared.edit(Edit::Objects(wanted.objects.clone())).expect("a valid edit");
    assert_eq!(renewed, Renewed { geometry: true, lights: true, ..Renewed::default() });
    check(&prepared, &wanted, "moved");

    wanted.materials.push(matte(Vec3::new(0.9, 0.1, 0.1)));
    prepared.edit(Edit::AddMaterial(Box::new(wanted.materials[2].clone()))).expect("a valid edit");
    let mesh = Arc::new(sphere(0.3, 8));
    for (number, x) in [-1.0, 1.2].into_iter().enumerate() {
        wanted.objects.push(Object {
            name: format!("small {number}"),
            mesh: Arc::clone(&mesh),
            material: 2,
            subsurface_group: 2,
            world_from_local: Affine3A::from_translation(Vec3::new(x, 1.0, 0.5)),
            is_movable: true,
        });
    }
    prepared.edit(Edit::Objects(wanted.objects.clone())).expect("a valid edit");
    check(&prepared, &wanted, "added");

    wanted.objects.remove(0);
    prepared.edit(Edit::Objects(wanted.objects.clone())).expect("a valid edit");
    check(&prepared, &wanted, "removed");
    assert!(prepared.edit(Edit::RemoveMaterial(1)).is_err(), "it is that of an object");
    wanted.materials.remove(0);
    wanted.objects.iter_mut().for_each(|object| object.material -= 1);
    prepared.edit(Edit::RemoveMaterial(0)).expect("a valid edit");
    check(&prepared, &wanted, "without its material");

    let broken = Object {
        world_from_local: Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0)),
        ..wanted.objects[1].clone()
    };
    for objects in [Vec::new(), vec![Object { material: 2, ..wanted.objects[0].clone() }], vec![broken]] {
        assert!(prepared.edit(Edit::Objects(objects)).is_err());
        check(&prepared, &wanted, "refused");
    }
}

fn picture(prepared: &PreparedScene) -> FilmSums {
    let mut film = FilmSums::new(16, 16);
    render(prepared, &mut film, 2);
    film
}

/// Every kind of edit, with what it prepares anew.
fn edits() -> Vec<(&'static str, Edit, Renewed)> {
    let none = Renewed::default();
    let material = Renewed { materials: 1, ..none };
    let emissive = Material { emission_luminance: 3.0, ..matte(Vec3::ONE) };
    let walk = Material { subsurface_model: SubsurfaceModel::RandomWalk(WalkSurface::Clear), ..wax(0.3) };
    let default = Material { subsurface_model: SubsurfaceModel::Default, ..wax(0.3) };
    let normalized = Material { subsurface_normalization: SubsurfaceNormalization::Energy, ..wax(0.4) };
    let moved = Mesh {
        positions: sphere(1.0, 16).positions.into_iter().map(|p| p + Vec3::X).collect(),
        ..sphere(1.0, 16)
    };
    let object = Object {
        name: "moved".into(),
        mesh: moved.into(),
        material: 0,
        subsurface_group: 0,
        ..Object::default()
    };
    let bright = Environment { radiance: Vec3::ONE, ..uniform_environment(Vec3::ONE).expect("a sky") };
    let point_based = Integrator { subsurface_method: SubsurfaceMethod::PointBased, ..still().integrator };
    let clear = Integrator { caustics: true, subsurface_sharing: false, ..still().integrator };
    let colors = image("colors", [Vec3::new(0.9, 0.2, 0.1), Vec3::new(0.1, 0.8, 0.3)]);
    let sky = image("sky", [Vec3::new(0.0, 0.5, 2.0), Vec3::new(1.0, 0.1, 0.0)]);
    let others = image("others", [Vec3::splat(0.2), Vec3::new(0.7, 0.9, 0.1)]);
    let under_sky = Environment { image: Some(1), ..uniform_environment(Vec3::ONE).expect("a sky") };
    vec![
        ("image of colors", Edit::AddImage(colors), none),
        ("colors", Edit::Material(0, Box::new(painted(0))), material),
        ("image of a sky", Edit::AddImage(sky), none),
        ("sky", Edit::Environment(Some(under_sky)), Renewed { lights: true, ..none }),
        ("image of other colors", Edit::AddImage(others), none),
        ("other colors", Edit::Material(0, Box::new(painted(2))), material),
        ("without the first", Edit::DropUnusedImages, none),
        ("length", Edit::Material(0, Box::new(wax(0.7))), material),
        ("walk", Edit::Material(0, Box::new(walk)), material),
        ("normalization", Edit::Material(0, Box::new(normalized)), material),
        ("emission", Edit::Material(1, Box::new(emissive)), Renewed { lights: true, ..material }),
        ("lights", Edit::Lights(vec![light(3.0), light(1.5)]), Renewed { lights: true, ..none }),
        ("no lights", Edit::Lights(Vec::new()), Renewed { lights: true, ..none }),
        ("environment", Edit::Environment(Some(bright)), Renewed { lights: true, ..none }),
        ("no environment", Edit::Environment(None), Renewed { lights: true, ..none }),
        ("object", Edit::Object(0, Box::new(object)), Renewed { geometry: true, lights: true, ..none }),
        ("integrator", Edit::Integrator(clear), Renewed { materials: 2, ..none }),
        // A walk, until points are asked for
        ("default", Edit::Material(0, Box::new(default)), material),
        ("points", Edit::Integrator(point_based), Renewed { materials: 2, points: true, ..none }),
    ]
}

fn apply(scene: &mut Scene, edit: Edit) {
    match edit {
        Edit::Material(index, material) => scene.materials[index] = *material,
        Edit::Object(index, object) => scene.objects[index] = *object,
        Edit::Lights(lights) => scene.lights = lights,
        Edit::Environment(environment) => scene.environment = environment,
        Edit::Integrator(integrator) => scene.integrator = integrator,
        Edit::AddImage(image) => scene.images.push(image),
        Edit::Objects(objects) => scene.objects = objects,
        Edit::AddMaterial(material) => scene.materials.push(*material),
        Edit::RemoveMaterial(_) | Edit::DropUnusedImages => {}
    }
}

#[test]
fn edited_scene_renders_as_one_that_is_prepared_anew() {
    // One prepared scene goes through all edits, so that nothing of an earlier one is left
    let mut prepared = PreparedScene::new(still()).expect("a valid scene");
    let mut fresh = still();
    for (name, edit, renewed) in edits() {
        assert_eq!(prepared.edit(edit.clone()).expect(name), renewed, "{name}");
        apply(&mut fresh, edit);
        let anew = PreparedScene::new(fresh.clone()).expect("a valid scene");
        assert!(picture(&prepared) == picture(&anew), "{name}");
        assert_eq!(prepared.notes(), anew.notes(), "{name}");
        if name == "emission" {
            // Light from the floor would drown what the other edits change
            let edit = Edit::Material(1, Box::new(matte(Vec3::splat(0.6))));
            prepared.edit(edit.clone()).expect("a valid material");
            apply(&mut fresh, edit);
        }
        if name == "without the first" {
            let names: Vec<&str> = prepared.scene().images.iter().map(|image| image.name.as_str()).collect();
            assert_eq!(names, ["sky", "others"], "nothing refers to the first colors any more");
        }
    }
}

/// The windows of a room are those of its walls and its sky after each edit.
#[test]
fn edited_room_renders_as_one_that_is_prepared_anew() {
    let room = |window: f32| {
        let mut scene = still();
        let (x, y, z) = (Vec3::X * 3.0, Vec3::Y * 3.0, Vec3::Z * 9.0);
        let walls = [(-y, x, -z), (y, x, z), (-x, y, z), (x, z, y), (-z, x, y), (z - Vec3::X * window, x, y)];
        let floor = scene.objects.pop().expect("a floor");
        scene
            .objects
            .extend(walls.map(|(center, a, b)| Object { mesh: quad(center, a, b).into(), ..floor.clone() }));
        scene
    };
    let mut prepared = PreparedScene::new(room(2.0)).expect("a valid scene");
    let mut fresh = room(2.0);
    let sky = Environment { radiance: Vec3::new(0.2, 0.5, 0.9), ..fresh.environment.expect("a sky") };
    for (name, edit) in [
        ("lights", Edit::Lights(vec![light(1.5)])),
        ("sky", Edit::Environment(Some(sky))),
        ("walls", Edit::Objects(room(1.0).objects)),
    ] {
        prepared.edit(edit.clone()).expect(name);
        apply(&mut fresh, edit);
        let anew = PreparedScene::new(fresh.clone()).expect("a valid scene");
        assert!(picture(&prepared) == picture(&anew), "{name}");
    }
}

/// Normalization stays with its material when another one before it is removed.
#[test]
fn removed_material_leaves_the_others_normalized() {
    let mut wanted = still();
    wanted.materials[0].subsurface_normalization = SubsurfaceNormalization::Energy;
    let mut spare = wanted.clone();
    spare.materials.insert(0, matte(Vec3::ONE));
    spare.objects.iter_mut().for_each(|object| object.material += 1);
    let mut prepared = PreparedScene::new(spare).expect("a valid scene");
    prepared.edit(Edit::RemoveMaterial(0)).expect("no object has it");
    assert!(picture(&prepared) == picture(&PreparedScene::new(wanted).expect("a valid scene")));
}

#[test]
fn edit_that_is_not_valid_changes_nothing() {
    let mut prepared = PreparedScene::new(still()).expect("a valid scene");
    let before = picture(&prepared);
    let nan = Material { specular_ior: f32::NAN, ..wax(0.2) };
    let dangling = Object { material: 7, ..still().objects.remove(0) };
    let dark = Light::Sphere { center: Vec3::ZERO, radius: -1.0, radiance: Vec3::ONE, visible: true };
    for edit in [
        Edit::AddImage(image("broken", [Vec3::NAN; 2])),
        Edit::Material(0, Box::new(painted(0))),
        Edit::Material(0, Box::new(nan)),
        Edit::Material(9, Box::new(wax(0.2))),
        Edit::Object(0, Box::new(dangling)),
        Edit::Object(2, Box::new(still().objects.remove(0))),
        Edit::Lights(vec![dark]),
        Edit::Environment(Some(Environment {
            image: Some(3),
            ..uniform_environment(Vec3::ONE).expect("a sky")
        })),
        Edit::Integrator(Integrator { max_depth: 0, ..Integrator::default() }),
    ] {
        let error = prepared.edit(edit.clone()).expect_err("not valid");
        assert!(!error.to_string().is_empty(), "{edit:?}");
        assert!(picture(&prepared) == before, "{edit:?}: {error}");
        assert!(prepared.scene().images.is_empty(), "{edit:?}");
    }
}

#[test]
fn camera_and_film_that_are_not_valid_are_refused() {
    let view = PreparedScene::new(still()).expect("a valid scene").view().expect("a valid view");
    let camera = *view.camera();
    assert!(view.with_camera(Camera { target: camera.position, ..camera }).is_err());
    assert!(
        view.with_camera(Camera { projection: Projection::Perspective { horizontal_fov: 180.0 }, ..camera })
            .is_err()
    );
    let mut nowhere = still();
    nowhere.film.width = 0;
    assert!(PreparedScene::new(nowhere).is_err());
}
