//! Geometric solids and flat pieces, centered on the origin.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};
use translucid_scene::{Mesh, SceneError};

use super::lathe::{Corner, ProfilePoint, curve_profile, fillet_profile, revolve};
use super::rounded_box::rounded_box;
use crate::parameters::{ShapeParameter, Values};

const SEGMENTS: ShapeParameter = ShapeParameter::count("segments", 96.0, 3.0, 4096.0);
const RADIUS: ShapeParameter = ShapeParameter::length("radius", 1.0);
const HEIGHT: ShapeParameter = ShapeParameter::length("height", 2.0);
const EDGE_RADIUS: ShapeParameter = ShapeParameter::length_or_zero("edge_radius", 0.05);

/// Pieces of a rounded edge.
const ARC: usize = 6;

pub(crate) const SPHERE: &[ShapeParameter] = &[RADIUS, SEGMENTS];

pub(crate) fn sphere(values: &Values) -> Result<Mesh, SceneError> {
    let (radius, segments) = (values.get("radius"), values.count("segments"));
    let rings = (segments / 2).max(2);
    let mut profile = curve_profile(|t| radius * Vec2::new(libm::sinf(PI * t), -libm::cosf(PI * t)), rings);
    for (i, point) in profile.iter_mut().enumerate() {
        point.normal = point.position / radius;
        // The poles lie on the axis exactly.
        if i == 0 || i == rings {
            (point.position.x, point.normal.x) = (0.0, 0.0);
        }
    }
    Ok(revolve(&profile, segments))
}

pub(crate) const RECTANGLE: &[ShapeParameter] =
    &[ShapeParameter::length("width", 2.0), ShapeParameter::length("height", 2.0)];

/// In the plane z = 0, facing +z.
pub(crate) fn rectangle(values: &Values) -> Result<Mesh, SceneError> {
    let half = 0.5 * Vec2::new(values.get("width"), values.get("height"));
    let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    Ok(Mesh {
        positions: uvs.iter().map(|uv| ((2.0 * *uv - 1.0) * half).extend(0.0)).collect(),
        normals: vec![Vec3::Z; 4],
        uvs: uvs.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })
}

pub(crate) const DISC: &[ShapeParameter] = &[RADIUS, SEGMENTS];

/// In the plane z = 0, facing +z.
pub(crate) fn disc(values: &Values) -> Result<Mesh, SceneError> {
    let (radius, segments) = (values.get("radius"), values.count("segments"));
    let rim = (0..segments).map(|i| Vec2::from_angle(TAU * i as f32 / segments as f32));
    let points: Vec<Vec2> = std::iter::once(Vec2::ZERO).chain(rim).collect();
    let next = |i: usize| (i % segments + 1) as u32;
    Ok(Mesh {
        positions: points.iter().map(|point| (radius * *point).extend(0.0)).collect(),
        normals: vec![Vec3::Z; points.len()],
        uvs: points.iter().map(|point| 0.5 * *point + 0.5).collect(),
        triangles: (0..segments).map(|i| [0, next(i), next(i + 1)]).collect(),
        ..Mesh::default()
    })
}

pub(crate) const BOX: &[ShapeParameter] = &[
    ShapeParameter::length("width", 2.0),
    ShapeParameter::length("height", 2.0),
    ShapeParameter::length("depth", 2.0),
    EDGE_RADIUS,
];

pub(crate) fn cuboid(values: &Values) -> Result<Mesh, SceneError> {
    let half = 0.5 * Vec3::new(values.get("width"), values.get("height"), values.get("depth"));
    Ok(rounded_box(half, values.get("edge_radius"), ARC, [1; 3]))
}

pub(crate) const CYLINDER: &[ShapeParameter] = &[RADIUS, HEIGHT, EDGE_RADIUS, SEGMENTS];

pub(crate) fn cylinder(values: &Values) -> Result<Mesh, SceneError> {
    let (radius, half) = (values.get("radius"), 0.5 * values.get("height"));
    let edge = values.get("edge_radius");
    let corners = [
        Corner::sharp(0.0, -half),
        Corner::rounded(radius, -half, edge),
        Corner::rounded(radius, half, edge),
        Corner::sharp(0.0, half),
    ];
    Ok(revolve(&fillet_profile(&corners, ARC), values.count("segments")))
}

pub(crate) const CONE: &[ShapeParameter] =
    &[RADIUS, HEIGHT, ShapeParameter::length_or_zero("top_radius", 0.0), EDGE_RADIUS, SEGMENTS];

pub(crate) fn cone(values: &Values) -> Result<Mesh, SceneError> {
    let (radius, half, top) = (values.get("radius"), 0.5 * values.get("height"), values.get("top_radius"));
    let edge = values.get("edge_radius");
    let mut corners = vec![Corner::sharp(0.0, -half), Corner::rounded(radius, -half, edge)];
    if top > 0.0 {
        corners.push(Corner::rounded(top, half, edge));
    }
    corners.push(Corner::sharp(0.0, half));
    Ok(revolve(&fillet_profile(&corners, ARC), values.count("segments")))
}

pub(crate) const TORUS: &[ShapeParameter] = &[
    ShapeParameter::length("radius", 1.0), // Of the middle line of the tube
    ShapeParameter::length("tube_radius", 0.3),
    SEGMENTS,
    ShapeParameter::count("tube_segments", 48.0, 3.0, 4096.0),
];

pub(crate) fn torus(values: &Values) -> Result<Mesh, SceneError> {
    let (radius, tube) = (values.get("radius"), values.get("tube_radius"));
    if tube >= radius {
        let message = format!("tube_radius is {tube}, but must be less than radius = {radius}");
        return Err(SceneError::new(message));
    }
    let rings = values.count("tube_segments");
    let point = |i: usize| {
        let normal = Vec2::from_angle(TAU * (i % rings) as f32 / rings as f32);
        ProfilePoint { position: Vec2::new(radius, 0.0) + tube * normal, normal }
    };
    let profile: Vec<_> = (0..=rings).map(point).collect();
    Ok(revolve(&profile, values.count("segments")))
}
