//! Probes on meshes that overlap, are open, nested, turned inside out or there twice.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors (a false alarm in
//! 2,700 comparisons).

use glam::{Affine3A, Vec3};
use translucid_profile::Model;
use translucid_render::{Edit, NoteKind, PreparedScene};
use translucid_scene::{ColorInput, Material, Mesh, ScalarInput, Scene, SubsurfaceModel, WalkSurface};

use crate::common::{assert_within, distant, measure, prepare, quad, scene, sphere, uniform_environment};

const A: f32 = 0.8;
const SAMPLES: u32 = 1 << 15;

fn translucent() -> Material {
    Material {
        name: "translucent".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::splat(A)),
        subsurface_radius_scale: ColorInput::constant(Vec3::splat(0.2)),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusionRefined),
        ..Material::default()
    }
}

/// Meshes of one group in even light.
fn in_even_light(meshes: Vec<Mesh>) -> Scene {
    let mut scene = scene(meshes, translucent());
    scene.environment = uniform_environment(Vec3::ONE);
    scene
}

/// Radiance of the surface below a point on the outside.
fn seen(scene: Scene, origin: Vec3, direction: Vec3) -> (Vec3, Vec3) {
    measure(&prepare(scene), origin, direction, SAMPLES)
}

fn moved(mut mesh: Mesh, by: Vec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|position| *position += by);
    mesh
}

/// The part of a mesh that lies outside of a unit sphere.
fn outside(mut mesh: Mesh, center: Vec3) -> Mesh {
    let positions = mesh.positions.clone();
    let middle = |corners: &[u32; 3]| corners.iter().map(|&c| positions[c as usize]).sum::<Vec3>() / 3.0;
    mesh.triangles.retain(|corners| middle(corners).distance(center) > 1.0);
    mesh
}

/// Inner parts of overlapping meshes lie in the dark, so in one group they are their union; in two groups light does not
/// pass from one to the other, and the seam is darker.
#[test]
fn overlapping_meshes_of_one_group_are_their_union() {
    let (left, right) = (Vec3::X * -0.6, Vec3::X * 0.6);
    let balls = || vec![moved(sphere(1.0, 96), left), moved(sphere(1.0, 96), right)];
    let union = vec![outside(balls()[0].clone(), right), outside(balls()[1].clone(), left)];
    // Close to the seam at x = 0, where each ball has the other's light within its reach, and far from it
    for (x, is_at_seam) in [(0.1_f32, true), (1.5, false)] {
        let (origin, direction) = (Vec3::new(x, 0.0, 3.0), Vec3::NEG_Z);
        let (expected, noise) = seen(in_even_light(union.clone()), origin, direction);
        let (one, error) = seen(in_even_light(balls()), origin, direction);
        let z = (one.x - expected.x) / error.x.hypot(noise.x);
        // The union's seam follows whole triangles
        assert!(z.abs() < 4.0 || (one.x / expected.x - 1.0).abs() < 0.01, "{x}: {one} ± {error}, {expected}");
        let mut apart = in_even_light(balls());
        apart.objects[1].subsurface_group = 1;
        let (two, _) = seen(apart, origin, direction);
        let loss = 1.0 - two.x / expected.x;
        assert_eq!(loss > 0.05, is_at_seam, "{x}: {two}, {expected}");
    }
}

/// An eye in a head: a mesh that is entirely inside gets no light, and takes none.
#[test]
fn nested_mesh_changes_nothing() {
    let (origin, direction) = (Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
    let (alone, noise) = seen(in_even_light(vec![sphere(1.0, 48)]), origin, direction);
    for (group, radius) in [(0, 0.9), (1, 0.9), (0, 0.5)] {
        let mut nested = in_even_light(vec![sphere(1.0, 48), sphere(radius, 48)]);
        nested.objects[1].subsurface_group = group;
        let (mean, error) = seen(nested, origin, direction);
        let z = (mean.x - alone.x) / error.x.hypot(noise.x);
        assert!(z.abs() < 4.0, "group {group}, radius {radius}: {mean} ± {error}, {alone}");
    }
}

/// A sheet is a half space on either side: it shows the light of the side that is seen, and lets none through.
#[test]
fn open_sheet_lets_no_light_through() {
    let mut sheet = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], translucent());
    sheet.lights.push(distant(Vec3::NEG_Z));
    let (front, _) = seen(sheet.clone(), Vec3::new(0.3, 0.1, 1.0), Vec3::NEG_Z);
    assert_eq!(front, Vec3::ZERO);
    let back = seen(sheet, Vec3::new(0.3, 0.1, -1.0), Vec3::Z);
    assert_within("back", back, Vec3::splat(A / std::f32::consts::PI));
}

