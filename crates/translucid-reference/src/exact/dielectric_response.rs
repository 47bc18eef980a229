//! Light that gets out of the half space at one lateral wave number, for every way in which light may enter.
//!
//! # Without a boundary
//! Light that enters with the decay s₀ per depth comes out with the transform (unit source along the depth, e^{−s₀τ})
//!
//! ```text
//! R̂ = H(1/s₀) g(s₀),    g(s₀) = (α/4π) ∫ H(1/s)/(s₀ + s) dΩ
//! ```
//!
//! # With one
//! Light that the boundary reflects enters once more. M. M. R. Williams 2006, *The albedo problem with Fresnel reflection*,
//! solves this for k = 0; here the equation is in its adjoint form, one solution of which serves all entries:
//!
//! ```text
//! g(s) = (α/4π) ∫ T(μ') H(1/s')/(s + s') dΩ'  +  (α/4π) ∫ F(μ')/μ' H(1/s')² g(s')/(s + s') dΩ'
//! ```
//!
//! With F = 1 − T the second integral is over the hemisphere less one over the cone that gets out:
//! [`Directions`] has the nodes of both. Residuals are minimized over Krylov's space, where some six steps give
//! 12 digits.

use std::cell::Cell;
use std::mem;

use fearless_simd::{Level, dispatch};
use num_complex::Complex64;

use super::complex::{exp, exp_m1};
use super::dielectric_directions::{DirectionCounts, Directions};
use super::dispersion::Dispersion;
use super::h_function::{HFunction, WaveNumber};

/// Residual of the equation, as part of its right side, at which the solution is good.
const RESIDUAL: f64 = 1e-12;
/// Steps after which the best so far is taken; a dozen is the most that was seen.
const MAX_STEPS: usize = 60;

/// The solution at one wave number.
#[derive(Clone, Debug)]
pub(crate) struct Response {
    h: HFunction,
    single_scattering_albedo: f64,
    s: Vec<Complex64>,
    /// Weights of 1/(s₀ + s) for light that is scattered once and gets out.
    single: Vec<Complex64>,
    /// g(s₀) = Σ weight/(s₀ + s), less `single`.
    multiple: Vec<Complex64>,
    boundary: Option<BoundarySolution>,
}

/// Values at the nodes that light over all directions needs.
#[derive(Clone, Debug)]
struct BoundarySolution {
    /// α T H dΩ/4π.
    exit: Vec<Complex64>,
    /// g.
    g: Vec<Complex64>,
    /// Σ single/(s + s') at the nodes.
    g_of_single: Vec<Complex64>,
    /// Weights of (1/4π) ∫ f/μ dΩ over the hemisphere, at all nodes.
    isotropic: Vec<Complex64>,
    /// Weights of (1/4π) ∫ fH/μ dΩ over the hemisphere, at all nodes.
    isotropic_with_h: Vec<Complex64>,
}

impl Response {
    /// The half space without a boundary.
    pub(crate) fn matched(
        dispersion: &Dispersion,
        wave_number: WaveNumber,
        t_step: f64,
        hemisphere: usize,
    ) -> Self {
        let alpha = dispersion.single_scattering_albedo;
        let h = HFunction::new(dispersion, wave_number, t_step);
        let directions = Directions::hemisphere(wave_number.k, hemisphere);
        let single: Vec<Complex64> = directions.per_solid_angle.iter().map(|w| alpha * w).collect();
        let excess = |s: &Complex64| exp_m1(h.ln_h_anywhere(*s).fine);
        let multiple = directions.s.iter().zip(&single).map(|(s, w)| w * excess(s)).collect();
        Self { h, single_scattering_albedo: alpha, s: directions.s, single, multiple, boundary: None }
    }

