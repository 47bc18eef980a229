//! Layers below a surface.

use glam::Vec3;

/// A layer that follows the surface of a body: the medium of the points from one distance to the surface to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubsurfaceLayer {
    /// Thickness \[L\], > 0.
    pub thickness: f32,
    /// What its medium scatters and absorbs.
    pub medium: LayerMedium,
    /// Mean cosine of the phase function, in (−1, 1).
    pub g: f32,
}

/// The medium of a layer, per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LayerMedium {
    /// What an endless layer of it looks like.
    Appearance {
        /// Share of diffuse light that it returns, without a boundary.
        surface_albedo: Vec3,
        /// Mean free path \[L\].
        mfp: Vec3,
    },
    /// Its coefficients.
    Coefficients {
        /// Scattering coefficient σ_s \[L⁻¹\].
        scattering: Vec3,
        /// Absorption coefficient σ_a \[L⁻¹\].
        absorption: Vec3,
    },
}

impl SubsurfaceLayer {
    /// Most layers of a material.
    pub const MOST: usize = 100;
}
