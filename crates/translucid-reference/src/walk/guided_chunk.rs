//! The walk of a chunk of guided photons, breadth first in 16 lanes.
//!
//! ```text
//! start all photons of the chunk at their second collision
//! until none is left:
//!     for 16 photons at a time:
//!         roulette, if they are far from what is tallied
//!         a few flights; whoever crosses the surface stops
//!         append the leaving to a list, move the remaining together
//! spread every exit over the rings it may have hit
//! ```
//!
//! Departures from that order: the first pass draws from a lattice in place of random numbers, and the few
//! photons left at the end of a chunk wait for those of other chunks, so that lanes do not run empty. Who walks
//! beside a photon has no part in what it does, and a chunk's sums are formed in the order of its photons: they
//! are the same bits in any company.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x16, mask32x16, u32x16};

use super::guided_columns::Columns;
use super::guided_sampling::Guide;
use super::guided_scoring::{ChunkSums, LeftGroup, LeftPhotons, Scoring, score, score_apart};
use super::lanes::{self, Floats, Words};
use super::random::{Key, LANES, Stream};

/// Photons of a chunk: they share a lattice, and their mean is one sample of the statistics.
pub(super) const CHUNK: usize = 1024;

/// Chunks that are walked together.
pub(super) const BLOCK: usize = 16;

/// Photons left of a chunk when it joins the rest of the block.
const STRAGGLERS: usize = 64;

/// Flights between two compactions.
const FLIGHTS: usize = 4;

/// Flights of the first pass, which draw from the lattice.
const FIRST_FLIGHTS: usize = 3;

/// Coordinates of the lattice: five for the start, three for each flight of the first pass.
const DIMENSIONS: usize = 5 + 3 * FIRST_FLIGHTS;

/// Photons between passes: place, weight at the second collision, factor by which roulette has multiplied it;
/// random stream and chunk.
type PhotonRows = Columns<5, 5>;

/// A thread's memory for blocks.
pub(super) struct Workspace {
    /// Photons of the chunk at hand.
    flying: PhotonRows,
    /// Stragglers of all chunks of the block.
    rest: PhotonRows,
    left: LeftPhotons,
}

impl Workspace {
    pub(super) fn new() -> Self {
        Self {
            flying: Columns::new(CHUNK),
            rest: Columns::new(BLOCK * STRAGGLERS),
            left: LeftPhotons::new(CHUNK.max(BLOCK * STRAGGLERS)),
        }
    }
}

/// Walks consecutive chunks, at most [`BLOCK`], from the index given.
#[inline(always)]
pub(super) fn walk_block<S: Simd>(
    simd: S,
    guide: &Guide,
    scoring: &Scoring,
    seed: u64,
    first: u64,
    sums: &mut [ChunkSums],
    workspace: &mut Workspace,
) {
    simd.vectorize(
        #[inline(always)]
        || match (guide.series(), guide.absorbs()) {
            (true, _) => walk::<S, true, false>(simd, guide, scoring, seed, first, sums, workspace),
            (false, false) => walk::<S, false, false>(simd, guide, scoring, seed, first, sums, workspace),
            (false, true) => walk::<S, false, true>(simd, guide, scoring, seed, first, sums, workspace),
        },
    );
}

#[inline(always)]
fn walk<S: Simd, const SERIES: bool, const ABSORBS: bool>(
    simd: S,
    guide: &Guide,
    scoring: &Scoring,
    seed: u64,
    first: u64,
    sums: &mut [ChunkSums],
    workspace: &mut Workspace,
) {
    let Workspace { flying, rest, left } = workspace;
    rest.len = 0;
    let key = Key::new(seed);
    for (i, sums) in sums.iter_mut().enumerate() {
        let chunk = first + i as u64;
        left.clear();
        sums.collisions += first_pass::<S, SERIES, ABSORBS>(simd, guide, key, chunk, i as u32, flying, left);
        while flying.len > STRAGGLERS {
            sums.collisions += pass::<S, SERIES, ABSORBS>(simd, guide, scoring.roulette, flying, left);
        }
        score(simd, scoring, left, sums);
        rest.append(flying);
    }
    left.clear();
    let mut collisions = 0;
    while rest.len > 0 {
        collisions += pass::<S, SERIES, ABSORBS>(simd, guide, scoring.roulette, rest, left);
    }
    score_apart(simd, scoring, left, sums);
    if let Some(first) = sums.first_mut() {
        first.collisions += collisions;
    }
}

