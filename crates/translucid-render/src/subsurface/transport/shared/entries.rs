//! The exits of a block of pixels and the light that has entered near them.

use std::f32::consts::TAU;

use glam::Vec3;

use super::nearness::Nearness;
use crate::subsurface::entry_point::Arrival;
use crate::subsurface::kernel::{CutProfile, DirectionalWeight, Directions, EntryToExit};
use crate::subsurface::pairing::{PairedExit, StatedParameters};
use crate::subsurface::parameters::Subsurface;
use crate::subsurface::transport::gathering::resampled_sum::{ResampledReceiver, ResampledSums};
use crate::subsurface::transport::gathering::{
    Account, BlockReceiver, COORDINATES, ExitKind, FoundLight, LightStatistics,
};
use crate::subsurface::transport::probes::{CyclesDisk, Probes};

/// A point where light has entered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EntryLight {
    pub(crate) position: Vec3,
    /// Shading normal on the side that is seen.
    pub(crate) normal: Vec3,
    pub(crate) geometric_normal: Vec3,
    /// g times an unbiased estimate of 1/p for the exit that found it.
    pub(crate) own_weight: f32,
    /// R times the same estimate of 1/p, without its directional factor.
    pub(crate) own_reflectance: Vec3,
    /// From a sampled light and from a path.
    pub(crate) arrivals: [Arrival; 2],
    /// Parameters that the material states there, where they count.
    pub(crate) stated: Option<StatedParameters>,
}

impl EntryLight {
    /// All light, weighted by its direction.
    fn weighted(&self, directional: &DirectionalWeight<'_>) -> Vec3 {
        let light = |arrival: &Arrival| {
            if arrival.light == Vec3::ZERO {
                return Vec3::ZERO;
            }
            arrival.light * directional.weight(arrival.direction)
        };
        self.arrivals.iter().map(light).sum()
    }
}

impl FoundLight for EntryLight {
    fn coordinates(&self) -> [f32; COORDINATES] {
        let [x, y, z] = self.position.to_array();
        [x, y, z, 0.0, 0.0, 0.0, 0.0]
    }

    fn own_weight(&self) -> f32 {
        self.own_weight
    }

    fn light(&self) -> Vec3 {
        self.arrivals[0].light + self.arrivals[1].light
    }

    fn normal(&self) -> Vec3 {
        self.normal
    }
}

/// Relative variance of light, times the square of the profile's mean radius in pixels, from which on it is worth sharing.
///
/// A choice between noise and time: more would leave the head noisier, less would share where little is gained.
const LEAST_VARIANCE: f32 = 0.5;

/// Relative variance of light, times the profile's mean radius in pixels, that is not worth sharing on flat ground: every
/// probe hits there, and those of a pixel's samples complement each other. It adds to [`LEAST_VARIANCE`] over that radius.
const LEAST_VARIANCE_ON_FLAT: f32 = 1.0;

/// Variance of normals from which on nothing is flat.
const ROUGHEST: f32 = 0.03;

/// An exit that waits for light.
///
/// A block has thousands of them, so numbers that only sharing needs are made when they are asked for.
pub(crate) struct WaitingExit<'a> {
    pub(crate) kind: ExitKind,
    pub(crate) account: Account,
    pub(crate) position: Vec3,
    /// Shading normal on the side that is seen.
    pub(crate) normal: Vec3,
    pub(crate) geometric_normal: Vec3,
    pub(crate) probes: &'a Probes,
    pub(crate) paired: PairedExit,
    pub(crate) nearness: Nearness,
    /// Mean radius of the widest profile in pixels.
    pub(crate) mean_radius: f32,
}

/// The kernel of an exit's own parameters.
pub(crate) struct OwnKernel<'a> {
    directions: Directions<'a>,
    /// `None` where no channel scatters.
    profiles: Option<[CutProfile<'a>; 3]>,
    disk: Option<CyclesDisk>,
}

impl<'a> BlockReceiver for WaitingExit<'a> {
    type Kind = ExitKind;
    type FoundLight = EntryLight;
    type Sums = ResampledSums<EntryLight>;

