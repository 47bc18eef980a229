//! Running the command, and a scene that renders in a moment.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

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

/// Starts the command with words separated by spaces; what it prints is for [`Child::wait_with_output`].
pub(crate) fn start(directory: &Path, words: &str) -> Child {
    let mut command = translucid(directory);
    command.args(words.split_whitespace()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits for an event. Whoever waits for a time instead waits too little on a busy machine.
pub(crate) fn wait_for(event: &str, mut is_there: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_there() {
        assert!(start.elapsed().as_secs() < 600, "{event} does not come");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Sends a signal, such as `-INT`, to a command that catches Ctrl-C by now, once something is there, and returns its end,
/// which may come before.
#[cfg(target_os = "linux")]
pub(crate) fn signal(mut child: Child, name: &str, mut is_there: impl FnMut() -> bool) -> Output {
    let mut has_ended = false;
    wait_for("the moment for a signal", || {
        has_ended = child.try_wait().unwrap().is_some();
        has_ended || catches_interrupt(&child) && is_there()
    });
    if !has_ended {
        send(child.id(), name);
    }
    child.wait_with_output().unwrap()
}

/// Sends a signal to a command that runs.
#[cfg(target_os = "linux")]
pub(crate) fn send(process: u32, name: &str) {
    assert!(Command::new("kill").args([name, &process.to_string()]).status().unwrap().success());
}

/// Whether a process has a function for SIGINT, the second bit of the mask of caught signals (Linux, proc(5)).
#[cfg(target_os = "linux")]
fn catches_interrupt(child: &Child) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & 2 != 0)
}

/// CPU seconds of a process so far, of which Linux keeps account in hundredths (proc(5), fields 14 and 15).
#[cfg(target_os = "linux")]
pub(crate) fn cpu_seconds(process: u32) -> f64 {
    let account = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    let fields = account.rsplit(')').next().unwrap().split_whitespace().skip(11).take(2);
    fields.map(|ticks| ticks.parse::<f64>().unwrap() / 100.0).sum()
}

/// Standard error of the command.
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
