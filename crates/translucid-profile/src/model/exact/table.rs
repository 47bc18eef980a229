//! The exact half space as rows over the surface albedo, and the table of radii for an albedo between them.
//!
//! The rows are equidistant in the angle θ ∈ [0, π/2] with 1 − A = cos⁴θ, and all have the same cells of radii.
//! Logarithms of shares, densities and weights (see `monotone_cell.rs`) are polynomials through six rows:
//! logarithms, because far out energy falls like e^{−k₀(A) r}; in θ, because α rises to ½ before A does to 0.1,
//! and because k₀ ~ 1 − A lets profiles change the faster the farther out.
//! A is even about both ends of θ, so that rows go on beyond them as in a mirror.
//! The result is positive, so its cdf rises, whatever the interpolation's error.
//!
//! `data/exact-*.bin` are made by the example `exact_table` of `translucid-reference`: a header of text, an empty
//! line, then rows of `f32`, least byte first.

use std::f64::consts::FRAC_PI_2;
use std::sync::OnceLock;

use crate::Configuration;
use crate::table::monotone_cell::Cell;
use crate::table::radial_table::{RadialTable, Tail};

/// Rows that an interpolation takes part in.
const POINTS: usize = 6;
/// Number of these rows before the one at or before the albedo.
const BEFORE: usize = 2;
/// Share beyond a radius at which the table ends.
const TAIL_SHARE: f64 = 1e-30;

/// Rows of one configuration.
#[derive(Debug)]
pub(crate) struct ExactTable {
    first_exponent: i32,
    /// Binary logarithm of the number of cells in each octave.
    octaves: Vec<u32>,
    /// Ends of cells, from 0.
    radii: Vec<f64>,
    /// Logarithms: of each cell's share and of what is beyond; of the density at each end; of each cell's weight.
    rows: Vec<Vec<f32>>,
}

impl ExactTable {
    /// The table of a configuration, read from what the crate carries when it is first asked for.
    pub(crate) fn of(configuration: Configuration) -> &'static Self {
        static SEARCHLIGHT: OnceLock<ExactTable> = OnceLock::new();
        static DIFFUSE: OnceLock<ExactTable> = OnceLock::new();
        let (table, bytes): (_, &[u8]) = match configuration {
            Configuration::Searchlight => {
                (&SEARCHLIGHT, include_bytes!("../../../data/exact-searchlight.bin"))
            }
            Configuration::Diffuse => (&DIFFUSE, include_bytes!("../../../data/exact-diffuse.bin")),
        };
        table.get_or_init(|| Self::parse(bytes).expect("the table that the crate carries is whole"))
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        let end = bytes.windows(2).position(|pair| pair == b"\n\n")?;
        let header = std::str::from_utf8(&bytes[..end]).ok()?;
        let entry = |name: &str| header.lines().find_map(|line| line.strip_prefix(name));
        let first_exponent = entry("first_exponent ")?.parse().ok()?;
        let octaves: Vec<u32> =
            entry("octaves ")?.split(' ').map(|bits| bits.parse().ok()).collect::<Option<_>>()?;
        let radii = radii(first_exponent, &octaves);
        let values: Vec<f32> =
            bytes[end + 2..].as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        let rows: Vec<Vec<f32>> = values.chunks(3 * radii.len() - 1).map(<[f32]>::to_vec).collect();
        let is_whole = rows.len() == entry("rows ")?.parse().ok()? && rows.len() >= POINTS;
        let is_whole = is_whole && rows.iter().all(|row| row.len() == 3 * radii.len() - 1);
        is_whole.then_some(Self { first_exponent, octaves, radii, rows })
    }

    /// The distribution of radii for a surface albedo A ∈ [0, 1], in mean free paths.
    pub(crate) fn at(&self, surface_albedo: f64) -> RadialTable {
        // Interpolate logarithms
        let (rows, weights) = self.interpolation(angle(surface_albedo));
        let value = |i: usize| {
            let terms = rows.iter().zip(&weights).map(|(row, weight)| weight * f64::from(row[i]));
            libm::exp(terms.sum::<f64>().min(50.0))
        };
        let count = self.radii.len() - 1;
        let mut shares: Vec<f64> = (0..=count).map(value).collect();
        let densities: Vec<f64> = (count + 1..2 * count + 2).map(value).collect();

        // What is within and beyond every end of a cell
        let total: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|share| *share /= total);
        let mut beyond = vec![shares[count]; count + 1];
        for i in (0..count).rev() {
            beyond[i] = beyond[i + 1] + shares[i];
        }

        // Cells up to where nothing is left
        let kept = beyond.iter().position(|beyond| *beyond < TAIL_SHARE).unwrap_or(count).max(1);
        let mut within = 0.0;
        let mut cells = Vec::with_capacity(kept);
        for i in 0..kept {
            let width = self.radii[i + 1] - self.radii[i];
            let slope = |density: f64| density * width / (shares[i] * total);
            cells.push(Cell {
                start: self.radii[i],
                inverse_width: 1.0 / width,
                within,
                beyond: beyond[i + 1],
                share: shares[i],
                slope_in: slope(densities[i]),
                slope_out: slope(densities[i + 1]),
                weight: value(2 * count + 2 + i),
            });
            within += shares[i];
        }
        let tail = Tail::with_density(self.radii[kept], beyond[kept], densities[kept] / total);
        RadialTable::new(self.first_exponent, &self.octaves, cells, tail)
    }

    /// The rows that take part, and their weights in Lagrange's polynomial for the angle θ ∈ [0, π/2].
    fn interpolation(&self, angle: f64) -> ([&[f32]; POINTS], [f64; POINTS]) {
        let last = self.rows.len() - 1;
        let t = angle * last as f64 / FRAC_PI_2;
        let whole = (t as usize).min(last - 1);
        let row = |i: usize| {
            // Rows before the first and behind the last are mirrored
            let i = (whole + i).abs_diff(BEFORE);
            &self.rows[if i > last { 2 * last - i } else { i }][..]
        };
        let t = t - whole as f64 + BEFORE as f64;
        let weight = |i: usize| {
            let others = (0..POINTS).filter(|j| *j != i);
            others.map(|j| (t - j as f64) / (i as f64 - j as f64)).product()
        };
        (std::array::from_fn(row), std::array::from_fn(weight))
    }
}

