//! Passes made as engines make them, each with a mistake that is known, and none.

#![allow(clippy::print_stdout, reason = "sentences are for those who ask with --nocapture")]

use std::f64::consts::TAU;

use translucid_profile::{AlbedoInversion, Medium, Model, Profile, TabulatedProfile};
use translucid_reference::Incidence;
use translucid_reference::exact::single_scattering_albedo;
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_testing::SplitMix;

use super::*;

const PIXEL: f64 = 0.1;
const SETUPS: [Setup; 3] = [Setup::Edge, Setup::Disk { radius: 2.0 }, Setup::Line { width: 1.6 }];
const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];

/// Whether a place of the plane is lit; shapes end between pixels.
fn is_lit(setup: Setup, x: f64, y: f64) -> bool {
    match setup {
        Setup::Edge => x < 0.0,
        Setup::Disk { radius } => x.hypot(y) < radius,
        Setup::Line { width } => x.abs() < 0.5 * width,
    }
}

/// Places of a picture.
fn places(setup: Setup) -> Vec<f64> {
    let first = if setup == Setup::Edge { -200 } else { 0 };
    (first..200).map(|i| (f64::from(i) + 0.5) * PIXEL).collect()
}

fn material(surface_albedo: f64) -> Appearance {
    appearance(surface_albedo, 1.0, false, 0.0)
}

fn profile(model: Model, surface_albedo: f64, configuration: Configuration) -> Box<dyn Profile> {
    model.profile(&material(surface_albedo), configuration, 1.0).unwrap()
}

/// A gather by weighed taps \[x, y, weight\], divided by the sum of weights.
fn gathered(setup: Setup, taps: &[[f64; 3]]) -> Vec<f64> {
    let all: f64 = taps.iter().map(|tap| tap[2]).sum();
    let light = |x: f64| {
        let lit = taps.iter().filter(|[dx, dy, _]| is_lit(setup, x + dx, *dy));
        lit.map(|tap| tap[2]).sum::<f64>() / all
    };
    places(setup).into_iter().map(light).collect()
}

/// Taps over a disk, evenly by the energy of a profile.
fn disk_taps(profile: &dyn Profile) -> Vec<[f64; 3]> {
    let n = 8192;
    let tap = |i: i32| {
        let r = profile.quantile((f64::from(i) + 0.5) / f64::from(n));
        let (sin, cos) = libm::sincos(2.399_963_229_728_653 * f64::from(i));
        [r * cos, r * sin, 1.0]
    };
    (0..n).map(tap).collect()
}

/// Taps on rings a pixel apart, weighed by R(r) alone.
fn unweighted_taps(profile: &dyn Profile) -> Vec<[f64; 3]> {
    let tap = |i: i32| {
        let r = (f64::from(i / 32) + 0.5) * PIXEL;
        let (sin, cos) = libm::sincos(TAU * (f64::from(i % 32) + 0.37 * f64::from(i / 32)) / 32.0);
        [r * cos, r * sin, profile.eval(r)]
    };
    (0..32 * 300).map(tap).collect()
}

/// Taps of blurs along x and y by R(|x|); across an edge or a line the second one does nothing.
fn slice_taps(profile: &dyn Profile) -> Vec<[f64; 3]> {
    let tap = |i: i32| {
        let x = PIXEL * f64::from(i);
        [x, 0.0, profile.eval(x.abs().max(0.25 * PIXEL))]
    };
    (-300..=300).map(tap).collect()
}

fn pass(setup: Setup, surface_albedo: f64, configuration: Configuration, values: Vec<f64>) -> Pass {
    let bins = Bins { places: places(setup), values, ..Bins::default() };
    Pass {
        setup,
        appearance: material(surface_albedo),
        eta: 1.0,
        configuration,
        pixel: PIXEL,
        white: None,
        bins,
    }
}

fn judged(setup: Setup, surface_albedo: f64, configuration: Configuration, taps: &[[f64; 3]]) -> Judgement {
    let judgement = pass(setup, surface_albedo, configuration, gathered(setup, taps)).judge().unwrap();
    println!(
        "{setup:?} A {surface_albedo} {configuration:?}: {} {:?}: {}",
        judgement.verdict(),
        judgement.causes,
        judgement.sentence
    );
    judgement
}

#[test]
fn right_passes_are_right() {
    for configuration in CONFIGURATIONS {
        for surface_albedo in [0.3, 0.7, 0.9] {
            let taps = disk_taps(&*profile(Model::NormalizedDiffusionRefined, surface_albedo, configuration));
            for setup in SETUPS {
                let judgement = judged(setup, surface_albedo, configuration, &taps);
                assert_eq!(judgement.verdict(), "right", "{}", judgement.sentence);
                assert!(judgement.rms < 0.005 && judgement.causes.is_empty(), "{}", judgement.rms);
                assert!(judgement.sentence.starts_with("right within 0."), "{}", judgement.sentence);
            }
        }
    }
}

