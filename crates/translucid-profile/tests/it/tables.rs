//! The laws of tables, checked from outside the crate against the profiles that they were made from.

use std::f64::consts::PI;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU32, Ordering};

use translucid_profile::{
    AlbedoTable, AlbedoTableF32, Appearance, BetterDipole, Configuration, DirectionalDipoleAverage,
    ExactProfile, Medium, NormalizedDiffusion, ParameterError, Parameterization, PhotonBeamDiffusion,
    Profile, QuantizedDiffusion, StandardDipole, SumOfGaussians, TabulatedProfile,
};
use translucid_testing::{SplitMix, power};

/// Error of a table's cdf below the median, and of 1 − cdf above it, that its documentation promises.
const PROMISED: f64 = 1e-4;
/// Error that all but one of the models here reach.
const REACHED: f64 = 1e-5;

fn diffusion(surface_albedo: f64, d: f64) -> NormalizedDiffusion {
    NormalizedDiffusion::from_d(surface_albedo, d).expect("valid parameters")
}

/// Profiles of every model, each for strong and weak absorption, with and without a boundary.
fn sources() -> Vec<(String, Box<dyn Profile>)> {
    let mut sources: Vec<(String, Box<dyn Profile>)> = Vec::new();
    for (a, d) in [(0.3, 1.0), (1.0, 1e-100), (1e-12, 1e100)] {
        sources.push((format!("normalized diffusion, A {a}, d {d:e}"), Box::new(diffusion(a, d))));
    }
    for absorbed in [0.9, 0.3, 0.01, 1e-4] {
        for eta in [1.0, 1.4] {
            let medium = Medium::new(absorbed, 1.0 - absorbed, 0.0).expect("valid parameters");
            macro_rules! push {
                ($model:ident) => {
                    let profile = $model::from_medium(&medium, eta).expect("valid parameters");
                    let name = format!("{}, 1 − α {absorbed}, η {eta}", stringify!($model));
                    sources.push((name, Box::new(profile)));
                };
            }
            push!(StandardDipole);
            push!(BetterDipole);
            push!(QuantizedDiffusion);
            push!(PhotonBeamDiffusion);
            push!(DirectionalDipoleAverage);
        }
    }
    for a in [0.05, 0.7, 0.99] {
        let (parameterization, configuration) = (Parameterization::Mfp, Configuration::Searchlight);
        let exact = ExactProfile::new(a, 1.0, parameterization, configuration).expect("valid parameters");
        sources.push((format!("exact, A {a}"), Box::new(exact)));
        let gaussians =
            SumOfGaussians::new(a, 1.0, parameterization, configuration, SumOfGaussians::DEFAULT_TERMS);
        sources.push((format!("Gaussians, A {a}"), Box::new(gaussians.expect("valid parameters"))));
    }
    sources
}

/// A model in words, its profile, and the table of that.
type Tabulated = (String, Box<dyn Profile>, TabulatedProfile);

/// The sources with their tables.
static TABLES: LazyLock<Vec<Tabulated>> = LazyLock::new(|| {
    let tabulated = |(name, source): (String, Box<dyn Profile>)| {
        let table = TabulatedProfile::new(&*source);
        (name, source, table)
    };
    sources().into_iter().map(tabulated).collect()
});

/// Radii from 1e-7 to 1e4 times a profile's scale.
fn radii(scale: f64) -> impl Iterator<Item = f64> {
    (-1600..=920).map(move |i| scale * (0.01 * f64::from(i)).exp())
}

