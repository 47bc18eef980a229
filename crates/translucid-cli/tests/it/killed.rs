//! A rendering that is killed: its files stay whole, and it goes on to the same end.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant, SystemTime};

use crate::common::{directory_with_ball, exr_values, files, stderr, stdout, translucid};
use translucid_render::ShardReader;

/// Options to go on from where a rendering was killed, and to save it all the time.
const GOING_ON: &str = "--checkpoint 0.01 --resume";

/// Whatever moment the process is killed at, by a signal that it cannot catch, the picture is the old one or the new
/// one, the checkpoint a whole one or none, and going on from there ends in the bytes of an undisturbed rendering.
#[test]
fn killed_renderings_leave_whole_files_and_resume_to_the_same_bits() {
    let (_keep, directory) = directory_with_ball();
    let rendering = "render ball.toml -q --size 96x64 --spp 48";
    let start = Instant::now();
    stdout(&directory, &format!("{rendering} -o whole.exr"));
    let duration = start.elapsed();
    // A picture that was there before
    stdout(&directory, "render ball.toml -q --size 8x8 --spp 1 -o killed.exr");

    let compare = || {
        assert_eq!(exr_values(&directory.join("killed.exr")), exr_values(&directory.join("whole.exr")));
        let bytes = |name: &str| fs::read(directory.join(name)).unwrap();
        assert!(bytes("killed.png") == bytes("whole.png"));
    };
    let words = format!("{rendering} {GOING_ON} -o killed.exr");
    let mut attempts = Attempts::new(duration);
    let mut checkpoints = 0;
    while attempts.kills < kills([6, 30]) {
        let is_killed = attempts.attempt(&directory, &words);
        checkpoints += check_files(&directory);
        assert!(["killed.exr", "killed.png"].map(|name| directory.join(name).exists()) == [true; 2]);
        if !is_killed {
            // It was sooner: the next begins anew, with the picture and without the checkpoint
            compare();
            fs::remove_file(directory.join("killed.exr.checkpoint")).unwrap();
        }
    }
    assert!(checkpoints > 0, "no kill came after the first checkpoint");
    stdout(&directory, &words);
    compare();
    // No draft of a file is left
    let names = ["ball.toml", "killed.exr", "killed.exr.checkpoint", "killed.png", "whole.exr", "whole.png"];
    assert_eq!(files(&directory), names);
}

#[test]
fn killed_renderings_side_by_side_leave_whole_files_and_resume_to_the_same_bits() {
    let (_keep, directory) = directory_with_ball();
    let rendering = "render ball.toml -q --size 64x48 --spp 32 --subsurface dipole,none";
    let start = Instant::now();
    stdout(&directory, &format!("{rendering} -o whole"));
    let duration = start.elapsed();

    let words = format!("{rendering} {GOING_ON} -o killed");
    let [whole, killed] = ["whole", "killed"].map(|name| directory.join(name));
    let mut attempts = Attempts::new(duration);
    while attempts.kills < kills([3, 15]) {
        let is_killed = attempts.attempt(&directory, &words);
        if !is_killed {
            fs::remove_dir_all(&killed).unwrap();
        } else if killed.exists() {
            check_files(&killed);
        }
    }
    stdout(&directory, &words);
    for name in files(&whole) {
        match extension(&name) {
            "exr" => assert_eq!(exr_values(&whole.join(&name)), exr_values(&killed.join(&name)), "{name}"),
            "png" => {
                assert!(
                    fs::read(whole.join(&name)).unwrap() == fs::read(killed.join(&name)).unwrap(),
                    "{name}"
                );
            }
            _ => assert!(killed.join(&name).exists(), "{name}"),
        }
    }
    assert!(files(&killed).iter().all(|name| extension(name) != "part"), "{:?}", files(&killed));
}

/// Each of three shards is killed at random moments; the rest is rendered, and all merge to the picture.
#[test]
fn killed_shards_go_on_and_merge_to_the_picture_of_one_rendering() {
    let (_keep, directory) = directory_with_ball();
    let rendering = "render ball.toml -q --size 96x64 --spp 48";
    stdout(&directory, &format!("{rendering} -o whole.exr"));
    let shard = |name: &str, samples: &str| {
        let words = format!("{rendering} --samples {samples} {GOING_ON} -o {name}.shard");
        let start = Instant::now();
        stdout(&directory, &words);
        let duration = start.elapsed();
        let path = directory.join(format!("{name}.shard"));
        let mut attempts = Attempts::new(duration);
        while attempts.kills < kills([2, 10]) {
            if !attempts.attempt(&directory, &words) {
                fs::remove_file(&path).unwrap();
            }
            check_files(&directory);
        }
        stdout(&directory, &words);
    };
    shard("a", "0..16");
    shard("b", "16..40");
    shard("c", "40..48");
    stdout(&directory, "merge -q killed.exr c.shard a.shard b.shard");
    assert_eq!(exr_values(&directory.join("killed.exr")), exr_values(&directory.join("whole.exr")));
    let bytes = |name: &str| fs::read(directory.join(name)).unwrap();
    assert!(bytes("killed.png") == bytes("whole.png"));
}

