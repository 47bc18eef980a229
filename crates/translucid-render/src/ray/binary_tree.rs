//! Binary trees over boxes, in a time that hardly grows faster than their number, wherever they lie.
//!
//! `obvhs` brings boxes into Morton order and merges those that are each other's best neighbors, pass by pass (PLOC: D.
//! Meister & J. Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction", 2018).
//! Where merging costs as much or more from neighbor to neighbor all along a row of boxes, because they coincide, are evenly
//! spaced or contain each other, only two in it are: a pass over all boxes merges one pair.
//! So long rows are found first, and each is halved again and again along the order; `obvhs` takes it for one box.

use std::mem::take;
use std::ops::Range;

use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::morton::morton_encode_u64_unorm;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Boxes that may lie in a row: as many passes cost little.
const LONGEST: usize = 256;

/// Makes binary trees, with memory that is used again.
pub(crate) struct BinaryBuilder {
    builder: PlocBuilder,
    optimizer: ReinsertionOptimizer,
    tree: Bvh2,
}

impl Default for BinaryBuilder {
    fn default() -> Self {
        let (optimizer, tree) = (ReinsertionOptimizer::default(), Bvh2::default());
        Self { builder: PlocBuilder::new(), optimizer, tree }
    }
}

impl BinaryBuilder {
    /// The tree over the boxes made last, of one box a leaf.
    pub(crate) fn tree(&self) -> &Bvh2 {
        &self.tree
    }

    /// Its nodes, and the numbers of the boxes in the order of the leaves.
    pub(crate) fn into_parts(self) -> (Vec<Bvh2Node>, Vec<u32>) {
        (self.tree.nodes, self.tree.primitive_indices)
    }

    /// Makes a good tree over boxes, which does not depend on the number of threads.
    pub(crate) fn build(&mut self, boxes: &[Aabb]) {
        match Rows::new(boxes) {
            None => self.cluster(boxes),
            Some(rows) => {
                self.cluster(&rows.boxes);
                self.expand(&rows, boxes);
            }
        }
    }

    fn cluster(&mut self, boxes: &[Aabb]) {
        let Self { builder, optimizer, tree } = self;
        let mut indices = take(&mut tree.primitive_indices);
        indices.clear();
        indices.extend(0..boxes.len() as u32);
        builder.build_with_bvh(tree, PlocSearchDistance::Medium, boxes, indices, SortPrecision::U64, 3);
        // A tenth of obvhs' medium preset was measured to trace as fast on scanned meshes.
        optimizer.run(tree, 0.02, None);
    }

    /// Puts a balanced tree over its boxes in the place of each row.
    fn expand(&mut self, rows: &Rows, boxes: &[Aabb]) {
        let numbers = take(&mut self.tree.primitive_indices);
        let nodes = &mut self.tree.nodes;
        let first = nodes.len();
        let mut open: Vec<(usize, Range<usize>)> = (0..first)
            .filter(|&node| nodes[node].is_leaf())
            .map(|node| (node, rows.range(numbers[nodes[node].first_index as usize] as usize)))
            .collect();
        while let Some((node, range)) = open.pop() {
            if range.len() == 1 {
                let thing = rows.order[range.start] as usize;
                nodes[node] = Bvh2Node::new(boxes[thing], 1, range.start as u32);
                continue;
            }
            let (below, middle) = (nodes.len(), range.start + range.len() / 2);
            nodes[node] = Bvh2Node::new(*nodes[node].aabb(), 0, below as u32);
            nodes.extend([Bvh2Node::default(); 2]);
            open.extend([(below, range.start..middle), (below + 1, middle..range.end)]);
        }
        // Those below come after
        for node in (first..nodes.len()).rev().filter(|&node| !nodes[node].is_leaf()).collect::<Vec<_>>() {
            let below = nodes[node].first_index as usize;
            let both = nodes[below].aabb().union(nodes[below + 1].aabb());
            nodes[node].set_aabb(both);
        }
        self.tree.primitive_indices.clone_from(&rows.order);
    }
}

/// Boxes in Morton order, and its parts: long rows, and single boxes.
struct Rows {
    /// Numbers of the boxes.
    order: Vec<u32>,
    /// Where each part begins in the order.
    starts: Vec<u32>,
    /// The box around each part.
    boxes: Vec<Aabb>,
}

