//! Profile of the half space under an oblique pencil beam, over radius and azimuth.

use std::f64::consts::PI;

use num_complex::Complex64;
use translucid_profile::ParameterError;

use super::azimuthal_inversion::{AzimuthalInversion, Harmonics};
use super::boundary_entrance::{BoundaryEntrance, checked_beam};
use super::dielectric::{DielectricHalfSpace, DielectricSettings};
use super::dielectric_response::Response;
use super::dispersion::Dispersion;
use super::h_function::WaveNumber;
use super::oblique_single_scattering::Beam;
use super::positive_radius;
use crate::Estimate;

/// Exact reflectance of a half space of isotropic scatterers under a pencil beam at any angle, as a function of the
/// distance r from the point of entry and of the azimuth φ.
///
/// ```text
/// R̂(k, φ_k) = (1/μ₀) H(k, 1/s₀) g(s₀),     s₀ = 1/μ₀ + i k tan θ₀ cos φ_k
/// R(r, φ) = R₁(r, φ) + Σ_m f_m(r) cos mφ
/// ```
///
/// θ₀ is the angle inside the medium, g the part of the light that gets out ((α/4π) ∫ H(1/s)/(s₀ + s) dΩ without a
/// boundary), R₁ the light scattered once, and f_m the inverse Hankel transform of order m of what is left.
/// After G. B. Rybicki 1971, *The searchlight problem with isotropic scattering*.
///
/// # Accuracy
/// Harmonics fall like e^{−m w}, w = arcosh(1/sin θ₀). Without a boundary figures are good to some 1e-9 of R for angles
/// up to 60°, with one to some 1e-6; close to grazing (beyond 85° inside) the number of harmonics is limited, and
/// the error that is returned says what that costs. Without a boundary totals are good to 1e-9 at cosines
/// from 1e-3 on, to 2e-8 at 1e-5 and to 4e-9 at 1e-8 (α = 0.9).
///
/// ```
/// use translucid_reference::exact::ObliqueHalfSpace;
///
/// let half_space = ObliqueHalfSpace::new(0.9, 1.0, 0.5)?;
/// // More light comes out where the beam is tilted to
/// let (ahead, behind) = (half_space.eval(1.0, 0.0), half_space.eval(1.0, std::f64::consts::PI));
/// assert!(ahead.value > 2.0 * behind.value);
/// # Ok::<(), translucid_profile::ParameterError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ObliqueHalfSpace {
    beam: Beam,
    dispersion: Dispersion,
    settings: DielectricSettings,
    /// The azimuthal mean.
    mean: DielectricHalfSpace,
    harmonics: AzimuthalInversion,
    /// Number of harmonics; 0 for a beam along the normal.
    count: usize,
}

/// Precision of the harmonics.
#[derive(Clone, Copy, Debug)]
struct HarmonicsSettings {
    /// Size of harmonics that may be left out, as a part of the first.
    tolerance: f64,
    /// Power of e by which errors of the transform may grow: as many as leave the tolerance.
    growth: f64,
}

impl Default for HarmonicsSettings {
    fn default() -> Self {
        // The transform is good to some 12 digits
        Self { tolerance: 1e-9, growth: 4.0 }
    }
}

/// Most harmonics: enough for 80° at 1e-10.
const MAX_HARMONICS: usize = 160;

impl ObliqueHalfSpace {
    /// Solves for the single-scattering albedo α ∈ (0, 1], the relative index η = n_inside/n_outside ∈ [0.5, 3] and
    /// the cosine of the angle of incidence outside, in (0, 1].
    ///
    /// # Errors
    /// A parameter is outside its range, or the beam is totally reflected (η < 1).
    pub fn new(single_scattering_albedo: f64, eta: f64, cos_theta: f64) -> Result<Self, ParameterError> {
        let beam = checked_beam(single_scattering_albedo, eta, cos_theta)?;
        let settings = DielectricSettings::default();
        Ok(Self::with_settings(single_scattering_albedo, beam, &settings, HarmonicsSettings::default()))
    }

