//! Generates the coefficients of `translucid_profile::RefinedDiffusion`.
//!
//! ```text
//! cargo run --release -p translucid-fit -F generators --example fit_refined > target/refined_coefficients.rs
//! mv target/refined_coefficients.rs crates/translucid-profile/src/model/refined/coefficients.rs
//! cargo run --release -p translucid-fit -F generators --example fit_refined -- length > target/length_coefficients.rs
//! mv target/length_coefficients.rs crates/translucid-profile/src/medium/length_coefficients.rs
//! ```
//!
//! Not straight to its place: the shell would empty the file before the crate is compiled, which needs it.
//!
//! Weights and rates of four exponentials are polynomials of the surface albedo A.
//! Their coefficients minimize the L1 distance from the exact half space, ∫|R_fit − R| 2πr dr / A, summed over all A:
//! 1. Fit four exponentials at each A by least squares, each from its neighbor, so that no term changes its part.
//! 2. Draw polynomials through those weights and rates.
//! 3. Move all coefficients together: the sum of √(x² + ε²) over the differences x, by least squares whose weights
//!    1/√(x² + ε²) are made anew as ε falls, is the sum of |x| in the end.
//! 4. Round, and judge what has been rounded.
//!
//! The second file has the polynomials for ℓ/ℓ_d, least squares of their relative error.

#![allow(clippy::print_stdout, reason = "the generated file goes to standard output")]

#[path = "fit_refined/joint_fit.rs"]
mod joint_fit;

use joint_fit::{Grid, Shape, TERMS, polynomial, polynomial_through};
use translucid_fit::{Exponential, Judge, Mixture, Target};
use translucid_profile::{
    Configuration, ExactProfile, Parameterization, half_space_single_scattering_albedo,
};

/// Surface albedos are these numbers of percent, 0 standing for the limit.
const PERCENTS: std::ops::RangeInclusive<usize> = 0..=100;
/// The surface albedo that stands for the limit 0.
const FAINT: f64 = 1e-9;
/// The greatest surface albedo at which ℓ/ℓ_d is taken.
const NEXT_TO_WHITE: f64 = 1.0 - 1e-4;
/// Start of the chain of neighbors.
const FIRST: usize = 50;
/// Degree of the polynomial for ℓ/ℓ_d.
const DEGREE_OF_LENGTH: usize = 5;
/// Decimals that are kept.
const UNIT: f64 = 1e-4;
/// Greatest radii in mean free paths.
const R_MAX: [f64; 3] = [8.0, 16.0, f64::INFINITY];

fn main() {
    if std::env::args().nth(1).as_deref() == Some("length") {
        print_lengths();
        return;
    }
    let fits = [Configuration::Searchlight, Configuration::Diffuse].map(Coefficients::fit);
    print_header(&fits);
    print_tables("SEARCHLIGHT", &fits[0]);
    print_tables("DIFFUSE", &fits[1]);
}

fn exact(surface_albedo: f64, configuration: Configuration) -> ExactProfile {
    ExactProfile::new(surface_albedo, 1.0, Parameterization::Mfp, configuration).expect("an albedo in [0, 1]")
}

fn surface_albedo(percent: usize) -> f64 {
    (percent as f64 / 100.0).max(FAINT)
}

/// ℓ/ℓ_d of the half space with a surface albedo, with D after Grosjean.
fn mfp_per_dmfp(surface_albedo: f64, configuration: Configuration) -> f64 {
    let alpha = half_space_single_scattering_albedo(surface_albedo, configuration);
    (3.0 * (1.0 - alpha) / (2.0 - alpha)).sqrt()
}

/// The rounded coefficients of one configuration.
struct Coefficients {
    configuration: Configuration,
    shape: Shape,
    /// Coefficients of the polynomial (ℓ/ℓ_d) / (1 − A).
    length: Vec<f64>,
}

impl Coefficients {
    fn fit(configuration: Configuration) -> Self {
        let albedos: Vec<f64> = PERCENTS.map(surface_albedo).collect();
        let start = Shape::through(&albedos, &free_fits(configuration));
        let grid = Grid::new(&albedos, |a| exact(a, configuration));
        let shape = grid.minimize_l1(start).rounded(UNIT);
        shape.assert_valid();
        Self { configuration, shape, length: fit_length(configuration) }
    }

    /// The mixture for a mean free path.
    fn mixture(&self, surface_albedo: f64, mfp: f64) -> Mixture<Exponential> {
        let [weights, rates] = self.shape.terms(surface_albedo);
        let terms: Vec<(f64, f64)> = weights.into_iter().zip(rates.map(|rate| mfp / rate)).collect();
        Mixture::new(surface_albedo, &terms).expect("weights and rates are positive")
    }

