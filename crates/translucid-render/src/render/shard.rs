//! Shards: a film's exact sums in a file, so that a rendering can continue where it stopped, or be joined with others of the
//! same picture.
//!
//! ```text
//! bytes  content (little endian)
//!     8  magic
//!     4  format version, u32
//!     4  length of the header, u32
//!     …  the header: JSON, see ShardHeader
//!     4  CRC-32 of all before, u32
//!     …  tile by tile:
//!     4    number of ranges of samples, u32
//!     …    their ends, u32
//!     …    sums of the pixels, rounded, f64
//!     4    number of the parts of their rests, u32
//!     …    number of the sum, u32, and part, f64
//!     4    CRC-32 of the tile, u32
//! ```
//!
//! Every tile has a checksum of its own: none of a damaged one is added to anything.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use bytemuck::{Pod, bytes_of, bytes_of_mut, cast_slice, cast_slice_mut};
use serde::{Deserialize, Serialize};
use translucid_files::write_atomically;
use translucid_image::{OutputError, PixelRect};

use super::exact_sums::ExactSums;
use super::film::{FilmSums, TileSums};
use super::fingerprint::Fingerprint;
use super::sample_ranges::SampleRanges;
use super::tile_grid::TileGrid;
use crate::world::layer;

const MAGIC: [u8; 8] = *b"TRLCKPT\n";
const VERSION: u32 = 2;
/// Longest header: a thousand runs and as many files.
const LONGEST_HEADER: u32 = 64 << 20;
/// Largest edge of an image, as `translucid_scene::Film` has it.
const MAX_EDGE: u32 = 16384;
/// Greatest sum: 2³² samples of the greatest `f32`.
const GREATEST_SUM: f64 = 1.5e48;

/// The header of a shard, before its sums.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShardHeader {
    /// Everything that its samples depend on: only shards with equal ones can be joined.
    pub fingerprint: Fingerprint,
    /// Width and height of the whole picture in pixels.
    pub size: [u32; 2],
    /// The part of the picture that the shard has: from (x0, y0) to just before (x1, y1).
    pub region: [u32; 4],
    /// Ranges of the numbers of samples that all pixels have.
    pub samples: Vec<[u32; 2]>,
    /// Where columns and rows of tiles begin in the region, and where they end.
    edges: [Vec<u32>; 2],
    /// Notes of the caller.
    pub notes: ShardNotes,
}

/// The origin of a shard, and the display of its picture. No sample depends on them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShardNotes {
    /// Where the scene came from.
    pub scene: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Samples per pixel that the picture is to have in the end; 0 if unknown.
    pub samples_per_pixel: u32,
    /// Stops by which the display is brighter; none where they are to be metered on the picture.
    pub exposure: Option<f32>,
    /// Curve to the display, by its name.
    pub tone_mapping: String,
    /// Files that the scene was read from: length and hash of each.
    pub inputs: BTreeMap<String, (u64, String)>,
    /// Who rendered it, in the order of their work.
    pub runs: Vec<ShardRun>,
}

/// One process's work on a shard.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShardRun {
    /// Name of the machine.
    pub host: String,
    /// Threads that rendered.
    pub threads: usize,
    /// When it began, in seconds since 1970 by the machine's clock.
    pub began: u64,
    /// Time spent rendering \[s\].
    pub seconds: f64,
    /// Time from the start of the program to the first path \[s\].
    pub preparing: f64,
}

impl ShardNotes {
    /// Time spent rendering by all \[s\].
    pub fn seconds(&self) -> f64 {
        self.runs.iter().map(|run| run.seconds).sum()
    }
}

impl ShardHeader {
    /// The header of a film that shows a region of a picture of some size.
    fn new(
        film: &FilmSums,
        fingerprint: Fingerprint,
        region: PixelRect,
        size: [u32; 2],
        notes: ShardNotes,
    ) -> Self {
        let PixelRect { left, top, width, height } = region;
        let mut tiles = film.tiles.iter().map(|tile| &tile.taken);
        let first = tiles.next().cloned().unwrap_or_default();
        let samples = tiles
            .fold(first, |common, taken| if common == *taken { common } else { common.intersection(taken) });
        let samples = samples.as_slice().iter().map(|range| [range.start, range.end]).collect();
        let region = [left, top, left + width, top + height];
        let edges = film.grid().edges().map(<[u32]>::to_vec);
        Self { fingerprint, size, region, samples, edges, notes }
    }

    /// The part of the picture that the shard has.
    pub fn rect(&self) -> PixelRect {
        let [x0, y0, x1, y1] = self.region;
        PixelRect { left: x0, top: y0, width: x1 - x0, height: y1 - y0 }
    }

    /// Where columns and rows of tiles begin, and where they end.
    pub(super) fn edges(&self) -> &[Vec<u32>; 2] {
        &self.edges
    }

