//! A choice among finitely many things, in proportion to weights.

/// Largest number below 1 that a rescaled random number may become.
const ALMOST_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// Discrete distribution with its cumulated probabilities.
///
/// They are kept in double precision: a million triangles, or a sky beside its sun, differ by more than
/// the 24 bits of `f32`. A search in them, rather than an alias table, keeps well-distributed random numbers
/// well distributed.
#[derive(Clone, Debug)]
pub(crate) struct Discrete {
    /// `cumulated[i]` is the probability of an index below i; the last entry is 1.
    cumulated: Vec<f64>,
}

/// A choice of [`Discrete::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    /// Number of the entry.
    pub(crate) index: usize,
    /// Its probability.
    pub(crate) probability: f64,
    /// Random number in [0, 1) that is left: uniform given the choice.
    pub(crate) rest: f64,
}

impl Discrete {
    /// Distribution in proportion to the weights; those negative or not finite count as 0.
    /// None if all are 0.
    pub(crate) fn new(weights: impl Iterator<Item = f64>) -> Option<Self> {
        let mut cumulated = vec![0.0];
        let mut sum = 0.0;
        for weight in weights {
            sum += if weight.is_finite() { weight.max(0.0) } else { 0.0 };
            cumulated.push(sum);
        }
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        for value in &mut cumulated {
            *value /= sum;
        }
        Some(Self { cumulated })
    }

    /// Number of entries.
    pub(crate) fn len(&self) -> usize {
        self.cumulated.len() - 1
    }

    /// Probability of an entry.
    pub(crate) fn probability(&self, index: usize) -> f64 {
        self.cumulated[index + 1] - self.cumulated[index]
    }

    /// Chooses by a random number in [0, 1).
    pub(crate) fn sample(&self, u: f64) -> Choice {
        let u = u.clamp(0.0, ALMOST_ONE);
        // The number of entries whose range begins at or below u; entries of probability 0 are stepped over.
        let index = self.cumulated[..self.len()].partition_point(|&begin| begin <= u) - 1;
        let probability = self.probability(index);
        let rest = ((u - self.cumulated[index]) / probability).clamp(0.0, ALMOST_ONE);
        Choice { index, probability, rest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_inverts_the_cumulated_probabilities() {
        let discrete = Discrete::new([0.0, 3.0, 0.0, 1.0, 0.0].into_iter()).unwrap();
        for (u, index, rest) in [(0.0, 1, 0.0), (0.375, 1, 0.5), (0.75, 3, 0.0), (0.9375, 3, 0.75)] {
            let choice = discrete.sample(u);
            assert_eq!(choice.index, index, "{u}");
            assert!((choice.rest - rest).abs() < 1e-12, "{u}: {choice:?}");
        }
        assert_eq!(discrete.sample(1.0).index, 3);
        assert!(discrete.sample(1.0).rest < 1.0);
    }

    #[test]
    fn probabilities_are_the_shares_of_the_weights_even_when_tiny() {
        let weights = [1e9, 1e-3, f64::NAN, -1.0, 2e9];
        let discrete = Discrete::new(weights.into_iter()).unwrap();
        let shares = [1.0 / 3.0, 1e-12 / 3.0, 0.0, 0.0, 2.0 / 3.0];
        for (index, share) in shares.into_iter().enumerate() {
            let probability = discrete.probability(index);
            assert!((probability - share).abs() <= 1e-3 * share, "{index}: {probability}");
        }
    }

    #[test]
    fn weights_without_a_sum_have_no_distribution() {
        assert!(Discrete::new([0.0, -1.0].into_iter()).is_none());
        assert!(Discrete::new(std::iter::empty()).is_none());
    }
}
