//! Surfaces of revolution about the y axis.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use translucid_scene::Mesh;

/// A point of a profile in the (radius, y) half plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ProfilePoint {
    /// Radius ≥ 0 and height \[L\].
    pub(crate) position: Vec2,
    /// Outward unit normal in the same plane.
    pub(crate) normal: Vec2,
}

/// A corner of a polygonal profile and the radius of the arc that rounds it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Radius ≥ 0 and height \[L\].
    pub(crate) position: Vec2,
    /// Radius of the arc; 0 keeps the corner sharp, too large a radius is reduced.
    pub(crate) fillet: f32,
}

impl Corner {
    /// A corner rounded by an arc.
    pub(crate) fn rounded(radius: f32, y: f32, fillet: f32) -> Self {
        Self { position: Vec2::new(radius, y), fillet }
    }

    /// A sharp corner, or the end of a profile.
    pub(crate) fn sharp(radius: f32, y: f32) -> Self {
        Self::rounded(radius, y, 0.0)
    }
}

/// Outward normal of a profile that has its outside on the right.
fn normal_of(tangent: Vec2) -> Vec2 {
    Vec2::new(tangent.y, -tangent.x)
}

/// Points along a polygon whose corners are rounded; `arc` segments to each arc.
///
/// The polygon has its outside on the right: bottom center → rim → top center.
pub(crate) fn fillet_profile(corners: &[Corner], arc: usize) -> Vec<ProfilePoint> {
    let mut points = Vec::new();
    for (i, corner) in corners.iter().enumerate() {
        let before = i.checked_sub(1).map(|previous| corner.position - corners[previous].position);
        let after = corners.get(i + 1).map(|next| next.position - corner.position);
        match (before, after) {
            (Some(before), Some(after)) => push_corner(&mut points, *corner, before, after, arc),
            (Some(only), None) | (None, Some(only)) => points.push(ProfilePoint {
                position: corner.position,
                normal: normal_of(only.normalize_or(Vec2::Y)),
            }),
            (None, None) => {}
        }
    }
    points
}

/// Replaces a corner by an arc that touches both of its sides.
fn push_corner(points: &mut Vec<ProfilePoint>, corner: Corner, before: Vec2, after: Vec2, arc: usize) {
    let (a, b) = (before.normalize_or(Vec2::Y), after.normalize_or(Vec2::Y));
    let turn = libm::atan2f(a.perp_dot(b), a.dot(b));
    let half_tangent = libm::tanf(0.5 * turn).abs();
    // An arc may take almost half of either side, so that neighbors never meet.
    let reach = (corner.fillet * half_tangent).min(0.49 * before.length().min(after.length()));
    let fillet = if half_tangent > 1e-4 { reach / half_tangent } else { 0.0 };
    if fillet <= 0.0 {
        let sides = if turn.abs() < 1e-4 { &[a][..] } else { &[a, b][..] };
        points.extend(
            sides.iter().map(|&side| ProfilePoint { position: corner.position, normal: normal_of(side) }),
        );
        return;
    }
    let inward = turn.signum() * fillet;
    let center = corner.position - a * reach - normal_of(a) * inward;
    for k in 0..=arc {
        let tangent = Vec2::from_angle(turn * k as f32 / arc as f32).rotate(a);
        let normal = normal_of(tangent);
        points.push(ProfilePoint { position: center + normal * inward, normal });
    }
}

/// Points along a smooth curve given by a function of t ∈ [0, 1]; the outside is on the right.
pub(crate) fn curve_profile(curve: impl Fn(f32) -> Vec2, segments: usize) -> Vec<ProfilePoint> {
    let step = 1e-3;
    (0..=segments)
        .map(|i| {
            let t = i as f32 / segments as f32;
            let tangent = curve((t + step).min(1.0)) - curve((t - step).max(0.0));
            ProfilePoint { position: curve(t), normal: normal_of(tangent.normalize_or(Vec2::Y)) }
        })
        .collect()
}

/// Turns a profile about the y axis; points of radius zero become poles.
///
/// Texture coordinates: u once around, v along the profile by length.
pub(crate) fn revolve(profile: &[ProfilePoint], segments: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let lengths = lengths_along(profile);
    let total = lengths.last().copied().unwrap_or(1.0).max(f32::MIN_POSITIVE);
    for (point, length) in profile.iter().zip(&lengths) {
        for j in 0..=segments {
            // The seam's two columns must coincide to the bit.
            let (sine, cosine) = libm::sincosf(TAU * (j % segments) as f32 / segments as f32);
            let turn = |v: Vec2| Vec3::new(v.x * sine, v.y, v.x * cosine);
            mesh.positions.push(turn(point.position));
            mesh.normals.push(turn(point.normal));
            mesh.uvs.push(Vec2::new(j as f32 / segments as f32, length / total));
        }
    }
    for (i, pair) in profile.windows(2).enumerate() {
        push_strip(&mut mesh, [pair[0].position, pair[1].position], i, segments);
    }
    mesh
}

fn lengths_along(profile: &[ProfilePoint]) -> Vec<f32> {
    let mut length = 0.0;
    let mut previous = profile.first().map_or(Vec2::ZERO, |point| point.position);
    profile
        .iter()
        .map(|point| {
            length += previous.distance(point.position);
            previous = point.position;
            length
        })
        .collect()
}

/// Triangles between profile points i and i + 1.
fn push_strip(mesh: &mut Mesh, ends: [Vec2; 2], i: usize, segments: usize) {
    if ends[0] == ends[1] {
        return;
    }
    let vertex = |i: usize, j: usize| (i * (segments + 1) + j) as u32;
    for j in 0..segments {
        let [a, b, c, d] = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)];
        if ends[0].x > 0.0 {
            mesh.triangles.push([a, b, if ends[1].x > 0.0 { c } else { d }]);
        }
        if ends[1].x > 0.0 {
            mesh.triangles.push([a, c, d]);
        }
    }
}
