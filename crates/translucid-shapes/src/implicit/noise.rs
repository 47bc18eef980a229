//! Solid noise for the colors and the relief of natural surfaces.

use std::sync::LazyLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8, f32x16, i32x16, u32x8, u32x16};
use glam::{IVec3, Vec3};

/// The instructions that the processor has.
static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// Factor of the hash's first step, so also the difference that it leaves between neighbors.
const FACTOR: u32 = 1_664_525;

/// Summand of the hash's first step.
const INCREMENT: u32 = 1_013_904_223;

/// First step of the hash, for each coordinate alone.
#[inline(always)]
fn first_step(coordinate: u32) -> u32 {
    coordinate.wrapping_mul(FACTOR).wrapping_add(INCREMENT)
}

/// Third coordinate as the hash takes it.
#[inline(always)]
fn seeded(z: i32, seed: u32) -> u32 {
    z as u32 ^ seed.wrapping_mul(0x9e37_79b9)
}

/// The two further steps of a hash of grid points (pcg3d of M. Jarzynski and O. Olano, "Hash functions for GPU
/// rendering", 2020).
macro_rules! stir_twice {
    ($x:ident, $y:ident, $z:ident) => {
        for _ in 0..2 {
            $x += $y * $z;
            $y += $z * $x;
            $z += $x * $y;
            $x = $x ^ ($x >> 16);
            $y = $y ^ ($y >> 16);
            $z = $z ^ ($z >> 16);
        }
    };
}

/// Scale of 24 bits to [0, 1).
const UNIT: f32 = 1.0 / 16_777_216.0;

/// The grid point below `p`, and the place from there to `p` in [0, 1); within ±2³¹.
// `f32::floor` is a call where the compiler may not rely on an instruction for it.
#[inline(always)]
fn split(p: Vec3) -> (IVec3, Vec3) {
    let below = |x: f32| {
        let toward_zero = x as i32;
        toward_zero.wrapping_sub(i32::from(toward_zero as f32 > x))
    };
    let base = IVec3::new(below(p.x), below(p.y), below(p.z));
    (base, p - base.as_vec3())
}

/// Smooth noise in [−1, 1] with features of size 1.
pub(crate) fn noise(p: Vec3, seed: u32) -> f32 {
    dispatch!(*LEVEL, simd => noise_by(simd, p, seed))
}

#[inline(always)]
fn noise_by<S: Simd>(simd: S, p: Vec3, seed: u32) -> f32 {
    let (base, f) = split(p);
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    // The corners of the cell, x fastest
    let [x0, y0] = [base.x, base.y].map(|c| first_step(c as u32));
    let [x1, y1] = [x0, y0].map(|c| c.wrapping_add(FACTOR));
    let [z0, z1] = [base.z, base.z.wrapping_add(1)].map(|z| first_step(seeded(z, seed)));
    let mut x = u32x8::from_slice(simd, &[x0, x1, x0, x1, x0, x1, x0, x1]);
    let mut y = u32x8::from_slice(simd, &[y0, y0, y1, y1, y0, y0, y1, y1]);
    let mut z = u32x8::from_slice(simd, &[z0, z0, z0, z0, z1, z1, z1, z1]);
    stir_twice!(x, y, z);
    let at = ((x >> 8).to_float::<f32x8<S>>() * UNIT).to_array();
    let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
    let row = |y: usize| mix(at[2 * y], at[2 * y + 1], w.x);
    let plane = |z: usize| mix(row(2 * z), row(2 * z + 1), w.y);
    2.0 * mix(plane(0), plane(1), w.z) - 1.0
}

/// Sum of `octaves` noises, each half as large and half as strong as the one before; within [−1, 1].
pub(crate) fn fractal_noise(p: Vec3, octaves: u32, seed: u32) -> f32 {
    dispatch!(*LEVEL, simd => fractal_noise_by(simd, p, octaves, seed))
}

#[inline(always)]
fn fractal_noise_by<S: Simd>(simd: S, p: Vec3, octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut weight = 0.5;
    let mut q = p;
    for octave in 0..octaves {
        sum += weight * noise_by(simd, q, seed.wrapping_add(octave));
        weight *= 0.5;
        // A turn between octaves hides the grid.
        q = 2.03 * Vec3::new(0.8 * q.x - 0.6 * q.z, q.y, 0.6 * q.x + 0.8 * q.z);
    }
    sum
}

/// Distance to the nearest of points scattered one per unit cell, in [0, 1.8).
pub(crate) fn cell_distance(p: Vec3, seed: u32) -> f32 {
    dispatch!(*LEVEL, simd => cell_distance_by(simd, p, seed))
}

#[inline(always)]
fn cell_distance_by<S: Simd>(simd: S, p: Vec3, seed: u32) -> f32 {
    let (base, _) = split(p);
    let [first, second] = &CELLS_AROUND;
    let nearest =
        squared_distances(simd, p, base, first, seed).min(squared_distances(simd, p, base, second, seed));
    nearest.to_array().into_iter().fold(f32::MAX, f32::min).sqrt()
}

