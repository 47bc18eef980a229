//! An eight-wide bounding volume hierarchy with triangles in blocks of four.
//!
//! `obvhs` builds a binary tree (PLOC with reinsertion); eight neighbors of it are gathered into one
//! node, whose boxes are tested together, and up to four triangles into a block.
//! Rounding never hides a hit: boxes have a margin, far distances of the box test are widened, and the
//! triangle test is watertight.

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::{Boundable, bvh2::node::Bvh2Node};

use crate::triangle::{LANES, Ray, TriangleBlock, TriangleHit};

/// Children of a node.
const WIDTH: usize = 8;

/// Marks a child that is a triangle block.
const LEAF: u32 = 1 << 31;

/// Marks a child that is not there.
const EMPTY: u32 = u32::MAX;

/// Eight boxes with what is in them. An empty child's box is inside out, so no ray meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
struct Node {
    /// Lower x, y, z, then upper x, y, z.
    bounds: [[f32; WIDTH]; 6],
    /// Index of a node, or `LEAF` and the index of a block.
    children: [u32; WIDTH],
}

/// A child that a ray has yet to visit.
#[derive(Clone, Copy, Debug, Default)]
struct Visit {
    child: u32,
    /// Distance at which the ray enters its box.
    t: f32,
}

/// The tree over a scene's triangles.
#[derive(Debug, PartialEq)]
pub(crate) struct WideTree {
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
    bounds: (Vec3, Vec3),
    avx2: bool,
}

/// A triangle to be sorted into the tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Primitive {
    pub(crate) vertices: [Vec3; 3],
    pub(crate) object: u32,
    pub(crate) triangle: u32,
    pub(crate) group: u32,
}

impl Boundable for Primitive {
    fn aabb(&self) -> Aabb {
        let [a, b, c] = self.vertices.map(Vec3A::from);
        // The box test rounds: a little room keeps it from culling what the triangle test would hit.
        // It differs between triangles, since the builder takes quadratic time over equal boxes.
        let jitter = (self.triangle.wrapping_mul(0x9e37_79b9) >> 28) as f32;
        let room = a.abs().max(b.abs()).max(c.abs()).max_element() * (4.0 + jitter) * f32::EPSILON;
        Aabb::new(a.min(b).min(c) - room, a.max(b).max(c) + room)
    }
}

impl WideTree {
    /// Builds the tree; the result does not depend on the number of threads.
    pub(crate) fn new(primitives: &[Primitive]) -> Self {
        let avx2 = avx2_is_available();
        if primitives.is_empty() {
            return Self { nodes: Vec::new(), blocks: Vec::new(), bounds: (Vec3::ZERO, Vec3::ZERO), avx2 };
        }
        let mut binary = PlocBuilder::with_capacity(primitives.len()).build(
            PlocSearchDistance::Medium,
            primitives,
            (0..primitives.len() as u32).collect(),
            SortPrecision::U64,
            3,
        );
        // A tenth of obvhs' medium preset was measured to trace as fast on scanned meshes.
        ReinsertionOptimizer::default().run(&mut binary, 0.02, None);
        let root = binary.nodes[0].aabb;
        let mut gathered = Gather::new(&binary, primitives);
        gathered.run();
        let bounds = (root.min.into(), root.max.into());
        Self { nodes: gathered.nodes, blocks: gathered.blocks, bounds, avx2 }
    }

    /// Corners of the box around everything.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// The triangle block that a leaf number belongs to, and its lane.
    pub(crate) fn leaf(&self, leaf: u32) -> (&TriangleBlock, usize) {
        (&self.blocks[leaf as usize / LANES], leaf as usize % LANES)
    }

