//! Light that a photograph has lost at either end of its range.

use crate::error::MeasureError;
use crate::linear_photo::{NamedPhoto, Photo};
use crate::remark::{CHANNELS, Remark, three_digits};
use crate::spot_place::SpotPlace;

/// Share of pixels at the end of their range from which on a photograph counts as clipped.
const CLIPPED: f64 = 1e-3;

/// Share from which on nothing is measured.
const TOO_MUCH_CLIPPED: f64 = 0.05;

/// Part of the light by which the dark may be brighter because a file holds nothing below 0.
const CUT_NOISE: f64 = 1e-3;

/// Warns of light that is cut off, and refuses a part of a photograph where that is much of it.
pub(crate) fn check_clipping(
    part: &Photo,
    name: &str,
    say: &mut dyn FnMut(Remark),
) -> Result<(), MeasureError> {
    let (mut share, mut message) = (part.clipped(), String::from("the values are at the end of their range"));
    for (c, name) in CHANNELS.iter().enumerate() {
        if let Some(pile) = part.pile_up(c).filter(|pile| pile.share > share) {
            let most = three_digits(f64::from(pile.greatest));
            (share, message) = (pile.share, format!("the values of {name} are at its greatest, {most}"));
        }
    }
    let message = format!("{:.1} % of {message}, where light is lost", 100.0 * share);
    let help = "expose less, add a shorter `exposure`, or leave highlights out by `region`";
    if share > TOO_MUCH_CLIPPED {
        return Err(MeasureError::of_photo(name, message).with_help(help));
    }
    if share > CLIPPED {
        say(Remark::Warning(format!("{name}: {message}: {help}")));
    }
    warn_of_cut_noise(part, name, part, say);
    Ok(())
}

/// Notes a white card whose values are equal though the photograph is noisy: it may be clipped.
pub(crate) fn note_equal_white(photo: &NamedPhoto, card: [usize; 4], say: &mut dyn FnMut(Remark)) {
    let clipped = photo.photo.clipped_whites(card);
    let names: Vec<&str> = (0..3).filter(|c| clipped[*c]).map(|c| CHANNELS[c]).collect();
    if !names.is_empty() {
        say(Remark::Note(format!(
            "{}: the white card's values of {} are all the same, but the rest is noisy: if the card is clipped, the surface \
             albedo is too high: expose less",
            photo.name,
            names.join(", ")
        )));
    }
}

/// Warns of values below 0 that the file has as 0, which makes the dark brighter, where that counts beside the light.
pub(crate) fn warn_of_cut_noise(part: &Photo, name: &str, lit: &Photo, say: &mut dyn FnMut(Remark)) {
    let light = lit.mean().into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let gained = part.cut_noise() / light;
    if gained > CUT_NOISE {
        say(Remark::Warning(format!(
            "{name}: noise below 0 is cut off, which brightens the dark by up to {} % of the light: save as OpenEXR with \
             negative values, or without the camera's black level subtracted, which `dark` does better",
            three_digits(100.0 * gained)
        )));
    }
}

/// Radius in pixels of the core of a spot in which light is lost; refuses one beyond which too little is left.
pub(crate) fn check_core(
    piece: &Photo,
    place: &SpotPlace,
    name: &str,
    say: &mut dyn FnMut(Remark),
) -> Result<f64, MeasureError> {
    let core = place.core(piece);
    let [x, y] = place.center;
    let reach = x.min(y).min(piece.width as f64 - x).min(piece.height as f64 - y);
    if core > 0.5 * reach {
        let message = format!(
            "the spot is saturated: light is lost up to {core:.0} pixels from its center, of {reach:.0} pixels that are seen \
             all around"
        );
        let help = "expose less, or add a shorter `exposure`";
        return Err(MeasureError::of_photo(name, message).with_help(help));
    }
    if core > 0.0 {
        say(Remark::Warning(format!(
            "{name}: light is lost up to {core:.0} pixels from the center of the spot: that core is left out"
        )));
    }
    Ok(core)
}
