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

use super::guided_sampling::Guide;
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

/// What a block is to score.
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
    /// All.
    pub(super) total: f64,
    /// Inside each radius and outside the one before; the last outside all.
    pub(super) rings: Vec<f64>,
    /// Collisions.
    pub(super) collisions: u64,
}

impl ChunkSums {
    pub(super) fn new(radii: usize) -> Self {
        Self { total: 0.0, rings: vec![0.0; radii + 1], collisions: 0 }
    }
}

/// Photons between passes.
struct Pool {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Weight at the second collision.
    weight: Vec<f32>,
    /// What roulette has multiplied it by.
    factor: Vec<f32>,
    streams: [Vec<u32>; 4],
    chunk: Vec<u32>,
    len: usize,
}

impl Pool {
    fn new(capacity: usize) -> Self {
        let floats = || vec![0.0; capacity + LANES];
        let words = || vec![0; capacity + LANES];
        Self {
            x: floats(),
            y: floats(),
            z: floats(),
            weight: floats(),
            factor: floats(),
            streams: [words(), words(), words(), words()],
            chunk: words(),
            len: 0,
        }
    }

    /// Appends the photons of another pool.
    fn append(&mut self, other: &Self) {
        let (to, from) = (self.len..self.len + other.len, 0..other.len);
        self.x[to.clone()].copy_from_slice(&other.x[from.clone()]);
        self.y[to.clone()].copy_from_slice(&other.y[from.clone()]);
        self.z[to.clone()].copy_from_slice(&other.z[from.clone()]);
        self.weight[to.clone()].copy_from_slice(&other.weight[from.clone()]);
        self.factor[to.clone()].copy_from_slice(&other.factor[from.clone()]);
        for (words, others) in self.streams.iter_mut().zip(&other.streams) {
            words[to.clone()].copy_from_slice(&others[from.clone()]);
        }
        self.chunk[to].copy_from_slice(&other.chunk[from]);
        self.len += other.len;
    }
}

/// Photons that have left or were ended.
struct Exits {
    /// ρ² + d², where ρ is the distance of the last collision from the axis and d the way aside from there.
    squares: Vec<f32>,
    /// 1/(2ρd).
    product: Vec<f32>,
    /// Weight that gets out; 0 for a photon ended by roulette.
    score: Vec<f32>,
    /// Part of the azimuths of the last flight that end inside the radius at hand.
    inside: Vec<f32>,
    chunk: Vec<u32>,
    /// Contributions to the total.
    total: Vec<f32>,
    len: usize,
}

impl Exits {
    fn new(capacity: usize) -> Self {
        let floats = || vec![0.0; capacity + LANES];
        Self {
            squares: floats(),
            product: floats(),
            score: floats(),
            inside: floats(),
            chunk: vec![0; capacity + LANES],
            total: floats(),
            len: 0,
        }
    }
}

/// A thread's memory for blocks.
pub(super) struct Workspace {
    pool: Pool,
    rest: Pool,
    exits: Exits,
}

