//! From wave vectors back to points of the surface, harmonic by harmonic of the azimuth.
//!
//! ```text
//! R(r, φ) = Σ_m f_m(r) cos mφ,    f_m(r) = (1/2π) ∫₀^∞ c_m(k) J_m(kr) k dk
//! ```
//!
//! Along a ray from i k₀, as [`Inversion`](super::hankel_inversion::Inversion) has it, H_m⁽¹⁾ is huge for |kr| < m, and
//! digits cancel. Here the way goes along the real axis with J_m up to k_j, where k_j r ≥ z₀ is large enough for the
//! highest harmonic, and from there on the ray k_j + x e^{iπ/4} with H_m⁽¹⁾, which decays; the real part of the latter
//! is the integral of J_m. What is lost is the *relative* accuracy at large k₀r, where the other way has it.
//!
//! The k_j double from one to the next, so that all radii share the nodes on the real axis. Nodes are computed when a
//! radius first needs them.

use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::sync::OnceLock;

use num_complex::Complex64;
use rayon::prelude::*;
use translucid_profile::quadrature::gauss_legendre;

use super::complex::{exp, from_polar};
use super::macdonald::Macdonald;
use crate::Estimate;

/// k₀, the end of the first panel: radii up to z₀/k₀ come with their full accuracy.
const FIRST_END: f64 = 4e-3;
/// Number of ends k_j; the last serves radii down to z₀ 1e-9.
const ENDS: usize = 40;
/// Ends of the panels of the rays in x r, for the least radius that they serve.
const RAY_PANELS: [f64; 7] = [0.0, 2.0, 5.0, 10.0, 18.0, 30.0, 46.0];
/// Points on each panel of the rays.
const RAY_POINTS: usize = 12;

/// The harmonics of a transform by two rules: the value, and its difference from the coarser one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Harmonics {
    /// c_m(k).
    pub(crate) values: Vec<Complex64>,
    /// Differences between the rules.
    pub(crate) doubts: Vec<Complex64>,
}

/// A node and its harmonics, weighed with k dk/2π.
#[derive(Clone, Debug)]
struct Node {
    k: Complex64,
    weighed: Harmonics,
}

/// Caches the nodes of one transform.
#[derive(Clone, Debug)]
pub(crate) struct AzimuthalInversion {
    /// z₀.
    least_argument: f64,
    /// Number of harmonics, from m = 0.
    count: usize,
    /// Between k_{j−1} and k_j.
    panels: Vec<OnceLock<Vec<Node>>>,
    /// From k_j on.
    rays: Vec<OnceLock<Vec<Node>>>,
}

impl AzimuthalInversion {
    /// For harmonics m < count whose absolute errors may grow by e^growth.
    pub(crate) fn new(count: usize, growth: f64) -> Self {
        Self {
            least_argument: least_argument(count, growth),
            count,
            panels: vec![OnceLock::new(); ENDS],
            rays: vec![OnceLock::new(); ENDS],
        }
    }

    /// f_m(r), and what the two rules make different in it, for the transform given.
    ///
    /// Beyond r = 2z₀/k₀, some 5000, what is left of the harmonics is 0 with an error.
    pub(crate) fn eval(
        &self,
        r: f64,
        transform: &(dyn Fn(Complex64) -> Harmonics + Sync),
    ) -> Vec<[Estimate; 2]> {
        let farthest = 2.0 * self.least_argument / FIRST_END;
        if r <= farthest {
            return self.eval_from(self.end_index(r), r, transform);
        }
        let lost = |part: Estimate| Estimate { value: 0.0, error: part.value.abs() + part.error };
        let last = self.eval_from(0, farthest, transform);
        last.into_iter().map(|pair| pair.map(lost)).collect()
    }

    /// Harmonics as of [`Self::eval`], leaving the real axis twice as far out.
    #[cfg(test)]
    pub(crate) fn eval_past(
        &self,
        r: f64,
        transform: &(dyn Fn(Complex64) -> Harmonics + Sync),
    ) -> Vec<[Estimate; 2]> {
        self.eval_from(self.end_index(r) + 1, r, transform)
    }

    /// The least end that is large enough.
    fn end_index(&self, r: f64) -> usize {
        libm::log2(self.least_argument / (r * FIRST_END)).ceil().max(0.0).min((ENDS - 1) as f64) as usize
    }

