//! Radial profile of the half space whose refractive index is that of its surroundings.

use num_complex::Complex64;
use translucid_profile::quadrature::gauss_legendre;

use super::angular_quadrature::directions;
use super::complex::exp_m1;
use super::dispersion::Dispersion;
use super::energy::EnergyBudget;
use super::h_function::{HFunction, K_MAX, Nested, WaveNumber};
use super::hankel_inversion::{Contour, Inversion, Settings};
use super::single_scattering::{Entrance, SingleScattering};
use crate::Estimate;

/// Error as a multiple of the square of the relative difference between the rules over directions: the finer rule's
/// error is about the square of the coarser's.
const DOUBT: f64 = 1000.0;
/// Error as a part of the value: of the H function and of rounding.
const ROUNDING: f64 = 2e-12;

/// Index-matched half space of isotropic scatterers, after G. B. Rybicki 1971:
///
/// ```text
/// pencil    R̂(k) = (α/2) H(k,1) ∫₀¹ H(k,ν(u)) ν/(1+ν) du,     ν(u) = u/√(1 + k²u²)
/// cosine    R̂(k) = α ∫₀¹∫₀¹ H(ν) H(ν') νν'/(ν+ν') du du'
/// uniform   R̂(k) = ∫₀¹ [H(ν) − 1] du
/// ```
#[derive(Clone, Debug)]
pub(crate) struct MatchedHalfSpace {
    kernel: MultipleScattering,
    single_scattering: SingleScattering,
    inversion: Inversion,
    energy: EnergyBudget,
}

/// Hankel transform of what is scattered twice or more.
#[derive(Clone, Debug)]
struct MultipleScattering {
    dispersion: Dispersion,
    entrance: Entrance,
    t_step: f64,
    /// Gauss–Legendre rules over directions, the finer first.
    rules: [Vec<(f64, f64)>; 2],
}

impl MatchedHalfSpace {
    /// Solves for α ∈ (0, 1].
    pub(crate) fn new(single_scattering_albedo: f64, entrance: Entrance, settings: &Settings) -> Self {
        let dispersion = Dispersion::new(single_scattering_albedo);
        let kernel = MultipleScattering::new(dispersion, entrance, settings);
        let contour = Contour::new(dispersion.k0, settings);
        let values: Vec<Nested> = (contour.nodes.iter())
            .map(|node| kernel.hankel(contour.wave_number(&dispersion, node)))
            .collect();
        let multiple = kernel.on_real_axis(0.0);
        let inversion = Inversion::new(&contour, &values).with_total(multiple);
        let single_scattering = SingleScattering::new(single_scattering_albedo, entrance);
        let total = single_scattering.hankel(0.0).plus(multiple).at_most_1();
        let energy = EnergyBudget::new(total, dispersion.k0, inversion.beyond_is_difference());
        Self { kernel, single_scattering, inversion, energy }
    }

    /// Single-scattering albedo α.
    pub(crate) fn single_scattering_albedo(&self) -> f64 {
        self.kernel.dispersion.single_scattering_albedo
    }

    /// Profile of the light that is scattered once.
    pub(crate) fn single_scattering(&self) -> &SingleScattering {
        &self.single_scattering
    }

    /// Surface albedo.
    pub(crate) fn total(&self) -> Estimate {
        self.energy.total()
    }

    /// R(r) for r > 0.
    pub(crate) fn eval(&self, r: f64) -> Estimate {
        self.single_scattering.eval(r).plus(self.inversion.eval(r))
    }

    /// Energy within and beyond r > 0.
    pub(crate) fn split(&self, r: f64) -> [Estimate; 2] {
        let Self { single_scattering: single, inversion, .. } = self;
        self.energy.split(
            r,
            |r| single.enclosed(r).plus(inversion.enclosed(r)),
            |r| single.beyond(r).plus(inversion.beyond(r)),
        )
    }

    /// R̂(k) for k ≥ 0.
    pub(crate) fn hankel(&self, k: f64) -> Estimate {
        self.single_scattering.hankel(k).plus(self.kernel.on_real_axis(k.min(K_MAX))).at_most_1()
    }
}

