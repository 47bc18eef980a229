//! Generates the tables of the exact half space that `ExactProfile` carries.
//!
//! ```text
//! cargo run --release -p translucid-reference --example exact_table -- crates/translucid-profile/data
//! ```
//!
//! A row is one surface albedo, rows are equidistant in the angle θ with 1 − A = cos⁴θ, and between them logarithms are interpolated.
//! For each cell of radii (one from 0 to the first octave, then 2^j in each octave) a row holds the logarithms of its
//! share of the energy and of its weight, of each end that of the density per length: see `exact_table.rs` and
//! `monotone_cell.rs` of `translucid-profile`, which read them.

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

use translucid_profile::{Configuration, ParameterError};
use translucid_reference::{Incidence, exact::HalfSpace};

/// Rows of a table.
const ROWS: usize = 49;
/// The first octave begins at 2^this, the last one ends at 2^`LAST_EXPONENT`.
const FIRST_EXPONENT: i32 = -12;
const LAST_EXPONENT: i32 = 14;
/// Up to this radius the density keeps its digits however small it is.
const NEAR: f64 = 32.0;
/// Relative error of the density in the middle of a cell at which it is narrow enough, near and far.
const TOLERANCE: f64 = 1e-5;
/// Beyond [`NEAR`] a share has this error, or 1e-6 of it.
const FAR_TOLERANCE: f64 = 1e-10;
/// Logarithms below this are of nothing.
const LEAST_LOGARITHM: f64 = -600.0;

/// Figures at a radius, in parts of all energy.
#[derive(Clone, Copy)]
struct Knot {
    r: f64,
    within: f64,
    beyond: f64,
    density: f64,
}

struct Cell {
    share: f64,
    weight: f64,
    /// Error of the density in the middle, in parts of it, and of the share between middle and ends.
    error: [f64; 2],
}

#[allow(clippy::print_stdout, reason = "an example shows its results")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "crates/translucid-profile/data".to_owned());
    for (configuration, name) in
        [(Configuration::Searchlight, "searchlight"), (Configuration::Diffuse, "diffuse")]
    {
        let bytes = table(configuration, name)?;
        let path = Path::new(&folder).join(format!("exact-{name}.bin"));
        std::fs::write(&path, &bytes)?;
        println!("{}: {} bytes", path.display(), bytes.len());
    }
    Ok(())
}

/// The half spaces of the rows. The first stands for A → 0, where all light is scattered once.
fn half_spaces(configuration: Configuration) -> Result<Vec<HalfSpace>, ParameterError> {
    let incidence = Incidence::from(configuration);
    let row = |i: usize| {
        let sine = (0.5 * PI * i as f64 / (ROWS - 1) as f64).sin();
        if i == 0 {
            return HalfSpace::new(1e-12, incidence);
        }
        HalfSpace::from_surface_albedo(sine * sine * (2.0 - sine * sine), incidence)
    };
    (0..ROWS).map(row).collect()
}

fn table(configuration: Configuration, name: &str) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let rows = half_spaces(configuration)?;

    // Halve the cells of every octave until they are narrow enough for every row
    let octaves: Vec<(u32, Vec<f64>)> =
        (FIRST_EXPONENT..LAST_EXPONENT).map(|exponent| octave(&rows, exponent)).collect();
    let mut radii = vec![0.0];
    radii.extend(octaves.iter().flat_map(|(_, starts)| starts));
    radii.push(f64::from(LAST_EXPONENT).exp2());

    // Write the header
    let mut header = String::new();
    writeln!(
        header,
        "Exact half space of isotropic scatterers without a boundary, {name}; lengths in mean free paths."
    )?;
    writeln!(header, "Made by: cargo run --release -p translucid-reference --example exact_table")?;
    writeln!(
        header,
        "Error: below 1e-6 in the cdf, 5e-5 of the profile up to 20 mean free paths (1e-3 of it for A < 0.02)."
    )?;
    writeln!(header, "rows {ROWS}")?;
    writeln!(header, "first_exponent {FIRST_EXPONENT}")?;
    let bits: Vec<String> = octaves.iter().map(|(bits, _)| bits.to_string()).collect();
    writeln!(header, "octaves {}\n", bits.join(" "))?;

    // Write the rows
    let mut bytes = header.into_bytes();
    for half_space in &rows {
        let knots: Vec<Knot> = radii.iter().map(|r| knot(half_space, *r)).collect();
        let cells: Vec<Cell> = knots.windows(2).map(|pair| cell(half_space, &pair[0], &pair[1])).collect();
        let last = knots[knots.len() - 1];
        let shares = cells.iter().map(|cell| cell.share).chain([last.beyond]);
        let densities = knots.iter().map(|knot| knot.density);
        let weights = cells.iter().map(|cell| cell.weight);
        for value in shares.chain(densities).chain(weights) {
            bytes.extend((value.ln().max(LEAST_LOGARITHM) as f32).to_le_bytes());
        }
    }
    Ok(bytes)
}

/// Number of times that an octave is halved, and the start of its cells.
fn octave(rows: &[HalfSpace], exponent: i32) -> (u32, Vec<f64>) {
    let start = f64::from(exponent).exp2();
    for bits in 0.. {
        let radii: Vec<f64> =
            (0..=1 << bits).map(|i| start * (1.0 + f64::from(i) / f64::from(1 << bits))).collect();
        let fits = |half_space: &HalfSpace| {
            let knots: Vec<Knot> = radii.iter().map(|r| knot(half_space, *r)).collect();
            knots.windows(2).all(|pair| {
                let [density, share] = cell(half_space, &pair[0], &pair[1]).error;
                let lesser = pair[1].within.min(pair[0].beyond);
                let is_far = pair[1].r > NEAR;
                if is_far { share < (1e-6 * lesser).max(FAR_TOLERANCE) } else { density < TOLERANCE }
            })
        };
        if bits == 6 || rows.iter().all(fits) {
            return (bits, radii[..radii.len() - 1].to_vec());
        }
    }
    unreachable!("the loop returns at the last depth")
}

fn knot(half_space: &HalfSpace, r: f64) -> Knot {
    let total = half_space.total().value;
    // R grows like 1/r: r R at 0 is that of a small r
    let positive = r.max(1e-100);
    Knot {
        r,
        within: half_space.enclosed(r).value / total,
        beyond: half_space.beyond(r).value / total,
        density: 2.0 * PI * positive * (half_space.eval(positive).value / total),
    }
}

fn cell(half_space: &HalfSpace, start: &Knot, end: &Knot) -> Cell {
    let share_of =
        |a: &Knot, b: &Knot| if a.within < 0.5 { b.within - a.within } else { a.beyond - b.beyond };
    let middle = knot(half_space, 0.5 * (start.r + end.r));
    let (width, share) = (end.r - start.r, share_of(start, end));
    if share.is_nan() || share < 1e-250 {
        return Cell { share: 0.0, weight: 1.0, error: [0.0; 2] };
    }
    let (d0, d1, s) =
        (start.density * width / share, end.density * width / share, share_of(start, &middle) / share);
    let weight = (d0 * (1.0 - s) - s) / (d1 * s - (1.0 - s));
    let weight = if weight > 1.0 / 256.0 && weight < 256.0 { weight } else { 1.0 };
    // The density at θ = ½
    let q = 1.0 + d0 + weight * (d1 + 1.0);
    let density = share / width * 4.0 * (d0 + weight * (2.0 + weight * d1)) / (q * q);
    let off = (density - middle.density).abs();
    Cell { share, weight, error: [off / middle.density, 0.143 * off * width] }
}
