//! A measurement with its photograph, as the page shows it.

use translucid_measure::{Fit, Photo, Samples};

use super::trace::Trace;

/// A measurement and the photograph that it was made in.
pub(super) struct Shown<'a> {
    pub(super) photo: &'a Photo,
    pub(super) region: [usize; 4],
    /// In the region.
    pub(super) trace: &'a Trace,
    pub(super) samples: &'a Samples,
    pub(super) fit: &'a Fit,
    pub(super) limits: &'a [String],
}