impl MultipleScattering {
    fn new(dispersion: Dispersion, entrance: Entrance, settings: &Settings) -> Self {
        let rules = [settings.directions, settings.directions / 2].map(gauss_legendre);
        Self { dispersion, entrance, t_step: settings.t_step, rules }
    }

    /// R̂(k) less single scattering.
    fn hankel(&self, wave_number: WaveNumber) -> Nested {
        let h = HFunction::new(&self.dispersion, wave_number, self.t_step);
        // The beam's decay may be small beside b
        let beam = match self.entrance {
            Entrance::Normal => h.ln_h_anywhere(Complex64::ONE),
            _ => Nested { fine: Complex64::ZERO, coarse: Complex64::ZERO },
        };
        Nested {
            fine: self.over_directions(&h, &self.rules[0], beam.fine, |s| h.excess(s)),
            coarse: self.over_directions(&h, &self.rules[1], beam.coarse, |s| h.excess_coarse(s)),
        }
    }

    /// R̂(k) less single scattering for k ≥ 0.
    fn on_real_axis(&self, k: f64) -> Estimate {
        let value = self.hankel(WaveNumber::real(&self.dispersion, k));
        let (fine, coarse) = (value.fine.re, value.coarse.re);
        let relative = (fine - coarse) / fine.max(f64::MIN_POSITIVE);
        Estimate { value: fine, error: fine * (DOUBT * relative * relative + ROUNDING) }
    }

    /// (α/2) Σ over ways in and out of [H H' − 1]/(s + s').
    fn over_directions(
        &self,
        h: &HFunction,
        rule: &[(f64, f64)],
        beam: Complex64,
        excess: impl Fn(Complex64) -> Complex64,
    ) -> Complex64 {
        let directions = directions(h.wave_number(), rule);
        // s, H − 1 and weight
        let out: Vec<[Complex64; 3]> = directions.iter().map(|d| [d.s, excess(d.s), d.du]).collect();
        let enter: Vec<[Complex64; 3]> = match self.entrance {
            Entrance::Normal => vec![[Complex64::ONE, exp_m1(beam), Complex64::ONE]],
            Entrance::Cosine => out.iter().map(|[s, h, du]| [*s, *h, 2.0 * du]).collect(),
            Entrance::UniformCosine => (directions.iter().zip(&out))
                .map(|(d, [s, h, du])| [*s, *h, du * d.inverse_u_squared / s])
                .collect(),
        };
        let mut sum = Complex64::ZERO;
        for [s_in, h_in, weight_in] in &enter {
            let mut inner = Complex64::ZERO;
            for [s, h, weight] in &out {
                inner += weight * (h + h_in + h * h_in) / (s + s_in);
            }
            sum += weight_in * inner;
        }
        sum * (0.5 * self.dispersion.single_scattering_albedo)
    }
}

#[cfg(test)]
mod tests {
    use translucid_profile::quadrature::integrate;

    use super::*;

    const ENTRANCES: [Entrance; 3] = [Entrance::Normal, Entrance::Cosine, Entrance::UniformCosine];
    const ALPHAS: [f64; 11] = [1e-3, 0.01, 0.1, 0.3, 0.6, 0.9, 0.94, 0.99, 0.999, 0.9999, 1.0];

    fn half_space(alpha: f64, entrance: Entrance) -> MatchedHalfSpace {
        MatchedHalfSpace::new(alpha, entrance, &Settings::default())
    }

    /// Another ray, steps less than half as long, twice the directions.
    fn finer(alpha: f64, entrance: Entrance) -> MatchedHalfSpace {
        let settings = Settings { angle: 0.7, k_step: 0.07, t_step: 0.12, directions: 64, r_max: 1e5 };
        MatchedHalfSpace::new(alpha, entrance, &settings)
    }

    /// Functions of a radius.
    const FUNCTIONS: [fn(&MatchedHalfSpace, f64) -> Estimate; 3] = [
        MatchedHalfSpace::eval,
        |half_space, r| half_space.split(r)[0],
        |half_space, r| half_space.split(r)[1],
    ];

