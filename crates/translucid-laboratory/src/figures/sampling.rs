//! Distribution functions, and radii that were drawn from them.

use super::{ink, middle, radii, section_of, with_curves};
use crate::comparison::{Comparison, Curve, Reflectance, SampleTest};
use crate::data_table::row;
use crate::{Axis, Block, Chart, DataTable, Ink, Mark, Section, Series};

/// Distribution functions at the middle albedo.
pub(super) fn cdf_section(comparison: &Comparison) -> Section {
    let mut blocks = Vec::new();
    for &configuration in &comparison.settings.configurations {
        if let Some(figure) = middle(comparison, configuration) {
            blocks.extend([cdf(comparison, figure), cdf_difference(comparison, figure)].map(Block::Chart));
        }
    }
    if !blocks.is_empty() {
        blocks.insert(
            0,
            Block::Text(String::from(
                "The share of the light that leaves within r. It is what a renderer samples, and half of the error of \
                 a model is the way that its distance from the exact one goes up and down.",
            )),
        );
    }
    section_of("Distribution functions", blocks)
}

fn cdf(comparison: &Comparison, figure: &Reflectance) -> Chart {
    let (a, configuration) = (figure.surface_albedo, figure.configuration.name());
    let y = Axis::linear("share within r", "").between(0.0, 1.0);
    let title = format!("Distribution functions, A = {a}, {configuration}");
    let chart = Chart::new(&format!("cdf-{configuration}"), &title, radii(figure), y);
    with_curves(chart, comparison, figure, |curve, i| curve.enclosed[i] / a)
        .with_caption("The share of the light that leaves within r, of all that leaves.")
}

fn cdf_difference(comparison: &Comparison, figure: &Reflectance) -> Chart {
    let (a, configuration) = (figure.surface_albedo, figure.configuration.name());
    let y = Axis::linear("share within r, model − exact", "%");
    let title = format!("Distribution functions less the exact one, A = {a}, {configuration}");
    let chart = Chart::new(&format!("cdf-difference-{configuration}"), &title, radii(figure), y);
    let off = |curve: &Curve, i: usize| 100.0 * (curve.enclosed[i] - figure.exact.enclosed[i]) / a;
    with_curves(chart, comparison, figure, off).with_caption(
        "Above zero, a model has sent out too much light so far, below zero too little; the slope is what it is wrong \
         by at r.",
    )
}

/// Histograms of all models.
pub(super) fn section(comparison: &Comparison) -> Section {
    let mut blocks = Vec::new();
    if let Some(first) = comparison.samples.first().filter(|first| first.count() > 0) {
        blocks.push(Block::Text(format!(
            "{} radii were drawn from each model at A = {} with the function that renderers call, and counted in {} \
             bins of equal width up to the radius within which 99 % leave, and one beyond. Expected is what the model's \
             own energies within the edges promise. The probability is how often chance alone is as far off; one in a \
             hundred is nothing odd, one in a million is a defect.",
            super::grouped(first.count()),
            first.surface_albedo,
            SampleTest::BINS
        )));
        blocks.push(Block::Table(table(&comparison.samples)));
        let contenders = &comparison.settings.contenders;
        let charts = comparison.samples.iter().map(|test| {
            let contender = contenders.iter().find(|one| one.name == test.contender);
            chart(test, contender.map_or(Ink::Fit, ink))
        });
        blocks.extend(charts.map(Block::Chart));
    }
    section_of("Sampling", blocks)
}

fn table(samples: &[SampleTest]) -> DataTable {
    let columns = ["model", "drawn", "chi_square", "degrees of freedom", "probability"];
    let mut table = DataTable::new("sampling", "Drawn radii against the density", &columns);
    for test in samples {
        let drawn = if test.own_sampler { "in closed form" } else { "by a table" };
        let freedom = test.freedom as f64;
        table.rows.push(row![test.contender, drawn, test.chi_square, freedom, test.probability]);
    }
    table
}

fn chart(test: &SampleTest, ink: Ink) -> Chart {
    let count = test.count() as f64;
    let widths: Vec<f64> = test.edges.windows(2).map(|edges| edges[1] - edges[0]).collect();
    let mut steps: Vec<[f64; 2]> = (test.edges.iter().zip(&test.counts))
        .zip(&widths)
        .map(|((edge, n), width)| [*edge, *n as f64 / (count * width)])
        .collect();
    steps.push([test.edges.last().copied().unwrap_or(1.0), 0.0]);
    let (x, y) = (Axis::linear("r", "ℓ"), Axis::linear("density", "ℓ⁻¹"));
    let top = steps.iter().chain(&test.density).map(|[_, y]| *y).fold(0.0, f64::max);
    let end = test.edges.last().copied().unwrap_or(1.0);
    let name = format!("sampling-{}", test.contender);
    let title = format!("Radii drawn from {}, A = {}", test.contender, test.surface_albedo);
    let caption = format!(
        "Histogram of {} radii and the density 2πr R(r)/A of the model; χ² = {:.1} with {} degrees of freedom, probability \
         {:.3}.",
        super::grouped(test.count()),
        test.chi_square,
        test.freedom,
        test.probability
    );
    Chart::new(&name, &title, x.between(0.0, end), y.between(0.0, 1.08 * top))
        .with(Series::new("drawn", ink, Mark::Steps, steps))
        .with(Series::new("density", Ink::Reference, Mark::Line, test.density.clone()))
        .with_caption(&caption)
}
