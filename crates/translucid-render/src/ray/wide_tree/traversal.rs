//! Traversal of the tree by a ray.
//!
//! ```text
//! loop
//!   which of the node's boxes does the ray meet?
//!   none: take the nearest from the stack; else the nearest of them, the others onto the stack
//!   a block: ask the visitor, and take the next from the stack
//! ```
//!
//! Everything below is compiled twice, portably and for AVX2, which is chosen at run time; both find the same hits.

use std::mem::MaybeUninit;

use super::lines::Lines;
use super::node::{BoxHits, LEAF, SlabRay, WIDTH, WideNode};
use super::{Block, WideTree};
#[cfg(target_arch = "x86_64")]
use crate::ray::simd::Avx2;
use crate::ray::simd::{Portable, SimdToken};
use crate::ray::triangle::{BlockRay, Ray};

/// A visitor of the blocks on a ray's way.
pub(in crate::ray) trait Visitor<B> {
    /// Near blocks come before far ones, and blocks beyond the ray's end, which visits may bring nearer, are left out.
    const IS_ORDERED: bool;

    /// Looks at a block whose first lane has the number `first`; true ends the way.
    fn visit(&mut self, vectors: impl SimdToken, ray: &mut BlockRay, block: &B, first: u32) -> bool;
}

/// Children yet to visit that fit without an allocation: scanned meshes have up to 70.
pub(super) const STACK: usize = 96;

/// Children yet to visit: making room for them costs nothing as long as it is not written.
type Stack = [MaybeUninit<Visit>];

/// A child yet to visit: above the bits of the distance at which the ray enters its box, below its number.
///
/// Distances are not negative, so that the order of their bits is theirs.
#[derive(Clone, Copy)]
struct Visit(u64);

impl Visit {
    #[inline(always)]
    fn new(distance: f32, child: u32) -> Self {
        Self(u64::from(distance.to_bits()) << 32 | u64::from(child))
    }

    #[inline(always)]
    fn child(self) -> u32 {
        self.0 as u32
    }

    #[inline(always)]
    fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

impl<B: Block> WideTree<B> {
    /// Leads a visitor to the blocks whose boxes a ray meets; returns `true` if the visitor has ended the traversal.
    #[inline(always)]
    pub(in crate::ray) fn traverse<V: Visitor<B>>(&self, ray: &Ray, visitor: &mut V) -> bool {
        if self.lines.is_empty() {
            return false;
        }
        let mut array = [const { MaybeUninit::uninit() }; STACK];
        // Degenerate trees are deep.
        let mut deep;
        let stack = if self.most_waiting <= STACK {
            &mut array[..]
        } else {
            deep = vec![MaybeUninit::uninit(); self.most_waiting];
            &mut deep[..]
        };
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is true only if the processor was found to have AVX2.
            return unsafe { self.traverse_avx2(ray, visitor, stack) };
        }
        self.traverse_portable(ray, visitor, stack)
    }

    #[inline(never)]
    fn traverse_portable<V: Visitor<B>>(&self, ray: &Ray, visitor: &mut V, stack: &mut Stack) -> bool {
        self.traverse_with(Portable, ray, visitor, stack)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn traverse_avx2<V: Visitor<B>>(&self, ray: &Ray, visitor: &mut V, stack: &mut Stack) -> bool {
        // SAFETY: this function has AVX2.
        self.traverse_with(unsafe { Avx2::new() }, ray, visitor, stack)
    }

    #[inline(always)]
    fn traverse_with<V: Visitor<B>>(
        &self,
        vectors: impl SimdToken,
        ray: &Ray,
        visitor: &mut V,
        stack: &mut Stack,
    ) -> bool {
        let slab_ray = SlabRay::new(ray);
        let mut block_ray = BlockRay::new(ray);
        let mut used = 0;
        let mut child = 0;
        loop {
            // Go down to a block.
            let mut is_met = true;
            while child & LEAF == 0 {
                let node = self.lines.node(child);
                let met = slab_ray.meet(vectors, node, block_ray.t_max);
                if met.mask == 0 {
                    is_met = false;
                    break;
                }
                let first = child + node.children[met.mask.trailing_zeros() as usize % WIDTH];
                // Mostly there is one, and the next node's address depends on nothing else.
                child = if met.mask & (met.mask - 1) == 0 {
                    first
                } else {
                    self.choose::<V>((child, node), &met, stack, &mut used)
                };
            }
            if is_met {
                let word = child & !LEAF;
                if visitor.visit(vectors, &mut block_ray, self.lines.block(word), Lines::<B>::lane(word)) {
                    return true;
                }
            }
            // Go on with the rest of the stack.
            loop {
                if used == 0 {
                    return false;
                }
                used -= 1;
                // SAFETY: what lies below `used` has been written.
                let visit = unsafe { stack[used].assume_init() };
                if !V::IS_ORDERED || visit.distance() <= block_ray.t_max {
                    child = visit.child();
                    break;
                }
            }
        }
    }

    /// Takes the nearest of the children that a ray meets, of which there are any; the others go onto the stack so that the
    /// nearest of them is on top.
    #[inline(always)]
    fn choose<V: Visitor<B>>(
        &self,
        (word, node): (u32, &WideNode),
        met: &BoxHits,
        stack: &mut Stack,
        used: &mut usize,
    ) -> u32 {
        let next = |mask: u32| {
            let lane = mask.trailing_zeros() as usize % WIDTH;
            let child = word + node.children[lane];
            self.prefetch(child);
            Visit::new(met.near[lane], child)
        };
        let mut nearest = next(met.mask);
        let mut mask = met.mask & (met.mask - 1);
        let base = *used;
        while mask != 0 {
            let visit = next(mask);
            mask &= mask - 1;
            if !V::IS_ORDERED {
                stack[*used].write(visit);
                *used += 1;
                continue;
            }
            let (near, far) = if visit.0 < nearest.0 { (visit, nearest) } else { (nearest, visit) };
            nearest = near;
            let mut place = *used;
            // SAFETY: what lies below `used` has been written.
            while place > base && unsafe { stack[place - 1].assume_init() }.0 < far.0 {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place].write(far);
            *used += 1;
        }
        nearest.child()
    }

    /// Prefetches a child: on large meshes, waiting for memory would take most of the time.
    #[inline(always)]
    fn prefetch(&self, child: u32) {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            let start = self.lines.address(child & !LEAF);
            // A node lies in four cache lines, a block in two.
            let rest = if child & LEAF == 0 { 128 } else { 0 };
            for offset in [0, 64, rest, rest + 64] {
                // SAFETY: a prefetch reads nothing that the program can see, and faults at no address.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(offset)) };
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = child;
    }
}