    /// The half space under a dielectric boundary.
    pub(crate) fn dielectric(
        dispersion: &Dispersion,
        wave_number: WaveNumber,
        t_step: f64,
        eta: f64,
        counts: DirectionCounts,
    ) -> Self {
        let alpha = dispersion.single_scattering_albedo;
        let h = HFunction::new(dispersion, wave_number, t_step);
        let cone = Directions::cone(wave_number.k, eta, counts);
        let hemisphere = Directions::hemisphere(wave_number.k, counts.hemisphere);

        // Weights at all nodes, the cone's first: of what gets out once scattered, and of what is reflected
        let zeros = |directions: &Directions| vec![Complex64::ZERO; directions.s.len()];
        let s = [cone.s.as_slice(), &hemisphere.s].concat();
        let single = [cone.per_solid_angle.iter().map(|w| alpha * w).collect(), zeros(&hemisphere)].concat();
        let mut reflected: Vec<Complex64> = cone.per_cosine.iter().map(|w| -alpha * w).collect();
        reflected.extend(hemisphere.per_cosine.iter().map(|w| alpha * w));
        let ln_h: Vec<Complex64> = s.iter().map(|&s| h.ln_h_anywhere(s).fine).collect();
        let exit: Vec<Complex64> = single.iter().zip(&ln_h).map(|(w, ln)| w * exp(*ln)).collect();
        for (w, ln) in reflected.iter_mut().zip(&ln_h) {
            *w *= exp(2.0 * ln);
        }

        // Solve, and weigh: g(s₀) = Σ (exit + reflected g)/(s₀ + s)
        let cauchy = Cauchy::new(&s);
        let g = cauchy.solve(&cauchy.apply(&exit), &reflected);
        let multiple = (0..s.len()).map(|i| single[i] * exp_m1(ln_h[i]) + reflected[i] * g[i]).collect();
        let isotropic = [zeros(&cone), hemisphere.per_cosine].concat();
        let isotropic_with_h = isotropic.iter().zip(&ln_h).map(|(w, ln)| w * exp(*ln)).collect();
        let g_of_single = cauchy.apply(&single);
        let boundary = BoundarySolution { exit, g, g_of_single, isotropic, isotropic_with_h };
        Self { h, single_scattering_albedo: alpha, s, single, multiple, boundary: Some(boundary) }
    }

    /// R̂ of unit flux entered with the cosine μ₀ and the decay s₀ inside, less single scattering.
    pub(crate) fn pencil_remainder(&self, cos_inside: f64, s0: Complex64) -> Complex64 {
        let (single, multiple) = self.sums(s0);
        let h_excess = exp_m1(self.h.ln_h_anywhere(s0).fine);
        (h_excess * (single + multiple) + multiple) / cos_inside
    }

    /// R̂ of unit flux entered with the cosine μ₀ and the decay s₀ inside.
    pub(crate) fn pencil(&self, cos_inside: f64, s0: Complex64) -> Complex64 {
        let (single, multiple) = self.sums(s0);
        exp(self.h.ln_h_anywhere(s0).fine) * (single + multiple) / cos_inside
    }

    /// R̂ of unit flux entered from all directions outside with equal radiance, less single scattering.
    ///
    /// `passed` is ∫ T(μ) μ dμ over inside directions. By reciprocity light enters as it gets out. Only with a boundary.
    pub(crate) fn cosine_remainder(&self, passed: f64) -> Complex64 {
        let Some(boundary) = &self.boundary else { return Complex64::ZERO };
        let BoundarySolution { exit, g, g_of_single, .. } = boundary;
        let nodes = 0..self.s.len();
        let sum: Complex64 = nodes.map(|i| exit[i] * g[i] - self.single[i] * g_of_single[i]).sum();
        2.0 * sum / (self.single_scattering_albedo * passed)
    }

    /// R̂ of unit flux entered from all directions outside with equal radiance; see [`Self::cosine_remainder`].
    pub(crate) fn cosine(&self, passed: f64) -> Complex64 {
        let Some(boundary) = &self.boundary else { return Complex64::ZERO };
        let sum: Complex64 = boundary.exit.iter().zip(&boundary.g).map(|(t, g)| t * g).sum();
        2.0 * sum / (self.single_scattering_albedo * passed)
    }

