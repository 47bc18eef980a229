//! Whether a photograph resolves the light that creeps below a surface.

use crate::samples::Samples;

/// Standard error of ln ℓ from which on nothing is known of a mean free path.
const UNKNOWN: f64 = 1.0;

/// Whether a mean free path, by its logarithm and the standard error of that, differs from none at all and from one far beyond
/// the picture. A lens does not blur quite like a Gaussian, so lengths far below the blur are not resolved.
pub(crate) fn is_detectable(samples: &Samples, blur: f64, log_mfp: f64, error: f64) -> bool {
    let least = 0.25 * blur.abs().max(samples.pixel_width);
    error > 0.0
        && error < UNKNOWN
        && (libm::log(least)..=libm::log(3.0 * samples.extent())).contains(&log_mfp)
}
