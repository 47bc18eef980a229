//! The directional dipole for light along the normal: a radial profile, and its energy.

use std::f64::consts::PI;

use crate::Profile;
use crate::error::ParameterError;
use crate::math::elementary::{Double, exp_negative};
use crate::math::quadrature::{integrate, shared_gauss_legendre};
use crate::medium::diffusion_boundary::DiffusionBoundary;
use crate::model::directional_dipole::kernel::{D, Falloff, Kernel};
use crate::model::directional_dipole::{DirectionalDipole, find_medium};
use crate::{Appearance, Medium};

/// Profile of the [`DirectionalDipole`] for light along the normal of a plane, where it does not depend on the
/// azimuth.
///
/// ```text
/// R(r) = α'/4π {C_φ/D (E_r/d_r − E_v/d_v) + C_E P_r + 3C_φ h P_v + C_E [(1 + h) P_v − h² (3P_v + σ²E_v/d_v)/d_v²]}
/// E = e^{−σd},  P = (1 + σd) E/d³,  d_r² = r² + D² + 2D d_E r/√(r² + d_E²),  d_v² = r² + h²     (lengths in 1/σ'_t)
/// ```
///
/// It is positive everywhere: nothing is cut off. At r = 0 it has a finite value.
/// The energy within a radius has a closed form but for one smooth integral, taken to rounding.
///
/// ```
/// use translucid_profile::{Appearance, DirectionalDipoleAverage, Parameterization, Profile};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let appearance =
///     Appearance { surface_albedo: 0.8, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
/// let profile = DirectionalDipoleAverage::new(&appearance, 1.4)?;
/// assert!((profile.surface_albedo() - 0.8).abs() < 1e-12);
/// assert!((profile.enclosed(1.0) + profile.beyond(1.0) - 0.8).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionalDipoleAverage {
    dipole: DirectionalDipole,
    beam: NormalBeam,
    total: f64,
}

impl DirectionalDipoleAverage {
    /// The profile of a medium under a boundary of η = n_inside/n_outside ∈ [0.05, 20].
    ///
    /// # Errors
    /// η is out of its range.
    pub fn from_medium(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        Ok(Self::of(&DirectionalDipole::from_medium(medium, eta)?))
    }

    /// The profile whose total is a surface albedo A ∈ [0, 1], for η ∈ [0.05, 20].
    ///
    /// # Errors
    /// A parameter is out of its range.
    pub fn new(appearance: &Appearance, eta: f64) -> Result<Self, ParameterError> {
        Self::from_medium(&find_medium(appearance, eta)?, eta)
    }

    /// The profile of a directional dipole.
    pub fn of(dipole: &DirectionalDipole) -> Self {
        let beam = NormalBeam { kernel: *dipole.kernel() };
        let total = beam.kernel.strength * beam.beyond(0.0);
        Self { dipole: *dipole, beam, total }
    }

    /// The directional dipole that this is the profile of.
    pub fn dipole(&self) -> &DirectionalDipole {
        &self.dipole
    }

    /// r in transport mean free paths.
    fn relative(&self, r: f64) -> f64 {
        (r.max(0.0) * self.beam.kernel.sigma_t_prime).min(RADIUS_MAX)
    }
}

impl Profile for DirectionalDipoleAverage {
    fn eval_times_r(&self, r: f64) -> f64 {
        let Kernel { strength, sigma_t_prime, .. } = self.beam.kernel;
        let r = self.relative(r);
        strength / (4.0 * PI) * (r * self.beam.eval(r)) * sigma_t_prime
    }

    fn eval(&self, r: f64) -> f64 {
        let Kernel { strength, sigma_t_prime, .. } = self.beam.kernel;
        let relative = strength / (4.0 * PI) * self.beam.eval(self.relative(r));
        (relative * sigma_t_prime * sigma_t_prime).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        let r = self.relative(r);
        if r > 1.0 {
            self.total - self.beam.kernel.strength * self.beam.beyond(r)
        } else {
            self.beam.kernel.strength * self.beam.enclosed_near(r)
        }
    }

    fn beyond(&self, r: f64) -> f64 {
        self.beam.kernel.strength * self.beam.beyond(self.relative(r))
    }

    /// It rises from 0 with α', and goes beyond 1 as [`DirectionalDipole`] says.
    fn surface_albedo(&self) -> f64 {
        self.total
    }

