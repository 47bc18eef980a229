//! Intervals of mean free paths where the surface albedo is not known.

use crate::edge_fit::fit_edge_of;
use crate::fit::{Fit, Outline, Scale};
use crate::response::Response;
use crate::samples::Samples;
use crate::spot_fit::fit_spot;

/// The least surface albedo that a piece may have if none is known, and the greatest.
pub(crate) const PLAUSIBLE: [f64; 2] = [0.1, 0.98];

/// Widens the intervals of mean free paths to hold those for the [`PLAUSIBLE`] surface albedos: the mean free path that
/// explains some light falls as the surface albedo rises, so that those at the ends enclose all.
pub(crate) fn widen_by_albedo(fit: &mut Fit, samples: &Samples, response: &Response) {
    for albedo in PLAUSIBLE {
        let scale = Scale::Relative([albedo; 3]);
        let other = match fit.outline {
            Outline::Edge { card, .. } => fit_edge_of(card, samples, response, scale),
            Outline::Spot { .. } => fit_spot(samples, response, scale),
        };
        let others = other.iter().flat_map(|other| &other.channels);
        for (channel, other) in fit.channels.iter_mut().zip(others) {
            let mfps = [(&mut channel.mfp.likely, other.mfp.likely), (&mut channel.mfp.sure, other.mfp.sure)];
            for (interval, other) in mfps {
                *interval = [interval[0].min(other[0]), interval[1].max(other[1])];
            }
        }
    }
}
