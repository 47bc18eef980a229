//! Ways to find the light under a surface. Each material has one; a scene may gather light from points instead.
//!
//! ```text
//! probes/   segments near the exit point draw an entry point; the path goes on from there
//! shared/   probes, but the light that enters below one pixel serves the pixels around it
//! walk/     the volume itself, collision by collision; neighbors share the ends of their flights
//! points/   a sum over points all over the surface, whose light is known beforehand
//! ```
//!
//! `gathering` shares light among the pixels of a block.
//!
//! A new transport is a folder here and a variant of [`SubsurfaceTransport`].

mod gathering;
pub(crate) mod points;
pub(crate) mod probes;
mod shared;
mod simd_loop;
pub(crate) mod walk;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_scene::{Material, Scene};

use super::exit_point::ExitPoint;
use super::parameters::Subsurface;
use crate::ray::SurfacePoint;
use crate::sampling::Sampler;
use crate::surface::bsdf::SurfaceParameters;
use crate::surface::{self, WalkMedium};
use crate::world::{Layer, PathState, PixelWidth, World};
use points::GatherScratch;
use probes::{ProbeScratch, Probes};
use shared::SharedEntries;
use walk::{SharedCollisions, Walks};

/// The way in which light under the surface of a material is found.
#[doc(alias = "BSSRDF")]
pub(crate) enum SubsurfaceTransport {
    /// Light leaves where it enters.
    Lambertian,
    Probes(Probes),
    /// Paths in a block of pixels share their entry points, others have probes alone.
    Shared(Probes),
    Walk(Walks),
}

/// The path tracer as a transport sees it.
pub(crate) trait Tracer<'a> {
    /// Memory of this thread.
    fn scratch(&mut self) -> &mut TransportScratch<'a>;

    /// Follows a path to its end.
    fn follow(&mut self, path: &mut PathState, sampler: &mut Sampler);

    /// Factor on light that leaves at a point, for its shape.
    fn shape_factor(&mut self, exit: &ExitPoint<'_>) -> Vec3;

    /// Width of a pixel of the picture.
    fn pixel_width(&self) -> PixelWidth;
}

/// Memory of the transports of one thread.
#[derive(Default)]
pub(crate) struct TransportScratch<'a> {
    probes: ProbeScratch,
    pub(crate) points: GatherScratch,
    shared: SharedEntries<'a>,
    collisions: SharedCollisions<'a>,
}

impl TransportScratch<'_> {
    /// Calls `add` with the number of the sample, the layer and the light for every exit point of a block that others
    /// have light for, or for some if stopped, and forgets the block.
    pub(crate) fn finish_block(&mut self, stop: &AtomicBool, mut add: impl FnMut(usize, Layer, Vec3)) {
        self.shared.resolve(stop, &mut add);
        self.collisions.resolve(stop, add);
    }

    /// Forgets a block without its light.
    pub(crate) fn drop_block(&mut self) {
        self.shared.clear();
        self.collisions.clear();
    }
}

impl SubsurfaceTransport {
    /// Parameters of the medium below a point of a material that has this transport.
    pub(crate) fn at(&self, scene: &Scene, material: &Material, point: &SurfacePoint) -> Subsurface {
        if let Some(Subsurface { surface_albedo, length }) = self.own() {
            return Subsurface { surface_albedo, length: self.length(surface_albedo, length, point.offset) };
        }
        let surface_albedo = surface::surface_albedo_at(scene, material, point);
        if matches!(self, Self::Lambertian) {
            return Subsurface { surface_albedo, length: Vec3::ZERO };
        }
        let stated = surface::stated_length_at(scene, material, point);
        Subsurface { surface_albedo, length: self.length(surface_albedo, stated, point.offset) }
    }

    /// Surface albedos and lengths that count in place of those that the material states.
    pub(super) fn own(&self) -> Option<Subsurface> {
        self.probes().and_then(|probes| probes.kernel.own())
    }

    /// Lengths as the transport uses them, 0 in channels whose light leaves too near its entry for positions with a rounding
    /// error of `offset` to resolve.
    pub(super) fn length(&self, surface_albedo: Vec3, stated: Vec3, offset: f32) -> Vec3 {
        match self {
            Self::Lambertian => Vec3::ZERO,
            Self::Probes(probes) | Self::Shared(probes) => {
                probes.kernel.resolved(surface_albedo, stated, offset)
            }
            Self::Walk(walks) => walks.medium.resolved(surface_albedo, stated, offset),
        }
    }

    /// The medium, where the transport walks through it.
    pub(crate) fn medium(&self) -> Option<&Arc<WalkMedium>> {
        if let Self::Walk(walks) = self { Some(&walks.medium) } else { None }
    }

    /// The probes, where the transport knows a profile.
    pub(crate) fn probes(&self) -> Option<&Probes> {
        match self {
            Self::Lambertian | Self::Walk(_) => None,
            Self::Probes(probes) | Self::Shared(probes) => Some(probes),
        }
    }

    /// Makes paths look below a material where an exit is dark, but light may have entered where it is bright, or have been
    /// scattered by a brighter layer.
    pub(crate) fn brighten(&self, surface: &mut SurfaceParameters) {
        if let Some(medium) = self.medium().filter(|_| surface.subsurface_active != Vec3::ZERO) {
            surface.surface_albedo = medium.brightest(surface.surface_albedo);
        }
        if let Some(pairing) = self.probes().and_then(|probes| probes.pairing.as_ref()) {
            pairing.brighten(surface);
        }
    }

    /// Returns `true` if light that has left another diffuse surface toward this one leaves it where it enters.
    pub(crate) fn is_lambertian_behind_diffuse(&self) -> bool {
        matches!(self, Self::Probes(probes) | Self::Shared(probes) if probes.is_disk)
    }

    /// Leaves a surface through the medium below; false where the path is over.
    pub(crate) fn scatter<'a, T: Tracer<'a>>(
        &'a self,
        tracer: &mut T,
        world: &'a World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        sampler: &mut Sampler,
    ) -> bool {
        match self {
            Self::Lambertian => false,
            Self::Probes(probes) => probes.scatter(tracer, world, path, exit, sampler),
            Self::Shared(probes) => shared::scatter(probes, tracer, world, path, exit, sampler),
            Self::Walk(walks) => walks.scatter(tracer, world, path, exit, sampler),
        }
    }
}
