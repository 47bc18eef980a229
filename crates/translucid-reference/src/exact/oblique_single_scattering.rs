//! Light that is scattered once, in real space: a beam at any angle, under any boundary.
//!
//! A beam enters at the origin with the cosine μ₀ inside, tilted towards φ = 0. At the length t along it a part
//! α e^{−t} dt is scattered, and reaches the surface at (r, φ) over the distance D with the cosine μ = tμ₀/D:
//!
//! ```text
//! R₁(r, φ) = (α μ₀/4π) ∫₀^∞ T(tμ₀/D) t e^{−t−D}/D³ dt,   D² = r² − 2 r t sin θ₀ cos φ + t²
//! ```
//!
//! T = 1 − F is what the boundary lets out. With t = r w and D = r d the radius remains in the exponent alone,
//!
//! ```text
//! R₁(r, φ) = (α μ₀/4πr) ∫₀^∞ T w/d³ e^{−r (w + d)} dw
//! ```
//!
//! which is the Laplace transform that [`SingleScattering`] has: one set of σ = w + d ≥ 1 and weights serves every
//! radius, and integrals over r are elementary.
//! Averages over the azimuth (and over directions of entry) are gathered on few σ, by interpolation.

use std::f64::consts::{FRAC_PI_2, PI};

use translucid_profile::fresnel_from_inside;
use translucid_profile::quadrature::gauss_legendre;

use super::dielectric_directions::unit_rule;
use super::single_scattering::SingleScattering;

/// Points of the rule on each panel of w.
const POINTS: usize = 16;
/// Largest w: what is scattered farther off weighs 1e-14 of the whole at any radius.
const LN_W_MAX: f64 = 16.5;
/// Points by which averages are gathered on each panel of σ.
const GATHERED_POINTS: usize = 20;
/// Error of the rules here, as part of the value.
const RELATIVE_ERROR: f64 = 1e-12;
/// Panels of azimuths times the cosine of a beam close to grazing: azimuths and ways count on a scale that narrows with it.
const GRAZING_ERROR: f64 = 1e-13;

/// A beam inside the medium, and the boundary above it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    /// Relative index n_inside/n_outside.
    pub(crate) eta: f64,
    /// Cosine μ₀ ∈ (0, 1] of the refracted beam to the normal, inside.
    pub(crate) cos_inside: f64,
    /// Its sine.
    pub(crate) sin_inside: f64,
}

impl Beam {
    /// Refracts a beam with the cosine given outside; `None` where it would be totally reflected.
    pub(crate) fn refracted(eta: f64, cos_outside: f64) -> Option<Self> {
        let sin_inside = ((1.0 - cos_outside) * (1.0 + cos_outside)).max(0.0).sqrt() / eta;
        // (η μ₀)² = η² − 1 + μ² keeps its digits near η = 1
        let square = (eta - 1.0) * (eta + 1.0) + cos_outside * cos_outside;
        let cos_inside = (square.max(0.0).sqrt() / eta).min(1.0);
        (square > 0.0 && cos_inside > 0.0).then_some(Self { eta, cos_inside, sin_inside })
    }

    /// Half width of the strip of azimuths around the real axis in which the profile is analytic,
    /// acosh(1/sin θ₀); infinite for a beam along the normal.
    pub(crate) fn azimuth_strip(&self) -> f64 {
        libm::atanh(self.cos_inside)
    }

    /// Single scattering towards the azimuth φ.
    pub(crate) fn single_scattering(&self, single_scattering_albedo: f64, phi: f64) -> SingleScattering {
        let mut nodes = Vec::new();
        self.for_each(phi, &unit_rule(POINTS), |node| nodes.push(node));
        SingleScattering::from_nodes(single_scattering_albedo, nodes, self.relative_error())
    }

    /// Error of single scattering, as part of it.
    fn relative_error(&self) -> f64 {
        (RELATIVE_ERROR + GRAZING_ERROR / self.cos_inside).min(1.0)
    }

