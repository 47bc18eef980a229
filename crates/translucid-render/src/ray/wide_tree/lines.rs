//! The tree's memory: nodes and blocks side by side in one array of cache lines.
//!
//! Cache lines of the tree: nodes that a ray visits together lie together, so that it touches few pages of memory.

use std::marker::PhantomData;
use std::mem::MaybeUninit;

use bytemuck::{Pod, Zeroable};

use super::Block;
use super::node::WideNode;

/// A cache line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u32; 16]);

/// Words of eight bytes in a line.
const WORDS: u32 = 8;

/// Nodes and blocks by the number of the word at which they start: a processor addresses words by number at once.
///
/// Numbers have 31 bits: 16 GiB, or 400 million triangles.
#[derive(Debug, PartialEq)]
pub(super) struct Lines<B>(Vec<Line>, PhantomData<B>);

impl<B> Default for Lines<B> {
    fn default() -> Self {
        Self(Vec::new(), PhantomData)
    }
}

impl<B: Block> Lines<B> {
    /// So many empty nodes.
    pub(super) fn of_empty_nodes(count: usize) -> Self {
        let nodes = vec![WideNode::EMPTY; count];
        Self(bytemuck::cast_slice(&nodes).to_vec(), PhantomData)
    }

    /// Reserves room for `times` the present lines and `other`.
    pub(super) fn reserve_for(&mut self, other: &Self, times: f64) {
        let needed = self.0.len() + other.0.len();
        if needed > self.0.capacity() {
            let mut lines = Vec::with_capacity((needed as f64 * times.max(1.0)) as usize);
            ask_for_large_pages(lines.spare_capacity_mut());
            lines.extend_from_slice(&self.0);
            self.0 = lines;
        }
    }

    /// Puts the nodes of `other` into the place of the first.
    pub(super) fn replace_first(&mut self, other: &Self) {
        self.0[..other.0.len()].copy_from_slice(&other.0);
    }

    /// Forgets all, but keeps the room.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// The number of the word after the last.
    pub(super) fn end(&self) -> u32 {
        WORDS * self.0.len() as u32
    }

    /// The number of the first lane of the block at a word.
    #[inline(always)]
    pub(super) fn lane(word: u32) -> u32 {
        word / WORDS * B::LANES as u32
    }

    /// The block with a lane, and which of its lanes that is.
    #[inline(always)]
    pub(super) fn block_of(&self, lane: u32) -> (&B, usize) {
        (self.block(lane / B::LANES as u32 * WORDS), lane as usize % B::LANES)
    }

    /// Puts other lines after these.
    pub(super) fn append(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Size in bytes.
    pub(super) fn size(&self) -> usize {
        size_of_val(&*self.0)
    }

    #[inline(always)]
    pub(super) fn node(&self, word: u32) -> &WideNode {
        self.at(word)
    }

    #[inline(always)]
    pub(super) fn block(&self, word: u32) -> &B {
        self.at(word)
    }

    #[inline(always)]
    fn at<T: Pod>(&self, word: u32) -> &T {
        let words: &[u64] = bytemuck::cast_slice(&self.0);
        &bytemuck::cast_slice(&words[word as usize..][..size_of::<T>() / size_of::<u64>()])[0]
    }

    /// Address of a word, which need not be there.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn address(&self, word: u32) -> *const i8 {
        self.0.as_ptr().cast::<u64>().wrapping_add(word as usize).cast()
    }

    /// Calls `found` for every node where there are only nodes.
    pub(super) fn for_each_node(&mut self, mut found: impl FnMut(u32, &mut WideNode)) {
        let step = size_of::<WideNode>() / size_of::<u64>();
        (0..self.end()).step_by(step).for_each(|word| found(word, self.node_mut(word)));
    }

    pub(super) fn node_mut(&mut self, word: u32) -> &mut WideNode {
        let lines: &mut [Line] =
            &mut self.0[(word / WORDS) as usize..][..size_of::<WideNode>() / size_of::<Line>()];
        &mut bytemuck::cast_slice_mut(lines)[0]
    }

    pub(super) fn push_node(&mut self, node: &WideNode) -> u32 {
        let word = self.end();
        self.0.extend_from_slice(bytemuck::cast_slice(std::slice::from_ref(node)));
        word
    }

    pub(super) fn push_block(&mut self, block: &B) -> u32 {
        let word = self.end();
        self.0.extend_from_slice(bytemuck::cast_slice(std::slice::from_ref(block)));
        word
    }
}

/// Asks the system for large pages, before anything is written: rays wander over more small ones than a processor keeps
/// addresses of.
fn ask_for_large_pages(memory: &mut [MaybeUninit<Line>]) {
    #[cfg(target_os = "linux")]
    {
        const PAGE: usize = 2 << 20;
        let before = memory.as_ptr().align_offset(PAGE);
        let Some(pages) = memory.get_mut(before..) else { return };
        let size = size_of_val(pages) / PAGE * PAGE;
        // SAFETY: whatever the size of pages, the program sees the same memory, and a refusal leaves it as it is.
        unsafe { libc::madvise(pages.as_mut_ptr().cast(), size, libc::MADV_HUGEPAGE) };
    }
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
}