    /// The nearest hit along a ray with the number of its leaf.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray) -> Option<(TriangleHit, u32)> {
        let mut ray = *ray;
        let mut best = None;
        self.traverse(&mut ray, |ray, block, first| {
            if let Some((hit, lane)) = block.closest(ray) {
                ray.t_max = hit.t;
                best = Some((hit, first + lane as u32));
            }
            false
        });
        best
    }

    /// The nearest hit along a ray with a subsurface group, with the number of its leaf.
    #[inline]
    pub(crate) fn closest_in_group(&self, ray: &Ray, group: u32) -> Option<(TriangleHit, u32)> {
        let mut ray = *ray;
        let mut best = None;
        self.traverse(&mut ray, |ray, block, first| {
            if let Some((hit, lane)) = block.closest_in_group(ray, group) {
                ray.t_max = hit.t;
                best = Some((hit, first + lane as u32));
            }
            false
        });
        best
    }

    /// Whether anything lies on a segment.
    #[inline]
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        let mut ray = *ray;
        self.traverse(&mut ray, |ray, block, _| block.closest(ray).is_some())
    }

    /// Calls `found` for every hit of a segment, in the tree's order.
    #[inline]
    pub(crate) fn all(&self, ray: &Ray, mut found: impl FnMut(TriangleHit, u32)) {
        let mut ray = *ray;
        self.traverse(&mut ray, |ray, block, first| {
            block.all(ray, |hit, lane| found(hit, first + lane as u32));
            false
        });
    }

    /// Visits the blocks whose boxes a ray meets, nearest first, until `visit` returns true.
    #[inline(always)]
    fn traverse(&self, ray: &mut Ray, visit: impl FnMut(&mut Ray, &TriangleBlock, u32) -> bool) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is true only if the processor was found to have AVX2.
            return unsafe { self.traverse_avx2(ray, visit) };
        }
        self.traverse_with(ray, visit, slabs)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn traverse_avx2(&self, ray: &mut Ray, visit: impl FnMut(&mut Ray, &TriangleBlock, u32) -> bool) -> bool {
        self.traverse_with(ray, visit, |node, slab_ray, t_max| slabs_avx2(node, slab_ray, t_max))
    }

    #[inline(always)]
    fn traverse_with(
        &self,
        ray: &mut Ray,
        mut visit: impl FnMut(&mut Ray, &TriangleBlock, u32) -> bool,
        slabs: impl Fn(&Node, &SlabRay, f32) -> (u32, [f32; WIDTH]),
    ) -> bool {
        let slab_ray = SlabRay::new(ray);
        let mut stack = Stack::new();
        let mut current = 0;
        loop {
            let node = &self.nodes[current as usize];
            let (mut mask, near) = slabs(node, &slab_ray, ray.t_max);
            // Push what is hit so that the nearest child ends on top.
            let base = stack.len();
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                stack.push_sorted(base, Visit { child: node.children[lane], t: near[lane] });
            }
            loop {
                let Some(next) = stack.pop() else { return false };
                if next.t > ray.t_max {
                    continue;
                }
                if next.child & LEAF == 0 {
                    current = next.child;
                    break;
                }
                let block = (next.child & !LEAF) as usize;
                if visit(ray, &self.blocks[block], (block * LANES) as u32) {
                    return true;
                }
            }
        }
    }
}

/// Children yet to visit: an array, and beyond it memory that only degenerate trees need.
struct Stack {
    array: [Visit; Self::ARRAY],
    used: usize,
    overflow: Vec<Visit>,
}

impl Stack {
    const ARRAY: usize = 72;

    #[inline(always)]
    fn new() -> Self {
        Self { array: [Visit::default(); Self::ARRAY], used: 0, overflow: Vec::new() }
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.used
    }

    /// Adds a visit above `base`, keeping those above it sorted with the nearest on top.
    #[inline(always)]
    fn push_sorted(&mut self, base: usize, visit: Visit) {
        if self.used >= Self::ARRAY {
            // Order is a matter of speed only.
            self.overflow.push(visit);
            self.used += 1;
            return;
        }
        let mut place = self.used;
        while place > base && self.array[place - 1].t < visit.t {
            self.array[place] = self.array[place - 1];
            place -= 1;
        }
        self.array[place] = visit;
        self.used += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Visit> {
        if self.used == 0 {
            return None;
        }
        self.used -= 1;
        if self.used >= Self::ARRAY { self.overflow.pop() } else { Some(self.array[self.used]) }
    }
}

/// A ray as the box test wants it.
struct SlabRay {
    origin: Vec3,
    inverse: Vec3,
    /// Index of the near plane's array for each axis.
    near: [usize; 3],
}

impl SlabRay {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        // A finite stand-in for 1/0 keeps 0·∞ out of the test.
        let inverse = |d: f32| if d.abs() < 1e-18 { 1e18_f32.copysign(d) } else { 1.0 / d };
        let d = ray.direction;
        let near = |d: f32, axis: usize| if d.is_sign_negative() { axis + 3 } else { axis };
        Self {
            origin: ray.origin,
            inverse: Vec3::new(inverse(d.x), inverse(d.y), inverse(d.z)),
            near: [near(d.x, 0), near(d.y, 1), near(d.z, 2)],
        }
    }
}

/// Widens the far distance: three roundings of a relative 2⁻²⁴ each on either side
/// [Ize 2013, "Robust BVH Ray Traversal"].
const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Tests a ray against eight boxes: a bit mask of those it meets, and the distances at which it enters.
#[inline(always)]
fn slabs(node: &Node, ray: &SlabRay, t_max: f32) -> (u32, [f32; WIDTH]) {
    let mut near = [0.0_f32; WIDTH];
    let mut far = [t_max; WIDTH];
    for axis in 0..3 {
        let (low, high) = (ray.near[axis], axis + (axis + 3) - ray.near[axis]);
        for lane in 0..WIDTH {
            let a = (node.bounds[low][lane] - ray.origin[axis]) * ray.inverse[axis];
            let b = (node.bounds[high][lane] - ray.origin[axis]) * ray.inverse[axis] * WIDEN;
            near[lane] = if a > near[lane] { a } else { near[lane] };
            far[lane] = if b < far[lane] { b } else { far[lane] };
        }
    }
    let mut mask = 0;
    for lane in 0..WIDTH {
        mask |= u32::from(near[lane] <= far[lane]) << lane;
    }
    (mask, near)
}

