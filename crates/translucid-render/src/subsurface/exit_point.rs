//! The exit point x_o of a BSSRDF: the point where light leaves the body.

use glam::Vec3;

use super::parameters::Subsurface;
use crate::ray::SurfacePoint;

/// The exit point x_o of light, where a path has met the surface.
#[doc(alias = "BSSRDF")]
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExitPoint<'a> {
    pub(crate) point: &'a SurfacePoint,
    /// Number of its material.
    pub(crate) material: usize,
    /// Shading normal on the outside.
    pub(crate) normal: Vec3,
    /// 1 where the surface is seen from its outside, −1 from its inside.
    pub(crate) side: f32,
    pub(crate) subsurface: Subsurface,
}
