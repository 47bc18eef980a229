//! The profile of an oblique beam between single-precision arguments and results, for the inner loop of a renderer.
//!
//! The formulas are those of [`ObliqueDiffusion`](crate::ObliqueDiffusion), in `f64` registers with short polynomials.

use std::f64::consts::PI;

use crate::error::{ParameterError, require_positive};
use crate::math::elementary::Single;
use crate::medium::scaling::mfp_per_dmfp;
use crate::model::oblique::kernel::{Family, Way, means_above};
use crate::{Configuration, Parameterization};

/// Least length that the arithmetic holds.
const LENGTH_MIN: f32 = 1e-18;
/// Greatest length that the arithmetic holds.
const LENGTH_MAX: f32 = 1e18;

/// Profiles of oblique light of every surface albedo, length and direction, for one boundary.
///
/// ```
/// use translucid_profile::{Configuration, ObliqueDiffusionTable, Parameterization};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let table = ObliqueDiffusionTable::new(1.0, Parameterization::Mfp, Configuration::Diffuse)?;
/// let profile = table.at(0.8, 2.0); // at one point of a texture
/// let up = [0.0, 0.0, 1.0];
/// let ahead = profile.eval([1.0, 0.0, 0.0], [-0.6, 0.0, 0.8], up);
/// let behind = profile.eval([-1.0, 0.0, 0.0], [-0.6, 0.0, 0.8], up);
/// assert!(ahead > 2.0 * behind);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObliqueDiffusionTable {
    eta: f64,
    parameterization: Parameterization,
    configuration: Configuration,
    /// Means of the energy's functions over diffuse light that was refracted.
    means: [f64; 3],
}

impl ObliqueDiffusionTable {
    /// For a boundary of η = n_inside/n_outside > 0 that refracts light on its way in.
    ///
    /// It is not in the profile otherwise: like all of normalized diffusion that is made for η = 1. The albedo of
    /// diffuse light is that of diffuse light outside, which the boundary keeps from grazing inside.
    ///
    /// # Errors
    /// η is not finite and greater than 0.
    pub fn new(
        eta: f64,
        parameterization: Parameterization,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        require_positive("eta", eta)?;
        // sin θ = 1/η bounds the cone of refracted light
        let least = ((1.0 - 1.0 / eta) * (1.0 + 1.0 / eta)).max(0.0).sqrt().min(1.0 - 1e-6);
        Ok(Self { eta, parameterization, configuration, means: means_above(least) })
    }

    /// The table for a shader: 1 for a searchlight, 1 for a diffuse mean free path, three means of the energy's functions, η.
    #[doc(hidden)]
    pub fn words(&self) -> [f32; 6] {
        let is_searchlight = u8::from(self.configuration == Configuration::Searchlight);
        let is_dmfp = u8::from(self.parameterization == Parameterization::Dmfp);
        let [a, b, c] = self.means;
        [is_searchlight.into(), is_dmfp.into(), a, b, c, self.eta].map(|word: f64| word as f32)
    }

    /// The profiles of a surface albedo A ∈ \[0, 1\] and a length \[L\].
    ///
    /// The albedo is clamped to \[0, 1\], with a diffuse mean free path below 1, and the length to \[1e-18, 1e18\]; NaN
    /// counts as the least.
    #[inline]
    pub fn at(&self, surface_albedo: f32, length: f32) -> ObliqueDiffusionF32 {
        let surface_albedo = f64::from(surface_albedo.max(0.0).min(1.0));
        let length = f64::from(length.max(LENGTH_MIN).min(LENGTH_MAX));
        let mfp = match self.parameterization {
            Parameterization::Mfp => length,
            Parameterization::Dmfp => {
                length * mfp_per_dmfp(surface_albedo.min(1.0 - 1e-7), self.configuration)
            }
        };
        ObliqueDiffusionF32 {
            family: Family::new(surface_albedo, self.configuration, self.means),
            sigma_t: 1.0 / mfp,
            eta: self.eta,
        }
    }
}

/// Profiles of oblique light of one surface albedo and length.
///
/// For the same arguments they lie within a relative 2e-6 of their [`f64` twin](crate::ObliqueDiffusion), but for the
/// rounding of the arguments. No argument gives a NaN or an infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObliqueDiffusionF32 {
    family: Family,
    /// 1/ℓ \[L⁻¹\].
    sigma_t: f64,
    eta: f64,
}

