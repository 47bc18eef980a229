//! Laws that the BSDF of any material obeys, as tests.
//!
//! They ask the module [`judged`](super::judged) for all that they judge, many cases at a time: `translucid-gpu` includes this
//! file beside one that asks a device.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use glam::Vec3;
use translucid_testing::SplitMix;

use super::{BsdfSample, BsdfValue, Lobe, MaterialTables, SurfaceParameters, fresnel_dielectric, judged};

/// Random numbers, directions and materials.
pub(super) struct Random(SplitMix);

impl Random {
    pub(super) fn of(seed: u64) -> Self {
        Self(SplitMix(seed))
    }

    pub(super) fn next(&mut self) -> f32 {
        self.0.uniform_f32()
    }

    pub(super) fn triple(&mut self) -> [f32; 3] {
        [self.next(), self.next(), self.next()]
    }

    /// A material of a sheet.
    pub(super) fn thin_walled(&mut self, indices: [f32; 2]) -> SurfaceParameters {
        thin_walled(self.material(indices), 2.0 * self.next() - 1.0)
    }

    fn color(&mut self) -> Vec3 {
        Vec3::new(self.corner(), self.corner(), self.corner())
    }

    /// Uniform in [0, 1], but an end of it in one case of two.
    pub(super) fn corner(&mut self) -> f32 {
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
    pub(super) fn direction(&mut self) -> Vec3 {
        let mut z = 2.0 * self.next() - 1.0;
        if self.next() < 0.25 {
            z *= 1e-6;
        }
        let (sin, cos) = (TAU * self.next()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * cos, r * sin, z).normalize()
    }

    pub(super) fn material(&mut self, indices: [f32; 2]) -> SurfaceParameters {
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
            subsurface_active: Vec3::from_array([(); 3].map(|()| f32::from(u8::from(self.next() < 0.5)))),
            thin: 0,
            thin_albedo: Vec3::ZERO,
            coat_weight: self.corner(),
            coat_color: self.color(),
            coat_roughness: self.corner(),
            coat_ior: indices[1],
        }
    }
}

/// A direction of cosine `mu` in the plane of x and z.
pub(super) fn direction(mu: f32) -> Vec3 {
    Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu)
}

/// A material as that of a sheet, which scatters with the mean cosine `g`.
fn thin_walled(p: SurfaceParameters, g: f32) -> SurfaceParameters {
    SurfaceParameters { subsurface_active: Vec3::ZERO, ..p }.scattered_to_both_sides(g)
}

pub(super) fn white() -> SurfaceParameters {
    SurfaceParameters { base_color: Vec3::ONE, surface_albedo: Vec3::ONE, ..SurfaceParameters::default() }
}

/// Means and standard errors of the weights under uniform unit light, subsurface scattering returning its A
/// times the tint of the coat on entry.
fn furnaces(tables: &MaterialTables, cases: &[(SurfaceParameters, Vec3)]) -> Vec<(f64, f64)> {
    // A few at a time, for memory
    cases.chunks(16).flat_map(|cases| furnaces_at_once(tables, cases)).collect()
}

fn furnaces_at_once(tables: &MaterialTables, cases: &[(SurfaceParameters, Vec3)]) -> Vec<(f64, f64)> {
    const SIDE: usize = judged::FURNACE_SIDE;
    const COUNT: usize = SIDE * SIDE * SIDE;
    let numbers = || {
        let mut random = Random::of(7);
        (0..COUNT).map(move |k| {
            let cell = |i: usize, x: f32| ((i % SIDE) as f32 + x) / SIDE as f32;
            let v = [cell(k / SIDE, random.next()), cell(k / (SIDE * SIDE), random.next())];
            [cell(k, random.next()), v[0], v[1]]
        })
    };
    let drawn = cases.iter().flat_map(|&(p, wo)| numbers().map(move |numbers| (p, wo, numbers)));
    let samples = judged::sample(tables, drawn);
    let of_case = |(samples, (p, _)): (&[Option<BsdfSample>], &(SurfaceParameters, Vec3))| {
        let entry_tint = (1.0 + (p.coat_color.y - 1.0) * p.coat_weight).sqrt();
        let (mut sum, mut squares) = (0.0, 0.0);
        for sample in samples {
            let weight = match *sample {
                Some(BsdfSample::Direction { weight, .. }) => weight.y,
                Some(BsdfSample::Subsurface { weight }) => weight.y * p.surface_albedo.y * entry_tint,
                None => 0.0,
            };
            sum += f64::from(weight);
            squares += f64::from(weight * weight);
        }
        let n = COUNT as f64;
        let mean = sum / n;
        (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
    };
    samples.chunks_exact(COUNT).zip(cases).map(of_case).collect()
}

/// Asserts that white materials return all light, seen from a side, each to its tolerance and 4 standard errors
/// (6e-5 per check for independent samples; stratification makes it rarer).
fn assert_furnaces(tables: &MaterialTables, materials: &[(SurfaceParameters, f32, f64)]) {
    let mut cases = Vec::new();
    let mut tolerances = Vec::new();
    for &(p, side, tolerance) in materials {
        for specular_roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
            for mu in [0.05, 0.2, 0.5, 0.8, 1.0] {
                let p = SurfaceParameters { specular_roughness, ..p };
                cases.push((p, direction(mu) * Vec3::new(1.0, 1.0, side)));
                tolerances.push(tolerance);
            }
        }
    }
    let found = furnaces(tables, &cases);
    assert_eq!(found.len(), cases.len());
    for (((p, wo), tolerance), (mean, error)) in cases.iter().zip(tolerances).zip(found) {
        assert!((mean - 1.0).abs() < tolerance + 4.0 * error, "{p:?} {wo}: {mean} ± {error}");
    }
}

