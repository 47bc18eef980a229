//! The directional dipole between single-precision arguments and results, for the inner loop of a renderer.
//!
//! The formulas are those of [`DirectionalDipole`], which explains them, and so is the arithmetic: it runs in
//! `f64` registers with short polynomials, as single precision would not hold the inverse cubes of small
//! distances.

use crate::error::{ParameterError, require};
use crate::math::elementary::Single;
use crate::medium::diffusion_boundary::DiffusionBoundary;
use crate::model::directional_dipole::average::NormalBeam;
use crate::model::directional_dipole::kernel::Kernel;
use crate::model::directional_dipole::{DirectionalDipole, find_medium};
use crate::{Appearance, Parameterization};

/// Least length that the arithmetic holds.
const LENGTH_MIN: f32 = 1e-18;
/// Greatest length that the arithmetic holds.
const LENGTH_MAX: f32 = 1e18;
/// Intervals of √A: the root finder's answers vary fastest where A is small.
const INTERVALS: usize = 192;

/// The directional dipole in single precision.
///
/// For the same arguments it lies within a relative 1e-7 of its [`f64` twin](DirectionalDipole); where terms of
/// the sum cancel, within 1e-9 of R along the normal at the same distance. No argument gives a NaN or an infinity.
/// An evaluation takes some 70 ns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalDipoleF32 {
    kernel: Kernel,
}

impl From<&DirectionalDipole> for DirectionalDipoleF32 {
    fn from(dipole: &DirectionalDipole) -> Self {
        Self { kernel: *dipole.kernel() }
    }
}

impl DirectionalDipoleF32 {
    /// R(x_o − x_i; ω_i) \[L⁻²\], exitance at x_o per unit of flux that entered at x_i; see
    /// [`DirectionalDipole::eval`].
    #[inline]
    pub fn eval(&self, offset: [f32; 3], omega_i: [f32; 3], n_i: [f32; 3], n_o: [f32; 3]) -> f32 {
        let [offset, omega_i, n_i, n_o] = [offset, omega_i, n_i, n_o].map(|v| v.map(f64::from));
        let r = self.kernel.unclamped::<Single>(offset, omega_i, n_i, n_o);
        r.max(0.0).min(f64::from(f32::MAX)) as f32
    }

    /// Transport mean free path ℓ* \[L\], the length on which R varies.
    #[inline]
    pub fn transport_mfp(&self) -> f32 {
        (1.0 / self.kernel.sigma_t_prime).min(f64::from(f32::MAX)) as f32
    }
}

/// Directional dipoles of every surface albedo and length, for one boundary and phase function.
///
/// The table holds the media that [`DirectionalDipole::new`] finds by a root finder, over the surface albedo; making it
/// takes some milliseconds. For η from 0.5 to 1.5 √(1 − α') is off by at most 1e-7, and α' by 3e-7 of itself; up to η = 3 by
/// 4e-7 and 1.3e-6.
///
/// ```
/// use translucid_profile::{DirectionalDipoleTable, Parameterization};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let table = DirectionalDipoleTable::new(1.4, 0.0, Parameterization::Mfp)?;
/// let dipole = table.at(0.8, 2.0); // at one point of a texture
/// let up = [0.0, 0.0, 1.0];
/// let ahead = dipole.eval([1.0, 0.0, 0.0], [-0.6, 0.0, 0.8], up, up);
/// let behind = dipole.eval([-1.0, 0.0, 0.0], [-0.6, 0.0, 0.8], up, up);
/// assert!(ahead > behind);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionalDipoleTable {
    boundary: DiffusionBoundary,
    eta: f64,
    g: f64,
    parameterization: Parameterization,
    /// √(1 − α') and α'/A over each interval, as cubics in its own coordinate from 0 to 1.
    cubics: Vec<[[f64; 4]; 2]>,
}

impl DirectionalDipoleTable {
    /// The table of a boundary η = n_inside/n_outside ∈ [0.05, 20], a mean cosine g ∈ (−1, 1) of the phase
    /// function, and what lengths are to mean.
    ///
    /// # Errors
    /// A parameter is out of its range.
    pub fn new(eta: f64, g: f64, parameterization: Parameterization) -> Result<Self, ParameterError> {
        let boundary = DiffusionBoundary::new(eta)?;
        require(g > -1.0 && g < 1.0, "g", g, "in (-1, 1)")?;
        let points = (0..=INTERVALS)
            .map(|i| point((i as f64 / INTERVALS as f64).powi(2), eta))
            .collect::<Result<Vec<_>, _>>()?;
        let cubics = (0..INTERVALS).map(|i| [0, 1].map(|column| cubic(&points, i, column))).collect();
        Ok(Self { boundary, eta, g, parameterization, cubics })
    }