    /// Single scattering averaged over the azimuth.
    pub(crate) fn mean_single_scattering(&self, single_scattering_albedo: f64) -> SingleScattering {
        let mut gathered = Gathered::new();
        self.gather_mean(1.0, &unit_rule(POINTS), &mut gathered);
        gathered.finish(single_scattering_albedo, self.relative_error())
    }

    fn gather_mean(&self, factor: f64, rule: &[(f64, f64)], gathered: &mut Gathered) {
        for (phi, share) in self.azimuths(rule) {
            self.for_each(phi, rule, |[y, weight]| gathered.add(y, factor * share * weight));
        }
    }

    /// Azimuths in [0, π] and weights of the mean over them.
    fn azimuths(&self, rule: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let strip = self.azimuth_strip();
        if strip > 0.3 {
            // The trapezoidal rule over the whole circle errs by e^{−2 count · strip}
            let count = (20.0 / strip) as usize + 2;
            let share = |j: usize| if j == 0 || j == count { 0.5 } else { 1.0 };
            return (0..=count).map(|j| (PI * j as f64 / count as f64, share(j) / count as f64)).collect();
        }
        // Close to grazing the profile peaks at φ = 0: φ = strip · sinh y, in panels
        let end = libm::asinh(PI / strip);
        let panels = end.ceil() as usize;
        let width = end / panels as f64;
        let node = |panel: usize, (x, weight): (f64, f64)| {
            let y = width * (panel as f64 + x);
            (strip * libm::sinh(y), strip * libm::cosh(y) * width * weight / PI)
        };
        (0..panels).flat_map(|panel| rule.iter().map(move |&point| node(panel, point))).collect()
    }

    /// Calls back with σ − 1 and f dσ of one azimuth.
    fn for_each(&self, phi: f64, rule: &[(f64, f64)], mut call: impl FnMut([f64; 2])) {
        // w = S + h sinh v and d = h cosh v, S = sin θ₀ cos φ: smooth on the scale of 1 in v
        let (sin_phi, cos_phi) = libm::sincos(phi);
        let shift = self.sin_inside * cos_phi;
        let height = libm::hypot(self.cos_inside, self.sin_inside * sin_phi).max(1e-150);
        // 1 - shift, with its digits at grazing
        let gap = if shift > 0.0 { height * height / (1.0 + shift) } else { 1.0 - shift };
        let Some(w_first) = self.first_w(shift) else { return };
        let first = libm::asinh((w_first - shift) / height);
        let last = LN_W_MAX - libm::log(height);
        let mut from = first;
        let mut panel = 1.0 / 64.0;
        while from < last {
            let to = from + panel;
            for &(x, weight_of_rule) in rule {
                // T rises like a square root from the critical angle: x² removes it
                let (x, dx) = if from == first { (x * x, 2.0 * x) } else { (x, 1.0) };
                let v = from + panel * x;
                let (d, w) = (height * libm::cosh(v), shift + height * libm::sinh(v));
                let mu = (w * self.cos_inside / d).min(1.0);
                if w > 0.0 {
                    let passed = 1.0 - fresnel_from_inside(mu, self.eta);
                    let weight = self.cos_inside * passed * w / (d * d);
                    call([(height * libm::exp(v) - gap).max(0.0), weight * weight_of_rule * dx * panel]);
                }
            }
            (from, panel) = (to, (2.0 * panel).min(0.75));
        }
    }

    /// The least w from which light leaves: that of the critical angle, wμ₀/d = μ_c.
    fn first_w(&self, shift: f64) -> Option<f64> {
        if self.eta <= 1.0 {
            return Some(0.0);
        }
        let critical_squared = (self.eta - 1.0) * (self.eta + 1.0) / (self.eta * self.eta);
        let margin = (self.cos_inside * self.cos_inside - critical_squared).max(0.0);
        let root = (critical_squared * (critical_squared * shift * shift + margin)).sqrt();
        let denominator = critical_squared * shift + root;
        (denominator > 1e-12 * critical_squared).then(|| critical_squared / denominator)
    }
}

