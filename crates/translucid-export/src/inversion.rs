//! The medium behind a surface albedo, as a polynomial: what a walk through the volume needs.

use std::f64::consts::PI;

use translucid_profile::{AlbedoInversion, Configuration};

use crate::error::ExportError;
use crate::header::light;
use crate::number::{horner, literal};

/// Degrees that are tried, and the error of the surface albedo that is small enough.
const DEGREES: std::ops::RangeInclusive<usize> = 4..=8;
const ENOUGH: f64 = 5e-5;
/// Poles that are tried, 1 over the place beyond A = 0.
const BENDS: [f64; 11] = [0.0, 0.5, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.99];
/// Surface albedos at which the error is measured.
const STEPS: usize = 1000;

/// A polynomial for one phase function and boundary.
#[derive(Clone, Debug)]
pub(crate) struct Inversion {
    g: f64,
    eta: f64,
    configuration: Configuration,
    /// The pole of √(1 − α') beyond A = 0, at 1 − A = 1/bend, which a boundary and forward scattering bring near: a
    /// polynomial alone would take twice the degree.
    bend: f64,
    /// √(1 − α') (1/k − bend) with k = 1 − A, in powers of 1 − 2A.
    coefficients: Vec<f64>,
    /// Largest error of the surface albedo of the medium that is found.
    error: f64,
}

impl Inversion {
    pub(crate) fn new(g: f64, eta: f64, configuration: Configuration) -> Result<Self, ExportError> {
        let exact = AlbedoInversion::new(g, eta, configuration)?;
        let mut best =
            Self { g, eta, configuration, bend: 0.0, coefficients: Vec::new(), error: f64::INFINITY };
        for degree in DEGREES {
            for bend in BENDS {
                let fit = Self { bend, coefficients: interpolate(&exact, bend, degree), ..best.clone() };
                let error = fit.largest_error(&exact);
                if error < best.error {
                    best = Self { error, ..fit };
                }
            }
            if best.error < ENOUGH {
                break;
            }
        }
        Ok(best)
    }

    /// Largest error of A: that of α, over the slope of α(A).
    fn largest_error(&self, exact: &AlbedoInversion) -> f64 {
        let alpha = |a: f64| exact.single_scattering_albedo(a);
        let errors = (0..=STEPS).map(|i| {
            let a = i as f64 / STEPS as f64;
            let (from, to) = ((a - 1e-4).max(0.0), (a + 1e-4).min(1.0));
            // At A = 1 the slope is 0, and both are 1
            let slope = (alpha(to) - alpha(from)) / (to - from);
            (self.single_scattering_albedo(a) - alpha(a)).abs() / slope.max(1e-12)
        });
        errors.fold(0.0, f64::max)
    }

    fn single_scattering_albedo(&self, a: f64) -> f64 {
        let k = 1.0 - a;
        let x = 2.0 * k - 1.0;
        let polynomial = self.coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
        let root = k * polynomial / (1.0 - self.bend * k);
        let absorbed = (root * root).min(1.0);
        (1.0 - absorbed) / (1.0 - self.g * absorbed)
    }

    /// The functions in WGSL.
    pub(crate) fn wgsl(&self) -> String {
        let Self { g, eta, error, .. } = self;
        let light = light(self.configuration);
        let polynomial = horner(&self.coefficients, "x");
        let (g_text, bend) = (literal(*g), literal(self.bend));
        format!(
            "// Reduced absorption 1 - alpha' of the half space with a surface albedo A in [0, 1], with the digits of a small one.
//
// For a phase function of mean cosine g = {g}, a boundary of eta = {eta}, and {light}:
// solved by translucid to 2e-5 of A, fitted by this polynomial to another {error:.1e}.
fn inversion_absorbed(surface_albedo: f32) -> f32 {{
    let k: f32 = 1.0 - min(max(surface_albedo, 0.0), 1.0);
    let x: f32 = 2.0 * k - 1.0;
    let root: f32 = k * ({polynomial}) / (1.0 - {bend} * k);
    return min(root * root, 1.0);
}}

// Single-scattering albedo alpha = sigma_s / sigma_t of that half space.
fn inversion_single_scattering_albedo(surface_albedo: f32) -> f32 {{
    let absorbed: f32 = inversion_absorbed(surface_albedo);
    return (1.0 - absorbed) / (1.0 - {g_text} * absorbed);
}}

// Absorption 1 - alpha = sigma_a / sigma_t of that half space, with the digits of a small one.
fn inversion_absorption(surface_albedo: f32) -> f32 {{
    let absorbed: f32 = inversion_absorbed(surface_albedo);
    return (1.0 - {g_text}) * absorbed / (1.0 - {g_text} * absorbed);
}}
"
        )
    }
}

/// √(1 − α') at A = 1 − k.
fn root(exact: &AlbedoInversion, k: f64) -> f64 {
    let alpha = exact.single_scattering_albedo(1.0 - k);
    ((1.0 - alpha) / (1.0 - exact.g() * alpha)).sqrt()
}

/// Coefficients of the polynomial through the relation at Chebyshev's nodes.
fn interpolate(exact: &AlbedoInversion, bend: f64, degree: usize) -> Vec<f64> {
    let value = |x: f64| {
        let k = 0.5 * (1.0 + x);
        root(exact, k) * (1.0 / k - bend)
    };
    let n = degree + 1;
    let nodes: Vec<f64> = (0..n).map(|i| (PI * (i as f64 + 0.5) / n as f64).cos()).collect();
    // Newton's divided differences, then powers
    let mut differences: Vec<f64> = nodes.iter().map(|x| value(*x)).collect();
    for order in 1..n {
        for i in (order..n).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    let mut powers = vec![0.0; n];
    for i in (0..n).rev() {
        for j in (1..n).rev() {
            powers[j] = powers[j - 1] - nodes[i] * powers[j];
        }
        powers[0] = differences[i] - nodes[i] * powers[0];
    }
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_find_the_medium() {
        for (g, eta, most) in [(0.0, 1.0, 5e-5), (0.8, 1.4, 5e-4), (-0.5, 1.0, 5e-5), (0.9, 1.5, 7e-4)] {
            let inversion = Inversion::new(g, eta, Configuration::Diffuse).unwrap();
            assert!(inversion.error < most, "{g} {eta}: {} {:?}", inversion.error, inversion.coefficients);
            assert!((inversion.single_scattering_albedo(1.0) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let error = Inversion::new(0.99, 1.0, Configuration::Diffuse).unwrap_err();
        assert_eq!(error.to_string(), "g is 0.99, but must be in [-0.95, 0.95]");
    }
}
