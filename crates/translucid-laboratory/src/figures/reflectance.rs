//! R(r) of every model at each albedo: the talk's figures.

use std::f64::consts::PI;

use translucid_profile::Configuration;

use super::{LEAST_RADIUS, radii, section_of, with_curves};
use crate::comparison::{Comparison, Curve, Reflectance, RingPoint, Walk};
use crate::{Axis, Block, Chart, Ink, Mark, Section, Series};

/// Charts of all albedos in one configuration.
pub(super) fn section(comparison: &Comparison, configuration: Configuration) -> Section {
    let figures: Vec<&Reflectance> =
        comparison.reflectances.iter().filter(|figure| figure.configuration == configuration).collect();
    let mut blocks = Vec::new();
    if !figures.is_empty() {
        let text = match configuration {
            Configuration::Searchlight => {
                "A pencil of light enters perpendicularly, and every model knows the case. On logarithmic axes the \
                 exact profile goes like 1/r towards the point of entry, because light that is scattered once leaves \
                 there; models of light that is scattered many times stay finite. The third chart of each albedo \
                 shows where the light is: equal areas under a curve are equal energies; the fourth divides by the \
                 exact solution, so that small differences and the errors of the photons are seen."
            }
            Configuration::Diffuse => {
                "Light enters at a point with a cosine distribution, as it does under a sky. Models that describe a \
                 perpendicular beam only are left out."
            }
        };
        blocks.push(Block::Text(String::from(text)));
        if comparison.settings.photons > 0 {
            blocks.push(Block::Text(agreement(&figures)));
        }
    }
    for figure in figures {
        blocks.extend(
            [linear, logarithmic, energy, ratio].map(|chart| Block::Chart(chart(comparison, figure))),
        );
    }
    let title = match configuration {
        Configuration::Searchlight => "Profiles of a perpendicular pencil of light",
        Configuration::Diffuse => "Profiles of diffuse light",
    };
    section_of(title, blocks)
}

/// Agreement of photons and the exact solution.
fn agreement(figures: &[&Reflectance]) -> String {
    let one = |figure: &&&Reflectance| {
        let (chi_square, rings, probability) = figure.chi_square();
        let a = figure.surface_albedo;
        match rings {
            0 if figure.single_scattering_albedo > Walk::HIGHEST_ALBEDO => {
                format!("A = {a}: no photons, for they would collide without end")
            }
            0 => format!(
                "A = {a}: no points, for no ring has been left by {:.0} photons",
                Walk::FEWEST_PHOTONS
            ),
            _ => format!(
                "A = {a}: χ² = {chi_square:.1} for {rings} rings, as large by chance in {:.0} % of all runs, greatest \
                 distance {:.1} standard errors",
                100.0 * probability,
                figure.greatest_deviate()
            ),
        }
    };
    let all: Vec<String> = figures.iter().map(|figure| one(&figure)).collect();
    format!("Photons against the exact solution: {}.", all.join("; "))
}

/// Share of the light that linear axes show.
const MOST: f64 = 0.7;

/// Both axes linear, over the radii where most of the light leaves.
fn linear(comparison: &Comparison, figure: &Reflectance) -> Chart {
    let [near, far] = [0.08, MOST].map(|share| radius_of(figure, share));
    let (x, y) = (Axis::linear("r", "ℓ"), Axis::linear("R(r)", "ℓ⁻²"));
    let top = at(figure, near);
    let chart = chart(figure, "linear", x.between(0.0, far), y.between(0.0, top));
    let caption = format!(
        "R(r) at A = {}, {}, linear axes: the range of radii in which {:.0} % of the light leaves; the curves go on \
         upwards.",
        figure.surface_albedo,
        figure.configuration.name(),
        100.0 * MOST
    );
    with_series(comparison, figure, chart, |_, reflectance| reflectance).with_caption(&caption)
}