/// Single scattering of light that enters with equal radiance from all directions outside, for unit flux entered.
pub(crate) fn cosine_single_scattering(single_scattering_albedo: f64, eta: f64) -> SingleScattering {
    let rule_of_w = unit_rule(POINTS);
    let mut gathered = Gathered::new();
    // Angles gather at grazing, where single scattering has terms like μ ln μ
    let angles: Vec<(f64, f64)> = (gauss_legendre(24).into_iter())
        .map(|(x, weight)| {
            let x = 0.5 - 0.5 * x;
            (FRAC_PI_2 * (1.0 - x * x), FRAC_PI_2 * x * weight)
        })
        .collect();
    // Over inside directions for η < 1, over outside ones for η > 1: whichever cover their hemisphere
    let cosines = |angle: f64| -> Option<(Beam, f64)> {
        let (sin, cos) = libm::sincos(angle);
        if eta >= 1.0 {
            let passed = 1.0 - translucid_profile::fresnel_from_outside(cos, eta);
            Some((Beam::refracted(eta, cos)?, passed * cos * sin))
        } else {
            let passed = 1.0 - fresnel_from_inside(cos, eta);
            Some((Beam { eta, cos_inside: cos, sin_inside: sin }, passed * cos * sin))
        }
    };
    let entered: f64 = angles.iter().filter_map(|&(angle, w)| cosines(angle).map(|(_, flux)| flux * w)).sum();
    for (angle, weight) in angles {
        if let Some((beam, flux)) = cosines(angle) {
            beam.gather_mean(flux * weight / entered, &rule_of_w, &mut gathered);
        }
    }
    gathered.finish(single_scattering_albedo, RELATIVE_ERROR)
}

/// Single scattering of light that enters with cosines distributed uniformly inside, for unit flux entered.
///
/// Entry and exit are the foci of spheroidal coordinates σ ≥ 1, τ ∈ [−1, 1] and ψ about the axis. With the cosine of exit
/// μ = M sin ψ, M = √((σ² − 1)(1 − τ²))/(σ − τ) ≤ 1,
///
/// ```text
/// f(σ) = (1/π) ∫∫ T(μ) μ/(σ² − τ²) dτ dψ
/// ```
pub(crate) fn uniform_cosine_single_scattering(single_scattering_albedo: f64, eta: f64) -> SingleScattering {
    /// Step of the trapezoidal rule in ln(σ − 1), and its range.
    const STEP: f64 = 0.24;
    const STEPS: std::ops::RangeInclusive<i32> = -130..=130;
    let rule = gauss_legendre(24);
    let critical = ((eta - 1.0) * (eta + 1.0)).max(0.0).sqrt() / eta;
    let node = |step: i32| {
        let y = libm::exp(f64::from(step) * STEP);
        [y, over_spheroid(y, eta, critical, &rule) * y * STEP / PI]
    };
    SingleScattering::from_nodes(single_scattering_albedo, STEPS.map(node).collect(), 1e-9)
}

/// ∫∫ T(μ) μ/(σ² − τ²) dτ dψ for σ = 1 + y.
fn over_spheroid(y: f64, eta: f64, critical: f64, rule: &[(f64, f64)]) -> f64 {
    // In the plane of the foci the exit ray has the cosine M = sin of the angle γ from the surface: over γ all is smooth.
    // With e = 1/σ the focal distance is σ − τ = (σ² − 1)/(σ − cos γ), dτ = (σ² − 1) sin γ/(σ − cos γ)² dγ
    let (sigma, square_minus_1) = (1.0 + y, y * (2.0 + y));
    let least = libm::asin(critical);
    let over_gamma = |gamma: f64| {
        let sin = libm::sin(gamma);
        // σ − cos γ, with every digit for small y and γ
        let denominator = y + 2.0 * libm::sin(0.5 * gamma).powi(2);
        let far = square_minus_1 / denominator;
        let d_tau = far * sin / denominator;
        let first = if critical > 0.0 { libm::asin((critical / sin).min(1.0)) } else { 0.0 };
        // (σ − τ)(σ + τ)
        d_tau / (far * (2.0 * sigma - far))
            * integrate_to_edges(rule, first, PI - first, |psi| {
                let mu = (sin * libm::sin(psi)).min(1.0);
                (1.0 - fresnel_from_inside(mu, eta)) * mu
            })
    };
    // Panels that double from √y on, where σ − cos γ has its scale
    let (mut from, mut sum) = (least, 0.0);
    while from < PI - least {
        let to = (2.0 * from).max(y.sqrt()).max(1e-9).min(PI - least);
        sum += integrate_to_edges(rule, from, to, over_gamma);
        from = to;
    }
    sum
}

