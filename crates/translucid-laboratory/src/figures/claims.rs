//! Claims of the talk, with what came out.

use super::errors::versus;
use super::{percent, section_of};
use crate::comparison::{Claim, Comparison, R_MAX};
use crate::{Block, Cell, DataTable, Section};

pub(super) fn section(comparison: &Comparison) -> Section {
    let mut blocks = Vec::new();
    if !comparison.claims.is_empty() {
        blocks.push(Block::Text(summary(&comparison.claims)));
        blocks.push(Block::Table(table(comparison)));
    }
    if !comparison.scaling.is_empty() {
        blocks.push(Block::Table(stated(comparison)));
    }
    section_of("What the talk claims", blocks)
}

/// Number of the talk's claims that hold, in words.
fn summary(claims: &[Claim]) -> String {
    let of_the_talk: Vec<&Claim> = claims.iter().filter(|claim| claim.is_the_talks).collect();
    let held = of_the_talk.iter().filter(|claim| claim.holds() == Some(true)).count();
    let text = format!(
        "Of {} comparisons that the talk makes, {held} hold at every albedo asked for and in the mean. The others of \
         the table put variants of the same models to the same test. Normalized diffusion was fitted to Monte Carlo \
         of this very case, the models of media were fitted to nothing.",
        of_the_talk.len()
    );
    let failed = of_the_talk.iter().filter(|claim| claim.holds() == Some(false));
    let failed: Vec<String> = failed.map(|claim| format!("\"{}\"", claim.statement)).collect();
    if failed.is_empty() { text } else { format!("{text} Not everywhere true: {}.", failed.join(", ")) }
}

/// All claims: errors in percent, and whether they bear the claim out.
fn table(comparison: &Comparison) -> DataTable {
    let albedos: Vec<String> =
        comparison.settings.surface_albedos.iter().map(|a| format!("A = {a}")).collect();
    let mut columns = vec!["claim", "of the talk"];
    columns.extend(albedos.iter().map(String::as_str));
    columns.push("mean");
    let caption = "Claims, searchlight, error over all radii: of the first model : of the second";
    let mut table = DataTable::new("claims", caption, &columns);
    for claim in &comparison.claims {
        let verdict = |errors: &Option<[f64; 2]>| match errors {
            Some(errors) => {
                let word = if Claim::is_confirmed(*errors) { "confirmed" } else { "refuted" };
                Cell::from(format!("{word} ({})", versus(*errors)))
            }
            None => Cell::Number(f64::NAN),
        };
        let talk = if claim.is_the_talks { "yes" } else { "no" };
        let mut row = vec![Cell::from(claim.statement.as_str()), Cell::from(talk)];
        row.extend(claim.errors.iter().chain([&claim.means]).map(verdict));
        table.rows.push(row);
    }
    table
}

/// The mean errors that the talk states for its polynomials.
fn stated(comparison: &Comparison) -> DataTable {
    let columns = ["s(A)", "stated: about", "r ≤ 8 ℓ", "r ≤ 16 ℓ", "all r", "verdict"];
    let caption = "Mean errors of the talk's polynomials s(A) over A = 0.01, 0.02, … 0.99";
    let mut table = DataTable::new("stated-errors", caption, &columns);
    for case in &comparison.scaling {
        let (Some(stated), Some((nearest, is_confirmed))) = (case.stated, case.reproduction()) else {
            continue;
        };
        let range = if R_MAX[nearest].is_finite() {
            format!("r ≤ {} ℓ", R_MAX[nearest])
        } else {
            String::from("all r")
        };
        let word = if is_confirmed { "confirmed" } else { "refuted" };
        let verdict = format!("{word}: {} for {range}", percent(case.talk_errors[nearest].mean));
        let [a, b, c] = case.talk_errors.map(|errors| Cell::from(percent(errors.mean)));
        let stated = format!("{:.1} %", 100.0 * stated);
        table.push([Cell::from(case.name()), Cell::from(stated), a, b, c, Cell::from(verdict)]);
    }
    table
}
