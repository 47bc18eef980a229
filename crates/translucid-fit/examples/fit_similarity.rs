//! Generates the coefficients of `translucid_profile::Similarity`.
//!
//! ```text
//! cargo run --release -p translucid-fit -F generators --example similarity_tables > target/similarity_tables.csv
//! cargo run --release -p translucid-fit -F generators --example fit_similarity -- target/similarity_tables.csv > target/similarity_coefficients.rs
//! mv target/similarity_coefficients.rs crates/translucid-profile/src/medium/similarity_coefficients.rs
//! ```
//!
//! Every function is Σ_m m(g, L) P_m(√A) with polynomials P_m and the monomials m of [`monomials`], which are all 0 for
//! isotropic scattering without a boundary:
//! 1. The surface albedo A' of the isotropic, index-matched half space with the same α': logit A' − logit A, by
//!    weighted least squares.
//! 2. The stretch of normalized diffusion: ln c, for the least sum of L1 distances over all points of the grid, with
//!    the best s of each A in place of the talk's polynomial, so that c does not mend that one's errors.
//! 3. Stretch, depth and rate of the dimple of the refined profile: ln c, b and ln κ, likewise.

#![allow(clippy::print_stdout, reason = "the generated file goes to standard output")]

#[path = "fit_similarity/joint_fit.rs"]
mod joint_fit;
#[path = "similarity/tables.rs"]
mod tables;

use joint_fit::JointFit;
use nalgebra::{DMatrix, DVector};
use tables::{ETA, G, Point, SURFACE_ALBEDOS, Table, differences, radii, tables};
use translucid_fit::ScalingFit;
use translucid_profile::{
    Configuration, Parameterization, RefinedDiffusion, fresnel_moment_1_from_inside,
    half_space_single_scattering_albedo, half_space_surface_albedo,
};

/// Monomials of g and L.
const MONOMIALS: usize = 7;
/// Coefficients of a polynomial in √A.
const OF_POLYNOMIAL: usize = 5;
/// Degree of the polynomials for the dimple's rate.
const OF_RATE: usize = 3;
/// Start of the fit of the dimple: ln κ.
const LN_RATE: f64 = 1.0;
/// Error that the albedos' logits may have.
const LOGIT_TOLERANCE: f64 = 0.01;
/// Decimals that are kept.
const UNIT: f64 = 1e-4;

/// g, g², g³, L, L², gL, g²L, where 1 − e^{−L} is the boundary's reflectance for diffuse light from inside.
fn monomials(g: f64, eta: f64) -> [f64; MONOMIALS] {
    let l = -(1.0 - 2.0 * fresnel_moment_1_from_inside(eta)).ln();
    [g, g * g, g * g * g, l, l * l, g * l, g * g * l]
}

/// m(g, L) √Aⁱ, by monomial, then by power.
fn basis(monomials: &[f64], surface_albedo: f64, powers: usize) -> Vec<f64> {
    let root = surface_albedo.sqrt();
    monomials.iter().flat_map(|m| (0..powers).map(move |i| m * root.powi(i as i32))).collect()
}

fn logit(x: f64) -> f64 {
    (x / (1.0 - x)).ln()
}

/// A point of the grid with its case.
struct Datum<'a> {
    g: f64,
    monomials: [f64; MONOMIALS],
    point: &'a Point,
    /// Radii in transport mean free paths.
    radii: Vec<f64>,
}

/// Rounded coefficients of one configuration.
struct Coefficients {
    similar_albedo: Vec<f64>,
    stretch_of_normalized_diffusion: Vec<f64>,
    stretch: Vec<f64>,
    dimple: Vec<f64>,
    dimple_rate: Vec<f64>,
    /// Errors that the rounded coefficients leave.
    errors: Errors,
}

/// Errors of one configuration at all points of the grid.
struct Errors {
    /// Errors of normalized diffusion with the best s of each A, and of the refined profile; by similarity alone, and repaired.
    normalized_diffusion: [Vec<f64>; 2],
    refined: [Vec<f64>; 2],
    /// Relative errors of 1 − α'.
    absorbed: Vec<f64>,
}

