//! Plane layers by their solution, beside published figures, the exact half space and a walk of photons.
//!
//! ```text
//! cargo run --release -p translucid-reference --example layers_truth [-- --write]
//! ```
//!
//! `--write` puts the tables into `docs/accuracy/layers.md`.

#![allow(clippy::print_stdout, reason = "the tables go to standard output")]

use translucid_profile::quadrature::gauss_legendre;
use translucid_reference::exact::HalfSpace;
use translucid_reference::layers::{Grid, Ground, Layer, Layers, LayersProfile, Quantity};
use translucid_reference::walk::Control;
use translucid_reference::{Estimate, Incidence, specular_reflectance};
use translucid_testing::write_measured;

const COMMAND: &str = "cargo run --release -p translucid-reference --example layers_truth -- --write";
const PHOTONS: u64 = 16_000_000;
const SEED: u64 = 49;
/// Radii between rings of a table, in the unit of its layers.
const RINGS: [[usize; 2]; 6] = [[0, 1], [1, 2], [4, 5], [10, 12], [30, 36], [80, 100]];

fn main() {
    let totals = known_totals() + &walked_totals();
    let profiles = profiles();
    println!("{totals}\n{profiles}");
    if std::env::args().any(|argument| argument == "--write") {
        write_measured("docs/accuracy/layers.md", &format!("{COMMAND}, totals"), &totals);
        write_measured("docs/accuracy/layers.md", &format!("{COMMAND}, profiles"), &profiles);
    }
}

fn solved(layers: Vec<Layer>, ground: Ground, incidence: Incidence) -> [f64; 3] {
    let layers = Layers::new(1.0, layers, ground).expect("valid");
    let totals = layers.totals(incidence).expect("has a solution");
    [
        totals.specular_reflectance + totals.diffuse_reflectance,
        totals.collimated_transmittance + totals.diffuse_transmittance,
        totals.error,
    ]
}

/// Totals that others have published, and those of the half space, which is solved in another way.
fn known_totals() -> String {
    let mut table = String::from(
        "| layers | known from | quantity | known | solved | difference | stated error |\n|---|---|---|---|---|---|---|\n",
    );
    let mut row = |layers: &str,
                   source: &str,
                   quantity: &str,
                   known: (f64, usize),
                   found: f64,
                   error: f64| {
        let (known, digits) = known;
        let off = found - known;
        table += &format!(
            "| {layers} | {source} | {quantity} | {known:.digits$} | {found:.9} | {off:+.0e} | {error:.0e} |\n"
        );
    };
    let slab = Layer::new(90.0, 10.0, 0.02).with_g(0.75);
    let [r, t, error] = solved(vec![slab], Ground::AIR, Incidence::NORMAL);
    let source = "H. C. van de Hulst 1980, table 35";
    row("slab, α = 0.9, τ = 2, g = 0.75", source, "R", (0.09739, 5), r, error);
    row("slab, α = 0.9, τ = 2, g = 0.75", source, "T", (0.66096, 5), t, error);
    let half_space = Layer::new(0.9, 0.1, f64::INFINITY).with_eta(1.5);
    let [r, _, error] = solved(vec![half_space], Ground::None, Incidence::NORMAL);
    row("half space, α = 0.9, η = 1.5", "R. G. Giovanelli 1955", "R", (0.26, 4), r, error);
    for (alpha, eta) in [(0.5, 1.0), (0.99, 1.0), (0.9, 1.4), (0.999, 1.4)] {
        for (name, incidence) in [("R, beam", Incidence::NORMAL), ("R, diffuse", Incidence::Cosine)] {
            let layer = Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_eta(eta);
            let [r, _, error] = solved(vec![layer], Ground::None, incidence);
            let specular = specular_reflectance(incidence, eta);
            let exact = HalfSpace::with_boundary(alpha, eta, incidence).expect("valid").total().value;
            let known = specular + (1.0 - specular) * exact;
            let layers = format!("half space, α = {alpha}, η = {eta}");
            row(&layers, "the exact half space", name, (known, 9), r, error);
        }
    }
    table
}

