//! ICC profiles of pictures (ICC.1:2022).

use std::sync::Arc;

use moxcms::{
    ColorProfile, DataColorSpace, Layout, ParametricCurve, ProfileText, RenderingIntent, ToneReprCurve,
    TransformExecutor, TransformOptions,
};

use super::encoding::{Curve, Encoding, Samples};
use crate::primaries::rec_709_from_d50;

/// Most characters of a profile's name in a message.
const MOST_NAMED: usize = 60;

/// A profile as this reader can use it.
pub(super) enum Profile {
    /// Curves and primaries.
    Matrix(Encoding),
    /// Tables of many colors, as profiles of scanners have them.
    Tables(Tables),
}

/// The way of colors through the tables of a profile to a wide space, and on from there.
pub(super) struct Tables {
    pub(super) name: String,
    transform: Arc<dyn TransformExecutor<f32> + Send + Sync>,
    wide: Encoding,
}

impl Profile {
    /// Parses a profile for a picture of gray or of red, green, blue.
    ///
    /// # Errors
    /// It is damaged, for other colors, or of a kind that is not read; the text goes on after "its ICC profile".
    pub(super) fn parse(bytes: &[u8], is_gray: bool) -> Result<Self, String> {
        let profile = ColorProfile::new_from_slice(bytes).map_err(|error| format!("is damaged ({error})"))?;
        let name = name(&profile);
        match (profile.color_space, &profile.gray_trc) {
            (DataColorSpace::Gray, Some(curve)) if is_gray => {
                let curve = self::curve(curve)?;
                let curves = [(); 3].map(|()| curve.clone());
                return Ok(Self::Matrix(Encoding { name, curves, to_rec_709: glam::DMat3::IDENTITY }));
            }
            (DataColorSpace::Rgb, _) => {}
            (other, _) => return Err(format!("\"{name}\" is for colors of the kind {other:?}")),
        }
        // Where a profile has tables they count, not its curves (ICC.1:2022, section 8.10.2)
        let has_tables = profile.lut_a_to_b_colorimetric.is_some() || profile.lut_a_to_b_perceptual.is_some();
        if has_tables {
            return Tables::new(name, &profile).map(Self::Tables);
        }
        encoding(name, &profile).map(Self::Matrix)
    }
}

impl Tables {
    fn new(name: String, profile: &ColorProfile) -> Result<Self, String> {
        let wide = ColorProfile::new_pro_photo_rgb();
        let options = TransformOptions {
            rendering_intent: RenderingIntent::RelativeColorimetric,
            ..Default::default()
        };
        let transform = profile
            .create_transform_f32(Layout::Rgba, &wide, Layout::Rgba, options)
            .map_err(|error| format!("\"{name}\" has tables that cannot be used ({error})"))?;
        Ok(Self { wide: encoding(name.clone(), &wide)?, name, transform })
    }

    /// Linear Rec. 709.
    pub(super) fn decode(&self, samples: &Samples) -> Result<Vec<[f32; 4]>, String> {
        let codes: Vec<[f32; 4]> = match samples {
            Samples::Byte(pixels) => pixels.iter().map(|p| p.map(|code| f32::from(code) / 255.0)).collect(),
            Samples::Short(pixels) => {
                pixels.iter().map(|p| p.map(|code| f32::from(code) / 65535.0)).collect()
            }
            Samples::Float(pixels) => pixels.clone(),
        };
        let mut wide = vec![[0.0; 4]; codes.len()];
        self.transform
            .transform(codes.as_flattened(), wide.as_flattened_mut())
            .map_err(|error| format!("\"{}\" has tables that cannot be used ({error})", self.name))?;
        for (wide, code) in wide.iter_mut().zip(&codes) {
            wide[3] = code[3];
        }
        Ok(self.wide.decode(&Samples::Float(wide)))
    }
}

/// Curves and primaries of a profile that has them.
fn encoding(name: String, profile: &ColorProfile) -> Result<Encoding, String> {
    let trc = |curve: &Option<ToneReprCurve>| match curve {
        Some(curve) if profile.is_matrix_shaper() => self::curve(curve),
        _ => Err(format!("\"{name}\" has neither curves and primaries nor tables")),
    };
    let curves = [trc(&profile.red_trc)?, trc(&profile.green_trc)?, trc(&profile.blue_trc)?];
    let columns = [profile.red_colorant, profile.green_colorant, profile.blue_colorant];
    let [red, green, blue] = columns.map(|color| glam::DVec3::new(color.x, color.y, color.z));
    let to_rec_709 = rec_709_from_d50() * glam::DMat3::from_cols(red, green, blue);
    Ok(Encoding { name, curves, to_rec_709 })
}

fn curve(curve: &ToneReprCurve) -> Result<Curve, String> {
    Ok(match curve {
        ToneReprCurve::Lut(table) => match table[..] {
            [] | [256] => Curve::Linear,
            [exponent] => Curve::Power(f64::from(exponent) / 256.0),
            _ => Curve::Table(table.iter().map(|&light| f32::from(light) / 65535.0).collect()),
        },
        ToneReprCurve::Parametric(numbers) => {
            let curve = Some(numbers).filter(|numbers| !numbers.is_empty());
            let curve = curve.and_then(|numbers| ParametricCurve::new(numbers));
            let ParametricCurve { g, a, b, c, d, e, f } = curve.ok_or("has a curve of an unknown kind")?;
            match [g, a, b, c, d, e, f].map(f64::from) {
                [1.0, 1.0, 0.0, _, _, 0.0, _] => Curve::Linear,
                numbers if numbers.iter().all(|number| number.is_finite()) => Curve::Parametric(numbers),
                _ => return Err("has a curve that is not finite".into()),
            }
        }
    })
}

/// The description of a profile.
fn name(profile: &ColorProfile) -> String {
    let text = match &profile.description {
        Some(ProfileText::PlainString(text)) => text.as_str(),
        Some(ProfileText::Localizable(texts)) => texts.first().map_or("", |text| text.value.as_str()),
        Some(ProfileText::Description(text)) => text.ascii_string.as_str(),
        None => "",
    };
    let text: String = text.chars().filter(|c| !c.is_control()).take(MOST_NAMED).collect();
    if text.trim().is_empty() { String::from("without a name") } else { text.trim().to_owned() }
}