    /// The dipole of a surface albedo A ∈ \[0, 1\] and a length \[L\].
    ///
    /// The albedo is clamped to \[0, 1\] and the length to \[1e-18, 1e18\]; NaN counts as the least.
    #[inline]
    pub fn at(&self, surface_albedo: f32, length: f32) -> DirectionalDipoleF32 {
        let surface_albedo = f64::from(surface_albedo.max(0.0).min(1.0));
        let length = f64::from(length.max(LENGTH_MIN).min(LENGTH_MAX));
        let [root, quotient] = self.at_albedo(surface_albedo);
        let (absorbed, alpha_prime) = (root * root, surface_albedo * quotient);
        // σ'_t/σ_t = ℓ/ℓ*
        let transport_mfps_per_mfp = absorbed + alpha_prime / (1.0 - self.g);
        let transport_mfp = match self.parameterization {
            Parameterization::Mfp => length * transport_mfps_per_mfp,
            Parameterization::Dmfp => length * (3.0 * absorbed / (1.0 + absorbed)).sqrt(),
        };
        let (reduction, sigma_t_prime) = (1.0 / transport_mfps_per_mfp, 1.0 / transport_mfp);
        let albedos = [absorbed, alpha_prime];
        DirectionalDipoleF32 {
            kernel: Kernel::new(albedos, alpha_prime, reduction, sigma_t_prime, self.boundary, self.eta),
        }
    }

    /// The table for a shader: first six words, 0, 1 for a diffuse mean free path, C_φ, C_E, A of the boundary, η; then the others,
    /// g and for each interval of √A the cubics of √(1 − α') and α'/A.
    #[doc(hidden)]
    pub fn words(&self) -> ([f32; 6], Vec<f32>) {
        let DiffusionBoundary { fluence, flux, mismatch } = self.boundary;
        let is_dmfp = f64::from(u8::from(self.parameterization == Parameterization::Dmfp));
        let first = [0.0, is_dmfp, fluence, flux, mismatch, self.eta];
        let cubics = self.cubics.iter().flatten().flatten();
        (
            first.map(|word| word as f32),
            std::iter::once(&self.g).chain(cubics).map(|word| *word as f32).collect(),
        )
    }

    /// √(1 − α') and α'/A.
    #[inline]
    fn at_albedo(&self, surface_albedo: f64) -> [f64; 2] {
        let scaled = surface_albedo.sqrt() * INTERVALS as f64;
        let i = (scaled as usize).min(INTERVALS - 1);
        let t = scaled - i as f64;
        self.cubics[i].map(|[a, b, c, d]| a + t * (b + t * (c + t * d)))
    }
}

