//! Files that are either whole or not there.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::OutputError;

/// Writes a file through `write`, beside its target first; then the new file takes the target's place.
///
/// What stood at `path` stays as it was if anything fails. A symbolic link keeps pointing where it did,
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
    drop(file);
    fs::rename(&draft.path, &target).map_err(failed)?;
    draft.renamed = true;
    Ok(())
}

/// Finds out whether [`write_atomically`] would get as far as writing, so that hours of work do not end
/// at a directory that is not there. Leaves nothing behind.
///
/// # Errors
/// The directory does not exist, is no directory or admits no new file, or the target is itself a
/// directory or write-protected.
pub fn check_writable(path: &Path) -> Result<(), OutputError> {
    let target = checked_target(path)?;
    Draft::create(&target).map(drop).map_err(|error| cannot_create(path, &error))
}

/// The file that a path names, links followed, if it may be replaced.
fn checked_target(path: &Path) -> Result<PathBuf, OutputError> {
    if path.file_name().is_none() {
        return Err(OutputError::new(path, "does not name a file"));
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
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            // The name does not grow with the target's, which may already be as long as names may be.
            let name = format!(".translucid-{}-{number}.part", std::process::id());
            let path = directory_of(target).join(name);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok(Self { path, file: Some(file), renamed: false }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }
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
