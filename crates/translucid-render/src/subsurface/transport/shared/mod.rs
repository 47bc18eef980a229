//! Light that has entered below one pixel's surface point, shared with the pixels around it.
//!
//! Exits x_i of a block of pixels each find an entry point y_i by probes of their own, and light that arrives there.
//! Where exits lie closer together than light travels below the surface, all of them could have found all entries, so
//! each gathers light from every entry (see [`gathering`](super::gathering)), with K = R(|x − y|) and a rational
//! stand-in for the profile as g (see [`Nearness`]), cut at the same radius as the probes.
//! The profile R is evaluated for a few terms only, so models may be expensive, and directional.
//!
//! Only exits whose light would have the same bounds share: see [`ExitKind`].

mod entries;
mod nearness;

use std::f32::consts::TAU;

use glam::Vec3;

use super::Tracer;
use super::gathering::{Account, ExitKind, Gathering};
use super::probes::{EntryHit, HitWeight, ProbeScratch, Probes};
use crate::ray::Hit;
use crate::sampling::{Reserved, Sampler};
use crate::subsurface::entry_point::{Arrival, EntryPoint};
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::pairing::{PairedExit, StatedParameters};
use crate::subsurface::parameters::Subsurface;
use crate::world::{Layer, PathState, World};
use entries::{EntryLight, WaitingExit};
use nearness::Nearness;

/// The exits of a block.
pub(super) type SharedEntries<'a> = Gathering<WaitingExit<'a>>;

/// Mean radius of the widest profile, in pixels, from which on an exit shares.
///
/// Below, an entry is of little use to the neighbors, and their distances to it add noise. The choice depends on no entry,
/// so it changes no mean.
const LEAST_PIXELS: f32 = 1.5;

/// How far from its own place an exit may go, over the mean radius of its widest profile, to find those that it shares with.
///
/// Squares of pixels that share have errors of their own, so their borders show. A random offset of each pixel, up to this
/// distance, dissolves squares that light crosses easily into each other, but brings less close pixels together. Measured
/// by the benches `structure` and `sharing` at a mean free path of 16 pixels: steps across borders are 1.06 times as high
/// as steps elsewhere, with 0.1 they are 1.18 times and with 0 1.36 times as high; with 1 the noise is 1.3 times as great.
const SPREAD: f32 = 0.25;

/// Least ratio of a profile from a file to its stand-in, within its reach: an entry that one exit hardly finds and that
/// weighs much for another would be a speck.
const LEAST_OF_STAND_IN: f32 = 0.02;

/// Radii at which a profile from a file is compared with its stand-in.
const RADII: u16 = 1024;

impl Probes {
    /// Returns `true` if exits may share their light: entries have to be found wherever the stand-in for the profile is.
    pub(crate) fn can_share(&self) -> bool {
        self.kernel.albedos_of_any_shape().is_none_or(|albedos| {
            albedos.iter().all(|&albedo| {
                let profile = self.profile(albedo as f32, 1.0);
                let reach = profile.longest();
                let nearness = Nearness::new([1.0, 0.0, 0.0], [reach, 0.0, 0.0], self.cutting.tail());
                let mut radii = (1..RADII).map(|i| reach * (f32::from(i) / f32::from(RADII)).powi(2));
                radii.all(|r| profile.pdf(r) > LEAST_OF_STAND_IN * 3.0 * r * nearness.at(r * r))
            })
        })
    }
}

/// The hit of an exit's probes, if any, and the stand-in for its profile by which it shares.
struct ProbeHit {
    hit: Option<(Hit, HitWeight)>,
    nearness: Nearness,
}

