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

/// Cosine of the view to which a shading normal is lifted if it faces away from the side that is seen.
const LEAST_COSINE: f32 = 1e-3;

/// The shading normal that is nearest among those that face the seen side of a surface.
///
/// Interpolated normals of coarse meshes, and those of normal maps, may face away where the surface itself does not: light
/// reflected there would count as having come through the surface, and the surface would be black.
pub(crate) fn facing(normal: Vec3, geometric_normal: Vec3, view: Vec3) -> Vec3 {
    let (seen, promised) = (view.dot(geometric_normal), view.dot(normal));
    if seen * promised > 0.0 || seen == 0.0 {
        return normal;
    }
    let lifted = normal + view * (LEAST_COSINE.copysign(seen) - promised);
    lifted.try_normalize().unwrap_or(geometric_normal)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facing_keeps_normals_that_face_the_seen_side() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        for view in [Vec3::Z, Vec3::new(0.0, 0.6, 0.8), -Vec3::Z, Vec3::new(-0.8, 0.0, 0.7).normalize()] {
            let faces = view.dot(normal) * view.z > 0.0;
            assert_eq!(facing(normal, Vec3::Z, view) == normal, faces, "{view}");
        }
    }

    #[test]
    fn facing_lifts_others_just_over_the_horizon_of_the_view() {
        let normal = Vec3::new(0.8, 0.0, 0.6);
        for view in [Vec3::new(-1.0, 0.0, 0.1), Vec3::new(-0.9, 0.3, 0.3), Vec3::new(1.0, 0.2, -0.1)] {
            let view = view.normalize();
            assert!(view.dot(normal) * view.z < 0.0, "{view} sees the normal's side");
            let lifted = facing(normal, Vec3::Z, view);
            assert!(lifted.is_normalized() && lifted.z > 0.0, "{lifted}");
            let cosine = lifted.dot(view) * view.z.signum();
            assert!(cosine > 0.0 && cosine < 2.0 * LEAST_COSINE, "{cosine}");
            // The nearest: in the plane of view and normal
            assert!(lifted.dot(view.cross(normal)).abs() < 1e-6);
        }
    }
}
