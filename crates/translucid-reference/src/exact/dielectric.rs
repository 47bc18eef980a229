//! Radial profile of the half space under a dielectric boundary.

use num_complex::Complex64;
use rayon::prelude::*;
use translucid_profile::{ParameterError, fresnel_moment_1_from_inside};

use super::dielectric_directions::{DirectionCounts, azimuthal_mean};
use super::dielectric_response::Response;
use super::dispersion::Dispersion;
use super::energy::EnergyBudget;
use super::h_function::{Nested, WaveNumber};
use super::half_space::at_most_1;
use super::inversion::{Contour, Inversion, Settings};
use super::oblique_single_scattering::{Beam, cosine_single_scattering, uniform_cosine_single_scattering};
use super::single_scattering::SingleScattering;
use crate::{Entry, Estimate};

/// How finely the solution under a boundary is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DielectricSettings {
    /// Rule over directions.
    pub(crate) fine: DirectionCounts,
    /// Another one, whose difference tells the error.
    pub(crate) coarse: DirectionCounts,
    /// The ray of wave numbers.
    pub(crate) contour: Settings,
}

impl Default for DielectricSettings {
    fn default() -> Self {
        Self {
            fine: DirectionCounts { hemisphere: 26, arcs: 12, arc: 32 },
            coarse: DirectionCounts { hemisphere: 22, arcs: 10, arc: 28 },
            contour: Settings { r_max: 100.0, ..Settings::default() },
        }
    }
}

/// Error as a multiple of the difference between the rules over directions. It is far smaller where they converge
/// exponentially; for η < 1 they do not quite.
const DOUBT: f64 = 3.0;
/// Error as a part of the value: of the H function, of the residual, of rounding.
const ROUNDING: f64 = 1e-10;

/// How light enters through the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BoundaryEntrance {
    /// A pencil beam; without a boundary too.
    Pencil(Beam),
    /// Equal radiance from outside; under a boundary only.
    Cosine {
        /// ∫ T(μ) μ dμ over inside directions.
        passed: f64,
    },
    /// Cosines distributed uniformly inside; under a boundary only.
    UniformCosine,
}

impl BoundaryEntrance {
    /// `None` for a pencil that is totally reflected.
    pub(crate) fn new(eta: f64, entry: Entry) -> Option<Self> {
        Some(match entry {
            Entry::Pencil { cos_theta } => Self::Pencil(Beam::refracted(eta, cos_theta)?),
            Entry::Cosine => Self::Cosine { passed: 0.5 - fresnel_moment_1_from_inside(eta) },
            Entry::UniformCosine => Self::UniformCosine,
        })
    }

    /// Checks the parameters: α ∈ (0, 1], η ∈ [0.5, 3], and a beam that enters.
    pub(crate) fn checked(alpha: f64, eta: f64, entry: Entry) -> Result<Self, ParameterError> {
        let refuse = |parameter, value, allowed| Err(ParameterError::new(parameter, value, allowed));
        if !(alpha > 0.0 && alpha <= 1.0) {
            return refuse("single_scattering_albedo", alpha, "in (0, 1]");
        }
        if !(0.5..=3.0).contains(&eta) {
            return refuse("eta", eta, "in [0.5, 3] for the exact solution");
        }
        match entry {
            Entry::Pencil { cos_theta } if !(cos_theta > 0.0 && cos_theta <= 1.0) => {
                refuse("cos_theta", cos_theta, "in (0, 1]")
            }
            Entry::Pencil { cos_theta } => Self::new(eta, entry).map_or_else(
                || refuse("cos_theta", cos_theta, "above that of total reflection, sqrt(1 - eta^2)"),
                Ok,
            ),
            _ => Ok(Self::new(eta, entry).unwrap_or(Self::UniformCosine)),
        }
    }

    /// R̂ averaged over azimuths, less single scattering.
    fn remainder(&self, response: &Response, k: Complex64) -> Complex64 {
        match self {
            Self::Pencil(beam) => {
                mean_over_azimuths(beam, k, |s0| response.pencil_remainder(beam.cos_inside, s0))
            }
            Self::Cosine { passed } => response.cosine_remainder(*passed),
            Self::UniformCosine => response.uniform_cosine_remainder(),
        }
    }

