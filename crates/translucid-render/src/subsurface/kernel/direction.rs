//! The factor of a directional model: how the light that leaves depends on the direction from which it enters.
//!
//! Probes find entry points by a radial profile, before any light is known.
//! A directional model then weights the light at the entry with R(x_o − x_i; ω_i)/R(|x_o − x_i|).

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;
use translucid_profile::{DirectionalDipoleF32, ObliqueDiffusionF32, ProfileViewF32};

use super::half_space::HalfSpaceReflection;

/// The offset of an exit from an entry point, with normals on the side that is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EntryToExit {
    /// From the entry to the exit \[L\].
    pub(crate) offset: Vec3,
    /// Unit normal at the entry.
    pub(crate) entry_normal: Vec3,
    /// Unit normal at the exit.
    pub(crate) exit_normal: Vec3,
}

/// A directional model at the parameters of an exit point, per channel.
#[allow(
    clippy::large_enum_variant,
    reason = "one for each exit of a block, in memory that is kept: a box would allocate in the inner loop"
)]
#[derive(Clone, Copy)]
pub(crate) enum DirectedProfiles {
    /// The directional dipole.
    Dipole([DirectionalDipoleF32; 3]),
    /// Normalized diffusion of oblique light.
    Oblique([ObliqueDiffusionF32; 3]),
}

/// Directional part of the kernel for the parameters of an exit point; `None` where all directions are alike.
#[derive(Clone, Copy)]
pub(crate) struct Directions<'a>(pub(super) Option<(DirectedProfiles, RadialMean<'a>)>);

/// The weight of light by its direction, per channel.
pub(crate) enum DirectionalWeight<'a> {
    /// All directions are alike.
    Radial,
    /// That of a directional model, with 1 over the profile by which the entry was found.
    Directed(&'a DirectedProfiles, EntryToExit, Vec3),
    /// Light leaves a half space where it enters.
    HalfSpace(HalfSpaceReflection),
}

/// The radial profiles by which probes find entry points.
#[derive(Clone, Copy)]
pub(crate) struct RadialMean<'a> {
    pub(super) views: [ProfileViewF32<'a>; 3],
    /// Surface albedo of the shape, 0 in channels that do not scatter.
    pub(super) surface_albedo: [f32; 3],
}

impl RadialMean<'_> {
    /// 1 over a density of the profiles times A; 0 where that is 0.
    fn inverse(&self, density: impl Fn(&ProfileViewF32<'_>) -> f32) -> Vec3 {
        let of = |c: usize| {
            let radial = if self.surface_albedo[c] > 0.0 {
                self.surface_albedo[c] * density(&self.views[c])
            } else {
                0.0
            };
            if radial > 0.0 { radial.recip() } else { 0.0 }
        };
        Vec3::new(of(0), of(1), of(2))
    }
}

impl Directions<'_> {
    /// The weights of light that travels from an entry to the exit point.
    pub(crate) fn along(&self, passage: EntryToExit) -> DirectionalWeight<'_> {
        let distance = passage.offset.length();
        let Some((profiles, mean)) = &self.0 else { return DirectionalWeight::Radial };
        // 1/R(|x_o − x_i|), or 1/(r R(r)), of the profile that the entry was found by
        let inverse = match profiles {
            DirectedProfiles::Dipole(_) => mean.inverse(|view| view.pdf_area(distance)),
            DirectedProfiles::Oblique(_) => mean.inverse(|view| view.pdf(distance) * (0.5 * FRAC_1_PI)),
        };
        DirectionalWeight::Directed(profiles, passage, inverse)
    }
}

impl DirectionalWeight<'_> {
    /// Factor on light that comes from a unit direction.
    #[inline]
    pub(crate) fn weight(&self, toward_light: Vec3) -> Vec3 {
        let (profiles, passage, inverse) = match self {
            Self::Radial => return Vec3::ONE,
            Self::HalfSpace(reflection) => return reflection.weight(toward_light),
            Self::Directed(profiles, passage, inverse) => (profiles, passage, inverse),
        };
        let [offset, omega, entry_normal, exit_normal] = passage.arrays(toward_light);
        match profiles {
            DirectedProfiles::Dipole(dipoles) => {
                per_channel(*inverse, |c| dipoles[c].eval(offset, omega, entry_normal, exit_normal))
            }
            DirectedProfiles::Oblique(profiles) => {
                per_channel(*inverse, |c| profiles[c].eval_times_r(offset, omega, entry_normal))
            }
        }
    }
}

impl EntryToExit {
    /// Offset, direction toward the light, and normals at entry and exit.
    fn arrays(&self, toward_light: Vec3) -> [[f32; 3]; 4] {
        [self.offset, toward_light, self.entry_normal, self.exit_normal].map(|v| v.to_array())
    }
}

/// inverse · value, 0 in channels whose inverse is 0.
///
/// It is 0, too, where the product overflows: far away from a channel's light, where other channels have theirs.
fn per_channel(inverse: Vec3, value: impl Fn(usize) -> f32) -> Vec3 {
    let product = |c: usize| {
        let product = if inverse[c] <= 0.0 { 0.0 } else { value(c) * inverse[c] };
        if product.is_finite() { product } else { 0.0 }
    };
    Vec3::new(product(0), product(1), product(2))
}
