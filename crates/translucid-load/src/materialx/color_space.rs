//! Color spaces of constants, by the names of MaterialX: to linear Rec. 709.

use glam::{DVec3, Vec3};

use translucid_scene::description::linear_from_srgb;

use crate::primaries::{ADOBE_RGB, AP1, DISPLAY_P3, Primaries, REC_709};

/// Curve between a channel's code and its light.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve {
    Linear,
    Srgb,
    Power(f64),
}

/// A color space.
#[derive(Clone, Copy, Debug)]
pub(super) struct NamedSpace {
    name: &'static str,
    primaries: Primaries,
    curve: Curve,
}

const fn space(name: &'static str, primaries: Primaries, curve: Curve) -> NamedSpace {
    NamedSpace { name, primaries, curve }
}

/// The spaces that MaterialX names; "none" is no management: numbers are taken as they are.
const SPACES: [NamedSpace; 15] = [
    space("none", REC_709, Curve::Linear),
    space("lin_rec709", REC_709, Curve::Linear),
    space("lin_srgb", REC_709, Curve::Linear),
    space("srgb_texture", REC_709, Curve::Srgb),
    space("g22_rec709", REC_709, Curve::Power(2.2)),
    space("g18_rec709", REC_709, Curve::Power(1.8)),
    space("rec709_display", REC_709, Curve::Power(2.4)),
    space("acescg", AP1, Curve::Linear),
    space("lin_ap1", AP1, Curve::Linear),
    space("g22_ap1", AP1, Curve::Power(2.2)),
    space("g18_ap1", AP1, Curve::Power(1.8)),
    space("lin_adobergb", ADOBE_RGB, Curve::Linear),
    space("adobergb", ADOBE_RGB, Curve::Power(563.0 / 256.0)),
    space("lin_displayp3", DISPLAY_P3, Curve::Linear),
    space("srgb_displayp3", DISPLAY_P3, Curve::Srgb),
];

/// Names of other versions and of NanoColor, as `DefaultColorManagementSystem` of MaterialX 1.39.5 takes them.
const OTHER_NAMES: [(&str, &str); 13] = [
    ("gamma18", "g18_rec709"),
    ("gamma22", "g22_rec709"),
    ("gamma24", "rec709_display"),
    ("lin_ap1_scene", "acescg"),
    ("lin_rec709_scene", "lin_rec709"),
    ("lin_p3d65_scene", "lin_displayp3"),
    ("lin_adobergb_scene", "lin_adobergb"),
    ("srgb_rec709_scene", "srgb_texture"),
    ("g22_rec709_scene", "g22_rec709"),
    ("g18_rec709_scene", "g18_rec709"),
    ("g22_ap1_scene", "g22_ap1"),
    ("srgb_p3d65_scene", "srgb_displayp3"),
    ("g22_adobergb_scene", "adobergb"),
];

impl NamedSpace {
    pub(super) fn named(name: &str) -> Option<Self> {
        let name = OTHER_NAMES.iter().find(|(other, _)| *other == name).map_or(name, |(_, name)| *name);
        SPACES.into_iter().find(|space| space.name == name)
    }

    /// Whether an image in it needs the sRGB curve and nothing else, or nothing at all; none if it needs more.
    pub(super) fn of_images(&self) -> Option<bool> {
        match self.curve {
            _ if self.primaries != REC_709 => None,
            Curve::Linear => Some(false),
            Curve::Srgb => Some(true),
            Curve::Power(_) => None,
        }
    }

    /// A color of the space in linear Rec. 709; channels beyond that gamut are negative or above 1.
    pub(super) fn to_rec_709(self, color: Vec3) -> Vec3 {
        let linear = |code: f32| match self.curve {
            Curve::Linear => f64::from(code),
            Curve::Srgb => linear_from_srgb(f64::from(code)),
            Curve::Power(exponent) => libm::pow(f64::from(code).max(0.0), exponent),
        };
        if self.primaries == REC_709 {
            return Vec3::from_array(color.to_array().map(|code| linear(code) as f32));
        }
        let linear = DVec3::from_array(color.to_array().map(linear));
        (self.primaries.to_rec_709() * linear).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to_rec_709(name: &str, color: [f32; 3]) -> Vec3 {
        NamedSpace::named(name).unwrap().to_rec_709(color.into())
    }

    #[test]
    fn white_and_gray_stay_what_they_are_in_linear_spaces() {
        for space in SPACES.iter().filter(|space| space.curve == Curve::Linear) {
            for gray in [1.0, 0.18, 0.0] {
                let found = space.to_rec_709(Vec3::splat(gray));
                assert!(found.abs_diff_eq(Vec3::splat(gray), 1e-6), "{}: {found}", space.name);
            }
        }
    }

    /// The columns of the matrices of MaterialX 1.39, cmlib_ng.mtlx; that of ACEScg has six equal digits because it was made
    /// with another adaptation.
    #[test]
    fn primaries_become_those_of_materialx() {
        for (name, red, tolerance) in [
            ("acescg", [1.705_051, -0.130_256, -0.024_003], 2e-4),
            ("lin_adobergb", [1.398_356, 0.0, 0.0], 1e-4),
            ("lin_displayp3", [1.224_930, -0.042_059, -0.019_641], 1e-4),
        ] {
            let found = to_rec_709(name, [1.0, 0.0, 0.0]);
            assert!(found.abs_diff_eq(red.into(), tolerance), "{name}: {found}");
        }
    }

    #[test]
    fn curves_are_those_of_their_names() {
        assert!((to_rec_709("srgb_texture", [188.0 / 255.0; 3]).x - 0.502_886).abs() < 1e-6);
        assert!((to_rec_709("g22_rec709", [0.5; 3]).y - 0.217_638).abs() < 1e-6);
        assert!((to_rec_709("adobergb", [0.5; 3]).z - 0.5_f32.powf(2.199_218_8)).abs() < 1e-6);
        assert!(NamedSpace::named("sRGB").is_none());
    }

    #[test]
    fn names_of_nanocolor_are_those_of_their_spaces() {
        let color = [0.2, 0.8, 0.2];
        let expected = Vec3::new(0.033_105, 0.603_827, 0.033_105);
        assert!(to_rec_709("srgb_rec709_scene", color).abs_diff_eq(expected, 1e-5));
        for (other, name) in OTHER_NAMES {
            assert_eq!(to_rec_709(other, color), to_rec_709(name, color), "{other}");
        }
    }
}
