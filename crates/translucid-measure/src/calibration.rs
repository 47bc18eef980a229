//! Radiometric calibration: factors that make light a reflectance, from something white in the photograph or in another one.

use crate::clipping::check_clipping;
use crate::error::MeasureError;
use crate::linear_photo::{NamedPhoto, Photo};
use crate::options::Options;
use crate::remark::{CHANNELS, Remark};
use crate::spot_place::SpotPlace;

/// Factors that make values of a photograph those that a fit takes.
pub(crate) enum Calibration {
    /// Factors of all pixels, and the relative standard error of the white's mean that they hold.
    Even([f64; 3], [f64; 3]),
    /// A photograph of something white to divide by, times its reflectance.
    Flat(Photo, [f64; 3]),
    /// Factors, and the relative standard error of the power that they hold.
    Power([f64; 3], [f64; 3]),
}

/// Parts of a white card in a row and in a column, whose differences show the noise of its mean.
const PARTS: usize = 4;

impl Calibration {
    /// The factors by a white card in the photograph; none where there is none.
    pub(crate) fn by_card(photo: &NamedPhoto, options: &Options) -> Result<Self, MeasureError> {
        let reflectances = options.white_reflectances()?;
        let Some(white) = options.white else { return Ok(Self::Even([1.0; 3], [0.0; 3])) };
        let card = photo.part("white", white)?;
        let gains = gains(reflectances, card.mean(), &photo.name, "white")?;
        Ok(Self::Even(gains, mean_error(&card)))
    }

    /// The factors by a photograph of white paper, those of a spot by the power of its light.
    pub(crate) fn by_photo(
        white: &NamedPhoto,
        dark: Option<&Photo>,
        place: Option<SpotPlace>,
        options: &Options,
        say: &mut dyn FnMut(Remark),
    ) -> Result<Self, MeasureError> {
        let reflectances = options.white_reflectances()?;
        let NamedPhoto { name, photo } = white;
        check_clipping(photo, name, say)?;
        let mut photo = photo.clone();
        if let Some(dark) = dark {
            photo.subtract(dark);
        }
        let Some(place) = place else {
            gains(reflectances, photo.mean(), name, "white_photo")?;
            return Ok(Self::Flat(photo, reflectances));
        };
        if photo.clipped() > 0.0 {
            let message = "light is lost in it, and with it the power of the spot is unknown";
            return Err(MeasureError::of_photo(name, message).with_help("expose less, the photograph, too"));
        }
        let powers = place.power(&photo);
        let gains = gains(reflectances, powers.map(|(power, _)| power), name, "white_photo")?;
        let area = options.pixel_width()?.powi(2);
        Ok(Self::Power(gains.map(|gain: f64| gain / area), powers.map(|(power, error)| error / power)))
    }

    /// Makes values reflectances where something white is seen; of a spot, shares of its power per area \[mm⁻²\].
    pub(crate) fn apply(&self, photo: &mut Photo) {
        let scaled = |value: f32, gain: f64| (f64::from(value) * gain) as f32;
        for (i, pixel) in photo.pixels.iter_mut().enumerate() {
            for (c, value) in pixel.iter_mut().enumerate() {
                *value = match self {
                    Self::Even(gains, _) | Self::Power(gains, _) => scaled(*value, gains[c]),
                    Self::Flat(white, reflectances) => {
                        let light = f64::from(white.pixels[i][c]);
                        // Where no light falls there is none to measure
                        if light > 0.0 { scaled(*value, reflectances[c] / light) } else { 0.0 }
                    }
                };
            }
        }
    }

    /// Relative standard errors of the factors.
    pub(crate) fn errors(&self) -> [f64; 3] {
        match self {
            Self::Even(_, errors) | Self::Power(_, errors) => *errors,
            // It is in the differences of blocks
            Self::Flat(..) => [0.0; 3],
        }
    }
}

/// Relative standard error of a mean of pixels that may depend on their neighbors, by the means of parts.
fn mean_error(card: &Photo) -> [f64; 3] {
    let part = |i: usize, n: usize| [i * n / PARTS, ((i + 1) * n / PARTS).max(i * n / PARTS + 1)];
    let parts: Vec<[f64; 3]> = (0..PARTS * PARTS)
        .map(|i| (part(i % PARTS, card.width), part(i / PARTS, card.height)))
        .map(|([x0, x1], [y0, y1])| card.part([x0, y0, x1, y1]).mean())
        .collect();
    let (mean, count) = (card.mean(), parts.len() as f64);
    std::array::from_fn(|c| {
        let square: f64 = parts.iter().map(|part| (part[c] - mean[c]).powi(2)).sum();
        (square / (count - 1.0) / count).sqrt() / mean[c]
    })
}

/// Reflectances over the light of what has them; refuses a channel without light.
fn gains(
    reflectances: [f64; 3],
    light: [f64; 3],
    name: &str,
    option: &str,
) -> Result<[f64; 3], MeasureError> {
    match (0..3).find(|&c| light[c] <= 0.0) {
        Some(c) => {
            let message = format!("`{option}`: {} is {} there", CHANNELS[c], light[c]);
            Err(MeasureError::of_photo(name, message))
        }
        None => Ok(std::array::from_fn(|c| reflectances[c] / light[c])),
    }
}
