//! Gaussians against exponentials.

use std::f64::consts::PI;

use translucid_profile::{Configuration, SumOfGaussians};

use super::{curve, line, middle, radii, section_of};
use crate::comparison::{Comparison, Inversion, Reference, Reflectance};
use crate::{Axis, Block, Chart, Ink, Mark, Section, Series};

/// A family of terms: its name in files and in sentences, and the most terms of a sum.
#[derive(Clone, Copy)]
struct Family {
    name: &'static str,
    title: &'static str,
    most_terms: usize,
}

const FAMILIES: [Family; 2] = [
    Family { name: "gaussians", title: "Gaussians", most_terms: SumOfGaussians::MAX_TERMS },
    Family { name: "exponentials", title: "exponentials", most_terms: Reference::MAX_EXPONENTIALS },
];

impl Family {
    /// The contender of so many terms.
    fn contender(self, terms: usize) -> String {
        match self.name {
            "gaussians" if terms == self.most_terms => String::from(self.name),
            name => format!("{name}-{terms}"),
        }
    }
}

pub(super) fn section(comparison: &Comparison) -> Section {
    let mut blocks = Vec::new();
    let errors = errors(comparison);
    if !errors.series.is_empty() {
        blocks.push(Block::Text(String::from(
            "Sums of Gaussians are what one blurs textures with; sums of exponentials over r have the same closed-form \
             distribution function and sampling. A Gaussian is flat where a profile goes like 1/r, so that it takes \
             many of them to do what few exponentials do. All sums are least-squares fits to the exact solution at each \
             albedo.",
        )));
        blocks.push(Block::Chart(errors));
    }
    if let Some(figure) = middle(comparison, Configuration::Searchlight) {
        blocks.extend(FAMILIES.into_iter().filter_map(|family| curves(figure, family)).map(Block::Chart));
    }
    section_of("Gaussians against exponentials", blocks)
}

fn errors(comparison: &Comparison) -> Chart {
    let (x, y) = (Axis::linear("number of terms K", ""), Axis::logarithmic("mean error", "%"));
    let mut chart = Chart::new("mixtures", "Mean error of the best sum of K terms", x.between(0.5, 6.5), y);
    let mut place = 0;
    for &configuration in &comparison.settings.configurations {
        for family in FAMILIES {
            let point = |terms: usize| {
                let contender = family.contender(terms);
                let summary = comparison.errors.summary(&contender, configuration, Inversion::Own)?;
                Some([terms as f64, 100.0 * summary.errors[2].mean])
            };
            let points: Vec<[f64; 2]> = (1..=family.most_terms).filter_map(point).collect();
            if !points.is_empty() {
                let label = format!("{}, {}", family.title, configuration.name());
                let ink = Ink::Numbered(place);
                chart.series.push(Series::new(&label, ink, Mark::Line, points.clone()));
                chart.series.push(Series::new(&label, ink, Mark::Points, points));
            }
            place += 1;
        }
    }
    chart.with_caption("Mean over the albedos, all radii.")
}

/// Light of sums over the radius, beside the exact solution.
fn curves(figure: &Reflectance, family: Family) -> Option<Chart> {
    let a = figure.surface_albedo;
    let weight = |r: f64, reflectance: f64| 2.0 * PI * r * r * reflectance / a;
    let name = format!("mixtures-{}", family.name);
    let title = format!("Sums of {}, A = {a}, {}", family.title, figure.configuration.name());
    let mut chart = Chart::new(&name, &title, radii(figure), Axis::linear("2πr² R(r) / A", ""));
    for terms in [1, 2, 3, 4, 6] {
        if let Some(curve) = curve(figure, &family.contender(terms)) {
            let label = format!("{terms} {}", family.title);
            let label = if terms == 1 { label.trim_end_matches('s').to_owned() } else { label };
            let y = |i: usize| weight(figure.radii[i], curve.reflectance[i]);
            chart.series.push(line(&label, Ink::Numbered(chart.series.len()), figure, y));
        }
    }
    if chart.series.is_empty() {
        return None;
    }
    let y = |i: usize| weight(figure.radii[i], figure.exact.reflectance[i]);
    chart.series.push(line("exact solution", Ink::Reference, figure, y));
    Some(chart.with_caption("The share of the light per e-fold of the radius."))
}
