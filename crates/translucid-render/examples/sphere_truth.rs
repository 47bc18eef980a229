//! Light that leaves a translucent sphere, by a walk of photons through it and by the models of a flat half space.
//!
//! ```text
//! cargo run --release -p translucid-render --example sphere_truth [-- --write]
//! ```
//!
//! `--write` puts the rows of distant light into `docs/accuracy/oblique.md`.
//!
//! The sphere is homogeneous, scatters isotropically and has no boundary (g = 0, η = 1). The walk is that of
//! `translucid_reference::body`, of which nothing is shared with the models. Light that passes without a collision is
//! left out, as it is no scattered light.
//! Models are integrated over the sphere's surface as the renderer does it: R of the offset from entry to exit, of the
//! direction of light and of the normals, times the irradiance at the entry.
//!
//! Radiosity is per unit of irradiance on a plane that faces the distant light, at the cosine of the angle between the
//! normal and the direction to the light; under uniform light it is per unit of irradiance.

#![allow(clippy::print_stdout, reason = "the tables go to standard output")]

use std::f64::consts::PI;

use rayon::prelude::*;
use translucid_profile::{
    Appearance, Configuration, DirectionalDipole, NormalizedDiffusion, ObliqueDiffusionF32,
    ObliqueDiffusionTable, Parameterization, RefinedDiffusion, half_space_single_scattering_albedo,
};
use translucid_reference::body::{Body, Interior, Lighting, SPHERE_RINGS as RINGS, Shape};
use translucid_testing::write_measured;

const ALBEDOS: [f64; 2] = [0.5, 0.9];
/// In mean free paths.
const RADII: [f64; 3] = [3.0, 10.0, 30.0];
const PHOTONS: u64 = 2_000_000;
const NAMES: [&str; 4] = ["oblique", "refined", "normalized diffusion", "directional dipole"];

fn main() {
    let names = NAMES.join(" | ");
    println!("| A | radius/ℓ | light | truth | {names} |\n|---|---|---|---|{}", "---|".repeat(NAMES.len()));
    let mut table =
        format!("| A | radius/ℓ | truth | {names} |\n|---|---|---|{}\n", "---|".repeat(NAMES.len()));
    let mut profiles = Vec::new();
    for a in ALBEDOS {
        let alpha = half_space_single_scattering_albedo(a, Configuration::Diffuse);
        let models = Models::new(a);
        for radius in RADII {
            for light in [Lighting::Distant, Lighting::Uniform] {
                let truth = Truth::walk(alpha, radius, light);
                let radiosities = models.radiosities(radius, light);
                let row = summary(&truth, &radiosities);
                println!("| {a} | {radius} | {light:?} | {row} |");
                if light == Lighting::Distant {
                    table += &format!("| {a} | {radius} | {row} |\n");
                    profiles.push((a, radius, truth, radiosities));
                }
            }
        }
    }
    println!();
    println!(
        "Truth: what leaves of the light that arrives, and the sum of standard errors over {RINGS} rings of equal area."
    );
    println!("Models: Σ|B_model − B| / Σ B over these rings / what leaves over the truth's; in percent.");
    for (a, radius, truth, radiosities) in &profiles {
        print_rings(*a, *radius, truth, radiosities);
    }
    if std::env::args().any(|argument| argument == "--write") {
        let command = "cargo run --release -p translucid-render --example sphere_truth -- --write";
        write_measured("docs/accuracy/oblique.md", command, &table);
    }
}

type Radiosities = [[f64; RINGS]; NAMES.len()];

fn ring_bounds(ring: usize) -> [f64; 2] {
    [ring, ring + 1].map(|i| 2.0 * i as f64 / RINGS as f64 - 1.0)
}

fn summary(truth: &Truth, models: &Radiosities) -> String {
    let sum: f64 = truth.radiosity.iter().sum();
    let columns = models.map(|model| {
        let off: f64 = model.iter().zip(&truth.radiosity).map(|(b, truth)| (b - truth).abs()).sum();
        format!("{:.1} / {:.1}", 100.0 * off / sum, 100.0 * model.iter().sum::<f64>() / sum)
    });
    let noise: f64 = truth.error.iter().sum::<f64>() / sum;
    format!("{:.4} ± {:.1} % | {}", truth.share, 100.0 * noise, columns.join(" | "))
}

