//! Profiles of media by their albedo and second similarity parameter, between those that are solved.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use crate::Estimate;

/// Solved profile R(r) \[ℓ*⁻²\] over r \[ℓ*\], with its error.
type Solved = Box<dyn Fn(f64) -> Estimate>;

/// Profiles by the reduced single-scattering albedo α' = σ'_s/(σ_a + σ'_s) and γ = (1 − χ₂)/(1 − χ₁), in transport mean
/// free paths ℓ* = 1/(σ_a + σ'_s).
///
/// R(r) depends on all Legendre moments χ_n of the phase function; here those above the second follow from γ by
///
/// ```text
/// p = w Henyey–Greenstein(0.85) + (1 − w)/4π,     (1 − χ_n)/(1 − χ₁) = 1 + (γ − 1) (1 − 0.85^(n−1))/0.15
/// ```
///
/// a forward peak on an isotropic ground: isotropic scattering at γ = 1, Henyey and Greenstein's of g = 0.85 at 1.85.
/// Profiles are solved when they are first needed, at 11 albedos and 4 values of γ, and interpolated by cubics in √(1 − α'),
/// γ and ln r, over diffusion's R(r) r ~ α' (1 + κr) e^(−κr), κ = √(3 (1 − α'))/ℓ*, which takes up most of their change.
pub struct MediumGrid<'a> {
    solve: &'a dyn Fn(f64, f64) -> Solved,
    rows: RefCell<HashMap<[usize; 2], Rc<Row>>>,
}

/// Albedos that are solved, even in √(1 − α').
const ALBEDOS: usize = 11;
const ALBEDO_STEP: f64 = 0.099;
/// Values of γ that are solved.
const GAMMAS: usize = 4;
/// Radii, even in ln r, and the ends of their range.
const RADII: usize = 61;
const ENDS: [f64; 2] = [0.05, 20.0];

impl<'a> MediumGrid<'a> {
    /// Range of γ.
    pub const GAMMA: [f64; 2] = [1.0, 1.85];
    /// Least reduced single-scattering albedo.
    pub const LEAST_ALBEDO: f64 = 0.02;
    /// Mean cosine of the forward peak.
    pub const PEAK: f64 = 0.85;

    /// Grid of the profiles that `solve` finds by α' and γ.
    pub fn new(solve: &'a dyn Fn(f64, f64) -> Solved) -> Self {
        Self { solve, rows: RefCell::default() }
    }

    /// Weight w of the forward peak in the phase function of γ, which counts as the nearest of its range.
    pub fn weight(gamma: f64) -> f64 {
        let [low, high] = Self::GAMMA;
        let (gamma, g) = (gamma.clamp(low, high), Self::PEAK);
        ((gamma - 1.0) / (g * (gamma - g))).clamp(0.0, 1.0)
    }

    /// Whether profiles are solved at a radius \[ℓ*\].
    pub fn has_radius(r: f64) -> bool {
        (ENDS[0]..=ENDS[1]).contains(&r)
    }

    /// Error of profiles as a part of them, as tests find it where light has not decayed to a millionth.
    pub fn error(r: f64) -> f64 {
        1e-3 + 1.5e-4 * r * r
    }

