//! Chunks of things that lie together, each of which becomes a tree of its own.
//!
//! The memory that builds a tree is much larger than the tree. For many things it fits into no cache, but for one chunk
//! after the other it does, and processors share the work.

use std::iter;
use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

/// Things of a chunk at most, unless they lie in one place.
pub(crate) const MOST: usize = 1 << 17;

/// Bits of a cell's coordinate on one axis.
const BITS: u32 = 6;

const CELLS: usize = 1 << (3 * BITS);

/// One of this many things determines where the grid lies.
const SAMPLED: usize = 61;

/// Brings the numbers of things into the order of a grid's cells along a Morton curve, which is halved until few enough
/// things lie in each part, and returns the parts.
pub(super) fn chunks(things: &mut [u32], place: &(impl Fn(u32) -> Vec3 + Sync)) -> Vec<Range<usize>> {
    let count = things.len();
    if count <= MOST {
        return iter::once(0..count).collect();
    }
    let (low, high) = things
        .iter()
        .step_by(SAMPLED)
        .map(|&thing| place(thing))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let per_length = (1 << BITS) as f32 / (high - low).max_element();
    // Things beyond the grid count for the cells at its end.
    let cell = |&thing: &u32| morton(((place(thing) - low) * per_length).as_uvec3().to_array());
    let cells: Vec<u32> = things.par_iter().map(cell).collect();
    let mut starts = vec![0_usize; CELLS + 1];
    cells.iter().for_each(|&cell| starts[cell as usize + 1] += 1);
    for i in 0..CELLS {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    let mut sorted = vec![0; count];
    for (&thing, &cell) in things.iter().zip(&cells) {
        let place = &mut next[cell as usize];
        sorted[*place] = thing;
        *place += 1;
    }
    things.copy_from_slice(&sorted);
    drop((cells, sorted));
    let mut parts = Vec::new();
    halve(0..CELLS, &starts, &mut parts);
    // Where one cell has too many, its own grid parts them, unless all lie in one place.
    let part = |cells: Range<usize>| {
        let part = starts[cells.start]..starts[cells.end];
        let parts = if part.len() < count {
            chunks(&mut things[part.clone()], place)
        } else {
            iter::once(0..count).collect()
        };
        parts.into_iter().map(move |inner| part.start + inner.start..part.start + inner.end)
    };
    parts.into_iter().flat_map(part).collect()
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

/// Number of a cell in Morton order.
fn morton(cell: [u32; 3]) -> u32 {
    let [x, y, z] = cell.map(|at| SPREAD[at.min((1 << BITS) - 1) as usize]);
    x | y << 1 | z << 2
}

/// Coordinates of cells with two zeros after each bit.
const SPREAD: [u32; 1 << BITS] = {
    let mut spread = [0; 1 << BITS];
    let mut i = 0;
    while i < spread.len() {
        let mut bit = 0;
        while bit < BITS {
            spread[i] |= (i as u32 >> bit & 1) << (3 * bit);
            bit += 1;
        }
        i += 1;
    }
    spread
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Sorted numbers of all things after they were parted, and the size of the largest chunk, none of which is empty.
    fn parted(count: u32, place: impl Fn(u32) -> Vec3 + Sync) -> (Vec<u32>, usize) {
        let mut things: Vec<u32> = (0..count).collect();
        let chunks = chunks(&mut things, &place);
        let mut end = 0;
        for chunk in &chunks {
            assert!(chunk.start == end && !chunk.is_empty());
            end = chunk.end;
        }
        assert_eq!(end, things.len());
        things.sort_unstable();
        (things, chunks.iter().map(Range::len).max().unwrap_or(0))
    }

    #[test]
    fn chunks_have_everything_once_and_not_too_much() {
        let count = 5 * MOST as u32;
        // Half of them in a corner that is much smaller than a cell, and some far off
        let place = |thing: u32| {
            let random = |salt: u32| sobol_burley::sample(thing & 0xffff, salt, thing >> 16);
            let scale = if thing % 1000 == 7 {
                1e6
            } else if thing.is_multiple_of(2) {
                1e-3
            } else {
                1.0
            };
            Vec3::new(random(0), random(1), random(2)) * scale
        };
        let (all, largest) = parted(count, place);
        assert!(all.into_iter().eq(0..count) && largest <= MOST, "{largest}");
    }

    #[test]
    fn what_lies_in_one_place_is_one_chunk() {
        let count = 2 * MOST as u32;
        for place in [Vec3::ONE, Vec3::NAN, Vec3::MAX] {
            let (all, largest) = parted(count, |_| place);
            assert!(all.into_iter().eq(0..count) && largest == count as usize);
        }
    }
}
