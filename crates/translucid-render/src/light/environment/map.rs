//! Latitude–longitude image as a light.
//!
//! The radiance is interpolated bilinearly between pixel centers, around the seam and up to the poles.
//! Directions are drawn from [tables of cells](super::cells), in proportion to the root mean square of the luminance in
//! each cell times the cell's solid angle and, about, its cosine to the normal, and uniformly in solid angle within a cell.
//! The density is therefore exactly constant in a cell, and 0 only where all pixels that the cell interpolates are
//! black.
//! For a density that is constant in cells the root mean square leaves the least variance; in a cell of one
//! pixel it is the mean of the interpolated luminance.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Mat3, Vec3};
use translucid_law::{Receiver, luminance};
use translucid_scene::Image;

use super::cells::{CellTables, WeighedCells};

/// Most cells of the table in azimuth and in elevation; a larger image has several pixels to the cell.
const MOST_CELLS: [usize; 2] = [1024, 512];

/// An image on the sphere with its table for sampling.
#[derive(Clone, Debug)]
pub(crate) struct EnvironmentMap {
    world_from_environment: Mat3,
    pub(crate) environment_from_world: Mat3,
    pub(crate) pixels: Pixels,
    pub(crate) grid: PixelGrid,
    cells: CellTables,
    /// Irradiance (luminance) on surfaces that face +x, −x, +y, −y, +z, −z of the environment's frame.
    pub(crate) irradiance: [f32; 6],
}

impl EnvironmentMap {
    /// None if the image times the factor is black.
    pub(crate) fn new(image: &Image, factor: Vec3, world_from_environment: Mat3) -> Option<Self> {
        let pixels = Pixels::new(image, factor);
        let grid = PixelGrid::new(pixels.width, pixels.height);
        let weights = grid.weights(&pixels);
        let weight = |i: usize, j: usize| weights[j * grid.columns + i];
        let cells = CellTables::new(&WeighedCells {
            columns: grid.columns,
            rows: grid.rows,
            weight: &weight,
            direction: &|column, row| grid.direction(column, row),
        })?;
        let irradiance = grid.irradiance(&weight);
        Some(Self {
            world_from_environment,
            environment_from_world: world_from_environment.transpose(),
            pixels,
            grid,
            cells,
            irradiance,
        })
    }

    /// Radiance from a direction.
    pub(crate) fn radiance(&self, direction: Vec3) -> Vec3 {
        let [u, v] = image_coordinates(self.environment_from_world * direction);
        self.pixels.bilinear(u, v)
    }

    /// Estimate of the irradiance, from six exact ones; without a normal the largest.
    ///
    /// A hemisphere lies within those about the nearest axes, so that it is black where this is 0.
    pub(crate) fn irradiance(&self, receiver: &Receiver) -> f32 {
        if !receiver.has_normal() {
            return self.irradiance.iter().copied().fold(0.0, f32::max);
        }
        let normal = self.environment_from_world * receiver.normal;
        let along = |axis: usize| self.irradiance[2 * axis + usize::from(normal[axis] < 0.0)];
        (0..3).map(|axis| normal[axis] * normal[axis] * along(axis)).sum()
    }

    /// Draws a direction.
    pub(crate) fn sample(&self, receiver: &Receiver, v: [f32; 2]) -> Vec3 {
        let Some(cell) = self.cells.sample(self.normal(receiver), v) else { return Vec3::Y };
        let [i, j] = cell.at;
        let cos = lerp(self.grid.cos_theta(j), self.grid.cos_theta(j + 1), cell.rest[0]);
        let u = lerp(self.grid.u(i), self.grid.u(i + 1), cell.rest[1]);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = libm::sincos(TAU * (u - 0.5));
        let local = DVec3::new(sin * sin_phi, cos, -sin * cos_phi).as_vec3();
        (self.world_from_environment * local).normalize_or(Vec3::Y)
    }

    /// Solid-angle density of `sample`.
    pub(crate) fn pdf(&self, receiver: &Receiver, direction: Vec3) -> f32 {
        let [u, v] = image_coordinates(self.environment_from_world * direction);
        let [i, j] = self.grid.cell(u, v);
        self.cells.probability(self.normal(receiver), [i, j]) / self.grid.solid_angle(i, j) as f32
    }

