//! Laws that the BSDF of any material obeys, as tests.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use glam::Vec3;
use translucid_testing::SplitMix;

use super::{
    Bsdf, BsdfSample, BsdfValue, EntryBsdf, Lobe, MaterialTables, SurfaceParameters, fresnel_dielectric,
};

/// Random numbers, directions and materials.
struct Random(SplitMix);

impl Random {
    fn of(seed: u64) -> Self {
        Self(SplitMix(seed))
    }

    fn next(&mut self) -> f32 {
        self.0.uniform_f32()
    }

    fn pair(&mut self) -> [f32; 2] {
        [self.next(), self.next()]
    }

    /// A material of a sheet.
    fn thin_walled(&mut self, indices: [f32; 2]) -> SurfaceParameters {
        thin_walled(self.material(indices), 2.0 * self.next() - 1.0)
    }

    fn color(&mut self) -> Vec3 {
        Vec3::new(self.corner(), self.corner(), self.corner())
    }

    /// Uniform in [0, 1], but an end of it in one case of two.
    fn corner(&mut self) -> f32 {
        let x = self.next();
        if x < 0.25 {
            0.0
        } else if x < 0.5 {
            1.0
        } else {
            2.0 * x - 1.0
        }
    }

    /// A direction over the whole sphere, grazing in one case of four.
    fn direction(&mut self) -> Vec3 {
        let mut z = 2.0 * self.next() - 1.0;
        if self.next() < 0.25 {
            z *= 1e-6;
        }
        let (sin, cos) = (TAU * self.next()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * cos, r * sin, z).normalize()
    }

    fn material(&mut self, indices: [f32; 2]) -> SurfaceParameters {
        SurfaceParameters {
            base_color: self.color(),
            metalness: self.corner(),
            specular_weight: self.corner(),
            specular_color: self.color(),
            specular_roughness: self.corner(),
            specular_ior: indices[0],
            transmission_weight: self.corner(),
            transmission_tint: self.color(),
            subsurface_weight: self.corner(),
            surface_albedo: self.color(),
            subsurface_active: [self.next() < 0.5, self.next() < 0.5, self.next() < 0.5],
            thin_wall: None,
            coat_weight: self.corner(),
            coat_color: self.color(),
            coat_roughness: self.corner(),
            coat_ior: indices[1],
        }
    }
}

/// A direction of cosine `mu` in the plane of x and z.
fn direction(mu: f32) -> Vec3 {
    Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu)
}

/// A material as that of a sheet, which scatters with the mean cosine `g`.
fn thin_walled(p: SurfaceParameters, g: f32) -> SurfaceParameters {
    SurfaceParameters { subsurface_active: [false; 3], ..p }.scattered_to_both_sides(g)
}

fn white() -> SurfaceParameters {
    SurfaceParameters { base_color: Vec3::ONE, surface_albedo: Vec3::ONE, ..SurfaceParameters::default() }
}

/// Mean and standard error of the weight under uniform unit light, subsurface scattering returning its A
/// times the tint of the coat on entry.
fn furnace(p: &SurfaceParameters, tables: &MaterialTables, wo: Vec3) -> (f64, f64) {
    const SIDE: usize = 24;
    let bsdf = Bsdf::new(p, tables, wo);
    let entry_tint = (1.0 + (p.coat_color.y - 1.0) * p.coat_weight).sqrt();
    let mut random = Random::of(7);
    let (mut sum, mut squares, mut n) = (0.0, 0.0, 0.0);
    for k in 0..SIDE * SIDE * SIDE {
        let cell = |i: usize, x: f32| ((i % SIDE) as f32 + x) / SIDE as f32;
        let v = [cell(k / SIDE, random.next()), cell(k / (SIDE * SIDE), random.next())];
        let weight = match bsdf.sample(cell(k, random.next()), v) {
            Some(BsdfSample::Direction { weight, .. }) => weight.y,
            Some(BsdfSample::Subsurface { weight }) => weight.y * p.surface_albedo.y * entry_tint,
            None => 0.0,
        };
        sum += f64::from(weight);
        squares += f64::from(weight * weight);
        n += 1.0;
    }
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

/// Asserts that a white material returns all light, to `tolerance` and 4 standard errors
/// (6e-5 per check for independent samples; stratification makes it rarer).
fn assert_furnace(p: &SurfaceParameters, tables: &MaterialTables, side: f32, tolerance: f64) {
    for roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
        let p = SurfaceParameters { specular_roughness: roughness, ..*p };
        for mu in [0.05, 0.2, 0.5, 0.8, 1.0] {
            let (mean, error) = furnace(&p, tables, direction(mu) * Vec3::new(1.0, 1.0, side));
            let difference = (mean - 1.0).abs();
            assert!(
                difference < tolerance + 4.0 * error,
                "roughness {roughness}, cos {mu}: {mean} ± {error}"
            );
        }
    }
}

