//! Sums over chunks of photons, exact and in any order.

use super::guided_chunk::CHUNK;
use super::guided_scoring::ChunkSums;
use crate::Estimate;

/// Samples, one a chunk, as far as mean and variance need them.
///
/// Fixed-point numbers: whoever adds what in which order, on however many machines, gets the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Moments {
    /// Σ sample, in units of 2⁻⁶⁰.
    sum: i128,
    /// Σ sample², in units of 2⁻⁶⁰.
    squares: i128,
}

/// 1 in units of 2⁻⁶⁰.
const ONE: f64 = (1u64 << 60) as f64;

impl Moments {
    /// A sample of a chunk is at most some 10⁴, so that 10¹² chunks fit. Conversions and sums saturate.
    fn add(&mut self, sample: f64) {
        self.merge(Self { sum: (sample * ONE) as i128, squares: (sample * sample * ONE) as i128 });
    }

    fn merge(&mut self, other: Self) {
        self.sum = self.sum.saturating_add(other.sum);
        self.squares = self.squares.saturating_add(other.squares);
    }

    /// Mean for a photon, and its standard error from the scatter of the chunks; samples are in `unit`s. Where
    /// nothing was scored, the error is that of one photon of the greatest weight.
    fn estimate(self, chunks: u64, unit: f64, greatest_weight: f64) -> Estimate {
        if chunks == 0 {
            return Estimate { value: 0.0, error: f64::INFINITY };
        }
        let n = chunks as f64;
        let scale = unit / CHUNK as f64;
        let mean = self.sum as f64 / ONE / n;
        let scatter = (self.squares as f64 / ONE / n - mean * mean).max(0.0);
        if self == Self::default() {
            return Estimate { value: 0.0, error: greatest_weight / (n * CHUNK as f64) };
        }
        let error = if chunks == 1 { f64::INFINITY } else { scale * (scatter / (n - 1.0)).sqrt() };
        Estimate { value: scale * mean, error }
    }
}

/// Sums of the weights that photons scattered twice or more have carried out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GuidedTally {
    /// Unit of the sums.
    unit: f64,
    /// Greatest weight of a photon, roulette apart.
    greatest_weight: f64,
    chunks: u64,
    collisions: u64,
    total: Moments,
    rings: Vec<Moments>,
    enclosed: Vec<Moments>,
}

impl GuidedTally {
    /// A tally of sums that are not above some 10⁴ `unit`s.
    pub(super) fn new(radii: usize, unit: f64, greatest_weight: f64) -> Self {
        Self {
            unit,
            greatest_weight,
            chunks: 0,
            collisions: 0,
            total: Moments::default(),
            rings: vec![Moments::default(); radii + 1],
            enclosed: vec![Moments::default(); radii + 1],
        }
    }

    /// Adds the sums of a chunk.
    pub(super) fn add(&mut self, sums: &ChunkSums) {
        self.chunks += 1;
        self.collisions += sums.collisions;
        self.total.add(sums.total / self.unit);
        let mut enclosed_sum = 0.0;
        for ((&sum, ring), enclosed) in sums.rings.iter().zip(&mut self.rings).zip(&mut self.enclosed) {
            let sum = sum / self.unit;
            enclosed_sum += sum;
            ring.add(sum);
            enclosed.add(enclosed_sum);
        }
    }

    /// Both tallies together, which have the same radii and unit.
    pub(super) fn merged(mut self, other: &Self) -> Self {
        self.chunks += other.chunks;
        self.collisions += other.collisions;
        self.total.merge(other.total);
        self.rings.iter_mut().zip(&other.rings).for_each(|(ring, &more)| ring.merge(more));
        self.enclosed.iter_mut().zip(&other.enclosed).for_each(|(enclosed, &more)| enclosed.merge(more));
        self
    }

    pub(super) fn photons(&self) -> u64 {
        self.chunks * CHUNK as u64
    }

    pub(super) fn collisions(&self) -> u64 {
        self.collisions
    }

    /// Mean of a photon over all rings.
    pub(super) fn total(&self) -> Estimate {
        self.total.estimate(self.chunks, self.unit, self.greatest_weight)
    }

    /// Mean of a photon in a ring, the last of which is outside all radii; nothing where there is no such ring.
    pub(super) fn ring(&self, ring: usize) -> Option<Estimate> {
        self.rings.get(ring).map(|ring| ring.estimate(self.chunks, self.unit, self.greatest_weight))
    }

    /// Mean of a photon in all rings up to one; nothing where there is no such ring.
    pub(super) fn enclosed(&self, ring: usize) -> Option<Estimate> {
        self.enclosed
            .get(ring)
            .map(|enclosed| enclosed.estimate(self.chunks, self.unit, self.greatest_weight))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums(i: u32) -> ChunkSums {
        let x = f64::from(i);
        ChunkSums {
            total: 700.0 + x.sin(),
            rings: vec![1e-9 * x, 300.0 / (1.0 + x)],
            collisions: u64::from(i),
        }
    }

    #[test]
    fn sums_do_not_depend_on_the_order() {
        let mut forwards = GuidedTally::new(1, 0.5, 0.3);
        (0..100).for_each(|i| forwards.add(&sums(i)));
        let mut parts = GuidedTally::new(1, 0.5, 0.3);
        for start in (0..100).step_by(10).rev() {
            let mut part = GuidedTally::new(1, 0.5, 0.3);
            (start..start + 10).for_each(|i| part.add(&sums(i)));
            parts = parts.merged(&part);
        }
        assert_eq!(parts, forwards);
    }

    #[test]
    fn estimate_is_mean_and_its_standard_error() {
        let mut tally = GuidedTally::new(1, 0.5, 0.3);
        (0..100).for_each(|i| tally.add(&sums(i)));
        let samples: Vec<f64> = (0..100).map(|i| sums(i).total / CHUNK as f64).collect();
        let mean = samples.iter().sum::<f64>() / 100.0;
        let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 99.0;
        let found = tally.total();
        assert!((found.value - mean).abs() < 1e-14 * mean);
        assert!((found.error / (variance / 100.0).sqrt() - 1.0).abs() < 1e-9);
        assert_eq!((tally.photons(), tally.collisions()), (100 * CHUNK as u64, 4950));
        let [ring, enclosed] = [tally.ring(1).unwrap(), tally.enclosed(1).unwrap()];
        assert!((enclosed.value - ring.value - tally.ring(0).unwrap().value).abs() < 1e-15);
        assert_eq!(tally.ring(2), None);
    }

    #[test]
    fn estimate_of_nothing_has_the_error_of_one_photon() {
        let mut tally = GuidedTally::new(1, 0.5, 0.3);
        (0..4).for_each(|_| tally.add(&ChunkSums { total: 1.0, rings: vec![0.0, 1.0], collisions: 0 }));
        let error = 0.3 / (4 * CHUNK) as f64;
        assert_eq!(tally.ring(0), Some(Estimate { value: 0.0, error }));
    }

    #[test]
    fn estimate_of_too_few_is_without_bound() {
        let mut tally = GuidedTally::new(0, 1.0, 0.3);
        assert_eq!(tally.total().error, f64::INFINITY);
        tally.add(&ChunkSums { total: 1.0, rings: vec![], collisions: 0 });
        assert_eq!(tally.total().error, f64::INFINITY);
        tally.add(&ChunkSums { total: 1.0, rings: vec![], collisions: 0 });
        assert_eq!(tally.total(), Estimate { value: 1.0 / CHUNK as f64, error: 0.0 });
    }
}
