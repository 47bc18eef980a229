//! The orientation of a surface: closed and looking out, closed and looking in, or neither.

use glam::{DMat3, DVec3, Vec3};

/// Part of the area whose absence is not noticed.
const TOLERANCE: f64 = 1e-4;

/// 1 if triangles form one or more closed surfaces whose faces all look out, −1 if they all look in, 0 if there are holes or
/// flipped faces, or hardly any volume.
///
/// By the divergence theorem no linear field without sources flows through a closed surface. Over centroids c and area
/// vectors A, Σ A then vanishes, and Σ c Aᵀ is the volume times the unit matrix; with holes or flipped faces, both hold only
/// by chance. This needs no table of edges, and vertices may be duplicated.
pub(crate) fn orientation<I: Iterator<Item = [Vec3; 3]>>(triangles: impl Fn() -> I) -> f32 {
    let Some([origin, ..]) = triangles().next() else { return 0.0 };
    let (mut area, mut extent) = (0.0, 0.0_f64);
    let (mut flux, mut moments) = (DVec3::ZERO, DMat3::ZERO);
    for triangle in triangles() {
        let [a, b, c] = triangle.map(|vertex| (vertex - origin).as_dvec3());
        let vector = (b - a).cross(c - a);
        let center = (a + b + c) / 3.0;
        area += vector.length();
        extent = extent.max(center.length());
        flux += vector;
        moments += DMat3::from_cols(center * vector.x, center * vector.y, center * vector.z);
    }
    let trace = moments.x_axis.x + moments.y_axis.y + moments.z_axis.z;
    let rest = moments - DMat3::from_diagonal(DVec3::splat(trace / 3.0));
    let most = rest.to_cols_array().into_iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let is_closed = flux.length() <= TOLERANCE * area && most <= TOLERANCE * area * extent;
    if is_closed && trace.abs() > TOLERANCE * area * extent { trace.signum() as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use translucid_scene::Mesh;
    use translucid_shapes::{ShapeParameters, build_shape};

    use super::*;

    fn sphere() -> Mesh {
        let mut mesh = build_shape("sphere", &ShapeParameters::new()).expect("a sphere");
        mesh.positions
            .iter_mut()
            .for_each(|p| *p = *p * Vec3::new(1.0, 1.4, 0.7) + Vec3::new(30.0, -7.0, 2.0));
        mesh
    }

    fn orientation_of(mesh: &Mesh) -> f32 {
        orientation(|| mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])))
    }

    #[test]
    fn closed_surfaces_are_told_from_open_and_turned_ones() {
        let whole = sphere();
        assert_eq!(orientation_of(&whole), 1.0);
        let mut inside_out = whole.clone();
        inside_out.triangles.iter_mut().for_each(|t| t.reverse());
        assert_eq!(orientation_of(&inside_out), -1.0);
        assert_eq!(orientation_of(&Mesh::default()), 0.0);
        // One face in a hundred
        for seed in 0..20 {
            let is_one = |i: usize| (i * 7919 + seed).is_multiple_of(100);
            let mut turned = whole.clone();
            turned
                .triangles
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| is_one(*i))
                .for_each(|(_, t)| t.reverse());
            assert_eq!(orientation_of(&turned), 0.0, "{seed}");
            let mut open = whole.clone();
            let mut number = 0..;
            open.triangles.retain(|_| !is_one(number.next().unwrap_or_default()));
            assert_eq!(orientation_of(&open), 0.0, "{seed}");
        }
        // Two holes that face each other
        let mut tube = whole;
        let positions = tube.positions.clone();
        tube.triangles.retain(|t| t.iter().all(|&i| (positions[i as usize].z - 2.0).abs() < 0.6));
        assert_eq!(orientation_of(&tube), 0.0);
    }

    #[test]
    fn extremes_are_answered() {
        for scale in [0.0, 1e-30, 1e30, f32::INFINITY, f32::NAN] {
            let mut mesh = sphere();
            mesh.positions.iter_mut().for_each(|p| *p *= scale);
            assert!([-1.0, 0.0, 1.0].contains(&orientation_of(&mesh)), "{scale}");
        }
    }
}