/// A bowl is darker at its rim, where half of the surface around is missing, outside as inside.
#[test]
fn open_bowl_is_dark_at_its_rim() {
    let mut bowl = sphere(1.0, 96);
    let positions = bowl.positions.clone();
    bowl.triangles.retain(|corners| corners.iter().all(|&c| positions[c as usize].z < 1e-3));
    let closed = seen(in_even_light(vec![sphere(1.0, 96)]), Vec3::X * 3.0, Vec3::NEG_X);
    let bowl = in_even_light(vec![bowl]);
    let rim = seen(bowl.clone(), Vec3::new(3.0, 0.0, -0.02), Vec3::NEG_X);
    let ratio = rim.0.x / closed.0.x;
    assert!((0.4..0.7).contains(&ratio), "{rim:?} {closed:?}");
    let foot = seen(bowl, Vec3::NEG_Z * 3.0, Vec3::Z);
    assert!((foot.0.x / closed.0.x - 1.0).abs() < 0.1, "{foot:?} {closed:?}");
}

/// A closed mesh whose triangles face inward is seen from the side of its light, too.
#[test]
fn mesh_turned_inside_out_looks_the_same() {
    let mut turned = sphere(1.0, 48);
    turned.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    turned.normals.iter_mut().for_each(|normal| *normal = -*normal);
    let (origin, direction) = (Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
    let (plain, noise) = seen(in_even_light(vec![sphere(1.0, 48)]), origin, direction);
    let (mean, error) = seen(in_even_light(vec![turned]), origin, direction);
    let z = (mean.x - plain.x) / error.x.hypot(noise.x);
    assert!(z.abs() < 4.0, "{mean} ± {error}, {plain}");
}

/// A mirrored copy shares light with its original where the two meet, in one group.
#[test]
fn mirrored_half_completes_its_original() {
    let half = |sign: f32| {
        let mut half = quad(Vec3::X * 500.0, Vec3::X * 500.0, Vec3::Y * 1e3);
        half.positions.iter_mut().for_each(|position| position.x *= sign);
        if sign < 0.0 {
            // As loaders do with mirrored transforms: normals stay outside
            half.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        half
    };
    let both = in_even_light(vec![half(1.0), half(-1.0)]);
    assert_within("one group", seen(both.clone(), Vec3::new(0.05, 0.1, 1.0), Vec3::NEG_Z), Vec3::splat(A));
    let mut apart = both;
    apart.objects[1].subsurface_group = 1;
    let (mean, _) = seen(apart, Vec3::new(0.05, 0.1, 1.0), Vec3::NEG_Z);
    assert!(mean.x < 0.65 * A, "{mean}");
}

/// Faces that lie twice in the same place count once, in one object or in two of a group, whatever corner they begin with.
#[test]
fn faces_that_are_there_twice_count_once() {
    let plane = quad(Vec3::ZERO, Vec3::new(900.0, 300.0, 0.0), Vec3::new(-300.0, 900.0, 0.0));
    let mut rotated = plane.clone();
    rotated.triangles.iter_mut().for_each(|[a, b, c]| (*a, *b, *c) = (*b, *c, *a));
    let mut doubled = plane.clone();
    doubled.triangles.extend(rotated.triangles.clone());
    for (name, meshes) in
        [("one object", vec![doubled]), ("copy", vec![plane.clone(); 2]), ("rotated", vec![plane, rotated])]
    {
        let scene = in_even_light(meshes);
        for point in [Vec3::new(3.3, 1.1, 1.0), Vec3::new(-70.0, 20.0, 1.0)] {
            assert_within(name, seen(scene.clone(), point, Vec3::NEG_Z), Vec3::splat(A));
        }
    }
}

/// Two faces back to back are a slab without thickness: as much light comes through as comes back.
#[test]
fn faces_back_to_back_are_a_slab_without_thickness() {
    let top = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
    let bottom = quad(Vec3::ZERO, Vec3::Y * 1e3, Vec3::X * 1e3);
    let mut slab = scene(vec![top, bottom], translucent());
    slab.lights.push(distant(Vec3::NEG_Z));
    let through = seen(slab, Vec3::new(0.3, 0.1, 1.0), Vec3::NEG_Z);
    assert_within("through", through, Vec3::splat(A / std::f32::consts::PI));
}

/// A ball or a sheet in the same mesh is in no light and encloses nothing: neither profiles nor walks know of it.
#[test]
fn pieces_inside_a_mesh_change_nothing() {
    let joined = |inner: Mesh| {
        let mut mesh = sphere(1.0, 48);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(inner.positions);
        mesh.normals.clear();
        mesh.triangles.extend(inner.triangles.iter().map(|corners| corners.map(|i| i + first)));
        mesh
    };
    let sheet = quad(Vec3::ZERO, Vec3::X * 0.5, Vec3::Y * 0.5);
    let (origin, direction) = (Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
    for model in [
        SubsurfaceModel::Profile(Model::NormalizedDiffusionRefined),
        SubsurfaceModel::RandomWalk(WalkSurface::Diffuse),
    ] {
        let lit = |mesh: Mesh| {
            let mut scene = in_even_light(vec![mesh]);
            scene.materials[0].subsurface_model = model;
            scene.materials[0].subsurface_radius_scale = ColorInput::constant(Vec3::splat(0.4));
            scene.lights.push(distant(Vec3::Z));
            scene
        };
        let (alone, noise) = seen(lit(joined(Mesh::default())), origin, direction);
        for inner in [sphere(0.5, 24), sheet.clone()] {
            let count = inner.triangles.len();
            let scene = lit(joined(inner));
            let given = scene.objects[0].mesh.clone();
            let mut prepared = PreparedScene::new(scene).unwrap();
            let notes = prepared.notes();
            let found = notes.iter().find(|note| note.kind == NoteKind::InnerPieces).unwrap();
            assert!(found.message.contains(&format!("{count} of its faces")), "{found}");
            let (mean, error) = measure(&prepared, origin, direction, SAMPLES);
            let z = (mean.x - alone.x) / error.x.hypot(noise.x);
            assert!(z.abs() < 4.0, "{model:?}: {mean} ± {error}, {alone}");

            // They are seen in a body that is clear, and left out again
            let whole = |prepared: &PreparedScene| prepared.scene().objects[0].mesh == given;
            let body = prepared.scene().materials[0].clone();
            let clear = Material { transmission_weight: ScalarInput::constant(0.5), ..body.clone() };
            assert!(!whole(&prepared));
            assert!(prepared.edit(Edit::Material(0, clear.into())).unwrap().geometry && whole(&prepared));
            assert!(prepared.edit(Edit::Material(0, body.into())).unwrap().geometry && !whole(&prepared));
        }
    }
}

/// Of a body that fills a glass to its walls there is a note; a gap and a body that reaches into the glass are right.
#[test]
fn body_that_touches_glass_has_a_note() {
    for (radius, touches) in [(0.899, false), (0.9, true), (0.901, false)] {
        let mut scene = scene(vec![sphere(radius, 48), sphere(1.0, 48), sphere(0.9, 48)], translucent());
        let glass = Material { transmission_weight: ScalarInput::constant(1.0), ..Material::default() };
        scene.materials.push(glass);
        for (object, place) in [(1, Vec3::ONE), (2, Vec3::new(-1.0, 1.0, 1.0))] {
            scene.objects[object].material = 1;
            scene.objects[object].subsurface_group = object as u32;
            scene.objects[object].world_from_local = Affine3A::from_scale(place);
        }
        let notes = PreparedScene::new(scene).unwrap().notes();
        let touching: Vec<_> = notes.iter().filter(|note| note.kind == NoteKind::Touching).collect();
        assert_eq!(touching.len(), usize::from(touches), "{radius}: {touching:?}");
    }
}