    /// The receiver's normal in the environment's frame.
    fn normal(&self, receiver: &Receiver) -> Option<Vec3> {
        receiver.has_normal().then(|| self.environment_from_world * receiver.normal)
    }
}

/// Image coordinates in [0, 1] of a direction in the environment's frame, v downward.
///
/// As seen from inside with +y up: the middle is −z, right of it +x.
fn image_coordinates(direction: Vec3) -> [f32; 2] {
    let u = 0.5 + libm::atan2f(direction.x, -direction.z) / std::f32::consts::TAU;
    // By both coordinates: the arc cosine alone has no digits near the poles.
    let across = (direction.x * direction.x + direction.z * direction.z).sqrt();
    let v = libm::atan2f(across, direction.y) / std::f32::consts::PI;
    [u, v]
}

fn lerp(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

/// Linear pixels.
#[derive(Clone, Debug)]
pub(crate) struct Pixels {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Rows from the top.
    pub(crate) data: Vec<Vec3>,
}

impl Pixels {
    fn new(image: &Image, factor: Vec3) -> Self {
        let (width, height) = (image.width.max(1), image.height.max(1));
        let color = |x, y| {
            let [r, g, b, _] = image.texel(x, y);
            // Negative channels are colors beyond Rec. 709
            let color = Vec3::new(r, g, b) * factor;
            Vec3::from_array(color.to_array().map(|c| if c.is_finite() { c } else { 0.0 }))
        };
        let data =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| color(x, y)).collect();
        Self { width: width as usize, height: height as usize, data }
    }

    /// Interpolated color; the pixel in column i, row j has its center at ((i + ½)/width, (j + ½)/height).
    fn bilinear(&self, u: f32, v: f32) -> Vec3 {
        let x = (u * self.width as f32 - 0.5).rem_euclid(self.width as f32);
        let y = (v * self.height as f32 - 0.5).clamp(0.0, (self.height - 1) as f32);
        let (i, j) = ((x as usize).min(self.width - 1), y as usize);
        let (s, t) = (x - i as f32, y - j as f32);
        let (right, below) = ((i + 1) % self.width, (j + 1).min(self.height - 1));
        let row = |j: usize| self.data[j * self.width + i].lerp(self.data[j * self.width + right], s);
        row(j).lerp(row(below), t)
    }

    /// Mean over a pixel's area of the interpolated luminance, negative channels counted as positive: weights ⅛, ¾, ⅛ in each
    /// direction.
    fn mean_luminance(&self, i: usize, j: usize) -> f32 {
        let columns = [(i + self.width - 1) % self.width, i, (i + 1) % self.width];
        let rows = [j.saturating_sub(1), j, (j + 1).min(self.height - 1)];
        let mut sum = 0.0;
        for (row, weight) in rows.into_iter().zip([0.125, 0.75, 0.125]) {
            let at = |k: usize| luminance(self.data[row * self.width + columns[k]].abs());
            sum += weight * (0.125 * at(0) + 0.75 * at(1) + 0.125 * at(2));
        }
        sum
    }
}

/// Cells of the table: blocks of pixels.
#[derive(Clone, Debug)]
pub(crate) struct PixelGrid {
    /// Size of the image in pixels.
    pixels: [usize; 2],
    /// Size of a cell in pixels; the last ones of a row or column may be smaller.
    pub(crate) block: [usize; 2],
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Cosine of the polar angle of the upper edge of each row of cells, and of the lower edge of the last.
    cos_theta: Vec<f64>,
}

impl PixelGrid {
    fn new(width: usize, height: usize) -> Self {
        let block = [width.div_ceil(MOST_CELLS[0]), height.div_ceil(MOST_CELLS[1])];
        let (columns, rows) = (width.div_ceil(block[0]), height.div_ceil(block[1]));
        let v = |row: usize| (row * block[1]).min(height) as f64 / height as f64;
        let cos_theta = (0..=rows).map(|row| libm::cos(PI * v(row))).collect();
        Self { pixels: [width, height], block, columns, rows, cos_theta }
    }

