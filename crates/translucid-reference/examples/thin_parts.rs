//! Light that thin and curved parts return, by a walk of photons and by the models of a flat half space.
//!
//! ```text
//! cargo run --release -p translucid-reference --example thin_parts [-- --write]
//! ```
//!
//! `--write` puts tables of the oblique model and of the normalization into `docs/accuracy/thin-parts.md`.
//!
//! Bodies are homogeneous, scatter isotropically and have no boundary (g = 0, η = 1).
//! Their size is a sphere's diameter, a slab's thickness, and in a wedge the distance of a point from the edge.
//! It is given by the width d of normalized diffusion in diffuse light, d = ℓ/s(A), so that d/size tells how far light
//! gets in comparison to the body.
//!
//! A profile is integrated over the surface of the body, as a renderer does it. Of the surface around an exit only the
//! *coverage* matters, how much of it there is at a distance r in comparison to a plane, 2πr dr:
//!
//! ```text
//! sphere   1 up to its diameter           (the area within a chord c is πc²)
//! slab     1, and 1 more beyond its thickness
//! wedge    what part of the circle of radius r around the exit lies on each of the half planes
//! ```

#![allow(clippy::print_stdout, reason = "the tables go to standard output")]

use std::f64::consts::{FRAC_PI_3, PI, TAU};

use rayon::prelude::*;
use translucid_profile::{
    Appearance, Configuration, Model, ObliqueDiffusionF32, ObliqueDiffusionTable, Parameterization, Profile,
    d_from_surface_albedo, half_space_single_scattering_albedo,
};
use translucid_reference::Estimate;
use translucid_reference::body::{Body, Interior, Lighting, SPHERE_RINGS, Shape, Tally};
use translucid_testing::write_measured;

const ALBEDOS: [f64; 4] = [0.2, 0.5, 0.8, 0.95];
/// d over size.
const THINNESSES: [f64; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];
/// d over the thickness of slabs that are seen from behind.
const THINNESSES_FROM_BEHIND: [f64; 5] = [0.08, 0.1, 0.17, 0.3, 1.0];
const PHOTONS: u64 = 400_000;
/// Steps of the radius in sums over the surface: of round profiles, and of the oblique one.
const RADII: [u32; 2] = [4000, 600];
/// Azimuths and angles of light around an entry.
const DIRECTIONS: [u32; 2] = [32, 60];

/// Models whose light is the same whatever its direction; the oblique one comes beside them.
const RADIAL: [Model; 8] = [
    Model::NormalizedDiffusion,
    Model::NormalizedDiffusionRefined,
    Model::Dipole,
    Model::BetterDipole,
    Model::QuantizedDiffusion,
    Model::PhotonBeamDiffusion,
    Model::Gaussians,
    Model::Exact,
];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Sphere,
    Slab,
    /// Wedge with its angle.
    Wedge(f64),
}

const KINDS: [(&str, Kind); 4] = [
    ("Sphere", Kind::Sphere),
    ("Slab", Kind::Slab),
    ("Edge of 60°", Kind::Wedge(FRAC_PI_3)),
    ("Edge of 20°", Kind::Wedge(PI / 9.0)),
];

