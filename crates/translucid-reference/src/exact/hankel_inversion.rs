//! From wave numbers back to radii, with full relative accuracy at every radius.
//!
//! ```text
//! R(r) = (1/2π) Re ∫ R̂(k) H₀⁽¹⁾(kr) k dk            beyond(r) = −r Re ∫ R̂(k) H₁⁽¹⁾(kr) dk
//! ```
//!
//! along the ray k = i k₀ + x e^{iψ}, x ∈ (0, ∞), into the right upper quadrant. R̂ is real on the segment from 0 to
//! i k₀, which gives nothing. On the ray the Hankel function decays like e^{−k₀r − x r sin ψ}: the first part, which
//! R itself has, comes out as a factor.
//! With z = −ikr the Hankel functions are H₀⁽¹⁾(kr) = −(2i/π) K₀(z) and H₁⁽¹⁾(kr) = −(2/π) K₁(z).
//!
//! The nodes are those of the trapezoidal rule in w with x = exp(w − e^{w₀−w} + e^{w−w₁}), one set for every radius.
//! Between e^{w₀} and e^{w₁} it is a rule in ln x. Below, where R̂ is smooth in √x, it rushes to 0. Above, it runs out
//! faster and faster, for radii so small that nearly all of R is single scattering.
//!
//! # Error
//! A rule of twice the step, and R̂ of a coarser setting, say how fast the sums converge: the error of the finer is
//! about the square of the coarser's. The factors in [`Sums::estimate`] cover what was found against much finer
//! settings.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::complex::{exp, from_polar};
use super::dispersion::Dispersion;
use super::h_function::{Nested, WaveNumber};
use super::macdonald::{Macdonald, MacdonaldNear};
use crate::Estimate;

/// Steps and rules of the exact solution.
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
    /// Radius up to which the error keeps small.
    pub(crate) r_max: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { angle: std::f64::consts::FRAC_PI_4, k_step: 0.14, t_step: 0.2, directions: 32, r_max: 1e3 }
    }
}

/// A point of the ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    /// x.
    pub(crate) x: f64,
    /// k = i k₀ + x e^{iψ}.
    pub(crate) k: Complex64,
    /// Weight of the rule, dk.
    pub(crate) dk: Complex64,
}

/// The ray of wave numbers and its nodes, those of even index being the rule of twice the step.
#[derive(Clone, Debug)]
pub(crate) struct Contour {
    k0: f64,
    angle: f64,
    low: f64,
    /// In order of x.
    pub(crate) nodes: Vec<Node>,
}

impl Contour {
    /// A ray that begins at i k₀.
    pub(crate) fn new(k0: f64, settings: &Settings) -> Self {
        let Settings { angle, k_step, r_max, .. } = *settings;
        let direction = from_polar(1.0, angle);
        let (low, high) = (libm::log(0.1 / r_max), libm::log(1e5f64));
        let first = low - 3.6;
        let count = ((high + 2.4 - first) / k_step).ceil() as usize;
        let node = |j: usize| {
            let w = first + j as f64 * k_step;
            let (below, above) = (libm::exp(low - w), libm::exp(w - high));
            let x = libm::exp(w - below + above);
            let dk = direction * (x * (1.0 + below + above) * k_step);
            Node { x, k: direction * x + Complex64::I * k0, dk }
        };
        Self { k0, angle, low: libm::exp(low), nodes: (0..=count).map(node).collect() }
    }

    /// The wave number of a node, if the ray begins at the k₀ of a medium.
    pub(crate) fn wave_number(&self, dispersion: &Dispersion, node: &Node) -> WaveNumber {
        WaveNumber::on_ray(dispersion, node.x, self.angle)
    }
}

/// A function f(r) given by its Hankel transform on the nodes of a [`Contour`].
///
/// The transform must be even in k and real for real k, and decay like k⁻² or faster: R̂ without single scattering.
#[derive(Clone, Debug)]
pub(crate) struct Inversion {
    k0: f64,
    /// −i e^{iψ}, the direction of z − k₀r.
    z_direction: Complex64,
    /// x of the nodes.
    x: Vec<f64>,
    /// Below this x the nodes rush to 0.
    low: f64,
    /// Measure of how far out the nodes are, in [0, 1).
    far: Vec<f64>,
    /// Transform times dk.
    values: Vec<Nested>,
    /// ∫ f 2πr dr, where it is known and needed.
    total: Option<Estimate>,
}

/// Sums over nodes: all nodes; every other node; all nodes with the coarser values; moduli of all.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    fine: f64,
    half: f64,
    coarse: f64,
    moduli: f64,
    /// Sums over the nodes far out, all and every other.
    far: [f64; 2],
}

impl Inversion {
    /// `values[j]` is the transform at node j.
    pub(crate) fn new(contour: &Contour, values: &[Nested]) -> Self {
        let weighted = (values.iter().zip(&contour.nodes))
            .map(|(v, node)| Nested { fine: v.fine * node.dk, coarse: v.coarse * node.dk });
        Self {
            k0: contour.k0,
            low: contour.low,
            z_direction: from_polar(1.0, contour.angle - PI / 2.0),
            x: contour.nodes.iter().map(|node| node.x).collect(),
            far: contour
                .nodes
                .iter()
                .map(|node| 1.0 - 1.0 / (1.0 + (node.x / FAR) * (node.x / FAR)))
                .collect(),
            values: weighted.collect(),
            total: None,
        }
    }

