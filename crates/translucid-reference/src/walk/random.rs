//! Random numbers as a function of (seed, photon index).
//!
//! Every photon owns a stream. Its 128-bit state at the start is a strong permutation of the photon's index
//! under a key made from the seed, so that streams of one seed never start alike, and streams of neighbours or
//! of other seeds have nothing in common; from there a cheap generator runs. Who else walks beside a photon,
//! how many threads there are and where a range was cut has no part in it.
//!
//! - Permutation: Chaskey's π with 8 rounds (N. Mouha, B. Mennink, A. Van Herrewege, D. Watanabe, B. Preneel,
//!   I. Verbauwhede, *Chaskey: An Efficient MAC Algorithm for 32-bit Microcontrollers*, 2014, §3), additions,
//!   rotations and exclusive or of 32-bit words only; keyed as an Even–Mansour cipher, π(index ⊕ key) ⊕ key.
//! - Generator: sfc32 (C. Doty-Humphrey, *PractRand*, 2010), 32 bits per draw; a 32-bit counter in its state
//!   bars cycles shorter than 2³² draws.
//!
//! Both are written once, for one stream of `u32` and for the 16 streams of a vector.

use std::ops::{BitOr, BitXor, Shl, Shr};

use fearless_simd::{Simd, SimdBase, SimdFrom, u32x16};

/// Streams that a vector draws from at a time.
pub(crate) const LANES: usize = 16;

/// A word or a vector of words, with the operations that the permutation and the generator need.
pub(crate) trait Word:
    Copy + BitXor<Output = Self> + BitOr<Output = Self> + Shl<u32, Output = Self> + Shr<u32, Output = Self>
{
    /// Sum modulo 2³².
    fn plus(self, other: Self) -> Self;
    /// Sum modulo 2³² with a constant.
    fn plus_constant(self, constant: u32) -> Self;
    /// Rotation to the left by `bits` in 1..32.
    #[inline(always)]
    fn rotate(self, bits: u32) -> Self {
        (self << bits) | (self >> (32 - bits))
    }
}

impl Word for u32 {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn plus_constant(self, constant: u32) -> Self {
        self.wrapping_add(constant)
    }
}

impl<S: Simd> Word for u32x16<S> {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn plus_constant(self, constant: u32) -> Self {
        self + constant
    }
}

/// The key that a seed stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key([u32; 4]);

impl Key {
    /// The seed, permuted beside two constants: the first 64 bits of the fraction of π.
    pub(crate) fn new(seed: u64) -> Self {
        Self(permute([seed as u32, (seed >> 32) as u32, 0x243f_6a88, 0x85a3_08d3]))
    }
}

/// A stream of random words, or 16 of them side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stream<W>(pub(crate) [W; 4]);

#[cfg(test)]
impl Stream<u32> {
    /// The stream of one photon.
    #[inline(always)]
    pub(crate) fn new(key: Key, index: u64) -> Self {
        start([index as u32, (index >> 32) as u32, 0, 0], key.0)
    }
}

impl<S: Simd> Stream<u32x16<S>> {
    /// The streams of 16 photons, the first of which has the index given.
    #[inline(always)]
    pub(crate) fn of_16(simd: S, key: Key, first: u64) -> Self {
        let splat = |word: u32| u32x16::splat(simd, word);
        let lane = u32x16::simd_from(simd, [0u32, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]);
        let low = lane + first as u32;
        let high = if (first as u32).checked_add(LANES as u32 - 1).is_some() {
            splat((first >> 32) as u32)
        } else {
            // The upper word changes within the vector
            u32x16::from_fn(simd, |i| (first.wrapping_add(i as u64) >> 32) as u32)
        };
        start([low, high, splat(0), splat(0)], key.0.map(splat))
    }
}

impl<W: Word> Stream<W> {
    /// The next word of every stream.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> W {
        let [a, b, c, counter] = self.0;
        let drawn = a.plus(b).plus(counter);
        self.0 = [b ^ (b >> 9), c.plus(c << 3), c.rotate(21).plus(drawn), counter.plus_constant(1)];
        drawn
    }
}

#[inline(always)]
fn start<W: Word>(index: [W; 4], key: [W; 4]) -> Stream<W> {
    let xor = |a: [W; 4], b: [W; 4]| [a[0] ^ b[0], a[1] ^ b[1], a[2] ^ b[2], a[3] ^ b[3]];
    Stream(xor(permute(xor(index, key)), key))
}

