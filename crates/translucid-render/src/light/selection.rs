//! Selection of the light to sample.
//!
//! Few lights are weighed one by one for each point; a tree selects among many. Lights without a place (at infinity) or a
//! box (beams) stand beside the tree, each weighed by itself.

use translucid_law::Receiver;

use super::distribution::Discrete;
use super::emitters::Emitters;
use super::tree::{LightTree, Root};
use super::weights::{GREATEST_IMPORTANCE, LightWeights, importance};

/// Up to this many lights are weighed one by one.
///
/// `cargo bench -p translucid-workbench --bench lights -- --lights 16,24,31,40,64` shows where a tree begins to pay.
pub(crate) const MOST_WEIGHED: usize = 32;

/// Up to this many have a shorter array: most scenes have a light and a sky.
const A_FEW: usize = 4;

/// Share of the samples that goes evenly to all lights that can contribute, in case the important ones are
/// hidden.
const EVEN_SHARE: f32 = 0.1;

/// A way to select lights, for measuring one against the other: all of them give the same picture in the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSelection {
    /// The way that suits the number of lights.
    #[default]
    Automatic,
    /// Each of up to 32 lights weighed for every point, more of them always by their power.
    Power,
    /// Each light weighed for every point, however many there are.
    Weighed,
    /// A tree, however few there are.
    Tree,
}

/// A way to select lights, with its tables.
#[derive(Clone, Debug)]
pub(crate) enum Selection {
    /// By their importance for the point at hand.
    Weighed,
    /// Each light weighed in two rounds, for more lights than fit into an array.
    AllWeighed,
    /// Always with these probabilities.
    Fixed(Discrete),
    /// By a tree, and beside it those that it cannot hold.
    Tree { tree: LightTree, apart: UntreedLights },
}

impl Selection {
    /// A selection among the lights of a scene with this cross section \[L²\].
    pub(crate) fn new(emitters: &Emitters, cross_section: f32, way: LightSelection) -> Self {
        let few = emitters.len() <= MOST_WEIGHED;
        match way {
            LightSelection::Automatic | LightSelection::Power | LightSelection::Weighed if few => {
                Self::Weighed
            }
            LightSelection::Weighed => Self::AllWeighed,
            LightSelection::Power => {
                let powers = (0..emitters.len()).map(|light| emitters.power(light, cross_section));
                Discrete::new(powers.map(f64::from)).map_or(Self::AllWeighed, Self::Fixed)
            }
            LightSelection::Automatic | LightSelection::Tree => {
                let bounds = |light| emitters.bounds(light).map(|bounds| (bounds, light as u32));
                let placed: Vec<_> = (0..emitters.len()).filter_map(bounds).collect();
                LightTree::new(placed, emitters.len()).map_or(Self::AllWeighed, |tree| {
                    let apart = (0..emitters.len()).filter(|&light| !tree.holds(light)).collect();
                    Self::Tree { apart: UntreedLights::new(apart, emitters, cross_section), tree }
                })
            }
        }
    }

    /// The tree, and the numbers of the lights beside it in rising order, where one is used.
    pub(crate) fn tree(&self) -> Option<(&LightTree, &[usize])> {
        if let Self::Tree { tree, apart } = self { Some((tree, &apart.lights)) } else { None }
    }

    /// Selects a light; returns its number and its probability. None if no light can contribute.
    #[inline]
    pub(crate) fn choose(&self, emitters: &Emitters, receiver: &Receiver, u: f64) -> Option<(usize, f32)> {
        match self {
            Self::Weighed if emitters.len() <= A_FEW => {
                weighed::<A_FEW>(emitters, receiver).choose(u).map(|(light, p, _)| (light, p))
            }
            Self::Weighed => {
                weighed::<MOST_WEIGHED>(emitters, receiver).choose(u).map(|(light, p, _)| (light, p))
            }
            Self::AllWeighed => choose_of_all(emitters, receiver, u),
            Self::Fixed(discrete) => {
                let choice = discrete.sample(u);
                Some((choice.index, choice.probability as f32))
            }
            Self::Tree { tree, apart } => choose_by_tree(tree, apart, emitters, receiver, u),
        }
    }