    /// Profile of α' and γ. Beyond the grid α' counts as the nearest of it, and γ continues the cubic.
    pub fn row(&self, alpha: f64, gamma: f64) -> Row {
        let [low, high] = Self::GAMMA;
        let root = (1.0 - alpha).max(0.0).sqrt() / ALBEDO_STEP;
        let albedos = cubic(root.min((ALBEDOS - 1) as f64), ALBEDOS);
        let gammas = cubic((gamma - low) / (high - low) * (GAMMAS - 1) as f64, GAMMAS);
        let mut sum = Row { ln_values: (0..RADII).map(|k| ln_diffusion(alpha, radius(k))).collect() };
        for (i, of_albedo) in albedos {
            for (j, of_gamma) in gammas {
                let weight = of_albedo * of_gamma;
                if weight == 0.0 {
                    continue;
                }
                let row = self.solved(i, j);
                sum.ln_values.iter_mut().zip(&row.ln_values).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        sum
    }

    /// The row of a node.
    fn solved(&self, i: usize, j: usize) -> Rc<Row> {
        let known = self.rows.borrow().get(&[i, j]).cloned();
        known.unwrap_or_else(|| {
            let [low, high] = Self::GAMMA;
            let root = ALBEDO_STEP * i as f64;
            let alpha = 1.0 - root * root;
            let gamma = low + (high - low) * j as f64 / (GAMMAS - 1) as f64;
            let row = Rc::new(Row::new(&(self.solve)(alpha, gamma), alpha));
            self.rows.borrow_mut().insert([i, j], Rc::clone(&row));
            row
        })
    }
}

/// One profile at the radii of the grid.
#[derive(Clone, Debug)]
pub struct Row {
    /// ln R r; in the grid over that of diffusion.
    ln_values: Vec<f64>,
}

impl Row {
    /// A solved profile. Where its error is as large as a third of it, its decay goes on as before.
    fn new(profile: &Solved, alpha: f64) -> Self {
        let mut ln_values: Vec<f64> = Vec::with_capacity(RADII);
        let mut is_known = true;
        for k in 0..RADII {
            let (r, Estimate { value, error }) = (radius(k), profile(radius(k)));
            is_known &= 3.0 * error < value;
            ln_values.push(match ln_values[..] {
                [.., before, last] if !is_known => {
                    last + (last - before).min(0.0) * (r - radius(k - 1)) / (radius(k - 1) - radius(k - 2))
                }
                _ => libm::log((value * r).max(f64::MIN_POSITIVE)),
            });
        }
        ln_values.iter_mut().enumerate().for_each(|(k, value)| *value -= ln_diffusion(alpha, radius(k)));
        Self { ln_values }
    }

    /// R(r) \[ℓ*⁻²\]; beyond the radii of the grid ln R r goes on by ln r.
    pub fn eval(&self, r: f64) -> f64 {
        let place = (libm::log(r) - libm::log(ENDS[0])) / step();
        let last = (RADII - 1) as f64;
        let at = |place: f64| -> f64 {
            cubic(place, RADII).into_iter().map(|(k, weight)| weight * self.ln_values[k]).sum()
        };
        let inside = place.clamp(0.0, last);
        let slope = if place < 0.0 { at(1.0) - at(0.0) } else { (at(last) - at(last - 1.0)).min(0.0) };
        libm::exp(at(inside) + (place - inside) * slope) / r
    }
}

/// Radius of the grid \[ℓ*\].
fn radius(k: usize) -> f64 {
    libm::exp(libm::log(ENDS[0]) + step() * k as f64)
}

/// Logarithm of about what diffusion has for R r.
fn ln_diffusion(alpha: f64, r: f64) -> f64 {
    let x = (3.0 * (1.0 - alpha)).max(0.0).sqrt() * r;
    libm::log(alpha.max(f64::MIN_POSITIVE)) + libm::log1p(x) - x
}

/// Step of ln r.
fn step() -> f64 {
    libm::log(ENDS[1] / ENDS[0]) / (RADII - 1) as f64
}

/// Four numbers of nodes around a place, counted in nodes, with Lagrange's weights of the cubic through them.
fn cubic(place: f64, count: usize) -> [(usize, f64); 4] {
    // At a node, however rounded, the others are not needed
    let place = if (place - place.round()).abs() < 1e-9 { place.round() } else { place };
    let first = (place.floor() - 1.0).clamp(0.0, (count - 4) as f64);
    let x = place - first;
    let weights = [
        -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
        x * (x - 2.0) * (x - 3.0) / 2.0,
        -x * (x - 1.0) * (x - 3.0) / 2.0,
        x * (x - 1.0) * (x - 2.0) / 6.0,
    ];
    [0, 1, 2, 3].map(|i| (first as usize + i, weights[i]))
}