fn print_rings(a: f64, radius: f64, truth: &Truth, models: &Radiosities) {
    println!();
    println!("Radiosity by the cosine to the distant light: A = {a}, radius = {radius} ℓ.");
    println!();
    println!("| cosine | truth | {} |", NAMES.join(" | "));
    println!("|---|---|{}", "---|".repeat(NAMES.len()));
    for ring in (0..RINGS).rev() {
        let [from, to] = ring_bounds(ring);
        let figures: Vec<String> = models.iter().map(|model| format!("{:.4}", model[ring])).collect();
        let (b, error) = (truth.radiosity[ring], truth.error[ring]);
        println!("| {from:.1} … {to:.1} | {b:.4} ± {error:.4} | {} |", figures.join(" | "));
    }
}

/// The results of photons.
struct Truth {
    radiosity: [f64; RINGS],
    /// Standard errors.
    error: [f64; RINGS],
    /// Scattered light that leaves, of what arrives.
    share: f64,
}

impl Truth {
    fn walk(alpha: f64, radius: f64, light: Lighting) -> Self {
        let interior = Interior { single_scattering_albedo: alpha, g: 0.0, eta: 1.0 };
        let body = Body::new(Shape::Sphere { radius }, interior, light).expect("an albedo in (0, 1)");
        let tally = body.walk(PHOTONS, 1);
        // Flux πρ² of distant light at irradiance 1, or 4πρ² of uniform light, on an area of 4πρ²/RINGS
        let per_share = match light {
            Lighting::Distant => RINGS as f64 / 4.0,
            Lighting::Uniform => RINGS as f64,
        };
        // The walk counts rings from the light, the tables by rising cosine
        let ring = |i: usize| tally.scattered_through(RINGS - 1 - i);
        Self {
            radiosity: std::array::from_fn(|i| ring(i).value * per_share),
            error: std::array::from_fn(|i| ring(i).error * per_share),
            share: tally.scattered().value,
        }
    }
}

/// The models of one surface albedo, with a mean free path of 1.
struct Models {
    oblique: ObliqueDiffusionF32,
    refined: RefinedDiffusion,
    normalized: NormalizedDiffusion,
    dipole: DirectionalDipole,
}

/// Azimuths around an exit.
const SECTORS: usize = 96;
/// Azimuths and angles of light around an entry.
const DIRECTIONS: [usize; 2] = [32, 20];
/// Chords between entry and exit.
const CHORDS: usize = 160;
/// Exits in a ring.
const EXITS: usize = 4;

impl Models {
    fn new(a: f64) -> Self {
        let (mfp, diffuse, valid) = (Parameterization::Mfp, Configuration::Diffuse, "an albedo in (0, 1)");
        let appearance = Appearance { surface_albedo: a, length: 1.0, parameterization: mfp, g: 0.0 };
        let table = ObliqueDiffusionTable::new(1.0, mfp, diffuse).expect(valid);
        Self {
            oblique: table.at(a as f32, 1.0),
            refined: RefinedDiffusion::new(a, 1.0, mfp, diffuse).expect(valid),
            normalized: NormalizedDiffusion::new(a, 1.0, mfp, diffuse).expect(valid),
            dipole: DirectionalDipole::new(&appearance, 1.0).expect(valid),
        }
    }

    /// r R of every model.
    fn times_r(&self, passage: &Passage, toward_light: [f64; 3]) -> [f64; NAMES.len()] {
        let Passage { offset, r, entry, exit } = *passage;
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        [
            self.oblique.eval_times_r(single(offset), single(toward_light), single(entry)).into(),
            self.refined.eval_times_r(r),
            self.normalized.eval_times_r(r),
            r * self.dipole.eval(offset, toward_light, entry, exit),
        ]
    }

    fn radiosities(&self, radius: f64, light: Lighting) -> Radiosities {
        let rings: Vec<[f64; NAMES.len()]> = match light {
            Lighting::Distant => {
                (0..RINGS).into_par_iter().map(|ring| self.under_distant(radius, ring)).collect()
            }
            Lighting::Uniform => vec![self.under_uniform(radius); RINGS],
        };
        std::array::from_fn(|model| std::array::from_fn(|ring| rings[ring][model]))
    }

