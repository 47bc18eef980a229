//! The profile that probes are drawn from: cut at the radius beyond which little energy is left.

use std::ops::Range;

use translucid_profile::ProfileViewF32;

use super::SubsurfaceKernel;

/// Lengths \[L\] that tables take as they are, and whose radii are finite.
const USUAL_LENGTHS: Range<f32> = 1e-15..1e15;

/// A channel's profile of one surface albedo and length, cut at the radius R_m and renormalized.
#[derive(Clone, Copy)]
pub(crate) struct CutProfile<'a> {
    view: ProfileViewF32<'a>,
    longest: f32,
    /// 1 over the share of the energy within R_m.
    inverse_within: f32,
}

/// How profiles are cut.
pub(crate) struct Cutting {
    /// Energy beyond R_m, in (0, 1).
    tail: f32,
    /// The cuts of a material that has the same color everywhere.
    known: Vec<KnownCut>,
}

/// The cut of one surface albedo.
struct KnownCut {
    surface_albedo: f32,
    /// R_m for length 1.
    longest: f32,
    inverse_within: f32,
}

impl Cutting {
    /// Cuts the profiles of a kernel so that no more than `tail` of their energy is outside.
    pub(crate) fn new(kernel: &SubsurfaceKernel, tail: f32) -> Self {
        let albedos = kernel.radial.surface_albedos();
        let of_color = if albedos.len() <= 3 { albedos } else { &[] };
        let known = |&albedo: &f64| {
            let surface_albedo = albedo as f32;
            let CutProfile { longest, inverse_within, .. } =
                CutProfile::new(kernel.radial(surface_albedo, 1.0), tail);
            KnownCut { surface_albedo, longest, inverse_within }
        };
        Self { tail, known: of_color.iter().map(known).collect() }
    }

    /// Energy beyond R_m.
    pub(crate) fn tail(&self) -> f32 {
        self.tail
    }

    /// The profile of a surface albedo and a length \[L\], cut.
    #[inline]
    pub(crate) fn cut<'a>(
        &self,
        kernel: &'a SubsurfaceKernel,
        surface_albedo: f32,
        length: f32,
    ) -> CutProfile<'a> {
        let view = kernel.radial(surface_albedo, length);
        let known = self.known.iter().find(|cut| cut.surface_albedo == surface_albedo);
        match known.filter(|_| USUAL_LENGTHS.contains(&length)) {
            Some(cut) => {
                CutProfile { view, longest: cut.longest * length, inverse_within: cut.inverse_within }
            }
            None => CutProfile::new(view, self.tail),
        }
    }
}

impl<'a> CutProfile<'a> {
    /// Cuts a profile so that no more than `tail` of its energy is outside.
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
