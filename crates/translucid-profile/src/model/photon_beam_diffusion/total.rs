//! Surface albedo by multiple scattering: what dipoles along a beam send out in all.
//!
//! Without κ each dipole's energy is elementary (e^{−s d}/d integrates to 2π e^{−s z}/s over the plane), and so
//! is its integral over the beam. Of κ's e^{−2(t + d_r)} the real source leaves elementary functions and an
//! exponential integral, whose integral over the beam is elementary again; the virtual source leaves a double
//! integral without any singularity, in polar coordinates about the exit.

use std::sync::LazyLock;

use super::beam_dipole::{BeamDipole, UnitRule, dot};
use crate::math::elementary::{Double, exp_negative};
use crate::math::slices::{Elementwise, map_slice};

/// Points of the double integral.
const POINTS: [usize; 2] = [36, 16];
/// Points of the inner integral for an oblique beam, which has e^{−3z/cos θ}.
const OBLIQUE_POINTS: usize = 32;
/// How many virtual sources a total takes.
pub(super) const TOTAL_POINTS: u32 = (POINTS[0] * POINTS[1]) as u32;
/// e^{−2ρ} is 1e-15 there.
const RHO_MAX: f64 = 17.0;
/// And this far e^{−x} is followed.
const EXPONENT_MAX: f64 = 36.0;

impl BeamDipole {
    /// ∫ R over the plane, for a beam of the cosine given inside.
    pub(super) fn total(&self, cos_theta: f64) -> f64 {
        let BeamDipole { sigma_tr: s, z_b, fluence_weight, flux_weight, .. } = *self;
        let (fades, faded) = exp_negative::<Double>(2.0 * s * z_b);
        let fluence = if s * z_b > 1e-200 { faded / s } else { 2.0 * z_b };
        let without_kappa = (fluence_weight * fluence + flux_weight * (1.0 + fades)) / (1.0 + s * cos_theta);

        // ∫ e^{−3t} over the real source, where ∫ (1 + s d) e^{−(s+2)d}/d² dd = e^{−(s+2)z}/z − 2 E₁((s+2)z)
        let b = (s + 2.0) * cos_theta;
        let exponential_integral = (3.0 / b).ln_1p() / 9.0 - 1.0 / (3.0 * (3.0 + b));
        let real = fluence_weight / ((s + 2.0) * (3.0 + b))
            + flux_weight * (1.0 / (3.0 + b) - 2.0 * cos_theta * exponential_integral);
        0.5 * self.alpha_squared * (without_kappa - real - self.virtual_part(cos_theta))
    }

    /// ∫∫ e^{−3t − 2d_r} {C_E (z + 2z_b)(1 + s d_v) e^{−s d_v}/d_v³ − C_φ/D e^{−s d_v}/d_v} r dr dt with d_r =
    /// ρ, z = ρμ: r dr dz = ρ² dρ dμ.
    fn virtual_part(&self, cos_theta: f64) -> f64 {
        static RULES: LazyLock<[UnitRule; 3]> =
            LazyLock::new(|| [POINTS[0], POINTS[1], OBLIQUE_POINTS].map(UnitRule::new));
        let [outer, inner, inner_oblique] = &*RULES;
        let inner = if cos_theta < 1.0 { inner_oblique } else { inner };
        let mut terms = [0.0; OBLIQUE_POINTS];
        let terms = &mut terms[..inner.positions.len()];
        let mut sum = 0.0;
        for (x, weight) in outer.positions.iter().zip(&outer.weights) {
            // ρ = ρ_max x², since ρ counts near 0
            let rho = RHO_MAX * x * x;
            let mu_max = (EXPONENT_MAX * cos_theta / (3.0 * rho)).min(1.0);
            map_slice(&inner.positions, terms, VirtualSources { dipole: *self, rho, mu_max, cos_theta });
            sum += weight * 2.0 * x * RHO_MAX * rho * rho * mu_max * dot(&inner.weights, terms);
        }
        sum / cos_theta
    }
}

/// The virtual sources whose real ones are ρ away from the exit, over μ/μ_max.
struct VirtualSources {
    dipole: BeamDipole,
    rho: f64,
    mu_max: f64,
    cos_theta: f64,
}

impl Elementwise<f64> for VirtualSources {
    #[inline(always)]
    fn at(&self, x: f64) -> f64 {
        let Self { dipole, rho, mu_max, cos_theta } = *self;
        let BeamDipole { sigma_tr: s, z_b, fluence_weight, flux_weight, .. } = dipole;
        let z = rho * (mu_max * x);
        let height = z + 2.0 * z_b;
        let d_v = (rho * rho + 4.0 * z_b * (z + z_b)).sqrt();
        let (arrives, _) = exp_negative::<Double>(2.0 * rho + 3.0 * z / cos_theta + s * d_v);
        let inverse = 1.0 / d_v;
        let flux = height * (1.0 + s * d_v) * (inverse * inverse);
        arrives * inverse * (flux_weight * flux - fluence_weight)
    }
}
