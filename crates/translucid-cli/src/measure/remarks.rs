//! Limits of a measurement, in plain sentences.

use translucid_measure::{Fit, Outline, Samples, Scale};

use super::report::{CHANNELS, outline_name, three_digits};
use crate::messages;

/// Change of the light across the picture, over its mean, from which on it is called uneven.
const UNEVEN: f64 = 0.5;

/// Mean square of residuals over the noise from which on the model does not explain the light.
pub(super) const MISFIT: f64 = 2.0;

/// Says what limits the measurement, and returns it in plain sentences.
pub(super) fn remarks(fit: &Fit, samples: &Samples, scale: Scale) -> Vec<String> {
    let mut notes = Vec::new();
    let mut warnings = Vec::new();
    if let Scale::Relative(albedos) = scale {
        let shown = albedos.map(|a| a.to_string()).join(", ");
        notes.push(format!("without a white card only lengths are measured, for surface albedos of {shown}"));
    }
    let (extent, outline) = (samples.extent(), outline_name(fit));
    for (name, channel) in CHANNELS.iter().zip(&fit.channels) {
        let [low, high] = channel.mfp.sure;
        let [value, blur] = [channel.mfp.value, fit.blur].map(three_digits);
        if !channel.is_seen {
            warnings.push(format!(
                "{name}: no scattering is seen: the {outline} is as sharp as a blur of {blur} mm makes it: come closer"
            ));
        } else if high > 2.0 * low {
            let [low, high] = [low, high].map(three_digits);
            notes.push(format!(
                "{name}: the {outline} does not tell the mean free path: it may be {low} to {high} mm"
            ));
        } else if channel.mfp.value > extent / samples_needed(fit) {
            warnings.push(format!(
                "{name}: light creeps {value} mm and more, farther than the {extent:.0} mm that are seen show: step back"
            ));
        } else if channel.mfp.value < fit.blur {
            warnings.push(format!(
                "{name}: the picture's blur of {blur} mm hides a mean free path of {value} mm: come closer"
            ));
        }
        if channel.surface_albedo.is_some_and(|albedo| albedo.value >= 1.0) {
            warnings.push(format!(
                "{name}: brighter than any surface in the light of the white card: is a highlight in the way, or \
                 --white-reflectance too high?"
            ));
        }
        if channel.unevenness.abs() > UNEVEN {
            warnings.push(format!(
                "{name}: the light changes by {:.0} % across the picture: is the piece tilted, or the lamp close?",
                100.0 * channel.unevenness.abs()
            ));
        }
    }
    if fit.misfit > MISFIT {
        warnings.push(unlike(fit));
    }
    notes.iter().for_each(|note| messages::print_note(note));
    warnings.iter().for_each(|warning| messages::print_warning(warning));
    notes.into_iter().chain(warnings).collect()
}

/// Mean free paths that a picture must show.
fn samples_needed(fit: &Fit) -> f64 {
    match fit.outline {
        // Of both sides
        Outline::Edge { .. } => 15.0,
        Outline::Spot { .. } => 5.0,
    }
}

/// Words for light that no half space explains.
pub(super) fn unlike(fit: &Fit) -> String {
    format!(
        "the light is not that of an even, thick, isotropic piece: what is left is {:.1} times the noise (layers, strong \
         forward scattering, a rough, bent or patterned surface, moiré, a second light?)",
        fit.misfit.sqrt()
    )
}
