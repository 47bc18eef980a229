//! The tree's memory: nodes and blocks side by side in one array of cache lines.
//!
//! Cache lines of the tree: nodes that a ray visits together lie together, so that it touches few pages of memory.

use bytemuck::{Pod, Zeroable};

use super::node::Node;
use crate::ray::triangle::TriangleBlock;

/// A cache line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u32; 16]);

const NODE_LINES: usize = size_of::<Node>() / size_of::<Line>();
const BLOCK_LINES: usize = size_of::<TriangleBlock>() / size_of::<Line>();

/// Nodes and blocks by the number of the line at which they start.
///
/// Numbers have 30 bits: 64 GiB, or 700 million triangles.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Lines(Vec<Line>);

impl Lines {
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
    pub(super) fn block(&self, line: u32) -> &TriangleBlock {
        let lines: &[Line] = &self.0[line as usize..][..BLOCK_LINES];
        &bytemuck::cast_slice(lines)[0]
    }

    /// Address of a line, which need not be there.
    #[inline(always)]
    pub(super) fn address(&self, line: u32) -> *const i8 {
        self.0.as_ptr().wrapping_add(line as usize).cast()
    }

    pub(super) fn node_mut(&mut self, line: u32) -> &mut Node {
        let lines: &mut [Line] = &mut self.0[line as usize..][..NODE_LINES];
        &mut bytemuck::cast_slice_mut(lines)[0]
    }

    pub(super) fn push_node(&mut self, node: &Node) -> u32 {
        let line = self.0.len() as u32;
        self.0.extend_from_slice(bytemuck::cast_slice(std::slice::from_ref(node)));
        line
    }

    pub(super) fn push_block(&mut self, block: &TriangleBlock) -> u32 {
        let line = self.0.len() as u32;
        self.0.extend_from_slice(bytemuck::cast_slice(std::slice::from_ref(block)));
        line
    }
}
