//! Errors of fits over many surface albedos, as text and as a table.

use std::fmt::Write;

use translucid_fit::ErrorSummary;
use translucid_laboratory::comparison::R_MAX;
use translucid_laboratory::{Cell, DataTable};

/// Errors of one fit up to each of [`R_MAX`].
pub(super) struct Errors {
    /// Name of the fit, in one word.
    pub(super) name: &'static str,
    pub(super) summaries: [ErrorSummary; 3],
}

/// The errors as `errors.csv`; an empty r_max means all radii.
pub(super) fn table(errors: &[Errors]) -> DataTable {
    let columns = ["fit", "r_max", "mean_error", "worst_error", "worst_surface_albedo"];
    let mut table = DataTable::new("errors", "", &columns);
    for of in errors {
        for (r_max, summary) in R_MAX.into_iter().zip(&of.summaries) {
            let numbers = [r_max, summary.mean, summary.worst, summary.worst_surface_albedo];
            table.rows.push([Cell::from(of.name)].into_iter().chain(numbers.map(Cell::from)).collect());
        }
    }
    table
}

/// The errors in percent, as columns of text.
pub(super) fn text(errors: &[Errors]) -> String {
    let mut text = String::from("error in percent: mean, worst (at A)\n");
    let heads = R_MAX.map(|r_max| format!("{:<22}", range(r_max)));
    line(&mut text, "", heads.as_slice());
    for of in errors {
        let cell = |s: &ErrorSummary| {
            let (mean, worst) = (100.0 * s.mean, 100.0 * s.worst);
            format!("{:<22}", format!("{mean:5.2}, {worst:5.2} ({:.2})", s.worst_surface_albedo))
        };
        line(&mut text, of.name, &of.summaries.iter().map(cell).collect::<Vec<_>>());
    }
    text
}

/// The radii that count, in words.
pub(super) fn range(r_max: f64) -> String {
    if r_max.is_finite() { format!("r <= {r_max}") } else { String::from("all r") }
}

fn line(text: &mut String, name: &str, cells: &[String]) {
    let cells = cells.concat();
    // Writing to a string does not fail
    let _ = writeln!(text, "  {name:<12}{}", cells.trim_end());
}