    fn with_settings(
        single_scattering_albedo: f64,
        beam: Beam,
        settings: &DielectricSettings,
        harmonics: HarmonicsSettings,
    ) -> Self {
        let entrance = BoundaryEntrance::Pencil(beam);
        let count = if beam.sin_inside > 0.0 {
            (4.0 - libm::log(harmonics.tolerance) / beam.azimuth_strip()).min(MAX_HARMONICS as f64) as usize
        } else {
            0
        };
        Self {
            beam,
            dispersion: Dispersion::new(single_scattering_albedo),
            settings: *settings,
            mean: DielectricHalfSpace::new(single_scattering_albedo, beam.eta, entrance, settings),
            harmonics: AzimuthalInversion::new(count.max(1), harmonics.growth),
            count,
        }
    }

    /// Single-scattering albedo α.
    pub fn single_scattering_albedo(&self) -> f64 {
        self.dispersion.single_scattering_albedo
    }

    /// Surface albedo: what gets out of one unit of flux that entered.
    pub fn total(&self) -> Estimate {
        self.mean.total()
    }

    /// Profile R(r, φ) \[ℓ⁻²\]; φ = 0 is the direction the beam is tilted towards.
    ///
    /// R grows like 1/r: r below the least normal number counts as that number, and R above the greatest number as that
    /// one. NaN counts as 0, for either argument.
    /// The first radius of each octave takes the longest, as the transform is computed for it.
    pub fn eval(&self, r: f64, phi: f64) -> Estimate {
        let r = positive_radius(r);
        let phi = if phi.is_finite() { phi } else { 0.0 };
        let multiple_mean = self.mean.multiple(r);
        // Scattered once
        let single = self.beam.single_scattering(self.single_scattering_albedo(), phi).eval(r);
        let anisotropic = self.anisotropic(r, phi);
        let value = single.value + multiple_mean.value + anisotropic.value;
        let error = single.error + multiple_mean.error + anisotropic.error;
        Estimate { value: value.clamp(0.0, f64::MAX), error: error.min(f64::MAX) }
    }

    /// Mean of R(r, φ) over the azimuth \[ℓ⁻²\].
    pub fn eval_mean(&self, r: f64) -> Estimate {
        self.mean.eval(positive_radius(r))
    }

    /// Energy that leaves within r, over all azimuths.
    pub fn enclosed(&self, r: f64) -> Estimate {
        self.mean.split(positive_radius(r))[0]
    }

    /// Energy that leaves beyond r, over all azimuths.
    pub fn beyond(&self, r: f64) -> Estimate {
        self.mean.split(positive_radius(r))[1]
    }

    /// Σ f_m(r) cos mφ over m > 0.
    fn anisotropic(&self, r: f64, phi: f64) -> Estimate {
        if self.count == 0 {
            return Estimate::ZERO;
        }
        let harmonics = self.harmonics.eval(r, &|k| self.transform(k));
        let (mut sum, mut rounding, mut doubt) = (0.0, 0.0, 0.0);
        for (m, [value, difference]) in harmonics.iter().enumerate().skip(1) {
            sum += value.value * libm::cos(m as f64 * phi);
            rounding += value.error;
            doubt += difference.value * difference.value;
        }
        // What is left out falls like the last harmonics do
        let last = harmonics[harmonics.len().saturating_sub(3)..].iter().map(|[value, _]| value.value.abs());
        let left_out = last.fold(0.0, f64::max) / -libm::expm1(-self.beam.azimuth_strip());
        Estimate { value: sum, error: rounding + doubt.sqrt() + left_out }
    }

    /// c_m(k) for k in the right upper quadrant.
    fn transform(&self, k: Complex64) -> Harmonics {
        let wave_number = WaveNumber::in_quadrant(&self.dispersion, k);
        let [fine, coarse] = [self.settings.fine, self.settings.coarse].map(|counts| {
            let response = self.mean.respond(wave_number, counts);
            self.harmonics_of(&response, k)
        });
        let doubts = fine.iter().zip(&coarse).map(|(fine, coarse)| fine - coarse).collect();
        Harmonics { values: fine, doubts }
    }

