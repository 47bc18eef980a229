//! An eight-wide bounding volume hierarchy over blocks: up to eight triangles, or one instance of a mesh.
//!
//! A good binary tree is built first (`binary_tree`); eight neighbors of it are gathered into one
//! node, whose boxes are tested together, and as many things as there is room for into a block. Many things are built chunk
//! by chunk, with one more tree over the chunks' trees.
//! Rounding never hides a hit: boxes have a margin, far distances of the box test are widened, and the
//! triangle test is watertight.

mod chunks;
mod collapse;
mod gather;
mod lines;
mod node;
mod traversal;

use std::collections::BTreeMap;
use std::mem::take;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

pub(crate) use chunks::MOST as AT_ONCE;
use chunks::chunks;
use gather::NodeGatherer;
use glam::Vec3;
use lines::Lines;
use node::{EMPTY, LEAF};
use obvhs::aabb::Aabb;
use rayon::prelude::*;
pub(super) use traversal::Visitor;

use super::binary_tree::BinaryBuilder;
use super::primitive::{Block, Primitive, PrimitiveSource};
use super::simd::SimdToken;
use super::triangle::{BlockRay, Ray, TriangleBlock, TriangleHit};

/// The tree over a scene's triangles, or over other blocks.
#[derive(Debug, PartialEq)]
pub(crate) struct WideTree<B = TriangleBlock> {
    lines: Lines<B>,
    /// Numbers that things have outside, block by block.
    numbers: Vec<u32>,
    /// Most children that a ray has yet to visit at any time.
    most_waiting: usize,
    bounds: (Vec3, Vec3),
    avx2: bool,
}

impl<B: Block> WideTree<B> {
    /// Builds the tree; the result does not depend on the number of threads.
    pub(crate) fn new(primitives: &[impl PrimitiveSource<Block = B>]) -> Self {
        let avx2 = avx2_is_available();
        if primitives.is_empty() {
            let bounds = (Vec3::ZERO, Vec3::ZERO);
            return Self { lines: Lines::default(), numbers: Vec::new(), most_waiting: 0, bounds, avx2 };
        }
        let mut order: Vec<u32> = (0..primitives.len() as u32).collect();
        let chunks = chunks(&mut order, &|thing| primitives[thing as usize].place());
        let Subtree { lines, numbers, most_waiting, bounds } = match &chunks[..] {
            [_] => {
                let mut workshop = ChunkBuilder::default();
                workshop.build(primitives, &order, 0);
                workshop.part
            }
            chunks => join(primitives, &order, chunks),
        };
        Self { lines, numbers, most_waiting, bounds: (bounds.min.into(), bounds.max.into()), avx2 }
    }

    /// Corners of the box around everything.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// Size of nodes and blocks in bytes.
    pub(crate) fn memory(&self) -> usize {
        self.lines.size() + size_of_val(&*self.numbers)
    }

    /// The block that the number of a leaf belongs to, and its lane.
    #[inline]
    pub(crate) fn leaf(&self, leaf: u32) -> (&B, usize) {
        self.lines.block_of(leaf)
    }

    /// Calls `found` for every block, with the number of its first lane.
    pub(crate) fn for_each_block(&self, mut found: impl FnMut(u32, &B)) {
        let mut open = if self.lines.is_empty() { Vec::new() } else { vec![0] };
        while let Some(word) = open.pop() {
            for child in self.lines.node(word).children {
                if child & LEAF == 0 {
                    open.push(word + child);
                } else if child != EMPTY {
                    let word = word + (child & !LEAF);
                    found(Lines::<B>::lane(word), self.lines.block(word));
                }
            }
        }
    }
}

impl WideTree {
    /// The nearest hit along a ray with the number of its leaf.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray) -> Option<(TriangleHit, u32)> {
        self.nearest(ray, |_| true)
    }

    /// The nearest hit along a ray with a subsurface group, with the number of its leaf.
    #[inline]
    pub(crate) fn closest_in_group(&self, ray: &Ray, group: u32) -> Option<(TriangleHit, u32)> {
        self.nearest(ray, move |block| block.group() == group)
    }

    /// The triangle that the number of a leaf belongs to.
    #[inline]
    pub(crate) fn triangle(&self, leaf: u32) -> Primitive {
        let (block, lane) = self.leaf(leaf);
        block.get(lane, &self.numbers)
    }

    #[inline(always)]
    fn nearest(&self, ray: &Ray, counts: impl Fn(&TriangleBlock) -> bool) -> Option<(TriangleHit, u32)> {
        let mut nearest = NearestVisitor { counts, hit: None };
        self.traverse(ray, &mut nearest);
        nearest.hit
    }

    /// Returns `true` if anything lies on a segment.
    #[inline]
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        self.traverse(ray, &mut AnyVisitor)
    }

    /// Calls `found` for every hit of a segment, in the tree's order.
    #[inline]
    pub(crate) fn all(&self, ray: &Ray, found: impl FnMut(TriangleHit, u32)) {
        self.traverse(ray, &mut EveryVisitor { found });
    }
}

