//! `translucid measure`: from a photograph to a material.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use crate::common::{files, run, stderr, stdout};
use crate::markdown::{Page, root};
use translucid_reference::Incidence;
use translucid_reference::exact::{HalfSpace, single_scattering_albedo};
use translucid_reference::walk::{Control, Layout, Parameters, Problem, Side, WhiteTable};
use translucid_testing::SplitMix;

const ALBEDOS: [f64; 3] = [0.85, 0.6, 0.35];
/// \[mm\]
const MFPS: [f64; 3] = [1.1, 0.6, 0.35];
/// \[mm\]
const PIXEL: f64 = 0.1;
const SIZE: [usize; 2] = [150, 90];

/// The light beyond an edge by the exact profile in space, over that far on the lit side: not the command's own road by
/// its transform.
pub(crate) struct Edge {
    /// At distances 0, h, 2h, … into the dark.
    beyond: Vec<f64>,
}

impl Edge {
    const STEP: f64 = 0.05;

    pub(crate) fn new(surface_albedo: f64) -> Self {
        Self::of(&HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine).unwrap())
    }

    fn of(half_space: &HalfSpace) -> Self {
        let surface_albedo = half_space.total().value;
        // Its logarithm over that of the radius, from the least to the greatest that is asked for: straight to 1e-5 in between
        let (first, step) = ((0.9 * Self::STEP).ln(), 0.01);
        let logarithms: Vec<f64> = (0..1100)
            .map(|i| half_space.beyond((first + step * f64::from(i)).exp()).value.max(1e-300).ln())
            .collect();
        let outside = |r: f64| {
            let place = (r.ln() - first) / step;
            let (i, t) = (place as usize, place.fract());
            (logarithms[i] + t * (logarithms[i + 1] - logarithms[i])).exp()
        };
        let n = 200;
        let beyond = |x: f64| {
            let outside = |i: i32| match i {
                _ if i == n => 0.0,
                _ => outside(x / (FRAC_PI_2 * f64::from(i) / f64::from(n)).cos()),
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
    pub(crate) fn at(&self, x: f64) -> f64 {
        let place = (x.abs() / Self::STEP).min(298.0);
        let (i, t) = (place as usize, place.fract());
        let beyond = self.beyond[i] + t * (self.beyond[i + 1] - self.beyond[i]);
        if x < 0.0 { beyond } else { 1.0 - beyond }
    }
}

pub(crate) fn normal(random: &mut SplitMix) -> f64 {
    (-2.0 * (1.0 - random.uniform()).ln()).sqrt() * (TAU * random.uniform()).cos()
}

/// A linear OpenEXR file of values by the distance from an edge \[mm\] that is 7° off upright through the middle, by the
/// distance along it, and by channel: means over the width of a pixel, with noise.
pub(crate) fn save(path: &Path, light: impl Fn(f64, f64, usize) -> f64) {
    let mut random = SplitMix(1);
    let [width, height] = SIZE;
    let (sin, cos) = (7.0 * PI / 180.0).sin_cos();
    let pixels: Vec<[f32; 3]> = (0..width * height)
        .map(|i| {
            let offset = |part: f64| [(i % width) as f64 + part - 75.0, (i / width) as f64 + 0.5 - 45.0];
            std::array::from_fn(|c| {
                let value = |part: f64| {
                    let [x, y] = offset(part);
                    light(PIXEL * (x * cos + y * sin), PIXEL * (y * cos - x * sin), c)
                };
                let mean = [0.1, 0.3, 0.5, 0.7, 0.9].map(value).iter().sum::<f64>() / 5.0;
                (mean + 0.004 * normal(&mut random)) as f32
            })
        })
        .collect();
    let pixel = |x: usize, y: usize| {
        // A white card of reflectance 0.9 in the light that makes 0.5 of white
        let [r, g, b] = if x < 20 && y < 10 { [0.45; 3] } else { pixels[y * width + x] };
        (r, g, b)
    };
    exr::prelude::write_rgb_file(path, width, height, pixel).unwrap();
}

/// Size and sRGB codes in \[0, 1\] of a linear OpenEXR file.
fn codes(exr: &Path) -> ([u32; 2], Vec<f32>) {
    let image =
        translucid_load::load_image(exr, translucid_scene::ColorSpace::Linear, &mut Vec::new()).unwrap();
    let encode = |v: f32| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    let texel = |i: u32| image.texel(i % image.width, i / image.width);
    let pixel = |i: u32| texel(i).into_iter().take(3).map(|value| encode(value.clamp(0.0, 1.0)));
    ([image.width, image.height], (0..image.width * image.height).flat_map(pixel).collect())
}

fn save_as_tiff(exr: &Path, path: &Path) {
    let ([width, height], codes) = codes(exr);
    let codes: Vec<u16> = codes.iter().map(|code| (65535.0 * code).round() as u16).collect();
    let mut encoder = tiff::encoder::TiffEncoder::new(std::fs::File::create(path).unwrap()).unwrap();
    encoder.write_image::<tiff::encoder::colortype::RGB16>(width, height, &codes).unwrap();
}

fn save_as_jpeg(exr: &Path, path: &Path) {
    let ([width, height], codes) = codes(exr);
    let codes: Vec<u8> = codes.iter().map(|code| (255.0 * code).round() as u8).collect();
    let encoder = jpeg_encoder::Encoder::new_file(path, 92).unwrap();
    encoder.encode(&codes, width as u16, height as u16, jpeg_encoder::ColorType::Rgb).unwrap();
}

/// The OpenEXR file as a PNG of sRGB codes, of 16 bits or 8.
pub(crate) fn save_as_png(exr: &Path, png: &Path, depth: png::BitDepth) {
    let ([width, height], all) = codes(exr);
    let mut bytes = Vec::new();
    for code in all {
        match depth {
            png::BitDepth::Sixteen => bytes.extend(((65535.0 * code).round() as u16).to_be_bytes()),
            _ => bytes.push((255.0 * code).round() as u8),
        }
    }
    let mut encoder = png::Encoder::new(std::fs::File::create(png).unwrap(), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
}

/// PNG, TIFF and JPEG.
#[test]
fn coded_files_give_what_linear_ones_give() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    // Stray light far above the noise, as a PNG cuts off what is negative
    let edges = ALBEDOS.map(Edge::new);
    save(&path("edge.exr"), |x, _, c| 0.02 + 0.5 * ALBEDOS[c] * edges[c].at(x / MFPS[c]));
    save_as_png(&path("edge.exr"), &path("fine.png"), png::BitDepth::Sixteen);
    save_as_png(&path("edge.exr"), &path("coarse.png"), png::BitDepth::Eight);
    save_as_tiff(&path("edge.exr"), &path("fine.tif"));
    save_as_jpeg(&path("edge.exr"), &path("camera.jpg"));
    let words = |name: &str| format!("{} --white 2,2,18,8 --format csv", WORDS.replace("edge.exr", name));
    let linear = rows(&stdout(directory.path(), &words("edge.exr")));
    // Codes of 8 bits are rounded by some 0.3 % of the light, of which a pixel's noise here is thrice as much
    // A JPEG's blocks lose some of the noise, too
    for (name, part, warns) in [
        ("fine.png", 0.001, false),
        ("fine.tif", 0.001, false),
        ("coarse.png", 0.03, true),
        ("camera.jpg", 0.05, true),
    ] {
        let output = run(directory.path(), &words(name));
        assert_eq!(stderr(&output).contains("8-bit values are taken as sRGB"), warns, "{}", stderr(&output));
        let found = rows(&String::from_utf8(output.stdout).unwrap());
        for ((channel, quantity, [value, _, _]), (_, _, [expected, _, _])) in found.iter().zip(&linear) {
            assert!((value / expected - 1.0).abs() < part, "{name} {channel} {quantity}: {value} {expected}");
        }
    }
}

/// Highlights that a JPEG has clipped: few of them are told, many are refused.
#[test]
fn clipped_jpeg_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let edge = Edge::new(0.6);
    for (size, code, says) in [(1.0, 0, "warning"), (3.0, 2, "error")] {
        // A bright square on the lit side
        let light = |x: f64, y: f64| {
            0.02 + 0.3 * edge.at(x / 0.6) + f64::from(x > 4.0 && x < 4.0 + size && y.abs() < 0.5 * size)
        };
        save(&path("edge.exr"), |x, y, _| light(x, y));
        save_as_jpeg(&path("edge.exr"), &path("camera.jpg"));
        let words = WORDS.replace("edge.exr", "camera.jpg");
        let output = run(directory.path(), &format!("{words} --surface-albedo 0.6"));
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        let is_told = |line: &str| {
            line.contains(says) && line.contains("at the end of their range, where light is lost")
        };
        assert!(stderr(&output).lines().any(is_told), "{}", stderr(&output));
        assert!(stderr(&output).contains("8-bit values are taken as sRGB"), "{}", stderr(&output));
    }
}

/// Below a smooth boundary of η = 1.4 the exact half space is another one, and A that of the light that enters.
#[test]
fn edge_below_a_boundary_gives_back_its_material() {
    let directory = tempfile::tempdir().unwrap();
    let half_space = HalfSpace::with_boundary(0.97, 1.4, Incidence::Cosine).unwrap();
    let (truth, edge) = (half_space.total().value, Edge::of(&half_space));
    let entering = 1.0 - translucid_reference::specular_reflectance(Incidence::Cosine, 1.4);
    save(&directory.path().join("edge.exr"), |x, _, _| 0.5 * entering * truth * edge.at(x / 0.7));
    let words = format!("{WORDS} --white 2,2,18,8 --format csv");
    let found = rows(&stdout(directory.path(), &format!("{words} --eta 1.4")));
    for (channel, quantity, [value, low, high]) in &found {
        let truth = if quantity == "mfp" { 0.7 } else { truth };
        let half = 0.5 * (high - low);
        assert!((value - truth).abs() < 2.0 * half, "{channel} {quantity}: {value} is not {truth} ± {half}");
        assert!(half < 0.15 * truth, "{channel} {quantity}: {low} to {high}");
    }
    // Taken for a matt piece it is another material
    let matt = rows(&stdout(directory.path(), &words));
    assert!(matt.iter().zip(&found).all(|((.., [a, ..]), (.., [b, ..]))| (a / b - 1.0).abs() > 0.05));
}

/// A spot of 0.9 mm radius around (70.4, 43.1) by rings of the exact profile in space, and the light of the spot itself.
struct Spot {
    /// At distances 0, h, 2h, … \[mm\], over the light on the disk.
    light: Vec<f64>,
}

impl Spot {
    const RADIUS: f64 = 0.9;
    const STEP: f64 = 0.05;

    fn new(surface_albedo: f64, mfp: f64) -> Self {
        let half_space = HalfSpace::from_surface_albedo(surface_albedo, Incidence::Cosine).unwrap();
        let n = 400;
        let edge = |i: i32| 10.0 * (f64::from(i) / f64::from(n)).powi(2);
        let enclosed = |i: i32| if i == 0 { 0.0 } else { half_space.enclosed(edge(i) / mfp).value };
        let rings: Vec<f64> = (0..n).map(|i| enclosed(i + 1) - enclosed(i)).collect();
        let light = |r: f64| {
            // Part of a ring around the place that is in the disk, times what comes from that far
            let ring = |i: i32| {
                let s = 0.5 * (edge(i) + edge(i + 1));
                let cos = (r * r + s * s - Self::RADIUS * Self::RADIUS) / (2.0 * r * s);
                cos.clamp(-1.0, 1.0).acos() / PI * rings[i as usize]
            };
            (0..n).map(ring).sum::<f64>()
        };
        Self { light: (0..180).map(|i| light(Self::STEP * f64::from(i).max(0.01))).collect() }
    }

    fn at(&self, r: f64) -> f64 {
        let place = (r / Self::STEP).min(178.0);
        let (i, t) = (place as usize, place.fract());
        self.light[i] + t * (self.light[i + 1] - self.light[i])
    }

    /// A linear OpenEXR file of values by the distance from the middle \[mm\] and channel: means over pixels, with noise.
    fn save(path: &Path, light: impl Fn(f64, usize) -> f64) {
        let mut random = SplitMix(5);
        let [width, height] = SIZE;
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| {
                std::array::from_fn(|c| {
                    let value = |j: usize| {
                        let part = |k: usize| (k as f64 + 0.5) / 4.0;
                        let x = (i % width) as f64 + part(j % 4) - 70.4;
                        let y = (i / width) as f64 + part(j / 4) - 43.1;
                        light(PIXEL * x.hypot(y), c)
                    };
                    let mean = (0..16).map(value).sum::<f64>() / 16.0;
                    (mean + 0.003 * normal(&mut random)) as f32
                })
            })
            .collect();
        let pixel = |x: usize, y: usize| pixels[y * width + x].into();
        exr::prelude::write_rgb_file(path, width, height, pixel).unwrap();
    }
}