#[test]
fn table_has_the_cdf_of_its_source() {
    for (name, source, table) in &*TABLES {
        let total = source.surface_albedo();
        let (mut worst, mut worst_density) = (0.0f64, 0.0f64);
        for r in radii(source.scale()) {
            let (within, beyond) = (source.enclosed(r) / total, source.beyond(r) / total);
            let off = if within < 0.5 {
                (table.cdf(r) - within).abs() / within
            } else {
                (table.complementary_cdf(r) - beyond).abs() / beyond.max(1e-6)
            };
            // The last 1e-8 is an exponential whatever the source
            if beyond > 1e-8 {
                worst = worst.max(off);
            } else {
                assert!(off < PROMISED, "{name} {r}: {off:e}");
            }
            if beyond > 1e-6 {
                worst_density =
                    worst_density.max((table.eval_times_r(r) / source.eval_times_r(r) - 1.0).abs());
            }
        }
        // Its forty Gaussians leave ripples close to r = 0, which no cell follows
        let ripples = name.starts_with("QuantizedDiffusion");
        assert!(worst < if ripples { PROMISED } else { REACHED }, "{name}: {worst:e}");
        let said = table.cdf_error();
        assert!(worst < 10.0 * said + 1e-9 || ripples, "{name}: {worst:e}, said {said:e}");
        assert!(table.cdf_error() < PROMISED, "{name}: {:e}", table.cdf_error());
        assert!(worst_density < 4e-4, "{name}: {worst_density:e}");
        assert_eq!(table.surface_albedo(), total, "{name}");
    }
}

/// A profile that counts how many numbers it is asked for.
struct Counted<'a>(&'a dyn Profile, AtomicU32);

impl Counted<'_> {
    fn count(&self, number: f64) -> f64 {
        self.1.fetch_add(1, Ordering::Relaxed);
        number
    }
}

impl Profile for Counted<'_> {
    fn eval_times_r(&self, r: f64) -> f64 {
        self.count(self.0.eval_times_r(r))
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.count(self.0.enclosed(r))
    }

    fn beyond(&self, r: f64) -> f64 {
        self.count(self.0.beyond(r))
    }

    fn surface_albedo(&self) -> f64 {
        self.0.surface_albedo()
    }

    fn scale(&self) -> f64 {
        self.0.scale()
    }
}

#[test]
fn table_asks_for_few_numbers() {
    for (name, source, _) in &*TABLES {
        let counted = Counted(&**source, AtomicU32::new(0));
        TabulatedProfile::new(&counted);
        let asked = counted.1.into_inner();
        assert!((100..700).contains(&asked), "{name}: {asked}");
    }
}

/// Normalized diffusion that gives a length far from where its energy is.
struct Misleading(f64);

impl Profile for Misleading {
    fn eval_times_r(&self, r: f64) -> f64 {
        diffusion(0.5, 1.0).eval_times_r(r)
    }

    fn enclosed(&self, r: f64) -> f64 {
        diffusion(0.5, 1.0).enclosed(r)
    }

    fn beyond(&self, r: f64) -> f64 {
        Profile::beyond(&diffusion(0.5, 1.0), r)
    }

    fn surface_albedo(&self) -> f64 {
        0.5
    }

    fn scale(&self) -> f64 {
        self.0
    }
}

#[test]
fn table_does_not_rest_on_the_scale() {
    let expected = diffusion(0.5, 1.0);
    for scale in [1e-6, 1e-3, 0.1, 10.0, 40.0, 200.0, 1e3, 1e6] {
        let table = TabulatedProfile::new(&Misleading(scale));
        for r in radii(1.0) {
            let (found, expected) = (table.cdf(r), expected.cdf(r));
            assert!(
                (found - expected).abs() < 1e-5 * expected.max(1e-5),
                "{scale} at {r}: {found} {expected}"
            );
        }
    }
}

#[test]
fn cdf_rises_to_one_and_quantile_inverts_it() {
    for (name, source, table) in &*TABLES {
        let (mut within, mut beyond) = (0.0, 1.0);
        for r in radii(source.scale()) {
            let (u, v) = (table.cdf(r), table.complementary_cdf(r));
            assert!(u >= within && v <= beyond, "{name} {r:e}: {u} {v}");
            assert!((u + v - 1.0).abs() < 1e-14, "{name} {r:e}: {u} {v}");
            (within, beyond) = (u, v);
            // What the rounding of a share is worth in the radius
            let back = if u < 0.5 { table.quantile(u) } else { table.quantile_complement(v) };
            let steep = u.min(v) / (r * table.pdf(r)).max(1e-300);
            assert!((back / r - 1.0).abs() < 1e-13 + 1e-15 * steep || v < 1e-300, "{name} {r:e}: {back:e}");
        }
        assert!(within > 1.0 - 1e-12, "{name}: {within}");
        assert_eq!((table.cdf(0.0), table.complementary_cdf(0.0)), (0.0, 1.0), "{name}");
    }
}

