//! Subsurface scattering by a walk through the volume itself, without a profile: the truth that profiles approximate.
//!
//! ```text
//! enter the body straight (refracted under a boundary), then
//! loop
//!   draw the length of a flight
//!   if a surface of the body comes first: leave there (or be reflected under a boundary), and go on as a path outside
//!   at the collision: absorb; add light from one sampled light, weighted by MIS; draw a direction by the phase function
//! ```
//!
//! As with profiles the path's throughput is multiplied with T(ωo) where the camera sees the surface, and light that
//! enters counts T(ωi)/T̄, so that A is the share of the light *that entered*; but the quantity that crosses the surface is a
//! radiance, not the irradiance that a profile collects.
//!
//! Under a boundary (η > 1) the surface is a smooth dielectric from inside: it reflects by Fresnel's formula, also totally,
//! and lets the rest out refracted. By reciprocity, the loss on the way out is the loss on the way in. The interface above
//! already accounts for that loss on average, so T(ωi)/T̄ is left out here, or it would count twice. From outside, toward
//! the camera, T(ωo) stands alone for the same reason. Light samples reach collisions refracted by the surface.
//!
//! The walk sees only surfaces of its own subsurface group. Closed meshes of a group may overlap: the walk counts how many
//! it is in, and is outside when there are none.

mod among_shells;
mod attenuation;
mod clear;
mod common_medium;
mod dense;
mod diffuse;
mod exit_plane;
mod flight;
mod flight_kernel;
mod random;
mod refracted;
mod shared;
mod state;
mod through_shells;
mod tilt;

use std::sync::Arc;

use translucid_scene::WalkSurface;

pub(super) use self::shared::SharedCollisions;
use super::Tracer;
use crate::sampling::Sampler;
use crate::subsurface::exit_point::ExitPoint;
use crate::surface::WalkMedium;
use crate::world::{PathState, World};

/// The walks of a material.
pub(crate) struct Walks {
    pub(crate) medium: Arc<WalkMedium>,
    /// Walks of a block of pixels share their light.
    pub(crate) share: bool,
    /// All are in the same medium.
    pub(crate) is_even: bool,
}

impl Walks {
    /// Leaves a surface through the volume below; false where the path is over.
    pub(super) fn scatter<'a, T: Tracer<'a>>(
        &'a self,
        tracer: &mut T,
        world: &'a World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        sampler: &mut Sampler,
    ) -> bool {
        // Through a hole in one mesh of a body, paths see its other meshes from inside. Walks from there count one mesh less
        // than walks that enter through the first mesh, and leave where those continue
        let place = path.in_block.take().filter(|_| self.share && !path.has_passed());
        if let Some(entry) = self.medium.dense_entry(tracer, world, path, exit, sampler) {
            return self.medium.enter_dense(world, path, exit, entry, sampler);
        }
        match self.medium.surface {
            WalkSurface::Clear => self.scatter_clear(tracer, world, path, exit, place, sampler),
            WalkSurface::Diffuse | WalkSurface::Rough | WalkSurface::Skin => {
                self.scatter_diffuse(tracer, world, path, exit, place, sampler)
            }
        }
    }
}
