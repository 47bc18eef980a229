//! The light and the first surface of one camera path, by layers.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Indices of the layers within a pixel's sums.
pub mod layer {
    use std::ops::Range;

    /// Light whose last event before the camera was a diffuse reflection.
    pub const DIFFUSE: Range<usize> = 0..3;
    /// … a specular reflection or transmission.
    pub const SPECULAR: Range<usize> = 3..6;
    /// … subsurface scattering.
    pub const SUBSURFACE: Range<usize> = 6..9;
    /// Light straight from an emitter, the visible environment included.
    pub const EMISSION: Range<usize> = 9..12;
    /// Coverage.
    pub const ALPHA: usize = 12;
    /// Albedo of the first surface seen.
    pub const ALBEDO: Range<usize> = 13..16;
    /// World-space shading normal of the first surface seen.
    pub const NORMAL: Range<usize> = 16..19;
    /// Distance to the first surface seen \[L\], summed over the samples that see one.
    pub const DEPTH: usize = 19;
    /// Share of the samples that see a surface, so that depth / surface is the mean distance even where a
    /// visible environment covers the rest of the pixel.
    pub const SURFACE: usize = 20;
    /// Number of sums per pixel.
    pub const COUNT: usize = 21;
}

/// The light and the features that one camera path brings; the beauty image is the sum of the four light layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PixelSample {
    /// See [`layer::DIFFUSE`].
    pub diffuse: Vec3,
    /// See [`layer::SPECULAR`].
    pub specular: Vec3,
    /// See [`layer::SUBSURFACE`].
    pub subsurface: Vec3,
    /// See [`layer::EMISSION`].
    pub emission: Vec3,
    /// 1 where a surface or a visible environment is seen, 0 where nothing is.
    pub alpha: f32,
    /// See [`layer::ALBEDO`].
    pub albedo: Vec3,
    /// See [`layer::NORMAL`].
    pub normal: Vec3,
    /// Distance to the first surface \[L\], 0 where none is seen.
    pub depth: f32,
}

impl PixelSample {
    /// All light of the sample.
    pub fn radiance(&self) -> Vec3 {
        self.diffuse + self.specular + self.subsurface + self.emission
    }

    /// The sample as values in the order of [`layer`].
    pub fn layers(&self) -> [f32; layer::COUNT] {
        let mut values = [0.0; layer::COUNT];
        for (range, color) in [
            (layer::DIFFUSE, self.diffuse),
            (layer::SPECULAR, self.specular),
            (layer::SUBSURFACE, self.subsurface),
            (layer::EMISSION, self.emission),
            (layer::ALBEDO, self.albedo),
            (layer::NORMAL, self.normal),
        ] {
            values[range].copy_from_slice(&color.to_array());
        }
        values[layer::ALPHA] = self.alpha;
        values[layer::DEPTH] = self.depth;
        values[layer::SURFACE] = if self.depth > 0.0 { 1.0 } else { 0.0 };
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_hold_every_part_of_a_sample() {
        let sample = PixelSample {
            diffuse: Vec3::new(1.0, 2.0, 3.0),
            specular: Vec3::new(4.0, 5.0, 6.0),
            subsurface: Vec3::new(7.0, 8.0, 9.0),
            emission: Vec3::new(10.0, 11.0, 12.0),
            alpha: 13.0,
            albedo: Vec3::new(14.0, 15.0, 16.0),
            normal: Vec3::new(17.0, 18.0, 19.0),
            depth: 20.0,
        };
        let expected: [f32; layer::COUNT] =
            std::array::from_fn(|i| if i == layer::SURFACE { 1.0 } else { i as f32 + 1.0 });
        assert_eq!(sample.layers(), expected);
        assert_eq!(PixelSample { depth: 0.0, ..sample }.layers()[layer::SURFACE], 0.0);
    }
}