#[test]
fn pdf_is_the_slope_of_cdf_and_integrates_to_one() {
    for (name, source, table) in &*TABLES {
        let scale = source.scale();
        let mut sum = 0.0;
        let step: f64 = 0.01;
        for r in radii(scale) {
            // Every change is told by the end that has the digits
            let (a, b) = (r * (-0.5 * step).exp(), r * (0.5 * step).exp());
            let change = if table.cdf(r) < 0.5 {
                table.cdf(b) - table.cdf(a)
            } else {
                table.complementary_cdf(a) - table.complementary_cdf(b)
            };
            // Simpson's rule in the radius: its error is some step⁵, but where a knot lies within,
            // at which the density has a bend
            let middle = 0.5 * (a + b);
            let expected = (b - a) / 6.0 * (table.pdf(a) + 4.0 * table.pdf(middle) + table.pdf(b));
            let is_fine = (change - expected).abs() <= 3e-5 * expected || change < 1e-8;
            assert!(is_fine, "{name} {r:e}: {change:e} {expected:e}");
            sum += expected;
            let area = table.pdf(r) / (2.0 * PI * r);
            assert!(
                (table.pdf_area(r) / area - 1.0).abs() < 1e-14 || !(1e-290..=1e290).contains(&area),
                "{name} {r:e}"
            );
        }
        assert!((sum - 1.0).abs() < 1e-6, "{name}: {sum}");
    }
}

/// Greatest distance between a cdf and that of samples, times √n (Kolmogorov and Smirnov).
///
/// Whatever their number n, it exceeds 2.2 by chance once in 8,000 (2 e^{−2·2.2²}).
/// The samples here are fixed, so that a test either always passes or never does.
fn kolmogorov_smirnov(mut samples: Vec<f64>, cdf: impl Fn(f64) -> f64) -> f64 {
    samples.sort_by(f64::total_cmp);
    let count = samples.len() as f64;
    let steps = samples.iter().enumerate().map(|(i, sample)| {
        let share = cdf(*sample);
        (share - i as f64 / count).abs().max((share - (i + 1) as f64 / count).abs())
    });
    steps.fold(0.0, f64::max) * count.sqrt()
}

/// A false alarm once in 160 for the 49 profiles here.
#[test]
fn samples_are_distributed_like_the_source() {
    for (name, source, table) in &*TABLES {
        let mut random = SplitMix(1);
        let radii = (0..power(100_000)).map(|_| table.sample(random.uniform())).collect();
        let statistic = kolmogorov_smirnov(radii, |r| source.enclosed(r) / source.surface_albedo());
        assert!(statistic < 2.2, "{name}: {statistic}");
    }
}

/// Arguments that a caller may come to by mistake.
const ARGUMENTS: [f64; 14] = [
    0.0,
    -0.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    -1.0,
    5e-324,
    f64::MIN_POSITIVE,
    1e-150,
    0.25,
    1.0,
    1.5,
    1e150,
    f64::MAX,
];

fn assert_finite(name: &str, table: &TabulatedProfile) {
    for x in ARGUMENTS {
        let values = [
            table.eval(x),
            table.eval_times_r(x),
            table.pdf(x),
            table.pdf_area(x),
            table.cdf(x),
            table.complementary_cdf(x),
            table.enclosed(x),
            table.quantile(x),
            table.quantile_complement(x),
            table.sample(x),
        ];
        for (i, value) in values.into_iter().enumerate() {
            assert!(value.is_finite() && value >= 0.0, "{name}, method {i} of {x}: {value}");
        }
    }
}

