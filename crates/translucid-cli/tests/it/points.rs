//! `translucid render` with the point-based method: options, and too little memory.

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
fn points_are_made_before_the_picture_and_announced() {
    let (_keep, directory) = directory();
    let output = run(&directory, "render ball.toml --threads 1 -o one.exr");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("laying points") && said.contains("points with their light in"), "{said}");
    stdout(&directory, "render ball.toml -q --threads 2 -o two.exr");
    assert_eq!(exr_values(&directory.join("one.exr")), exr_values(&directory.join("two.exr")));
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
    let said = refusal(&directory, "render fine.toml -o fine.exr");
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
fn methods_are_named_where_one_is_unknown() {
    let (_keep, directory) = directory();
    let said = refusal(&directory, "render ball.toml --subsurface-method points");
    assert!(said.contains("ray-traced, point-based and cycles-disk"), "{said}");
}
