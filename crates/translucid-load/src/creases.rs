//! Normals of meshes that have none: smooth, but across creases.

use glam::{DVec3, Vec3};
use translucid_scene::Triangle;

/// Angle between faces beyond which their common edge is a crease in meshes whose faces share vertices \[rad\]: more than
/// between the faces of most scans, less than the right angles of what is built.
pub(super) const SHARED_CREASE: f32 = std::f32::consts::FRAC_PI_3;

/// How a face goes over into its neighbors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Smoothing {
    /// Smooth where the angle is less than that of a crease.
    #[default]
    Angle,
    /// Flat.
    Flat,
    /// Smooth within the group of this number, whatever the angle.
    Group(u32),
}

/// The normals of all corners.
pub(super) struct CornerNormals {
    /// First the smooth normal of each vertex, then further ones of vertices on creases.
    pub(super) normals: Vec<Vec3>,
    /// For each triangle the numbers of its corners' normals.
    pub(super) triangles: Vec<Triangle>,
}

/// Computes normals: the sum of the normals of the faces around a vertex that smooth edges connect, each weighted by
/// its angle there.
///
/// A face without area, or with an index out of range, does not count.
pub(super) fn corner_normals(
    positions: &[Vec3],
    triangles: &[Triangle],
    crease: f32,
    smoothing: impl Fn(usize) -> Smoothing,
) -> CornerNormals {
    let corners = |triangle: &Triangle| -> Option<[DVec3; 3]> {
        let [a, b, c] = triangle.map(|i| positions.get(i as usize).map(|p| p.as_dvec3()));
        Some([a?, b?, c?])
    };
    let mut normals = vec![Vec3::ZERO; positions.len()];
    let mut of_faces = Vec::with_capacity(triangles.len());
    for triangle in triangles {
        let face = corners(triangle).and_then(Face::of);
        of_faces.push(face.as_ref().map_or(Vec3::ZERO, |face| face.normal));
        if let Some(Face { normal, angles }) = face {
            for (&vertex, angle) in triangle.iter().zip(angles) {
                normals[vertex as usize] += normal * angle;
            }
        }
    }
    normals.iter_mut().for_each(|normal| *normal = normal.normalize_or(Vec3::Z));

    // Faces within half a crease's angle of their common normal are within a crease's angle of each other.
    let near = libm::cosf(0.5 * crease);
    let mut first_smoothing = vec![None; positions.len()];
    let mut is_creased = vec![false; positions.len()];
    for (number, (triangle, &face)) in triangles.iter().zip(&of_faces).enumerate() {
        if face == Vec3::ZERO {
            continue;
        }
        let own = smoothing(number);
        for &vertex in triangle {
            let vertex = vertex as usize;
            is_creased[vertex] |= *first_smoothing[vertex].get_or_insert(own) != own
                || own == Smoothing::Flat
                || own == Smoothing::Angle && normals[vertex].dot(face) < near;
        }
    }
    drop(first_smoothing);
    let mut around: Vec<(u32, u32)> = Vec::new();
    for (number, triangle) in
        triangles.iter().enumerate().filter(|(number, _)| of_faces[*number] != Vec3::ZERO)
    {
        let of_triangle = (0..3).filter(|&corner| is_creased[triangle[corner] as usize]);
        around.extend(of_triangle.map(|corner| (triangle[corner], (3 * number + corner) as u32)));
    }
    around.sort_unstable();
    let mut of_corners = triangles.to_vec();
    let is_smooth = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|corner| corner as usize / 3);
        match (smoothing(a), smoothing(b)) {
            (Smoothing::Angle, Smoothing::Angle) => of_faces[a].dot(of_faces[b]) >= libm::cosf(crease),
            (Smoothing::Group(a), Smoothing::Group(b)) => a == b,
            _ => false,
        }
    };
    for fan in around.chunk_by(|a, b| a.0 == b.0) {
        let parts = parts_of_fan(fan, triangles, is_smooth);
        if parts.iter().all(|&part| part == 0) {
            continue;
        }
        let mut sums = vec![Vec3::ZERO; fan.len()];
        for (&(_, corner), &part) in fan.iter().zip(&parts) {
            let (triangle, corner) = (corner as usize / 3, corner as usize % 3);
            let face = corners(&triangles[triangle]).and_then(Face::of);
            sums[part] += face.map_or(Vec3::ZERO, |face| face.normal * face.angles[corner]);
        }
        let mut numbers = vec![None; fan.len()];
        for (&(_, corner), &part) in fan.iter().zip(&parts) {
            let (triangle, corner) = (corner as usize / 3, corner as usize % 3);
            of_corners[triangle][corner] = *numbers[part].get_or_insert_with(|| {
                normals.push(sums[part].normalize_or(of_faces[triangle]));
                normals.len() as u32 - 1
            });
        }
    }
    CornerNormals { normals, triangles: of_corners }
}

