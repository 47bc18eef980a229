//! How finely the light across an edge is fitted: a photograph of many pixels has more than its light needs.

use translucid_measure::{Fit, Outline, Samples};

use super::report::three_digits;
use crate::messages;

/// Most places that are fitted at once: a fit's time grows with their square.
const MOST_PLACES: usize = 224;

/// Steps of a mean free path from which on finer ones tell no more.
const FINE: f64 = 3.0;

/// Mean free paths around the edge within which its light changes.
const REACH: f64 = 30.0;

/// Fits samples in steps that are fine beside the shortest mean free path: those of all, and where these are too coarse,
/// those of a part around the edge. Says so, and returns the samples that were fitted.
pub(super) fn fit(samples: Samples, fit: impl Fn(&Samples) -> Option<Fit>) -> Option<(Samples, Fit)> {
    let (pixel, all) = (samples.pixel_width, samples.places.len());
    let mut around = samples;
    loop {
        let coarse = around.coarse(MOST_PLACES);
        let found = fit(&coarse)?;
        let mfp = |channel: &translucid_measure::ChannelFit| {
            if channel.is_seen { channel.mfp.value } else { 0.0 }
        };
        let mfps = found.channels.each_ref().map(mfp);
        let [shortest, longest] =
            [mfps.iter().copied().fold(f64::MAX, f64::min), mfps.iter().copied().fold(0.0, f64::max)];
        if coarse.pixel_width > pixel && shortest < FINE * coarse.pixel_width {
            let middle = match found.outline {
                Outline::Edge { position, .. } => position,
                Outline::Spot { .. } => 0.0,
            };
            let near = around.within(middle, REACH * longest.max(2.0 * coarse.pixel_width));
            if near.places.len() < around.places.len() * 4 / 5 {
                around = near;
                continue;
            }
        }
        if around.places.len() < all {
            let extent = around.places.len() as f64 * pixel;
            messages::line(&format!("measured in the {} mm around the edge", three_digits(extent)));
        }
        if coarse.pixel_width > pixel {
            let pixels = (coarse.pixel_width / pixel).round();
            messages::line(&format!(
                "measured in steps of {pixels} pixels, {} mm",
                three_digits(coarse.pixel_width)
            ));
        }
        return Some((coarse, found));
    }
}
