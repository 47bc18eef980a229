//! Signals of terminals and queues, full disks, too little memory, and outputs that are somebody else's.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use crate::common::{
    BALL, directory_with_ball, exr_values, files, run, send, signal, stderr, stdout, wait_for,
};

/// A rendering that would take hours.
const LONG: &str = "render ball.toml --spp 4000000 --threads 1 --checkpoint 0.05 -o long.exr";

/// Starts the command by a line of a shell, which ends in its words.
fn start(directory: &Path, before: &str, words: &str) -> Child {
    let mut command = Command::new("sh");
    let program = env!("CARGO_BIN_EXE_translucid");
    command.args(["-c", &format!("{before} {program} {words}")]).current_dir(directory);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Sends a signal to a [`LONG`] rendering once it has something to keep, and waits for its end.
fn signal_long(directory: &Path, child: Child, name: &str) -> Output {
    signal(child, name, || directory.join("long.exr.checkpoint").exists())
}

fn wait_for_file(path: &Path) {
    wait_for(&path.display().to_string(), || path.exists());
}

#[test]
fn signals_that_end_jobs_keep_the_picture_and_have_their_exit_codes() {
    for (name, code) in
        [("-INT", 130), ("-TERM", 143), ("-HUP", 129), ("-USR1", 138), ("-USR2", 140), ("-XCPU", 152)]
    {
        let (_keep, directory) = directory_with_ball();
        // Who runs the tests may have told them to ignore SIGHUP
        let child = start(&directory, "exec env --default-signal=HUP", LONG);
        let output = signal_long(&directory, child, name);
        assert_eq!(output.status.code(), Some(code), "{name}: {}", stderr(&output));
        assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
        assert_eq!(files(&directory), ["ball.toml", "long.exr", "long.exr.checkpoint", "long.png"]);
        assert!(!exr_values(&directory.join("long.exr")).is_empty());
    }
}

/// A limit on CPU time warns every second from then on.
#[test]
fn warnings_that_come_again_do_not_cost_the_picture() {
    let (_keep, directory) = directory_with_ball();
    let mut child = start(&directory, "exec", LONG);
    let process = child.id();
    let checkpoint = directory.join("long.exr.checkpoint");
    wait_for_file(&checkpoint);
    let mut end = None;
    wait_for("the end", || {
        for name in ["-XCPU", "-USR2"] {
            if end.is_none() && child.try_wait().unwrap().is_none() {
                send(process, name);
            }
        }
        end = child.try_wait().unwrap();
        end.is_some()
    });
    // Which of two that are pending comes first is the system's choice
    assert!([Some(140), Some(152)].contains(&end.unwrap().code()), "{end:?}");
    assert_eq!(files(&directory), ["ball.toml", "long.exr", "long.exr.checkpoint", "long.png"]);
}

#[test]
fn signals_that_a_script_ignores_are_ignored() {
    let (_keep, directory) = directory_with_ball();
    let child = start(&directory, "trap '' USR1 USR2 XCPU; exec", LONG);
    let checkpoint = directory.join("long.exr.checkpoint");
    wait_for_file(&checkpoint);
    ["-USR1", "-USR2", "-XCPU"].into_iter().for_each(|name| send(child.id(), name));
    let saved = || fs::metadata(&checkpoint).and_then(|found| found.modified()).ok();
    let before = saved();
    let output = signal(child, "-INT", || saved() > before);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
}

#[test]
fn interrupted_points_leave_no_file() {
    let (_keep, directory) = directory_with_ball();
    let far = BALL.replace("subsurface_radius = 0.2", "subsurface_radius = 0.5");
    let points = "[integrator]\nsubsurface_method = \"point-based\"\npoint_tolerance = 0.001";
    fs::write(directory.join("ball.toml"), far.replace("[integrator]", points)).unwrap();
    let mut child =
        start(&directory, "exec", "render ball.toml --size 64x48 --spp 1 --threads 1 -o ball.exr");
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let light = lines.find(|line| line.as_ref().is_ok_and(|line| line.contains("light that enters")));
    light.expect("points").unwrap();
    send(child.id(), "-INT");
    let said = lines.map_while(Result::ok).collect::<Vec<_>>().join("\n");
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
    assert!(said.contains("the points were not ready, so nothing was written"), "{said}");
    assert_eq!(files(&directory), ["ball.toml"]);
}

#[test]
fn nohup_goes_on_where_the_terminal_closes() {
    let (_keep, directory) = directory_with_ball();
    let child = start(&directory, "trap '' HUP; exec", LONG);
    let checkpoint = directory.join("long.exr.checkpoint");
    let saved = || fs::metadata(&checkpoint).and_then(|found| found.modified()).ok();
    wait_for_file(&checkpoint);
    send(child.id(), "-HUP");
    let before = saved();
    let output = signal(child, "-INT", || saved() > before);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("stopping").count(), 1, "{}", stderr(&output));
    assert!(directory.join("long.exr").exists());
}

