//! Figures of the oracle's tables: lit shapes on a plane, by the exact half space and by the profile of 2015.

use translucid_laboratory::oracle::{LitShape, Spread};
use translucid_laboratory::{Axis, Chart, Ink, Mark, Series};
use translucid_profile::{Appearance, Configuration, Model, ParameterError, Parameterization, Profile};
use translucid_reference::Incidence;
use translucid_reference::exact::{HalfSpace, single_scattering_albedo};

/// Surface albedos of the curves.
const ALBEDOS: [f64; 3] = [0.5, 0.8, 0.95];
/// Sizes and distances in mean free paths.
const LEAST: f64 = 0.05;
const MOST: f64 = 50.0;
const POINTS: i32 = 120;

/// A shape by its size or distance.
type Shape = fn(f64) -> LitShape;

/// Figures of an edge, a disk and a line.
pub(crate) fn charts() -> Result<Vec<Chart>, String> {
    let edge = chart(
        "oracle-edge",
        "Light beside the edge of a lit half plane, A = 0.5, 0.8, 0.95",
        ["distance from the edge", "dark"],
        |x| LitShape::Edge { distance: x },
    )?;
    let disk = chart(
        "oracle-disk",
        "Light in the center of a lit disk, A = 0.5, 0.8, 0.95",
        ["radius of the disk", "response"],
        |x| LitShape::Disk { radius: x, offset: 0.0 },
    )?;
    let line = chart(
        "oracle-line",
        "Light in the middle of a lit line, A = 0.5, 0.8, 0.95",
        ["width of the line", "response"],
        |x| LitShape::Line { width: x, offset: 0.0 },
    )?;
    Ok(vec![
        edge.with_caption(
            "Light on the dark side over that far on the lit side, for diffuse light. \
             Of each color A is 0.5, 0.8 and 0.95, from the lowest curve to the highest. \
             Burley's profile of 2015 leaves the dark side too dark where A is high.",
        ),
        disk.with_caption(
            "Light in the center over that of a very large disk, for diffuse light. \
             Of each color A is 0.5, 0.8 and 0.95, from the highest curve to the lowest. \
             The profile of 2015 keeps small bright features too bright where A is high.",
        ),
        line.with_caption(
            "Light in the middle over that of a very wide band, for diffuse light. \
             Of each color A is 0.5, 0.8 and 0.95, from the highest curve to the lowest.",
        ),
    ])
}

fn chart(name: &str, title: &str, [x, y]: [&str; 2], shape: Shape) -> Result<Chart, String> {
    let mut chart = Chart::new(name, title, Axis::logarithmic(x, "ℓ"), Axis::linear(y, ""));
    for a in ALBEDOS {
        let exact = half_space(a).map_err(|error| error.to_string())?;
        chart = chart.with(curve("exact", Ink::Reference, &exact, shape));
    }
    for a in ALBEDOS {
        let model = Model::NormalizedDiffusion;
        let profile = burley(a).map_err(|error| error.to_string())?;
        chart = chart.with(curve(model.name(), Ink::Model(model), &*profile, shape));
    }
    Ok(chart)
}

/// The exact half space of a surface albedo in diffuse light, with the mean free path 1.
fn half_space(a: f64) -> Result<HalfSpace, ParameterError> {
    HalfSpace::new(single_scattering_albedo(a, 1.0, Incidence::Cosine)?, Incidence::Cosine)
}

/// Burley's profile of the same medium.
fn burley(a: f64) -> Result<Box<dyn Profile>, ParameterError> {
    let parameterization = Parameterization::Mfp;
    let appearance = Appearance { surface_albedo: a, length: 1.0, parameterization, g: 0.0 };
    Model::NormalizedDiffusion.profile(&appearance, Configuration::Diffuse, 1.0)
}

/// The response by size or distance, as a part of that of a large lit shape.
fn curve(label: &str, ink: Ink, spread: &(impl Spread + ?Sized), shape: Shape) -> Series {
    let ratio = (MOST / LEAST).powf(1.0 / f64::from(POINTS - 1));
    let places = (0..POINTS).map(|i| LEAST * ratio.powi(i));
    let all = spread.total().value;
    let points = places.map(|x| [x, shape(x).response(spread).value / all]).collect();
    Series::new(label, ink, Mark::Line, points)
}
