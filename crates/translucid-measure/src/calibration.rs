//! Radiometric calibration: factors that make light a reflectance, from something white in the photograph or in another one.

use crate::clipping::check_clipping;
use crate::error::MeasureError;
use crate::fit::{Fit, Interval};
use crate::linear_photo::{NamedPhoto, Photo};
use crate::options::Options;
use crate::remark::{CHANNELS, Remark};
use crate::spot_place::SpotPlace;

/// Factors that make values of a photograph those that a fit takes.
pub(crate) enum Calibration {
    /// Factors of all pixels.
    Even([f64; 3]),
    /// A photograph of something white to divide by, times its reflectance.
    Flat(Photo, [f64; 3]),
    /// Factors, and the relative standard error of the power that they hold.
    Power([f64; 3], [f64; 3]),
}

/// Quantiles of the normal distribution that intervals of 68 % and of 95 % end at.
const LIKELY: f64 = 0.994_457_883;
const SURE: f64 = 1.959_963_985;

impl Calibration {
    /// The factors by a white card in the photograph; none where there is none.
    pub(crate) fn by_card(photo: &NamedPhoto, options: &Options) -> Result<Self, MeasureError> {
        let reflectances = options.white_reflectances()?;
        let Some(white) = options.white else { return Ok(Self::Even([1.0; 3])) };
        gains(reflectances, photo.part("white", white)?.mean(), &photo.name, "white").map(Self::Even)
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
                    Self::Even(gains) | Self::Power(gains, _) => scaled(*value, gains[c]),
                    Self::Flat(white, reflectances) => {
                        let light = f64::from(white.pixels[i][c]);
                        // Where no light falls there is none to measure
                        if light > 0.0 { scaled(*value, reflectances[c] / light) } else { 0.0 }
                    }
                };
            }
        }
    }

    /// Lets intervals of surface albedos hold the error of the power.
    pub(crate) fn widen(&self, fit: &mut Fit) {
        let Self::Power(_, errors) = self else { return };
        for (channel, error) in fit.channels.iter_mut().zip(errors) {
            if let Some(Interval { value, likely, sure }) = &mut channel.surface_albedo {
                for (interval, normal) in [(likely, LIKELY), (sure, SURE)] {
                    let [down, up] = [*value - interval[0], interval[1] - *value];
                    let more = *value * error * normal;
                    *interval = [*value - down.hypot(more), *value + up.hypot(more)];
                }
            }
        }
    }
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