#[test]
fn every_method_is_finite_for_any_argument() {
    for (name, _, table) in &*TABLES {
        assert_finite(name, table);
    }
    for (a, d) in [(0.0, 1e-150), (1.0, 1e-150), (0.5, 1.0), (1.0, 1e150), (1e-300, 1e150), (1e-320, 1.0)] {
        assert_finite(&format!("A {a:e}, d {d:e}"), &TabulatedProfile::new(&diffusion(a, d)));
    }
}

#[test]
fn black_has_a_shape_to_sample() {
    let table = TabulatedProfile::new(&diffusion(0.0, 2.0));
    assert_eq!((table.surface_albedo(), table.eval(1.0), table.enclosed(1.0)), (0.0, 0.0, 0.0));
    let median = diffusion(1.0, 2.0).quantile(0.5);
    assert!((table.sample(0.5) / median - 1.0).abs() < 1e-6);
}

#[test]
fn scaled_shares_the_shape() {
    let table = TabulatedProfile::new(&diffusion(0.8, 0.7));
    let scaled = table.scaled(3.0, 0.2).expect("valid parameters");
    for r in [1e-9, 0.1, 1.0, 10.0, 1000.0] {
        assert!((scaled.cdf(3.0 * r) - table.cdf(r)).abs() < 1e-14);
        assert!((scaled.eval(3.0 * r) * 9.0 * 4.0 / table.eval(r) - 1.0).abs() < 1e-12);
    }
    assert_eq!(scaled.surface_albedo(), 0.2);
    for (factor, a) in [(0.0, 0.5), (-1.0, 0.5), (f64::NAN, 0.5), (1.0, 1.1), (1.0, f64::NAN)] {
        assert!(table.scaled(factor, a).is_err(), "{factor} {a}");
    }
}

type Model = fn(f64) -> Result<Box<dyn Profile>, ParameterError>;

fn appearance(surface_albedo: f64, parameterization: Parameterization) -> Appearance {
    Appearance { surface_albedo, length: 1.0, parameterization, g: 0.0 }
}

/// Models of length 1 as functions of the surface albedo.
const MODELS: [(&str, Model); 9] = [
    ("normalized diffusion", |a| {
        let (parameterization, configuration) = (Parameterization::Mfp, Configuration::Searchlight);
        Ok(Box::new(NormalizedDiffusion::new(a, 1.0, parameterization, configuration)?))
    }),
    ("dipole, eta 1.3", |a| Ok(Box::new(StandardDipole::new(&appearance(a, Parameterization::Mfp), 1.3)?))),
    ("better dipole", |a| Ok(Box::new(BetterDipole::new(&appearance(a, Parameterization::Mfp), 1.0)?))),
    ("dipole by dmfp", |a| Ok(Box::new(StandardDipole::new(&appearance(a, Parameterization::Dmfp), 1.0)?))),
    ("quantized diffusion", |a| {
        Ok(Box::new(QuantizedDiffusion::new(&appearance(a, Parameterization::Mfp), 1.4)?))
    }),
    ("photon beam diffusion", |a| {
        Ok(Box::new(PhotonBeamDiffusion::new(&appearance(a, Parameterization::Mfp), 1.0)?))
    }),
    ("directional dipole", |a| {
        Ok(Box::new(DirectionalDipoleAverage::new(&appearance(a, Parameterization::Mfp), 1.3)?))
    }),
    ("exact", |a| {
        Ok(Box::new(ExactProfile::new(a, 1.0, Parameterization::Mfp, Configuration::Searchlight)?))
    }),
    ("gaussians", |a| {
        let (parameterization, configuration) = (Parameterization::Mfp, Configuration::Searchlight);
        Ok(Box::new(SumOfGaussians::new(a, 1.0, parameterization, configuration, 4)?))
    }),
];

