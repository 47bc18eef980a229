//! The subsurface kernel of a material, the spatial part of its BSSRDF: how much of the light that enters at the entry
//! point x_i leaves at the exit point x_o.
//!
//! ```text
//! S(x_i, ω_i, x_o) = A p(|x_o − x_i|) w(x_o − x_i, ω_i),      R(r) = A p(r)
//! ```
//!
//! p is a radial profile, tabulated for the surface albedos of the material and cut where little of its energy is
//! left: entry points are drawn from it. w is 1 where a model has no directions, else the model over its own mean.
//! The surface adds the rest of the BSSRDF, T(ω_i) T(ω_o) / (π T̄): see [`bsdf`](crate::surface::bsdf).
//!
//! On its way to a probe, one R(r) goes through four types:
//!
//! ```text
//! AlbedoTableF32 (every A) → ProfileViewF32 (one A and ℓ) → CutProfile (within R_m) → ProbeStrategy (3 channels, 3 axes)
//! ```

mod cut;
mod direction;
mod half_space;
#[cfg_attr(target_family = "wasm", path = "no_layers.rs")]
mod layers;
mod recipe;

use glam::Vec3;
use translucid_profile::{AlbedoTableF32, DirectionalDipoleTable, ObliqueDiffusionTable, ProfileViewF32};

use super::note::Remark;
use super::parameters::Subsurface;

pub(crate) use cut::{CutProfile, Cutting};
use direction::DirectedProfiles;
pub(crate) use direction::{DirectionalWeight, Directions, EntryToExit};
pub(crate) use half_space::HalfSpace;
pub(crate) use recipe::{KernelRecipe, unfitted};

/// The profile of one material, or of several that are alike.
#[doc(alias = "BSSRDF")]
pub(crate) struct SubsurfaceKernel {
    radial: AlbedoTableF32,
    /// Surface albedo whose shape stands in above it. Directional profiles use that shape, too; otherwise most of their
    /// light would leave where probes hardly look.
    brightest: f32,
    /// The profile is that of a file or of layers: it may have any shape, in a file holes included.
    has_any_shape: bool,
    /// Surface albedos and lengths of the profiles in place of the material's.
    own: Option<Subsurface>,
    angular: Angular,
    notes: Vec<Remark>,
}

/// The directional part of a kernel.
enum Angular {
    Nothing,
    Dipole(DirectionalDipoleTable),
    Oblique(ObliqueDiffusionTable),
}

impl SubsurfaceKernel {
    /// The radial profile of a surface albedo and a length.
    #[inline]
    pub(crate) fn radial(&self, surface_albedo: f32, length: f32) -> ProfileViewF32<'_> {
        self.radial.at(surface_albedo, length)
    }

    /// Lengths with 0 for those whose profiles are points, where positions are exact to `offset`.
    ///
    /// The median radius decides, not the length: a file's radii may be in any unit.
    pub(crate) fn resolved(&self, surface_albedo: Vec3, length: Vec3, offset: f32) -> Vec3 {
        let of = |c: usize| {
            let length = length[c];
            let is_wide = length > 0.0 && self.radial.median_radius(surface_albedo[c], length) > offset;
            if is_wide { length } else { 0.0 }
        };
        Vec3::new(of(0), of(1), of(2))
    }

    /// Radius within which half of a channel's light leaves \[L\].
    pub(crate) fn half_radius(&self, surface_albedo: f32, length: f32) -> f32 {
        self.radial.median_radius(surface_albedo, length)
    }

    /// Ways in which the kernel falls short of its material, worded to follow the model's name.
    pub(crate) fn notes(&self) -> &[Remark] {
        &self.notes
    }

    /// Returns `true` if the direction of light counts.
    pub(crate) fn knows_directions(&self) -> bool {
        !matches!(self.angular, Angular::Nothing)
    }

    /// Surface albedos and lengths that the profiles have in place of the material's.
    pub(crate) fn own(&self) -> Option<Subsurface> {
        self.own
    }

    /// Surface albedos of profiles that may have any shape.
    pub(crate) fn albedos_of_any_shape(&self) -> Option<&[f64]> {
        self.has_any_shape.then(|| self.radial.surface_albedos())
    }

    /// The kernel for a device: 1 for oblique light, 2 for the directional dipole, 0 where directions do not count, six words of
    /// those, the brightest surface albedo of their shape, whether surface albedos and lengths are its own, and these; three words
    /// of `axes`, then the number of rows and the [words](AlbedoTableF32::words) of the profile, cut so that no more than `tail` of
    /// its energy is outside. The dipole's own table comes last, and the first of its six words states where.
    pub(crate) fn words(&self, tail: f32, axes: [f32; 3]) -> Vec<f32> {
        let (kind, six, table) = match &self.angular {
            Angular::Nothing => (0.0, [0.0; 6], Vec::new()),
            Angular::Oblique(table) => (1.0, table.words(), Vec::new()),
            Angular::Dipole(table) => {
                let (six, table) = table.words();
                (2.0, six, table)
            }
        };
        let mut words = [&[kind], &six[..]].concat();
        let nothing = Subsurface { surface_albedo: Vec3::ZERO, length: Vec3::ZERO };
        let own = self.own.unwrap_or(nothing);
        words.extend([self.brightest, f32::from(u8::from(self.own.is_some()))]);
        words.extend(own.surface_albedo.to_array());
        words.extend(own.length.to_array());
        words.extend(axes);
        words.push(self.radial.surface_albedos().len() as f32);
        words.extend(self.radial.words(tail));
        if !table.is_empty() {
            words[1] = words.len() as f32;
            words.extend(table);
        }
        words
    }

    /// The directional part of an exit point's parameters.
    pub(crate) fn directions(&self, subsurface: &Subsurface) -> Directions<'_> {
        let Subsurface { surface_albedo, length } = *subsurface;
        let shape = |c: usize| surface_albedo[c].min(self.brightest);
        let profiles = match &self.angular {
            Angular::Nothing => return Directions(None),
            Angular::Dipole(table) => {
                DirectedProfiles::Dipole([0, 1, 2].map(|c| table.at(shape(c), length[c])))
            }
            Angular::Oblique(table) => {
                DirectedProfiles::Oblique([0, 1, 2].map(|c| table.at(shape(c), length[c])))
            }
        };
        let mean = direction::RadialMean {
            views: [0, 1, 2].map(|c| self.radial(shape(c), length[c])),
            surface_albedo: [0, 1, 2].map(|c| if length[c] > 0.0 { shape(c) } else { 0.0 }),
        };
        Directions(Some((profiles, mean)))
    }
}
