//! Checks that a mesh is valid, on all threads where it is large.

use glam::{DVec3, Vec3, Vec4};
use rayon::prelude::*;

use super::{Mesh, Triangle};
use crate::SceneError;
use translucid_words::{Interval, refusal};

/// Largest coordinate of a usable vertex \[L\].
///
/// The squared length of the cross product of two edges stays below 1.5e38, within `f32`.
pub(super) const LARGEST_COORDINATE: f32 = 1e9;

/// Smallest usable cross product of two edges \[L²\]: its square is still a normal `f32`.
const SMALLEST_CROSS: f64 = 2e-19;

/// Smallest usable height of a triangle relative to its longest edge.
///
/// Below, the plane drowns in the rounding of an `f32` cross product.
const SMALLEST_HEIGHT: f64 = 1e-6;

/// Largest difference between 1 and the square of the length of a unit vector: components of 8 bits pass.
const UNIT: f32 = 0.02;

/// Values that one thread looks at before the next one is asked.
const AT_ONCE: usize = 1 << 14;

impl Mesh {
    /// Checks that the mesh is valid.
    ///
    /// # Errors
    /// There is no triangle, an index or the length of an array is wrong, a number is not finite or out of its
    /// range, or a triangle has no area. [`repair_mesh`](crate::repair_mesh) makes such a mesh valid if it can.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.check().map_err(|error| error.within("mesh"))
    }

    pub(crate) fn check(&self) -> Result<(), SceneError> {
        if self.triangles.is_empty() {
            return Err(SceneError::new("it has no triangles, but must have at least one"));
        }
        self.check_lengths()?;
        self.check_vertices()?;
        self.check_triangles()
    }

    fn check_lengths(&self) -> Result<(), SceneError> {
        let vertices = self.positions.len();
        let lengths = [
            ("normals", self.normals.len()),
            ("uvs", self.uvs.len()),
            ("tangents", self.tangents.len()),
            ("colors", self.colors.len()),
        ];
        match lengths.into_iter().find(|&(_, length)| length != 0 && length != vertices) {
            Some((name, length)) => {
                let must_be = format!("0 or {vertices}, the number of positions");
                Err(refusal(format_args!("{name}.len()"), length, must_be))
            }
            None => Ok(()),
        }
    }

    fn check_vertices(&self) -> Result<(), SceneError> {
        let is_place = |p: &Vec3| p.abs().cmple(Vec3::splat(LARGEST_COORDINATE)).all();
        if let Some(i) = first_bad(&self.positions, is_place) {
            return Interval::COORDINATE.check_all(&format!("positions[{i}]"), self.positions[i].to_array());
        }
        let is_unit = |n: &Vec3| (n.length_squared() - 1.0).abs() <= UNIT;
        if let Some(i) = first_bad(&self.normals, is_unit) {
            return Err(refusal(format_args!("normals[{i}]"), self.normals[i], "a vector of length 1"));
        }
        if let Some(i) = first_bad(&self.uvs, |uv| uv.is_finite()) {
            return Err(refusal(format_args!("uvs[{i}]"), self.uvs[i], "finite"));
        }
        let is_tangent = |t: &Vec4| is_unit(&t.truncate()) && t.w.abs() == 1.0;
        if let Some(i) = first_bad(&self.tangents, is_tangent) {
            let must_be = "a vector of length 1 with w = 1 or -1";
            return Err(refusal(format_args!("tangents[{i}]"), self.tangents[i], must_be));
        }
        if let Some(i) = first_bad(&self.colors, is_color) {
            return Interval::FACTOR.check_all(&format!("colors[{i}]"), self.colors[i].to_array());
        }
        Ok(())
    }

    fn check_triangles(&self) -> Result<(), SceneError> {
        let has_area = |triangle: &Triangle| {
            let corner = |vertex: u32| self.positions.get(vertex as usize).copied();
            let [Some(a), Some(b), Some(c)] = triangle.map(corner) else { return false };
            clearly_has_area(a, b, c) || has_area([a, b, c].map(|p| p.as_dvec3()))
        };
        let Some(i) = first_bad(&self.triangles, has_area) else { return Ok(()) };
        let field = format!("triangles[{i}]");
        let triangle = self.triangles[i];
        let vertices = self.positions.len();
        if let Some(corner) = triangle.iter().position(|&vertex| vertex as usize >= vertices) {
            let must_be = format!("less than {vertices}, the number of positions");
            return Err(refusal(format_args!("{field}[{corner}]"), triangle[corner], must_be));
        }
        let error = refusal(field, format_args!("{triangle:?}"), "a triangle with an area");
        Err(error.with_help("repair_mesh leaves out triangles without"))
    }
}

/// Returns whether a vertex color can be used.
pub(super) fn is_color(color: &Vec3) -> bool {
    color.cmpge(Vec3::ZERO).all() && color.cmple(Vec3::splat(Interval::FACTOR.high as f32)).all()
}

/// Returns whether a triangle has an area that its plane can be computed from in single precision.
pub(super) fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let cross = (b - a).cross(c - a).length();
    let longest_squared =
        (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    cross >= SMALLEST_CROSS && cross >= SMALLEST_HEIGHT * longest_squared
}

/// Returns whether triangles of at least this cross product and this height over their longest edge have an area, as
/// [`has_area`] does of one.
pub(crate) fn stays_flat_enough(cross: f64, height: f64) -> bool {
    cross >= SMALLEST_CROSS && height >= SMALLEST_HEIGHT * (1.0 - 1e-6)
}