    /// Makes the total ∫ f 2πr dr = f̂(0) known, without which [`beyond`](Self::beyond) is wrong for small k₀.
    pub(crate) fn with_total(self, total: Estimate) -> Self {
        // K₁(z) has a pole at k = 0, which the nodes must keep away from
        let pole_is_close = self.k0 < 10.0 * self.low;
        Self { total: pole_is_close.then_some(total), ..self }
    }

    /// Returns whether [`beyond`](Self::beyond) is the total less what is within.
    pub(crate) fn beyond_is_difference(&self) -> bool {
        self.total.is_some()
    }

    /// f(r) for r > 0.
    pub(crate) fn eval(&self, r: f64) -> Estimate {
        let r = r.max(R_MIN);
        let mut sums = Sums::default();
        let values = &self.values;
        // (1/2π) (2/π) (−i) K₀ k dk, with k = iz/r
        let factor = 1.0 / (PI * PI * r);
        self.for_each_node(r, |j, z, k0, _| sums.add(j, self.far[j], k0 * z * factor, values[j]));
        let decay = libm::exp(-self.k0 * r);
        if sums.moduli == 0.0 {
            // Farther out than every node: all that is known is that f falls
            return Estimate { value: 0.0, error: decay / (PI * r * r) };
        }
        sums.estimate(decay)
    }

    /// ∫_r^∞ f(r') 2πr' dr' for r > 0.
    pub(crate) fn beyond(&self, r: f64) -> Estimate {
        if let Some(total) = self.total {
            let enclosed = self.enclosed(r);
            let value = (total.value - enclosed.value).max(0.0);
            return Estimate { value, error: total.error + enclosed.error };
        }
        let r = r.max(R_MIN);
        let mut sums = Sums::default();
        let values = &self.values;
        self.for_each_node(r, |j, _, _, k1| sums.add(j, self.far[j], k1 * (2.0 * r / PI), values[j]));
        sums.estimate(libm::exp(-self.k0 * r))
    }

    /// ∫₀^r f(r') 2πr' dr' for r > 0.
    pub(crate) fn enclosed(&self, r: f64) -> Estimate {
        if r < R_MIN {
            return Estimate::ZERO;
        }
        let r = r.min(R_MAX);
        let mut sums = Sums::default();
        // K₁(z) − 1/z in place of K₁: the pole's part is the total
        for (j, (x, value)) in self.x.iter().zip(&self.values).enumerate() {
            let z = self.k0 * r + self.z_direction * (x * r);
            let kernel = match Macdonald::new(z) {
                Macdonald::Small { k1_minus_pole, .. } => k1_minus_pole,
                Macdonald::Scaled { k1, .. } => k1 * exp(-z) - z.inv(),
            };
            sums.add(j, self.far[j], kernel * (-2.0 * r / PI), *value);
        }
        sums.estimate(1.0)
    }

    /// Calls back with index, z, e^{k₀r} K₀(z) and e^{k₀r} K₁(z) for the nodes that matter at the radius.
    #[inline(always)]
    fn for_each_node(&self, r: f64, mut call: impl FnMut(usize, Complex64, Complex64, Complex64)) {
        let z0 = self.k0 * r;
        let scale = libm::exp(z0);
        let near = (z0 > Z0_MIN).then(|| MacdonaldNear::new(z0));
        let reach = near.map_or(0.0, |near| near.reach() / r);
        for (j, x) in self.x.iter().enumerate() {
            let delta = self.z_direction * (x * r);
            if delta.re > NEGLIGIBLE {
                break;
            }
            let z = z0 + delta;
            if let Some(near) = &near
                && *x < reach
            {
                let (k0, k1) = near.eval(delta);
                call(j, z, k0, k1);
                continue;
            }
            let (k0, k1) = match Macdonald::new(z) {
                Macdonald::Small { k0, k1_minus_pole } => (k0 * scale, (k1_minus_pole + z.inv()) * scale),
                Macdonald::Scaled { k0, k1 } => {
                    let decay = exp(-delta);
                    (k0 * decay, k1 * decay)
                }
            };
            call(j, z, k0, k1);
        }
    }
}

/// Spacing at which the nodes are too far apart for the rule's error to be the square of the coarser one's.
const FAR: f64 = 1e6;
/// Below this radius f counts as constant: it grows like ln² r, and single scattering like 1/r.
const R_MIN: f64 = 1e-20;
/// Below this k₀r the coefficients of Taylor series leave the range of numbers.
const Z0_MIN: f64 = 1e-8;
/// Beyond this radius nothing is left to enclose.
const R_MAX: f64 = 1e100;
/// Argument x at which e^{−x} ends what matters.
const NEGLIGIBLE: f64 = 45.0;

impl Sums {
    fn add(&mut self, j: usize, far: f64, kernel: Complex64, value: Nested) {
        let fine = (kernel * value.fine).re;
        self.fine += fine;
        self.coarse += (kernel * value.coarse).re;
        self.moduli += fine.abs();
        let half = if j.is_multiple_of(2) { 2.0 * fine } else { 0.0 };
        self.half += half;
        self.far[0] += far * fine;
        self.far[1] += far * half;
    }

    /// The sum and its error, times a factor; 5e-12 is what rounding and the rule over directions leave.
    fn estimate(&self, factor: f64) -> Estimate {
        let moduli = self.moduli.max(f64::MIN_POSITIVE);
        let square = |coarser: f64| (self.fine - coarser) * (self.fine - coarser) / moduli;
        let far = (self.far[0] - self.far[1]).abs();
        let error = 50.0 * (square(self.half) + square(self.coarse)) + 3.0 * far + 5e-12 * self.moduli;
        Estimate { value: self.fine * factor, error: error * factor }
    }
}
