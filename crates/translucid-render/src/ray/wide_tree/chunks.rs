//! Chunks of things that lie together, each of which becomes a tree by itself.
//!
//! What a tree is built from is much larger than the tree, and fits into no cache where things are many: chunk after
//! chunk it does, and processors share the work.

use std::ops::Range;

use glam::Vec3;

/// Things of a chunk at most, unless they lie in one place.
pub(super) const MOST: usize = 1 << 18;

/// Bits of a cell's coordinate on one axis.
const BITS: u32 = 6;

/// Numbers of things, by chunks: a grid's cells in Morton order, halved until few enough things lie in each part.
pub(super) fn chunks(things: Vec<u32>, center: &impl Fn(u32) -> Vec3) -> Vec<Vec<u32>> {
    if things.len() <= MOST {
        return vec![things];
    }
    let (low, high) = things
        .iter()
        .map(|&thing| center(thing))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let per_length = (1 << BITS) as f32 / (high - low).max_element();
    let cell = |thing: u32| morton(((center(thing) - low) * per_length).as_uvec3().to_array());
    let mut starts = vec![0_usize; (1 << (3 * BITS)) + 1];
    things.iter().for_each(|&thing| starts[cell(thing) + 1] += 1);
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut parts = Vec::new();
    halve(0..starts.len() - 1, &starts, &mut parts);
    let mut part_of_cell = vec![0_u32; starts.len() - 1];
    let mut lists = Vec::new();
    for (number, cells) in parts.iter().enumerate() {
        lists.push(Vec::with_capacity(starts[cells.end] - starts[cells.start]));
        part_of_cell[cells.clone()].fill(number as u32);
    }
    let count = things.len();
    for thing in things {
        lists[part_of_cell[cell(thing)] as usize].push(thing);
    }
    // Where one cell has too many, its own grid parts them, unless all lie in one place.
    let part = |list: Vec<u32>| if list.len() < count { chunks(list, center) } else { vec![list] };
    lists.into_iter().flat_map(part).collect()
}

/// Ranges of cells with few enough things in them, by the numbers of things before each cell.
fn halve(cells: Range<usize>, starts: &[usize], parts: &mut Vec<Range<usize>>) {
    let count = starts[cells.end] - starts[cells.start];
    if count <= MOST || cells.len() == 1 {
        if count > 0 {
            parts.push(cells);
        }
        return;
    }
    let middle = cells.start + cells.len() / 2;
    halve(cells.start..middle, starts, parts);
    halve(middle..cells.end, starts, parts);
}

/// Number of a cell in Morton order; what lies beyond the grid counts for its last cells.
fn morton(cell: [u32; 3]) -> usize {
    let cell = cell.map(|at| at.min((1 << BITS) - 1));
    let spread = |at: u32| (0..BITS).fold(0, |spread, bit| spread | (at >> bit & 1) << (3 * bit));
    (spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2) as usize
}