#[test]
fn furnace_of_white_matte_under_specular_is_one() {
    for ior in [1.0, 1.33, 1.5, 2.5] {
        assert_furnace(&white(), &MaterialTables::new(ior, 1.6), 1.0, 2e-3);
    }
}

#[test]
fn furnace_of_white_subsurface_under_specular_is_one() {
    let tables = MaterialTables::new(1.4, 1.6);
    assert_furnace(&SurfaceParameters { subsurface_weight: 0.7, ..white() }, &tables, 1.0, 2e-3);
    let mixed =
        SurfaceParameters { subsurface_weight: 1.0, subsurface_active: [true, false, true], ..white() };
    assert_furnace(&mixed, &tables, 1.0, 2e-3);
}

#[test]
fn furnace_of_white_metal_is_one() {
    assert_furnace(
        &SurfaceParameters { metalness: 1.0, ..white() },
        &MaterialTables::new(1.5, 1.6),
        1.0,
        4e-3,
    );
}

#[test]
fn furnace_of_clear_glass_is_one_from_both_sides() {
    let tables = MaterialTables::new(1.5, 1.6);
    let glass = SurfaceParameters { transmission_weight: 1.0, ..white() };
    assert_furnace(&glass, &tables, 1.0, 4e-3);
    // The glass table is good to 0.015 of 0.5 from inside at roughness 1.
    assert_furnace(&glass, &tables, -1.0, 2e-2);
    let weak = SurfaceParameters { specular_weight: 0.5, ..glass };
    assert_furnace(&weak, &tables, 1.0, 1e-2);
    assert_furnace(&weak, &tables, -1.0, 4e-2);
}

#[test]
fn furnace_of_white_thin_wall_is_one_from_both_sides() {
    let tables = MaterialTables::new(1.5, 1.6);
    for side in [1.0, -1.0] {
        for g in [-0.6, 0.0, 0.9] {
            let sheet = thin_walled(SurfaceParameters { subsurface_weight: 0.7, ..white() }, g);
            assert_furnace(&sheet, &tables, side, 2e-3);
        }
        let pane = thin_walled(SurfaceParameters { transmission_weight: 1.0, ..white() }, 0.0);
        assert_furnace(&pane, &tables, side, 4e-3);
        let coat = SurfaceParameters { coat_weight: 1.0, coat_roughness: 0.4, ..pane };
        assert_furnace(&coat, &tables, side, 1e-2);
        let all =
            SurfaceParameters { metalness: 0.3, transmission_weight: 0.5, subsurface_weight: 0.5, ..coat };
        assert_furnace(&all, &tables, side, 1e-2);
    }
}

#[test]
fn furnace_of_white_under_coat_is_one() {
    let tables = MaterialTables::new(1.5, 1.6);
    for (coat_weight, coat_roughness) in [(1.0, 0.0), (0.6, 0.0), (1.0, 0.4), (0.5, 0.9)] {
        let coated = SurfaceParameters { coat_weight, coat_roughness, ..white() };
        assert_furnace(&coated, &tables, 1.0, 5e-3);
        assert_furnace(&SurfaceParameters { metalness: 1.0, ..coated }, &tables, 1.0, 8e-3);
        assert_furnace(&SurfaceParameters { transmission_weight: 1.0, ..coated }, &tables, 1.0, 8e-3);
        let half =
            SurfaceParameters { metalness: 0.3, transmission_weight: 0.5, subsurface_weight: 0.5, ..coated };
        assert_furnace(&half, &tables, 1.0, 8e-3);
    }
}

