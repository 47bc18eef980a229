//! Photon beam diffusion for a beam at any angle: isotropic scattering, no boundary, the paper's integral as it stands.
//!
//! ```text
//! R(x, y) = ∫₀^∞ α' σ_t e^{−σ_t t} κ α'/4π {(e^{−s d_r}/d_r − e^{−s d_v}/d_v)/4D
//!                  + ½ [z (1 + s d_r) e^{−s d_r}/d_r³ + (z + 2z_b)(1 + s d_v) e^{−s d_v}/d_v³]} dt
//!         + ∫₀^∞ σ_s e^{−σ_t (t + d_r)} z/4πd_r³ dt
//! κ = 1 − e^{−2σ_t (t + d_r)},   z_b = 2D,   s = √(σ_a/D)
//! ```
//!
//! z = t cos θ is the depth of the beam at the length t; d_r and d_v are the distances of the exit from there and from
//! its image at the height z + 2z_b.

use std::f64::consts::PI;
use std::sync::LazyLock;

use translucid_profile::Medium;
use translucid_profile::quadrature::{gauss_legendre, integrate};

/// Lengths of the beam in mean free paths beyond which nothing is left.
const LENGTH: f64 = 40.0;

/// Exitance per unit of flux of an oblique beam.
pub(crate) struct ObliqueBeam {
    medium: Medium,
    /// Direction of the beam along the surface and down.
    direction: [f64; 2],
}

impl ObliqueBeam {
    /// The beam whose angle of incidence has the cosine `cos_theta`.
    pub(crate) fn new(medium: &Medium, cos_theta: f64) -> Self {
        Self { medium: *medium, direction: [(1.0 - cos_theta * cos_theta).sqrt(), cos_theta] }
    }

    /// R at the distance r from the entry and the azimuth φ from where the beam is tilted to \[L⁻²\].
    pub(crate) fn eval(&self, r: f64, phi: f64) -> f64 {
        let (x, y) = (r * phi.cos(), r * phi.sin());
        // The integrand is steep where the beam passes the exit
        let nearest = (x * self.direction[0]).max(0.0);
        let off = ((r * r - nearest * nearest).max(0.0).sqrt() / 8.0).max(1e-6 * r);
        let at = |t: f64| self.scattered_at(t, x, y);
        graded(off, nearest, |t| at(nearest - t))
            + graded(off, LENGTH * self.medium.mfp(), |t| at(nearest + t))
    }

    /// Light scattered at the length t, once or more often.
    fn scattered_at(&self, t: f64, x: f64, y: f64) -> f64 {
        let (sigma_s, sigma_t) = (self.medium.sigma_s(), self.medium.sigma_t());
        let (alpha, d) = (sigma_s / sigma_t, self.medium.diffusion_coefficient());
        let (s, z_b) = ((self.medium.sigma_a() / d).sqrt(), 2.0 * d);

        let z = t * self.direction[1];
        let across = (x - t * self.direction[0]).hypot(y);
        let (d_r, d_v) = (across.hypot(z), across.hypot(z + 2.0 * z_b));

        let fluence = (-s * d_r).exp() / d_r - (-s * d_v).exp() / d_v;
        let flux = |z: f64, d: f64| z * (1.0 + s * d) * (-s * d).exp() / d.powi(3);
        let kappa = -(-2.0 * sigma_t * (t + d_r)).exp_m1();
        let multiple =
            alpha * kappa * (fluence / (4.0 * d) + 0.5 * (flux(z, d_r) + flux(z + 2.0 * z_b, d_v)));
        let single = (-sigma_t * d_r).exp() * z / d_r.powi(3);
        sigma_s * (-sigma_t * t).exp() * (multiple + single) / (4.0 * PI)
    }
}

/// ∫₀^end f over panels that double in size from the smallest scale on.
fn graded(smallest: f64, end: f64, f: impl Fn(f64) -> f64) -> f64 {
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(16));
    let (mut from, mut size, mut sum) = (0.0, smallest, 0.0);
    while from < end {
        let to = (from + size).min(end);
        sum += integrate(&RULE, from, to, &f);
        (from, size) = (to, 2.0 * size);
    }
    sum
}
