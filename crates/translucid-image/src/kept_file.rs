//! Files in which a program keeps its own data from one run to the next.
//!
//! ```text
//! offset  bytes  content (little endian)
//!      0      8  magic
//!      8      4  format version, u32
//!     12      8  fingerprint of what the data belongs to, u64
//!     20      …  the data, whose first numbers say how long it is
//!    end      4  CRC-32 of everything before, u32
//! ```

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use bytemuck::{Pod, bytes_of_mut, cast_slice_mut};
use translucid_files::write_atomically;

use crate::OutputError;

/// A format of such files.
///
/// Numbers are written as the processor has them; where that is not little endian, the version is another one.
#[derive(Clone, Copy, Debug)]
pub struct KeptFile {
    /// The first bytes of every file.
    pub magic: [u8; 8],
    /// Number of the format's version.
    pub version: u32,
    /// Word for a file, for messages: "file of points".
    pub name: &'static str,
    /// Words for the way without it: "render from the start".
    pub anew: &'static str,
}

/// Bytes of magic, version and fingerprint.
const HEADER_BYTES: u64 = 20;
/// Bytes of the checksum.
const CRC_BYTES: u64 = 4;

impl KeptFile {
    /// Writes a file whose data `write` writes.
    ///
    /// # Errors
    /// As [`write_atomically`]: an older file at `path` is then still whole.
    pub fn save(
        &self,
        path: &Path,
        fingerprint: u64,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), OutputError> {
        write_atomically(path, |out| {
            let mut out = Checksummed { inner: out, crc: crc32fast::Hasher::new() };
            out.write_all(&self.magic)?;
            out.write_all(&self.version.to_ne_bytes())?;
            out.write_all(&fingerprint.to_ne_bytes())?;
            write(&mut out)?;
            out.inner.write_all(&out.crc.finalize().to_ne_bytes())
        })
    }

    /// Whether a file begins as those of this format do, whatever their version.
    pub fn is_at(&self, path: &Path) -> bool {
        let mut magic = [0; 8];
        File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == self.magic
    }

    /// Reads a file back, if it belongs to what has this fingerprint; `read` reads its data.
    ///
    /// # Errors
    /// The file cannot be read, is of another kind or version, is cut short or [`damaged`], or belongs to something else.
    pub fn load<T>(
        &self,
        path: &Path,
        fingerprint: u64,
        read: impl FnOnce(&mut KeptData<'_>) -> io::Result<T>,
    ) -> Result<T, OutputError> {
        let open = || -> io::Result<(File, u64)> {
            let file = File::open(path)?;
            let length = file.metadata()?.len();
            Ok((file, length))
        };
        let (file, length) = open().map_err(|error| self.failure(path, &error))?;
        self.parse(path, BufReader::with_capacity(1 << 16, file), length, fingerprint, read)
    }

    /// Reads what [`load`](Self::load) does from anything of a known length; errors name the path.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse<T>(
        &self,
        path: &Path,
        mut reader: impl Read,
        length: u64,
        fingerprint: u64,
        read: impl FnOnce(&mut KeptData<'_>) -> io::Result<T>,
    ) -> Result<T, OutputError> {
        let Self { name, anew, .. } = self;
        let failed = |error: io::Error| self.failure(path, &error);
        if length < HEADER_BYTES + CRC_BYTES {
            return Err(failed(damaged(&format!("it ends after {length} bytes"))));
        }
        let inner: &mut dyn Read = &mut reader;
        let mut data = KeptData { file: Checksummed { inner, crc: crc32fast::Hasher::new() }, length };
        if data.read::<[u8; 8]>().map_err(failed)? != self.magic {
            return Err(
                OutputError::new(path, format!("is no {name}")).with_help(format!("move it away to {anew}"))
            );
        }
        if data.read::<u32>().map_err(failed)? != self.version {
            return Err(OutputError::new(path, format!("is a {name} of another version of translucid"))
                .with_help(format!("go on with that version, or delete the file to {anew}")));
        }
        let found = u64::from_ne_bytes(data.read().map_err(failed)?);
        let content = read(&mut data).map_err(failed)?;
        let crc = data.file.crc.clone().finalize();
        if data.read::<u32>().map_err(failed)? != crc {
            return Err(failed(damaged("its checksum does not fit its content")));
        }
        if found != fingerprint {
            return Err(OutputError::new(path, format!("is a {name} of another scene or other settings"))
                .with_help(format!("use the settings that it was made with, or delete it to {anew}")));
        }
        Ok(content)
    }

    fn failure(&self, path: &Path, error: &io::Error) -> OutputError {
        let Self { name, anew, .. } = self;
        if error.kind() == io::ErrorKind::InvalidData {
            OutputError::new(path, format!("the {name} is damaged: {error}"))
                .with_help(format!("delete it to {anew}"))
        } else {
            OutputError::new(path, format!("cannot read the {name}: {error}"))
                .with_help(format!("see that it is there and may be read, or move it away to {anew}"))
        }
    }
}

/// The error of data that cannot be right, with words on what is wrong.
pub fn damaged(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// The data of a kept file, read number by number.
pub struct KeptData<'a> {
    file: Checksummed<&'a mut dyn Read>,
    /// Length of the whole file.
    length: u64,
}

impl KeptData<'_> {
    /// Refuses a file that does not hold so many bytes of data.
    ///
    /// To be called before memory is taken for them: a file cannot ask for more than it holds.
    ///
    /// # Errors
    /// The file is longer or shorter.
    pub fn require_length(&self, bytes: u64) -> io::Result<()> {
        let expected = (HEADER_BYTES + CRC_BYTES).saturating_add(bytes);
        if self.length == expected {
            return Ok(());
        }
        Err(damaged(&format!("it has {} bytes instead of {expected}", self.length)))
    }