/// One picture of a fixed seed: its six intervals of 99.9 %, twice as wide as those of 95 %, hold the truth.
#[test]
fn spot_gives_back_its_material() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let spots = [0, 1, 2].map(|c| Spot::new(ALBEDOS[c], MFPS[c]));
    Spot::save(&path("spot.exr"), |r, c| 0.02 + 0.8 * spots[c].at(r));
    Spot::save(&path("paper.exr"), |r, _| 0.02 + 0.8 * 0.9 * f64::from(r < Spot::RADIUS));
    let words = "measure spot.exr --setup spot --mm-per-pixel 0.1";
    let power = "--white-photo paper.exr --format csv";
    let output = run(directory.path(), &format!("{words} {power} --page page"));
    assert!(stderr(&output).contains("spot around (70."), "{}", stderr(&output));
    let found = rows(&String::from_utf8(output.stdout).unwrap());
    assert_eq!(found.len(), 6);
    let holds = |found: &[(String, String, [f64; 3])]| {
        for (channel, quantity, [value, low, high]) in found {
            let c = ["red", "green", "blue"].iter().position(|name| name == channel).unwrap();
            let truth = if quantity == "mfp" { MFPS[c] } else { ALBEDOS[c] };
            let half = 0.5 * (high - low);
            assert!(
                (value - truth).abs() < 2.0 * half,
                "{channel} {quantity}: {value} is not {truth} ± {half}"
            );
            assert!(half < 0.15 * truth, "{channel} {quantity}: {low} to {high}");
        }
    };
    holds(&found);
    let page = std::fs::read_to_string(path("page/index.html")).unwrap();
    for words in
        ["12 sectors around the spot", "Light around the spot", "light / mm⁻²", "less fit / standard errors"]
    {
        assert!(page.contains(words), "{words}");
    }

    // A middle that is given, and a core that is clipped
    holds(&rows(&stdout(directory.path(), &format!("{words} {power} --center 70.4,43.1"))));
    Spot::save(&path("spot.exr"), |r, c| (4.0 * (0.02 + 0.8 * spots[c].at(r))).min(1.0));
    save_as_png(&path("spot.exr"), &path("spot.png"), png::BitDepth::Sixteen);
    let clipped = words.replace("spot.exr", "spot.png");
    let output = run(directory.path(), &format!("{clipped} --surface-albedo 0.85,0.6,0.35 --format csv"));
    assert!(
        stderr(&output).contains("pixels from the center of the spot: that core is left out"),
        "{}",
        stderr(&output)
    );
    let found = rows(&String::from_utf8(output.stdout).unwrap());
    assert_eq!(found.len(), 3);
    for ((_, _, [value, ..]), truth) in found.iter().zip(MFPS) {
        assert!((value / truth - 1.0).abs() < 0.3, "{value} {truth}");
    }
}