/// ∫ of a function that may be like a square root at the ends: Gauss–Legendre in x with the step x²(3 − 2x).
fn integrate_to_edges(rule: &[(f64, f64)], from: f64, to: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let length = to - from;
    let point = |&(x, weight): &(f64, f64)| {
        let x = 0.5 + 0.5 * x;
        0.5 * weight * 6.0 * x * (1.0 - x) * f(from + length * x * x * (3.0 - 2.0 * x))
    };
    length * rule.iter().map(point).sum::<f64>()
}

/// Weights gathered on fixed σ: each goes to the nodes of its panel in the shares of Lagrange's interpolation,
/// which is as good as e^{−rσ} is close to a polynomial on the panel.
struct Gathered {
    /// Bounds of the panels of σ − 1.
    edges: Vec<f64>,
    /// Chebyshev points of [0, 1] and their barycentric weights.
    points: Vec<(f64, f64)>,
    weights: Vec<f64>,
}

impl Gathered {
    fn new() -> Self {
        let mut edges = vec![0.0];
        let mut width = 0.05;
        while edges[edges.len() - 1] < 2.0 * libm::exp(LN_W_MAX) {
            edges.push(edges[edges.len() - 1] + width);
            width *= 1.5;
        }
        let n = GATHERED_POINTS;
        let point = |i: usize| {
            let angle = PI * (i as f64 + 0.5) / n as f64;
            let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            (0.5 - 0.5 * libm::cos(angle), sign * libm::sin(angle))
        };
        let weights = vec![0.0; n * (edges.len() - 1)];
        Self { edges, points: (0..n).map(point).collect(), weights }
    }

    fn add(&mut self, y: f64, weight: f64) {
        let panel = self.edges.partition_point(|&edge| edge <= y).clamp(1, self.edges.len() - 1) - 1;
        let x = (y - self.edges[panel]) / (self.edges[panel + 1] - self.edges[panel]);
        let share = |&(point, weight): &(f64, f64)| {
            let distance = x - point;
            weight / if distance == 0.0 { 1e-300 } else { distance }
        };
        let sum: f64 = self.points.iter().map(share).sum();
        let weights = &mut self.weights[panel * GATHERED_POINTS..][..GATHERED_POINTS];
        for (gathered, point) in weights.iter_mut().zip(&self.points) {
            *gathered += weight * (share(point) / sum);
        }
    }

    fn finish(self, single_scattering_albedo: f64, relative_error: f64) -> SingleScattering {
        let mut nodes = Vec::new();
        for (panel, weights) in self.weights.chunks(GATHERED_POINTS).enumerate() {
            let (from, to) = (self.edges[panel], self.edges[panel + 1]);
            let points = self.points.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            nodes.extend(points.map(|(&(x, _), &weight)| [from + (to - from) * x, weight]));
        }
        SingleScattering::from_nodes(single_scattering_albedo, nodes, relative_error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::dielectric_directions::{DirectionCounts, Directions};
    use crate::exact::single_scattering::Entrance;
    use num_complex::Complex64;
    use translucid_profile::quadrature::integrate;

    const ALPHA: f64 = 0.8;

    fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
        assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found} {expected}");
    }