impl Workspace {
    pub(super) fn new() -> Self {
        Self {
            pool: Pool::new(CHUNK),
            rest: Pool::new(BLOCK * STRAGGLERS),
            exits: Exits::new(CHUNK.max(BLOCK * STRAGGLERS)),
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
    let Workspace { pool, rest, exits } = workspace;
    rest.len = 0;
    let key = Key::new(seed);
    for (i, sums) in sums.iter_mut().enumerate() {
        let chunk = first + i as u64;
        exits.len = 0;
        sums.collisions += first_pass::<S, SERIES, ABSORBS>(simd, guide, key, chunk, i as u32, pool, exits);
        while pool.len > STRAGGLERS {
            sums.collisions += pass::<S, SERIES, ABSORBS>(simd, guide, scoring.roulette, pool, exits);
        }
        score(simd, scoring, exits, sums);
        rest.append(pool);
    }
    exits.len = 0;
    let mut collisions = 0;
    while rest.len > 0 {
        collisions += pass::<S, SERIES, ABSORBS>(simd, guide, scoring.roulette, rest, exits);
    }
    score_apart(simd, scoring, exits, sums);
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
    fn leave(&self, simd: S, ended: mask32x16<S>, guide: &Guide, chunk: Words<S>, exits: &mut Exits) {
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
        let at = exits.len..exits.len + LANES;
        squares.compress(gone).store_slice(&mut exits.squares[at.clone()]);
        product.compress(gone).store_slice(&mut exits.product[at.clone()]);
        score.compress(gone).store_slice(&mut exits.score[at.clone()]);
        total.compress(gone).store_slice(&mut exits.total[at.clone()]);
        chunk.compress(gone).store_slice(&mut exits.chunk[at]);
        exits.len += count;
    }

    /// Puts those alive at the end of the pool.
    #[inline(always)]
    fn stay(&self, stream: Stream<u32x16<S>>, chunk: Words<S>, pool: &mut Pool, len: usize) -> usize {
        let alive = self.alive;
        let at = len..len + LANES;
        self.x.compress(alive).store_slice(&mut pool.x[at.clone()]);
        self.y.compress(alive).store_slice(&mut pool.y[at.clone()]);
        self.z.compress(alive).store_slice(&mut pool.z[at.clone()]);
        self.weight.compress(alive).store_slice(&mut pool.weight[at.clone()]);
        self.factor.compress(alive).store_slice(&mut pool.factor[at.clone()]);
        for (words, to) in stream.0.into_iter().zip(&mut pool.streams) {
            words.compress(alive).store_slice(&mut to[at.clone()]);
        }
        chunk.compress(alive).store_slice(&mut pool.chunk[at]);
        len + alive.to_bitmask().count_ones() as usize
    }
}

/// Multipliers of the lattice's coordinates, in units of 2⁻³²: a Korobov lattice, 1024 points i·441ʲ/1024.
/// Of the 512 odd multipliers, 441 gave the least variance of total and ring at α = 0.5, 0.9 and 0.99, measured over
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

#[inline(always)]
fn first_pass<S: Simd, const SERIES: bool, const ABSORBS: bool>(
    simd: S,
    guide: &Guide,
    key: Key,
    chunk: u64,
    slot: u32,
    pool: &mut Pool,
    exits: &mut Exits,
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
        let zero = f32x16::splat(simd, 0.0);
        let one = f32x16::splat(simd, 1.0);
        let mut walkers = Walkers {
            x: second.x,
            y: second.y,
            z: second.z,
            weight: second.weight,
            factor: one,
            alive: mask32x16::splat(simd, true),
            out: mask32x16::splat(simd, false),
            exit_mu: one,
            exit_sigma: zero,
            collisions: 2 * LANES as u32,
        };
        for flight in 0..FIRST_FLIGHTS {
            if ABSORBS {
                // Few photons come as far as roulette
                let weight = walkers.weight * guide.survival;
                walkers.weight = walkers.alive.select(weight, walkers.weight);
            }
            let words = [word(3 + 3 * flight), word(4 + 3 * flight), word(5 + 3 * flight)];
            walkers.fly::<SERIES>(simd, guide, words);
        }
        walkers.leave(simd, mask32x16::splat(simd, false), guide, slot, exits);
        len = walkers.stay(stream, slot, pool, len);
        collisions += u64::from(walkers.collisions);
    }
    pool.len = len;
    collisions
}

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

#[inline(always)]
fn pass<S: Simd, const SERIES: bool, const ABSORBS: bool>(
    simd: S,
    guide: &Guide,
    roulette: f32,
    pool: &mut Pool,
    exits: &mut Exits,
) -> u64 {
    let lane = u32x16::from_fn(simd, |i| i as u32);
    let one = f32x16::splat(simd, 1.0);
    let mut len = 0;
    let mut collisions = 0;
    for from in (0..pool.len).step_by(LANES) {
        let at = from..from + LANES;
        let load = |values: &[f32]| f32x16::from_slice(simd, &values[at.clone()]);
        let words = |values: &[u32]| u32x16::from_slice(simd, &values[at.clone()]);
        let mut stream = Stream([
            words(&pool.streams[0]),
            words(&pool.streams[1]),
            words(&pool.streams[2]),
            words(&pool.streams[3]),
        ]);
        let chunk = words(&pool.chunk);
        let mut walkers = Walkers {
            x: load(&pool.x),
            y: load(&pool.y),
            z: load(&pool.z),
            weight: load(&pool.weight),
            factor: load(&pool.factor),
            alive: lane.simd_lt((pool.len - from) as u32),
            out: mask32x16::splat(simd, false),
            exit_mu: one,
            exit_sigma: one,
            collisions: 0,
        };
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
        walkers.leave(simd, ended, guide, chunk, exits);
        len = walkers.stay(stream, chunk, pool, len);
        collisions += u64::from(walkers.collisions);
    }
    pool.len = len;
    collisions
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

/// Sums the scores of one chunk.
#[inline(always)]
fn score<S: Simd>(simd: S, scoring: &Scoring, exits: &mut Exits, sums: &mut ChunkSums) {
    clear_end(exits);
    let groups = exits.len.div_ceil(LANES);
    let mut total = f32x16::splat(simd, 0.0);
    for total_part in exits.total[..groups * LANES].chunks_exact(LANES) {
        total += f32x16::from_slice(simd, total_part);
    }
    sums.total += sum(total);
    exits.inside[..groups * LANES].fill(0.0);
    for (radius, ring) in scoring.radii.iter().zip(&mut sums.rings) {
        let mut score = f32x16::splat(simd, 0.0);
        for group in 0..groups {
            score += ring_score(simd, radius * radius, exits, group);
        }
        *ring += sum(score);
    }
    let mut score = f32x16::splat(simd, 0.0);
    for group in 0..groups {
        score += score_beyond(simd, exits, group);
    }
    if let Some(ring) = sums.rings.last_mut() {
        *ring += sum(score);
    }
}

/// Sums the scores of photons of several chunks.
#[inline(always)]
fn score_apart<S: Simd>(simd: S, scoring: &Scoring, exits: &mut Exits, sums: &mut [ChunkSums]) {
    clear_end(exits);
    let groups = exits.len.div_ceil(LANES);
    for i in 0..exits.len {
        sums[exits.chunk[i] as usize].total += f64::from(exits.total[i]);
    }
    exits.inside[..groups * LANES].fill(0.0);
    for ring in 0..=scoring.radii.len() {
        for group in 0..groups {
            let scores = match scoring.radii.get(ring) {
                Some(radius) => ring_score(simd, radius * radius, exits, group),
                None => score_beyond(simd, exits, group),
            };
            let chunks = &exits.chunk[group * LANES..(group + 1) * LANES];
            for (score, &chunk) in scores.to_array().into_iter().zip(chunks) {
                sums[chunk as usize].rings[ring] += f64::from(score);
            }
        }
    }
}

/// Makes the lanes behind the last exit count for nothing.
#[inline(always)]
fn clear_end(exits: &mut Exits) {
    let end = exits.len..exits.len.next_multiple_of(LANES);
    exits.score[end.clone()].fill(0.0);
    exits.total[end.clone()].fill(0.0);
    exits.chunk[end].fill(0);
}

/// Scores in the ring that ends at a radius and starts where the last call's ended.
#[inline(always)]
fn ring_score<S: Simd>(simd: S, radius2: f32, exits: &mut Exits, group: usize) -> Floats<S> {
    let at = group * LANES..(group + 1) * LANES;
    let load = |values: &[f32]| f32x16::from_slice(simd, &values[at.clone()]);
    let inside = part_inside(simd, load(&exits.squares), load(&exits.product), radius2);
    let ring = load(&exits.score) * (inside - load(&exits.inside));
    inside.store_slice(&mut exits.inside[at]);
    ring
}

/// Scores outside all radii, with what roulette has taken from the total or added to it: exactly 0 for a photon
/// that certainly left inside.
#[inline(always)]
fn score_beyond<S: Simd>(simd: S, exits: &Exits, group: usize) -> Floats<S> {
    let at = group * LANES..(group + 1) * LANES;
    let load = |values: &[f32]| f32x16::from_slice(simd, &values[at.clone()]);
    load(&exits.total) - load(&exits.score) * load(&exits.inside)
}

#[inline(always)]
fn sum<S: Simd>(values: Floats<S>) -> f64 {
    values.to_array().into_iter().map(f64::from).sum()
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

    #[test]
    fn lattice_points_differ_in_every_coordinate() {
        for multiplier in LATTICE {
            let mut points: Vec<u32> = (0..CHUNK as u32).map(|i| i.wrapping_mul(multiplier)).collect();
            points.sort_unstable();
            assert!(points.windows(2).all(|pair| pair[1] - pair[0] == u32::MAX / CHUNK as u32 + 1));
        }
    }
}
