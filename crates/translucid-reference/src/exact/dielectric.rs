//! Radial profile of the half space under a dielectric boundary.

use num_complex::Complex64;
use rayon::prelude::*;

use super::boundary_entrance::BoundaryEntrance;
use super::dielectric_directions::DirectionCounts;
use super::dielectric_response::Response;
use super::dispersion::Dispersion;
use super::energy::EnergyBudget;
use super::h_function::{K_MAX, Nested, WaveNumber};
use super::hankel_inversion::{Contour, Inversion, Settings};
use super::single_scattering::SingleScattering;
use crate::Estimate;

/// Rules and steps of the solution under a boundary.
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

/// The half space of isotropic scatterers under a dielectric boundary, for one way of entry.
#[derive(Clone, Debug)]
pub(crate) struct DielectricHalfSpace {
    dispersion: Dispersion,
    eta: f64,
    entrance: BoundaryEntrance,
    settings: DielectricSettings,
    single_scattering: SingleScattering,
    inversion: Inversion,
    /// Inversion of the difference between the finer and the coarser rule.
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
        let contour = Contour::new(dispersion.k0, &settings.contour);
        let remainders: Vec<[Complex64; 2]> = (contour.nodes.par_iter())
            .map(|node| {
                let wave_number = contour.wave_number(&dispersion, node);
                let remainder = |counts| {
                    let response = respond(&dispersion, wave_number, eta, counts, settings);
                    entrance.remainder(&response, wave_number.k)
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

    /// Profile of the light that is scattered once.
    pub(crate) fn single_scattering(&self) -> &SingleScattering {
        &self.single_scattering
    }

    /// Light that gets out at one wave number, with the rule given.
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

    /// Energy within and beyond r > 0.
    pub(crate) fn split(&self, r: f64) -> [Estimate; 2] {
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
        let [value, doubt] = self.on_real_axis(k.min(K_MAX), BoundaryEntrance::whole);
        Estimate { value, error: DOUBT * doubt.abs() + ROUNDING * value.abs() }.at_most_1()
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

/// R̂(k) alone, without the profile's wave numbers and without its error; without a boundary of pencils only.
pub(crate) fn transform(dispersion: &Dispersion, eta: f64, entrance: BoundaryEntrance, k: f64) -> f64 {
    let settings = DielectricSettings::default();
    let wave_number = WaveNumber::real(dispersion, k.min(K_MAX));
    let response = respond(dispersion, wave_number, eta, settings.fine, &settings);
    entrance.whole(&response, wave_number.k).re
}

/// Surface albedo alone: R̂(0).
pub(crate) fn total(single_scattering_albedo: f64, eta: f64, entrance: BoundaryEntrance) -> f64 {
    transform(&Dispersion::new(single_scattering_albedo), eta, entrance, 0.0)
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
    use translucid_testing::is_thorough;

    use super::*;
    use crate::Incidence;

    fn solve(
        alpha: f64,
        eta: f64,
        incidence: Incidence,
        settings: &DielectricSettings,
    ) -> DielectricHalfSpace {
        let entrance = BoundaryEntrance::checked(alpha, eta, incidence).expect("valid");
        DielectricHalfSpace::new(alpha, eta, entrance, settings)
    }

    /// Default rules over directions, on which alone the total depends, and few wave numbers.
    const FOR_TOTALS: DielectricSettings = DielectricSettings {
        fine: DirectionCounts { hemisphere: 26, arcs: 12, arc: 32 },
        coarse: DirectionCounts { hemisphere: 22, arcs: 10, arc: 28 },
        contour: Settings { angle: 0.65, k_step: 3.0, t_step: 0.2, directions: 0, r_max: 100.0 },
    };

    #[test]
    fn settings_for_totals_have_the_default_rules() {
        let DielectricSettings { fine, coarse, contour } = DielectricSettings::default();
        assert_eq!((FOR_TOTALS.fine, FOR_TOTALS.coarse), (fine, coarse));
        assert_eq!(FOR_TOTALS.contour.t_step, contour.t_step);
    }

    const OTHER: DielectricSettings = DielectricSettings {
        fine: DirectionCounts { hemisphere: 31, arcs: 13, arc: 35 },
        coarse: DirectionCounts { hemisphere: 4, arcs: 1, arc: 1 },
        contour: Settings { angle: 0.65, k_step: 0.17, t_step: 0.17, directions: 0, r_max: 300.0 },
    };

    /// Two settings that have nothing in common: rules over directions, ray of wave numbers, steps.
    fn assert_settings_agree(alpha: f64, eta: f64, incidence: Incidence, tolerance: f64) {
        let half_space = solve(alpha, eta, incidence, &DielectricSettings::default());
        let other = solve(alpha, eta, incidence, &OTHER);
        let close = |found: Estimate, expected: Estimate, what: &str| {
            let off = (found.value - expected.value).abs();
            assert!(
                off < tolerance * expected.value,
                "{alpha} {eta} {incidence:?} {what}: {found:?} {expected:?}"
            );
            // The finer settings' own error is not part of the estimate
            assert!(off < found.error + 3e-10 * expected.value, "{alpha} {eta} {what}: {found:?} {off:e}");
            assert!(found.error < 1e-6 * expected.value, "{alpha} {eta} {what}: {found:?}");
        };
        for r in [0.03, 0.1, 0.3, 1.0, 3.0, 10.0] {
            close(half_space.eval(r), other.eval(r), &format!("R({r})"));
            close(half_space.split(r)[0], other.split(r)[0], &format!("within {r}"));
            close(half_space.split(r)[1], other.split(r)[1], &format!("beyond {r}"));
        }
        close(half_space.hankel(0.0), other.hankel(0.0), "total");
    }

    /// The sums over radii, which share no quadrature with the total, have it too.
    #[test]
    fn grazing_beam_keeps_its_energy() {
        for cos_theta in [1e-3, 1e-5, 1e-8] {
            let incidence = Incidence::Pencil { cos_theta };
            let half_space = solve(0.9, 1.0, incidence, &DielectricSettings::default());
            let total = half_space.total();
            let single = half_space.single_scattering.enclosed(300.0);
            let multiple = half_space.inversion.enclosed(300.0);
            let beyond = half_space.split(300.0)[1].value;
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
            let total = solve(0.5, eta, Incidence::Cosine, &FOR_TOTALS).total();
            let off = (total.value - expected).abs();
            assert!(off < total.error + 1e-13, "{eta}: {total:?} {off:e}");
        }
    }

    /// All albedos and indices that the accuracy is stated for: a minute, when tests run with their whole power; else a
    /// choice.
    #[test]
    fn dielectric_settings_agree() {
        assert_settings_agree(0.999, 1.5, Incidence::Pencil { cos_theta: 0.6 }, 1e-7);
        assert_settings_agree(0.9, 0.8, Incidence::NORMAL, 1e-6);
        if is_thorough() {
            assert_settings_agree(0.1, 1.2, Incidence::NORMAL, 1e-7);
            assert_settings_agree(0.5, 1.4, Incidence::Cosine, 1e-7);
            assert_settings_agree(0.99, 1.33, Incidence::UniformCosine, 1e-7);
            for alpha in [0.1, 0.5, 0.9, 0.99, 0.999] {
                for eta in [1.2, 1.33, 1.4, 1.5] {
                    for incidence in [
                        Incidence::NORMAL,
                        Incidence::Pencil { cos_theta: 0.4 },
                        Incidence::Cosine,
                        Incidence::UniformCosine,
                    ] {
                        assert_settings_agree(alpha, eta, incidence, 1e-6);
                    }
                }
            }
        }
    }
}
