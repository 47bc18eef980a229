//! From a binary tree to wide nodes and blocks of triangles.

use obvhs::bvh2::Bvh2;

use super::Source;
use super::collapse::Costs;
use super::node::{LEAF, Node};
use crate::triangle::TriangleBlock;

/// Turns the binary tree into wide nodes and blocks.
pub(super) struct Gather<'a, T> {
    binary: &'a Bvh2,
    primitives: &'a [T],
    costs: Costs<'a>,
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<TriangleBlock>,
    /// Most children that a ray has yet to visit at any time.
    pub(super) most_waiting: usize,
}

impl<'a, T: Source> Gather<'a, T> {
    pub(super) fn new(binary: &'a Bvh2, primitives: &'a [T]) -> Self {
        let costs = Costs::new(&binary.nodes);
        Self { binary, primitives, costs, nodes: Vec::new(), blocks: Vec::new(), most_waiting: 0 }
    }

    /// Works with a list of its own instead of recursion: degenerate trees are deep.
    pub(super) fn run(&mut self) {
        self.nodes.push(Node::EMPTY);
        let mut open = vec![(0_u32, 0_u32, 0)];
        while let Some((source, target, waiting)) = open.pop() {
            let mut node = Node::EMPTY;
            let children = self.costs.children(source);
            // All but the one that is visited first.
            let waiting = waiting + children.len() - 1;
            self.most_waiting = self.most_waiting.max(waiting);
            for (lane, &child) in children.iter().enumerate() {
                let bounds = self.binary.nodes[child as usize].aabb();
                for axis in 0..3 {
                    node.bounds[axis][lane] = bounds.min[axis];
                    node.bounds[axis + 3][lane] = bounds.max[axis];
                }
                node.children[lane] = if self.costs.is_block(child) {
                    LEAF | self.add_block(child)
                } else {
                    let index = self.nodes.len() as u32;
                    self.nodes.push(Node::EMPTY);
                    open.push((child, index, waiting));
                    index
                };
            }
            self.nodes[target as usize] = node;
        }
    }

    /// Collects the triangles below a node.
    fn add_block(&mut self, root: u32) -> u32 {
        let mut block = TriangleBlock::default();
        let mut lane = 0;
        let mut open = vec![root];
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index as usize];
            if node.is_leaf() {
                for slot in node.first_index..node.first_index + node.prim_count {
                    let primitive = self.binary.primitive_indices[slot as usize];
                    block.set(lane, &self.primitives[primitive as usize].primitive());
                    lane += 1;
                }
            } else {
                open.extend(self.costs.below(index));
            }
        }
        self.blocks.push(block);
        self.blocks.len() as u32 - 1
    }
}
