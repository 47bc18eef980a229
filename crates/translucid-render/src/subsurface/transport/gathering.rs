//! Light that is found below some pixels of a block, gathered by all that it could reach.
//!
//! Receivers x_1 … x_n each find a place y_i by a strategy of their own, with an unbiased estimate W_i of 1/p_i(y_i), and
//! the light E_i that is there: a shadow ray and a path, which is what costs. All of them could have found all places, so
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
//! The sum over i is itself drawn from: a few of its terms, in proportion to g_j W_i w_i E_i and evenly spaced along the
//! running sum, stand for all. What K_j is need be evaluated for these only.

use glam::Vec3;

use crate::subsurface::exit_point::ExitPoint;
use crate::world::{Layer, PathState};

/// Places that are worked on together.
pub(super) const LANES: usize = 8;

/// Numbers that a place is described by.
pub(super) const COORDINATES: usize = 7;

/// Coordinate \[L\] of a position that no receiver is near.
const FAR: f32 = 1e18;

/// Everything that exits have in common if they share: what was found is then the same to all of them, and so is how far
/// the light that arrives there has been followed, and through what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ExitKind {
    /// Subsurface group.
    pub(crate) group: u32,
    /// Whether it is seen from outside.
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
pub(super) trait Receiver {
    /// Everything that receivers have in common if they share.
    type Kind: Ord;
    /// A place with light, which one receiver finds and all use.
    type Found: Found;

    /// Terms that stand for the sum over all places.
    const PICKS: usize;

    fn kind(&self) -> Self::Kind;

    /// Where and how its light is added.
    fn account(&self) -> &Account;

    /// g at places with these coordinates, whose number is a multiple of [`LANES`]; adds it to the sums, too.
    fn fill(&self, points: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]);

    /// Rough worth of light, by channel.
    fn color(&self) -> Vec3;

    /// K times the light at a place and a factor.
    fn light_from(&self, found: &Self::Found, factor: f32) -> Vec3;
}

/// A place that a receiver has found.
pub(super) trait Found: Copy {
    /// Position and whatever else decides how near it is.
    fn coordinates(&self) -> [f32; COORDINATES];

    /// g_i W_i: about 1, and 1 where g is the density by which it was found.
    fn own_weight(&self) -> f32;

    /// All light that is there.
    fn light(&self) -> Vec3;
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

/// The receivers of a block; keeps its memory from block to block.
pub(super) struct Gathering<R: Receiver> {
    waiting: Vec<R>,
    /// Places, by receiver, and the first one of each.
    found: Vec<R::Found>,
    firsts: Vec<usize>,
    order: Vec<usize>,
    sums: Sums<R::Found>,
}

impl<R: Receiver> Default for Gathering<R> {
    fn default() -> Self {
        Self {
            waiting: Vec::new(),
            found: Vec::new(),
            firsts: Vec::new(),
            order: Vec::new(),
            sums: Sums::default(),
        }
    }
}

/// Work space for receivers of one kind.
struct Sums<F> {
    /// Places, by coordinate (filled up to whole [`LANES`]), Σ g.
    found: Vec<F>,
    points: [Vec<f32>; COORDINATES],
    sums: Vec<f32>,
    /// w_i W_i, and that times the light, by channel.
    coefficients: Vec<f32>,
    bright: [Vec<f32>; 3],
    /// That times g and the receiver's color, of one receiver.
    terms: Vec<f32>,
    /// g of each receiver (row) at each place.
    nearness: Vec<f32>,
    /// A receiver's terms, those of [`LANES`] places together.
    partial: Vec<f32>,
}

impl<F> Default for Sums<F> {
    fn default() -> Self {
        Self {
            found: Vec::new(),
            points: Default::default(),
            sums: Vec::new(),
            coefficients: Vec::new(),
            bright: Default::default(),
            terms: Vec::new(),
            nearness: Vec::new(),
            partial: Vec::new(),
        }
    }
}

impl<R: Receiver> Gathering<R> {
    /// Adds a receiver and the places that it has found.
    pub(super) fn push(&mut self, receiver: R, found: impl IntoIterator<Item = R::Found>) {
        self.waiting.push(receiver);
        self.firsts.push(self.found.len());
        self.found.extend(found);
    }