#[test]
fn furnace_of_any_material_gains_nothing() {
    // 4 standard errors over 2,000 checks: false alarms 6 %, with this seed none.
    let mut random = Random::of(11);
    for indices in [[1.0, 1.5], [1.5, 1.0], [1.33, 1.6], [4.0, 4.0]] {
        let tables = MaterialTables::new(indices[0], indices[1]);
        for _ in 0..50 {
            let p = random.material(indices);
            let wo = direction(0.02 + 0.98 * random.next());
            let (mean, error) = furnace(&p, &tables, wo);
            assert!(mean < 1.01 + 4.0 * error, "{p:?} {wo}: {mean} ± {error}");
        }
    }
}

#[test]
fn albedo_is_about_what_returns() {
    // The color of rough metals and the coat's shadow on rough lobes are estimates.
    let mut random = Random::of(13);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    for _ in 0..200 {
        let p = random.material(indices);
        let wo = direction(0.3 + 0.7 * random.next());
        let (mean, error) = furnace(&p, &tables, wo);
        let albedo = f64::from(Bsdf::new(&p, &tables, wo).albedo().y);
        assert!((mean - albedo).abs() < 0.04 + 4.0 * error, "{p:?} {wo}: {mean} ± {error}, {albedo}");
    }
}

#[test]
fn matte_without_interface_is_lambertian() {
    let color = Vec3::new(0.2, 0.5, 0.9);
    let unweighted = SurfaceParameters { specular_weight: 0.0, base_color: color, ..white() };
    let stepless = SurfaceParameters { specular_weight: 1.0, ..unweighted };
    let cases = [(unweighted, MaterialTables::new(1.5, 1.6)), (stepless, MaterialTables::new(1.0, 1.6))];
    let mut random = Random::of(3);
    for (p, tables) in &cases {
        for _ in 0..1000 {
            let (wo, wi) = (direction(random.next()), random.direction());
            let value = Bsdf::new(p, tables, wo).eval(wi);
            let expected = color * (wi.z.max(0.0) * FRAC_1_PI);
            assert!((value.diffuse - expected).length() < 1e-6 && value.specular == Vec3::ZERO, "{wo} {wi}");
        }
    }
}

#[test]
fn reflection_is_reciprocal() {
    let mut random = Random::of(5);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    let mut compared = 0;
    while compared < 20_000 {
        let p = SurfaceParameters { transmission_weight: 0.0, ..random.material(indices) };
        let (wo, wi) = (random.direction(), random.direction());
        // Directions below MIN_COS are lifted, which is not symmetric.
        if wo.z < 1e-3 || wi.z < 1e-3 {
            continue;
        }
        let sum = |v: BsdfValue| v.diffuse + v.specular;
        let there = sum(Bsdf::new(&p, &tables, wo).eval(wi)) / wi.z;
        let back = sum(Bsdf::new(&p, &tables, wi).eval(wo)) / wo.z;
        let difference = (there - back).abs().max_element();
        assert!(difference <= 2e-4 * there.max_element() + 1e-6, "{p:?} {wo} {wi}: {there} {back}");
        compared += 1;
    }
}

#[test]
fn diffuse_light_through_a_thin_wall_is_reciprocal() {
    let mut random = Random::of(29);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    let mut compared = 0;
    while compared < 2_000 {
        let p = random.thin_walled(indices);
        let (wo, wi) = (random.direction(), random.direction());
        if wo.z < 1e-3 || wi.z > -1e-3 {
            continue;
        }
        let there = Bsdf::new(&p, &tables, wo).eval(wi).diffuse / -wi.z;
        let back = Bsdf::new(&p, &tables, wi).eval(wo).diffuse / wo.z;
        let difference = (there - back).abs().max_element();
        assert!(difference <= 2e-4 * there.max_element() + 1e-6, "{p:?} {wo} {wi}: {there} {back}");
        compared += 1;
    }
}

