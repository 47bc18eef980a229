//! Primaries of color spaces, and the way from them to linear Rec. 709.

use glam::{DMat3, DVec3};

/// Chromaticities x, y of red, green, blue and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Primaries(pub(crate) [[f64; 2]; 4]);

const D65: [f64; 2] = [0.3127, 0.329];
/// The white of ACES, near D60.
const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];
/// X, Y, Z of the white of ICC profiles (ICC.1:2022, section 7.2.16).
const D50: DVec3 = DVec3::new(0.9642, 1.0, 0.8249);

/// ITU-R BT.709.
pub(crate) const REC_709: Primaries = Primaries([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], D65]);
/// ITU-R BT.2020.
pub(crate) const REC_2020: Primaries = Primaries([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], D65]);
/// SMPTE EG 432-1, with D65.
pub(crate) const DISPLAY_P3: Primaries = Primaries([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], D65]);
/// Adobe RGB (1998).
pub(crate) const ADOBE_RGB: Primaries = Primaries([[0.64, 0.33], [0.21, 0.71], [0.15, 0.06], D65]);
/// AP0 of ACES (SMPTE ST 2065-1).
pub(crate) const AP0: Primaries = Primaries([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], ACES_WHITE]);
/// AP1 of ACES (S-2014-004).
pub(crate) const AP1: Primaries = Primaries([[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], ACES_WHITE]);

impl Primaries {
    /// Matrix from linear channels to linear Rec. 709, whose white is that of these primaries.
    pub(crate) fn to_rec_709(self) -> DMat3 {
        REC_709.to_xyz().inverse() * adaptation(xyz(self.0[3]), xyz(D65)) * self.to_xyz()
    }

    /// As [`to_rec_709`](Self::to_rec_709) with the white as it is.
    pub(crate) fn to_rec_709_unadapted(self) -> DMat3 {
        REC_709.to_xyz().inverse() * self.to_xyz()
    }

    /// Matrix from linear channels to X, Y, Z (SMPTE RP 177).
    fn to_xyz(self) -> DMat3 {
        let [red, green, blue, white] = self.0.map(ray);
        let primaries = DMat3::from_cols(red, green, blue);
        primaries * DMat3::from_diagonal(primaries.inverse() * (white / white.y))
    }
}

/// Matrix from X, Y, Z under D50, as ICC profiles have them, to linear Rec. 709.
pub(crate) fn rec_709_from_d50() -> DMat3 {
    REC_709.to_xyz().inverse() * adaptation(D50, xyz(D65))
}

/// X, Y, Z of X + Y + Z = 1.
fn ray([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x, y, 1.0 - x - y)
}

/// X, Y, Z of a white at Y = 1.
fn xyz(white: [f64; 2]) -> DVec3 {
    ray(white) / white[1]
}

/// Chromatic adaptation of X, Y, Z from one white to another, after Bradford (K. M. Lam 1985).
fn adaptation(from: DVec3, to: DVec3) -> DMat3 {
    let cones = DMat3::from_cols(
        DVec3::new(0.8951, -0.7502, 0.0389),
        DVec3::new(0.2664, 1.7135, -0.0685),
        DVec3::new(-0.1614, 0.0367, 1.0296),
    );
    cones.inverse() * DMat3::from_diagonal((cones * to) / (cones * from)) * cones
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_of_any_primaries_is_white() {
        for primaries in [REC_709, REC_2020, DISPLAY_P3, ADOBE_RGB, AP0, AP1] {
            let white = primaries.to_rec_709() * DVec3::ONE;
            assert!(white.abs_diff_eq(DVec3::ONE, 1e-12), "{primaries:?}: {white}");
        }
        assert!((rec_709_from_d50() * D50).abs_diff_eq(DVec3::ONE, 1e-12));
    }

    /// The matrices of conversions, which have no vectors at hand, are these.
    #[test]
    fn matrices_of_conversions_are_the_same() {
        let [acescg, p3] = [("acescg", AP1), ("lin_displayp3", DISPLAY_P3)].map(|(name, primaries)| {
            let rows = translucid_profile::convention::rgb_from_rgb(name, "lin_rec709").unwrap();
            let twin = DMat3::from_cols_array_2d(&rows).transpose();
            (twin, primaries.to_rec_709())
        });
        let rows = translucid_profile::convention::rgb_from_rgb("lin_rec2020", "lin_adobergb").unwrap();
        let wide = ADOBE_RGB.to_rec_709().inverse() * REC_2020.to_rec_709();
        for (twin, matrix) in [acescg, p3, (DMat3::from_cols_array_2d(&rows).transpose(), wide)] {
            assert!(twin.abs_diff_eq(matrix, 1e-12), "{twin} {matrix}");
        }
    }

    #[test]
    fn green_of_acescg_is_outside_of_rec_709() {
        // colour 0.4, RGB_to_RGB of ACEScg and ITU-R BT.709 with Bradford
        let color = AP1.to_rec_709() * DVec3::new(0.2, 0.8, 0.2);
        assert!(color.abs_diff_eq(DVec3::new(-0.1731, 0.8845, 0.1226), 2e-4), "{color}");
    }
}
