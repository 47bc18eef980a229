//! Checkpoints: a film's sums in a file, bit by bit, so that a rendering can go on where it stopped.
//!
//! ```text
//! offset  bytes  content (little endian)
//!      0      8  magic "TRLCKPT\n"
//!      8      4  format version, u32
//!     12      8  fingerprint of scene and settings, u64
//!     20      8  seed, u64
//!     28      8  seconds spent so far, f64
//!     36     16  width, height, tile size, sums per pixel, u32 each
//!     52      …  per tile: samples, u32, then the sums of its pixels, f64
//!    end      4  CRC-32 of everything before, u32
//! ```

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use translucid_image::{Checksummed, OutputError, write_atomically};

use super::film::{FilmSums, TILE_SIZE};
use crate::world::layer;

const MAGIC: [u8; 8] = *b"TRLCKPT\n";
const VERSION: u32 = 1;
const HEADER_BYTES: u64 = 52;
/// Largest edge of an image, as `translucid_scene::Film` has it.
const MAX_EDGE: u32 = 16384;

/// What a checkpoint says besides the sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckpointInfo {
    /// A number that differs when scene or settings do.
    pub fingerprint: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Time spent rendering so far, in seconds.
    pub elapsed_seconds: f64,
}

/// Writes a film's sums so that [`load_checkpoint`] gives back the same bits.
///
/// # Errors
/// The file cannot be written; an older checkpoint at `path` is then still whole.
pub fn save_checkpoint(path: &Path, film: &FilmSums, info: &CheckpointInfo) -> Result<(), OutputError> {
    write_atomically(path, |out| {
        let mut out = Checksummed::new(out);
        out.write_all(&header(film, info))?;
        for tile in &film.tiles {
            out.write_all(&tile.samples.to_le_bytes())?;
            for pixel in &tile.pixels {
                // One array a pixel: a call per number would take most of the time.
                let mut bytes = [0; layer::COUNT * 8];
                for (bytes, sum) in bytes.as_chunks_mut().0.iter_mut().zip(pixel) {
                    *bytes = sum.to_le_bytes();
                }
                out.write_all(&bytes)?;
            }
        }
        let (crc, out) = out.finish();
        out.write_all(&crc.to_le_bytes())
    })
}

/// Reads a checkpoint back, if it belongs to the scene and settings with this fingerprint.
///
/// # Errors
/// The file cannot be read, is no checkpoint, is cut short or damaged, or belongs to another rendering.
pub fn load_checkpoint(
    path: &Path,
    expected_fingerprint: u64,
) -> Result<(FilmSums, CheckpointInfo), OutputError> {
    let open = || -> io::Result<(File, u64)> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        Ok((file, length))
    };
    let (file, length) = open().map_err(|error| unreadable(path, &error))?;
    parse(path, BufReader::with_capacity(1 << 16, file), length, expected_fingerprint)
}

fn unreadable(path: &Path, error: &io::Error) -> OutputError {
    OutputError::new(path, format!("cannot read the checkpoint: {error}"))
        .with_help("see that it is there and may be read, or move it away to render from the start")
}