/// Stacks that only a walk can judge.
fn stacks() -> [(&'static str, Layers); 4] {
    let stack = |layers, ground| Layers::new(1.0, layers, ground).expect("valid");
    let paint = Layer::new(50.0, 0.1, 0.1);
    let wood = Layer::new(10.0, 1.0, f64::INFINITY);
    let epidermis = Layer::new(20.0, 1.5, 0.1).with_g(0.8).with_eta(1.4);
    let dermis = Layer::new(15.0, 0.1, f64::INFINITY).with_g(0.8).with_eta(1.4);
    let varnish = Layer::new(0.0, 0.0, 0.05).with_eta(1.5);
    let print = |scattering, absorption| Layer::new(scattering, absorption, 0.2).with_g(0.5).with_eta(1.4);
    let cloud = Layer::new(10.0, 0.01, 0.5).with_g(0.85);
    let haze = Layer::new(2.0, 0.5, 0.5).with_g(0.6);
    [
        ("paint on wood", stack(vec![paint, wood], Ground::None)),
        ("cloud over haze", stack(vec![cloud, haze], Ground::AIR)),
        ("skin", stack(vec![epidermis, dermis], Ground::None)),
        (
            "varnished print on paper",
            stack(vec![varnish, print(20.0, 2.0), print(30.0, 0.1)], Ground::Lambertian { reflectance: 0.8 }),
        ),
    ]
}

fn walked_totals() -> String {
    let mut table = String::new();
    for (name, layers) in stacks() {
        for (light, incidence) in [("beam", Incidence::NORMAL), ("diffuse", Incidence::Cosine)] {
            let totals = layers.totals(incidence).expect("has a solution");
            let tally = layers
                .walk(incidence, Grid::TOTALS, PHOTONS, SEED, &Control::default())
                .expect("can be walked");
            let walked = tally.total(Quantity::Reflected);
            let (known, found) = (
                Estimate { value: walked.value + tally.specular(), ..walked },
                totals.specular_reflectance + totals.diffuse_reflectance,
            );
            let (off, error) = (found - known.value, totals.error);
            table += &format!(
                "| {name} | a walk, ±{:.0e} | R, {light} | {:.5} | {found:.9} | {off:+.0e} | {error:.0e} |\n",
                known.error, known.value
            );
        }
    }
    table
}

fn profiles() -> String {
    let mut table = String::from(
        "| layers | side | from | to | walked | standard error | solved | difference | stated error |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for (name, layers) in stacks() {
        let Ok(profile) = layers.profile() else {
            println!("{name} has no exact profile");
            continue;
        };
        let width = 0.01;
        let grid = Grid { dr: width, nr: 101, ..Grid::TOTALS };
        let tally =
            layers.walk(Incidence::NORMAL, grid, PHOTONS, SEED, &Control::default()).expect("can be walked");
        let sides: [(&str, Quantity, At); 2] = [
            ("R", Quantity::ReflectedByRing, LayersProfile::reflectance),
            ("T", Quantity::TransmittedByRing, LayersProfile::transmittance),
        ];
        for (side, quantity, at) in sides.into_iter().take(if layers.ground() == Ground::AIR { 2 } else { 1 })
        {
            let rings: Vec<Estimate> = tally.all(quantity).collect();
            // The innermost ring of T has the beam itself
            for [first, end] in RINGS.into_iter().filter(|[first, _]| side == "R" || *first > 0) {
                let [from, to] = [first as f64 * width, end as f64 * width];
                let walked: f64 = rings[first..end].iter().map(|ring| ring.value).sum();
                let error = rings[first..end].iter().map(|ring| ring.error.powi(2)).sum::<f64>().sqrt();
                let solved = ring(&profile, at, from, to);
                let stated = if solved.error < solved.value {
                    format!("{:.0e} %", 100.0 * solved.error / solved.value)
                } else {
                    String::from("more than the value")
                };
                table += &format!(
                    "| {name} | {side} | {from} | {to} | {walked:.4e} | {:.2} % | {:.4e} | {:+.2} % | {stated} |\n",
                    100.0 * error / walked,
                    solved.value,
                    100.0 * (solved.value / walked - 1.0),
                );
            }
        }
    }
    table
}

type At = fn(&LayersProfile, f64) -> Estimate;

/// Light between two radii.
fn ring(profile: &LayersProfile, at: At, from: f64, to: f64) -> Estimate {
    let mut sum = Estimate::ZERO;
    for (x, weight) in gauss_legendre(16) {
        let r = from + 0.5 * (to - from) * (x + 1.0);
        let area = std::f64::consts::PI * r * (to - from) * weight;
        let Estimate { value, error } = at(profile, r);
        sum = Estimate { value: sum.value + area * value, error: sum.error + area * error };
    }
    sum
}
