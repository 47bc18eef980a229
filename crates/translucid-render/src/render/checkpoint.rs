//! Checkpoints: a film's sums in a file, bit by bit, so that a rendering can go on where it stopped.
//!
//! The data of the [`KeptFile`]:
//!
//! ```text
//! offset  bytes  content (little endian)
//!     20      8  seed, u64
//!     28      8  seconds spent so far, f64
//!     36     16  width, height, tile size, sums per pixel, u32 each
//!     52      …  per tile: samples, u32, then the sums of its pixels, f64
//! ```

use std::io;
use std::path::Path;

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};
use translucid_image::{KeptData, KeptFile, OutputError, damaged};

use super::film::{FilmSums, TILE_SIZE};
use crate::world::layer;

const FORMAT: KeptFile =
    KeptFile { magic: *b"TRLCKPT\n", version: 1, name: "checkpoint", anew: "render from the start" };

/// Largest edge of an image, as `translucid_scene::Film` has it.
const MAX_EDGE: u32 = 16384;

/// Facts that a checkpoint keeps besides the sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckpointInfo {
    /// A number that differs when scene or settings do.
    pub fingerprint: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Time spent rendering so far, in seconds.
    pub elapsed_seconds: f64,
}

/// The numbers before the sums.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Header {
    seed: u64,
    elapsed_seconds: f64,
    width: u32,
    height: u32,
    tile_size: u32,
    layers: u32,
}

/// Writes a film's sums so that [`load_checkpoint`] gives back the same bits.
///
/// # Errors
/// The file cannot be written; an older checkpoint at `path` is then still whole.
pub fn save_checkpoint(path: &Path, film: &FilmSums, info: &CheckpointInfo) -> Result<(), OutputError> {
    let header = Header {
        seed: info.seed,
        elapsed_seconds: info.elapsed_seconds,
        width: film.width,
        height: film.height,
        tile_size: TILE_SIZE,
        layers: layer::COUNT as u32,
    };
    FORMAT.save(path, info.fingerprint, |out| {
        out.write_all(bytes_of(&header))?;
        film.tiles.iter().try_for_each(|tile| {
            out.write_all(bytes_of(&tile.samples))?;
            out.write_all(cast_slice(&tile.pixels))
        })
    })
}

/// Whether a file is a checkpoint, of whatever rendering.
pub fn is_checkpoint(path: &Path) -> bool {
    FORMAT.is_at(path)
}

/// Reads a checkpoint back, if it belongs to the scene and settings with this fingerprint.
///
/// # Errors
/// The file cannot be read, is no checkpoint, is cut short or damaged, or belongs to another rendering.
pub fn load_checkpoint(
    path: &Path,
    expected_fingerprint: u64,
) -> Result<(FilmSums, CheckpointInfo), OutputError> {
    let (film, header) = FORMAT.load(path, expected_fingerprint, read)?;
    let Header { seed, elapsed_seconds, .. } = header;
    Ok((film, CheckpointInfo { fingerprint: expected_fingerprint, seed, elapsed_seconds }))
}

fn read(data: &mut KeptData<'_>) -> io::Result<(FilmSums, Header)> {
    let header: Header = data.read()?;
    let Header { elapsed_seconds, width, height, tile_size, layers, .. } = header;
    let edges = 1..=MAX_EDGE;
    if !edges.contains(&width) || !edges.contains(&height) {
        return Err(damaged(&format!("it claims {width}x{height} pixels")));
    }
    if (tile_size, layers) != (TILE_SIZE, layer::COUNT as u32) {
        return Err(damaged(&format!("it claims {layers} sums a pixel in tiles of {tile_size} pixels")));
    }
    if !(elapsed_seconds.is_finite() && elapsed_seconds >= 0.0) {
        return Err(damaged(&format!("it claims {elapsed_seconds} seconds")));
    }
    let tiles = u64::from(width.div_ceil(TILE_SIZE)) * u64::from(height.div_ceil(TILE_SIZE));
    let pixels = u64::from(width) * u64::from(height);
    data.require_length(size_of::<Header>() as u64 + 4 * tiles + 8 * layer::COUNT as u64 * pixels)?;
    let mut film = FilmSums::new(width, height);
    for tile in &mut film.tiles {
        tile.samples = data.read()?;
        data.fill(&mut tile.pixels)?;
    }
    Ok((film, header))
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

    #[test]
    fn load_gives_back_the_same_bits() {
        let mut film = test_film(37, 21);
        film.tiles[1].samples = u32::MAX;
        film.tiles[0].pixels[3] = [-0.0; layer::COUNT];
        film.tiles[0].pixels[4] = [f64::MIN_POSITIVE / 8.0; layer::COUNT];
        let (_directory, path, bytes) = saved(&film);
        assert_eq!(bytes.len(), 52 + 4 * 6 + 8 * layer::COUNT * 37 * 21 + 4);
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
    fn load_refuses_a_size_that_the_file_does_not_hold() {
        let (_directory, path, mut bytes) = saved(&test_film(2, 2));
        for edge in [0_u32, 16384, 16385, u32::MAX] {
            bytes[36..40].copy_from_slice(&edge.to_le_bytes());
            bytes[40..44].copy_from_slice(&edge.to_le_bytes());
            fs::write(&path, &bytes).unwrap();
            let error = load_checkpoint(&path, INFO.fingerprint).unwrap_err();
            assert!(error.message.contains("damaged"), "{error}");
        }
    }
}
