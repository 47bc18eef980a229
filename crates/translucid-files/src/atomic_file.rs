//! Files that are either whole or not there.
//!
//! A file is written as a draft beside its target, which it then replaces by its name. A process that is killed
//! leaves its draft behind; the next one of the same system that writes into the directory takes it away. A draft names
//! the system and the process that write it, so that only who can see that this process has ended removes it. Locks do not
//! tell that: on many shared disks each machine sees its own only (NFS with `nolock` or `local_lock`, Lustre with
//! `localflock`).
//!
//! Crates for temporary files (`tempfile`, `atomic-write-file`) would do for the 40 lines of [`Draft`], but know neither
//! such writers nor the checks of a target, and make files that only their owner may read.

use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use crate::OutputError;

/// Writes a file through `write`, beside its target first; then the new file takes the target's place.
///
/// An older file at `path` stays as it was if anything fails. A symbolic link keeps pointing where it did,
/// and the file that it points to is replaced.
///
/// # Errors
/// As [`check_writable`], or the writing itself fails (a full disk, say).
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let target = checked_target(path)?;
    let mut draft = Draft::create(&target).map_err(|error| cannot_create(path, &error))?;
    let failed = |error: io::Error| OutputError::new(path, format!("cannot write the file: {error}"));
    let file = draft.file.take().ok_or_else(|| failed(io::Error::other("the draft is gone")))?;
    let mut buffer = BufWriter::with_capacity(1 << 16, file);
    write(&mut buffer).map_err(failed)?;
    let file = buffer.into_inner().map_err(|error| failed(error.into_error()))?;
    // Without this a power cut after the rename could leave a whole name on an empty file.
    file.sync_all().map_err(failed)?;
    fs::rename(&draft.path, &target).map_err(failed)?;
    draft.renamed = true;
    Ok(())
}

/// Finds out whether [`write_atomically`] would get as far as writing, so that hours of work do not end
/// at a directory that is not there. Leaves nothing behind, and takes away what killed processes have left.
///
/// # Errors
/// The directory does not exist, is no directory or admits no new file, or the target is itself a
/// directory or write-protected.
pub fn check_writable(path: &Path) -> Result<(), OutputError> {
    let target = checked_target(path)?;
    let draft = Draft::create(&target).map_err(|error| cannot_create(path, &error))?;
    remove_abandoned_drafts(&draft);
    Ok(())
}

/// The file that a path names, links followed, if it may be replaced.
fn checked_target(path: &Path) -> Result<PathBuf, OutputError> {
    if path.file_name().is_none() {
        return Err(OutputError::new(path, "does not name a file"));
    }
    if path == Path::new("-") {
        let help = "leave it out to print what can be printed, or name a file, such as ./-";
        return Err(OutputError::new(path, "stands for no file here").with_help(help));
    }
    if is_of_the_system(path) {
        return Err(OutputError::new(path, "is not a regular file"));
    }
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let directory = directory_of(&target);
    match fs::metadata(directory) {
        Err(error) => {
            let message = format!("cannot write into the directory `{}`: {error}", directory.display());
            return Err(OutputError::new(path, message).with_help("create the directory first"));
        }
        Ok(found) if !found.is_dir() => {
            let message = format!("`{}` is not a directory", directory.display());
            return Err(OutputError::new(path, message));
        }
        Ok(_) => {}
    }
    match fs::metadata(&target) {
        Ok(found) if found.is_dir() => Err(OutputError::new(path, "is a directory, not a file")),
        Ok(found) if !found.is_file() => Err(OutputError::new(path, "is not a regular file")),
        Ok(found) if found.permissions().readonly() => Err(OutputError::new(path, "is write-protected")),
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(OutputError::new(path, format!("cannot be written: {error}")))
        }
        _ => Ok(target),
    }
}

/// Whether a path leads into /dev or /proc: /dev/stdout, say, may be a link to a regular file that other
/// programs are writing at the same time, and a new file in its place would take that from them.
fn is_of_the_system(path: &Path) -> bool {
    cfg!(unix)
        && std::path::absolute(path).is_ok_and(|path| path.starts_with("/dev") || path.starts_with("/proc"))
}

/// The directory that holds a file.
fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn cannot_create(path: &Path, error: &io::Error) -> OutputError {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let message =
        format!("cannot create a file in the directory `{}`: {error}", directory_of(&target).display());
    OutputError::new(path, message)
}

/// Beginning and end of the name of every draft.
const DRAFT_NAME: [&str; 2] = [".translucid-", ".part"];

/// Time after which a draft that nobody has written to is abandoned, whoever wrote it: writers that stop for longer are
/// those of machines that are gone.
const LONGEST_PAUSE: Duration = Duration::from_secs(7 * 24 * 3600);

