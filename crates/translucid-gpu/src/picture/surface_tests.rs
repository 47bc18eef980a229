//! The surface's shaders against the renderer, case by case; and the laws of its BSDF, which devices sign as it does.
//!
//! A device rounds elsewhere than the renderer. Both are right if each is the exact result for inputs that differ by
//! roundings: so a result may differ by as much as the renderer's own changes when its inputs move by roundings, and by
//! a few roundings of its own.

#![allow(clippy::print_stdout, reason = "the errors are for those who ask with --nocapture")]

use glam::Vec3;
use translucid_render::internals::bsdf::{
    Bsdf, BsdfSample, BsdfValue, Lobe, MaterialTables, SurfaceParameters, fresnel_dielectric,
};

mod judged;
#[path = "../../../translucid-render/src/surface/bsdf/laws.rs"]
mod laws;

use laws::Random;

/// Two units in the last place of numbers below 1.
const STEP: f32 = 1.0 / (1 << 23) as f32;
/// Roundings of a result, relative to it: 2e-6 but for differences that lose a digit, as the chance of transmission by a facet
/// that nearly always reflects.
const ROUNDING: f32 = 1e-5;
/// Steps by which inputs count as moved.
const STEPS: f32 = 4.0;

/// Indices of base and coat.
const INDICES: [[f32; 2]; 5] = [[1.0, 1.5], [1.33, 1.6], [1.5, 1.6], [2.4, 1.0], [4.0, 1.3]];

fn surface(random: &mut Random, number: usize, indices: [f32; 2]) -> SurfaceParameters {
    if number.is_multiple_of(4) { random.thin_walled(indices) } else { random.material(indices) }
}

/// Numbers moved by a step one at a time, up and down.
fn moved(numbers: [f32; 3]) -> impl Iterator<Item = [f32; 3]> {
    (0..6).map(move |k| {
        let mut moved = numbers;
        moved[k / 2] += if k % 2 == 0 { STEP } else { -STEP };
        moved
    })
}

/// Errors in units of what is allowed.
#[derive(Default)]
struct Errors(Vec<f32>);

impl Errors {
    /// Adds the difference between a device's result and the renderer's, of which `around` are those for moved inputs.
    fn add(
        &mut self,
        found: Vec3,
        expected: Vec3,
        around: impl Iterator<Item = Vec3>,
        of: &dyn Fn() -> String,
    ) {
        let difference = |other: Vec3| (other - expected).abs().max_element();
        let spread = around.map(difference).fold(0.0, f32::max);
        let allowed = ROUNDING * expected.abs().max_element() + STEPS * spread + 1e-9;
        let error = difference(found) / allowed;
        if error > 1.0 || error.is_nan() {
            println!("{}: {found} is not {expected} ± {allowed}", of());
        }
        self.0.push(error);
    }

    /// Asserts that none is too large, and prints how they are distributed.
    fn assert(mut self) {
        self.0.sort_by(f32::total_cmp);
        let at = |part: f64| self.0[(part * (self.0.len() - 1) as f64) as usize];
        println!("{} errors: {:?}", self.0.len(), [0.5, 0.9, 0.99, 0.999, 1.0].map(at));
        assert!(at(0.0) >= 0.0 && at(1.0) <= 1.0, "{} {}", at(0.0), at(1.0));
    }
}

#[test]
fn places_of_tables_are_those_of_the_shaders() {
    let text = judged::SHADERS.concat();
    let mut place = 0;
    for (name, numbers) in MaterialTables::new(1.5, 1.6).sections() {
        assert!(place == 0 || text.contains(&format!("const {name} = {place}u;\n")), "{name} {place}");
        place += numbers.len();
    }
}

#[test]
fn device_evaluates_as_the_renderer_does() {
    let mut random = Random::of(41);
    let mut errors = Errors::default();
    for indices in INDICES {
        let tables = MaterialTables::new(indices[0], indices[1]);
        let cases: Vec<_> = (0..3000)
            .map(|k| {
                let (p, wo) = (surface(&mut random, k, indices), random.direction());
                // Narrow lobes are met by their own samples only
                match Bsdf::new(&p, &tables, wo).sample(random.next(), [random.next(), random.next()]) {
                    Some(BsdfSample::Direction { wi, .. }) if k % 3 > 0 => (p, wo, wi),
                    _ => (p, wo, random.direction()),
                }
            })
            .collect();
        for ((p, wo, wi), found) in cases.iter().zip(judged::eval(&tables, cases.iter().copied())) {
            let bsdf = Bsdf::new(p, &tables, *wo);
            let seen = |wo: [f32; 3]| Bsdf::new(p, &tables, Vec3::from(wo)).eval(*wi);
            let around: Vec<_> = moved(wi.to_array())
                .map(|wi| bsdf.eval(Vec3::from(wi)))
                .chain(moved(wo.to_array()).map(seen))
                .collect();
            for (name, part) in [
                ("diffuse", (|value| value.diffuse) as fn(&BsdfValue) -> Vec3),
                ("specular", |value| value.specular),
                ("pdf", |value| Vec3::splat(value.pdf)),
            ] {
                let of = || format!("{name} of {p:?} {wo} {wi}");
                errors.add(part(&found), part(&bsdf.eval(*wi)), around.iter().map(part), &of);
            }
        }
    }
    errors.assert();
}

