//! Sorts lights into the nodes of a light tree.
//!
//! ```text
//! clusters ← all lights
//! while there are fewer than eight: split the costliest in two
//! do the same below each cluster
//! ```
//!
//! A cluster is split where the two halves cost least: the surface area orientation heuristic of Conty Estevez & Kulla
//! (2018, §4.4), strength × area × solid angle of emission, over bins along the axes.
//! Departures from the paper:
//! 1. The squared diagonal stands for the box's area: the error of a cluster's estimate grows with it, and it does not
//!    vanish for lights without a size, such as spots.
//! 2. While splits are compared, the spread of normals comes from the length of their mean vector, which adds up;
//!    the cones themselves are united once for each node that is kept.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::super::bounds::LightBounds;
use super::{LightChild, LightNode, WIDTH};

/// Bins along an axis.
const BINS: usize = 12;

/// Nodes below this many others are split in halves: no arrangement of lights makes the tree deep.
const GREATEST_DEPTH: u32 = 24;

/// Clusters of more lights are built in parallel.
const PARALLEL: usize = 4096;

type TreeLight = (LightBounds, u32);

/// The nodes of a tree over at least one light, the root first. They do not depend on the number of threads.
pub(crate) fn build(mut lights: Vec<TreeLight>) -> Vec<LightNode> {
    let mut nodes = Vec::new();
    add_node(&mut lights, 0, &mut nodes);
    nodes
}

/// Adds a node with all that is below it behind `nodes`; returns the bounds of its lights.
fn add_node(items: &mut [TreeLight], depth: u32, nodes: &mut Vec<LightNode>) -> LightBounds {
    let place = nodes.len();
    nodes.push(LightNode::default());
    let is_large = items.len() > PARALLEL;
    let clusters = clusters(items, depth);
    let children: Vec<(LightBounds, LightChild)> = if is_large {
        let below: Vec<_> = clusters.into_par_iter().map(|cluster| subtree(cluster, depth)).collect();
        below.into_iter().map(|(bounds, child, subtree)| (bounds, child.placed(subtree, nodes))).collect()
    } else {
        clusters.into_iter().map(|cluster| add_child(cluster, depth, nodes)).collect()
    };
    let mut node = LightNode::default();
    for (lane, (bounds, child)) in children.iter().enumerate() {
        node.set(lane, bounds, *child);
    }
    nodes[place] = node;
    children.iter().map(|(bounds, _)| *bounds).reduce(|a, b| a.union(&b)).unwrap_or(items[0].0)
}

fn add_child(cluster: &mut [TreeLight], depth: u32, nodes: &mut Vec<LightNode>) -> (LightBounds, LightChild) {
    if let [(bounds, light)] = cluster {
        return (*bounds, LightChild::Light(*light));
    }
    let index = nodes.len() as u32;
    (add_node(cluster, depth + 1, nodes), LightChild::LightNode(index))
}

/// A child with nodes of its own, numbered from 0.
fn subtree(cluster: &mut [TreeLight], depth: u32) -> (LightBounds, LightChild, Vec<LightNode>) {
    let mut nodes = Vec::new();
    let (bounds, child) = add_child(cluster, depth, &mut nodes);
    (bounds, child, nodes)
}

impl LightChild {
    /// Puts a child's nodes behind others.
    fn placed(self, subtree: Vec<LightNode>, nodes: &mut Vec<LightNode>) -> Self {
        let first = nodes.len() as u32;
        nodes.extend(subtree.into_iter().map(|mut node| {
            node.shift(first);
            node
        }));
        match self {
            Self::LightNode(index) => Self::LightNode(index + first),
            light @ Self::Light(_) => light,
        }
    }
}

/// Splits lights into up to eight clusters.
fn clusters(items: &mut [TreeLight], depth: u32) -> Vec<&mut [TreeLight]> {
    let cost = |items: &[TreeLight]| {
        if items.len() > 1 { ClusterCost::of(items).cost() } else { -1.0 }
    };
    let mut clusters = vec![(cost(items), items)];
    while clusters.len() < WIDTH {
        let costliest = (0..clusters.len()).max_by(|&a, &b| clusters[a].0.total_cmp(&clusters[b].0));
        let Some(index) = costliest.filter(|&index| clusters[index].1.len() > 1) else { break };
        let (_, cluster) = clusters.swap_remove(index);
        let middle = if depth < GREATEST_DEPTH { partition(cluster) } else { None };
        let middle = middle.unwrap_or_else(|| halve(cluster));
        let (left, right) = cluster.split_at_mut(middle);
        clusters.push((cost(left), left));
        clusters.push((cost(right), right));
    }
    clusters.into_iter().map(|(_, items)| items).collect()
}

