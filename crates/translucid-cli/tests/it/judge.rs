//! `judge`: pictures of passes as engines make them, right and wrong.

use std::path::Path;

use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};
use serde_json::Value;
use translucid_laboratory::oracle::LitShape;
use translucid_profile::{Appearance, Configuration, Model, Parameterization, Profile};
use translucid_testing::SplitMix;

use crate::common::{files, run, stderr, stdout};
use crate::markdown::root;

const SIZE: [usize; 2] = [400, 20];
const PIXEL: f64 = 0.1;
const ALBEDOS: [f64; 3] = [0.9, 0.6, 0.3];
const MATERIAL: &str = "--pixel 0.1 --surface-albedo 0.9,0.6,0.3 --mfp 1,0.8,0.8";

fn profiles(model: Model) -> [Box<dyn Profile>; 3] {
    [(0.9, 1.0), (0.6, 0.8), (0.3, 0.8)].map(|(surface_albedo, length)| {
        let appearance =
            Appearance { surface_albedo, length, parameterization: Parameterization::Mfp, g: 0.0 };
        model.profile(&appearance, Configuration::Diffuse, 1.0).unwrap()
    })
}

/// Taps of a gather over a disk.
fn disk_taps(profile: &dyn Profile) -> Vec<[f64; 3]> {
    let tap = |i: i32| {
        let r = profile.quantile((f64::from(i) + 0.5) / 2048.0);
        let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
        [r * cos, r * sin, 1.0]
    };
    (0..2048).map(tap).collect()
}

/// Taps of a blur by the profile's slice.
fn slice_taps(profile: &dyn Profile) -> Vec<[f64; 3]> {
    (-200..=200).map(|i| f64::from(i) * PIXEL).map(|x| [x, 0.0, profile.eval(x.abs().max(0.025))]).collect()
}

/// A picture of lit places, gathered channel by channel, times the surface albedo and 2, the white of the picture.
fn picture(
    path: &Path,
    [width, height]: [usize; 2],
    is_lit: &dyn Fn(f64, f64) -> bool,
    taps: &[Vec<[f64; 3]>; 3],
    is_extruded: bool,
) {
    let value = |x: usize, y: usize, c: usize| {
        let [x, y] = [x, y].map(|at| (at as f64 + 0.5) * PIXEL);
        let all: f64 = taps[c].iter().map(|tap| tap[2]).sum();
        let lit = taps[c].iter().filter(|[dx, dy, _]| is_lit(x + dx, y + dy));
        (2.0 * ALBEDOS[c] * lit.map(|tap| tap[2]).sum::<f64>() / all) as f32
    };
    let rows = if is_extruded { 1 } else { height };
    let pixels: Vec<[f32; 3]> =
        (0..rows * width).map(|i| [0, 1, 2].map(|c| value(i % width, i / width, c))).collect();
    let at = |at: Vec2<usize>| {
        let [r, g, b] = pixels[if is_extruded { 0 } else { at.y() } * width + at.x()];
        (r, g, b)
    };
    Image::from_channels((width, height), SpecificChannels::rgb(at)).write().to_file(path).unwrap();
}

/// The edge is between two pixels.
fn is_edge_lit(x: f64, _y: f64) -> bool {
    x > 19.999
}

fn json(folder: &Path, words: &str) -> Vec<Value> {
    let text = stdout(folder, &format!("judge {words} --format json"));
    serde_json::from_str::<Value>(&text).unwrap().as_array().unwrap().clone()
}

fn verdicts(rows: &[Value]) -> Vec<&str> {
    rows.iter().map(|row| row["verdict"].as_str().unwrap()).collect()
}

