//! Materials at the ends of their ranges.

use translucid_scene::SubsurfaceModel;

use super::images::{PROFILE, TEXTURES};
use super::random::Random;
use super::text::{Text, number, triple};

/// Writes the material of a number for objects about as large as `size`.
pub(crate) fn write(text: &mut Text, random: &mut Random, index: usize, size: f64) {
    text.open("[[material]]");
    text.set_text("name", &format!("material {index}"));
    if random.chance(0.05) {
        let preset = random.pick(&["marble", "jade", "wholemilk", "skin1"]);
        text.set_text("preset", preset);
        return;
    }
    surface(text, random, size);
    subsurface(text, random, size);
    if random.chance(0.3) {
        coat(text, random);
    }
    if random.chance(0.2) {
        text.set_number("emission_luminance", random.pick(&[0.0, 1e-30, 1.0, 1e6, 1e12]));
        set_color(text, random, "emission_color", 1e6);
    }
    if random.chance(0.3) {
        set_scalar(text, random, "geometry_opacity", 1.0);
    }
    if random.chance(0.2) {
        let scale = number(random.pick(&[-100.0, 0.0, 0.5, 100.0]));
        let file = random.pick(&TEXTURES);
        text.set("geometry_normal", format!("{{ file = \"{file}\", scale = {scale}{} }}", mapping(random)));
    }
}

fn surface(text: &mut Text, random: &mut Random, size: f64) {
    text.set_number("base_weight", random.weight());
    set_color(text, random, "base_color", 1.0);
    if random.chance(0.2) {
        set_scalar(text, random, "base_metalness", 1.0);
    }
    set_scalar(text, random, "specular_weight", 1.0);
    set_color(text, random, "specular_color", 1.0);
    if random.chance(0.2) {
        set_scalar(text, random, "specular_roughness", 1.0);
    } else {
        text.set_number("specular_roughness", random.pick(&[0.0, 1e-4, 0.03, 0.032, 0.3, 1.0]));
    }
    text.set_number("specular_ior", index_of_refraction(random));
    if random.chance(0.3) {
        set_scalar(text, random, "transmission_weight", 1.0);
        set_color(text, random, "transmission_color", 1.0);
        let depth = random.pick(&[0.0, 0.0, 1e-40, 1e-9, size, 1e9]);
        text.set_number("transmission_depth", depth);
    }
}

fn subsurface(text: &mut Text, random: &mut Random, size: f64) {
    if random.chance(0.2) {
        set_scalar(text, random, "subsurface_weight", 1.0);
    } else {
        text.set_number("subsurface_weight", random.pick(&[0.0, 0.5, 1.0, 1.0]));
    }
    // A profile of layers takes no textures
    let is_layered = random.chance(0.05);
    if is_layered {
        text.set_color("subsurface_color", random.color());
    } else {
        set_color(text, random, "subsurface_color", 1.0);
    }
    let between = random.unit();
    let radius = [0.0, 1e-40, 1e-9, 1e-3 * size, 0.1 * size, between * size, size, 1.0, 1e9];
    let radius = random.pick(&radius);
    if random.chance(0.2) && !is_layered {
        set_scalar(text, random, "subsurface_radius", radius);
    } else {
        text.set_number("subsurface_radius", radius);
    }
    let scale = [0.0, 1e-6, 0.25, 0.5, 1.0, 1.0, 1e6];
    text.set_color("subsurface_radius_scale", [0; 3].map(|_| random.pick(&scale)));
    let between = random.signed();
    let g = random.pick(&[-0.999, -0.99, -0.5, 0.0, 0.0, 0.0, between, 0.9, 0.99, 0.999, 1.0 - 1e-7]);
    text.set_number("subsurface_scatter_anisotropy", g);
    text.set_number("subsurface_eta", random.pick(&[0.5, 0.999, 1.0, 1.0, 1.0, 1.0001, 1.4, 3.0]));
    if is_layered {
        text.set_text("subsurface_model", SubsurfaceModel::Layers.name());
    } else if random.chance(0.03) {
        text.set_text("subsurface_table", PROFILE);
    } else {
        let others = SubsurfaceModel::ALL.into_iter().filter(|model| *model != SubsurfaceModel::Layers);
        text.set_text("subsurface_model", random.pick(&others.collect::<Vec<_>>()).name());
    }
    text.set_text("subsurface_parameter", random.pick(&["mfp", "dmfp"]));
    let configuration = random.pick(&["searchlight", "diffuse"]);
    text.set_text("subsurface_configuration", if is_layered { "diffuse" } else { configuration });
    text.set_text("subsurface_texture_at", random.pick(&["exit", "entry", "both"]));
    text.set_text("subsurface_normalization", random.pick(&["none", "none", "none", "energy"]));
    text.set_text("camera_visibility", random.pick(&["surface", "surface", "surface", "shadow", "none"]));
}

fn coat(text: &mut Text, random: &mut Random) {
    set_scalar(text, random, "coat_weight", 1.0);
    set_color(text, random, "coat_color", 1.0);
    set_scalar(text, random, "coat_roughness", 1.0);
    text.set_number("coat_ior", index_of_refraction(random));
}

fn index_of_refraction(random: &mut Random) -> f64 {
    random.pick(&[1.0, 1.0 + 1e-9, 1.0001, 1.002, 1.4, 1.5, 3.0, 4.0])
}

/// A color up to `largest`: a constant, vertex colors, or an image.
fn set_color(text: &mut Text, random: &mut Random, key: &str, largest: f64) {
    match random.below(10) {
        0 => text.set_text(key, "vertex"),
        1 | 2 => {
            let factor = triple([0; 3].map(|_| random.pick(&[0.0, 1e-6, 1.0, 1.0, 1e6])));
            let file = random.pick(&TEXTURES);
            let space = random.pick(&["srgb", "linear"]);
            let vertex = random.chance(0.3);
            let image = format!(
                "{{ file = \"{file}\", color_space = \"{space}\", factor = {factor}, vertex_color = {vertex}{} }}",
                mapping(random)
            );
            text.set(key, image);
        }
        _ => text.set_color(key, random.color().map(|c| c * largest)),
    }
}

/// A scalar up to `largest`: a constant or an image.
fn set_scalar(text: &mut Text, random: &mut Random, key: &str, largest: f64) {
    if random.chance(0.7) {
        text.set_number(key, random.weight() * largest);
        return;
    }
    let factor = number(random.pick(&[1e-6, 1.0, largest, 1e9]));
    let file = random.pick(&TEXTURES);
    let channel = random.pick(&["red", "green", "blue", "alpha"]);
    let mapping = mapping(random);
    text.set(key, format!("{{ file = \"{file}\", factor = {factor}, channel = \"{channel}\"{mapping} }}"));
}

/// Placement of an image, as keys of its table.
fn mapping(random: &mut Random) -> String {
    if random.chance(0.5) {
        return String::new();
    }
    let wrap = random.pick(&["repeat", "mirror", "clamp"]);
    let scale = number(random.pick(&[0.0, 1.0, -3.0, 1e6]));
    let offset = number(random.pick(&[0.0, 0.5, -1e6]));
    let turn = number(random.pick(&[0.0, 45.0, -36000.0]));
    format!(", wrap = \"{wrap}\", uv_scale = {scale}, uv_offset = [{offset}, 0], uv_rotation = {turn}")
}
