//! Lower bounds of the distance from points to the surfaces of a subsurface group.
//!
//! Most flights of a walk are short and far from any surface. A grid of cells over a group's box knows for each cell how
//! many cells around it no triangle touches, by Euclidean distance, so that such flights need no ray. What is found
//! does not depend on it.
//!
//! The distance transform is that of P. F. Felzenszwalb and D. P. Huttenlocher, *Distance Transforms of Sampled
//! Functions*, 2012: the lower envelope of parabolas, one axis after the other.

use std::sync::OnceLock;

use glam::{UVec3, Vec3};
use translucid_scene::Object;

/// Cells of all grids together: two million bytes.
const CELLS: f32 = 2_097_152.0;

/// Steps of a cell's edge in which distances are kept, rounded down.
const STEPS: f32 = 2.0;

/// Grids of the subsurface groups of a scene, each made when it is first asked for.
pub(crate) struct Clearances(Vec<(u32, OnceLock<Clearance>)>);

impl Clearances {
    pub(super) fn new(objects: &[Object]) -> Self {
        let mut groups: Vec<u32> = objects.iter().map(|object| object.subsurface_group).collect();
        groups.sort_unstable();
        groups.dedup();
        Self(groups.into_iter().map(|group| (group, OnceLock::new())).collect())
    }

    /// The grid of a group of the objects that this was made for.
    pub(super) fn of(&self, objects: &[Object], group: u32) -> Option<&Clearance> {
        let index = self.0.binary_search_by_key(&group, |(group, _)| *group).ok()?;
        let cells = CELLS / self.0.len() as f32;
        let of_group = || objects.iter().filter(move |object| object.subsurface_group == group);
        let triangles = || {
            of_group().flat_map(|Object { mesh, .. }| {
                mesh.triangles.iter().map(|corners| corners.map(|corner| mesh.positions[corner as usize]))
            })
        };
        Some(self.0[index].1.get_or_init(|| Clearance::new(triangles, cells)))
    }
}

/// A grid over the surfaces of a group.
pub(crate) struct Clearance {
    origin: Vec3,
    /// Edge of a cell \[L\].
    edge: f32,
    size: UVec3,
    /// Distance to the nearest surface in parts of an edge, x fastest.
    steps: Vec<u8>,
}

impl Clearance {
    /// The grid of about so many cells over triangles.
    fn new<I: Iterator<Item = [Vec3; 3]>>(triangles: impl Fn() -> I, cells: f32) -> Self {
        let (low, high) = triangles()
            .flatten()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let extent = (high - low).max(Vec3::ZERO);
        let edge = extent.max_element() / cells.cbrt().max(1.0);
        let mut new = Self { origin: low, edge, size: UVec3::ZERO, steps: Vec::new() };
        if !(edge > 0.0 && edge.is_finite()) {
            return new;
        }
        new.size = (extent / edge).as_uvec3() + 1;
        let mut squared = vec![f32::INFINITY; new.size.element_product() as usize];
        for triangle in triangles() {
            new.touch(triangle, &mut squared);
        }
        for axis in 0..3 {
            new.transform(axis, &mut squared);
        }
        new.steps = squared.iter().map(|squared| (squared.sqrt() * STEPS) as u8).collect();
        new
    }

    /// Lower bound of the distance \[L\] from a point to the nearest surface; 0 outside the grid.
    #[inline]
    pub(super) fn at(&self, point: Vec3) -> f32 {
        let cell = (point - self.origin) / self.edge;
        // A NaN, too, is outside
        if !(cell.cmpge(Vec3::ZERO).all() && cell.cmplt(self.size.as_vec3()).all()) {
            return 0.0;
        }
        f32::from(self.steps[self.index(cell.as_uvec3())]) * (self.edge / STEPS)
    }

    fn index(&self, cell: UVec3) -> usize {
        ((cell.z * self.size.y + cell.y) * self.size.x + cell.x) as usize
    }

