//! Lights in places and of sizes that they should not have.

use glam::Vec3;

use super::images::SKIES;
use super::random::Random;
use super::text::{Text, number};

/// Writes a light; `places` are points of objects, whose size is about `size`.
pub(crate) fn write(text: &mut Text, random: &mut Random, places: &[Vec3], size: f64) {
    text.open("[[light]]");
    let at = place(random, places, size);
    let extent =
        |random: &mut Random| random.pick(&[1e-40, 1e-9, 1e-6 * size, size, 1e3 * size, 1e9]).min(1e9);
    match random.below(6) {
        0 => {
            text.set_text("type", "rectangle");
            text.set_vector("center", at);
            text.set_vector("direction", random.direction());
            text.set_vector("up", random.direction());
            text.set("size", format!("[{}, {}]", number(extent(random)), number(extent(random))));
            text.set_color("radiance", brightness(random));
            text.set("visible", random.chance(0.5));
        }
        1 => {
            text.set_text("type", "sphere");
            text.set_vector("center", at);
            text.set_number("radius", extent(random));
            text.set_color("radiance", brightness(random));
            text.set("visible", random.chance(0.5));
        }
        2 => {
            text.set_text("type", "distant");
            text.set_vector("direction", random.direction());
            text.set_number("angular_radius", random.pick(&[0.0, 1e-9, 0.0099, 0.0101, 0.25, 89.999_99]));
            text.set_color("irradiance", brightness(random));
        }
        3 => {
            text.set_text("type", "spot");
            text.set_vector("position", at);
            text.set_vector("direction", random.direction());
            text.set_color("intensity", brightness(random));
            let outer = random.pick(&[1e-40, 1e-6, 30.0, 90.0, 180.0]);
            text.set_number("outer_angle", outer);
            text.set_number("inner_angle", outer * random.pick(&[0.0, 0.5, 0.999]));
        }
        4 => {
            text.set_text("type", "point");
            text.set_vector("position", at);
            text.set_color("intensity", brightness(random));
        }
        _ => {
            text.set_text("type", "beam");
            text.set_vector("origin", at);
            text.set_vector("direction", random.direction());
            text.set_number("radius", extent(random));
            text.set_color("power", brightness(random));
        }
    }
}

/// Inside of objects, on them, among them, or far away.
pub(crate) fn place(random: &mut Random, places: &[Vec3], size: f64) -> Vec3 {
    let on = places[random.below(places.len())];
    let other = places[random.below(places.len())];
    let near = random.cube() * size as f32;
    let far = random.direction() * (1e4 * size) as f32;
    random
        .pick(&[Vec3::ZERO, on, on.midpoint(other), near, near, near * 4.0, far])
        .clamp(Vec3::splat(-1e9), Vec3::splat(1e9))
}

fn brightness(random: &mut Random) -> [f64; 3] {
    let factor = random.pick(&[0.0, 1e-45, 1e-9, 1.0, 1.0, 1e6, 1e12]);
    random.color().map(|c| c * factor)
}

/// Writes an environment: none, even, or an image.
pub(crate) fn write_environment(text: &mut Text, random: &mut Random) {
    if random.chance(0.4) {
        return;
    }
    text.open("[environment]");
    text.set_color("radiance", brightness(random));
    if random.chance(0.5) {
        text.set_text("file", random.pick(&SKIES));
        text.set_number("rotation", random.pick(&[0.0, 33.0, 36000.0]));
    }
    text.set("visible", random.chance(0.5));
}