/// The light of a panel through a slab beyond a line, by photons, at distances from it in mean free paths.
fn through_slab(surface_albedo: f64, thickness: f64) -> impl Fn(f64) -> f64 {
    let alpha = single_scattering_albedo(surface_albedo, 1.0, Incidence::Cosine).unwrap();
    let parameters = Parameters { thickness, incidence: Incidence::Cosine, ..Parameters::default() };
    let radii: Vec<f64> = (1..=300).map(|i| 0.05 * f64::from(i)).collect();
    let layout = Layout::new(&radii, 1).unwrap();
    let mut table = WhiteTable::new(Problem::new(parameters).unwrap(), layout, 0.995).unwrap();
    table.run(11, 1_000_000, &Control::default()).unwrap();
    let walk = table.at_albedo(alpha).unwrap();
    let rings: Vec<f64> = (0..300).map(|i| walk.ring(Side::Transmitted, i).value).collect();
    // The part of each ring beyond a line
    move |x: f64| {
        let part = |i: usize| rings[i] * (x / (radii[i] - 0.025)).clamp(-1.0, 1.0).acos() / PI;
        (0..300).map(part).sum::<f64>()
    }
}

/// A slab of 1.2 mm on a panel of light, half covered, by photons: one picture of a fixed seed, whose intervals of 99.9 % hold
/// the truth. The walk's own noise is a tenth of the picture's.
#[test]
fn slab_gives_back_its_material() {
    let (surface_albedo, mfp, thickness) = (0.8, 0.6, 1.2);
    let beyond = through_slab(surface_albedo, thickness / mfp);
    let directory = tempfile::tempdir().unwrap();
    // The panel is where the white card is, and shows 0.45
    save(&directory.path().join("edge.exr"), |x, _, _| 0.45 * beyond(-x / mfp));
    let slab = format!("--setup slab --thickness {thickness} --format csv");
    let check = |words: &str, count: usize| {
        let found = rows(&stdout(directory.path(), words));
        assert_eq!(found.len(), count);
        for (channel, quantity, [value, low, high]) in &found {
            let truth = if quantity == "mfp" { mfp } else { surface_albedo };
            let half = 0.5 * (high - low);
            assert!(
                (value - truth).abs() < 2.0 * half,
                "{channel} {quantity}: {value} is not {truth} ± {half}"
            );
            // Brightness and shape say nearly the same of both: one tells the other, and both are known badly
            assert!(count == 6 || half < 0.3 * truth, "{channel} {quantity}: {low} to {high}");
        }
    };
    check(&format!("{WORDS} --white 2,2,18,8 {slab}"), 6);
    check(&format!("{WORDS} --surface-albedo {surface_albedo} {slab}"), 3);
}