impl Rows {
    /// None where no row is long.
    fn new(boxes: &[Aabb]) -> Option<Self> {
        if boxes.len() <= LONGEST {
            return None;
        }
        let order = morton_order(boxes);
        // Neighbors in the order, after each of the first passes
        let mut clusters: Vec<(Aabb, u32)> =
            order.iter().zip(0..).map(|(&thing, start)| (boxes[thing as usize], start)).collect();
        let mut rows: Vec<Range<u32>> = Vec::new();
        while clusters.len() > LONGEST {
            clusters = merged(&clusters, order.len() as u32, &mut rows);
        }
        if rows.is_empty() {
            return None;
        }
        // A row may have become a part of another
        rows.sort_by_key(|row| (row.start, u32::MAX - row.end));
        let mut starts = Vec::new();
        let mut end = 0;
        for row in rows.into_iter().chain(std::iter::once(order.len() as u32..u32::MAX)) {
            if row.start >= end {
                starts.extend(end..row.start);
                starts.push(row.start);
                end = row.end;
            }
        }
        starts.pop();
        let mut new = Self { order, starts, boxes: Vec::new() };
        let around = |part: usize| {
            let things = new.order[new.range(part)].iter();
            things.fold(Aabb::empty(), |sum, &thing| sum.union(&boxes[thing as usize]))
        };
        new.boxes = (0..new.starts.len()).map(around).collect();
        Some(new)
    }

    /// A part's place in the order.
    fn range(&self, part: usize) -> Range<usize> {
        let end = self.starts.get(part + 1).map_or(self.order.len(), |&end| end as usize);
        self.starts[part] as usize..end
    }
}

/// Numbers of boxes along a Morton curve through their centers; those with the same center by size.
fn morton_order(boxes: &[Aabb]) -> Vec<u32> {
    let all = boxes.iter().fold(Aabb::empty(), |all, aabb| all.union(aabb));
    let scale = 1.0 / all.diagonal().as_dvec3().max(DVec3::splat(f64::MIN_POSITIVE));
    let low = all.min.as_dvec3();
    let key = |(aabb, number): (&Aabb, u32)| {
        let center = 0.5 * (aabb.min.as_dvec3() + aabb.max.as_dvec3());
        (morton_encode_u64_unorm((center - low) * scale), aabb.half_area().to_bits(), number)
    };
    let mut keys: Vec<(u64, u32, u32)> = boxes.iter().zip(0..).map(key).collect();
    keys.sort_unstable();
    keys.into_iter().map(|(.., number)| number).collect()
}

