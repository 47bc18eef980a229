//! The long tables, with stable columns.

use translucid_profile::Parameterization;

use super::word;
use crate::comparison::{Comparison, Curve, R_MAX};
use crate::{Cell, DataTable};

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
            table.push([
                Cell::from(row.contender),
                Cell::from(word(row.configuration)),
                Cell::from(row.inversion.name()),
                Cell::from(row.surface_albedo),
                Cell::from(r_max),
                Cell::from(error),
            ]);
        }
    }
    table
}

fn timing(comparison: &Comparison) -> DataTable {
    let columns = ["model", "quantity", "nanoseconds", "median_nanoseconds", "rounds"];
    let mut table = DataTable::new("timing", "Times", &columns);
    for timing in &comparison.timings {
        table.push([
            Cell::from(timing.contender),
            Cell::from(timing.quantity.name()),
            Cell::from(timing.nanoseconds),
            Cell::from(timing.median),
            Cell::from(timing.rounds as f64),
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
                table.push([
                    Cell::from(word(figure.configuration)),
                    Cell::from(figure.surface_albedo),
                    Cell::from(curve.name),
                    Cell::from(*r),
                    Cell::from(curve.reflectance[i]),
                    Cell::from(curve.enclosed[i]),
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
            table.push([
                Cell::from(word(figure.configuration)),
                Cell::from(figure.surface_albedo),
                Cell::from(figure.single_scattering_albedo),
                Cell::from(point.r),
                Cell::from(point.reflectance),
                Cell::from(point.standard_error),
                Cell::from(point.exact),
                Cell::from(point.photons),
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
            let [a, s, error] = [a, s, error].map(|number| Cell::from(*number));
            table.push([Cell::from(word(case.configuration)), Cell::from(parameter), a, s, error]);
        }
    }
    table
}

fn samples(comparison: &Comparison) -> DataTable {
    let columns = ["model", "surface_albedo", "left", "right", "count", "expected"];
    let mut table = DataTable::new("samples", "Drawn radii", &columns);
    for test in &comparison.samples {
        for (i, (count, expected)) in test.counts.iter().zip(&test.expected).enumerate() {
            table.push([
                Cell::from(test.contender),
                Cell::from(test.surface_albedo),
                Cell::from(test.edges[i]),
                Cell::from(test.edges.get(i + 1).copied().unwrap_or(f64::INFINITY)),
                Cell::from(*count as f64),
                Cell::from(*expected),
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
            let numbers = [curve.eta, *degrees, *exact, *approximate].map(Cell::from);
            let [eta, degrees, exact, approximate] = numbers;
            table.push([Cell::from(curve.side.name()), eta, degrees, exact, approximate]);
        }
    }
    table
}
