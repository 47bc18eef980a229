//! Directional dipole: diffusion of a ray of light that knows where it came from.
//!
//! J. R. Frisvad, T. Hachisuka and T. K. Kjeldsen, *Directional Dipole Model for Subsurface Scattering*, ACM
//! Transactions on Graphics 34(1), 2014.
//! Exitance from fluence and flux as in E. d'Eon and G. Irving, *A Quantized-Diffusion Model for Rendering
//! Translucent Materials*, 2011.

pub(crate) mod average;
mod kernel;
pub(crate) mod single_precision;

use crate::error::ParameterError;
use crate::math::elementary::Double;
use crate::medium::diffusion_boundary::DiffusionBoundary;
use crate::model::directional_dipole::average::NormalBeam;
use crate::model::directional_dipole::kernel::Kernel;
use crate::{Appearance, Medium};

/// Directional dipole of a half space: the exitance at one point for light that enters at another in a given
/// direction.
///
/// ```text
/// R(x_o − x_i; ω_i) = α' [S(x, ω, d_r) − S(x − h n*, ω*, d_v)]₊ / 4π
/// S(x, ω, d) = e^{−σ_tr d}/d³ {C_φ (d²/D + 3(1 + σ_tr d) x·ω)
///            − C_E [3D(1 + σ_tr d) ω·n_o − (1 + σ_tr d + 3D (3(1 + σ_tr d) + (σ_tr d)²)/d² x·ω) x·n_o]}
///
/// ω = refracted direction                  n* = n_i made perpendicular to x      ω* = ω − 2(ω·n*) n*
/// D = 1/3σ'_t,  σ_tr = √(σ_a/D)            d_E = 2.131 D/√α'                     h = 2A(η) d_E,  d_v = |x − h n*|
/// d_r² = |x|² + Dμ₀(Dμ₀ − 2d_E cos β)      where μ₀ = −ω·n_o > 0,                else |x|² + 1/(3σ_t)²
/// cos β = −√((|x|² − (x·ω)²)/(|x|² + d_E²))
/// C_φ = ¼(1 − 2C₁),  C_E = ½(1 − 3C₂),  A = (1 + 3C₂)/(1 − 2C₁) with the moments of the reflectance from inside
/// ```
///
/// # Convention
/// R is exitance per unit of flux that has entered, 4π C_φ(1/η) S_d in the paper's terms: its BSSRDF S_d is a
/// radiance that Fresnel's transmittance has yet to let out, and ∫ F_t cos θ dω = 4π C_φ(1/η), the paper's own
/// normalization, which cancels. The outgoing radiance is F_t(ω_o) R/(4π C_φ(1/η)), times F_t(ω_i) per unit of
/// flux that arrives.
///
/// # What it contains, and its energy
/// *All light that scatters, once too*; the paper's other term, reduced intensity, goes straight on and does not
/// come back out of a half space.
///
/// The paper's formula has no α'. It is the diffusion of all light in the medium, and the light that has not been
/// scattered is counted with the rest: black media would send back 21 % of the light (η = 1).
/// Only scattered light comes back; it starts with the density σ'_s e^{−σ'_t s} along the ray, which to first
/// order is the paper's source, monopole and dipole, times α'.
/// With α' the model is closer to the exact solution at every albedo, and black where the medium is;
/// [`as_published`](Self::as_published) leaves it out, as the paper does.
///
/// The model's sources are not those of a medium that keeps energy: at η = 1 a medium without absorption returns
/// 134 % of a beam along the normal, and one of α' = 0.9 64 % instead of 41 %.
/// [`new`](Self::new) therefore finds an α' that is less than the medium's true one.
/// At oblique incidence energy is what comes out; at grazing incidence for η = 1 it grows like −ln cos θ.
///
/// The part that is less than 0, behind light that arrives at a slant, is cut off: the cut is part of the model.
///
/// # Arguments
/// Vectors need not be of unit length. Light from below the surface at its entry, or beyond total reflection,
/// gives 0. No argument gives a NaN or an infinity: a NaN in the offset counts as 0, a normal or a direction that
/// has none (no length, no number) is replaced: n_i by the third axis, n_o and ω_i by n_i.
///
/// ```
/// use translucid_profile::{Appearance, DirectionalDipole, Parameterization};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let appearance =
///     Appearance { surface_albedo: 0.8, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
/// let dipole = DirectionalDipole::new(&appearance, 1.4)?;
/// let up = [0.0, 0.0, 1.0];
/// // Light that comes from the left leaves on the right
/// let from_left = [-0.8, 0.0, 0.6];
/// let right = dipole.eval([1.0, 0.0, 0.0], from_left, up, up);
/// let left = dipole.eval([-1.0, 0.0, 0.0], from_left, up, up);
/// assert!(right > 1.5 * left);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "dirpole")]
pub struct DirectionalDipole {
    kernel: Kernel,
    medium: Medium,
}