/// Number of kills in this run, or with the whole power.
fn kills([quick, thorough]: [u32; 2]) -> u32 {
    if translucid_testing::is_thorough() { thorough } else { quick }
}

/// Event that a killer waits for, from some moment of the command's time on.
#[derive(Clone, Copy, Debug)]
enum Event {
    /// None: the moment itself, which may be before the first checkpoint.
    Nothing,
    /// A draft is there: a file is being written.
    Draft,
    /// A checkpoint has taken its place: the next has not begun.
    Checkpoint,
}

impl Event {
    /// Waits for the event in a directory and those in it, or for the end of the command.
    fn wait(self, directory: &Path, child: &mut Child) {
        let before = newest_checkpoint(directory);
        while child.try_wait().unwrap().is_none() {
            let is_there = match self {
                Self::Nothing => true,
                Self::Draft => !files_below(directory, "part").is_empty(),
                Self::Checkpoint => newest_checkpoint(directory) > before,
            };
            if is_there {
                return;
            }
            std::thread::sleep(Duration::from_micros(100));
        }
    }
}

/// Files with an extension in a directory and the directories in it, some of which may go away meanwhile.
fn files_below(directory: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = |directory: &Path| -> Vec<PathBuf> {
        fs::read_dir(directory).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
    };
    let mut paths = entries(directory);
    let inner: Vec<PathBuf> =
        paths.iter().filter(|path| path.is_dir()).flat_map(|path| entries(path)).collect();
    paths.extend(inner);
    paths.retain(|path| path.extension().is_some_and(|found| found == extension));
    paths
}

/// Time of the last checkpoint, if there is one.
fn newest_checkpoint(directory: &Path) -> Option<SystemTime> {
    let checkpoints = ["checkpoint", "shard"].map(|extension| files_below(directory, extension));
    let checkpoints = checkpoints.into_iter().flatten();
    checkpoints.filter_map(|path| fs::metadata(path).and_then(|found| found.modified()).ok()).max()
}

/// Runs of a command, most of which are killed.
struct Attempts {
    /// About how long the command takes, undisturbed.
    duration: Duration,
    runs: u32,
    kills: u32,
}

impl Attempts {
    fn new(duration: Duration) -> Self {
        Self { duration, runs: 0, kills: 0 }
    }

    /// Runs the command and kills it at the first event after some moment of the time that it takes; false if it had
    /// ended by then.
    fn attempt(&mut self, directory: &Path, words: &str) -> bool {
        let mut command = translucid(directory);
        let mut child = command.args(words.split_whitespace()).stderr(Stdio::piped()).spawn().unwrap();
        self.runs += 1;
        assert!(self.runs < 1000, "the command ends sooner than it is killed");
        // Weyl's sequence leaves no moment out for long.
        std::thread::sleep(self.duration.mul_f64((f64::from(self.runs) * 0.618_033_988_749_895).fract()));
        let event = [Event::Nothing, Event::Draft, Event::Checkpoint][self.kills as usize % 3];
        event.wait(directory, &mut child);
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        let is_killed = output.status.code().is_none();
        assert!(is_killed || output.status.success(), "{words}: {}", stderr(&output));
        self.kills += u32::from(is_killed);
        is_killed
    }
}

/// Reads every picture and checkpoint of a directory to its end; returns the number of checkpoints.
fn check_files(directory: &Path) -> usize {
    let names = files(directory);
    for name in &names {
        let path = directory.join(name);
        match extension(name) {
            "exr" => assert!(!exr_values(&path).is_empty()),
            "png" => check_png(&path),
            "checkpoint" | "shard" => drop(ShardReader::open(&path).and_then(ShardReader::film).unwrap()),
            "toml" | "html" | "csv" | "svg" => assert!(fs::metadata(&path).unwrap().len() > 0, "{name}"),
            // A draft, or what kept others off the output
            other => assert!(["part", "lock"].contains(&other), "{name}"),
        }
    }
    names.iter().filter(|name| extension(name) == "checkpoint").count()
}

fn check_png(path: &Path) {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
}

fn extension(name: &str) -> &str {
    Path::new(name).extension().unwrap_or_default().to_str().unwrap()
}
