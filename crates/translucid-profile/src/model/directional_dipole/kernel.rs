//! The formulas of the directional dipole in units of the transport mean free path, for one accuracy or another.
//!
//! J. R. Frisvad, T. Hachisuka and T. K. Kjeldsen, *Directional Dipole Model for Subsurface Scattering*, ACM
//! Transactions on Graphics 34(1), 2014. [`DirectionalDipole`](crate::DirectionalDipole) explains the model.
//!
//! ```text
//! 4πR = [S(x, ω, d_r) − S(x − h n*, ω*, d_v)]₊ · strength
//! S(x, ω, d) = C_φ [E/(D d) + 3P x·ω] + C_E [(P + 3D Q x·ω) x·n_o − 3D P ω·n_o]
//! E = e^{−σd},  P = (1 + σd) E/d³,  Q = (3P + σ²E/d)/d²
//! ```
//!
//! The formula of the paper, less two things:
//!
//! 1. The difference E/d_r − E/d_v is formed from d_v² − d_r² = h² − z², which keeps its digits at any distance:
//!    n* is perpendicular to x, so that d_v² = |x|² + h².
//! 2. Scalar products with mirrored vectors are formed from those with the vectors themselves.

use crate::Medium;
use crate::math::elementary::{Accuracy, exp_negative};
use crate::medium::diffusion_boundary::DiffusionBoundary;

/// Diffusion coefficient, in transport mean free paths.
pub(crate) const D: f64 = 1.0 / 3.0;
/// Extrapolation length of a half space that does not absorb (B. Davison 1957, 0.7104 transport mean free paths),
/// over D, as the paper rounds it.
const EXTRAPOLATION: f64 = 2.131;
/// Reduced albedo below which the extrapolation length does not grow any more: its source is dark by then.
const LEAST_ALPHA_PRIME: f64 = 1e-12;
/// Lengths in transport mean free paths beyond which all are the same.
const FAR: f64 = 1e60;
/// Least distance from a source: its inverse fifth power times a cosine squared is a number.
const LEAST_DISTANCE: f64 = 1e-90;
/// Squared sine of the angle between offset and normal below which the mirror plane has no direction.
const LEAST_SINE_SQUARED: f64 = 1e-24;

/// The model's constants; lengths in transport mean free paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kernel {
    /// C_φ, C_E and A.
    pub(crate) boundary: DiffusionBoundary,
    /// η = n_inside/n_outside.
    pub(crate) eta: f64,
    /// σ_tr.
    pub(crate) sigma_tr: f64,
    /// Extrapolation length d_E.
    pub(crate) extrapolation: f64,
    /// Height h = 2 A d_E of the virtual source over the entry point.
    pub(crate) mirror: f64,
    /// (1/3σ_t)², which keeps the source off the exit point where light is refracted towards that point's outside.
    pub(crate) back_lit: f64,
    /// Part of the light that entered which the source emits.
    pub(crate) strength: f64,
    /// Transport mean free paths per unit of length \[L⁻¹\].
    pub(crate) sigma_t_prime: f64,
}

/// Fluence and its derivatives at a distance from a source.
#[derive(Clone, Copy)]
pub(crate) struct Falloff {
    /// 1/d.
    pub(crate) inverse: f64,
    /// E/d.
    pub(crate) e_over_d: f64,
    /// P = (1 + σd) E/d³.
    pub(crate) p: f64,
}

impl Falloff {
    #[inline(always)]
    pub(crate) fn new(sigma_tr: f64, d: f64, e: f64) -> Self {
        let inverse = 1.0 / d;
        let e_over_d = e * inverse;
        Self { inverse, e_over_d, p: (1.0 + sigma_tr * d) * (e_over_d * inverse) * inverse }
    }
}

impl Kernel {
    /// The model of a medium whose source emits the part `strength` of the light that entered.
    pub(crate) fn of_medium(medium: &Medium, strength: f64, boundary: DiffusionBoundary, eta: f64) -> Self {
        let sigma_t_prime = medium.sigma_t_prime();
        let albedos = [medium.sigma_a() / sigma_t_prime, medium.alpha_prime()];
        Self::new(albedos, strength, sigma_t_prime / medium.sigma_t(), sigma_t_prime, boundary, eta)
    }

    /// The model of 1 − α' and α', each with its own digits, of the part `strength` that the source emits of the
    /// light that entered, of the ratio σ'_t/σ_t and of σ'_t \[L⁻¹\].
    pub(crate) fn new(
        [absorbed, alpha_prime]: [f64; 2],
        strength: f64,
        reduction: f64,
        sigma_t_prime: f64,
        boundary: DiffusionBoundary,
        eta: f64,
    ) -> Self {
        let extrapolation = EXTRAPOLATION * D / alpha_prime.max(LEAST_ALPHA_PRIME).sqrt();
        Self {
            boundary,
            eta,
            sigma_tr: (absorbed / D).sqrt(),
            extrapolation,
            mirror: 2.0 * boundary.mismatch * extrapolation,
            back_lit: (D * reduction) * (D * reduction),
            strength,
            sigma_t_prime,
        }
    }

    /// R before the clamp \[L⁻²\].
    #[inline(always)]
    pub(crate) fn unclamped<P: Accuracy>(
        &self,
        offset: [f64; 3],
        omega_i: [f64; 3],
        n_i: [f64; 3],
        n_o: [f64; 3],
    ) -> f64 {
        let x = offset.map(|x| bounded(x * self.sigma_t_prime));
        let n_i = unit(n_i).unwrap_or([0.0, 0.0, 1.0]);
        let n_o = unit(n_o).unwrap_or(n_i);
        let omega_i = unit(omega_i).unwrap_or(n_i);
        let Some(omega) = refracted(omega_i, n_i, self.eta) else { return 0.0 };
        let relative = self.relative::<P>(x, omega, n_i, n_o);
        let scale = self.strength * (self.sigma_t_prime * self.sigma_t_prime) / (4.0 * std::f64::consts::PI);
        (relative * scale).max(-f64::MAX).min(f64::MAX)
    }

