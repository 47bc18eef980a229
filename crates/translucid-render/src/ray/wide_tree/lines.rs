//! The tree's memory: nodes and blocks side by side in one array of cache lines.
//!
//! Cache lines of the tree: nodes that a ray visits together lie together, so that it touches few pages of memory.

use std::marker::PhantomData;

use bytemuck::{Pod, Zeroable};

use super::Block;
use super::node::Node;

/// A cache line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u32; 16]);

const NODE_LINES: usize = size_of::<Node>() / size_of::<Line>();

/// Nodes and blocks by the number of the line at which they start.
///
/// Numbers have 28 bits: 16 GiB, or 400 million triangles.
#[derive(Debug, PartialEq)]
pub(super) struct Lines<B>(Vec<Line>, PhantomData<B>);

impl<B> Default for Lines<B> {
    fn default() -> Self {
        Self(Vec::new(), PhantomData)
    }
}

impl<B: Block> Lines<B> {
    const BLOCK_LINES: usize = size_of::<B>() / size_of::<Line>();

    /// With room for so many.
    pub(super) fn with_capacity(lines: u32) -> Self {
        Self(Vec::with_capacity(lines as usize), PhantomData)
    }

    /// The number of the line after the last.
    pub(super) fn end(&self) -> u32 {
        self.0.len() as u32
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
    pub(super) fn node(&self, line: u32) -> &Node {
        let lines: &[Line] = &self.0[line as usize..][..NODE_LINES];
        &bytemuck::cast_slice(lines)[0]
    }

    #[inline(always)]
    pub(super) fn block(&self, line: u32) -> &B {
        let lines: &[Line] = &self.0[line as usize..][..Self::BLOCK_LINES];
        &bytemuck::cast_slice(lines)[0]
    }

    /// Address of a line, which need not be there.
    #[inline(always)]
    pub(super) fn address(&self, line: u32) -> *const i8 {
        self.0.as_ptr().wrapping_add(line as usize).cast()
    }

    /// Calls `found` for every node where there are only nodes.
    pub(super) fn for_each_node(&mut self, mut found: impl FnMut(u32, &mut Node)) {
        (0..self.end()).step_by(NODE_LINES).for_each(|line| found(line, self.node_mut(line)));
    }

    pub(super) fn node_mut(&mut self, line: u32) -> &mut Node {
        let lines: &mut [Line] = &mut self.0[line as usize..][..NODE_LINES];
        &mut bytemuck::cast_slice_mut(lines)[0]
    }

    pub(super) fn push_node(&mut self, node: &Node) -> u32 {
        let line = self.end();
        self.0.extend_from_slice(bytemuck::cast_slice(std::slice::from_ref(node)));
        line
    }

    pub(super) fn push_block(&mut self, block: &B) -> u32 {
        let line = self.end();
        self.0.extend_from_slice(bytemuck::cast_slice(std::slice::from_ref(block)));
        line
    }
}
