//! Cuts polygons into triangles.

use std::collections::{HashMap, HashSet};

use earcut::{Earcut, Refiner};
use glam::{DVec3, Vec3};
use translucid_scene::Triangle;

/// Most corners of a polygon that becomes a fan: the triangles of a larger one would all be slivers.
const MOST_OF_FAN: usize = 16;

/// Part of a large polygon's area that may be covered twice: corners on a circle are not exactly on it.
const MOST_FOLDED: f64 = 1e-4;

/// Most corners of a polygon that is cut though it may cross itself: the time grows with the third power of their number.
const MOST_OF_CROSSING: usize = 64;

/// Most pairs of edges that are looked at for a crossing, per polygon.
const MOST_PAIRS: usize = 1 << 28;

/// Most corners that are cut well: `earcut` counts some tens of millions.
const MOST_TO_CUT: usize = 10_000_000;

/// Cuts a polygon, given as its vertices in order, into triangles of the same winding that have each of them as a corner.
///
/// A vertex without a position counts as lying in the origin.
/// A convex polygon becomes a fan about its first vertex, or is halved again and again if it is large, any other is
/// clipped ear by ear (G. H. Meisters, "Polygons have ears", 1975).
/// A polygon that cannot be cut so (self-intersecting, not finite) is taken for convex, and so is one of more than 64
/// corners that crosses itself or goes the same way twice.
pub(super) fn triangulate<T: Copy>(
    vertices: &[T],
    position: impl Fn(T) -> Option<Vec3>,
    mut emit: impl FnMut([T; 3]),
) {
    if let [a, b, c] = *vertices {
        return emit([a, b, c]);
    }
    let place = |&vertex: &T| position(vertex).unwrap_or_default().as_dvec3();
    let emit = |triangle: Triangle| emit(triangle.map(|i| vertices[i as usize]));
    // Without memory of its own: most polygons of most files have four corners
    if let [a, b, c, d] = vertices {
        let (corners, fan) = ([a, b, c, d].map(place), [[0, 1, 2], [0, 2, 3]]);
        if covers(&fan, &corners, newell_normal(&corners)) {
            return fan.into_iter().for_each(emit);
        }
    }
    let corners: Vec<DVec3> = vertices.iter().map(place).collect();
    let normal = newell_normal(&corners);
    let count = corners.len() as u32;
    let mut triangles: Vec<Triangle> = (2..count).map(|i| [0, i - 1, i]).collect();
    if corners.len() > MOST_OF_FAN {
        triangles.clear();
        halve(0, count - 1, &mut triangles);
    }
    if !covers(&triangles, &corners, normal) {
        triangles = clip_ears(&corners, normal).unwrap_or(triangles);
    }
    triangles.into_iter().for_each(emit);
}

/// Normal times twice the area (M. E. Newell; I. E. Sutherland et al. 1974).
fn newell_normal(corners: &[DVec3]) -> DVec3 {
    let Some(&origin) = corners.first() else { return DVec3::ZERO };
    corners.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum()
}

/// Cuts the part of a convex polygon between two corners and those between them.
fn halve(first: u32, last: u32, triangles: &mut Vec<Triangle>) {
    if last - first > 1 {
        let middle = first.midpoint(last);
        triangles.push([first, middle, last]);
        halve(first, middle, triangles);
        halve(middle, last, triangles);
    }
}

/// Whether triangles cover a polygon once.
fn covers(triangles: &[Triangle], corners: &[DVec3], normal: DVec3) -> bool {
    let area = |triangle: &Triangle| {
        let [a, b, c] = triangle.map(|i| corners[i as usize]);
        (b - a).cross(c - a).dot(normal)
    };
    let folded: f64 = triangles.iter().map(|triangle| (-area(triangle)).max(0.0)).sum();
    let is_large = corners.len() > MOST_OF_FAN;
    triangles.iter().all(|triangle| area(triangle) > 0.0)
        || is_large && folded <= MOST_FOLDED * normal.length_squared()
}

