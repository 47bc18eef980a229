//! A lithophane: a plate whose thickness is a picture once light is behind it, of a moon above mountains and a lake.

use glam::{Vec2, Vec3};
use rayon::prelude::*;
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::{common, rounded_block, smoothstep};
use crate::implicit::noise::{fractal_noise, noise};
use crate::implicit::sculpture::{detail, height, sculpt};
use crate::parameters::{ShapeParameter, Values};

/// The height is that of the plate, which is a third wider.
pub(crate) const LITHOPHANE: &[ShapeParameter] = &[height(12.0), detail(480.0)];

/// Half-lengths of the plate, and where it is thinnest and thickest.
const HALF: [f32; 2] = [8.0, 6.0];
const THICKNESS: [f32; 2] = [0.06, 0.3];
/// Brightness of the darkest part, as part of the brightest one's.
const DARKEST: f32 = 0.03;
/// Rows and columns in which the relief is kept.
const ROWS: usize = 768;
const COLUMNS: usize = 1024;

/// Height of the lake's far shore; the picture's is from -1 to 1.
const SHORE: f32 = -0.36;
const MOON: [f32; 2] = [0.42, 0.5];
/// Mountains from far to near: mean height, range, peaks along the picture, seed, brightness.
const MOUNTAINS: [(f32, f32, f32, u32, f32); 3] =
    [(0.0, 0.95, 1.3, 3, 0.30), (-0.12, 0.7, 1.9, 11, 0.16), (-0.24, 0.46, 2.6, 25, 0.08)];
/// Pines: the foot's place, and the height.
const PINES: [[f32; 3]; 7] = [
    [-1.2, -0.98, 0.95],
    [-1.0, -1.05, 0.72],
    [-0.85, -1.1, 0.5],
    [-1.36, -1.0, 0.7],
    [1.2, -1.02, 0.8],
    [1.03, -1.08, 0.55],
    [1.36, -1.05, 0.62],
];

/// Ridges by folded noise.
fn ridge(mut x: f32, seed: u32) -> f32 {
    let (mut sum, mut weight) = (0.0, 0.5);
    for octave in 0..6 {
        sum += weight * (1.0 - noise(Vec3::new(x, 0.5, 0.5), seed + octave).abs());
        (x, weight) = (2.1 * x, 0.5 * weight);
    }
    sum
}

/// Brightness above the shore.
fn land(u: f32, v: f32) -> f32 {
    let [x, y] = [u - MOON[0], v - MOON[1]];
    let r = Vec2::new(x, y).length();
    let glow = 0.42 * libm::expf(-(r / 0.36) * (r / 0.36));
    let mut light = 0.09 + 0.3 * libm::expf(-(v - SHORE) / 0.45) + glow;
    let seas = fractal_noise(Vec3::new(7.0 * x, 7.0 * y, 0.3), 4, 4);
    let moon = 1.0 - 0.45 * smoothstep(-0.05, 0.35, seas);
    light += (moon - light) * smoothstep(0.174, 0.166, r);
    for (mean, range, peaks, seed, shade) in MOUNTAINS {
        let height = mean + range * (ridge(peaks * u, seed) - 0.62);
        let mist = shade + 0.24 * smoothstep(0.3, 0.0, v - SHORE) * (shade + 0.2);
        light += (mist - light) * smoothstep(0.005, -0.005, v - height);
    }
    light
}

/// Whether a pine stands there: 1, 0, or between them on its edge.
fn pine(u: f32, v: f32, [x, y, height]: [f32; 3]) -> f32 {
    let t = (v - y) / height;
    if !(-1.0..1.0).contains(&t) {
        return 0.0;
    }
    let branches = 1.0 - (9.0 * t - (9.0 * t).floor());
    let width = 0.17 * height * (1.0 - t) * (0.5 + 0.5 * branches) + 0.01;
    smoothstep(0.006, -0.006, (u - x).abs() - width)
}

/// Brightness of the picture: u from -4/3 to 4/3, v from -1 to 1.
fn picture(u: f32, v: f32) -> f32 {
    let scene = if v > SHORE {
        land(u, v)
    } else {
        // The lake mirrors the land, in waves that are longer nearby
        let near = SHORE - v;
        let wave = libm::sinf(60.0 * libm::logf(near + 0.05) + 3.0 * libm::sinf(4.0 * u));
        0.85 * land(u + 0.03 * near * wave, SHORE + near + 0.05 * near * wave)
    };
    let trees = PINES.iter().map(|&tree| pine(u, v, tree)).fold(0.0, f32::max);
    scene + (DARKEST - scene) * trees
}

/// Thickness of a plate that lets through the brightness, as if each layer took its part.
fn thickness(brightness: f32) -> f32 {
    let depth = libm::logf(brightness.clamp(DARKEST, 1.0)) / libm::logf(DARKEST);
    THICKNESS[0] + (THICKNESS[1] - THICKNESS[0]) * depth
}

pub(crate) fn lithophane(values: &Values) -> Result<Mesh, SceneError> {
    let at = |i: usize| {
        let [u, v] = [(i % COLUMNS) as f32 / (COLUMNS - 1) as f32, (i / COLUMNS) as f32 / (ROWS - 1) as f32];
        thickness(picture((2.0 * u - 1.0) * HALF[0] / HALF[1], 2.0 * v - 1.0))
    };
    let relief: Vec<f32> = (0..ROWS * COLUMNS).into_par_iter().map(at).collect();
    let surface = |p: Vec3| {
        let place = |x: f32, half: f32, count: usize| {
            let x = (0.5 + 0.5 * x / half).clamp(0.0, 1.0) * (count - 1) as f32;
            let first = (x as usize).min(count - 2);
            (first, x - first as f32)
        };
        let ((i, s), (j, t)) = (place(p.x, HALF[0], COLUMNS), place(p.y - HALF[1], HALF[1], ROWS));
        let row = |j: usize| {
            let [a, b] = [relief[j * COLUMNS + i], relief[j * COLUMNS + i + 1]];
            a + s * (b - a)
        };
        row(j) + t * (row(j + 1) - row(j))
    };
    let half = Vec3::new(HALF[0], HALF[1], 0.2);
    let distance = |p: Vec3| {
        let plate = rounded_block(p - Vec3::new(0.0, HALF[1], 0.2), half, 0.03);
        // Steps of the relief are steeper than a distance
        common(plate, 0.2 * (p.z - surface(p)), 0.004)
    };
    let bounds = [Vec3::new(-HALF[0], 0.0, 0.0), Vec3::new(HALF[0], 2.0 * HALF[1], THICKNESS[1])];
    Ok(sculpt(bounds, distance, |_, _| Vec3::ONE, values))
}
