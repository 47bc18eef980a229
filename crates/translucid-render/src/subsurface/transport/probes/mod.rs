//! Ray-traced probes: they find the entry points of light that leaves at an exit point.
//!
//! Probes are segments through the neighborhood of the exit point P: along some of three axes, at a distance r from P
//! that is drawn from the profile of one of three channels (`strategy.rs`).
//! One probe along one axis chosen at random would be cheaper, but misses the surface half of the time.
//! All hits count: one of them is drawn in proportion to its weight and stands for their sum.
//! Where R depends on the entry point's texture, too (see [`Pairing`]), channels are the exit's profile and the widest one
//! that the texture has, so that every R is covered.

mod disk;
mod strategy;

use std::sync::Arc;

use glam::Vec3;

use super::Tracer;
use crate::ray::Hit;
use crate::sampling::Sampler;
use crate::subsurface::entry_point::EntryPoint;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::kernel::{CutProfile, Cutting, EntryToExit, SubsurfaceKernel};
use crate::subsurface::pairing::{PairedExit, Pairing, StatedParameters};
use crate::subsurface::parameters::Subsurface;
use crate::world::{PathState, World};
pub(super) use disk::CyclesDisk;
pub(super) use strategy::ProbeStrategy;

/// Part of a probe's length within which two hits that face the same way are one: rounding differs between the copies
/// of a face.
const SAME_PLACE: f32 = 1e-6;

/// |n · axis| below which a hit is left out: its density would be rounding noise.
const GRAZING: f32 = 1e-6;

/// Probes for the profile of a material.
pub(crate) struct Probes {
    pub(crate) kernel: Arc<SubsurfaceKernel>,
    /// How the parameters of exit and entry go together; `None` where those of the exit count alone.
    pub(crate) pairing: Option<Pairing>,
    /// Where the profile ends, and with it the longest probe.
    pub(crate) cutting: Cutting,
    /// Probabilities of probing along the two tangents and the normal.
    pub(crate) axes: [f32; 3],
    /// Hits count as on the disks of Cycles: see [`CyclesDisk`].
    pub(crate) is_disk: bool,
}

/// Hits of an exit's probes; their memory is kept between calls.
#[derive(Default)]
pub(super) struct ProbeScratch {
    hits: Vec<Hit>,
    /// Weight of each hit, and the sum of importances up to it.
    weights: Vec<(HitWeight, f32)>,
}

/// A point that light enters, with R(|x − P|) over the density of finding it.
#[derive(Clone, Copy, Debug)]
pub(super) struct EntryHit {
    pub(super) hit: Hit,
    pub(super) weight: Vec3,
    /// The parameters of R.
    pub(super) subsurface: Subsurface,
}

/// Weight of a hit.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HitWeight {
    /// R / p.
    pub(super) value: Vec3,
    /// 1 / (2πr p) for the distance r \[L\].
    pub(super) inverse_density: f32,
    /// r \[L\].
    pub(super) distance: f32,
}

impl HitWeight {
    fn scaled(self, factor: f32) -> Self {
        Self { value: self.value * factor, inverse_density: self.inverse_density * factor, ..self }
    }
}

impl Probes {
    /// Leaves the surface where a probe finds that light enters; false where the path is over.
    pub(super) fn scatter<'a, T: Tracer<'a>>(
        &'a self,
        tracer: &mut T,
        world: &'a World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        sampler: &mut Sampler,
    ) -> bool {
        // Neighbors do not share light that the path finds later
        path.in_block = None;
        match self.sample(&mut tracer.scratch().probes, world, exit, path.throughput, sampler) {
            Some(found) => self.leave(&found, tracer, world, path, exit, sampler),
            None => false,
        }
    }

    /// Goes on at an entry point that has been found.
    pub(super) fn leave<'a, T: Tracer<'a>>(
        &'a self,
        found: &EntryHit,
        tracer: &mut T,
        world: &'a World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        sampler: &mut Sampler,
    ) -> bool {
        path.throughput *= found.weight;
        path.throughput *= tracer.shape_factor(exit);
        // Seen from inside an open mesh, light enters from inside, too.
        let entry = EntryPoint::new(world, world.surface_point(&found.hit), exit.side);
        let passage = EntryToExit {
            offset: exit.point.position - entry.point.position,
            entry_normal: entry.normal,
            exit_normal: exit.normal * exit.side,
        };
        let directions = self.kernel.directions(&found.subsurface);
        entry.enter(path, &directions.along(passage), [sampler.reserve(), sampler.reserve()])
    }

