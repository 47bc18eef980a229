//! Closed bodies whose faces wind both ways.
//!
//! Light under a surface needs to know inside from outside, which a face's winding tells.

use glam::{DVec3, Vec3};
use translucid_scene::{Mesh, Object, Place, Triangle, Warning};

/// No neighbor.
const NONE: u32 = u32::MAX;

/// Share of a shell's area that has to wind alike to count as right where the shell may bound a cavity.
const MAJORITY: f64 = 0.5;

/// Least volume of a shell that has an inside, over the area to the power of 3/2.
const FLATTEST: f64 = 1e-6;

/// Most shells whose boxes a shell is compared with, the largest.
const MOST_COMPARED: usize = 64;

/// For each triangle whether it has to be turned, so that all of a closed shell wind alike; empty if none has to.
///
/// Vertices at the same place are one.
/// Of a shell that lies in no other's box the outside is what is out of it; in another's box, where it may bound a
/// cavity, most of its area is right.
/// Shells that wind one way are left alone, and so are those that are open, or have an edge of other than two faces.
pub(super) fn reversed(positions: &[Vec3], triangles: &[Triangle]) -> Vec<bool> {
    let keys: Vec<u64> = positions.iter().map(|&position| key(position)).collect();
    if all_edges_cancel(&keys, triangles) {
        return Vec::new();
    }
    let places = places_of(&keys);
    let welded: Vec<Triangle> = triangles
        .iter()
        .map(|triangle| {
            let corner = |i: u32| places.get(i as usize).copied();
            match triangle.map(corner) {
                [Some(a), Some(b), Some(c)] if a != b && b != c && c != a => [a, b, c],
                _ => [NONE; 3],
            }
        })
        .collect();
    let neighbors = neighbors(&welded, positions.len());
    let mut is_turned = vec![None; triangles.len()];
    let mut shells = Vec::new();
    for first in 0..triangles.len() {
        if is_turned[first].is_none() && welded[first][0] != NONE {
            shells.push(Shell::around(first as u32, &neighbors, &mut is_turned));
        }
    }
    turned_of_shells(positions, triangles, &shells, &is_turned)
}

/// A place as a number: different ones for different places, but for one pair in 2⁶⁴.
fn key(position: Vec3) -> u64 {
    let [x, y, z] = (position + 0.0).to_array().map(|c| u64::from(c.to_bits())); // 0 and −0 are the same place
    mixed(mixed(x << 32 | y) ^ z)
}