    /// Where the tiles are.
    pub(super) fn grid(&self) -> io::Result<TileGrid> {
        let [x0, y0, x1, y1] = self.region;
        let is_in_the_picture = x0 < x1 && y0 < y1 && x1 <= self.size[0] && y1 <= self.size[1];
        let ends = self.edges.each_ref().map(|edges| edges.last().copied().unwrap_or(0));
        if !is_in_the_picture || self.size.iter().any(|edge| *edge > MAX_EDGE) || ends != [x1 - x0, y1 - y0] {
            return Err(damaged(&format!("it claims region {:?} of {:?} pixels", self.region, self.size)));
        }
        if self.samples.iter().any(|[start, end]| start >= end) {
            return Err(damaged("its ranges of samples are empty"));
        }
        TileGrid::with_edges(self.edges.clone()).ok_or_else(|| damaged("its tiles are out of order"))
    }
}

/// Writes a shard: the sums of a film that shows a region of a picture of some size.
///
/// # Errors
/// The file cannot be written; an older one at `path` is then still whole.
pub fn save_shard(
    path: &Path,
    film: &FilmSums,
    fingerprint: Fingerprint,
    (region, size): (PixelRect, [u32; 2]),
    notes: ShardNotes,
) -> Result<(), OutputError> {
    let header = ShardHeader::new(film, fingerprint, region, size, notes);
    let json = serde_json::to_vec(&header).map_err(|error| OutputError::new(path, error.to_string()))?;
    write_atomically(path, |file| {
        let mut out = Checksummed::new(&mut *file);
        out.write_all(&MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(json.len() as u32).to_le_bytes())?;
        out.write_all(&json)?;
        out.finish()?;
        film.tiles.iter().try_for_each(|tile| {
            let mut out = Checksummed::new(&mut *file);
            let ranges = tile.taken.as_slice();
            out.write_all(&(ranges.len() as u32).to_le_bytes())?;
            ranges.iter().try_for_each(|range| out.write_all(cast_slice(&[range.start, range.end])))?;
            out.write_all(cast_slice(tile.pixels()))?;
            let rests = tile.sums.rests();
            out.write_all(&(rests.len() as u32).to_le_bytes())?;
            for (number, part) in rests {
                out.write_all(bytes_of(number))?;
                out.write_all(bytes_of(part))?;
            }
            out.finish()
        })
    })
}

/// Returns `true` if a file is a shard, of any picture and version.
pub fn is_shard(path: &Path) -> bool {
    let mut magic = [0; 8];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == MAGIC
}

/// A shard's file, its header read.
pub struct ShardReader {
    path: PathBuf,
    header: ShardHeader,
    grid: TileGrid,
    file: Checksummed<BufReader<File>>,
    /// Number of the next tile.
    next: usize,
}

impl ShardReader {
    /// Opens a shard and reads its header.
    ///
    /// # Errors
    /// The file cannot be read, is no shard or one of another version, or its header is damaged.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let failed = |error: io::Error| failure(path, &error);
        let file = File::open(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        let mut file = Checksummed::new(BufReader::with_capacity(1 << 18, file));
        if length < 16 || file.read_value::<[u8; 8]>().map_err(failed)? != MAGIC {
            return Err(OutputError::new(path, "is no shard of a picture"));
        }
        if u32::from_le(file.read_value().map_err(failed)?) != VERSION {
            return Err(OutputError::new(path, "is a shard of another version of translucid")
                .with_help("use that version, or delete the file to render it again"));
        }
        let read = |file: &mut Checksummed<BufReader<File>>| -> io::Result<ShardHeader> {
            let bytes = u32::from_le(file.read_value()?);
            if bytes > LONGEST_HEADER || u64::from(bytes) > length {
                return Err(damaged(&format!("it claims a header of {bytes} bytes")));
            }
            let mut json = vec![0; bytes as usize];
            file.read_exact(&mut json)?;
            file.check()?;
            serde_json::from_slice(&json)
                .map_err(|error| damaged(&format!("its header is not right: {error}")))
        };
        let header = read(&mut file).map_err(failed)?;
        let grid = header.grid().map_err(failed)?;
        Ok(Self { path: path.to_owned(), header, grid, file, next: 0 })
    }

    /// The shard's header.
    pub fn header(&self) -> &ShardHeader {
        &self.header
    }

    /// The whole film.
    ///
    /// # Errors
    /// The file cannot be read, is cut short or damaged.
    pub fn film(mut self) -> Result<(FilmSums, ShardHeader), OutputError> {
        let mut film = FilmSums::on(self.grid.clone());
        while let Some((_, tile)) = self.next_tile()? {
            film.tiles[self.next - 1] = tile;
        }
        Ok((film, self.header))
    }