    /// enclosed₁(r) = (α/2) ∫₀¹ T(μ) μ/(1+μ) [1 − exp(−r √((1+μ)/(1−μ)))] dμ for a beam along the normal.
    #[test]
    fn normal_beam_equals_the_integral_over_exit_angles() {
        let rule = gauss_legendre(60);
        for eta in [0.8f64, 1.0, 1.4] {
            let beam = Beam::refracted(eta, 1.0).expect("enters");
            let single = beam.mean_single_scattering(ALPHA);
            let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
            for r in [1e-3f64, 0.1, 1.0, 5.0] {
                // μ = μ_c + (1 − μ_c) x², and graded panels towards μ = 1
                let mut expected = 0.0;
                for panel in 0..50 {
                    let (from, to) = (1.0 - 0.5f64.powi(panel), 1.0 - 0.5f64.powi(panel + 1));
                    expected += integrate(&rule, from, to, |x| {
                        let mu = critical + (1.0 - critical) * x * x;
                        let one_minus = (1.0 - critical) * (1.0 - x) * (1.0 + x);
                        let passed = 1.0 - fresnel_from_inside(mu, eta);
                        let inside = -(-r * ((1.0 + mu) / one_minus).sqrt()).exp_m1();
                        0.5 * ALPHA * passed * mu / (1.0 + mu) * inside * (1.0 - critical) * 2.0 * x
                    });
                }
                assert_close(single.enclosed(r).value, expected, 1e-10, &format!("{eta} {r}"));
            }
        }
    }

    /// Totals without a boundary: (1 − ln 2)/2 of the order-of-scattering expansion for the pencil, 0.2045685463
    /// for the cosine (elementary and by quadrature, as the walk's tests have them).
    #[test]
    fn matched_totals_equal_the_first_order_of_scattering() {
        let normal = Beam::refracted(1.0, 1.0).expect("enters").mean_single_scattering(1.0);
        assert_close(normal.enclosed(1e7).value, 0.5 * (1.0 - std::f64::consts::LN_2), 1e-7, "pencil");
        // (α/2)(1 − μ₀ ln(1 + 1/μ₀)), by integration of (α/2) μ/(μ + μ₀) over μ
        for cos in [0.003f64, 0.01, 0.03, 0.1, 0.5, 0.9] {
            let single = Beam::refracted(1.0, cos).expect("enters").mean_single_scattering(1.0);
            let expected = 0.5 * (1.0 - cos * (1.0 + 1.0 / cos).ln());
            assert_close(single.beyond(1e-12).value, expected, 1e-9, &format!("oblique {cos}"));
        }
        assert_close(cosine_single_scattering(1.0, 1.0).beyond(1e-12).value, 0.2045685463, 1e-9, "cosine");
    }

    #[test]
    fn oblique_profile_equals_the_integral_along_the_beam() {
        let rule = gauss_legendre(40);
        for (eta, cos) in [(1.0, 0.3), (1.4, 0.6), (0.8, 0.9)] {
            let beam = Beam::refracted(eta, cos).expect("enters");
            for (r, phi) in [(0.05, 0.2), (1.0, 1.5), (4.0, 3.0)] {
                let cos_from = |t: f64| t * cos_inside(&beam, t, r, phi);
                // The critical angle by bisection: T is 0 before, and rises like a square root
                let critical = (1.0f64 - 1.0 / (eta * eta)).max(0.0).sqrt();
                let (mut low, mut first) = (0.0, 100.0);
                for _ in 0..60 {
                    let middle = 0.5 * (low + first);
                    if cos_from(middle) > critical { first = middle } else { low = middle }
                }
                let first = if critical > 0.0 { first } else { 0.0 };
                let f = |x: f64| 2.0 * x * along(&beam, first + x * x, r, phi);
                let panels = 300;
                let end = 40f64.sqrt() / f64::from(panels);
                let expected: f64 = (0..panels)
                    .map(|j| integrate(&rule, f64::from(j) * end, f64::from(j + 1) * end, f))
                    .sum();
                let found = beam.single_scattering(ALPHA, phi).eval(r).value;
                assert_close(found, expected, 1e-9, &format!("{eta} {r} {phi}"));
            }
        }
    }

    /// μ₀/D.
    fn cos_inside(beam: &Beam, t: f64, r: f64, phi: f64) -> f64 {
        beam.cos_inside / (r * r - 2.0 * r * t * beam.sin_inside * phi.cos() + t * t).sqrt()
    }