    /// 4πR before the clamp, per strength, for unit vectors and the refracted direction of light.
    #[inline(always)]
    fn relative<P: Accuracy>(&self, x: [f64; 3], omega: [f64; 3], n_i: [f64; 3], n_o: [f64; 3]) -> f64 {
        let DiffusionBoundary { fluence: c_phi, flux: c_e, .. } = self.boundary;
        let r2 = dot(x, x);

        // Mirror in the plane through both points that is nearest to the entry's tangent plane
        let n_star = modified_normal(x, r2, n_i, omega);
        let (star_omega, star_n) = (dot(n_star, omega), dot(n_star, n_o));
        let (x_omega, x_n, omega_n) = (dot(x, omega), dot(x, n_o), dot(omega, n_o));
        let virtual_x_omega = x_omega + self.mirror * star_omega;
        let virtual_x_n = x_n - self.mirror * star_n;
        let virtual_omega_n = omega_n - 2.0 * star_omega * star_n;

        // Measure the distances from the two sources
        let z2 = self.source_depth_squared(r2, x_omega, -omega_n);
        let d_r = (r2 + z2).sqrt().max(LEAST_DISTANCE);
        let d_v = (r2 + self.mirror * self.mirror).sqrt();
        // The virtual source is the farther: A ≥ 1, z² ≤ D(D + 2d_E), and d_E > 2D
        let gap = (self.mirror * self.mirror - z2) / (d_v + d_r);

        // Let the light fall off
        let sigma = self.sigma_tr;
        let (e_r, _) = exp_negative::<P>(sigma * d_r);
        let (more, less) = exp_negative::<P>(sigma * gap);
        let real = Falloff::new(sigma, d_r, e_r);
        let image = Falloff::new(sigma, d_v, e_r * more);
        let monopoles = e_r * (gap * real.inverse + less) * image.inverse;

        // Add up fluence and flux
        let rest = |f: Falloff, x_omega: f64, x_n: f64, omega_n: f64| {
            let (cos_omega, cos_n) = (x_omega * f.inverse, x_n * f.inverse);
            let quadrupole = (3.0 * f.p + sigma * sigma * f.e_over_d) * cos_omega * cos_n;
            3.0 * c_phi * f.p * x_omega + c_e * (f.p * x_n + 3.0 * D * (quadrupole - f.p * omega_n))
        };
        c_phi / D * monopoles + rest(real, x_omega, x_n, omega_n)
            - rest(image, virtual_x_omega, virtual_x_n, virtual_omega_n)
    }

    /// Square of how far the real source is off the exit point beyond |x|, d_r² − |x|².
    #[inline(always)]
    fn source_depth_squared(&self, r2: f64, x_omega: f64, mu_0: f64) -> f64 {
        if mu_0 > 0.0 {
            let d_e = self.extrapolation;
            let minus_cos_beta = ((r2 - x_omega * x_omega).max(0.0) / (r2 + d_e * d_e)).sqrt();
            (D * mu_0) * (D * mu_0 + 2.0 * d_e * minus_cos_beta)
        } else {
            self.back_lit
        }
    }
}

/// Direction that light from `omega_i` takes below the surface; `None` for light that does not get there.
#[inline(always)]
fn refracted(omega_i: [f64; 3], n_i: [f64; 3], eta: f64) -> Option<[f64; 3]> {
    let mu = dot(omega_i, n_i);
    // (η μ_t)², in the form that keeps its digits near η = 1
    let square = (eta - 1.0) * (eta + 1.0) + mu * mu;
    if !(mu > 0.0 && square > 0.0) {
        return None;
    }
    let along_normal = mu - square.sqrt();
    Some([0, 1, 2].map(|i| (along_normal * n_i[i] - omega_i[i]) / eta))
}

/// Normal n* of the plane in which the source is mirrored: perpendicular to x, as near to n_i as that allows.
///
/// n_i itself at x = 0; where x is parallel to n_i, one that lies across the beam, which is the mean of all that
/// could be meant.
#[inline(always)]
fn modified_normal(x: [f64; 3], r2: f64, n_i: [f64; 3], omega: [f64; 3]) -> [f64; 3] {
    if r2 == 0.0 {
        return n_i;
    }
    let along = dot(x, n_i) / r2;
    let across = [0, 1, 2].map(|i| n_i[i] - along * x[i]);
    let sine_squared = dot(across, across);
    if sine_squared > LEAST_SINE_SQUARED {
        let inverse = 1.0 / sine_squared.sqrt();
        across.map(|c| c * inverse)
    } else {
        perpendicular_to_both(n_i, omega)
    }
}

/// A unit vector perpendicular to the unit vectors n and ω, which may be parallel.
#[cold]
fn perpendicular_to_both(n: [f64; 3], omega: [f64; 3]) -> [f64; 3] {
    let axis = if n[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    unit(cross(n, omega)).or_else(|| unit(cross(n, axis))).unwrap_or([0.0, 0.0, 1.0])
}

/// A length as the formulas need it: NaN counts as 0.
#[inline(always)]
fn bounded(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.max(-FAR).min(FAR) }
}

/// The vector at length 1, unless it is too short, too long or no vector.
#[inline(always)]
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let square = dot(v, v);
    let inverse = 1.0 / square.sqrt();
    (square > 1e-24 && square < 1e24).then(|| v.map(|c| c * inverse))
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