/// A file on its way: removed when dropped, unless it has been renamed.
struct Draft {
    path: PathBuf,
    file: Option<File>,
    renamed: bool,
}

impl Draft {
    /// Creates a new file in the target's directory: a rename within one directory is atomic.
    fn create(target: &Path) -> io::Result<Self> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let system = system().unwrap_or_else(|| String::from("unknown"));
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            // The name does not grow with the target's, which may already be as long as names may be.
            let [begin, end] = DRAFT_NAME;
            let name = format!("{begin}{system}-{}-{number}{end}", std::process::id());
            let path = directory_of(target).join(name);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok(Self { path, file: Some(file), renamed: false }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }
}

/// The start of the system's kernel and the name space of its process numbers: within both a number is one process.
///
/// It is unknown where Linux's `/proc` does not tell, or tells of another name space.
fn system() -> Option<String> {
    let own = fs::read_link("/proc/self").ok()?;
    if own.to_str()? != std::process::id().to_string() {
        return None;
    }
    let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
    let space = fs::read_link("/proc/self/ns/pid").ok()?;
    let hexadecimal = |text: &str| text.chars().filter(char::is_ascii_hexdigit).collect::<String>();
    // pid:[4026531836]
    let space: String = space.to_str()?.chars().filter(char::is_ascii_digit).collect();
    Some(format!("{}.{space}", hexadecimal(&boot)))
}

