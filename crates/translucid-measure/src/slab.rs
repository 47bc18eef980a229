//! Responses of slabs lit from behind to stripes of light.
//!
//! Light that varies as e^{ikx} along a slab sees a one-dimensional slab of its own (G. B. Rybicki 1971, as the half space
//! does), whose collisions are
//!
//! ```text
//! S(τ) = S₀(τ) + α ∫₀ᵇ K(|τ − τ'|) S(τ') dτ',     K(τ) = ½ ∫₀¹ ν/u² e^{−τ/ν} du,     ν = u/√(1 + k²u²)
//! ```
//!
//! By quadrature over u these are rays of the cosines ν with the weights w ν²/u², whose reflection and transmission double
//! with the slab's thickness (H. C. van de Hulst 1963).
//! A Lambertian panel behind the slab sends in the rays u²/(πν²), and straight up there is one more ray, of the weight 0.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::DMatrix;
use translucid_profile::ParameterError;
use translucid_profile::quadrature::gauss_legendre;
use translucid_reference::Incidence;
use translucid_reference::exact::single_scattering_albedo;

use crate::cubic_lagrange::lagrange_weights;

/// Rays into a hemisphere.
const RAYS: usize = 12;
/// Halvings of a slab until single scattering is all there is.
const DOUBLINGS: u32 = 22;
/// Rows by √(1 − A), from the greatest surface albedo on.
const ALBEDO_STEP: f64 = 0.025;
const ALBEDO_ROWS: usize = 40;
const GREATEST: f64 = 0.9999;
/// Rows by the logarithm of the thickness in mean free paths.
const THICKNESS_STEP: f64 = 0.1;
const THINNEST: f64 = 0.3;
const THICKNESS_ROWS: usize = 64;
/// Wave numbers by ln(kt): from e⁻⁴ on.
const WAVE_STEP: f64 = 0.25;
const WAVES: usize = 34;
const LEAST_WAVE: f64 = -4.0;
/// Logarithm of what is below rounding.
const NOTHING: f64 = -40.0;

/// Slabs of isotropic scatterers without a boundary on a Lambertian panel.
#[derive(Debug)]
pub(crate) struct Slab {
    /// \[L\].
    thickness: f64,
    /// Whether all light that leaves counts, or that which leaves straight up.
    incidence: Incidence,
    rows: Mutex<Rows>,
}

/// Solved slabs by row of the surface albedo and of the thickness.
type Rows = HashMap<(usize, usize), Arc<Vec<f64>>>;

/// One slab's logarithm of transmittance by wave number.
#[derive(Clone, Debug)]
pub(crate) struct SlabTransfer {
    thickness: f64,
    /// At k = 0, and at each wave number.
    logarithms: Vec<f64>,
}

impl Slab {
    pub(crate) fn new(thickness: f64, incidence: Incidence) -> Self {
        Self { thickness, incidence, rows: Mutex::default() }
    }

    pub(crate) fn transfer(&self, surface_albedo: f64, mfp: f64) -> SlabTransfer {
        let albedo = surface_albedo.max(0.005).min(GREATEST);
        let root = (1.0 - albedo).sqrt() - (1.0 - GREATEST).sqrt();
        let (first, of_albedo) = lagrange_weights(ALBEDO_ROWS, root / ALBEDO_STEP);
        let depth = libm::log((self.thickness / mfp).max(THINNEST).min(150.0) / THINNEST);
        let (thinnest, of_depth) = lagrange_weights(THICKNESS_ROWS, depth / THICKNESS_STEP);
        let mut logarithms = vec![0.0; WAVES + 1];
        for (i, a) in of_albedo.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            for (j, b) in of_depth.iter().enumerate().filter(|(_, b)| **b != 0.0) {
                let row = self.row(first + i, thinnest + j);
                logarithms.iter_mut().zip(row.iter()).for_each(|(sum, value)| *sum += a * b * value);
            }
        }
        SlabTransfer { thickness: self.thickness, logarithms }
    }

    fn row(&self, albedo: usize, depth: usize) -> Arc<Vec<f64>> {
        let mut rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        let row = rows.entry((albedo, depth)).or_insert_with(|| {
            let root = (1.0 - GREATEST).sqrt() + ALBEDO_STEP * albedo as f64;
            let depth = THINNEST * libm::exp(THICKNESS_STEP * depth as f64);
            let alpha = alpha_of((1.0 - root * root).max(0.004), self.incidence).unwrap_or(0.5);
            let k = |i: usize| libm::exp(LEAST_WAVE + WAVE_STEP * i as f64) / depth;
            let all = std::iter::once(0.0).chain((0..WAVES).map(k));
            let logarithm = |k: f64| libm::log(transmittance(alpha, depth, k, self.incidence)).max(NOTHING);
            Arc::new(all.map(logarithm).collect())
        });
        Arc::clone(row)
    }
}