impl Mesh {
    /// The least cross product of two edges of a triangle \[L²\], and the least one over the longest edge squared.
    pub fn flattest(&self) -> [f64; 2] {
        let of_triangle = |triangle: &Triangle| {
            let Some([a, b, c]) = self.corners(triangle) else { return [0.0; 2] };
            let cross = (b - a).cross(c - a).length();
            let edges = [b - a, c - b, a - c].map(DVec3::length_squared);
            [cross, cross / edges.into_iter().fold(0.0, f64::max)]
        };
        let least = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].min(b[1])];
        let triangles = self.triangles.par_iter().with_min_len(AT_ONCE);
        triangles.map(of_triangle).reduce(|| [f64::INFINITY; 2], least)
    }
}

/// Returns, in single precision, whether a triangle has far more area than [`has_area`] asks for.
///
/// The cross product is exact to some 1e-6 of the longest edge squared, a hundredth of what it must have here, and
/// what overflows or underflows is not clear.
fn clearly_has_area(a: Vec3, b: Vec3, c: Vec3) -> bool {
    let (x, y) = (b - a, c - a);
    let longest_squared = x.length_squared().max(y.length_squared()).max((c - b).length_squared());
    let least = 1e-4 * longest_squared;
    least > 1e-15 && x.cross(y).length_squared() >= least * least
}

/// Index of the first value that is not good.
fn first_bad<T: Sync>(values: &[T], is_good: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    // Without a branch for each value: it is nearly always good.
    let all_good = |chunk: &[T]| chunk.iter().fold(true, |all, value| all & is_good(value));
    let first_bad = |(number, chunk): (usize, &[T])| {
        if all_good(chunk) {
            return None;
        }
        chunk.iter().position(|value| !is_good(value)).map(|i| number * AT_ONCE + i)
    };
    match values.len() {
        0..=AT_ONCE => first_bad((0, values)),
        _ => values.par_chunks(AT_ONCE).enumerate().find_map_first(first_bad),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    fn square() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4],
            colors: vec![Vec3::ONE; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    fn refusal_of(change: impl FnOnce(&mut Mesh)) -> String {
        let mut mesh = square();
        change(&mut mesh);
        mesh.validate().expect_err("the mesh is broken").message
    }

    #[test]
    fn broken_meshes_are_refused_with_their_place() {
        assert_eq!(square().validate(), Ok(()));
        let message = refusal_of(|mesh| mesh.triangles.clear());
        assert_eq!(message, "mesh, it has no triangles, but must have at least one");
        let message = refusal_of(|mesh| mesh.triangles[1][2] = 4);
        assert_eq!(message, "mesh, triangles[1][2] = 4: must be less than 4, the number of positions");
        let message = refusal_of(|mesh| mesh.triangles[1] = [0, 0, 1]);
        assert_eq!(message, "mesh, triangles[1] = [0, 0, 1]: must be a triangle with an area");
        let message = refusal_of(|mesh| mesh.uvs.truncate(3));
        assert_eq!(message, "mesh, uvs.len() = 3: must be 0 or 4, the number of positions");
        let message = refusal_of(|mesh| mesh.positions[2].y = f32::NAN);
        assert_eq!(message, "mesh, positions[2][1] = NaN: must be in [-1e9, 1e9]");
        let message = refusal_of(|mesh| mesh.normals[3] *= 2.0);
        assert_eq!(message, "mesh, normals[3] = [0, 0, 2]: must be a vector of length 1");
        let message = refusal_of(|mesh| mesh.uvs[0].x = f32::INFINITY);
        assert_eq!(message, "mesh, uvs[0] = [inf, 0]: must be finite");
        let message = refusal_of(|mesh| mesh.tangents[0].w = 0.5);
        assert_eq!(
            message,
            "mesh, tangents[0] = [1, 0, 0, 0.5]: must be a vector of length 1 with w = 1 or -1"
        );
        let message = refusal_of(|mesh| mesh.colors[1].z = -0.5);
        assert_eq!(message, "mesh, colors[1][2] = -0.5: must be in [0, 1e6]");
    }

    /// The quick test never accepts what the exact one refuses, from needles to specks.
    #[test]
    fn clear_areas_are_areas() {
        for size in [1e-12_f32, 1e-9, 1e-4, 1.0, 1e5, 1e9] {
            for height in [0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.5] {
                for shift in [0.0, 0.3, 1.0] {
                    let corners =
                        [Vec3::splat(shift), Vec3::new(1.0, 0.2, -0.1), Vec3::new(0.5, height, 0.0)];
                    let [a, b, c] = corners.map(|p| p * size);
                    let exact = has_area([a, b, c].map(|p| p.as_dvec3()));
                    assert!(!clearly_has_area(a, b, c) || exact, "{a} {b} {c}");
                }
            }
        }
    }

    #[test]
    fn first_bad_is_the_first_in_long_lists() {
        let mut values = vec![0; 5 * AT_ONCE + 3];
        assert_eq!(first_bad(&values, |&v| v == 0), None);
        for i in [5 * AT_ONCE + 2, 3 * AT_ONCE, 2 * AT_ONCE - 1] {
            values[i] = 1;
            assert_eq!(first_bad(&values, |&v| v == 0), Some(i));
        }
    }
}
