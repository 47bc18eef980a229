//! Checks of directions, edges and rotations.

use glam::{DMat3, Mat3, Vec3};

use crate::SceneError;
use translucid_words::{Interval, refusal};

/// Largest cosine between two directions that count as perpendicular.
const PERPENDICULAR: f64 = 1e-3;
/// Largest difference between 1 and the square of a length that counts as 1.
const UNIT: f64 = 0.02;

/// Refuses a direction whose length is not 1.
pub(crate) fn check_unit(field: &str, direction: Vec3) -> Result<(), SceneError> {
    if (direction.as_dvec3().length_squared() - 1.0).abs() <= UNIT {
        return Ok(());
    }
    Err(refusal(field, direction, "a vector of length 1"))
}

/// Refuses edges of a rectangle that are zero or not perpendicular to each other.
pub(crate) fn check_edges(x: Vec3, y: Vec3) -> Result<(), SceneError> {
    for (field, edge) in [("edge_x", x), ("edge_y", y)] {
        Interval::PLACE.check_all(field, edge.to_array())?;
        if edge == Vec3::ZERO {
            return Err(refusal(field, edge, "a vector that is not zero"));
        }
    }
    let (x, y) = (x.as_dvec3(), y.as_dvec3());
    // Components near the least number in single precision have no digits left for an angle.
    let rounding = f64::from(f32::from_bits(4)) * (x.length() + y.length());
    if x.dot(y).abs() <= PERPENDICULAR * x.length() * y.length() + rounding {
        return Ok(());
    }
    Err(refusal("edge_y", y, "perpendicular to edge_x"))
}

/// Whether a matrix turns without stretching or mirroring.
pub(crate) fn is_rotation(matrix: Mat3) -> bool {
    let matrix = matrix.as_dmat3();
    let difference = matrix.transpose() * matrix - DMat3::IDENTITY;
    let turns = difference.to_cols_array().iter().all(|x| x.abs() <= PERPENDICULAR);
    turns && matrix.determinant() > 0.0
}
