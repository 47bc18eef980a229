//! Shading normals on the side that is seen.

use glam::Vec3;

use crate::elementary::{sign_of, unit_or};

/// Cosine of the view to which a shading normal is lifted if it faces away from the side that is seen.
const LEAST_SEEN: f32 = 1e-3;

/// The shading normal that is nearest among those that face the seen side of a surface.
///
/// Interpolated normals of coarse meshes, and those of normal maps, may face away where the surface itself does not: light
/// reflected there would count as having come through the surface, and the surface would be black.
#[inline]
pub fn facing(normal: Vec3, geometric_normal: Vec3, view: Vec3) -> Vec3 {
    let (seen, promised) = (view.dot(geometric_normal), view.dot(normal));
    if seen * promised > 0.0 || seen == 0.0 {
        return normal;
    }
    let lifted = normal + view * (LEAST_SEEN * sign_of(seen) - promised);
    unit_or(lifted, geometric_normal)
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
            assert!(cosine > 0.0 && cosine < 2.0 * LEAST_SEEN, "{cosine}");
            // The nearest: in the plane of view and normal
            assert!(lifted.dot(view.cross(normal)).abs() < 1e-6);
        }
    }
}