/// Materials whose lobes can all be resolved by a grid on the sphere.
fn rough_materials() -> Vec<SurfaceParameters> {
    let base = SurfaceParameters { specular_roughness: 0.45, ..white() };
    vec![
        base,
        SurfaceParameters { metalness: 1.0, specular_roughness: 0.7, ..base },
        SurfaceParameters { transmission_weight: 1.0, specular_roughness: 0.9, ..base },
        SurfaceParameters { coat_weight: 0.8, coat_roughness: 0.5, ..base },
        SurfaceParameters {
            metalness: 0.3,
            specular_roughness: 0.8,
            transmission_weight: 0.5,
            subsurface_weight: 0.4,
            coat_weight: 0.5,
            coat_roughness: 0.4,
            transmission_tint: Vec3::new(0.3, 0.6, 0.9),
            ..base
        },
        thin_walled(
            SurfaceParameters {
                metalness: 0.2,
                specular_roughness: 0.8,
                transmission_weight: 0.5,
                subsurface_weight: 0.6,
                coat_weight: 0.5,
                coat_roughness: 0.4,
                ..base
            },
            0.5,
        ),
    ]
}

#[test]
fn sample_follows_pdf() {
    // χ² over 32 × 16 bins of the sphere, bins of fewer than 8 expected samples pooled. 30 histograms;
    // the threshold of 5 standard deviations of χ² alarms falsely once in about 1e5.
    const TURN: usize = 32;
    const COSINE: usize = 16;
    const FINE_TURN: usize = 8;
    const FINE_COSINE: usize = 32;
    const SAMPLES: usize = 60_000;
    let tables = MaterialTables::new(1.5, 1.6);
    for (m, p) in rough_materials().iter().enumerate() {
        for mu in [1.0, 0.6, 0.15, -0.3, -0.9] {
            let bsdf = Bsdf::new(p, &tables, direction(mu));
            let (mut found, mut expected) = (vec![0.0_f64; TURN * COSINE], vec![0.0_f64; TURN * COSINE]);
            let mut random = Random::of(m as u64 + 100);
            for _ in 0..SAMPLES {
                let sample = bsdf.sample(random.next(), random.pair());
                let Some(BsdfSample::Direction { wi, pdf, .. }) = sample else { continue };
                assert!(pdf > 0.0, "mirror lobe in a rough material");
                let turn = ((wi.y.atan2(wi.x) / TAU + 1.0).fract() * TURN as f32) as usize;
                let cosine = ((wi.z + 1.0) * 0.5 * COSINE as f32) as usize;
                found[cosine.min(COSINE - 1) * TURN + turn.min(TURN - 1)] += 1.0;
            }
            for i in 0..COSINE * FINE_COSINE {
                let z = (i as f32 + 0.5) / (COSINE * FINE_COSINE) as f32 * 2.0 - 1.0;
                for j in 0..TURN * FINE_TURN {
                    let (sin, cos) = ((j as f32 + 0.5) / (TURN * FINE_TURN) as f32 * TAU).sin_cos();
                    let r = (1.0 - z * z).sqrt();
                    let pdf = bsdf.eval(Vec3::new(r * cos, r * sin, z)).pdf;
                    expected[i / FINE_COSINE * TURN + j / FINE_TURN] += f64::from(pdf);
                }
            }
            let cell =
                4.0 * f64::from(PI) / (COSINE * TURN * FINE_TURN * FINE_COSINE) as f64 * SAMPLES as f64;
            let (mut chi2, mut bins, mut pooled) = (0.0, 0.0, [0.0, 0.0]);
            for (f, e) in found.iter().zip(expected.iter().map(|e| e * cell)) {
                if e < 8.0 {
                    pooled = [pooled[0] + f, pooled[1] + e];
                } else {
                    chi2 += (f - e) * (f - e) / e;
                    bins += 1.0;
                }
            }
            chi2 += (pooled[0] - pooled[1]).powi(2) / (pooled[1] + 1.0);
            bins += 1.0;
            assert!(
                chi2 < bins + 5.0 * (2.0_f64 * bins).sqrt(),
                "material {m}, cos {mu}: χ² {chi2} for {bins} bins"
            );
        }
    }
}