/// θ with 1 − A = cos⁴θ, with the digits of A and of 1 − A.
fn angle(surface_albedo: f64) -> f64 {
    let cosine_squared = (1.0 - surface_albedo).sqrt();
    let sine_squared = surface_albedo / (1.0 + cosine_squared);
    libm::atan2(sine_squared.sqrt(), cosine_squared.sqrt())
}

/// Ends of the cells: 0, then those of the octaves.
fn radii(first_exponent: i32, octaves: &[u32]) -> Vec<f64> {
    let mut radii = vec![0.0];
    for (bits, exponent) in octaves.iter().zip(first_exponent..) {
        let count = 1 << bits;
        radii.extend(
            (0..count).map(|i| libm::exp2(f64::from(exponent)) * (1.0 + f64::from(i) / f64::from(count))),
        );
    }
    radii.push(libm::exp2(f64::from(first_exponent + octaves.len() as i32)));
    radii
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_says_what_the_table_is() {
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            let table = ExactTable::of(configuration);
            assert!(table.rows.len() > 20 && table.radii.len() > 60);
            assert!(table.rows.iter().flatten().all(|logarithm| logarithm.is_finite() && *logarithm < 10.0));
        }
        assert!(ExactTable::parse(b"rows 41\nfirst_exponent -7\noctaves 0 1\n\nshort").is_none());
        assert!(ExactTable::parse(b"").is_none());
    }

    /// cos 2θ, which is even about both ends: six points at steps of 0.033 are off by 3e-10.
    #[test]
    fn interpolation_is_smooth_up_to_both_ends() {
        let angles = (0..49).map(|i| FRAC_PI_2 / 48.0 * f64::from(i));
        let rows = angles.map(|angle| vec![(2.0 * angle).cos() as f32]).collect();
        let table = ExactTable { first_exponent: 0, octaves: Vec::new(), radii: Vec::new(), rows };
        for i in 0..=1000 {
            let theta = FRAC_PI_2 * f64::from(i) / 1000.0;
            let (rows, weights) = table.interpolation(theta);
            let found: f64 = rows.iter().zip(&weights).map(|(row, weight)| weight * f64::from(row[0])).sum();
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            // What single precision leaves of six values
            assert!((found - (2.0 * theta).cos()).abs() < 1e-7, "{theta}: {found}");
        }
    }

    #[test]
    fn angle_keeps_the_digits_of_both_ends() {
        for (a, expected) in [(0.0, 0.0), (1.0, FRAC_PI_2), (2e-20, 1e-10), (0.75, FRAC_PI_2 / 2.0)] {
            assert!((angle(a) - expected).abs() <= 1e-15 * expected, "{a}: {}", angle(a));
        }
        let (rest, expected) = (1e-12, FRAC_PI_2 - 1e-3);
        assert!((angle(1.0 - rest) - expected).abs() < 1e-7);
    }
}