/// A small and noisy photograph of a wedge of two steps on a panel of light, by photons: with a known surface albedo the thin
/// step's layer has the color of the true one over black and over white, and what the photograph does not tell is refused.
#[test]
fn wedge_becomes_layers_of_its_color() {
    let (surface_albedo, mfp, steps) = (0.8, 0.6, [1.2, 2.4]);
    let beyond = steps.map(|thickness| through_slab(surface_albedo, thickness / mfp));
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    save(&path("edge.exr"), |x, y, _| 0.45 * beyond[usize::from(y > 0.0)](-x / mfp));
    let colors = |file: &str| {
        let json = stdout(directory.path(), &format!("stack {file} --format json"));
        let rows: serde_json::Value = serde_json::from_str(&json).unwrap();
        let lab = |row: usize| ["L", "a", "b"].map(|key| rows[row][key].as_f64().unwrap());
        [lab(0), lab(1)]
    };
    let words = |thickness: f64, region: &str, more: &str| {
        format!(
            "measure edge.exr --mm-per-pixel 0.1 --region {region} --setup slab --thickness {thickness} --format layers {more}"
        )
    };
    let [near, far] = ["21,0,150,34", "21,56,150,90"];
    stdout(directory.path(), &words(steps[0], near, "--surface-albedo 0.8 -o step.toml"));
    let truth =
        format!("[[layer]]\nthickness = {}\nsurface_albedo = {surface_albedo}\nmfp = {mfp}\n", steps[0]);
    std::fs::write(path("truth.toml"), truth).unwrap();
    for (found, expected) in colors("step.toml").into_iter().zip(colors("truth.toml")) {
        let distance = translucid_laboratory::colorimetry::delta_e_2000(found, expected);
        assert!(distance < 3.0, "{found:?}, expected {expected:?}: {distance}");
    }
    // What such a photograph does not tell makes no layer; nor do other definitions of the surface albedo
    for (words, expected) in [
        (words(steps[1], far, "--surface-albedo 0.8"), "the mean free path of red is not seen"),
        (
            words(steps[0], near, "--white 2,2,18,8"),
            "the surface albedo of red comes out as 0, or as 1 or more",
        ),
        (words(steps[0], near, ""), "the surface albedo of red is not known"),
        (words(steps[0], near, "--surface-albedo 0.8 --configuration searchlight"), "is for matt pieces"),
    ] {
        let message = stderr(&run(directory.path(), &words));
        assert!(message.contains(expected), "{words}: {message}");
    }
}

