//! The laws that every reflectance profile obeys, over one grid of parameters.
//!
//! To put a model under them, add it to [`models`]: one line of [`physical!`] where it has the constructors
//! `new(&Appearance, eta)` and `from_medium(&Medium, eta)`, else a `Model` spelled out, with `None` for what there is
//! not.

use std::f64::consts::PI;

use translucid_profile::quadrature::{gauss_legendre, integrate};
use translucid_profile::{
    Appearance, BeamMultipleScattering, BeamSingleScattering, BetterDipole, Configuration,
    DirectionalDipoleAverage, ExactProfile, Medium, NormalizedDiffusion, ParameterError, Parameterization,
    PhotonBeamDiffusion, Profile, QuantizedDiffusion, RefinedDiffusion, SimilarRefinedDiffusion,
    StandardDipole, SumOfGaussians, TabulatedProfile,
};

type Made = Result<Box<dyn Profile>, ParameterError>;
type Total = fn(f64, f64, f64) -> Result<f64, ParameterError>;

/// A way to make profiles of one kind, and where it may be used.
struct Model {
    name: &'static str,
    new: fn(&Appearance, f64) -> Made,
    from_medium: Option<fn(&Medium, f64) -> Made>,
    /// Total for 1 − α', g and η, of models whose `new` finds the medium by it.
    total: Option<Total>,
    etas: &'static [f64],
    gs: &'static [f64],
    /// True if R is smooth; that of a table has kinks where its cells meet, which quadratures feel.
    smooth: bool,
}

/// A model of a medium with a boundary, by the name of its type.
macro_rules! physical {
    ($model:ident) => {
        Model {
            name: stringify!($model),
            new: |appearance, eta| Ok(Box::new($model::new(appearance, eta)?)),
            from_medium: Some(|medium, eta| Ok(Box::new($model::from_medium(medium, eta)?))),
            total: Some(|absorbed, _, eta| {
                let medium = Medium::from_reduced(absorbed, 1.0 - absorbed, 0.0)?;
                Ok($model::from_medium(&medium, eta)?.surface_albedo())
            }),
            etas: &[0.7, 1.0, 1.33, 1.5],
            gs: &[-0.5, 0.0, 0.8],
            smooth: true,
        }
    };
}

/// A model that is carried over to media with a boundary, by its two constructors.
macro_rules! similar {
    ($new:expr, $from_medium:expr) => {
        Model {
            name: stringify!($new),
            new: |appearance, eta| Ok(Box::new($new(appearance, eta, Configuration::Searchlight)?)),
            from_medium: Some(|medium, eta| Ok(Box::new($from_medium(medium, eta, Configuration::Diffuse)?))),
            total: None,
            etas: &[1.0, 1.33, 1.5],
            gs: &[-0.5, 0.0, 0.8],
            smooth: true,
        }
    };
}

