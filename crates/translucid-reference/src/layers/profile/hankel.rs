//! From real wave numbers back to radii where poles leave a remainder.
//!
//! The rest is integrated over ln k as far as J₀(kr) does not oscillate, and beyond, with a smooth seam, by H. Ogata 2005,
//! *A numerical integration formula based on the Bessel functions*, equation 5.2: nodes near the zeros of J₀, to which they
//! converge double exponentially.

use std::f64::consts::PI;

use super::poles::Poles;

/// A transform f̂ as poles and a rest that is interpolated.
#[derive(Clone, Debug)]
pub(super) struct Hankel {
    poles: Poles,
    /// ln k of the first sample, and their step.
    first: f64,
    step: f64,
    /// Wave number from which on f̂ falls like k⁻².
    bend: f64,
    /// (f̂ − poles)(1 + k²/bend²), evenly spaced in ln k.
    rest: Vec<f64>,
    /// x and weight times J₀.
    nodes: Vec<[f64; 2]>,
}

/// Step of Ogata's rule, and its end.
const STEP: f64 = 0.015;
const END: f64 = 3.3;
/// Where the seam of the two rules lies in kr, and where the first one ends.
const SEAM: f64 = 4.0;
const SEAM_END: f64 = 9.0;
/// Step of ln k, and the first k in first samples.
const LOG_STEP: f64 = 0.06;
const FIRST: f64 = 0.1;
/// Parts of the last samples' rest that count, from the last on.
const FADING: [f64; 6] = [0.0, 0.1, 0.3, 0.6, 0.85, 0.97];
/// Samples that an interpolation uses.
const SAMPLES: usize = 8;

impl Hankel {
    /// From samples evenly spaced in ln k.
    pub(super) fn new(poles: Poles, samples: &[[f64; 2]], bend: f64) -> Self {
        let rest =
            samples.iter().map(|[k, value]| (value - poles.transform(*k)) * (1.0 + k * k / (bend * bend)));
        let [first, second] = [0, 1].map(|i| libm::log(samples[i][0]));
        let mut rest: Vec<f64> = rest.collect();
        // Where the rest ends it fades
        rest.iter_mut().rev().zip(FADING).for_each(|(rest, part)| *rest *= part);
        Self { first, step: second - first, bend, rest, nodes: nodes(), poles }
    }

    /// f(r) for r > 0.
    pub(super) fn eval(&self, r: f64) -> f64 {
        let far: f64 = self.nodes.iter().map(|[x, weight]| weight * self.rest(x / r)).sum();
        let first = libm::log(FIRST * r) + self.first;
        let count = ((libm::log(SEAM_END) - first) / LOG_STEP).max(0.0) as usize;
        let near = |i: usize| {
            let x = libm::exp(first + LOG_STEP * i as f64);
            LOG_STEP * x * x * near_part(x) * libm::j0(x) * self.rest(x / r)
        };
        let near: f64 = (0..=count).map(near).sum();
        self.poles.eval(r) + (near + far) / (2.0 * PI * r * r)
    }

    /// f̂(k).
    pub(super) fn transform(&self, k: f64) -> f64 {
        self.poles.transform(k) + self.rest(k)
    }

    fn rest(&self, k: f64) -> f64 {
        let last = self.rest.len() - 1;
        let place = ((libm::log(k) - self.first) / self.step).clamp(0.0, last as f64);
        if place == last as f64 {
            return 0.0;
        }
        let count = SAMPLES.min(last + 1);
        let start = (place as usize).saturating_sub(count / 2 - 1).min(last + 1 - count);
        let x = place - start as f64;
        let values = &self.rest[start..][..count];
        let weight = |i: usize| -> f64 {
            (0..count).filter(|j| *j != i).map(|j| (x - j as f64) / (i as f64 - j as f64)).product()
        };
        let sum: f64 = values.iter().enumerate().map(|(i, value)| weight(i) * value).sum();
        sum / (1.0 + k * k / (self.bend * self.bend))
    }
}

/// Part of the integrand that the rule over ln k takes.
fn near_part(x: f64) -> f64 {
    let y = x / SEAM;
    libm::exp(-y * y * y * y)
}

/// Nodes x with the weights of ∫ (1 − near part) f(x) J₀(x) x dx.
fn nodes() -> Vec<[f64; 2]> {
    let count = (END / STEP) as usize;
    (1..=count)
        .map(|n| {
            let zero = zero_of_j0(n);
            let j1 = libm::j1(zero);
            let t = STEP * zero / PI;
            let inner = 0.5 * PI * libm::sinh(t);
            let tanh = libm::tanh(inner);
            let cosh = libm::cosh(inner.min(300.0));
            let slope = tanh + t * 0.5 * PI * libm::cosh(t) / (cosh * cosh);
            let x = PI / STEP * t * tanh;
            [x, PI * 2.0 / (PI * zero * j1 * j1) * libm::j0(x) * slope * x * (1.0 - near_part(x))]
        })
        .collect()
}

/// By J. McMahon's expansion, and Newton.
fn zero_of_j0(n: usize) -> f64 {
    let b = (n as f64 - 0.25) * PI;
    let mut zero = b + 1.0 / (8.0 * b) - 31.0 / (384.0 * b * b * b);
    for _ in 0..3 {
        zero += libm::j0(zero) / libm::j1(zero);
    }
    zero
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layers::profile::poles::bessel_k0;

    /// Poles elsewhere than those of the fit, of both signs: K₀.
    #[test]
    fn hankel_inverts_other_poles() {
        let [a, b] = [0.37, 2.9];
        let samples: Vec<[f64; 3]> = (0..32)
            .map(|i| {
                let k = 0.01 * (0.28 * f64::from(i)).exp();
                [k, 1.0 / (k * k + a * a) - 0.5 / (k * k + b * b), 0.0]
            })
            .collect();
        let poles = Poles::new(&samples, 0.0, [0.005, 50.0], 0.75);
        let plain: Vec<[f64; 2]> = samples.iter().map(|[k, value, _]| [*k, *value]).collect();
        let hankel = Hankel::new(poles, &plain, 0.5);
        for r in [0.1, 0.5, 1.0, 3.0, 10.0] {
            let exact = (bessel_k0(a * r) - 0.5 * bessel_k0(b * r)) / (2.0 * PI);
            let off = (hankel.eval(r) / exact - 1.0).abs();
            assert!(
                off < if r > 5.0 { 5e-3 } else { 1e-3 },
                "{r}: {off:e}, poles {:e}",
                hankel.poles.eval(r) / exact - 1.0
            );
        }
    }
}