    /// R̂ averaged over azimuths.
    fn whole(&self, response: &Response, k: Complex64) -> Complex64 {
        match self {
            Self::Pencil(beam) => mean_over_azimuths(beam, k, |s0| response.pencil(beam.cos_inside, s0)),
            Self::Cosine { passed } => response.cosine(*passed),
            Self::UniformCosine => response.uniform_cosine(),
        }
    }

    /// The part that is added in real space.
    fn single_scattering(&self, single_scattering_albedo: f64, eta: f64) -> SingleScattering {
        match self {
            Self::Pencil(beam) => beam.mean_single_scattering(single_scattering_albedo),
            Self::Cosine { .. } => cosine_single_scattering(single_scattering_albedo, eta),
            Self::UniformCosine => uniform_cosine_single_scattering(single_scattering_albedo, eta),
        }
    }
}

/// Points for the mean over azimuths.
const AZIMUTHS: usize = 40;

fn mean_over_azimuths(beam: &Beam, k: Complex64, f: impl Fn(Complex64) -> Complex64) -> Complex64 {
    let Beam { cos_inside, sin_inside, .. } = *beam;
    if sin_inside <= 0.0 {
        return f(Complex64::from(1.0 / cos_inside));
    }
    let nodes = azimuthal_mean(sin_inside, AZIMUTHS).into_iter();
    nodes.map(|(n_x, weight)| weight * f((1.0 - Complex64::I * k * n_x) / cos_inside)).sum()
}

/// The half space of isotropic scatterers under a dielectric boundary, for one way of entry.
#[derive(Clone, Debug)]
pub(crate) struct DielectricHalfSpace {
    dispersion: Dispersion,
    eta: f64,
    entrance: BoundaryEntrance,
    settings: DielectricSettings,
    single_scattering: SingleScattering,
    inversion: Inversion,
    /// Of the difference between the finer and the coarser rule.
    doubt: Inversion,
    energy: EnergyBudget,
}

impl DielectricHalfSpace {
    /// For α ∈ (0, 1].
    pub(crate) fn new(
        single_scattering_albedo: f64,
        eta: f64,
        entrance: BoundaryEntrance,
        settings: &DielectricSettings,
    ) -> Self {
        let dispersion = Dispersion::new(single_scattering_albedo);
        let contour = Contour::new(&dispersion, &settings.contour);
        let remainders: Vec<[Complex64; 2]> = (contour.nodes.par_iter())
            .map(|node| {
                let remainder = |counts| {
                    let response = respond(&dispersion, node.wave_number, eta, counts, settings);
                    entrance.remainder(&response, node.wave_number.k)
                };
                [settings.fine, settings.coarse].map(remainder)
            })
            .collect();
        let plain = |value: Complex64| Nested { fine: value, coarse: value };
        let values: Vec<Nested> = remainders.iter().map(|[fine, _]| plain(*fine)).collect();
        let doubts: Vec<Nested> = remainders.iter().map(|[fine, coarse]| plain(fine - coarse)).collect();
        let mut half_space = Self {
            dispersion,
            eta,
            entrance,
            settings: *settings,
            single_scattering: entrance.single_scattering(single_scattering_albedo, eta),
            inversion: Inversion::new(&contour, &values),
            doubt: Inversion::new(&contour, &doubts),
            energy: EnergyBudget::new(Estimate::ZERO, dispersion.k0, false),
        };
        let [value, doubt] = half_space.on_real_axis(0.0, BoundaryEntrance::remainder);
        half_space.inversion = half_space.inversion.with_total(Estimate { value, error: doubt.abs() });
        half_space.doubt = half_space.doubt.with_total(Estimate { value: doubt, error: 0.0 });
        let is_difference = half_space.inversion.beyond_is_difference();
        half_space.energy = EnergyBudget::new(half_space.hankel(0.0), dispersion.k0, is_difference);
        half_space
    }

    /// Single-scattering albedo α.
    pub(crate) fn single_scattering_albedo(&self) -> f64 {
        self.dispersion.single_scattering_albedo
    }

    /// The part that is scattered once.
    pub(crate) fn single_scattering(&self) -> &SingleScattering {
        &self.single_scattering
    }