/// A photograph of white paper in place of the piece takes dark corners and uneven light out.
#[test]
fn white_photo_makes_light_even() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let edges = ALBEDOS.map(Edge::new);
    let uneven = |x: f64, y: f64| 0.5 * (1.0 + 0.04 * x) * (1.0 - 0.004 * (x * x + y * y));
    save(&path("edge.exr"), |x, y, c| uneven(x, y) * ALBEDOS[c] * edges[c].at(x / MFPS[c]));
    save(&path("paper.exr"), |x, y, _| 0.9 * uneven(x, y));
    let words = format!("{WORDS} --white-photo paper.exr --format csv");
    for (channel, quantity, [value, low, high]) in rows(&stdout(directory.path(), &words)) {
        let c = ["red", "green", "blue"].iter().position(|name| *name == channel).unwrap();
        let truth = if quantity == "mfp" { MFPS[c] } else { ALBEDOS[c] };
        assert!(
            (value - truth).abs() < high - low,
            "{channel} {quantity}: {value} is not {truth}, {low} to {high}"
        );
    }
}

/// A photograph of an edge. A white card of reflectance 0.9 is in the rectangle 0,0,20,10.
fn photograph(path: &Path) {
    let edges = ALBEDOS.map(Edge::new);
    save(path, |x, _, c| 0.5 * ALBEDOS[c] * edges[c].at(x / MFPS[c]));
}