    fn along(beam: &Beam, t: f64, r: f64, phi: f64) -> f64 {
        let d = beam.cos_inside / cos_inside(beam, t, r, phi);
        let passed = 1.0 - fresnel_from_inside(t * beam.cos_inside / d, beam.eta);
        ALPHA * beam.cos_inside / (4.0 * PI) * passed * t * (-t - d).exp() / (d * d * d)
    }

    #[test]
    fn mean_is_the_mean_over_azimuths() {
        for (eta, cos) in [(1.0, 0.5), (1.33, 0.2), (0.8, 0.9)] {
            let beam = Beam::refracted(eta, cos).expect("enters");
            let mean = beam.mean_single_scattering(ALPHA);
            for r in [1e-3, 0.3, 3.0, 30.0] {
                let count = 200;
                let phi = |j: usize| PI * (j as f64 + 0.5) / count as f64;
                let sum: f64 = (0..count).map(|j| beam.single_scattering(ALPHA, phi(j)).eval(r).value).sum();
                assert_close(mean.eval(r).value, sum / count as f64, 1e-9, &format!("{eta} {r}"));
                let all = mean.enclosed(r).value + mean.beyond(r).value;
                assert_close(all, mean.beyond(1e-13).value, 1e-11, "energy");
            }
        }
    }

    #[test]
    fn uniform_entry_is_elementary_without_a_boundary() {
        let single = uniform_cosine_single_scattering(ALPHA, 1.0);
        assert_close(single.beyond(1e-12).value, 0.25 * ALPHA, 1e-9, "total");
        let elementary = SingleScattering::new(ALPHA, Entrance::UniformCosine);
        for r in [1e-3, 0.1, 1.0, 10.0, 30.0] {
            assert_close(single.eval(r).value, elementary.eval(r).value, 1e-9, &format!("{r}"));
        }
    }

    /// Against (α/4πμ₀) ∫ T/(s₀ + s) dΩ.
    #[test]
    fn transform_equals_the_integral_over_directions() {
        let counts = DirectionCounts { hemisphere: 8, arcs: 14, arc: 36 };
        for eta in [0.8, 1.3, 1.5] {
            let beam = Beam::refracted(eta, 1.0).expect("enters");
            let normal = beam.mean_single_scattering(ALPHA);
            let cosine = cosine_single_scattering(ALPHA, eta);
            let passed = 0.5 - translucid_profile::fresnel_moment_1_from_inside(eta);
            for k in [0.3, 3.0, 30.0] {
                let transform = |single: &SingleScattering| single.hankel(k).value;
                let cone = Directions::cone(Complex64::from(k), eta, counts);
                let nodes = || cone.s.iter().zip(&cone.per_solid_angle);
                let expected: Complex64 = nodes().map(|(s, w)| ALPHA * w / (1.0 + s)).sum();
                assert_close(transform(&normal), expected.re, 1e-7, &format!("normal {eta} {k}"));
                let into = |(s, w): (&Complex64, &Complex64)| -> Complex64 {
                    nodes().map(|(s_out, w_out)| w * w_out / (s + s_out)).sum()
                };
                let from_hemisphere = Directions::hemisphere(Complex64::from(k), 30);
                let enter = from_hemisphere.s.iter().zip(&from_hemisphere.per_cosine);
                let expected = 2.0 * ALPHA * enter.map(into).sum::<Complex64>();
                let uniform = uniform_cosine_single_scattering(ALPHA, eta);
                // The rule over arcs is least good where light gets out up to grazing
                let allowed = if eta > 1.0 { 1e-7 } else { 3e-6 };
                assert_close(transform(&uniform), expected.re, allowed, &format!("uniform {eta} {k}"));
                let expected = 2.0 * ALPHA / passed * nodes().map(into).sum::<Complex64>();
                assert_close(transform(&cosine), expected.re, 1e-6, &format!("cosine {eta} {k}"));
            }
        }
    }
}