    /// R̂ of unit flux entered with cosines distributed uniformly inside. Only with a boundary.
    pub(crate) fn uniform_cosine(&self) -> Complex64 {
        let Some(boundary) = &self.boundary else { return Complex64::ZERO };
        2.0 * boundary.isotropic_with_h.iter().zip(&boundary.g).map(|(w, g)| w * g).sum::<Complex64>()
    }

    /// R̂ of unit flux entered with cosines distributed uniformly inside, less single scattering. Only with a boundary.
    pub(crate) fn uniform_cosine_remainder(&self) -> Complex64 {
        let Some(boundary) = &self.boundary else { return Complex64::ZERO };
        let BoundarySolution { g, g_of_single, isotropic, isotropic_with_h, .. } = boundary;
        let nodes = 0..self.s.len();
        2.0 * nodes.map(|i| isotropic_with_h[i] * g[i] - isotropic[i] * g_of_single[i]).sum::<Complex64>()
    }

    /// Σ single/(s₀ + s) and Σ multiple/(s₀ + s).
    fn sums(&self, s0: Complex64) -> (Complex64, Complex64) {
        let (mut single, mut multiple) = (Complex64::ZERO, Complex64::ZERO);
        for ((s, w_single), w_multiple) in self.s.iter().zip(&self.single).zip(&self.multiple) {
            let kernel = inverse(s0 + s);
            single += w_single * kernel;
            multiple += w_multiple * kernel;
        }
        (single, multiple)
    }
}

/// 1/z, without the care for overflow that makes the general one slow.
fn inverse(z: Complex64) -> Complex64 {
    let scale = 1.0 / (z.re * z.re + z.im * z.im);
    Complex64::new(z.re * scale, -z.im * scale)
}

/// The matrix 1/(s_i + s_j).
struct Cauchy {
    size: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

thread_local! {
    /// Room of the last matrix: fresh pages take as long as what is written to them.
    static ROOM: Cell<[Vec<f64>; 2]> = const { Cell::new([Vec::new(), Vec::new()]) };
}

impl Drop for Cauchy {
    fn drop(&mut self) {
        ROOM.set([mem::take(&mut self.re), mem::take(&mut self.im)]);
    }
}

impl Cauchy {
    fn new(s: &[Complex64]) -> Self {
        let (s_re, s_im): (Vec<f64>, Vec<f64>) = s.iter().map(|z| (z.re, z.im)).unzip();
        let size = s.len();
        let [mut re, mut im] = ROOM.take();
        re.resize(size * size, 0.0);
        im.resize(size * size, 0.0);
        let mut matrix = Self { size, re, im };
        dispatch!(Level::new(), _simd => matrix.fill(&s_re, &s_im));
        matrix
    }

    #[inline(always)] // As `rows_times`
    fn fill(&mut self, s_re: &[f64], s_im: &[f64]) {
        let rows = self.re.chunks_exact_mut(self.size).zip(self.im.chunks_exact_mut(self.size));
        for ((re, im), (a_re, a_im)) in rows.zip(s_re.iter().zip(s_im)) {
            for ((re, im), (b_re, b_im)) in re.iter_mut().zip(im).zip(s_re.iter().zip(s_im)) {
                let (x, y) = (a_re + b_re, a_im + b_im);
                let scale = 1.0 / (x * x + y * y);
                (*re, *im) = (x * scale, -y * scale);
            }
        }
    }

    fn apply(&self, x: &[Complex64]) -> Vec<Complex64> {
        let (x_re, x_im): (Vec<f64>, Vec<f64>) = x.iter().map(|z| (z.re, z.im)).unzip();
        dispatch!(Level::new(), _simd => self.rows_times(&x_re, &x_im))
    }