/// Squared distances to the points of 16 cells at these steps from `base`.
// Without closures: those that end up outside of the function for an instruction set do without it.
#[inline(always)]
fn squared_distances<S: Simd>(simd: S, p: Vec3, base: IVec3, steps: &[[i32; 16]; 3], seed: u32) -> f32x16<S> {
    let corner_x = i32x16::from_slice(simd, &steps[0]) + base.x;
    let corner_y = i32x16::from_slice(simd, &steps[1]) + base.y;
    let corner_z = i32x16::from_slice(simd, &steps[2]) + base.z;
    let mut x = corner_x.bitcast::<u32x16<S>>() * FACTOR + INCREMENT;
    let mut y = corner_y.bitcast::<u32x16<S>>() * FACTOR + INCREMENT;
    let mut z = (corner_z.bitcast::<u32x16<S>>() ^ seeded(0, seed)) * FACTOR + INCREMENT;
    stir_twice!(x, y, z);
    let point_x = corner_x.to_float::<f32x16<S>>() + (x >> 8).to_float::<f32x16<S>>() * UNIT;
    let point_y = corner_y.to_float::<f32x16<S>>() + (y >> 8).to_float::<f32x16<S>>() * UNIT;
    let point_z = corner_z.to_float::<f32x16<S>>() + (z >> 8).to_float::<f32x16<S>>() * UNIT;
    let (x, y, z) = (point_x - p.x, point_y - p.y, point_z - p.z);
    x * x + y * y + z * z
}

/// Offsets along x, y and z of a cell and its 26 neighbors; the last is there six times.
const CELLS_AROUND: [[[i32; 16]; 3]; 2] = cells_around();

const fn cells_around() -> [[[i32; 16]; 3]; 2] {
    let mut cells = [[[1; 16]; 3]; 2];
    let mut number = 0;
    while number < 27 {
        let (half, lane) = (number / 16, number % 16);
        let cell = number as i32;
        cells[half][0][lane] = cell % 3 - 1;
        cells[half][1][lane] = cell / 3 % 3 - 1;
        cells[half][2][lane] = cell / 9 - 1;
        number += 1;
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hash in the words of its authors.
    fn hash(p: IVec3, seed: u32) -> Vec3 {
        let [mut x, mut y, mut z] = [p.x as u32, p.y as u32, seeded(p.z, seed)].map(first_step);
        for _ in 0..2 {
            x = x.wrapping_add(y.wrapping_mul(z));
            y = y.wrapping_add(z.wrapping_mul(x));
            z = z.wrapping_add(x.wrapping_mul(y));
            [x, y, z] = [x, y, z].map(|x| x ^ (x >> 16));
        }
        Vec3::new((x >> 8) as f32, (y >> 8) as f32, (z >> 8) as f32) / 16_777_216.0
    }

    /// Points on both sides of the origin, far apart.
    fn points() -> impl Iterator<Item = Vec3> {
        (0..20_000).map(|i| {
            let t = i as f32;
            Vec3::new((0.618 * t) % 200.0 - 100.0, (1.37 * t) % 40.0 - 20.0, (0.137 * t) % 9.0 - 4.5)
        })
    }

    /// All instruction sets make the same mesh: the bits must be those of scalar code.
    #[test]
    fn noise_is_that_of_scalar_code() {
        for p in points() {
            let base = p.floor();
            let f = p - base;
            let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
            let at = |x, y, z| hash(base.as_ivec3() + IVec3::new(x, y, z), 7).x;
            let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
            let row = |y, z| mix(at(0, y, z), at(1, y, z), w.x);
            let plane = |z| mix(row(0, z), row(1, z), w.y);
            assert_eq!(noise(p, 7).to_bits(), (2.0 * mix(plane(0), plane(1), w.z) - 1.0).to_bits(), "{p}");
        }
    }

    #[test]
    fn cell_distance_is_that_of_scalar_code() {
        for p in points() {
            let base = p.floor().as_ivec3();
            let around = |i: i32| IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
            let squares = (0..27).map(|i| {
                let cell = base + around(i);
                p.distance_squared(cell.as_vec3() + hash(cell, 7))
            });
            let nearest = squares.fold(f32::MAX, f32::min).sqrt();
            assert_eq!(cell_distance(p, 7).to_bits(), nearest.to_bits(), "{p}");
        }
    }

    /// Every instruction set of this machine, each forced.
    #[test]
    #[cfg(target_arch = "x86_64")]
    fn instruction_sets_agree() {
        let levels = [
            LEVEL.as_avx2().map(Level::Avx2),
            LEVEL.as_sse4_2().map(Level::Sse4_2),
            LEVEL.as_sse2().map(Level::Sse2),
        ];
        let all = |level: Level, p: Vec3| {
            dispatch!(level, simd => [
                noise_by(simd, p, 7),
                fractal_noise_by(simd, p, 4, 7),
                cell_distance_by(simd, p, 7),
            ])
            .map(f32::to_bits)
        };
        for level in levels.into_iter().flatten() {
            for p in points() {
                assert_eq!(all(level, p), all(*LEVEL, p), "{level:?}, {p}");
            }
        }
    }
}