#[test]
fn sample_weight_is_value_over_pdf() {
    let mut random = Random::of(17);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    let mut compared = 0;
    while compared < 20_000 {
        let p = if compared % 4 == 0 { random.thin_walled(indices) } else { random.material(indices) };
        let bsdf = Bsdf::new(&p, &tables, random.direction());
        let sample = bsdf.sample(random.next(), random.pair());
        let Some(BsdfSample::Direction { wi, weight, diffuse_share, pdf, lobe, transmitted }) = sample else {
            continue;
        };
        if lobe == Lobe::Delta {
            continue;
        }
        let value = bsdf.eval(wi);
        assert!((value.pdf - pdf).abs() <= 1e-3 * pdf, "{p:?} {wi}: {} {pdf}", value.pdf);
        let expected = (value.diffuse + value.specular) / value.pdf;
        assert!((expected - weight).abs().max_element() <= 2e-3 * weight.max_element() + 1e-6, "{p:?} {wi}");
        let diffuse = value.diffuse / value.pdf;
        assert!((diffuse - weight * diffuse_share).abs().max_element() <= 2e-3 * weight.max_element() + 1e-6);
        assert!(!transmitted || value.diffuse == Vec3::ZERO || p.thin_wall.is_some());
        compared += 1;
    }
}

/// With light from below followed beside, the surface scatters the same light, and is drawn by every sample.
///
/// 4 × 3 comparisons of the means of 2¹⁶ samples; five standard errors alarm falsely once in about 1e5.
#[test]
fn split_below_changes_no_mean() {
    let tables = MaterialTables::new(1.5, 1.6);
    let base = SurfaceParameters { subsurface_weight: 1.0, specular_roughness: 0.4, ..white() };
    let mixed = SurfaceParameters { subsurface_weight: 0.5, coat_weight: 0.7, coat_roughness: 0.3, ..base };
    for (m, p) in [base, mixed].iter().enumerate() {
        for mu in [0.9, 0.2] {
            let whole = Bsdf::new(p, &tables, direction(mu));
            let mut split = whole;
            let below = split.split_below().expect("light comes from below");
            let mut random = Random::of(m as u64);
            let [mut sums, mut squares, mut drawn] = [[0.0_f64; 2]; 3];
            let n = 1 << 16;
            for _ in 0..n {
                let (u, v) = (random.next(), random.pair());
                for (k, bsdf) in [&whole, &split].into_iter().enumerate() {
                    if let Some(BsdfSample::Direction { wi, weight, pdf, .. }) = bsdf.sample(u, v) {
                        let value = f64::from(weight.y);
                        (sums[k], squares[k], drawn[k]) =
                            (sums[k] + value, squares[k] + value * value, drawn[k] + 1.0);
                        assert!((bsdf.eval(wi).pdf - pdf).abs() <= 1e-3 * pdf);
                    }
                }
            }
            let n = f64::from(n);
            let means = sums.map(|sum| sum / n);
            let errors = [0, 1].map(|k| (squares[k] / n - means[k] * means[k]) / n);
            let allowed = 5.0 * errors.iter().sum::<f64>().sqrt();
            assert!((means[0] - means[1]).abs() < allowed, "material {m}, cos {mu}: {means:?} ± {allowed}");
            // But for directions below the horizon
            assert!(drawn[1] > 0.9 * n && errors[1] < errors[0], "{drawn:?} {errors:?}");
            // Followed with this probability, light from below has the weight that it has on average when drawn
            let (low, high) = (below.weight * below.probability, whole.below());
            assert!(low.abs_diff_eq(high, 1e-6), "{low} {high}");
        }
    }
    let bare = SurfaceParameters { subsurface_weight: 0.0, ..base };
    assert!(Bsdf::new(&bare, &tables, direction(0.5)).split_below().is_none());
}

#[test]
fn mirrors_reflect_by_fresnel() {
    let tables = MaterialTables::new(1.5, 1.6);
    let black = SurfaceParameters { base_color: Vec3::ZERO, specular_roughness: 0.0, ..white() };
    let wo = direction(0.4);
    let Some(BsdfSample::Direction { wi, weight, lobe, pdf, transmitted, .. }) =
        Bsdf::new(&black, &tables, wo).sample(0.5, [0.3, 0.7])
    else {
        panic!("a mirror reflects")
    };
    assert!((wi - Vec3::new(-wo.x, 0.0, wo.z)).length() < 1e-6);
    assert!((weight.x - fresnel_dielectric(0.4, 1.5)).abs() < 1e-6);
    assert_eq!((lobe, pdf, transmitted), (Lobe::Delta, 0.0, false));
}