fn main() {
    let all = tables();
    let fits = [Configuration::Searchlight, Configuration::Diffuse].map(|configuration| {
        let data = data(&all, configuration);
        Coefficients::fit(&data, configuration)
    });
    print_header(&fits);
    print_coefficients("SEARCHLIGHT", "searchlight", &fits[0]);
    print_coefficients("DIFFUSE", "diffuse transmission", &fits[1]);
}

/// All points of the grid, without what is held out.
fn data(all: &[Table], configuration: Configuration) -> Vec<Datum<'_>> {
    let wanted = |table: &&Table| {
        let case = table.case;
        case.configuration == configuration && G.contains(&case.g) && ETA.contains(&case.eta)
    };
    let of_table = |table: &'_ &Table| -> (f64, [f64; MONOMIALS]) {
        (table.case.g, monomials(table.case.g, table.case.eta))
    };
    let mut data = Vec::new();
    for table in all.iter().filter(wanted) {
        let (g, monomials) = of_table(&table);
        data.extend(table.points.iter().map(|point| {
            let transport_mfp = point.transport_mfp(g);
            let radii = radii().into_iter().map(|r| r / transport_mfp).collect();
            Datum { g, monomials, point, radii }
        }));
    }
    assert_eq!(data.len(), G.len() * ETA.len() * SURFACE_ALBEDOS.len(), "points of the grid");
    data
}

impl Coefficients {
    fn fit(data: &[Datum], configuration: Configuration) -> Self {
        let similar_albedo = rounded(&fit_similar_albedo(data, configuration));
        let (of_normalized_diffusion, normalized_diffusion) = fit_normalized_diffusion(data, configuration);
        let (refined, of_refined) = fit_refined(data, configuration, &of_normalized_diffusion);
        let absorbed = errors_of_absorbed(data, configuration, &similar_albedo);
        let (stretch, rest) = refined.split_at(MONOMIALS * OF_POLYNOMIAL);
        let (dimple, dimple_rate) = rest.split_at(MONOMIALS * OF_POLYNOMIAL);
        Self {
            similar_albedo,
            stretch_of_normalized_diffusion: of_normalized_diffusion,
            stretch: stretch.to_vec(),
            dimple: dimple.to_vec(),
            dimple_rate: dimple_rate.to_vec(),
            errors: Errors { normalized_diffusion, refined: of_refined, absorbed },
        }
    }
}

fn rounded(coefficients: &[f64]) -> Vec<f64> {
    coefficients.iter().map(|c| (c / UNIT).round() * UNIT).collect()
}

/// Relative errors of 1 − α' by way of A', whose own α' is exact here.
fn errors_of_absorbed(data: &[Datum], configuration: Configuration, coefficients: &[f64]) -> Vec<f64> {
    let error = |datum: &Datum| {
        let a = datum.point.surface_albedo;
        let basis = basis(&datum.monomials, a, OF_POLYNOMIAL);
        let logit = logit(a) + basis.iter().zip(coefficients).map(|(b, c)| b * c).sum::<f64>();
        let similar = 1.0 / (1.0 + (-logit).exp());
        let found = 1.0 - half_space_single_scattering_albedo(similar, configuration);
        (found / (1.0 - datum.point.alpha_prime(datum.g)) - 1.0).abs()
    };
    data.iter().map(error).collect()
}

/// Least squares of logit A' − logit A, each weighed by its error.
fn fit_similar_albedo(data: &[Datum], configuration: Configuration) -> Vec<f64> {
    let rows: Vec<(Vec<f64>, f64, f64)> = data
        .iter()
        .map(|datum| {
            let [alpha, error] = datum.point.single_scattering_albedo;
            let similar = |alpha: f64| {
                let reduced = (1.0 - datum.g) * alpha / (1.0 - datum.g * alpha);
                logit(half_space_surface_albedo(reduced, configuration))
            };
            let lower = alpha - 0.5 * error;
            let noise = if error > 0.0 { 2.0 * (similar(alpha) - similar(lower)) } else { 0.0 };
            let a = datum.point.surface_albedo;
            let basis = basis(&datum.monomials, a, OF_POLYNOMIAL);
            (basis, similar(alpha) - logit(a), 1.0 / noise.hypot(LOGIT_TOLERANCE))
        })
        .collect();
    let matrix = DMatrix::from_fn(rows.len(), MONOMIALS * OF_POLYNOMIAL, |i, j| rows[i].2 * rows[i].0[j]);
    let right = DVector::from_fn(rows.len(), |i, _| rows[i].2 * rows[i].1);
    let solution = matrix.svd(true, true).solve(&right, 1e-14).expect("both bases were asked for");
    solution.as_slice().to_vec()
}