    /// Draws an entry point; `None` where the probes meet nothing. `importance` is what the result will be multiplied
    /// with: channels that matter more are probed more.
    fn sample(
        &self,
        scratch: &mut ProbeScratch,
        world: &World,
        exit: &ExitPoint<'_>,
        importance: Vec3,
        sampler: &mut Sampler,
    ) -> Option<EntryHit> {
        if let Some(pairing) = &self.pairing {
            let both = self.paired_strategy(pairing, exit, importance)?;
            let (hit, weight) =
                scratch.find_pair((self, pairing, &both), world, exit, importance, sampler)?;
            let entry = StatedParameters::at(world, &world.surface_point(&hit));
            let subsurface = pairing.pair(&self.kernel, &PairedExit::new(exit), &entry);
            return Some(EntryHit { hit, weight: weight.value, subsurface });
        }
        let own = self.strategy(exit, importance)?;
        let disk = self.disk(&exit.subsurface, exit.point.geometric_normal);
        let (hit, weight) = scratch.find_own((&own, disk.as_ref()), world, exit, importance, sampler)?;
        Some(EntryHit { hit, weight: weight.value, subsurface: exit.subsurface })
    }

    /// The strategy of an exit's own three channels; `None` if none scatters.
    pub(super) fn strategy(&self, exit: &ExitPoint<'_>, importance: Vec3) -> Option<ProbeStrategy<'_, 3>> {
        let Subsurface { surface_albedo, length } = exit.subsurface;
        let share = |c: usize| if length[c] > 0.0 { surface_albedo[c] * importance[c] } else { 0.0 };
        let shares = [share(0), share(1), share(2)];
        ProbeStrategy::new(exit.point, self.axes, self.profiles(&exit.subsurface)?, shares)
    }

    /// The profiles of the three channels, those that do not scatter with that of one that does; `None` if none scatters.
    #[inline]
    pub(super) fn profiles(&self, subsurface: &Subsurface) -> Option<[CutProfile<'_>; 3]> {
        let Subsurface { surface_albedo, length } = *subsurface;
        let first = (0..3).find(|&c| length[c] > 0.0)?;
        let profile = |c: usize| {
            let c = if length[c] > 0.0 { c } else { first };
            self.profile(surface_albedo[c], length[c])
        };
        Some([profile(0), profile(1), profile(2)])
    }

    /// The disks around an exit that hits count on, where they do.
    pub(super) fn disk(&self, subsurface: &Subsurface, geometric_normal: Vec3) -> Option<CyclesDisk> {
        self.is_disk.then(|| CyclesDisk::of(subsurface, geometric_normal))
    }

    /// The strategy of an exit where entries count: by its own profile and by the widest that there can be, so that
    /// none is missed. `None` if no channel scatters.
    pub(super) fn paired_strategy(
        &self,
        pairing: &Pairing,
        exit: &ExitPoint<'_>,
        importance: Vec3,
    ) -> Option<ProbeStrategy<'_, 6>> {
        let Subsurface { surface_albedo, length } = exit.subsurface;
        let widest = pairing.widest(&self.kernel);
        let first = (0..3).find(|&c| length[c] > 0.0)?;
        let proposal = |i: usize| {
            let c = if length[i % 3] > 0.0 { i % 3 } else { first };
            let of = if i < 3 { exit.subsurface } else { widest };
            self.profile(of.surface_albedo[c], of.length[c])
        };
        let brightest = pairing.brightest(surface_albedo);
        let share = |i: usize| {
            let c = i % 3;
            if length[c] > 0.0 { brightest[c] * importance[c] } else { 0.0 }
        };
        let profiles: [CutProfile<'_>; 6] = std::array::from_fn(proposal);
        ProbeStrategy::new(exit.point, self.axes, profiles, std::array::from_fn(share))
    }

    /// The profile of a channel.
    pub(super) fn profile(&self, surface_albedo: f32, length: f32) -> CutProfile<'_> {
        self.cutting.cut(&self.kernel, surface_albedo, length)
    }

    /// 2πr R(r) at a distance.
    pub(super) fn circular(&self, subsurface: &Subsurface, distance: f32) -> Vec3 {
        let value = |c: usize| {
            if subsurface.length[c] <= 0.0 {
                return 0.0;
            }
            let profile = self.profile(subsurface.surface_albedo[c], subsurface.length[c]);
            if distance <= profile.longest() {
                subsurface.surface_albedo[c] * profile.pdf(distance)
            } else {
                0.0
            }
        };
        Vec3::new(value(0), value(1), value(2))
    }
}

