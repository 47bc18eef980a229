//! Chunks of things that lie together, each of which becomes a tree by itself.
//!
//! What a tree is built from is much larger than the tree, and fits into no cache where things are many: chunk after
//! chunk it does, and processors share the work.

use std::ops::Range;

use glam::Vec3;

/// Things of a chunk at most, unless they lie in one place.
pub(crate) const MOST: usize = 1 << 18;

/// Bits of a cell's coordinate on one axis.
const BITS: u32 = 6;

const CELLS: usize = 1 << (3 * BITS);

/// Of so many things one says where the grid lies.
const SAMPLED: usize = 61;

/// Numbers of things, by chunks: a grid's cells in Morton order, halved until few enough things lie in each part.
pub(super) fn chunks(things: Vec<u32>, place: &impl Fn(u32) -> Vec3) -> Vec<Vec<u32>> {
    if things.len() <= MOST {
        return vec![things];
    }
    let (low, high) = things
        .iter()
        .step_by(SAMPLED)
        .map(|&thing| place(thing))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let per_length = (1 << BITS) as f32 / (high - low).max_element();
    // What lies beyond the grid counts for the cells at its end.
    let cell = |&thing: &u32| morton(((place(thing) - low) * per_length).as_uvec3().to_array());
    let cells: Vec<u32> = things.iter().map(cell).collect();
    let mut starts = vec![0_usize; CELLS + 1];
    cells.iter().for_each(|&cell| starts[cell as usize + 1] += 1);
    for i in 0..CELLS {
        starts[i + 1] += starts[i];
    }
    let mut parts = Vec::new();
    halve(0..CELLS, &starts, &mut parts);
    let mut part_of_cell = vec![0; CELLS];
    for (number, cells) in parts.iter().enumerate() {
        part_of_cell[cells.clone()].fill(number);
    }
    let room = |cells: &Range<usize>| Vec::with_capacity(starts[cells.end] - starts[cells.start]);
    let mut lists: Vec<Vec<u32>> = parts.iter().map(room).collect();
    things.iter().zip(&cells).for_each(|(&thing, &cell)| lists[part_of_cell[cell as usize]].push(thing));
    // Where one cell has too many, its own grid parts them, unless all lie in one place.
    let part = |list: Vec<u32>| if list.len() < things.len() { chunks(list, place) } else { vec![list] };
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

    /// Sorted numbers of all chunks, none of which is empty, and the size of the largest.
    fn all(chunks: &[Vec<u32>]) -> (Vec<u32>, usize) {
        assert!(chunks.iter().all(|chunk| !chunk.is_empty()));
        let mut all = chunks.concat();
        all.sort_unstable();
        (all, chunks.iter().map(Vec::len).max().unwrap_or(0))
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
        let (all, largest) = all(&chunks((0..count).collect(), &place));
        assert!(all.into_iter().eq(0..count) && largest <= MOST, "{largest}");
    }

    #[test]
    fn what_lies_in_one_place_is_one_chunk() {
        let count = 2 * MOST as u32;
        for place in [Vec3::ONE, Vec3::NAN, Vec3::MAX] {
            let (all, largest) = all(&chunks((0..count).collect(), &|_| place));
            assert!(all.into_iter().eq(0..count) && largest == count as usize);
        }
    }
}
