//! Light that is found below some pixels of a block, gathered by all that it could reach.
//!
//! Receivers x_1 … x_n each find a place y_i by a strategy of their own, with an unbiased estimate W_i of 1/p_i(y_i), and
//! the light E_i that is there: a shadow ray and a path, which take most of the time. All of them could have found all places, so
//! each takes light from every place:
//!
//! ```text
//! L_j = Σ_i w_i(y_i) K_j(y_i) W_i E_i,     w_i(y) = g_i(y) / Σ_k g_k(y)
//! ```
//!
//! This is multiple importance sampling with one sample of each of n strategies [Veach & Guibas 1995] and strategies
//! that are known by their contribution weights only [Lin et al. 2022, "Generalized Resampled Importance Sampling"].
//! It is unbiased for any g_i that is positive only where p_i is. Where a strategy has several receivers, their g add up
//! to its own.
//! Near x_j its own g_j grows like K_j, so no weight is larger than without sharing.
//!
//! Where K_j costs more than g_j, a few terms stand [for the sum](resampled_sum); where it does not, [all](full_sum) are added up.

pub(super) mod full_sum;
mod light_statistics;
pub(super) mod resampled_sum;
#[cfg(test)]
mod toys;
mod weights;

use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;

pub(super) use self::light_statistics::LightStatistics;
pub(super) use self::weights::{COORDINATES, LANES};
use crate::subsurface::exit_point::ExitPoint;
use crate::world::{Layer, PathState};

/// Properties common to exits that share: the light at an entry point is then the same for all of them, followed to the same
/// depth and through the same media.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ExitKind {
    /// Subsurface group.
    pub(crate) group: u32,
    /// It is seen from outside.
    pub(crate) outside: bool,
    pub(crate) depth: u32,
    pub(crate) diffuse_depth: u32,
    pub(crate) soft: bool,
    /// Bits of the absorption coefficients of the clear medium around.
    pub(crate) absorption: [u32; 3],
}

impl ExitKind {
    pub(super) fn new(exit: &ExitPoint<'_>, path: &PathState) -> Self {
        Self {
            group: exit.point.group,
            outside: exit.side > 0.0,
            depth: path.depth,
            diffuse_depth: path.diffuse_depth,
            soft: path.soft,
            absorption: path.absorption.to_array().map(f32::to_bits),
        }
    }
}

/// A point that light of a block is gathered at.
pub(super) trait BlockReceiver: Sized {
    /// Properties common to receivers that share.
    type Kind: Ord;
    /// A place with light, which one receiver finds and all use.
    type FoundLight: FoundLight;
    /// How the terms of all places are added up.
    type Sums: Sums<Self>;

    fn kind(&self) -> Self::Kind;

    /// Where and how its light is added.
    fn account(&self) -> &Account;

    /// Nearness to places with these coordinates, whose number is a multiple of [`LANES`], as the sums need it; adds g to
    /// the sums of g.
    fn fill(&self, places: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]);

    /// Rough worth of light, by channel.
    fn color(&self) -> Vec3;
}

/// A place that a receiver has found.
pub(super) trait FoundLight: Copy {
    /// Position, and other coordinates that its nearness depends on.
    fn coordinates(&self) -> [f32; COORDINATES];

    /// g_i W_i: about 1, and 1 where g is the density by which it was found.
    fn own_weight(&self) -> f32;

    /// All light that is there.
    fn light(&self) -> Vec3;

    /// Normal of the surface, 0 where there is none.
    fn normal(&self) -> Vec3;
}

/// Sums over the places that receivers of one kind have found.
pub(super) trait Sums<R: BlockReceiver>: Default {
    /// Looks at all kinds of a cohort, for the light that they may expect of each other.
    fn look_around<'c>(&mut self, _kinds: impl Iterator<Item = Alike<'c, R>>)
    where
        R: 'c,
    {
    }

    /// Prepares the numbers that all receivers of a kind share.
    fn prepare(&mut self, alike: &Alike<'_, R>);

    /// Light for one of these receivers, by its number among them.
    fn gather(&mut self, row: usize, receiver: &R) -> Vec3;
}

/// Where and how the light of a receiver is added.
pub(super) struct Account {
    /// Number of its sample in the block.
    pub(super) sample: usize,
    pub(super) layer: Layer,
    /// Factor on it.
    pub(super) throughput: Vec3,
    /// Uniform in [0, 1).
    pub(super) random: f32,
}

/// The receivers of a block, cohort by cohort; keeps its memory from block to block.
pub(super) struct Gathering<R: BlockReceiver> {
    cohorts: Vec<Cohort<R>>,
    order: Vec<usize>,
    sums: R::Sums,
}

