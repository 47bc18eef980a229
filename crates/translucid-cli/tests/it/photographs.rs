//! `translucid measure` of photographs as cameras and files make them: many pixels, noise that is cut off at zero.

use std::path::Path;

use translucid_testing::SplitMix;

use crate::common::{run, stderr};
use crate::measure::{Edge, normal, rows, save, save_as_png};

/// A photograph of an upright edge 2000 pixels wide, of pixels of 0.01 mm, A = 0.6 and such a mean free path \[mm\].
fn wide(path: &Path, mfp: f64) {
    let (edge, mut random) = (Edge::new(0.6), SplitMix(5));
    let light = |x: usize| 0.02 + 0.6 * edge.at((x as f64 - 1000.0 + 0.5) * 0.01 / mfp);
    let values: Vec<f32> =
        (0..2000 * 48).map(|i| (light(i % 2000) + 0.004 * normal(&mut random)) as f32).collect();
    let pixel = |x: usize, y: usize| (values[2000 * y + x], values[2000 * y + x], values[2000 * y + x]);
    exr::prelude::write_rgb_file(path, 2000, 48, pixel).unwrap();
}

/// Steps of 9 pixels are fine beside ℓ = 0.4 mm, not beside 0.05 mm, for which the picture is cut around the edge. Three
/// channels of the same values, whose interval of 99.9 %, twice as wide as that of 95 %, holds the truth.
#[test]
fn many_pixels_are_measured_in_steps_and_around_the_edge() {
    let directory = tempfile::tempdir().unwrap();
    for (mfp, steps, is_cut) in
        [(0.4, "in steps of 9 pixels, 0.09 mm", false), (0.05, "in steps of 2 pixels", true)]
    {
        wide(&directory.path().join("wide.exr"), mfp);
        let words = "measure wide.exr --mm-per-pixel 0.01 --surface-albedo 0.6 --card hidden --format csv";
        let output = run(directory.path(), words);
        let said = stderr(&output);
        assert!(said.contains(steps), "{said}");
        assert_eq!(said.contains("mm around the edge"), is_cut, "{said}");
        let found = rows(&String::from_utf8(output.stdout).unwrap());
        assert_eq!(found.len(), 3);
        for (channel, _, [value, low, high]) in found {
            assert!((value - mfp).abs() < high - low, "{channel}: {value} ({low} to {high})");
            assert!(high - low < 0.1 * mfp, "{channel}: {value} ({low} to {high})");
        }
    }
}

/// Light that creeps on until nothing is left, in noise of 1.3 % of the light: a PNG has what is below 0 as 0.
#[test]
fn noise_that_is_cut_off_is_said() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let edge = Edge::new(0.6);
    save(&path("dark.exr"), |x, _, _| 0.3 * edge.at(x / 0.6));
    save(&path("stray.exr"), |x, _, _| 0.02 + 0.3 * edge.at(x / 0.6));
    save(&path("off.exr"), |_, _, _| 0.0);
    save(&path("off with a level.exr"), |_, _, _| 0.02);
    for name in ["dark", "stray", "off", "off with a level"] {
        save_as_png(&path(&format!("{name}.exr")), &path(&format!("{name}.png")), png::BitDepth::Sixteen);
    }
    let said = |photo: &str, dark: Option<&str>| {
        let mut command = crate::common::translucid(directory.path());
        command.args([
            "measure",
            photo,
            "--mm-per-pixel",
            "0.1",
            "--region",
            "21,0,150,90",
            "--surface-albedo",
            "0.6",
        ]);
        let output = command.args(dark.iter().flat_map(|dark| ["--dark", dark])).output().unwrap();
        assert!(output.status.success(), "{photo}: {}", stderr(&output));
        stderr(&output)
    };
    let warning = "noise below 0 is cut off";
    assert!(said("dark.png", None).contains("dark.png: noise below 0"), "{}", said("dark.png", None));
    assert!(!said("dark.exr", None).contains(warning));
    assert!(!said("stray.png", None).contains(warning));
    assert!(!said("stray.png", Some("off with a level.png")).contains(warning));
    let dark = said("stray.png", Some("off.png"));
    assert!(dark.contains("off.png: noise below 0"), "{dark}");
}

#[test]
fn missing_scale_names_all_ways_to_state_it() {
    let directory = tempfile::tempdir().unwrap();
    save(&directory.path().join("edge.exr"), |_, _, _| 0.5);
    let output = run(directory.path(), "measure edge.exr");
    assert_eq!(output.status.code(), Some(2));
    for way in ["--mm-per-pixel", "--ruler", "--scene"] {
        assert!(stderr(&output).contains(way), "{}", stderr(&output));
    }
}