    /// The next tile and its pixels in the region; `None` after the last.
    pub(super) fn next_tile(&mut self) -> Result<Option<(PixelRect, TileSums)>, OutputError> {
        let read = |error: io::Error| failure(&self.path, &error);
        if self.next == self.grid.len() {
            return match self.file.inner.read(&mut [0]).map_err(read)? {
                0 => Ok(None),
                _ => Err(read(damaged("something follows its end"))),
            };
        }
        let rect = self.grid.rect(self.next);
        self.next += 1;
        let tile =
            read_tile(&mut self.file, rect.area() as usize).map_err(|error| failure(&self.path, &error))?;
        Ok(Some((rect, tile)))
    }
}

fn read_tile(file: &mut Checksummed<BufReader<File>>, pixels: usize) -> io::Result<TileSums> {
    let sums = pixels * layer::COUNT;
    let ranges = read_list::<[u32; 2]>(file, 1 << 20)?;
    let mut rounded = vec![[0.0; layer::COUNT]; pixels];
    file.read_exact(cast_slice_mut(&mut rounded))?;
    let rests = read_list::<[u8; 12]>(file, 64 * sums)?;
    file.check()?;
    let ranges: Vec<Range<u32>> = ranges.into_iter().map(|[start, end]| start..end).collect();
    let taken = SampleRanges::new(ranges.iter().cloned()).ok().filter(|taken| taken.as_slice() == ranges);
    let part = |bytes: [u8; 12]| {
        let [number, low, high] = bytemuck::cast::<_, [[u8; 4]; 3]>(bytes);
        (u32::from_le_bytes(number), f64::from_le_bytes(bytemuck::cast([low, high])))
    };
    let rests: Vec<(u32, f64)> = rests.into_iter().map(part).collect();
    let sums = ExactSums::from_parts(rounded, &rests);
    let is_small = |sums: &ExactSums| sums.rounded.iter().flatten().all(|sum| sum.abs() <= GREATEST_SUM);
    match (taken, sums.filter(is_small)) {
        (Some(taken), Some(sums)) => Ok(TileSums { taken, sums }),
        _ => Err(damaged("its sums cannot be those of samples")),
    }
}

/// A number of values and the values; more than `most` are damage.
fn read_list<T: Pod>(file: &mut Checksummed<BufReader<File>>, most: usize) -> io::Result<Vec<T>> {
    let count = u32::from_le(file.read_value()?) as usize;
    if count > most {
        return Err(damaged(&format!("it claims {count} values where at most {most} can be")));
    }
    // A file cannot ask for more memory than it holds
    let mut values = Vec::new();
    while values.len() < count {
        values.push(file.read_value()?);
    }
    Ok(values)
}

fn failure(path: &Path, error: &io::Error) -> OutputError {
    match error.kind() {
        io::ErrorKind::InvalidData => OutputError::new(path, format!("the shard is damaged: {error}"))
            .with_help("delete it and render it again"),
        io::ErrorKind::UnexpectedEof => OutputError::new(path, "the shard is damaged: it ends too soon")
            .with_help("delete it and render it again"),
        _ => OutputError::new(path, format!("cannot read the shard: {error}"))
            .with_help("see that it is there and may be read"),
    }
}

/// A reader or writer with the CRC-32 of all bytes that have passed since the last one.
struct Checksummed<T> {
    inner: T,
    crc: crc32fast::Hasher,
}

impl<T> Checksummed<T> {
    fn new(inner: T) -> Self {
        Self { inner, crc: crc32fast::Hasher::new() }
    }
}

impl<T: Read> Checksummed<T> {
    fn read_exact(&mut self, buffer: &mut [u8]) -> io::Result<()> {
        self.inner.read_exact(buffer)?;
        self.crc.update(buffer);
        Ok(())
    }

    fn read_value<V: Pod>(&mut self) -> io::Result<V> {
        let mut value = V::zeroed();
        self.read_exact(bytes_of_mut(&mut value))?;
        Ok(value)
    }

    /// Reads the checksum of what was read since the last one.
    fn check(&mut self) -> io::Result<()> {
        let found = std::mem::take(&mut self.crc).finalize();
        let mut crc = [0; 4];
        self.inner.read_exact(&mut crc)?;
        // What passes a checksum is checked, too, which fuzzing could not reach
        if cfg!(fuzzing) || u32::from_le_bytes(crc) == found {
            Ok(())
        } else {
            Err(damaged("a checksum does not fit its content"))
        }
    }
}

impl<T: Write> Checksummed<T> {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.crc.update(bytes);
        self.inner.write_all(bytes)
    }

    fn finish(mut self) -> io::Result<()> {
        self.inner.write_all(&self.crc.finalize().to_le_bytes())
    }
}

/// The error of data that cannot be right.
fn damaged(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}
