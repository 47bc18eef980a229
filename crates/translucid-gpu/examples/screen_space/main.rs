//! A screen-space pass with the exported disk, on a graphics processor or, for the plane, on any.
//!
//! ```text
//! cargo run --release -p translucid-gpu --features device --example screen_space -- bust bust.png
//! cargo run --release -p translucid-gpu --features device --example screen_space -- disk pass.exr
//! ```
//!
//! `bust` draws the built-in bust, once opaque and once with the pass. `disk` draws the setup that `translucid judge` knows: a
//! plane, lit in a disk of the diameter 2, seen straight from above, 0.1 a pixel; a white surface has the value 1. `too-wide`
//! and `no-energy` draw it with two mistakes: a disk for a mean free path 1.5 times as long, and weights whose sum is 0.8.
//! `TRANSLUCID_DEVICE` is a part of the name of the device, `cpu` for none; without it the first one draws.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for a terminal")]

mod draw;
mod plain;

use std::path::Path;
use std::process::ExitCode;

use glam::Vec3;
use glam::camera::rh::proj::directx::{orthographic, perspective}; // Depths in [0, 1], as wgpu has them
use glam::camera::rh::view::look_at_mat4;
use translucid_export::{Export, Language, Material, Sizes, Subject, Target};
use translucid_image::{DisplayTransform, Picture, PictureChannel, ToneMapping};
use translucid_profile::{Configuration, Model, Parameterization};
use translucid_shapes::{ShapeParameters, build_shape};

use draw::{Canvas, Frame, View};

/// Surface albedos and mean free paths of the disk; `translucid judge` is told them.
const DISK: ([f64; 3], [f64; 3]) = ([0.9, 0.6, 0.4], [0.5, 0.35, 0.25]);
/// Surface albedos and mean free paths of marble by Jensen and others (2001), in centimeters, four times as long: the bust is
/// small on the screen.
const MARBLE: ([f64; 3], [f64; 3]) = ([0.931, 0.913, 0.894], [0.18, 0.15, 0.13]);
/// Edge of a pixel on the plane.
const PIXEL: f32 = 0.1;
/// Pixels along a side of the plane's picture and of the bust's.
const SIZES: [u32; 2] = [96, 512];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["bust", path] if path.ends_with(".png") => bust(Path::new(path)),
        ["disk", path] if path.ends_with(".exr") => disk(Path::new(path), 1.0, 1.0),
        ["too-wide", path] if path.ends_with(".exr") => disk(Path::new(path), 1.5, 1.0),
        ["no-energy", path] if path.ends_with(".exr") => disk(Path::new(path), 1.0, 0.8),
        _ => Err(String::from(
            "the arguments are `bust FILE.png`, or `disk`, `too-wide` or `no-energy` and `FILE.exr`",
        )),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

/// The lit disk on a plane, as linear values: by mean free paths so many times as long, and so many times as bright.
fn disk(path: &Path, length: f64, brightness: f64) -> Result<(), String> {
    // Half of the picture's width; the plane is larger, so that the light that leaves beyond the picture is gathered, too
    let half = 0.5 * PIXEL * SIZES[0] as f32;
    let text = exported_disk((DISK.0, DISK.1.map(|mfp| mfp * length)), 256)?;
    let (name, pixels) = match Canvas::open(SIZES[0]) {
        Ok(canvas) => {
            let corner = |x: f32, y: f32| [2.0 * half * x, 2.0 * half * y, 0.0, 0.0, 0.0, 1.0];
            let vertices =
                [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)].concat();
            let clip_from_world =
                orthographic(-half, half, -half, half, 0.1, 2.0) * look_at_mat4(Vec3::Z, Vec3::ZERO, Vec3::Y);
            let view = View { clip_from_world, light: Vec3::Z.extend(1.0) };
            let frame = Frame { vertices: &vertices, triangles: &[0, 1, 2, 0, 2, 3], view };
            (canvas.name().to_owned(), canvas.draw(&frame, &text, 256, 4)?)
        }
        Err(reason) => {
            println!("{reason}: the processor draws");
            (String::from("the processor"), plain::disk_on_plane(&text, DISK.0, SIZES[0], PIXEL)?)
        }
    };
    let picture = picture([SIZES[0]; 2], brightness, pixels);
    picture.save_exr(path).map_err(|error| error.to_string())?;
    println!("{name} drew {}", path.display());
    let words = |numbers: [f64; 3]| numbers.map(|number| number.to_string()).join(",");
    println!(
        "translucid judge {} --setup disk --size 2 --pixel {PIXEL} --surface-albedo {} --mfp {} --white 1",
        path.display(),
        words(DISK.0),
        words(DISK.1)
    );
    Ok(())
}

