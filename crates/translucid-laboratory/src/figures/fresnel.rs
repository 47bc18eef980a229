//! Schlick's approximation against Fresnel's reflectance.

use super::section_of;
use crate::comparison::{Comparison, FresnelCurve, Side};
use crate::data_table::row;
use crate::{Axis, Block, Chart, DataTable, Ink, Mark, Section, Series};

pub(super) fn section(comparison: &Comparison) -> Section {
    let mut blocks = vec![Block::Text(String::from(
        "What a smooth boundary reflects of unpolarized light, by Fresnel's equations and by Schlick's approximation \
         R₀ + (1 − R₀)(1 − cos θ)⁵; from inside with the angle of the refracted ray, and 1 beyond the critical angle.",
    ))];
    for side in Side::ALL {
        let curves: Vec<&FresnelCurve> = comparison.fresnel.iter().filter(|one| one.side == side).collect();
        blocks.extend([reflectance(side, &curves), difference(side, &curves)].map(Block::Chart));
    }
    blocks.push(Block::Table(table(&comparison.fresnel)));
    section_of("Schlick against Fresnel", blocks)
}

fn reflectance(side: Side, curves: &[&FresnelCurve]) -> Chart {
    let (x, y) = (Axis::linear("angle θ", "degrees"), Axis::linear("reflectance", ""));
    let title = format!("Reflectance of light from {}", side.name());
    let name = format!("fresnel-{}", side.name());
    let mut chart = Chart::new(&name, &title, x.between(0.0, end(side)), y.between(0.0, 1.05));
    for (place, curve) in curves.iter().enumerate() {
        let of = |i: usize| curve.points.iter().map(|point| [point[0], point[i]]).collect::<Vec<_>>();
        let eta = curve.eta;
        let exact = format!("Fresnel, η = {eta}");
        chart.series.push(Series::new(&exact, Ink::Numbered(SOLID[place % 3]), Mark::Line, of(1)));
        let schlick = format!("Schlick, η = {eta}");
        chart.series.push(Series::new(&schlick, Ink::Numbered(BROKEN[place % 3]), Mark::Line, of(2)));
    }
    chart.with_caption(
        "Fresnel's reflectance as solid lines, Schlick's approximation of the same color broken.",
    )
}

/// End of a chart \[degrees\]: from inside all is reflected beyond the greatest critical angle, 50.3°.
fn end(side: Side) -> f64 {
    match side {
        Side::Outside => 90.0,
        Side::Inside => 60.0,
    }
}

/// Numbered inks of equal colors, solid and broken.
const SOLID: [usize; 3] = [0, 1, 10];
const BROKEN: [usize; 3] = [8, 9, 2];

fn difference(side: Side, curves: &[&FresnelCurve]) -> Chart {
    let (x, y) = (Axis::linear("angle θ", "degrees"), Axis::linear("Schlick − Fresnel", ""));
    let title = format!("What Schlick's approximation is off by, from {}", side.name());
    let mut chart =
        Chart::new(&format!("fresnel-difference-{}", side.name()), &title, x.between(0.0, end(side)), y);
    for (place, curve) in curves.iter().enumerate() {
        let points = curve.points.iter().map(|point| [point[0], point[2] - point[1]]).collect();
        let label = format!("η = {}", curve.eta);
        chart.series.push(Series::new(&label, Ink::Numbered(SOLID[place % 3]), Mark::Line, points));
    }
    let worst = curves.iter().map(|curve| {
        let [degrees, off] = curve.greatest_difference();
        format!("η = {}: {off:+.4} at {degrees:.1}°", curve.eta).replace('-', "−")
    });
    let worst: Vec<String> = worst.collect();
    chart.with_caption(&format!("The greatest differences are {}.", worst.join("; ")))
}

fn table(curves: &[FresnelCurve]) -> DataTable {
    let columns = ["from", "η", "greatest difference", "at θ / degrees"];
    let mut table =
        DataTable::new("fresnel-greatest", "Where Schlick's approximation is farthest off", &columns);
    for curve in curves {
        let [degrees, off] = curve.greatest_difference();
        table.rows.push(row![curve.side.name(), curve.eta, off, degrees]);
    }
    table
}
