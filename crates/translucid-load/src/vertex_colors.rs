//! The colors of vertices and faces of files that do not say what they are.

use glam::Vec3;
use translucid_scene::{Place, Warning, linear_from_srgb};

/// Channel above which colors are from 0 to 255: one of those from 0 to 1 may be a little above 1.
const LARGEST_OF_UNIT: f32 = 2.0;

/// Makes linear colors of those of sRGB, which are from 0 to 1, or from 0 to 255 with a warning.
///
/// Colors that are all white are taken away: they change nothing, and programs write them where there are none.
pub(super) fn make_linear(colors: &mut Vec<Vec3>, place: &Place, warnings: &mut Vec<Warning>) {
    let largest = colors.iter().fold(0.0, |largest: f32, color| largest.max(color.max_element()));
    let mut white = 1.0;
    if largest > LARGEST_OF_UNIT {
        let message = format!("vertex colors reach {largest}, so they are taken for values from 0 to 255");
        warnings.push(Warning { message, place: Some(place.clone()) });
        white = 255.0;
    }
    let linear = |value: f32| linear_from_srgb((value / white).clamp(0.0, 1.0));
    colors.iter_mut().for_each(|color| *color = color.map(linear));
    if colors.iter().all(|color| *color == Vec3::ONE) {
        *colors = Vec::new();
    }
}
