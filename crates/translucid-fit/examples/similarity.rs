//! Errors of similarity, before and after its repair.
//!
//! ```text
//! cargo run --release -p translucid-fit -F generators --example similarity_tables > target/similarity_tables.csv
//! cargo run --release -p translucid-fit -F generators --example similarity -- target/similarity_tables.csv [--write]
//! ```
//!
//! Without the file the tables are made anew, which takes some minutes.
//! `--write` puts the errors over the whole grid into `docs/accuracy/similarity.md`.

#![allow(clippy::print_stdout, reason = "the tables go to standard output")]

#[path = "similarity/tables.rs"]
mod tables;

use tables::{CONFIGURATIONS, Case, HELD_OUT, Point, Table, tables};
use translucid_fit::Judge;
use translucid_profile::{
    Appearance, Configuration, ExactProfile, NormalizedDiffusion, Parameterization, Profile,
    RefinedDiffusion, SimilarRefinedDiffusion, Similarity, half_space_single_scattering_albedo,
};
use translucid_testing::write_measured;

/// Contenders of the tables of errors.
const COLUMNS: [&str; 8] = [
    "exact, ℓ",
    "exact, ℓ*",
    "exact at A', ℓ*",
    "normalized diffusion, ℓ*",
    "normalized diffusion, repaired",
    "refined, ℓ*",
    "refined, repaired",
    "refined, repaired, from ℓ_d",
];

fn main() {
    let all = tables();
    print_ring_check();
    let summary = CONFIGURATIONS.map(|configuration| {
        let words = match configuration {
            Configuration::Searchlight => "Searchlight",
            Configuration::Diffuse => "Diffuse transmission",
        };
        let of_configuration: Vec<&Table> =
            all.iter().filter(|table| table.case.configuration == configuration).collect();
        let over_grid = print_errors(words, &of_configuration);
        print_by_albedo(words, &of_configuration);
        print_by_distance(words, &of_configuration);
        print_albedos(words, &of_configuration);
        over_grid
    });
    let mut table = String::from(
        "| profile | searchlight: mean | worst | diffuse: mean | worst |\n|---|---|---|---|---|\n",
    );
    for (i, name) in COLUMNS.iter().enumerate() {
        let [searchlight, diffuse] = [0, 1].map(|c: usize| summary[c][i].replace(" / ", " | "));
        table += &format!("| {name} | {searchlight} | {diffuse} |\n");
    }
    println!("\n### Both, over the whole grid\n\n{table}");
    if std::env::args().any(|argument| argument == "--write") {
        let command = "cargo run --release -p translucid-fit -F generators --example similarity -- --write";
        write_measured("docs/accuracy/similarity.md", command, &table);
    }
}

/// A profile that was made for ℓ = 1 from a length.
fn error(point: &Point, profile: &dyn Profile, length: f64) -> f64 {
    point.l1_error(|r| profile.enclosed(r / length) / profile.surface_albedo())
}

/// Errors of all contenders at one point.
fn errors(case: Case, point: &Point) -> [f64; COLUMNS.len()] {
    let Case { g, eta, configuration } = case;
    let a = point.surface_albedo;
    let known = "an albedo in (0, 1)";
    let exact = |a: f64| ExactProfile::new(a, 1.0, Parameterization::Mfp, configuration).expect(known);
    let talk = NormalizedDiffusion::new(a, 1.0, Parameterization::Mfp, configuration).expect(known);
    let refined = RefinedDiffusion::new(a, 1.0, Parameterization::Mfp, configuration).expect(known);
    let similar_albedo = translucid_profile::half_space_surface_albedo(point.alpha_prime(g), configuration);
    let transport_mfp = point.transport_mfp(g);
    let appearance =
        |length: f64, parameterization| Appearance { surface_albedo: a, length, parameterization, g };
    let of_mfp = appearance(1.0, Parameterization::Mfp);
    let absorbed = 1.0 - point.alpha_prime(g);
    let dmfp = transport_mfp / (3.0 * absorbed / (1.0 + absorbed)).sqrt();
    let of_dmfp = appearance(dmfp, Parameterization::Dmfp);
    let known = "parameters in the domain";
    let repaired = |appearance| SimilarRefinedDiffusion::new(appearance, eta, configuration).expect(known);
    [
        error(point, &exact(a), 1.0),
        error(point, &exact(a), transport_mfp),
        error(point, &exact(similar_albedo), transport_mfp),
        error(point, &talk, transport_mfp),
        error(point, &NormalizedDiffusion::from_appearance(&of_mfp, eta, configuration).expect(known), 1.0),
        error(point, &refined, transport_mfp),
        error(point, &repaired(&of_mfp), 1.0),
        error(point, &repaired(&of_dmfp), 1.0),
    ]
}

