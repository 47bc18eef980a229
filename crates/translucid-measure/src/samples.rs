//! Values of a photograph by place, in blocks whose differences tell their noise.

/// Values by one coordinate of a photograph: the distance across an edge of light, or from the middle of a spot.
#[derive(Clone, Debug)]
pub struct Samples {
    /// Places, rising \[L\].
    pub places: Vec<f64>,
    /// Width of a pixel \[L\].
    pub pixel_width: f64,
    /// Blocks along the edge, or sectors around the spot: for each place the linear values of three channels.
    pub blocks: Vec<Vec<[f64; 3]>>,
    /// Where along the edge the blocks begin and end \[L\]; of sectors both are 0.
    pub along: [f64; 2],
}

impl Samples {
    /// Means of the blocks, by place.
    pub fn means(&self) -> Vec<[f64; 3]> {
        let count = self.blocks.len().max(1) as f64;
        let mean = |i: usize, c: usize| self.blocks.iter().map(|block| block[i][c]).sum::<f64>() / count;
        (0..self.places.len()).map(|i| std::array::from_fn(|c| mean(i, c))).collect()
    }

    /// From the first place to the last \[L\].
    pub fn extent(&self) -> f64 {
        self.places.last().zip(self.places.first()).map_or(0.0, |(last, first)| last - first)
    }
}