/// Removes the drafts beside a new one whose writers have ended. What cannot be read or removed stays.
fn remove_abandoned_drafts(new: &Draft) {
    let Ok(own) = fs::metadata(&new.path) else { return };
    let system = system();
    let Ok(entries) = fs::read_dir(directory_of(&new.path)) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let Some((writer_system, process)) = writer(&name) else { continue };
        let Ok(found) = entry.metadata() else { continue };
        let has_ended = system.as_deref() == Some(writer_system) && are_of_one_user(&own, &found) && {
            // Whatever else the answer is, the process may be there
            matches!(Path::new(&format!("/proc/{process}")).try_exists(), Ok(false))
        };
        if found.is_file() && (has_ended || is_past(&found, &own)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether nothing has been written to a file for long before another one came to be, by the clock of their disk.
fn is_past(found: &Metadata, new: &Metadata) -> bool {
    let times = new.modified().ok().zip(found.modified().ok());
    times.and_then(|(now, then)| now.duration_since(then).ok()).is_some_and(|pause| pause > LONGEST_PAUSE)
}

/// Whether files belong to the same user: processes of others may be hidden (`hidepid`, proc(5)).
#[cfg(unix)]
fn are_of_one_user(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    a.uid() == b.uid()
}

#[cfg(not(unix))]
fn are_of_one_user(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// The system and the process that write a draft, if a file is named as [`Draft::create`] names them.
fn writer(name: &OsStr) -> Option<(&str, u32)> {
    let [begin, end] = DRAFT_NAME;
    let (rest, number) = name.to_str()?.strip_prefix(begin)?.strip_suffix(end)?.rsplit_once('-')?;
    let (system, process) = rest.rsplit_once('-')?;
    number.parse::<u32>().ok()?;
    Some((system, process.parse().ok()?))
}

impl Drop for Draft {
    fn drop(&mut self) {
        drop(self.file.take());
        if !self.renamed {
            // Nothing more can be done about a draft that does not go away.
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
        write_atomically(path, |out| out.write_all(bytes))
    }

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn write_replaces_the_target_and_leaves_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.bin");
        write_bytes(&path, b"first").unwrap();
        write_bytes(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(directory.path()), ["picture.bin"]);
    }

    #[test]
    fn write_that_fails_keeps_what_was_there() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.bin");
        write_bytes(&path, b"first").unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(b"half of it")?;
            Err(io::Error::other("the disk is full"))
        })
        .unwrap_err();
        assert!(error.to_string().contains("picture.bin") && error.to_string().contains("disk is full"));
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(names(directory.path()), ["picture.bin"]);
    }

    #[test]
    fn dash_is_no_file() {
        for check in [check_writable(Path::new("-")), write_bytes(Path::new("-"), b"")] {
            assert!(check.unwrap_err().to_string().contains("stands for no file here"));
        }
        assert!(!Path::new("-").exists());
    }

    #[test]
    fn check_names_the_directory_that_is_missing() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("missing").join("picture.exr");
        let error = check_writable(&path).unwrap_err();
        assert!(error.to_string().contains("missing"), "{error}");
        assert!(error.help.is_some());
    }

    #[test]
    fn check_refuses_a_directory_and_a_file_as_directory() {
        let directory = tempfile::tempdir().unwrap();
        assert!(check_writable(directory.path()).unwrap_err().message.contains("is a directory"));
        let file = directory.path().join("file");
        fs::write(&file, b"x").unwrap();
        assert!(check_writable(&file.join("picture.exr")).is_err());
        assert!(check_writable(Path::new("/")).is_err());
        assert!(check_writable(Path::new("")).is_err());
    }

    #[test]
    fn check_refuses_names_that_are_too_long() {
        let directory = tempfile::tempdir().unwrap();
        let error = check_writable(&directory.path().join("x".repeat(300))).unwrap_err();
        assert!(error.message.starts_with("cannot be written"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn check_refuses_devices_even_where_they_lead_to_a_file() {
        for path in ["/dev/stdout", "/dev/null", "/proc/self/fd/1"] {
            let error = check_writable(Path::new(path)).unwrap_err();
            assert_eq!(error.message, "is not a regular file", "{path}");
        }
    }

    #[test]
    fn check_leaves_no_trace() {
        let directory = tempfile::tempdir().unwrap();
        check_writable(&directory.path().join("picture.exr")).unwrap();
        assert!(names(directory.path()).is_empty());
    }

    /// No draft here is locked: what other machines lock looks the same.
    #[cfg(target_os = "linux")]
    #[test]
    fn check_removes_drafts_of_ended_writers_only() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        let own = system().unwrap();
        let (boot, space) = own.split_once('.').unwrap();
        let this = std::process::id();
        let after_the_last = 4_194_305;
        let ended = format!(".translucid-{own}-{after_the_last}-7.part");
        let kept = [
            format!(".translucid-{own}-{this}-4000000000.part"),
            format!(".translucid-{own}-1-7.part"),
            format!(".translucid-{own}0-{after_the_last}-7.part"),
            format!(".translucid-0{boot}.{space}-{after_the_last}-7.part"),
            format!(".translucid-unknown-{after_the_last}-7.part"),
            format!(".translucid-{own}-{after_the_last}-7.part.txt"),
            format!(".translucid-{own}-{after_the_last}-x.part"),
            format!(".translucid-{own}-x-7.part"),
            format!(".translucid-{after_the_last}-7.part"),
        ];
        for name in kept.iter().chain([&ended]) {
            fs::write(path(name), b"half of a pict").unwrap();
        }
        fs::create_dir(path(&format!(".translucid-{own}-{after_the_last}-9.part"))).unwrap();
        let draft = Draft::create(&path("other.exr")).unwrap();

        check_writable(&path("picture.exr")).unwrap();
        assert!(!path(&ended).exists());
        assert!(draft.path.exists());
        assert!(kept.iter().all(|name| path(name).exists()), "{:?}", names(directory.path()));
    }

    #[test]
    fn check_removes_drafts_that_nobody_goes_on_with() {
        let directory = tempfile::tempdir().unwrap();
        let day = Duration::from_secs(24 * 3600);
        for (days, is_kept) in [(0, true), (6, true), (8, false)] {
            let path = directory.path().join(format!(".translucid-a.1-2-{days}.part"));
            let file = File::create(&path).unwrap();
            file.set_modified(file.metadata().unwrap().modified().unwrap() - days * day).unwrap();
            check_writable(&directory.path().join("picture.exr")).unwrap();
            assert_eq!(path.exists(), is_kept, "{days} days");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn writer_reads_what_draft_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let draft = Draft::create(&directory.path().join("picture.exr")).unwrap();
        let name = draft.path.file_name().unwrap();
        assert_eq!(writer(name), Some((system().unwrap().as_str(), std::process::id())));
    }

    /// Drafts that are created while others look for abandoned ones get where they should.
    #[test]
    fn check_takes_no_draft_from_its_writer() {
        let directory = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for writer in 0..4 {
                let path = directory.path().join(format!("{writer}.exr"));
                scope.spawn(move || {
                    for round in 0..50_u8 {
                        check_writable(&path).unwrap();
                        write_bytes(&path, &[round]).unwrap();
                        assert_eq!(fs::read(&path).unwrap(), [round]);
                    }
                });
            }
        });
        assert_eq!(names(directory.path()).len(), 4);
    }

    #[test]
    fn check_respects_write_protection() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.exr");
        fs::write(&path, b"precious").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert!(check_writable(&path).unwrap_err().message.contains("write-protected"));
        assert!(write_bytes(&path, b"new").is_err());
        assert_eq!(fs::read(&path).unwrap(), b"precious");
    }

    #[cfg(unix)]
    #[test]
    fn write_follows_a_link() {
        let directory = tempfile::tempdir().unwrap();
        let (real, link) = (directory.path().join("real"), directory.path().join("link"));
        fs::write(&real, b"old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_bytes(&link, b"new").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
    }
}