/// Reads a checkpoint of a known length.
fn parse(
    path: &Path,
    reader: impl Read,
    length: u64,
    expected_fingerprint: u64,
) -> Result<(FilmSums, CheckpointInfo), OutputError> {
    let unreadable = |error: io::Error| unreadable(path, &error);
    let damaged = |what: &str| {
        OutputError::new(path, format!("the checkpoint is damaged: {what}"))
            .with_help("delete it to render from the start")
    };
    let mut file = Checksummed::new(reader);

    // Read and judge the header
    if length < HEADER_BYTES + 4 {
        return Err(damaged(&format!("it ends after {length} bytes")));
    }
    let mut bytes = [0; HEADER_BYTES as usize];
    file.read_exact(&mut bytes).map_err(unreadable)?;
    let header = Header::parse(&bytes);
    if header.magic != MAGIC {
        return Err(OutputError::new(path, "is not a translucid checkpoint")
            .with_help("move it away to render from the start"));
    }
    if header.version != VERSION || header.tile_size != TILE_SIZE || header.layers as usize != layer::COUNT {
        return Err(OutputError::new(path, "the checkpoint was written by another version of translucid")
            .with_help("go on with that version, or delete the checkpoint to render from the start"));
    }
    let edges = 1..=MAX_EDGE;
    if !edges.contains(&header.width) || !edges.contains(&header.height) {
        return Err(damaged(&format!("it claims {}x{} pixels", header.width, header.height)));
    }
    // The length is compared before anything is allocated: a file cannot ask for more than it holds.
    let expected = file_bytes(header.width, header.height);
    if length != expected {
        return Err(damaged(&format!("it has {length} bytes instead of {expected}")));
    }

    // Read the sums
    let film = read_film(&mut file, header.width, header.height).map_err(unreadable)?;
    let (crc, mut file) = file.finish();
    let mut stored = [0; 4];
    file.read_exact(&mut stored).map_err(unreadable)?;
    if crc != u32::from_le_bytes(stored) {
        return Err(damaged("its checksum does not fit its content"));
    }
    if !(header.info.elapsed_seconds.is_finite() && header.info.elapsed_seconds >= 0.0) {
        return Err(damaged(&format!("it claims {} seconds", header.info.elapsed_seconds)));
    }
    if header.info.fingerprint != expected_fingerprint {
        return Err(OutputError::new(path, "the checkpoint belongs to another scene or other settings")
            .with_help("render with the settings it was made with, or delete it to render from the start"));
    }
    Ok((film, header.info))
}

/// Length of the file of an image.
fn file_bytes(width: u32, height: u32) -> u64 {
    let tiles = u64::from(width.div_ceil(TILE_SIZE)) * u64::from(height.div_ceil(TILE_SIZE));
    let pixels = u64::from(width) * u64::from(height);
    HEADER_BYTES + 4 * tiles + 8 * layer::COUNT as u64 * pixels + 4
}