#[test]
fn furnace_of_white_matte_under_specular_is_one() {
    for ior in [1.0, 1.33, 1.5, 2.5] {
        assert_furnaces(&MaterialTables::new(ior, 1.6), &[(white(), 1.0, 2e-3)]);
    }
}

#[test]
fn furnace_of_white_subsurface_under_specular_is_one() {
    let part = SurfaceParameters { subsurface_weight: 0.7, ..white() };
    let mixed =
        SurfaceParameters { subsurface_weight: 1.0, subsurface_active: Vec3::new(1.0, 0.0, 1.0), ..white() };
    assert_furnaces(&MaterialTables::new(1.4, 1.6), &[(part, 1.0, 2e-3), (mixed, 1.0, 2e-3)]);
}

#[test]
fn furnace_of_white_metal_is_one() {
    let metal = SurfaceParameters { metalness: 1.0, ..white() };
    assert_furnaces(&MaterialTables::new(1.5, 1.6), &[(metal, 1.0, 4e-3)]);
}

#[test]
fn furnace_of_clear_glass_is_one_from_both_sides() {
    let glass = SurfaceParameters { transmission_weight: 1.0, ..white() };
    let weak = SurfaceParameters { specular_weight: 0.5, ..glass };
    // The glass table is good to 0.015 of 0.5 from inside at roughness 1.
    let materials = [(glass, 1.0, 4e-3), (glass, -1.0, 2e-2), (weak, 1.0, 1e-2), (weak, -1.0, 4e-2)];
    assert_furnaces(&MaterialTables::new(1.5, 1.6), &materials);
}

#[test]
fn furnace_of_white_thin_wall_is_one_from_both_sides() {
    let mut materials = Vec::new();
    for side in [1.0, -1.0] {
        for g in [-0.6, 0.0, 0.9] {
            let sheet = thin_walled(SurfaceParameters { subsurface_weight: 0.7, ..white() }, g);
            materials.push((sheet, side, 2e-3));
        }
        let pane = thin_walled(SurfaceParameters { transmission_weight: 1.0, ..white() }, 0.0);
        let coat = SurfaceParameters { coat_weight: 1.0, coat_roughness: 0.4, ..pane };
        let all =
            SurfaceParameters { metalness: 0.3, transmission_weight: 0.5, subsurface_weight: 0.5, ..coat };
        materials.extend([(pane, side, 4e-3), (coat, side, 1e-2), (all, side, 1e-2)]);
    }
    assert_furnaces(&MaterialTables::new(1.5, 1.6), &materials);
}

#[test]
fn furnace_of_white_under_coat_is_one() {
    let mut materials = Vec::new();
    for (coat_weight, coat_roughness) in [(1.0, 0.0), (0.6, 0.0), (1.0, 0.4), (0.5, 0.9)] {
        let coated = SurfaceParameters { coat_weight, coat_roughness, ..white() };
        let metal = SurfaceParameters { metalness: 1.0, ..coated };
        let glass = SurfaceParameters { transmission_weight: 1.0, ..coated };
        let half =
            SurfaceParameters { metalness: 0.3, transmission_weight: 0.5, subsurface_weight: 0.5, ..coated };
        materials.extend([(coated, 1.0, 5e-3), (metal, 1.0, 8e-3), (glass, 1.0, 8e-3), (half, 1.0, 8e-3)]);
    }
    assert_furnaces(&MaterialTables::new(1.5, 1.6), &materials);
}