/// A tree over some of the things.
struct Subtree<B> {
    lines: Lines<B>,
    numbers: Vec<u32>,
    most_waiting: usize,
    bounds: Aabb,
}

impl<B: Block> Default for Subtree<B> {
    fn default() -> Self {
        Self { lines: Lines::default(), numbers: Vec::new(), most_waiting: 0, bounds: Aabb::empty() }
    }
}

/// Memory for building the tree over a chunk, used again by the next chunk.
struct ChunkBuilder<B> {
    boxes: Vec<Aabb>,
    binary: BinaryBuilder,
    part: Subtree<B>,
}

impl<B: Block> Default for ChunkBuilder<B> {
    fn default() -> Self {
        Self { boxes: Vec::new(), binary: BinaryBuilder::default(), part: Subtree::default() }
    }
}

impl<B: Block> ChunkBuilder<B> {
    /// Builds the tree over a chunk, before whose numbers there are `first` of others.
    fn build<T: PrimitiveSource<Block = B>>(&mut self, primitives: &[T], chunk: &[u32], first: u32) {
        let thing = |index: u32| &primitives[chunk[index as usize] as usize];
        self.boxes.clear();
        self.boxes.extend(chunk.iter().map(|&number| primitives[number as usize].aabb()));
        self.binary.build(&self.boxes);
        let binary = self.binary.tree();
        let mut numbers = take(&mut self.part.numbers);
        let mut gather = NodeGatherer::new(binary, |index| thing(index).needs(), take(&mut self.part.lines));
        gather.run(|lines, word, things| {
            let mut block = B::default();
            block.set_first(first + numbers.len() as u32);
            let put = |(lane, &index): (usize, &u32)| thing(index).put(&mut block, lane);
            numbers.extend(things.iter().enumerate().map(put));
            LEAF | (lines.push_block(&block) - word)
        });
        let (lines, most_waiting) = (gather.lines, gather.most_waiting);
        self.part = Subtree { lines, numbers, most_waiting, bounds: *binary.nodes[0].aabb() };
    }
}