impl SlabTransfer {
    /// Light that is seen over that of the panel.
    pub(crate) fn level(&self) -> f64 {
        libm::exp(self.logarithms[0])
    }

    /// Part of the contrast that stripes of a wave number keep.
    pub(crate) fn at(&self, k: f64) -> f64 {
        let x = libm::log(k * self.thickness);
        let place = (x - LEAST_WAVE) / WAVE_STEP;
        let zero = self.logarithms[0];
        if place < 0.0 {
            // ln T ~ −k² there
            let first = self.logarithms[1] - zero;
            return libm::exp(first * libm::exp(2.0 * (x - LEAST_WAVE)));
        }
        let (first, weights) = lagrange_weights(WAVES, place.min((WAVES - 1) as f64));
        let logarithm: f64 = (0..4).map(|i| weights[i] * self.logarithms[1 + first + i]).sum();
        libm::exp(logarithm - zero).min(1.0)
    }
}

fn alpha_of(surface_albedo: f64, incidence: Incidence) -> Result<f64, ParameterError> {
    single_scattering_albedo(surface_albedo, 1.0, incidence)
}

/// Light that leaves a slab of so many mean free paths on a Lambertian panel at the wave number k \[ℓ⁻¹\], over that of the
/// panel: its exitance for [`Incidence::Cosine`], else its radiance straight up.
fn transmittance(alpha: f64, depth: f64, k: f64, incidence: Incidence) -> f64 {
    let rule = gauss_legendre(RAYS);
    let rays: Vec<[f64; 3]> = rule
        .iter()
        .map(|(x, w)| {
            let (u, w) = (0.5 * (x + 1.0), 0.5 * w);
            [u, u / (1.0 + (k * u).powi(2)).sqrt(), w]
        })
        .chain([[1.0, 1.0, 0.0]])
        .collect();
    let n = rays.len();
    let mut step = depth / f64::from(1 << DOUBLINGS);
    let once = |i: usize, j: usize| {
        let [u, nu, w] = rays[j];
        0.5 * alpha * w * (nu / u).powi(2) * step / rays[i][1]
    };
    let mut reflected = DMatrix::from_fn(n, n, once);
    // Scattered light alone: what passes straight is known
    let mut scattered = reflected.clone();
    for _ in 0..DOUBLINGS {
        let straight = DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(
            n,
            rays.iter().map(|[_, nu, _]| libm::exp(-step / nu)),
        ));
        let through = &scattered + &straight;
        let between = DMatrix::identity(n, n) - &reflected * &reflected;
        let Some(between) = between.try_inverse() else { return f64::NAN };
        let back = &through * &reflected * &between * &through;
        // T (1 − R²)⁻¹ T less what passes straight: (1 − R²)⁻¹ = 1 + (1 − R²)⁻¹ R²
        let again = &between * &reflected * &reflected;
        scattered = &through * again * &through + &through * &scattered + &scattered * &straight;
        reflected += back;
        step *= 2.0;
    }
    let sent: Vec<f64> = rays.iter().map(|[u, nu, _]| (u / nu).powi(2) / PI).collect();
    let seen = |i: usize| (0..n - 1).map(|j| scattered[(i, j)] * sent[j]).sum::<f64>();
    match incidence {
        Incidence::Cosine => {
            let scattered = (0..n - 1).map(|i| TAU * rays[i][2] * rays[i][1] * seen(i)).sum::<f64>();
            scattered + straight_through(depth, k)
        }
        _ => PI * seen(n - 1) + libm::exp(-depth),
    }
}

