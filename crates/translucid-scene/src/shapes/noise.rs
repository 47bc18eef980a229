//! Solid noise for the colors and the relief of natural surfaces.

use glam::{IVec3, Vec3};

/// Three numbers in [0, 1) from a grid point (pcg3d of M. Jarzynski and O. Olano, "Hash functions for GPU
/// rendering", 2020).
fn hash(p: IVec3, seed: u32) -> Vec3 {
    let [mut x, mut y, mut z] = [p.x as u32, p.y as u32, p.z as u32 ^ seed.wrapping_mul(0x9e37_79b9)]
        .map(|x| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mut stir = || {
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        [x, y, z] = [x, y, z].map(|x| x ^ (x >> 16));
    };
    stir();
    stir();
    Vec3::new((x >> 8) as f32, (y >> 8) as f32, (z >> 8) as f32) / 16_777_216.0
}

/// Smooth noise in [−1, 1] with features of size 1.
pub(super) fn noise(p: Vec3, seed: u32) -> f32 {
    let base = p.floor();
    let f = p - base;
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let at = |x, y, z| hash(base.as_ivec3() + IVec3::new(x, y, z), seed).x;
    let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
    let row = |y, z| mix(at(0, y, z), at(1, y, z), w.x);
    let plane = |z| mix(row(0, z), row(1, z), w.y);
    2.0 * mix(plane(0), plane(1), w.z) - 1.0
}

/// Sum of `octaves` noises, each half as large and half as strong as the one before; within [−1, 1].
pub(super) fn fractal_noise(p: Vec3, octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut weight = 0.5;
    let mut q = p;
    for octave in 0..octaves {
        sum += weight * noise(q, seed.wrapping_add(octave));
        weight *= 0.5;
        // A turn between octaves hides the grid.
        q = 2.03 * Vec3::new(0.8 * q.x - 0.6 * q.z, q.y, 0.6 * q.x + 0.8 * q.z);
    }
    sum
}

/// Distance to the nearest of points scattered one per unit cell, in [0, 1.8).
pub(super) fn cell_distance(p: Vec3, seed: u32) -> f32 {
    let base = p.floor().as_ivec3();
    let mut nearest = f32::MAX;
    for z in -1..=1 {
        for y in -1..=1 {
            for x in -1..=1 {
                let cell = base + IVec3::new(x, y, z);
                nearest = nearest.min(p.distance_squared(cell.as_vec3() + hash(cell, seed)));
            }
        }
    }
    nearest.sqrt()
}
