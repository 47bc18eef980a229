//! Numbers that the closed forms are made of, for those who write these in another language.
//!
//! Polynomials are in the surface albedo A, coefficients those of 1, A, A² …; the [`Configuration`] says how light
//! enters. Domains and errors are those of the profiles that the numbers belong to.

use crate::Configuration;
use crate::medium::length_coefficients;
use crate::model::burley::kernel::{LOWER_START_3, UPPER_START_3};
use crate::model::oblique::{coefficients as oblique, kernel};
use crate::model::refined::coefficients as refined;

/// Weights w_k of the [refined profile](crate::RefinedDiffusion), all but the last, which takes what is left of 1.
pub fn refined_weights(configuration: Configuration) -> [[f64; 5]; 3] {
    match configuration {
        Configuration::Searchlight => refined::SEARCHLIGHT_WEIGHTS,
        Configuration::Diffuse => refined::DIFFUSE_WEIGHTS,
    }
}

/// Rates ℓ λ_k of the [refined profile](crate::RefinedDiffusion).
pub fn refined_rates(configuration: Configuration) -> [[f64; 4]; 4] {
    match configuration {
        Configuration::Searchlight => refined::SEARCHLIGHT_RATES,
        Configuration::Diffuse => refined::DIFFUSE_RATES,
    }
}

/// (ℓ/ℓ_d) / (1 − A), the mean free path over the diffuse one, with Grosjean's diffusion coefficient.
pub fn mfp_per_dmfp(configuration: Configuration) -> [f64; 6] {
    match configuration {
        Configuration::Searchlight => length_coefficients::SEARCHLIGHT,
        Configuration::Diffuse => length_coefficients::DIFFUSE,
    }
}

/// Tilts κ_k of the [oblique profile](crate::ObliqueDiffusion) along the normal, and what grazing incidence adds.
pub const OBLIQUE_TILTS: [[[f64; 3]; 2]; 4] = oblique::TILTS;

/// Weights of the [oblique profile](crate::ObliqueDiffusion) at grazing incidence, all but the last.
pub const OBLIQUE_GRAZING_WEIGHTS: [[f64; 3]; 3] = oblique::GRAZING_WEIGHTS;

/// Relative changes of all rates but the first of the [oblique profile](crate::ObliqueDiffusion) at grazing incidence.
pub const OBLIQUE_RATE_CHANGES: [[f64; 2]; 3] = oblique::RATE_CHANGES;

/// Deviations q_j of the energy of the [oblique profile](crate::ObliqueDiffusion) for μ ln(1 + 1/μ), μ and μ², in the
/// albedo of diffuse light.
pub const OBLIQUE_ENERGY: [[f64; 4]; 3] = oblique::ENERGY;

/// (A_diffuse/A − 1) / (1 − A) of the [oblique profile](crate::ObliqueDiffusion), A that of light along the normal.
pub const OBLIQUE_DIFFUSE_ALBEDO: [f64; 4] = oblique::DIFFUSE_ALBEDO;

/// Least cosine whose shape the [oblique profile](crate::ObliqueDiffusion) knows.
pub const OBLIQUE_LEAST_COS_THETA: f64 = kernel::LEAST_COS_THETA;

/// Start of [`NormalizedDiffusion::quantile`](crate::NormalizedDiffusion::quantile) below the median: the root
/// y = 1 − e^{−r/3d} over the share u, a polynomial in u ∈ [0, ½] with a relative error of 2.6e-4.
pub const QUANTILE_START_BELOW: [f64; 3] = LOWER_START_3;

/// Start of [`NormalizedDiffusion::quantile`](crate::NormalizedDiffusion::quantile) above the median: the root
/// x = e^{−r/3d} over the complement v = 1 − u, a polynomial in v ∈ [0, ½] with a relative error of 2.1e-3.
pub const QUANTILE_START_ABOVE: [f64; 3] = UPPER_START_3;