/// The bust without and with the pass, beside each other.
fn bust(path: &Path) -> Result<(), String> {
    let mesh = build_shape("bust", &ShapeParameters::new()).map_err(|error| error.to_string())?;
    let (low, high) = mesh.bounds();
    let (middle, height) = (0.5 * (low + high), high.y - low.y);
    let vertices: Vec<f32> = mesh
        .positions
        .iter()
        .zip(&mesh.normals)
        .flat_map(|(position, normal)| [position.to_array(), normal.to_array()].concat())
        .collect();
    let triangles: Vec<u32> = mesh.triangles.iter().flat_map(|triangle| triangle.to_vec()).collect();
    let eye = middle + height * Vec3::new(-0.5, 0.15, 2.1);
    let clip_from_world =
        perspective(0.52, 1.0, 0.1 * height, 10.0 * height) * look_at_mat4(eye, middle, Vec3::Y);
    let view = View { clip_from_world, light: Vec3::new(0.75, 0.55, 0.1).normalize().extend(0.0) };
    let canvas = Canvas::open(SIZES[1])?;
    let frame = Frame { vertices: &vertices, triangles: &triangles, view };
    let opaque = (MARBLE.0, [1e-4; 3]);
    let [left, right] = [opaque, MARBLE].map(|material| -> Result<Vec<f32>, String> {
        canvas.draw(&frame, &exported_disk(material, 32)?, 32, 16)
    });
    let (left, right) = (left?, right?);
    let row = 4 * SIZES[1] as usize;
    let both: Vec<f32> =
        left.chunks(row).zip(right.chunks(row)).flat_map(|(left, right)| [left, right].concat()).collect();
    // Radiosity over π is radiance
    let picture = picture([2 * SIZES[1], SIZES[1]], std::f64::consts::FRAC_1_PI, both);
    let display = DisplayTransform { exposure: 0.5, tone_mapping: ToneMapping::Neutral };
    picture.save_png(path, display).map_err(|error| error.to_string())?;
    println!("{} drew {}: opaque, and with the pass", canvas.name(), path.display());
    Ok(())
}

/// The text of `translucid export --to wgsl --what disk --model normalized-diffusion-refined`.
fn exported_disk((surface_albedo, mfp): ([f64; 3], [f64; 3]), taps: usize) -> Result<String, String> {
    let export = Export {
        target: Target::Text(Language::Wgsl),
        subjects: &[Subject::Disk],
        models: &[Model::NormalizedDiffusionRefined],
        material: Some(Material {
            surface_albedo,
            length: mfp,
            parameterization: Parameterization::Mfp,
            surface: None,
        }),
        configuration: Configuration::Diffuse,
        g: 0.0,
        eta: 1.0,
        sizes: Sizes { taps, ..Sizes::default() },
        command: "the example screen_space",
    };
    let bytes = export.bytes().map_err(|error| error.to_string())?;
    String::from_utf8(bytes).map_err(|error| error.to_string())
}

/// Pixels of red, green, blue and coverage as a picture.
fn picture(size: [u32; 2], factor: f64, pixels: Vec<f32>) -> Picture<'static> {
    let channels = ["R", "G", "B", "A"].map(PictureChannel::single).to_vec();
    let fill_row = move |y: u32, values: &mut [f64]| {
        let row = &pixels[y as usize * values.len()..];
        for (i, (value, pixel)) in values.iter_mut().zip(row).enumerate() {
            *value = f64::from(*pixel) * if i % 4 == 3 { 1.0 } else { factor };
        }
    };
    Picture::new(size, channels, fill_row)
}
