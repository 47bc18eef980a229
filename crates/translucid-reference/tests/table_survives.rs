//! A process that is killed while it saves a table leaves the old file or the new one, whole.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use translucid_reference::walk::{Control, Layout, Parameters, Problem, WhiteTable};

/// Name of the environment variable that turns the test into the process that is killed.
const TARGET: &str = "TRANSLUCID_TEST_SAVE_UNTIL_KILLED";

fn table(photons: u64) -> WhiteTable {
    let layout = Layout::new(&[0.1, 0.3, 1.0, 3.0], 60).unwrap();
    let mut table = WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, 0.9).unwrap();
    table.run(1, photons, &Control::default()).unwrap();
    table
}

/// Saves two tables in turn, for ever.
fn save_until_killed(path: &Path) {
    let tables = [table(1000), table(2000)];
    for table in tables.iter().cycle() {
        table.save(path).unwrap();
    }
}

#[test]
fn killed_process_leaves_a_whole_file() {
    if let Some(path) = std::env::var_os(TARGET) {
        return save_until_killed(Path::new(&path));
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("table.npz");
    let tables = [table(1000), table(2000)];
    tables[0].save(&path).unwrap();
    for attempt in 0..20 {
        let before = entries(directory.path());
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "killed_process_leaves_a_whole_file"])
            .env(TARGET, &path)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        // Once it saves, kill it at different moments.
        let start = Instant::now();
        while entries(directory.path()) == before && start.elapsed() < Duration::from_secs(30) {
            std::thread::yield_now();
        }
        std::thread::sleep(Duration::from_micros(170) * attempt);
        child.kill().unwrap();
        child.wait().unwrap();
        let found = WhiteTable::load(&path).unwrap();
        assert!(tables.contains(&found), "{found:?}");
    }
    // Otherwise no process was killed while it wrote, and nothing was tested.
    assert!(entries(directory.path()) > 1);
}

/// Number of files in a directory: the table, and drafts of processes that were killed.
fn entries(directory: &Path) -> usize {
    std::fs::read_dir(directory).unwrap().count()
}
