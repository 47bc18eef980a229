//! From a binary tree to wide nodes and blocks.

use obvhs::bvh2::Bvh2;

use super::Block;
use super::collapse::Costs;
use super::lines::Lines;
use super::node::WideNode;
use crate::ray::primitive::BlockNeeds;

/// Turns a binary tree into wide nodes.
pub(super) struct NodeGatherer<'a, B> {
    binary: &'a Bvh2,
    costs: Costs<'a>,
    pub(super) lines: Lines<B>,
    /// Most children that a ray has yet to visit at any time.
    pub(super) most_waiting: usize,
}

impl<'a, B: Block> NodeGatherer<'a, B> {
    /// Gathers a tree's things, of which each fills a block but for those with `needs`, into empty lines.
    pub(super) fn new(binary: &'a Bvh2, needs: impl Fn(u32) -> Option<BlockNeeds>, lines: Lines<B>) -> Self {
        let costs = Costs::new(binary, needs, B::LANES);
        Self { binary, costs, lines, most_waiting: 0 }
    }

    /// Lays out each node: first its blocks, whose children `add` returns for the node's word and the things in a block, then
    /// the subtrees below its other children, one after the other.
    ///
    /// Works with a list of its own instead of recursion: degenerate trees are deep.
    pub(super) fn run(&mut self, mut add: impl FnMut(&mut Lines<B>, u32, &[u32]) -> u32) {
        let (mut things, mut below) = (Vec::new(), Vec::new());
        let (mut children, mut places) = (Vec::new(), Vec::new());
        let mut open = vec![OpenNode { source: 0, parent: None, waiting: 0 }];
        while let Some(OpenNode { source, parent, waiting }) = open.pop() {
            let mut node = WideNode::EMPTY;
            self.costs.children(source, &mut children, &mut places);
            // All but the one that is visited first.
            let waiting = waiting + children.len() - 1;
            self.most_waiting = self.most_waiting.max(waiting);
            let word = self.lines.push_node(&node);
            for (lane, &child) in children.iter().enumerate() {
                let bounds = self.binary.nodes[child as usize].aabb();
                for axis in 0..3 {
                    node.bounds[2 * axis][lane] = bounds.min[axis];
                    node.bounds[2 * axis + 1][lane] = bounds.max[axis];
                }
                if self.costs.is_block(child) {
                    self.collect(child, &mut things, &mut below);
                    node.children[lane] = add(&mut self.lines, word, &things);
                }
            }
            *self.lines.node_mut(word) = node;
            if let Some((parent, lane)) = parent {
                self.lines.node_mut(parent).children[lane] = word - parent;
            }
            for (lane, &child) in children.iter().enumerate().rev() {
                if !self.costs.is_block(child) {
                    open.push(OpenNode { source: child, parent: Some((word, lane)), waiting });
                }
            }
        }
    }

    /// Collects what is below a node; `open` is empty before and after.
    fn collect(&self, root: u32, things: &mut Vec<u32>, open: &mut Vec<u32>) {
        things.clear();
        open.push(root);
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index as usize];
            if node.is_leaf() {
                let slots = node.first_index..node.first_index + node.prim_count;
                things.extend(slots.map(|slot| self.binary.primitive_indices[slot as usize]));
            } else {
                open.extend(self.costs.below(index));
            }
        }
    }
}

/// A binary node that has yet to become a wide one.
struct OpenNode {
    source: u32,
    /// Word and lane of the node that it is a child of.
    parent: Option<(u32, usize)>,
    /// Children that wait where a ray comes to this one.
    waiting: usize,
}
