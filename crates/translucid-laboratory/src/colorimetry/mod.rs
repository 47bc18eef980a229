//! Colors of spectra, as the CIE measures them.
//!
//! A spectrum has 81 values, from 380 nm to 780 nm by 5 nm ([`WAVELENGTHS`]): reflectances or transmittances, where 1 is all of
//! the light. [`Colorimeter`] turns it into XYZ, CIELAB and linear sRGB under an [`Illuminant`] for an [`Observer`];
//! [`delta_e_ab`] and [`delta_e_2000`] are differences of two CIELAB colors.

mod difference;
mod tables;

pub use difference::{delta_e_2000, delta_e_ab};

use tables::ROWS;
use translucid_profile::convention::primaries::{CONES, Matrix, apply, inverse, times};

/// Values of a spectrum.
pub const WAVELENGTHS: usize = ROWS.len();

/// Spectrum of reflectances or transmittances at [`wavelength`]s.
pub type Spectrum = [f64; WAVELENGTHS];

/// Wavelength of a spectrum's value, from 380 to 780 \[nm\].
pub fn wavelength(index: usize) -> f64 {
    380.0 + 5.0 * index as f64
}

/// Eye for which colors are matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observer {
    /// CIE 1931, for fields of 2°.
    TwoDegrees,
    /// CIE 1964, for fields of 10°.
    TenDegrees,
}

/// Light by which colors are seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illuminant {
    /// Daylight of 6504 K.
    D65,
    /// Daylight of 5003 K, that of printing.
    D50,
    /// Incandescent light of 2856 K.
    A,
}

impl Illuminant {
    /// Relative power at a value of a spectrum.
    fn power(self, index: usize) -> f64 {
        let [.., d65, d50] = ROWS[index];
        match self {
            Self::D65 => d65,
            Self::D50 => d50,
            // The definition of ISO/CIE 11664-2:2022, up to a factor
            Self::A => {
                let wavelength = wavelength(index);
                1e15 * libm::pow(wavelength, -5.0) / libm::expm1(1.435e7 / (2848.0 * wavelength))
            }
        }
    }
}

/// Linear Rec. 709 to XYZ of white 1, from the primaries and the white of ITU-R BT.709-6 (0.3127, 0.3290).
const XYZ_FROM_SRGB: Matrix = [
    [0.412_390_799_265_959_3, 0.357_584_339_383_877_8, 0.180_480_788_401_834_3],
    [0.212_639_005_871_510_2, 0.715_168_678_767_755_6, 0.072_192_315_360_733_7],
    [0.019_330_818_715_591_9, 0.119_194_779_794_626, 0.950_532_152_249_660_7],
];

/// Instrument that measures colors of spectra under one illuminant for one observer.
///
/// XYZ are those of CIE 15: sums over wavelengths, scaled so that the perfect diffuser has Y = 100.
/// For smooth spectra, sums by 5 nm from 380 nm to 780 nm agree with those by 1 nm to 0.01 in CIELAB.
///
/// ```
/// use translucid_laboratory::colorimetry::{Colorimeter, Illuminant, Observer, WAVELENGTHS};
///
/// let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
/// let gray = eye.xyz(&[0.184_186_5; WAVELENGTHS]);
/// let [lightness, a, b] = eye.lab(gray);
/// assert!((lightness - 50.0).abs() < 1e-4 && a.abs() < 1e-9 && b.abs() < 1e-9);
/// ```
#[derive(Clone, Debug)]
pub struct Colorimeter {
    weights: [[f64; 3]; WAVELENGTHS],
    white: [f64; 3],
    xyz_from_srgb: Matrix,
    srgb_from_xyz: Matrix,
}

impl Colorimeter {
    /// An instrument for an observer and an illuminant.
    pub fn new(observer: Observer, illuminant: Illuminant) -> Self {
        let mut weights = [[0.0; 3]; WAVELENGTHS];
        for (i, (weight, row)) in weights.iter_mut().zip(&ROWS).enumerate() {
            let [x, y, z, x10, y10, z10, ..] = *row;
            let matched = match observer {
                Observer::TwoDegrees => [x, y, z],
                Observer::TenDegrees => [x10, y10, z10],
            };
            *weight = matched.map(|value| value * illuminant.power(i));
        }
        let luminance: f64 = weights.iter().map(|[_, y, _]| y).sum();
        let weights = weights.map(|weight| weight.map(|value| 100.0 * value / luminance));
        let white = sum(&weights, &[1.0; WAVELENGTHS]);

        // Adapt from the white of sRGB to that of the illuminant
        let cones = apply(&CONES, apply(&XYZ_FROM_SRGB, [1.0; 3]));
        let seen = apply(&CONES, white);
        let scaled: Matrix = [0, 1, 2].map(|i| CONES[i].map(|value| value * seen[i] / cones[i]));
        let xyz_from_srgb = times(&inverse(&CONES), &times(&scaled, &XYZ_FROM_SRGB));
        Self { weights, white, xyz_from_srgb, srgb_from_xyz: inverse(&xyz_from_srgb) }
    }

    /// XYZ of the perfect diffuser, whose Y is 100.
    pub fn white(&self) -> [f64; 3] {
        self.white
    }

    /// XYZ of a spectrum.
    pub fn xyz(&self, spectrum: &Spectrum) -> [f64; 3] {
        sum(&self.weights, spectrum)
    }

