//! Tables in Markdown.

use translucid_laboratory::comparison::{
    Claim, Contender, ErrorTable, Group, Inversion, Quantity, R_MAX, Reference, ScalingCase, Timing,
};
use translucid_profile::{
    Configuration, Model, Parameterization, Profile, RefinedDiffusion, SampledProfile, TabulatedProfile,
};

use super::references::{ALBEDOS, CONFIGURATIONS, References};

/// Radii at which profiles are compared with the exact one, in mean free paths.
const RADII: [f64; 6] = [0.01, 0.1, 0.3, 1.0, 3.0, 10.0];

/// The contender that is a model.
pub(crate) fn contender(model: Model) -> Result<Contender, String> {
    let found = Contender::all().into_iter().find(|one| one.name == model.name());
    found.ok_or_else(|| format!("the model {model} is not among those that are compared"))
}

/// A table from rows of equally many cells.
fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let mut text = line(&head.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>());
    text += &format!("|{}\n", "---|".repeat(head.len()));
    for row in rows {
        debug_assert_eq!(row.len(), head.len(), "{row:?}");
        text += &line(&row);
    }
    text
}

/// Percent with two decimals, or with two digits where these would be zeros.
fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if value == 0.0 || value.abs() >= 0.005 { format!("{value:.2}") } else { format!("{value:.1e}") }
}

/// A number with so many significant digits.
fn digits(value: f64, count: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return String::from("0");
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        format!("{value:.*}", usize::try_from(count - 1 - exponent).unwrap_or(0))
    } else {
        format!("{value:.*e}", usize::try_from(count - 1).unwrap_or(0))
    }
}

const ERROR_COLUMNS: [&str; 8] =
    ["r ≤ 8 ℓ", "r ≤ 16 ℓ", "all r", "A = 0.2", "A = 0.5", "A = 0.8", "worst A", "of 99"];

/// The columns that a model's own page shows.
const MODEL_COLUMNS: std::ops::Range<usize> = 2..7;

/// Mean errors in three ranges, errors at [`ALBEDOS`], the worst, and how many albedos are reached.
fn error_cells(
    errors: &ErrorTable,
    name: &str,
    configuration: Configuration,
    inversion: Inversion,
) -> Option<Vec<String>> {
    let summary = errors.summary(name, configuration, inversion)?;
    let mut cells: Vec<String> = summary.errors.iter().map(|range| percent(range.mean)).collect();
    let at =
        |a: &f64| errors.at(name, configuration, inversion, *a).map_or_else(|| String::from("–"), percent);
    cells.extend(ALBEDOS.iter().map(at));
    let [.., all_r] = summary.errors;
    cells.push(format!("{} at {}", percent(all_r.worst), all_r.worst_surface_albedo));
    cells.push(summary.reached.to_string());
    Some(cells)
}

/// A model, or the best fit of a kind that is no model: pages of models have their variants.
fn is_of_all(contender: &Contender) -> bool {
    contender.is_model() || contender.group == Group::Fit && contender.model.is_none()
}

/// Errors of every model for a searchlight, beside the best sums of exponentials.
pub(crate) fn all_errors(contenders: &[Contender], errors: &ErrorTable) -> String {
    let rows = contenders.iter().filter(|one| is_of_all(one)).filter_map(|one| {
        let cells = error_cells(errors, one.name, Configuration::Searchlight, Inversion::Own)?;
        Some([vec![one.title.to_owned()], cells].concat())
    });
    table(&[&["model"][..], &ERROR_COLUMNS].concat(), rows)
}

/// Errors of a model, its variants and its best fits.
pub(crate) fn errors_of_model(model: Model, contenders: &[Contender], errors: &ErrorTable) -> String {
    let mut rows = Vec::new();
    for configuration in CONFIGURATIONS {
        for inversion in [Inversion::Own, Inversion::Exact] {
            for one in contenders.iter().filter(|one| one.model == Some(model)) {
                let Some(cells) = error_cells(errors, one.name, configuration, inversion) else { continue };
                let what = match inversion {
                    Inversion::Own => one.title.to_owned(),
                    Inversion::Exact => format!("{}, exact α", one.title),
                };
                rows.push([&[what, configuration.name().to_owned()][..], &cells[MODEL_COLUMNS]].concat());
            }
        }
    }
    table(&[&["what", "light"][..], &ERROR_COLUMNS[MODEL_COLUMNS]].concat(), rows)
}

