//! Which nodes of a binary tree become children of a wide node.
//!
//! The expected cost of a ray is a sum over what the tree is made of, each by the area of its box. Let C(n, i) be the
//! least cost of what is below n if it may have up to i places in the node above [Ylitie, Karras & Laine 2017, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3]:
//!
//! ```text
//! C(n, i) = area(n) c_block                              what is below n fits into a block
//! C(n, 1) = area(n) + S(n, 8)                            a node of its own
//! C(n, i) = min { S(n, i), C(n, i − 1) }                 i > 1
//! S(n, i) = min { C(left, k) + C(right, i − k) : 0 < k < i }
//! ```
//!
//! On the dragon of 870,026 triangles nodes have 5.8 children each, and 4.4 where the largest box is divided again and again.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

use super::node::WIDTH;
use crate::ray::primitive::Needs;

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
    /// Of a tree over things with such needs (none: a whole block), whose blocks have so many lanes.
    pub(super) fn new(binary: &'a Bvh2, needs: impl Fn(u32) -> Option<Needs>, lanes: usize) -> Self {
        let nodes = &*binary.nodes;
        let mut this = Self { binary: nodes, places: vec![BLOCK; nodes.len()], costs: Vec::new() };
        // The needs of what is done, as far as they fit into a block.
        let mut done: Vec<Option<Needs>> = Vec::new();
        // Children before parents, with a list instead of recursion: degenerate trees are deep.
        let mut open = vec![(0_u32, false)];
        while let Some((index, is_below_done)) = open.pop() {
            let node = &nodes[index as usize];
            if node.is_leaf() {
                debug_assert_eq!(node.prim_count, 1);
                done.push(needs(binary.primitive_indices[node.first_index as usize]));
            } else if !is_below_done {
                let [left, right] = this.below(index);
                open.extend([(index, true), (left, false), (right, false)]);
            } else {
                let sum = match (done.pop().flatten(), done.pop().flatten()) {
                    (Some(left), Some(right)) => left.with(&right, lanes),
                    _ => None,
                };
                done.push(sum);
                if sum.is_none() {
                    this.add(index);
                }
            }
        }
        this
    }

    /// Whether a node's triangles become a block.
    pub(super) fn is_block(&self, node: u32) -> bool {
        self.places[node as usize] == BLOCK
    }

    /// The two nodes below one that is no leaf.
    pub(super) fn below(&self, node: u32) -> [u32; 2] {
        let first = self.binary[node as usize].first_index;
        [first, first + 1]
    }

    /// Up to eight nodes that become the children of the wide node made of a binary one.
    pub(super) fn children(&self, root: u32) -> Vec<u32> {
        if self.is_block(root) {
            return vec![root];
        }
        let mut found = Vec::with_capacity(WIDTH);
        let (first, _) = self.best_split(root, WIDTH);
        let [left, right] = self.below(root);
        let mut open = vec![(right, WIDTH - first), (left, first)];
        while let Some((node, mut places)) = open.pop() {
            // Places that make nothing better stay empty.
            while places > 1 && self.cost(node, places) == self.cost(node, places - 1) {
                places -= 1;
            }
            if places == 1 {
                found.push(node);
            } else {
                let (first, _) = self.best_split(node, places);
                let [left, right] = self.below(node);
                open.extend([(right, places - first), (left, first)]);
            }
        }
        found
    }

    /// C(n, 1) … C(n, 7) of a node whose children's are known.
    fn add(&mut self, node: u32) {
        let mut costs = [0.0; WIDTH - 1];
        let (_, apart) = self.best_split(node, WIDTH);
        costs[0] = self.area(node) + apart;
        for places in 2..WIDTH {
            let (_, split) = self.best_split(node, places);
            costs[places - 1] = split.min(costs[places - 2]);
        }
        self.places[node as usize] = self.costs.len() as u32;
        self.costs.push(costs);
    }

    /// S(n, i), and the number of places that the left child gets.
    fn best_split(&self, node: u32, places: usize) -> (usize, f32) {
        let [left, right] = self.below(node);
        let mut best = (1, f32::INFINITY);
        for first in 1..places {
            let cost = self.cost(left, first) + self.cost(right, places - first);
            if cost < best.1 {
                best = (first, cost);
            }
        }
        best
    }

    fn cost(&self, node: u32, places: usize) -> f32 {
        match self.places[node as usize] {
            BLOCK => self.area(node) * BLOCK_COST,
            place => self.costs[place as usize][places - 1],
        }
    }

    fn area(&self, node: u32) -> f32 {
        self.binary[node as usize].aabb().half_area()
    }
}
