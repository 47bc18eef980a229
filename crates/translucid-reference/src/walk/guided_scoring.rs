//! Scores of guided photons that have left: which part of each counts in which ring.
//!
//! Given its slope, the last flight of a photon ends on a circle around its last collision. The part of that circle
//! inside a radius is an arc cosine.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x16};

use super::guided_columns::Columns;
use super::lanes::{self, Floats, Words};
use super::random::LANES;

/// Rings into which a block's light is sorted.
#[derive(Clone, Debug)]
pub(super) struct Scoring {
    /// Radii between rings, increasing; the innermost ring starts at 0.
    pub(super) radii: Vec<f32>,
    /// 1/(distance from the entry at which roulette sets in)²; 0 for no roulette.
    pub(super) roulette: f32,
}

impl Scoring {
    /// The radii are finite and increase.
    pub(super) fn new(radii: &[f64]) -> Self {
        let reach = radii.last().copied().unwrap_or(3.0) + 1.0;
        let radii = radii.iter().map(|&radius| radius as f32).collect();
        Self { radii, roulette: (reach * reach).recip() as f32 }
    }
}

/// Sums of the weights that the photons of a chunk have carried out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ChunkSums {
    /// Sum over all photons.
    pub(super) total: f64,
    /// Sums inside each radius and outside the one before; the last is outside all.
    pub(super) rings: Vec<f64>,
    /// Number of collisions.
    pub(super) collisions: u64,
}

impl ChunkSums {
    pub(super) fn new(radii: usize) -> Self {
        Self { total: 0.0, rings: vec![0.0; radii + 1], collisions: 0 }
    }
}

/// Photons that have left or were ended.
pub(super) struct LeftPhotons {
    /// Columns in the order of [`LeftGroup`], and the chunk.
    rows: Columns<4, 1>,
    /// Part of the azimuths of the last flight that end inside the radius at hand.
    inside: Vec<f32>,
}

/// Sixteen photons that have left or were ended.
pub(super) struct LeftGroup<S: Simd> {
    /// ρ² + d², where ρ is the distance of the last collision from the axis and d the way aside from there.
    pub(super) squares: Floats<S>,
    /// 1/(2ρd).
    pub(super) product: Floats<S>,
    /// Weight that gets out; 0 for a photon ended by roulette.
    pub(super) score: Floats<S>,
    /// Contribution to the total.
    pub(super) total: Floats<S>,
}

impl LeftPhotons {
    /// A list with room for so many photons.
    pub(super) fn new(capacity: usize) -> Self {
        Self { rows: Columns::new(capacity), inside: vec![0.0; capacity + LANES] }
    }

    pub(super) fn clear(&mut self) {
        self.rows.len = 0;
    }

    /// Appends the first `count` photons of a group.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, group: &LeftGroup<S>, chunk: Words<S>, count: usize) {
        let LeftGroup { squares, product, score, total } = *group;
        self.rows.put(self.rows.len, [squares, product, score, total], [chunk]);
        self.rows.len += count;
    }

    /// Starts a sum over rings, and returns the number of groups.
    #[inline(always)]
    fn start(&mut self) -> usize {
        self.rows.clear_end();
        let groups = self.rows.len.div_ceil(LANES);
        self.inside[..groups * LANES].fill(0.0);
        groups
    }

    #[inline(always)]
    fn group<S: Simd>(&self, simd: S, group: usize) -> (LeftGroup<S>, [u32; LANES]) {
        let ([squares, product, score, total], [chunk]) = self.rows.get(simd, group * LANES);
        (LeftGroup { squares, product, score, total }, chunk.to_array())
    }

    /// Scores of a group in the ring that ends at a radius and starts where the last call's ended.
    #[inline(always)]
    fn ring_score<S: Simd>(&mut self, simd: S, radius2: f32, group: usize) -> Floats<S> {
        let (left, _) = self.group(simd, group);
        let before = &mut self.inside[group * LANES..(group + 1) * LANES];
        let inside = part_inside(simd, left.squares, left.product, radius2);
        let ring = left.score * (inside - f32x16::from_slice(simd, before));
        inside.store_slice(before);
        ring
    }

    /// Scores of a group outside all radii, with what roulette has taken from the total or added to it: exactly 0 for
    /// a photon that certainly left inside.
    #[inline(always)]
    fn score_beyond<S: Simd>(&self, simd: S, group: usize) -> Floats<S> {
        let (left, _) = self.group(simd, group);
        let inside = &self.inside[group * LANES..(group + 1) * LANES];
        left.total - left.score * f32x16::from_slice(simd, inside)
    }
}