    /// Direction of a place, in cells from the upper left corner.
    fn direction(&self, column: f64, row: f64) -> Vec3 {
        let place = |at: f64, axis: usize| {
            let [pixels, block] = [self.pixels[axis], self.block[axis]].map(|size| size as f64);
            (at * block).min(pixels) / pixels
        };
        let (sin, cos) = libm::sincos(PI * place(row, 1));
        let (sin_phi, cos_phi) = libm::sincos(TAU * (place(column, 0) - 0.5));
        DVec3::new(sin * sin_phi, cos, -sin * cos_phi).as_vec3()
    }

    /// Image coordinate of the left edge of a column of cells.
    fn u(&self, column: usize) -> f64 {
        (column * self.block[0]).min(self.pixels[0]) as f64 / self.pixels[0] as f64
    }

    /// Cosine of the polar angle of the upper edge of a row of cells.
    pub(crate) fn cos_theta(&self, row: usize) -> f64 {
        self.cos_theta[row]
    }

    /// Solid angle of a cell [sr].
    fn solid_angle(&self, i: usize, j: usize) -> f64 {
        TAU * (self.u(i + 1) - self.u(i)) * (self.cos_theta(j) - self.cos_theta(j + 1))
    }

    /// Column and row of the cell at image coordinates.
    fn cell(&self, u: f32, v: f32) -> [usize; 2] {
        let pixel = |x: f32, size: usize| ((f64::from(x) * size as f64) as usize).min(size - 1);
        [pixel(u, self.pixels[0]) / self.block[0], pixel(v, self.pixels[1]) / self.block[1]]
    }

    /// Light of each cell, row by row: the root mean square of its luminance times its solid angle.
    pub(crate) fn weights(&self, pixels: &Pixels) -> Vec<f64> {
        let mean_squares = self.mean_squares(pixels).into_iter().enumerate();
        mean_squares
            .map(|(cell, mean_square)| {
                f64::from(mean_square).sqrt() * self.solid_angle(cell % self.columns, cell / self.columns)
            })
            .collect()
    }

    /// Mean square over the pixels of each cell, row by row.
    fn mean_squares(&self, pixels: &Pixels) -> Vec<f32> {
        let mut sums = vec![0.0_f32; self.columns * self.rows];
        let mut counts = vec![0_u32; sums.len()];
        for y in 0..self.pixels[1] {
            for x in 0..self.pixels[0] {
                let cell = y / self.block[1] * self.columns + x / self.block[0];
                sums[cell] += pixels.mean_luminance(x, y).powi(2);
                counts[cell] += 1;
            }
        }
        sums.iter().zip(counts).map(|(sum, count)| sum / count as f32).collect()
    }

    /// Irradiance on the six axes, given each cell's luminance × solid angle.
    fn irradiance(&self, weight: &impl Fn(usize, usize) -> f64) -> [f32; 6] {
        let mut sums = [0.0; 6];
        for j in 0..self.rows {
            let edges = [self.cos_theta(j), self.cos_theta(j + 1)];
            for i in 0..self.columns {
                // Corners bound the cosine from above: a cell that can contribute is not forgotten.
                let [left, right] = [self.u(i), self.u(i + 1)].map(|u| libm::sincos(TAU * (u - 0.5)));
                let weight = weight(i, j);
                let corners = [(edges[0], left), (edges[0], right), (edges[1], left), (edges[1], right)].map(
                    |(cos, (sin_phi, cos_phi))| {
                        let sin = (1.0 - cos * cos).max(0.0).sqrt();
                        DVec3::new(sin * sin_phi, cos, -sin * cos_phi)
                    },
                );
                for (k, sum) in sums.iter_mut().enumerate() {
                    let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                    let cosine = corners.iter().map(|c| sign * c[k / 2]).fold(0.0, f64::max);
                    *sum += weight * cosine;
                }
            }
        }
        sums.map(|sum| sum as f32)
    }
}