/// 16 photons under way.
struct Walkers<S: Simd> {
    x: Floats<S>,
    y: Floats<S>,
    z: Floats<S>,
    weight: Floats<S>,
    factor: Floats<S>,
    alive: mask32x16<S>,
    /// Crossed the surface.
    out: mask32x16<S>,
    /// Cosine and σ of the flight across the surface.
    exit_mu: Floats<S>,
    exit_sigma: Floats<S>,
    collisions: u32,
}

impl<S: Simd> Walkers<S> {
    /// Photons at a collision, none of which has left.
    #[inline(always)]
    fn new(simd: S, [x, y, z, weight, factor]: [Floats<S>; 5], alive: mask32x16<S>) -> Self {
        let one = f32x16::splat(simd, 1.0);
        let out = mask32x16::splat(simd, false);
        Self { x, y, z, weight, factor, alive, out, exit_mu: one, exit_sigma: one, collisions: 0 }
    }

    /// A flight of those alive.
    #[inline(always)]
    fn fly<const SERIES: bool>(&mut self, simd: S, guide: &Guide, words: [Words<S>; 3]) {
        let (mu, sigma) = guide.direction::<S, SERIES>(simd, words[0]);
        let length = lanes::exponential(simd, words[1]) / sigma;
        let (cos, sin) = lanes::circle(simd, words[2]);
        let aside = lanes::complement(mu) * length;
        let z = (-mu).mul_add(length, self.z);
        let out = self.alive & z.simd_lt(0.0);
        self.out |= out;
        self.exit_mu = out.select(mu, self.exit_mu);
        self.exit_sigma = out.select(sigma, self.exit_sigma);
        self.alive &= !out;
        self.x = self.alive.select(aside.mul_add(cos, self.x), self.x);
        self.y = self.alive.select(aside.mul_add(sin, self.y), self.y);
        self.z = self.alive.select(z, self.z);
        self.collisions += self.alive.to_bitmask().count_ones();
    }

    /// Moves those that have left, or were ended, to the list.
    #[inline(always)]
    fn leave(&self, simd: S, ended: mask32x16<S>, guide: &Guide, chunk: Words<S>, left: &mut LeftPhotons) {
        let gone = self.out | ended;
        let count = gone.to_bitmask().count_ones() as usize;
        if count == 0 {
            return;
        }
        let rho2 = self.x * self.x + self.y * self.y;
        let aside = lanes::complement(self.exit_mu) * self.z / self.exit_mu;
        let squares = aside.mul_add(aside, rho2);
        let product = f32x16::splat(simd, 0.5) / (rho2.sqrt() * aside).max(1e-30);
        // The weight σ·factor, less the mean of what roulette has added, which is 0
        let score = self.out.select(self.weight * self.factor * self.exit_sigma, f32x16::splat(simd, 0.0));
        let expected = self.weight * guide.mean_exit;
        let total = self.out.select(score - expected * (self.factor - 1.0), expected);
        let group = LeftGroup {
            squares: squares.compress(gone),
            product: product.compress(gone),
            score: score.compress(gone),
            total: total.compress(gone),
        };
        left.push(&group, chunk.compress(gone), count);
    }

