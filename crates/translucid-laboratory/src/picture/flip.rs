//! ꟻLIP: the difference that a viewer sees who flips between two pictures.

use flip_rs::{RgbImage, ldr_flip};

use super::Picture;

/// Pixels for one degree of the viewer's field: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m, which is what
/// everyone who gives no other number has.
pub const PIXELS_PER_DEGREE: f32 = flip_rs::DEFAULT_PPD;

/// LDR-ꟻLIP of what a display shows of two pictures, pixel by pixel
/// \[P. Andersson et al. 2020, "ꟻLIP: A Difference Evaluator for Alternating Images"\].
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    values: Vec<f32>,
}

impl FlipMap {
    /// The map of a picture against a reference of the same size, at [`PIXELS_PER_DEGREE`].
    ///
    /// # Errors
    /// The sizes differ, a picture is empty, or it is too large: beyond some ten million pixels.
    pub fn new(picture: &Picture, reference: &Picture) -> Result<Self, String> {
        let image = |picture: &Picture| {
            let values = picture.display.as_flattened().to_vec();
            RgbImage::new(picture.width, picture.height, values).map_err(|error| error.to_string())
        };
        let map = ldr_flip(&image(reference)?, &image(picture)?, PIXELS_PER_DEGREE);
        Ok(Self { values: map.map_err(|error| error.to_string())?.into_pixels() })
    }

    /// The values, each in \[0, 1\], row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Their mean.
    pub fn mean(&self) -> f64 {
        self.values.iter().map(|&value| f64::from(value)).sum::<f64>() / self.values.len().max(1) as f64
    }

    /// The greatest of them.
    pub fn max(&self) -> f64 {
        f64::from(self.values.iter().copied().fold(0.0, f32::max))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{noise, picture};
    use super::*;

    fn flat(color: [f32; 3]) -> Picture {
        picture(16, 16, |_, _| color)
    }

    /// Mean and maximum of NVIDIA's own program for the same pictures: the Python package flip-evaluator 1.7,
    /// `evaluate(picture, reference, "LDR", True, False)`. Its mean is a sum in single precision.
    #[test]
    fn flip_agrees_with_the_program_of_its_authors() {
        let gray = |x: f32| [x; 3];
        let wide = |color: &dyn Fn(usize, usize) -> [f32; 3]| picture(64, 48, color);
        let ramp = |x: usize, y: usize| [x as f32 / 63.0, y as f32 / 47.0, (x + y) as f32 / 110.0];
        let cases = [
            (flat([0.0, 1.0, 0.0]), flat([0.0, 0.0, 1.0]), 1.0, 1.0),
            (flat(gray(0.0)), flat(gray(1.0)), 0.967_391, 0.967_388),
            (flat(gray(0.5)), flat([0.5, 0.5, 0.52]), 0.084_234, 0.084_234),
            (noise(64, 48, 1), noise(64, 48, 2), 0.452_979, 0.967_137),
            (
                wide(&|x, _| gray(if x < 32 { 0.2 } else { 0.8 })),
                wide(&|_, _| gray(0.2)),
                0.506_480,
                0.980_064,
            ),
            (
                wide(&|x, _| if x == 32 { [0.9, 0.3, 0.1] } else { gray(0.2) }),
                wide(&|_, _| gray(0.2)),
                0.053_497,
                0.704_875,
            ),
            (
                wide(&ramp),
                wide(&|x, y| ramp(x, y).map(|value| (value + 0.03).min(1.0))),
                0.169_972,
                0.226_421,
            ),
        ];
        for (number, (one, other, mean, max)) in cases.into_iter().enumerate() {
            let map = FlipMap::new(&one, &other).unwrap();
            assert!((map.mean() - mean).abs() < 1e-5, "case {number}: {} and {mean}", map.mean());
            assert!((map.max() - max).abs() < 1e-5, "case {number}: {} and {max}", map.max());
        }
    }

    #[test]
    fn flip_of_equal_pictures_is_zero() {
        let one = noise(40, 24, 3);
        let map = FlipMap::new(&one, &one.clone()).unwrap();
        assert!(map.values().iter().all(|&value| value == 0.0));
        assert_eq!([map.mean(), map.max()], [0.0, 0.0]);
    }

    #[test]
    fn flip_is_symmetric() {
        let [one, other] = [4, 5].map(|seed| noise(40, 24, seed));
        let [there, back] = [FlipMap::new(&one, &other).unwrap(), FlipMap::new(&other, &one).unwrap()];
        for (a, b) in there.values().iter().zip(back.values()) {
            assert!((a - b).abs() < 1e-6 && (0.0..=1.0).contains(a), "{a} {b}");
        }
    }

    #[test]
    fn flip_refuses_pictures_of_other_sizes() {
        assert!(FlipMap::new(&noise(4, 3, 0), &noise(3, 4, 0)).is_err());
        assert!(FlipMap::new(&noise(0, 0, 0), &noise(0, 0, 0)).is_err());
    }
}