    /// ∫ R E dA over the sphere, with dA = r dr dψ around the exit, r being the chord.
    fn under_distant(&self, radius: f64, ring: usize) -> [f64; NAMES.len()] {
        let toward_light = [0.0, 0.0, 1.0];
        let [from, to] = ring_bounds(ring);
        let mut sums = [0.0; NAMES.len()];
        for i in 0..EXITS {
            let cosine = from + (to - from) * (i as f64 + 0.5) / EXITS as f64;
            for_each_chord(radius, |r, step| {
                for j in 0..SECTORS {
                    let psi = 2.0 * PI * (j as f64 + 0.5) / SECTORS as f64;
                    let passage = Passage::on_sphere(radius, cosine, r, psi);
                    let irradiance = dot(passage.entry, toward_light);
                    if irradiance > 0.0 {
                        let factor = irradiance * step * 2.0 * PI / (SECTORS * EXITS) as f64;
                        add(&mut sums, self.times_r(&passage, toward_light), factor);
                    }
                }
            });
        }
        sums
    }

    /// The results for light with a cosine distribution at every entry.
    fn under_uniform(&self, radius: f64) -> [f64; NAMES.len()] {
        let [azimuths, angles] = DIRECTIONS;
        let mut sums = [0.0; NAMES.len()];
        for_each_chord(radius, |r, step| {
            let passage = Passage::on_sphere(radius, 1.0, r, 0.0);
            // Axes at the entry; the exit lies in the plane of the first
            let normal = passage.entry;
            let (first, second) = ([normal[2], 0.0, -normal[0]], [0.0, 1.0, 0.0]);
            for i in 0..angles {
                let sin_theta = ((i as f64 + 0.5) / angles as f64).sqrt();
                let cos_theta = (1.0 - sin_theta * sin_theta).sqrt();
                for j in 0..azimuths {
                    let (sin, cos) = (2.0 * PI * (j as f64 + 0.5) / azimuths as f64).sin_cos();
                    let toward_light = std::array::from_fn(|k| {
                        cos_theta * normal[k] + sin_theta * (cos * first[k] + sin * second[k])
                    });
                    let factor = step * 2.0 * PI / (angles * azimuths) as f64;
                    add(&mut sums, self.times_r(&passage, toward_light), factor);
                }
            }
        });
        sums
    }
}

/// Chords r between 0 and 2ρ at the middles of steps dr, dense where r is small.
fn for_each_chord(radius: f64, mut f: impl FnMut(f64, f64)) {
    for i in 0..CHORDS {
        let t = (i as f64 + 0.5) / CHORDS as f64;
        f(2.0 * radius * t.powi(3), 2.0 * radius * 3.0 * t * t / CHORDS as f64);
    }
}

fn add(sums: &mut [f64; NAMES.len()], values: [f64; NAMES.len()], factor: f64) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
}

/// From an entry to an exit.
#[derive(Clone, Copy)]
struct Passage {
    offset: [f64; 3],
    r: f64,
    /// Unit normals.
    entry: [f64; 3],
    exit: [f64; 3],
}

impl Passage {
    /// To the exit at z/ρ from the entry at the end of a chord r in a direction ψ.
    fn on_sphere(radius: f64, cosine: f64, r: f64, psi: f64) -> Self {
        let sine = (1.0 - cosine * cosine).sqrt();
        let exit = [sine, 0.0, cosine];
        let (first, second) = ([cosine, 0.0, -sine], [0.0, 1.0, 0.0]);
        let sin_half = 0.5 * r / radius;
        let cos_gamma = 1.0 - 2.0 * sin_half * sin_half;
        let sin_gamma = 2.0 * sin_half * (1.0 - sin_half * sin_half).max(0.0).sqrt();
        let (sin, cos) = psi.sin_cos();
        let entry: [f64; 3] =
            std::array::from_fn(|k| cos_gamma * exit[k] + sin_gamma * (cos * first[k] + sin * second[k]));
        let offset = std::array::from_fn(|k| radius * (exit[k] - entry[k]));
        Self { offset, r, entry, exit }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
