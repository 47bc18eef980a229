//! Errors of every model, against the albedo and against time.

use translucid_profile::Configuration;

use super::{ink, percent, section_of};
use crate::comparison::{Comparison, Contender, Group, Inversion, Quantity, Summary, Timing};
use crate::{Axis, Block, Cell, Chart, DataTable, Ink, Mark, Section, Series};

/// Errors over the albedos, with a table of their means.
pub(super) fn section(comparison: &Comparison) -> Section {
    let mut blocks = Vec::new();
    let configurations = &comparison.settings.configurations;
    for &configuration in configurations {
        for (inversion, is_shown, kind, title) in [
            (Inversion::Own, Contender::is_model as fn(&Contender) -> bool, "models", "Error of the models"),
            (Inversion::Own, is_variant, "variants", "Error of variants"),
            (Inversion::Own, is_sum, "sums", "Error of sums of Gaussians and exponentials"),
            (Inversion::Exact, |_| true, "exact-medium", "Error of models of the exact medium"),
        ] {
            let chart = Chart::new(&format!("error-{}-{kind}", configuration.name()), title, x(), y());
            blocks.extend(against_albedo(comparison, configuration, inversion, is_shown, chart));
        }
        for inversion in [Inversion::Own, Inversion::Exact] {
            blocks.extend(means(comparison, configuration, inversion));
        }
    }
    if !blocks.is_empty() {
        let text = format!(
            "Errors over all radii for each surface albedo, and their means over {} albedos. Models that describe a \
             medium find the one whose total, by their own formulas, is A, so that all curves have the same energy; \
             the charts \"of the exact medium\" give them the medium that returns A exactly instead, and their \
             energies then differ. Fits are the least-squares optimum of their form at each albedo.",
            comparison.errors.averaged.len()
        );
        blocks.insert(0, Block::Text(text));
    }
    section_of("Error against the surface albedo", blocks)
}

/// Errors against the time of a call, with a table of times.
pub(super) fn time_section(comparison: &Comparison) -> Section {
    let mut blocks: Vec<Block> = [
        (Quantity::Eval, "an evaluation of R(r)"),
        (Quantity::Sample, "a drawn radius"),
        (Quantity::Build, "making the profile of an albedo"),
    ]
    .into_iter()
    .filter_map(|(quantity, what)| against_time(comparison, quantity, what))
    .map(Block::Chart)
    .collect();
    if !blocks.is_empty() {
        blocks.push(Block::Table(times(comparison)));
        let rounds = comparison.timings.iter().map(|timing| timing.rounds).max().unwrap_or(0);
        let text = format!(
            "Times were measured in this very run, on one thread before the other work began, at A = {}: all calls \
             take turns of a tenth of a millisecond, {rounds} rounds of them, and the lower decile counts, so that \
             what else the machine did falls on all alike and little of it is left. The medians in timing.csv say how \
             much there was. Each call goes through a trait object, as in a renderer that swaps models. A radius is \
             drawn in closed form where a model has one, and else by a search for 1e-6 of the energy; as a table every \
             model costs the same.",
            comparison.middle_albedo
        );
        blocks.insert(0, Block::Text(text));
    }
    section_of("Error against time", blocks)
}

/// The axes of all charts against the albedo.
fn x() -> Axis {
    Axis::linear("surface albedo A", "").between(0.0, 1.0)
}

fn y() -> Axis {
    Axis::logarithmic("error", "%").between(LEAST, 200.0)
}

/// Least error that charts show, in percent; that of the exact solution's table is far below.
const LEAST: f64 = 0.05;

fn is_variant(contender: &Contender) -> bool {
    !contender.is_model() && contender.terms.is_none()
}

fn is_sum(contender: &Contender) -> bool {
    contender.terms.is_some()
}

/// Fills a chart; `None` where it stays empty.
fn against_albedo(
    comparison: &Comparison,
    configuration: Configuration,
    inversion: Inversion,
    is_shown: fn(&Contender) -> bool,
    mut chart: Chart,
) -> Option<Block> {
    chart.title = format!("{}, {}", chart.title, configuration.name());
    for contender in comparison.settings.contenders.iter().filter(|one| is_shown(one)) {
        let rows = comparison.errors.of(contender.name, configuration, inversion);
        let points: Vec<[f64; 2]> = rows.map(|row| [row.surface_albedo, 100.0 * row.errors[2]]).collect();
        if points.iter().any(|[_, error]| *error > LEAST) {
            chart.series.push(Series::new(contender.title, ink(contender), Mark::Line, points));
        }
    }
    let caption = "Area-weighted error over all radii. The talk speaks of A = 0.2, 0.5 and 0.8.";
    (!chart.series.is_empty()).then(|| Block::Chart(chart.with_caption(caption)))
}

