//! Files that are either whole or not there.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::table_error::TableError;

/// Writes a file beside its target, then lets it take the target's place.
///
/// What stood at `path` stays as it was if anything fails, or if the process ends in between. A symbolic link
/// keeps pointing where it did, and the file that it points to is replaced.
///
/// # Errors
/// The file system refuses, or `write` fails.
pub(crate) fn write_whole(
    path: &Path,
    write: impl FnOnce(BufWriter<File>) -> io::Result<BufWriter<File>>,
) -> Result<(), TableError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let replaceable = fs::metadata(&target).map_or(true, |found| found.is_file());
    if !replaceable {
        let source = io::Error::other("it is not a regular file");
        return Err(TableError::Io { path: path.to_owned(), action: "replace", source });
    }
    let (mut draft, file) = Draft::create(&target).map_err(TableError::io(path, "create a file beside"))?;
    let written = write(BufWriter::with_capacity(1 << 16, file))
        .and_then(|buffer| buffer.into_inner().map_err(io::IntoInnerError::into_error))
        // Without this a power cut after the rename could leave a whole name on an empty file.
        .and_then(|file| file.sync_all());
    written.map_err(TableError::io(path, "write"))?;
    fs::rename(&draft.path, &target).map_err(TableError::io(path, "replace"))?;
    draft.renamed = true;
    Ok(())
}

/// A file on its way: removed when dropped, unless it has been renamed.
struct Draft {
    path: PathBuf,
    renamed: bool,
}

impl Draft {
    /// Creates a new file in the target's directory: a rename within one directory is atomic.
    fn create(target: &Path) -> io::Result<(Self, File)> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let path =
                target.with_file_name(format!(".translucid-table-{}-{number}.part", std::process::id()));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Self { path, renamed: false }, file)),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
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

    fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), TableError> {
        write_whole(path, |mut out| out.write_all(bytes).map(|()| out))
    }

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|incidence| incidence.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn whole_file_replaces_the_old_one() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("table.npz");
        for bytes in [&b"first"[..], b"second"] {
            write_bytes(&path, bytes).unwrap();
            assert_eq!(fs::read(&path).unwrap(), bytes);
        }
        assert_eq!(names(directory.path()), ["table.npz"]);
    }

    #[test]
    fn failure_keeps_what_was_there() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("table.npz");
        write_bytes(&path, b"first").unwrap();
        let error = write_whole(&path, |mut out| {
            out.write_all(&[0; 1 << 17])?;
            Err(io::Error::other("the disk is full"))
        });
        let error = error.unwrap_err().to_string();
        assert!(error.contains("cannot write") && error.contains("table.npz: the disk is full"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(names(directory.path()), ["table.npz"]);
    }

    #[test]
    fn targets_that_are_no_files_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        for path in [
            directory.path(),
            &directory.path().join("missing").join("table.npz"),
            Path::new("/"),
            Path::new(""),
        ] {
            assert!(write_bytes(path, b"x").is_err(), "{}", path.display());
        }
        if cfg!(unix) {
            assert!(write_bytes(Path::new("/dev/null"), b"x").unwrap_err().to_string().contains("regular"));
        }
        assert!(names(directory.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn link_keeps_pointing_where_it_did() {
        let directory = tempfile::tempdir().unwrap();
        let (real, link) = (directory.path().join("real"), directory.path().join("link"));
        fs::write(&real, b"old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_bytes(&link, b"new").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
    }
}