/// The terms of a cluster's cost, which add up.
#[derive(Clone, Copy, Debug)]
struct ClusterCost {
    low: Vec3,
    high: Vec3,
    strength: f64,
    /// Sum of strength × axis.
    direction: DVec3,
    count: usize,
}

impl ClusterCost {
    const EMPTY: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
        strength: 0.0,
        direction: DVec3::ZERO,
        count: 0,
    };

    fn of(items: &[TreeLight]) -> Self {
        items.iter().fold(Self::EMPTY, |sum, (bounds, _)| sum.plus(&Self::one(bounds)))
    }

    fn one(bounds: &LightBounds) -> Self {
        let strength = f64::from(bounds.strength).max(1e-60);
        // The mean vector of a cone's directions has length (1 + cos θ)/2.
        let length = 0.5 * (1.0 + libm::cos(f64::from(bounds.theta_o)));
        let direction = bounds.axis.as_dvec3() * (length * strength);
        Self { low: bounds.low, high: bounds.high, strength, direction, count: 1 }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            strength: self.strength + other.strength,
            direction: self.direction + other.direction,
            count: self.count + other.count,
        }
    }

    /// Strength × squared diagonal × solid angle of emission.
    ///
    /// For emitters of a hemisphere about each normal in a cone the latter is π for one normal, 4π for all; between
    /// these π (1 + 3 √x) with x = (1 − cos θ_o)/2 is within 15 % of the paper's formula.
    fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let diagonal2 = (self.high.as_dvec3() - self.low.as_dvec3()).length_squared();
        let spread = (1.0 - self.direction.length() / self.strength).max(0.0);
        self.strength * diagonal2 * (1.0 + 3.0 * spread.sqrt())
    }
}

fn center(bounds: &LightBounds) -> Vec3 {
    bounds.low.midpoint(bounds.high)
}

/// Lowest and highest center.
fn extent(items: &[TreeLight]) -> (Vec3, Vec3) {
    items.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (bounds, _)| {
        (low.min(center(bounds)), high.max(center(bounds)))
    })
}

/// Orders lights so that the cheapest split is at the returned index. `None` if all lights have one center.
fn partition(items: &mut [TreeLight]) -> Option<usize> {
    let (low, high) = extent(items);
    let size = high - low;
    let longest = f64::from(size.max_element());
    let bin_of = |axis: usize, bounds: &LightBounds| {
        let share = (center(bounds)[axis] - low[axis]) / size[axis];
        ((share * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| size[axis] > 0.0 && size[axis].is_finite()) {
        let mut bins = [ClusterCost::EMPTY; BINS];
        for (bounds, _) in items.iter() {
            let bin = &mut bins[bin_of(axis, bounds)];
            *bin = bin.plus(&ClusterCost::one(bounds));
        }
        let mut behind = [ClusterCost::EMPTY; BINS + 1];
        for split in (0..BINS).rev() {
            behind[split] = behind[split + 1].plus(&bins[split]);
        }
        let mut before = ClusterCost::EMPTY;
        for split in 1..BINS {
            before = before.plus(&bins[split - 1]);
            if before.count == 0 || behind[split].count == 0 {
                continue;
            }
            let cost = (before.cost() + behind[split].cost()) * longest / f64::from(size[axis]);
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, split));
            }
        }
    }
    let (_, axis, split) = best?;
    let mut middle = 0;
    for index in 0..items.len() {
        if bin_of(axis, &items[index].0) < split {
            items.swap(index, middle);
            middle += 1;
        }
    }
    (middle > 0 && middle < items.len()).then_some(middle)
}

/// Orders lights along the longest axis and splits them in equal halves.
fn halve(items: &mut [TreeLight]) -> usize {
    let (low, high) = extent(items);
    let size = high - low;
    let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |(a, _), (b, _)| center(a)[axis].total_cmp(&center(b)[axis]));
    middle
}
