//! Pass 2: the light that enters at each point, by the path tracer.
//!
//! The light that leaves anywhere is a mean over many points. So the mean of a cluster of neighbors has to be exact, not
//! each point. Every point has two independent halves of samples. Their difference over a cluster gives the error of its
//! mean, gains of the well-distributed samples included, and clusters get samples until that error is small.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::super::Tracer;
use super::plan::LEAST_SAMPLES;
use super::surfels::Surfel;
use crate::ray::Ray;
use crate::sampling::Sampler;
use crate::subsurface::entry_point::EntryPoint;
use crate::subsurface::kernel::DirectionalWeight;
use crate::world::{PathState, World};

/// Points whose mean has to be exact, neighbors in the order of the tree.
const CLUSTER: usize = 64;
/// Samples that each half of a point has at most.
const MOST_SAMPLES: u32 = 4096;
/// Standard error of a cluster's mean for a tolerance of 1, relative to the mean. It goes with the root of the
/// tolerance: the number of points within reach of a profile goes with its inverse.
const NOISE: f64 = 0.04;
/// Clusters darker than this part of the group's mean may be as inexact as one that is as bright.
const DARK: f64 = 0.05;

/// Transmitted irradiance ∫ L T(ω) cosθ / (π T̄) dω of each point; `None` when stopped. `groups` are the numbers of the
/// groups' points, `progress` hears the part that is done, which never falls, and about how many samples there are in all.
pub(super) fn irradiance<'a, T: Tracer<'a>>(
    world: &World,
    tracer: impl Fn() -> T + Sync,
    groups: &[usize],
    surfels: &[Surfel],
    progress: &(dyn Fn(f64, u64) + Sync),
    stop: &AtomicBool,
) -> Option<Vec<Vec3>> {
    let is_stopped = || stop.load(Ordering::Relaxed);
    let mut clusters = clusters(groups, surfels);
    // How many samples it takes is not known yet: as many again
    let rounds = Rounds::new(0.0, clusters.iter().map(|_| LEAST_SAMPLES), &clusters, progress);
    clusters.par_iter_mut().for_each_init(&tracer, |tracer, cluster| {
        if !is_stopped() {
            cluster.sample(world, tracer, LEAST_SAMPLES);
            rounds.add(cluster.samples(LEAST_SAMPLES));
        }
    });
    if is_stopped() {
        return None;
    }
    let dark = means(groups.len(), &clusters);
    let tolerance = NOISE * f64::from(world.scene.integrator.point_tolerance).sqrt();
    let wanted = |cluster: &Cluster<'_>| cluster.wanted(tolerance, dark[cluster.group]);
    let rounds = Rounds::new(0.5, clusters.iter().map(wanted), &clusters, progress);
    clusters.par_iter_mut().for_each_init(&tracer, |tracer, cluster| {
        let expected = wanted(cluster);
        loop {
            let count = cluster.count;
            // The first estimates are rough: not too far at once
            let next = wanted(cluster).min(4 * count);
            if is_stopped() {
                return;
            }
            if next <= count {
                // All that was expected is done, whether it took more or less
                rounds.add(cluster.samples(expected.saturating_sub(count)));
                return;
            }
            cluster.sample(world, tracer, next);
            rounds.add(cluster.samples(next.min(expected).saturating_sub(count)));
        }
    });
    if is_stopped() {
        return None;
    }
    let light = |cluster: &Cluster<'_>| -> Vec<Vec3> {
        (0..cluster.surfels.len()).map(|i| cluster.mean(i).as_vec3()).collect()
    };
    Some(clusters.iter().flat_map(light).collect())
}

/// One half of the work, and how much of it is done.
struct Rounds<'a> {
    /// Part that was done before.
    before: f64,
    done: AtomicU64,
    total: u64,
    progress: &'a (dyn Fn(f64, u64) + Sync),
}

impl<'a> Rounds<'a> {
    /// Work that brings each half of each point of clusters to so many samples.
    fn new(
        before: f64,
        goals: impl Iterator<Item = u32>,
        clusters: &[Cluster<'_>],
        progress: &'a (dyn Fn(f64, u64) + Sync),
    ) -> Self {
        let total = goals.zip(clusters).map(|(goal, cluster)| cluster.samples(goal)).sum();
        let done = clusters.iter().map(|cluster| cluster.samples(cluster.count)).sum();
        Self { before, done: AtomicU64::new(done), total, progress }
    }

    fn add(&self, more: u64) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        let part = done as f64 / self.total.max(1) as f64;
        (self.progress)(self.before + 0.5 * part.min(1.0), (self.total as f64 / (self.before + 0.5)) as u64);
    }
}

