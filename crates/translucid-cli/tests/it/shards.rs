//! Shards by the command: parts that merge to the files of one run, and everything that can be wrong with them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::common::{BALL, directory_with_ball, exr_values, files, run, stderr, stdout};

const RENDERING: &str = "render ball.toml -q";

/// The command fails with this code and these words.
fn assert_refused(output: &Output, code: i32, words: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert!(words.iter().all(|word| text.contains(word)), "{words:?} in {text}");
}

fn assert_same_picture(directory: &Path, a: &str, b: &str) {
    let [a, b] = [a, b].map(|name| directory.join(name));
    assert_eq!(exr_values(&a.with_extension("exr")), exr_values(&b.with_extension("exr")));
    assert!(fs::read(a.with_extension("png")).unwrap() == fs::read(b.with_extension("png")).unwrap());
}

#[test]
fn parts_of_a_plan_merge_to_the_files_of_one_run() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, &format!("{RENDERING} --spp 6 -o whole.exr"));
    for (shards, count) in [(1, 1), (4, 4), (9, 10)] {
        let text = stdout(&directory, &format!("plan ball.toml --shards {shards} -- -q --spp 6"));
        let plan: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(plan["shards"].as_array().unwrap().len(), count, "{text}");
        assert_eq!((&plan["samples_per_pixel"], &plan["size"][0]), (&Value::from(6), &Value::from(40)));
        let run_words = |words: &Value| {
            let words: Vec<&str> =
                words.as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
            stdout(&directory, &words[1..].join(" "));
        };
        plan["shards"].as_array().unwrap().iter().rev().for_each(|shard| run_words(&shard["command"]));
        run_words(&plan["merge"]);
        assert_same_picture(&directory, "ball", "whole");
        fs::remove_file(directory.join("ball.exr")).unwrap();
    }
    let text = stdout(&directory, "plan ball.toml --minutes 5 -- --region 3,4,30,20");
    let plan: Value = serde_json::from_str(&text).unwrap();
    assert!(
        plan["seconds_per_sample"].as_f64().unwrap() > 0.0 && plan["shards"].as_array().unwrap().len() == 1
    );
    assert_eq!(plan["shards"][0]["region"], serde_json::json!([3, 4, 30, 20]));
}

/// Lays shards of 3, 3 and 2 of the eight samples into the directory.
fn three_shards(directory: &Path) {
    for (name, samples) in [("a", "0..3"), ("b", "3..6"), ("c", "6..8")] {
        stdout(directory, &format!("{RENDERING} --samples {samples} -o {name}.shard"));
    }
}

#[test]
fn merged_parts_merge_again_and_are_resumed() {
    let (_keep, directory) = directory_with_ball();
    stdout(&directory, &format!("{RENDERING} -o whole.exr"));
    three_shards(&directory);
    stdout(&directory, "merge -q --allow-gaps ca.shard c.shard a.shard");
    stdout(&directory, "merge -q all.exr ca.shard b.shard");
    assert_same_picture(&directory, "all", "whole");
    // What is in a shard is not rendered again
    stdout(&directory, &format!("{RENDERING} --samples 0..8 --resume -o ca.shard"));
    stdout(&directory, "merge -q resumed.exr ca.shard");
    assert_same_picture(&directory, "resumed", "whole");
    // A checkpoint of a picture is a shard, too
    stdout(&directory, &format!("{RENDERING} --resume -o kept.exr"));
    stdout(&directory, "merge -q kept.shard kept.exr.checkpoint");
    stdout(&directory, "merge -q --exposure 1 brighter.png kept.shard");
    assert!(
        fs::read(directory.join("brighter.png")).unwrap() != fs::read(directory.join("whole.png")).unwrap()
    );
}

/// Queues run commands again; what they replace is called by its name.
#[test]
fn shard_that_is_replaced_is_finished_or_not() {
    let (_keep, directory) = directory_with_ball();
    let said = |words: &str| stderr(&run(&directory, words));
    let finished = |thing: &str| format!("the finished {thing} will be made anew; --resume keeps it");
    let unfinished = |thing: &str| format!("the unfinished {thing} will be replaced; --resume continues it");
    stdout(&directory, &format!("{RENDERING} --samples 0..1 -o n.shard"));
    for (words, expected) in [
        ("--samples 0..1 -o n.shard", finished("shard n.shard")),
        ("--samples 0..2 -o n.shard", unfinished("shard n.shard")),
        ("--samples 0..2 -o n.shard", finished("shard n.shard")),
        ("--samples 1..2 -o n.shard", finished("shard n.shard")),
        ("--samples 0..1 -o n.shard", unfinished("shard n.shard")),
        (
            "--samples 0..1 --seed 5 -o n.shard",
            String::from("n.shard: is of another scene or other settings: "),
        ),
        ("--resume -o n.png", String::new()),
        ("-o n.png", finished("rendering n.png.checkpoint")),
    ] {
        let text = said(&format!("{RENDERING} {words}"));
        assert!(text.contains(&expected), "{words}: {text}");
        assert_eq!(text.matches("note:").count(), usize::from(!expected.is_empty()), "{words}: {text}");
    }
}

