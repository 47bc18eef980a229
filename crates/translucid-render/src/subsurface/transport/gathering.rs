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
//!
//! # Even light
//! Where all E_i are alike there is nothing to share: how many y_i lie near x_j is a matter of chance, while K_j W_j of
//! its own hardly varies. The light that half of the receivers find tells whether that of the others, A, is worth sharing
//! with x_j; if not, its own find stands for theirs:
//!
//! ```text
//! Σ_{i∈A} w_i(y_i) K_j(y_i) W_i E_i   or   Σ_{i∈A} w_i(y_j) K_j(y_j) W_j E_j
//! ```
//!
//! Both have the same mean, and the choice knows neither A's places nor, without y_j's, x_j's.
//!
//! # Expected light
//! Where the integral of K_j over all places is 1, the same noise is taken away by a control variate, whatever E is:
//!
//! ```text
//! L_j = Ē + Σ_i w_i(y_i) K_j(y_i) W_i (E_i − Ē)
//! ```
//!
//! Ē is what receivers nearby have found that share nothing with these, so that it knows nothing of their places. Places with
//! more light than that and with less are picked from separately: a sum whose terms cancel would be far from any few of them.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;

use super::widest::{Loop, in_widest_vectors};
use crate::subsurface::exit_point::ExitPoint;
use crate::world::{Layer, PathState};

/// Places that are worked on together.
pub(super) const LANES: usize = 16;

/// Places whose terms are added up before some of them are picked.
const GROUP: usize = 8;

/// Greatest number of terms that stand for a sum.
const MOST_PICKS: usize = 8;

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
    type Response;

    /// Terms that stand for the sum over all places, at most [`MOST_PICKS`].
    const PICKS: usize;

    fn kind(&self) -> Self::Kind;

    /// Where and how its light is added.
    fn account(&self) -> &Account;

    /// g at places with these coordinates, whose number is a multiple of [`LANES`]; adds it to the sums, too.
    fn fill(&self, points: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]);

    /// Rough worth of light, by channel.
    fn color(&self) -> Vec3;

    /// What K is evaluated with, for all places.
    fn response(&self) -> Self::Response;

    /// K times the light at a place and a factor.
    fn light_from(&self, response: &Self::Response, found: &Self::Found, factor: f32) -> Vec3;

    /// Whether the integral of K over all places is 1 in every channel.
    fn is_complete(&self) -> bool {
        false
    }

    /// Whether what it finds tells what light to expect of another that it shares nothing with.
    fn tells_of(&self, _other: &Self) -> bool {
        false
    }

    /// K W E of what it has found itself, for each kind of light that is not worth sharing.
    fn alone(&self, kinds: [Evenness; 2], found: Option<&Self::Found>) -> [Option<Vec3>; 2];
}

/// A place that a receiver has found.
pub(super) trait Found: Copy {
    /// Position and whatever else decides how near it is.
    fn coordinates(&self) -> [f32; COORDINATES];

    /// g_i W_i: about 1, and 1 where g is the density by which it was found.
    fn own_weight(&self) -> f32;

    /// All light that is there.
    fn light(&self) -> Vec3;

    /// The same place with so much less light; needed where receivers are [complete](Receiver::is_complete).
    fn less(&self, _light: Vec3) -> Self {
        *self
    }

    /// Normal of the surface, 0 where there is none.
    fn normal(&self) -> Vec3;
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
pub(super) struct Gathering<R: Receiver> {
    cohorts: Vec<Cohort<R>>,
    order: Vec<usize>,
    /// The first receiver of each complete kind, and what those of its kind have found.
    known: Vec<(usize, Evenness)>,
    sums: Sums<R::Found>,
}

/// Receivers that may share with each other, and with no others.
///
/// Each cohort has memory of its own: that of a block is more than is near a processor, and a cohort's receivers come from
/// all over the block.
struct Cohort<R: Receiver> {
    waiting: Vec<R>,
    /// Whether they are of several kinds.
    is_mixed: bool,
    /// Places, by receiver, and the first one of each.
    found: Vec<R::Found>,
    firsts: Vec<usize>,
}

impl<R: Receiver> Cohort<R> {
    /// Places that a receiver has found.
    fn found_by(&self, index: usize) -> &[R::Found] {
        let end = self.firsts.get(index + 1).map_or(self.found.len(), |first| *first);
        &self.found[self.firsts[index]..end]
    }