/// Sums the scores of one chunk.
#[inline(always)]
pub(super) fn score<S: Simd>(simd: S, scoring: &Scoring, left: &mut LeftPhotons, sums: &mut ChunkSums) {
    let groups = left.start();
    let zero = f32x16::splat(simd, 0.0);
    let mut total = zero;
    for group in 0..groups {
        total += left.group(simd, group).0.total;
    }
    sums.total += sum(total);
    for (radius, ring) in scoring.radii.iter().zip(&mut sums.rings) {
        let mut score = zero;
        for group in 0..groups {
            score += left.ring_score(simd, radius * radius, group);
        }
        *ring += sum(score);
    }
    let mut score = zero;
    for group in 0..groups {
        score += left.score_beyond(simd, group);
    }
    if let Some(ring) = sums.rings.last_mut() {
        *ring += sum(score);
    }
}

/// Sums the scores of photons of several chunks, photon by photon.
#[inline(always)]
pub(super) fn score_apart<S: Simd>(
    simd: S,
    scoring: &Scoring,
    left: &mut LeftPhotons,
    sums: &mut [ChunkSums],
) {
    let (photons, groups) = (left.rows.len, left.start());
    for group in 0..groups {
        let (LeftGroup { total, .. }, chunks) = left.group(simd, group);
        let present = photons - group * LANES;
        for (total, chunk) in total.to_array().into_iter().zip(chunks).take(present) {
            sums[chunk as usize].total += f64::from(total);
        }
    }
    for ring in 0..=scoring.radii.len() {
        for group in 0..groups {
            let scores = match scoring.radii.get(ring) {
                Some(radius) => left.ring_score(simd, radius * radius, group),
                None => left.score_beyond(simd, group),
            };
            let (_, chunks) = left.group(simd, group);
            for (score, chunk) in scores.to_array().into_iter().zip(chunks) {
                sums[chunk as usize].rings[ring] += f64::from(score);
            }
        }
    }
}

#[inline(always)]
fn sum<S: Simd>(values: Floats<S>) -> f64 {
    values.to_array().into_iter().map(f64::from).sum()
}

/// arccos(c)/(π √(1 − c)) on [0, 1]: worst relative error 2e-8.
const ARC: [f32; 8] = [
    0.49999999090291997,
    -0.06830871447300023,
    0.02831966553614379,
    -0.015951878117500762,
    0.00977915529140816,
    -0.005360673480144129,
    0.0020663154493121283,
    -0.00038570811233284985,
];

/// Part of the azimuths that end inside a circle: arccos(c)/π.
#[inline(always)]
fn part_inside<S: Simd>(simd: S, squares: Floats<S>, product: Floats<S>, radius2: f32) -> Floats<S> {
    let c = (squares - radius2) * product;
    let magnitude = c.abs().min(1.0);
    let part = (f32x16::splat(simd, 1.0) - magnitude).sqrt() * lanes::polynomial(simd, magnitude, ARC);
    c.simd_lt(0.0).select(f32x16::splat(simd, 1.0) - part, part)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[inline(always)]
    fn parts<S: Simd>(simd: S, rho: f32, aside: f32, radii: &[f32; 16]) -> [f32; 16] {
        let splat = |x| f32x16::splat(simd, x);
        let squares = splat(rho * rho + aside * aside);
        let product = splat(0.5 / (rho * aside));
        std::array::from_fn(|i| part_inside(simd, squares, product, radii[i] * radii[i]).to_array()[i])
    }

    /// Against counting azimuths.
    #[test]
    fn part_inside_agrees_with_counting() {
        let radii: [f32; 16] = std::array::from_fn(|i| 0.13 * (i + 1) as f32);
        for (rho, aside) in [(1.0, 0.3), (0.2, 0.9), (0.7, 0.7), (1e-3, 1.0)] {
            let found = dispatch!(Level::new(), simd => parts(simd, rho, aside, &radii));
            for (radius, found) in radii.into_iter().zip(found) {
                let n = 20_000;
                let inside = (0..n).filter(|i| {
                    let (sin, cos) = (std::f32::consts::PI * (*i as f32 + 0.5) / n as f32).sin_cos();
                    f32::hypot(rho + aside * cos, aside * sin) < radius
                });
                let counted = inside.count() as f32 / n as f32;
                assert!((found - counted).abs() < 3e-4, "{rho} {aside} {radius}: {found} {counted}");
            }
        }
    }

    #[test]
    fn coefficients_agree_with_the_arc_cosine() {
        for i in 0..1000 {
            let c = f64::from(i) / 1000.0;
            let sum = ARC.iter().rev().fold(0.0, |sum, &x| sum * c + f64::from(x));
            let exact = c.acos() / std::f64::consts::PI / (1.0 - c).sqrt();
            assert!((sum / exact - 1.0).abs() < 6e-8, "{c}");
        }
    }
}