    #[inline(always)] // Compiled for the instructions of the function that calls it
    fn rows_times(&self, x_re: &[f64], x_im: &[f64]) -> Vec<Complex64> {
        let rows = self.re.chunks_exact(self.size).zip(self.im.chunks_exact(self.size));
        rows.map(|(re, im)| row_times(re, im, x_re, x_im)).collect()
    }

    /// g with g − C·(reflected g) = right: the generalized conjugate residual method (S. C. Eisenstat, H. C. Elman and
    /// M. H. Schultz 1983).
    fn solve(&self, right: &[Complex64], reflected: &[Complex64]) -> Vec<Complex64> {
        let mut g = vec![Complex64::ZERO; self.size];
        let mut residual = right.to_vec();
        let target = RESIDUAL * norm(right);
        let mut directions: Vec<(Vec<Complex64>, Vec<Complex64>)> = Vec::new();
        while norm(&residual) > target && directions.len() < MAX_STEPS {
            let mut step = residual.clone();
            let mut image = self.image(&step, reflected);
            for (old_step, old_image) in &directions {
                let share = dot(old_image, &image);
                subtract(&mut step, share, old_step);
                subtract(&mut image, share, old_image);
            }
            let length = norm(&image);
            if length <= 0.0 || !length.is_finite() {
                break;
            }
            let scale = Complex64::from(1.0 / length);
            step.iter_mut().chain(&mut image).for_each(|z| *z *= scale);
            let share = dot(&image, &residual);
            subtract(&mut g, -share, &step);
            subtract(&mut residual, share, &image);
            directions.push((step, image));
        }
        g
    }

