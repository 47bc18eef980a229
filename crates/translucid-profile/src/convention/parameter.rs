//! The parameters by which a system is told a material.

/// Name of the mean cosine of Cycles' walks.
pub(super) const WALK_G: &str = "subsurface_anisotropy";

/// A parameter of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name in the system.
    pub name: &'static str,
    /// Role in the product of the length.
    pub role: Role,
}

/// Role of a parameter; the product of all lengths, distances and factors is the system's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// A number for each channel: a length, or a part of one beside a [`Distance`](Self::Distance).
    Length,
    /// One number for all channels that a conversion may choose: the greatest length.
    Distance,
    /// A color of each channel in [0, 1): the light that is left after the [`Distance`](Self::Distance), which makes the length
    /// that distance over −ln of the color.
    Attenuation,
    /// A color of each channel in (0, 1] that is no factor of the length; white changes nothing.
    Filter,
    /// One number for all channels whose customary value is `default`; the length is multiplied by value/`per`.
    Factor {
        /// Value that the system starts with.
        default: f64,
        /// Value that changes nothing.
        per: f64,
    },
    /// One number for all channels that is no factor of the length, in the open interval.
    Setting {
        /// Value that the system starts with.
        default: f64,
        /// The value must be greater.
        above: f64,
        /// The value must be less.
        below: f64,
        /// Both in words, to follow "must be".
        allowed: &'static str,
    },
    /// Absorption coefficient σ_a of each channel \[L⁻¹\], at least 0.
    Absorption,
    /// Scattering coefficient σ_s of each channel \[L⁻¹\], at least 0.
    Scattering,
}

impl Role {
    /// The parameter of a name that has this role.
    pub(super) const fn named(self, name: &'static str) -> Parameter {
        Parameter { name, role: self }
    }

    /// Returns whether each channel has its own value.
    pub fn is_per_channel(self) -> bool {
        matches!(self, Self::Length | Self::Attenuation | Self::Filter | Self::Absorption | Self::Scattering)
    }

    /// Returns whether it is part of the length, so that stating it states one.
    pub(super) fn is_of_length(self) -> bool {
        matches!(self, Self::Length | Self::Distance | Self::Attenuation)
    }

    /// Default value.
    pub fn default(self) -> f64 {
        match self {
            Self::Length | Self::Distance | Self::Attenuation | Self::Filter => 1.0,
            Self::Factor { default, .. } | Self::Setting { default, .. } => default,
            Self::Absorption | Self::Scattering => 0.0,
        }
    }
}