    /// L1 errors of the profile that is made from one of the lengths, at some numbers of percent.
    fn errors(&self, from: Parameterization, percents: impl IntoIterator<Item = usize>) -> Errors {
        let error = |percent: usize| {
            let a = surface_albedo(percent);
            let mfp = match from {
                Parameterization::Mfp => 1.0,
                Parameterization::Dmfp => {
                    (1.0 - a) * polynomial(&self.length, a) / mfp_per_dmfp(a, self.configuration)
                }
            };
            let judge = Judge::new(&exact(a, self.configuration));
            (percent, judge.l1_errors(&self.mixture(a, mfp), R_MAX))
        };
        Errors(percents.into_iter().map(error).collect())
    }
}

fn in_words(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::Searchlight => "searchlight",
        Configuration::Diffuse => "diffuse transmission",
    }
}

/// Weights and rates of the least-squares fit of four exponentials at each surface albedo, rates rising.
fn free_fits(configuration: Configuration) -> Vec<[[f64; TERMS]; 2]> {
    let target = |percent: usize| {
        Target::new(&exact(surface_albedo(percent), configuration)).expect("an exact profile has energy")
    };
    let first = target(FIRST).fit::<Exponential>(TERMS).expect("few terms")[TERMS - 1].mixture.clone();
    let follow = |percents: Vec<usize>| {
        let mut last = first.clone();
        let next = |percent: usize| {
            last = target(percent).refine(&last).mixture;
            last.clone()
        };
        percents.into_iter().map(next).collect::<Vec<_>>()
    };
    let mut fits = follow((0..FIRST).rev().collect());
    fits.reverse();
    fits.push(first.clone());
    fits.extend(follow((FIRST + 1..=100).collect()));
    let terms = |mixture: Mixture<Exponential>| {
        // Scales rise, so rates do in reverse
        let weight = |k: usize| mixture.weights()[TERMS - 1 - k];
        let rate = |k: usize| 1.0 / mixture.scales()[TERMS - 1 - k];
        [std::array::from_fn(weight), std::array::from_fn(rate)]
    };
    fits.into_iter().map(terms).collect()
}

/// Least squares of the relative error of (ℓ/ℓ_d) / (1 − A).
fn fit_length(configuration: Configuration) -> Vec<f64> {
    let (albedos, ratios) = ratios_of_lengths(configuration);
    let weights: Vec<f64> = ratios.iter().map(|ratio| 1.0 / ratio).collect();
    let coefficients = polynomial_through(&albedos, &ratios, &weights, DEGREE_OF_LENGTH);
    coefficients.into_iter().map(|c| (c / UNIT).round() * UNIT).collect()
}

/// Greatest relative error of the polynomial for (ℓ/ℓ_d) / (1 − A).
fn worst_of_length(length: &[f64], configuration: Configuration) -> f64 {
    let (albedos, ratios) = ratios_of_lengths(configuration);
    let error = |(a, ratio): (&f64, &f64)| (polynomial(length, *a) / ratio - 1.0).abs();
    albedos.iter().zip(&ratios).map(error).fold(0.0, f64::max)
}

/// Surface albedos, and (ℓ/ℓ_d) / (1 − A) of them. At 1 both are 0; just below, the ratio has its limit.
fn ratios_of_lengths(configuration: Configuration) -> (Vec<f64>, Vec<f64>) {
    let albedos: Vec<f64> = (0..=200).map(|i| (f64::from(i) / 200.0).min(NEXT_TO_WHITE)).collect();
    let ratios = albedos.iter().map(|a| mfp_per_dmfp(*a, configuration) / (1.0 - a)).collect();
    (albedos, ratios)
}

/// L1 errors at some surface albedos for each greatest radius.
struct Errors(Vec<(usize, [f64; 3])>);

impl Errors {
    fn mean(&self, r_max: usize) -> f64 {
        self.0.iter().map(|(_, errors)| errors[r_max]).sum::<f64>() / self.0.len() as f64
    }

    fn at(&self, percent: usize) -> f64 {
        self.0.iter().find(|(found, _)| *found == percent).map_or(f64::NAN, |(_, errors)| errors[2])
    }

    /// Greatest error over all r up to a surface albedo.
    fn worst_to(&self, percent: usize) -> f64 {
        let errors = self.0.iter().filter(|(found, _)| *found <= percent).map(|(_, errors)| errors[2]);
        errors.fold(0.0, f64::max)
    }
}