/// Channel, quantity, and value, from and to of 95 %.
pub(crate) fn rows(csv: &str) -> Vec<(String, String, [f64; 3])> {
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

    // Two points 70 pixels apart on a ruler, and forward scattering: (1 − g) σ_s is the same
    let other = words.replace("--mm-per-pixel 0.1", "--ruler 30,20,72,76,7 --g 0.8 --card hidden");
    let forward = self::rows(&stdout(directory.path(), &format!("{other} --format csv")));
    for ((_, quantity, [value, _, _]), (_, _, [of_g, _, _])) in rows.iter().zip(forward) {
        if quantity == "surface_albedo" {
            assert_eq!(*value, of_g);
        } else {
            // Of 1/ℓ* = σ_a + 0.2 σ_s the medium has σ_a + σ_s, nearly 5 times as much where little is absorbed
            assert!((0.2..0.35).contains(&(of_g / value)), "{of_g} {value}");
        }
    }

    // What says the same in other renderers' numbers runs
    let text = stdout(directory.path(), &words);
    let command = text.lines().find_map(|line| line.strip_prefix("In other renderers: translucid ")).unwrap();
    assert!(stdout(directory.path(), command).contains("renderman"), "{command}");

    // A page, which may be made anew, but not over somebody's own
    for _ in 0..2 {
        stdout(directory.path(), &format!("{words} --page page"));
    }
    let names = files(&directory.path().join("page"));
    assert_eq!(names.len(), 10, "{names:?}");
    let [seen, rendered] = ["region.png", "setup.png"].map(|name| {
        let path = directory.path().join("page").join(name);
        translucid_load::load_image(&path, translucid_scene::ColorSpace::Srgb, &mut Vec::new()).unwrap()
    });
    // Means over a tenth of the picture on either side: what the renderer makes of the material is what the camera saw
    assert_eq!([seen.width, seen.height], [rendered.width, rendered.height]);
    for columns in [0..13, 40..53, 76..89, 116..129] {
        let mean = |image: &translucid_scene::Image, c: usize| {
            let all = columns.clone().flat_map(|x| (0..90).map(move |y| image.texel(x, y)[c]));
            all.sum::<f32>() / (90.0 * 13.0)
        };
        for c in 0..3 {
            let [a, b] = [&seen, &rendered].map(|image| mean(image, c));
            assert!((a - b).abs() < 0.02 * mean(&seen, 0).max(0.5), "{columns:?} {c}: {a} {b}");
        }
    }
    let page = std::fs::read_to_string(directory.path().join("page/index.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("What limits the accuracy"));
    std::fs::write(directory.path().join("page/index.html"), "mine").unwrap();
    assert_eq!(run(directory.path(), &format!("{words} --page page")).status.code(), Some(2));

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
    save("spot.exr", &|x, y| if (x as f32 - 30.0).hypot(y as f32 - 30.0) < 12.0 { 0.9 } else { 0.1 });
    save("sharp.exr", &|x, y| if x > 30 { 0.5 } else { 0.01 } + 1e-3 * ((x * 7 + y * 13) % 5) as f32);
    save("small.exr", &|x, _| if x > 30 { 0.5 } else { 0.01 });
    save("clipped.exr", &|x, y| (0.1 * x as f32 / (1.0 + 0.1 * (y % 3) as f32)).min(1.0));
    // Two eyes, a nose, ears, fur
    let fur = |x: usize, y: usize| 0.1 * ((x * 31 + y * 17) % 11) as f32 / 11.0;
    let disk = |x: usize, y: usize, [cx, cy, r]: [f32; 3]| (x as f32 - cx).hypot(y as f32 - cy) < r;
    let eyes = [[20.0, 25.0, 5.0], [40.0, 25.0, 5.0], [30.0, 38.0, 3.0]];
    save("cat.exr", &|x, y| {
        let head = disk(x, y, [30.0, 30.0, 22.0]) || (y < 14 && (x % 40).abs_diff(12) < y);
        let is_dark = eyes.iter().any(|eye| disk(x, y, *eye));
        fur(x, y)
            + if is_dark {
                0.05
            } else if head {
                0.5
            } else {
                0.25
            }
    });
    std::fs::write(directory.path().join("text.png"), "no picture").unwrap();
    let round = |x: usize, y: usize, [cx, cy]: [f32; 2]| {
        0.02 + 0.9 * (-((x as f32 - cx).hypot(y as f32 - cy) / 6.0).powi(2)).exp()
    };
    save("two.exr", &|x, y| round(x, y, [15.0, 30.0]) + 0.8 * round(x, y, [45.0, 30.0]));
    save("rim.exr", &|x, y| round(x, y, [1.0, 30.0]));
    save("round.exr", &|x, y| round(x, y, [30.0, 30.0]));
    save("oval.exr", &|x, y| round(30 + x.abs_diff(30) / 3, y, [30.0, 30.0]));
    save("saturated.exr", &|x, y| (300.0 * round(x, y, [30.0, 30.0])).min(1.0));
    for (words, says) in [
        ("even.exr --mm-per-pixel 0.1", "no edge of light"),
        ("black.exr --mm-per-pixel 0.1", "no edge of light"),
        ("spot.exr --mm-per-pixel 0.1", "no edge that goes through the picture"),
        ("sharp.exr --mm-per-pixel 0.1", "no scattering is seen"),
        ("small.exr --mm-per-pixel 0.1 --region 25,0,35,60", "fewer than 16 pixels"),
        ("cat.exr --mm-per-pixel 0.1", "no straight edge"),
        ("clipped.exr --mm-per-pixel 0.1", "at the end of their range, where light is lost"),
        ("small.exr", "--mm-per-pixel, --ruler or --scene"),
        ("small.exr --ruler 1,1,1,1,5", "two points in pixels that are apart"),
        ("small.exr --ruler 1,1,1,9", "a ruler is"),
        ("small.exr --mm-per-pixel 0.1 --eta 5", "--eta"),
        ("small.exr --mm-per-pixel 0.1 --g 1", "--g"),
        ("small.exr --mm-per-pixel 0.1 --exposure black.exr", "nothing in common"),
        ("small.exr --mm-per-pixel 0.1 --exposure text.png", "not an image of a known format"),
        ("small.exr --mm-per-pixel 0", "(0, 1e6]"),
        ("small.exr --mm-per-pixel 0.1 --region 0,0,70,60", "the photograph is 60×60 pixels"),
        ("small.exr --mm-per-pixel 0.1 --region 9,0,9,60", "X0 < X1"),
        ("small.exr --mm-per-pixel 0.1 --white 0,0,9,9 --white-reflectance 1.2", "must be in (0, 1]"),
        ("black.exr --mm-per-pixel 0.1 --white 0,0,9,9", "--white: red is 0 there"),
        ("small.exr --mm-per-pixel 0.1 --surface-albedo 0.5,0.4", "one or three"),
        ("small.exr --mm-per-pixel 0.1 --edge 5,5,5,5", "both points are the same"),
        ("small.exr --mm-per-pixel 0.1 --edge 90,5,91,50", "the line misses the region"),
        ("small.exr --mm-per-pixel 0.1 --region 32,0,60,60", "no edge of light"),
        ("even.exr --setup spot --mm-per-pixel 0.1", "no spot of light"),
        ("two.exr --setup spot --mm-per-pixel 0.1", "2 spots of light of similar size"),
        ("rim.exr --setup spot --mm-per-pixel 0.1", "goes on beyond the picture"),
        ("small.exr --setup spot --mm-per-pixel 0.1", "goes on beyond the picture"),
        ("saturated.exr --setup spot --mm-per-pixel 0.1 --center 30,30", "the spot is saturated"),
        ("cat.exr --setup spot --mm-per-pixel 0.1", "the spot of light goes on beyond the picture"),
        ("round.exr --setup spot --mm-per-pixel 0.1", "no scattering is seen: the spot is as sharp"),
        ("oval.exr --setup spot --mm-per-pixel 0.1", "no round spot"),
        ("round.exr --setup spot", "--mm-per-pixel, --ruler or --scene"),
        ("round.exr --setup spot --mm-per-pixel 0.1 --center 70,30", "--center: 70,30 is not in the region"),
        ("round.exr --setup spot --mm-per-pixel 0.1 --center 30", "a point is X,Y"),
        ("round.exr --setup spot --mm-per-pixel 0.1 --edge 5,5,9,9", "--edge is for --setup edge and slab"),
        ("round.exr --setup spot --mm-per-pixel 0.1 --white 5,5,9,9", "--white-photo"),
        ("round.exr --mm-per-pixel 0.1 --center 30,30", "--center is for --setup spot"),
        ("round.exr --setup spot --mm-per-pixel 0.1 --incidence 30", "round only for 0"),
        ("small.exr --mm-per-pixel 0.1 --thickness 3", "--thickness is for --setup slab"),
        ("small.exr --setup slab --mm-per-pixel 0.1", "--thickness"),
        ("small.exr --setup slab --thickness 3 --mm-per-pixel 0.1 --eta 1.4", "--setup slab is for --eta 1"),
        (
            "small.exr --setup slab --thickness 3 --mm-per-pixel 0.1 --card hidden",
            "--card is for --setup edge",
        ),
        ("small.exr --mm-per-pixel 0.1 --incidence 30 --eta 1.4", "--incidence is for --eta 1"),
        ("small.exr --mm-per-pixel 0.1 --incidence 90", "(-90, 90)"),
        ("small.exr --mm-per-pixel 0.1 --white-photo black.exr", "--white-photo: red is 0 there"),
        ("small.exr --mm-per-pixel 0.1 --white-photo saturated.exr", "at the end of their range"),
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

/// What a photograph of an edge may suffer from, and what is said of it. The medium is A = 0.6, ℓ = 0.6 mm.
#[test]
fn what_limits_a_measurement_is_said() {
    let edge = Edge::new(0.6);
    let edge = |x: f64| 0.3 * edge.at(x / 0.6);
    let says = |name: &str, words: &str, light: &dyn Fn(f64, f64) -> f64| {
        let directory = tempfile::tempdir().unwrap();
        save(&directory.path().join("edge.exr"), |x, y, _| light(x, y));
        let output = run(directory.path(), &format!("{WORDS} --white 2,2,18,8 {words}"));
        // Two lights may look like a blurred edge without scattering
        let is_right = output.status.success() || (name == "two lights" && output.status.code() == Some(2));
        assert!(is_right, "{name}: {}", stderr(&output));
        stderr(&output)
    };
    let good = says("good", "", &|x, _| edge(x));
    assert!(!good.contains("warning") && good.contains("--card hidden"), "{good}");

    let covered = says("card", "", &|x, _| if x < 0.0 { 0.01 } else { edge(x) });
    assert!(!covered.contains("warning") && covered.contains("--card visible"), "{covered}");

    let not_a_half_space = "the light is not that of an even, thick, isotropic piece";
    let lights = says("two lights", "", &|x, _| 0.6 * edge(x) + 0.4 * edge(x + 2.5));
    assert!(lights.contains(not_a_half_space), "{lights}");
    let moire = says("moiré", "", &|x, y| edge(x) * (1.0 + 0.1 * (4.0 * x + 0.3 * y).sin()));
    assert!(moire.contains(not_a_half_space), "{moire}");

    // d = 0.8 mm: the share of normalized diffusion beyond a line is ∫ acos(x/r)/π dcdf over rings, 1 − cdf = ¼e^{−r/d} + ¾e^{−r/3d}
    let beyond = |x: f64| {
        let outside = |i: i32| {
            let r = x / (FRAC_PI_2 * f64::from(i) / 200.0).cos() / 0.8;
            if i == 200 { 0.0 } else { 0.25 * (-r).exp() + 0.75 * (-r / 3.0).exp() }
        };
        (0..200).map(|i| (outside(i) - outside(i + 1)) * (f64::from(i) + 0.5) / 400.0).sum::<f64>()
    };
    let diffusion = |x: f64| 0.45 * if x < 0.0 { beyond(-x) } else { 1.0 - beyond(x) };
    let rival = says("normalized diffusion", "", &|x, _| diffusion(x));
    assert!(rival.contains("normalized diffusion, no solution"), "{rival}");
    // A layer above another: a narrow peak of light on a wide glow
    let layers = says("layers", "", &|x, _| 0.5 * edge(4.0 * x) + 0.5 * edge(0.3 * x));
    assert!(
        layers.contains("no solution of the equation of transfer") || layers.contains(not_a_half_space),
        "{layers}"
    );

    let tilted = says("tilted", "", &|x, _| edge(x) * (1.0 + 0.08 * x));
    assert!(tilted.contains("is the piece tilted"), "{tilted}");
    let bright = says("a wrong card", "--white-reflectance 1", &|x, _| 2.0 * edge(x));
    assert!(bright.contains("brighter than any surface"), "{bright}");
}

/// The guide's example prints what stands there, and draws the chart that is shown there.
#[test]
fn documentation_prints_and_draws_what_it_shows() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::create_dir(directory.path().join("scenes")).unwrap();
    std::fs::copy(root().join("scenes/edge.toml"), directory.path().join("scenes/edge.toml")).unwrap();
    let page = Page::read(&root().join("docs/guide/measure.md"));
    let (mut printed, mut shown) = (String::new(), String::new());
    for block in page.code().iter().filter(|block| block.language == "console") {
        for line in &block.lines {
            match line.strip_prefix("$ translucid ") {
                Some(words) => printed += &stdout(directory.path(), words),
                None => shown += &format!("{line}\n"),
            }
        }
    }
    assert!(shown.lines().count() > 4);
    assert_eq!(printed, shown);
    let [drawn, image] = [directory.path().join("page/fit.svg"), root().join("docs/images/measure-fit.svg")]
        .map(|path| std::fs::read_to_string(path).unwrap());
    assert!(drawn == image, "docs/images/measure-fit.svg is another chart than page/fit.svg of the example");
}