/// Mean errors of all models, and those at [`ALBEDOS`], best first.
pub(crate) fn errors_of_models(contenders: &[Contender], errors: &ErrorTable) -> String {
    let searchlight = Configuration::Searchlight;
    let mean =
        |name: &str, configuration| Some(errors.summary(name, configuration, Inversion::Own)?.errors[2].mean);
    let mut models: Vec<(f64, &Contender)> = (contenders.iter().filter(|one| one.is_model()))
        .filter_map(|one| Some((mean(one.name, searchlight)?, one)))
        .collect();
    models.sort_by(|a, b| a.0.total_cmp(&b.0));
    let cell = |error: Option<f64>| error.map_or_else(|| String::from("–"), percent);
    let rows = models.into_iter().map(|(of_searchlight, one)| {
        let mut row = vec![format!("`{}`", one.name), percent(of_searchlight)];
        row.extend(ALBEDOS.iter().map(|a| cell(errors.at(one.name, searchlight, Inversion::Own, *a))));
        row.push(cell(mean(one.name, Configuration::Diffuse)));
        row
    });
    table(&["model", "searchlight, mean", "A = 0.2", "A = 0.5", "A = 0.8", "diffuse, mean"], rows)
}

fn radius_columns(first: &'static str) -> Vec<String> {
    std::iter::once(first.to_owned()).chain(RADII.iter().map(|r| format!("r = {r}"))).collect()
}

fn table_over_radii(first: &'static str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let columns = radius_columns(first);
    table(&columns.iter().map(String::as_str).collect::<Vec<_>>(), rows)
}

/// A model's profile over the exact one.
pub(crate) fn ratios(model: Model, references: &References) -> Result<String, String> {
    let contender = contender(model)?;
    let row = |reference: &Reference| {
        let profile = contender.profile(reference).map_err(|error| format!("{model}: {error}"))?;
        let mut row = vec![reference.surface_albedo.to_string()];
        row.extend(RADII.iter().map(|r| digits(profile.eval(*r) / reference.exact.eval(*r), 3)));
        Ok(row)
    };
    let rows: Vec<_> = references.searchlight.iter().map(row).collect::<Result<_, String>>()?;
    Ok(table_over_radii("A", rows))
}

/// The exact profile itself.
pub(crate) fn exact_values(references: &References) -> Result<String, String> {
    let rows = references.searchlight.iter().chain(&references.diffuse).map(|reference| {
        let mut row = vec![format!("{}, {}", reference.configuration.name(), reference.surface_albedo)];
        row.extend(RADII.iter().map(|r| digits(reference.exact.eval(*r), 7)));
        row
    });
    Ok(table_over_radii("light, A", rows))
}

/// The coefficients of the refined profile: of polynomials, which the values at as many albedos determine.
pub(crate) fn refined_coefficients() -> Result<String, String> {
    let profile = |a: f64, parameterization, configuration| {
        RefinedDiffusion::new(a, 1.0, parameterization, configuration).map_err(|error| error.to_string())
    };
    let mut rows = Vec::new();
    for configuration in CONFIGURATIONS {
        for k in 0..RefinedDiffusion::TERMS - 1 {
            let weight = |a| Ok(profile(a, Parameterization::Mfp, configuration)?.weights()[k]);
            rows.push(coefficient_row(&format!("w_{}", k + 1), configuration, 5, weight)?);
        }
        for k in 0..RefinedDiffusion::TERMS {
            let rate = |a| Ok(profile(a, Parameterization::Mfp, configuration)?.rates()[k]);
            rows.push(coefficient_row(&format!("ℓ λ_{}", k + 1), configuration, 4, rate)?);
        }
        let length = |a| Ok(profile(a, Parameterization::Dmfp, configuration)?.mfp() / (1.0 - a));
        rows.push(coefficient_row("(ℓ/ℓ_d)/(1 − A)", configuration, 6, length)?);
    }
    Ok(table(&["what", "light", "1", "A", "A²", "A³", "A⁴", "A⁵"], rows))
}

/// A row of the coefficients of a polynomial of so many terms, in four decimals, which must be all that they have.
fn coefficient_row(
    name: &str,
    configuration: Configuration,
    terms: usize,
    value: impl Fn(f64) -> Result<f64, String>,
) -> Result<Vec<String>, String> {
    let at = |i: usize| 0.9 * i as f64 / (terms - 1) as f64;
    let nodes: Vec<f64> = (0..terms).map(at).collect();
    let values = nodes.iter().map(|a| value(*a)).collect::<Result<Vec<f64>, String>>()?;
    let coefficients: Vec<f64> =
        polynomial_through(&nodes, &values).iter().map(|c| (1e4 * c).round() / 1e4).collect();
    let a = 0.37;
    let again = coefficients.iter().rev().fold(0.0, |sum, c| sum * a + c);
    if (again - value(a)?).abs() > 1e-10 {
        return Err(format!("{name} is no polynomial of {terms} coefficients with four decimals"));
    }
    let mut row = vec![name.to_owned(), configuration.name().to_owned()];
    row.extend(coefficients.iter().map(|c| format!("{c:.4}").replace('-', "−")));
    row.resize(8, String::new());
    Ok(row)
}

