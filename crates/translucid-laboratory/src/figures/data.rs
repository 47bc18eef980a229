//! The long tables, with stable columns.

use crate::DataTable;
use crate::comparison::{Comparison, Curve, R_MAX, RingPoint, Timing};
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
    for one in &comparison.errors.rows {
        let (light, medium) = (one.configuration.name(), one.inversion.name());
        for (r_max, error) in R_MAX.into_iter().zip(one.errors) {
            table.rows.push(row![one.contender, light, medium, one.surface_albedo, r_max, error]);
        }
    }
    table
}

fn timing(comparison: &Comparison) -> DataTable {
    let columns = ["model", "quantity", "nanoseconds", "median_nanoseconds", "rounds"];
    let mut table = DataTable::new("timing", "Times", &columns);
    for Timing { contender, quantity, nanoseconds, median, rounds } in &comparison.timings {
        table.rows.push(row![*contender, quantity.name(), *nanoseconds, *median, *rounds as f64]);
    }
    table
}

fn reflectance(comparison: &Comparison) -> DataTable {
    let columns = ["configuration", "surface_albedo", "model", "r", "reflectance", "enclosed"];
    let mut table = DataTable::new("reflectance", "Profiles", &columns);
    for figure in &comparison.reflectances {
        let solution = Curve { name: "exact-solution", ..figure.exact.clone() };
        let (light, a) = (figure.configuration.name(), figure.surface_albedo);
        for curve in [&solution].into_iter().chain(&figure.curves) {
            for (i, r) in figure.radii.iter().enumerate() {
                table.rows.push(row![light, a, curve.name, *r, curve.reflectance[i], curve.enclosed[i]]);
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
        let (light, a) = (figure.configuration.name(), figure.surface_albedo);
        let alpha = figure.single_scattering_albedo;
        for RingPoint { r, reflectance, standard_error, exact, photons } in &figure.points {
            table.rows.push(row![light, a, alpha, *r, *reflectance, *standard_error, *exact, *photons]);
        }
    }
    table
}

fn scaling(comparison: &Comparison) -> DataTable {
    let columns = ["configuration", "parameter", "surface_albedo", "s", "error"];
    let mut table = DataTable::new("scaling", "Best scales of normalized diffusion", &columns);
    for case in &comparison.scaling {
        let parameter = case.parameterization.name();
        for [a, s, error] in &case.points {
            table.rows.push(row![case.configuration.name(), parameter, *a, *s, *error]);
        }
    }
    table
}

fn samples(comparison: &Comparison) -> DataTable {
    let columns = ["model", "surface_albedo", "left", "right", "count", "expected"];
    let mut table = DataTable::new("samples", "Drawn radii", &columns);
    for test in &comparison.samples {
        for (i, (count, expected)) in test.counts.iter().zip(&test.expected).enumerate() {
            let (left, right) = (test.edges[i], test.edges.get(i + 1).copied().unwrap_or(f64::INFINITY));
            let (name, a) = (test.contender, test.surface_albedo);
            table.rows.push(row![name, a, left, right, *count as f64, *expected]);
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
