//! Bodies so dense that light leaves them near where it enters, as far as the picture can show.
//!
//! As the mean free path ℓ gets short, walks become the reflection of a [half space](HalfSpace), which is known. A walk of
//! hundreds of collisions only adds noise and time then. In place of it light leaves where it enters, where it travels less
//! than a width that is seen as one, and where three rays from some way below come straight to the surface around the
//! place, and not far from its plane: the body is thick there, and nearly flat. Limits are drawn at random for each walk, so
//! that no border shows.
//!
//! The curvature of the body counts to first order. One that bends away lets out more light than a half space: in light that
//! is alike everywhere a ball of radius R shows 1 + C ℓ/R times its albedo. The rays meet the surface at a mean height h
//! above the plane of the place, which is −r²/2R at a distance r, so that the mean of
//!
//! ```text
//! 1 − 2 C ℓ h / r²
//! ```
//!
//! is right to the first order for any shape, folds of two faces included. Of three rays at equal angles the mean height is
//! the same however they are turned, and tells nothing of a tilt, so that a place that is flat for some turns only is not
//! taken for flatter than it is.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use translucid_law::HenyeyGreenstein;
use translucid_profile::scaling_from_mfp_diffuse;
use translucid_profile::split_mix::split_mix;
use translucid_scene::WalkSurface;

use super::clear::is_last;
use crate::ray::Body;
use crate::sampling::{Frame, Sampler};
use crate::subsurface::entry_point::EntryPoint;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::kernel::{DirectionalWeight, HalfSpace};
use crate::subsurface::parameters::Subsurface;
use crate::subsurface::transport::Tracer;
use crate::surface::WalkMedium;
use crate::world::{PathState, PixelWidth, World};

/// Mean distances that light travels, in widths that are seen as one: light leaves where it enters at the first, in no case
/// from the second on.
const POINTLIKE: [f32; 2] = [0.25, 1.0];

/// Share of the light on a slab's back that comes through, below which the slab is thick.
const LEAST_TRANSMITTANCE: f32 = 5e-3;

/// Width that is seen as one from a matte surface, over the distance.
const WIDTH_FROM_MATTE: f32 = 0.1;

/// Distance from a place at which it is looked at whether it is flat, over the mean distance that light travels.
const RADIUS: f32 = 4.0;

/// Greatest slope at which a surface is flat.
const GREATEST_SLOPE: f32 = 0.1;

/// C of the head of the module.
///
/// About the same for every surface albedo and every surface of walks, as balls in even light show.
const OF_CURVATURE: f32 = 1.38;

/// So that no other random numbers of the vertex are the same.
const SALT: u64 = 0x6f8b_1d3e_52c9_a047;

/// Where light enters that leaves a place without a walk.
pub(super) struct DenseEntry {
    half_space: HalfSpace,
    /// The path's throughput, without the albedo.
    throughput: Vec3,
}

