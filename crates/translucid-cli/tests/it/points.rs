//! `translucid render` with the point-based method: files of points, other views, too little memory.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{BALL, exr_values, files, run, stderr, stdout};

/// A directory with a ball whose points are few.
fn directory() -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().to_owned();
    let points = "samples_per_pixel = 4\nsubsurface_method = \"point-based\"\npoint_tolerance = 0.5";
    let text = BALL.replace("samples_per_pixel = 8", points);
    let radius = "subsurface_radius = 2\nsubsurface_model = \"normalized-diffusion-refined\"";
    fs::write(path.join("ball.toml"), text.replace("subsurface_radius = 0.2", radius)).unwrap();
    (directory, path)
}

/// Words of the command when it refuses.
fn refusal(directory: &Path, words: &str) -> String {
    let output = run(directory, words);
    assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
    stderr(&output)
}

#[test]
fn points_are_kept_and_used_again() {
    let (_keep, directory) = directory();
    let output = run(&directory, "render ball.toml --points ball.points --threads 1 -o one.exr");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        said.contains("points over surfaces")
            && said.contains("points with their light")
            && said.contains("kept them in ball.points"),
        "{said}"
    );
    let bytes = |name: &str| fs::read(directory.join(name)).unwrap();
    let points = bytes("ball.points");

    let output = run(&directory, "render ball.toml --points ball.points -o two.exr");
    assert!(stderr(&output).contains("from ball.points"), "{}", stderr(&output));
    stdout(&directory, "render ball.toml -q --threads 2 -o fresh.exr");
    for other in ["two.exr", "fresh.exr"] {
        assert_eq!(exr_values(&directory.join("one.exr")), exr_values(&directory.join(other)), "{other}");
    }
    assert_eq!(bytes("ball.points"), points);

    // Another film may use them, another seed not
    stdout(&directory, "render ball.toml -q --points ball.points --size 20x20 --spp 1 -o small.png");
    let said = refusal(&directory, "render ball.toml --points ball.points --seed 3");
    assert!(said.contains("another scene or other settings") && said.contains("delete"), "{said}");
    assert_eq!(bytes("ball.points"), points);
}

#[test]
fn points_for_wide_pixels_serve_no_narrow_ones() {
    let (_keep, directory) = directory();
    let text = fs::read_to_string(directory.join("ball.toml")).unwrap();
    fs::write(directory.join("fine.toml"), text.replace("subsurface_radius = 2", "subsurface_radius = 0.1"))
        .unwrap();
    let words = "render fine.toml --points fine.points --spp 1";
    let said = stderr(&run(&directory, &format!("{words} --size 12x9 -o small.png")));
    assert!(said.contains("because of the width of pixels; their light takes"), "{said}");
    stdout(&directory, &format!("{words} --size 12x9 -o again.png"));
    let said = refusal(&directory, &format!("{words} --size 64x48 -o large.png"));
    assert!(said.contains("made for wider pixels") && said.contains("delete it"), "{said}");
}

#[test]
fn points_differ_from_probes_by_noise_only() {
    let (_keep, directory) = directory();
    stdout(&directory, "render ball.toml -q --size 16x12 --spp 256 -o points.exr");
    stdout(
        &directory,
        "render ball.toml -q --size 16x12 --spp 256 --subsurface-method ray-traced -o probes.exr",
    );
    let sum = |name: &str| -> f64 {
        let values = exr_values(&directory.join(name));
        let beauty = values.iter().filter(|(name, _)| ["R", "G", "B"].contains(&name.as_str()));
        beauty.flat_map(|(_, values)| values).map(|&bits| f64::from(f32::from_bits(bits))).sum()
    };
    let ratio = sum("points.exr") / sum("probes.exr");
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn points_that_do_not_fit_are_refused_before_any_work() {
    let (_keep, directory) = directory();
    let text = fs::read_to_string(directory.join("ball.toml")).unwrap();
    let fine = text.replace("point_tolerance = 0.5", "point_tolerance = 0.001\npoint_memory = 1");
    fs::write(directory.join("fine.toml"), fine).unwrap();
    let said = refusal(&directory, "render fine.toml -o fine.exr --points fine.points");
    for part in [
        "points need",
        "may take 1.00 MiB",
        "material stuff of object ball",
        "mean free path",
        "point_tolerance",
    ] {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
    // Pixels must be as narrow as the profile for it to be too fine
    let tiny = text
        .replace("subsurface_radius = 2", "subsurface_radius = 1e-4")
        .replace("point_tolerance = 0.5", "point_tolerance = 0.5\npoint_memory = 1");
    fs::write(directory.join("tiny.toml"), tiny).unwrap();
    assert!(refusal(&directory, "render tiny.toml --size 400x300 -o tiny.exr").contains("points need"));
    assert_eq!(files(&directory), ["ball.toml", "fine.toml", "tiny.toml"]);
}

#[test]
fn options_of_points_have_to_fit() {
    let (_keep, directory) = directory();
    let said = refusal(&directory, "render ball.toml --points a.points --subsurface-method ray-traced");
    assert!(said.contains("the method is ray-traced"), "{said}");
    let said = refusal(&directory, "render ball.toml --points nowhere/a.points");
    assert!(said.contains("nowhere"), "{said}");
    let said = refusal(&directory, "render ball.toml --points ball.toml -o ball.exr");
    assert!(said.contains("no file of points"), "{said}");
    for file in ["ball.exr", "./ball.png", "ball.exr.checkpoint"] {
        let said = refusal(&directory, &format!("render ball.toml --points {file} -o ball.exr"));
        assert!(said.contains("written over"), "{said}");
    }
    assert_eq!(files(&directory), ["ball.toml"]);
    let said = refusal(&directory, "render ball.toml --subsurface-method points");
    assert!(said.contains("ray-traced, point-based and cycles-disk"), "{said}");
}
