//! The profiles that probes are drawn from: one for each channel, cut where little of the energy is left.

use translucid_profile::{NormalizedDiffusionF32, ProfileViewF32};

/// A channel's profile, cut at the radius R_m and renormalized.
pub(crate) trait CutProfile: Copy {
    /// Density per length at r ≤ R_m \[L⁻¹\], up to a factor that the channels of a surface share.
    fn pdf(&self, r: f32) -> f32;

    /// Radius of that density for a random number uniform on [0, 1), at most R_m \[L\].
    fn sample(&self, u: f32) -> f32;

    /// R_m \[L\].
    fn longest(&self) -> f32;
}

/// Where normalized diffusion is cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truncation {
    /// Energy outside.
    pub(crate) tail: f32,
    /// Radius in units of d.
    radius: f32,
}

impl Truncation {
    /// Cuts every profile where `tail` of its energy is outside, tail in (0, 1).
    pub(crate) fn new(tail: f32) -> Self {
        Self { tail, radius: NormalizedDiffusionF32::from_d(1.0).quantile_complement(tail) }
    }
}

/// Normalized diffusion; the factor 1/(1 − tail) is left out of its density.
#[derive(Clone, Copy)]
pub(crate) struct CutNormalizedDiffusion {
    profile: NormalizedDiffusionF32,
    longest: f32,
    tail: f32,
}

impl CutNormalizedDiffusion {
    /// The profile of width d > 0 \[L\].
    pub(crate) fn new(d: f32, truncation: &Truncation) -> Self {
        let profile = NormalizedDiffusionF32::from_d(d);
        Self { profile, longest: d * truncation.radius, tail: truncation.tail }
    }
}

impl CutProfile for CutNormalizedDiffusion {
    #[inline]
    fn pdf(&self, r: f32) -> f32 {
        self.profile.pdf(r)
    }

    #[inline]
    fn sample(&self, u: f32) -> f32 {
        self.profile.quantile_complement(1.0 - u * (1.0 - self.tail)).min(self.longest)
    }

    #[inline]
    fn longest(&self) -> f32 {
        self.longest
    }
}

/// A tabulated profile of one surface albedo and length.
#[derive(Clone, Copy)]
pub(crate) struct CutTable<'a> {
    view: ProfileViewF32<'a>,
    longest: f32,
    /// 1 over the share of the energy within R_m.
    inverse_within: f32,
}

impl<'a> CutTable<'a> {
    /// Cuts a profile where no more than `tail` of its energy is outside.
    pub(crate) fn new(view: ProfileViewF32<'a>, tail: f32) -> Self {
        let longest = view.truncation_radius(tail);
        Self { view, longest, inverse_within: 1.0 / view.cdf(longest) }
    }
}

impl CutProfile for CutTable<'_> {
    #[inline]
    fn pdf(&self, r: f32) -> f32 {
        self.view.pdf(r) * self.inverse_within
    }

    #[inline]
    fn sample(&self, u: f32) -> f32 {
        self.view.sample_within(u, self.longest)
    }

    #[inline]
    fn longest(&self) -> f32 {
        self.longest
    }
}