/// Clusters after a pass, in which each is merged with the next if each is the other's better neighbor; the long rows of
/// others become one each.
fn merged(clusters: &[(Aabb, u32)], end: u32, rows: &mut Vec<Range<u32>>) -> Vec<(Aabb, u32)> {
    let start_of = |index: usize| clusters.get(index).map_or(end, |&(_, start)| start);
    let cost = |index: usize| match clusters.get(index..index + 2) {
        Some([(one, _), (other, _)]) => one.union(other).half_area(),
        _ => f32::INFINITY,
    };
    let mut after: Vec<(Aabb, u32)> = Vec::with_capacity(clusters.len());
    // Clusters up to here are in `after`, and those up to `index` are alone
    let mut done = 0;
    let mut alone = |range: Range<usize>, after: &mut Vec<(Aabb, u32)>| {
        if range.len() > LONGEST {
            rows.push(start_of(range.start)..start_of(range.end));
            let around = clusters[range.clone()].iter().fold(Aabb::empty(), |sum, (aabb, _)| sum.union(aabb));
            after.push((around, start_of(range.start)));
        } else {
            after.extend_from_slice(&clusters[range]);
        }
    };
    let (mut last, mut this, mut index) = (f32::INFINITY, cost(0), 0);
    while index + 1 < clusters.len() {
        let next = cost(index + 1);
        let is_pair = index >= done && last >= this && this < next;
        if is_pair {
            alone(done..index, &mut after);
            after.push((clusters[index].0.union(&clusters[index + 1].0), clusters[index].1));
            done = index + 2;
        }
        (last, this, index) = (this, next, index + 1);
    }
    alone(done..clusters.len(), &mut after);
    after
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use glam::Vec3A;

    use super::*;

    /// Builds the tree over boxes, of which each leaf has one, once, inside the boxes above it; returns its depth and the
    /// seconds that it took.
    fn built(boxes: &[Aabb]) -> (usize, f64) {
        let mut builder = BinaryBuilder::default();
        let start = Instant::now();
        builder.build(boxes);
        let seconds = start.elapsed().as_secs_f64();
        let Bvh2 { nodes, primitive_indices, .. } = builder.tree();
        let (mut deepest, mut found, mut open) = (0, vec![0; boxes.len()], vec![(0, 1)]);
        while let Some((index, depth)) = open.pop() {
            let node: &Bvh2Node = &nodes[index as usize];
            deepest = deepest.max(depth);
            let is_around = |inner: &Aabb| {
                let outer = node.aabb();
                assert!(outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all());
            };
            if node.is_leaf() {
                let thing = primitive_indices[node.first_index as usize] as usize;
                is_around(&boxes[thing]);
                found[thing] += 1;
            } else {
                for below in [node.first_index, node.first_index + 1] {
                    is_around(nodes[below as usize].aabb());
                    open.push((below, depth + 1));
                }
            }
        }
        assert_eq!(nodes.len(), 2 * boxes.len() - 1);
        assert!(found.iter().all(|&count| count == 1));
        (deepest, seconds)
    }

    fn random(number: u32, salt: u32) -> f32 {
        sobol_burley::sample(number & 0xffff, salt, number >> 16)
    }

    /// A box from its corner on.
    fn sized(corner: [f32; 3], size: [f32; 3]) -> Aabb {
        let corner = Vec3A::from_array(corner);
        Aabb::new(corner, corner + Vec3A::from_array(size))
    }

    /// A box for each number.
    type Kind = fn(u32) -> Aabb;

    /// Times and depths of trees that pairs alone would make in quadratic time.
    #[test]
    fn rows_of_boxes_are_quick() {
        const COUNT: u32 = 60_000;
        let kinds: [(&str, Kind); 9] = [
            ("one place", |_| sized([0.0; 3], [1.0, 1.0, 0.0])),
            ("points of one place", |_| sized([3.0; 3], [0.0; 3])),
            ("two sizes", |i| sized([if i % 2 == 0 { 0.0 } else { -1.0 }; 3], [(1 + i % 2 * 2) as f32; 3])),
            ("four in turn", |i| sized([-((i / 2 % 4) as f32); 3], [(1 + i / 2 % 4 * 2) as f32; 3])),
            ("evenly spaced", |i| sized([i as f32, 0.0, 0.0], [1.0, 1.0, 0.0])),
            ("pairs, evenly spaced", |i| sized([(i / 2) as f32, 0.0, 0.0], [1.0, 1.0, 0.0])),
            ("nested", |i| sized([0.0; 3], [1.0 + i as f32, 1.0, 0.0])),
            ("nested around a center", |i| sized([-1.0 - i as f32; 3], [2.0 * (1.0 + i as f32); 3])),
            ("a line", |i| sized([random(i, 0), 0.0, 0.0], [0.0; 3])),
        ];
        for (name, kind) in kinds {
            // And among others
            let scattered = |i: u32| sized([random(i, 1), random(i, 2), random(i, 3)], [0.01; 3]);
            let boxes: Vec<Aabb> = (0..COUNT).map(kind).chain((0..5000).map(scattered)).collect();
            let (depth, seconds) = built(&boxes);
            assert!(seconds < 3.0 && depth < 400, "{name}: {depth} deep, {seconds} s");
        }
    }

    #[test]
    fn scattered_boxes_have_no_rows() {
        let boxes: Vec<Aabb> = (0..100_000)
            .map(|i| {
                sized([random(i, 1), random(i, 2), random(i, 3)], [4, 5, 6].map(|j| 0.01 * random(i, j)))
            })
            .collect();
        assert!(Rows::new(&boxes).is_none());
        built(&boxes);
    }

    #[test]
    fn few_boxes_have_a_tree() {
        for count in [1, 2, 3, 256, 257, 258, 300] {
            built(&vec![sized([1.0; 3], [1.0; 3]); count]);
        }
    }
}