    /// Sets the cells around a triangle to 0: those it touches with a neighbor on each side, so that distances count
    /// between the nearest points of cells rather than their middles.
    fn touch(&self, triangle: [Vec3; 3], squared: &mut [f32]) {
        let cells = triangle.map(|vertex| (vertex - self.origin) / self.edge);
        let (low, high) = (cells[0].min(cells[1]).min(cells[2]), cells[0].max(cells[1]).max(cells[2]));
        if (high - low).max_element() > 2.0 {
            let [a, b, c] = triangle;
            let [ab, bc, ca] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
            for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                self.touch(part, squared);
            }
            return;
        }
        // Beside the neighbors a little room for rounding
        let first = (low - 1.01).max(Vec3::ZERO).as_uvec3();
        let last = (high + 1.01).as_uvec3().min(self.size - 1);
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                let start = self.index(UVec3::new(first.x, y, z));
                squared[start..=start + (last.x - first.x) as usize].fill(0.0);
            }
        }
    }

    /// Squared distances along one more axis, in cells.
    fn transform(&self, axis: usize, squared: &mut [f32]) {
        let size = self.size.to_array().map(|n| n as usize);
        let stride = [1, size[0], size[0] * size[1]][axis];
        let mut line = vec![0.0; size[axis]];
        let mut envelope = Vec::with_capacity(size[axis]);
        for first in 0..squared.len() / size[axis] {
            let start = first / stride * stride * size[axis] + first % stride;
            for (i, value) in line.iter_mut().enumerate() {
                *value = squared[start + i * stride];
            }
            lower_envelope(&line, &mut envelope);
            let mut parabolas = envelope.iter().peekable();
            let mut lowest = None;
            for i in 0..size[axis] {
                while let Some(parabola) = parabolas.next_if(|(_, from)| *from <= i as f32) {
                    lowest = Some(parabola.0);
                }
                squared[start + i * stride] = lowest.map_or(f32::INFINITY, |lowest: usize| {
                    let off = i.abs_diff(lowest) as f32;
                    off * off + line[lowest]
                });
            }
        }
    }
}

/// The parabolas (x − i)² + f(i) that are lowest somewhere, from left to right: i, and where it begins to be.
fn lower_envelope(f: &[f32], envelope: &mut Vec<(usize, f32)>) {
    envelope.clear();
    for (i, &height) in f.iter().enumerate().filter(|(_, height)| height.is_finite()) {
        let crossing = |&(j, _): &(usize, f32)| {
            let (x, y) = (i as f32, j as f32);
            ((height + x * x) - (f[j] + y * y)) / (2.0 * (x - y))
        };
        while envelope.last().is_some_and(|last| crossing(last) <= last.1) {
            envelope.pop();
        }
        let from = envelope.last().map_or(f32::NEG_INFINITY, crossing);
        envelope.push((i, from));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every bound is below the distance to all triangles, by points spread over them, and not by more than the diagonals of
    /// a cell at each end and of the three cells that a triangle's part may have touched.
    #[test]
    fn bounds_are_below_the_distance() {
        let random = |i: u32, salt: u32| sobol_burley::sample(i, salt, 7);
        let point = |i: u32, salt: u32| Vec3::new(random(i, salt), random(i, salt + 1), random(i, salt + 2));
        let triangles: Vec<[Vec3; 3]> = (0..40)
            .map(|i| {
                let size = if i < 3 { 3.0 } else { 0.2 };
                [0, 3, 6].map(|salt| point(i, 20) + size * (point(i, salt) - 0.5))
            })
            .collect();
        let grid = Clearance::new(|| triangles.iter().copied(), 32_768.0);
        for i in 0..2000 {
            let at = grid.origin + point(i, 40) * grid.size.as_vec3() * grid.edge;
            let mut nearest = f32::INFINITY;
            for [a, b, c] in &triangles {
                for j in 0..40_u16 {
                    for k in 0..=40 - j {
                        let (u, v) = (f32::from(j) / 40.0, f32::from(k) / 40.0);
                        nearest = nearest.min((a + (b - a) * u + (c - a) * v - at).length());
                    }
                }
            }
            let bound = grid.at(at);
            assert!(bound <= nearest && bound > nearest - 8.7 * grid.edge, "{at}: {bound} {nearest}");
        }
        assert_eq!(grid.at(grid.origin - 1.0), 0.0);
        assert_eq!(grid.at(Vec3::NAN), 0.0);
    }

    /// Nothing, a point, a line: no cell is clear.
    #[test]
    fn degenerate_surfaces_have_bounds() {
        assert_eq!(Clearance::new(std::iter::empty, 1000.0).at(Vec3::ZERO), 0.0);
        for triangle in [[Vec3::ONE; 3], [Vec3::ZERO, Vec3::X, Vec3::X * 2.0]] {
            assert_eq!(Clearance::new(|| std::iter::once(triangle), 1000.0).at(triangle[1]), 0.0);
        }
    }
}
