//! Which light to sample.
//!
//! The rest of the module knows only [`Selection::odds`]: a light tree can take its place.

use super::distribution::Discrete;

/// Up to this many lights are weighed anew for every point.
pub(crate) const MOST_ADAPTIVE: usize = 32;

/// Share of the samples that goes evenly to all lights that can contribute, in case the important ones are
/// hidden.
const EVEN_SHARE: f32 = 0.1;

/// Importances above this are as good as equal; their sum must stay finite.
const GREATEST_IMPORTANCE: f32 = 1e30;

/// How lights are selected.
#[derive(Clone, Debug)]
pub(crate) enum Selection {
    /// By their importance for the point at hand.
    Adaptive,
    /// Always with these probabilities.
    Fixed(Discrete),
}

impl Selection {
    /// Selection among lights of these powers.
    pub(crate) fn new(powers: &[f32]) -> Self {
        if powers.len() <= MOST_ADAPTIVE {
            return Self::Adaptive;
        }
        Discrete::new(powers.iter().map(|&power| f64::from(power))).map_or(Self::Adaptive, Self::Fixed)
    }

    /// Probabilities of the lights, given their importance at a point.
    pub(crate) fn odds<T>(&self, lights: &[T], importance: impl Fn(&T) -> f32) -> Odds<'_> {
        match self {
            Self::Fixed(discrete) => Odds::Fixed(discrete),
            Self::Adaptive => Odds::adaptive(lights.iter().map(importance)),
        }
    }
}

/// Probabilities of selecting each light for one point.
pub(crate) enum Odds<'a> {
    /// Probabilities of the first lights, the rest zeros.
    Adaptive([f32; MOST_ADAPTIVE]),
    Fixed(&'a Discrete),
}

impl Odds<'_> {
    fn adaptive(importances: impl Iterator<Item = f32>) -> Self {
        let mut odds = [0.0; MOST_ADAPTIVE];
        for (slot, importance) in odds.iter_mut().zip(importances) {
            *slot = if importance.is_nan() { 0.0 } else { importance.clamp(0.0, GREATEST_IMPORTANCE) };
        }
        let sum: f32 = odds.iter().sum();
        if sum > 0.0 {
            let contributing = odds.iter().filter(|&&importance| importance > 0.0).count();
            let even = EVEN_SHARE / contributing as f32;
            for slot in odds.iter_mut().filter(|slot| **slot > 0.0) {
                *slot = (1.0 - EVEN_SHARE) * (*slot / sum) + even;
            }
        }
        Self::Adaptive(odds)
    }

    /// Probability of one light.
    pub(crate) fn probability(&self, index: usize) -> f32 {
        match self {
            Self::Adaptive(odds) => odds.get(index).copied().unwrap_or(0.0),
            Self::Fixed(discrete) => discrete.probability(index) as f32,
        }
    }

    /// Selects a light; returns its index, its probability and what is left of the random number.
    /// None if no light can contribute.
    pub(crate) fn choose(&self, u: f32) -> Option<(usize, f32, f64)> {
        match self {
            Self::Adaptive(odds) => choose_linear(odds, f64::from(u)),
            Self::Fixed(discrete) => {
                let choice = discrete.sample(f64::from(u));
                Some((choice.index, choice.probability as f32, choice.rest))
            }
        }
    }
}

/// Walks along probabilities that sum to 1 up to rounding, or to 0.
fn choose_linear(odds: &[f32], u: f64) -> Option<(usize, f32, f64)> {
    let mut chosen = None;
    let mut begin = 0.0;
    for (index, &probability) in odds.iter().enumerate().filter(|&(_, &p)| p > 0.0) {
        let width = f64::from(probability);
        let rest = ((u - begin) / width).clamp(0.0, 1.0 - f64::EPSILON);
        chosen = Some((index, probability, rest));
        begin += width;
        if u < begin {
            break;
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odds_sum_to_one_and_skip_what_cannot_contribute() {
        let importances = [0.0, 1.0, f32::NAN, 1e38, f32::INFINITY, -1.0, 1e-30];
        let odds = Selection::Adaptive.odds(&importances, |&i| i);
        let sum: f32 = (0..importances.len()).map(|i| odds.probability(i)).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        for (index, importance) in importances.into_iter().enumerate() {
            assert_eq!(odds.probability(index) > 0.0, importance > 0.0, "{importance}");
        }
    }

    #[test]
    fn choose_follows_the_odds() {
        let importances: Vec<f32> = (0..7).map(|i| (i * i % 5) as f32).collect();
        let odds = Selection::Adaptive.odds(&importances, |&i| i);
        let n = 100_000;
        let mut counts = [0_u32; 7];
        for i in 0..n {
            let (index, probability, rest) = odds.choose((i as f32 + 0.5) / n as f32).unwrap();
            assert_eq!(probability, odds.probability(index));
            assert!((0.0..1.0).contains(&rest));
            counts[index] += 1;
        }
        for (index, &count) in counts.iter().enumerate() {
            let share = count as f32 / n as f32;
            assert!((share - odds.probability(index)).abs() < 1e-4, "{index}: {share}");
        }
    }

    #[test]
    fn odds_of_many_lights_follow_their_power() {
        let powers: Vec<f32> = (1..=100).map(|i| i as f32).collect();
        let selection = Selection::new(&powers);
        let odds = selection.odds(&powers, |_| 0.0);
        for (index, power) in powers.iter().enumerate() {
            assert!((odds.probability(index) - power / 5050.0).abs() < 1e-6);
        }
        assert_eq!(odds.choose(0.999_999).unwrap().0, 99);
    }
}