impl DirectionalDipole {
    /// The model of a medium under a boundary of η = n_inside/n_outside ∈ [0.05, 20].
    ///
    /// # Errors
    /// η is out of its range.
    pub fn from_medium(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        Ok(Self {
            kernel: Kernel::of_medium(medium, medium.alpha_prime(), DiffusionBoundary::new(eta)?, eta),
            medium: *medium,
        })
    }

    /// The model to the letter of the paper, without the factor α': for comparison with other programs.
    ///
    /// # Errors
    /// As [`from_medium`](Self::from_medium).
    pub fn as_published(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        Ok(Self {
            kernel: Kernel::of_medium(medium, 1.0, DiffusionBoundary::new(eta)?, eta),
            medium: *medium,
        })
    }

    /// The model whose energy for light along the normal is a surface albedo A ∈ [0, 1], which it always reaches.
    ///
    /// # Errors
    /// A parameter is out of its range.
    pub fn new(appearance: &Appearance, eta: f64) -> Result<Self, ParameterError> {
        Self::from_medium(&find_medium(appearance, eta)?, eta)
    }

    /// R(x_o − x_i; ω_i) \[L⁻²\], exitance at x_o per unit of flux that entered at x_i, at least 0.
    ///
    /// `offset` is x_o − x_i; ω_i points from x_i to where the light comes from, outside; n_i and n_o are the
    /// surface's normals at x_i and x_o, outwards.
    pub fn eval(&self, offset: [f64; 3], omega_i: [f64; 3], n_i: [f64; 3], n_o: [f64; 3]) -> f64 {
        self.eval_unclamped(offset, omega_i, n_i, n_o).max(0.0)
    }

    /// R(x_o − x_i; ω_i) as [`eval`](Self::eval) has it before the part that is less than 0 is cut off \[L⁻²\].
    pub fn eval_unclamped(&self, offset: [f64; 3], omega_i: [f64; 3], n_i: [f64; 3], n_o: [f64; 3]) -> f64 {
        self.kernel.unclamped::<Double>(offset, omega_i, n_i, n_o)
    }

    /// The medium: for [`new`](Self::new) the one that was found.
    pub fn medium(&self) -> &Medium {
        &self.medium
    }

    pub(crate) fn kernel(&self) -> &Kernel {
        &self.kernel
    }
}

/// The medium whose model has the surface albedo.
pub(crate) fn find_medium(appearance: &Appearance, eta: f64) -> Result<Medium, ParameterError> {
    let boundary = DiffusionBoundary::new(eta)?;
    let total = |absorbed: f64| {
        let alpha_prime = 1.0 - absorbed;
        let beam =
            NormalBeam { kernel: Kernel::new([absorbed, alpha_prime], alpha_prime, 1.0, 1.0, boundary, eta) };
        alpha_prime * beam.beyond(0.0)
    };
    appearance.medium(total)
}

#[cfg(test)]
mod tests {
    use translucid_testing::SplitMix;

    use super::*;
    use crate::Parameterization;

    const UP: [f64; 3] = [0.0, 0.0, 1.0];

    struct Random(SplitMix);

    impl Random {
        fn of(seed: u64) -> Self {
            Self(SplitMix(seed))
        }

        /// Uniform in [0, 1).
        fn next(&mut self) -> f64 {
            self.0.uniform()
        }

        /// Any number at all: ordinary, extreme or none.
        fn any(&mut self) -> f64 {
            let sign = if self.next() < 0.5 { -1.0 } else { 1.0 };
            let specials =
                [0.0, f64::NAN, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1.0, f64::EPSILON];
            sign * match (self.next() * 4.0) as u32 {
                0 => specials[(self.next() * 8.0) as usize],
                1 => 10f64.powf(600.0 * self.next() - 300.0),
                _ => 2.0 * self.next(),
            }
        }