fn print_header(fits: &[Coefficients; 2]) {
    println!(
        "//! Polynomials of the surface albedo A for four exponentials, fitted to the exact half space (g = 0, η = 1)."
    );
    println!("//!");
    println!("//! Generated by");
    println!(
        "//! `cargo run --release -p translucid-fit -F generators --example fit_refined > target/refined_coefficients.rs`."
    );
    println!("//!");
    println!("//! Domain: A ∈ [0, 1]. Lengths are in mean free paths.");
    println!(
        "//! Fitted for the least sum of L1 errors ∫|R_fit − R| 2πr dr / ∫ R 2πr dr over A = 0, 0.01, … 1."
    );
    println!(
        "//! These errors, of the rounded coefficients against the exact solution, in percent; means are over"
    );
    println!("//! A = 0.01, 0.02, … 0.99, and all but the first two columns are for all r:");
    println!("//!");
    println!(
        "//! | | r ≤ 8, mean | r ≤ 16, mean | mean | worst, A ≤ 0.98 | worst, A ≤ 0.99 | A = 0.2 | 0.5 | 0.8 |"
    );
    println!("//! |---|---|---|---|---|---|---|---|---|");
    for fit in fits {
        for (length, parameterization) in [("ℓ", Parameterization::Mfp), ("ℓ_d", Parameterization::Dmfp)]
        {
            let errors = fit.errors(parameterization, 1..=99);
            let [near, middle, all] = [0, 1, 2].map(|r_max| errors.mean(r_max));
            let columns = [near, middle, all, errors.worst_to(98), errors.worst_to(99)].into_iter();
            let columns = columns.chain([20, 50, 80].map(|percent| errors.at(percent)));
            let columns: Vec<String> = columns.map(|error| format!("{:.2}", 100.0 * error)).collect();
            println!("//! | {}, {length} | {} |", in_words(fit.configuration), columns.join(" | "));
        }
    }
    println!("//!");
    for fit in fits {
        let ends = fit.errors(Parameterization::Mfp, [0, 100]);
        println!(
            "//! {}: {:.2} in the limit A = 0, {:.2} at A = 1.",
            in_words(fit.configuration),
            100.0 * ends.at(0),
            100.0 * ends.at(100),
        );
    }
    println!("//!");
    println!("//! Coefficients are those of 1, A, A², …");
}

fn print_tables(name: &str, fit: &Coefficients) {
    let words = in_words(fit.configuration);
    println!();
    println!("/// Weights of all terms but the last, which takes what is left of 1: {words}.");
    let columns = fit.shape.weights[0].len();
    println!("pub(crate) const {name}_WEIGHTS: [[f64; {columns}]; {}] = [", fit.shape.weights.len());
    fit.shape.weights.iter().for_each(|row| println!("    {},", array(row)));
    println!("];");
    println!();
    println!("/// Rates in 1/ℓ, which rise from term to term: {words}.");
    let columns = fit.shape.rates[0].len();
    println!("pub(crate) const {name}_RATES: [[f64; {columns}]; {}] = [", fit.shape.rates.len());
    fit.shape.rates.iter().for_each(|row| println!("    {},", array(row)));
    println!("];");
}

/// Prints the file of the polynomials for ℓ/ℓ_d.
fn print_lengths() {
    let fits = [("SEARCHLIGHT", Configuration::Searchlight), ("DIFFUSE", Configuration::Diffuse)]
        .map(|(name, configuration)| (name, configuration, fit_length(configuration)));
    println!(
        "//! Polynomials of the surface albedo A for ℓ/ℓ_d, the mean free path over the diffuse one, of the half space (g = 0,"
    );
    println!("//! η = 1).");
    println!("//!");
    println!("//! Generated by");
    println!(
        "//! `cargo run --release -p translucid-fit -F generators --example fit_refined -- length > target/length_coefficients.rs`."
    );
    println!("//!");
    println!("//! Domain: A ∈ [0, 1). Least squares of the relative error against the exact half space.");
    for (_, configuration, length) in &fits {
        let worst = worst_of_length(length, *configuration);
        println!("//! {}: off by a share of {worst:.0e} at most.", in_words(*configuration));
    }
    println!("//!");
    println!("//! Coefficients are those of 1, A, A², …");
    for (name, configuration, length) in &fits {
        println!();
        println!("/// (ℓ/ℓ_d) / (1 − A), with D after Grosjean: {}.", in_words(*configuration));
        println!("pub(crate) const {name}: [f64; {}] = {};", length.len(), array(length));
    }
}

fn array(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:.4}")).collect();
    format!("[{}]", numbers.join(", "))
}
