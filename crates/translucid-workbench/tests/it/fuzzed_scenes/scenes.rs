//! The scene of a seed, as files.

use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::random::Random;
use super::text::Text;
use super::{lights, materials, meshes};

/// Writes the scene of a seed into a directory that has the images, and returns its path.
pub(crate) fn write(seed: u64, directory: &Path) -> PathBuf {
    let mut random = Random::new(seed);
    let mut text = Text::default();
    let size = random.pick(&[1.0, 1.0, 1e-3, 3e-9, 1e4, 1e8]);
    text.set_text("unit", random.pick(&["mm", "cm", "m"]));
    text.set_text("subsurface_grouping", random.pick(&["object", "material"]));
    film(&mut text, &mut random);
    integrator(&mut text, &mut random, seed);
    let materials = 1 + random.below(3);
    for index in 0..materials {
        materials::write(&mut text, &mut random, index, size);
    }
    let mut places = Vec::new();
    for index in 0..1 + random.below(4) {
        text.open("[[object]]");
        text.set_text("material", &format!("material {}", random.below(materials)));
        if random.chance(0.5) {
            text.set_text("subsurface_group", random.pick(&["one", "other"]));
        }
        places.push(Vec3::ZERO);
        if random.chance(0.2) {
            shape(&mut text, &mut random, size);
            continue;
        }
        let mesh = meshes::random_mesh(&mut random, size as f32);
        let name = format!("scene-{seed}-{index}.ply");
        fs::write(directory.join(&name), mesh.ply(&mut random)).expect("a file in a directory of our own");
        text.set_text("file", &name);
        places.extend(mesh.positions.iter().take(8));
        if random.chance(0.3) {
            transform(&mut text, &mut random);
        }
    }
    for _ in 0..random.pick(&[0, 1, 1, 3, 40]) {
        lights::write(&mut text, &mut random, &places, size);
    }
    lights::write_environment(&mut text, &mut random);
    if random.chance(0.8) {
        camera(&mut text, &mut random, &places, size);
    }
    let path = directory.join(format!("scene-{seed}.toml"));
    fs::write(&path, text.finish()).expect("a file in a directory of our own");
    path
}

/// Removes the files of a scene.
pub(crate) fn remove(seed: u64, directory: &Path) {
    let meshes = (0..4).map(|index| format!("scene-{seed}-{index}.ply"));
    for name in meshes.chain([format!("scene-{seed}.toml")]) {
        // A scene has up to four meshes.
        let _ = fs::remove_file(directory.join(name));
    }
}

fn film(text: &mut Text, random: &mut Random) {
    text.open("[film]");
    text.set("size", "[64, 64]");
    text.set_text("filter", random.pick(&["box", "gaussian", "blackman-harris"]));
    text.set_number("filter_radius", random.pick(&[1e-40, 1e-3, 0.5, 1.5, 8.0]));
}

fn integrator(text: &mut Text, random: &mut Random, seed: u64) {
    text.open("[integrator]");
    text.set("samples_per_pixel", 4);
    text.set("max_depth", random.pick(&[1, 2, 4, 12, 1024]));
    text.set("max_diffuse_depth", random.pick(&[0, 1, 4, 1024]));
    text.set("caustics", random.chance(0.5));
    text.set_number("subsurface_tail", random.pick(&[1e-40, 1e-30, 1e-6, 1e-3, 0.1]));
    if random.chance(0.15) {
        text.set_text("subsurface_method", "point-based");
        text.set_number("point_tolerance", random.pick(&[0.001, 0.9, 1.0, 1.0, 1.0, 1.0]));
        text.set("point_memory", random.pick(&[1, 1 << 20]));
    }
    text.set("seed", seed);
}

/// A built-in shape of about the size.
fn shape(text: &mut Text, random: &mut Random, size: f64) {
    text.set_text("shape", random.pick(&["sphere", "box", "torus", "rectangle", "disc", "cone"]));
    text.set_number("scale", (size * random.pick(&[0.01, 1.0, 3.0])).clamp(1e-8, 1e8));
}

/// Stretched, turned, mirrored, moved a little.
fn transform(text: &mut Text, random: &mut Random) {
    let scale = [0; 3].map(|_| random.pick(&[-1.0, 1e-3, 0.5, 1.0, 1.0]));
    text.set_color("scale", scale);
    text.set_color("rotate", [0; 3].map(|_| random.pick(&[0.0, 0.0, 33.0, 90.0, -36000.0])));
}

/// Inside of objects, on them, or far away; any lens.
fn camera(text: &mut Text, random: &mut Random, places: &[Vec3], size: f64) {
    let position = lights::place(random, places, size);
    let toward = random.direction();
    let near = position + toward * (size * random.pick(&[1e-20, 1.0])) as f32;
    let at = lights::place(random, places, size);
    let target = random.pick(&[at, at, Vec3::ZERO, near]);
    // Another point than its own
    let target =
        if target != position { target } else { position + toward * position.length().max(1.0) * 1e-3 };
    let target = target.clamp(Vec3::splat(-1e9), Vec3::splat(1e9));
    text.open("[camera]");
    text.set_vector("position", position);
    text.set_vector("target", target);
    text.set_vector("up", random.cube());
    text.set_number("fov", random.pick(&[1e-40, 1e-3, 45.0, 90.0, 179.9, 180.0 - 1e-5]));
    let lens_radius = random.pick(&[0.0, 0.0, 1e-40, 0.1 * size, (1e3 * size).min(1e9)]);
    let focus_distance = random.pick(&[1e-40, 1e-9, size, 1e9]);
    // Wider ones are refused
    let widest = 250.0 * focus_distance.max(position.as_dvec3().distance(target.as_dvec3()));
    text.set_number("lens_radius", lens_radius.min(widest));
    text.set_number("focus_distance", focus_distance);
}