    fn eval_from(
        &self,
        index: usize,
        r: f64,
        transform: &(dyn Fn(Complex64) -> Harmonics + Sync),
    ) -> Vec<[Estimate; 2]> {
        // Below the least radius harmonics hardly change with r
        let r = r.max(self.least_argument / end(ENDS - 1));
        let mut sums = vec![[Sum::default(); 2]; self.count];
        let mut bessel = Vec::new();
        for (j, panel) in self.panels[..=index].iter().enumerate() {
            let nodes = panel.get_or_init(|| self.panel(j, transform));
            for node in nodes {
                bessel_j(node.k.re * r, self.count, &mut bessel);
                for (m, sum) in sums.iter_mut().enumerate() {
                    sum[0].add(bessel[m] * node.weighed.values[m].re);
                    sum[1].add(bessel[m] * node.weighed.doubts[m].re);
                }
            }
        }
        let mut hankel = Vec::new();
        for node in self.rays[index].get_or_init(|| self.ray(index, transform)) {
            hankel_1(node.k * r, self.count, &mut hankel);
            for (m, sum) in sums.iter_mut().enumerate() {
                sum[0].add((hankel[m] * node.weighed.values[m]).re);
                sum[1].add((hankel[m] * node.weighed.doubts[m]).re);
            }
        }
        sums.iter().map(|pair| pair.map(Sum::estimate)).collect()
    }

    /// Nodes between k_{j−1} and k_j, enough for the waves of J_m up to kr = 2z₀.
    fn panel(&self, j: usize, transform: &(dyn Fn(Complex64) -> Harmonics + Sync)) -> Vec<Node> {
        let from = if j == 0 { 0.0 } else { end(j - 1) };
        let rule = gauss_legendre((0.5 * self.least_argument) as usize + 12);
        nodes(from.into(), (end(j) - from).into(), &rule, transform)
    }

    /// Nodes from k_j on.
    fn ray(&self, j: usize, transform: &(dyn Fn(Complex64) -> Harmonics + Sync)) -> Vec<Node> {
        let rule = gauss_legendre(RAY_POINTS);
        let unit = from_polar(end(j) / self.least_argument, FRAC_PI_4);
        let panel =
            |ends: &[f64]| nodes(end(j) + unit * ends[0], unit * (ends[1] - ends[0]), &rule, transform);
        RAY_PANELS.windows(2).flat_map(panel).collect()
    }
}

/// k_j.
fn end(j: usize) -> f64 {
    FIRST_END * libm::exp2(j as f64)
}

fn nodes(
    from: Complex64,
    length: Complex64,
    rule: &[(f64, f64)],
    transform: &(dyn Fn(Complex64) -> Harmonics + Sync),
) -> Vec<Node> {
    let node = |&(x, weight): &(f64, f64)| {
        let k = from + length * (0.5 + 0.5 * x);
        let factor = k * length * (0.5 * weight / TAU);
        let mut weighed = transform(k);
        weighed.values.iter_mut().chain(&mut weighed.doubts).for_each(|c| *c *= factor);
        Node { k, weighed }
    };
    rule.par_iter().map(node).collect()
}

/// The least z₀ for which |H_m⁽¹⁾(z₀)| < e^growth for all m < count: by as much errors of c_m grow.
///
/// |H_m⁽¹⁾(z)| ~ exp[m (arcosh y − √(1 − 1/y²))], y = m/z > 1 (P. Debye 1909).
fn least_argument(count: usize, growth: f64) -> f64 {
    let m = count as f64;
    let (mut low, mut high) = (1.0, 50.0);
    for _ in 0..60 {
        let y = 0.5 * (low + high);
        let found = m * (libm::acosh(y) - (1.0f64 - 1.0 / (y * y)).sqrt());
        if found < growth { low = y } else { high = y }
    }
    (m / low).max(10.0)
}

/// A sum and the size of its terms.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    value: f64,
    moduli: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        self.value += term;
        self.moduli += term.abs();
    }

    /// Terms are good to some digits less than numbers have.
    fn estimate(self) -> Estimate {
        Estimate { value: self.value, error: 1e-14 * self.moduli }
    }
}

