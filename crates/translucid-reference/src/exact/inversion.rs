//! From wave numbers back to radii, with full relative accuracy at every radius.
//!
//! ```text
//! R(r) = (1/2π) Re ∫ R̂(k) H₀⁽¹⁾(kr) k dk            beyond(r) = −r Re ∫ R̂(k) H₁⁽¹⁾(kr) dk
//! ```
//!
//! along the ray k = i k₀ + x e^{iψ}, x ∈ (0, ∞), into the right upper quadrant. R̂ is real on the segment from 0 to
//! i k₀, which gives nothing. On the ray the Hankel function decays like e^{−k₀r − x r sin ψ}: the first part, which
//! R itself has, comes out as a factor.
//! With z = −ikr the Hankel functions are H_m⁽¹⁾(kr) = (2/π) i^{−m−1} K_m(z).
//!
//! The trapezoidal rule in ln x, compressed at the lower end where R̂ is smooth in √x, has one set of nodes for every
//! radius.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::dispersion::Dispersion;
use super::h_function::{Nested, WaveNumber};
use super::macdonald::Macdonald;
use crate::Estimate;

/// How finely the exact solution is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Settings {
    /// Angle ψ of the ray of k, between 0 and π/2.
    pub(crate) angle: f64,
    /// Step of the trapezoidal rule along the ray of k.
    pub(crate) k_step: f64,
    /// Step of the trapezoidal rule for H.
    pub(crate) t_step: f64,
    /// Points of the Gauss–Legendre rule over directions; the coarser rule has half as many.
    pub(crate) directions: usize,
    /// Radius up to which all digits are wanted.
    pub(crate) r_max: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { angle: std::f64::consts::FRAC_PI_4, k_step: 0.16, t_step: 0.2, directions: 32, r_max: 1e3 }
    }
}

/// A point of the ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    /// x.
    pub(crate) x: f64,
    /// k = i k₀ + x e^{iψ}.
    pub(crate) wave_number: WaveNumber,
    /// Weight of the rule, dk.
    pub(crate) dk: Complex64,
}

/// The ray of wave numbers and its nodes, those of even index being the rule of twice the step.
#[derive(Clone, Debug)]
pub(crate) struct Contour {
    pub(crate) k0: f64,
    pub(crate) angle: f64,
    pub(crate) nodes: Vec<Node>,
}

impl Contour {
    pub(crate) fn new(dispersion: &Dispersion, settings: &Settings) -> Self {
        let Settings { angle, k_step, r_max, .. } = *settings;
        let direction = Complex64::from_polar(1.0, angle);
        // x = e^{w − e^{w₀ − w}}
        let low = (1e-2 / r_max).ln();
        let high = 1e9f64.ln();
        let first = low - 3.8;
        let count = ((high - first) / k_step).ceil() as usize;
        let node = |j: usize| {
            let w = first + j as f64 * k_step;
            let compression = (low - w).exp();
            let x = (w - compression).exp();
            let dk = direction * (x * (1.0 + compression) * k_step);
            Node { x, wave_number: WaveNumber::on_ray(dispersion, x, angle), dk }
        };
        Self { k0: dispersion.k0, angle, nodes: (0..=count).map(node).collect() }
    }
}

/// A function given by its Hankel transforms of one or several orders on the nodes of a [`Contour`].
///
/// The transforms must be what is left of it without single scattering, decaying like k⁻² or faster. That of
/// order m must be c_m(k) = k^m g(k²), real for real k, where the function is Σ_m f_m(r) cos mφ (up to
/// normalization) and f_m(r) = (1/2π) ∫₀^∞ c_m(k) J_m(kr) k dk.
#[derive(Clone, Debug)]
pub(crate) struct Inversion {
    k0: f64,
    /// −i e^{iψ}, the direction of z − k₀r.
    z_direction: Complex64,
    /// x of the nodes.
    x: Vec<f64>,
    /// c_m(k) dk by order, then node.
    orders: Vec<Vec<Nested>>,
}

/// Sums over nodes: all nodes; every other node; all nodes with the coarser values; moduli of all.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    fine: f64,
    half: f64,
    coarse: f64,
    moduli: f64,
}

impl Inversion {
    /// `orders[m][j]` is c_m at node j.
    pub(crate) fn new(contour: &Contour, orders: Vec<Vec<Nested>>) -> Self {
        let weighted = |values: Vec<Nested>| -> Vec<Nested> {
            (values.iter().zip(&contour.nodes))
                .map(|(v, node)| Nested { fine: v.fine * node.dk, coarse: v.coarse * node.dk })
                .collect()
        };
        Self {
            k0: contour.k0,
            z_direction: Complex64::from_polar(1.0, contour.angle - PI / 2.0),
            x: contour.nodes.iter().map(|node| node.x).collect(),
            orders: orders.into_iter().map(weighted).collect(),
        }
    }