#[test]
fn three_passes_are_judged() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let taps = |model: Model| profiles(model).map(|profile| disk_taps(&*profile));
    picture(&path("right.exr"), SIZE, &is_edge_lit, &taps(Model::NormalizedDiffusionRefined), true);
    picture(&path("burley.exr"), SIZE, &is_edge_lit, &taps(Model::NormalizedDiffusion), true);
    picture(
        &path("slice.exr"),
        SIZE,
        &is_edge_lit,
        &profiles(Model::Exact).map(|one| slice_taps(&*one)),
        true,
    );

    let rows = json(folder.path(), &format!("right.exr --setup edge {MATERIAL} --white 2"));
    assert_eq!(verdicts(&rows), ["right"; 3], "{rows:?}");
    assert!(rows.iter().all(|row| row["light_error"].as_f64().unwrap().abs() < 0.005), "{rows:?}");
    assert!(rows.iter().all(|row| row["rms_error"].as_f64().unwrap() < 0.005), "{rows:?}");

    let rows = json(folder.path(), &format!("burley.exr --setup edge {MATERIAL}"));
    assert_eq!(rows[0]["verdict"], "profile", "{rows:?}");
    assert!(rows[0]["sentence"].as_str().unwrap().contains("Burley's of 2015"), "{rows:?}");
    assert!(rows[0]["light_error"].is_null());
    // Burley's is too narrow there
    let width = |name: &str| rows[0][name].as_f64().unwrap();
    assert!(width("width_10") < 0.9 * width("exact_width_10"), "{rows:?}");

    let rows = json(folder.path(), &format!("slice.exr --setup edge {MATERIAL}"));
    assert_eq!(verdicts(&rows), ["gather"; 3], "{rows:?}");
    assert!(rows[0]["sentence"].as_str().unwrap().contains("R(|x|)"), "{rows:?}");

    // Too bright by a tenth
    let rows = json(folder.path(), &format!("right.exr --setup edge {MATERIAL} --white 1.8"));
    assert_eq!(verdicts(&rows), ["gather"; 3], "{rows:?}");

    // For people and as a plot
    let text = stdout(folder.path(), &format!("judge right.exr --setup edge {MATERIAL} -o plot.svg"));
    assert!(text.starts_with("red: right within") && text.contains("light falls to 25 % at"), "{text}");
    let plot = std::fs::read_to_string(path("plot.svg")).unwrap();
    assert!(plot.starts_with("<svg") && plot.contains("blue: exact"), "{plot:.300}");
    let csv = stdout(folder.path(), &format!("judge right.exr --setup edge {MATERIAL} --format csv"));
    assert!(csv.starts_with("channel,verdict,light_error,rms_error") && csv.lines().count() == 4, "{csv}");
}

/// Edges anywhere between the middles of pixels, and at an angle: by the exact light at each pixel's middle, whose widths
/// have to come back.
#[test]
fn edges_through_pixels_and_diagonal_ones_are_right() {
    let folder = tempfile::tempdir().unwrap();
    let profiles = profiles(Model::Exact);
    let light =
        |distance: f64, c: usize| LitShape::Edge { distance }.response(&*profiles[c]).value as f32 * 2.0;
    for (name, degrees, offset) in [
        ("quarter", 0.0, 0.25),
        ("half", 180.0, 0.5),
        ("most", 90.0, 0.9),
        ("small", 2.0, 0.3),
        ("turned", 30.0, 0.6),
        ("diagonal", 225.0, 0.1),
    ] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let at = |at: Vec2<usize>| {
            let [x, y] = [at.x(), at.y()].map(|i| i as f64 + 0.5 - 80.0 - offset);
            let light = |c: usize| light((x * cos + y * sin) * PIXEL, c);
            (light(0), light(1), light(2))
        };
        let path = folder.path().join(format!("{name}.exr"));
        Image::from_channels((160, 160), SpecificChannels::rgb(at)).write().to_file(path).unwrap();
        let rows = json(folder.path(), &format!("{name}.exr --setup edge {MATERIAL} --white 2"));
        assert_eq!(verdicts(&rows), ["right"; 3], "{name}: {rows:?}");
        for row in &rows {
            for level in ["25", "10", "5"] {
                let width = |prefix: &str| row[format!("{prefix}width_{level}")].as_f64().unwrap();
                let off = width("") / width("exact_") - 1.0;
                assert!(off.abs() < 0.01, "{name} {level}: {off}");
            }
        }
    }
}

