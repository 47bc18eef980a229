//! Archives of NumPy arrays: ZIP files with a member `NAME.npy` for every array, stored as they are.

use std::io::{self, BufWriter, Cursor, Read, Write};
use std::path::{Path, PathBuf};

use zip::read::{ArchiveOffset, Config, ZipFile};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use super::npy::{Header, write_header};
use super::table_error::TableError;

/// The bytes of an archive of arrays of numbers, each with its name and shape.
///
/// # Errors
/// An array has so many dimensions that its header is longer than 65535 bytes.
pub fn npz_of_numbers(arrays: &[(&str, &[usize], &[f64])]) -> io::Result<Vec<u8>> {
    let mut out = Writer::new();
    for (name, shape, numbers) in arrays {
        out.words(name, "<f8", shape, numbers.iter().map(|number| number.to_bits()))?;
    }
    out.finish()
}

/// An archive on its way. It is put together in memory, since what is written to may know no way back.
pub(crate) struct Writer(ZipWriter<Cursor<Vec<u8>>>);

impl Writer {
    pub(crate) fn new() -> Self {
        Self(ZipWriter::new(Cursor::default()))
    }

    /// Ends the archive and returns its bytes.
    pub(crate) fn finish(self) -> io::Result<Vec<u8>> {
        Ok(self.0.finish()?.into_inner())
    }

    /// Writes an array of eight-byte elements.
    pub(crate) fn words(
        &mut self,
        name: &str,
        descr: &str,
        shape: &[usize],
        words: impl IntoIterator<Item = u64>,
    ) -> io::Result<()> {
        self.begin(name, descr, shape)?;
        let mut buffer = BufWriter::with_capacity(1 << 15, &mut self.0);
        words.into_iter().try_for_each(|word| buffer.write_all(&word.to_le_bytes()))?;
        buffer.flush()
    }

    /// Writes a whole number.
    pub(crate) fn count(&mut self, name: &str, count: u64) -> io::Result<()> {
        self.words(name, "<u8", &[], [count])
    }

    /// Writes a number.
    pub(crate) fn number(&mut self, name: &str, number: f64) -> io::Result<()> {
        self.words(name, "<f8", &[], [number.to_bits()])
    }

    /// Writes a text in ASCII.
    pub(crate) fn text(&mut self, name: &str, text: &str) -> io::Result<()> {
        self.begin(name, &format!("|S{}", text.len()), &[])?;
        self.0.write_all(text.as_bytes())
    }

    fn begin(&mut self, name: &str, descr: &str, shape: &[usize]) -> io::Result<()> {
        // A fixed time: equal tables make equal bytes.
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::DEFAULT);
        self.0.start_file(format!("{name}.npy"), options)?;
        write_header(&mut self.0, descr, shape)
    }
}

/// An archive to be read.
pub(crate) struct Reader {
    path: PathBuf,
    archive: ZipArchive<Cursor<Vec<u8>>>,
}

impl Reader {
    /// Reads an archive of at most `longest` bytes that has no other members than the given ones. Errors call it by
    /// its path.
    ///
    /// # Errors
    /// It cannot be read, or is not such an archive.
    pub(crate) fn new(
        path: &Path,
        input: impl Read,
        longest: u64,
        members: &[&str],
    ) -> Result<Self, TableError> {
        let error = |problem| Err(TableError::File { path: path.to_owned(), member: String::new(), problem });
        let mut bytes = Vec::new();
        input.take(longest + 1).read_to_end(&mut bytes).map_err(TableError::unreadable(path))?;
        if bytes.len() as u64 > longest {
            return error(format!("has more than {longest} bytes, which are the most that are allowed"));
        }
        let config = Config { archive_offset: ArchiveOffset::Known(0) };
        let archive = match ZipArchive::with_config(config, Cursor::new(bytes)) {
            Ok(archive) => archive,
            Err(ZipError::Io(source)) => return Err(TableError::unreadable(path)(source)),
            Err(problem) => {
                return error(format!("is not an NPZ archive, or cut short or damaged ({problem})"));
            }
        };
        if archive.has_duplicate_names() {
            return error("has two members of one name".to_owned());
        }
        let known =
            |name: &[u8]| members.iter().any(|member| name.strip_suffix(b".npy") == Some(member.as_bytes()));
        if let Some(name) = archive.file_names_raw().find(|name| !known(name)) {
            return error(format!("has an unknown member {:?}", String::from_utf8_lossy(name)));
        }
        Ok(Self { path: path.to_owned(), archive })
    }