fn models() -> Vec<Model> {
    vec![
        Model {
            name: "NormalizedDiffusion",
            new: |a, _| {
                let (albedo, length) = (a.surface_albedo, a.length);
                let searchlight = Configuration::Searchlight;
                Ok(Box::new(NormalizedDiffusion::new(albedo, length, a.parameterization, searchlight)?))
            },
            from_medium: None,
            total: None,
            etas: &[1.0],
            gs: &[0.0],
            smooth: true,
        },
        similar!(NormalizedDiffusion::from_appearance, NormalizedDiffusion::from_medium),
        similar!(SimilarRefinedDiffusion::new, SimilarRefinedDiffusion::from_medium),
        Model {
            name: "RefinedDiffusion",
            new: |a, _| {
                let (albedo, length) = (a.surface_albedo, a.length);
                let searchlight = Configuration::Searchlight;
                Ok(Box::new(RefinedDiffusion::new(albedo, length, a.parameterization, searchlight)?))
            },
            from_medium: None,
            total: None,
            etas: &[1.0],
            gs: &[0.0],
            smooth: true,
        },
        physical!(StandardDipole),
        physical!(BetterDipole),
        physical!(QuantizedDiffusion),
        physical!(DirectionalDipoleAverage),
        Model {
            name: "ExactProfile",
            new: |a, _| {
                let (albedo, length) = (a.surface_albedo, a.length);
                let searchlight = Configuration::Searchlight;
                Ok(Box::new(ExactProfile::new(albedo, length, a.parameterization, searchlight)?))
            },
            from_medium: None,
            total: None,
            etas: &[1.0],
            gs: &[0.0],
            smooth: false,
        },
        Model {
            name: "TabulatedProfile of BetterDipole",
            new: |appearance, eta| Ok(Box::new(TabulatedProfile::new(&BetterDipole::new(appearance, eta)?))),
            from_medium: None,
            total: None,
            etas: &[0.7, 1.0, 1.33, 1.5],
            gs: &[-0.5, 0.0, 0.8],
            smooth: false,
        },
        Model {
            name: "SumOfGaussians",
            new: |a, _| {
                let (albedo, length, diffuse) = (a.surface_albedo, a.length, Configuration::Diffuse);
                let terms = SumOfGaussians::DEFAULT_TERMS;
                Ok(Box::new(SumOfGaussians::new(albedo, length, a.parameterization, diffuse, terms)?))
            },
            from_medium: None,
            total: None,
            etas: &[1.0],
            gs: &[0.0],
            smooth: true,
        },
        Model {
            name: "PhotonBeamDiffusion",
            new: |appearance, eta| Ok(Box::new(PhotonBeamDiffusion::new(appearance, eta)?)),
            from_medium: Some(|medium, eta| Ok(Box::new(PhotonBeamDiffusion::from_medium(medium, eta)?))),
            total: Some(PhotonBeamDiffusion::surface_albedo_from_absorbed),
            etas: &[0.7, 1.0, 1.33, 1.5],
            gs: &[-0.5, 0.0, 0.8],
            smooth: true,
        },
        Model {
            name: "BeamMultipleScattering",
            new: |appearance, eta| {
                let total = |absorbed| multiple_total(absorbed, appearance.g, eta).unwrap_or(1.0);
                let medium = appearance.medium(total)?;
                Ok(Box::new(BeamMultipleScattering::from_medium(&medium, eta)?))
            },
            from_medium: Some(|medium, eta| Ok(Box::new(BeamMultipleScattering::from_medium(medium, eta)?))),
            total: Some(multiple_total),
            etas: &[0.7, 1.4],
            gs: &[0.0, 0.8],
            smooth: true,
        },
        Model {
            name: "BeamSingleScattering",
            new: |appearance, eta| {
                let total = |absorbed| single_total(absorbed, appearance.g, eta).unwrap_or(1.0);
                let medium = appearance.medium(total)?;
                Ok(Box::new(BeamSingleScattering::from_medium(&medium, eta)?))
            },
            from_medium: Some(|medium, eta| Ok(Box::new(BeamSingleScattering::from_medium(medium, eta)?))),
            total: Some(single_total),
            etas: &[0.7, 1.4],
            gs: &[0.0, 0.8],
            smooth: true,
        },
    ]
}

/// Total of single scattering for 1 − α'.
fn single_total(absorbed: f64, g: f64, eta: f64) -> Result<f64, ParameterError> {
    let medium = Medium::from_reduced(absorbed, 1.0 - absorbed, g)?;
    Ok(BeamSingleScattering::from_medium(&medium, eta)?.surface_albedo())
}

/// Rest of photon beam diffusion without single scattering.
fn multiple_total(absorbed: f64, g: f64, eta: f64) -> Result<f64, ParameterError> {
    Ok(PhotonBeamDiffusion::surface_albedo_from_absorbed(absorbed, g, eta)? - single_total(absorbed, g, eta)?)
}

const ALBEDOS: [f64; 6] = [1e-9, 0.01, 0.2, 0.5, 0.8, 0.95];
const LENGTHS: [f64; 3] = [1e-60, 1.0, 1e60];

/// A profile and the parameters it was made of.
struct Case {
    label: String,
    appearance: Appearance,
    eta: f64,
    /// The most that the model reaches.
    limit: f64,
    smooth: bool,
    profile: Box<dyn Profile>,
}

