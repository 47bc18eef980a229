//! Weights of lights at a point, and a choice in proportion to them.

use translucid_law::Receiver;

use super::emitters::Emitters;

/// Importances above this are as good as equal; their sum must stay finite.
pub(crate) const GREATEST_IMPORTANCE: f32 = 1e30;

/// Probabilities in proportion to weights, but for a share that goes evenly to all that are not 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightWeights<const N: usize> {
    weights: [f32; N],
    /// Number of weights in use.
    len: usize,
    sum: f32,
    /// Probability of a weight of 1 less the even share.
    scale: f32,
    even: f32,
}

impl<const N: usize> LightWeights<N> {
    /// From weights that are not negative, and whose sum is finite.
    #[inline]
    pub(crate) fn new(weights: [f32; N], even_share: f32) -> Self {
        Self::of_first(weights, N, even_share)
    }

    /// From the first `len` weights, the rest being 0.
    #[inline]
    pub(crate) fn of_first(weights: [f32; N], len: usize, even_share: f32) -> Self {
        // In lanes, which a processor adds side by side; weights not in use are 0.
        let (mut sums, mut counts) = ([0.0; 8], [0; 8]);
        for lanes in weights.chunks(8) {
            for (lane, &weight) in lanes.iter().enumerate() {
                sums[lane] += weight;
                counts[lane] += u32::from(weight > 0.0);
            }
        }
        let (sum, count): (f32, u32) = (sums.iter().sum(), counts.iter().sum());
        Self { weights, len, sum, scale: (1.0 - even_share) / sum, even: even_share / count as f32 }
    }

    /// Sum of the weights.
    pub(crate) fn sum(&self) -> f32 {
        self.sum
    }

    /// Probability of a choice.
    #[inline]
    pub(crate) fn probability(&self, index: usize) -> f32 {
        let weight = self.weights[index];
        if weight > 0.0 { weight * self.scale + self.even } else { 0.0 }
    }

    /// Chooses; returns the index, its probability and the remainder of the random number. None if all weights
    /// are 0.
    #[inline]
    pub(crate) fn choose(&self, u: f64) -> Option<(usize, f32, f64)> {
        let (mut begin, mut chosen) = (0.0, None);
        for index in 0..self.len {
            let probability = self.probability(index);
            if probability > 0.0 {
                chosen = Some((index, probability, begin));
                begin += f64::from(probability);
                if u < begin {
                    break;
                }
            }
        }
        // The probabilities sum to 1 up to rounding: beyond their sum the last one is chosen.
        let (index, probability, begin) = chosen?;
        let rest = ((u - begin) / f64::from(probability)).clamp(0.0, 1.0 - f64::EPSILON);
        Some((index, probability, rest))
    }
}

/// A light's importance, in [0, [`GREATEST_IMPORTANCE`]].
pub(crate) fn importance(emitters: &Emitters, light: usize, receiver: &Receiver) -> f32 {
    let importance = emitters.importance(light, receiver);
    if importance.is_nan() { 0.0 } else { importance.clamp(0.0, GREATEST_IMPORTANCE) }
}
