//! Light that passes a body without being scattered in it.
//!
//! Shadow rays have to pass every body that paths may pass. Otherwise light samples, and paths that meet the lights, would
//! not be two ways of finding the same light. With T the factors of the surface on both sides, both have the transmittance
//!
//! ```text
//! T(ωo) e^{−σ_t d} T(ωi) / T̄
//! ```
//!
//! per channel. Surfaces that may also be passed in another way (partly opaque, partly clear, partly metal) are left to
//! paths: a shadow ray follows one way only.

use std::sync::Arc;

use glam::Vec3;
use translucid_profile::split_mix::{STEP, split_mix};

use super::World;
use crate::ray::{Body, FlightEnd, SurfacePoint};
use crate::sampling::Frame;
use crate::surface::bsdf::{Bsdf, EntryBsdf};
use crate::surface::{self, WalkMedium};

/// The media that light may pass straight, by material.
#[derive(Default)]
pub(crate) struct Media(Vec<Option<Arc<WalkMedium>>>);

impl Media {
    /// Those of the given media that have no boundary at all.
    pub(crate) fn new<'a>(media: impl Iterator<Item = Option<&'a Arc<WalkMedium>>>) -> Self {
        Self(media.map(|medium| medium.filter(|medium| medium.is_matched()).cloned()).collect())
    }

    /// Returns `true` if there are any.
    pub(crate) fn any(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    pub(crate) fn of(&self, material: usize) -> Option<&WalkMedium> {
        self.0.get(material)?.as_deref()
    }
}

/// A body that was passed.
pub(super) struct Passage {
    pub(super) transmittance: Vec3,
    /// Way through the body \[L\].
    pub(super) distance: f32,
    /// Where it ends.
    pub(super) end: SurfacePoint,
}

/// Limits of a ray.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    /// Distance \[L\] at which it ends.
    pub(super) distance: f32,
    /// Transmittance below which nothing is left of it.
    pub(super) transmittance: f32,
    /// A number that differs from ray to ray, or from sample to sample.
    pub(super) random: f32,
}

impl World {
    /// Returns `true` if shadow rays pass the body below a surface as paths do.
    pub(crate) fn is_passed_by_shadow_rays(&self, point: &SurfacePoint, soft: bool) -> bool {
        let (_, material) = self.material(point);
        let surface = surface::parameters_at(&self.scene, material, point);
        let is_opaque = surface::opacity_at(&self.scene, material, point) >= 1.0;
        is_opaque && surface.metalness == 0.0 && (!soft || surface.transmission_weight == 0.0)
    }

    /// Factor of a surface on a radiance that enters from a direction, T(ωi)/T̄ and tints; `side` is that of the body.
    pub(crate) fn entering(&self, point: &SurfacePoint, direction: Vec3, side: f32) -> Vec3 {
        let (index, material) = self.material(point);
        let parameters = surface::parameters_at(&self.scene, material, point);
        let normal = surface::shading_normal_at(&self.scene, material, point) * side;
        EntryBsdf::new(&parameters, self.surfaces.of(index)).weight(direction.dot(normal).max(0.0))
    }

    /// Light along a direction through the body below a surface that it meets.
    pub(super) fn pass_straight(
        &self,
        medium: &WalkMedium,
        point: &SurfacePoint,
        direction: Vec3,
        soft: bool,
        reach: Reach,
    ) -> Option<Passage> {
        let (index, material) = self.material(point);
        let albedo = surface::surface_albedo_at(&self.scene, material, point);
        let stated = surface::stated_length_at(&self.scene, material, point);
        let length = medium.resolved(albedo, stated, point.offset);
        let scatters = length.cmpgt(Vec3::ZERO);
        if !scatters.any() {
            return None;
        }
        let side = if direction.dot(point.geometric_normal) > 0.0 { -1.0 } else { 1.0 };
        let body = Body::below(&self.scene, &self.geometry, point, side);
        let shells = medium.shells(&body, &self.scene.objects, (albedo, length), point.offset);
        let length = shells.map_or(length, |shells| shells.least().recip());
        // Beyond, the last channel is dark
        let visible = -libm::logf(reach.transmittance) * length.max_element();
        let (start, skipped) = body.enter(point, direction)?;
        let FlightEnd::Boundary { distance, hit } = body.fly(start, direction, visible) else { return None };
        let distance = distance + skipped;
        // Lights inside are not seen
        if distance >= reach.distance {
            return None;
        }
        let normal = surface::shading_normal_at(&self.scene, material, point);
        // As paths look below
        let brightest = if direction.dot(normal) < 0.0 { medium.brightest(albedo) } else { albedo };
        let mut surface =
            surface::parameters_at(&self.scene, material, point).with_subsurface(brightest, scatters);
        if soft {
            surface = surface.seen_softly();
        }
        let wo = Frame::from_normal(normal).to_local(-direction);
        let seen = Bsdf::new(&surface, self.surfaces.of(index), wo).below();
        let mut attenuation = Vec3::select(scatters, -distance / length, Vec3::NEG_INFINITY).exp();
        if let Some(shells) = &shells {
            let bits = point.position.to_array().map(|x| u64::from(x.to_bits()));
            let seed =
                bits.into_iter().fold(u64::from(reach.random.to_bits()), |seed, x| split_mix(seed ^ x));
            let mut numbers = (0..).map(|n: u64| split_mix(seed.wrapping_add(STEP.wrapping_mul(n))));
            let number = move || numbers.next().map_or(0.0, |bits| (bits >> 40) as f32 / 16_777_216.0);
            attenuation *=
                shells.transmittance_beyond_least(&body, (point.position, direction, distance), number);
        }
        let end = self.surface_point(&hit);
        let transmittance = seen * attenuation * self.entering(&end, direction, side);
        Some(Passage { transmittance, distance, end })
    }
}
