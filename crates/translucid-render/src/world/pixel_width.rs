//! The width of a pixel on the surface that it shows.

/// Width of a pixel \[L\] by the distance of the surface that it shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PixelWidth {
    constant: f32,
    per_distance: f32,
}

impl PixelWidth {
    /// A width that does not depend on the distance.
    pub(crate) fn constant(width: f32) -> Self {
        Self { constant: width, per_distance: 0.0 }
    }

    /// A width in proportion to the distance.
    pub(crate) fn per_distance(per_distance: f32) -> Self {
        Self { constant: 0.0, per_distance }
    }

    /// The width at a distance from the camera \[L\].
    pub(crate) fn at(self, distance: f32) -> f32 {
        self.constant + self.per_distance * distance
    }
}