impl ProbeHit {
    /// `None` where no channel scatters.
    fn new(
        probes: &Probes,
        scratch: &mut ProbeScratch,
        world: &World,
        (exit, importance): (&ExitPoint<'_>, Vec3),
        sampler: &mut Sampler,
    ) -> Option<Self> {
        let Some(pairing) = &probes.pairing else {
            let own = probes.strategy(exit, importance)?;
            let disk = probes.disk(&exit.subsurface, exit.point.geometric_normal);
            let reaches = own.profiles.map(|profile| profile.longest());
            return Some(Self {
                hit: scratch.find_own((&own, disk.as_ref()), world, exit, importance, sampler),
                nearness: Nearness::new(own.shares, reaches, probes.cutting.tail()),
            });
        };
        let both = probes.paired_strategy(pairing, exit, importance)?;
        let reaches = both.profiles.map(|profile| profile.longest());
        let [a, b, c, ..] = reaches;
        let [share_a, share_b, share_c, ..] = both.shares;
        let nearness = Nearness::new([share_a, share_b, share_c], [a, b, c], probes.cutting.tail());
        let longest = reaches.into_iter().fold(0.0, f32::max);
        let hit = scratch.find_pair((probes, pairing, &both), world, exit, importance, sampler);
        Some(Self { hit, nearness: nearness.ending_at(longest) })
    }

    /// The entry point of an exit that does not share.
    fn alone(self, probes: &Probes, world: &World, exit: &PairedExit) -> Option<EntryHit> {
        let (hit, weight) = self.hit?;
        let subsurface = probes.pairing.as_ref().map_or(exit.subsurface, |pairing| {
            pairing.pair(&probes.kernel, exit, &StatedParameters::at(world, &world.surface_point(&hit)))
        });
        Some(EntryHit { hit, weight: weight.value, subsurface })
    }

    /// The light that enters at the hit, for all exits of the block.
    fn entry_light<'a, T: Tracer<'a>>(
        &self,
        tracer: &mut T,
        world: &'a World,
        path: &PathState,
        exit: &ExitPoint<'_>,
        sampler: &mut Sampler,
    ) -> Option<EntryLight> {
        let Self { ref hit, nearness } = *self;
        let (hit, weight) = hit.as_ref()?;
        let entry = EntryPoint::new(world, world.surface_point(hit), exit.side);
        let numbers = [sampler.reserve(), sampler.reserve()];
        let arrivals = arrivals(tracer, path, &entry, path.throughput * weight.value, sampler, numbers);
        let position = entry.point.position;
        let contribution = TAU * nearness.distance(weight.distance) * weight.inverse_density;
        Some(EntryLight {
            position,
            normal: entry.normal,
            geometric_normal: entry.point.geometric_normal,
            own_weight: nearness.at(exit.point.position.distance_squared(position)) * contribution,
            own_reflectance: weight.value,
            arrivals,
            stated: StatedParameters::if_paired(world, &entry.point),
        })
    }
}

/// Leaves a surface through the medium below: the light of a path in a block is left to the block, any other finds an entry
/// point for itself. False where the path is over.
pub(super) fn scatter<'a, T: Tracer<'a>>(
    probes: &'a Probes,
    tracer: &mut T,
    world: &'a World,
    path: &mut PathState,
    exit: &ExitPoint<'_>,
    sampler: &mut Sampler,
) -> bool {
    let Some(place) = path.in_block.take().filter(|_| can_share(&exit.subsurface, path.throughput)) else {
        return probes.scatter(tracer, world, path, exit, sampler);
    };
    let scratch = &mut tracer.scratch().probes;
    let Some(found) = ProbeHit::new(probes, scratch, world, (exit, path.throughput), sampler) else {
        return false;
    };
    let paired = PairedExit::new(exit);
    let nearness = found.nearness;
    let mean_radius = nearness.mean_radius() / tracer.pixel_width().at(path.sample.depth);
    if mean_radius < LEAST_PIXELS {
        let entry = found.alone(probes, world, &paired);
        return entry.is_some_and(|entry| probes.leave(&entry, tracer, world, path, exit, sampler));
    }
    let bits = sampler.fork();
    let cohort = place.cohort(place.offset(SPREAD * mean_radius, bits));
    let account = Account {
        sample: place.number,
        layer: path.layer_after(Layer::Subsurface),
        throughput: path.throughput * tracer.shape_factor(exit),
        random: (bits >> 40) as f32 * (1.0 / (1 << 24) as f32),
    };
    let entry = found.entry_light(tracer, world, path, exit, sampler);
    let waiting = WaitingExit {
        kind: ExitKind::new(exit, path),
        account,
        position: exit.point.position,
        normal: exit.normal * exit.side,
        geometric_normal: exit.point.geometric_normal,
        probes,
        paired,
        nearness,
        mean_radius,
    };
    tracer.scratch().shared.push_to(cohort, waiting, entry);
    false
}

/// Returns `true` if an exit may share the light of its entry.
///
/// The inverse squares of its lengths \[L\] and products of them have to stay finite.
fn can_share(subsurface: &Subsurface, throughput: Vec3) -> bool {
    let Subsurface { length, .. } = *subsurface;
    let usual = |c: usize| length[c] <= 0.0 || (1e-8..1e8).contains(&length[c]);
    (0..3).all(usual) && throughput.max_element() > 1e-15
}

/// Light that enters at an entry point: from a sampled light, and [along a path](arrival_along).
fn arrivals<'a, T: Tracer<'a>>(
    tracer: &mut T,
    path: &PathState,
    entry: &EntryPoint<'_>,
    worth: Vec3,
    sampler: &mut Sampler,
    [of_light, of_direction]: [Reserved; 2],
) -> [Arrival; 2] {
    let direct = entry.direct_light(path.absorption, of_light.numbers()).unwrap_or(Arrival::NONE);
    [direct, arrival_along(tracer, path, entry, worth, sampler, of_direction)]
}

/// Light that enters at an entry point along a path, followed as far as it is `worth` to the one that has found the point.
pub(super) fn arrival_along<'a, T: Tracer<'a>>(
    tracer: &mut T,
    path: &PathState,
    entry: &EntryPoint<'_>,
    worth: Vec3,
    sampler: &mut Sampler,
    of_direction: Reserved,
) -> Arrival {
    let worth = worth_to_all(worth);
    let mut onward = path.branch(worth);
    let Some((direction, weight)) = entry.head_off(&mut onward, of_direction.numbers()) else {
        return Arrival::NONE;
    };
    onward.throughput *= weight;
    tracer.follow(&mut onward, sampler);
    Arrival { direction, light: onward.sample.radiance() / worth }
}

/// Least part of the brightest channel that every channel is worth: other exits may see more of a color.
const LEAST_CHANNEL: f32 = 0.1;

/// Least worth of the brightest channel: other exits may be brighter.
const LEAST_WORTH: f32 = 0.05;

/// Throughput with which light is followed that is worth so much to one exit of a block.
fn worth_to_all(worth: Vec3) -> Vec3 {
    let most = worth.max_element();
    if most > 1e-30 {
        worth.max(Vec3::splat(LEAST_CHANNEL * most)) * (most.clamp(LEAST_WORTH, 1.0) / most)
    } else {
        Vec3::ONE
    }
}