impl ObliqueDiffusionF32 {
    /// R(x_o − x_i; ω_i) \[L⁻²\], exitance at x_o per unit of flux that entered at x_i.
    ///
    /// `offset` is x_o − x_i; ω_i points from x_i to where the light comes from, outside, and n_i is the surface's
    /// normal at x_i, outwards; both of unit length.
    /// Where the surface is not flat, r is the length of the offset, of which the part q lies along the surface at x_i,
    /// and each term's density of the azimuth becomes √(1 − q² sin² θ_k)/(1 − q sin θ_k cos φ): light from everywhere
    /// keeps its energy for any q. Light from below the surface, or beyond total reflection, gives 0.
    #[inline]
    pub fn eval(&self, offset: [f32; 3], omega_i: [f32; 3], n_i: [f32; 3]) -> f32 {
        let r = length(offset.map(f64::from)).max(f64::from(f32::MIN_POSITIVE));
        (self.times_r(offset, omega_i, n_i) / r).min(f64::from(f32::MAX)) as f32
    }

    /// r R(x_o − x_i; ω_i) \[L⁻¹\], as [`eval`](Self::eval), which has a limit at r = 0 for each azimuth; at r = 0 itself
    /// that of φ = 90°.
    #[inline]
    pub fn eval_times_r(&self, offset: [f32; 3], omega_i: [f32; 3], n_i: [f32; 3]) -> f32 {
        self.times_r(offset, omega_i, n_i).min(f64::from(f32::MAX)) as f32
    }