/// Receivers that may share with each other, and with no others.
///
/// Each cohort has memory of its own: a block's is larger than a processor's cache, and a cohort's receivers come from all
/// over the block.
struct Cohort<R: BlockReceiver> {
    waiting: Vec<R>,
    /// They are of several kinds.
    is_mixed: bool,
    /// Places, by receiver, and the first one of each.
    found: Vec<R::FoundLight>,
    firsts: Vec<usize>,
}

impl<R: BlockReceiver> Default for Cohort<R> {
    fn default() -> Self {
        Self { waiting: Vec::new(), is_mixed: false, found: Vec::new(), firsts: Vec::new() }
    }
}

/// Receivers of a cohort that are of one kind.
pub(super) struct Alike<'c, R: BlockReceiver> {
    cohort: &'c Cohort<R>,
    /// Numbers in the cohort.
    indices: &'c [usize],
}

impl<'c, R: BlockReceiver> Alike<'c, R> {
    fn len(&self) -> usize {
        self.indices.len()
    }

    fn receivers(&self) -> impl Iterator<Item = &'c R> {
        let cohort = self.cohort;
        self.indices.iter().map(|&index| &cohort.waiting[index])
    }

    /// The places that each has found, receiver by receiver.
    fn found(&self) -> impl Iterator<Item = &'c [R::FoundLight]> {
        let Cohort { found, firsts, .. } = self.cohort;
        self.indices.iter().map(|&index| {
            let end = firsts.get(index + 1).map_or(found.len(), |first| *first);
            &found[firsts[index]..end]
        })
    }
}

impl<R: BlockReceiver> Default for Gathering<R> {
    fn default() -> Self {
        Self { cohorts: Vec::new(), order: Vec::new(), sums: R::Sums::default() }
    }
}

impl<R: BlockReceiver> Gathering<R> {
    /// Number of places that the only cohort has found.
    pub(super) fn found_count(&self) -> usize {
        self.cohorts.first().map_or(0, |cohort| cohort.found.len())
    }

    /// A place that the only cohort has found.
    pub(super) fn found_mut(&mut self, index: usize) -> &mut R::FoundLight {
        &mut self.cohorts[0].found[index]
    }

    /// Adds a receiver to the only cohort, and the places that it has found.
    pub(super) fn push(&mut self, receiver: R, found: impl IntoIterator<Item = R::FoundLight>) {
        self.push_to(0, receiver, found);
    }

    /// Adds a receiver to the cohort of this number, and the places that it has found.
    pub(super) fn push_to(
        &mut self,
        cohort: usize,
        receiver: R,
        found: impl IntoIterator<Item = R::FoundLight>,
    ) {
        if cohort >= self.cohorts.len() {
            self.cohorts.resize_with(cohort + 1, Cohort::default);
        }
        let cohort = &mut self.cohorts[cohort];
        cohort.is_mixed |= cohort.waiting.last().is_some_and(|last| last.kind() != receiver.kind());
        cohort.waiting.push(receiver);
        cohort.firsts.push(cohort.found.len());
        cohort.found.extend(found);
    }

    /// Calls `add` with the number of the sample, the layer and the light for every receiver that gets some, or for some of
    /// them if stopped, and forgets all receivers.
    pub(super) fn resolve(&mut self, stop: &AtomicBool, mut add: impl FnMut(usize, Layer, Vec3)) {
        let Self { cohorts, order, sums } = self;
        for cohort in &*cohorts {
            let Cohort { waiting, is_mixed, .. } = cohort;
            order.clear();
            order.extend(0..waiting.len());
            if *is_mixed {
                order.sort_by_key(|&i| waiting[i].kind());
            }
            let by_kind = || {
                let kinds = order.chunk_by(|&a, &b| !is_mixed || waiting[a].kind() == waiting[b].kind());
                kinds.map(|indices| Alike { cohort, indices })
            };
            sums.look_around(by_kind());
            for alike in by_kind() {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                let receivers = alike.receivers();
                sums.prepare(&alike);
                for (row, receiver) in receivers.enumerate() {
                    let light = sums.gather(row, receiver);
                    if light != Vec3::ZERO {
                        let Account { sample, layer, throughput, .. } = *receiver.account();
                        add(sample, layer, throughput * light);
                    }
                }
            }
        }
        self.clear();
    }

    /// Forgets all receivers.
    pub(super) fn clear(&mut self) {
        for Cohort { waiting, is_mixed, found, firsts } in &mut self.cohorts {
            waiting.clear();
            *is_mixed = false;
            found.clear();
            firsts.clear();
        }
    }
}
