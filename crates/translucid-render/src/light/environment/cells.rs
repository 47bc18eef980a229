//! A choice among the cells of a map, in proportion to their light and its cosine to a normal.
//!
//! Cells lie in blocks. For each of a few hundred directions, about evenly spread, there is a table of the blocks as
//! surfaces that face about this direction see them: light below the horizon is not drawn, and light near it seldom. Within
//! a block cells are drawn in proportion to their light.
//!
//! ```text
//! p(cell) = P(block | nearest direction to the normal) w(cell) / Σ_block w
//! ```
//!
//! Which table is used depends on the normal alone, so that the density of any direction is known exactly.

use std::f32::consts::FRAC_PI_2;

use glam::Vec3;

use super::super::distribution::Discrete;

/// Most blocks in azimuth and in elevation.
const MOST_BLOCKS: [usize; 2] = [32, 16];

/// Squares along the edge of each face of the cube that divides the sphere of normals.
const EDGE: usize = 8;

/// Number of the table for all directions alike.
const EVERYWHERE: usize = 6 * EDGE * EDGE;

/// Least cosine with which light counts that may come from above the horizon.
const LEAST_COSINE: f32 = 0.02;

/// Cells in rows, and what they weigh.
pub(super) struct WeighedCells<'a> {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Light of a cell by column and row.
    pub(super) weight: &'a dyn Fn(usize, usize) -> f64,
    /// Direction of a place in the grid, in cells from its upper left corner.
    pub(super) direction: &'a dyn Fn(f64, f64) -> Vec3,
}

/// Tables for drawing cells.
#[derive(Clone, Debug)]
pub(super) struct CellTables {
    columns: usize,
    /// Size of a block in cells; the last ones of a row or column may be smaller.
    block: [usize; 2],
    blocks_in_row: usize,
    /// Choice of a block for each square of normals, then for all directions; none where no light is.
    of_normals: Vec<Option<Grid>>,
    /// Choice of a cell of each block.
    of_blocks: Vec<Option<Grid>>,
    /// Probability of each cell within its block.
    within: Vec<f32>,
}

/// A choice among the fields of a grid: its row, then its column.
#[derive(Clone, Debug)]
struct Grid {
    rows: Discrete,
    /// One for each row; none where the row is black.
    columns: Vec<Option<Discrete>>,
}

/// A drawn field of a grid, and the random numbers that are left.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawnCell {
    /// Column and row.
    pub(super) at: [usize; 2],
    /// For the place between its upper and lower edge, and between its left and right one.
    pub(super) rest: [f64; 2],
}

impl CellTables {
    /// `None` where there is no light.
    pub(super) fn new(cells: &WeighedCells<'_>) -> Option<Self> {
        let size = [cells.columns, cells.rows];
        let block = [0, 1].map(|axis| size[axis].div_ceil(MOST_BLOCKS[axis]));
        let counts = [0, 1].map(|axis| size[axis].div_ceil(block[axis]));
        let seen: Vec<SeenBlock> = (0..counts[0] * counts[1])
            .map(|k| {
                let first = [k % counts[0] * block[0], k / counts[0] * block[1]];
                let end = [0, 1].map(|axis| (first[axis] + block[axis]).min(size[axis]));
                SeenBlock::new(cells, first, end)
            })
            .collect();
        let choice = |light: &dyn Fn(&SeenBlock) -> f64| {
            Grid::new(counts, |column, row| light(&seen[row * counts[0] + column]))
        };
        let of_normal = |square| {
            let (normal, radius) = normals_of(square);
            choice(&|block| block.irradiance(normal, radius))
        };
        let mut of_normals: Vec<_> = (0..EVERYWHERE).map(of_normal).collect();
        of_normals.push(Some(choice(&|block| block.light)?));
        let of_block = |&SeenBlock { first, end, .. }: &SeenBlock| {
            let weight = |column, row| (cells.weight)(first[0] + column, first[1] + row);
            Grid::new([end[0] - first[0], end[1] - first[1]], weight)
        };
        let of_blocks: Vec<_> = seen.iter().map(of_block).collect();
        let probability = |cell: usize| {
            let (column, row) = (cell % size[0], cell / size[0]);
            let of_block = of_blocks[row / block[1] * counts[0] + column / block[0]].as_ref();
            of_block.map_or(0.0, |of_block| of_block.probability([column % block[0], row % block[1]]))
        };
        let within = (0..size[0] * size[1]).map(|cell| probability(cell) as f32).collect();
        Some(Self { columns: size[0], block, blocks_in_row: counts[0], of_normals, of_blocks, within })
    }

    /// Draws a cell for a surface with a unit normal, or for all directions alike without one; `None` where no light is.
    pub(super) fn sample(&self, normal: Option<Vec3>, v: [f32; 2]) -> Option<DrawnCell> {
        let of_normal = self.of_normals[table_of(normal)].as_ref()?;
        let DrawnCell { at: [i, j], rest } = of_normal.sample(v.map(f64::from))?;
        let DrawnCell { at, rest } = self.of_blocks[j * self.blocks_in_row + i].as_ref()?.sample(rest)?;
        Some(DrawnCell { at: [i * self.block[0] + at[0], j * self.block[1] + at[1]], rest })
    }

    /// Probability with which [`sample`](Self::sample) draws a cell.
    pub(super) fn probability(&self, normal: Option<Vec3>, [i, j]: [usize; 2]) -> f32 {
        let Some(of_normal) = &self.of_normals[table_of(normal)] else { return 0.0 };
        let of_block = of_normal.probability([i / self.block[0], j / self.block[1]]);
        of_block as f32 * self.within[j * self.columns + i]
    }
}

