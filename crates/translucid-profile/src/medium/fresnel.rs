//! Reflectance of a smooth dielectric boundary, and its angular moments.
//!
//! η = n_inside/n_outside throughout, whichever side the light comes from; the name of a function says the
//! side.
//! Exact reflectance: A.-J. Fresnel 1823, as in M. Born and E. Wolf, *Principles of Optics*, §1.5.2.

use crate::math::quadrature::{integrate, shared_gauss_legendre};

/// Reflectance of unpolarized light that comes from outside, in [0, 1].
///
/// ```text
/// F = ½ [((μ − η μ_t)/(μ + η μ_t))² + ((η μ − μ_t)/(η μ + μ_t))²],   μ_t = √(1 − (1 − μ²)/η²)
/// ```
///
/// μ is the cosine of the angle of incidence on that side; its sign does not count, and it is clamped to 1.
/// η = 1 gives exactly 0, grazing light exactly 1, light beyond the critical angle (η < 1) exactly 1.
/// η ≤ 0 or NaN has no meaning and counts as total reflection; η may be infinite.
///
/// ```
/// use translucid_profile::{fresnel_from_inside, fresnel_from_outside};
///
/// assert!((fresnel_from_outside(1.0, 1.5) - 0.04).abs() < 1e-16);
/// assert_eq!(fresnel_from_inside(0.7, 1.5), 1.0); // beyond the critical angle
/// ```
#[doc(alias = "FrDielectric")]
pub fn fresnel_from_outside(cos_theta: f64, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let mu = cos_theta.abs().min(1.0);
    // (η μ_t)² in a form that keeps its digits near η = 1
    let transmitted = (eta - 1.0) * (eta + 1.0) + mu * mu;
    let refracts = eta > 0.0 && transmitted > 0.0 && mu > 0.0;
    if !refracts {
        return 1.0;
    }
    if eta.is_infinite() {
        return 1.0;
    }
    // Each polarization divided by η, so that a large η does not overflow
    let mu_t = (transmitted.sqrt() / eta).min(1.0);
    let perpendicular = (mu / eta - mu_t) / (mu / eta + mu_t);
    let parallel = (mu - mu_t / eta) / (mu + mu_t / eta);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// Reflectance of unpolarized light that comes from inside, in [0, 1]; for η > 1 it is 1 beyond the
/// critical angle, cos θ < √(1 − 1/η²).
///
/// Arguments count as in [`fresnel_from_outside`], the cosine being that on the inner side.
pub fn fresnel_from_inside(cos_theta: f64, eta: f64) -> f64 {
    fresnel_from_outside(cos_theta, 1.0 / eta)
}

/// Schlick's approximation of [`fresnel_from_outside`] for η ≥ 1.
///
/// ```text
/// F ≈ R₀ + (1 − R₀)(1 − μ)⁵,   R₀ = ((η − 1)/(η + 1))²
/// ```
///
/// C. Schlick, *An Inexpensive BRDF Model for Physically-based Rendering*, 1994, equation 15.
/// For η ∈ [1.2, 1.8] it is off the exact value by at most 0.025 up to 60° and by up to 0.114 near grazing,
/// where η = 1.2 fares worst.
///
/// ```
/// assert!((translucid_profile::schlick_from_outside(1.0, 1.5) - 0.04).abs() < 1e-16);
/// ```
pub fn schlick_from_outside(cos_theta: f64, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    schlick(cos_theta.abs().min(1.0), eta)
}

/// Schlick's approximation for light from inside, η ≥ 1: the same with the cosine of the refracted ray, on
/// the thinner side, and 1 beyond the critical angle.
pub fn schlick_from_inside(cos_theta: f64, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let mu = cos_theta.abs().min(1.0);
    let outside_squared = 1.0 - eta * eta * (1.0 - mu * mu);
    schlick(outside_squared.max(0.0).sqrt(), eta)
}

fn schlick(mu: f64, eta: f64) -> f64 {
    let root = if eta.is_infinite() { 1.0 } else { (eta - 1.0) / (eta + 1.0) };
    let normal = root * root;
    let m = 1.0 - mu;
    normal + (1.0 - normal) * (m * m) * (m * m) * m
}

/// First moment C₁ = ∫₀¹ F(μ) μ dμ of the reflectance from outside, in [0, ½].
///
/// Twice this is the reflectance for diffuse light.
/// Quadrature in t with μ = √(η²−1) sinh t, which removes the kink at the critical angle; worst error against
/// brute force 2e-14 over η ∈ [0.05, 20].
/// C₁ is 0 at η = 1 and tends to ½ for η → 0 and η → ∞ (η is clamped to [1e-15, 1e15]; NaN counts as 1e-15).
///
/// ```
/// // Diffuse reflectance of glass, 9.18 % from outside and 59.6 % from inside.
/// use translucid_profile::{fresnel_moment_1_from_inside, fresnel_moment_1_from_outside};
/// assert!((2.0 * fresnel_moment_1_from_outside(1.5) - 0.0918).abs() < 1e-4);
/// assert!((2.0 * fresnel_moment_1_from_inside(1.5) - 0.5963).abs() < 1e-4);
/// ```
#[doc(alias = "FresnelMoment1")]
pub fn fresnel_moment_1_from_outside(eta: f64) -> f64 {
    moment(eta, Order::First)
}

/// First moment C₁ of the reflectance from inside, in [0, ½]; see [`fresnel_moment_1_from_outside`].
///
/// The two obey 1 − 2C₁(inside) = (1 − 2C₁(outside))/η².
pub fn fresnel_moment_1_from_inside(eta: f64) -> f64 {
    moment(1.0 / eta, Order::First)
}

/// Second moment C₂ = ∫₀¹ F(μ) μ² dμ of the reflectance from outside, in [0, ⅓]; method, accuracy and
/// edges as for [`fresnel_moment_1_from_outside`].
#[doc(alias = "FresnelMoment2")]
pub fn fresnel_moment_2_from_outside(eta: f64) -> f64 {
    moment(eta, Order::Second)
}

/// Second moment C₂ of the reflectance from inside, in [0, ⅓]; see [`fresnel_moment_2_from_outside`].
pub fn fresnel_moment_2_from_inside(eta: f64) -> f64 {
    moment(1.0 / eta, Order::Second)
}

/// Power of the cosine that a moment weighs with.
#[derive(Clone, Copy)]
enum Order {
    First = 1,
    Second = 2,
}

/// Moment for light that crosses from the thinner (η > 1) or the denser side (η < 1).
fn moment(eta: f64, order: Order) -> f64 {
    let eta = eta.max(1e-15).min(1e15);
    if eta == 1.0 {
        0.0
    } else if eta > 1.0 {
        moment_from_thinner_side(eta, order)
    } else {
        moment_from_denser_side(1.0 / eta, order)
    }
}

/// ∫₀¹ F μⁿ dμ for n_t/n_i = η > 1, with μ = δ sinh t, δ = √(η²−1).
fn moment_from_thinner_side(eta: f64, order: Order) -> f64 {
    let delta = ((eta - 1.0) * (eta + 1.0)).sqrt();
    integrate_over_t(eta, delta, |t| {
        let mu = delta * libm::sinh(t);
        mu.powi(order as i32) * delta * libm::cosh(t)
    })
}

/// ∫₀¹ F μⁿ dμ for n_i/n_t = η > 1: total reflection up to μ_c = δ/η, beyond it F by reciprocity.
///
/// With μ' = δ sinh t the cosine on the thinner side, μ = (δ/η) cosh t and μ dμ = μ' dμ'/η².
fn moment_from_denser_side(eta: f64, order: Order) -> f64 {
    let delta = ((eta - 1.0) * (eta + 1.0)).sqrt();
    let critical = delta / eta;
    let n = order as i32;
    let total = critical.powi(n + 1) / f64::from(n + 1);
    let partial = integrate_over_t(eta, delta, |t| {
        let mu = critical * libm::cosh(t);
        mu.powi(n - 1) * critical * libm::sinh(t) * critical * libm::cosh(t)
    });
    total + partial
}

/// ∫ F(t) weight(t) dt over the cosines of the thinner side.
///
/// F has its Brewster dip at tanh t = 1/η², near grazing when η is large: panels double in size from there,
/// up to 1.
fn integrate_over_t(eta: f64, delta: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let rule = shared_gauss_legendre(20);
    let end = libm::asinh(1.0 / delta);
    let mut from = 0.0;
    let mut sum = 0.0;
    while from < end {
        let size = if from == 0.0 { (1.0 / eta).powi(2) } else { from };
        let to = (from + size.min(1.0)).min(end);
        sum += integrate(rule, from, to, |t| reflectance_over_t(t, eta) * weight(t));
        from = to;
    }
    sum
}

/// F where μ = δ sinh t: the polarizations reflect e^{−4t} and ((η² tanh t − 1)/(η² tanh t + 1))².
fn reflectance_over_t(t: f64, eta: f64) -> f64 {
    let product = eta * eta * libm::tanh(t);
    let parallel = (product - 1.0) / (product + 1.0);
    0.5 * (libm::exp(-4.0 * t) + parallel * parallel)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ETAS: [f64; 14] =
        [0.05, 0.3, 0.67, 0.9, 0.999, 1.0, 1.000001, 1.01, 1.1, 1.33, 1.5, 2.0, 5.0, 20.0];

    /// ∫₀¹ F μⁿ dμ by graded panels around the critical angle and near grazing.
    fn brute_moment(f: impl Fn(f64) -> f64, kink: f64, n: i32) -> f64 {
        let rule = shared_gauss_legendre(16);
        let mut edges = vec![0.0, kink, 1.0];
        for k in 1..=60 {
            let step = 0.5f64.powi(k);
            edges.extend([step, kink + step, kink - step].into_iter().filter(|e| (0.0..=1.0).contains(e)));
        }
        edges.sort_by(f64::total_cmp);
        edges.windows(2).map(|e| integrate(rule, e[0], e[1], |mu| f(mu) * mu.powi(n))).sum()
    }

    #[test]
    fn moments_agree_with_brute_quadrature() {
        let mut worst = 0.0f64;
        for eta in ETAS {
            let kink = |eta: f64| if eta < 1.0 { (1.0 - eta * eta).sqrt() } else { 0.0 };
            for (n, outside, inside) in [
                (1, fresnel_moment_1_from_outside(eta), fresnel_moment_1_from_inside(eta)),
                (2, fresnel_moment_2_from_outside(eta), fresnel_moment_2_from_inside(eta)),
            ] {
                let brute = brute_moment(|mu| fresnel_from_outside(mu, eta), kink(eta), n);
                worst = worst.max((outside - brute).abs());
                let brute = brute_moment(|mu| fresnel_from_inside(mu, eta), kink(1.0 / eta), n);
                worst = worst.max((inside - brute).abs());
            }
        }
        assert!(worst < 2e-14, "{worst:e}");
    }

    /// J. W. T. Walsh 1926, as in S. Q. Duntley, J. Opt. Soc. Am. 32 (1942): diffuse reflectance 2C₁.
    #[test]
    fn first_moment_equals_the_closed_form() {
        for n in [1.2f64, 1.33, 1.5, 2.0, 3.0] {
            let n2 = n * n;
            let n4 = n2 * n2;
            let closed = 0.5
                + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
                + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
                - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
                + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
            let found = 2.0 * fresnel_moment_1_from_outside(n);
            assert!((found - closed).abs() < 1e-12, "{n}: {found} {closed}");
        }
    }

    #[test]
    fn first_moments_are_reciprocal() {
        for eta in ETAS {
            let inside = 1.0 - 2.0 * fresnel_moment_1_from_inside(eta);
            let outside = 1.0 - 2.0 * fresnel_moment_1_from_outside(eta);
            assert!((inside * eta * eta - outside).abs() < 1e-14 * (1.0 + eta * eta), "{eta}");
        }
    }

    #[test]
    fn moments_reach_their_edges() {
        type Moment = fn(f64) -> f64;
        let first: [Moment; 2] = [fresnel_moment_1_from_outside, fresnel_moment_1_from_inside];
        let second: [Moment; 2] = [fresnel_moment_2_from_outside, fresnel_moment_2_from_inside];
        for (moments, full) in [(first, 1.0 / 2.0), (second, 1.0 / 3.0)] {
            for moment in moments {
                assert_eq!(moment(1.0), 0.0);
                assert!(moment(1.0 + 1e-12) < 1e-10 && moment(1.0 - 1e-12) < 1e-10);
                for extreme in [0.0, 1e-300, 1e300, f64::INFINITY] {
                    assert!((moment(extreme) - full).abs() < 1e-13, "{extreme}: {}", moment(extreme));
                }
                assert!((moment(1e6) - full).abs() < 1e-5 && (moment(1e-6) - full).abs() < 1e-5);
                assert!(moment(f64::NAN).is_finite() && moment(-1.0).is_finite());
            }
        }
    }

    #[test]
    fn reflectance_is_zero_without_a_boundary() {
        for mu in [0.0, 1e-300, 1e-9, 0.5, 1.0] {
            assert_eq!(fresnel_from_outside(mu, 1.0), 0.0);
            assert_eq!(fresnel_from_inside(mu, 1.0), 0.0);
            assert_eq!(schlick_from_outside(mu, 1.0), 0.0);
            assert_eq!(schlick_from_inside(mu, 1.0), 0.0);
        }
    }

    #[test]
    fn reflectance_is_reciprocal() {
        for eta in [1.1f64, 1.33, 1.5, 3.0] {
            for i in 1..=100 {
                let mu = f64::from(i) / 100.0;
                let refracted = (1.0 - (1.0 - mu * mu) / (eta * eta)).sqrt();
                let (outside, inside) = (fresnel_from_outside(mu, eta), fresnel_from_inside(refracted, eta));
                assert!((outside - inside).abs() < 1e-12, "{eta} {mu}: {outside} {inside}");
            }
        }
    }

    /// At Brewster's angle, tan θ = η, only one polarization reflects: F = ½ ((η²−1)/(η²+1))².
    #[test]
    fn reflectance_at_brewsters_angle_is_half() {
        for eta in [0.7f64, 1.33, 1.5, 2.5] {
            let expected = 0.5 * ((eta * eta - 1.0) / (eta * eta + 1.0)).powi(2);
            let found = fresnel_from_outside(1.0 / (1.0 + eta * eta).sqrt(), eta);
            assert!((found - expected).abs() < 1e-15, "{eta}");
        }
    }

    #[test]
    fn reflectance_is_total_beyond_the_critical_angle() {
        let critical = (1.0f64 - 1.0 / 2.25).sqrt();
        assert_eq!(fresnel_from_inside(critical - 1e-12, 1.5), 1.0);
        assert!(fresnel_from_inside(critical + 1e-6, 1.5) < 1.0);
        assert_eq!(schlick_from_inside(critical - 1e-12, 1.5), 1.0);
        assert_eq!(fresnel_from_outside(0.0, 1.5), 1.0);
    }

    #[test]
    fn reflectance_stays_a_fraction_for_any_argument() {
        let values = [0.0, -0.0, 1e-300, 0.5, 1.0, -0.5, 1.5, 3.0, 1e200, f64::INFINITY, f64::NAN, -1.0];
        for eta in values {
            for mu in values {
                for f in [fresnel_from_outside(mu, eta), fresnel_from_inside(mu, eta)] {
                    assert!((0.0..=1.0).contains(&f), "η {eta} μ {mu}: {f}");
                }
            }
        }
    }

    #[test]
    fn schlick_stays_near_the_exact_reflectance() {
        let (mut worst, mut worst_steep) = (0.0f64, 0.0f64);
        for eta in [1.2, 1.33, 1.5, 1.8] {
            for i in 0..=1000 {
                let mu = f64::from(i) / 1000.0;
                let refracted = (1.0 - (1.0 - mu * mu) / (eta * eta)).sqrt();
                let error = (schlick_from_outside(mu, eta) - fresnel_from_outside(mu, eta)).abs();
                worst = worst.max(error);
                worst_steep = worst_steep.max(if mu >= 0.5 { error } else { 0.0 });
                let inside = (schlick_from_inside(refracted, eta) - schlick_from_outside(mu, eta)).abs();
                assert!(inside < 1e-7, "{eta} {mu}");
            }
        }
        assert!(worst < 0.114 && worst_steep < 0.025, "{worst} {worst_steep}");
    }
}
