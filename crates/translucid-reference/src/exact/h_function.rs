//! H functions of the half space whose light varies along the surface.
//!
//! Light that varies as e^{i k·x} along the surface sees a one-dimensional half space of its own
//! (G. B. Rybicki 1971, *The searchlight problem with isotropic scattering*, J. Quant. Spectrosc. Radiat.
//! Transfer 11), with an H function for each k. As a function of s = 1/ν, the decay per depth of a direction,
//!
//! ```text
//! ln H(k, 1/s) = −(s/π) ∫₀^∞ ln Λ(√(k² + t²)) / (s² + t²) dt
//! H(k, 1/s) H(k, −1/s) = 1/Λ(√(k² − s²))
//! ```
//!
//! where Re s > 0, and continued analytically from there; the singularities are at s = −√(k² + λ²),
//! λ ∈ {k₀} ∪ [1, ∞).
//!
//! # Method
//! 1. The zero and the branch point of Λ that are nearest to t = 0 integrate in closed form: with
//!    Λ = (t² + a²)/(t² + b²) Λ̃, a² = k² + k₀², b² = k² + 1, their part of H is (s + b)/(s + a).
//! 2. The rest is even in t: ½ ∫ over the whole line, on a ray t = c e^{iθ} sinh w that keeps away from the
//!    singularities ±i√(k² + λ²), by the trapezoidal rule in w, whose error is e^{−2πd/h} for a strip of
//!    analyticity of half width d.
//! 3. The poles t = ±is may be near the ray or cross it. Their part of the rule's error is known exactly: for the
//!    pole w_p that starts above the real axis
//!
//!    ```text
//!    ln H̃ = h Σ f(jh) + q/(1 − q) · ln Λ̃(√(k² − s²)),   q = e^{2πi w_p/h},   c e^{iθ} sinh w_p = is
//!    ```

use std::f64::consts::PI;

use fearless_simd::{Level, dispatch};
use num_complex::Complex64;

use super::complex::{asinh, atan, exp, exp_m1, from_polar, ln_1p, norm, sqrt};
use super::dispersion::Dispersion;

/// Wave number beyond which the transform is that of single scattering, and fourth powers are no numbers.
pub(crate) const K_MAX: f64 = 1e60;

/// A lateral wave number and its distances from the zero and the branch point of the dispersion function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WaveNumber {
    /// k.
    pub(crate) k: Complex64,
    /// k² + k₀², with every digit near k = i k₀.
    k_squared_plus_k0_squared: Complex64,
    /// a = √(k² + k₀²).
    pub(crate) a: Complex64,
    /// b = √(k² + 1).
    pub(crate) b: Complex64,
    /// Argument θ of the ray of t that is farthest from all singularities.
    t_angle: f64,
}

impl WaveNumber {
    /// k = i k₀ + x e^{iψ} for x > 0 and the angle ψ ∈ [0, π/2).
    pub(crate) fn on_ray(dispersion: &Dispersion, x: f64, angle: f64) -> Self {
        let from_vertex = from_polar(x, angle);
        let k = from_vertex + Complex64::I * dispersion.k0;
        let a_squared = from_vertex * (from_vertex + Complex64::I * (2.0 * dispersion.k0));
        // arg a² is between 0 and π/2 + ψ, for every branch point; half of that, times ±i, are singularities in t
        Self::new(dispersion, k, a_squared, std::f64::consts::FRAC_PI_8 + 0.25 * angle)
    }

    /// Any k in the right upper quadrant; near i k₀ [`Self::on_ray`] keeps more digits.
    pub(crate) fn in_quadrant(dispersion: &Dispersion, k: Complex64) -> Self {
        let a_squared = k * k + dispersion.k0 * dispersion.k0;
        Self::new(dispersion, k, a_squared, 0.25 * libm::atan2(a_squared.im, a_squared.re))
    }

    /// k ≥ 0 on the real axis.
    pub(crate) fn real(dispersion: &Dispersion, k: f64) -> Self {
        let a_squared = k * k + dispersion.k0 * dispersion.k0;
        Self::new(dispersion, k.into(), a_squared.into(), 0.0)
    }

    fn new(dispersion: &Dispersion, k: Complex64, a_squared: Complex64, t_angle: f64) -> Self {
        let b = sqrt(a_squared + dispersion.one_minus_k0_squared);
        Self { k, k_squared_plus_k0_squared: a_squared, a: sqrt(a_squared), b, t_angle }
    }