/// Both axes logarithmic.
fn logarithmic(comparison: &Comparison, figure: &Reflectance) -> Chart {
    let top = at(figure, LEAST_RADIUS);
    let low = at(figure, f64::INFINITY).max(1e-9 * top);
    let y = Axis::logarithmic("R(r)", "ℓ⁻²").between(0.4 * low, 1.5 * top);
    let chart = chart(figure, "logarithmic", radii(figure), y);
    let caption =
        format!("R(r) at A = {}, {}, logarithmic axes.", figure.surface_albedo, figure.configuration.name());
    with_series(comparison, figure, chart, |_, reflectance| reflectance).with_caption(&caption)
}

/// Energy per e-fold of the radius.
fn energy(comparison: &Comparison, figure: &Reflectance) -> Chart {
    let a = figure.surface_albedo;
    let weight = |r: f64, reflectance: f64| 2.0 * PI * r * r * reflectance / a;
    let exact = figure.radii.iter().zip(&figure.exact.reflectance).map(|(r, value)| weight(*r, *value));
    let top = exact.fold(0.0, f64::max);
    let chart =
        chart(figure, "energy", radii(figure), Axis::linear("2πr² R(r) / A", "").between(0.0, 1.6 * top));
    let caption = format!(
        "Where the light leaves at A = {a}, {}: 2πr² R(r)/A, the share of it per e-fold of the radius.",
        figure.configuration.name()
    );
    with_series(comparison, figure, chart, weight).with_caption(&caption)
}

/// R(r) in units of the exact one.
fn ratio(comparison: &Comparison, figure: &Reflectance) -> Chart {
    let chart =
        chart(figure, "ratio", radii(figure), Axis::linear("R(r) / exact R(r)", "").between(0.5, 1.5));
    let caption = format!(
        "R(r) divided by the exact one at A = {}, {}; the points are photons in rings, divided by the exact mean over \
         the ring.",
        figure.surface_albedo,
        figure.configuration.name()
    );
    let exact = |r: f64| {
        let is_ring = |point: &&RingPoint| point.r == r;
        match figure.points.iter().find(is_ring) {
            Some(ring) => ring.exact,
            None => at(figure, r),
        }
    };
    with_series(comparison, figure, chart, |r, reflectance| reflectance / exact(r)).with_caption(&caption)
}

fn chart(figure: &Reflectance, kind: &str, x: Axis, y: Axis) -> Chart {
    let (a, configuration) = (figure.surface_albedo, figure.configuration.name());
    let name = format!("reflectance-{configuration}-{a}-{kind}").replace('.', "_");
    let what = match kind {
        "linear" => "R(r), linear axes",
        "logarithmic" => "R(r), logarithmic axes",
        "energy" => "Where the light leaves",
        _ => "R(r) divided by the exact one",
    };
    Chart::new(&name, &format!("{what}: A = {a}, {configuration}"), x, y)
}

/// The models, the exact solution above them, and the photons on top.
fn with_series(
    comparison: &Comparison,
    figure: &Reflectance,
    mut chart: Chart,
    height: impl Fn(f64, f64) -> f64,
) -> Chart {
    let y = |curve: &Curve, i: usize| height(figure.radii[i], curve.reflectance[i]);
    chart = with_curves(chart, comparison, figure, y);
    if !figure.points.is_empty() {
        let point = |point: &RingPoint| [point.r, height(point.r, point.reflectance)];
        let error = |point: &RingPoint| height(point.r, point.standard_error);
        let errors = Mark::PointsWithErrors(figure.points.iter().map(error).collect());
        let points = figure.points.iter().map(point).collect();
        chart.series.push(Series::new("photons, ± 1 standard error", Ink::Reference, errors, points));
    }
    chart
}

/// Radius within which a share of the light leaves, among those of the figure.
fn radius_of(figure: &Reflectance, share: f64) -> f64 {
    let target = share * figure.surface_albedo;
    let index = figure.exact.enclosed.partition_point(|enclosed| *enclosed < target);
    figure.radii.get(index).or(figure.radii.last()).copied().unwrap_or(1.0)
}

/// Exact R at the first radius of the figure that is at least r.
fn at(figure: &Reflectance, r: f64) -> f64 {
    let index = figure.radii.partition_point(|radius| *radius < r);
    figure.exact.reflectance.get(index).or(figure.exact.reflectance.last()).copied().unwrap_or(1.0)
}
