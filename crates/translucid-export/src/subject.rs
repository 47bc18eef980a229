//! Subjects of exported texts.

use translucid_profile::values;

use crate::language::Language;
use crate::target::Target;

/// The subject of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Evaluation, densities, distribution and quantile of a profile.
    Profile,
    /// Random radii and their densities.
    Sampler,
    /// Taps around a pixel for screen-space scattering.
    Disk,
    /// Pre-integrated light on a sphere, by N·L and curvature.
    Lut,
    /// Separable kernel for screen-space scattering.
    Kernel,
    /// Sampling of entry points on any shape, as commented reference code.
    Probe,
    /// Reflectance of a dielectric boundary.
    Fresnel,
    /// The medium behind a surface albedo.
    Inversion,
    /// A material, with its surface shader.
    Material,
    /// Transmittance of slabs by their thickness.
    Transmittance,
}

impl Subject {
    /// Every subject with its name and a line about it, in the order of the variants.
    #[rustfmt::skip]
    const ROWS: [(Self, [&'static str; 2]); 10] = [
        (Self::Profile, ["profile", "Evaluation, densities, distribution and quantile of a profile"]),
        (Self::Sampler, ["sampler", "Random radii and their densities"]),
        (Self::Disk, ["disk", "Taps around a pixel for screen-space scattering, of a material"]),
        (Self::Lut, ["lut", "Pre-integrated light on a sphere by N·L and curvature, of a material: c, cpp or an image"]),
        (Self::Kernel, ["kernel", "Separable kernel for screen-space scattering, of a material"]),
        (Self::Probe, ["probe", "Sampling of entry points on any shape, as commented reference code"]),
        (Self::Fresnel, ["fresnel", "Reflectance of a dielectric boundary"]),
        (Self::Inversion, ["inversion", "The medium behind a surface albedo, for a g and an eta"]),
        (Self::Material, ["material", "A material with the numbers of OpenPBR Surface: materialx"]),
        (Self::Transmittance, ["transmittance", "Light through thin parts by their thickness, of a material: also as an image"]),
    ];

    /// Every subject.
    pub const ALL: [Self; 10] = values(&Self::ROWS);

    /// Name as the command line writes it.
    pub fn name(self) -> &'static str {
        Self::ROWS[self as usize].1[0]
    }

    /// One line about it.
    pub fn description(self) -> &'static str {
        Self::ROWS[self as usize].1[1]
    }

    /// Returns whether it is a table of a material, and no function.
    pub(crate) fn is_table(self) -> bool {
        match self {
            Self::Profile
            | Self::Sampler
            | Self::Probe
            | Self::Fresnel
            | Self::Inversion
            | Self::Material => false,
            Self::Disk | Self::Lut | Self::Kernel | Self::Transmittance => true,
        }
    }

    /// Returns whether it depends on a model of the profile.
    pub fn has_model(self) -> bool {
        match self {
            Self::Fresnel | Self::Inversion | Self::Material | Self::Transmittance => false,
            Self::Profile | Self::Sampler | Self::Disk | Self::Lut | Self::Kernel | Self::Probe => true,
        }
    }

    /// Returns whether it can go to a target.
    pub(crate) fn goes_to(self, target: Target) -> bool {
        match (self, target) {
            (_, Target::Image(_)) => matches!(self, Self::Lut | Self::Transmittance),
            (Self::Material, _) => target == Target::MaterialX,
            (_, Target::MaterialX | Target::Text(Language::Osl)) => !self.is_table(),
            (Self::Lut, Target::Text(language)) => matches!(language, Language::C | Language::Cpp),
            (_, Target::Text(_)) => true,
        }
    }
}
