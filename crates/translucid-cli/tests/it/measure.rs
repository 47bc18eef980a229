//! `translucid measure`: from a photograph to a material.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use crate::common::{run, stderr, stdout};
use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_testing::SplitMix;

const ALBEDOS: [f64; 3] = [0.85, 0.6, 0.35];
/// \[mm\]
const MFPS: [f64; 3] = [1.1, 0.6, 0.35];
/// \[mm\]
const PIXEL: f64 = 0.1;
const SIZE: [usize; 2] = [150, 90];

/// The light beyond an edge by the exact profile in space, over that far on the lit side: not the command's own road by
/// its transform.
struct Edge {
    /// At distances 0, h, 2h, … into the dark.
    beyond: Vec<f64>,
}

impl Edge {
    const STEP: f64 = 0.05;

    fn new(surface_albedo: f64) -> Self {
        let half_space = HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine).unwrap();
        let n = 200;
        let beyond = |x: f64| {
            let outside = |i: i32| match i {
                _ if i == n => 0.0,
                _ => half_space.beyond(x / (FRAC_PI_2 * f64::from(i) / f64::from(n)).cos()).value,
            };
            // ∫ acos(x/r)/π dE over rings
            let share = |i: i32| (outside(i) - outside(i + 1)) * (f64::from(i) + 0.5) / f64::from(2 * n);
            (0..n).map(share).sum::<f64>() / surface_albedo
        };
        Self {
            beyond: (0..300).map(|i| if i == 0 { 0.5 } else { beyond(Self::STEP * f64::from(i)) }).collect(),
        }
    }

    /// At a distance toward the light \[ℓ\].
    fn at(&self, x: f64) -> f64 {
        let place = (x.abs() / Self::STEP).min(298.0);
        let (i, t) = (place as usize, place.fract());
        let beyond = self.beyond[i] + t * (self.beyond[i + 1] - self.beyond[i]);
        if x < 0.0 { beyond } else { 1.0 - beyond }
    }
}

fn normal(random: &mut SplitMix) -> f64 {
    (-2.0 * (1.0 - random.uniform()).ln()).sqrt() * (TAU * random.uniform()).cos()
}

/// A photograph of an edge that is 7° off upright through the middle, with noise, as an OpenEXR file. A white card of
/// reflectance 0.9 is in the rectangle 0,0,20,10.
fn photograph(path: &Path) {
    let edges = ALBEDOS.map(Edge::new);
    let mut random = SplitMix(1);
    let [width, height] = SIZE;
    let (sin, cos) = (7.0 * PI / 180.0).sin_cos();
    let pixels: Vec<[f32; 3]> = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            if x < 20 && y < 10 {
                return [0.45; 3];
            }
            // The mean over a pixel's width
            let at = |part: f64| (x as f64 + part - 75.0) * cos + (y as f64 + 0.5 - 45.0) * sin;
            std::array::from_fn(|c| {
                let parts = [0.1, 0.3, 0.5, 0.7, 0.9].map(|part| edges[c].at(at(part) * PIXEL / MFPS[c]));
                let light = 0.5 * ALBEDOS[c] * parts.iter().sum::<f64>() / 5.0;
                (light + 0.004 * normal(&mut random)) as f32
            })
        })
        .collect();
    let pixel = |x: usize, y: usize| {
        let [r, g, b] = pixels[y * width + x];
        (r, g, b)
    };
    exr::prelude::write_rgb_file(path, width, height, pixel).unwrap();
}

/// Channel, quantity, and value, from and to of 95 %.
fn rows(csv: &str) -> Vec<(String, String, [f64; 3])> {
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields[i].parse().unwrap();
        (fields[0].to_owned(), fields[1].to_owned(), [number(2), number(5), number(6)])
    };
    csv.lines().skip(1).map(row).collect()
}

const WORDS: &str = "measure edge.exr --mm-per-pixel 0.1 --region 21,0,150,90";