    /// Reads a value.
    ///
    /// # Errors
    /// The file cannot be read, or ends.
    pub fn read<T: Pod>(&mut self) -> io::Result<T> {
        let mut value = T::zeroed();
        self.file.read_exact(bytes_of_mut(&mut value))?;
        Ok(value)
    }

    /// Reads as many values as there is room for.
    ///
    /// # Errors
    /// The file cannot be read, or ends.
    pub fn fill<T: Pod>(&mut self, values: &mut [T]) -> io::Result<()> {
        self.file.read_exact(cast_slice_mut(values))
    }
}

/// A reader or writer with the CRC-32 of all bytes that have passed.
struct Checksummed<T> {
    inner: T,
    crc: crc32fast::Hasher,
}

impl<T: Read> Read for Checksummed<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.crc.update(&buffer[..count]);
        Ok(count)
    }
}

impl<T: Write> Write for Checksummed<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.crc.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const NOTES: KeptFile =
        KeptFile { magic: *b"NOTES!!\n", version: 1, name: "page of notes", anew: "take them anew" };
    const FINGERPRINT: u64 = 0x1234_5678_9abc_def0;

    fn read(data: &mut KeptData<'_>) -> io::Result<Vec<f64>> {
        let count: u32 = data.read()?;
        data.require_length(4 + 8 * u64::from(count))?;
        let mut notes = vec![0.0; count as usize];
        data.fill(&mut notes)?;
        Ok(notes)
    }

    fn parsed(bytes: &[u8]) -> Result<Vec<f64>, OutputError> {
        NOTES.parse(Path::new("a.notes"), bytes, bytes.len() as u64, FINGERPRINT, read)
    }

    fn saved() -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.notes");
        let notes = [0.5, f64::MIN_POSITIVE / 8.0, -0.0];
        let write = |out: &mut dyn Write| {
            out.write_all(&3_u32.to_le_bytes())?;
            notes.iter().try_for_each(|note| out.write_all(&note.to_le_bytes()))
        };
        NOTES.save(&path, FINGERPRINT, write).unwrap();
        let loaded = NOTES.load(&path, FINGERPRINT, read).unwrap();
        assert_eq!(loaded.iter().map(|n| n.to_bits()).collect::<Vec<_>>(), notes.map(f64::to_bits));
        let error = NOTES.load(&path, FINGERPRINT + 1, read).unwrap_err();
        assert!(error.message.contains("another scene") && error.help.is_some(), "{error}");
        let error = NOTES.load(&directory.path().join("b.notes"), 0, read).unwrap_err();
        assert!(error.to_string().contains("b.notes"), "{error}");
        fs::read(&path).unwrap()
    }

    #[test]
    fn parse_refuses_every_truncation_addition_and_flipped_bit() {
        let bytes = saved();
        for length in 0..bytes.len() {
            let error = parsed(&bytes[..length]).unwrap_err();
            assert!(error.to_string().contains("a.notes") && error.help.is_some(), "{error}");
        }
        assert!(parsed(&[&bytes[..], b"x"].concat()).is_err());
        for bit in 0..bytes.len() * 8 {
            let mut bytes = bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            let error = parsed(&bytes).unwrap_err();
            assert!(error.help.is_some(), "bit {bit}: {error}");
        }
    }

    #[test]
    fn parse_refuses_random_damage() {
        // Damage passes the checksum with probability 2⁻³²; the seed is fixed.
        let bytes = saved();
        let mut state = 1_u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize
        };
        for _ in 0..2000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + next() % 16 {
                let at = next() % damaged.len();
                damaged[at] = next() as u8;
            }
            if damaged != bytes {
                assert!(parsed(&damaged).is_err());
            }
        }
    }

    #[test]
    fn parse_tells_another_version_and_another_kind() {
        let mut bytes = saved();
        bytes[8] = 2;
        assert!(parsed(&bytes).unwrap_err().message.contains("another version"));
        assert!(parsed(&[b'x'; 200]).unwrap_err().message.contains("no page of notes"));
    }
}
