//! Distance of the profiles of oblique light from the exact half space (g = 0, η = 1), as tables in Markdown.
//!
//! ```text
//! cargo run --release -p translucid-fit -F generators --example oblique_errors [-- --write]
//! ```
//!
//! `--write` puts the means over the surface albedo into `docs/accuracy/oblique.md`.
//!
//! An error is ∫|R_model − R| dA / ∫R dA over the whole plane, in percent: as the model is, told A for light along the
//! normal, and multiplied to the exact energy of the angle.
//! The integral is a sum over cells of the plane, each counted at its middle; the last line says what twice as many
//! cells change.

#![allow(clippy::print_stdout, reason = "the table goes to standard output")]

#[path = "oblique_errors/beam.rs"]
mod beam;

use std::f64::consts::{LN_2, PI};

use translucid_profile::{
    Appearance, Configuration, DirectionalDipole, NormalizedDiffusion, ObliqueDiffusion, Parameterization,
    PhotonBeamDiffusion, RefinedDiffusion, half_space_single_scattering_albedo,
};
use translucid_reference::exact::ObliqueHalfSpace;
use translucid_testing::write_measured;

use beam::ObliqueBeam;

const ALBEDOS: [f64; 6] = [0.1, 0.2, 0.5, 0.8, 0.9, 0.98];
const DEGREES: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0];
/// Cases of the check with twice as many cells.
const CHECKED: [(f64, f64); 3] = [(0.1, 75.0), (0.5, 60.0), (0.9, 30.0)];
/// Radii in mean free paths, as powers of two; what is within the least is one ring.
const OCTAVES: [i32; 2] = [-9, 9];
/// Cells per octave and in half a turn.
const COARSE: [u32; 2] = [3, 18];
const FINE: [u32; 2] = [6, 36];
const NAMES: [&str; 5] =
    ["oblique", "refined", "normalized diffusion", "directional dipole", "oblique beam diffusion"];

fn main() {
    let names = NAMES.join(" | ");
    println!("| A | θ₀ | {names} |\n|---|---|{}", "---|".repeat(NAMES.len()));
    let mut means = [[[0.0; 2]; NAMES.len()]; DEGREES.len()];
    for a in ALBEDOS {
        for (degrees, mean) in DEGREES.into_iter().zip(&mut means) {
            let errors = errors(a, degrees, COARSE);
            println!("| {a} | {degrees}° | {} |", row(&errors));
            add(mean, &errors, ALBEDOS.len());
        }
    }
    let mut all = [[0.0; 2]; NAMES.len()];
    means.iter().for_each(|mean| add(&mut all, mean, DEGREES.len()));
    let mut table = format!("| θ₀ | {names} |\n|---|{}\n", "---|".repeat(NAMES.len()));
    for (degrees, mean) in DEGREES.iter().zip(&means) {
        table += &format!("| {degrees}° | {} |\n", row(mean));
    }
    table += &format!("| all | {} |", row(&all));
    println!(
        "\n{table}\n\nPercent: as the model is / at the exact energy; the second table has the means over A."
    );
    if std::env::args().any(|argument| argument == "--write") {
        let command =
            "cargo run --release -p translucid-fit -F generators --example oblique_errors -- --write";
        write_measured("docs/accuracy/oblique.md", command, &table);
    }
    let change = CHECKED.map(|(a, degrees)| {
        let [coarse, fine] = [COARSE, FINE].map(|cells| errors(a, degrees, cells));
        let pairs = coarse.as_flattened().iter().zip(fine.as_flattened());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    });
    let worst = 100.0 * change.into_iter().fold(0.0, f64::max);
    println!("Twice as many radii and azimuths change no figure of {CHECKED:?} by more than {worst:.2}.");
}

/// Adds errors to their mean over so many cases.
fn add(mean: &mut [[f64; 2]], errors: &[[f64; 2]], cases: usize) {
    for (mean, error) in mean.as_flattened_mut().iter_mut().zip(errors.as_flattened()) {
        *mean += error / cases as f64;
    }
}