/// A pass by the light of a row, with noise of a part of each pixel's light, in the numbers that a curve makes of it.
fn edge_with_noise(
    path: &Path,
    model: Model,
    [noise, white]: [f64; 2],
    random: &mut SplitMix,
    curve: &dyn Fn(f64) -> f64,
) {
    let (profiles, [width, height]) = (profiles(model), [240, 48]);
    let light = |x: usize, c: usize| {
        let distance = (x as f64 + 0.5 - 120.3) * PIXEL;
        white * LitShape::Edge { distance }.response(&*profiles[c]).value
    };
    let row: Vec<[f64; 3]> = (0..width).map(|x| [0, 1, 2].map(|c| light(x, c))).collect();
    // Of unit variance
    let mut normal = || (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0;
    let mut value = |i: usize, c: usize| curve(row[i % width][c] * (1.0 + noise * normal())) as f32;
    let pixels: Vec<[f32; 3]> = (0..width * height).map(|i| [0, 1, 2].map(|c| value(i, c))).collect();
    let at = |at: Vec2<usize>| pixels[at.y() * width + at.x()].into();
    Image::from_channels((width, height), SpecificChannels::rgb(at)).write().to_file(path).unwrap();
}

/// IEC 61966-2-1, section 5.2, from light to codes.
fn code(light: f64) -> f64 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// Noise of a pass is no mistake, and codes are none of the profile. Seed 11, twelve pictures.
#[test]
fn noise_and_codes_are_no_wrong_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pass.exr");
    let mut random = SplitMix(11);
    let mut judged = |model: Model, noise: f64, white: f64, curve: &dyn Fn(f64) -> f64| {
        edge_with_noise(&path, model, [noise, white], &mut random, curve);
        json(folder.path(), &format!("pass.exr --setup edge {MATERIAL} --white {}", curve(white)))
    };
    let sentence = |row: &Value| row["sentence"].as_str().unwrap().to_owned();
    let linear = |light: f64| light;
    for _ in 0..3 {
        for row in judged(Model::Exact, 0.03, 2.0, &linear) {
            assert!(row["verdict"] == "right" && sentence(&row).contains("; noise is "), "{row}");
            assert!((0.001..0.02).contains(&row["noise"].as_f64().unwrap()), "{row}");
        }
        for row in judged(Model::Exact, 0.6, 2.0, &linear) {
            assert!(row["verdict"] == "unknown" && sentence(&row).starts_with("noise hides"), "{row}");
        }
        // At A = 0.3 there is hardly anything to tell
        let [first, ..] = &judged(Model::NormalizedDiffusion, 0.03, 2.0, &linear)[..] else {
            panic!("no rows")
        };
        assert!(first["verdict"] == "profile" || sentence(first).contains("noise hides which"), "{first}");
        assert!(sentence(first).contains("Burley's of 2015"), "{first}");
    }
    for noise in [0.0, 0.03] {
        for row in judged(Model::Exact, noise, 1.0, &code) {
            assert_eq!(row["verdict"], "picture", "{row}");
            assert!(
                sentence(&row).contains("codes of sRGB") && sentence(&row).contains("decoded: right"),
                "{row}"
            );
        }
    }
    let [first, ..] = &judged(Model::NormalizedDiffusion, 0.0, 1.0, &code)[..] else { panic!("no rows") };
    assert!(
        sentence(first).contains("codes of sRGB") && sentence(first).contains("Burley's of 2015"),
        "{first}"
    );
}