fn is_held_out(case: Case) -> bool {
    HELD_OUT.contains(&[case.g, case.eta])
}

/// Mean and greatest of some numbers, in percent.
fn mean_and_worst(numbers: impl Iterator<Item = f64> + Clone) -> String {
    let count = numbers.clone().count() as f64;
    let mean = numbers.clone().sum::<f64>() / count;
    format!("{:.1} / {:.1}", 100.0 * mean, 100.0 * numbers.fold(0.0, f64::max))
}

/// The name of a row.
fn row(case: Case) -> String {
    let reference = if case.is_exact() { "exact" } else { "walk" };
    let held_out = if is_held_out(case) { ", held out" } else { "" };
    format!("{} | {} | {reference}{held_out}", case.g, case.eta)
}

/// Errors of each case; returns those over the grid without its first row, mean and worst.
fn print_errors(words: &str, tables: &[&Table]) -> [String; COLUMNS.len()] {
    println!("\n### {words}: errors, mean / worst over A, in percent\n");
    println!("| g | η | reference | noise | {} |", COLUMNS.join(" | "));
    println!("|---|---|---|---|{}", "---|".repeat(COLUMNS.len()));
    let mut sums: [Vec<f64>; COLUMNS.len()] = std::array::from_fn(|_| Vec::new());
    for table in tables {
        let all: Vec<_> = table.points.iter().map(|point| errors(table.case, point)).collect();
        let columns: Vec<String> =
            (0..COLUMNS.len()).map(|i| mean_and_worst(all.iter().map(move |errors| errors[i]))).collect();
        let noise = mean_and_worst(table.points.iter().map(Point::noise));
        println!("| {} | {noise} | {} |", row(table.case), columns.join(" | "));
        if !is_held_out(table.case) && table.case.g.abs() + (table.case.eta - 1.0) > 0.0 {
            sums.iter_mut().enumerate().for_each(|(i, sum)| sum.extend(all.iter().map(|errors| errors[i])));
        }
    }
    let columns = sums.map(|sum| mean_and_worst(sum.iter().copied()));
    println!("| all | | without the first row of g = 0 and what is held out | | {} |", columns.join(" | "));
    columns
}

/// Means over the grid for each surface albedo.
fn print_by_albedo(words: &str, tables: &[&Table]) {
    println!("\n### {words}: the same by surface albedo\n");
    println!("| A | noise | {} |", COLUMNS.join(" | "));
    println!("|---|---|{}", "---|".repeat(COLUMNS.len()));
    for surface_albedo in tables::SURFACE_ALBEDOS {
        let points: Vec<(Case, &Point)> = (tables.iter())
            .filter(|table| !is_held_out(table.case))
            .filter(|table| table.case.g != 0.0 || table.case.eta != 1.0)
            .flat_map(|table| table.points.iter().map(|point| (table.case, point)))
            .filter(|(_, point)| point.surface_albedo == surface_albedo)
            .collect();
        let all: Vec<_> = points.iter().map(|(case, point)| errors(*case, point)).collect();
        let columns: Vec<String> =
            (0..COLUMNS.len()).map(|i| mean_and_worst(all.iter().map(move |errors| errors[i]))).collect();
        let noise = mean_and_worst(points.iter().map(|(_, point)| point.noise()));
        println!("| {surface_albedo} | {noise} | {} |", columns.join(" | "));
    }
}

