//! The choice of nodes of a binary tree that become children of a wide node.
//!
//! The expected cost of a ray is a sum over nodes and blocks, each weighted with the area of its box. Let C(n, i) be the
//! least cost of the subtree below n if it may have up to i places in the node above [Ylitie, Karras & Laine 2017, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3]:
//!
//! ```text
//! C(n, i) = area(n) c_block                              the subtree below n fits into a block
//! C(n, 1) = area(n) + S(n, 8)                            a node of its own
//! C(n, i) = min { S(n, i), C(n, i − 1) }                 i > 1
//! S(n, i) = min { C(left, k) + C(right, i − k) : 0 < k < i }
//! ```
//!
//! On the dragon of 870,026 triangles nodes have 5.8 children each, and 4.4 where the largest box is divided again and again.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

use super::node::WIDTH;
use crate::ray::primitive::BlockNeeds;

/// Cost of a block in units of a node.
const BLOCK_COST: f32 = 1.0;

/// Marks a binary node whose triangles become a block.
const BLOCK: u32 = u32::MAX;

/// The least costs of all subtrees.
pub(super) struct Costs<'a> {
    binary: &'a [Bvh2Node],
    /// Place of each binary node in `costs`, or `BLOCK`.
    places: Vec<u32>,
    /// C(n, 1) … C(n, 7) of the nodes that are no blocks.
    costs: Vec<[f32; WIDTH - 1]>,
}

impl<'a> Costs<'a> {
    /// Costs of a tree whose things fill a block each, but for those with `needs`, in blocks of so many lanes.
    pub(super) fn new(binary: &'a Bvh2, needs: impl Fn(u32) -> Option<BlockNeeds>, lanes: usize) -> Self {
        let nodes = &*binary.nodes;
        let mut this = Self { binary: nodes, places: vec![BLOCK; nodes.len()], costs: Vec::new() };
        // Parents before children, with a list instead of recursion: degenerate trees are deep.
        let mut order = Vec::with_capacity(nodes.len() / 2);
        let mut open = vec![0_u32];
        while let Some(index) = open.pop() {
            if !nodes[index as usize].is_leaf() {
                order.push(index);
                let [left, right] = this.below(index);
                open.extend([right, left]);
            }
        }
        // The needs of the nodes that are done, as far as they fit into a block.
        let mut done: Vec<Option<BlockNeeds>> = Vec::new();
        let needs_of = |child: u32, done: &mut Vec<Option<BlockNeeds>>| {
            let node = &nodes[child as usize];
            if !node.is_leaf() {
                return done.pop().flatten();
            }
            debug_assert_eq!(node.prim_count, 1);
            needs(binary.primitive_indices[node.first_index as usize])
        };
        for &index in order.iter().rev() {
            let [left, right] = this.below(index);
            let sum = match (needs_of(left, &mut done), needs_of(right, &mut done)) {
                (Some(left), Some(right)) => left.with(&right, lanes),
                _ => None,
            };
            done.push(sum);
            if sum.is_none() {
                this.add(index);
            }
        }
        this
    }

    /// Returns `true` if a node's triangles become a block.
    pub(super) fn is_block(&self, node: u32) -> bool {
        self.places[node as usize] == BLOCK
    }

    /// The two nodes below one that is no leaf.
    pub(super) fn below(&self, node: u32) -> [u32; 2] {
        let first = self.binary[node as usize].first_index;
        [first, first + 1]
    }

    /// Finds up to eight nodes that become the children of the wide node made of a binary one; `open` is empty before and
    /// after.
    pub(super) fn children(&self, root: u32, found: &mut Vec<u32>, open: &mut Vec<(u32, usize)>) {
        found.clear();
        if self.is_block(root) {
            found.push(root);
            return;
        }
        open.push((root, WIDTH));
        while let Some((node, places)) = open.pop() {
            if places == 1 {
                found.push(node);
                continue;
            }
            let first = self.best_split(node, places);
            let below = self.below(node);
            // Places that do not lower the cost stay empty.
            let [left, right] = [(below[0], first), (below[1], places - first)].map(|(node, mut places)| {
                let costs = self.costs_of(node);
                while places > 1 && costs[places - 1] == costs[places - 2] {
                    places -= 1;
                }
                (node, places)
            });
            open.extend([right, left]);
        }
    }

    /// Adds C(n, 1) … C(n, 7) of a node whose children's are known.
    fn add(&mut self, node: u32) {
        let [left, right] = self.below(node).map(|child| self.costs_of(child));
        let split = |places: usize| least(&left, &right, places).1;
        let mut costs = [self.area(node) + split(WIDTH); WIDTH - 1];
        for places in 2..WIDTH {
            costs[places - 1] = split(places).min(costs[places - 2]);
        }
        self.places[node as usize] = self.costs.len() as u32;
        self.costs.push(costs);
    }

    /// The number of places that the left child gets where there are so many.
    fn best_split(&self, node: u32, places: usize) -> usize {
        let [left, right] = self.below(node).map(|child| self.costs_of(child));
        least(&left, &right, places).0
    }

    /// C(n, 1) … C(n, 7).
    fn costs_of(&self, node: u32) -> [f32; WIDTH - 1] {
        match self.places[node as usize] {
            BLOCK => [self.area(node) * BLOCK_COST; WIDTH - 1],
            place => self.costs[place as usize],
        }
    }

    fn area(&self, node: u32) -> f32 {
        self.binary[node as usize].aabb().half_area()
    }
}

/// S(n, i) by the costs of the two children, and the number of places that the left one gets.
#[inline(always)]
fn least(left: &[f32; WIDTH - 1], right: &[f32; WIDTH - 1], places: usize) -> (usize, f32) {
    let mut best = (1, f32::INFINITY);
    for first in 1..places {
        let cost = left[first - 1] + right[places - first - 1];
        if cost < best.1 {
            best = (first, cost);
        }
    }
    best
}