    /// What gets out at one wave number, with the rule given.
    pub(crate) fn respond(&self, wave_number: WaveNumber, counts: DirectionCounts) -> Response {
        respond(&self.dispersion, wave_number, self.eta, counts, &self.settings)
    }

    /// R(r) for r > 0, less single scattering.
    pub(crate) fn multiple(&self, r: f64) -> Estimate {
        self.estimate(Estimate::ZERO, |inversion| inversion.eval(r))
    }

    /// R(r) for r > 0.
    pub(crate) fn eval(&self, r: f64) -> Estimate {
        self.estimate(self.single_scattering.eval(r), |inversion| inversion.eval(r))
    }

    /// ∫₀^r R 2πr' dr' for r > 0.
    pub(crate) fn enclosed(&self, r: f64) -> Estimate {
        self.split(r)[0]
    }

    /// ∫_r^∞ R 2πr' dr' for r > 0.
    pub(crate) fn beyond(&self, r: f64) -> Estimate {
        self.split(r)[1]
    }

    fn split(&self, r: f64) -> [Estimate; 2] {
        self.energy.split(
            r,
            |r| self.estimate(self.single_scattering.enclosed(r), |inversion| inversion.enclosed(r)),
            |r| self.estimate(self.single_scattering.beyond(r), |inversion| inversion.beyond(r)),
        )
    }

    /// Surface albedo.
    pub(crate) fn total(&self) -> Estimate {
        self.energy.total()
    }

    /// R̂(k) for k ≥ 0; the total is R̂(0).
    pub(crate) fn hankel(&self, k: f64) -> Estimate {
        let [value, doubt] = self.on_real_axis(k, BoundaryEntrance::whole);
        at_most_1(Estimate { value, error: DOUBT * doubt.abs() + ROUNDING * value.abs() })
    }

    /// A transform at k ≥ 0, and how far the rules are apart.
    fn on_real_axis(
        &self,
        k: f64,
        transform: impl Fn(&BoundaryEntrance, &Response, Complex64) -> Complex64,
    ) -> [f64; 2] {
        let wave_number = WaveNumber::real(&self.dispersion, k);
        let [fine, coarse] = [self.settings.fine, self.settings.coarse].map(|counts| {
            let response = self.respond(wave_number, counts);
            transform(&self.entrance, &response, wave_number.k).re
        });
        [fine, fine - coarse]
    }

    fn estimate(&self, single: Estimate, multiple: impl Fn(&Inversion) -> Estimate) -> Estimate {
        let Estimate { value, error } = multiple(&self.inversion);
        let doubt = multiple(&self.doubt).value.abs();
        Estimate {
            value: (single.value + value).clamp(0.0, f64::MAX),
            error: (single.error + error + DOUBT * doubt + ROUNDING * value.abs()).min(f64::MAX),
        }
    }
}

/// Surface albedo alone: R̂(0), without the profile's wave numbers; without a boundary of pencils only.
pub(crate) fn total(single_scattering_albedo: f64, eta: f64, entrance: BoundaryEntrance) -> f64 {
    let (dispersion, settings) = (Dispersion::new(single_scattering_albedo), DielectricSettings::default());
    let wave_number = WaveNumber::real(&dispersion, 0.0);
    let response = respond(&dispersion, wave_number, eta, settings.fine, &settings);
    entrance.whole(&response, wave_number.k).re
}

