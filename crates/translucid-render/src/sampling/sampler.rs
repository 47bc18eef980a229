//! Owen-scrambled Sobol numbers, padded four dimensions at a time.

/// Random numbers of one camera path, a pure function of (seed, pixel, sample).
///
/// Each set of four dimensions is the well-distributed start of the Sobol sequence under its own
/// scramble and shuffle [Burley 2020, "Practical Hash-based Owen Scrambling"], so any number of
/// dimensions is as good as the first four.
/// A vertex of a path takes its sets at a fixed place, so that samples of a pixel stay stratified
/// against each other however their paths differ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampler {
    index: u32,
    seed: u32,
    set: u32,
}

/// Four numbers that are not computed yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reserved {
    index: u32,
    scramble: u32,
}

impl Reserved {
    /// The numbers in [0, 1), the same every time.
    pub(crate) fn numbers(self) -> [f32; 4] {
        sobol_burley::sample_4d(self.index, 0, self.scramble)
    }
}

/// Sets that a path vertex may use.
const SETS_PER_VERTEX: u32 = 8;

impl Sampler {
    /// Numbers for sample `index` of the pixel (x, y).
    pub(crate) fn new(seed: u64, x: u32, y: u32, index: u32) -> Self {
        // The library's sequence ends after 2^16 points: go on with another scramble.
        let block = index >> 16;
        let seed =
            [seed as u32, (seed >> 32) as u32, x, y, block].into_iter().fold(0x9e37_79b9, hash_combine);
        Self { index: index & 0xffff, seed, set: 0 }
    }

    /// The next four numbers in [0, 1).
    pub(crate) fn next_4d(&mut self) -> [f32; 4] {
        self.reserve().numbers()
    }

    /// Reserves the next four numbers, which are computed when `numbers` is called.
    pub(crate) fn reserve(&mut self) -> Reserved {
        let reserved = Reserved { index: self.index, scramble: hash_combine(self.seed, self.set) };
        self.set += 1;
        reserved
    }

    /// A seed for another generator, different for each of the sets to come.
    pub(crate) fn fork(&self) -> u64 {
        let low = hash_combine(hash_combine(self.seed, self.set), self.index);
        u64::from(low) | u64::from(hash_combine(low ^ 0x5bd1_e995, self.index)) << 32
    }

    /// Moves to the numbers that belong to a vertex of the path; the camera has vertex 0.
    pub(crate) fn start_vertex(&mut self, vertex: u32) {
        self.set = vertex.saturating_mul(SETS_PER_VERTEX);
    }
}

/// A hash of two words with good avalanche: `lowbias32` of Wellons' hash prospector.
fn hash_combine(state: u32, value: u32) -> u32 {
    let mut x = state ^ value.wrapping_mul(0x9e37_79b9).rotate_left(15);
    x = (x ^ (x >> 16)).wrapping_mul(0x21f0_aaad);
    x = (x ^ (x >> 15)).wrapping_mul(0x735a_2d97);
    x ^ (x >> 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampler_repeats_and_differs_between_pixels() {
        let draw = |seed, x, y, index| Sampler::new(seed, x, y, index).next_4d();
        assert_eq!(draw(1, 2, 3, 4), draw(1, 2, 3, 4));
        for other in [draw(2, 2, 3, 4), draw(1, 3, 2, 4), draw(1, 2, 3, 5), draw(1, 2, 3, 4 + 65536)] {
            assert_ne!(draw(1, 2, 3, 4), other);
        }
    }

    /// Every set integrates a smooth product far better than independent numbers would (1/√N).
    #[test]
    fn sampler_is_stratified_in_every_set() {
        let n = 4096;
        for set in [0, 1, 7, 50, 1000] {
            let mut sum = 0.0_f64;
            for index in 0..n {
                let mut sampler = Sampler::new(9, 5, 6, index);
                sampler.set = set;
                sum += sampler.next_4d().iter().map(|&x| f64::from(x) * 2.0).product::<f64>();
            }
            let error = (sum / f64::from(n) - 1.0).abs();
            // Independent numbers have a standard error of √((4/3)⁴ − 1)/64 = 0.023.
            assert!(error < 2e-3, "set {set}: error {error}");
        }
    }
}
