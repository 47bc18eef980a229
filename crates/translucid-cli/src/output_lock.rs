//! One process at a time for an output: what two wrote by turns would be neither's.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::failure::Failure;
use crate::{command_line, interrupt, messages};

/// Numbers the locks of this process: each file has a content of its own.
static NUMBER: AtomicU32 = AtomicU32::new(0);

/// Milliseconds that another process may go on writing an output before the command gives up.
static PATIENCE: AtomicU64 = AtomicU64::new(0);

/// Time between two attempts to take an output that another process has.
const BETWEEN_ATTEMPTS: Duration = Duration::from_millis(50);

/// From now on outputs of other processes are waited for this long.
pub(crate) fn set_patience(patience: Duration) {
    PATIENCE.store(u64::try_from(patience.as_millis()).unwrap_or(u64::MAX), Ordering::Relaxed);
}

/// A locked file at an output, gone when dropped. The lock ends with the process, however that ends; a file that a
/// killed process leaves behind is taken over by the next one for the same output.
#[derive(Debug)]
pub(crate) struct OutputLock {
    path: PathBuf,
    /// The file while it is locked; none where files cannot be locked, which stops nobody.
    file: Option<File>,
}

impl OutputLock {
    /// Takes an output, whose directory is there, and waits for it as long as was asked for.
    ///
    /// # Errors
    /// Another process has it; the message says which. Or the wait was interrupted.
    pub(crate) fn take(output: &Path) -> Result<Self, Failure> {
        let path = lock_file(output);
        let unlocked = Self { path: path.clone(), file: None };
        let patience = Duration::from_millis(PATIENCE.load(Ordering::Relaxed));
        let (start, mut is_told) = (Instant::now(), false);
        loop {
            let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            // A directory that admits no new file has been found out before
            let Ok(mut file) = open else { return Ok(unlocked) };
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let message = format!("{} is being written by {}", output.display(), holder(&path));
                    if start.elapsed() >= patience {
                        let help = "wait for it with --wait SECONDS, or write elsewhere with -o";
                        return Err(Failure::held(message).with_help(help));
                    }
                    if interrupt::STOP.load(Ordering::Relaxed) {
                        return Err(Failure::interrupted(message));
                    }
                    if !std::mem::replace(&mut is_told, true) {
                        messages::line(&format!("waiting: {message}"));
                    }
                    thread::sleep(BETWEEN_ATTEMPTS);
                    continue;
                }
                Err(TryLockError::Error(_)) => return Ok(unlocked),
            }
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let holder = format!("process {} ({})\n{number}\n", std::process::id(), command_line::shown());
            if file.set_len(0).and_then(|()| file.write_all(holder.as_bytes())).is_err() {
                return Ok(Self { path, file: Some(file) });
            }
            // Its last holder may have removed the file between the opening and the lock. Where a locked file cannot be
            // read, it cannot be removed either.
            match fs::read_to_string(&path) {
                Ok(found) if found != holder => {}
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
                _ => return Ok(Self { path, file: Some(file) }),
            }
        }
    }
}

impl Drop for OutputLock {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            // Still locked when it goes: nobody else can have it by then
            let _ = fs::remove_file(&self.path);
            drop(file);
        }
    }
}

/// The file that stands for an output: in a directory, beside a file.
fn lock_file(output: &Path) -> PathBuf {
    if output.is_dir() {
        return output.join(".translucid.lock");
    }
    let output = fs::canonicalize(output).unwrap_or_else(|_| output.to_owned());
    let mut name = std::ffi::OsString::from(".");
    name.push(output.file_name().unwrap_or_default());
    name.push(".lock");
    output.with_file_name(name)
}

/// Who has written a lock's file.
fn holder(lock: &Path) -> String {
    let found = fs::read_to_string(lock).unwrap_or_default();
    found.lines().next().unwrap_or("another process").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_is_one_at_a_time() {
        let directory = tempfile::tempdir().unwrap();
        let output = directory.path().join("a.png");
        // Left by a process that was killed
        fs::write(lock_file(&output), "process 1").unwrap();
        let lock = OutputLock::take(&output).unwrap();
        let message = OutputLock::take(&output).unwrap_err().message;
        assert!(message.contains(&format!("process {}", std::process::id())), "{message}");
        let other = OutputLock::take(&directory.path().join("b.png")).unwrap();
        drop((lock, other));
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
        OutputLock::take(&output).unwrap();
    }

    #[test]
    fn output_goes_from_one_to_the_next() {
        let directory = tempfile::tempdir().unwrap();
        let output = directory.path().join("a.png");
        let holders = AtomicU32::new(0);
        let taken = AtomicU32::new(0);
        thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..500 {
                        let Ok(lock) = OutputLock::take(&output) else { continue };
                        assert_eq!(holders.fetch_add(1, Ordering::SeqCst), 0);
                        taken.fetch_add(1, Ordering::SeqCst);
                        holders.fetch_sub(1, Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
        assert!(taken.into_inner() > 10);
    }
}