/// Rounded coefficients, and the errors before and after.
fn fit_normalized_diffusion(data: &[Datum], configuration: Configuration) -> (Vec<f64>, [Vec<f64>; 2]) {
    let best = ScalingFit::new(Parameterization::Mfp, configuration, &SURFACE_ALBEDOS, f64::INFINITY)
        .expect("albedos in (0, 1)");
    let s = |a: f64| {
        let point = best.points().iter().find(|point| point.surface_albedo == a);
        point.expect("every albedo was fitted").s
    };
    let scales: Vec<f64> = data.iter().map(|datum| s(datum.point.surface_albedo)).collect();
    let fit = JointFit {
        shares: data.iter().map(|datum| &datum.point.shares[..]).collect(),
        bases: data.iter().map(|d| [basis(&d.monomials, d.point.surface_albedo, OF_POLYNOMIAL)]).collect(),
        model: |i: usize, [ln_stretch]: [f64; 1]| {
            let within = |r: &f64| {
                let t = r * scales[i] * ln_stretch.exp();
                1.0 - 0.25 * (-t).exp() - 0.75 * (-t / 3.0).exp()
            };
            differences(data[i].radii.iter().map(within))
        },
    };
    let before = vec![0.0; MONOMIALS * OF_POLYNOMIAL];
    let after = rounded(&fit.minimize_l1(before.clone()));
    let errors = [fit.l1_errors(&before), fit.l1_errors(&after)];
    (after, errors)
}

/// From the stretch of normalized diffusion, without a dimple.
fn fit_refined(data: &[Datum], configuration: Configuration, stretch: &[f64]) -> (Vec<f64>, [Vec<f64>; 2]) {
    let profile = |datum: &Datum| {
        let a = datum.point.surface_albedo;
        RefinedDiffusion::new(a, 1.0, Parameterization::Mfp, configuration).expect("an albedo in (0, 1)")
    };
    let profiles: Vec<RefinedDiffusion> = data.iter().map(profile).collect();
    let bases = |datum: &Datum| {
        let of_function = basis(&datum.monomials, datum.point.surface_albedo, OF_POLYNOMIAL);
        let with_one: Vec<f64> = std::iter::once(1.0).chain(datum.monomials).collect();
        let of_rate = basis(&with_one, datum.point.surface_albedo, OF_RATE);
        [of_function.clone(), of_function, of_rate]
    };
    let fit = JointFit {
        shares: data.iter().map(|datum| &datum.point.shares[..]).collect(),
        bases: data.iter().map(bases).collect(),
        model: |i: usize, [ln_stretch, dimple, ln_rate]: [f64; 3]| {
            let within = |r: &f64| {
                let x = r * ln_stretch.exp();
                (1.0 + dimple) * profiles[i].cdf(x) + dimple * (-ln_rate.exp() * x).exp_m1()
            };
            differences(data[i].radii.iter().map(within))
        },
    };
    let mut start = stretch.to_vec();
    start.extend([0.0; MONOMIALS * OF_POLYNOMIAL]);
    start.push(LN_RATE);
    start.extend([0.0; (MONOMIALS + 1) * OF_RATE - 1]);
    let after = rounded(&fit.minimize_l1(start));
    let errors = [fit.l1_errors(&vec![0.0; after.len()]), fit.l1_errors(&after)];
    (after, errors)
}