/// Triangles of a polygon, as numbers of its corners; `None` if they are fewer than a simple polygon has.
fn clip_ears(corners: &[DVec3], normal: DVec3) -> Option<Vec<Triangle>> {
    let normal = normal.try_normalize().filter(|_| corners.len() <= MOST_TO_CUT)?;
    let (x, y) = normal.any_orthonormal_pair();
    let points: Vec<[f64; 2]> = corners.iter().map(|corner| [corner.dot(x), corner.dot(y)]).collect();
    if points.len() > MOST_OF_CROSSING && !is_simple(&points) {
        return None;
    }
    let mut numbers: Vec<u32> = Vec::new();
    Earcut::new().earcut_slice(&points, &[], &mut numbers);
    let mut triangles: Vec<Triangle> = numbers.as_chunks().0.iter().copied().map(along_polygon).collect();
    restore_corners(&mut triangles, corners.len());
    Refiner::new().refine(triangles.as_flattened_mut(), &points);
    (triangles.len() + 2 == corners.len()).then_some(triangles)
}

/// Whether a polygon neither crosses itself nor goes along an edge twice in one direction; it may touch itself, as one
/// with a hole does.
fn is_simple(points: &[[f64; 2]]) -> bool {
    let edges: Vec<[[f64; 2]; 2]> =
        points.iter().zip(points.iter().cycle().skip(1)).map(|(&a, &b)| [a, b]).collect();
    let bits = |point: [f64; 2]| point.map(f64::to_bits);
    let different: HashSet<_> = edges.iter().map(|edge| edge.map(bits)).collect();
    let corners: HashSet<_> = points.iter().map(|&point| bits(point)).collect();
    // A hole of three corners or more has two of the outline's and two of its own twice
    if different.len() < edges.len() || 5 * corners.len() < 3 * points.len() {
        return false;
    }
    // Sweep along the axis along which edges are shorter
    let length = |axis: usize| -> f64 {
        let reach = points
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p[axis]), high.max(p[axis])]);
        edges.iter().map(|[a, b]| (a[axis] - b[axis]).abs()).sum::<f64>() / (reach[1] - reach[0])
    };
    let along = usize::from(length(1) < length(0));
    let low = |edge: &[[f64; 2]; 2], axis: usize| edge[0][axis].min(edge[1][axis]);
    let high = |edge: &[[f64; 2]; 2], axis: usize| edge[0][axis].max(edge[1][axis]);
    let mut order: Vec<&[[f64; 2]; 2]> = edges.iter().collect();
    order.sort_by(|a, b| low(a, along).total_cmp(&low(b, along)));
    let mut active: Vec<&[[f64; 2]; 2]> = Vec::new();
    let mut pairs = 0;
    for edge in order {
        pairs += active.len();
        if pairs > MOST_PAIRS {
            return false;
        }
        active.retain(|other| high(other, along) >= low(edge, along));
        let across = 1 - along;
        let overlaps = |other: &[[f64; 2]; 2]| {
            high(other, across) >= low(edge, across) && high(edge, across) >= low(other, across)
        };
        if active.iter().any(|other| overlaps(other) && cross(edge, other)) {
            return false;
        }
        active.push(edge);
    }
    true
}

/// Whether two edges cross between their ends.
fn cross(&[a, b]: &[[f64; 2]; 2], &[c, d]: &[[f64; 2]; 2]) -> bool {
    /// Distance from an edge, as a share of it, up to which a point is on it.
    const TOUCH: f64 = 1e-9;
    let side = |[p, q]: [[f64; 2]; 2], r: [f64; 2]| {
        let [x, y] = [q[0] - p[0], q[1] - p[1]];
        let area = x * (r[1] - p[1]) - y * (r[0] - p[0]);
        if area.abs() <= TOUCH * (x * x + y * y) { 0.0 } else { area.signum() }
    };
    side([a, b], c) * side([a, b], d) < 0.0 && side([c, d], a) * side([c, d], b) < 0.0
}

/// The triangle with its corners in the order in which the polygon has them.
fn along_polygon([a, b, c]: Triangle) -> Triangle {
    let steps_forward = [a < b, b < c, c < a].into_iter().filter(|&forward| forward).count();
    if steps_forward == 2 { [a, b, c] } else { [a, c, b] }
}