/// The most that a model reaches for a relative index and a phase function.
fn most_reachable(model: &Model, appearance: Appearance, eta: f64) -> f64 {
    let white = Appearance { surface_albedo: 1.0, parameterization: Parameterization::Mfp, ..appearance };
    match (model.new)(&white, eta) {
        Ok(_) => 1.0,
        Err(error) => error.limit.unwrap_or_else(|| panic!("{}: {error}", model.name)),
    }
}

/// All parameters of one model for one length.
fn cases_of(model: &Model, length: f64) -> Vec<Case> {
    let mut cases = Vec::new();
    for &eta in model.etas {
        for &g in model.gs {
            for parameterization in [Parameterization::Mfp, Parameterization::Dmfp] {
                let start = Appearance { surface_albedo: 0.0, length, parameterization, g };
                let limit = most_reachable(model, start, eta);
                // Without absorption there is no diffuse mean free path
                let dmfp = parameterization == Parameterization::Dmfp;
                let most = if dmfp { limit * (1.0 - 1e-6) } else { limit };
                for surface_albedo in ALBEDOS.into_iter().filter(|a| *a < most).chain([most]) {
                    let appearance = Appearance { surface_albedo, ..start };
                    let label = format!("{} η = {eta}, {appearance:?}", model.name);
                    let profile = (model.new)(&appearance, eta).unwrap_or_else(|e| panic!("{label}: {e}"));
                    cases.push(Case { label, appearance, eta, limit, smooth: model.smooth, profile });
                }
            }
        }
    }
    cases
}

/// Every model with every parameter, at length 1.
fn cases() -> Vec<Case> {
    models().iter().flat_map(|model| cases_of(model, 1.0)).collect()
}

/// Radii from 1e-6 to 1e6 of a profile's scale, `per_decade` of them.
fn radii(profile: &dyn Profile, per_decade: i32) -> impl Iterator<Item = f64> {
    let scale = profile.scale();
    (-6 * per_decade..=6 * per_decade).map(move |i| scale * 10f64.powf(f64::from(i) / f64::from(per_decade)))
}

/// The trapezoidal rule in ln r: its error for what is smooth in ln r is below e^(−4.9/step), with kinks of the order of
/// the step's square times theirs.
#[test]
fn eval_integrates_to_total() {
    for case in cases() {
        let (step, count) = if case.smooth { (0.1, 280) } else { (0.02, 1400) };
        let p = &case.profile;
        let ring = |i: i32| {
            let r = p.scale() * (step * f64::from(i)).exp();
            2.0 * PI * r * p.eval_times_r(r) * step
        };
        let found: f64 = (-count..=count).map(ring).sum();
        assert!(
            (found - p.surface_albedo()).abs() < 1e-8 * p.surface_albedo(),
            "{}: {found} is not {}",
            case.label,
            p.surface_albedo()
        );
    }
}

#[test]
fn total_is_the_surface_albedo_asked_for() {
    for case in cases() {
        let (found, asked) = (case.profile.surface_albedo(), case.appearance.surface_albedo);
        assert!((found - asked).abs() < 1e-10, "{}: {found}", case.label);
    }
}

#[test]
fn total_is_that_of_the_albedo_alone() {
    for model in models() {
        let (Some(from_medium), Some(total)) = (model.from_medium, model.total) else { continue };
        for &eta in model.etas {
            for &g in model.gs {
                for absorbed in [0.0, 1e-12, 1e-6, 0.01, 0.3, 0.9, 1.0] {
                    let medium = Medium::from_reduced(2.0 * absorbed, 2.0 * (1.0 - absorbed), g).unwrap();
                    let found = from_medium(&medium, eta).unwrap().surface_albedo();
                    let expected = total(absorbed, g, eta).unwrap();
                    assert!(
                        (found - expected).abs() < 1e-13,
                        "{} {eta} {g} {absorbed}: {found} is not {expected}",
                        model.name
                    );
                }
            }
        }
    }
}