#[test]
fn wrong_sizes_other_media_and_lengths_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let taps = profiles(Model::Exact).map(|profile| disk_taps(&*profile));
    let lit = |x: f64, _: f64| (x - 20.0).abs() < 0.799;
    picture(&folder.path().join("line.exr"), SIZE, &lit, &taps, true);
    let rows = json(folder.path(), &format!("line.exr --setup line --size 2.4 {MATERIAL}"));
    assert_eq!(verdicts(&rows), ["picture"; 3], "{rows:?}");
    let sentence = rows[0]["sentence"].as_str().unwrap();
    assert!(
        sentence.contains("the lit shape of the picture is 1.59") && sentence.contains("not 2.4000"),
        "{sentence}"
    );

    // The same mean free paths mean more light far away where light is scattered forward
    let rows = json(folder.path(), &format!("line.exr --setup line --size 1.6 {MATERIAL} --g 0.8"));
    assert_eq!(rows[0]["verdict"], "profile", "{rows:?}");
    assert!(rows[0]["sentence"].as_str().unwrap().contains("--g"), "{rows:?}");

    let words = "judge line.exr --setup line --size 1.6 --pixel 0.1 --surface-albedo 0.8 --dmfp 6";
    let said = stderr(&run(folder.path(), words));
    let page = std::fs::read_to_string(root().join("docs/guide/oracle.md")).unwrap();
    for ratio in ["5.978", "7.404", "7.618"] {
        assert!(said.contains(ratio) && page.contains(&format!("| {ratio} |")), "{ratio}: {said}");
    }
}

#[test]
fn disks_and_lines_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let taps = profiles(Model::Exact).map(|profile| disk_taps(&*profile));
    let lit = |x: f64, y: f64| (x - 3.5).hypot(y - 3.5) < 1.0;
    let few = taps.clone().map(|taps| taps.into_iter().step_by(2).collect());
    picture(&folder.path().join("disk.exr"), [70, 70], &lit, &few, false);
    let rows = json(folder.path(), &format!("disk.exr --setup disk --size 2 {MATERIAL} --white 2"));
    assert_eq!(verdicts(&rows), ["right"; 3], "{rows:?}");

    let lit = |x: f64, _: f64| (x - 20.0).abs() < 0.799;
    picture(&folder.path().join("line.exr"), SIZE, &lit, &taps, true);
    let rows = json(folder.path(), &format!("line.exr --setup line --size 1.6 {MATERIAL} --white 2"));
    assert_eq!(verdicts(&rows), ["right"; 3], "{rows:?}");
    // A separable blur of a disk is a cross
    let slices = profiles(Model::Exact).map(|profile| slice_taps(&*profile));
    let blurred = |x: f64, y: f64, c: usize| {
        let all: f64 = slices[c].iter().map(|tap| tap[2]).sum();
        let mut sum = 0.0;
        for [dy, _, wy] in slices[c].iter().filter(|[dy, ..]| (y + dy - 3.5).abs() < 1.0) {
            let half = (1.0 - (y + dy - 3.5).powi(2)).sqrt();
            let inside = slices[c].iter().filter(|[dx, ..]| (x + dx - 3.5).abs() < half);
            sum += wy * inside.map(|tap| tap[2]).sum::<f64>();
        }
        (2.0 * ALBEDOS[c] * sum / (all * all)) as f32
    };
    let at = |at: Vec2<usize>| {
        let [x, y] = [at.x(), at.y()].map(|at| (at as f64 + 0.5) * PIXEL);
        (blurred(x, y, 0), blurred(x, y, 1), blurred(x, y, 2))
    };
    let path = folder.path().join("cross.exr");
    Image::from_channels((70, 70), SpecificChannels::rgb(at)).write().to_file(&path).unwrap();
    let rows = json(folder.path(), &format!("cross.exr --setup disk --size 2 {MATERIAL}"));
    assert_eq!(verdicts(&rows), ["gather"; 3], "{rows:?}");
    assert!(rows[0]["sentence"].as_str().unwrap().contains("a cross"), "{rows:?}");
}