    /// Harmonics of R̂(φ_k): c_m = ε_m i^m (1/π) ∫₀^π R̂ cos mφ_k dφ_k, ε₀ = 1 and ε_m = 2.
    fn harmonics_of(&self, response: &Response, k: Complex64) -> Vec<Complex64> {
        let Beam { cos_inside, sin_inside, .. } = self.beam;
        let count = self.count;
        // cos(πj/count) for j < 2 count
        let cosines: Vec<f64> = (0..2 * count).map(|j| libm::cos(PI * j as f64 / count as f64)).collect();
        let weigh = |j: usize| {
            let s0 = (1.0 + Complex64::I * k * (sin_inside * cosines[j])) / cos_inside;
            let share = if j == 0 || j == count { 0.5 } else { 1.0 } / count as f64;
            share * response.pencil_remainder(cos_inside, s0)
        };
        let values: Vec<Complex64> = (0..=count).map(weigh).collect();
        let mut phase = Complex64::ONE;
        let harmonic = |m: usize| {
            let sum: Complex64 = (0..=count).map(|j| values[j] * cosines[(j * m) % (2 * count)]).sum();
            let this = phase * sum * if m == 0 { 1.0 } else { 2.0 };
            phase *= Complex64::I;
            this
        };
        (0..count).map(harmonic).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::dielectric_directions::DirectionCounts;
    use crate::exact::hankel_inversion::Settings;

    /// Another ray, other steps and rules, more harmonics.
    const OTHER: DielectricSettings = DielectricSettings {
        fine: DirectionCounts { hemisphere: 37, arcs: 13, arc: 35 },
        coarse: DirectionCounts { hemisphere: 4, arcs: 1, arc: 1 },
        contour: Settings { angle: 0.68, k_step: 0.17, t_step: 0.17, directions: 0, r_max: 300.0 },
    };

    fn assert_settings_agree(alpha: f64, eta: f64, cos_theta: f64, tolerance: f64, points: &[(f64, f64)]) {
        let half_space = ObliqueHalfSpace::new(alpha, eta, cos_theta).expect("valid");
        let beam = checked_beam(alpha, eta, cos_theta).expect("enters");
        let finer = HarmonicsSettings { tolerance: 1e-11, growth: 2.0 };
        let other = ObliqueHalfSpace::with_settings(alpha, beam, &OTHER, finer);
        for &(r, phi) in points {
            let (found, expected) = (half_space.eval(r, phi), other.eval(r, phi));
            let off = (found.value - expected.value).abs();
            let what = format!("{alpha} {eta} {cos_theta} at {r}, {phi}: {found:?} {expected:?} {off:e}");
            assert!(
                off < tolerance * expected.value && found.error < 10.0 * tolerance * expected.value,
                "{what}"
            );
            assert!(off < found.error + 1e-9 * expected.value, "{what}");
        }
    }

    const POINTS: [(f64, f64); 8] =
        [(1e-3, 0.1), (0.03, 3.0), (0.1, 0.0), (0.1, 1.5), (1.0, 0.5), (1.0, PI), (5.0, -0.4), (10.0, 1.0)];

    #[test]
    fn matched_settings_agree() {
        for (alpha, cos_theta) in [(0.1, 0.5), (0.9, 0.5), (0.999, 0.3), (1.0, 0.9)] {
            assert_settings_agree(alpha, 1.0, cos_theta, 1e-8, &POINTS);
        }
    }

    #[test]
    fn dielectric_settings_agree() {
        assert_settings_agree(0.9, 1.4, 0.5, 1e-7, &[(0.03, 3.0), (0.5, 0.2)]);
    }

    /// The mean over azimuths from another way through the wave numbers, with another rule for the mean; and the
    /// harmonics from an end twice as far as needed.
    #[test]
    fn harmonics_do_not_depend_on_the_way() {
        let half_space = ObliqueHalfSpace::new(0.95, 1.0, 0.4).expect("valid");
        let transform = |k| half_space.transform(k);
        for r in [0.01, 0.3, 2.0, 8.0] {
            let harmonics = half_space.harmonics.eval(r, &transform);
            let mean = half_space.mean.multiple(r);
            assert!((harmonics[0][0].value / mean.value - 1.0).abs() < 1e-9, "{r}: {harmonics:?} {mean:?}");
            let others = half_space.harmonics.eval_past(r, &transform);
            for (m, (one, other)) in harmonics.iter().zip(&others).enumerate() {
                let off = (one[0].value - other[0].value).abs();
                assert!(off < 1e-10 * mean.value, "{r} {m}: {one:?} {other:?}");
            }
        }
    }
}