/// The finalizer of SplitMix64 (G. L. Steele et al., "Fast splittable pseudorandom number generators", 2014).
fn mixed(x: u64) -> u64 {
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

/// Whether each edge is used as often forward as backward: all shells are closed and wind one way.
fn all_edges_cancel(keys: &[u64], triangles: &[Triangle]) -> bool {
    let edge = |a: u64, b: u64| {
        let (low, high) = (a.min(b), a.max(b));
        let number = (low ^ high.rotate_left(32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let number = (number ^ number >> 29).wrapping_mul(low | 1);
        if a < b { number } else { number.wrapping_neg() }
    };
    let sum = triangles.iter().fold(0_u64, |sum, triangle| {
        let corner = |i: u32| keys.get(i as usize).copied().unwrap_or(0);
        let [a, b, c] = triangle.map(corner);
        let of_triangle = if a == b || b == c || c == a {
            0
        } else {
            edge(a, b).wrapping_add(edge(b, c)).wrapping_add(edge(c, a))
        };
        sum.wrapping_add(of_triangle)
    });
    sum == 0
}

/// For each vertex the first one at the same place.
pub(super) fn places(positions: &[Vec3]) -> Vec<u32> {
    let keys: Vec<u64> = positions.iter().map(|&position| key(position)).collect();
    places_of(&keys)
}

fn places_of(keys: &[u64]) -> Vec<u32> {
    let slots = (2 * keys.len()).next_power_of_two();
    let mut first_at = vec![NONE; slots];
    let of_vertex = |(i, &key): (usize, &u64)| {
        let mut slot = key as usize & (slots - 1);
        loop {
            match first_at[slot] {
                NONE => {
                    first_at[slot] = i as u32;
                    return i as u32;
                }
                first if keys[first as usize] == key => return first,
                _ => slot = (slot + 1) & (slots - 1),
            }
        }
    };
    keys.iter().enumerate().map(of_vertex).collect()
}

/// For each edge of each triangle twice the number of the only other triangle there, plus 1 if that runs along the
/// edge in the same direction: one of the two has to be turned.
fn neighbors(triangles: &[Triangle], vertices: usize) -> Vec<[u32; 3]> {
    let start = |half: usize| triangles[half / 3][half % 3];
    let end = |half: usize| triangles[half / 3][(half + 1) % 3];
    let halves = || (0..3 * triangles.len()).filter(|half| triangles[half / 3][0] != NONE);
    // Edges by their lower vertex
    let mut begin = vec![0_u32; vertices + 1];
    halves().for_each(|half| begin[start(half).min(end(half)) as usize + 1] += 1);
    for i in 0..vertices {
        begin[i + 1] += begin[i];
    }
    let mut next = begin.clone();
    let mut edges = vec![(0_u32, 0_u32); begin[vertices] as usize];
    for half in halves() {
        let slot = &mut next[start(half).min(end(half)) as usize];
        edges[*slot as usize] = (start(half).max(end(half)), half as u32);
        *slot += 1;
    }
    let mut neighbors = vec![[NONE; 3]; triangles.len()];
    for bounds in begin.windows(2) {
        let of_vertex = &mut edges[bounds[0] as usize..bounds[1] as usize];
        of_vertex.sort_unstable();
        for edge in of_vertex.chunk_by(|a, b| a.0 == b.0) {
            if let &[(_, one), (_, other)] = edge {
                let (one, other) = (one as usize, other as usize);
                let is_alike = u32::from(start(one) == start(other));
                neighbors[one / 3][one % 3] = 2 * (other / 3) as u32 + is_alike;
                neighbors[other / 3][other % 3] = 2 * (one / 3) as u32 + is_alike;
            }
        }
    }
    neighbors
}

/// Triangles that edges connect.
struct Shell {
    triangles: Vec<u32>,
    /// It has an inside and an outside.
    is_closed: bool,
}

impl Shell {
    /// The shell around a triangle, which stays; each of the others is turned or not.
    fn around(first: u32, neighbors: &[[u32; 3]], is_turned: &mut [Option<bool>]) -> Self {
        let (mut triangles, mut is_closed) = (vec![first], true);
        is_turned[first as usize] = Some(false);
        let mut done = 0;
        while let Some(&triangle) = triangles.get(done) {
            let own = is_turned[triangle as usize] == Some(true);
            for neighbor in neighbors[triangle as usize] {
                if neighbor == NONE {
                    is_closed = false;
                    continue;
                }
                let wanted = own ^ (neighbor & 1 == 1);
                match &mut is_turned[(neighbor / 2) as usize] {
                    Some(known) => is_closed &= *known == wanted, // Not so on a Klein bottle
                    unknown => {
                        *unknown = Some(wanted);
                        triangles.push(neighbor / 2);
                    }
                }
            }
            done += 1;
        }
        Self { triangles, is_closed }
    }
}

/// Which triangles to turn, shell by shell.
fn turned_of_shells(
    positions: &[Vec3],
    triangles: &[Triangle],
    shells: &[Shell],
    is_turned: &[Option<bool>],
) -> Vec<bool> {
    let is_mixed = |shell: &&Shell| {
        shell.is_closed && shell.triangles.iter().any(|&i| is_turned[i as usize] == Some(true))
    };
    let mut mixed = shells.iter().filter(is_mixed).peekable();
    if mixed.peek().is_none() {
        return Vec::new();
    }
    let corners = |i: u32| triangles[i as usize].map(|corner| positions[corner as usize].as_dvec3());
    let bounds = |shell: &Shell| {
        let all = || shell.triangles.iter().flat_map(|&i| corners(i));
        (all().fold(DVec3::INFINITY, DVec3::min), all().fold(DVec3::NEG_INFINITY, DVec3::max))
    };
    let mut boxes: Vec<(DVec3, DVec3)> = shells.iter().map(bounds).collect();
    boxes.sort_by(|a, b| (b.1 - b.0).length().total_cmp(&(a.1 - a.0).length()));
    boxes.truncate(MOST_COMPARED);
    let mut result = vec![false; triangles.len()];
    for shell in mixed {
        let (low, high) = bounds(shell);
        let is_inner = boxes.iter().any(|other| other.0.cmplt(low).all() && high.cmplt(other.1).all());
        let (mut volume, mut areas) = (0.0, [0.0; 2]);
        for &i in &shell.triangles {
            let [a, b, c] = corners(i).map(|corner| corner - low);
            let turned = is_turned[i as usize] == Some(true);
            volume += a.dot(b.cross(c)) * if turned { -1.0 } else { 1.0 };
            areas[usize::from(turned)] += (b - a).cross(c - a).length();
        }
        let area = areas[0] + areas[1];
        if volume.abs() < FLATTEST * area * area.sqrt() {
            continue;
        }
        let is_wrong = if is_inner { areas[1] > MAJORITY * area } else { volume < 0.0 };
        for &i in &shell.triangles {
            result[i as usize] = (is_turned[i as usize] == Some(true)) != is_wrong;
        }
    }
    result
}

/// Says how many triangles were turned.
pub(super) fn warn_of_turned(count: usize, place: &Place, warnings: &mut Vec<Warning>) {
    if count > 0 {
        let triangles = if count == 1 { "triangle" } else { "triangles" };
        let message =
            format!("{count} {triangles} of a closed body wound the other way than the rest: turned");
        warnings.push(Warning { message, place: Some(place.clone()) });
    }
}

/// Turns triangles of a mesh, and normals that only they have and that point in; returns how many were turned.
fn turn(mesh: &mut Mesh, is_turned: &[bool]) -> usize {
    let mut is_kept = vec![mesh.normals.is_empty(); mesh.positions.len()];
    for (triangle, &is_turned) in mesh.triangles.iter_mut().zip(is_turned) {
        if is_turned {
            triangle.swap(1, 2);
        }
        let corners = triangle.map(|i| mesh.positions.get(i as usize).copied().unwrap_or_default());
        let outward = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        for &mut i in triangle {
            let (Some(is_kept), Some(normal)) = (is_kept.get_mut(i as usize), mesh.normals.get(i as usize))
            else {
                continue;
            };
            *is_kept |= !is_turned || normal.dot(outward) >= 0.0;
        }
    }
    for (normal, is_kept) in mesh.normals.iter_mut().zip(is_kept) {
        if !is_kept {
            *normal = -*normal;
        }
    }
    is_turned.iter().filter(|&&is_turned| is_turned).count()
}

/// Turns the triangles of closed bodies that wind the other way than the rest; returns how many.
pub(super) fn orient(mesh: &mut Mesh) -> usize {
    let is_turned = reversed(&mesh.positions, &mesh.triangles);
    if is_turned.is_empty() { 0 } else { turn(mesh, &is_turned) }
}

/// As [`orient`], for objects in the same space whose meshes are parts of the same bodies.
pub(super) fn orient_together(objects: &mut [Object]) -> usize {
    let (mut positions, mut triangles) = (Vec::new(), Vec::<Triangle>::new());
    for Object { mesh, .. } in &*objects {
        let first = positions.len() as u32;
        positions.extend_from_slice(&mesh.positions);
        triangles.extend(mesh.triangles.iter().map(|triangle| triangle.map(|i| i.saturating_add(first))));
    }
    let is_turned = reversed(&positions, &triangles);
    let mut rest = &is_turned[..];
    let mut count = 0;
    for object in objects.iter_mut().filter(|_| !is_turned.is_empty()) {
        let (own, others) = rest.split_at(object.mesh.triangles.len());
        rest = others;
        if own.contains(&true) {
            count += turn(std::sync::Arc::make_mut(&mut object.mesh), own);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces of a cube from `low` to `high`, each corner of a face a vertex of its own if `split`.
    fn cube(low: f32, high: f32, split: bool) -> Mesh {
        let corner =
            |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * (high - low) + low;
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<Triangle> =
            faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        if split {
            let positions = triangles.iter().flatten().map(|&i| corner(i)).collect();
            let triangles = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            return Mesh { positions, triangles, ..Mesh::default() };
        }
        Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
    }

    fn together(mut a: Mesh, b: &Mesh) -> Mesh {
        let first = a.positions.len() as u32;
        a.positions.extend(&b.positions);
        a.triangles.extend(b.triangles.iter().map(|t| t.map(|i| i + first)));
        a
    }

    /// The mesh with some triangles turned.
    fn spoiled(mut mesh: Mesh, which: impl Fn(usize) -> bool) -> Mesh {
        for (_, [_, b, c]) in mesh.triangles.iter_mut().enumerate().filter(|(i, _)| which(*i)) {
            std::mem::swap(b, c);
        }
        mesh
    }

    #[test]
    fn orient_turns_the_faces_of_a_closed_body_outward_however_many_are_wrong() {
        for split in [false, true] {
            let right = cube(-1.0, 2.0, split);
            for (first, step, count) in [(3, 99, 1), (0, 2, 6), (1, 1, 11)] {
                let mut mesh = spoiled(right.clone(), |i| i >= first && (i - first).is_multiple_of(step));
                assert_eq!(orient(&mut mesh), count);
                let volume: f64 = mesh
                    .triangles
                    .iter()
                    .filter_map(|t| mesh.corners(t))
                    .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                    .sum();
                assert!((volume - 27.0).abs() < 1e-9, "{volume}");
            }
        }
    }

    #[test]
    fn orient_leaves_alone_what_winds_one_way_or_is_open_or_branches() {
        let right = cube(0.0, 1.0, true);
        let inverted = spoiled(right.clone(), |_| true);
        let hollow = together(cube(0.0, 3.0, false), &spoiled(cube(1.0, 2.0, false), |_| true));
        let mut open = spoiled(right.clone(), |i| i == 5);
        open.triangles.pop();
        // Two cubes that share an edge
        let mut other = right.clone();
        other.positions.iter_mut().for_each(|p| *p += Vec3::new(1.0, 1.0, 0.0));
        let branching = spoiled(together(right.clone(), &other), |i| i == 5);
        for mesh in [right, inverted, hollow, open, branching] {
            let mut after = mesh.clone();
            assert_eq!((orient(&mut after), &after), (0, &mesh));
        }
    }

    #[test]
    fn orient_keeps_cavities_and_moves_normals_along() {
        let cavity = spoiled(cube(1.0, 2.0, true), |i| i > 0);
        let mut hollow = together(cube(0.0, 3.0, true), &cavity);
        assert_eq!(orient(&mut hollow), 1);
        assert_eq!(hollow.triangles[12], [36, 38, 37]);

        let mut mesh = cube(0.0, 1.0, true);
        mesh.normals = mesh.smooth_normals();
        let right = mesh.clone();
        mesh.triangles[4].swap(1, 2);
        mesh.normals[12..15].iter_mut().for_each(|normal| *normal = -*normal);
        assert_eq!((orient(&mut mesh), mesh), (1, right));
    }

    #[test]
    fn orient_takes_the_parts_of_a_body_together() {
        let whole = cube(0.0, 1.0, true);
        let part = |range: std::ops::Range<usize>| {
            let mesh = Mesh { triangles: whole.triangles[range].to_vec(), ..whole.clone() };
            Object { mesh: mesh.into(), ..Object::default() }
        };
        let mut objects = [part(0..5), part(5..12)];
        std::sync::Arc::make_mut(&mut objects[1].mesh).triangles[0].swap(1, 2);
        assert_eq!(orient_together(&mut objects), 1);
        assert_eq!(objects[1].mesh.triangles[..], whole.triangles[5..]);
    }

    #[test]
    fn orient_survives_indices_out_of_range_and_faces_without_area() {
        let mut mesh = spoiled(cube(0.0, 1.0, false), |i| i == 2);
        mesh.triangles.extend([[0, 0, 1], [0, 1, 99], [u32::MAX; 3]]);
        assert_eq!(orient(&mut mesh), 1);
        assert_eq!(mesh.triangles[2], cube(0.0, 1.0, false).triangles[2]);
        assert_eq!(orient(&mut Mesh::default()), 0);
    }
}