/// For each corner at a vertex the first one that smooth edges connect it with.
fn parts_of_fan(
    fan: &[(u32, u32)],
    triangles: &[Triangle],
    is_smooth: impl Fn(u32, u32) -> bool,
) -> Vec<usize> {
    fn root(parts: &mut [usize], mut at: usize) -> usize {
        while parts[at] != at {
            parts[at] = parts[parts[at]];
            at = parts[at];
        }
        at
    }
    let mut spokes: Vec<(u32, usize)> = Vec::with_capacity(2 * fan.len());
    for (number, &(_, corner)) in fan.iter().enumerate() {
        let (triangle, corner) = (triangles[corner as usize / 3], corner as usize % 3);
        spokes.extend([1, 2].map(|step| (triangle[(corner + step) % 3], number)));
    }
    spokes.sort_unstable();
    let mut parts: Vec<usize> = (0..fan.len()).collect();
    for pair in spokes.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let (one, other) = (pair[0].1, pair[1].1);
        if is_smooth(fan[one].1, fan[other].1) {
            let (one, other) = (root(&mut parts, one), root(&mut parts, other));
            parts[one.max(other)] = one.min(other);
        }
    }
    (0..fan.len()).map(|number| root(&mut parts, number)).collect()
}

/// Unit normal of a triangle, and its angles.
struct Face {
    normal: Vec3,
    angles: [f32; 3],
}

impl Face {
    /// The face of three corners; none if it has no area.
    fn of([a, b, c]: [DVec3; 3]) -> Option<Self> {
        /// Least height, as a share of the longest edge.
        const FLATTEST: f64 = 1e-6;
        let [ab, bc, ca] = [b - a, c - b, a - c];
        let longest = ab.length_squared().max(bc.length_squared()).max(ca.length_squared());
        let cross = ab.cross(-ca);
        if !(cross.length() >= FLATTEST * longest && longest > 0.0) {
            return None;
        }
        let [ab, bc, ca] = [ab, bc, ca].map(DVec3::normalize_or_zero);
        let angle = |from: DVec3, to: DVec3| libm::acos((-from.dot(to)).clamp(-1.0, 1.0)) as f32;
        let normal = cross.try_normalize()?.as_vec3();
        Some(Self { normal, angles: [angle(ca, ab), angle(ab, bc), angle(bc, ca)] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of quads, each two triangles.
    fn cube() -> (Vec<Vec3>, Vec<Triangle>) {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        ((0..8).map(corner).collect(), triangles)
    }

    /// Largest angle between a corner's normal and its face's [degrees].
    fn largest_angle(positions: &[Vec3], triangles: &[Triangle], found: &CornerNormals) -> f32 {
        let of_triangle = |(triangle, numbers): (&Triangle, &Triangle)| {
            let [a, b, c] = triangle.map(|i| positions[i as usize]);
            let face = (b - a).cross(c - a).normalize();
            numbers.map(|i| found.normals[i as usize].dot(face).min(1.0).acos().to_degrees())
        };
        triangles.iter().zip(&found.triangles).flat_map(of_triangle).fold(0.0, f32::max)
    }

    #[test]
    fn cube_is_flat_by_angle_or_by_wish_and_round_in_one_group() {
        let (positions, triangles) = cube();
        let of = |smoothing: Smoothing| {
            let found = corner_normals(&positions, &triangles, SHARED_CREASE, |_| smoothing);
            largest_angle(&positions, &triangles, &found)
        };
        assert!(of(Smoothing::Angle) < 0.1 && of(Smoothing::Flat) < 0.1);
        assert!((of(Smoothing::Group(1)) - 54.735_61).abs() < 0.1);
    }

    #[test]
    fn groups_are_smooth_within_and_sharp_between() {
        let (positions, triangles) = cube();
        // Sides that meet at the edges along z form one group, bottom and top one each
        let group = |number: usize| Smoothing::Group(number as u32 / 2).min_of_sides();
        let found = corner_normals(&positions, &triangles, SHARED_CREASE, group);
        for numbers in &found.triangles[..4] {
            assert!(numbers.iter().all(|&i| found.normals[i as usize].z.abs() > 0.9999));
        }
        for &i in found.triangles[4..].iter().flatten() {
            let normal = found.normals[i as usize];
            assert!(normal.z.abs() < 1e-6 && (normal.x.abs() - normal.y.abs()).abs() < 0.5, "{normal}");
        }
    }

    impl Smoothing {
        fn min_of_sides(self) -> Self {
            match self {
                Self::Group(number) => Self::Group(number.min(2)),
                other => other,
            }
        }
    }

    #[test]
    fn shallow_edges_stay_smooth_without_further_normals() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.4), Vec3::Y];
        let found = corner_normals(&positions, &[[0, 1, 2], [0, 2, 3]], SHARED_CREASE, |_| Smoothing::Angle);
        assert_eq!((found.normals.len(), found.triangles[1]), (4, [0, 2, 3]));
    }

    #[test]
    fn broken_faces_do_not_count() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN)];
        let triangles = [[0, 1, 2], [0, 1, 3], [0, 1, 9], [0, 0, 1]];
        let found = corner_normals(&positions, &triangles, SHARED_CREASE, |_| Smoothing::Angle);
        assert_eq!(found.normals[..3], [Vec3::Z; 3]);
        assert_eq!(found.triangles, triangles);
    }
}