/// J_m(x) for m < count and x ≥ 0: J. C. P. Miller's backward recursion, normalized by J₀ + 2(J₂ + J₄ + …) = 1.
fn bessel_j(x: f64, count: usize, values: &mut Vec<f64>) {
    values.clear();
    values.resize(count, 0.0);
    if x < 1e-8 {
        // J_m = (x/2)^m/m!, the first two of which count
        values.iter_mut().zip([1.0, 0.5 * x]).for_each(|(value, first)| *value = first);
        return;
    }
    let largest = x.max(count as f64);
    let start = 2 * ((largest + 6.0 * libm::cbrt(largest) + 12.0) as usize).div_ceil(2);
    let (mut above, mut value, mut norm) = (0.0, 1e-290, 0.0);
    for m in (0..=start).rev() {
        if m < count {
            values[m] = value;
        }
        norm += if m == 0 {
            value
        } else if m.is_multiple_of(2) {
            2.0 * value
        } else {
            0.0
        };
        if value.abs() > 1e200 {
            for number in values.iter_mut().chain([&mut above, &mut value, &mut norm]) {
                *number *= 1e-200;
            }
        }
        (above, value) = (value, 2.0 * m as f64 / x * value - above);
    }
    values.iter_mut().for_each(|value| *value /= norm);
}

/// H_m⁽¹⁾(z) for m < count by forward recursion, with z in the upper right quadrant.
fn hankel_1(z: Complex64, count: usize, values: &mut Vec<Complex64>) {
    values.clear();
    // H_m⁽¹⁾(z) = (2/π) i^{−m−1} K_m(−iz)
    let rotated = -Complex64::I * z;
    let (k0, k1) = match Macdonald::new(rotated) {
        Macdonald::Small { k0, k1_minus_pole } => (k0, k1_minus_pole + rotated.inv()),
        Macdonald::Scaled { k0, k1 } => {
            let scale = exp(-rotated);
            (k0 * scale, k1 * scale)
        }
    };
    let (mut value, mut next) = (k0 * (-Complex64::I * (2.0 / PI)), k1 * (-2.0 / PI));
    for m in 0..count {
        values.push(value);
        (value, next) = (next, next * (2.0 * (m + 1) as f64) / z - value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_functions_agree_with_amos() {
        let (mut j, mut h) = (Vec::new(), Vec::new());
        for x in [1e-3, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0] {
            bessel_j(x, 40, &mut j);
            for (m, found) in j.iter().enumerate() {
                let expected = complex_bessel::besselj(m as f64, Complex64::from(x)).expect("in range").re;
                // Amos loses digits for large real arguments
                assert!((found - expected).abs() < 1e-14 * (1.0 + x), "{m} {x}: {found} {expected}");
            }
        }
        for z in [Complex64::new(10.0, 0.0), Complex64::new(12.0, 5.0), Complex64::new(30.0, 10.0)] {
            hankel_1(z, 40, &mut h);
            for (m, found) in h.iter().enumerate() {
                let expected = complex_bessel::hankel1(m as f64, z).expect("in range");
                assert!((found - expected).norm() < 1e-12 * expected.norm(), "{m} {z}: {found} {expected}");
            }
        }
    }

    /// e^{−ak} (kb)^m/m!-like transforms have closed inverses: c_m = k^m e^{−ak} gives
    /// f_m = (1/2π) (2m+1)!/(2^m m!) a r^m/(a² + r²)^{m+3/2}.
    #[test]
    fn harmonics_equal_closed_forms() {
        let (count, a, scale) = (12usize, 1.0f64, 0.4f64);
        let inversion = AzimuthalInversion::new(count, 3.0);
        let transform = |k: Complex64| {
            let values: Vec<Complex64> =
                (0..count as i32).map(|m| (scale * k).powi(m) * (-a * k).exp()).collect();
            Harmonics { doubts: values.iter().map(|c| c * 1e-3).collect(), values }
        };
        for r in [1e-3, 0.03, 0.5, 2.0, 10.0] {
            let found = inversion.eval(r, &transform);
            let mut factor = 1.0; // (2m+1)!/(2^m m!) scale^m
            for (m, [value, doubt]) in found.iter().enumerate() {
                if m > 0 {
                    factor *= (2 * m + 1) as f64 * scale;
                }
                let expected = factor * a * r.powi(m as i32) / (a * a + r * r).powf(m as f64 + 1.5) / TAU;
                let off = (value.value - expected).abs();
                assert!(
                    off < 2e-13 * factor.max(1.0) && off <= value.error + 1e-13,
                    "{m} {r}: {value:?} {expected}"
                );
                assert!((doubt.value - 1e-3 * expected).abs() < 1e-15 * factor.max(1.0));
            }
        }
    }
}