fn row(errors: &[[f64; 2]]) -> String {
    let cell = |[as_is, at_total]: &[f64; 2]| format!("{:.1} / {:.1}", 100.0 * as_is, 100.0 * at_total);
    errors.iter().map(cell).collect::<Vec<_>>().join(" | ")
}

/// Errors of each model as it is, and at the exact energy.
fn errors(surface_albedo: f64, degrees: f64, cells: [u32; 2]) -> [[f64; 2]; NAMES.len()] {
    let cos_theta = if degrees == 0.0 { 1.0 } else { degrees.to_radians().cos() };
    let sin_theta = (1.0 - cos_theta * cos_theta).sqrt();
    let (mfp, searchlight) = (Parameterization::Mfp, Configuration::Searchlight);
    let alpha = half_space_single_scattering_albedo(surface_albedo, searchlight);
    let exact = Plane::new(&ObliqueHalfSpace::new(alpha, 1.0, cos_theta).expect("valid"), cells);

    let appearance = Appearance { surface_albedo, length: 1.0, parameterization: mfp, g: 0.0 };
    let valid = "an albedo in (0, 1)";
    let oblique = ObliqueDiffusion::new(surface_albedo, 1.0, mfp, searchlight, cos_theta).expect(valid);
    let refined = RefinedDiffusion::new(surface_albedo, 1.0, mfp, searchlight).expect(valid);
    let normalized = NormalizedDiffusion::new(surface_albedo, 1.0, mfp, searchlight).expect(valid);
    let dipole = DirectionalDipole::new(&appearance, 1.0).expect(valid);
    let up = [0.0, 0.0, 1.0];
    let on_plane = |r: f64, phi: f64| {
        dipole.eval([r * phi.cos(), r * phi.sin(), 0.0], [-sin_theta, 0.0, cos_theta], up, up)
    };
    let errors_of = |model: &dyn Fn(f64, f64) -> f64| exact.errors(model);
    [
        errors_of(&|r, phi| oblique.eval(r, phi)),
        errors_of(&|r, _| refined.eval(r)),
        errors_of(&|r, _| normalized.eval(r)),
        errors_of(&on_plane),
        // It reaches no albedo beyond some 0.96
        match PhotonBeamDiffusion::new(&appearance, 1.0) {
            Ok(profile) => {
                let beam = ObliqueBeam::new(profile.medium(), cos_theta);
                errors_of(&|r, phi| beam.eval(r, phi))
            }
            Err(_) => [f64::NAN; 2],
        },
    ]
}

/// The exact profile on the plane.
struct Plane {
    /// r, φ, area of a cell with its mirror image, energy.
    cells: Vec<[f64; 4]>,
    total: f64,
}

impl Plane {
    fn new(half_space: &ObliqueHalfSpace, [per_octave, sectors]: [u32; 2]) -> Self {
        let step = LN_2 / f64::from(per_octave);
        let least = 2f64.powi(OCTAVES[0]);
        let rings = (OCTAVES[1] - OCTAVES[0]) as u32 * per_octave;
        let mut cells = Vec::new();
        for sector in 0..sectors {
            let phi = PI * (f64::from(sector) + 0.5) / f64::from(sectors);
            let turn = 2.0 * PI / f64::from(sectors);
            let mut add =
                |r: f64, area: f64| cells.push([r, phi, area, half_space.eval(r, phi).value * area]);
            // R ~ 1/r close to the entry, whose mean over the disc is that at half the radius
            add(0.5 * least, turn * 0.5 * least * least);
            for ring in 0..rings {
                let r = least * (step * (f64::from(ring) + 0.5)).exp();
                add(r, turn * step * r * r);
            }
        }
        Self { cells, total: half_space.total().value }
    }

    fn errors(&self, model: &dyn Fn(f64, f64) -> f64) -> [f64; 2] {
        let energies: Vec<f64> = self.cells.iter().map(|&[r, phi, area, _]| model(r, phi) * area).collect();
        let factor = self.total / energies.iter().sum::<f64>();
        [1.0, factor].map(|factor| {
            let pairs = self.cells.iter().zip(&energies);
            pairs.map(|([.., exact], energy)| (factor * energy - exact).abs()).sum::<f64>() / self.total
        })
    }
}