#[test]
fn smooth_glass_splits_by_fresnel_and_bends_by_snell() {
    let tables = MaterialTables::new(1.5, 1.6);
    let glass = SurfaceParameters { transmission_weight: 1.0, specular_roughness: 0.0, ..white() };
    for (wo, eta) in [(direction(0.4), 1.5), (-direction(0.9), 1.0 / 1.5)] {
        let bsdf = Bsdf::new(&glass, &tables, wo);
        assert!(bsdf.is_smooth_only());
        let (mut reflected, n) = (0, 10_000);
        for i in 0..n {
            let sample = bsdf.sample((i as f32 + 0.5) / n as f32, [0.5; 2]);
            let Some(BsdfSample::Direction { wi, weight, transmitted, .. }) = sample else {
                panic!("lossless")
            };
            assert!((weight - Vec3::ONE).length() < 1e-5);
            assert_eq!(transmitted, wi.z * wo.z < 0.0);
            if transmitted {
                assert!((wi.x * eta + wo.x).abs() < 1e-5, "{wi}");
            } else {
                reflected += 1;
            }
        }
        let fraction = reflected as f32 / n as f32;
        assert!((fraction - fresnel_dielectric(wo.z.abs(), eta)).abs() < 2e-4, "{fraction}");
    }
    // Beyond the critical angle all is reflected.
    let inside = Bsdf::new(&glass, &tables, -direction(0.3));
    for i in 0..100 {
        let sample = inside.sample(i as f32 / 100.0, [0.5; 2]);
        assert!(matches!(sample, Some(BsdfSample::Direction { transmitted: false, .. })));
    }
}

#[test]
fn glass_without_index_step_lets_light_straight_through() {
    let wo = direction(0.37);
    for (tables, specular_weight) in
        [(MaterialTables::new(1.0, 1.6), 1.0), (MaterialTables::new(1.5, 1.6), 0.0)]
    {
        for roughness in [0.0, 0.5] {
            let p = SurfaceParameters {
                transmission_weight: 1.0,
                specular_roughness: roughness,
                specular_weight,
                transmission_tint: Vec3::new(0.1, 0.5, 1.0),
                ..white()
            };
            let sample = Bsdf::new(&p, &tables, wo).sample(0.3, [0.2, 0.8]);
            let Some(BsdfSample::Direction { wi, weight, lobe, .. }) = sample else { panic!("lossless") };
            assert!((wi + wo).length() < 1e-6 && (weight - p.transmission_tint).length() < 1e-6);
            assert_eq!(lobe, Lobe::Delta);
        }
    }
}

#[test]
fn subsurface_without_extent_is_the_matte_lobe() {
    // Exit factor × A × entry factor of active channels equals the diffuse value of inactive ones.
    let mut random = Random::of(23);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    let mut compared = 0;
    while compared < 2000 {
        let p = SurfaceParameters {
            subsurface_weight: 0.1 + 0.9 * random.next(),
            base_color: Vec3::ZERO,
            subsurface_active: [true; 3],
            ..random.material(indices)
        };
        let wo = direction(0.01 + 0.99 * random.next());
        let wi = direction(0.01 + 0.99 * random.next());
        let bsdf = Bsdf::new(&p, &tables, wo);
        let Some(BsdfSample::Subsurface { weight }) = bsdf.sample(0.0, [0.5; 2]) else { continue };
        let mut hits = 0;
        let n = 4000;
        for i in 0..n {
            let sample = bsdf.sample((i as f32 + 0.5) / n as f32, [0.5; 2]);
            hits += i32::from(matches!(sample, Some(BsdfSample::Subsurface { .. })));
        }
        if hits < 100 {
            continue;
        }
        let chance = hits as f32 / n as f32;
        let spread = weight * chance * p.surface_albedo * EntryBsdf::new(&p, &tables).eval(wi.z);
        let flat = Bsdf::new(&SurfaceParameters { subsurface_active: [false; 3], ..p }, &tables, wo)
            .eval(wi)
            .diffuse;
        let allowed = spread.max_element() * (1.0 / hits as f32 + 1e-4) + 1e-6;
        assert!((spread - flat).abs().max_element() <= allowed, "{p:?} {wo} {wi}: {spread} {flat}");
        compared += 1;
    }
}

