//! Scenes that the project has, and those of scans where these are.

use std::path::Path;

use glam::Vec3;
use translucid_load::{LoadOptions, load_scene, still_life};
use translucid_profile::Model;
use translucid_scene::{Light, Material, Mesh, Object, ScalarInput, Scene, SubsurfaceModel, WalkSurface};

use super::EDGE;
use crate::picture::profile_tests::profile;
use crate::picture::tests::{lamp, matte, scene, shape, wax};

fn options() -> LoadOptions {
    LoadOptions { size: Some([EDGE; 2]), ..LoadOptions::default() }
}

/// A file of the folder `scenes`.
fn file(name: &str, options: &LoadOptions) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    load_scene(&path, options, &mut Vec::new()).unwrap()
}

fn sized(mut scene: Scene) -> Scene {
    (scene.film.width, scene.film.height) = (EDGE, EDGE);
    scene
}

/// Three balls, of a walk, of a profile and matte, on a block under a lamp: none reflects, so that both sides take the same ways.
pub(super) fn spheres() -> Scene {
    let bare = ScalarInput::constant(0.0);
    let wax = Material { specular_weight: bare, ..wax(WalkSurface::Diffuse) };
    let mut scene = sized(scene(wax, Material { specular_weight: bare, ..matte() }));
    scene.materials.push(profile(Model::NormalizedDiffusionOblique));
    scene.objects = vec![
        shape("sphere", 0.8, Vec3::new(-1.1, 0.0, 0.0), 0, 0),
        shape("sphere", 0.8, Vec3::new(1.1, 0.0, 0.0), 2, 1),
        shape("sphere", 0.5, Vec3::new(0.0, 0.3, 0.9), 1, 2),
        shape("box", 6.0, Vec3::new(0.0, -6.8, 0.0), 1, 3),
    ];
    scene.lights.push(lamp());
    scene
}

/// Upright slabs side by side of every boundary that walks have, and of a profile, lit from behind.
pub(super) fn slabs() -> Scene {
    let mut scene = sized(scene(matte(), matte()));
    let walks = WalkSurface::ALL.map(SubsurfaceModel::RandomWalk);
    let models = walks.into_iter().chain([SubsurfaceModel::Profile(Model::NormalizedDiffusion)]);
    scene.objects.clear();
    for (index, subsurface_model) in models.enumerate() {
        scene.materials.push(Material {
            name: format!("slab {index}"),
            subsurface_model,
            subsurface_eta: if index == 0 { 1.0 } else { 1.3 },
            specular_weight: ScalarInput::constant(0.0),
            ..wax(WalkSurface::Clear)
        });
        let x = 0.7 * (index as f32 - 2.0);
        let corner = |k: usize| {
            let [right, up, front] = [k & 1, k >> 1 & 1, k >> 2].map(|bit| bit as f32);
            Vec3::new(x + 0.6 * right - 0.3, 3.0 * up - 1.5, 0.3 * front)
        };
        let quads = [[4, 5, 7, 6], [1, 0, 2, 3], [5, 1, 3, 7], [0, 4, 6, 2], [6, 7, 3, 2], [0, 1, 5, 4]];
        let mesh = Mesh {
            positions: (0..8).map(corner).collect(),
            triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
            ..Mesh::default()
        };
        let (material, subsurface_group) = (index + 2, index as u32);
        let name = format!("slab {index}");
        scene.objects.push(Object {
            name,
            mesh: mesh.into(),
            material,
            subsurface_group,
            ..Object::default()
        });
    }
    scene.camera.position = Vec3::new(0.5, 0.5, 4.5);
    let mut behind = lamp();
    if let Light::Rectangle { center, edge_x, edge_y, .. } = &mut behind {
        (*center, *edge_x, *edge_y) = (Vec3::new(0.3, 0.5, -3.0), 2.0 * Vec3::X, 2.0 * Vec3::Y);
    }
    scene.lights.push(behind);
    scene
}

/// Names and scenes of what has more triangles.
pub(super) fn models() -> Vec<(String, Scene)> {
    let mut all = vec![("still life".to_owned(), still_life(&options()).unwrap())];
    let bust = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/bust.ply");
    let preset = LoadOptions { preset: Some("marble".into()), ..options() };
    all.push(("bust".to_owned(), load_scene(&bust, &preset, &mut Vec::new()).unwrap()));
    for (name, mesh) in [("head", "head/head_70k.ply"), ("dragon", "dragon/dragon_198k.ply")] {
        let Some(path) = translucid_testing::asset(mesh) else {
            println!("{name} is left out: {mesh} is not in TRANSLUCID_ASSETS");
            continue;
        };
        let with_mesh = LoadOptions { mesh_overrides: vec![(None, path)], ..options() };
        let scene = file(&format!("{name}.toml"), &with_mesh);
        for (kind, model) in [("walk", Some(WalkSurface::Clear)), ("profile", None)] {
            let mut scene = scene.clone();
            if let Some(surface) = model {
                let is_below = |material: &&mut Material| material.subsurface_weight.factor > 0.0;
                for material in scene.materials.iter_mut().filter(is_below) {
                    material.subsurface_model = SubsurfaceModel::RandomWalk(surface);
                }
            }
            all.push((format!("{name}, {kind}"), scene));
        }
    }
    all
}
