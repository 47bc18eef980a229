//! Binary trees over boxes, and those that a scene keeps while it is edited.

use std::sync::Arc;

use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use crate::ray::BinaryBuilder;

/// A binary tree over boxes, one a leaf.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Bvh2Node>,
    /// The numbers of the boxes in the order of the leaves.
    pub(super) order: Vec<u32>,
}

impl Tree {
    fn new(boxes: &[Aabb]) -> Self {
        let mut builder = BinaryBuilder::default();
        if !boxes.is_empty() {
            builder.build(boxes);
        }
        let (nodes, order) = builder.into_parts();
        Self { nodes, order }
    }

    /// Returns `true` if it is the tree over these boxes, which depends on nothing else.
    fn is_over(&self, boxes: &[Aabb]) -> bool {
        let mut leaves = self.nodes.iter().filter(|node| node.is_leaf());
        self.order.len() == boxes.len()
            && leaves.all(|leaf| *leaf.aabb() == boxes[self.order[leaf.first_index as usize] as usize])
    }

    /// Greatest number of nodes above a leaf.
    pub(super) fn height(&self) -> u32 {
        let mut highest = 0;
        let mut open = vec![(0, 0)];
        while let Some((node, above)) = open.pop() {
            highest = highest.max(above);
            if let Some(node) = self.nodes.get(node as usize).filter(|node| !node.is_leaf()) {
                open.extend([0, 1].map(|child| (node.first_index + child, above + 1)));
            }
        }
        highest
    }
}

/// The trees of a [`DeviceScene`](super::DeviceScene), from which the next one takes those whose boxes are the same.
#[derive(Debug, Default)]
pub struct DeviceTrees(Vec<Arc<Tree>>);

impl DeviceTrees {
    /// A tree over each list of boxes; these are kept in place of the others.
    pub(super) fn over(&mut self, all: &[Vec<Aabb>]) -> Vec<Arc<Tree>> {
        let tree = |boxes: &Vec<Aabb>| {
            let known = self.0.iter().find(|tree| tree.is_over(boxes));
            known.map_or_else(|| Arc::new(Tree::new(boxes)), Arc::clone)
        };
        let trees: Vec<_> = all.par_iter().map(tree).collect();
        self.0.clone_from(&trees);
        trees
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;

    #[test]
    fn trees_are_kept_while_their_boxes_are_the_same() {
        let boxes = |first: u16| {
            let corner = |i: u16| Vec3A::splat(f32::from(i * i));
            (first..first + 20).map(|i| Aabb::new(corner(i), corner(i + 1))).collect::<Vec<_>>()
        };
        let mut kept = DeviceTrees::default();
        let before = kept.over(&[boxes(0), boxes(1), Vec::new()]);
        let moved = [vec![boxes(0)[19]], boxes(0)[..19].to_vec()].concat();
        let after = kept.over(&[boxes(1), moved.clone(), boxes(2), Vec::new()]);
        assert!(Arc::ptr_eq(&after[0], &before[1]) && Arc::ptr_eq(&after[3], &before[2]));
        for (tree, boxes) in after[1..3].iter().zip([moved, boxes(2)]) {
            assert!(!before.iter().any(|old| Arc::ptr_eq(old, tree)) && tree.is_over(&boxes));
        }
        assert!(
            !Arc::ptr_eq(&kept.over(&[boxes(0)])[0], &before[0]),
            "what is not used any more is given up"
        );
    }
}