#[test]
fn any_parameters_give_finite_numbers() {
    let mut random = Random::of(29);
    for indices in [[1.0, 1.0], [1.0, 4.0], [1.0005, 1.5], [1.01, 1.6], [1.5, 1.6], [4.0, 1.0], [4.0, 4.0]] {
        let tables = MaterialTables::new(indices[0], indices[1]);
        for number in 0..20_000 {
            let p = if number % 4 == 0 { random.thin_walled(indices) } else { random.material(indices) };
            let wo = random.direction();
            let bsdf = Bsdf::new(&p, &tables, wo);
            let albedo = bsdf.albedo();
            assert!(
                albedo.is_finite() && albedo.min_element() >= 0.0 && albedo.max_element() <= 1.0,
                "{p:?} {wo}"
            );
            for wi in [random.direction(), -wo, Vec3::new(-wo.x, -wo.y, wo.z), wo, Vec3::Z, Vec3::X] {
                let v = bsdf.eval(wi);
                let is_valid = v.diffuse.is_finite() && v.specular.is_finite() && v.pdf.is_finite();
                assert!(is_valid && v.pdf >= 0.0, "{p:?} {wo} {wi}: {v:?}");
                assert!(
                    v.diffuse.min_element() >= 0.0 && v.specular.min_element() >= 0.0,
                    "{p:?} {wo} {wi}: {v:?}"
                );
                // Light that no sample can bring would be lost.
                assert!(
                    v.pdf > 0.0 || (v.diffuse + v.specular).max_element() <= 0.0,
                    "{p:?} {wo} {wi}: {v:?}"
                );
            }
            match bsdf
                .sample(random.corner().min(0.999_999_9), [random.corner().min(0.999_999_9), random.next()])
            {
                Some(BsdfSample::Direction { wi, weight, pdf, .. }) => {
                    assert!(weight.is_finite() && weight.min_element() >= 0.0, "{p:?} {wo}: {weight}");
                    assert!(
                        (wi.length() - 1.0).abs() < 1e-4 && pdf.is_finite() && pdf >= 0.0,
                        "{p:?} {wo}: {wi} {pdf}"
                    );
                }
                Some(BsdfSample::Subsurface { weight }) => {
                    assert!(weight.is_finite() && weight.min_element() >= 0.0, "{p:?} {wo}: {weight}");
                }
                None => {}
            }
        }
    }
}

#[test]
fn smooth_only_means_that_light_sampling_finds_nothing() {
    let mut random = Random::of(31);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    let mut smooth = 0;
    for _ in 0..20_000 {
        let p = random.material(indices);
        let bsdf = Bsdf::new(&p, &tables, random.direction());
        if bsdf.is_smooth_only() {
            smooth += 1;
            assert_eq!(bsdf.eval(random.direction()), BsdfValue::default());
        }
    }
    assert!(smooth > 100, "{smooth}");
}

#[test]
fn entry_passes_all_light_that_is_not_reflected() {
    // 2 ∫ T μ dμ / T̄ = 1.
    for indices in [[1.0, 1.0], [1.5, 1.6], [2.5, 2.0]] {
        let tables = MaterialTables::new(indices[0], indices[1]);
        for (roughness, coat_weight, coat_roughness) in
            [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.6, 0.7, 0.0), (0.2, 1.0, 0.5)]
        {
            let p =
                SurfaceParameters { specular_roughness: roughness, coat_weight, coat_roughness, ..white() };
            let entry = EntryBsdf::new(&p, &tables);
            let n = 4000;
            let total: f32 = (0..n)
                .map(|i| {
                    let mu = (i as f32 + 0.5) / n as f32;
                    entry.eval(mu).x * (TAU / n as f32)
                })
                .sum();
            assert!((total - 1.0).abs() < 1e-3, "{indices:?} {roughness} {coat_weight}: {total}");
            let (wi, weight) = entry.sample([0.3, 0.6]);
            assert!((weight * EntryBsdf::pdf(wi.z) - entry.eval(wi.z)).length() < 1e-6);
        }
    }
}
