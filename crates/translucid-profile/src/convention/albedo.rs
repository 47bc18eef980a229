//! The surface albedo of one channel, and of the channel that reflects most.

use crate::error::{ParameterError, require, require_fraction};

/// Surface albedo A of one channel in [0, 1], with the greatest among the channels of the same material.
///
/// Rules ask for the second only where a system divides by it (Blender EEVEE).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAlbedo {
    of_channel: f64,
    greatest: f64,
}

impl SurfaceAlbedo {
    /// One channel of several.
    ///
    /// # Errors
    /// A value is not in [0, 1], or the greatest is less than that of the channel.
    pub fn new(of_channel: f64, greatest: f64) -> Result<Self, ParameterError> {
        require_fraction("surface_albedo", of_channel)?;
        require_fraction("greatest", greatest)?;
        require(greatest >= of_channel, "greatest", greatest, "at least the channel's surface_albedo")?;
        Ok(Self { of_channel, greatest })
    }

    /// The only channel, or one of several that are alike.
    ///
    /// # Errors
    /// The value is not in [0, 1].
    pub fn gray(surface_albedo: f64) -> Result<Self, ParameterError> {
        Self::new(surface_albedo, surface_albedo)
    }

    /// Both albedos by a function that rises.
    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Result<Self, ParameterError> {
        let of_channel = f(self.of_channel);
        Self::new(of_channel, f(self.greatest).max(of_channel))
    }

    /// Surface albedo A of this channel.
    pub fn of_channel(self) -> f64 {
        self.of_channel
    }

    /// Greatest surface albedo among the channels.
    pub fn greatest(self) -> f64 {
        self.greatest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn new_refuses_what_is_no_albedo() {
        assert!(SurfaceAlbedo::new(0.5, 0.4).is_err());
        assert!(SurfaceAlbedo::new(f64::NAN, 1.0).is_err() && SurfaceAlbedo::new(0.5, 1.1).is_err());
        assert!(SurfaceAlbedo::gray(-0.1).is_err());
        assert_eq!(SurfaceAlbedo::gray(1.0).unwrap().greatest(), 1.0);
    }
}