#[test]
fn new_is_from_medium_of_the_medium_found() {
    for model in models() {
        let (Some(from_medium), Some(total)) = (model.from_medium, model.total) else { continue };
        for case in cases_of(&model, 1.0) {
            let total = |absorbed| total(absorbed, case.appearance.g, case.eta).unwrap();
            let found = case.appearance.medium(total).unwrap();
            let other = from_medium(&found, case.eta).unwrap();
            for r in radii(&*case.profile, 2) {
                let (a, b) = (case.profile.eval(r), other.eval(r));
                assert!((a - b).abs() <= 1e-13 * b, "{} at {r}: {a} is not {b}", case.label);
            }
        }
    }
}

#[test]
fn enclosed_and_beyond_make_the_total() {
    for case in cases() {
        let p = &case.profile;
        let mut before = 0.0;
        for r in radii(&**p, 8) {
            let (within, beyond) = (p.enclosed(r), p.beyond(r));
            assert!(
                (within + beyond - p.surface_albedo()).abs() < 1e-12 * p.surface_albedo(),
                "{} at {r}",
                case.label
            );
            // Rising but for the last digits
            assert!(within >= before * (1.0 - 1e-15), "{} at {r}: {within} after {before}", case.label);
            before = within;
        }
        assert_eq!(p.enclosed(0.0), 0.0, "{}", case.label);
        assert!((p.beyond(0.0) / p.surface_albedo() - 1.0).abs() < 1e-12, "{}", case.label);
        assert!((p.enclosed(f64::INFINITY) / p.surface_albedo() - 1.0).abs() < 1e-12, "{}", case.label);
    }
}

/// By the Gauss rule between radii that differ by a quarter of an octave, relative to what lies within and beyond:
/// the digits of small and large radii count.
/// Densities and shares are those of the values and energies, whether derived from them or in closed form.
#[test]
fn shares_are_energies_over_the_surface_albedo() {
    for case in cases() {
        let p = &case.profile;
        let a = p.surface_albedo();
        for r in radii(&**p, 3) {
            let pairs = [
                (p.pdf(r), 2.0 * PI * p.eval_times_r(r) / a),
                (p.pdf_area(r), p.eval(r) / a),
                (p.cdf(r), p.enclosed(r) / a),
                (p.complementary_cdf(r), p.beyond(r) / a),
            ];
            for (i, (found, expected)) in pairs.into_iter().enumerate() {
                assert!((found - expected).abs() <= 1e-12 * expected + 1e-300, "{} at {r}: {i}", case.label);
            }
        }
    }
}

/// Not above 1 by rounding: a quantile of it is asked for next.
#[test]
fn shares_are_at_most_one() {
    for case in cases() {
        let p = &case.profile;
        for i in 0..600 {
            let r = p.scale() * 10.0_f64.powf(f64::from(i) / 100.0 - 3.0);
            for share in [p.cdf(r), p.complementary_cdf(r)] {
                assert!((0.0..=1.0).contains(&share), "{} at {r}: {share:e}", case.label);
            }
        }
    }
}

#[test]
fn quantile_inverts_cdf() {
    for case in cases() {
        let p = &case.profile;
        assert_eq!(p.quantile(0.0), 0.0, "{}", case.label);
        for share in [1e-6, 0.03, 0.3, 0.5] {
            let [inner, outer] = [p.quantile(share), p.quantile_complement(share)];
            let found = [p.cdf(inner), p.complementary_cdf(outer)];
            for found in found {
                assert!((found / share - 1.0).abs() < 1e-9, "{}: {found} is not {share}", case.label);
            }
            assert!(inner <= outer * (1.0 + 1e-9), "{}: {inner} {outer}", case.label);
            let other = p.quantile_complement(1.0 - share);
            assert!((other / inner - 1.0).abs() < 1e-7, "{}: {other} is not {inner}", case.label);
        }
    }
}

/// Samples at the middles of equal strata fall into four equal bins: all alike from a sampler that is monotone, but for
/// a few at the ends of its terms from one that goes term by term.
#[test]
fn samples_have_the_distribution() {
    const COUNT: i32 = 128;
    for case in cases() {
        let p = &case.profile;
        let mut bins = [0.0; 4];
        for i in 0..COUNT {
            let r = p.sample((f64::from(i) + 0.5) / f64::from(COUNT));
            bins[((4.0 * p.cdf(r)) as usize).min(3)] += 1.0;
        }
        for bin in bins {
            assert!((bin / f64::from(COUNT) - 0.25f64).abs() < 0.04, "{}: {bins:?}", case.label);
        }
    }
}

