//! A path under way: its place, its throughput, and the light that it has found.

use glam::Vec3;

use super::direct_light::power_heuristic;
use super::{BlockPlace, PixelSample};
use crate::light::refracted_pdf;
use crate::ray::{Ray, SurfacePoint};

/// Surfaces that a path may pass straight through in a row, against endless loops.
const MOST_PASSES: u32 = 256;

/// Difference between the vertex numbers of a path and of one [beside](PathState::beside) it, so that they draw other random
/// numbers; few paths have as many vertices.
const BESIDE: u32 = 1 << 16;

/// Layer of the image that a path brings light to: the first scattering event decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Layer {
    Emission,
    /// Reflected or transmitted by the surface; the share that is matte, per channel.
    Surface(Vec3),
    Subsurface,
}

impl Layer {
    pub(crate) fn add(self, sample: &mut PixelSample, light: Vec3) {
        match self {
            Self::Emission => sample.emission += light,
            Self::Surface(diffuse_share) => {
                sample.diffuse += light * diffuse_share;
                sample.specular += light * (1.0 - diffuse_share);
            }
            Self::Subsurface => sample.subsurface += light,
        }
    }
}

/// The last point at which the path was scattered, for MIS.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MisOrigin {
    pub(crate) point: Vec3,
    /// Normal given to the light selection.
    pub(crate) normal: Vec3,
    /// Solid-angle density of the direction taken; infinite where lights could not be sampled instead.
    pub(crate) pdf: f32,
    /// Light samples reach this point only refracted by a surface.
    pub(crate) is_refracted: bool,
}

impl MisOrigin {
    /// Weight of light that the path has met, given the density with which lights are sampled for it at a point with a
    /// normal.
    pub(crate) fn weight(&self, light_pdf: impl FnOnce(Vec3, Vec3) -> f32) -> f32 {
        if !self.pdf.is_finite() {
            return 1.0;
        }
        let density = light_pdf(self.point, self.normal);
        power_heuristic(self.pdf, if self.is_refracted { refracted_pdf(density) } else { density })
    }
}

/// A path from the camera, or from an entry point of light.
pub(crate) struct PathState {
    pub(crate) ray: Ray,
    pub(crate) throughput: Vec3,
    pub(crate) layer: Layer,
    pub(crate) origin: MisOrigin,
    pub(crate) depth: u32,
    pub(crate) diffuse_depth: u32,
    passes: u32,
    /// It has met a surface that the camera sees, whether that has scattered it or not.
    pub(crate) has_met: bool,
    /// The path has left a matte surface with caustics off; see [`crate::path`].
    pub(crate) soft: bool,
    /// Number of the vertex, the camera's being 0.
    pub(crate) vertex: u32,
    /// It goes on [beside](Self::beside) a path, and has met no surface since but mirrors.
    pub(crate) is_beside: bool,
    /// Mirrors alone have scattered it: it sees what the camera sees.
    pub(crate) is_mirrored: bool,
    /// Absorption coefficient of the clear medium around the ray [1/L].
    pub(crate) absorption: Vec3,
    pub(crate) sample: PixelSample,
    /// Its pixel's place in the block, until the block takes over its light under a surface.
    pub(crate) in_block: Option<BlockPlace>,
}

impl PathState {
    pub(crate) fn new(ray: Ray) -> Self {
        Self {
            ray,
            throughput: Vec3::ONE,
            layer: Layer::Emission,
            origin: MisOrigin {
                point: ray.origin,
                normal: Vec3::ZERO,
                pdf: f32::INFINITY,
                is_refracted: false,
            },
            depth: 0,
            diffuse_depth: 0,
            passes: 0,
            has_met: false,
            soft: false,
            vertex: 0,
            is_beside: false,
            is_mirrored: true,
            absorption: Vec3::ZERO,
            sample: PixelSample::default(),
            in_block: None,
        }
    }

    /// A path that goes on from here under a surface with this throughput; it counts its light separately.
    pub(crate) fn branch(&self, throughput: Vec3) -> Self {
        Self { throughput, layer: Layer::Subsurface, sample: PixelSample::default(), in_block: None, ..*self }
    }

    /// A copy of the path that goes on from here in another way, with random numbers of its own.
    pub(crate) fn beside(&self) -> Self {
        Self { vertex: self.vertex + BESIDE, is_beside: true, ..*self }
    }

    /// Adds light of the given radiance at the path's end to its layer.
    pub(crate) fn add(&mut self, radiance: Vec3) {
        let light = self.throughput * radiance;
        self.add_to(self.layer, light);
    }

    pub(crate) fn add_to(&mut self, layer: Layer, light: Vec3) {
        layer.add(&mut self.sample, light);
    }

    /// The layer, given the kind of the event at hand.
    pub(crate) fn layer_after(&self, event: Layer) -> Layer {
        if self.layer == Layer::Emission { event } else { self.layer }
    }

    /// Goes on in a new direction.
    pub(crate) fn scatter(&mut self, event: Layer, ray: Ray, weight: Vec3, origin: MisOrigin) {
        self.layer = self.layer_after(event);
        self.is_mirrored &= matches!(event, Layer::Surface(_)) && origin.pdf == f32::INFINITY;
        self.throughput *= weight;
        self.ray = ray;
        self.origin = origin;
        self.depth += 1;
        self.passes = 0;
    }

    /// Returns `true` if what it meets is seen by the camera itself, over holes at most: not through a body.
    pub(crate) fn is_of_camera(&self) -> bool {
        self.depth == 0 && !self.has_met
    }

    /// Returns `true` if it has passed a surface since it was scattered.
    pub(crate) fn has_passed(&self) -> bool {
        self.passes > 0
    }

    /// Goes on behind the surface in the same direction; the MIS origin stays. False where the path is over.
    pub(crate) fn pass(&mut self, point: &SurfacePoint, transmittance: Vec3) -> bool {
        self.throughput *= transmittance;
        self.ray = Ray::new(point.ray_origin(self.ray.direction), self.ray.direction);
        self.passes += 1;
        self.passes < MOST_PASSES && self.throughput != Vec3::ZERO
    }
}