/// One picture of a fixed seed: its six intervals of 99.9 %, twice as wide as those of 95 %, hold the truth.
#[test]
fn edge_gives_back_its_material() {
    let directory = tempfile::tempdir().unwrap();
    photograph(&directory.path().join("edge.exr"));
    let words = format!("{WORDS} --white 2,2,18,8 --white-reflectance 0.9");
    let csv = stdout(directory.path(), &format!("{words} --format csv"));
    let rows = rows(&csv);
    assert_eq!(rows.len(), 6, "{csv}");
    for (channel, quantity, [value, low, high]) in &rows {
        let c = ["red", "green", "blue"].iter().position(|name| name == channel).unwrap();
        let truth = if quantity == "mfp" { MFPS[c] } else { ALBEDOS[c] };
        let half = 0.5 * (high - low);
        assert!((value - truth).abs() < 2.0 * half, "{channel} {quantity}: {value} is not {truth} ± {half}");
        assert!(half < 0.1 * truth, "{channel} {quantity}: {low} to {high}");
    }

    // The material is one that a scene takes
    let material = stdout(directory.path(), &format!("{words} --format toml -o soap.toml"));
    assert_eq!(material, "");
    let mut scene = std::fs::read_to_string(directory.path().join("soap.toml")).unwrap();
    scene += "\n[[object]]\nshape = \"sphere\"\nmaterial = \"edge\"\n";
    std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
    stdout(directory.path(), "render scene.toml --size 8x8 --spp 1 -o scene.png");
}

#[test]
fn edge_without_a_white_card_gives_lengths_alone() {
    let directory = tempfile::tempdir().unwrap();
    photograph(&directory.path().join("edge.exr"));
    let output = run(directory.path(), &format!("{WORDS} --surface-albedo 0.85,0.6,0.35 --format csv"));
    assert!(stderr(&output).contains("only lengths are measured"), "{}", stderr(&output));
    let rows = rows(&String::from_utf8(output.stdout).unwrap());
    assert_eq!(rows.len(), 3);
    for ((_, quantity, [value, _, _]), truth) in rows.iter().zip(MFPS) {
        assert_eq!(quantity, "mfp");
        assert!((value / truth - 1.0).abs() < 0.08, "{value} {truth}");
    }
}

#[test]
fn wrong_input_is_told_what_is_allowed() {
    let directory = tempfile::tempdir().unwrap();
    let save = |name: &str, pixel: &(dyn Fn(usize, usize) -> f32 + Sync)| {
        let gray = |x: usize, y: usize| (pixel(x, y), pixel(x, y), pixel(x, y));
        exr::prelude::write_rgb_file(directory.path().join(name), 60, 60, gray).unwrap();
    };
    save("even.exr", &|_, _| 0.5);
    save("black.exr", &|_, _| 0.0);
    save("spot.exr", &|x, y| if (x as f32 - 30.0).hypot(y as f32 - 30.0) < 12.0 { 1.0 } else { 0.1 });
    save("sharp.exr", &|x, y| if x > 30 { 0.5 } else { 0.01 } + 1e-3 * ((x * 7 + y * 13) % 5) as f32);
    save("small.exr", &|x, _| if x > 30 { 0.5 } else { 0.01 });
    std::fs::write(directory.path().join("text.png"), "no picture").unwrap();
    for (words, says) in [
        ("even.exr --mm-per-pixel 0.1", "no edge of light"),
        ("black.exr --mm-per-pixel 0.1", "no edge of light"),
        ("spot.exr --mm-per-pixel 0.1", "no edge that goes through the picture"),
        ("sharp.exr --mm-per-pixel 0.1", "no scattering is seen"),
        ("small.exr --mm-per-pixel 0.1 --region 25,0,35,60", "fewer than 16 pixels"),
        ("small.exr", "--mm-per-pixel"),
        ("small.exr --mm-per-pixel 0", "(0, 1e6]"),
        ("small.exr --mm-per-pixel 0.1 --region 0,0,70,60", "the photograph is 60×60 pixels"),
        ("small.exr --mm-per-pixel 0.1 --region 9,0,9,60", "X0 < X1"),
        ("small.exr --mm-per-pixel 0.1 --white 0,0,9,9 --white-reflectance 1.2", "must be in (0, 1]"),
        ("black.exr --mm-per-pixel 0.1 --white 0,0,9,9", "--white: red is 0 there"),
        ("small.exr --mm-per-pixel 0.1 --surface-albedo 0.5,0.4", "one or three"),
        ("small.exr --mm-per-pixel 0.1 --edge 5,5,5,5", "both points are the same"),
        ("small.exr --mm-per-pixel 0.1 --dark small.png", "cannot be read"),
        ("text.png --mm-per-pixel 0.1", "not an image of a known format"),
        ("nothing.png --mm-per-pixel 0.1", "cannot be read"),
        ("small.exr --mm-per-pixel 0.1 -o no/where.txt", "no"),
    ] {
        let output = run(directory.path(), &format!("measure {words}"));
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains(says), "{words}: {}", stderr(&output));
    }
}