    #[inline(always)]
    fn times_r(&self, offset: [f32; 3], omega_i: [f32; 3], n_i: [f32; 3]) -> f64 {
        let [offset, omega, normal] = [offset, omega_i, n_i].map(|v| v.map(f64::from));
        let cos_outside = dot(omega, normal).min(1.0);
        // A NaN is no light either
        if cos_outside <= 0.0 || cos_outside.is_nan() {
            return 0.0;
        }
        let onward: [f64; 3] = std::array::from_fn(|i| cos_outside * normal[i] - omega[i]);
        let sin_outside = length(onward);
        let sin_theta = sin_outside / self.eta;
        if sin_theta >= 1.0 || sin_theta.is_nan() {
            return 0.0;
        }
        let cos_theta = ((1.0 - sin_theta) * (1.0 + sin_theta)).sqrt();
        let r = length(offset);
        let r = if r.is_finite() { r } else { f64::MAX };
        let terms = self.family.terms(cos_theta);
        let density = terms.pdf_times_turn::<Single>(
            r * self.sigma_t,
            Way {
                versine: 1.0 - share(dot(offset, onward), r * sin_outside),
                lift: share(dot(offset, normal), r).powi(2),
            },
        );
        self.family.total(cos_theta) * self.sigma_t * density / (2.0 * PI)
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Part of a whole, in [−1, 1]; 0 at the entry, and for light along the normal, where no azimuth is another.
fn share(part: f64, whole: f64) -> f64 {
    let share = part / whole;
    if share.is_finite() { share.max(-1.0).min(1.0) } else { 0.0 }
}

fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ObliqueDiffusion;
    use crate::math::quadrature::{gauss_legendre, integrate};

    const UP: [f32; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn eval_agrees_with_its_twin() {
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            for parameterization in [Parameterization::Mfp, Parameterization::Dmfp] {
                let table = ObliqueDiffusionTable::new(1.0, parameterization, configuration).unwrap();
                for a in [0.01f32, 0.25, 0.75, 0.98] {
                    for sin in [0.0f32, 0.28, 0.6, 0.96, 0.999] {
                        let cos_theta = (1.0 - f64::from(sin) * f64::from(sin)).sqrt();
                        let twin =
                            ObliqueDiffusion::new(a.into(), 2.0, parameterization, configuration, cos_theta)
                                .unwrap();
                        for (r, phi) in [(1e-6f64, 1.0f64), (0.3, 0.0), (1.0, 3.0), (8.0, 2.0)] {
                            let offset = [r * phi.cos(), r * phi.sin(), 0.0].map(|x| x as f32);
                            let found = table.at(a, 2.0).eval(offset, [-sin, 0.0, cos_theta as f32], UP);
                            let expected = twin.eval(r, phi);
                            // The rounding of directions weighs most where light grazes
                            let tolerance = if sin > 0.99 { 1e-4 } else { 3e-6 };
                            assert!(
                                (f64::from(found) / expected - 1.0).abs() < tolerance,
                                "{a} {sin} {r} {phi}: {found} {expected}"
                            );
                        }
                    }
                }
            }
        }
    }

    /// Diffuse light returns A whatever the boundary.
    #[test]
    fn diffuse_light_returns_surface_albedo() {
        let rule = gauss_legendre(60);
        for eta in [0.8, 1.0, 1.4, 3.0] {
            let table =
                ObliqueDiffusionTable::new(eta, Parameterization::Mfp, Configuration::Diffuse).unwrap();
            for a in [0.1f32, 0.8] {
                let family = table.at(a, 1.0).family;
                // Over the cosine inside, whose light is as diffuse in its cone as that outside
                let least = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
                let at = |w: f64| {
                    let mu = least + (1.0 - least) * w.powi(3);
                    6.0 * w * w * (1.0 - least) * mu * family.total(mu)
                };
                let found = integrate(&rule, 0.0, 1.0, at) / (1.0 - least * least);
                assert!((found - f64::from(a)).abs() < 1e-10, "{eta} {a}: {found}");
            }
        }
    }

    /// Light from all azimuths brings as much to any point at a distance, on the surface or not.
    #[test]
    fn curved_surfaces_keep_energy() {
        let table = ObliqueDiffusionTable::new(1.0, Parameterization::Mfp, Configuration::Diffuse).unwrap();
        for (a, cos) in [(0.2f32, 0.3f32), (0.9, 0.6)] {
            let profile = table.at(a, 1.0);
            let mean = |offset: [f32; 3]| {
                let sin = (1.0 - cos * cos).sqrt();
                let from = |i: i32| {
                    let (y, x) = (f64::from(i) * PI / 300.0).sin_cos();
                    f64::from(profile.eval(offset, [sin * x as f32, sin * y as f32, cos], UP))
                };
                (0..600).map(from).sum::<f64>() / 600.0
            };
            let on_plane = mean([0.7, 0.0, 0.0]);
            for up in [0.0f32, 0.3, -0.5, 0.7, -0.7] {
                let found = mean([(0.49 - up * up).sqrt(), 0.0, up]);
                assert!((found / on_plane - 1.0).abs() < 1e-5, "{a} {cos} {up}: {found} {on_plane}");
            }
        }
    }

    #[test]
    fn light_that_does_not_enter_gives_nothing() {
        let at = |eta, sin: f32| {
            let table =
                ObliqueDiffusionTable::new(eta, Parameterization::Mfp, Configuration::Diffuse).unwrap();
            let cos = (1.0 - sin * sin).sqrt();
            [cos, -cos].map(|cos| table.at(0.5, 1.0).eval([1.0, 0.0, 0.0], [sin, 0.0, cos], UP))
        };
        assert!(at(1.4, 0.9)[0] > 0.0 && at(0.8, 0.79)[0] > 0.0);
        assert_eq!(at(1.4, 0.9)[1], 0.0);
        assert_eq!(at(0.8, 0.81)[0], 0.0); // total reflection
    }

    #[test]
    fn eval_is_finite_for_any_argument() {
        let specials = [0.0, -1.0, 1.0, f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e-45, 0.3];
        for eta in [1e-3, 0.8, 1.0, 1e9] {
            for parameterization in [Parameterization::Mfp, Parameterization::Dmfp] {
                let table =
                    ObliqueDiffusionTable::new(eta, parameterization, Configuration::Searchlight).unwrap();
                let mut state = 1u32;
                let mut any = || {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    specials[(state >> 16) as usize % specials.len()]
                };
                for _ in 0..100_000 {
                    let profile = table.at(any(), any());
                    let [offset, omega, normal] = [(); 3].map(|()| [any(), any(), any()]);
                    let found = profile.eval(offset, omega, normal);
                    assert!(found.is_finite() && found >= 0.0, "{profile:?} {offset:?} {omega:?} {normal:?}");
                }
            }
        }
        assert!(ObliqueDiffusionTable::new(0.0, Parameterization::Mfp, Configuration::Diffuse).is_err());
    }
}