    /// Writes those alive as rows from the one given on, and returns the row behind them.
    #[inline(always)]
    fn stay(&self, stream: Stream<Words<S>>, chunk: Words<S>, flying: &mut PhotonRows, row: usize) -> usize {
        let alive = self.alive;
        let floats = [
            self.x.compress(alive),
            self.y.compress(alive),
            self.z.compress(alive),
            self.weight.compress(alive),
            self.factor.compress(alive),
        ];
        let [a, b, c, d] = stream.0;
        let words = [
            a.compress(alive),
            b.compress(alive),
            c.compress(alive),
            d.compress(alive),
            chunk.compress(alive),
        ];
        flying.put(row, floats, words);
        row + alive.to_bitmask().count_ones() as usize
    }
}

/// Multipliers of the lattice's coordinates, in units of 2⁻³²: a Korobov lattice, 1024 points i·441ʲ/1024.
/// The multiplier 441 of all 512 odd ones gave the least variance of total and ring at α = 0.5, 0.9 and 0.99, measured over
/// 256 chunks: 0.41 of that without a lattice in the geometric mean. The median is some 0.55, the worst (1) 50.
const LATTICE: [u32; DIMENSIONS] = lattice(441);

/// Korobov's lattice of [`CHUNK`] points.
const fn lattice(multiplier: u32) -> [u32; DIMENSIONS] {
    let mut z = [(1u64 << 32 >> CHUNK.ilog2()) as u32; DIMENSIONS];
    let mut i = 1;
    while i < DIMENSIONS {
        z[i] = z[i - 1].wrapping_mul(multiplier);
        i += 1;
    }
    z
}

/// Starts a chunk at its second collisions and lets it fly a few times, by the lattice; returns its collisions.
#[inline(always)]
fn first_pass<S: Simd, const SERIES: bool, const ABSORBS: bool>(
    simd: S,
    guide: &Guide,
    key: Key,
    chunk: u64,
    slot: u32,
    flying: &mut PhotonRows,
    left: &mut LeftPhotons,
) -> u64 {
    let lane = u32x16::from_fn(simd, |i| i as u32);
    let slot = u32x16::splat(simd, slot);
    // Indices of chunks' shifts count down from the last, those of photons up from 0
    let mut shifts = Stream::new(key, u64::MAX - chunk);
    let shifts: [u32; DIMENSIONS] = std::array::from_fn(|_| shifts.next());
    let mut len = 0;
    let mut collisions = 0;
    for group in 0..CHUNK / LANES {
        let index = (group * LANES) as u32;
        let stream = Stream::of_16(simd, key, chunk * CHUNK as u64 + u64::from(index));
        let point = lane + index;
        let word = |i: usize| point * LATTICE[i] + shifts[i];
        let second = guide.start::<S, SERIES>(
            simd,
            [word(0), word(1), word(2), word(3 + 3 * FIRST_FLIGHTS), word(4 + 3 * FIRST_FLIGHTS)],
        );
        let start = [second.x, second.y, second.z, second.weight, f32x16::splat(simd, 1.0)];
        let mut walkers = Walkers::new(simd, start, mask32x16::splat(simd, true));
        walkers.collisions = 2 * LANES as u32;
        for flight in 0..FIRST_FLIGHTS {
            if ABSORBS {
                // Few photons come as far as roulette
                let weight = walkers.weight * guide.survival;
                walkers.weight = walkers.alive.select(weight, walkers.weight);
            }
            let words = [word(3 + 3 * flight), word(4 + 3 * flight), word(5 + 3 * flight)];
            walkers.fly::<SERIES>(simd, guide, words);
        }
        walkers.leave(simd, mask32x16::splat(simd, false), guide, slot, left);
        len = walkers.stay(stream, slot, flying, len);
        collisions += u64::from(walkers.collisions);
    }
    flying.len = len;
    collisions
}

/// Ends photons by absorption.
#[inline(always)]
fn absorb<S: Simd>(
    guide: &Guide,
    walkers: &mut Walkers<S>,
    ended: &mut mask32x16<S>,
    stream: &mut Stream<u32x16<S>>,
) {
    let absorbed = walkers.alive & !lanes::unit(stream.next()).simd_lt(guide.survival);
    walkers.alive &= !absorbed;
    *ended |= absorbed;
}

