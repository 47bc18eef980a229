//! A surface point that a path has met, and the way on from there.

use glam::Vec3;
use translucid_scene::Material;

use crate::ray::{Ray, SurfacePoint};
use crate::sampling::Frame;
use crate::subsurface::{ExitPoint, Subsurface};
use crate::surface;
use crate::surface::bsdf::{BsdfSample, Lobe, SurfaceParameters};
use crate::world::{Layer, MisOrigin, PathState, World, absorption_behind};

/// A surface point that a path has met.
pub(super) struct Vertex<'a> {
    pub(super) point: &'a SurfacePoint,
    /// Number of the material.
    pub(super) index: usize,
    pub(super) material: &'a Material,
    /// Shading normal on the outside.
    pub(super) normal: Vec3,
    /// Frame of the BSDF's directions.
    pub(super) frame: Frame,
    /// Light that falls here has come straight through clear surfaces; see [`crate::path`].
    pub(super) soft: bool,
    /// The path may not be scattered any more, only pass a body straight.
    pub(super) is_depth_spent: bool,
    /// Light may pass the body below straight.
    pub(super) can_be_passed: bool,
}

impl<'a> Vertex<'a> {
    /// The vertex at a point where the material states `surface`.
    pub(super) fn new(
        world: &'a World,
        path: &PathState,
        point: &'a SurfacePoint,
        surface: &SurfaceParameters,
    ) -> Self {
        let integrator = &world.scene.integrator;
        let (index, material) = world.material(point);
        let normal = surface::shading_normal_at(&world.scene, material, point);
        let normal = surface::facing(normal, point.geometric_normal, -path.ray.direction);
        let is_matte = surface.metalness < 1.0 && surface.transmission_weight < 1.0;
        Self {
            point,
            index,
            material,
            normal,
            frame: Frame::from_normal(normal),
            soft: path.soft || (is_matte && !integrator.caustics),
            is_depth_spent: path.depth >= integrator.max_depth,
            can_be_passed: world.media.of(index).is_some(),
        }
    }

    /// Returns `false` where the path ends by its depth.
    pub(super) fn can_scatter(&self) -> bool {
        !self.is_depth_spent || self.can_be_passed || self.material.geometry_thin_walled
    }

    /// The exit point of light from below, for a path that arrives in a direction.
    pub(super) fn exit_point(&self, incoming: Vec3, subsurface: Subsurface) -> ExitPoint<'a> {
        let side = if incoming.dot(self.point.geometric_normal) > 0.0 { -1.0 } else { 1.0 };
        let Self { point, index: material, normal, .. } = *self;
        ExitPoint { point, material, normal, side, subsurface }
    }

    /// The normal that light selection may rely on: zero where light from both sides counts.
    pub(super) fn light_normal(&self, incoming: Vec3) -> Vec3 {
        if self.material.transmission_weight.factor > 0.0 || self.is_lit_from_behind() {
            Vec3::ZERO
        } else if incoming.dot(self.normal) > 0.0 {
            -self.normal
        } else {
            self.normal
        }
    }

    /// Returns `true` if diffuse light comes through a thin wall.
    fn is_lit_from_behind(&self) -> bool {
        self.material.geometry_thin_walled && self.material.subsurface_weight.factor > 0.0
    }

    /// Returns `true` if a direction drawn from the BSDF leads straight through a thin wall, as light samples go that this path
    /// has taken before. The camera has taken none, and sees what is behind as through any glass.
    pub(super) fn lets_straight_through(&self, path: &PathState, lobe: Lobe, transmitted: bool) -> bool {
        self.material.geometry_thin_walled && transmitted && lobe == Lobe::Delta && path.depth > 0
    }

    /// Goes on in a direction drawn from the BSDF; false where the path is over.
    pub(super) fn follow(&self, path: &mut PathState, drawn: &BsdfSample) -> bool {
        let BsdfSample::Direction { wi, weight, diffuse_share, pdf, lobe, transmitted } = *drawn else {
            return false;
        };
        let direction = self.frame.to_world(wi).normalize();
        let geometric = self.point.geometric_normal;
        let to = direction.dot(geometric);
        // The shading normal promised one side, the geometry has another: such light cannot be.
        if (-path.ray.direction.dot(geometric) * to < 0.0) != transmitted {
            return false;
        }
        if transmitted {
            if self.lets_straight_through(path, lobe, transmitted) {
                return path.pass(self.point, weight);
            }
            path.absorption = absorption_behind(self.material, self.point, direction, path.absorption);
        }
        let origin = MisOrigin {
            point: self.point.position,
            normal: self.light_normal(path.ray.direction),
            pdf: if pdf > 0.0 { pdf } else { f32::INFINITY },
            is_refracted: false,
        };
        let ray = Ray::new(self.point.ray_origin(direction), direction);
        path.diffuse_depth += u32::from(lobe == Lobe::Diffuse);
        // A mirror direction takes no part in MIS and sees clear bodies as they are.
        path.soft |= self.soft && pdf > 0.0;
        path.scatter(Layer::Surface(diffuse_share), ray, weight, origin);
        path.throughput != Vec3::ZERO
    }
}