    /// Evenness of all places that some receivers have found.
    fn evenness(&self, receivers: &[usize]) -> Evenness {
        let found = receivers.iter().flat_map(|&index| self.found_by(index));
        found.fold(Evenness::default(), |all, one| all.plus(1.0, Evenness::of(one)))
    }
}

impl<R: Receiver> Default for Cohort<R> {
    fn default() -> Self {
        Self { waiting: Vec::new(), is_mixed: false, found: Vec::new(), firsts: Vec::new() }
    }
}

impl<R: Receiver> Default for Gathering<R> {
    fn default() -> Self {
        Self { cohorts: Vec::new(), order: Vec::new(), known: Vec::new(), sums: Sums::default() }
    }
}

/// Work space for receivers of one kind.
struct Sums<F> {
    /// Places in two parts, by coordinate (each part filled up to whole [`LANES`]): those that each half has found or, where
    /// receivers are complete, bright ones and dark ones. Σ g over the receivers of each half.
    found: Vec<F>,
    points: [Vec<f32>; COORDINATES],
    sums: [Vec<f32>; 2],
    /// Where the second part begins.
    split: usize,
    /// Light that places have beside what counts as found there.
    expected: Vec3,
    /// Place that each receiver has found.
    own: Vec<Option<usize>>,
    /// Light that each receiver has from there, in place of that of each half.
    alone: Vec<[Option<Vec3>; 2]>,
    /// w_i W_i, and that times the light, by channel.
    coefficients: Vec<f32>,
    bright: [Vec<f32>; 3],
    /// That times g and the receiver's color, of one receiver.
    terms: Vec<f32>,
    /// g of each receiver (row) at each place.
    nearness: Vec<f32>,
    /// Sums of a receiver's terms up to the end of each [`GROUP`].
    partial: Vec<f32>,
}

impl<F> Default for Sums<F> {
    fn default() -> Self {
        Self {
            found: Vec::new(),
            points: Default::default(),
            sums: Default::default(),
            split: 0,
            expected: Vec3::ZERO,
            own: Vec::new(),
            alone: Vec::new(),
            coefficients: Vec::new(),
            bright: Default::default(),
            terms: Vec::new(),
            nearness: Vec::new(),
            partial: Vec::new(),
        }
    }
}

impl<R: Receiver> Gathering<R> {
    /// Number of places that the only cohort has found.
    pub(super) fn found_count(&self) -> usize {
        self.cohorts.first().map_or(0, |cohort| cohort.found.len())
    }

    /// A place that the only cohort has found.
    pub(super) fn found_mut(&mut self, index: usize) -> &mut R::Found {
        &mut self.cohorts[0].found[index]
    }

    /// Adds a receiver to the only cohort, and the places that it has found.
    pub(super) fn push(&mut self, receiver: R, found: impl IntoIterator<Item = R::Found>) {
        self.push_to(0, receiver, found);
    }

