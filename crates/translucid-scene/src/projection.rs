//! Geometry of the lines of sight.

use translucid_words::Interval;

/// Geometry of the lines of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// They meet in the lens.
    Perspective {
        /// Full horizontal field of view of a picture without shift in degrees, in (0, 180).
        horizontal_fov: f32,
    },
    /// They are parallel.
    Orthographic {
        /// Width of what the picture shows \[L\], > 0.
        width: f32,
    },
}

impl Projection {
    /// Range of a field of view.
    pub(crate) const FOV: Interval = Interval::open(0.0, 180.0);

    /// Width of what the picture shows at a depth along the view \[L\].
    pub fn width_at(self, depth: f64) -> f64 {
        match self {
            Self::Perspective { horizontal_fov } => {
                2.0 * depth * libm::tan((0.5 * f64::from(horizontal_fov)).to_radians())
            }
            Self::Orthographic { width } => f64::from(width),
        }
    }

    /// The projection that shows `factor` times the width.
    pub fn widened(self, factor: f64) -> Self {
        match self {
            Self::Perspective { .. } => {
                let tangent = 0.5 * factor * self.width_at(1.0);
                Self::Perspective { horizontal_fov: (2.0 * libm::atan(tangent)).to_degrees() as f32 }
            }
            Self::Orthographic { width } => Self::Orthographic { width: (factor * f64::from(width)) as f32 },
        }
    }
}