/// Lets all photons fly a few times, after roulette or with absorption; returns their collisions.
#[inline(always)]
fn pass<S: Simd, const SERIES: bool, const ABSORBS: bool>(
    simd: S,
    guide: &Guide,
    roulette: f32,
    flying: &mut PhotonRows,
    left: &mut LeftPhotons,
) -> u64 {
    let lane = u32x16::from_fn(simd, |i| i as u32);
    let mut len = 0;
    let mut collisions = 0;
    for from in (0..flying.len).step_by(LANES) {
        let (floats, [a, b, c, d, chunk]) = flying.get(simd, from);
        let mut stream = Stream([a, b, c, d]);
        let mut walkers = Walkers::new(simd, floats, lane.simd_lt((flying.len - from) as u32));
        let mut ended = mask32x16::splat(simd, false);
        if !ABSORBS {
            // Roulette
            let Walkers { x, y, z, factor, alive, .. } = walkers;
            let distance2 = x * x + y * y + z * z;
            // (D/b)^1.5, see the module's documentation
            let root = (distance2 * roulette).sqrt();
            let far = alive & (factor * 2.0).simd_le(root * root.sqrt());
            let coin = (stream.next() & 0x8000_0000).simd_eq(0);
            ended = far & coin;
            walkers.alive = alive & !ended;
            walkers.factor = far.select(factor * 2.0, factor);
        }
        for _ in 0..FLIGHTS {
            if ABSORBS {
                absorb(guide, &mut walkers, &mut ended, &mut stream);
            }
            let words = [stream.next(), stream.next(), stream.next()];
            walkers.fly::<SERIES>(simd, guide, words);
        }
        walkers.leave(simd, ended, guide, chunk, left);
        len = walkers.stay(stream, chunk, flying, len);
        collisions += u64::from(walkers.collisions);
    }
    flying.len = len;
    collisions
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::super::super::exact::Entrance;
    use super::*;

    fn block(guide: &Guide, scoring: &Scoring, first: u64, chunks: usize) -> Vec<ChunkSums> {
        let mut sums = vec![ChunkSums::new(scoring.radii.len()); chunks];
        let mut workspace = Workspace::new();
        dispatch!(Level::new(), simd => walk_block(simd, guide, scoring, 7, first, &mut sums, &mut workspace));
        sums
    }

    #[test]
    fn chunk_does_not_depend_on_its_company() {
        let scoring = Scoring::new(&[0.3, 2.0]);
        for alpha in [0.1, 0.5, 0.99, 0.9999] {
            let guide = Guide::new(alpha, Entrance::Cosine);
            let together = block(&guide, &scoring, 100, BLOCK);
            for (i, expected) in together.iter().enumerate() {
                let alone = &block(&guide, &scoring, 100 + i as u64, 1)[0];
                assert_eq!((alone.total, &alone.rings), (expected.total, &expected.rings), "α = {alpha}");
            }
        }
    }

    #[test]
    fn rings_sum_to_the_total() {
        for (alpha, radii) in [(0.5, &[0.5, 1.0, 9.0][..]), (0.999, &[0.01, 0.2]), (0.9, &[])] {
            let sums = block(&Guide::new(alpha, Entrance::Normal), &Scoring::new(radii), 0, BLOCK);
            for ChunkSums { total, rings, .. } in sums {
                assert!((rings.iter().sum::<f64>() / total - 1.0).abs() < 3e-6);
            }
        }
    }

    #[test]
    fn lattice_points_differ_in_every_coordinate() {
        for multiplier in LATTICE {
            let mut points: Vec<u32> = (0..CHUNK as u32).map(|i| i.wrapping_mul(multiplier)).collect();
            points.sort_unstable();
            assert!(points.windows(2).all(|pair| pair[1] - pair[0] == u32::MAX / CHUNK as u32 + 1));
        }
    }
}