/// Coefficients of 1, x, x², … of the polynomial through points, by Newton's divided differences.
fn polynomial_through(nodes: &[f64], values: &[f64]) -> Vec<f64> {
    let mut differences = values.to_vec();
    for order in 1..nodes.len() {
        for i in (order..nodes.len()).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    let mut coefficients = vec![0.0; nodes.len()];
    for (difference, node) in differences.iter().zip(nodes).rev() {
        // Multiply by (x − node) and add the difference
        for i in (1..coefficients.len()).rev() {
            coefficients[i] = coefficients[i - 1] - node * coefficients[i];
        }
        coefficients[0] = difference - node * coefficients[0];
    }
    coefficients
}

/// Every model's table against the model itself, at the middle albedo.
pub(crate) fn errors_of_tables(references: &References) -> Result<String, String> {
    let reference = &references.searchlight[1];
    let row = |model: Model| -> Result<Vec<String>, String> {
        let profile = contender(model)?.profile(reference).map_err(|error| format!("{model}: {error}"))?;
        let table = TabulatedProfile::new(&*profile);
        let (mut cdf, mut density) = (0.0f64, 0.0f64);
        for i in 0..=4000 {
            let r = 1e-5 * 1e7f64.powf(f64::from(i) / 4000.0);
            let share = profile.enclosed(r) / profile.surface_albedo();
            cdf = cdf.max((table.cdf(r) - share).abs());
            if share > 1e-6 && profile.beyond(r) / profile.surface_albedo() > 1e-6 {
                density = density.max((table.eval(r) / profile.eval(r) - 1.0).abs());
            }
        }
        Ok(vec![format!("`{model}`"), format!("{cdf:.1e}"), format!("{density:.1e}")])
    };
    let models = Model::ALL.into_iter().filter(|model| *model != Model::NormalizedDiffusionOblique);
    let rows: Vec<_> = models.map(row).collect::<Result<_, String>>()?;
    Ok(table(&["model, A = 0.5", "cdf", "R(r)"], rows))
}

/// Samples of the exact profile, evenly spaced in ln r from 0.01 to 20 mean free paths.
pub(crate) fn samples(reference: &Reference, count: u32) -> (Vec<f64>, Vec<f64>) {
    let radius = |i: u32| 0.01 * 2000f64.powf(f64::from(i) / f64::from(count - 1));
    let radii: Vec<f64> = (0..count).map(radius).collect();
    let reflectances = radii.iter().map(|r| reference.exact.eval(*r)).collect();
    (radii, reflectances)
}

/// Errors of the exact profile when it is known at some radii only.
pub(crate) fn errors_of_samples(references: &References) -> Result<String, String> {
    let row = |count: u32| -> Result<Vec<String>, String> {
        let mut row = vec![count.to_string()];
        for reference in &references.searchlight {
            let (radii, reflectances) = samples(reference, count);
            let sampled = SampledProfile::new(&radii, &reflectances).map_err(|error| error.to_string())?;
            row.push(percent(reference.judge.l1_errors(&sampled, R_MAX)[2]));
        }
        Ok(row)
    };
    let rows: Vec<_> = [6, 8, 12, 20, 40, 100].into_iter().map(row).collect::<Result<_, String>>()?;
    Ok(table(&["samples", "A = 0.2", "A = 0.5", "A = 0.8"], rows))
}

/// Claims of the talk with their errors, the media found by the models' own albedo inversions.
pub(crate) fn claims(claims: &[Claim]) -> String {
    let verdict = |errors: &Option<[f64; 2]>| match errors {
        Some([better, worse]) => {
            let word = if Claim::is_confirmed([*better, *worse]) { "confirmed" } else { "**refuted**" };
            format!("{word} ({:.2} : {:.2})", 100.0 * better, 100.0 * worse)
        }
        None => String::from("–"),
    };
    let rows = claims.iter().filter(|claim| claim.inversion == Inversion::Own).map(|claim| {
        let whose = if claim.is_the_talks { "talk" } else { "ours" };
        let verdicts = claim.errors.iter().chain([&claim.means]).map(verdict);
        [claim.statement.clone(), whose.to_owned()].into_iter().chain(verdicts).collect()
    });
    table(&["claim", "whose", "A = 0.2", "A = 0.5", "A = 0.8", "mean"], rows)
}

fn case(case: &ScalingCase) -> &'static str {
    match (case.parameterization, case.configuration) {
        (Parameterization::Mfp, Configuration::Searchlight) => "ℓ, searchlight",
        (Parameterization::Mfp, Configuration::Diffuse) => "ℓ, diffuse",
        (Parameterization::Dmfp, Configuration::Searchlight) => "ℓ_d, searchlight",
        (Parameterization::Dmfp, Configuration::Diffuse) => "ℓ_d, diffuse",
    }
}