    /// Returns whether there is a member.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.archive.index_for_name(&format!("{name}.npy")).is_some()
    }

    /// Error that explains what is wrong with a member.
    pub(crate) fn error(&self, member: &str, problem: impl Into<String>) -> TableError {
        TableError::File { path: self.path.clone(), member: format!("{member}.npy"), problem: problem.into() }
    }

    /// Reads an array of eight-byte elements of a shape that `accept` accepts.
    pub(crate) fn words(
        &mut self,
        name: &str,
        descr: &str,
        accept: impl FnOnce(&[u64]) -> Result<(), String>,
    ) -> Result<Vec<u64>, TableError> {
        let size = |header: &Header| {
            if header.descr != descr {
                return Err(format!("has elements of type {:?}, but they must be {descr:?}", header.descr));
            }
            accept(&header.shape)?;
            let bytes = header.elements().and_then(|elements| elements.checked_mul(8));
            bytes.ok_or_else(|| format!("has the shape {:?}, which is too large", header.shape))
        };
        let bytes = self.read(name, size)?;
        Ok(bytes.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word)).collect())
    }

    /// Reads a whole number.
    pub(crate) fn count(&mut self, name: &str) -> Result<u64, TableError> {
        self.single(name, "<u8")
    }

    /// Reads a number.
    pub(crate) fn number(&mut self, name: &str) -> Result<f64, TableError> {
        self.single(name, "<f8").map(f64::from_bits)
    }

    fn single(&mut self, name: &str, descr: &str) -> Result<u64, TableError> {
        let words = self.words(name, descr, |shape| expect_shape(shape, &[]))?;
        Ok(words[0])
    }

    /// Reads a text that must be one of some.
    pub(crate) fn text(&mut self, name: &str, allowed: &[&'static str]) -> Result<&'static str, TableError> {
        let size = |header: &Header| {
            expect_shape(&header.shape, &[])?;
            let length = header.descr.strip_prefix("|S").and_then(|length| length.parse().ok());
            length.ok_or_else(|| format!("has the type {:?}, but must be \"|S\" and a length", header.descr))
        };
        let found = self.read(name, size)?;
        allowed.iter().copied().find(|text| text.as_bytes() == found).ok_or_else(|| {
            let found = String::from_utf8_lossy(&found);
            self.error(name, format!("is {found:?}, but must be one of {}", allowed.join(", ")))
        })
    }

    /// Reads the data of a member; `size` computes its number of bytes from its header.
    fn read(
        &mut self,
        name: &str,
        size: impl FnOnce(&Header) -> Result<u64, String>,
    ) -> Result<Vec<u8>, TableError> {
        let found = match self.archive.by_name(&format!("{name}.npy")) {
            Ok(mut file) => read_member(&mut file, size),
            Err(ZipError::FileNotFound) => Err("is missing".to_owned()),
            Err(error) => Err(format!("cannot be read: {error}")),
        };
        found.map_err(|problem| self.error(name, problem))
    }
}

fn read_member<R: Read>(
    file: &mut ZipFile<'_, R>,
    size: impl FnOnce(&Header) -> Result<u64, String>,
) -> Result<Vec<u8>, String> {
    // A stored member is no longer than the archive, whatever its directory says
    if file.compression() != CompressionMethod::Stored || file.compressed_size() != file.size() {
        return Err("is compressed, but must be stored".to_owned());
    }
    let header = Header::read(file)?;
    let bytes = size(&header)?;
    let mut data = Vec::new();
    file.read_to_end(&mut data).map_err(|error| format!("is cut short or damaged ({error})"))?;
    let found = data.len() as u64;
    if found != bytes {
        return Err(format!("has {found} bytes of data, but its shape {:?} asks for {bytes}", header.shape));
    }
    Ok(data)
}

/// Demands a shape.
pub(crate) fn expect_shape(found: &[u64], expected: &[u64]) -> Result<(), String> {
    if found == expected {
        return Ok(());
    }
    Err(format!("has the shape {found:?}, but must have {expected:?}"))
}