fn header(film: &FilmSums, info: &CheckpointInfo) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER_BYTES as usize);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(info.fingerprint.to_le_bytes());
    bytes.extend(info.seed.to_le_bytes());
    bytes.extend(info.elapsed_seconds.to_le_bytes());
    for number in [film.width, film.height, TILE_SIZE, layer::COUNT as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

fn read_film(file: &mut impl Read, width: u32, height: u32) -> io::Result<FilmSums> {
    let mut film = FilmSums::new(width, height);
    for tile in &mut film.tiles {
        let mut samples = [0; 4];
        file.read_exact(&mut samples)?;
        tile.samples = u32::from_le_bytes(samples);
        for pixel in &mut tile.pixels {
            let mut bytes = [0; layer::COUNT * 8];
            file.read_exact(&mut bytes)?;
            for (bytes, sum) in bytes.as_chunks().0.iter().zip(pixel) {
                *sum = f64::from_le_bytes(*bytes);
            }
        }
    }
    Ok(film)
}

/// The header's fields as they stand in the file.
struct Header {
    magic: [u8; 8],
    version: u32,
    info: CheckpointInfo,
    width: u32,
    height: u32,
    tile_size: u32,
    layers: u32,
}

impl Header {
    fn parse(bytes: &[u8; HEADER_BYTES as usize]) -> Self {
        let four = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        let eight = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        Self {
            magic: std::array::from_fn(|i| bytes[i]),
            version: four(8),
            info: CheckpointInfo {
                fingerprint: eight(12),
                seed: eight(20),
                elapsed_seconds: f64::from_bits(eight(28)),
            },
            width: four(36),
            height: four(40),
            tile_size: four(44),
            layers: four(48),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::render::film::tests::test_film;

    const INFO: CheckpointInfo =
        CheckpointInfo { fingerprint: 0x1234_5678_9abc_def0, seed: 7, elapsed_seconds: 12.5 };

    /// A directory, a checkpoint in it, and the checkpoint's bytes.
    fn saved(film: &FilmSums) -> (tempfile::TempDir, std::path::PathBuf, Vec<u8>) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.exr.checkpoint");
        save_checkpoint(&path, film, &INFO).unwrap();
        let bytes = fs::read(&path).unwrap();
        (directory, path, bytes)
    }

    /// Reads a checkpoint from memory: these tests read thousands of them.
    fn parsed(bytes: &[u8]) -> Result<(FilmSums, CheckpointInfo), OutputError> {
        parse(Path::new("picture.exr.checkpoint"), bytes, bytes.len() as u64, INFO.fingerprint)
    }

    #[test]
    fn load_gives_back_the_same_bits() {
        let mut film = test_film(37, 21);
        film.tiles[1].samples = u32::MAX;
        film.tiles[0].pixels[3] = [-0.0; layer::COUNT];
        film.tiles[0].pixels[4] = [f64::MIN_POSITIVE / 8.0; layer::COUNT];
        let (_directory, path, bytes) = saved(&film);
        assert_eq!(bytes.len() as u64, file_bytes(37, 21));
        let (loaded, info) = load_checkpoint(&path, INFO.fingerprint).unwrap();
        assert_eq!(info, INFO);
        assert_eq!((loaded.width, loaded.height), (film.width, film.height));
        for (a, b) in loaded.tiles.iter().zip(&film.tiles) {
            assert_eq!(a.samples, b.samples);
            let bits = |pixels: &[[f64; layer::COUNT]]| -> Vec<u64> {
                pixels.iter().flatten().map(|sum| sum.to_bits()).collect()
            };
            assert_eq!(bits(&a.pixels), bits(&b.pixels));
        }
    }

    #[test]
    fn load_refuses_every_truncation_and_every_addition() {
        let (_, _, bytes) = saved(&test_film(3, 2));
        for length in 0..bytes.len() {
            let error = parsed(&bytes[..length]).unwrap_err();
            assert!(error.to_string().contains("picture.exr.checkpoint") && error.help.is_some(), "{error}");
        }
        assert!(parsed(&[&bytes[..], b"x"].concat()).is_err());
    }

    #[test]
    fn load_refuses_every_flipped_bit() {
        let (_, _, bytes) = saved(&test_film(2, 2));
        for bit in 0..bytes.len() * 8 {
            let mut bytes = bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            let error = parsed(&bytes).unwrap_err();
            assert!(error.help.is_some(), "bit {bit}: {error}");
        }
    }

    #[test]
    fn load_refuses_random_damage() {
        // Damage passes the checksum with probability 2⁻³²; the seed is fixed.
        let (_, _, bytes) = saved(&test_film(5, 4));
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
    fn load_refuses_a_size_that_the_file_does_not_hold() {
        let (_, _, mut bytes) = saved(&test_film(2, 2));
        for edge in [0_u32, 16384, 16385, u32::MAX] {
            bytes[36..40].copy_from_slice(&edge.to_le_bytes());
            bytes[40..44].copy_from_slice(&edge.to_le_bytes());
            assert!(parsed(&bytes).unwrap_err().message.contains("damaged"));
        }
    }

    #[test]
    fn load_refuses_another_rendering_and_another_version() {
        let (_directory, path, mut bytes) = saved(&test_film(2, 2));
        let error = load_checkpoint(&path, INFO.fingerprint + 1).unwrap_err();
        assert!(error.message.contains("another scene"), "{error}");
        bytes[8] = 2;
        assert!(parsed(&bytes).unwrap_err().message.contains("another version"));
        assert!(parsed(&[b'x'; 200]).unwrap_err().message.contains("not a translucid"));
    }

    #[test]
    fn load_names_a_file_that_is_not_there() {
        let directory = tempfile::tempdir().unwrap();
        let error = load_checkpoint(&directory.path().join("none.checkpoint"), 0).unwrap_err();
        assert!(error.to_string().contains("none.checkpoint"));
    }
}
