//! Lower bounds of the distance from points to the surfaces of a subsurface group.
//!
//! Most flights of a walk are short and far from any surface. A grid of cells over a group's box knows for each cell how
//! many cells around it no triangle touches, by Euclidean distance, so that such flights need no ray. No result depends on
//! it.
//!
//! The distance transform is that of P. F. Felzenszwalb and D. P. Huttenlocher, *Distance Transforms of Sampled
//! Functions*, 2012: the lower envelope of parabolas, one axis after the other.

use glam::{UVec3, Vec3};

use super::orientation::orientation;

/// Steps of a cell's edge in which distances are kept, rounded down.
const STEPS: f32 = 2.0;

/// Triangles of a group beyond which it has no grid: making it would keep a rendering from being stopped for too long.
const MOST_TRIANGLES: usize = 1 << 21;

/// Rounding errors of a coordinate in cells, generously.
const ROOM: f32 = 0.01;

/// A grid over the surfaces of a group.
pub(crate) struct Clearance {
    origin: Vec3,
    /// Edge of a cell \[L\].
    edge: f32,
    size: UVec3,
    /// Distance to the nearest surface in parts of an edge, x fastest.
    steps: Vec<u8>,
    /// 1 where the group's surfaces are closed and look out, -1 where they look in, else 0.
    pub(super) orientation: f32,
}

impl Clearance {
    /// The grid of about so many cells over triangles; without cells where there are too many triangles.
    pub(super) fn new<I: Iterator<Item = [Vec3; 3]>>(triangles: impl Fn() -> I, cells: f32) -> Self {
        let (low, high) = triangles()
            .flatten()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let extent = (high - low).max(Vec3::ZERO);
        let edge = extent.max_element() / libm::cbrtf(cells).max(1.0);
        let orientation = orientation(&triangles);
        let mut new = Self { origin: low, edge, size: UVec3::ZERO, steps: Vec::new(), orientation };
        if !(edge > 0.0 && edge.is_finite()) || triangles().nth(MOST_TRIANGLES).is_some() {
            return new;
        }
        new.size = (extent / edge).as_uvec3() + 1;
        let mut squared = vec![f32::INFINITY; new.size.element_product() as usize];
        for triangle in triangles() {
            new.touch(triangle.map(|vertex| (vertex - low) / edge), &mut squared);
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

    /// Sets the cells to 0 that a triangle, in cells, touches: from layer to layer, from row to row.
    fn touch(&self, triangle: [Vec3; 3], squared: &mut [f32]) {
        let range = |polygon: &Polygon, axis: usize| {
            let (low, high) = polygon.range(axis);
            (low - ROOM).max(0.0) as u32..=((high + ROOM) as u32).min(self.size[axis] - 1)
        };
        let whole = Polygon::new(triangle);
        for z in range(&whole, 2) {
            let layer = whole.between(2, z as f32 - ROOM, z as f32 + 1.0 + ROOM);
            for y in range(&layer, 1) {
                let cells = range(&layer.between(1, y as f32 - ROOM, y as f32 + 1.0 + ROOM), 0);
                if !cells.is_empty() {
                    let start = self.index(UVec3::new(*cells.start(), y, z));
                    squared[start..=start + (cells.end() - cells.start()) as usize].fill(0.0);
                }
            }
        }
    }

    /// Squared distances along one more axis, in cells, between the nearest points of cells: a neighbor is as near as the
    /// cell itself.
    fn transform(&self, axis: usize, squared: &mut [f32]) {
        let size = self.size.to_array().map(|n| n as usize);
        let stride = [1, size[0], size[0] * size[1]][axis];
        let mut line = vec![0.0; size[axis]];
        let mut envelope = Vec::with_capacity(size[axis]);
        for first in 0..squared.len() / size[axis] {
            let start = first / stride * stride * size[axis] + first % stride;
            for (i, value) in line.iter_mut().enumerate() {
                let neighbors = i.saturating_sub(1)..=(i + 1).min(size[axis] - 1);
                *value = neighbors.map(|i| squared[start + i * stride]).fold(f32::INFINITY, f32::min);
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

/// A part of a triangle between planes: a convex polygon, of one more corner at most for each plane.
struct Polygon {
    corners: [Vec3; 7],
    count: usize,
}

impl Polygon {
    fn new([a, b, c]: [Vec3; 3]) -> Self {
        Self { corners: [a, b, c, c, c, c, c], count: 3 }
    }

    /// Least and greatest coordinate; nothing lies between those of an empty polygon.
    fn range(&self, axis: usize) -> (f32, f32) {
        let corners = self.corners[..self.count].iter().map(|corner| corner[axis]);
        corners.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    }

    /// The part between two coordinates.
    fn between(&self, axis: usize, low: f32, high: f32) -> Self {
        self.clip(|corner| corner[axis] - low).clip(|corner| high - corner[axis])
    }

    /// The part in which a linear function is not negative.
    fn clip(&self, inside: impl Fn(Vec3) -> f32) -> Self {
        let mut clipped = Self { corners: [Vec3::ZERO; 7], count: 0 };
        let mut push = |corner: Vec3| {
            if let Some(place) = clipped.corners.get_mut(clipped.count) {
                *place = corner;
                clipped.count += 1;
            }
        };
        for (i, &corner) in self.corners[..self.count].iter().enumerate() {
            let next = self.corners[(i + 1) % self.count];
            let (here, there) = (inside(corner), inside(next));
            if here >= 0.0 {
                push(corner);
            }
            if (here >= 0.0) != (there >= 0.0) {
                push(corner + (next - corner) * (here / (here - there)));
            }
        }
        clipped
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
    use crate::ray::groups::CELLS;

    /// Every bound is below the distance to all triangles, by points spread over them, and not by more than the diagonals of
    /// a cell at each end, and the rounding.
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
            assert!(bound <= nearest && bound > nearest - 4.1 * grid.edge, "{at}: {bound} {nearest}");
        }
        assert_eq!(grid.at(grid.origin - 1.0), 0.0);
        assert_eq!(grid.at(Vec3::NAN), 0.0);
    }

    /// Far from the origin coordinates are coarser than cells.
    #[test]
    fn small_bodies_far_away_have_bounds() {
        let far = Vec3::new(1e6, 8.0, -3e7);
        let triangle = [far, far + Vec3::new(2.0, 0.0, 4.0), far + Vec3::new(0.0, 2.0, 0.0)];
        let grid = Clearance::new(|| std::iter::once(triangle), 2e6);
        for corner in triangle {
            assert_eq!(grid.at(corner), 0.0);
        }
    }

    /// Needles as long as the body touch few cells.
    #[test]
    fn needles_are_quick() {
        let needle = |i: u16| {
            let at = Vec3::new(0.0, f32::from(i) * 1e-5, f32::from(i) * 2e-5);
            [at, at + Vec3::new(1.0, 0.9, 0.8), at + Vec3::new(1.0, 0.9, 0.801)]
        };
        let grid = Clearance::new(|| (0..20_000).map(needle), CELLS);
        assert!(grid.at(Vec3::new(0.1, 0.9, 0.8)) > 0.2);
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
