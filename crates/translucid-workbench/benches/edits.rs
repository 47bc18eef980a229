//! Time from an edit of a prepared scene to the first ray that is traced after it.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench edits
//! ```
//!
//! For the built-in still life and, where the scans are there (`docs/inside/scans.md`), for a head of 71k triangles and a dragon of 870k.
//! Each figure is the median of 21 runs, in milliseconds of wall time, with the first ray through the picture's middle.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use translucid_load::{LoadOptions, load_scene, still_life};
use translucid_profile::Model;
use translucid_render::internals::sample_ray;
use translucid_render::{Edit, PreparedScene, View};
use translucid_scene::{Camera, Material, Projection, Scene, SubsurfaceModel};
use translucid_testing::asset;

const RUNS: usize = 21;

fn main() {
    println!("| scene | triangles | prepare | camera | material | textured material | lights | object |");
    println!("|---|---|---|---|---|---|---|---|");
    let profile = Some(SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique));
    let options = LoadOptions { subsurface_model: profile, ..LoadOptions::default() };
    report("still-life", still_life(&options).expect("built in"));
    for (name, file, mesh) in [
        ("head", "scenes/head.toml", "head/head_70k.ply"),
        ("dragon-870k", "scenes/dragon.toml", "dragon/dragon_870k.ply"),
    ] {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let Some(mesh) = asset(mesh) else {
            println!("| {name} | {mesh} is not in TRANSLUCID_ASSETS |");
            continue;
        };
        let options = LoadOptions { mesh_overrides: vec![(None, mesh)], ..LoadOptions::default() };
        report(name, load_scene(&root.join(file), &options, &mut Vec::new()).expect("a scene"));
    }
}

fn report(name: &str, scene: Scene) {
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    let start = Instant::now();
    let mut prepared = PreparedScene::new(scene).expect("a valid scene");
    let prepare = start.elapsed().as_secs_f64() * 1e3;
    let mut view = prepared.view().expect("a valid view");

    let camera = median(|run| {
        let old = *view.camera();
        view = view
            .with_camera(Camera {
                projection: Projection::Perspective { horizontal_fov: 30.0 + run as f32 },
                ..old
            })
            .expect("a camera");
        trace(&prepared, &view);
    });
    let index = prepared.scene().materials.iter().position(|m| m.subsurface_weight.factor > 0.0).unwrap_or(0);
    let material = median(|run| {
        let mut material = prepared.scene().materials[index].clone();
        // Other albedos in all channels, so that no table can serve again
        material.subsurface_color.factor *= 0.97 - 0.001 * run as f32;
        edit(&mut prepared, Edit::Material(index, Box::new(material)), &view);
    });
    let textured = median(|run| {
        let mut material = Material { name: "textured".into(), ..prepared.scene().materials[index].clone() };
        material.subsurface_color.vertex_color = true;
        // Another table each time
        material.subsurface_parameter = translucid_scene::SubsurfaceParameter::Mfp;
        material.subsurface_eta = 1.0 + 0.01 * (run + 1) as f32;
        edit(&mut prepared, Edit::Material(index, Box::new(material)), &view);
    });
    let lights = median(|_| {
        let lights = prepared.scene().lights.clone();
        edit(&mut prepared, Edit::Lights(lights), &view);
    });
    let object = median(|_| {
        let object = prepared.scene().objects[0].clone();
        edit(&mut prepared, Edit::Object(0, Box::new(object)), &view);
    });
    println!(
        "| {name} | {triangles} | {prepare:.0} | {camera:.3} | {material:.2} | {textured:.1} | {lights:.2} | {object:.0} |"
    );
}

fn edit(prepared: &mut PreparedScene, edit: Edit, view: &View) {
    prepared.edit(edit).expect("a valid edit");
    trace(prepared, view);
}

/// Traces a ray from the camera to its target.
fn trace(prepared: &PreparedScene, view: &View) {
    let Camera { position, target, .. } = *view.camera();
    black_box(sample_ray(prepared, position, (target - position).normalize(), 0, 0));
}

/// Median time of a work in milliseconds.
fn median(mut work: impl FnMut(usize)) -> f64 {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|run| {
            let start = Instant::now();
            work(run);
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}