#[test]
fn what_cannot_be_judged_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, size: (usize, usize), value: &(dyn Fn(usize, usize) -> f32 + Sync)| {
        let at = |at: Vec2<usize>| {
            let value = value(at.x(), at.y());
            (value, value, value)
        };
        Image::from_channels(size, SpecificChannels::rgb(at))
            .write()
            .to_file(folder.path().join(name))
            .unwrap();
    };
    let edge = |x: usize, _: usize| if x < 100 { 0.001 } else { 0.8 };
    write("edge.exr", (200, 20), &edge);
    write("nan.exr", (200, 20), &|x, y| if (x, y) == (7, 3) { f32::NAN } else { edge(x, y) });
    write("small.exr", (200, 8), &edge);
    write("even.exr", (200, 20), &|_, _| 0.5);
    write("near.exr", (20, 20), &|x, _| if x < 10 { 0.001 } else { 0.8 });
    let gray = SpecificChannels::build().with_channel("Z").with_pixel_fn(|_| (1.0_f32,));
    Image::from_channels((200, 20), gray).write().to_file(folder.path().join("depth.exr")).unwrap();
    std::fs::write(folder.path().join("text.exr"), "no picture").unwrap();

    let good = "--pixel 0.1 --surface-albedo 0.8 --mfp 1";
    let edge = "edge.exr --setup edge";
    for (words, parts) in [
        (
            format!("{edge} --pixel 0.1 --surface-albedo 0.8 --dmfp 1,2"),
            ["--dmfp is [1, 2]", "one number or three"],
        ),
        (format!("{edge} --pixel 0.1 --surface-albedo 0.8"), ["--mfp", "--dmfp"]),
        (format!("{edge} --pixel 1e-15 --surface-albedo 0.8 --mfp 1"), ["the picture ends 9.9", "at 0.7"]),
        (format!("{edge} {good} --size 2"), ["--size is 2", "for a disk or a line"]),
        (format!("edge.exr --setup disk {good}"), ["size is missing", "diameter"]),
        (format!("edge.exr --setup line --size 1 {good}"), ["edge.exr", "no single line of light"]),
        (format!("edge.exr --setup disk --size 1 {good}"), ["edge.exr", "disk of light"]),
        (format!("even.exr --setup edge {good}"), ["even.exr", "no edge of light"]),
        (format!("nan.exr --setup edge {good}"), ["nan.exr", "channel R is NaN at the pixel 7,3"]),
        (format!("depth.exr --setup edge {good}"), ["depth.exr", "has no channel R: its channels are Z"]),
        (format!("small.exr --setup edge {good}"), ["small.exr", "fewer than 16 pixels"]),
        (
            "near.exr --setup edge --pixel 0.1 --surface-albedo 0.8 --mfp 10".into(),
            ["near.exr", "light falls to a quarter at"],
        ),
        (
            "edge.exr --setup edge --pixel 5 --surface-albedo 0.8 --mfp 1".to_owned(),
            ["edge.exr", "a pixel is 5"],
        ),
        (format!("text.exr --setup edge {good}"), ["text.exr", "OpenEXR"]),
        (format!("none.exr --setup edge {good}"), ["none.exr", "cannot"]),
        (format!("{edge} {good} -o edge.exr"), ["--output is edge.exr", "choose another file"]),
    ] {
        let before = files(folder.path());
        let output = run(folder.path(), &format!("judge {words}"));
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{words}: {said}");
        assert!(parts.iter().all(|part| said.contains(part)), "{words}: {said}");
        assert!(output.stdout.is_empty() && files(folder.path()) == before, "{words}");
    }
}

/// The three shipped pictures are judged as the guide for engines says.
#[test]
fn shipped_passes_are_right_too_wide_and_too_dark() {
    let folder = root().join("examples/judge");
    let said = |name: &str| {
        let judged = run(
            &folder,
            &format!(
                "judge {name}.exr --setup disk --size 2 --pixel 0.1 --surface-albedo 0.9,0.6,0.4 --mfp 0.5,0.35,0.25 \
                 --white 1"
            ),
        );
        assert!(judged.status.success(), "{}", stderr(&judged));
        let text = String::from_utf8(judged.stdout).unwrap();
        let of = |channel: &str| {
            let line = text.lines().find(|line| line.starts_with(channel)).unwrap().to_owned();
            line.split_once(": ").unwrap().1.to_owned()
        };
        ["red", "green", "blue"].map(of)
    };
    assert!(said("right").iter().all(|words| words.starts_with("right within")));
    assert!(said("too-wide").iter().all(|words| words.contains("its width is +5")));
    for words in said("no-energy") {
        assert!(words.starts_with("the gather returns 0.80"), "{words}");
    }
}