/// Builds a tree for each chunk of the things in this order, and one more that leads to them.
fn join<T: PrimitiveSource>(primitives: &[T], order: &[u32], chunks: &[Range<usize>]) -> Subtree<T::Block> {
    let joined = Mutex::new(JoinedTree::new(chunks.len(), order.len()));
    let workshops = Mutex::new(Vec::new());
    // One after the other: few trees have to wait for their turn.
    chunks.iter().enumerate().par_bridge().for_each(|(number, chunk)| {
        let free = locked(&workshops).pop();
        let mut workshop: ChunkBuilder<T::Block> = free.unwrap_or_default();
        workshop.build(primitives, &order[chunk.clone()], chunk.start as u32);
        locked(&joined).add(number, &mut workshop.part);
        locked(&workshops).push(workshop);
    });
    joined.into_inner().unwrap_or_else(PoisonError::into_inner).finish()
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The trees of chunks, one after the other, behind the room for the tree that leads to them.
struct JoinedTree<B> {
    part: Subtree<B>,
    /// Number of all things.
    things: usize,
    /// Words at which the trees begin, and the boxes around them.
    starts: Vec<u32>,
    boxes: Vec<Aabb>,
    /// Trees that have come before their turn.
    early: BTreeMap<usize, Subtree<B>>,
}

impl<B: Block> JoinedTree<B> {
    fn new(chunks: usize, things: usize) -> Self {
        // Every node leads to two others or more.
        let lines = Lines::of_empty_nodes(chunks - 1);
        let part = Subtree { lines, numbers: Vec::with_capacity(things), ..Subtree::default() };
        Self { part, things, starts: Vec::new(), boxes: Vec::new(), early: BTreeMap::new() }
    }

    /// Adds the tree of a chunk.
    fn add(&mut self, number: usize, part: &mut Subtree<B>) {
        if number != self.starts.len() {
            self.early.insert(number, take(part));
            return;
        }
        self.append(part);
        while let Some(mut part) = self.early.remove(&self.starts.len()) {
            self.append(&mut part);
        }
    }

    fn append(&mut self, part: &mut Subtree<B>) {
        let all = &mut self.part;
        all.numbers.append(&mut part.numbers);
        // A little more than the trees so far suggest
        all.lines.reserve_for(&part.lines, 1.06 * self.things as f64 / all.numbers.len() as f64);
        self.starts.push(all.lines.end());
        self.boxes.push(part.bounds);
        all.lines.append(&part.lines);
        all.most_waiting = all.most_waiting.max(part.most_waiting);
        part.lines.clear();
    }

    fn finish(mut self) -> Subtree<B> {
        let mut builder = BinaryBuilder::default();
        builder.build(&self.boxes);
        let binary = builder.tree();
        let mut gather = NodeGatherer::<B>::new(binary, |_| None, Lines::default());
        // A part's number stands for its node until that is known.
        gather.run(|_, _, part| LEAF | part[0]);
        let NodeGatherer { lines: mut top, most_waiting, .. } = gather;
        top.for_each_node(|word, node| {
            for child in node.children.iter_mut().filter(|child| **child != EMPTY && **child & LEAF != 0) {
                *child = self.starts[(*child & !LEAF) as usize] - word;
            }
        });
        self.part.lines.replace_first(&top);
        self.part.most_waiting += most_waiting;
        self.part.bounds = *binary.nodes[0].aabb();
        self.part
    }
}

/// Finds the nearest hit.
struct NearestVisitor<F> {
    /// Returns `true` if the triangles of a block count.
    counts: F,
    hit: Option<(TriangleHit, u32)>,
}

impl<F: Fn(&TriangleBlock) -> bool> Visitor<TriangleBlock> for NearestVisitor<F> {
    const IS_ORDERED: bool = true;

    #[inline(always)]
    fn visit(
        &mut self,
        vectors: impl SimdToken,
        ray: &mut BlockRay,
        block: &TriangleBlock,
        first: u32,
    ) -> bool {
        if !(self.counts)(block) {
            return false;
        }
        if let Some((hit, lane)) = block.closest(vectors, ray) {
            ray.t_max = hit.t;
            self.hit = Some((hit, first + lane as u32));
        }
        false
    }
}

/// Stops at any hit.
struct AnyVisitor;

impl Visitor<TriangleBlock> for AnyVisitor {
    const IS_ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, vectors: impl SimdToken, ray: &mut BlockRay, block: &TriangleBlock, _: u32) -> bool {
        block.is_hit(vectors, ray)
    }
}

/// Reports every hit.
struct EveryVisitor<F> {
    found: F,
}

impl<F: FnMut(TriangleHit, u32)> Visitor<TriangleBlock> for EveryVisitor<F> {
    const IS_ORDERED: bool = false;

    #[inline(always)]
    fn visit(
        &mut self,
        vectors: impl SimdToken,
        ray: &mut BlockRay,
        block: &TriangleBlock,
        first: u32,
    ) -> bool {
        block.all(vectors, ray, |hit, lane| (self.found)(hit, first + lane as u32));
        false
    }
}

