//! Files that results are written to, and those that must not be written over.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use translucid_files::write_atomically;
use translucid_image::OutputError;

use crate::failure::Failure;
use crate::output_lock::OutputLock;

/// A file's name and content.
pub(crate) type NamedFile = (String, Vec<u8>);

/// A directory that results are written to, by one process at a time.
pub(crate) struct Directory {
    path: PathBuf,
    _lock: OutputLock,
}

impl Directory {
    /// Makes the directory, unless it is there.
    pub(crate) fn make(path: &Path) -> Result<Self, Failure> {
        match fs::create_dir_all(path) {
            Ok(()) => Ok(Self { path: path.to_owned(), _lock: OutputLock::take(path)? }),
            Err(error) => Err(refusal(path, format!("cannot make the directory: {error}"))),
        }
    }

    /// Makes the directory for some work, and takes it away again if the work fails before it has written anything.
    pub(crate) fn fill<T>(path: &Path, work: impl FnOnce(&Self) -> Result<T, Failure>) -> Result<T, Failure> {
        let is_new = !path.exists();
        let result = work(&Self::make(path)?);
        if is_new && result.is_err() {
            // Fails, as it should, where there is something already
            let _ = fs::remove_dir(path);
        }
        result
    }

    /// The directory.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// A file in it.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes files one after the other.
    pub(crate) fn write(&self, files: &[NamedFile]) -> Result<(), Failure> {
        files.iter().try_for_each(|(name, content)| write_file(&self.file(name), content))
    }
}

/// The refusal of a directory, for a file that is there or cannot be.
pub(crate) fn refusal(path: &Path, message: impl Into<String>) -> Failure {
    OutputError::new(path, message).with_help("name another directory with -o DIR").into()
}

/// Writes a file whose place was found to be writable before the work.
pub(crate) fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    write_atomically(path, |out| out.write_all(content)).map_err(Failure::late)
}

/// The first of some files that is one of the inputs, whatever paths both go by, or will be when both are there.
pub(crate) fn input_among<'a, 'b>(
    mut files: impl Iterator<Item = &'b Path>,
    inputs: impl Iterator<Item = &'a Path>,
) -> Option<&'b Path> {
    let inputs: Vec<PathBuf> = inputs.filter_map(place).collect();
    files.find(|path| place(path).is_some_and(|path| inputs.contains(&path)))
}

/// Where a file is, or would be, in a directory that is there.
fn place(path: &Path) -> Option<PathBuf> {
    let of_a_new_file = || {
        let directory =
            path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(directory).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(of_a_new_file)
}

/// Returns `true` if a file states at its start, where images keep their notes, that this program has made it.
pub(crate) fn is_own(path: &Path) -> bool {
    const NAME: &[u8] = b"translucid";
    start(path, 1 << 16).windows(NAME.len()).any(|bytes| bytes == NAME)
}

/// Returns `true` if a page states that this program has made it, with a title that begins so.
pub(crate) fn is_own_page(page: &Path, title: &str) -> bool {
    const GENERATOR: &str = "name=\"generator\" content=\"translucid\"";
    let start = start(page, 4096);
    let start = String::from_utf8_lossy(&start);
    start.contains(GENERATOR) && start.contains(&format!("<title>{title}"))
}

/// The first bytes of a file; none of one that cannot be read.
fn start(path: &Path, count: u64) -> Vec<u8> {
    let mut start = Vec::new();
    let read = fs::File::open(path).and_then(|file| file.take(count).read_to_end(&mut start));
    if read.is_ok() { start } else { Vec::new() }
}
