//! Samples of a block of pixels on their way to a film that is elsewhere.

use bytemuck::{bytes_of, cast_slice, pod_collect_to_vec, pod_read_unaligned};

use crate::world::PixelSample;

/// A sample of every pixel of a block, as [`PreparedScene::trace_blocks`](crate::PreparedScene::trace_blocks) makes it.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedBlock {
    /// Number of the sample.
    pub(super) number: u32,
    /// Number of the block in the sample's grid.
    pub(super) block: usize,
    /// In the order of the pixels' numbers.
    pub(super) samples: Vec<PixelSample>,
}

impl TracedBlock {
    /// Appends the block to bytes, for a program on a machine of the same kind.
    pub fn append_to(&self, bytes: &mut Vec<u8>) {
        let header = [self.number, self.block as u32, self.samples.len() as u32];
        bytes.extend_from_slice(bytes_of(&header));
        bytes.extend_from_slice(cast_slice(&self.samples));
    }

    /// Reads blocks that were [appended](Self::append_to) to each other; it ends where bytes are missing.
    pub fn read_all(mut bytes: &[u8]) -> Vec<Self> {
        let mut blocks = Vec::new();
        while let Some((header, rest)) = bytes.split_at_checked(size_of::<[u32; 3]>()) {
            let [number, block, count] = pod_read_unaligned(header);
            let Some((samples, rest)) = rest.split_at_checked(count as usize * size_of::<PixelSample>())
            else {
                break;
            };
            blocks.push(Self { number, block: block as usize, samples: pod_collect_to_vec(samples) });
            bytes = rest;
        }
        blocks
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn blocks_read_back_to_the_same_bits() {
        let sample = |depth| PixelSample { diffuse: Vec3::splat(0.1), depth, ..PixelSample::default() };
        let block = |number, block, count: u16| {
            let samples = (0..count).map(|i| sample(f32::from(i))).collect();
            TracedBlock { number, block, samples }
        };
        let blocks = vec![block(3, 70_000, 5), block(4, 0, 1)];
        let mut bytes = vec![];
        blocks.iter().for_each(|block| block.append_to(&mut bytes));
        assert_eq!(TracedBlock::read_all(&bytes), blocks);
        assert_eq!(TracedBlock::read_all(&bytes[..bytes.len() - 1]), blocks[..1]);
    }
}
