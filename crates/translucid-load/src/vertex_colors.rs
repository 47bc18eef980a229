//! The range of colors of vertices.

use glam::Vec3;
use translucid_scene::{Place, Warning};

/// Channel above which colors are from 0 to 255: one of those from 0 to 1 may be a little above 1.
const LARGEST_OF_UNIT: f32 = 2.0;

/// The value of a channel that is 1: that or 255, which adds a warning.
pub(super) fn white_of(colors: &[Vec3], place: &Place, warnings: &mut Vec<Warning>) -> f32 {
    let largest = colors.iter().fold(0.0, |largest: f32, color| largest.max(color.max_element()));
    if largest <= LARGEST_OF_UNIT {
        return 1.0;
    }
    let message = format!("vertex colors reach {largest}, so they are taken for values from 0 to 255");
    warnings.push(Warning { message, place: Some(place.clone()) });
    255.0
}