#[test]
fn burleys_profile_is_told_as_the_profile() {
    for configuration in CONFIGURATIONS {
        let taps = disk_taps(&*profile(Model::NormalizedDiffusion, 0.9, configuration));
        for setup in SETUPS {
            let judgement = judged(setup, 0.9, configuration, &taps);
            assert_eq!(judgement.verdict(), "profile");
            assert_eq!(judgement.causes, [Cause::NormalizedDiffusion], "{}", judgement.sentence);
            assert!(judgement.explained_rms.unwrap() < 0.25 * judgement.rms);
        }
    }
}

#[test]
fn wrong_gathers_are_told_as_the_gather() {
    for model in [Model::Exact, Model::NormalizedDiffusion] {
        let configuration = Configuration::Diffuse;
        for surface_albedo in [0.6, 0.9] {
            let profile = profile(model, surface_albedo, configuration);
            for setup in SETUPS {
                let judgement = judged(setup, surface_albedo, configuration, &unweighted_taps(&*profile));
                assert_eq!(judgement.causes, [Cause::Unweighted], "{}", judgement.sentence);
                assert_eq!(judgement.verdict(), "gather");
            }
            for setup in [Setup::Edge, Setup::Line { width: 1.6 }] {
                let judgement = judged(setup, surface_albedo, configuration, &slice_taps(&*profile));
                assert_eq!(judgement.causes, [Cause::Slice], "{}", judgement.sentence);
                assert_eq!(judgement.verdict(), "gather");
            }
        }
    }
}

#[test]
fn weights_that_do_not_add_up_are_told_where_white_is_known() {
    let taps = disk_taps(&*profile(Model::Exact, 0.8, Configuration::Diffuse));
    for setup in SETUPS {
        let light = gathered(setup, &taps);
        for (times, words) in [(0.9, "0.900 times"), (0.8, "counts twice"), (1.25, "does not count")] {
            let values = light.iter().map(|value| 0.8 * 3.0 * times * value).collect();
            let dark = pass(setup, 0.8, Configuration::Diffuse, values);
            let judgement = Pass { white: Some(3.0), ..dark.clone() }.judge().unwrap();
            assert_eq!(judgement.verdict(), "gather", "{}", judgement.sentence);
            assert!(judgement.sentence.contains(words), "{}", judgement.sentence);
            assert!((judgement.light_error.unwrap() + 1.0 - times).abs() < 0.01);
            // Without white nobody can know
            let judgement = dark.judge().unwrap();
            assert_eq!((judgement.verdict(), judgement.light_error), ("right", None));
        }
    }
}

#[test]
fn widths_and_configurations_are_told() {
    let configuration = Configuration::Diffuse;
    let wide = |factor: f64| {
        let appearance = appearance(0.8, factor, false, 0.0);
        disk_taps(&*Model::Exact.profile(&appearance, configuration, 1.0).unwrap())
    };
    let dmfp = Medium::from_mfp(single_scattering_albedo(0.8, 1.0, Incidence::Cosine).unwrap(), 1.0, 0.0)
        .unwrap()
        .dmfp();
    for setup in SETUPS {
        for (factor, words) in [(1.3, "+30 % off"), (0.7, "-30 % off"), (1.0 / dmfp, "mean free path stands")]
        {
            let judgement = judged(setup, 0.8, configuration, &wide(factor));
            assert_eq!(judgement.verdict(), "profile");
            assert!(judgement.sentence.contains(words), "{factor}: {}", judgement.sentence);
        }
    }
    let taps = disk_taps(&*profile(Model::Exact, 0.3, Configuration::Searchlight));
    let judgement = judged(Setup::Edge, 0.3, configuration, &taps);
    assert_eq!(judgement.causes, [Cause::Configuration], "{}", judgement.sentence);
}

/// The size that is stated is not that of the picture, which has the right profile.
#[test]
fn wrong_sizes_are_told() {
    let configuration = Configuration::Diffuse;
    for surface_albedo in [0.5, 0.9] {
        let taps = disk_taps(&*profile(Model::Exact, surface_albedo, configuration));
        for (drawn, stated) in [
            (Setup::Disk { radius: 2.0 }, Setup::Disk { radius: 4.0 }),
            (Setup::Disk { radius: 2.0 }, Setup::Disk { radius: 1.0 }),
            (Setup::Disk { radius: 2.0 }, Setup::Disk { radius: 2.4 }),
            (Setup::Line { width: 1.6 }, Setup::Line { width: 3.2 }),
            (Setup::Line { width: 1.6 }, Setup::Line { width: 0.8 }),
            (Setup::Line { width: 1.6 }, Setup::Line { width: 2.0 }),
        ] {
            let values = gathered(drawn, &taps).into_iter().map(|value| surface_albedo * value).collect();
            let pass = Pass { white: Some(1.0), ..pass(stated, surface_albedo, configuration, values) };
            let judgement = pass.judge().unwrap();
            let [Cause::Size(times)] = judgement.causes[..] else {
                panic!("{surface_albedo} {drawn:?} {stated:?}: {}", judgement.sentence)
            };
            assert!(
                (times * stated.size() / drawn.size() - 1.0).abs() < 0.02,
                "{drawn:?} {stated:?}: {times}"
            );
            assert_eq!(judgement.verdict(), "picture");
            assert!(judgement.sentence.contains("check the size"), "{}", judgement.sentence);
        }
    }
}