    /// Decay per depth s = √(λ² + k²) of a direction with the decay λ ≥ 1 along itself.
    pub(crate) fn decay(&self, lambda: Complex64) -> Complex64 {
        // λ² + k² = (λ² − 1) + b²
        sqrt(self.b * self.b + (lambda - 1.0) * (lambda + 1.0))
    }
}

/// A value by the quadrature of a setting, and by its coarser half.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nested {
    /// Value with every node.
    pub(crate) fine: Complex64,
    /// Value with every other node; its error is about the square root of the finer rule's.
    pub(crate) coarse: Complex64,
}

/// Samples of one ray of t, as slices of real and imaginary parts.
#[derive(Clone, Debug, Default)]
struct Samples {
    t_squared_re: Vec<f64>,
    t_squared_im: Vec<f64>,
    value_re: Vec<f64>,
    value_im: Vec<f64>,
}

impl Samples {
    fn push(&mut self, t_squared: Complex64, value: Complex64) {
        self.t_squared_re.push(t_squared.re);
        self.t_squared_im.push(t_squared.im);
        self.value_re.push(value.re);
        self.value_im.push(value.im);
    }

    /// Fills up with zeros to whole lanes.
    fn pad(&mut self) {
        while !self.t_squared_re.len().is_multiple_of(LANES) {
            self.push(Complex64::ONE, Complex64::ZERO);
        }
    }

    /// Σ value/(s² + t²), in the widest registers there are.
    fn sum(&self, s_squared: Complex64) -> Complex64 {
        self.sum_at_level(Level::new(), s_squared)
    }

    fn sum_at_level(&self, level: Level, s_squared: Complex64) -> Complex64 {
        dispatch!(level, _simd => self.sum_in_lanes(s_squared))
    }

    #[inline(always)]
    fn sum_in_lanes(&self, s_squared: Complex64) -> Complex64 {
        let (mut re, mut im) = ([0.0; LANES], [0.0; LANES]);
        let lanes = (self.t_squared_re.as_chunks::<LANES>().0.iter())
            .zip(self.t_squared_im.as_chunks::<LANES>().0)
            .zip(self.value_re.as_chunks::<LANES>().0)
            .zip(self.value_im.as_chunks::<LANES>().0);
        for (((t_re, t_im), v_re), v_im) in lanes {
            for i in 0..LANES {
                let (x, y) = (s_squared.re + t_re[i], s_squared.im + t_im[i]);
                let scale = 1.0 / (x * x + y * y);
                re[i] += (v_re[i] * x + v_im[i] * y) * scale;
                im[i] += (v_im[i] * x - v_re[i] * y) * scale;
            }
        }
        Complex64::new(re.iter().sum(), im.iter().sum())
    }
}

/// Independent sums that the processor may add up at once.
const LANES: usize = 8;

/// End of the samples, in units of |b| or 1.
const REACH: f64 = 3e4;

/// The H function of one albedo and one wave number, ready to be evaluated for many s.
#[derive(Clone, Debug)]
pub(crate) struct HFunction {
    dispersion: Dispersion,
    wave_number: WaveNumber,
    /// Step h in w.
    step: f64,
    /// c e^{iθ}.
    scale: Complex64,
    /// t² where the samples end.
    end_squared: Complex64,
    /// Samples at even and odd multiples of h.
    even: Samples,
    odd: Samples,
}

impl HFunction {
    /// Samples ln Λ̃ with the step h in w: 0.2 gives some 13 digits for k on the ray of π/4.
    pub(crate) fn new(dispersion: &Dispersion, wave_number: WaveNumber, step: f64) -> Self {
        let scale = from_polar(0.25 * norm(wave_number.b).min(1.0), wave_number.t_angle);
        let count =
            (libm::log(2.0 * REACH * norm(wave_number.b).max(1.0) / norm(scale)) / step).ceil() as usize;
        let end = scale * libm::sinh((count as f64 + 0.5) * step);
        let (mut even, mut odd) = (Samples::default(), Samples::default());
        let (ratio, mut exp_w) = (libm::exp(step), 1.0);
        for j in 0..=count {
            let weight = if j == 0 { 0.5 * step } else { step };
            let exp_minus_w = 1.0 / exp_w;
            let (t, slope) = (scale * (0.5 * (exp_w - exp_minus_w)), scale * (0.5 * (exp_w + exp_minus_w)));
            exp_w *= ratio;
            let t_squared = t * t;
            let value = dispersion.ln_regular_part(wave_number.k_squared_plus_k0_squared + t_squared);
            let samples = if j % 2 == 0 { &mut even } else { &mut odd };
            samples.push(t_squared, value * slope * weight);
        }
        even.pad();
        odd.pad();
        Self { dispersion: *dispersion, wave_number, step, scale, end_squared: end * end, even, odd }
    }

