//! Running the command, and a scene that renders in a moment.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The command, to be run in a directory.
pub(crate) fn translucid(directory: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_translucid"));
    command.current_dir(directory).env_remove("NO_COLOR");
    command
}

/// Runs the command with words separated by spaces.
pub(crate) fn run(directory: &Path, words: &str) -> Output {
    translucid(directory).args(words.split_whitespace()).output().unwrap()
}

/// Runs the command, which must succeed, and returns its stdout.
pub(crate) fn stdout(directory: &Path, words: &str) -> String {
    let output = run(directory, words);
    assert_eq!(output.status.code(), Some(0), "{words}: {}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// What the command printed on stderr.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A scene of a translucent ball, 40×24 pixels, 8 samples per pixel.
pub(crate) const BALL: &str = "\
unit = \"mm\"
[film]
size = [40, 24]
[integrator]
samples_per_pixel = 8
[[material]]
name = \"stuff\"
subsurface_weight = 1.0
subsurface_color = [0.8, 0.5, 0.3]
subsurface_radius = 0.2
[[object]]
name = \"ball\"
shape = \"sphere\"
material = \"stuff\"
";

/// A fresh directory with the scene in it.
pub(crate) fn directory_with_ball() -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().to_owned();
    std::fs::write(path.join("ball.toml"), BALL).unwrap();
    (directory, path)
}

/// Names of all files in a directory, sorted.
pub(crate) fn files(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The values of all channels of an OpenEXR file, by channel name.
pub(crate) fn exr_values(path: &Path) -> Vec<(String, Vec<u32>)> {
    use exr::prelude::*;

    let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let layer = image.all_attributes().from_file(path).unwrap().layer_data;
    let channels = layer.channel_data.list.into_iter();
    channels
        .map(|c| (c.name.to_string(), c.sample_data.values_as_f32().map(f32::to_bits).collect()))
        .collect()
}