fn avx2_is_available() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        std::arch::is_x86_feature_detected!("avx2")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::primitive::BlockNeeds;

    impl PrimitiveSource for Primitive {
        type Block = TriangleBlock;

        fn needs(&self) -> Option<BlockNeeds> {
            let factors = [0x9e37_79b9, 0x85eb_ca6b, 0xc2b2_ae35];
            let mix =
                |sum: u32, (x, factor): (f32, u32)| sum.rotate_left(7) ^ x.to_bits().wrapping_mul(factor);
            let corner = |vertex: Vec3| vertex.to_array().into_iter().zip(factors).fold(0, mix);
            Some(BlockNeeds::triangle(self.object, self.vertices.map(corner)))
        }

        fn place(&self) -> Vec3 {
            self.vertices[0]
        }

        fn put(&self, block: &mut TriangleBlock, lane: usize) -> u32 {
            block.set(lane, self);
            self.triangle
        }
    }

    /// Random triangles in the unit cube.
    fn soup(count: u32) -> Vec<Primitive> {
        let random = |i: u32, salt: u32| sobol_burley::sample(i, salt, 3);
        let triangle = |i: u32| {
            let center = Vec3::new(random(i, 0), random(i, 1), random(i, 2));
            let vertex = |corner: u32| {
                let at = |axis: u32| random(i, 3 + 3 * corner + axis) - 0.5;
                center + 0.1 * Vec3::new(at(0), at(1), at(2))
            };
            Primitive { vertices: [0, 1, 2].map(vertex), object: i % 3, triangle: i, group: i % 3 }
        };
        (0..count).map(triangle).collect()
    }

    fn random_ray(i: u32) -> Ray {
        let random = |salt: u32| sobol_burley::sample(i, salt, 11);
        let target = Vec3::new(random(0), random(1), random(2));
        let origin = Vec3::new(random(3), random(4), random(5)) * 4.0 - 1.5;
        // Some run along an axis, where a slab's distances are huge.
        let direction =
            if i.is_multiple_of(5) { Vec3::AXES[i as usize % 3] } else { (target - origin).normalize() };
        Ray::segment(origin, direction, 0.5 + 4.0 * random(6))
    }

    /// Whatever the processor, the same hits in the same order, to the last bit.
    #[test]
    fn portable_traversal_finds_the_same() {
        let tree = WideTree::new(&soup(2000));
        let portable = WideTree { avx2: false, ..WideTree::new(&soup(2000)) };
        let bits = |(hit, leaf): (TriangleHit, u32)| ([hit.t, hit.b1, hit.b2].map(f32::to_bits), leaf);
        let mut hits = 0;
        for ray in (0..2000).map(random_ray) {
            let all = |tree: &WideTree| {
                let mut found = Vec::new();
                tree.all(&ray, |hit, leaf| found.push(bits((hit, leaf))));
                found
            };
            assert_eq!(all(&tree), all(&portable));
            assert_eq!(tree.closest(&ray).map(bits), portable.closest(&ray).map(bits));
            assert_eq!(
                tree.closest_in_group(&ray, 1).map(bits),
                portable.closest_in_group(&ray, 1).map(bits)
            );
            assert_eq!(tree.occluded(&ray), portable.occluded(&ray));
            hits += all(&tree).len();
        }
        assert!(hits > 1000, "the test meets too few triangles: {hits}");
    }

    /// Objects each a little larger than the one before make a tree as deep as they are many, up to some number.
    #[test]
    fn deep_trees_are_traversed_to_the_end() {
        let vertices = |i: u32| {
            let size = 1.04_f32.powi(i as i32);
            [Vec3::new(size, 0.0, 0.0), Vec3::new(size, size, 0.0), Vec3::new(size, 0.0, size)]
        };
        let primitives: Vec<_> =
            (0..250).map(|i| Primitive { vertices: vertices(i), object: i, triangle: i, group: 0 }).collect();
        let tree = WideTree::new(&primitives);
        assert!(tree.most_waiting > traversal::STACK, "{} children wait", tree.most_waiting);
        for tree in [WideTree { avx2: false, ..WideTree::new(&primitives) }, tree] {
            let ray = Ray::new(Vec3::new(0.0, 0.1, 0.1), Vec3::X);
            let mut count = 0;
            tree.all(&ray, |_, _| count += 1);
            assert_eq!(count, 250);
            assert_eq!(tree.closest(&ray).map(|(hit, _)| hit.t), Some(1.0));
        }
    }

    /// A mesh as a scanner makes them, at a tenth of the largest that the bench `huge_mesh` renders.
    #[test]
    fn large_meshes_take_less_than_sixty_bytes_a_triangle_and_keep_all() {
        let side = 710_u32;
        let vertex = |x: u32, y: u32| {
            let (u, v) = (x as f32 / side as f32, y as f32 / side as f32);
            Vec3::new(u, v, 0.05 * (9.0 * u).sin() * (7.0 * v).cos())
        };
        let mut primitives = Vec::new();
        for (x, y) in (0..side).flat_map(|x| (0..side).map(move |y| (x, y))) {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(dx, dy)| vertex(x + dx, y + dy));
            for vertices in [[a, b, c], [a, c, d]] {
                let triangle = primitives.len() as u32;
                primitives.push(Primitive { vertices, object: 0, triangle, group: 0 });
            }
        }
        assert!(primitives.len() > 1_000_000);
        let tree = WideTree::new(&primitives);
        let bytes = tree.memory() as f64 / primitives.len() as f64;
        assert!(bytes < 60.0, "{bytes} bytes a triangle");
        assert!(tree.most_waiting <= traversal::STACK, "{} children wait", tree.most_waiting);
        let mut numbers = tree.numbers.clone();
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..primitives.len() as u32), "each triangle is there once");
        for i in 0..2000 {
            let [u, v] = [0, 1].map(|salt| sobol_burley::sample(i, salt, 5));
            let mut hits = 0;
            tree.all(&Ray::new(Vec3::new(u, v, 1.0), Vec3::NEG_Z), |_, _| hits += 1);
            assert_eq!(hits, 1, "from above {u} {v}");
        }
    }
}