/// The models with their tables for every surface albedo.
static EVERY_ALBEDO: LazyLock<Vec<(&str, Model, AlbedoTable)>> = LazyLock::new(|| {
    let every = |&(name, model): &(&'static str, Model)| {
        (name, model, AlbedoTable::for_every_albedo(model).expect("a model of every albedo"))
    };
    MODELS.iter().map(every).collect()
});

#[test]
fn rows_are_the_model_and_between_them_is_little_else() {
    for (name, model, table) in &*EVERY_ALBEDO {
        assert!(table.cdf_error_of_rows() < REACHED, "{name}");
        let rows = table.surface_albedos();
        for pair in rows.windows(2) {
            for (a, allowed) in [(pair[0], 3e-6), (0.5 * (pair[0] + pair[1]), 1e-4)] {
                let (source, view) = (model(a).expect("between rows"), table.at(a, 1.0));
                let off = |r: f64| (view.cdf(r) - source.enclosed(r) / source.surface_albedo()).abs();
                let worst = radii(source.scale()).step_by(7).map(off).fold(0.0, f64::max);
                // The Gaussians of its ripples come and go towards white
                let allowed = if *name == "quantized diffusion" && a > 0.999 { 3e-4 } else { allowed };
                assert!(worst < allowed, "{name} {a}: {worst:e}");
                assert_eq!(view.surface_albedo(), a);
            }
        }
    }
}

#[test]
fn views_are_distributions() {
    for (name, _, table) in &*EVERY_ALBEDO {
        for (a, length) in [(0.0, 1.0), (0.02, 3.0), (0.5, 1e-100), (0.83, 1e100), (0.997, 0.1), (1.0, 1.0)] {
            let view = table.at(a, length);
            let (mut within, mut sum, step) = (0.0, 0.0, 0.01f64);
            for r in radii(view.quantile(0.5)) {
                let (u, v) = (view.cdf(r), view.complementary_cdf(r));
                assert!(u >= within && (u + v - 1.0).abs() < 1e-14, "{name} {a} {r:e}");
                within = u;
                let back = if u < 0.5 { view.quantile(u) } else { view.quantile_complement(v) };
                let steep = u.min(v) / (r * view.pdf(r)).max(1e-300);
                assert!(
                    (back / r - 1.0).abs() < 1e-13 + 1e-15 * steep || v < 1e-300,
                    "{name} {a} {r:e}: {back:e}"
                );
                sum += view.pdf(r) * r * step;
            }
            assert!((sum - within).abs() < 1e-6, "{name} {a}: {sum} {within}");
            for tail in [1e-9, 1e-3, 0.1, 0.9] {
                let beyond = view.complementary_cdf(view.truncation_radius(tail));
                assert!(beyond <= tail * (1.0 + 1e-12) && beyond > 0.5 * tail, "{name} {a} {tail}: {beyond}");
            }
        }
    }
}

/// A false alarm once in 400 for the 18 cases here.
#[test]
fn half_of_the_energy_leaves_within_the_median_radius() {
    for (name, _, table) in &*EVERY_ALBEDO {
        let single = AlbedoTableF32::from(table);
        for a in [0.0, 1e-3, 0.02, 0.3, 0.777, 0.9531, 0.9999, 1.0] {
            let within = table.at(a, 3.0).cdf(table.median_radius(a, 3.0));
            assert!((within - 0.5).abs() < 1e-9, "{name} {a}: {within}");
            let within = single.at(a as f32, 3.0).cdf(single.median_radius(a as f32, 3.0));
            assert!((within - 0.5).abs() < 1e-5, "{name} {a} in single precision: {within}");
        }
        assert!(table.median_radius(f64::NAN, f64::INFINITY).is_finite(), "{name}");
        assert!(single.median_radius(f32::INFINITY, f32::NAN) > 0.0, "{name}");
    }
}