        fn vector(&mut self) -> [f64; 3] {
            [self.any(), self.any(), self.any()]
        }

        fn direction(&mut self) -> [f64; 3] {
            let z = 2.0 * self.next() - 1.0;
            let (sin, cos) = (2.0 * std::f64::consts::PI * self.next()).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            [radius * cos, radius * sin, z]
        }
    }

    fn dipole(alpha: f64, length: f64, g: f64, eta: f64) -> DirectionalDipole {
        DirectionalDipole::from_medium(&Medium::from_mfp(alpha, length, g).unwrap(), eta).unwrap()
    }

    fn unit(v: [f64; 3]) -> [f64; 3] {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| c / length)
    }

    #[test]
    fn eval_is_finite_and_not_negative_for_any_argument() {
        let mut random = Random::of(1);
        for alpha in [0.0, 1e-12, 0.5, 1.0] {
            for length in [1e-100, 1.0, 1e100, 1e-150, 1e150] {
                for g in [-1.0 + 1e-15, 0.0, 0.9, 1.0 - 1e-15] {
                    for eta in [0.05, 0.5, 1.0, 1.4, 20.0] {
                        let d = dipole(alpha, length, g, eta);
                        for _ in 0..translucid_testing::power(4000) {
                            let scale = 10f64.powf(20.0 * random.next() - 18.0) * d.medium().transport_mfp();
                            let sane = random.next() < 0.5;
                            let offset =
                                if sane { random.vector().map(|x| x * scale) } else { random.vector() };
                            let mut v =
                                || if random.next() < 0.7 { random.direction() } else { random.vector() };
                            let (omega, n_i, n_o) = (v(), v(), v());
                            let n_o = if sane { n_i } else { n_o };
                            let found = d.eval(offset, omega, n_i, n_o);
                            let what = || format!("{d:?} {offset:?} {omega:?} {n_i:?} {n_o:?}: {found}");
                            assert!(found.is_finite() && found >= 0.0, "{}", what());
                            assert!(d.eval_unclamped(offset, omega, n_i, n_o).is_finite(), "{}", what());
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn eval_scales_with_the_length() {
        let mut random = Random::of(2);
        let (one, other) = (dipole(0.9, 1.0, 0.3, 1.4), dipole(0.9, 1e7, 0.3, 1.4));
        for _ in 0..1000 {
            let (offset, omega, n_i, n_o) =
                (random.direction(), random.direction(), random.direction(), random.direction());
            let expected = one.eval(offset, omega, n_i, n_o);
            let found = 1e14 * other.eval(offset.map(|x| 1e7 * x), omega, n_i, n_o);
            assert!((found - expected).abs() <= 1e-11 * expected + 1e-15, "{found} {expected}");
        }
    }

    #[test]
    fn eval_does_not_depend_on_the_axes_or_on_the_lengths_of_directions() {
        let d = dipole(0.8, 1.0, 0.0, 1.3);
        let turn = |v: [f64; 3]| [-v[1], 0.6 * v[0] + 0.8 * v[2], -0.8 * v[0] + 0.6 * v[2]];
        let mut random = Random::of(3);
        for _ in 0..1000 {
            let (offset, omega, n_i, n_o) =
                (random.direction(), random.direction(), random.direction(), random.direction());
            let expected = d.eval(offset, omega, n_i, n_o);
            let reflected = |v: [f64; 3]| turn(v).map(|c| c * 7.0);
            let found = d.eval(turn(offset), reflected(omega), reflected(n_i), reflected(n_o));
            assert!((found - expected).abs() <= 1e-10 * expected + 1e-13, "{found} {expected}");
        }
    }

    #[test]
    fn eval_prefers_where_the_beam_goes() {
        let d = dipole(0.9, 1.0, 0.0, 1.0);
        for degrees in [10.0f64, 45.0, 80.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let omega = [-sin, 0.0, cos];
            for r in [0.1, 1.0, 5.0] {
                let [ahead, behind] = [r, -r].map(|x| d.eval([x, 0.0, 0.0], omega, UP, UP));
                assert!(ahead > behind, "{degrees} {r}: {ahead} {behind}");
            }
        }
        // Behind a slanting beam the model is less than 0 before the cut
        let (sin, cos) = 80f64.to_radians().sin_cos();
        let behind = ([-0.3, 0.0, 0.0], [-sin, 0.0, cos], UP, UP);
        assert!(d.eval_unclamped(behind.0, behind.1, behind.2, behind.3) < 0.0);
        assert_eq!(d.eval(behind.0, behind.1, behind.2, behind.3), 0.0);
    }

    #[test]
    fn light_that_does_not_enter_gives_nothing() {
        let d = dipole(0.9, 1.0, 0.0, 0.8);
        assert_eq!(d.eval([1.0, 0.0, 0.0], [0.3, 0.0, -0.9], UP, UP), 0.0);
        // Total reflection beyond sin θ = 0.8
        assert_eq!(d.eval([1.0, 0.0, 0.0], unit([0.81, 0.0, 0.58]), UP, UP), 0.0);
        assert!(d.eval([1.0, 0.0, 0.0], unit([-0.79, 0.0, 0.613]), UP, UP) > 0.0);
    }

    /// A black medium is black, and its neighbors are nearly so.
    #[test]
    fn black_media_return_nothing() {
        let at = |alpha| dipole(alpha, 1.0, 0.0, 1.4).eval([0.3, 0.0, 0.0], unit([-1.0, 0.0, 1.0]), UP, UP);
        assert_eq!(at(0.0), 0.0);
        assert!((at(1e-9) / at(1e-6) * 1e3 - 1.0).abs() < 1e-5);
        let black = Medium::new(1.0, 0.0, 0.0).unwrap();
        let published = DirectionalDipole::as_published(&black, 1.0).unwrap();
        assert!(published.eval([0.3, 0.0, 0.0], UP, UP, UP) > 0.1);
    }

    #[test]
    fn the_limit_without_absorption_is_met_without_a_jump() {
        let at = |absorbed: f64, r: f64| {
            let medium = Medium::new(absorbed, 1.0 - absorbed, 0.0).unwrap();
            let d = DirectionalDipole::from_medium(&medium, 1.4).unwrap();
            d.eval([r, 0.0, 0.0], unit([-1.0, 0.0, 1.0]), UP, UP)
        };
        for r in [0.1, 1.0, 30.0, 1e6] {
            let (white, nearly) = (at(0.0, r), at(1e-30, r));
            assert!(white > 0.0 && (nearly / white - 1.0).abs() < 1e-7, "{r}: {nearly} {white}");
        }
        // R falls like r⁻³: the two sources' leading terms cancel
        let ratio = at(0.0, 1e6) / at(0.0, 1e7);
        assert!((ratio / 1e3 - 1.0).abs() < 1e-5, "{ratio}");
    }

    #[test]
    fn new_finds_the_medium_of_the_length() {
        for parameterization in [Parameterization::Mfp, Parameterization::Dmfp] {
            let appearance = Appearance { surface_albedo: 0.7, length: 3.0, parameterization, g: 0.5 };
            let medium = *DirectionalDipole::new(&appearance, 1.4).unwrap().medium();
            let length = match parameterization {
                Parameterization::Mfp => medium.mfp(),
                Parameterization::Dmfp => medium.dmfp(),
            };
            assert!((length / 3.0 - 1.0).abs() < 1e-12, "{length}");
        }
    }

    #[test]
    fn constructors_refuse_what_has_no_model() {
        let medium = Medium::new(0.1, 0.9, 0.0).unwrap();
        for eta in [0.0, -1.0, 0.04, 21.0, f64::NAN, f64::INFINITY] {
            assert!(DirectionalDipole::from_medium(&medium, eta).is_err(), "{eta}");
            assert!(DirectionalDipole::as_published(&medium, eta).is_err(), "{eta}");
        }
        let parameterization = Parameterization::Mfp;
        for (surface_albedo, length, g) in
            [(1.1, 1.0, 0.0), (f64::NAN, 1.0, 0.0), (0.5, 0.0, 0.0), (0.5, 1.0, 1.0)]
        {
            let appearance = Appearance { surface_albedo, length, parameterization, g };
            assert!(DirectionalDipole::new(&appearance, 1.4).is_err(), "{appearance:?}");
        }
    }
}