/// √(1 − α') and α'/A at one surface albedo.
fn point(surface_albedo: f64, eta: f64) -> Result<[f64; 2], ParameterError> {
    if surface_albedo == 0.0 {
        return Ok([1.0, 1.0 / NormalBeam::total_per_strength(1.0, eta)?]);
    }
    let appearance =
        Appearance { surface_albedo, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
    let medium = find_medium(&appearance, eta)?;
    let absorbed = medium.sigma_a() / medium.sigma_t_prime();
    Ok([absorbed.sqrt(), medium.alpha_prime() / surface_albedo])
}

/// Cubic through the four points nearest to interval i, in t = 0 … 1 across it, by Newton's differences.
fn cubic(points: &[[f64; 2]], i: usize, column: usize) -> [f64; 4] {
    let first = i.saturating_sub(1).min(points.len() - 4);
    let at = |k: usize| points[first + k][column];
    // Σ cⱼ binomial(s, j) with s = t + shift
    let c = [at(0), at(1) - at(0), at(2) - 2.0 * at(1) + at(0), at(3) - 3.0 * (at(2) - at(1)) - at(0)];
    let shift = (i - first) as f64;
    let value = |t: f64| {
        let s = t + shift;
        c[0] + s * (c[1] + (s - 1.0) / 2.0 * (c[2] + (s - 2.0) / 3.0 * c[3]))
    };
    // The polynomial's coefficients in t from its derivatives at t = 0
    let s = shift;
    let slope = c[1] + (2.0 * s - 1.0) / 2.0 * c[2] + (3.0 * s * s - 6.0 * s + 2.0) / 6.0 * c[3];
    [value(0.0), slope, 0.5 * (c[2] + (s - 1.0) * c[3]), c[3] / 6.0]
}

#[cfg(test)]
mod tests {
    use translucid_testing::SplitMix;

    use super::*;
    use crate::Medium;

    fn direction(random: &mut SplitMix) -> [f32; 3] {
        let z = 2.0 * random.uniform() - 1.0;
        let (sin, cos) = (2.0 * std::f64::consts::PI * random.uniform()).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        [radius * cos, radius * sin, z].map(|c| c as f32)
    }

    #[test]
    fn eval_agrees_with_its_twin() {
        let mut random = SplitMix(1);
        for (alpha, eta) in [(0.0, 1.4), (0.3, 1.0), (0.9, 1.4), (0.999, 0.8), (1.0, 1.5)] {
            let medium = Medium::from_mfp(alpha, 2.0, 0.3).unwrap();
            let dipole = DirectionalDipole::from_medium(&medium, eta).unwrap();
            let single = DirectionalDipoleF32::from(&dipole);
            for _ in 0..20_000 {
                let far = (12.0 * random.uniform() - 9.0).exp() as f32;
                let offset = direction(&mut random).map(|c| c * far);
                let [omega, n_i, n_o] = [(); 3].map(|()| direction(&mut random));
                let wide = |v: [f32; 3]| v.map(f64::from);
                let expected = dipole.eval(wide(offset), wide(omega), wide(n_i), wide(n_o));
                let found = f64::from(single.eval(offset, omega, n_i, n_o));
                // The sources' parts may cancel; either is about as large as at the same distance along the normal
                let size = dipole.eval(
                    [f64::from(far), 0.0, 0.0],
                    [0.0, 0.0, 1.0],
                    [0.0, 0.0, 1.0],
                    [0.0, 0.0, 1.0],
                );
                let off = (found - expected).abs();
                assert!(
                    off <= 1e-7 * expected + 1e-9 * size,
                    "{alpha} {eta} {offset:?} {omega:?} {n_i:?} {n_o:?}: {found:e} {expected:e}"
                );
            }
        }
    }

    #[test]
    fn table_finds_what_the_root_finder_does() {
        for (eta, root_error, quotient_error) in
            [(0.5, 1e-7, 3e-7), (1.0, 1e-7, 3e-7), (1.5, 1e-7, 3e-7), (3.0, 4e-7, 1.3e-6)]
        {
            let table = DirectionalDipoleTable::new(eta, 0.0, Parameterization::Mfp).unwrap();
            for i in 0..=300 {
                let a = (f64::from(i) / 300.0).powf(1.5);
                let [root, quotient] = table.at_albedo(a);
                let [expected_root, expected_quotient] = point(a, eta).unwrap();
                let off = (root - expected_root).abs();
                assert!(off < root_error, "{eta} {a}: {off:e}");
                let off = (quotient / expected_quotient - 1.0).abs();
                assert!(off < quotient_error, "{eta} {a}: {off:e}");
            }
        }
    }

    #[test]
    fn table_gives_the_model_of_the_appearance() {
        for parameterization in [Parameterization::Mfp, Parameterization::Dmfp] {
            for g in [-0.5, 0.0, 0.9] {
                let table = DirectionalDipoleTable::new(1.4, g, parameterization).unwrap();
                for surface_albedo in [0.003, 0.2, 0.77, 1.0] {
                    let appearance = Appearance { surface_albedo, length: 3.0, parameterization, g };
                    let dipole = DirectionalDipole::new(&appearance, 1.4).unwrap();
                    let single = table.at(surface_albedo as f32, 3.0);
                    let up = [0.0, 0.0, 1.0];
                    for r in [0.0, 0.1, 1.0, 10.0] {
                        let (omega, tilted) = ([-0.8, 0.0, 0.6], [0.6, 0.0, 0.8]);
                        for n_o in [up, tilted, [0.0, 0.0, -1.0]] {
                            let expected = dipole.eval([r, 0.0, 0.0], omega, up, n_o);
                            let narrow = |v: [f64; 3]| v.map(|c| c as f32);
                            let found =
                                single.eval(narrow([r, 0.0, 0.0]), narrow(omega), narrow(up), narrow(n_o));
                            let off = (f64::from(found) - expected).abs();
                            assert!(
                                off < 3e-6 * expected + 1e-12,
                                "{appearance:?} {r} {n_o:?}: {found} {expected}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn eval_is_finite_for_any_argument() {
        let specials =
            [0.0, -0.0, 1.0, -1.0, f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e-45, 0.3];
        let mut random = SplitMix(2);
        for eta in [0.5, 1.0, 1.4] {
            for g in [-0.999, 0.0, 0.999_999] {
                let table = DirectionalDipoleTable::new(eta, g, Parameterization::Dmfp).unwrap();
                for _ in 0..300_000 {
                    let mut any = || specials[(random.uniform() * 10.0) as usize];
                    let dipole = table.at(any(), any());
                    let [offset, omega, n_i, n_o] = [(); 4].map(|()| [any(), any(), any()]);
                    let found = dipole.eval(offset, omega, n_i, n_o);
                    assert!(
                        found.is_finite() && found >= 0.0,
                        "{dipole:?} {offset:?} {omega:?} {n_i:?} {n_o:?}: {found}"
                    );
                    assert!(dipole.transport_mfp() > 0.0 && dipole.transport_mfp().is_finite());
                }
            }
        }
    }

    #[test]
    fn table_refuses_what_has_no_model() {
        assert!(DirectionalDipoleTable::new(0.0, 0.0, Parameterization::Mfp).is_err());
        assert!(DirectionalDipoleTable::new(f64::NAN, 0.0, Parameterization::Mfp).is_err());
        assert!(DirectionalDipoleTable::new(1.4, 1.0, Parameterization::Mfp).is_err());
    }
}