#[test]
fn samples_of_views_are_distributed_like_their_cdf() {
    for (name, _, table) in &*EVERY_ALBEDO {
        let view = table.at(0.7654, 2.0);
        let r_max = view.truncation_radius(0.05);
        let mut random = SplitMix(7);
        for limit in [f64::INFINITY, r_max] {
            let mut sample = || {
                let u = random.uniform();
                if limit.is_finite() { view.sample_within(u, limit) } else { view.sample(u) }
            };
            let radii: Vec<f64> = (0..power(100_000)).map(|_| sample()).collect();
            assert!(radii.iter().all(|r| *r <= limit));
            let statistic = kolmogorov_smirnov(radii, |r| view.cdf(r) / view.cdf(limit));
            assert!(statistic < 2.2, "{name} {limit}: {statistic}");
        }
    }
}

#[test]
fn single_precision_follows_double() {
    for (name, _, table) in &*EVERY_ALBEDO {
        let twin = AlbedoTableF32::from(table);
        for (a, length) in [(0.0f32, 1.0f32), (0.02, 3.0), (0.5, 1e-9), (0.83, 1e9), (0.997, 0.1), (1.0, 1.0)]
        {
            let (exact, view) = (table.at(f64::from(a), f64::from(length)), twin.at(a, length));
            for r in radii(exact.quantile(0.5)).map(|r| r as f32) {
                let at = f64::from(r);
                let pairs = [
                    (view.cdf(r), exact.cdf(at)),
                    (view.complementary_cdf(r), exact.complementary_cdf(at)),
                    (view.pdf(r), exact.pdf(at)),
                    (view.pdf_area(r), exact.pdf_area(at)),
                ];
                for (i, (found, expected)) in pairs.into_iter().enumerate() {
                    let off = (f64::from(found) / expected - 1.0).abs();
                    // Tails of 1e-9 are what no random number of single precision gets to
                    let matters = exact.complementary_cdf(at) > 1e-9;
                    assert!(off < 1e-5 || !matters, "{name} {a} {length:e} {r:e}, method {i}: {off:e}");
                }
            }
            for u in (0..=1000).map(|i| i as f32 / 1000.0) {
                let (found, expected) = (view.sample(u), exact.sample(f64::from(u)));
                // Near the lower row's share, which is rounded, u decides about the row
                let off = (f64::from(found) / expected - 1.0).abs();
                let [low, high] = [-2e-7, 2e-7].map(|shift| exact.sample(f64::from(u) + shift));
                let is_near = f64::from(found) >= 0.99999 * low.min(high)
                    && f64::from(found) <= 1.00001 * low.max(high);
                assert!(
                    off < 1e-5 || is_near || u == 1.0,
                    "{name} {a} {length:e} {u}: {found:e} {expected:e}"
                );
                let r_max = view.truncation_radius(0.01);
                assert!(view.complementary_cdf(r_max) <= 0.0100001 && view.complementary_cdf(r_max) > 0.007);
                let r = view.sample_within(u, r_max);
                assert!(r >= 0.0 && r <= r_max, "{name} {a} {u}: {r}");
            }
        }
    }
}

/// Shares of the energy within a radius that are drawn below it are even.
#[test]
fn sample_within_is_exact_in_single_precision() {
    for (name, _, table) in &*EVERY_ALBEDO {
        let table = AlbedoTableF32::from(table);
        for a in [0.3, 0.9531] {
            let view = table.at(a, 1.0);
            let r_max = view.truncation_radius(0.02);
            // Equidistant numbers: both rows' parts are integrated by the midpoint rule
            const COUNT: u32 = 100_000;
            let mut shares = [0u32; 64];
            for i in 0..COUNT {
                let r = view.sample_within((i as f32 + 0.5) / COUNT as f32, r_max);
                let share = view.cdf(r) / view.cdf(r_max);
                shares[((share * 64.0) as usize).min(63)] += 1;
            }
            for (bin, count) in shares.iter().enumerate() {
                let expected = f64::from(COUNT) / 64.0;
                // Each row puts a number of samples into a bin that is off by two at most
                assert!(
                    (f64::from(*count) - expected).abs() < 8.0,
                    "{name} {a} bin {bin}: {count} {expected}"
                );
            }
        }
    }
}