/// The talk's s(A) and ours, with their errors.
pub(crate) fn scaling(cases: &[ScalingCase]) -> String {
    let formula = |text: String| format!("`{text}`");
    let rows = cases.iter().flat_map(|one| {
        let means = |errors: &[translucid_fit::ErrorSummary; 3]| errors.map(|range| percent(range.mean));
        let stated = one.stated.map_or_else(String::new, |stated| format!("{:.1}", 100.0 * stated));
        let row = |whose: &str, text: String, stated: String, errors: [String; 3]| {
            [vec![case(one).to_owned(), whose.to_owned(), text, stated], errors.to_vec()].concat()
        };
        [
            row("the talk's", formula(one.talk.to_string()), stated, means(&one.talk_errors)),
            row("ours", formula(one.fitted.to_string()), String::from("–"), means(&one.fitted_errors)),
            row("best at each A", String::from("–"), String::from("–"), means(&one.least_errors)),
        ]
    });
    table(&["length, light", "whose", "s(A)", "stated", "r ≤ 8 ℓ", "r ≤ 16 ℓ", "all r"], rows)
}

/// Times of the models and of their tables in nanoseconds, and as multiples of normalized diffusion's own time.
pub(crate) fn times(contenders: &[Contender], timings: &[Timing]) -> String {
    // A quantity, and the one that it is a multiple of
    const COLUMNS: [(&str, Quantity, Quantity); 6] = [
        ("build", Quantity::Build, Quantity::Build),
        ("eval", Quantity::Eval, Quantity::Eval),
        ("sample", Quantity::Sample, Quantity::Sample),
        ("tabulate", Quantity::Tabulate, Quantity::Build),
        ("table eval", Quantity::TableEval, Quantity::Eval),
        ("table sample", Quantity::TableSample, Quantity::Sample),
    ];
    let of = |name: &str, quantity: Quantity| {
        Some(timings.iter().find(|one| one.contender == name && one.quantity == quantity)?.nanoseconds)
    };
    let yardstick = Model::NormalizedDiffusion.name();
    let row = |one: &Contender| {
        let cell = |(_, quantity, unit)| match (of(one.name, quantity), of(yardstick, unit)) {
            (Some(time), Some(unit)) => format!("{} ({}×)", digits(time, 2), digits(time / unit, 2)),
            _ => String::from("–"),
        };
        std::iter::once(one.title.to_owned()).chain(COLUMNS.map(cell)).collect()
    };
    let head: Vec<&str> = std::iter::once("model").chain(COLUMNS.map(|(name, ..)| name)).collect();
    table(&head, contenders.iter().filter(|one| one.group == Group::Model).map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_digits() {
        assert_eq!(digits(1234.0, 2), "1234");
        assert_eq!(digits(12.34, 3), "12.3");
        assert_eq!(digits(0.012345, 3), "0.0123");
        assert_eq!(digits(1.2345e-7, 3), "1.23e-7");
        assert_eq!(digits(0.0, 3), "0");
        assert_eq!([0.05471, 0.0, 3e-7, 1.0].map(percent), ["5.47", "0.00", "3.0e-5", "100.00"]);
    }

    #[test]
    fn polynomial_goes_through_its_points() {
        let nodes = [0.0, 0.3, 0.6, 0.9];
        let cubic = |x: f64| 2.0 - x + 0.5 * x * x - 3.0 * x * x * x;
        let found = polynomial_through(&nodes, &nodes.map(cubic));
        for (found, expected) in found.iter().zip([2.0, -1.0, 0.5, -3.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn table_is_markdown() {
        let text = table(&["a", "b"], [vec![String::from("1"), String::from("`|2|`")]]);
        assert_eq!(text, "| a | b |\n|---|---|\n| 1 | `\\|2\\|` |\n");
    }
}
