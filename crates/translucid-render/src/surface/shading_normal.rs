//! Shading normals: from the mesh, bent by normal maps, on the side that is seen.

use glam::Vec3;
use translucid_scene::{Material, Scene};

use super::texture::texel;
use crate::ray::SurfacePoint;

/// The shading normal, bent by the normal map if there is one.
pub(crate) fn shading_normal_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    let Some(map) = &material.geometry_normal else { return point.shading_normal };
    let Some(frame) = tangent_frame(scene, point) else { return point.shading_normal };
    let texel = texel(&scene.images, &map.texture, point);
    let x = (texel[0] * 2.0 - 1.0) * map.scale;
    let y = (texel[1] * 2.0 - 1.0) * map.scale;
    let z = texel[2] * 2.0 - 1.0;
    let normal = frame[0] * x + frame[1] * y + point.shading_normal * z;
    match normal.try_normalize() {
        Some(normal) if normal.dot(point.geometric_normal) > 0.0 => normal,
        _ => point.shading_normal,
    }
}

/// Tangent and bitangent along u and v: the mesh's own, or the triangle's.
fn tangent_frame(scene: &Scene, point: &SurfacePoint) -> Option<[Vec3; 2]> {
    let object = &scene.objects[point.object as usize];
    let mesh = &object.mesh;
    let corners = object.corners(point.triangle as usize);
    let normal = point.shading_normal;
    let (tangent, sign) = if mesh.tangents.is_empty() {
        if mesh.uvs.is_empty() {
            return None;
        }
        let [p0, p1, p2] = corners.map(|c| object.position(c));
        let [t0, t1, t2] = corners.map(|c| mesh.uvs[c as usize]);
        let (d1, d2) = (t1 - t0, t2 - t0);
        let determinant = d1.perp_dot(d2);
        let tangent = ((p1 - p0) * d2.y - (p2 - p0) * d1.y) * determinant.signum();
        (tangent, determinant.signum())
    } else {
        // Corner weights would matter only where tangents differ much within a triangle.
        let [a, b, c] = corners.map(|c| object.tangent(c));
        let sum = a + b + c;
        (sum.truncate(), sum.w.signum())
    };
    let tangent = (tangent - normal * normal.dot(tangent)).try_normalize()?;
    Some([tangent, normal.cross(tangent) * sign])
}