#[test]
fn views_are_finite_for_any_argument() {
    for (name, _, table) in &*EVERY_ALBEDO {
        let twin = AlbedoTableF32::from(table);
        for (a, length) in ARGUMENTS.iter().flat_map(|a| ARGUMENTS.map(|length| (*a, length))) {
            let (view, narrow) = (table.at(a, length), twin.at(a as f32, length as f32));
            for x in ARGUMENTS {
                let values = [
                    view.eval(x),
                    view.eval_times_r(x),
                    view.pdf(x),
                    view.pdf_area(x),
                    view.cdf(x),
                    view.complementary_cdf(x),
                    view.enclosed(x),
                    view.quantile(x),
                    view.quantile_complement(x),
                    view.sample(x),
                    view.truncation_radius(x),
                    view.sample_within(x, 1.0),
                    view.sample_within(0.5, x),
                ];
                for (i, value) in values.into_iter().enumerate() {
                    assert!(
                        value.is_finite() && value >= 0.0,
                        "{name} {a} {length}, method {i} of {x}: {value}"
                    );
                }
                let x = x as f32;
                let values = [
                    narrow.pdf(x),
                    narrow.pdf_area(x),
                    narrow.cdf(x),
                    narrow.complementary_cdf(x),
                    narrow.sample(x),
                    narrow.truncation_radius(x),
                    narrow.sample_within(x, 1.0),
                    narrow.sample_within(0.5, x),
                ];
                for (i, value) in values.into_iter().enumerate() {
                    assert!(
                        value.is_finite() && value >= 0.0,
                        "{name} {a} {length}, f32 method {i} of {x}: {value}"
                    );
                }
            }
        }
    }
}

#[test]
fn rows_must_rise() {
    let model: Model = MODELS[0].1;
    assert!(AlbedoTable::new(&[], model).is_err());
    assert!(AlbedoTable::new(&[0.5, 0.5], model).is_err());
    assert!(AlbedoTable::new(&[0.5, 1.5], model).is_err());
    assert!(AlbedoTable::new(&[f64::NAN], model).is_err());
    let message = AlbedoTable::new(&[0.5, 0.4], model).unwrap_err().to_string();
    assert_eq!(message, "surface_albedo is 0.4, but must be in [0, 1] and greater than the one before");
    let of_dmfp = AlbedoTable::new(&[0.5, 1.0], MODELS[3].1).unwrap_err();
    assert_eq!(of_dmfp.parameter, "surface_albedo");
    // Black has the shape of the next row
    let table = AlbedoTable::new(&[0.0, 0.5], model).expect("valid rows");
    assert_eq!(table.at(0.0, 1.0).cdf(0.3), table.at(0.5, 1.0).cdf(0.3));
}

/// Radii from 0.02 to 40 widths of normalized diffusion, and its samples and energies there.
fn samples() -> [Vec<f64>; 3] {
    let source = diffusion(0.8, 1.0);
    let radii: Vec<f64> = (0..=60).map(|i| 0.02 * 2000f64.powf(f64::from(i) / 60.0)).collect();
    [
        radii.clone(),
        radii.iter().map(|r| source.eval(*r)).collect(),
        radii.iter().map(|r| source.enclosed(*r)).collect(),
    ]
}

