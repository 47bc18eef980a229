//! Limits of a measurement, in plain sentences.

use crate::fit::{Card, ChannelFit, Fit, Outline, Scale, USUAL_ALBEDO};
use crate::remark::{CHANNELS, Remark, three_digits};
use crate::samples::Samples;
use crate::unknown_albedo::PLAUSIBLE;

/// Change of the light across the picture, over its mean, from which on it is called uneven.
const UNEVEN: f64 = 0.5;

/// Reflectance that a black card hardly has.
const BRIGHT_CARD: f64 = 0.045;

/// Mean square of residuals over the noise from which on the model does not explain the light.
pub(crate) const MISFIT: f64 = 2.0;

/// The limits of a fit: first notes, then warnings.
pub(crate) fn limitations(fit: &Fit, samples: &Samples, scale: Scale) -> Vec<Remark> {
    let mut all = Vec::new();
    match scale {
        Scale::Reflectance(_) => {}
        Scale::Relative(albedos) => {
            let shown = albedos.map(|a| a.to_string()).join(", ");
            all.push(Remark::Note(format!(
                "without a white card only lengths are measured, for surface albedos of {shown}"
            )));
        }
        Scale::Unknown => {
            let [least, most] = PLAUSIBLE;
            all.push(Remark::Note(format!(
                "without a white card only lengths are measured: their values are for a surface albedo of {USUAL_ALBEDO}, \
                 their intervals hold those for {least} to {most}; `surface_albedo` narrows them"
            )));
        }
    }
    for (name, channel) in CHANNELS.iter().zip(&fit.channels) {
        all.extend(limit_of_mfp(name, channel, fit, samples));
        if channel.surface_albedo.is_some_and(|albedo| albedo.value >= 1.0) {
            all.push(Remark::Warning(format!(
                "{name}: brighter than any surface in the light of the white card: is a highlight in the way, or \
                 `white_reflectance` too high?"
            )));
        }
        let is_card = matches!(fit.outline, Outline::Edge { card: Card::Visible, .. });
        if is_card && channel.surface_albedo.is_some_and(|albedo| channel.stray * albedo.value > BRIGHT_CARD)
        {
            all.push(Remark::Warning(format!(
                "{name}: the card is {:.1} % as bright as the piece: if that is stray light of the camera, the surface albedo \
                 is too high; a blacker card narrows the intervals",
                100.0 * channel.stray
            )));
        }
        if channel.unevenness.abs() > UNEVEN {
            all.push(Remark::Warning(format!(
                "{name}: the light changes by {:.0} % across the picture: is the piece tilted, or the lamp close?",
                100.0 * channel.unevenness.abs()
            )));
        }
    }
    if fit.misfit > MISFIT {
        all.push(Remark::Warning(unlike(fit)));
    }
    all.sort_by_key(|remark| matches!(remark, Remark::Warning(_)));
    all
}

/// The limit of a channel's mean free path, if there is one.
fn limit_of_mfp(name: &str, channel: &ChannelFit, fit: &Fit, samples: &Samples) -> Option<Remark> {
    let (extent, outline) = (samples.extent(), fit.outline.name());
    let [low, high] = channel.mfp.sure;
    let [value, blur] = [channel.mfp.value, fit.blur].map(three_digits);
    if !channel.is_seen {
        Some(Remark::Warning(format!(
            "{name}: no scattering is seen: the {outline} is as sharp as a blur of {blur} mm makes it: come closer"
        )))
    } else if high > 2.0 * low {
        let [low, high] = [low, high].map(three_digits);
        Some(Remark::Note(format!(
            "{name}: the {outline} does not tell the mean free path: it may be {low} to {high} mm"
        )))
    } else if channel.mfp.value > extent / mfps_needed(fit) {
        Some(Remark::Warning(format!(
            "{name}: light creeps {value} mm and more, farther than the {extent:.0} mm that are seen show: step back"
        )))
    } else if channel.mfp.value < fit.blur {
        Some(Remark::Warning(format!(
            "{name}: the picture's blur of {blur} mm hides a mean free path of {value} mm: come closer"
        )))
    } else {
        None
    }
}

/// Mean free paths that a picture must show.
fn mfps_needed(fit: &Fit) -> f64 {
    match fit.outline {
        // Of both sides
        Outline::Edge { .. } => 15.0,
        Outline::Spot { .. } => 5.0,
    }
}

/// Words for light that no half space explains.
pub(crate) fn unlike(fit: &Fit) -> String {
    format!(
        "the light is not that of an even, thick, isotropic piece: what is left is {:.1} times the noise (layers, strong \
         forward scattering, a rough, bent or patterned surface, moiré, a second light?)",
        fit.misfit.sqrt()
    )
}
