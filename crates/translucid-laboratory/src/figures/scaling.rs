//! s(A) of normalized diffusion.

use translucid_profile::Model;

use super::section_of;
use crate::comparison::{Comparison, R_MAX, ScalingCase};
use crate::{Axis, Block, Cell, Chart, DataTable, Ink, Mark, Section, Series};

pub(super) fn section(comparison: &Comparison) -> Section {
    let mut blocks = Vec::new();
    if comparison.has(Model::NormalizedDiffusion) && !comparison.scaling.is_empty() {
        blocks.push(Block::Text(String::from(
            "Normalized diffusion R(r) = A (e^(−r/d) + e^(−r/3d))/(8πdr) has one free length d = length/s(A). The \
             points are the s that brings it closest to the exact solution at each albedo; the talk gives a polynomial \
             through its own Monte Carlo points for each of three cases, and the second curve has the same form with \
             constants fitted here such that the mean error is least.",
        )));
        blocks.extend(comparison.scaling.iter().map(|case| Block::Chart(chart(case))));
        blocks.push(Block::Table(coefficients(&comparison.scaling)));
    }
    section_of("The scale s(A) of normalized diffusion", blocks)
}

fn chart(case: &ScalingCase) -> Chart {
    let best: Vec<[f64; 2]> = case.points.iter().map(|[a, s, _]| [*a, *s]).collect();
    let albedos = || (0..=200).map(|i| f64::from(i) / 200.0);
    let curve = |of: &dyn Fn(f64) -> f64| albedos().map(|a| [a, of(a)]).collect::<Vec<_>>();
    let [low, top] =
        best.iter().fold([f64::MAX, 0.0], |[low, top]: [f64; 2], [_, s]| [low.min(*s), top.max(*s)]);
    let x = Axis::linear("surface albedo A", "").between(0.0, 1.0);
    // A diffuse mean free path grows without bounds towards A = 1, and s with it
    let y = if top > 20.0 * low {
        Axis::logarithmic("s", "").between(0.8 * low, 1.25 * top)
    } else {
        Axis::linear("s", "").between(0.0, 1.15 * top)
    };
    let name = format!("scaling-{}", case.name());
    let title = format!("s(A), {}", case.name().replace('-', ", "));
    let caption = format!(
        "Best s at each albedo and polynomials. Talk: {}, mean error {:.2} % over all radii. Fitted here: {}, {:.2} %. \
         The best s alone leaves {:.2} %.",
        case.talk,
        100.0 * case.talk_errors[2].mean,
        case.fitted,
        100.0 * case.fitted_errors[2].mean,
        100.0 * case.least_errors[2].mean
    );
    Chart::new(&name, &title, x, y)
        .with(Series::new("best s", Ink::Reference, Mark::Points, best))
        .with(Series::new("the talk's polynomial", Ink::Talk, Mark::Line, curve(&|a| case.talk.eval(a))))
        .with(Series::new("fitted here", Ink::Fit, Mark::Line, curve(&|a| case.fitted.eval(a))))
        .with_caption(&caption)
}

/// Constants and errors of the polynomials.
fn coefficients(cases: &[ScalingCase]) -> DataTable {
    let columns = [
        "case",
        "fit",
        "constant",
        "slope",
        "factor",
        "center",
        "power",
        "r_max",
        "mean_error",
        "worst_error",
        "worst_surface_albedo",
    ];
    let caption =
        "s = constant − slope A + factor |A − center|^power, and its errors; a missing r_max means all radii";
    let mut table = DataTable::new("scaling-fits", caption, &columns);
    for case in cases {
        for (fit, form, errors) in
            [("talk", case.talk, case.talk_errors), ("fitted", case.fitted, case.fitted_errors)]
        {
            for (r_max, errors) in R_MAX.into_iter().zip(errors) {
                let constants =
                    [form.constant, form.slope, form.factor, form.center, f64::from(form.power), r_max];
                let numbers = [errors.mean, errors.worst, errors.worst_surface_albedo];
                let mut row = vec![Cell::from(case.name()), Cell::from(fit)];
                row.extend(constants.into_iter().chain(numbers).map(Cell::from));
                table.rows.push(row);
            }
        }
    }
    table
}
