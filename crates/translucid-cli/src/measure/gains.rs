//! Factors that make light a reflectance, from something white in the photograph or in another one.

use std::path::Path;

use translucid_measure::{Fit, Interval, Photo, SpotPlace};

use super::arguments::{MeasureArguments, SetupName, three};
use super::photograph::{check_clipping, load, part, refusal, subtract};
use super::report::CHANNELS;
use crate::failure::Failure;

/// Reflectance of white paper.
const PAPER: f64 = 0.9;

/// Factors that make values of a photograph those that a fit takes.
pub(super) enum Gains {
    /// Factors of all pixels.
    Even([f64; 3]),
    /// A photograph of something white to divide by, times its reflectance.
    Flat(Photo, [f64; 3]),
    /// Factors, and the relative standard error of the power that they hold.
    Power([f64; 3], [f64; 3]),
}

impl Gains {
    /// Makes values reflectances where something white is seen; of a spot, shares of its power per area \[mm⁻²\].
    pub(super) fn apply(&self, photo: &mut Photo) {
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
    pub(super) fn widen(&self, fit: &mut Fit) {
        let Self::Power(_, errors) = self else { return };
        for (channel, error) in fit.channels.iter_mut().zip(errors) {
            if let Some(Interval { value, likely, sure }) = &mut channel.surface_albedo {
                for (interval, normal) in [(likely, 0.994_457_883), (sure, 1.959_963_985)] {
                    let [down, up] = [*value - interval[0], interval[1] - *value];
                    let more = *value * error * normal;
                    *interval = [*value - down.hypot(more), *value + up.hypot(more)];
                }
            }
        }
    }
}

/// Finds the factors by white paper in the photograph or in another one; a spot's by the power of the light.
pub(super) fn gains(
    photo: &Photo,
    place: Option<SpotPlace>,
    dark: Option<&Photo>,
    arguments: &MeasureArguments,
) -> Result<Gains, Failure> {
    let path = &arguments.photo;
    let reflectances = match (arguments.white_reflectance.as_slice(), arguments.setup) {
        ([], SetupName::Slab) => [1.0; 3],
        ([], _) => [PAPER; 3],
        (given, _) => three("--white-reflectance", given, 1.0)?,
    };
    let ratio = |of: [f64; 3], path: &Path, option: &str| match (0..3).find(|&c| of[c] <= 0.0) {
        Some(c) => Err(refusal(path, format!("{option}: {} is {} there", CHANNELS[c], of[c]))),
        None => Ok(std::array::from_fn(|c| reflectances[c] / of[c])),
    };
    if let Some(white) = arguments.white {
        return ratio(part(photo, path, "--white", white)?.mean(), path, "--white").map(Gains::Even);
    }
    let Some(white_path) = &arguments.white_photo else { return Ok(Gains::Even([1.0; 3])) };
    let mut white = load(white_path, arguments)?;
    if [white.width, white.height] != [photo.width, photo.height] {
        let message = format!(
            "is {}×{} pixels, but the photograph is {}×{}",
            white.width, white.height, photo.width, photo.height
        );
        return Err(refusal(white_path, message));
    }
    check_clipping(&white, white_path)?;
    if let Some(dark) = dark {
        subtract(&mut white, dark).map_err(|message| refusal(white_path, message))?;
    }
    if place.is_some() && white.clipped() > 0.0 {
        let message = "light is lost in it, and with it the power of the spot is unknown";
        return Err(refusal(white_path, message).with_help("expose less, the photograph, too"));
    }
    let Some(place) = place else {
        ratio(white.mean(), white_path, "--white-photo")?;
        return Ok(Gains::Flat(white, reflectances));
    };
    let powers = place.power(&white);
    // Per pixel's area
    let gains = ratio(powers.map(|(power, _)| power), white_path, "--white-photo")?;
    let area = arguments.mm_per_pixel()?.powi(2);
    Ok(Gains::Power(gains.map(|gain: f64| gain / area), powers.map(|(power, error)| error / power)))
}
