//! Gaussians against exponentials.

use std::f64::consts::PI;

use translucid_profile::Configuration;

use super::{curve, line, middle, radii, section_of, word};
use crate::comparison::{Comparison, MixtureErrors, MixtureFamily, Reflectance};
use crate::{Axis, Block, Chart, Ink, Mark, Section, Series};

pub(super) fn section(comparison: &Comparison) -> Section {
    let mut blocks = Vec::new();
    if !comparison.mixtures.is_empty() {
        blocks.push(Block::Text(String::from(
            "Sums of Gaussians are what one blurs textures with; sums of exponentials over r have the same closed-form \
             distribution function and sampling. A Gaussian is flat where a profile goes like 1/r, so that it takes \
             many of them to do what few exponentials do. All sums are least-squares fits to the exact solution at each \
             albedo.",
        )));
        blocks.push(Block::Chart(errors(comparison)));
    }
    if let Some(figure) = middle(comparison, Configuration::Searchlight) {
        blocks.extend(
            MixtureFamily::ALL.into_iter().filter_map(|family| curves(figure, family)).map(Block::Chart),
        );
    }
    section_of("Gaussians against exponentials", blocks)
}

fn errors(comparison: &Comparison) -> Chart {
    let (x, y) = (Axis::linear("number of terms K", ""), Axis::logarithmic("mean error", "%"));
    let mut chart = Chart::new("mixtures", "Mean error of the best sum of K terms", x.between(0.5, 6.5), y);
    let mut place = 0;
    for &configuration in &comparison.settings.configurations {
        for family in MixtureFamily::ALL {
            let of = |one: &&MixtureErrors| one.family == family && one.configuration == configuration;
            let points: Vec<[f64; 2]> = (comparison.mixtures.iter().filter(of))
                .map(|one| [one.terms as f64, 100.0 * one.errors[2]])
                .collect();
            if !points.is_empty() {
                let label = format!("{}, {}", family.title(), word(configuration));
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
fn curves(figure: &Reflectance, family: MixtureFamily) -> Option<Chart> {
    let a = figure.surface_albedo;
    let weight = |r: f64, reflectance: f64| 2.0 * PI * r * r * reflectance / a;
    let name = format!("mixtures-{}", family.name());
    let title = format!("Sums of {}, A = {a}, {}", family.title(), word(figure.configuration));
    let mut chart = Chart::new(&name, &title, radii(figure), Axis::linear("2πr² R(r) / A", ""));
    for terms in [1, 2, 3, 4, 6] {
        if let Some(curve) = curve(figure, &family.contender(terms)) {
            let label = format!("{terms} {}", family.title());
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