#[test]
fn gaps_are_named_and_allowed() {
    let (_keep, directory) = directory_with_ball();
    three_shards(&directory);
    let output = run(&directory, "merge gaps.exr a.shard c.shard");
    assert_refused(&output, 1, &["lack --samples 3..6", "--allow-gaps"]);
    assert!(!directory.join("gaps.exr").exists());
    let output = run(&directory, "merge --allow-gaps gaps.exr a.shard c.shard");
    assert_refused(&output, 0, &["warning", "--samples 3..6", "5 samples or more"]);
    stdout(&directory, &format!("{RENDERING} --samples 3..6 --region 0,0,40,10 -o top.shard"));
    let output = run(&directory, "merge gaps.exr a.shard c.shard top.shard");
    assert_refused(&output, 1, &["lack --samples 3..6 --region 0,10,40,24"]);
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let (_keep, directory) = directory_with_ball();
    three_shards(&directory);
    let changed = BALL.replace("subsurface_color = [0.8, 0.5, 0.3]", "subsurface_color = [0.8, 0.5, 0.4]");
    fs::write(directory.join("other.toml"), changed).unwrap();
    stdout(&directory, "render other.toml -q --samples 3..6 -o other.shard");
    stdout(&directory, "render ball.toml -q --seed 5 --samples 3..6 -o seed.shard");
    let bytes = fs::read(directory.join("b.shard")).unwrap();
    fs::write(directory.join("half.shard"), &bytes[..bytes.len() / 2]).unwrap();
    let mut old = bytes.clone();
    old[8] = 1;
    fs::write(directory.join("old.shard"), old).unwrap();
    let before = files(&directory);
    for (words, expected) in [
        (
            "merge out.exr a.shard other.shard c.shard",
            &["other.shard", "a.shard", "material stuff differs"][..],
        ),
        ("merge out.exr a.shard seed.shard c.shard", &["seed.shard", "seed is 0 in one and 5 in the other"]),
        ("merge out.exr a.shard b.shard a.shard", &["a.shard", "samples 0..3"]),
        ("merge out.exr a.shard half.shard c.shard", &["half.shard", "damaged", "render it again"]),
        ("merge out.exr a.shard old.shard c.shard", &["old.shard", "another version"]),
        ("merge out.exr a.shard missing.shard", &["missing.shard", "No such file"]),
        ("merge out.exr a.shard ball.toml", &["ball.toml", "no shard"]),
        ("merge a.shard a.shard b.shard", &["a.shard is both"]),
        ("merge out.jpg a.shard b.shard", &["out.jpg", ".exr, .png, .shard or .npz"]),
        ("merge nowhere/out.exr a.shard b.shard c.shard", &["nowhere"]),
        ("render ball.toml --samples 0..3 -o out.exr", &["0..3", "-o FILE.shard"]),
        ("render ball.toml --samples 0..9 -o out.shard", &["0..9", "8 samples", "--spp 9"]),
        ("render ball.toml --samples 3..3 -o out.shard", &["A < B"]),
        ("render ball.toml --denoise -o out.shard", &["--denoise", "shard"]),
        (
            "render ball.toml -o ball.toml.shard --samples 0..1 --resume --seed 4294967296123123123123",
            &["--seed"],
        ),
        ("render ball.toml --subsurface dipole,none --samples 0..1 -o x", &["--samples"]),
        ("plan ball.toml --shards 0", &["0"]),
        ("plan ball.toml", &["--shards"]),
        ("plan ball.toml --shards 2 -- --samples 0..1", &["--samples"]),
        ("plan ball.toml --shards 2 -- --nonsense", &["--nonsense"]),
        ("plan ball.toml --minutes 0.00000001", &["--minutes"]),
    ] {
        let output = run(&directory, words);
        assert_refused(&output, 2, expected);
        assert_eq!(files(&directory), before, "{words}");
    }
    // A shard of another picture is not gone on from
    let output = run(&directory, "render other.toml -q --samples 0..3 --resume -o a.shard");
    assert_refused(&output, 2, &["a.shard", "material stuff differs"]);
}

#[test]
fn changed_texture_is_named() {
    let (_keep, directory) = directory_with_ball();
    let textured =
        BALL.replace("subsurface_color = [0.8, 0.5, 0.3]", "subsurface_color = { file = \"spots.png\" }");
    fs::write(directory.join("ball.toml"), textured).unwrap();
    let texture = |level: u8| {
        let file = fs::File::create(directory.join("spots.png")).unwrap();
        let mut encoder = png::Encoder::new(file, 2, 2);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[200, 100, 50, level]).unwrap();
    };
    texture(20);
    stdout(&directory, &format!("{RENDERING} --samples 0..4 -o a.shard"));
    texture(21);
    stdout(&directory, &format!("{RENDERING} --samples 4..8 -o b.shard"));
    assert_refused(&run(&directory, "merge out.exr a.shard b.shard"), 2, &["image 0 (spots.png) differs"]);
}

/// A disk that is full, or an output that may not be replaced, costs no part and leaves nothing half-written.
#[test]
#[cfg(unix)]
fn full_disk_and_protected_output_cost_nothing() {
    let (_keep, directory) = directory_with_ball();
    three_shards(&directory);
    let before = files(&directory);
    let program = env!("CARGO_BIN_EXE_translucid");
    for out in ["all.shard", "all.exr"] {
        let line =
            format!("trap \'\' XFSZ; ulimit -f 8; exec {program} merge -q {out} a.shard b.shard c.shard");
        let output = Command::new("sh").args(["-c", &line]).current_dir(&directory).output().unwrap();
        assert_refused(&output, 1, &[out, "cannot write"]);
        let left: Vec<String> = files(&directory).into_iter().filter(|name| name != "all.png").collect();
        assert_eq!(left, before, "{out}");
    }
    let protected = directory.join("protected.exr");
    fs::write(&protected, "mine").unwrap();
    let mut permissions = fs::metadata(&protected).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&protected, permissions).unwrap();
    let output = run(&directory, "merge -q protected.exr a.shard b.shard c.shard");
    assert_refused(&output, 2, &["protected.exr", "write-protected"]);
    assert_eq!(fs::read(&protected).unwrap(), b"mine");
    stdout(&directory, "merge -q all.exr a.shard b.shard c.shard");
}