/// A decision without its numbers: the lobe, or `None` for light from below, and whether light crosses the surface.
fn decision(sample: &BsdfSample) -> (Option<Lobe>, bool) {
    match *sample {
        BsdfSample::Direction { lobe, transmitted, .. } => (Some(lobe), transmitted),
        BsdfSample::Subsurface { .. } => (None, false),
    }
}

/// The numbers of a decision: direction, weight, its matte part and density.
fn numbers(sample: &BsdfSample) -> [Vec3; 4] {
    match *sample {
        BsdfSample::Direction { wi, weight, diffuse_share, pdf, .. } => {
            [wi, weight, weight * diffuse_share, Vec3::splat(pdf)]
        }
        BsdfSample::Subsurface { weight } => [Vec3::ZERO, weight, Vec3::ZERO, Vec3::ZERO],
    }
}

/// The numbers of a decision if its direction is rounded otherwise.
fn around_direction(bsdf: &Bsdf<'_>, sample: &BsdfSample) -> Vec<[Vec3; 4]> {
    let BsdfSample::Direction { wi, pdf, .. } = *sample else { return Vec::new() };
    let directions = moved(wi.to_array()).filter(|_| pdf > 0.0).map(Vec3::from);
    directions
        .map(|wi| (wi, bsdf.eval(wi)))
        .filter(|(_, value)| value.pdf > 0.0)
        .map(|(wi, v)| [wi, (v.diffuse + v.specular) / v.pdf, v.diffuse / v.pdf, Vec3::splat(v.pdf)])
        .collect()
}

/// The material with a tint that is rounded otherwise, which matters to light that crosses a sheet at grazing angles.
fn paler(p: &SurfaceParameters) -> SurfaceParameters {
    SurfaceParameters { transmission_tint: p.transmission_tint * (1.0 - 0.5 * STEP), ..*p }
}

#[test]
fn device_samples_as_the_renderer_does() {
    let mut random = Random::of(43);
    let mut errors = Errors::default();
    let (mut count, mut edges) = (0, 0);
    for indices in INDICES {
        let tables = MaterialTables::new(indices[0], indices[1]);
        let cases: Vec<_> = (0..6000)
            .map(|k| (surface(&mut random, k, indices), random.direction(), random.triple()))
            .collect();
        for ((p, wo, u), found) in cases.iter().zip(judged::sample(&tables, cases.iter().copied())) {
            let bsdf = Bsdf::new(p, &tables, *wo);
            let draw = |bsdf: &Bsdf<'_>, u: [f32; 3]| {
                let [u, v0, v1] = u.map(|u| u.clamp(0.0, 1.0 - 0.5 * STEP));
                bsdf.sample(u, [v0, v1])
            };
            let expected = draw(&bsdf, *u);
            count += 1;
            if found.as_ref().map(decision) != expected.as_ref().map(decision) {
                edges += 1;
                continue;
            }
            let (Some(found), Some(expected)) = (found, expected) else { continue };
            let same = |sample: Option<BsdfSample>| {
                sample.filter(|sample| decision(sample) == decision(&expected)).as_ref().map(numbers)
            };
            let around: Vec<_> = moved(*u)
                .map(|u| draw(&bsdf, u))
                .chain(moved(wo.to_array()).map(|wo| draw(&Bsdf::new(p, &tables, Vec3::from(wo)), *u)))
                .chain([draw(&Bsdf::new(&paler(p), &tables, *wo), *u)])
                .filter_map(same)
                .chain(around_direction(&bsdf, &expected))
                .collect();
            let names = ["direction", "weight", "matte weight", "pdf"];
            for (k, name) in names.into_iter().enumerate() {
                let of = || format!("{name} of {p:?} {wo} {u:?}, {:?}", decision(&expected));
                errors.add(numbers(&found)[k], numbers(&expected)[k], around.iter().map(|n| n[k]), &of);
            }
        }
    }
    println!("{edges} of {count} decisions on an edge");
    assert!(1000 * edges < count, "{edges} of {count}");
    errors.assert();
}

#[test]
fn device_clamps_surfaces_as_the_renderer_does() {
    let odd = [f32::NAN, -1.0, 0.5, 7.0, f32::INFINITY, f32::NEG_INFINITY];
    let (mut random, tables) = (Random::of(59), MaterialTables::new(1.5, 1.6));
    let mut number = || odd[(random.next() * odd.len() as f32) as usize];
    let mut color = || Vec3::new(number(), number(), number());
    let cases: Vec<_> = (0..2000)
        .map(|k| {
            let [weights, rest, last] = [color(), color(), color()];
            let p = SurfaceParameters {
                base_color: color(),
                specular_color: color(),
                transmission_tint: color(),
                surface_albedo: color(),
                coat_color: color(),
                metalness: weights.x,
                specular_weight: weights.y,
                specular_roughness: weights.z,
                transmission_weight: rest.x,
                subsurface_weight: rest.y,
                coat_weight: rest.z,
                coat_roughness: last.x,
                thin: (k % 4 == 0).into(),
                thin_albedo: color(),
                ..SurfaceParameters::default()
            };
            (p, laws::direction(0.6) * if k % 3 == 0 { -1.0 } else { 1.0 })
        })
        .collect();
    for ((p, wo), (albedo, _)) in cases.iter().zip(judged::seen(&tables, cases.iter().copied())) {
        let expected = Bsdf::new(p, &tables, *wo).albedo();
        assert!((albedo - expected).abs().max_element() < ROUNDING, "{p:?} {wo}: {albedo} is not {expected}");
    }
}