    /// Adds a receiver to the cohort of this number, and the places that it has found.
    pub(super) fn push_to(&mut self, cohort: usize, receiver: R, found: impl IntoIterator<Item = R::Found>) {
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
        for cohort in &self.cohorts {
            let Cohort { waiting, is_mixed, .. } = cohort;
            self.order.clear();
            self.order.extend(0..waiting.len());
            if *is_mixed {
                self.order.sort_by_key(|&i| waiting[i].kind());
            }
            let by_kind =
                || self.order.chunk_by(|&a, &b| !is_mixed || waiting[a].kind() == waiting[b].kind());
            self.known.clear();
            if *is_mixed {
                let complete = by_kind().filter(|alike| waiting[alike[0]].is_complete());
                self.known.extend(complete.map(|alike| (alike[0], cohort.evenness(alike))));
            }
            for alike in by_kind() {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                let is_telling = |(first, _): &&(usize, _)| waiting[*first].tells_of(&waiting[alike[0]]);
                // Too little light takes noise away, too; too much adds noise where it is dark
                let told = self.known.iter().filter(is_telling).map(|(_, evenness)| evenness.expected());
                let expected = told.reduce(Vec3::min).unwrap_or(Vec3::ZERO);
                self.sums.prepare(alike, waiting, |index| cohort.found_by(index), expected);
                for (row, &index) in alike.iter().enumerate() {
                    let receiver = &waiting[index];
                    let light = self.sums.gather(row, receiver);
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

/// Relative variance of light from which on none is expected: it may be elsewhere.
///
/// Error of matte walks on the head, 4 samples, over that with 2: 0.97 with 5, 1.09 with 1, 1.22 with 0.5. The greater it is,
/// the noisier is what lies in the dark beside a bright lamp.
const UNFORESEEABLE: f32 = 2.0;

/// Sums over places that tell how even they and their light are.
#[derive(Clone, Copy, Default)]
pub(super) struct Evenness {
    count: f32,
    light: Vec3,
    /// Sum over the places of the square of their light, channels added up.
    light_squared: f32,
    normal: Vec3,
}

impl Evenness {
    fn of(found: &impl Found) -> Self {
        let light = found.light();
        Self { count: 1.0, light, light_squared: light.element_sum().powi(2), normal: found.normal() }
    }

    /// These and as many times others.
    fn plus(self, factor: f32, other: Self) -> Self {
        Self {
            count: self.count + factor * other.count,
            light: self.light + factor * other.light,
            light_squared: self.light_squared + factor * other.light_squared,
            normal: self.normal + factor * other.normal,
        }
    }

    /// Variance of the light over its mean squared; 0 where nothing is known.
    pub(super) fn variance(&self) -> f32 {
        let square = self.light.element_sum().powi(2);
        if square > 0.0 { self.count * self.light_squared / square - 1.0 } else { 0.0 }
    }

    /// Light to be expected elsewhere, by channel.
    fn expected(&self) -> Vec3 {
        // Rounding may leave a variance below 0
        let part = (1.0 - self.variance() / UNFORESEEABLE).clamp(0.0, 1.0);
        let expected = self.light / self.count * part;
        if expected.is_finite() { expected } else { Vec3::ZERO }
    }

    /// Variance of the normals.
    pub(super) fn roughness(&self) -> f32 {
        if self.count > 0.0 { 1.0 - self.normal.length_squared() / (self.count * self.count) } else { 1.0 }
    }
}

/// The half that a receiver belongs to.
fn half_of(row: usize) -> usize {
    row % 2
}

impl<F: Found> Sums<F> {
    /// Number of places, filled up.
    fn width(&self) -> usize {
        self.found.len()
    }

    /// Everything that all receivers share.
    fn prepare<'f, R: Receiver<Found = F>>(
        &mut self,
        alike: &[usize],
        waiting: &[R],
        found_by: impl Fn(usize) -> &'f [F],
        expected: Vec3,
    ) where
        F: 'f,
    {
        self.expected = expected;
        self.found.clear();
        let is_complete = waiting[alike[0]].is_complete();
        self.alone.clear();
        if is_complete {
            self.alone.resize(alike.len(), [None; 2]);
        } else {
            self.find_alone(alike, waiting, &found_by);
        }
        if self.alone.iter().flatten().all(Option::is_some) {
            return;
        }
        self.points.iter_mut().for_each(Vec::clear);
        self.own.clear();
        self.own.resize(alike.len(), None);
        for part in 0..2 {
            self.split = self.found.len();
            for (row, &index) in alike.iter().enumerate() {
                for found in found_by(index) {
                    let (found, part_of) = if is_complete {
                        let rest = found.less(expected);
                        (rest, usize::from(rest.light().element_sum() < 0.0))
                    } else {
                        (*found, half_of(row))
                    };
                    if part_of == part {
                        self.own[row] = Some(self.found.len());
                        self.push(found);
                    }
                }
            }
            self.fill_up();
        }
        if self.width() > 0 {
            self.weigh(alike, waiting);
        }
    }

    /// Light of those who keep to their own.
    fn find_alone<'f, R: Receiver<Found = F>>(
        &mut self,
        alike: &[usize],
        waiting: &[R],
        found_by: impl Fn(usize) -> &'f [F],
    ) where
        F: 'f,
    {
        let mut evenness = [Evenness::default(); 2];
        for (row, &index) in alike.iter().enumerate() {
            let evenness = &mut evenness[half_of(row)];
            for found in found_by(index) {
                *evenness = evenness.plus(1.0, Evenness::of(found));
            }
        }
        for (row, &index) in alike.iter().enumerate() {
            let own = found_by(index).last();
            let mut known = evenness;
            if let Some(own) = own {
                known[half_of(row)] = known[half_of(row)].plus(-1.0, Evenness::of(own));
            }
            // Each half by what the other knows
            self.alone.push(waiting[index].alone([known[1], known[0]], own));
        }
    }

    fn push(&mut self, found: F) {
        self.found.push(found);
        for (points, coordinate) in self.points.iter_mut().zip(found.coordinates()) {
            points.push(coordinate);
        }
    }

    /// Adds places that no receiver is near, up to whole [`LANES`].
    fn fill_up(&mut self) {
        let Some(&last) = self.found.last() else { return };
        let width = self.found.len().next_multiple_of(LANES);
        self.found.resize(width, last);
        for (coordinate, values) in self.points.iter_mut().enumerate() {
            values.resize(width, if coordinate < 3 { FAR } else { 0.0 });
        }
    }

    /// Weights of all places.
    fn weigh<R: Receiver<Found = F>>(&mut self, alike: &[usize], waiting: &[R]) {
        let width = self.width();
        for sums in &mut self.sums {
            sums.clear();
            sums.resize(width, 0.0);
        }
        self.nearness.resize(width * alike.len(), 0.0);
        let points = self.points.each_ref().map(Vec::as_slice);
        for (row, (near, &index)) in self.nearness.chunks_exact_mut(width).zip(alike).enumerate() {
            waiting[index].fill(points, near, &mut self.sums[half_of(row)]);
        }
        self.coefficients.clear();
        self.bright.iter_mut().for_each(Vec::clear);
        for (i, found) in self.found.iter().enumerate() {
            let coefficient = found.own_weight() / (self.sums[0][i] + self.sums[1][i]);
            let bright = (coefficient * found.light()).abs();
            let is_usable = coefficient > 0.0 && bright.is_finite() && self.points[0][i] != FAR;
            self.coefficients.push(if is_usable { coefficient } else { 0.0 });
            for (c, channel) in self.bright.iter_mut().enumerate() {
                channel.push(if is_usable { bright[c] } else { 0.0 });
            }
        }
        self.terms.resize(width, 0.0);
        self.partial.resize(width / GROUP, 0.0);
    }

    /// Light for the receiver of a row.
    fn gather<R: Receiver<Found = F>>(&mut self, row: usize, receiver: &R) -> Vec3 {
        let width = self.width();
        let alone = self.alone[row];
        if let [Some(light), Some(_)] = alone {
            return light;
        }
        let mut light = self.expected;
        if width == 0 {
            return light;
        }
        if let Some(i) = self.own[row] {
            let sums = [self.sums[0][i], self.sums[1][i]];
            for half in 0..2 {
                let part = sums[half] / (sums[0] + sums[1]);
                // Not a number where nobody is near
                light += alone[half].filter(|_| part.is_finite()).map_or(Vec3::ZERO, |alone| alone * part);
            }
        }
        let near = &self.nearness[row * width..(row + 1) * width];
        let color = receiver.color();
        let most = color.max_element();
        // What has none of this receiver's color is worth nothing to it
        let color = if most > 0.0 { color / most } else { Vec3::ONE };
        let parts = match alone {
            [None, None] if receiver.is_complete() => [0..self.split, self.split..width],
            [None, None] => [0..width, 0..0],
            [None, _] => [0..self.split, 0..0],
            _ => [self.split..width, 0..0],
        };
        let mut sums = [0.0; 2];
        for (part, sum) in parts.iter().zip(&mut sums) {
            let [red, green, blue] = self.bright.each_ref().map(Vec::as_slice);
            let of = [red, green, blue, near].map(|row| &row[part.clone()]);
            let partial = &mut self.partial[part.start / GROUP..part.end / GROUP];
            let terms = &mut self.terms[part.clone()];
            in_widest_vectors(Terms { of, color: color.to_array(), terms, partial });
            for partial in partial {
                *sum += *partial;
                *partial = *sum;
            }
        }
        let picks = R::PICKS / sums.iter().filter(|sum| **sum > 0.0).count().max(1);
        let response = receiver.response();
        let random = receiver.account().random;
        for (part, sum) in parts.into_iter().zip(sums) {
            if !(sum > 0.0 && sum.is_finite()) {
                continue;
            }
            let step = sum / picks as f32;
            let mut places = [0; MOST_PICKS];
            let places = &mut places[..picks];
            self.find_places(&part, std::array::from_fn(|k| (random + k as f32) * step), places);
            for alike in places.chunk_by(|a, b| a == b) {
                let place = alike[0];
                let stands_for = alike.len() as f32 * step / self.terms[place];
                let factor = stands_for * self.coefficients[place];
                light += receiver.light_from(&response, &self.found[place], factor);
            }
        }
        light
    }

    /// Numbers of the places of a part with whose terms the running sum of all of the part passes each goal, for as many of
    /// the goals as there are places.
    ///
    /// By counting, for all goals at once and without a branch that depends on one.
    fn find_places(&self, part: &Range<usize>, goals: [f32; MOST_PICKS], places: &mut [usize]) {
        let partial = &self.partial[part.start / GROUP..part.end / GROUP];
        let terms = &self.terms[part.clone()];
        let mut groups_before = [0_u32; MOST_PICKS];
        for end in partial {
            for (before, goal) in groups_before.iter_mut().zip(&goals) {
                *before += u32::from(end <= goal);
            }
        }
        for ((place, before), goal) in places.iter_mut().zip(groups_before).zip(goals) {
            let group = (before as usize).min(partial.len() - 1);
            let mut passed = if group > 0 { partial[group - 1] } else { 0.0 };
            let mut terms_before = 0;
            for term in &terms[group * GROUP..(group + 1) * GROUP] {
                passed += term;
                terms_before += u32::from(passed <= goal);
            }
            let mut found = group * GROUP + (terms_before as usize).min(GROUP - 1);
            // Rounding may lead on to what is worth nothing
            while found > 0 && terms[found] <= 0.0 {
                found -= 1;
            }
            *place = part.start + found;
        }
    }
}

/// Worth of places to a receiver.
struct Terms<'a> {
    /// Light there by channel, and how near it is.
    of: [&'a [f32]; 4],
    /// Worth of each channel.
    color: [f32; 3],
    /// Worth of each place.
    terms: &'a mut [f32],
    /// Worth of [`GROUP`] places together.
    partial: &'a mut [f32],
}

impl Loop for Terms<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.color;
        let n = self.terms.len();
        let [red, green, blue, near] = self.of.map(|row| &row[..n]);
        for i in 0..n {
            self.terms[i] = near[i] * (red[i] * x + green[i] * y + blue[i] * z);
        }
        for (partial, group) in self.partial.iter_mut().zip(self.terms.as_chunks::<GROUP>().0) {
            let [a, b, c, d, e, f, g, h] = *group;
            *partial = ((a + e) + (c + g)) + ((b + f) + (d + h));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::split_mix;

    /// Finds places on a line, up to 1 away, with light that is (2 + y) times 0.5 or 1.5 there.
    struct Toy {
        x: f32,
        kind: usize,
        is_complete: bool,
        account: Account,
    }

    #[derive(Clone, Copy)]
    struct Spot {
        y: f32,
        light: f32,
    }

    impl Found for Spot {
        fn coordinates(&self) -> [f32; COORDINATES] {
            [self.y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        }

        fn own_weight(&self) -> f32 {
            1.0
        }

        fn light(&self) -> Vec3 {
            Vec3::splat(self.light)
        }

        fn less(&self, light: Vec3) -> Self {
            Self { light: self.light - light.x, ..*self }
        }

        fn normal(&self) -> Vec3 {
            Vec3::Z
        }
    }

    impl Receiver for Toy {
        type Kind = usize;
        type Found = Spot;
        type Response = ();
        const PICKS: usize = 3;

        fn kind(&self) -> usize {
            self.kind
        }

        fn account(&self) -> &Account {
            &self.account
        }

        fn fill(&self, [y, ..]: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]) {
            for (i, y) in y.iter().enumerate() {
                row[i] = if (y - self.x).abs() < 1.0 { 0.5 } else { 0.0 };
                sums[i] += row[i];
            }
        }

        fn color(&self) -> Vec3 {
            Vec3::ONE
        }

        fn response(&self) {}

        fn light_from(&self, (): &(), spot: &Spot, factor: f32) -> Vec3 {
            spot.light() * (factor * (1.0 + 0.3 * (spot.y - self.x)) * 0.5)
        }

        fn is_complete(&self) -> bool {
            self.is_complete
        }

        fn tells_of(&self, other: &Self) -> bool {
            self.kind != other.kind
        }

        fn alone(&self, kinds: [Evenness; 2], spot: Option<&Spot>) -> [Option<Vec3>; 2] {
            let own = || spot.map_or(Vec3::ZERO, |spot| self.light_from(&(), spot, 2.0));
            kinds.map(|evenness| (evenness.variance() < 0.3).then(own))
        }
    }

    /// Half of the light is not worth sharing, and what stands for it nobody is near.
    #[test]
    fn what_nobody_is_near_is_worth_nothing() {
        let mut gathering = Gathering::<Toy>::default();
        for (sample, (y, light)) in [(5.0, 1.0), (0.1, 0.01), (5.0, 1.0), (0.1, 10.0)].into_iter().enumerate()
        {
            let account = Account { sample, layer: Layer::Subsurface, throughput: Vec3::ONE, random: 0.5 };
            gathering.push(Toy { x: 0.0, kind: 0, is_complete: false, account }, [Spot { y, light }]);
        }
        let mut count = 0;
        gathering.resolve(&AtomicBool::new(false), |sample, _, light| {
            assert!(light.is_finite(), "{sample}: {light}");
            count += 1;
        });
        assert!(count > 0);
    }

    /// Mean light of receivers at 0, 0.2 … 1.6 and its variance over many trials, with its standard error from what is exact at
    /// most 5.
    fn variances(kinds: usize, is_complete: bool) -> [f64; 9] {
        let mut state = 7_u64;
        let mut random = move || {
            state = split_mix(state);
            (state >> 40) as f32 / (1 << 24) as f32
        };
        let mut gathering = Gathering::<Toy>::default();
        let mut moments = [(0.0_f64, 0.0_f64); 9];
        let trials = 40_000;
        for _ in 0..trials {
            for sample in 0..9 {
                let x = 0.2 * sample as f32;
                let account =
                    Account { sample, layer: Layer::Subsurface, throughput: Vec3::ONE, random: random() };
                let y = x + 2.0 * random() - 1.0;
                let light = (2.0 + y) * if random() < 0.5 { 0.5 } else { 1.5 };
                gathering.push(Toy { x, kind: sample % kinds, is_complete, account }, [Spot { y, light }]);
            }
            gathering.resolve(&AtomicBool::new(false), |sample, _, light| {
                let light = f64::from(light.x);
                moments[sample].0 += light;
                moments[sample].1 += light * light;
            });
        }
        std::array::from_fn(|sample| {
            let (sum, squared) = moments[sample];
            let (n, x) = (f64::from(trials), 0.2 * sample as f64);
            let exact = 2.0 + x + 0.1;
            let variance = squared / n - (sum / n).powi(2);
            let error = (variance / n).sqrt();
            assert!((sum / n - exact).abs() < 5.0 * error, "{sample}: {} ± {error}, not {exact}", sum / n);
            variance
        })
    }

    /// Every receiver keeps to its own for one half, for both or for none, as the light falls out.
    ///
    /// Nine comparisons of about 4 × 10⁴ trials, where 5 standard errors have a probability of 6e-7.
    #[test]
    fn choices_keep_the_mean() {
        variances(1, false);
    }

    /// Receivers expect what those of the other kind have found, and vary less.
    ///
    /// 18 comparisons of about 4 × 10⁴ trials, where 5 standard errors have a probability of 6e-7.
    #[test]
    fn expected_light_keeps_the_mean() {
        let [with, without] = [true, false].map(|is_complete| variances(2, is_complete));
        assert!((0..9).all(|i| with[i] < 0.7 * without[i]), "{with:?} {without:?}");
    }
}
