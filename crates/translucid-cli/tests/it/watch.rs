//! A rendering that is followed: previews, progress and statistics.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use serde_json::Value;

use crate::common::{directory_with_ball, files, run, signal, start, stderr, stdout};

/// Codes of a PNG, whole to its end.
fn codes(path: &Path) -> Vec<u8> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut codes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut codes).unwrap();
    reader.finish().unwrap();
    codes
}

#[cfg(target_os = "linux")]
#[test]
fn preview_grows_while_it_renders_and_is_the_picture_in_the_end() {
    let (_keep, directory) = directory_with_ball();
    let words = "render ball.toml -q --spp 4000000 --preview so-far.png --region 3,2,33,20 -o end.png";
    let preview = directory.join("so-far.png");
    let mut states = Vec::new();
    let output = signal(start(&directory, words), "-INT", || {
        // Whole at any moment
        if preview.exists() {
            let state = codes(&preview);
            if states.last() != Some(&state) {
                states.push(state);
            }
        }
        states.len() == 2
    });
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    // A picture of the region
    assert_eq!(codes(&preview), codes(&directory.join("end.png")));
    assert_eq!(codes(&preview).len() % (30 * 18), 0);
    assert_eq!(files(&directory), ["ball.toml", "end.png", "end.png.checkpoint", "so-far.png"]);
}

#[test]
fn files_of_followers_are_their_own() {
    let (_keep, directory) = directory_with_ball();
    for (options, named) in [
        ("--preview so-far.jpg", "must end in .png"),
        ("--preview a.png", "--preview is a.png, which is written as well"),
        ("--stats a.exr.checkpoint", "--stats is a.exr.checkpoint, which is written as well"),
        ("--preview b.png --stats b.png", "--stats is b.png, which is written as well"),
        ("--stats ball.toml", "--stats is ball.toml, a file that the scene is read from"),
        ("--preview missing/b.png", "missing"),
        ("--stats s.json --subsurface dipole,none", "--stats is for one model"),
        ("--json-progress -q", "cannot be used with"),
    ] {
        let output = run(&directory, &format!("render ball.toml --spp 1 -o a.exr {options}"));
        assert_eq!(output.status.code(), Some(2), "{options}: {}", stderr(&output));
        assert!(stderr(&output).contains(named), "{options}: {}", stderr(&output));
    }
    assert_eq!(files(&directory), ["ball.toml"]);
}

#[test]
fn programs_get_an_object_a_line() {
    let (_keep, directory) = directory_with_ball();
    let output = run(&directory, "render ball.toml --spp 4000000 --time 3 --json-progress -o a.png");
    assert!(output.status.success());
    let events: Vec<Value> =
        stderr(&output).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let named =
        |name: &str| -> Vec<&Value> { events.iter().filter(|event| event["event"] == name).collect() };
    let progress = named("progress");
    // At most twice a second of the 3 s
    assert!((1..=7).contains(&progress.len()), "{events:?}");
    let number = |event: &Value, name: &str| event[name].as_f64().unwrap();
    for pair in progress.windows(2) {
        for name in ["done", "seconds", "fraction"] {
            assert!(number(pair[0], name) <= number(pair[1], name), "{pair:?}");
        }
    }
    let last = progress.last().unwrap();
    let seconds = number(last, "seconds");
    assert!((number(last, "fraction") - seconds / 3.0).abs() < 0.05, "{last:?}");
    assert!(
        last["unit"] == "samples" && (number(last, "seconds_left") + seconds - 3.0).abs() < 0.15,
        "{last:?}"
    );
    let statistics = named("statistics");
    assert!(statistics.len() == 1 && statistics[0]["outcome"] == "time-up", "{statistics:?}");
    assert!(!named("message").is_empty());

    let output = run(&directory, "render missing.toml --json-progress");
    assert_eq!(output.status.code(), Some(2));
    let error: Value = serde_json::from_str(stderr(&output).trim()).unwrap();
    assert_eq!(error["event"], "error");
    assert!(
        error["text"].is_string() && error["place"].as_str().unwrap().contains("missing.toml"),
        "{error}"
    );
}

#[test]
fn statistics_are_those_of_the_rendering() {
    let (_keep, directory) = directory_with_ball();
    let read = |name: &str| -> Value {
        serde_json::from_str(&fs::read_to_string(directory.join(name)).unwrap()).unwrap()
    };
    let render = |options: &str| stdout(&directory, &format!("render ball.toml -q {options}"));
    render("--spp 16 --threads 2 --stats a.json -o a.png");
    let a = read("a.json");
    assert_eq!(a["samples"], 16 * 40 * 24);
    assert_eq!([&a["width"], &a["height"], &a["samples_per_pixel"], &a["threads"]], [40, 24, 16, 2]);
    assert!(a["outcome"] == "finished" && a["objects"] == 1 && a["files"] == serde_json::json!(["a.png"]));
    assert!(a["command"].as_str().unwrap().starts_with("translucid render ball.toml"), "{a}");
    for part in ["loading", "preparing", "rendering", "writing"] {
        assert!(a["seconds"][part].as_f64().unwrap() > 0.0, "{part}");
    }
    assert_eq!(a["seconds"]["rendering_before"], 0.0);
    // Bits do not depend on whether anybody follows
    render("--spp 16 -o quiet.png");
    assert_eq!(codes(&directory.join("a.png")), codes(&directory.join("quiet.png")));
    // Sixteen times the samples have a sixteenth of the noise, as far as it can be told from 2880 values; samples that
    // are spread evenly, and those that pixels share, leave between a fourth and a hundredth of it
    render("--spp 256 --stats b.json -o b.png");
    let noise = |statistics: &Value| statistics["relative_noise"].as_f64().unwrap();
    let ratio = noise(&a) / noise(&read("b.json"));
    assert!(noise(&a) > 0.0 && (4.0..100.0).contains(&ratio), "{ratio}");

    // Of two runs
    render("--spp 4 --resume -o c.png");
    render("--spp 8 --resume --stats c.json -o c.png");
    let c = read("c.json");
    assert_eq!([&c["samples"], &c["samples_now"]], [8 * 960, 4 * 960]);
    assert!(c["seconds"]["rendering_before"].as_f64().unwrap() > 0.0);
    // Without a goal there is no half
    render("--time 0.2 --stats d.json -o d.png");
    assert!(read("d.json")["relative_noise"].is_null() && read("d.json")["outcome"] == "time-up");
}