#[test]
fn samples_make_the_profile_they_are_of() {
    let source = diffusion(0.8, 1.0);
    let [radii, reflectances, enclosed] = samples();
    let from_samples = TabulatedProfile::from_samples(&radii, &reflectances).expect("valid samples");
    let from_enclosed = TabulatedProfile::from_enclosed(&radii, &enclosed).expect("valid energies");
    let from_both =
        TabulatedProfile::from_samples_and_enclosed(&radii, &reflectances, &enclosed).expect("valid samples");
    // Far out neighbouring samples differ by a factor of three, which is what the errors of R are about
    for (table, energy, value) in
        [(&from_samples, 6e-5, 2e-2), (&from_enclosed, 1e-5, 3e-2), (&from_both, 1e-5, 3e-2)]
    {
        assert!((table.surface_albedo() - 0.8).abs() < energy, "{}", table.surface_albedo());
        assert!(table.cdf_error() < PROMISED, "{:e}", table.cdf_error());
        let (mut worst, mut worst_value) = (0.0f64, 0.0f64);
        for i in 0..=700 {
            let r = 0.001 * 35_000f64.powf(f64::from(i) / 700.0);
            worst = worst.max((table.enclosed(r) - source.enclosed(r)).abs());
            worst_value = worst_value.max((table.eval(r) / source.eval(r) - 1.0).abs());
        }
        assert!(worst < energy && worst_value < value, "{worst:e} {worst_value:e}");
    }
    // Energies that were given are kept
    for (r, energy) in radii.iter().zip(&enclosed) {
        for table in [&from_enclosed, &from_both] {
            assert!((table.enclosed(*r) - energy).abs() < 1e-5, "{r}: {} {energy}", table.enclosed(*r));
        }
    }
    assert_finite("from samples", &from_samples);
    assert_finite("from enclosed", &from_enclosed);
}

#[test]
fn noise_and_zeros_make_a_distribution() {
    let [radii, mut reflectances, _] = samples();
    let mut random = SplitMix(3);
    for value in &mut reflectances {
        *value *= 0.5 + random.uniform();
    }
    for i in [0, 7, 30, 31, 59, 60] {
        reflectances[i] = 0.0;
    }
    let table = TabulatedProfile::from_samples(&radii, &reflectances).expect("valid samples");
    assert!((table.surface_albedo() - 0.8).abs() < 0.1, "{}", table.surface_albedo());
    let mut within = 0.0;
    for i in 0..=5000 {
        let u = table.cdf(0.01 * f64::from(i));
        assert!(u >= within, "{i}");
        within = u;
    }
    assert!(within > 1.0 - 1e-6);
    assert_finite("noise", &table);
}

#[test]
fn errors_of_energies_say_which() {
    let error = |radii: &[f64], energies: &[f64]| {
        TabulatedProfile::from_enclosed(radii, energies).unwrap_err().to_string()
    };
    let (radii, good) = ([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.27, 0.3]);
    assert!(TabulatedProfile::from_enclosed(&radii, &good).is_ok());
    assert_eq!(error(&radii[..3], &good[..3]), "number of radii is 3, but must be at least 4");
    let expected = "radius is 2, but must be in [1e-150, 1e150] and greater than the one before by 1e-9 of itself; its index is 2";
    assert_eq!(error(&[1.0, 2.0, 2.0, 3.0], &good), expected);
    assert!(error(&[f64::NAN, 2.0, 3.0, 4.0], &good).starts_with("radius is NaN"));
    assert_eq!(
        error(&radii, &good[..3]),
        "number of enclosed energies is 3, but must be that of the radii, 4"
    );
    assert_eq!(
        error(&radii, &[0.1, 0.3, 0.2, 0.4]),
        "enclosed is 0.2, but must be finite and no less than the one before; its index is 2"
    );
    assert!(error(&radii, &[0.1, 0.2, 0.3, 0.5]).starts_with("energy per length of the last ring"));
    assert!(error(&radii, &[0.0; 4]).starts_with("energy of all samples is 0"));
    let both = |reflectances: &[f64]| {
        TabulatedProfile::from_samples_and_enclosed(&radii, reflectances, &good).unwrap_err().to_string()
    };
    assert_eq!(both(&[1.0, -1.0, 1.0, 0.1]), "reflectance is -1, but must be in [0, 1e300); its index is 1");
    // r R rises: what lies beyond would be infinite
    assert!(both(&[1.0; 4]).starts_with("rate at which r R falls"));
    assert!(both(&[0.0; 4]).starts_with("number of reflectances is 0"));
}