    fn scale(&self) -> f64 {
        (1.0 / self.beam.kernel.sigma_t_prime).min(f64::MAX)
    }
}

/// Radii in transport mean free paths beyond which all are the same.
const RADIUS_MAX: f64 = 1e60;
/// Points of the Gauss–Legendre rule on each panel.
const POINTS: usize = 16;

/// Profile and energies for normal incidence, in transport mean free paths and per strength of the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NormalBeam {
    pub(crate) kernel: Kernel,
}

impl NormalBeam {
    /// Energy of a medium with 1 − α' = `absorbed`, per strength of its source.
    pub(crate) fn total_per_strength(absorbed: f64, eta: f64) -> Result<f64, ParameterError> {
        let boundary = DiffusionBoundary::new(eta)?;
        let kernel = Kernel::new([absorbed, 1.0 - absorbed], 1.0, 1.0, 1.0, boundary, eta);
        Ok(Self { kernel }.beyond(0.0))
    }

    /// 4πR.
    #[inline(always)]
    pub(crate) fn eval(&self, r: f64) -> f64 {
        let Kernel {
            boundary: DiffusionBoundary { fluence: c_phi, flux: c_e, .. },
            sigma_tr: sigma,
            mirror: h,
            ..
        } = self.kernel;
        let [d_r, d_v, gap] = self.distances(r);
        let (e_r, _) = exp_negative::<Double>(sigma * d_r);
        let (more, less) = exp_negative::<Double>(sigma * gap);
        let real = Falloff::new(sigma, d_r, e_r);
        let image = Falloff::new(sigma, d_v, e_r * more);
        let quadrupole = (3.0 * image.p + sigma * sigma * image.e_over_d) * (h * image.inverse).powi(2);
        c_phi / D * e_r * (gap * real.inverse + less) * image.inverse
            + c_e * real.p
            + 3.0 * c_phi * h * image.p
            + c_e * ((1.0 + h) * image.p - quadrupole)
    }

    /// d_r, d_v and d_v − d_r.
    #[inline(always)]
    fn distances(&self, r: f64) -> [f64; 3] {
        let Kernel { extrapolation: d_e, mirror: h, .. } = self.kernel;
        let z2 = D * (D + 2.0 * d_e * r / (r * r + d_e * d_e).sqrt());
        let (d_r, d_v) = ((r * r + z2).sqrt(), (r * r + h * h).sqrt());
        [d_r, d_v, (h * h - z2) / (d_v + d_r)]
    }

    /// Energy beyond r.
    ///
    /// With u = d_r and w = r/√(r² + d_E²), r dr is u du − D d_E dw: the first part has an antiderivative, and the
    /// second is smooth and falls fast.
    pub(crate) fn beyond(&self, r: f64) -> f64 {
        let Kernel {
            boundary: DiffusionBoundary { fluence: c_phi, flux: c_e, .. },
            sigma_tr: sigma,
            mirror: h,
            ..
        } = self.kernel;
        let [d_r, d_v, gap] = self.distances(r);
        let (e_r, _) = exp_negative::<Double>(sigma * d_r);
        let (more, less) = exp_negative::<Double>(sigma * gap);
        let real = Falloff::new(sigma, d_r, e_r);
        let image = Falloff::new(sigma, d_v, e_r * more);
        let monopoles = e_r * if sigma > 0.0 { less / sigma } else { gap };
        let closed = c_phi / D * monopoles
            + c_e * real.e_over_d
            + 3.0 * c_phi * h * image.e_over_d
            + c_e * ((1.0 + h) * image.e_over_d - h * h * image.p);
        (0.5 * (closed - self.correction(r))).max(0.0)
    }

    /// Energy within r ≤ 1, with the digits of a small r.
    fn enclosed_near(&self, r: f64) -> f64 {
        let (rule, middle) = (shared_gauss_legendre(POINTS), r.min(D));
        let ring = |r: f64| 0.5 * r * self.eval(r);
        integrate(rule, 0.0, middle, ring) + integrate(rule, middle, r, ring)
    }

    /// D d_E ∫_r^∞ [C_φ E/(D u) + 3D C_E P] dw.
    fn correction(&self, from: f64) -> f64 {
        let rule = shared_gauss_legendre(POINTS);
        self.panels(from).map(|[a, b]| integrate(rule, a, b, |r| self.correction_per_length(r))).sum()
    }