/// Light of another solution, by wave number, where the judge has photons walk; and passes that know no phase function.
#[test]
fn passes_over_other_media_are_judged() {
    let configuration = Configuration::Diffuse;
    let (g, eta, surface_albedo) = (0.8, 1.4, 0.8);
    let alpha = AlbedoInversion::new(g, eta, configuration).unwrap().single_scattering_albedo(surface_albedo);
    let layer = Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_g(g).with_eta(eta);
    let row = Layers::new(1.0, vec![layer], Ground::None).unwrap().diffuse_profile().unwrap().row().unwrap();
    let right = TabulatedProfile::from_enclosed(&row.radii, &row.enclosed).unwrap();
    // A tenth of the lengths of a medium that scatters forward
    let length = 0.1;
    let taps = |profile: &dyn Profile, times: f64| -> Vec<[f64; 3]> {
        disk_taps(profile).into_iter().map(|[x, y, weight]| [times * x, times * y, weight]).collect()
    };
    let plain = profile(Model::Exact, surface_albedo, configuration);
    let setup = Setup::Edge;
    for (taps, verdict) in [
        (taps(&right, length), "right"),
        (taps(&right, 1.3 * length), "profile"),
        (taps(&*plain, length), "profile"),
    ] {
        let appearance = appearance(surface_albedo, length, false, g);
        let pass = pass(setup, surface_albedo, configuration, gathered(setup, &taps));
        let judged = Pass { appearance, eta, ..pass }.judge().unwrap();
        println!("{setup:?}: {} {:?}: {}", judged.verdict(), judged.causes, judged.sentence);
        assert_eq!(judged.verdict(), verdict, "{setup:?}: {}", judged.sentence);
    }
}

/// A pixel that keeps a part of its light; and a pass of noise, for which there is no reason.
#[test]
fn centers_are_told_and_what_is_unknown_is_unknown() {
    let configuration = Configuration::Diffuse;
    let mut taps = disk_taps(&*profile(Model::Exact, 0.8, configuration));
    taps.push([0.0, 0.0, 0.25 * taps.len() as f64]);
    for setup in SETUPS {
        let judgement = judged(setup, 0.8, configuration, &taps);
        let [Cause::Center(weight)] = judgement.causes[..] else { panic!("{}", judgement.sentence) };
        assert!((weight - 0.2).abs() < 0.02, "{weight}");
    }
    // A box is no profile
    let taps: Vec<[f64; 3]> = (-40..=40).map(|i| [f64::from(i) * PIXEL, 0.0, 1.0]).collect();
    let judgement = judged(Setup::Edge, 0.8, configuration, &taps);
    assert_eq!((judgement.verdict(), judgement.causes.len()), ("unknown", 0), "{}", judgement.sentence);
}

/// Light along axes and diagonals; noise is no reason. Seed 5, one comparison a noise.
#[test]
fn crosses_are_told_by_directions() {
    let setup = Setup::Disk { radius: 2.0 };
    let taps = disk_taps(&*profile(Model::NormalizedDiffusion, 0.9, Configuration::Diffuse));
    let values = gathered(setup, &taps);
    let mut random = SplitMix(5);
    for (ripple, verdict) in [(0.0, Cause::NormalizedDiffusion), (0.1, Cause::Separable)] {
        let mut pass = pass(setup, 0.9, Configuration::Diffuse, values.clone());
        let mut along = |sign: f64| {
            let one = |value: &f64| value * (1.0 + sign * ripple + 0.02 * (random.uniform() - 0.5));
            values.iter().map(one).collect()
        };
        pass.bins.directions = Some([along(1.0), along(-1.0)]);
        let judgement = pass.judge().unwrap();
        assert_eq!(judgement.causes, [verdict], "{}", judgement.sentence);
    }
}

#[test]
fn pictures_that_show_too_little_are_refused() {
    let configuration = Configuration::Diffuse;
    let taps = disk_taps(&*profile(Model::Exact, 0.8, configuration));
    let whole = pass(Setup::Edge, 0.8, configuration, gathered(Setup::Edge, &taps));
    let mut cut = whole.clone();
    cut.bins.places.truncate(203);
    cut.bins.values.truncate(203);
    assert!(matches!(cut.judge(), Err(Unjudged::TooSmall([end, wanted])) if end < wanted && wanted < 3.0));
    let mut coarse = whole.clone();
    coarse.appearance.length = 0.05;
    assert!(matches!(coarse.judge(), Err(Unjudged::TooCoarse(_))));
    let mut dark = whole;
    dark.bins.values.fill(0.0);
    assert_eq!(dark.judge(), Err(Unjudged::Dark));
    dark.appearance.surface_albedo = 1.5;
    assert!(matches!(dark.judge(), Err(Unjudged::Parameter(_))));
}