    #[test]
    fn two_settings_agree_to_1e_9() {
        for (alpha, entrance) in ALPHAS.iter().flat_map(|alpha| ENTRANCES.map(|entrance| (*alpha, entrance)))
        {
            let (found, other) = (half_space(alpha, entrance), finer(alpha, entrance));
            for i in -30..=20 {
                let r = 10f64.powf(f64::from(i) / 10.0);
                for (which, function) in FUNCTIONS.iter().enumerate() {
                    let (found, expected) = (function(&found, r), function(&other, r).value);
                    let off = (found.value / expected - 1.0).abs();
                    assert!(off < 1e-9, "{which}, {entrance:?}, alpha {alpha}, r {r}: {off:e}");
                    let relative = found.relative_error();
                    assert!(
                        relative < 1e-8,
                        "{which}, {entrance:?}, alpha {alpha}, r {r}: {found:?} {off:e}"
                    );
                }
            }
        }
    }

    /// Every error is at most the estimate, and the estimate not wild.
    #[test]
    fn error_is_honest() {
        let mut ratios = Vec::new();
        for (alpha, entrance) in ALPHAS.iter().flat_map(|alpha| ENTRANCES.map(|entrance| (*alpha, entrance)))
        {
            let (found, other) = (half_space(alpha, entrance), finer(alpha, entrance));
            for i in -32..=14 {
                let r = 10f64.powf(f64::from(i) / 4.0);
                for (which, function) in FUNCTIONS.iter().enumerate() {
                    let (found, expected) = (function(&found, r), function(&other, r));
                    let off = (found.value - expected.value).abs();
                    // Beyond that radius R is below the least normal number
                    if found.value < 1e-290 {
                        continue;
                    }
                    let allowed = found.error + expected.error;
                    assert!(
                        off <= allowed,
                        "{which}, {entrance:?}, alpha {alpha}, r {r:e}: {found:?} {expected:?}"
                    );
                    ratios.push(found.error / off.max(1e-15 * expected.value));
                }
            }
        }
        ratios.sort_by(f64::total_cmp);
        let quantile = |part: f64| ratios[(part * ratios.len() as f64) as usize];
        let (median, most) = (quantile(0.5), quantile(0.95));
        assert!(median < 150.0 && most < 3000.0, "{median:e} {most:e}");
    }

    /// Beyond the radii that the nodes are made for, up to where nothing is left of R or the nodes end.
    #[test]
    fn error_is_honest_far_out() {
        for (alpha, entrance) in
            [0.99999, 1.0].iter().flat_map(|alpha| ENTRANCES.map(|entrance| (*alpha, entrance)))
        {
            let settings = Settings { angle: 0.7, k_step: 0.07, r_max: 1e9, ..Settings::default() };
            let other = MatchedHalfSpace::new(alpha, entrance, &settings);
            let found = half_space(alpha, entrance);
            for i in 12..=32 {
                let r = 10f64.powf(f64::from(i) / 4.0);
                let (found, expected) = (found.eval(r), other.eval(r));
                let off = (found.value - expected.value).abs();
                let allowed = found.error + expected.error;
                assert!(off <= allowed, "{entrance:?}, alpha {alpha}, r {r:e}: {found:?} {expected:?}");
            }
        }
    }

    /// R̂ of the uniform entry by the H equation, ∫₀¹ (H − 1) du: a single integral instead of a double one.
    #[test]
    fn hankel_of_uniform_entry_has_a_second_form() {
        let rule = gauss_legendre(60);
        for alpha in [0.1, 0.7, 0.99, 1.0] {
            let half_space = half_space(alpha, Entrance::UniformCosine);
            for k in [0.0, 0.1, 1.0, 3.0, 30.0] {
                let dispersion = Dispersion::new(alpha);
                let wave_number = WaveNumber::real(&dispersion, k);
                let h = HFunction::new(&dispersion, wave_number, 0.2);
                let expected = integrate(&rule, 0.0, 1.0, |w| {
                    h.excess(wave_number.decay(Complex64::from(w * w * w).inv())).re * 3.0 * w * w
                });
                let found = half_space.hankel(k).value;
                assert!((found / expected - 1.0).abs() < 1e-11, "alpha {alpha}, k {k}: {found} {expected}");
            }
        }
    }
}
