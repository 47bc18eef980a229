//! Parameters of a material and its light that a picture is to determine.

use crate::error::MeasureError;

/// A parameter to be found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// Surface albedo A of each channel.
    SurfaceAlbedo,
    /// Mean free path ℓ of each channel.
    Mfp,
    /// Mean cosine of the phase function.
    G,
    /// Factor on the radiance of all lights, for each channel.
    Radiance,
}

impl Unknown {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::SurfaceAlbedo, Self::Mfp, Self::G, Self::Radiance];

    /// Name, as options have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::SurfaceAlbedo => "material.surface_albedo",
            Self::Mfp => "material.mfp",
            Self::G => "material.g",
            Self::Radiance => "light.radiance",
        }
    }

    /// The parameters of some names.
    ///
    /// # Errors
    /// There is none of a name, or it is named twice.
    pub fn of_names(names: &[impl AsRef<str>]) -> Result<Vec<Self>, MeasureError> {
        let mut found = Vec::new();
        for name in names.iter().map(|name| name.as_ref().trim()) {
            let Some(unknown) = Self::ALL.into_iter().find(|unknown| unknown.name() == name) else {
                let all = Self::ALL.map(Self::name).join(", ");
                return Err(MeasureError::new(format!("`fit` is {name:?}, but the parameters are {all}")));
            };
            if found.contains(&unknown) {
                return Err(MeasureError::new(format!("`fit` names {name} twice")));
            }
            found.push(unknown);
        }
        Ok(found)
    }

    /// Name of what is measured of it, and its unit.
    pub(crate) fn quantity(self) -> [&'static str; 2] {
        match self {
            Self::SurfaceAlbedo => ["surface_albedo", ""],
            Self::Mfp => ["mfp", "scene unit"],
            Self::G => ["g", ""],
            Self::Radiance => ["radiance_scale", ""],
        }
    }

    /// Whether each channel has its own.
    pub(crate) fn is_per_channel(self) -> bool {
        self != Self::G
    }

    /// Whether it takes pictures to know its derivative.
    pub(crate) fn is_rendered(self) -> bool {
        self != Self::Radiance
    }

    /// The parameter on a scale without ends: ln A/(1 − A), ln ℓ, artanh g.
    pub(crate) fn unbounded(self, value: f64) -> f64 {
        match self {
            Self::SurfaceAlbedo => libm::log(value / (1.0 - value)),
            Self::Mfp | Self::Radiance => libm::log(value),
            Self::G => libm::atanh(value),
        }
    }

    pub(crate) fn bounded(self, x: f64) -> f64 {
        match self {
            Self::SurfaceAlbedo => 1.0 / (1.0 + libm::exp(-x)),
            Self::Mfp | Self::Radiance => libm::exp(x),
            Self::G => libm::tanh(x),
        }
    }

    /// Change between the two sides of a difference, on the unbounded scale: far enough apart to stand out of the noise.
    pub(crate) fn difference(self) -> f64 {
        match self {
            Self::SurfaceAlbedo => 0.6,
            Self::Mfp | Self::Radiance => 0.5,
            Self::G => 0.3,
        }
    }

    /// Longest step on that scale, and the greatest distance from zero.
    pub(crate) fn limits(self) -> [f64; 2] {
        match self {
            // 0.0009 … 0.9991
            Self::SurfaceAlbedo => [1.0, 7.0],
            Self::Mfp => [0.8, 30.0],
            Self::G => [0.4, 2.0],
            Self::Radiance => [1.5, 60.0],
        }
    }
}

/// Values of all parameters, known or to be found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guess {
    /// Surface albedo A, in (0, 1).
    pub surface_albedo: [f64; 3],
    /// Mean free path ℓ \[L\].
    pub mfp: [f64; 3],
    /// Mean cosine of the phase function.
    pub g: f64,
    /// Factor on the radiance of all lights.
    pub radiance: [f64; 3],
}

impl Guess {
    /// A parameter's value in a channel.
    pub fn get(&self, unknown: Unknown, channel: usize) -> f64 {
        match unknown {
            Unknown::SurfaceAlbedo => self.surface_albedo[channel],
            Unknown::Mfp => self.mfp[channel],
            Unknown::G => self.g,
            Unknown::Radiance => self.radiance[channel],
        }
    }

    pub(crate) fn set(&mut self, unknown: Unknown, channel: usize, value: f64) {
        match unknown {
            Unknown::SurfaceAlbedo => self.surface_albedo[channel] = value,
            Unknown::Mfp => self.mfp[channel] = value,
            Unknown::G => self.g = value,
            Unknown::Radiance => self.radiance[channel] = value,
        }
    }

    /// The guess with a parameter moved by half a difference on its unbounded scale; up for 1, down for −1.
    pub(crate) fn moved(&self, unknown: Unknown, sign: f64) -> Self {
        let mut moved = *self;
        for channel in 0..3 {
            let x = unknown.unbounded(self.get(unknown, channel));
            moved.set(unknown, channel, unknown.bounded(x + 0.5 * sign * unknown.difference()));
            if unknown == Unknown::G {
                break;
            }
        }
        moved
    }
}
