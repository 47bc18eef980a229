//! The long tables, with stable columns.

use translucid_profile::Parameterization;

use super::word;
use crate::DataTable;
use crate::comparison::{Comparison, Curve, R_MAX};
use crate::data_table::row;

/// All of them: what `translucid compare --help` describes.
pub(super) fn tables(comparison: &Comparison) -> Vec<DataTable> {
    vec![
        errors(comparison),
        timing(comparison),
        reflectance(comparison),
        monte_carlo(comparison),
        scaling(comparison),
        samples(comparison),
        fresnel(comparison),
    ]
}

fn errors(comparison: &Comparison) -> DataTable {
    let columns = ["model", "configuration", "medium", "surface_albedo", "r_max", "error"];
    let mut table = DataTable::new("errors", "Errors", &columns);
    for row in &comparison.errors.rows {
        for (r_max, error) in R_MAX.into_iter().zip(row.errors) {
            table.rows.push(row![
                row.contender,
                word(row.configuration),
                row.inversion.name(),
                row.surface_albedo,
                r_max,
                error
            ]);
        }
    }
    table
}

fn timing(comparison: &Comparison) -> DataTable {
    let columns = ["model", "quantity", "nanoseconds", "median_nanoseconds", "rounds"];
    let mut table = DataTable::new("timing", "Times", &columns);
    for timing in &comparison.timings {
        table.rows.push(row![
            timing.contender,
            timing.quantity.name(),
            timing.nanoseconds,
            timing.median,
            timing.rounds as f64
        ]);
    }
    table
}

fn reflectance(comparison: &Comparison) -> DataTable {
    let columns = ["configuration", "surface_albedo", "model", "r", "reflectance", "enclosed"];
    let mut table = DataTable::new("reflectance", "Profiles", &columns);
    for figure in &comparison.reflectances {
        let solution = Curve { name: "exact-solution", ..figure.exact.clone() };
        for curve in [&solution].into_iter().chain(&figure.curves) {
            for (i, r) in figure.radii.iter().enumerate() {
                table.rows.push(row![
                    word(figure.configuration),
                    figure.surface_albedo,
                    curve.name,
                    *r,
                    curve.reflectance[i],
                    curve.enclosed[i]
                ]);
            }
        }
    }
    table
}

fn monte_carlo(comparison: &Comparison) -> DataTable {
    let columns = [
        "configuration",
        "surface_albedo",
        "single_scattering_albedo",
        "r",
        "reflectance",
        "standard_error",
        "exact",
        "photons",
    ];
    let mut table = DataTable::new("monte-carlo", "Photons in rings", &columns);
    for figure in &comparison.reflectances {
        for point in &figure.points {
            table.rows.push(row![
                word(figure.configuration),
                figure.surface_albedo,
                figure.single_scattering_albedo,
                point.r,
                point.reflectance,
                point.standard_error,
                point.exact,
                point.photons
            ]);
        }
    }
    table
}

fn scaling(comparison: &Comparison) -> DataTable {
    let columns = ["configuration", "parameter", "surface_albedo", "s", "error"];
    let mut table = DataTable::new("scaling", "Best scales of normalized diffusion", &columns);
    for case in &comparison.scaling {
        let parameter = match case.parameterization {
            Parameterization::Mfp => "mfp",
            Parameterization::Dmfp => "dmfp",
        };
        for [a, s, error] in &case.points {
            table.rows.push(row![word(case.configuration), parameter, *a, *s, *error]);
        }
    }
    table
}

fn samples(comparison: &Comparison) -> DataTable {
    let columns = ["model", "surface_albedo", "left", "right", "count", "expected"];
    let mut table = DataTable::new("samples", "Drawn radii", &columns);
    for test in &comparison.samples {
        for (i, (count, expected)) in test.counts.iter().zip(&test.expected).enumerate() {
            table.rows.push(row![
                test.contender,
                test.surface_albedo,
                test.edges[i],
                test.edges.get(i + 1).copied().unwrap_or(f64::INFINITY),
                *count as f64,
                *expected
            ]);
        }
    }
    table
}

fn fresnel(comparison: &Comparison) -> DataTable {
    let columns = ["side", "eta", "degrees", "fresnel", "schlick"];
    let mut table = DataTable::new("fresnel", "Reflectance of a boundary", &columns);
    for curve in &comparison.fresnel {
        for [degrees, exact, approximate] in &curve.points {
            table.rows.push(row![curve.side.name(), curve.eta, *degrees, *exact, *approximate]);
        }
    }
    table
}