/// 2 ∫₀¹ μ e^{−b/μ} J₀(kb tan θ) dμ: light of a Lambertian panel that is not scattered.
fn straight_through(depth: f64, k: f64) -> f64 {
    let part = |(x, w): &(f64, f64)| {
        let mu = 0.5 * (x + 1.0);
        w * mu * libm::exp(-depth / mu) * libm::j0(k * depth * (1.0 - mu * mu).sqrt() / mu)
    };
    gauss_legendre(64).iter().map(part).sum()
}

#[cfg(test)]
mod tests {
    use translucid_reference::walk::{Control, Layout, Parameters, Problem, Side, WhiteTable};

    use super::*;

    /// Photons through a slab, ring by ring: light that enters along the normal leaves as light of a panel does that is seen
    /// from straight above. One comparison in 30 000 is as far off as 4 standard errors by chance; there are 24 of them.
    #[test]
    fn transmittance_is_that_of_the_walk() {
        for incidence in [Incidence::Cosine, Incidence::NORMAL] {
            for (thickness, alpha) in [(1.5, 0.8), (4.0, 0.95)] {
                let problem =
                    Problem::new(Parameters { thickness, incidence, ..Parameters::default() }).unwrap();
                let radii: Vec<f64> = (1..=400).map(|i| 0.05 * f64::from(i)).collect();
                let mut table = WhiteTable::new(problem, Layout::new(&radii, 1).unwrap(), 0.96).unwrap();
                table.run(3, 400_000, &Control::default()).unwrap();
                let walk = table.at_albedo(alpha).unwrap();
                for k in [0.0, 0.1, 0.3, 0.7, 1.5, 2.5] {
                    let ring = |i: usize| {
                        let energy = walk.ring(Side::Transmitted, i);
                        let weight = libm::j0(k * (radii[i] - 0.025));
                        (weight * energy.value, (weight * energy.error).powi(2))
                    };
                    let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
                    let (expected, variance) = (0..400).map(ring).fold((0.0, 0.0), add);
                    let found = transmittance(alpha, thickness, k, incidence);
                    // Rings are of some width
                    let most = 4.0 * variance.sqrt() + 1e-4;
                    assert!(
                        (found - expected).abs() < most,
                        "{incidence:?} {thickness} {k}: {found} {expected} ± {most}"
                    );
                }
            }
        }
    }

    #[test]
    fn table_is_what_is_solved() {
        let slab = Slab::new(3.0, Incidence::Cosine);
        for (albedo, mfp) in [(0.3, 1.1), (0.83, 0.4), (0.97, 0.21)] {
            let alpha = alpha_of(albedo, Incidence::Cosine).unwrap();
            let exact = |k: f64| transmittance(alpha, 3.0 / mfp, k * mfp, Incidence::Cosine);
            let transfer = slab.transfer(albedo, mfp);
            assert!((transfer.level() / exact(0.0) - 1.0).abs() < 2e-3, "{albedo}: {}", transfer.level());
            for k in [0.005, 0.1, 0.5, 1.0, 2.0] {
                let expected = exact(k) / exact(0.0);
                assert!(
                    (transfer.at(k) - expected).abs() < 2e-3,
                    "{albedo} {k}: {} {expected}",
                    transfer.at(k)
                );
            }
        }
        let none = slab.transfer(f64::NAN, 1e-300);
        assert!(none.level().is_finite() && none.at(1e300).is_finite() && none.at(0.0).is_finite());
    }
}
