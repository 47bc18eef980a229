//! Light absorbed and scattered by what skin is made of.
//!
//! Coefficients are in mm⁻¹, wavelengths in nm.

use std::f64::consts::LN_10;

/// Absorption coefficient \[mm⁻¹\] of melanosomes of skin (S. L. Jacques 1998, *Skin optics*, omlc.org/news/jan98):
/// 6.6e11 λ^−3.33 cm⁻¹.
pub(super) fn eumelanin(wavelength: f64) -> f64 {
    6.6e10 * libm::pow(wavelength, -3.33)
}

/// Absorption coefficient \[mm⁻¹\] of as large a volume of pheomelanin (C. Donner and H. W. Jensen 2006, *A spectral BSSRDF
/// for shading human skin*).
pub(super) fn pheomelanin(wavelength: f64) -> f64 {
    2.9e14 * libm::pow(wavelength, -4.75)
}

/// Skin without blood and melanin, measured on rats (S. L. Jacques 1998, *Skin optics*): 0.244 + 85.3 … cm⁻¹.
pub(super) fn bare(wavelength: f64) -> f64 {
    0.0244 + 8.53 * libm::exp(-(wavelength - 154.0) / 66.2)
}

/// Whole blood with 150 g/L of hemoglobin, of which the part `oxygenation` carries oxygen.
pub(super) fn blood(wavelength: f64, oxygenation: f64) -> f64 {
    let extinction = |table: &[u32]| interpolated(table, 380.0, 5.0, wavelength);
    let mixed = oxygenation * extinction(&OXYHEMOGLOBIN) + (1.0 - oxygenation) * extinction(&HEMOGLOBIN);
    dissolved(mixed, 150.0, 64_500.0)
}

/// Bilirubin of a concentration \[g/L\]; none from 560 nm on.
pub(super) fn bilirubin(wavelength: f64, concentration: f64) -> f64 {
    dissolved(interpolated(&BILIRUBIN, 380.0, 10.0, wavelength), concentration, 585.0)
}

/// β-carotene of a concentration \[g/L\]; none from 560 nm on.
pub(super) fn carotene(wavelength: f64, concentration: f64) -> f64 {
    dissolved(interpolated(&CAROTENE, 380.0, 10.0, wavelength), concentration, 537.0)
}

/// Fat; below 430 nm, where it was not measured, that of 430 nm.
pub(super) fn fat(wavelength: f64) -> f64 {
    1e-6 * interpolated(&FAT, 430.0, 10.0, wavelength)
}

/// Reduced scattering coefficient a' (f (λ/500)⁻⁴ + (1 − f) (λ/500)^−b) (S. L. Jacques 2013, *Optical properties of
/// biological tissues: a review*, equation 2).
pub(super) struct Scattering {
    /// a', at 500 nm.
    at_500: f64,
    /// f, the part of Rayleigh's scattering.
    rayleigh: f64,
    /// b, the exponent of the rest.
    exponent: f64,
}

impl Scattering {
    /// Epidermis of E. Salomatina et al. 2006, fitted by Jacques, table 1.
    pub(super) const EPIDERMIS: Self = Self { at_500: 6.67, rayleigh: 0.29, exponent: 0.689 };
    /// Dermis of the same.
    pub(super) const DERMIS: Self = Self { at_500: 4.36, rayleigh: 0.41, exponent: 0.562 };
    /// Mean of fatty tissues, Jacques, table 2.
    pub(super) const SUBCUTIS: Self = Self { at_500: 1.93, rayleigh: 0.174, exponent: 0.447 };

    /// Reduced scattering coefficient.
    pub(super) fn reduced(&self, wavelength: f64) -> f64 {
        let power = |exponent: f64| libm::pow(wavelength / 500.0, -exponent);
        self.at_500 * (self.rayleigh * power(4.0) + (1.0 - self.rayleigh) * power(self.exponent))
    }
}