    /// The wave number k.
    pub(crate) fn wave_number(&self) -> &WaveNumber {
        &self.wave_number
    }

    /// ln H(k, 1/s) for s = √(λ² + k²), λ ≥ 1, and other s not much smaller than b whose poles are far from the ray.
    pub(crate) fn ln_h(&self, s: Complex64) -> Nested {
        let (even, odd) = self.sums(s);
        let exact = self.ln_rational_part(s) + self.tail(s);
        Nested { fine: exact + even + odd, coarse: exact + 2.0 * even }
    }

    /// H(k, 1/s) − 1 by the finer rule, for s as in [`ln_h`](Self::ln_h).
    pub(crate) fn excess(&self, s: Complex64) -> Complex64 {
        let (even, odd) = self.sums(s);
        self.times_rational_part(s, exp_m1(even + odd + self.tail(s)))
    }

    /// H(k, 1/s) − 1 by the coarser rule.
    pub(crate) fn excess_coarse(&self, s: Complex64) -> Complex64 {
        let even = self.even.sum(s * s) * (-2.0 * s / PI);
        self.times_rational_part(s, exp_m1(even + self.tail(s)))
    }

    /// H − 1 from H̃ − 1.
    fn times_rational_part(&self, s: Complex64, excess: Complex64) -> Complex64 {
        let rational = self.rational_part_excess(s);
        rational + excess + rational * excess
    }

    /// ln H(k, 1/s) up to a multiple of 2πi, for any s but the singularities, whichever side of the ray its
    /// poles are on.
    ///
    /// Continues from Re s > 0 through s of growing argument up to π, or falling down to −π/4 where k is on a ray.
    /// The absolute error is below 2e-11, except for |s| > 1e3 max(|b|, 1), where it reaches 1e-7, and for
    /// |s| < 1e-7, where it is some 1e-18/|s|.
    pub(crate) fn ln_h_anywhere(&self, s: Complex64) -> Nested {
        // The poles fall on the node w = 0 where s = 0 exactly
        let s = if s.norm_sqr() > 0.0 { s } else { self.scale * 1e-9 };
        let plain = self.ln_h(s);
        let sinh = Complex64::I * s / self.scale;
        let pole = asinh(sinh);
        let exponent = Complex64::I * (2.0 * PI / self.step) * pole;
        // The coarse rule has twice the step
        if 0.5 * exponent.re < -40.0 {
            return plain;
        }
        let from_zero = self.wave_number.k_squared_plus_k0_squared - s * s;
        let residue = self.dispersion.ln_regular_part(from_zero);
        if !residue.is_finite() {
            return plain;
        }
        let fine = plain.fine + residue * over_one_minus(exponent);
        let coarse = plain.coarse + residue * over_one_minus(0.5 * exponent);
        Nested { fine, coarse }
    }

    /// The trapezoidal sums over even and odd nodes.
    fn sums(&self, s: Complex64) -> (Complex64, Complex64) {
        let factor = -s / PI;
        (factor * self.even.sum(s * s), factor * self.odd.sum(s * s))
    }

    /// The integral beyond the samples, where ln Λ̃ = −απ/(2t) + c/t² + O(t⁻³): that from half a step behind the last
    /// node, and the first term of what makes it a sum (Euler and Maclaurin).
    fn tail(&self, s: Complex64) -> Complex64 {
        let alpha = self.dispersion.single_scattering_albedo;
        let ratio = s * s / self.end_squared;
        let to_sum = s / ((1.0 + ratio) * (1.0 + ratio) * self.end_squared) * (self.step * self.step / 24.0);
        // Mostly s is far from the end, and neither the logarithm nor the second term count
        if ratio.norm_sqr() < 1e-6 {
            return (ratio * (1.0 - 0.5 * ratio) * 0.25 / s - to_sum) * alpha;
        }
        let first = (ln_1p(ratio) * 0.25 / s - to_sum) * alpha;
        let c = alpha - (alpha * PI) * (alpha * PI) / 8.0 + self.dispersion.one_minus_k0_squared;
        let root = sqrt(ratio);
        first - c / (PI * s * sqrt(self.end_squared)) * (1.0 - atan(root) / root)
    }