impl WalkMedium {
    /// The entry of light that leaves without a walk; `None` where there has to be one.
    pub(super) fn dense_entry<'a, T: Tracer<'a>>(
        &self,
        tracer: &T,
        world: &World,
        path: &PathState,
        exit: &ExitPoint<'_>,
        sampler: &Sampler,
    ) -> Option<DenseEntry> {
        let is_known = HenyeyGreenstein::new(self.g).is_isotropic() && !self.has_shells();
        if !is_known || self.surface == WalkSurface::Clear && self.eta != 1.0 {
            return None;
        }
        let Subsurface { surface_albedo, length } = exit.subsurface;
        let scatters = path.throughput.cmpgt(Vec3::ZERO) & length.cmpgt(Vec3::ZERO);
        let throughput = Vec3::select(scatters, path.throughput, Vec3::ZERO);
        let scaling = surface_albedo.map(|albedo| scaling_from_mfp_diffuse(f64::from(albedo)) as f32);
        let travel = Vec3::select(scatters, MEAN_RADIUS * length / scaling, Vec3::ZERO);
        let travel = travel.max_element();
        let width = width_of_view(tracer.pixel_width(), path, exit.point.position);
        let [of_limit, of_depth, of_angle] = three_numbers(split_mix(sampler.fork() ^ SALT));
        let [all, none] = POINTLIKE;
        if travel.is_nan() || travel >= width * (all + (none - all) * of_limit) {
            return None;
        }

        // Three rays from below, around the place: whether the body is thick and flat, and how it bends
        let alpha = self.single_scattering_albedo(surface_albedo);
        let depth =
            Vec3::select(scatters, thickness(alpha) * length, Vec3::ZERO).max_element() * (1.0 + of_depth);
        let body = Body::below(&world.scene, &world.geometry, exit.point, exit.side);
        let frame = Frame::from_normal(exit.point.geometric_normal);
        let beside = |distance: f32, angle: f32| {
            let (sin, cos) = libm::sincosf(TAU * angle);
            let offset = frame.to_world(Vec3::new(distance * cos, distance * sin, 0.0));
            let most = GREATEST_SLOPE * distance + exit.point.offset;
            let height = body.height_beside(exit.point, offset, depth, 2.0 * most)?;
            (height.abs() <= most).then_some(height)
        };
        let radius = RADIUS * travel;
        let around = |third: f32| beside(radius, of_angle + third / 3.0);
        let height = (around(0.0)? + around(1.0)? + around(2.0)?) / 3.0;
        let curved = 1.0 - length * (2.0 * OF_CURVATURE * height / (radius * radius));

        let throughput = Vec3::select(scatters, throughput * curved, Vec3::ZERO);
        Some(DenseEntry { half_space: HalfSpace::new(alpha), throughput })
    }

    /// Goes on where light enters that leaves without a walk; false where the path is over.
    pub(super) fn enter_dense(
        &self,
        world: &World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        DenseEntry { half_space, throughput }: DenseEntry,
        sampler: &mut Sampler,
    ) -> bool {
        let outward = exit.point.geometric_normal * exit.side;
        let numbers = [sampler.reserve(), sampler.reserve()];
        if self.surface == WalkSurface::Clear {
            if is_last(world, path) {
                return false;
            }
            path.throughput = throughput;
            let entry = EntryPoint::flat(world, *exit.point, exit.side);
            let reflection = half_space.reflection(entry.normal, -path.ray.direction.dot(outward));
            return entry.enter(path, &DirectionalWeight::HalfSpace(reflection), numbers);
        }
        let [a, b, ..] = sampler.next_4d();
        let Some(direction) = self.direction_below(world, path, exit, [a, b]) else { return false };
        path.throughput = throughput * half_space.albedo(-direction.dot(outward));
        EntryPoint::new(world, *exit.point, exit.side).enter(path, &DirectionalWeight::Radial, numbers)
    }
}

/// Width \[L\] that a path sees as one at a place: that of a pixel, or of a part of what a matte surface has its light from.
fn width_of_view(pixel: PixelWidth, path: &PathState, place: Vec3) -> f32 {
    if path.depth == 0 {
        return pixel.at(path.sample.depth);
    }
    let distance = path.origin.point.distance(place);
    if !path.origin.pdf.is_finite() {
        return pixel.at(path.sample.depth + distance);
    }
    // Of a cosine distribution along the normal; of a narrower one as much less
    let spread = (path.origin.pdf * PI).max(1.0).sqrt().recip();
    (WIDTH_FROM_MATTE * spread * distance).max(pixel.at(path.sample.depth))
}

/// Mean distance that light travels by normalized diffusion, over its d [Christensen & Burley 2015].
const MEAN_RADIUS: f32 = 2.5;

/// Thickness, in mean free paths, of a slab that lets no more than [`LEAST_TRANSMITTANCE`] through: 4/3 κ / sinh(κ t) by
/// diffusion, with κ² = 3 (1 − α), or a little thicker.
fn thickness(alpha: Vec3) -> Vec3 {
    alpha.map(|alpha| {
        let rate = (3.0 * (1.0 - alpha)).max(1e-6).sqrt().min(1.0);
        libm::logf(1.0 + 8.0 / 3.0 * rate / LEAST_TRANSMITTANCE) / rate
    })
}

/// Three numbers in [0, 1) from random bits.
fn three_numbers(bits: u64) -> [f32; 3] {
    [0, 16, 32].map(|shift| f32::from((bits >> shift) as u16) / 65536.0)
}