#[test]
fn enclosed_is_the_integral_of_eval() {
    let rule = gauss_legendre(64);
    for case in cases() {
        let p = &case.profile;
        // Both integrals of photon beam diffusion have 8 digits
        let tolerance = match case.smooth {
            false => 1e-5,
            true if case.label.contains("Beam") => 1e-7,
            true => 1e-10,
        };
        for a in radii(&**p, 1) {
            let b = a * 2f64.powf(0.25);
            let ring = integrate(&rule, a, b, |r| 2.0 * PI * p.eval_times_r(r));
            let within = p.enclosed(b) - p.enclosed(a);
            assert!(
                (ring - within).abs() <= tolerance * p.enclosed(b),
                "{} at {a}: {within:e} is not {ring:e}",
                case.label
            );
            let beyond = p.beyond(a) - p.beyond(b);
            let tiny = 1e-290;
            assert!(
                (ring - beyond).abs() <= tolerance * p.beyond(a) + tiny,
                "{} at {a}: {beyond:e} is not {ring:e}",
                case.label
            );
        }
    }
}

#[test]
fn eval_is_not_negative_and_continuous() {
    for case in cases() {
        let p = &case.profile;
        let greatest = p.eval(1e-6 * p.scale());
        for r in radii(&**p, 16) {
            let value = p.eval(r);
            assert!(value >= 0.0, "{} at {r}: {value}", case.label);
            assert!(
                (p.eval_times_r(r) - r * value).abs() <= 1e-14 * r * value + 1e-290,
                "{} at {r}: {value}",
                case.label
            );
            // The logarithmic slope is at most a few hundred where anything is left
            let step = p.eval(r * (1.0 + 1e-9)) - value;
            if value > 1e-100 * greatest {
                assert!(step.abs() <= 1e-6 * value, "{} at {r}: {value} and a step of {step}", case.label);
            }
        }
    }
}

#[test]
fn eval_is_continuous_in_the_surface_albedo() {
    for model in models() {
        for case in cases_of(&model, 1.0) {
            // Light far away rests on what is missing to the limit: a millionth of that, or of A
            let a = case.appearance.surface_albedo;
            let surface_albedo = a - (1e-6 * a.min(case.limit - a)).max(1e-12 * a);
            let other = (model.new)(&Appearance { surface_albedo, ..case.appearance }, case.eta).unwrap();
            for r in radii(&*case.profile, 2) {
                let r = r.min(10.0 * case.profile.scale());
                let (a, b) = (case.profile.eval(r), other.eval(r));
                assert!((a - b).abs() <= 1e-4 * b, "{} at {r}: {a} is not {b}", case.label);
            }
        }
    }
}

/// Arguments at the ends of the numbers, and beyond them.
const ODD: [f64; 19] = [
    0.0,
    -0.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    -1.0,
    5e-324,
    f64::MIN_POSITIVE,
    1e-300,
    1e-150,
    1e-60,
    0.25,
    1.0 - f64::EPSILON / 2.0,
    1.0,
    1.5,
    1e60,
    1e150,
    1e300,
    f64::MAX,
];

/// All that a profile says of a radius and of a share is a number, at least 0.
fn assert_finite(p: &dyn Profile, r: f64, share: f64, label: &str) {
    let of_radius = [p.eval(r), p.eval_times_r(r), p.enclosed(r), p.beyond(r)];
    let shares = [p.pdf(r), p.pdf_area(r), p.cdf(r), p.complementary_cdf(r)];
    let of_share = [p.quantile(share), p.quantile_complement(share), p.sample(share)];
    for value in of_radius.into_iter().chain(shares).chain(of_share) {
        assert!(value.is_finite() && value >= 0.0, "{label} at {r} or {share}: {value}");
    }
}

