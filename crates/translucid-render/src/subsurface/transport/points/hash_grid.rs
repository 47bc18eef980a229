//! Points by their place: a grid of cubes that exist where there are points.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use glam::{DVec3, Vec3};

/// Finds the points near a place.
pub(super) struct HashGrid {
    inverse_edge: f64,
    /// For each cube the last point put into it.
    last: HashMap<u64, u32, BuildHasherDefault<Identity>>,
    /// For each point the one put into its cube before it.
    before: Vec<u32>,
}

/// No point.
const NONE: u32 = u32::MAX;

impl HashGrid {
    /// An empty grid of cubes of this edge > 0 \[L\].
    pub(super) fn new(edge: f64) -> Self {
        Self { inverse_edge: edge.recip(), last: HashMap::default(), before: Vec::new() }
    }

    /// Puts in the point of the next number: 0, 1, 2 …
    pub(super) fn push(&mut self, position: Vec3) {
        let number = self.before.len() as u32;
        let cube = self.cube(position.as_dvec3());
        let before = self.last.insert(key(cube), number);
        self.before.push(before.unwrap_or(NONE));
    }

    /// Calls `found` for all points in the cubes that the ball meets, and maybe for others, until it returns true.
    #[inline]
    pub(super) fn any_near(&self, center: Vec3, radius: f64, mut found: impl FnMut(u32) -> bool) -> bool {
        let center = center.as_dvec3();
        let (low, high) = (self.cube(center - radius), self.cube(center + radius));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let mut point = self.last.get(&key([x, y, z])).copied().unwrap_or(NONE);
                    while point != NONE {
                        if found(point) {
                            return true;
                        }
                        point = self.before[point as usize];
                    }
                }
            }
        }
        false
    }

    fn cube(&self, position: DVec3) -> [i64; 3] {
        (position * self.inverse_edge).floor().to_array().map(|x| x as i64)
    }
}

/// A number for a cube; two cubes with the same one share their points, which callers tell apart by distance.
fn key(cube: [i64; 3]) -> u64 {
    cube.iter().fold(0x9e37_79b9_7f4a_7c15, |hash, &x| {
        let mixed = (hash ^ x as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed ^ (mixed >> 29)
    })
}

/// Keys are hashes already.
#[derive(Default)]
struct Identity(u64);

impl Hasher for Identity {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = self.0.rotate_left(8) ^ u64::from(byte);
        }
    }

    fn write_u64(&mut self, number: u64) {
        self.0 = number;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ball_meets_what_brute_force_finds() {
        let random = |i: u32, salt: u32| sobol_burley::sample(i, salt, 3) * 10.0 - 5.0;
        let point = |i: u32| Vec3::new(random(i, 0), random(i, 1), random(i, 2));
        let mut grid = HashGrid::new(0.8);
        (0..2000).for_each(|i| grid.push(point(i)));
        for i in 2000..2100 {
            for radius in [0.1_f32, 0.8, 1.7] {
                let near = |&p: &u32| point(p).distance(point(i)) < radius;
                let expected: Vec<u32> = (0..2000).filter(near).collect();
                let mut found = Vec::new();
                grid.any_near(point(i), f64::from(radius), |p| {
                    found.push(p);
                    false
                });
                found.retain(near);
                found.sort_unstable();
                found.dedup();
                assert_eq!(found, expected);
            }
        }
    }
}
