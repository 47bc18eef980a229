//! Light across a step of a texture: a walk of photons through two media side by side, and whose parameters a profile
//! has to have to be near it.
//!
//! ```text
//! cargo run --release -p translucid-reference --example textured_edge [-- --write]
//! ```
//!
//! `--write` puts the mean and the worst error of each choice into `docs/accuracy/textures.md`.
//! One side of the step is lit evenly, the exit is on the other. Where the two lie on the same side, all ways to choose
//! the parameters are one.
//! The profile is the refined one, which is the exact half space's to 0.2 %.

#![allow(clippy::print_stdout, reason = "the tables go to standard output")]

use std::f64::consts::PI;

use translucid_profile::{
    Configuration, Parameterization, Profile, RefinedDiffusion, half_space_single_scattering_albedo,
};
use translucid_reference::body::{Half, TwoHalves};
use translucid_testing::write_measured;

const PHOTONS: u64 = 1_000_000;
/// Distances of the exit from the step, in mean free paths of its own side.
const DISTANCES: [f64; 4] = [0.1, 0.3, 1.0, 3.0];

/// A and ℓ.
type Side = [f64; 2];
type Mean = fn(f64, f64) -> f64;

/// Steps: the exit's side, then the entry's.
const STEPS: [[Side; 2]; 8] = [
    [[0.9, 1.0], [0.3, 1.0]],
    [[0.3, 1.0], [0.9, 1.0]],
    [[0.8, 1.0], [0.5, 1.0]],
    [[0.5, 1.0], [0.8, 1.0]],
    [[0.7, 1.0], [0.7, 3.0]],
    [[0.7, 1.0], [0.7, 0.333_333]],
    [[0.9, 1.0], [0.4, 3.0]],
    [[0.4, 1.0], [0.9, 0.333_333]],
];

const HARMONIC: Mean = |a, b| 2.0 * a * b / (a + b);
const GEOMETRIC: Mean = |a, b| (a * b).sqrt();
const ARITHMETIC: Mean = |a, b| 0.5 * (a + b);
/// Means of the single-scattering albedos.
const INSIDE: Mean = |a, b| {
    let [a, b] = [a, b].map(|a| half_space_single_scattering_albedo(a, Configuration::Diffuse));
    translucid_profile::half_space_surface_albedo((a * b).sqrt(), Configuration::Diffuse)
};

/// Names of pairs' parameters, and what makes them of the exit's and the entry's A and ℓ.
const CHOICES: [(&str, Mean, Mean); 6] = [
    ("exit", |exit, _| exit, |exit, _| exit),
    ("entry", |_, entry| entry, |_, entry| entry),
    ("√AA, √ℓℓ", GEOMETRIC, GEOMETRIC),
    ("√AA, harmonic ℓ", GEOMETRIC, HARMONIC),
    ("√AA, mean ℓ", GEOMETRIC, ARITHMETIC),
    ("√αα, √ℓℓ", INSIDE, GEOMETRIC),
];

fn main() {
    let names = CHOICES.map(|(name, ..)| name).join(" | ");
    println!("| exit A, ℓ | entry A, ℓ | distance | truth | {names} |");
    println!("|---|---|---|---|{}", "---|".repeat(CHOICES.len()));
    let (mut sums, mut worst) = ([0.0; CHOICES.len()], [0.0_f64; CHOICES.len()]);
    for [exit, entry] in STEPS {
        let half = |[a, mfp]: Side| {
            let alpha = half_space_single_scattering_albedo(a, Configuration::Diffuse);
            Half { single_scattering_albedo: alpha, mfp }
        };
        let medium = TwoHalves::new([half(entry), half(exit)]).expect("albedos in (0, 1)");
        for x in DISTANCES {
            let truth = medium.walk(x, PHOTONS, 1).scattered_through(0);
            let shares = CHOICES.map(|(_, albedo, length)| {
                let profile = RefinedDiffusion::new(
                    albedo(exit[0], entry[0]),
                    length(exit[1], entry[1]),
                    Parameterization::Mfp,
                    Configuration::Diffuse,
                );
                beyond_line(&profile.expect("an albedo in (0, 1)"), x)
            });
            let columns = shares.map(|share| format!("{share:.4}")).join(" | ");
            for (i, share) in shares.into_iter().enumerate() {
                let error = (share / truth.value).ln().abs();
                sums[i] += error;
                worst[i] = worst[i].max(error);
            }
            let [[a, l], [b, m]] = [exit, entry];
            println!(
                "| {a}, {l} | {b}, {m:.2} | {x} | {:.4} ± {:.4} | {columns} |",
                truth.value, truth.error
            );
        }
    }
    let cases = (STEPS.len() * DISTANCES.len()) as f64;
    let mut summary = String::from("| A and ℓ | mean error | worst |\n|---|---|---|\n");
    for (i, (name, ..)) in CHOICES.iter().enumerate() {
        summary += &format!("| {name} | {:.2} | {:.1} |\n", (sums[i] / cases).exp(), worst[i].exp());
    }
    println!("\n{summary}");
    if std::env::args().any(|argument| argument == "--write") {
        let command = "cargo run --release -p translucid-reference --example textured_edge -- --write";
        write_measured("docs/accuracy/textures.md", command, &summary);
    }
}

/// Energy of a profile beyond a line at a distance x: ∫ acos(x/r)/π dE.
fn beyond_line(profile: &dyn Profile, x: f64) -> f64 {
    let n = 2000;
    let beyond = |i: u32| {
        let phi = 0.5 * PI * f64::from(i) / f64::from(n);
        if i == n { 0.0 } else { profile.beyond(x / phi.cos()) }
    };
    (0..n).map(|i| (beyond(i) - beyond(i + 1)) * (f64::from(i) + 0.5) / f64::from(2 * n)).sum()
}
