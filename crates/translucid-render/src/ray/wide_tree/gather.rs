//! From a binary tree to wide nodes and blocks.

use obvhs::bvh2::Bvh2;

use super::Block;
use super::collapse::Costs;
use super::lines::Lines;
use super::node::{LEAF, Node};
use crate::ray::primitive::PrimitiveSource;

/// Turns the binary tree into wide nodes and blocks.
pub(super) struct Gather<'a, T: PrimitiveSource> {
    binary: &'a Bvh2,
    primitives: &'a [T],
    costs: Costs<'a>,
    pub(super) lines: Lines<T::Block>,
    /// Most children that a ray has yet to visit at any time.
    pub(super) most_waiting: usize,
}

impl<'a, T: PrimitiveSource> Gather<'a, T> {
    pub(super) fn new(binary: &'a Bvh2, primitives: &'a [T]) -> Self {
        let costs = Costs::new(&binary.nodes, T::Block::LANES);
        Self { binary, primitives, costs, lines: Lines::default(), most_waiting: 0 }
    }

    /// Lays out each node, its blocks, and then what is below each of its other children, one after the other.
    ///
    /// Works with a list of its own instead of recursion: degenerate trees are deep.
    pub(super) fn run(&mut self) {
        let mut open = vec![Open { source: 0, parent: None, waiting: 0 }];
        while let Some(Open { source, parent, waiting }) = open.pop() {
            let mut node = Node::EMPTY;
            let children = self.costs.children(source);
            // All but the one that is visited first.
            let waiting = waiting + children.len() - 1;
            self.most_waiting = self.most_waiting.max(waiting);
            let line = self.lines.push_node(&node);
            for (lane, &child) in children.iter().enumerate() {
                let bounds = self.binary.nodes[child as usize].aabb();
                for axis in 0..3 {
                    node.bounds[axis][lane] = bounds.min[axis];
                    node.bounds[axis + 3][lane] = bounds.max[axis];
                }
                if self.costs.is_block(child) {
                    node.children[lane] = LEAF | self.add_block(child);
                }
            }
            *self.lines.node_mut(line) = node;
            if let Some((parent, lane)) = parent {
                self.lines.node_mut(parent).children[lane] = line;
            }
            for (lane, &child) in children.iter().enumerate().rev() {
                if !self.costs.is_block(child) {
                    open.push(Open { source: child, parent: Some((line, lane)), waiting });
                }
            }
        }
    }

    /// Collects what is below a node.
    fn add_block(&mut self, root: u32) -> u32 {
        let mut block = T::Block::default();
        let mut lane = 0;
        let mut open = vec![root];
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index as usize];
            if node.is_leaf() {
                for slot in node.first_index..node.first_index + node.prim_count {
                    let primitive = self.binary.primitive_indices[slot as usize];
                    self.primitives[primitive as usize].put(&mut block, lane);
                    lane += 1;
                }
            } else {
                open.extend(self.costs.below(index));
            }
        }
        self.lines.push_block(&block)
    }
}

/// A binary node that has yet to become a wide one.
struct Open {
    source: u32,
    /// Line and lane of the node that it is a child of.
    parent: Option<(u32, usize)>,
    /// Children that wait where a ray comes to this one.
    waiting: usize,
}