/// Errors by radius, at A = 0.5.
fn print_by_distance(words: &str, tables: &[&Table]) {
    const A: f64 = 0.5;
    const BOUNDS: [f64; 4] = [0.0, 1.0, 4.0, f64::INFINITY];
    println!("\n### {words}: where the errors are, at A = {A}\n");
    println!(
        "Share of the energy / part of the error of the refined profile by similarity alone / repaired, in percent.\n"
    );
    println!("| g | η | r < ℓ* | ℓ* to 4 ℓ* | beyond |");
    println!("|---|---|---|---|---|");
    for table in tables.iter().filter(|table| !is_held_out(table.case)) {
        let Case { g, eta, configuration } = table.case;
        let Some(point) = table.points.iter().find(|point| point.surface_albedo == A) else { continue };
        let transport_mfp = point.transport_mfp(g);
        let known = "parameters in the domain";
        let plain =
            RefinedDiffusion::new(A, transport_mfp, Parameterization::Mfp, configuration).expect(known);
        let of_mfp =
            Appearance { surface_albedo: A, length: 1.0, parameterization: Parameterization::Mfp, g };
        let repaired = SimilarRefinedDiffusion::new(&of_mfp, eta, configuration).expect(known);
        let cells = BOUNDS.windows(2).map(|bounds| {
            let range = bounds[0] * transport_mfp..bounds[1] * transport_mfp;
            let [before, share] = point.l1_error_between(range.clone(), |r| plain.cdf(r));
            let [after, _] = point.l1_error_between(range, |r| repaired.cdf(r));
            format!("{:.1} / {:.1} / {:.1}", 100.0 * share, 100.0 * before, 100.0 * after)
        });
        println!("| {g} | {eta} | {} |", cells.collect::<Vec<_>>().join(" | "));
    }
}

/// Relative errors of 1 − α' and of ℓ*.
fn print_albedos(words: &str, tables: &[&Table]) {
    println!(
        "\n### {words}: relative errors of 1 − α' and of ℓ* = ℓ/(1 − αg), mean / worst over A, in percent\n"
    );
    println!(
        "| g | η | reference | noise of 1 − α | 1 − α', by that of g = 0, η = 1 | repaired | ℓ*, by that of g = 0, η = 1 | repaired |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for table in tables {
        let Case { g, eta, configuration } = table.case;
        let of_point = |point: &Point| -> [f64; 5] {
            let [alpha, noise] = point.single_scattering_albedo;
            let a = point.surface_albedo;
            let plain = half_space_single_scattering_albedo(a, configuration);
            let repaired = Similarity::new(a, g, eta, configuration).expect("parameters in the domain");
            let transport_mfp = |alpha_prime: f64| (1.0 - g * (1.0 - alpha_prime)) / (1.0 - g);
            let off = |found: f64, truth: f64| (found / truth - 1.0).abs();
            let (truth, truth_mfp) = (1.0 - point.alpha_prime(g), point.transport_mfp(g));
            [
                noise / (1.0 - alpha),
                off(1.0 - plain, truth),
                off(1.0 - repaired.alpha_prime(), truth),
                off(transport_mfp(plain), truth_mfp),
                off(transport_mfp(repaired.alpha_prime()), truth_mfp),
            ]
        };
        let all: Vec<_> = table.points.iter().map(of_point).collect();
        let columns: Vec<String> =
            (0..5).map(|i| mean_and_worst(all.iter().map(move |errors| errors[i]))).collect();
        println!("| {} | {} |", row(table.case), columns.join(" | "));
    }
}

/// Share of an L1 distance that rings of half an octave miss.
fn print_ring_check() {
    let configuration = Configuration::Searchlight;
    let mut worst: f64 = 0.0;
    let case = Case { g: 0.0, eta: 1.0, configuration };
    let table = Table::new(case);
    for point in &table.points {
        let a = point.surface_albedo;
        let known = "an albedo in (0, 1)";
        let exact = ExactProfile::new(a, 1.0, Parameterization::Mfp, configuration).expect(known);
        let talk = NormalizedDiffusion::new(a, 1.0, Parameterization::Mfp, configuration).expect(known);
        let whole = Judge::new(&exact).l1_error(&talk, f64::INFINITY);
        worst = worst.max((error(point, &talk, 1.0) - whole).abs());
    }
    println!(
        "Rings of half an octave in place of all radii change the L1 distance of normalized diffusion (g = 0, η = 1, searchlight) by {:.2} % of the energy at most.",
        100.0 * worst
    );
}