/// The limit on the size of files stands for a disk that has room for the picture, but not for its sums.
#[test]
fn checkpoint_that_cannot_be_written_does_not_cost_the_picture() {
    let (_keep, directory) = directory_with_ball();
    // Some ten checkpoints are tried; blocks of 512 bytes or, of some shells, of 1024
    let words = "render ball.toml --size 96x96 --spp 64 --checkpoint 0.01 -o picture.png";
    let output = start(&directory, "ulimit -f 200; exec", words).wait_with_output().unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert_eq!(text.matches("warning:").count(), 1, "{text}");
    assert!(text.contains("picture.png.checkpoint: cannot write the file"), "{text}");
    assert_eq!(files(&directory), ["ball.toml", "picture.png"]);
    let samples = text.split(" samples per pixel").next().unwrap().lines().last().unwrap();
    assert_eq!(samples, "64", "{text}");
}

/// The larger of two pictures does not fit: the other is written all the same.
#[test]
fn picture_that_fits_is_written_where_the_other_does_not() {
    let (_keep, directory) = directory_with_ball();
    let words = "render ball.toml -q --size 96x96 --spp 1 -o picture.exr";
    let output = start(&directory, "ulimit -f 100; exec", words).wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("picture.exr: cannot write the file"), "{}", stderr(&output));
    assert_eq!(files(&directory), ["ball.toml", "picture.png"]);
}

#[test]
fn short_renderings_leave_no_checkpoint() {
    let (_keep, directory) = directory_with_ball();
    let output = run(&directory, "render ball.toml --spp 64 -o short.exr");
    assert_eq!(output.status.code(), Some(0));
    assert!(!stderr(&output).contains("checkpoint"), "{}", stderr(&output));
    assert_eq!(files(&directory), ["ball.toml", "short.exr", "short.png"]);
}

#[test]
fn file_that_is_no_checkpoint_is_not_replaced_by_one() {
    let (_keep, directory) = directory_with_ball();
    let foreign = directory.join("a.png.checkpoint");
    fs::write(&foreign, "somebody's game").unwrap();
    for words in ["render ball.toml -o a.png", "render ball.toml --resume -o a.png"] {
        let output = run(&directory, words);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", stderr(&output));
        assert!(stderr(&output).contains("a.png.checkpoint"), "{}", stderr(&output));
    }
    assert_eq!(fs::read(&foreign).unwrap(), b"somebody's game");
    assert_eq!(files(&directory), ["a.png.checkpoint", "ball.toml"]);
    let words = "render ball.toml --spp 1 --subsurface dipole,none -o two";
    fs::create_dir(directory.join("two")).unwrap();
    fs::write(directory.join("two/none.half.checkpoint"), "x").unwrap();
    let output = run(&directory, words);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("none.half.checkpoint"), "{}", stderr(&output));
}

#[test]
fn fit_replaces_files_of_earlier_fits_only() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let rows: String = (1..40).map(|r| format!("{r},{}\n", (-0.3 * f64::from(r)).exp())).collect();
    fs::write(directory.join("measured.csv"), format!("r,reflectance\n{rows}")).unwrap();
    let words = "fit --table measured.csv -o fits";
    stdout(directory, words);
    stdout(directory, words);
    let found = files(&directory.join("fits"));
    assert_eq!(found, ["parameters.csv", "report.txt", "residuals.csv", "residuals.svg"]);
    for name in ["report.txt", "residuals.svg"] {
        let other = directory.join("other");
        fs::create_dir(&other).unwrap();
        fs::write(other.join(name), "somebody's thesis").unwrap();
        let output = run(directory, "fit --table measured.csv -o other");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(name), "{}", stderr(&output));
        assert_eq!(fs::read(other.join(name)).unwrap(), b"somebody's thesis");
        assert_eq!(files(&other), [name]);
        fs::remove_dir_all(other).unwrap();
    }
}

#[test]
fn second_process_of_an_output_says_who_has_it() {
    let (_keep, directory) = directory_with_ball();
    for (long, second) in [
        (LONG, "render ball.toml --spp 1 -o long.png"),
        ("render ball.toml --spp 4000000 --subsurface dipole,none -o two", "compare -o two"),
    ] {
        let mut first = start(&directory, "exec", long);
        let lock = if long == LONG { ".long.png.lock" } else { "two/.translucid.lock" };
        wait_for(lock, || fs::metadata(directory.join(lock)).is_ok_and(|found| found.len() > 0));
        let output = run(&directory, second);
        assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
        let text = stderr(&output);
        assert!(text.contains(&format!("process {} (translucid {long})", first.id())), "{text}");
        let mut waiting = start(&directory, "exec", &format!("{second} --wait 0.001"));
        assert_eq!(waiting.wait().unwrap().code(), Some(75));
        // Killed, it keeps nothing
        first.kill().unwrap();
        first.wait().unwrap();
        let mut text = String::new();
        first.stderr.take().unwrap().read_to_string(&mut text).unwrap();
    }
    stdout(&directory, "render ball.toml -q --spp 1 -o long.png");
    assert!(!directory.join(".long.png.lock").exists());
}

