//! Figures of single models.

use std::f64::consts::PI;

use translucid_laboratory::comparison::Reference;
use translucid_laboratory::{Axis, Chart, Ink, Mark, Series};
use translucid_profile::{Model, Profile, SampledProfile};

use super::references::References;
use super::tables;

/// Radii of curves in mean free paths.
const R_MIN: f64 = 0.01;
const R_MAX: f64 = 30.0;
const POINTS: i32 = 160;

/// A model and the exact solution for a searchlight.
pub(crate) fn model(model: Model, references: &References) -> Result<Chart, String> {
    let contender = tables::contender(model)?;
    let mut chart = energy_chart(model.name(), &format!("{model} and the exact solution, A = 0.2, 0.5, 0.8"));
    for reference in &references.searchlight {
        chart = chart.with(curve("exact", Ink::Reference, &reference.exact));
    }
    for reference in &references.searchlight {
        let profile = contender.profile(reference).map_err(|error| format!("{model}: {error}"))?;
        chart = chart.with(curve(contender.title, Ink::Model(model), &*profile));
    }
    Ok(chart.with_caption(
        "Light per logarithm of the radius, 2πr² R(r), for a searchlight and ℓ = 1: equal areas below a curve are equal \
         amounts of light. The pairs of curves are A = 0.2, 0.5 and 0.8, from the lowest to the highest.",
    ))
}

/// The exact solution in both configurations.
pub(crate) fn exact(references: &References) -> Chart {
    let title = "The exact solution, A = 0.2, 0.5, 0.8";
    let mut chart = energy_chart("exact", title);
    for (references, label, ink) in
        [(&references.searchlight, "searchlight", Ink::Reference), (&references.diffuse, "diffuse", Ink::Fit)]
    {
        for reference in references {
            chart = chart.with(curve(label, ink, &reference.exact));
        }
    }
    chart.with_caption(
        "Light per logarithm of the radius, 2πr² R(r), for ℓ = 1: equal areas below a curve are equal amounts of light. \
         The pairs of curves are A = 0.2, 0.5 and 0.8, from the lowest to the highest. \
         Light that enters from all directions stays a little nearer than light that enters straight.",
    )
}

/// The exact solution at A = 0.5 and the curve through some samples of it.
pub(crate) fn samples(references: &References) -> Result<Chart, String> {
    let reference: &Reference = &references.searchlight[1];
    let (radii, reflectances) = tables::samples(reference, 8);
    let sampled = SampledProfile::new(&radii, &reflectances).map_err(|error| error.to_string())?;
    let points = radii.iter().zip(&reflectances).map(|(r, value)| [*r, 2.0 * PI * r * r * value]).collect();
    let chart = energy_chart("tables", "The exact solution and the curve through 8 samples, A = 0.5")
        .with(curve("exact", Ink::Reference, &reference.exact))
        .with(curve("through the samples", Ink::Fit, &sampled))
        .with(Series::new("samples", Ink::Fit, Mark::Points, points));
    Ok(chart.with_caption(
        "Light per logarithm of the radius, 2πr² R(r), for a searchlight and a mean free path ℓ of 1. \
         Eight samples of the exact solution and what the library makes of them: before the first sample and behind \
         the last one the curve is a guess.",
    ))
}

/// Errors against samples, from the first table of a page whose first column is headed "samples".
pub(crate) fn noise(page: &str) -> Result<Chart, String> {
    fn cells(line: &str) -> impl Iterator<Item = &str> {
        line.trim().trim_matches('|').split('|').map(str::trim)
    }
    let mut lines = page.lines().skip_while(|line| !line.starts_with("| samples |"));
    let labels: Vec<&str> = cells(lines.next().ok_or("the page has no table of samples")?).skip(1).collect();
    let rows: Vec<Vec<f64>> = lines
        .take_while(|line| line.starts_with('|'))
        .filter_map(|line| cells(line).map(|cell| cell.parse().ok()).collect())
        .collect();
    let mut chart = Chart::new(
        "noise",
        "The head's error against samples",
        Axis::logarithmic("samples per pixel", ""),
        Axis::logarithmic("relMSE", ""),
    );
    for (column, label) in labels.iter().enumerate() {
        let points: Vec<[f64; 2]> =
            rows.iter().filter_map(|row| Some([*row.first()?, *row.get(column + 1)?])).collect();
        if let ([first, .., last], 0) = (&points[..], column) {
            let guide = vec![*first, [last[0], first[1] * first[0] / last[0]]];
            chart = chart.with(Series::new("1/N", Ink::Guide, Mark::Line, guide));
        }
        chart = chart.with(Series::new(label, Ink::Numbered(column), Mark::Points, points.clone()));
        chart = chart.with(Series::new("", Ink::Numbered(column), Mark::Line, points));
    }
    Ok(chart.with_caption(
        "Relative mean square error of a part of the head against samples per pixel, as in the table above. \
         The straight line falls like 1/N.",
    ))
}

fn energy_chart(name: &str, title: &str) -> Chart {
    Chart::new(name, title, Axis::logarithmic("r", "ℓ"), Axis::linear("2πr² R(r)", ""))
}

fn curve(label: &str, ink: Ink, profile: &dyn Profile) -> Series {
    let ratio = (R_MAX / R_MIN).powf(1.0 / f64::from(POINTS - 1));
    let radii = (0..POINTS).map(|i| R_MIN * ratio.powi(i));
    let points = radii.map(|r| [r, 2.0 * PI * r * profile.eval_times_r(r)]).collect();
    Series::new(label, ink, Mark::Line, points)
}