    /// ln (s + b)/(s + a), with every digit for large s.
    fn ln_rational_part(&self, s: Complex64) -> Complex64 {
        ln_1p(self.rational_part_excess(s))
    }

    /// (s + b)/(s + a) − 1.
    fn rational_part_excess(&self, s: Complex64) -> Complex64 {
        let WaveNumber { a, b, .. } = self.wave_number;
        self.dispersion.one_minus_k0_squared / ((a + b) * (s + a))
    }
}

/// q/(1 − q) for q = e^z.
fn over_one_minus(z: Complex64) -> Complex64 {
    if z.re > 0.0 {
        // Without overflow: −1/(1 − 1/q)
        return exp_m1(-z).inv();
    }
    -exp(z) / exp_m1(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALPHAS: [f64; 10] = [1e-6, 0.01, 0.1, 0.3, 0.5, 0.8, 0.9, 0.99, 0.9999, 1.0];

    fn on_ray(alpha: f64, x: f64) -> (Dispersion, WaveNumber) {
        let dispersion = Dispersion::new(alpha);
        (dispersion, WaveNumber::on_ray(&dispersion, x, PI / 4.0))
    }

    /// The H function, and that of another ray of t and a finer step.
    fn two_settings(alpha: f64, x: f64) -> [HFunction; 2] {
        let (dispersion, wave_number) = on_ray(alpha, x);
        let turned = WaveNumber { t_angle: wave_number.t_angle - 0.1, ..wave_number };
        [HFunction::new(&dispersion, wave_number, 0.2), HFunction::new(&dispersion, turned, 0.12)]
    }

    #[test]
    fn h_function_is_the_same_on_another_ray_with_another_step() {
        for alpha in ALPHAS {
            for i in -30..=25 {
                let x = 10f64.powf(f64::from(i) / 4.0);
                let [h, other] = two_settings(alpha, x);
                for lambda in [0.0, 1.0, 1.0001, 1.5, 10.0, 1e3] {
                    let s = if lambda == 0.0 { Complex64::ONE } else { h.wave_number().decay(lambda.into()) };
                    let off = (h.ln_h(s).fine - other.ln_h(s).fine).norm();
                    assert!(
                        off < (2e-12 + 2e-14 * lambda) * alpha,
                        "alpha {alpha}, x {x:e}, s {s:e}: {off:e}"
                    );
                }
            }
        }
    }

    /// Decays s = 1/μ + ik tan θ cos φ of every direction, whose poles lie on both sides of the ray.
    #[test]
    fn h_function_continues_across_its_ray() {
        for alpha in ALPHAS {
            for x in [1e-8, 1e-4, 1e-2, 0.1, 1.0, 10.0, 1e3, 1e5] {
                let [h, other] = two_settings(alpha, x);
                for a in [1.0, 1.3, 10.0, 1e3] {
                    for c in [-1e3, -30.0, -3.0, -1.0, -0.1, 0.0, 0.1, 1.0, 3.0, 30.0, 1e3] {
                        let s = a + Complex64::I * h.wave_number().k * c * a;
                        let off = (h.ln_h_anywhere(s).fine - other.ln_h_anywhere(s).fine).exp() - 1.0;
                        // Where the samples end, H is 1 to 1e-3 and has fewer digits
                        let reach = 1e3 * h.wave_number().b.norm().max(1.0);
                        let allowed = if s.norm() < reach { 2e-11 + 5e-18 / s.norm() } else { 1e-7 };
                        assert!(off.norm() < allowed, "alpha {alpha}, x {x:e}, s {s:e}: {:e}", off.norm());
                    }
                }
            }
        }
    }

    #[test]
    fn instruction_sets_agree() {
        let (dispersion, wave_number) = on_ray(0.9, 0.7);
        let samples = HFunction::new(&dispersion, wave_number, 0.2).even;
        for i in 1..100 {
            let s = Complex64::new(0.1 * f64::from(i), 0.03 * f64::from(i) - 1.0);
            let widest = samples.sum(s * s);
            for level in crate::walk::narrower_levels() {
                assert_eq!(samples.sum_at_level(level, s * s), widest, "{level:?}, {s}");
            }
        }
    }

    #[test]
    fn coarse_rule_errs_by_the_square_root() {
        for alpha in ALPHAS {
            for x in [1e-4, 0.1, 1.0, 10.0, 1e3] {
                let [h, _] = two_settings(alpha, x);
                let value = h.ln_h(Complex64::ONE);
                let off = (value.fine - value.coarse).norm();
                assert!(off < 2e-6 * alpha, "alpha {alpha}, x {x:e}: {off:e}");
            }
        }
    }

    fn without_variation(alpha: f64) -> HFunction {
        let dispersion = Dispersion::new(alpha);
        HFunction::new(&dispersion, WaveNumber::real(&dispersion, 0.0), 0.2)
    }

    /// S. Chandrasekhar 1950, *Radiative Transfer*, table XI, the column of the perfect scatterer.
    #[test]
    fn h_function_matches_published_values() {
        let published = [
            (0.1, 1.2474),
            (0.2, 1.4503),
            (0.3, 1.6425),
            (0.4, 1.8293),
            (0.5, 2.0128),
            (0.6, 2.1941),
            (0.7, 2.3740),
            (0.8, 2.5527),
            (0.9, 2.7306),
            (1.0, 2.9078),
        ];
        let h = without_variation(1.0);
        for (mu, expected) in published {
            let found = h.ln_h((1.0 / mu).into()).fine.exp().re;
            assert!((found - expected).abs() < 6e-5, "{mu}: {found}");
        }
    }

    /// Moments of H for α = 1: ∫H dμ = 2, ∫Hμ dμ = 2/√3 (Chandrasekhar 1950, chapter V), and ∫Hμ² dμ/∫Hμ dμ =
    /// 0.710446089598, the extrapolation length of Milne's problem (G. Placzek and W. Seidel 1947, *Milne's problem
    /// in transport theory*, Phys. Rev. 72, to the digits known since).
    #[test]
    fn h_function_has_its_moments() {
        let h = without_variation(1.0);
        let rule = translucid_profile::quadrature::gauss_legendre(40);
        let moment = |power: i32| {
            translucid_profile::quadrature::integrate(&rule, 0.0, 1.0, |w| {
                let mu = w * w * w;
                h.ln_h((1.0 / mu).into()).fine.exp().re * mu.powi(power) * 3.0 * w * w
            })
        };
        assert!((moment(0) - 2.0).abs() < 1e-12, "{}", moment(0));
        assert!((moment(1) - 2.0 / 3f64.sqrt()).abs() < 1e-12, "{}", moment(1));
        assert!((moment(2) / moment(1) - 0.710446089598).abs() < 1e-12, "{}", moment(2) / moment(1));
    }

    /// The equation that H solves, with the characteristic function of the wave number k:
    /// 1/H(μ) = 1 − μ ∫ Ψ H dμ'/(μ + μ'), Ψ dμ' = (α/2) du/(1 + k²u²).
    #[test]
    fn h_function_solves_its_equation() {
        let rule = translucid_profile::quadrature::gauss_legendre(60);
        for alpha in [0.1, 0.9, 1.0] {
            for k in [0.3, 1.0, 5.0] {
                let dispersion = Dispersion::new(alpha);
                let wave_number = WaveNumber::real(&dispersion, k);
                let h = HFunction::new(&dispersion, wave_number, 0.2);
                for s in [1.0, 1.7, 30.0] {
                    let integral = translucid_profile::quadrature::integrate(&rule, 0.0, 1.0, |w| {
                        let u = w * w * w;
                        let decay = wave_number.decay(Complex64::from(1.0 / u));
                        let value = h.ln_h(decay).fine.exp().re;
                        0.5 * alpha * value * decay.re / ((s + decay.re) * (1.0 + k * k * u * u))
                            * 3.0
                            * w
                            * w
                    });
                    let product = h.ln_h_anywhere(s.into()).fine.exp().re * (1.0 - integral);
                    assert!((product - 1.0).abs() < 1e-11, "alpha {alpha}, k {k}, s {s}: {product}");
                }
            }
        }
    }
}
