//! Files that other processes and machines are writing in the same directory, on a disk where nobody sees a lock of another.
//!
//! Drafts are not locked, so that those of other machines look here as they do on such a disk.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Child;

use crate::common::{directory_with_ball, files, send, start, stdout, wait_for};

/// Commands that write each kind of file: shards, pictures, joined shards, walks, joined walks, tables.
const COMMANDS: [&str; 6] = [
    "render ball.toml -q --size 8x8 --spp 2 --samples 1..2 -o b.shard",
    "render ball.toml -q --size 8x8 --spp 1 -o picture.exr",
    "merge -q merged.exr a.shard b.shard",
    "reference -q --method monte-carlo --surface-albedo 0.5 --at 1 --photons 100..200 -o b.npz --resume",
    "merge -q merged.npz a.npz b.npz",
    "profile --surface-albedo 0.5 --mfp 1 --at 1,2 -o profile.csv",
];

/// Starts a table that is written for a while, and stops its process once its draft is there.
fn stopped_writer(directory: &Path) -> (Child, PathBuf) {
    for rows in (0..).map(|attempt| 1_000_000 << attempt) {
        let words = format!("sample --surface-albedo 0.5 --mfp 1 --count {rows} -o long.csv");
        let mut child = start(directory, &words);
        let mut draft = None;
        wait_for("a draft", || {
            draft = files(directory).into_iter().find(|name| name.ends_with(".part"));
            draft.is_some() || child.try_wait().unwrap().is_some()
        });
        if child.try_wait().unwrap().is_none() {
            send(child.id(), "-STOP");
            // The directory's check of a moment before the table's is another draft
            if let Some(path) = draft.map(|name| directory.join(name)).filter(|path| path.exists()) {
                return (child, path);
            }
            child.kill().unwrap();
        }
        child.wait().unwrap();
        files(directory).iter().filter(|name| name.ends_with(".part")).for_each(|name| {
            fs::remove_file(directory.join(name)).unwrap();
        });
    }
    unreachable!("attempts without end")
}

#[test]
fn every_command_spares_the_drafts_of_others() {
    let (_keep, directory) = directory_with_ball();
    let (mut writer, of_the_living) = stopped_writer(&directory);
    stdout(&directory, "render ball.toml -q --size 8x8 --spp 2 --samples 0..1 -o a.shard");
    let walk = "reference -q --method monte-carlo --surface-albedo 0.5 --at 1";
    stdout(&directory, &format!("{walk} --photons 0..100 -o a.npz"));

    let name = of_the_living.file_name().unwrap().to_str().unwrap();
    let [boot, process] = [".translucid-", &format!("-{}-", writer.id())].map(|part| {
        assert!(name.contains(part), "{name}");
        part.to_owned()
    });
    // No process of Linux has a number as large
    let of_the_dead = directory.join(name.replace(&process, "-4194305-"));
    let of_another_machine =
        directory.join(name.replace(&boot, ".translucid-0").replace(&process, "-4194305-"));
    fs::write(&of_another_machine, "half of it").unwrap();
    for words in COMMANDS {
        fs::write(&of_the_dead, "half of it").unwrap();
        stdout(&directory, words);
        let is_there = [&of_the_dead, &of_the_living, &of_another_machine].map(|path| path.exists());
        assert_eq!(is_there, [false, true, true], "{words}");
    }

    send(writer.id(), "-CONT");
    assert!(writer.wait().unwrap().success());
    assert!(directory.join("long.csv").exists() && !of_the_living.exists());
}