/// Absorption by a molar extinction to the base of 10 \[cm⁻¹ M⁻¹\], a concentration \[g/L\] and a molar mass \[g/mol\].
fn dissolved(extinction: f64, concentration: f64, molar_mass: f64) -> f64 {
    0.1 * LN_10 * extinction * concentration / molar_mass
}

/// A table between its values; beyond them the nearest.
fn interpolated(table: &[u32], start: f64, step: f64, wavelength: f64) -> f64 {
    let place = ((wavelength - start) / step).clamp(0.0, (table.len() - 1) as f64);
    let index = (place as usize).min(table.len() - 2);
    let [below, above] = [table[index], table[index + 1]].map(f64::from);
    below + (above - below) * (place - index as f64)
}

/// Hemoglobin with oxygen, in water, from 380 nm by 5 nm \[cm⁻¹ M⁻¹\]: W. B. Gratzer and N. Kollias, compiled by S. Prahl,
/// *Optical absorption of hemoglobin*, omlc.org/spectra/hemoglobin.
#[rustfmt::skip]
const OXYHEMOGLOBIN: [u32; 81] = [
    109_564, 130_276, 167_748, 221_836, 266_232, 331_462, 466_840, 523_080, 480_360, 351_134, 246_072, 149_076,
    102_580, 78_884, 62_816, 51_524, 44_480, 38_440, 33_209, 29_482, 26_629, 24_925, 23_684, 22_154, 20_933,
    20_182, 20_035, 20_715, 24_202, 30_883, 39_957, 48_338, 53_236, 50_982, 43_016, 35_646, 32_613, 35_205,
    44_496, 54_424, 50_104, 30_620, 14_401, 6681, 3200, 1959, 1506, 1166, 942, 741, 610, 496, 442, 398, 368,
    340, 320, 306, 294, 284, 278, 274, 276, 281, 290, 300, 314, 329, 348, 368, 390, 413, 446, 480, 518, 555,
    586, 616, 650, 683, 710,
];

/// Hemoglobin without oxygen, of the same source.
#[rustfmt::skip]
const HEMOGLOBIN: [u32; 81] = [
    145_232, 151_288, 167_780, 196_832, 223_296, 261_958, 303_956, 353_222, 407_560, 471_520, 528_600, 549_600,
    413_280, 259_974, 103_292, 33_434, 23_389, 18_702, 16_156, 14_921, 14_550, 15_378, 16_684, 18_648, 20_862,
    23_289, 25_774, 28_682, 31_590, 35_171, 39_036, 42_840, 46_592, 50_488, 53_412, 54_530, 53_788, 49_700,
    45_072, 40_904, 37_020, 33_592, 28_324, 21_187, 14_677, 12_040, 9444, 7553, 6510, 5763, 5149, 4667, 4345,
    4027, 3750, 3481, 3227, 3011, 2795, 2591, 2408, 2225, 2052, 1923, 1794, 1661, 1540, 1433, 1326, 1224, 1102,
    1102, 1116, 1237, 1405, 1551, 1549, 1435, 1312, 1188, 1075,
];

/// Bilirubin in chloroform from 380 nm by 10 nm, means over 10 nm \[cm⁻¹ M⁻¹\]: J. Li 1997, scaled to 55,000 at 450.8 nm
/// (G. Agati and F. Fusi 1990), PhotochemCAD, omlc.org/spectra/PhotochemCAD.
#[rustfmt::skip]
const BILIRUBIN: [u32; 19] = [
    11_640, 16_488, 23_197, 30_862, 39_256, 46_766, 51_913, 54_511, 53_581, 45_687, 29_828, 14_411, 5017, 1382,
    364, 134, 73, 58, 0,
];