    fn kind(&self) -> ExitKind {
        self.kind
    }

    fn account(&self) -> &Account {
        &self.account
    }

    fn fill(&self, [x, y, z, ..]: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]) {
        self.nearness.fill(self.position.to_array(), [x, y, z], row, sums);
    }

    fn color(&self) -> Vec3 {
        let albedo = self.paired.subsurface.scattering_albedo();
        let pairing = self.probes.pairing.as_ref();
        self.account.throughput * pairing.map_or(albedo, |pairing| pairing.brightest(albedo))
    }
}

impl<'a> ResampledReceiver for WaitingExit<'a> {
    type Response = OwnKernel<'a>;

    fn response(&self) -> OwnKernel<'a> {
        let (probes, subsurface) = (self.probes, &self.paired.subsurface);
        OwnKernel {
            directions: probes.kernel.directions(subsurface),
            profiles: probes.profiles(subsurface),
            disk: probes.disk(subsurface, self.geometric_normal),
        }
    }

    fn light_from(&self, own: &OwnKernel<'a>, entry: &EntryLight, factor: f32) -> Vec3 {
        let passage = self.passage(entry);
        let EntryToExit { offset, .. } = passage;
        let distance = self.nearness.distance(offset.length());
        // Light may be as bright as extreme scenes have it; the factors on it are about 1
        if let Some(pair) = self.pair(entry) {
            let directions = self.probes.kernel.directions(&pair);
            let reflectance = self.probes.circular(&pair, distance) / (TAU * distance);
            return reflectance * factor * entry.weighted(&directions.along(passage));
        }
        let Some(profiles) = &own.profiles else { return Vec3::ZERO };
        let on_disk = |disk: &CyclesDisk| disk.factor_in_world(profiles, -offset, entry.geometric_normal);
        let reflectance = self.reflectance(profiles, distance) * own.disk.as_ref().map_or(1.0, on_disk);
        reflectance * factor * entry.weighted(&own.directions.along(passage))
    }

    fn alone(&self, kinds: [LightStatistics; 2], found: Option<&EntryLight>) -> [Option<Vec3>; 2] {
        let is_alone = kinds.map(|statistics| {
            let flatness = (1.0 - statistics.roughness() / ROUGHEST).max(0.0);
            let least = LEAST_VARIANCE / self.mean_radius + LEAST_VARIANCE_ON_FLAT * flatness;
            statistics.variance() * self.mean_radius < least
        });
        if is_alone == [false; 2] {
            return [None; 2];
        }
        let own = found.map_or(Vec3::ZERO, |entry| {
            let directions =
                self.probes.kernel.directions(&self.pair(entry).unwrap_or(self.paired.subsurface));
            entry.own_reflectance * entry.weighted(&directions.along(self.passage(entry)))
        });
        is_alone.map(|is_alone| is_alone.then_some(own))
    }
}

impl WaitingExit<'_> {
    /// Parameters of the exit and an entry together, where the entries' count.
    fn pair(&self, entry: &EntryLight) -> Option<Subsurface> {
        let pairing = self.probes.pairing.as_ref()?;
        Some(pairing.pair(&self.probes.kernel, &self.paired, entry.stated.as_ref()?))
    }

    fn passage(&self, entry: &EntryLight) -> EntryToExit {
        let offset = self.position - entry.position;
        EntryToExit { offset, entry_normal: entry.normal, exit_normal: self.normal }
    }

    /// R at a distance.
    #[inline]
    fn reflectance(&self, profiles: &[CutProfile<'_>; 3], distance: f32) -> Vec3 {
        let albedo = self.paired.subsurface.scattering_albedo();
        let value = |c: usize| {
            let within = albedo[c] > 0.0 && distance <= profiles[c].longest();
            if within { albedo[c] * profiles[c].pdf(distance) } else { 0.0 }
        };
        Vec3::new(value(0), value(1), value(2)) / (TAU * distance)
    }
}