/// Cuts triangles at the corners of a polygon that lie on their edges, and which no triangle has: without them there
/// would be gaps to a neighbor that has them.
fn restore_corners(triangles: &mut Vec<Triangle>, count: usize) {
    let mut is_used = vec![false; count];
    triangles.iter().flatten().for_each(|&i| is_used[i as usize] = true);
    let Some(first) = is_used.iter().position(|&used| used).filter(|_| is_used.contains(&false)) else {
        return;
    };
    let mut owners = HashMap::new();
    for (number, &[a, b, c]) in triangles.iter().enumerate() {
        owners.extend([((a, b), (number, c)), ((b, c), (number, a)), ((c, a), (number, b))]);
    }
    let mut edge = vec![first as u32];
    for i in (first + 1..=first + count).map(|i| i % count) {
        edge.push(i as u32);
        if !is_used[i] {
            continue;
        }
        let (start, end) = (edge[0], i as u32);
        if let Some(&(number, apex)) = owners.get(&(start, end)).filter(|_| edge.len() > 2) {
            triangles[number] = [start, edge[1], apex];
            triangles.extend(edge[1..].windows(2).map(|part| [part[0], part[1], apex]));
            owners.insert((end, apex), (triangles.len() - 1, start));
        }
        edge = vec![end];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    /// A neighbor may have the corners on straight edges.
    #[test]
    fn triangulate_keeps_corners_on_straight_edges() {
        // An L whose edges are cut into parts
        let turns = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0_f32]];
        let mut points = Vec::new();
        for (i, [x, y]) in turns.into_iter().enumerate() {
            let [to_x, to_y] = turns[(i + 1) % turns.len()];
            points.extend((0..4).map(|k| 0.25 * k as f32).map(|t| [x + t * (to_x - x), y + t * (to_y - y)]));
        }
        let (positions, triangles) = cut(&points);
        assert_eq!(triangles.len(), points.len() - 2);
        let areas = areas(&positions, &triangles);
        assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f32>() - 7.0).abs() < 1e-4, "{areas:?}");
        let is_side = |&[a, b, c]: &Triangle, from, to| [(a, b), (b, c), (c, a)].contains(&(from, to));
        for from in 0..points.len() as u32 {
            let to = (from + 1) % points.len() as u32;
            assert_eq!(triangles.iter().filter(|t| is_side(t, from, to)).count(), 1, "{from}");
        }
    }

    /// The triangles of a fan would measure 3.3 around, on average.
    #[test]
    fn triangulate_cuts_large_polygons_into_short_edges() {
        for (inner, most) in [(1.0, 0.1), (0.9, 1.2)] {
            let count = 60_000_u16;
            let points: Vec<[f32; 2]> = (0..count)
                .map(|i| {
                    let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(count)).sin_cos();
                    let radius = if i.is_multiple_of(2) { 1.0 } else { inner };
                    [(radius * cos) as f32, (radius * sin) as f32]
                })
                .collect();
            let (positions, triangles) = cut(&points);
            assert_eq!(triangles.len(), points.len() - 2);
            let point = |i: u32| positions[i as usize];
            let around = |&[a, b, c]: &Triangle| {
                point(a).distance(point(b)) + point(b).distance(point(c)) + point(c).distance(point(a))
            };
            let mean = triangles.iter().map(around).sum::<f32>() / triangles.len() as f32;
            assert!(mean < most, "{inner}: {mean}");
        }
    }

    #[test]
    fn polygons_with_a_hole_are_simple_and_those_that_cross_or_repeat_themselves_are_not() {
        let circle = |count: usize, radius: f64| {
            (0..count).map(move |i| {
                let (sin, cos) = (i as f64 * std::f64::consts::TAU / count as f64).sin_cos();
                [radius * cos, radius * sin]
            })
        };
        let outline: Vec<[f64; 2]> = circle(100, 2.0).collect();
        assert!(is_simple(&outline));
        let mut hole: Vec<[f64; 2]> = circle(50, 1.0).collect();
        hole.push(hole[0]);
        hole.reverse();
        let with_hole = [&outline[..], &outline[..1], &hole].concat();
        assert!(is_simple(&with_hole));
        let twice = outline.repeat(2);
        let star: Vec<[f64; 2]> =
            (0..101).map(|i| circle(101, 1.0).nth(i * 50 % 101).unwrap_or_default()).collect();
        assert!(!is_simple(&twice) && !is_simple(&star));
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
