//! The profile that probes are drawn from: cut where little of the energy is left.

use translucid_profile::ProfileViewF32;

/// A channel's profile of one surface albedo and length, cut at the radius R_m and renormalized.
#[derive(Clone, Copy)]
pub(crate) struct CutProfile<'a> {
    view: ProfileViewF32<'a>,
    longest: f32,
    /// 1 over the share of the energy within R_m.
    inverse_within: f32,
}

impl<'a> CutProfile<'a> {
    /// Cuts a profile where no more than `tail` of its energy is outside.
    pub(crate) fn new(view: ProfileViewF32<'a>, tail: f32) -> Self {
        let longest = view.truncation_radius(tail);
        Self { view, longest, inverse_within: 1.0 / view.cdf(longest) }
    }

    /// Density per length at r ≤ R_m \[L⁻¹\].
    #[inline]
    pub(crate) fn pdf(&self, r: f32) -> f32 {
        self.view.pdf(r) * self.inverse_within
    }

    /// Radius of that density for a random number uniform on [0, 1), at most R_m \[L\].
    #[inline]
    pub(crate) fn sample(&self, u: f32) -> f32 {
        self.view.sample_within(u, self.longest)
    }

    /// R_m \[L\].
    #[inline]
    pub(crate) fn longest(&self) -> f32 {
        self.longest
    }
}