fn main() {
    let media: Vec<Models> = ALBEDOS.iter().map(|&a| Models::new(a)).collect();
    let mut summary = Summary::default();
    let mut uniform = pivot("body, A", THINNESSES);
    for (title, kind) in KINDS {
        println!("### {title} in even light\n");
        let names: Vec<&str> = RADIAL.iter().map(|model| model.name()).collect();
        println!("| A | d/size | scattered | straight | oblique | {} | normalized |", names.join(" | "));
        println!("|---|---|---|---|---|{}---|", "---|".repeat(RADIAL.len()));
        for models in &media {
            let oblique = THINNESSES.map(|thinness| {
                let size = models.d / thinness;
                let truth = truth(kind, models.a, size, Lighting::Uniform);
                let energies = models.energies(kind, size);
                println!("{}", even_row(models.a, thinness, &truth, &energies));
                summary.add(&truth, &energies, models.a);
                percent(energies[0] / truth.leaving().value)
            });
            uniform += &format!("| {title}, {} | {} |\n", models.a, oblique.join(" | "));
        }
        println!();
    }
    println!("### Light from one side\n");
    println!(
        "| body | A | d/size | truth | normalized-diffusion | normalized-diffusion-refined | normalized |"
    );
    println!("|---|---|---|---|---|---|---|");
    for models in &media {
        for thinness in THINNESSES {
            println!("{}", models.slab_row(thinness));
            println!("{}", models.sphere_row(thinness));
        }
    }
    println!("\n### From behind\n");
    println!(
        "| light along | A | d/size | through | straight | oblique | normalized-diffusion | normalized-diffusion-refined |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let mut behind = pivot("light along, A", THINNESSES_FROM_BEHIND);
    for (name, light) in [("all directions", Lighting::Uniform), ("the normal", Lighting::Distant)] {
        for models in &media {
            let oblique = THINNESSES_FROM_BEHIND.map(|thinness| {
                let [truth, straight, shares @ ..] = models.cells_from_behind(thinness, light);
                println!(
                    "| {name} | {} | {thinness} | {truth} | {straight} | {} |",
                    models.a,
                    shares.join(" | ")
                );
                let [oblique, ..] = shares;
                oblique
            });
            behind += &format!("| {name}, {} | {} |\n", models.a, oblique.join(" | "));
        }
    }
    let tables =
        [("in uniform light", uniform), ("from behind", behind), ("by normalization", summary.table())];
    for (what, table) in &tables {
        println!("\n### Summary, {what}\n\n{table}");
    }
    if std::env::args().any(|argument| argument == "--write") {
        for (what, table) in tables {
            let command = "cargo run --release -p translucid-reference --example thin_parts -- --write";
            write_measured("docs/accuracy/thin-parts.md", &format!("{command}, {what}"), &table);
        }
    }
}

/// The head of a table with a column for each of these d/size.
fn pivot(first: &str, thinnesses: [f64; 5]) -> String {
    let columns = thinnesses.map(|thinness| thinness.to_string()).join(" | ");
    format!("| {first} | d/size = {columns} |\n|---|{}\n", "---|".repeat(thinnesses.len()))
}

fn body(kind: Kind, size: f64) -> Shape {
    match kind {
        Kind::Sphere => Shape::Sphere { radius: 0.5 * size },
        Kind::Slab => Shape::Slab { thickness: size },
        Kind::Wedge(angle) => Shape::Wedge { angle, distance: size },
    }
}

fn truth(kind: Kind, a: f64, size: f64, light: Lighting) -> Tally {
    let alpha = half_space_single_scattering_albedo(a, Configuration::Diffuse);
    let medium = Interior { single_scattering_albedo: alpha, g: 0.0, eta: 1.0 };
    Body::new(body(kind, size), medium, light).expect("an albedo in (0, 1)").walk(PHOTONS, 1)
}

fn percent(x: f64) -> String {
    format!("{:.1}", 100.0 * x)
}

fn even_row(a: f64, thinness: f64, truth: &Tally, energies: &[f64]) -> String {
    let all = truth.leaving().value;
    let models: Vec<String> = energies.iter().map(|energy| percent(energy / all)).collect();
    let [scattered, straight] = [truth.scattered(), truth.straight()].map(|share| percent(share.value));
    let models = models.join(" | ");
    format!("| {a} | {thinness} | {scattered} | {straight} | {models} | {} |", percent(a / all))
}

/// The models of one surface albedo, with a mean free path of 1.
struct Models {
    a: f64,
    /// Width of normalized diffusion.
    d: f64,
    radial: Vec<Box<dyn Profile>>,
    oblique: ObliqueDiffusionF32,
}

impl Models {
    fn new(a: f64) -> Self {
        let (mfp, diffuse, valid) = (Parameterization::Mfp, Configuration::Diffuse, "an albedo in (0, 1)");
        let appearance = Appearance { surface_albedo: a, length: 1.0, parameterization: mfp, g: 0.0 };
        let profile = |model: &Model| model.profile(&appearance, diffuse, 1.0).expect(valid);
        let table = ObliqueDiffusionTable::new(1.0, mfp, diffuse).expect(valid);
        Self {
            a,
            d: d_from_surface_albedo(a, 1.0, mfp, diffuse),
            radial: RADIAL.iter().map(profile).collect(),
            oblique: table.at(a as f32, 1.0),
        }
    }

    /// Light that every model returns of even light, the oblique one first.
    fn energies(&self, kind: Kind, size: f64) -> Vec<f64> {
        let mut energies =
            vec![self.oblique_energies(kind, size, |r, q| self.oblique_times_r(r, q)).iter().sum()];
        energies.extend(self.radial.iter().map(|profile| radial_energy(profile.as_ref(), kind, size)));
        energies
    }

    /// Light that is returned from each of the body's faces by r R at a distance r, of which the share q lies along the
    /// surface at the entry.
    fn oblique_energies(&self, kind: Kind, size: f64, times_r: impl Fn(f64, f64) -> f64 + Sync) -> Vec<f64> {
        let longest = 60.0 * self.d;
        let step = |i: u32| {
            let t = (f64::from(i) + 0.5) / f64::from(RADII[1]);
            let r = longest * t.powi(3);
            let weight = TAU * longest * 3.0 * t * t / f64::from(RADII[1]);
            let face = |[share, q]: [f64; 2]| weight * share * times_r(r, q);
            coverage(kind, size, r).into_iter().map(face).collect::<Vec<f64>>()
        };
        let steps: Vec<Vec<f64>> = (0..RADII[1]).into_par_iter().map(step).collect();
        (0..steps[0].len()).map(|face| steps.iter().map(|step| step[face]).sum()).collect()
    }

    /// The far face of a slab with light on the near one: what gets through, scattered and straight, and the shares of
    /// the former that the oblique model and the first two radial ones have.
    fn cells_from_behind(&self, thinness: f64, light: Lighting) -> [String; 5] {
        let size = self.d / thinness;
        let tally = truth(Kind::Slab, self.a, size, light);
        let through = tally.scattered_through(1);
        let oblique = match light {
            Lighting::Uniform => self.oblique_energies(Kind::Slab, size, |r, q| self.oblique_times_r(r, q)),
            Lighting::Distant => self.oblique_energies(Kind::Slab, size, |r, q| {
                self.oblique_times_r_toward(along(q, r), [0.0, 0.0, 1.0])
            }),
        };
        let share = |energy: f64| percent(energy / through.value);
        let [oblique, normalized, refined] =
            [oblique[1], self.radial[0].beyond(size), self.radial[1].beyond(size)].map(share);
        let truth = format!("{:.2} ± {:.2}", 100.0 * through.value, 100.0 * through.error);
        [truth, percent(tally.straight().value), oblique, normalized, refined]
    }

    /// r R averaged over light from everywhere.
    fn oblique_times_r(&self, r: f64, q: f64) -> f64 {
        let [azimuths, angles] = DIRECTIONS;
        let offset = along(q, r);
        let mut sum = 0.0;
        for i in 0..angles {
            let sin_theta = ((f64::from(i) + 0.5) / f64::from(angles)).sqrt();
            for j in 0..azimuths {
                let (sin, cos) = (TAU * (f64::from(j) + 0.5) / f64::from(azimuths)).sin_cos();
                let toward = [sin_theta * cos, sin_theta * sin, (1.0 - sin_theta * sin_theta).sqrt()];
                sum += self.oblique_times_r_toward(offset, toward);
            }
        }
        sum / f64::from(angles * azimuths)
    }

    /// r R of light that comes from a direction on a surface that faces z.
    fn oblique_times_r_toward(&self, offset: [f64; 3], toward: [f64; 3]) -> f64 {
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        self.oblique.eval_times_r(single(offset), single(toward), [0.0, 0.0, 1.0]).into()
    }

    /// Both faces of a slab under parallel light: Σ|model − truth| / Σ truth.
    fn slab_row(&self, thinness: f64) -> String {
        let size = self.d / thinness;
        // A diffuse profile is that of light from all angles: such light falls on one face
        let tally = truth(Kind::Slab, self.a, size, Lighting::Uniform);
        let truths = [tally.scattered_through(0), tally.scattered_through(1)];
        let faces = |profile: &dyn Profile| vec![profile.surface_albedo(), profile.beyond(size)];
        self.side_row("slab", thinness, &truths, faces, |profile| radial_energy(profile, Kind::Slab, size))
    }

    /// Rings of a sphere under parallel light.
    fn sphere_row(&self, thinness: f64) -> String {
        let size = self.d / thinness;
        let tally = truth(Kind::Sphere, self.a, size, Lighting::Distant);
        let truths: Vec<Estimate> = (0..SPHERE_RINGS).map(|ring| tally.scattered_through(ring)).collect();
        let rings = |profile: &dyn Profile| sphere_rings(profile, 0.5 * size);
        self.side_row("sphere", thinness, &truths, rings, |profile| {
            radial_energy(profile, Kind::Sphere, size)
        })
    }

    fn side_row(
        &self,
        name: &str,
        thinness: f64,
        truths: &[Estimate],
        parts: impl Fn(&dyn Profile) -> Vec<f64>,
        energy: impl Fn(&dyn Profile) -> f64,
    ) -> String {
        let all: f64 = truths.iter().map(|truth| truth.value).sum();
        let off = |parts: &[f64], factor: f64| -> f64 {
            parts.iter().zip(truths).map(|(part, truth)| (part * factor - truth.value).abs()).sum::<f64>()
                / all
        };
        let columns: Vec<String> = self.radial[..2]
            .iter()
            .map(|profile| {
                let parts = parts(profile.as_ref());
                percent(off(&parts, 1.0))
            })
            .collect();
        let refined = self.radial[1].as_ref();
        let normalized = off(&parts(refined), self.a / energy(refined));
        let [a, all] = [self.a.to_string(), percent(all)];
        format!("| {name} | {a} | {thinness} | {all} | {} | {} |", columns.join(" | "), percent(normalized))
    }
}

/// The way from an entry that faces z to an exit at a distance r, of which the share q lies along the surface.
fn along(q: f64, r: f64) -> [f64; 3] {
    [q * r, 0.0, -(1.0 - q * q).max(0.0).sqrt() * r]
}

/// Energy of a profile over the surface of a body: ∫ coverage dE, with the profile's own sums over rings.
fn radial_energy(profile: &dyn Profile, kind: Kind, size: f64) -> f64 {
    match kind {
        Kind::Sphere => profile.enclosed(size),
        Kind::Slab => profile.surface_albedo() + profile.beyond(size),
        Kind::Wedge(_) => {
            // Radii at which the energy beyond falls evenly, and half of what each ring has at both of its ends
            let longest = 40.0 * size.max(profile.scale());
            let radius = |i: u32| longest * (f64::from(i) / f64::from(RADII[0])).powi(3);
            let cover = |r: f64| coverage(kind, size, r).iter().map(|[share, _]| share).sum::<f64>();
            let rings = (0..RADII[0]).map(|i| {
                let (from, to) = (radius(i), radius(i + 1));
                (profile.beyond(from) - profile.beyond(to)) * cover(0.5 * (from + to))
            });
            rings.sum::<f64>() + profile.beyond(longest) * cover(longest)
        }
    }
}

/// For the body's faces the surface at a distance r from an exit in comparison to a plane's, and what share of the way
/// from there lies along the surface there.
fn coverage(kind: Kind, size: f64, r: f64) -> Vec<[f64; 2]> {
    // A plane at a distance, of which there is the part to one side of a line at a distance from the foot point
    let half_plane = |distance: f64, to_edge: f64| {
        let along = (r * r - distance * distance).max(0.0).sqrt();
        let share = 1.0 - (to_edge / along.max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0).acos() / PI;
        [if r > distance { share } else { 0.0 }, along / r]
    };
    match kind {
        Kind::Sphere => {
            let is_there = r < size;
            vec![[f64::from(u8::from(is_there)), (1.0 - (r / size).powi(2)).max(0.0).sqrt()]]
        }
        Kind::Slab => vec![[1.0, 1.0], half_plane(size, f64::INFINITY)],
        Kind::Wedge(angle) => {
            vec![half_plane(0.0, size), half_plane(size * angle.sin(), size * angle.cos())]
        }
    }
}

/// Share of the parallel light on a sphere that leaves through each ring, from the one that faces the light.
fn sphere_rings(profile: &dyn Profile, radius: f64) -> Vec<f64> {
    let (exits, chords, sectors) = (8_u32, 400_u32, 96_u32);
    let ring = |ring: usize| {
        let mut sum = 0.0;
        for i in 0..exits {
            let cosine =
                1.0 - 2.0 * (ring as f64 + (f64::from(i) + 0.5) / f64::from(exits)) / SPHERE_RINGS as f64;
            let sine = (1.0 - cosine * cosine).sqrt();
            for j in 0..chords {
                let [from, to] =
                    [j, j + 1].map(|j| 2.0 * radius * (f64::from(j) / f64::from(chords)).powi(3));
                let energy = profile.beyond(from) - profile.beyond(to);
                let sin_half = 0.25 * (from + to) / radius;
                let cos_gamma = 1.0 - 2.0 * sin_half * sin_half;
                let sin_gamma = (1.0 - cos_gamma * cos_gamma).sqrt();
                let lit: f64 = (0..sectors)
                    .map(|k| {
                        let psi = TAU * (f64::from(k) + 0.5) / f64::from(sectors);
                        (cos_gamma * cosine - sin_gamma * psi.cos() * sine).max(0.0)
                    })
                    .sum();
                sum += energy * lit / f64::from(sectors);
            }
        }
        // Of the flux πρ² on a ring of 4πρ²/RINGS
        sum / f64::from(exits) * 4.0 / SPHERE_RINGS as f64
    };
    (0..SPHERE_RINGS).into_par_iter().map(ring).collect()
}

/// Mean |error| of what is returned, by d/size.
#[derive(Default)]
struct Summary {
    /// Without and with normalization.
    rows: Vec<[f64; 2]>,
}

impl Summary {
    fn add(&mut self, truth: &Tally, energies: &[f64], a: f64) {
        let all = truth.leaving().value;
        let off = |energy: f64| (energy / all - 1.0).abs();
        self.rows.push([off(energies[2]), off(a)]);
    }

    /// The refined profile without and with normalization, means over the surface albedos.
    fn table(&self) -> String {
        let mut table = pivot("body", THINNESSES);
        for ((title, _), rows) in KINDS.iter().zip(self.rows.chunks(ALBEDOS.len() * THINNESSES.len())) {
            let cells = (0..THINNESSES.len()).map(|i| {
                let mean = |column: usize| {
                    let of_thinness = rows.iter().skip(i).step_by(THINNESSES.len());
                    percent(of_thinness.map(|row| row[column]).sum::<f64>() / ALBEDOS.len() as f64)
                };
                format!("{} / {}", mean(0), mean(1))
            });
            table += &format!("| {title} | {} |\n", cells.collect::<Vec<_>>().join(" | "));
        }
        table
    }
}