    /// Calls `add` with the number of the sample, the layer and the light for every receiver that gets some, and forgets
    /// all receivers.
    pub(super) fn resolve(&mut self, mut add: impl FnMut(usize, Layer, Vec3)) {
        self.order.clear();
        self.order.extend(0..self.waiting.len());
        self.order.sort_by_key(|&i| self.waiting[i].kind());
        let waiting = &self.waiting;
        for alike in self.order.chunk_by(|&a, &b| waiting[a].kind() == waiting[b].kind()) {
            let of = |index: usize| {
                let end = self.firsts.get(index + 1).map_or(self.found.len(), |first| *first);
                &self.found[self.firsts[index]..end]
            };
            self.sums.prepare(alike, waiting, of);
            for (row, &index) in alike.iter().enumerate() {
                let receiver = &waiting[index];
                let light = self.sums.gather(row, receiver);
                if light != Vec3::ZERO {
                    let Account { sample, layer, throughput, .. } = *receiver.account();
                    add(sample, layer, throughput * light);
                }
            }
        }
        self.clear();
    }

    /// Forgets all receivers.
    pub(super) fn clear(&mut self) {
        self.waiting.clear();
        self.found.clear();
        self.firsts.clear();
    }
}

impl<F: Found> Sums<F> {
    /// Number of places, filled up.
    fn width(&self) -> usize {
        self.sums.len()
    }

    /// Everything that all receivers share.
    fn prepare<'f, R: Receiver<Found = F>>(
        &mut self,
        alike: &[usize],
        waiting: &[R],
        found_by: impl Fn(usize) -> &'f [F],
    ) where
        F: 'f,
    {
        self.found.clear();
        self.points.iter_mut().for_each(Vec::clear);
        for &index in alike {
            for found in found_by(index) {
                self.found.push(*found);
                for (points, coordinate) in self.points.iter_mut().zip(found.coordinates()) {
                    points.push(coordinate);
                }
            }
        }
        let width = self.found.len().next_multiple_of(LANES);
        for (coordinate, values) in self.points.iter_mut().enumerate() {
            values.resize(width, if coordinate < 3 { FAR } else { 0.0 });
        }
        self.sums.clear();
        self.sums.resize(width, 0.0);
        self.nearness.resize(width * alike.len(), 0.0);
        if width == 0 {
            return;
        }
        let points = self.points.each_ref().map(Vec::as_slice);
        for (row, &index) in self.nearness.chunks_exact_mut(width).zip(alike) {
            waiting[index].fill(points, row, &mut self.sums);
        }
        self.coefficients.clear();
        self.bright.iter_mut().for_each(Vec::clear);
        for (found, sum) in self.found.iter().zip(&self.sums) {
            let coefficient = found.own_weight() / sum;
            let bright = coefficient * found.light();
            let is_usable = coefficient > 0.0 && bright.max_element() > 0.0 && bright.is_finite();
            self.coefficients.push(if is_usable { coefficient } else { 0.0 });
            for (c, channel) in self.bright.iter_mut().enumerate() {
                channel.push(if is_usable { bright[c] } else { 0.0 });
            }
        }
        self.bright.iter_mut().for_each(|channel| channel.resize(width, 0.0));
        self.terms.resize(width, 0.0);
    }

    /// Light for the receiver of a row.
    fn gather<R: Receiver<Found = F>>(&mut self, row: usize, receiver: &R) -> Vec3 {
        let width = self.width();
        let near = &self.nearness[row * width..(row + 1) * width];
        let color = receiver.color();
        let most = color.max_element();
        // What has none of this receiver's color is worth nothing to it
        let color = if most > 0.0 { color / most } else { Vec3::ONE };
        let [red, green, blue] = self.bright.each_ref().map(|channel| &channel[..width]);
        let terms = &mut self.terms[..width];
        for i in 0..width {
            terms[i] = near[i] * (red[i] * color.x + green[i] * color.y + blue[i] * color.z);
        }
        self.partial.clear();
        for chunk in terms.chunks_exact(LANES) {
            self.partial.push(chunk.iter().sum());
        }
        let sum: f32 = self.partial.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Vec3::ZERO;
        }
        let step = sum / R::PICKS as f32;
        let mut light = Vec3::ZERO;
        // Picks are where the running sum passes (random + k) steps
        let mut passed = 0.0;
        let mut picked = 0;
        let random = receiver.account().random;
        let goal = |picked: usize| (random + picked as f32) * step;
        for (chunk, &partial) in self.partial.iter().enumerate() {
            if passed + partial <= goal(picked) {
                passed += partial;
                continue;
            }
            let end = passed + partial;
            for i in chunk * LANES..(chunk + 1) * LANES {
                let term = self.terms[i];
                if term <= 0.0 {
                    continue;
                }
                passed += term;
                let before = picked;
                while picked < R::PICKS && goal(picked) < passed {
                    picked += 1;
                }
                if picked > before {
                    let stands_for = (picked - before) as f32 * step / term;
                    light += receiver.light_from(&self.found[i], stands_for * self.coefficients[i]);
                }
            }
            passed = end;
        }
        light
    }
}