    /// The integrand of the correction over the radius.
    fn correction_per_length(&self, r: f64) -> f64 {
        let Kernel {
            boundary: DiffusionBoundary { fluence: c_phi, flux: c_e, .. },
            sigma_tr: sigma,
            extrapolation: d_e,
            ..
        } = self.kernel;
        let [u, ..] = self.distances(r);
        let falloff = Falloff::new(sigma, u, exp_negative::<Double>(sigma * u).0);
        let narrow = d_e / (r * r + d_e * d_e).sqrt();
        D * (narrow * narrow * narrow) * (c_phi / D * falloff.e_over_d + c_e * falloff.p)
    }

    /// Intervals from a radius on, on each of which the correction is smooth.
    ///
    /// It is singular at −D, wherefore they are no longer than twice the way there, which leaves 5e-19 of what 16 points
    /// see; and it falls like r⁻⁴ or like an exponential, wherefore they end: where e^{−σ(r − from)} is rounding, and
    /// where e^{−σr} is no number.
    fn panels(&self, from: f64) -> impl Iterator<Item = [f64; 2]> {
        let sigma = self.kernel.sigma_tr;
        let far = 1e6 * from.max(1.0);
        let next = move |[_, a]: &[f64; 2]| Some([*a, a + (2.0 * (a + D)).min(8.0 / sigma)]);
        std::iter::successors(next(&[from, from]), next)
            .take_while(move |[a, _]| *a < far && sigma * (a - from) < 40.0 && sigma * a < 750.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameterization;

    const ALPHAS: [f64; 9] = [0.0, 1e-9, 0.1, 0.5, 0.9, 0.99, 0.9999, 1.0 - 1e-12, 1.0];
    const ETAS: [f64; 8] = [0.05, 0.5, 0.8, 1.0, 1.33, 1.5, 3.0, 20.0];

    fn profile(alpha: f64, eta: f64) -> DirectionalDipoleAverage {
        DirectionalDipoleAverage::from_medium(&Medium::from_mfp(alpha, 1.0, 0.0).unwrap(), eta).unwrap()
    }

    /// The whole model at normal incidence on a plane.
    #[test]
    fn eval_is_the_dipole_along_the_normal() {
        let up = [0.0, 0.0, 1.0];
        for alpha in ALPHAS {
            for eta in ETAS {
                let p = profile(alpha, eta);
                for r in [1e-9, 0.01, 0.3, 1.0, 7.0, 100.0] {
                    let expected = p.dipole().eval_unclamped([0.6 * r, -0.8 * r, 0.0], up, up, up);
                    let found = p.eval(r);
                    assert!(
                        (found - expected).abs() <= 1e-13 * expected,
                        "{alpha} {eta} {r}: {found} {expected}"
                    );
                }
            }
        }
    }

    /// So the cut does nothing, and the antiderivatives hold.
    #[test]
    fn eval_is_positive() {
        for alpha in ALPHAS {
            for eta in ETAS {
                let p = profile(alpha.max(1e-9), eta);
                for i in 0..3000 {
                    let r = 10f64.powf(f64::from(i) / 200.0 - 8.0);
                    let sigma_tr = p.beam.kernel.sigma_tr;
                    assert!(p.eval(r) > 0.0 || sigma_tr * r > 700.0, "{alpha} {eta} {r}");
                }
            }
        }
    }

    #[test]
    fn total_is_the_integral_of_eval() {
        for alpha in ALPHAS {
            for eta in ETAS {
                let p = profile(alpha, eta);
                // Trapezoidal rule in ln r; beyond 1e12 R goes on like r⁻³ where nothing absorbs
                let (step, end) = (0.05, 1e12f64);
                let count = ((end / 1e-9).ln() / step) as i32;
                let sum: f64 = (0..=count)
                    .map(|i| {
                        let r = end * (-step * f64::from(i)).exp();
                        let weight = if i == 0 { 0.5 } else { 1.0 };
                        weight * 2.0 * PI * r * p.eval_times_r(r) * step
                    })
                    .sum();
                let found = sum + p.beyond(end);
                assert!(
                    (found - p.surface_albedo()).abs() < 1e-10,
                    "{alpha} {eta}: {found} {}",
                    p.surface_albedo()
                );
            }
        }
    }

    #[test]
    fn enclosed_and_beyond_are_integrals_of_eval() {
        let rule = shared_gauss_legendre(20);
        for alpha in [0.1, 0.9, 0.999, 1.0] {
            for eta in [0.8, 1.0, 1.4] {
                let p = profile(alpha, eta);
                for (a, b) in [(0.0, 1e-6), (0.1, 0.2), (0.9, 1.1), (2.0, 3.0), (20.0, 22.0), (1e4, 1.1e4)] {
                    let expected = integrate(rule, a, b, |r| 2.0 * PI * p.eval_times_r(r));
                    let (inner, outer) = (p.enclosed(b) - p.enclosed(a), p.beyond(a) - p.beyond(b));
                    assert!(
                        (inner - expected).abs() < 1e-14 + 1e-13 * expected,
                        "{alpha} {eta} {a}: {inner} {expected}"
                    );
                    assert!(
                        (outer - expected).abs() < 4e-15 + 1e-12 * expected,
                        "{alpha} {eta} {a}: {outer} {expected}"
                    );
                    // With the digits of a small and of a large radius
                    if a == 0.0 {
                        assert!((inner / expected - 1.0).abs() < 1e-12, "{alpha} {eta}: {inner} {expected}");
                    }
                    if a > 10.0 {
                        assert!(
                            (outer / expected - 1.0).abs() < 1e-8 || expected < 1e-300,
                            "{alpha} {eta} {a}: {outer} {expected}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn total_rises_with_the_albedo_beyond_1() {
        for eta in ETAS {
            let mut last = -1.0;
            for i in 0..=400 {
                let root = 1.0 - f64::from(i) / 400.0;
                let (absorbed, one) =
                    (root * root, Medium::new(root * root, 1.0 - root * root, 0.0).unwrap());
                let total = DirectionalDipoleAverage::from_medium(&one, eta).unwrap().surface_albedo();
                assert!(total > last, "{eta} {absorbed}: {total} {last}");
                last = total;
            }
            assert!(last > 1.0, "{eta}: {last}");
        }
        // Without the factor α' a black medium returns a fifth
        let black = DirectionalDipole::as_published(&Medium::new(1.0, 0.0, 0.0).unwrap(), 1.0).unwrap();
        assert!((DirectionalDipoleAverage::of(&black).surface_albedo() - 0.21052).abs() < 1e-5);
        // Of a beam along the normal, in media without absorption, and with 0.1 of it
        for (alpha, eta, expected) in
            [(1.0, 1.0, 1.33947), (1.0, 1.4, 1.21615), (0.9, 1.0, 0.63847), (0.9, 1.4, 0.37155)]
        {
            let found = profile(alpha, eta).surface_albedo();
            assert!((found - expected).abs() < 1e-5, "{alpha} {eta}: {found}");
        }
    }

    #[test]
    fn new_has_the_surface_albedo() {
        for a in [0.0, 1e-12, 1e-6, 0.01, 0.3, 0.8, 0.99, 1.0] {
            for eta in ETAS {
                for parameterization in [Parameterization::Mfp, Parameterization::Dmfp] {
                    for (length, g) in [(1e-100, 0.0), (1.0, 0.9), (1e100, -0.5)] {
                        let appearance = Appearance { surface_albedo: a, length, parameterization, g };
                        let p = DirectionalDipoleAverage::new(&appearance, eta).unwrap();
                        assert!((p.surface_albedo() - a).abs() < 1e-12, "{a} {eta}: {}", p.surface_albedo());
                    }
                }
            }
        }
    }

    #[test]
    fn every_method_is_finite_for_any_argument() {
        for (alpha, length) in [(0.0, 1e-150), (1.0, 1e-150), (0.5, 1.0), (1.0, 1e150), (1e-300, 1e150)] {
            for g in [-1.0 + 1e-15, 0.0, 1.0 - 1e-15] {
                let medium = Medium::from_mfp(alpha, length, g).unwrap();
                let p = DirectionalDipoleAverage::from_medium(&medium, 1.4).unwrap();
                for r in [f64::NAN, -1.0, 0.0, 5e-324, 1e-150, 1e-3, 1.0, 1e3, 1e150, f64::MAX, f64::INFINITY]
                {
                    for value in [
                        p.eval(r),
                        p.eval_times_r(r),
                        p.enclosed(r),
                        p.beyond(r),
                        p.scale(),
                        p.surface_albedo(),
                    ] {
                        assert!(value.is_finite() && value >= 0.0, "{alpha} {length} {g} {r}: {value}");
                    }
                }
            }
        }
    }
}
