//! Random numbers of the plain walks, which have nothing in common with the crate's.

use translucid_testing::SplitMix;

pub(crate) struct Random(pub(crate) SplitMix);

impl Random {
    /// Uniform in (0, 1].
    pub(crate) fn next(&mut self) -> f64 {
        self.0.uniform() + 2f64.powi(-54)
    }
}