#[test]
fn every_method_is_finite_for_any_radius() {
    for model in models() {
        for length in [1e-100, 1e-60, 1.0, 1e60, 1e100] {
            for case in cases_of(&model, length) {
                let p = &case.profile;
                for r in ODD {
                    // Shares take searches, where lengths do not matter
                    let share = if length == 1.0 { r } else { 0.3 };
                    assert_finite(&**p, r, share, &case.label);
                    assert!(p.enclosed(r) <= p.surface_albedo() * (1.0 + 1e-12), "{} at {r}", case.label);
                }
                for r in [-0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
                    assert_eq!(p.eval(r), p.eval(0.0), "{} at {r}", case.label);
                    assert_eq!(p.enclosed(r), 0.0, "{} at {r}", case.label);
                }
                assert!(p.scale() > 0.0 && p.scale().is_finite(), "{}", case.label);
            }
        }
    }
}

/// Closed forms take lengths from 1e-150 to 1e150.
#[test]
fn closed_forms_are_finite_at_the_ends_of_their_lengths() {
    let (mfp, searchlight) = (Parameterization::Mfp, Configuration::Searchlight);
    for (a, length) in [(0.0, 1e-150), (1.0, 1e-150), (1.0, 1e150), (1e-300, 1e150)] {
        let burley = NormalizedDiffusion::from_d(a, length).unwrap();
        let refined = RefinedDiffusion::new(a, length, mfp, searchlight).unwrap();
        for x in ODD {
            assert_finite(&burley, x, x, "NormalizedDiffusion");
            assert_finite(&refined, x, x, "RefinedDiffusion");
        }
        let moments = [burley.mean_squared_radius(), refined.mean_squared_radius()];
        assert!(moments.iter().all(|moment| moment.is_finite()), "{moments:?}");
    }
}

#[test]
fn profile_scales_with_the_length() {
    for model in models() {
        for length in LENGTHS {
            for (case, unit) in cases_of(&model, length).iter().zip(cases_of(&model, 1.0)) {
                for r in radii(&*unit.profile, 2) {
                    let (p, q) = (&case.profile, &unit.profile);
                    let pairs = [
                        (p.eval(r * length) * length * length, q.eval(r)),
                        (p.enclosed(r * length), q.enclosed(r)),
                        (p.beyond(r * length), q.beyond(r)),
                    ];
                    for (a, b) in pairs {
                        // An exponential multiplies the rounding of its exponent; 1e60² of underflow
                        let exponent = (q.eval(0.0) / b.max(1e-300)).ln().clamp(0.0, 700.0);
                        let close = (a - b).abs() <= 1e-12 * (1.0 + 0.05 * exponent) * b + 1e-180;
                        assert!(close, "{} at {r}: {a:e} is not {b:e}", case.label);
                    }
                }
            }
        }
    }
}

#[test]
fn black_has_no_profile_left() {
    for model in models() {
        let appearance =
            Appearance { surface_albedo: 0.0, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
        let black = (model.new)(&appearance, 1.0).unwrap();
        for r in [0.0, 0.1, 1.0, f64::INFINITY] {
            let values = [black.eval(r), black.enclosed(r), black.beyond(r), black.surface_albedo()];
            assert_eq!(values, [0.0; 4], "{} at {r}", model.name);
        }
    }
}

#[test]
fn constructors_refuse_what_is_out_of_range() {
    let good =
        Appearance { surface_albedo: 0.5, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
    for model in models() {
        let refuses = |appearance: Appearance, eta: f64| (model.new)(&appearance, eta).is_err();
        for surface_albedo in [-1e-9, 1.0 + 1e-9, f64::NAN, f64::INFINITY] {
            assert!(refuses(Appearance { surface_albedo, ..good }, 1.0), "{} {surface_albedo}", model.name);
        }
        for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(refuses(Appearance { length, ..good }, 1.0), "{} {length}", model.name);
        }
        if model.gs.len() > 1 {
            for g in [-1.0, 1.0, f64::NAN] {
                assert!(refuses(Appearance { g, ..good }, 1.0), "{} {g}", model.name);
            }
        }
        if model.etas.len() > 1 {
            for eta in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                assert!(refuses(good, eta), "{} {eta}", model.name);
            }
        }
    }
}
