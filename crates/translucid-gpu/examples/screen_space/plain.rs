//! The screen-space pass on the processor, for the plane alone: the gather of `scatter.wgsl` without a screen.

use glam::{Vec2, Vec3};

/// Turns of the disk that a pixel averages.
const TURNS: u32 = 4;

/// Pixels of a plane that is lit by irradiance 1 in a disk of radius 1, row by row: red, green, blue and coverage.
///
/// `text` is the exported disk, from which the taps are read as an engine's compiler would.
pub(crate) fn disk_on_plane(
    text: &str,
    surface_albedo: [f64; 3],
    size: u32,
    pixel: f32,
) -> Result<Vec<f32>, String> {
    let offsets = rows::<2>(text, "DISK_OFFSETS").into_iter().map(Vec2::from_array);
    let weights = rows::<3>(text, "DISK_WEIGHTS").into_iter().map(Vec3::from_array);
    let taps: Vec<(Vec2, Vec3)> = offsets.zip(weights).collect();
    if taps.is_empty() {
        return Err(String::from("the exported disk has no taps"));
    }
    let albedo = Vec3::from_array(surface_albedo.map(|albedo| albedo as f32));
    let mut pixels = Vec::with_capacity(4 * (size * size) as usize);
    for y in 0..size {
        for x in 0..size {
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let center = pixel * (at - 0.5 * size as f32);
            let mut light = Vec3::ZERO;
            for turn in 0..TURNS {
                let angle = std::f32::consts::TAU * (turn as f32 + noise(at)) / TURNS as f32;
                let axis = Vec2::from_angle(angle);
                for (offset, weight) in &taps {
                    if (center + axis.rotate(*offset)).length_squared() < 1.0 {
                        light += *weight;
                    }
                }
            }
            // As a target of 16 bits a channel holds it
            let rounded = |x: f32| f32::from_bits((x.to_bits() + 0x1000) & !0x1fff);
            pixels.extend((albedo * light / TURNS as f32).extend(1.0).to_array().map(rounded));
        }
    }
    Ok(pixels)
}

/// Interleaved gradient noise, as in `scatter.wgsl`.
fn noise(at: Vec2) -> f32 {
    (52.982_918_9 * (at.dot(Vec2::new(0.067_110_56, 0.005_837_15))).fract()).fract()
}

/// The vectors of a constant array.
fn rows<const N: usize>(text: &str, name: &str) -> Vec<[f32; N]> {
    let array = text.split_once(&format!("const {name}")).map_or("", |(_, rest)| rest);
    let array = array.split(';').next().unwrap_or_default();
    let vector = |part: &str| {
        let numbers: Vec<f32> =
            part.split(')').next()?.split(',').filter_map(|word| word.trim().parse().ok()).collect();
        numbers.try_into().ok()
    };
    array.split(&format!("vec{N}<f32>(")).skip(1).filter_map(vector).collect()
}