#[test]
fn furnace_of_any_material_gains_nothing() {
    // 4 standard errors over 200 checks: false alarms 0.6 %, with this seed none.
    let mut random = Random::of(11);
    for indices in [[1.0, 1.5], [1.5, 1.0], [1.33, 1.6], [4.0, 4.0]] {
        let cases: Vec<_> =
            (0..50).map(|_| (random.material(indices), direction(0.02 + 0.98 * random.next()))).collect();
        let found = furnaces(&MaterialTables::new(indices[0], indices[1]), &cases);
        for ((p, wo), (mean, error)) in cases.iter().zip(found) {
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
    let cases: Vec<_> =
        (0..200).map(|_| (random.material(indices), direction(0.3 + 0.7 * random.next()))).collect();
    let albedos = judged::seen(&tables, cases.iter().copied());
    for (((p, wo), (mean, error)), (albedo, _)) in cases.iter().zip(furnaces(&tables, &cases)).zip(albedos) {
        let difference = (mean - f64::from(albedo.y)).abs();
        assert!(difference < 0.04 + 4.0 * error, "{p:?} {wo}: {mean} ± {error}, {albedo}");
    }
}

#[test]
fn matte_without_interface_is_lambertian() {
    let color = Vec3::new(0.2, 0.5, 0.9);
    let unweighted = SurfaceParameters { specular_weight: 0.0, base_color: color, ..white() };
    let stepless = SurfaceParameters { specular_weight: 1.0, ..unweighted };
    let materials = [(unweighted, MaterialTables::new(1.5, 1.6)), (stepless, MaterialTables::new(1.0, 1.6))];
    let mut random = Random::of(3);
    for (p, tables) in &materials {
        let cases: Vec<_> = (0..1000).map(|_| (*p, direction(random.next()), random.direction())).collect();
        for ((_, wo, wi), value) in cases.iter().zip(judged::eval(tables, cases.iter().copied())) {
            let expected = color * (wi.z.max(0.0) * FRAC_1_PI);
            let is_met = (value.diffuse - expected).length() < 1e-6 && value.specular == Vec3::ZERO;
            assert!(is_met, "{wo} {wi}: {value:?}");
        }
    }
}

/// Asserts that what a part of the BSDF passes from one direction to the other, it passes back.
fn assert_reciprocal(
    tables: &MaterialTables,
    cases: &[(SurfaceParameters, Vec3, Vec3)],
    part: fn(BsdfValue) -> Vec3,
) {
    let there = judged::eval(tables, cases.iter().copied());
    let back = judged::eval(tables, cases.iter().map(|&(p, wo, wi)| (p, wi, wo)));
    for ((p, wo, wi), (there, back)) in cases.iter().zip(there.into_iter().zip(back)) {
        let (there, back) = (part(there) / wi.z.abs(), part(back) / wo.z.abs());
        let difference = (there - back).abs().max_element();
        assert!(difference <= 2e-4 * there.max_element() + 1e-6, "{p:?} {wo} {wi}: {there} {back}");
    }
}

#[test]
fn reflection_is_reciprocal() {
    let mut random = Random::of(5);
    let indices = [1.5, 1.6];
    let mut cases = Vec::new();
    while cases.len() < 20_000 {
        let p = SurfaceParameters { transmission_weight: 0.0, ..random.material(indices) };
        let (wo, wi) = (random.direction(), random.direction());
        // Directions below MIN_COS are lifted, which is not symmetric.
        if wo.z >= 1e-3 && wi.z >= 1e-3 {
            cases.push((p, wo, wi));
        }
    }
    assert_reciprocal(&MaterialTables::new(indices[0], indices[1]), &cases, |v| v.diffuse + v.specular);
}

#[test]
fn diffuse_light_through_a_thin_wall_is_reciprocal() {
    let mut random = Random::of(29);
    let indices = [1.5, 1.6];
    let mut cases = Vec::new();
    while cases.len() < 2_000 {
        let p = random.thin_walled(indices);
        let (wo, wi) = (random.direction(), random.direction());
        if wo.z >= 1e-3 && wi.z <= -1e-3 {
            cases.push((p, wo, wi));
        }
    }
    assert_reciprocal(&MaterialTables::new(indices[0], indices[1]), &cases, |v| v.diffuse);
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
    for (m, p) in rough_materials().into_iter().enumerate() {
        for mu in [1.0, 0.6, 0.15, -0.3, -0.9] {
            let wo = direction(mu);
            let (mut found, mut expected) = (vec![0.0_f64; TURN * COSINE], vec![0.0_f64; TURN * COSINE]);
            let mut random = Random::of(m as u64 + 100);
            for sample in judged::sample(&tables, (0..SAMPLES).map(|_| (p, wo, random.triple()))) {
                let Some(BsdfSample::Direction { wi, pdf, .. }) = sample else { continue };
                assert!(pdf > 0.0, "mirror lobe in a rough material");
                let turn = ((wi.y.atan2(wi.x) / TAU + 1.0).fract() * TURN as f32) as usize;
                let cosine = ((wi.z + 1.0) * 0.5 * COSINE as f32) as usize;
                found[cosine.min(COSINE - 1) * TURN + turn.min(TURN - 1)] += 1.0;
            }
            let cells: Vec<_> =
                (0..COSINE * FINE_COSINE).flat_map(|i| (0..TURN * FINE_TURN).map(move |j| (i, j))).collect();
            let center = |&(i, j): &(usize, usize)| {
                let z = (i as f32 + 0.5) / (COSINE * FINE_COSINE) as f32 * 2.0 - 1.0;
                let (sin, cos) = ((j as f32 + 0.5) / (TURN * FINE_TURN) as f32 * TAU).sin_cos();
                let r = (1.0 - z * z).sqrt();
                Vec3::new(r * cos, r * sin, z)
            };
            let values = judged::eval(&tables, cells.iter().map(|cell| (p, wo, center(cell))));
            for ((i, j), value) in cells.iter().zip(values) {
                expected[i / FINE_COSINE * TURN + j / FINE_TURN] += f64::from(value.pdf);
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
    let cases: Vec<_> = (0..40_000)
        .map(|k| {
            let p = if k % 4 == 0 { random.thin_walled(indices) } else { random.material(indices) };
            (p, random.direction(), random.triple())
        })
        .collect();
    let is_scattered =
        |sample: &BsdfSample| matches!(sample, BsdfSample::Direction { lobe, .. } if *lobe != Lobe::Delta);
    let samples: Vec<_> = cases
        .iter()
        .zip(judged::sample(&tables, cases.iter().copied()))
        .filter_map(|(&(p, wo, _), sample)| Some((p, wo, sample.filter(is_scattered)?)))
        .collect();
    assert!(samples.len() > 15_000, "{}", samples.len());
    let direction_of = |sample: &BsdfSample| match *sample {
        BsdfSample::Direction { wi, .. } => wi,
        BsdfSample::Subsurface { .. } => Vec3::ZERO,
    };
    let values = judged::eval(&tables, samples.iter().map(|(p, wo, sample)| (*p, *wo, direction_of(sample))));
    for ((p, _, sample), value) in samples.iter().zip(values) {
        let BsdfSample::Direction { wi, weight, diffuse_share, pdf, transmitted, .. } = *sample else {
            continue;
        };
        assert!((value.pdf - pdf).abs() <= 1e-3 * pdf, "{p:?} {wi}: {} {pdf}", value.pdf);
        let expected = (value.diffuse + value.specular) / value.pdf;
        assert!((expected - weight).abs().max_element() <= 2e-3 * weight.max_element() + 1e-6, "{p:?} {wi}");
        let diffuse = value.diffuse / value.pdf;
        assert!((diffuse - weight * diffuse_share).abs().max_element() <= 2e-3 * weight.max_element() + 1e-6);
        assert!(!transmitted || value.diffuse == Vec3::ZERO || p.is_thin());
    }
}

#[test]
fn mirrors_reflect_by_fresnel() {
    let tables = MaterialTables::new(1.5, 1.6);
    let black = SurfaceParameters { base_color: Vec3::ZERO, specular_roughness: 0.0, ..white() };
    let wo = direction(0.4);
    let Some(BsdfSample::Direction { wi, weight, lobe, pdf, transmitted, .. }) =
        judged::sample(&tables, [(black, wo, [0.5, 0.3, 0.7])])[0]
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
        assert!(judged::seen(&tables, [(glass, wo)])[0].1);
        let (mut reflected, n) = (0, 10_000);
        let numbers = (0..n).map(|i| (glass, wo, [(i as f32 + 0.5) / n as f32, 0.5, 0.5]));
        for sample in judged::sample(&tables, numbers) {
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
    let inside = (0..100).map(|i| (glass, -direction(0.3), [i as f32 / 100.0, 0.5, 0.5]));
    for sample in judged::sample(&tables, inside) {
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
            let sample = judged::sample(&tables, [(p, wo, [0.3, 0.2, 0.8])])[0];
            let Some(BsdfSample::Direction { wi, weight, lobe, .. }) = sample else { panic!("lossless") };
            assert!((wi + wo).length() < 1e-6 && (weight - p.transmission_tint).length() < 1e-6);
            assert_eq!(lobe, Lobe::Delta);
        }
    }
}

#[test]
fn any_parameters_give_finite_numbers() {
    let mut random = Random::of(29);
    for indices in [[1.0, 1.0], [1.0, 4.0], [1.0005, 1.5], [1.01, 1.6], [1.5, 1.6], [4.0, 1.0], [4.0, 4.0]] {
        let tables = MaterialTables::new(indices[0], indices[1]);
        let cases: Vec<_> = (0..20_000)
            .map(|k| {
                let p = if k % 4 == 0 { random.thin_walled(indices) } else { random.material(indices) };
                (p, random.direction())
            })
            .collect();
        for ((p, wo), (albedo, _)) in cases.iter().zip(judged::seen(&tables, cases.iter().copied())) {
            let is_valid = albedo.is_finite() && albedo.min_element() >= 0.0 && albedo.max_element() <= 1.0;
            assert!(is_valid, "{p:?} {wo}: {albedo}");
        }
        let pairs: Vec<_> = cases
            .iter()
            .flat_map(|&(p, wo)| {
                let mirrored = Vec3::new(-wo.x, -wo.y, wo.z);
                [random.direction(), -wo, mirrored, wo, Vec3::Z, Vec3::X].map(|wi| (p, wo, wi))
            })
            .collect();
        for ((p, wo, wi), v) in pairs.iter().zip(judged::eval(&tables, pairs.iter().copied())) {
            let is_valid = v.diffuse.is_finite() && v.specular.is_finite() && v.pdf.is_finite();
            assert!(is_valid && v.pdf >= 0.0, "{p:?} {wo} {wi}: {v:?}");
            let least = v.diffuse.min_element().min(v.specular.min_element());
            assert!(least >= 0.0, "{p:?} {wo} {wi}: {v:?}");
            // Light that no sample can bring would be lost.
            assert!(v.pdf > 0.0 || (v.diffuse + v.specular).max_element() <= 0.0, "{p:?} {wo} {wi}: {v:?}");
        }
        let below_one = |x: f32| x.min(0.999_999_9);
        let drawn: Vec<_> = cases
            .iter()
            .map(|&(p, wo)| (p, wo, [below_one(random.corner()), below_one(random.corner()), random.next()]))
            .collect();
        for ((p, wo, _), sample) in drawn.iter().zip(judged::sample(&tables, drawn.iter().copied())) {
            let Some(sample) = sample else { continue };
            let (BsdfSample::Direction { weight, .. } | BsdfSample::Subsurface { weight }) = sample;
            assert!(weight.is_finite() && weight.min_element() >= 0.0, "{p:?} {wo}: {weight}");
            if let BsdfSample::Direction { wi, pdf, .. } = sample {
                let is_valid = (wi.length() - 1.0).abs() < 1e-4 && pdf.is_finite() && pdf >= 0.0;
                assert!(is_valid, "{p:?} {wo}: {wi} {pdf}");
            }
        }
    }
}

#[test]
fn smooth_only_means_that_light_sampling_finds_nothing() {
    let mut random = Random::of(31);
    let indices = [1.5, 1.6];
    let tables = MaterialTables::new(indices[0], indices[1]);
    let cases: Vec<_> = (0..20_000).map(|_| (random.material(indices), random.direction())).collect();
    let is_smooth = judged::seen(&tables, cases.iter().copied());
    let smooth: Vec<_> = cases
        .into_iter()
        .zip(is_smooth)
        .filter(|(_, (_, is_smooth))| *is_smooth)
        .map(|((p, wo), _)| (p, wo, random.direction()))
        .collect();
    assert!(smooth.len() > 100, "{}", smooth.len());
    assert!(judged::eval(&tables, smooth).into_iter().all(|value| value == BsdfValue::default()));
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
            let n = 4000;
            let mu = |i: usize| (i as f32 + 0.5) / n as f32;
            let weights = judged::entry_weight(&tables, (0..n).map(|i| (p, mu(i))));
            let total: f32 = (0..n).zip(weights).map(|(i, weight)| weight.x * mu(i) * (2.0 / n as f32)).sum();
            assert!((total - 1.0).abs() < 1e-3, "{indices:?} {roughness} {coat_weight}: {total}");
        }
    }
}