/// The same eight tests with one instruction each.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
#[inline]
fn slabs_avx2(node: &Node, ray: &SlabRay, t_max: f32) -> (u32, [f32; WIDTH]) {
    use std::arch::x86_64::{
        __m256, _CMP_LE_OQ, _mm256_cmp_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps,
        _mm256_set1_ps, _mm256_setzero_ps, _mm256_sub_ps,
    };
    let plane = |index: usize| -> __m256 { bytemuck::cast(node.bounds[index]) };
    let mut near = _mm256_setzero_ps();
    let mut far = _mm256_set1_ps(t_max);
    let widen = _mm256_set1_ps(WIDEN);
    for axis in 0..3 {
        let (low, high) = (ray.near[axis], axis + (axis + 3) - ray.near[axis]);
        let origin = _mm256_set1_ps(ray.origin[axis]);
        let inverse = _mm256_set1_ps(ray.inverse[axis]);
        let a = _mm256_mul_ps(_mm256_sub_ps(plane(low), origin), inverse);
        let b = _mm256_mul_ps(_mm256_mul_ps(_mm256_sub_ps(plane(high), origin), inverse), widen);
        near = _mm256_max_ps(a, near);
        far = _mm256_min_ps(b, far);
    }
    let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far));
    (mask as u32, bytemuck::cast(near))
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

/// Turns the binary tree into wide nodes and blocks.
struct Gather<'a> {
    binary: &'a Bvh2,
    primitives: &'a [Primitive],
    /// Triangles below each binary node.
    counts: Vec<u32>,
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
}

impl<'a> Gather<'a> {
    fn new(binary: &'a Bvh2, primitives: &'a [Primitive]) -> Self {
        let counts = count_below(&binary.nodes);
        Self { binary, primitives, counts, nodes: Vec::new(), blocks: Vec::new() }
    }

    /// Works with a list of its own instead of recursion: degenerate trees are deep.
    fn run(&mut self) {
        self.nodes.push(EMPTY_NODE);
        let mut open = vec![(0_u32, 0_u32)];
        while let Some((source, target)) = open.pop() {
            let mut node = EMPTY_NODE;
            for (lane, &child) in self.children(source).iter().enumerate() {
                let below = &self.binary.nodes[child as usize];
                for axis in 0..3 {
                    node.bounds[axis][lane] = below.aabb.min[axis];
                    node.bounds[axis + 3][lane] = below.aabb.max[axis];
                }
                node.children[lane] = if self.is_block(child) {
                    LEAF | self.add_block(child)
                } else {
                    let index = self.nodes.len() as u32;
                    self.nodes.push(EMPTY_NODE);
                    open.push((child, index));
                    index
                };
            }
            self.nodes[target as usize] = node;
        }
    }

    fn is_block(&self, node: u32) -> bool {
        self.counts[node as usize] <= LANES as u32
    }

    /// Up to eight descendants: the largest box is replaced by its two children again and again.
    fn children(&self, root: u32) -> Vec<u32> {
        if self.is_block(root) {
            return vec![root];
        }
        let mut found = self.below(root).to_vec();
        while found.len() < WIDTH {
            let area = |&node: &u32| self.binary.nodes[node as usize].aabb.half_area();
            let largest = (0..found.len())
                .filter(|&i| !self.is_block(found[i]))
                .max_by(|&a, &b| area(&found[a]).total_cmp(&area(&found[b])));
            let Some(index) = largest else { break };
            let [a, b] = self.below(found[index]);
            found[index] = a;
            found.push(b);
        }
        found
    }

    fn below(&self, node: u32) -> [u32; 2] {
        let first = self.binary.nodes[node as usize].first_index;
        [first, first + 1]
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
                    block.set(lane, &self.primitives[primitive as usize]);
                    lane += 1;
                }
            } else {
                open.extend(self.below(index));
            }
        }
        self.blocks.push(block);
        self.blocks.len() as u32 - 1
    }
}

const EMPTY_NODE: Node = Node {
    bounds: [
        [f32::INFINITY; WIDTH],
        [f32::INFINITY; WIDTH],
        [f32::INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
        [f32::NEG_INFINITY; WIDTH],
    ],
    children: [EMPTY; WIDTH],
};

/// Number of primitives below each node of a binary tree.
fn count_below(nodes: &[Bvh2Node]) -> Vec<u32> {
    let mut counts = vec![0; nodes.len()];
    let mut open = vec![(0_usize, false)];
    while let Some((index, seen)) = open.pop() {
        let node = &nodes[index];
        let first = node.first_index as usize;
        if node.is_leaf() {
            counts[index] = node.prim_count;
        } else if seen {
            counts[index] = counts[first] + counts[first + 1];
        } else {
            open.extend([(index, true), (first, false), (first + 1, false)]);
        }
    }
    counts
}
