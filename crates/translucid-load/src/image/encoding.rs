//! How a picture's numbers stand for light: curves and primaries, and the way from them to linear Rec. 709.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use translucid_scene::linear_from_srgb;

use crate::primaries::Primaries;

/// Relation of a channel's code, 0 to 1, to its light.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Curve {
    Linear,
    Srgb,
    /// A power of the code.
    Power(f64),
    /// ITU-R BT.709, section 1.2, from the camera's side.
    Rec709,
    /// Light at equal steps of the code.
    Table(Vec<f32>),
    /// g, a, b, c, d, e, f of (a x + b)ᵍ + e from x = d on, c x + f below (ICC.1:2022, section 10.18).
    Parametric([f64; 7]),
}

impl Curve {
    /// The light of a code; beyond [0, 1] linear and power curves go on, with the sign of the code.
    fn light(&self, code: f32) -> f32 {
        let x = f64::from(code);
        match self {
            Self::Linear => code,
            Self::Srgb => linear_from_srgb(code.abs()).copysign(code),
            Self::Power(exponent) => libm::pow(x.abs(), *exponent).copysign(x) as f32,
            Self::Rec709 if x < 0.081 => (x / 4.5) as f32,
            Self::Rec709 => libm::pow((x + 0.099) / 1.099, 1.0 / 0.45) as f32,
            Self::Table(table) => {
                let last = table.len() - 1;
                let position = code.clamp(0.0, 1.0) * last as f32;
                let first = (position as usize).min(last.saturating_sub(1));
                let second = (first + 1).min(last);
                table[first] + (position - first as f32) * (table[second] - table[first])
            }
            &Self::Parametric([g, a, b, _, d, e, _]) if x >= d => {
                (libm::pow((a * x + b).max(0.0), g) + e) as f32
            }
            Self::Parametric([_, _, _, c, _, _, f]) => (c * x + f) as f32,
        }
    }

    /// Whether it is another up to half a level of a byte.
    fn is_near(&self, other: &Self) -> bool {
        (0..=255_u8).map(|byte| f32::from(byte) / 255.0).all(|code| {
            let [own, other] = [self, other].map(|curve| curve.light(code));
            (own - other).abs() <= 1e-4 + 5e-3 * other.abs()
        })
    }
}

/// Numbers as a file has them: red, green, blue, alpha in rows from top to bottom.
pub(super) enum Samples {
    Byte(Vec<[u8; 4]>),
    Short(Vec<[u16; 4]>),
    /// Linear, unless the file states a curve.
    Float(Vec<[f32; 4]>),
}

/// The curves and primaries of a file's numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Encoding {
    /// Name of the encoding in messages.
    pub(super) name: String,
    pub(super) curves: [Curve; 3],
    /// From linear channels to linear Rec. 709.
    pub(super) to_rec_709: DMat3,
}

impl Encoding {
    pub(super) fn new(name: impl Into<String>, curve: Curve, primaries: Primaries) -> Self {
        let curves = [curve.clone(), curve.clone(), curve];
        Self { name: name.into(), curves, to_rec_709: primaries.to_rec_709() }
    }

    /// Replaces the curve of every channel and keeps the primaries.
    pub(super) fn with_curve(self, curve: &Curve) -> Self {
        Self { curves: [(); 3].map(|()| curve.clone()), ..self }
    }

    /// Whether all channels have this curve, as far as a picture of bytes shows it.
    pub(super) fn has_curve(&self, curve: &Curve) -> bool {
        self.curves.iter().all(|own| own.is_near(curve))
    }

    /// Whether its primaries are those of Rec. 709, as profiles round them.
    pub(super) fn is_rec_709(&self) -> bool {
        self.to_rec_709.abs_diff_eq(DMat3::IDENTITY, 3e-3)
    }

    /// Linear Rec. 709; channels beyond that gamut are negative or above 1.
    pub(super) fn decode(&self, samples: &Samples) -> Vec<[f32; 4]> {
        match samples {
            Samples::Byte(pixels) => self.decode_codes(pixels, u8::MAX.into()),
            Samples::Short(pixels) => self.decode_codes(pixels, u16::MAX),
            Samples::Float(pixels) => {
                let mixing = self.mixing();
                let light = |&[r, g, b, alpha]: &[f32; 4]| {
                    let codes = [r, g, b];
                    mixed(mixing, std::array::from_fn(|c| self.curves[c].light(codes[c])), alpha)
                };
                pixels.par_iter().map(light).collect()
            }
        }
    }

    /// Decodes by a table: a photograph has a thousand times as many samples as there are codes.
    fn decode_codes<T: Copy + Into<u16> + Sync>(&self, pixels: &[[T; 4]], greatest: u16) -> Vec<[f32; 4]> {
        let part = |code: u16| f32::from(code) / f32::from(greatest);
        let table: Vec<[f32; 3]> = (0..=greatest)
            .into_par_iter()
            .map(|code| std::array::from_fn(|c| self.curves[c].light(part(code))))
            .collect();
        let mixing = self.mixing();
        let decoded = |pixel: &[T; 4]| {
            let [r, g, b, alpha] = pixel.map(Into::<u16>::into);
            let light = |code: u16, channel: usize| table[usize::from(code)][channel];
            mixed(mixing, [light(r, 0), light(g, 1), light(b, 2)], part(alpha))
        };
        pixels.par_iter().map(decoded).collect()
    }

    /// The matrix to linear Rec. 709, unless the channels are that.
    fn mixing(&self) -> Option<DMat3> {
        (!self.is_rec_709()).then_some(self.to_rec_709)
    }
}

/// A pixel whose light is mixed by a matrix, if there is one.
fn mixed(mixing: Option<DMat3>, light: [f32; 3], alpha: f32) -> [f32; 4] {
    let mixed = |matrix: DMat3| (matrix * DVec3::from(light.map(f64::from))).as_vec3().to_array();
    let [r, g, b] = mixing.map_or(light, mixed);
    [r, g, b, alpha]
}