/// Neighboring points and their light so far.
struct Cluster<'a> {
    /// Position of the group among the groups.
    group: usize,
    /// Number of the first point.
    first: u32,
    surfels: &'a [Surfel],
    /// Samples that each half of each point has.
    count: u32,
    /// Sums of both halves of each point.
    sums: Vec<[DVec3; 2]>,
}

fn clusters<'a>(groups: &[usize], surfels: &'a [Surfel]) -> Vec<Cluster<'a>> {
    let mut clusters = Vec::new();
    let mut first = 0;
    for (group, &length) in groups.iter().enumerate() {
        for surfels in surfels[first..first + length].chunks(CLUSTER) {
            let sums = vec![[DVec3::ZERO; 2]; surfels.len()];
            clusters.push(Cluster { group, first: first as u32, surfels, count: 0, sums });
            first += surfels.len();
        }
    }
    clusters
}

/// The mean irradiance of each group, times what counts as dark.
fn means(groups: usize, clusters: &[Cluster<'_>]) -> Vec<DVec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); groups];
    for cluster in clusters {
        for (i, surfel) in cluster.surfels.iter().enumerate() {
            sums[cluster.group].0 += cluster.mean(i) * f64::from(surfel.area);
            sums[cluster.group].1 += f64::from(surfel.area);
        }
    }
    sums.into_iter().map(|(light, area)| light * (DARK / area.max(f64::MIN_POSITIVE))).collect()
}

/// Light that enters the medium at a point, on its outside: one sample of ∫ L T(ωi) cosθ / (π T̄) dω, as after an event
/// under a surface that was seen.
fn entering_light<'a, T: Tracer<'a>>(
    world: &World,
    tracer: &mut T,
    surfel: &Surfel,
    sampler: &mut Sampler,
) -> Vec3 {
    let point = world.point_on(surfel.primitive.into(), surfel.position());
    let mut path = PathState::new(Ray::new(point.position, -point.geometric_normal));
    if EntryPoint::new(world, point, 1.0).enter(
        &mut path,
        &DirectionalWeight::Radial,
        [sampler.reserve(), sampler.reserve()],
    ) {
        tracer.follow(&mut path, sampler);
    }
    path.sample.radiance()
}

impl Cluster<'_> {
    /// Brings both halves of each point to so many samples.
    fn sample<'a, T: Tracer<'a>>(&mut self, world: &World, tracer: &mut T, count: u32) {
        for (i, surfel) in self.surfels.iter().enumerate() {
            for (half, sum) in self.sums[i].iter_mut().enumerate() {
                for index in self.count..count {
                    // No pixel is that far down: a picture's samples are other ones
                    let (x, y) = (self.first + i as u32, u32::MAX - half as u32);
                    let mut sampler = Sampler::new(world.scene.integrator.seed, x, y, index);
                    let light = entering_light(world, tracer, surfel, &mut sampler);
                    if light.is_finite() {
                        *sum += light.as_dvec3();
                    }
                }
            }
        }
        self.count = count;
    }

    /// Samples of all its points, of which each half has so many.
    fn samples(&self, count: u32) -> u64 {
        self.surfels.len() as u64 * 2 * u64::from(count)
    }

    /// Mean of a point's samples.
    fn mean(&self, i: usize) -> DVec3 {
        let [a, b] = self.sums[i];
        (a + b) / (2.0 * f64::from(self.count.max(1)))
    }

    /// About how many samples each half needs for an error, estimated from those so far.
    fn wanted(&self, tolerance: f64, dark: DVec3) -> u32 {
        let (mut light, mut variance, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (i, surfel) in self.surfels.iter().enumerate() {
            let weight = f64::from(surfel.area);
            let [a, b] = self.sums[i];
            let difference = (a - b) / (2.0 * f64::from(self.count.max(1)));
            variance += difference * difference * (weight * weight);
            light += self.mean(i) * weight;
            area += weight;
        }
        let allowed = (light / area).max(dark).max(DVec3::splat(f64::MIN_POSITIVE)) * (tolerance * area);
        let excess = (variance / (allowed * allowed)).max_element();
        // Not a number where there is no light at all
        if excess.is_nan() || excess <= 1.0 {
            return self.count;
        }
        let wanted = (f64::from(self.count) * excess * 1.05).ceil();
        wanted.min(f64::from(MOST_SAMPLES)) as u32
    }
}