    /// Probability with which `choose` selects a light.
    #[inline]
    pub(crate) fn probability(&self, emitters: &Emitters, receiver: &Receiver, light: usize) -> f32 {
        match self {
            Self::Weighed if emitters.len() <= A_FEW => {
                weighed::<A_FEW>(emitters, receiver).probability(light)
            }
            Self::Weighed => weighed::<MOST_WEIGHED>(emitters, receiver).probability(light),
            Self::AllWeighed => {
                let (importance, total) =
                    (importance(emitters, light, receiver), Total::of(emitters, receiver));
                total.probability(importance)
            }
            Self::Fixed(discrete) => discrete.probability(light) as f32,
            Self::Tree { tree, apart } => {
                let root = tree.root(emitters, receiver);
                let beside = apart.weigh(emitters, receiver);
                let groups = groups(&root, &beside);
                match apart.place(light) {
                    Some(place) => groups.probability(0) * beside.probability(place),
                    None => {
                        let cut = tree.cut(&root, emitters, receiver);
                        groups.probability(1) * tree.probability(&cut, emitters, receiver, light)
                    }
                }
            }
        }
    }
}

/// Each of few lights weighed.
#[inline]
fn weighed<const N: usize>(emitters: &Emitters, receiver: &Receiver) -> LightWeights<N> {
    let mut weights = [0.0; N];
    let len = emitters.len().min(N);
    for (light, weight) in weights[..len].iter_mut().enumerate() {
        *weight = importance(emitters, light, receiver);
    }
    LightWeights::of_first(weights, len, EVEN_SHARE)
}

/// The weights of any number of lights, as [`LightWeights`] makes them.
struct Total {
    sum: f64,
    count: u32,
}

impl Total {
    fn of(emitters: &Emitters, receiver: &Receiver) -> Self {
        let importances = (0..emitters.len()).map(|light| importance(emitters, light, receiver));
        importances.fold(Self { sum: 0.0, count: 0 }, |total, importance| Self {
            sum: total.sum + f64::from(importance),
            count: total.count + u32::from(importance > 0.0),
        })
    }

    fn probability(&self, importance: f32) -> f32 {
        if importance <= 0.0 {
            return 0.0;
        }
        let share = f64::from(importance) / self.sum * f64::from(1.0 - EVEN_SHARE);
        (share + f64::from(EVEN_SHARE) / f64::from(self.count)) as f32
    }
}

fn choose_of_all(emitters: &Emitters, receiver: &Receiver, u: f64) -> Option<(usize, f32)> {
    let total = Total::of(emitters, receiver);
    let (mut end, mut chosen) = (0.0, None);
    for light in 0..emitters.len() {
        let probability = total.probability(importance(emitters, light, receiver));
        if probability > 0.0 {
            chosen = Some((light, probability));
            end += f64::from(probability);
            if u < end {
                break;
            }
        }
    }
    chosen
}

/// The lights that no tree can hold.
#[derive(Clone, Debug)]
pub(crate) struct UntreedLights {
    /// Their numbers in rising order.
    lights: Vec<usize>,
    /// Where there are too many to weigh: their probabilities, and the importance of all of them.
    fixed: Option<(Discrete, f32)>,
}

/// The lights beside the tree weighed for a point.
enum UntreedWeights<'a> {
    Weighed(LightWeights<MOST_WEIGHED>),
    Fixed(&'a Discrete, f32),
}

impl UntreedLights {
    fn new(lights: Vec<usize>, emitters: &Emitters, cross_section: f32) -> Self {
        let fixed = (lights.len() > MOST_WEIGHED).then(|| {
            let powers: Vec<_> =
                lights.iter().map(|&light| f64::from(emitters.power(light, cross_section))).collect();
            let mean_irradiance = (powers.iter().sum::<f64>() / f64::from(cross_section)) as f32;
            let importance = mean_irradiance.clamp(f32::MIN_POSITIVE, GREATEST_IMPORTANCE);
            Discrete::new(powers.into_iter()).map(|discrete| (discrete, importance))
        });
        Self { lights, fixed: fixed.flatten() }
    }