/// β-carotene in hexane from 380 nm by 10 nm, means over 10 nm \[cm⁻¹ M⁻¹\]: R. A. Fuh 1995, scaled to 139,500 at 451 nm
/// (L. Zechmeister and A. Polgar 1943), PhotochemCAD, omlc.org/spectra/PhotochemCAD.
#[rustfmt::skip]
const CAROTENE: [u32; 19] = [
    30_418, 42_625, 59_165, 73_661, 96_076, 107_893, 121_240, 136_507, 121_201, 109_297, 107_945, 75_436,
    33_694, 11_090, 3712, 1716, 1059, 858, 0,
];

/// Fat from 430 nm by 10 nm \[km⁻¹\]: R. L. P. van Veen et al. 2005, *Determination of visible near-IR absorption coefficients
/// of mammalian fat using time- and spatially resolved diffuse reflectance and transmission spectroscopy*.
#[rustfmt::skip]
const FAT: [u32; 36] = [
    8216, 7383, 6375, 5523, 4327, 3315, 2515, 1906, 1501, 1231, 1031, 896, 773, 698, 629, 566, 502, 466, 464,
    430, 428, 452, 471, 418, 450, 406, 342, 323, 315, 367, 499, 654, 972, 1278, 871, 409,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absorption_has_published_values() {
        // Prahl's page: 2.303 e (150 g/L)/(64,500 g/mol), with e at 540, 560 and 650 nm
        for (wavelength, oxygenation, extinction) in
            [(540.0, 1.0, 53_236.0), (560.0, 0.0, 53_788.0), (650.0, 1.0, 368.0), (650.0, 0.0, 3750.12)]
        {
            let expected = 0.2303 * extinction * 150.0 / 64_500.0;
            assert!((blood(wavelength, oxygenation) / expected - 1.0).abs() < 3e-4);
        }
        // Another source for whole blood [1/mm]: N. Bosschaart et al. 2014, appendix
        for (wavelength, oxygenation, expected) in [
            (500.0, 1.0, 11.05),
            (540.0, 1.0, 27.13),
            (560.0, 1.0, 19.12),
            (576.0, 1.0, 27.2),
            (500.0, 0.0, 9.5),
            (540.0, 0.0, 22.13),
            (560.0, 0.0, 26.56),
            (650.0, 0.0, 1.8),
        ] {
            let found = blood(wavelength, oxygenation);
            assert!((found / expected - 1.0).abs() < 0.18, "{wavelength} nm: {found} for {expected}");
        }
        // S. L. Jacques 1998: some 230 cm⁻¹ at 694 nm
        assert!((eumelanin(694.0) / 23.0 - 1.0).abs() < 0.03);
        // T. Sarna and H. M. Swartz 2006, figure 16.3: pheomelanin absorbs 0.827 and 0.625 of the same mass of eumelanin
        for (wavelength, expected) in [(400.0, 0.827), (500.0, 0.625)] {
            assert!((pheomelanin(wavelength) / eumelanin(wavelength) / expected - 1.0).abs() < 0.08);
        }
        assert!((bilirubin(450.0, 585.0) / (0.1 * LN_10 * 54_511.0) - 1.0).abs() < 1e-12);
        assert_eq!((bilirubin(700.0, 1.0), carotene(560.0, 1.0), fat(380.0)), (0.0, 0.0, fat(430.0)));
    }

    #[test]
    fn scattering_follows_the_measurements_it_was_fitted_to() {
        // E. Salomatina et al. 2006, figures 3 and 4 [1/cm]
        for (wavelength, epidermis, dermis) in [
            (450.0, 86.2, 58.6),
            (500.0, 70.6, 46.1),
            (550.0, 58.4, 37.4),
            (600.0, 51.4, 32.2),
            (650.0, 46.2, 28.8),
            (700.0, 42.7, 26.4),
        ] {
            for (law, measured) in [(Scattering::EPIDERMIS, epidermis), (Scattering::DERMIS, dermis)] {
                assert!((10.0 * law.reduced(wavelength) / measured - 1.0).abs() < 0.08);
            }
        }
    }
}