impl Grid {
    /// A choice in proportion to the weights by column and row; `None` if all are 0.
    fn new([columns, rows]: [usize; 2], weight: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let row = |j: usize| (0..columns).map(|i| weight(i, j)).collect::<Vec<_>>();
        let weights: Vec<Vec<f64>> = (0..rows).map(row).collect();
        let rows = Discrete::new(weights.iter().map(|row| row.iter().sum()))?;
        Some(Self { rows, columns: weights.into_iter().map(|row| Discrete::new(row.into_iter())).collect() })
    }

    fn sample(&self, v: [f64; 2]) -> Option<DrawnCell> {
        let row = self.rows.sample(v[0]);
        let column = self.columns[row.index].as_ref()?.sample(v[1]);
        Some(DrawnCell { at: [column.index, row.index], rest: [row.rest, column.rest] })
    }

    fn probability(&self, [column, row]: [usize; 2]) -> f64 {
        let Some(columns) = &self.columns[row] else { return 0.0 };
        self.rows.probability(row) * columns.probability(column)
    }
}

/// A block as seen from its middle.
struct SeenBlock {
    /// First cell, and the first behind the last.
    first: [usize; 2],
    end: [usize; 2],
    light: f64,
    /// Light times its direction, over the light.
    mean_direction: Vec3,
    middle: Vec3,
    /// Largest angle between the middle and a direction of the block.
    radius: f32,
}

impl SeenBlock {
    fn new(cells: &WeighedCells<'_>, first: [usize; 2], end: [usize; 2]) -> Self {
        let WeighedCells { columns, rows, weight, direction } = *cells;
        let (mut light, mut sum) = (0.0, Vec3::ZERO);
        for (i, j) in (first[1]..end[1]).flat_map(|j| (first[0]..end[0]).map(move |i| (i, j))) {
            let weight = weight(i, j);
            light += weight;
            sum += direction(i as f64 + 0.5, j as f64 + 0.5) * weight as f32;
        }
        let [left, top, right, bottom] = [first[0], first[1], end[0], end[1]].map(|at| at as f64);
        let middle = direction((left + right) * 0.5, (top + bottom) * 0.5);
        let corners = [(left, top), (right, top), (left, bottom), (right, bottom)];
        let is_narrow = (end[0] - first[0]) * 4 <= columns && (end[1] - first[1]) * 2 <= rows;
        let radius = if is_narrow {
            corners.into_iter().map(|(x, y)| angle(middle, direction(x, y))).fold(0.0, f32::max)
        } else {
            FRAC_PI_2
        };
        let mean_direction = if light > 0.0 { sum / light as f32 } else { Vec3::ZERO };
        Self { first, end, light, mean_direction, middle, radius }
    }

    /// About its irradiance on surfaces whose normals lie so far about one; 0 only where all of it is below their horizons.
    fn irradiance(&self, normal: Vec3, radius: f32) -> f64 {
        let width = libm::sinf((self.radius + radius).min(FRAC_PI_2));
        if width < 1.0 && self.middle.dot(normal) <= -width {
            return 0.0;
        }
        let cosine = self.mean_direction.dot(normal);
        // The mean of what is above the horizon
        let above = if cosine < width { (cosine + width).max(0.0).powi(2) / (4.0 * width) } else { cosine };
        self.light * f64::from(above.max(LEAST_COSINE))
    }
}

/// Angle between two unit vectors.
fn angle(a: Vec3, b: Vec3) -> f32 {
    libm::acosf(a.dot(b).clamp(-1.0, 1.0))
}

/// The number of the table for a normal.
fn table_of(normal: Option<Vec3>) -> usize {
    let Some(normal) = normal else { return EVERYWHERE };
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
    let place = |other: usize| {
        let at = normal[(axis + other) % 3] / size[axis];
        (((at * 0.5 + 0.5) * EDGE as f32) as usize).min(EDGE - 1)
    };
    ((2 * axis + usize::from(normal[axis] < 0.0)) * EDGE + place(1)) * EDGE + place(2)
}

/// The middle of a table's normals, and their largest angle to it.
fn normals_of(table: usize) -> (Vec3, f32) {
    let (face, a, b) = (table / (EDGE * EDGE), table / EDGE % EDGE, table % EDGE);
    let normal = |a: f32, b: f32| {
        let axis = face / 2;
        let mut normal = Vec3::ZERO;
        normal[axis] = if face % 2 == 0 { 1.0 } else { -1.0 };
        normal[(axis + 1) % 3] = 2.0 * a / EDGE as f32 - 1.0;
        normal[(axis + 2) % 3] = 2.0 * b / EDGE as f32 - 1.0;
        normal.normalize()
    };
    let (a, b) = (a as f32, b as f32);
    let middle = normal(a + 0.5, b + 0.5);
    let corners = [(a, b), (a + 1.0, b), (a, b + 1.0), (a + 1.0, b + 1.0)];
    let radius = corners.into_iter().map(|(a, b)| angle(middle, normal(a, b))).fold(0.0, f32::max);
    (middle, radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_hold_the_normals_that_choose_them() {
        for k in 0..20_000 {
            let z = 1.0 - (k as f32 + 0.5) / 10_000.0;
            let (sin, cos) = libm::sincosf(k as f32 * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            let normal = Vec3::new(r * cos, r * sin, z);
            let (middle, radius) = normals_of(table_of(Some(normal)));
            assert!(angle(middle, normal) <= radius + 1e-3, "{normal}");
            assert!(radius < 0.2);
        }
    }
}
