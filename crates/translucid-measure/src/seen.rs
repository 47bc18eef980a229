//! Whether a picture shows that light creeps.

use crate::samples::Samples;

/// Standard error of ln ℓ from which on nothing is known of a mean free path.
const UNSEEN: f64 = 1.0;

/// Whether a mean free path with a standard error of its logarithm is one that a picture of such a blur and such an extent can
/// tell from none and from all: a lens blurs not quite like a Gaussian.
pub(crate) fn is_seen(samples: &Samples, blur: f64, log_mfp: f64, error: f64) -> bool {
    let least = 0.25 * blur.abs().max(samples.pixel_width);
    error > 0.0 && error < UNSEEN && (libm::log(least)..=libm::log(3.0 * samples.extent())).contains(&log_mfp)
}
