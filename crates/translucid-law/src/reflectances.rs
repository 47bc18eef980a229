//! Directional albedos of rough interfaces, interpolated in tables.
//!
//! Tables are over (t, ρ), ρ the perceptual roughness and
//!
//! ```text
//! t = √μ (1 + ρ) / (√μ + ρ)
//! ```
//!
//! in which shadowing at grazing angles, a function of μ/α, keeps its shape however small α = ρ² gets.

use crate::dielectric::fresnel_dielectric;
use crate::ggx::Ggx;

/// Nodes over t.
pub const COLUMNS: u32 = 40;
/// Nodes over roughness.
pub const ROWS: u32 = 24;
/// Roughnesses of averages: the mirror, then the rows.
pub const AVERAGE_ROWS: u32 = 25;
/// Nodes of the losses under a coat over t: they are small and smooth.
pub const LOSS_COLUMNS: u32 = 16;
/// Nodes of the losses over the base's roughness.
pub const LOSS_ROWS: u32 = 8;
/// Nodes of the losses over the coat's roughness.
pub const COAT_ROWS: u32 = 6;
/// Levels of F₀ of glass: 4⁻ᵏ.
pub const GLASS_LEVELS: u32 = 4;
/// Roughness of the first row: the square root of the smallest width that is not a mirror.
pub const SMOOTHEST: f32 = 0.031_622_777;

/// A place between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// The node below.
    pub(crate) node: u32,
    /// Where it is on the way to the next one, in [0, 1].
    pub(crate) between: f32,
}

/// The place of a coordinate in nodes.
#[inline]
pub(crate) fn place_of(x: f32, nodes: u32) -> Place {
    let node = (x.max(0.0) as u32).min(nodes - 2_u32);
    Place { node, between: (x - node as f32).clamp(0.0, 1.0) }
}

/// The place of a roughness among rows.
#[inline]
pub(crate) fn row_of(roughness: f32, rows: u32) -> Place {
    place_of((roughness - SMOOTHEST) * ((rows - 1_u32) as f32 / (1.0 - SMOOTHEST)), rows)
}

/// Linear interpolation.
#[inline]
pub(crate) fn linear(a: f32, b: f32, x: f32) -> f32 {
    a + (b - a) * x
}

/// A table's value at a cosine and a roughness that is not a mirror's, bilinear between nodes.
#[inline]
pub fn grid_value(grid: &[f32], columns: u32, rows: u32, mu: f32, roughness: f32) -> f32 {
    let root = mu.sqrt();
    let t = root * (1.0 + roughness) / (root + roughness);
    let column = place_of(t * (columns - 1_u32) as f32, columns);
    let row = row_of(roughness, rows);
    let low = row.node * columns + column.node;
    let high = low + columns;
    linear(
        linear(grid[low as usize], grid[(low + 1_u32) as usize], column.between),
        linear(grid[high as usize], grid[(high + 1_u32) as usize], column.between),
        row.between,
    )
}

/// Rows of averages around a roughness: the mirror stands alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AverageRows {
    /// The row below.
    pub(crate) low: u32,
    /// The row above.
    pub(crate) high: u32,
    /// Where the roughness is between them, in [0, 1].
    pub(crate) between: f32,
}

/// The rows of averages around a roughness.
#[inline]
pub(crate) fn average_rows(roughness: f32) -> AverageRows {
    if Ggx::from_roughness(roughness).is_smooth() {
        return AverageRows { low: 0_u32, high: 0_u32, between: 0.0 };
    }
    let row = row_of(roughness, ROWS);
    AverageRows { low: row.node + 1_u32, high: row.node + 2_u32, between: row.between }
}

/// The average at a roughness.
#[inline]
pub fn average_at(averages: &[f32], roughness: f32) -> f32 {
    let rows = average_rows(roughness);
    linear(averages[rows.low as usize], averages[rows.high as usize], rows.between)
}

/// The average at roughnesses of the coat (rows) and of the base (columns).
#[inline]
pub fn average_at_both(averages: &[f32], roughness: f32, coat_roughness: f32) -> f32 {
    let coat = average_rows(coat_roughness);
    let base = average_rows(roughness);
    let low = coat.low * AVERAGE_ROWS;
    let high = coat.high * AVERAGE_ROWS;
    linear(
        linear(averages[(low + base.low) as usize], averages[(low + base.high) as usize], base.between),
        linear(averages[(high + base.low) as usize], averages[(high + base.high) as usize], base.between),
        coat.between,
    )
}

/// Directional albedo of a dielectric's reflection from outside, whose table holds what it exceeds Fresnel's reflectance by.
#[inline]
pub fn reflectance_at(excess: &[f32], eta: f32, mu: f32, roughness: f32) -> f32 {
    let fresnel = fresnel_dielectric(mu, eta);
    if Ggx::from_roughness(roughness).is_smooth() {
        return fresnel;
    }
    (fresnel + grid_value(excess, COLUMNS, ROWS, mu, roughness)).clamp(0.0, 1.0)
}

/// Share of light that single scattering by the facets of a lossless metal loses; 0 for a mirror.
#[inline]
pub fn deficit_at(deficit: &[f32], mu: f32, roughness: f32) -> f32 {
    if Ggx::from_roughness(roughness).is_smooth() {
        return 0.0;
    }
    grid_value(deficit, COLUMNS, ROWS, mu, roughness).clamp(0.0, 1.0)
}

/// Light that a lobe under a coat loses to it beyond the coat's loss in the direction seen.
#[inline]
pub fn loss_at(losses: &[f32], mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
    if Ggx::from_roughness(roughness).is_smooth() {
        return 0.0;
    }
    let row = place_of(coat_roughness * (COAT_ROWS - 1_u32) as f32, COAT_ROWS);
    let low = row.node * (LOSS_COLUMNS * LOSS_ROWS);
    let high = low + LOSS_COLUMNS * LOSS_ROWS;
    linear(
        grid_value(&losses[low as usize..], LOSS_COLUMNS, LOSS_ROWS, mu, roughness),
        grid_value(&losses[high as usize..], LOSS_COLUMNS, LOSS_ROWS, mu, roughness),
        row.between,
    )
}

/// The cosine mean of that light.
#[inline]
pub fn average_loss_at(averages: &[f32], roughness: f32, coat_roughness: f32) -> f32 {
    if Ggx::from_roughness(roughness).is_smooth() {
        return 0.0;
    }
    let row = place_of(coat_roughness * (COAT_ROWS - 1_u32) as f32, COAT_ROWS);
    let base = row_of(roughness, LOSS_ROWS);
    let low = row.node * LOSS_ROWS + base.node;
    let high = low + LOSS_ROWS;
    linear(
        linear(averages[low as usize], averages[(low + 1_u32) as usize], base.between),
        linear(averages[high as usize], averages[(high + 1_u32) as usize], base.between),
        row.between,
    )
}