/// Chaskey's permutation of 128 bits.
#[inline(always)]
fn permute<W: Word>([mut a, mut b, mut c, mut d]: [W; 4]) -> [W; 4] {
    for _ in 0..8 {
        a = a.plus(b);
        b = b.rotate(5) ^ a;
        a = a.rotate(16);
        c = c.plus(d);
        d = d.rotate(8) ^ c;
        a = a.plus(d);
        d = d.rotate(13) ^ a;
        c = c.plus(b);
        b = b.rotate(7) ^ c;
        c = c.rotate(16);
    }
    [a, b, c, d]
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[inline(always)]
    fn words_of_16<S: Simd>(simd: S, seed: u64, first: u64, draws: usize) -> Vec<[u32; LANES]> {
        let mut streams = Stream::of_16(simd, Key::new(seed), first);
        (0..draws).map(|_| streams.next().to_array()).collect()
    }

    fn words(seed: u64, index: u64, draws: usize) -> Vec<u32> {
        let mut stream = Stream::new(Key::new(seed), index);
        (0..draws).map(|_| stream.next()).collect()
    }

    /// Standard normal deviate of a count of successes.
    fn deviate(count: u64, trials: u64, probability: f64) -> f64 {
        let n = trials as f64;
        (count as f64 - n * probability) / (n * probability * (1.0 - probability)).sqrt()
    }

    #[test]
    fn lanes_draw_what_single_streams_draw() {
        for first in [0, 7, u64::from(u32::MAX) - 5, u64::MAX - 15] {
            let drawn = dispatch!(Level::new(), simd => words_of_16(simd, 42, first, 5));
            for lane in 0..LANES {
                let expected = words(42, first + lane as u64, 5);
                let found: Vec<u32> = drawn.iter().map(|words| words[lane]).collect();
                assert_eq!(found, expected, "photon {first} + {lane}");
            }
        }
    }

    #[test]
    fn permutation_is_one_to_one() {
        // Undo the rounds step by step
        fn undo([mut a, mut b, mut c, mut d]: [u32; 4]) -> [u32; 4] {
            for _ in 0..8 {
                c = c.rotate_right(16);
                b = (b ^ c).rotate_right(7);
                c = c.wrapping_sub(b);
                d = (d ^ a).rotate_right(13);
                a = a.wrapping_sub(d);
                d = (d ^ c).rotate_right(8);
                c = c.wrapping_sub(d);
                a = a.rotate_right(16);
                b = (b ^ a).rotate_right(5);
                a = a.wrapping_sub(b);
            }
            [a, b, c, d]
        }
        let mut stream = Stream::new(Key::new(1), 2);
        for _ in 0..1000 {
            let state = [stream.next(), stream.next(), stream.next(), stream.next()];
            assert_eq!(undo(permute(state)), state);
        }
    }

    /// One bit of seed or index flips half of the bits of the first words: each of the 128 × 128 frequencies
    /// is binomial. Fixed inputs; false alarm of a 6σ bound over 16384 frequencies: 3e-5.
    #[test]
    fn start_scatters_every_bit_of_seed_and_index() {
        let trials = 2000u64;
        for flipped in 0..128 {
            let mut counts = [0u64; 128];
            for trial in 0..trials {
                let (seed, index) = (trial, 1000 * trial + 3);
                let (seed2, index2) = if flipped < 64 {
                    (seed ^ (1 << flipped), index)
                } else {
                    (seed, index ^ (1 << (flipped - 64)))
                };
                let one = words(seed, index, 4);
                let two = words(seed2, index2, 4);
                for (bit, count) in counts.iter_mut().enumerate() {
                    *count += u64::from((one[bit / 32] ^ two[bit / 32]) >> (bit % 32) & 1);
                }
            }
            for (bit, &count) in counts.iter().enumerate() {
                assert!(deviate(count, trials, 0.5).abs() < 6.0, "input {flipped}, output {bit}: {count}");
            }
        }
    }

    /// The k-th words of neighbouring photons, and successive words of one photon, as pairs of 4-bit digits:
    /// χ² over 256 cells. Fixed seed; each of the 8 × 8 × 2 statistics may exceed its mean by 6σ with
    /// probability < 1e-7 (χ² is skewed: 4e-8 at 255 degrees of freedom), so 1e-5 in all.
    #[test]
    fn neighbours_and_successive_words_are_independent() {
        let photons = 1u64 << 16;
        let drawn: Vec<Vec<u32>> = (0..=photons).map(|index| words(9, index, 9)).collect();
        for draw in 0..8 {
            for digit in 0..8 {
                let cut = |word: u32| (word >> (4 * digit) & 15) as usize;
                let (mut beside, mut after) = ([0u64; 256], [0u64; 256]);
                for index in 0..photons as usize {
                    beside[16 * cut(drawn[index][draw]) + cut(drawn[index + 1][draw])] += 1;
                    after[16 * cut(drawn[index][draw]) + cut(drawn[index][draw + 1])] += 1;
                }
                for counts in [beside, after] {
                    let expected = photons as f64 / 256.0;
                    let chi2: f64 = counts.iter().map(|&n| (n as f64 - expected).powi(2) / expected).sum();
                    let deviate = (chi2 - 255.0) / (2.0f64 * 255.0).sqrt();
                    assert!(deviate.abs() < 6.0, "draw {draw}, digit {digit}: χ² = {chi2}");
                }
            }
        }
    }

    /// Correlation of the words of photons 1, 2, 4 … 2¹⁶ apart. False alarm of |z| < 5 over 17 × 4: 4e-5.
    #[test]
    fn distant_photons_are_uncorrelated() {
        let photons = 1usize << 17;
        let centered = |word: u32| f64::from(word) / 4294967296.0 - 0.5;
        let drawn: Vec<Vec<f64>> =
            (0..photons).map(|index| words(3, index as u64, 4).into_iter().map(centered).collect()).collect();
        for power in 0..17 {
            let apart = 1 << power;
            let pairs = photons - apart;
            let product = |i: usize, draw: usize| drawn[i][draw] * drawn[i + apart][draw];
            for draw in 0..4 {
                let sum: f64 = (0..pairs).map(|i| product(i, draw)).sum();
                let z = 12.0 * sum / (pairs as f64).sqrt();
                assert!(z.abs() < 5.0, "{apart} apart, draw {draw}: {z}");
            }
        }
    }
}
