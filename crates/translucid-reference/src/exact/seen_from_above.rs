//! Light of a beam that a camera straight above sees leave.

use num_complex::Complex64;
use translucid_profile::ParameterError;

use super::boundary_entrance::checked_beam;
use super::complex::exp;
use super::dispersion::Dispersion;
use super::h_function::{HFunction, K_MAX, WaveNumber};

/// Step of the H function's quadrature, for some 13 digits.
const T_STEP: f64 = 0.2;

/// Radiance along the normal of an index-matched half space of isotropic scatterers in a parallel beam.
///
/// Where the beam's irradiance varies as e^{ikx}, x along the surface in the direction in which the beam is tilted, the
/// radiance L that leaves straight up does so, too, and over that of a white Lambertian surface it is
///
/// ```text
/// πL/E = (α/4μ₀) H(k, 1/s₀) H(k, 1) / (s₀ + 1),     s₀ = 1/μ₀ + i k tan θ₀
/// ```
///
/// which is S. Chandrasekhar's law of diffuse reflection (*Radiative Transfer*, 1950) at k = 0, and its continuation after
/// G. B. Rybicki 1971 elsewhere. Exitance, which [`HalfSpace`](super::HalfSpace) has, is all directions of L together.
///
/// ```
/// use translucid_reference::exact::SeenFromAbove;
///
/// let seen = SeenFromAbove::new(0.5, 1.0)?;
/// // Narrow stripes are seen by light that is scattered once: α/8
/// assert!((seen.transform(1e6)[0] - 0.0625).abs() < 1e-6);
/// # Ok::<(), translucid_profile::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SeenFromAbove {
    dispersion: Dispersion,
    cos_theta: f64,
}

impl SeenFromAbove {
    /// For the single-scattering albedo α ∈ (0, 1] and the cosine μ₀ of the angle of incidence, in (0, 1].
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(single_scattering_albedo: f64, cos_theta: f64) -> Result<Self, ParameterError> {
        checked_beam(single_scattering_albedo, 1.0, cos_theta)?;
        Ok(Self { dispersion: Dispersion::new(single_scattering_albedo), cos_theta })
    }

    /// Real and imaginary part of πL/E at the wave number k ≥ 0 \[ℓ⁻¹\].
    pub fn transform(&self, k: f64) -> [f64; 2] {
        let k = if k > 0.0 { k.min(K_MAX) } else { 0.0 };
        let h = HFunction::new(&self.dispersion, WaveNumber::real(&self.dispersion, k), T_STEP);
        let tan = (1.0 - self.cos_theta * self.cos_theta).max(0.0).sqrt() / self.cos_theta;
        let s = Complex64::new(1.0 / self.cos_theta, k * tan);
        let ln_h = h.ln_h_anywhere(s).fine + h.ln_h_anywhere(Complex64::ONE).fine;
        let light =
            exp(ln_h) / (s + 1.0) * (0.25 * self.dispersion.single_scattering_albedo / self.cos_theta);
        [light.re, light.im]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The source function on a grid of depths by successive orders of scattering, at k = 0 and elsewhere: no H function.
    ///
    /// S = α/(4π) E/μ₀ e^{−s₀τ} + α ∫ K(|τ − τ'|) S(τ') dτ',     K(τ) = ½ ∫₀¹ ν/u² e^{−τ/ν} du
    fn by_orders(alpha: f64, k: f64, cos_theta: f64) -> [f64; 2] {
        let (step, n, m) = (0.02, 700, 400);
        let tan = (1.0 - cos_theta * cos_theta).sqrt() / cos_theta;
        // ∫ K over a cell at so many cells' distance: ½ ∫ ν²/u² (e^{−a/ν} − e^{−b/ν}) du
        let cell = |j: usize| {
            let (a, b) = ((j as f64 - 0.5) * step, (j as f64 + 0.5) * step);
            let node = |i: usize| {
                let u = (i as f64 + 0.5) / m as f64;
                let nu = u / (1.0 + k * k * u * u).sqrt();
                let weight = 0.5 / m as f64 * nu * nu / (u * u);
                let beyond = |t: f64| (-t / nu).exp();
                weight * if j == 0 { 2.0 * (1.0 - beyond(b)) } else { beyond(a) - beyond(b) }
            };
            (0..m).map(node).sum::<f64>()
        };
        let cells: Vec<f64> = (0..n).map(cell).collect();
        let depth = |i: usize| (i as f64 + 0.5) * step;
        let s0 = Complex64::new(1.0 / cos_theta, k * tan);
        let first: Vec<Complex64> = (0..n).map(|i| alpha / cos_theta * (-s0 * depth(i)).exp()).collect();
        let (mut order, mut source) = (first.clone(), first);
        for _ in 0..60 {
            let next = |i: usize| alpha * (0..n).map(|j| order[j] * cells[i.abs_diff(j)]).sum::<Complex64>();
            order = (0..n).map(next).collect();
            source.iter_mut().zip(&order).for_each(|(sum, more)| *sum += more);
        }
        let light: Complex64 = (0..n).map(|i| source[i] * (-depth(i)).exp() * step).sum::<Complex64>() * 0.25;
        [light.re, light.im]
    }

    #[test]
    fn transform_is_the_sum_of_orders_of_scattering() {
        for (alpha, k, cos_theta) in [(0.6, 0.0, 1.0), (0.6, 1.3, 1.0), (0.8, 0.7, 0.6), (0.5, 3.0, 0.8)] {
            let [found, expected] =
                [SeenFromAbove::new(alpha, cos_theta).unwrap().transform(k), by_orders(alpha, k, cos_theta)];
            for (found, expected) in found.iter().zip(expected) {
                // The grid's error is some step²
                assert!((found - expected).abs() < 3e-4, "{alpha} {k} {cos_theta}: {found} {expected}");
            }
        }
    }

    #[test]
    fn what_is_out_of_range_is_refused() {
        for (alpha, cos_theta) in [(0.0, 1.0), (1.1, 1.0), (0.5, 0.0), (0.5, f64::NAN)] {
            assert!(SeenFromAbove::new(alpha, cos_theta).is_err());
        }
        assert!(SeenFromAbove::new(0.5, 0.3).unwrap().transform(f64::NAN)[0].is_finite());
    }
}