    /// CIELAB of XYZ (ISO/CIE 11664-4:2019): L*, a* and b*.
    pub fn lab(&self, xyz: [f64; 3]) -> [f64; 3] {
        let root = |t: f64| {
            const LIMIT: f64 = 24.0 / 116.0;
            if t > LIMIT * LIMIT * LIMIT { libm::cbrt(t) } else { 841.0 / 108.0 * t + 16.0 / 116.0 }
        };
        let [x, y, z] = [0, 1, 2].map(|i| root(xyz[i] / self.white[i]));
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Linear sRGB (Rec. 709) of XYZ, adapted so that the perfect diffuser is (1, 1, 1); outside \[0, 1\] for colors that no
    /// display shows.
    pub fn linear_srgb(&self, xyz: [f64; 3]) -> [f64; 3] {
        apply(&self.srgb_from_xyz, xyz)
    }

    /// XYZ of linear sRGB, the inverse of [`Self::linear_srgb`].
    pub fn xyz_of_linear_srgb(&self, color: [f64; 3]) -> [f64; 3] {
        apply(&self.xyz_from_srgb, color)
    }
}

fn sum(weights: &[[f64; 3]; WAVELENGTHS], spectrum: &Spectrum) -> [f64; 3] {
    [0, 1, 2].map(|i| weights.iter().zip(spectrum).map(|(weight, value)| weight[i] * value).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step at 560 nm beside a band at 450 nm.
    fn spectrum() -> Spectrum {
        std::array::from_fn(|i| {
            let w = wavelength(i);
            0.1 + 0.6 / (1.0 + (-(w - 560.0) / 20.0).exp()) + 0.2 * (-((w - 450.0) / 25.0).powi(2)).exp()
        })
    }

    /// `colour-science` 0.4.7: `sd_to_XYZ_integration` and `XYZ_to_Lab` of the spectrum by 5 nm and by 1 nm from 380 nm to
    /// 780 nm, with the white of the same sums.
    #[test]
    fn colors_are_those_of_colour_science() {
        for (observer, illuminant, xyz, lab, lab_by_1_nm) in [
            (
                Observer::TwoDegrees,
                Illuminant::D65,
                [47.26377632, 38.80661827, 25.1961761],
                [68.61095341, 31.42920912, 23.09215166],
                [68.61138674, 31.42954891, 23.09863144],
            ),
            (
                Observer::TenDegrees,
                Illuminant::D50,
                [49.14182822, 38.96264897, 18.83891714],
                [68.72420086, 33.78726346, 23.29657185],
                [68.72462106, 33.78670593, 23.30415407],
            ),
            (
                Observer::TwoDegrees,
                Illuminant::A,
                [62.86811105, 45.42305834, 7.99723028],
                [73.16959207, 30.77575649, 32.14135472],
                [73.16928375, 30.77606389, 32.14003001],
            ),
        ] {
            let eye = Colorimeter::new(observer, illuminant);
            let found = eye.xyz(&spectrum());
            for i in 0..3 {
                // The table of A is rounded to six digits
                let tolerance = if illuminant == Illuminant::A { 2e-4 } else { 1e-7 };
                assert!((found[i] - xyz[i]).abs() < tolerance, "{illuminant:?}: {found:?}, expected {xyz:?}");
                let found = eye.lab(found);
                assert!((found[i] - lab[i]).abs() < tolerance, "{illuminant:?}: {found:?}, expected {lab:?}");
                assert!((found[i] - lab_by_1_nm[i]).abs() < 0.01, "{found:?}, by 1 nm {lab_by_1_nm:?}");
            }
        }
    }

    /// The whites by 1 nm of CIE 15:2004, table T.3.
    #[test]
    fn whites_are_those_of_the_cie() {
        for (observer, illuminant, [x, z]) in [
            (Observer::TwoDegrees, Illuminant::A, [109.85, 35.58]),
            (Observer::TwoDegrees, Illuminant::D65, [95.04, 108.88]),
            (Observer::TwoDegrees, Illuminant::D50, [96.42, 82.51]),
            (Observer::TenDegrees, Illuminant::A, [111.14, 35.20]),
            (Observer::TenDegrees, Illuminant::D65, [94.81, 107.32]),
            (Observer::TenDegrees, Illuminant::D50, [96.72, 81.43]),
        ] {
            let white = Colorimeter::new(observer, illuminant).white();
            let is_near = |i: usize, expected: f64| (white[i] - expected).abs() < 0.0051;
            assert!(is_near(0, x) && is_near(1, 100.0) && is_near(2, z), "{illuminant:?}: {white:?}");
        }
    }

    #[test]
    fn white_is_white_everywhere() {
        for illuminant in [Illuminant::D65, Illuminant::D50, Illuminant::A] {
            for observer in [Observer::TwoDegrees, Observer::TenDegrees] {
                let eye = Colorimeter::new(observer, illuminant);
                let white = eye.xyz(&[1.0; WAVELENGTHS]);
                assert!((white[1] - 100.0).abs() < 1e-12);
                assert!(delta_e_ab(eye.lab(white), [100.0, 0.0, 0.0]) < 1e-9);
                assert!(eye.linear_srgb(white).iter().all(|value| (value - 1.0).abs() < 1e-12));
                let color = [0.2, 0.5, 0.9];
                let back = eye.linear_srgb(eye.xyz_of_linear_srgb(color));
                assert!(color.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
            }
        }
    }

    /// Red of sRGB: CIELAB (53.24, 80.09, 67.20), as B. J. Lindbloom's calculator and many others print it.
    #[test]
    fn red_of_srgb_is_known() {
        let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
        let lab = eye.lab(eye.xyz_of_linear_srgb([1.0, 0.0, 0.0]));
        assert!(delta_e_ab(lab, [53.24, 80.09, 67.20]) < 0.05, "{lab:?}");
    }
}