    fn place(&self, light: usize) -> Option<usize> {
        self.lights.binary_search(&light).ok()
    }

    #[inline]
    fn weigh(&self, emitters: &Emitters, receiver: &Receiver) -> UntreedWeights<'_> {
        if let Some((discrete, importance)) = &self.fixed {
            return UntreedWeights::Fixed(discrete, *importance);
        }
        let mut weights = [0.0; MOST_WEIGHED];
        for (weight, &light) in weights.iter_mut().zip(&self.lights) {
            *weight = importance(emitters, light, receiver);
        }
        UntreedWeights::Weighed(LightWeights::of_first(
            weights,
            self.lights.len().min(MOST_WEIGHED),
            EVEN_SHARE,
        ))
    }
}

impl UntreedWeights<'_> {
    fn importance(&self) -> f32 {
        match self {
            Self::Weighed(weights) => weights.sum(),
            Self::Fixed(_, importance) => *importance,
        }
    }

    fn probability(&self, place: usize) -> f32 {
        match self {
            Self::Weighed(weights) => weights.probability(place),
            Self::Fixed(discrete, _) => discrete.probability(place) as f32,
        }
    }

    fn choose(&self, u: f64) -> Option<(usize, f32)> {
        match self {
            Self::Weighed(weights) => weights.choose(u).map(|(place, probability, _)| (place, probability)),
            Self::Fixed(discrete, _) => {
                let choice = discrete.sample(u);
                Some((choice.index, choice.probability as f32))
            }
        }
    }
}

/// The choice between the lights beside the tree and those in it.
fn groups(root: &Root, beside: &UntreedWeights<'_>) -> LightWeights<2> {
    LightWeights::new([beside.importance(), root.importance()], EVEN_SHARE)
}

fn choose_by_tree(
    tree: &LightTree,
    apart: &UntreedLights,
    emitters: &Emitters,
    receiver: &Receiver,
    u: f64,
) -> Option<(usize, f32)> {
    let root = tree.root(emitters, receiver);
    let beside = apart.weigh(emitters, receiver);
    let (group, share, u) = groups(&root, &beside).choose(u)?;
    let (light, probability) = if group == 0 {
        let (place, probability) = beside.choose(u)?;
        (apart.lights[place], probability)
    } else {
        tree.choose(&tree.cut(&root, emitters, receiver), emitters, receiver, u)?
    };
    Some((light, share * probability))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_sum_to_one_and_skip_what_cannot_contribute() {
        let weights = [0.0, 1.0, 1e30, 1e30, 0.0, 1e-30];
        let odds = LightWeights::new(weights, EVEN_SHARE);
        let sum: f32 = (0..weights.len()).map(|i| odds.probability(i)).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        for (index, weight) in weights.into_iter().enumerate() {
            assert_eq!(odds.probability(index) > 0.0, weight > 0.0, "{weight}");
        }
        assert!(LightWeights::new([0.0; 3], EVEN_SHARE).choose(0.5).is_none());
    }

    #[test]
    fn choose_follows_the_odds() {
        let odds = LightWeights::new([0, 1, 2, 3, 4, 5, 6].map(|i| (i * i % 5) as f32), EVEN_SHARE);
        let n = 100_000;
        let mut counts = [0_u32; 7];
        for i in 0..n {
            let (index, probability, rest) = odds.choose((f64::from(i) + 0.5) / f64::from(n)).unwrap();
            assert_eq!(probability, odds.probability(index));
            assert!((0.0..1.0).contains(&rest));
            counts[index] += 1;
        }
        for (index, &count) in counts.iter().enumerate() {
            let share = count as f32 / n as f32;
            assert!((share - odds.probability(index)).abs() < 1e-4, "{index}: {share}");
        }
    }
}
