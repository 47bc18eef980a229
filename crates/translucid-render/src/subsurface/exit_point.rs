//! A point that light leaves.

use glam::Vec3;

use super::parameters::Subsurface;
use crate::ray::SurfacePoint;

/// The point that light leaves, as a path has met it.
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