/// Means and worst errors of all contenders.
fn means(comparison: &Comparison, configuration: Configuration, inversion: Inversion) -> Option<Block> {
    let (name, what) = match inversion {
        Inversion::Own => (format!("mean-error-{}", configuration.name()), ""),
        Inversion::Exact => {
            (format!("mean-error-{}-exact-medium", configuration.name()), ", of the exact medium")
        }
    };
    let caption = format!(
        "Errors in percent, {}{what}: means within 8 ℓ, 16 ℓ and all radii, and the worst over all radii",
        configuration.name()
    );
    let columns = ["model", "r ≤ 8 ℓ", "r ≤ 16 ℓ", "all r", "worst", "at A", "albedos"];
    let mut table = DataTable::new(&name, &caption, &columns);
    for contender in &comparison.settings.contenders {
        if let Some(Summary { errors, reached }) =
            comparison.errors.summary(contender.name, configuration, inversion)
        {
            let [a, b, c] = errors.map(|errors| Cell::from(100.0 * errors.mean));
            let [.., all] = errors;
            let worst = [Cell::from(100.0 * all.worst), Cell::from(all.worst_surface_albedo)];
            let [worst, at] = worst;
            table.push([Cell::from(contender.title), a, b, c, worst, at, Cell::from(reached as f64)]);
        }
    }
    (!table.rows.is_empty()).then_some(Block::Table(table))
}

/// Everything that is timed, each with its name beside it.
fn against_time(comparison: &Comparison, quantity: Quantity, what: &str) -> Option<Chart> {
    let name = format!("error-against-time-{}", quantity.name());
    let (x, y) = (Axis::logarithmic("time", "ns"), Axis::logarithmic("mean error", "%"));
    let title = format!("Mean error against the time of {what}");
    let mut chart = Chart::new(&name, &title, x, y);
    let searchlight = Configuration::Searchlight;
    let mut below = Vec::new();
    for contender in &comparison.settings.contenders {
        let Some(time) = time(comparison, contender, quantity) else { continue };
        let summary = comparison.errors.summary(contender.name, searchlight, Inversion::Own);
        let Some(error) = summary.map(|summary| summary.errors[2].mean) else { continue };
        if 100.0 * error < LEAST {
            below.push(format!("{} ({time:.0} ns, {:.1e} %)", contender.title, 100.0 * error));
            continue;
        }
        let ink = match contender.group {
            Group::Model => ink(contender),
            Group::Variant | Group::Fit => Ink::Guide,
        };
        let words = Mark::LabelledPoints(vec![short(contender)]);
        chart.series.push(Series::new("", ink, words, vec![[time, 100.0 * error]]));
    }
    let mut caption = String::from(
        "Better is to the left and further down. Searchlight, mean over the albedos, all radii; gray marks are variants.",
    );
    if !below.is_empty() {
        caption += &format!(" Far below the chart: {}.", below.join(", "));
    }
    (!chart.series.is_empty()).then(|| chart.with_caption(&caption))
}

/// Nanoseconds a call.
fn time(comparison: &Comparison, contender: &Contender, quantity: Quantity) -> Option<f64> {
    let of = |timing: &&Timing| timing.contender == contender.name && timing.quantity == quantity;
    Some(comparison.timings.iter().find(of)?.nanoseconds)
}

/// A name that fits beside a point.
fn short(contender: &Contender) -> String {
    contender
        .title
        .replace("single scattering", "single")
        .replace("photon-beam-diffusion", "photon beam")
        .replace("quantized-diffusion", "quantized")
}

fn times(comparison: &Comparison) -> DataTable {
    let mut columns = vec!["model"];
    columns.extend(Quantity::ALL.map(Quantity::name));
    let caption = format!("Nanoseconds a call at A = {}", comparison.middle_albedo);
    let mut table = DataTable::new("times", &caption, &columns);
    for contender in &comparison.settings.contenders {
        let times = Quantity::ALL.map(|quantity| time(comparison, contender, quantity).unwrap_or(f64::NAN));
        if times.iter().any(|time| time.is_finite()) {
            let mut row = vec![Cell::from(contender.title)];
            row.extend(times.map(Cell::from));
            table.rows.push(row);
        }
    }
    table
}

/// Two errors and which is less, in words.
pub(super) fn versus([better, worse]: [f64; 2]) -> String {
    format!("{} : {}", percent(better), percent(worse))
}
