//! Cuts polygons into triangles.

use glam::{DVec3, Vec3};

/// Most corners of a polygon that is clipped by ears, which takes the square of their number.
const MOST_EARS: usize = 1_000;

/// Cuts a polygon, given as its vertices in order, into triangles of the same winding.
///
/// A vertex without a position counts as lying in the origin.
/// A convex polygon becomes a fan about its first vertex, a concave one is clipped ear by ear
/// (G. H. Meisters, "Polygons have ears", 1975).
/// A polygon that cannot be cut well (self-intersecting, more than 1,000 concave corners) becomes a fan.
pub(super) fn triangulate<T: Copy>(
    vertices: &[T],
    position: impl Fn(T) -> Option<Vec3>,
    mut emit: impl FnMut([T; 3]),
) {
    if let [a, b, c] = *vertices {
        return emit([a, b, c]); // Most polygons of most files.
    }
    let corners: Vec<DVec3> =
        vertices.iter().map(|&vertex| position(vertex).unwrap_or_default().as_dvec3()).collect();
    let mut polygon =
        Polygon { normal: newell_normal(&corners), corners, rest: (0..vertices.len()).collect() };
    if vertices.len() <= MOST_EARS {
        while let Some(ear) = polygon.clip_ear() {
            emit(ear.map(|corner| vertices[corner]));
        }
    }
    for pair in polygon.rest.windows(2).skip(1) {
        emit([polygon.rest[0], pair[0], pair[1]].map(|corner| vertices[corner]));
    }
}

/// Normal times twice the area (M. E. Newell; I. E. Sutherland et al. 1974).
fn newell_normal(corners: &[DVec3]) -> DVec3 {
    let Some(&origin) = corners.first() else { return DVec3::ZERO };
    corners.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum()
}

/// Rest of a polygon, as numbers of corners.
struct Polygon {
    corners: Vec<DVec3>,
    normal: DVec3,
    rest: Vec<usize>,
}

impl Polygon {
    /// Cuts off one ear; `None` if the rest is convex or has no ear.
    fn clip_ear(&mut self) -> Option<[usize; 3]> {
        let count = self.rest.len();
        let reflex: Vec<usize> = (0..count).filter(|&i| self.turn(self.around(i)) < 0.0).collect();
        if count < 4 || reflex.is_empty() {
            return None;
        }
        let ear = (0..count).find(|&i| {
            let around = self.around(i);
            self.turn(around) > 0.0 && !reflex.iter().any(|&other| self.holds(around, self.rest[other]))
        })?;
        let triangle = self.around(ear);
        self.rest.remove(ear);
        Some(triangle)
    }

    /// A corner of the rest between its neighbors.
    fn around(&self, i: usize) -> [usize; 3] {
        let count = self.rest.len();
        [self.rest[(i + count - 1) % count], self.rest[i], self.rest[(i + 1) % count]]
    }

    /// Positive if the polygon's boundary turns to the left.
    fn turn(&self, [a, b, c]: [usize; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|corner| self.corners[corner]);
        (b - a).cross(c - b).dot(self.normal)
    }

    /// Whether a triangle holds another corner, its boundary included.
    fn holds(&self, [a, b, c]: [usize; 3], corner: usize) -> bool {
        let inside = |from, to| self.turn([from, to, corner]) >= 0.0;
        ![a, b, c].contains(&corner) && inside(a, b) && inside(b, c) && inside(c, a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Triangle;

    /// Triangles of a polygon in the plane z = x.
    fn cut(points: &[[f32; 2]]) -> (Vec<Vec3>, Vec<Triangle>) {
        let positions: Vec<Vec3> = points.iter().map(|&[x, y]| Vec3::new(x, y, x)).collect();
        let index: Vec<u32> = (0..points.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&index, |i| positions.get(i as usize).copied(), |t| triangles.push(t));
        (positions, triangles)
    }

    /// Sum of the triangles' areas in x and y, each with the sign of its winding.
    fn areas(positions: &[Vec3], triangles: &[Triangle]) -> Vec<f32> {
        let point = |i: u32| positions[i as usize].truncate();
        let area = |&[a, b, c]: &Triangle| 0.5 * (point(b) - point(a)).perp_dot(point(c) - point(a));
        triangles.iter().map(area).collect()
    }

    #[test]
    fn triangulate_fans_convex_polygons() {
        let (_, triangles) = cut(&[[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [2.0, 2.0], [0.0, 2.0]]);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    #[test]
    fn triangulate_covers_concave_polygons_without_overlap() {
        let dart: &[[f32; 2]] = &[[0.0, 0.0], [2.0, -2.0], [0.5, 0.0], [2.0, 2.0]];
        let comb: &[[f32; 2]] = &[
            [0.0, 0.0],
            [7.0, 0.0],
            [7.0, 3.0],
            [6.0, 3.0],
            [6.0, 1.0],
            [5.0, 1.0],
            [5.0, 3.0],
            [4.0, 3.0],
            [4.0, 1.0],
            [3.0, 1.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        for (points, area) in [(dart, 1.0), (comb, 15.0)] {
            // Every rotation of the first corner, and clockwise polygons too.
            for shift in 0..points.len() {
                let mut points = points.to_vec();
                points.rotate_left(shift);
                let (positions, triangles) = cut(&points);
                assert_eq!(triangles.len(), points.len() - 2);
                let areas = areas(&positions, &triangles);
                assert!(areas.iter().all(|&a| a > 0.0), "{shift}: {areas:?}");
                assert!((areas.iter().sum::<f32>() - area).abs() < 1e-4, "{shift}: {areas:?}");
                points.reverse();
                let (positions, triangles) = cut(&points);
                assert!(self::areas(&positions, &triangles).iter().all(|&a| a < 0.0));
            }
        }
    }

    #[test]
    fn triangulate_keeps_the_count_whatever_the_shape() {
        let crossed: &[[f32; 2]] = &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        let point: &[[f32; 2]] = &[[1.0, 1.0]; 6];
        let broken: &[[f32; 2]] =
            &[[f32::NAN, 0.0], [1.0, f32::INFINITY], [0.0, 0.0], [1.0, 0.0], [2.0, 5.0]];
        let star: Vec<[f32; 2]> = (0..4000)
            .map(|i| {
                let (sin, cos) = (i as f32 * std::f32::consts::TAU / 4000.0).sin_cos();
                let radius = if i % 2 == 0 { 1.0 } else { 0.9 };
                [radius * cos, radius * sin]
            })
            .collect();
        for points in [crossed, point, broken, &star] {
            assert_eq!(cut(points).1.len(), points.len() - 2);
        }
        for points in [&star[..0], &star[..1], &star[..2]] {
            assert!(cut(points).1.is_empty());
        }
    }
}