fn print_header(fits: &[Coefficients; 2]) {
    println!(
        "//! Coefficients by which phase function and boundary change the profiles of normalized diffusion."
    );
    println!("//!");
    println!("//! Generated by");
    println!(
        "//! `cargo run --release -p translucid-fit -F generators --example fit_similarity > target/similarity_coefficients.rs`."
    );
    println!("//!");
    println!("//! Domain: g ∈ [{}, {}], η ∈ [{}, {}],", G[0], G[G.len() - 1], ETA[0], ETA[ETA.len() - 1]);
    let [first, .., last] = SURFACE_ALBEDOS;
    println!("//! A ∈ [{first}, {last}], outside of which the values at the end stand in.");
    println!("//! Fitted at g = {G:?}, η = {ETA:?}.");
    println!(
        "//! Errors at all points of the grid, mean / worst in percent: the L1 distance by similarity alone and with these"
    );
    println!("//! coefficients, ℓ* being known, and the relative error of 1 − α':");
    println!("//!");
    println!("//! | | normalized diffusion with the best s(A) | repaired | refined | repaired | 1 − α' |");
    println!("//! |---|---|---|---|---|---|");
    for (words, fit) in ["searchlight", "diffuse transmission"].iter().zip(fits) {
        let Errors { normalized_diffusion, refined, absorbed } = &fit.errors;
        let all = normalized_diffusion.iter().chain(refined).chain([absorbed]);
        let columns: Vec<String> = all
            .map(|errors| {
                let mean = errors.iter().sum::<f64>() / errors.len() as f64;
                let worst = errors.iter().fold(0.0, |a: f64, b| a.max(*b));
                format!("{:.1} / {:.1}", 100.0 * mean, 100.0 * worst)
            })
            .collect();
        println!("//! | {words} | {} |", columns.join(" | "));
    }
    println!("//!");
    println!("//! `--example similarity` of the same crate prints more errors.");
    println!("//!");
    println!(
        "//! Rows are the factors of g, g², g³, L, L², gL, g²L, where 1 − e^(−L) is the boundary's reflectance for"
    );
    println!("//! diffuse light from inside; columns are those of 1, √A, A, …");
    println!();
    println!("/// Least and greatest surface albedo that was fitted.");
    println!("pub(crate) const SURFACE_ALBEDOS: [f64; 2] = [{first:?}, {last:?}];");
    println!();
    println!("/// Coefficients of one configuration.");
    println!("pub(crate) struct Coefficients {{");
    println!("    /// logit A' − logit A.");
    println!("    pub(crate) similar_albedo: [[f64; {OF_POLYNOMIAL}]; {MONOMIALS}],");
    println!("    /// ln c of normalized diffusion.");
    println!("    pub(crate) stretch_of_normalized_diffusion: [[f64; {OF_POLYNOMIAL}]; {MONOMIALS}],");
    println!("    /// ln c of the refined profile.");
    println!("    pub(crate) stretch: [[f64; {OF_POLYNOMIAL}]; {MONOMIALS}],");
    println!("    /// Depth b of its dimple.");
    println!("    pub(crate) dimple: [[f64; {OF_POLYNOMIAL}]; {MONOMIALS}],");
    println!("    /// ln κ of the dimple's rate; the first row stands alone.");
    println!("    pub(crate) dimple_rate: [[f64; {OF_RATE}]; {}],", MONOMIALS + 1);
    println!("}}");
}

fn print_coefficients(name: &str, words: &str, coefficients: &Coefficients) {
    println!();
    println!("/// Coefficients of the {words} configuration.");
    println!("pub(crate) const {name}: Coefficients = Coefficients {{");
    let print = |field: &str, numbers: &[f64], columns: usize| {
        println!("    {field}: [");
        for row in numbers.chunks(columns) {
            let row: Vec<String> = row.iter().map(|c| format!("{:.4}", c + 0.0)).collect();
            println!("        [{}],", row.join(", "));
        }
        println!("    ],");
    };
    print("similar_albedo", &coefficients.similar_albedo, OF_POLYNOMIAL);
    let stretch = &coefficients.stretch_of_normalized_diffusion;
    print("stretch_of_normalized_diffusion", stretch, OF_POLYNOMIAL);
    print("stretch", &coefficients.stretch, OF_POLYNOMIAL);
    print("dimple", &coefficients.dimple, OF_POLYNOMIAL);
    print("dimple_rate", &coefficients.dimple_rate, OF_RATE);
    println!("}};");
}
