//! Options of how a picture is shown, and the exposure that the pictures of a command have in common.

use std::sync::{Arc, OnceLock};

use clap::Args;
use translucid_image::{DisplayTransform, Picture, ToneMapping};
use translucid_scene::Film;

/// The options.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Tone {
    /// Exposure of FILE.png in stops, or auto
    ///
    /// auto meters the first picture, so that its bright parts are not clipped. By default auto for a mesh, else the
    /// scene's.
    #[arg(long, value_name = "STOPS|auto", value_parser = parse_exposure, allow_negative_numbers = true)]
    exposure: Option<ExposureWord>,
    /// Curve from light to FILE.png: srgb, neutral or agx
    ///
    /// srgb clamps, neutral is Khronos PBR Neutral, agx is Troy Sobotka's filmic curve of 2022 (base look, in Rec. 709, by
    /// Benjamin Wrensch's polynomial), not Blender's of that name. By default the scene's.
    #[arg(long, value_name = "CURVE", value_parser = parse_tone_mapping)]
    tone_mapping: Option<ToneMapping>,
}

/// Exposure that `--exposure` asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ExposureWord {
    Auto,
    Stops(f32),
}

impl Tone {
    /// The film with the changes.
    pub(crate) fn of(&self, film: Film) -> Film {
        let exposure = match self.exposure {
            Some(ExposureWord::Stops(stops)) => stops,
            _ => film.exposure,
        };
        Film { exposure, tone_mapping: self.tone_mapping.unwrap_or(film.tone_mapping), ..film }
    }

    /// How the pictures of a scene, or of a mesh that states no exposure, are exposed.
    pub(crate) fn exposure(&self, is_mesh: bool) -> Exposure {
        match self.exposure {
            Some(ExposureWord::Auto) => Exposure::Metered(Arc::default()),
            None if is_mesh => Exposure::Metered(Arc::default()),
            _ => Exposure::OfFilm,
        }
    }
}

/// The exposure of a command's pictures.
#[derive(Clone, Debug)]
pub(crate) enum Exposure {
    /// The exposure that the film states.
    OfFilm,
    /// The exposure of the first picture, once there is one: pictures that belong together are shown alike.
    Metered(Arc<OnceLock<f32>>),
}

impl Exposure {
    /// The way to a display of a finished picture of this film.
    pub(crate) fn display(&self, film: &Film, picture: &Picture<'_>) -> DisplayTransform {
        let exposure = match self {
            Self::OfFilm => film.exposure,
            Self::Metered(stops) => *stops.get_or_init(|| metered(picture)),
        };
        DisplayTransform { exposure, tone_mapping: film.tone_mapping }
    }

    /// Whether a picture decides.
    pub(crate) fn is_metered(&self) -> bool {
        matches!(self, Self::Metered(_))
    }

    /// The stops, where they are not metered.
    pub(super) fn stated(&self, film: &Film) -> Option<f32> {
        matches!(self, Self::OfFilm).then_some(film.exposure)
    }

    /// The way to a display of a picture that is not finished: metered as it is, until a finished one is.
    pub(super) fn preview(&self, film: &Film, picture: &Picture<'_>) -> DisplayTransform {
        let exposure = match self {
            Self::OfFilm => film.exposure,
            Self::Metered(stops) => stops.get().copied().unwrap_or_else(|| metered(picture)),
        };
        DisplayTransform { exposure, tone_mapping: film.tone_mapping }
    }

    /// The metered stops, once they are known.
    pub(super) fn metered(&self) -> Option<f32> {
        match self {
            Self::OfFilm => None,
            Self::Metered(stops) => stops.get().copied(),
        }
    }
}

/// Nothing to meter is nothing to write either, which is said there.
fn metered(picture: &Picture<'_>) -> f32 {
    picture.metered_exposure().unwrap_or_default()
}

fn parse_exposure(text: &str) -> Result<ExposureWord, String> {
    let stops = text.parse().ok().filter(|stops| (-32.0..=32.0).contains(stops));
    match (text, stops) {
        ("auto", _) => Ok(ExposureWord::Auto),
        (_, Some(stops)) => Ok(ExposureWord::Stops(stops)),
        _ => Err(String::from("an exposure is a number of stops in [-32, 32], or auto")),
    }
}

fn parse_tone_mapping(text: &str) -> Result<ToneMapping, String> {
    ToneMapping::from_name(text).ok_or_else(|| {
        let names = ToneMapping::WORDS.map(|(name, _)| name).join(", ");
        format!("the curves are {names}")
    })
}

#[cfg(test)]
mod tests {
    use translucid_image::PictureChannel;

    use super::*;

    #[test]
    fn exposures_are_stops_or_metered() {
        assert_eq!(parse_exposure("-1.5"), Ok(ExposureWord::Stops(-1.5)));
        assert_eq!(parse_exposure("auto"), Ok(ExposureWord::Auto));
        for wrong in ["", "33", "nan", "Auto", "1 stop"] {
            assert!(parse_exposure(wrong).is_err(), "{wrong}");
        }
        assert!(parse_tone_mapping("agx").is_ok() && parse_tone_mapping("aces").is_err());
    }

    /// Without an option only a mesh is metered, and what is metered first holds for all.
    #[test]
    fn exposure_is_that_of_the_film_or_of_the_first_picture() {
        let grey = |value: f64| {
            let channels = ["R", "G", "B"].map(PictureChannel::single).to_vec();
            Picture::new([4, 4], channels, move |_, values| values.fill(value))
        };
        let film = Film { exposure: 1.5, ..Film::default() };
        let shown = |exposure: &Exposure, value: f64| exposure.display(&film, &grey(value)).exposure;
        let plain = Tone::default();
        assert_eq!(shown(&plain.exposure(false), 0.1), 1.5);
        let metered = plain.exposure(true);
        let first = shown(&metered, 0.01);
        assert_eq!((shown(&metered, 1.0), metered.metered()), (first, Some(first)));
        let begun = plain.exposure(true);
        assert_eq!(begun.preview(&film, &grey(0.01)).exposure, first);
        assert!(begun.metered().is_none() && shown(&begun, 1.0) < first, "a preview decides nothing");
        assert!(first > shown(&plain.exposure(true), 1.0) + 5.0);
        let stated = Tone { exposure: Some(ExposureWord::Stops(-2.0)), ..Tone::default() };
        assert_eq!((stated.of(film).exposure, stated.exposure(true).metered()), (-2.0, None));
        let auto = Tone { exposure: Some(ExposureWord::Auto), ..Tone::default() };
        assert_eq!(shown(&auto.exposure(false), 0.01), first);
    }
}