impl ProbeScratch {
    /// Draws a hit of an exit whose own parameters are all that counts.
    pub(super) fn find_own(
        &mut self,
        (own, disk): (&ProbeStrategy<'_, 3>, Option<&CyclesDisk>),
        world: &World,
        exit: &ExitPoint<'_>,
        importance: Vec3,
        sampler: &mut Sampler,
    ) -> Option<(Hit, HitWeight)> {
        let albedo = exit.subsurface.scattering_albedo();
        let weight = |_: &Hit, offset, normal| {
            let weight = own.weight(albedo, offset, normal);
            let disk = disk.map_or(1.0, |disk| disk.factor(&own.profiles, offset, normal));
            HitWeight { value: weight.value * disk, ..weight }
        };
        self.find(own, world, exit, importance, sampler, weight)
    }

    /// Draws a hit of an exit where entries count.
    pub(super) fn find_pair(
        &mut self,
        (probes, pairing, both): (&Probes, &Pairing, &ProbeStrategy<'_, 6>),
        world: &World,
        exit: &ExitPoint<'_>,
        importance: Vec3,
        sampler: &mut Sampler,
    ) -> Option<(Hit, HitWeight)> {
        let paired = PairedExit::new(exit);
        self.find(both, world, exit, importance, sampler, |hit, offset, normal| {
            let (density, distance) = both.density(offset, normal);
            if density <= 0.0 {
                return HitWeight::default();
            }
            let entry = StatedParameters::at(world, &world.surface_point(hit));
            let pair = pairing.pair(&probes.kernel, &paired, &entry);
            let value = probes.circular(&pair, distance) / density;
            HitWeight { value, inverse_density: 1.0 / density, distance }
        })
    }

    /// Draws a hit of a strategy's probes. `weight` is that of a hit at an offset from the exit with a normal, both in
    /// the exit's frame.
    fn find<const N: usize>(
        &mut self,
        strategy: &ProbeStrategy<'_, N>,
        world: &World,
        exit: &ExitPoint<'_>,
        importance: Vec3,
        sampler: &mut Sampler,
        weight: impl Fn(&Hit, Vec3, Vec3) -> HitWeight,
    ) -> Option<(Hit, HitWeight)> {
        let geometry = &world.geometry;
        let frame = strategy.frame;
        self.hits.clear();
        self.weights.clear();
        let mut sum = 0.0;
        let mut pick = 0.0;
        for axis in 0..3 {
            let u = sampler.next_4d();
            pick = u[3];
            let Some(ray) = strategy.sample(axis, [u[0], u[1], u[2]], geometry.bounds()) else { continue };
            let first = self.hits.len();
            geometry.all_in_group(&ray, exit.point.group, |hit| self.hits.push(hit));
            // The tree's order must not show in the picture.
            let number = |hit: &Hit| geometry.object_and_triangle_of(hit);
            self.hits[first..]
                .sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then_with(|| number(a).cmp(&number(b))));
            let mut before = (f32::NEG_INFINITY, Vec3::ZERO);
            for hit in &self.hits[first..] {
                let normal = geometry.normal(hit);
                // A face that lies twice in the same place would count twice
                let is_copy = hit.t - before.0 <= SAME_PLACE * ray.t_max && normal.dot(before.1) > 0.999;
                before = (hit.t, normal);
                let weight = if is_copy || frame.axis(axis).dot(normal).abs() < GRAZING {
                    HitWeight::default()
                } else {
                    let offset = geometry.position(hit) - exit.point.position;
                    weight(hit, frame.to_local(offset), frame.to_local(normal))
                };
                sum += (weight.value * importance).element_sum();
                self.weights.push((weight, sum));
            }
        }
        self.pick(pick * sum, importance, sum)
    }

    /// The hit at which the running sum of importances passes `goal` stands for all of them.
    fn pick(&self, goal: f32, importance: Vec3, sum: f32) -> Option<(Hit, HitWeight)> {
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let index = self.weights.partition_point(|&(_, cumulative)| cumulative <= goal);
        let (weight, _) = *self.weights.get(index)?;
        let own = (weight.value * importance).element_sum();
        (own > 0.0).then(|| (self.hits[index], weight.scaled(sum / own)))
    }
}