    /// x − C·(reflected x).
    fn image(&self, x: &[Complex64], reflected: &[Complex64]) -> Vec<Complex64> {
        let product: Vec<Complex64> = x.iter().zip(reflected).map(|(x, w)| x * w).collect();
        self.apply(&product).iter().zip(x).map(|(y, x)| x - y).collect()
    }
}

/// Sums that the processor may add up at once.
const LANES: usize = 4;

#[inline(always)] // As `rows_times`
fn row_times(re: &[f64], im: &[f64], x_re: &[f64], x_im: &[f64]) -> Complex64 {
    let (mut sum_re, mut sum_im) = ([0.0; LANES], [0.0; LANES]);
    let whole = re.len() - re.len() % LANES;
    for at in (0..whole).step_by(LANES) {
        let [a, b, x, y] = [re, im, x_re, x_im].map(|part| &part[at..at + LANES]);
        for i in 0..LANES {
            sum_re[i] += a[i] * x[i] - b[i] * y[i];
            sum_im[i] += a[i] * y[i] + b[i] * x[i];
        }
    }
    for i in whole..re.len() {
        sum_re[0] += re[i] * x_re[i] - im[i] * x_im[i];
        sum_im[0] += re[i] * x_im[i] + im[i] * x_re[i];
    }
    Complex64::new(sum_re.iter().sum(), sum_im.iter().sum())
}

/// a* · b.
fn dot(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

fn norm(a: &[Complex64]) -> f64 {
    a.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt()
}

/// a −= share · b.
fn subtract(a: &mut [Complex64], share: Complex64, b: &[Complex64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a -= share * b;
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use translucid_profile::fresnel_from_inside;
    use translucid_profile::quadrature::gauss_legendre;

    const COUNTS: DirectionCounts = DirectionCounts { hemisphere: 26, arcs: 12, arc: 24 };

    /// The equation that the solution is to satisfy, with its integrals over real directions: another quadrature, and
    /// Fresnel's reflectance where the solver has complex transmittances.
    #[test]
    fn dielectric_satisfies_its_equation_over_real_directions() {
        let (alpha, rule, azimuths) = (0.9, gauss_legendre(50), 100);
        let dispersion = Dispersion::new(alpha);
        for (eta, k) in [(1.4f64, 0.7), (0.8, 0.7), (1.2, 1.5)] {
            let response =
                Response::dielectric(&dispersion, WaveNumber::real(&dispersion, k), 0.2, eta, COUNTS);
            let edge = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
            let g = |s: Complex64| {
                let (single, multiple) = response.sums(s);
                single + multiple
            };
            // s', and weights of T H/4π and F H² g/4πμ
            let mut nodes = Vec::new();
            for (from, to) in [(0.0, edge), (edge, 1.0)].into_iter().filter(|(from, to)| from < to) {
                for &(x, weight) in &rule {
                    let x = 0.5 + 0.5 * x;
                    let (mu, d_mu) = (from + (to - from) * x * x, (to - from) * x * weight);
                    let reflected = fresnel_from_inside(mu, eta);
                    for j in 0..azimuths {
                        let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(azimuths);
                        let s = Complex64::new(1.0, -k * (1.0 - mu * mu).sqrt() * phi.cos()) / mu;
                        let h = response.h.ln_h_anywhere(s).fine.exp();
                        let share = alpha * d_mu / (2.0 * f64::from(azimuths));
                        nodes.push((s, share * ((1.0 - reflected) * h + reflected / mu * h * h * g(s))));
                    }
                }
            }
            for s in [Complex64::new(1.0, 0.0), Complex64::new(1.5, 0.6), Complex64::new(10.0, -4.0)] {
                let right: Complex64 = nodes.iter().map(|(node, weight)| weight / (s + node)).sum();
                let off = (g(s) - right).norm() / right.norm();
                // Under η < 1 light gets out up to grazing, where the rule over arcs is least good
                let allowed = if eta > 1.0 { 1e-8 } else { 1e-6 };
                assert!(off < allowed, "{eta} {k} {s}: {} {right} {off:e}", g(s));
            }
        }
    }

    /// Light that enters as the cosine law says is a sum of pencils: reciprocity of the solution.
    #[test]
    fn cosine_equals_the_sum_of_pencils() {
        let dispersion = Dispersion::new(0.9);
        let (eta, k) = (1.4f64, 0.9);
        let response = Response::dielectric(&dispersion, WaveNumber::real(&dispersion, k), 0.2, eta, COUNTS);
        let edge = (1.0 - 1.0 / (eta * eta)).sqrt();
        let (mut sum, mut passed) = (Complex64::ZERO, 0.0);
        for (x, weight) in gauss_legendre(40) {
            let x = 0.5 + 0.5 * x;
            let mu = edge + (1.0 - edge) * x * x;
            let flux = (1.0 - fresnel_from_inside(mu, eta)) * mu * (1.0 - edge) * x * weight;
            passed += flux;
            for j in 0..40 {
                let phi = 2.0 * PI * (f64::from(j) + 0.5) / 40.0;
                let s = Complex64::new(1.0, k * (1.0 - mu * mu).sqrt() * phi.cos()) / mu;
                sum += flux / 40.0 * response.pencil(mu, s);
            }
        }
        let found = response.cosine(passed);
        assert!((found - sum / passed).norm() < 1e-9 * found.norm(), "{found} {}", sum / passed);
    }

    /// Nothing is absorbed at α = 1: everything gets out, whatever is reflected on the way.
    #[test]
    fn everything_gets_out_without_absorption() {
        let dispersion = Dispersion::new(1.0);
        for eta in [0.6, 1.2, 1.5, 2.5] {
            let wave_number = WaveNumber::real(&dispersion, 0.0);
            let response = Response::dielectric(&dispersion, wave_number, 0.2, eta, COUNTS);
            for mu in [1.0, 0.8, 0.1] {
                let total = response.pencil(mu, Complex64::from(1.0 / mu));
                assert!((total.re - 1.0).abs() < 1e-8 && total.im.abs() < 1e-12, "{eta} {mu}: {total}");
            }
            assert!((response.uniform_cosine().re - 1.0).abs() < 1e-8, "{eta}");
        }
    }
}
