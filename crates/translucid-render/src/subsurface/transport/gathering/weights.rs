//! The weights of all places that receivers of one kind have found.

use std::ops::Range;

use glam::Vec3;

use super::{Alike, BlockReceiver, FoundLight};

/// Places that are worked on together.
pub(in crate::subsurface::transport) const LANES: usize = 16;

/// Numbers that describe a place.
pub(in crate::subsurface::transport) const COORDINATES: usize = 7;

/// Places whose terms are added up before some of them are picked.
const GROUP: usize = 8;

/// Coordinate \[L\] of a position that no receiver is near.
const FAR: f32 = 1e18;

/// The half that a receiver belongs to.
pub(super) fn half_of(row: usize) -> usize {
    row % 2
}

/// Worth of each channel of the light that a receiver of some color gathers, at most 1.
pub(super) fn worth_of_channels(color: Vec3) -> [f32; 3] {
    let most = color.max_element();
    // Light without this receiver's colors is worth nothing to it
    if most > 0.0 { (color / most).to_array() } else { [1.0; 3] }
}

/// Places in two parts, each filled up to whole [`LANES`], and their weights.
pub(super) struct MisWeights<F> {
    pub(super) found: Vec<F>,
    /// Coordinates of the places, a column each.
    points: [Vec<f32>; COORDINATES],
    /// Where the second part begins.
    pub(super) split: usize,
    /// Σ g over the receivers of each half.
    pub(super) sums: [Vec<f32>; 2],
    /// w_i W_i, and that times the light, by channel.
    pub(super) coefficients: Vec<f32>,
    bright: [Vec<f32>; 3],
    /// Rows of nearness, [`stride`](Self::stride) numbers for each receiver.
    nearness: Vec<f32>,
    stride: usize,
    /// Worth of each place to one receiver.
    pub(super) terms: Vec<f32>,
    /// Sums of these up to the end of each [`GROUP`].
    partial: Vec<f32>,
}

/// Places as a receiver sees them.
pub(super) struct PlaceLanes<'a> {
    /// Their nearness, which the receiver has filled in.
    pub(super) near: &'a [f32],
    /// w_i W_i times the light, by channel.
    pub(super) bright: [&'a [f32]; 3],
    /// w_i W_i.
    pub(super) coefficients: &'a [f32],
}

impl<F> Default for MisWeights<F> {
    fn default() -> Self {
        Self {
            found: Vec::new(),
            points: Default::default(),
            split: 0,
            sums: Default::default(),
            coefficients: Vec::new(),
            bright: Default::default(),
            nearness: Vec::new(),
            stride: 0,
            terms: Vec::new(),
            partial: Vec::new(),
        }
    }
}

impl<F: FoundLight> MisWeights<F> {
    /// Number of places, filled up.
    pub(super) fn width(&self) -> usize {
        self.found.len()
    }

    /// Places by coordinate.
    pub(super) fn points(&self) -> [&[f32]; COORDINATES] {
        self.points.each_ref().map(Vec::as_slice)
    }

    /// All places as the receiver of a row sees them, and the terms to be made of that.
    pub(super) fn places_and_terms(&mut self, row: usize) -> (PlaceLanes<'_>, &mut [f32]) {
        let places = PlaceLanes {
            near: &self.nearness[row * self.stride..(row + 1) * self.stride],
            bright: self.bright.each_ref().map(Vec::as_slice),
            coefficients: &self.coefficients,
        };
        (places, &mut self.terms)
    }

    /// Puts in the places of one part after those of the other, with the number of the receiver that has found each.
    pub(super) fn arrange<R: BlockReceiver<FoundLight = F>>(
        &mut self,
        alike: &Alike<'_, R>,
        part_of: impl Fn(usize, &F) -> usize,
        mut place: impl FnMut(usize, usize),
    ) {
        self.found.clear();
        self.points.iter_mut().for_each(Vec::clear);
        for part in 0..2 {
            self.split = self.found.len();
            for (row, all) in alike.found().enumerate() {
                for found in all.iter().filter(|found| part_of(row, found) == part) {
                    place(row, self.found.len());
                    self.push(*found);
                }
            }
            self.fill_up();
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

    /// Weighs all places for receivers that fill so many numbers for each; so much `less` light counts.
    pub(super) fn weigh<R: BlockReceiver<FoundLight = F>>(
        &mut self,
        alike: &Alike<'_, R>,
        rows: usize,
        less: Vec3,
    ) {
        let width = self.width();
        for sums in &mut self.sums {
            sums.clear();
            sums.resize(width, 0.0);
        }
        self.stride = rows * width;
        if width == 0 {
            return;
        }
        self.nearness.resize(self.stride * alike.len(), 0.0);
        let points = self.points.each_ref().map(Vec::as_slice);
        let rows = self.nearness.chunks_exact_mut(self.stride);
        for (row, (near, receiver)) in rows.zip(alike.receivers()).enumerate() {
            receiver.fill(points, near, &mut self.sums[half_of(row)]);
        }
        self.coefficients.clear();
        self.bright.iter_mut().for_each(Vec::clear);
        for (i, found) in self.found.iter().enumerate() {
            let coefficient = found.own_weight() / (self.sums[0][i] + self.sums[1][i]);
            let bright = coefficient * (found.light() - less);
            let is_usable = coefficient > 0.0 && bright.is_finite() && self.points[0][i] != FAR;
            self.coefficients.push(if is_usable { coefficient } else { 0.0 });
            for (c, channel) in self.bright.iter_mut().enumerate() {
                channel.push(if is_usable { bright[c] } else { 0.0 });
            }
        }
        self.terms.resize(width, 0.0);
        self.partial.resize(width / GROUP, 0.0);
    }

    /// Sum of the terms of a range of whole [`LANES`]; readies it for [`find_places`](Self::find_places).
    pub(super) fn add_up(&mut self, range: &Range<usize>) -> f32 {
        let partial = &mut self.partial[range.start / GROUP..range.end / GROUP];
        let mut sum = 0.0;
        for (partial, group) in partial.iter_mut().zip(self.terms[range.clone()].as_chunks::<GROUP>().0) {
            let [a, b, c, d, e, f, g, h] = *group;
            sum += ((a + e) + (c + g)) + ((b + f) + (d + h));
            *partial = sum;
        }
        sum
    }

    /// Numbers of the places of a range with whose terms the running sum of all of the range passes each goal.
    ///
    /// By counting, for all goals at once and without a branch that depends on one.
    pub(super) fn find_places<const N: usize>(&self, range: &Range<usize>, goals: [f32; N]) -> [usize; N] {
        let partial = &self.partial[range.start / GROUP..range.end / GROUP];
        let terms = &self.terms[range.clone()];
        let mut groups_before = [0_u32; N];
        for end in partial {
            for (before, goal) in groups_before.iter_mut().zip(&goals) {
                *before += u32::from(end <= goal);
            }
        }
        let mut places = [0; N];
        for ((place, before), goal) in places.iter_mut().zip(groups_before).zip(goals) {
            let group = (before as usize).min(partial.len() - 1);
            let mut passed = if group > 0 { partial[group - 1] } else { 0.0 };
            let mut terms_before = 0;
            for term in &terms[group * GROUP..(group + 1) * GROUP] {
                passed += term;
                terms_before += u32::from(passed <= goal);
            }
            let mut found = group * GROUP + (terms_before as usize).min(GROUP - 1);
            // Rounding may lead to a place without worth
            while found > 0 && terms[found] <= 0.0 {
                found -= 1;
            }
            *place = range.start + found;
        }
        places
    }
}