    /// f₀(r) for r > 0.
    pub(crate) fn eval(&self, r: f64) -> Estimate {
        self.eval_orders(r, 0)[0]
    }

    /// f_m(r) for m = 0 up to the highest order wanted (at most those given), for r > 0.
    pub(crate) fn eval_orders(&self, r: f64, highest: usize) -> Vec<Estimate> {
        let orders = &self.orders[..self.orders.len().min(highest + 1)];
        let mut sums = vec![Sums::default(); orders.len()];
        // (1/2π) (2/π) i^{−m−1} K_m k dk, with k = iz/r
        let mut phase = Complex64::ONE / (PI * PI);
        let phases: Vec<Complex64> = orders
            .iter()
            .map(|_| {
                let this = phase;
                phase *= -Complex64::I;
                this
            })
            .collect();
        self.for_each_node(r, |j, z, macdonald, exponential| {
            let (k0, k1) = macdonald_values(z, macdonald, exponential, self.k0 * r);
            let (mut before, mut value) = (k0, k1);
            for (m, values) in orders.iter().enumerate() {
                let kernel = before * z * phases[m] / r;
                sums[m].add(j, kernel, values[j]);
                // K_{m+2} = K_m + 2(m+1)/z K_{m+1}
                (before, value) = (value, before + value * (2.0 * (m + 1) as f64) / z);
            }
        });
        let factor = (-self.k0 * r).exp();
        sums.iter().map(|sum| sum.estimate(factor)).collect()
    }

    /// ∫_r^∞ f₀(r') 2πr' dr' for r > 0.
    pub(crate) fn beyond(&self, r: f64) -> Estimate {
        let mut sums = Sums::default();
        let values = &self.orders[0];
        self.for_each_node(r, |j, z, macdonald, exponential| {
            let (_, k1) = macdonald_values(z, macdonald, exponential, self.k0 * r);
            sums.add(j, k1 * (2.0 * r / PI), values[j]);
        });
        sums.estimate((-self.k0 * r).exp())
    }

    /// ∫₀^r f₀(r') 2πr' dr' for r > 0.
    pub(crate) fn enclosed(&self, r: f64) -> Estimate {
        let mut sums = Sums::default();
        // K₁(z) − 1/z in place of K₁: the pole's part is the total
        for (j, (x, value)) in self.x.iter().zip(&self.orders[0]).enumerate() {
            let z = self.k0 * r + self.z_direction * (x * r);
            let kernel = match Macdonald::new(z) {
                Macdonald::Small { k1_minus_pole, .. } => k1_minus_pole,
                Macdonald::Scaled { k1, .. } => k1 * (-z).exp() - z.inv(),
            };
            sums.add(j, kernel * (-2.0 * r / PI), *value);
        }
        sums.estimate(1.0)
    }

    /// Calls back with index, z, Bessel functions and e^{k₀r − z} for the nodes that matter at the radius.
    fn for_each_node(&self, r: f64, mut call: impl FnMut(usize, Complex64, Macdonald, Complex64)) {
        for (j, x) in self.x.iter().enumerate() {
            let from_vertex = self.z_direction * (x * r);
            if from_vertex.re > 60.0 {
                break;
            }
            let z = self.k0 * r + from_vertex;
            call(j, z, Macdonald::new(z), (-from_vertex).exp());
        }
    }
}

/// e^{k₀r} K₀(z) and e^{k₀r} K₁(z).
fn macdonald_values(
    z: Complex64,
    macdonald: Macdonald,
    exponential: Complex64,
    k0_r: f64,
) -> (Complex64, Complex64) {
    match macdonald {
        Macdonald::Small { k0, k1_minus_pole } => {
            let scale = k0_r.exp();
            (k0 * scale, (k1_minus_pole + z.inv()) * scale)
        }
        Macdonald::Scaled { k0, k1 } => (k0 * exponential, k1 * exponential),
    }
}

impl Sums {
    fn add(&mut self, j: usize, kernel: Complex64, value: Nested) {
        let fine = (kernel * value.fine).re;
        self.fine += fine;
        self.coarse += (kernel * value.coarse).re;
        self.moduli += fine.abs();
        if j.is_multiple_of(2) {
            self.half += 2.0 * fine;
        }
    }

    /// The finer rule's error is about the square of the coarser's, as parts of the whole; and rounding.
    fn estimate(&self, factor: f64) -> Estimate {
        let square =
            |coarser: f64| (self.fine - coarser) * (self.fine - coarser) / self.moduli.max(f64::MIN_POSITIVE);
        let error = square(self.half) + square(self.coarse) + 4e-15 * self.moduli;
        Estimate { value: self.fine * factor, error: error * factor }
    }
}
