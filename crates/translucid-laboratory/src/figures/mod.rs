//! The figures and tables of a comparison, and the page that explains them.

mod claims;
mod data;
mod errors;
mod fresnel;
mod mixtures;
mod reflectance;
mod sampling;
mod scaling;

use translucid_profile::{Configuration, Model};

use crate::comparison::{Comparison, Contender, Curve, Reflectance};
use crate::{Axis, Block, Chart, DataTable, Ink, Mark, Page, Section, Series};

/// A comparison as something to read.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Text, charts and small tables.
    pub page: Page,
    /// The tables behind them, which are too long for a page.
    pub tables: Vec<DataTable>,
}

impl Report {
    /// Lays out a comparison.
    pub fn new(comparison: &Comparison) -> Self {
        let sections = [
            claims::section(comparison),
            reflectance::section(comparison, Configuration::Searchlight),
            reflectance::section(comparison, Configuration::Diffuse),
            errors::section(comparison),
            errors::time_section(comparison),
            scaling::section(comparison),
            sampling::cdf_section(comparison),
            sampling::section(comparison),
            mixtures::section(comparison),
            fresnel::section(comparison),
        ];
        let page = Page {
            title: String::from("Reflectance profiles compared"),
            introduction: introduction(comparison),
            sections: sections.into_iter().filter(|section| !section.blocks.is_empty()).collect(),
        };
        Self { page, tables: data::tables(comparison) }
    }
}

fn introduction(comparison: &Comparison) -> Vec<String> {
    let settings = &comparison.settings;
    let walk = if settings.photons > 0 {
        format!(
            "The points with error bars are an independent witness: {} photons that walk at random through the same \
             medium (seed {}), with one standard error.",
            grouped(settings.photons),
            settings.seed
        )
    } else {
        String::from("No photons walked for these figures.")
    };
    vec![
        String::from(
            "Light that enters a translucent material leaves it again around the point of entry; the reflectance \
             profile R(r) says how much leaves at the distance r, per unit of area. This page puts models of R(r) \
             beside the exact solution, for the case that P. H. Christensen and B. Burley (Approximate Reflectance \
             Profiles for Efficient Subsurface Scattering, 2015) look at: a flat, infinitely deep medium that \
             scatters isotropically (g = 0) and has the refractive index of its surroundings (η = 1).",
        ),
        String::from(
            "All models get the same two numbers: the surface albedo A, which is the share of the light that comes \
             back, and the mean free path ℓ, which is the unit of length. Searchlight means that a pencil of light \
             enters perpendicularly, diffuse that light enters at a point from all directions.",
        ),
        format!("Black lines are the exact solution. {walk}"),
        String::from(
            "The error of a model is the area-weighted distance ∫|R_model − R| 2πr dr / ∫R 2πr dr: half of it is \
             the share of the light that leaves at a wrong place. Every number of a figure is in the CSV file beside \
             it.",
        ),
    ]
}

/// A number with thin spaces between thousands.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Ink of a contender, equal in every figure: that of its model, or one by its place among all that are none.
fn ink(contender: &Contender) -> Ink {
    match contender.model {
        Some(model) if contender.is_model() => Ink::Model(model),
        _ => {
            let all = Contender::all();
            let others = all.iter().filter(|other| !other.is_model());
            Ink::Numbered(others.map(|other| other.name).position(|name| name == contender.name).unwrap_or(0))
        }
    }
}

/// Contenders that a figure of curves has room for: the models, or all where few were asked for.
fn shown(comparison: &Comparison) -> Vec<&Contender> {
    const MOST: usize = 9;
    let all = &comparison.settings.contenders;
    let not_exact = |one: &&Contender| one.name != Model::Exact.name();
    let shown: Vec<&Contender> = all.iter().filter(not_exact).collect();
    if shown.len() <= MOST {
        return shown;
    }
    shown.into_iter().filter(|one| one.is_model()).collect()
}

/// The figure of the middle albedo.
fn middle(comparison: &Comparison, configuration: Configuration) -> Option<&Reflectance> {
    let is_middle = |figure: &&Reflectance| {
        figure.configuration == configuration && figure.surface_albedo == comparison.middle_albedo
    };
    comparison.reflectances.iter().find(is_middle)
}

/// A line for a curve, with a height for each radius and index.
fn line(label: &str, ink: Ink, figure: &Reflectance, height: impl Fn(usize) -> f64) -> Series {
    let points = figure.radii.iter().enumerate().map(|(i, r)| [*r, height(i)]).collect();
    Series::new(label, ink, Mark::Line, points)
}

/// The least radius of logarithmic axes, in mean free paths.
const LEAST_RADIUS: f64 = 0.02;

/// A logarithmic axis of the radii of a figure.
fn radii(figure: &Reflectance) -> Axis {
    let end = figure.radii.last().copied().unwrap_or(1.0);
    Axis::logarithmic("r", "ℓ").between(LEAST_RADIUS, end)
}

/// The chart with the contenders and the exact solution above them, by the height of each curve at an index.
fn with_curves(
    mut chart: Chart,
    comparison: &Comparison,
    figure: &Reflectance,
    height: impl Fn(&Curve, usize) -> f64,
) -> Chart {
    for contender in shown(comparison) {
        if let Some(curve) = curve(figure, contender.name) {
            chart.series.push(line(contender.title, ink(contender), figure, |i| height(curve, i)));
        }
    }
    let exact = |i: usize| height(&figure.exact, i);
    chart.with(line("exact solution", Ink::Reference, figure, exact))
}

/// The curve of a contender.
fn curve<'a>(figure: &'a Reflectance, name: &str) -> Option<&'a Curve> {
    figure.curves.iter().find(|curve| curve.name == name)
}

fn section_of(title: &str, blocks: Vec<Block>) -> Section {
    Section { blocks, ..Section::new(title) }
}

/// Percent with two digits after the point.
fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}