/// Who waits begins when the other has ended, and keeps what it has left.
#[test]
fn second_process_of_an_output_waits_for_it() {
    let (_keep, directory) = directory_with_ball();
    let shard =
        "render ball.toml --spp 4000000 --samples 0..4000000 --threads 1 --checkpoint 0.05 -o a.shard";
    let mut first = start(&directory, "exec", shard);
    wait_for_file(&directory.join("a.shard"));
    let mut second = start(&directory, "exec", &format!("{shard} --resume --wait 600"));
    let mut lines = BufReader::new(second.stderr.take().unwrap()).lines().map(Result::unwrap);
    let told = lines.next().unwrap();
    let words = format!("waiting: a.shard is being written by process {} (translucid", first.id());
    assert!(told.starts_with(&words), "{told}");
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(lines.any(|line| line.starts_with("continuing from")));
    send(second.id(), "-TERM");
    assert_eq!(second.wait().unwrap().code(), Some(143));
}

/// Whatever the limit on the address space, a rendering ends with its picture or with a reason: no panic, no abort.
#[test]
fn too_little_memory_is_an_error_with_numbers() {
    let (_keep, directory) = directory_with_ball();
    // A mesh of 323,208 triangles
    let vertices = (0..403_u32.pow(2)).map(|i| {
        let (x, y) = (i % 403, i / 403);
        format!("v {x} {y} {:.2}\n", (f64::from(x * y) * 0.01).sin())
    });
    let faces = (0..402_u32.pow(2)).map(|i| {
        let corner = i / 402 * 403 + i % 402 + 1;
        format!("f {corner} {} {} {}\n", corner + 1, corner + 404, corner + 403)
    });
    fs::write(directory.join("grid.obj"), vertices.chain(faces).collect::<String>()).unwrap();
    let words = "render grid.obj --preset marble --unit mm --size 500x500 --spp 1 --threads 2 -o a.png";
    // Returns the refusal, empty where there was a picture
    let attempt = |mebibytes: u32| {
        // How many arenas the allocator reserves would depend on how its threads meet
        let limit =
            format!("export RUST_BACKTRACE=0 MALLOC_ARENA_MAX=1; ulimit -v {}; exec", mebibytes * 1024);
        let output = start(&directory, &limit, words).wait_with_output().unwrap();
        let text = stderr(&output);
        if output.status.success() {
            fs::remove_file(directory.join("a.png")).unwrap();
        } else {
            // Of a program that the system cannot even load there is nothing to say
            let is_loaded =
                start(&directory, &limit, "--version").wait_with_output().unwrap().status.success();
            assert!(!is_loaded || text.contains("error:"), "{mebibytes} MiB: {:?} {text}", output.status);
            assert!(
                !text.contains("panicked") && !text.contains("memory allocation of"),
                "{mebibytes}: {text}"
            );
        }
        assert_eq!(files(&directory), ["ball.toml", "grid.obj"], "{mebibytes} MiB: {text}");
        if output.status.success() { String::new() } else { text }
    };
    for mebibytes in [24, 40, 70, 100, 150] {
        attempt(mebibytes);
    }
    // Where a picture begins to be possible depends on the machine; just below, the command says what it needs
    let (mut low, mut high, mut refusal) = (150, 1200, String::new());
    assert_eq!(attempt(high), "");
    while high - low > 8 {
        let middle = u32::midpoint(low, high);
        let text = attempt(middle);
        if text.is_empty() {
            high = middle;
        } else {
            (low, refusal) = (middle, text);
        }
    }
    assert!(refusal.contains("rendering needs about"), "{low} MiB: {refusal}");
}

#[test]
fn bare_command_is_short_for_a_small_still_life_and_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    for (words, options, then) in
        [("", "", ""), ("--resume", " --resume", "there is no still-life.exr.checkpoint yet")]
    {
        let mut child = start(directory.path(), "exec", words);
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        let short = format!("short for: translucid render --size 640x360 --spp 20{options}");
        assert_eq!(lines.next(), Some(short));
        assert!(lines.any(|line| line.starts_with(then)), "{words}");
        wait_for_file(&directory.path().join(".still-life.png.lock"));
        child.kill().unwrap();
        child.wait().unwrap();
        fs::remove_file(directory.path().join(".still-life.png.lock")).unwrap();
    }
}
