//! The places of a film's tiles.

use translucid_image::PixelRect;

/// Greatest edge of a tile in pixels.
pub const TILE_SIZE: u32 = 16;

/// Tiles in columns and rows over a film.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TileGrid {
    columns: Spans,
    rows: Spans,
}

impl TileGrid {
    /// Tiles of [`TILE_SIZE`]; those at the right and bottom edge may be smaller.
    pub(super) fn new(width: u32, height: u32) -> Self {
        let edges = |size: u32| (0..size).step_by(TILE_SIZE as usize).chain([size]).collect();
        Self::with_edges([edges(width), edges(height)]).expect("these edges are right")
    }

    /// Tiles whose columns and rows begin at all but the last of these edges, where it ends; `None` where they do not begin
    /// at 0, do not grow, or are farther apart than [`TILE_SIZE`].
    pub(super) fn with_edges([columns, rows]: [Vec<u32>; 2]) -> Option<Self> {
        let is_right = |edges: &[u32]| {
            edges.len() > 1 && edges[0] == 0 && edges.is_sorted_by(|a, b| a < b && b - a <= TILE_SIZE)
        };
        (is_right(&columns) && is_right(&rows))
            .then(|| Self { columns: Spans::new(columns), rows: Spans::new(rows) })
    }

    /// Where columns and rows begin, and where the last ones end.
    pub(super) fn edges(&self) -> [&[u32]; 2] {
        [&self.columns.edges, &self.rows.edges]
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        [&self.columns, &self.rows].map(|spans| spans.of_pixel.len() as u32)
    }

    /// Number of tiles.
    pub(super) fn len(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Pixels of a tile.
    pub(super) fn rect(&self, index: usize) -> PixelRect {
        let (left, width) = self.columns.start_and_size(index % self.columns.len());
        let (top, height) = self.rows.start_and_size(index / self.columns.len());
        PixelRect { left, top, width, height }
    }

    /// Number of the tile that a pixel is in.
    pub(super) fn index_of(&self, x: u32, y: u32) -> usize {
        self.rows.of_pixel[y as usize] as usize * self.columns.len()
            + self.columns.of_pixel[x as usize] as usize
    }

    /// Numbers of the tiles that a rectangle of pixels touches.
    pub(super) fn touching(&self, rect: PixelRect) -> impl Iterator<Item = usize> + use<> {
        let span = |spans: &Spans, start: u32, size: u32| {
            let [first, last] = [start, start + size - 1].map(|at| spans.of_pixel[at as usize] as usize);
            first..=last
        };
        let columns = span(&self.columns, rect.left, rect.width);
        let per_row = self.columns.len();
        span(&self.rows, rect.top, rect.height)
            .flat_map(move |row| columns.clone().map(move |column| row * per_row + column))
    }
}

/// The columns or rows of tiles.
#[derive(Clone, Debug, PartialEq)]
struct Spans {
    /// Where they begin, and where the last one ends.
    edges: Vec<u32>,
    /// For each pixel the one that it is in.
    of_pixel: Vec<u32>,
}

impl Spans {
    fn new(edges: Vec<u32>) -> Self {
        let of_pixel =
            (0..).zip(edges.windows(2)).flat_map(|(number, ends)| (ends[0]..ends[1]).map(move |_| number));
        Self { of_pixel: of_pixel.collect(), edges }
    }

    fn len(&self) -> usize {
        self.edges.len() - 1
    }

    fn start_and_size(&self, number: usize) -> (u32, u32) {
        (self.edges[number], self.edges[number + 1] - self.edges[number])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_of_a_rect_are_those_with_its_pixels() {
        let odd = TileGrid::with_edges([vec![0, 3, 16, 20, 36, 50], vec![0, 1, 17, 33, 40]]).unwrap();
        for grid in [TileGrid::new(50, 40), odd] {
            assert_eq!(grid.size(), [50, 40]);
            for (left, top, width, height) in [(0, 0, 16, 16), (5, 5, 16, 16), (47, 16, 3, 1), (15, 15, 2, 2)]
            {
                let rect = PixelRect { left, top, width, height };
                let touches = |index: &usize| grid.rect(*index).intersection(&rect).is_some();
                let expected: Vec<usize> = (0..grid.len()).filter(touches).collect();
                assert_eq!(grid.touching(rect).collect::<Vec<_>>(), expected, "{rect:?}");
                assert!(rect.pixels().all(|(x, y)| expected.contains(&grid.index_of(x, y))));
            }
        }
        for wrong in [vec![], vec![0], vec![1, 2], vec![0, 17], vec![0, 4, 4], vec![0, 4, 2]] {
            assert!(TileGrid::with_edges([wrong, vec![0, 1]]).is_none());
        }
    }
}