fn respond(
    dispersion: &Dispersion,
    wave_number: WaveNumber,
    eta: f64,
    counts: DirectionCounts,
    settings: &DielectricSettings,
) -> Response {
    let t_step = settings.contour.t_step;
    if eta == 1.0 {
        Response::matched(dispersion, wave_number, t_step, counts.hemisphere)
    } else {
        Response::dielectric(dispersion, wave_number, t_step, eta, counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(alpha: f64, eta: f64, entry: Entry, settings: &DielectricSettings) -> DielectricHalfSpace {
        let entrance = BoundaryEntrance::new(eta, entry).expect("refracted");
        DielectricHalfSpace::new(alpha, eta, entrance, settings)
    }

    const OTHER: DielectricSettings = DielectricSettings {
        fine: DirectionCounts { hemisphere: 31, arcs: 13, arc: 35 },
        coarse: DirectionCounts { hemisphere: 4, arcs: 1, arc: 1 },
        contour: Settings { angle: 0.65, k_step: 0.17, t_step: 0.17, directions: 0, r_max: 300.0 },
    };

    /// Two settings that have nothing in common: rules over directions, ray of wave numbers, steps.
    fn assert_settings_agree(alpha: f64, eta: f64, entry: Entry, tolerance: f64) {
        let half_space = solve(alpha, eta, entry, &DielectricSettings::default());
        let other = solve(alpha, eta, entry, &OTHER);
        let close = |found: Estimate, expected: Estimate, what: &str| {
            let off = (found.value - expected.value).abs();
            assert!(
                off < tolerance * expected.value,
                "{alpha} {eta} {entry:?} {what}: {found:?} {expected:?}"
            );
            // The finer settings' own error is not part of the estimate
            assert!(off < found.error + 3e-10 * expected.value, "{alpha} {eta} {what}: {found:?} {off:e}");
            assert!(found.error < 1e-6 * expected.value, "{alpha} {eta} {what}: {found:?}");
        };
        for r in [0.03, 0.1, 0.3, 1.0, 3.0, 10.0] {
            close(half_space.eval(r), other.eval(r), &format!("R({r})"));
            close(half_space.enclosed(r), other.enclosed(r), &format!("within {r}"));
            close(half_space.beyond(r), other.beyond(r), &format!("beyond {r}"));
        }
        close(half_space.hankel(0.0), other.hankel(0.0), "total");
    }

    /// The sums over radii, which share no quadrature with the total, have it too.
    #[test]
    fn grazing_beam_keeps_its_energy() {
        for cos_theta in [1e-3, 1e-5, 1e-8] {
            let entry = Entry::Pencil { cos_theta };
            let half_space = solve(0.9, 1.0, entry, &DielectricSettings::default());
            let total = half_space.total();
            let single = half_space.single_scattering.enclosed(300.0);
            let multiple = half_space.inversion.enclosed(300.0);
            let beyond = half_space.beyond(300.0).value;
            let off = (single.value + multiple.value + beyond - total.value).abs();
            let error = single.error + multiple.error + total.error;
            assert!(off < error && error < 1e-8 + 1e-12 / cos_theta, "{cos_theta}: {off:e} {error:e}");
        }
    }

    /// Totals of an independent program: the equation for k = 0 on real directions, by Nyström's method with nodes
    /// graded towards grazing, the critical angle and the normal.
    #[test]
    fn error_covers_the_totals_of_another_program() {
        for (eta, expected) in [
            (0.5, 0.12186576884499),
            (0.99, 0.14564650875733),
            (0.999, 0.14643850157971),
            (1.001, 0.14580381825652),
            (1.01, 0.14030269348777),
            (3.0, 0.009291293155614),
        ] {
            let total = solve(0.5, eta, Entry::Cosine, &DielectricSettings::default()).total();
            let off = (total.value - expected).abs();
            assert!(off < total.error + 1e-13, "{eta}: {total:?} {off:e}");
        }
    }

    #[test]
    fn dielectric_settings_agree() {
        assert_settings_agree(0.1, 1.2, Entry::NORMAL, 1e-7);
        assert_settings_agree(0.999, 1.5, Entry::Pencil { cos_theta: 0.6 }, 1e-7);
        assert_settings_agree(0.5, 1.4, Entry::Cosine, 1e-7);
        assert_settings_agree(0.99, 1.33, Entry::UniformCosine, 1e-7);
        assert_settings_agree(0.9, 0.8, Entry::NORMAL, 1e-6);
    }

    /// All albedos and indices that the accuracy is stated for.
    #[test]
    #[ignore = "takes a minute; dielectric_settings_agree has a choice"]
    fn dielectric_settings_agree_everywhere() {
        for alpha in [0.1, 0.5, 0.9, 0.99, 0.999] {
            for eta in [1.2, 1.33, 1.4, 1.5] {
                for entry in
                    [Entry::NORMAL, Entry::Pencil { cos_theta: 0.4 }, Entry::Cosine, Entry::UniformCosine]
                {
                    assert_settings_agree(alpha, eta, entry, 1e-6);
                }
            }
        }
    }
}
