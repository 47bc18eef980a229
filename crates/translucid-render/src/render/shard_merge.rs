//! Shards of a picture joined to the sums of one rendering.

use std::ops::Range;
use std::path::{Path, PathBuf};

use translucid_image::{OutputError, PixelRect};

use super::film::FilmSums;
use super::fingerprint::Fingerprint;
use super::shard::{ShardHeader, ShardNotes, ShardReader, save_shard};
use super::tile_grid::{TILE_SIZE, TileGrid};
use crate::world::layer;

/// Shards of one picture, joined as they are read: of any samples and regions, in any order.
///
/// The sums are exact, so that the result has the bits of one rendering of all samples. In memory is the picture and a tile.
#[derive(Debug)]
pub struct ShardMerge {
    film: FilmSums,
    fingerprint: Fingerprint,
    /// The pixels of the picture that the shards are parts of, and its width and height.
    region: PixelRect,
    size: [u32; 2],
    notes: ShardNotes,
    /// Files that have been added.
    added: Vec<PathBuf>,
}

/// Samples that pixels lack.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// The pixels: from (x0, y0) to just before (x1, y1).
    pub region: [u32; 4],
    /// Numbers of the samples.
    pub samples: Range<u32>,
}

impl ShardMerge {
    /// An empty picture with room for shards whose headers belong together.
    ///
    /// # Errors
    /// There are none, one cannot be read, they are of different scenes or settings, two have the same samples, or the picture
    /// takes more than so many bytes of memory.
    pub fn new(paths: &[PathBuf], memory: u64) -> Result<Self, OutputError> {
        let mut headers = Vec::with_capacity(paths.len());
        for path in paths {
            headers.push((path.as_path(), ShardReader::open(path)?.header().clone()));
        }
        let Some(((first, header), others)) = headers.split_first() else {
            return Err(OutputError::without_file("there are no shards to merge"));
        };
        for (path, other) in others {
            if let Some(difference) = header.fingerprint.difference(&other.fingerprint) {
                let message =
                    format!("is of another scene or other settings than {}: {difference}", first.display());
                return Err(OutputError::new(path, message)
                    .with_help("merge shards of one picture, rendered by one version of translucid"));
            }
        }
        refuse_overlaps(&headers)?;
        let rects = || headers.iter().map(|(_, header)| header.rect());
        let region = rects().reduce(around).unwrap_or_else(|| header.rect());
        let needed = region.area() * size_of::<[f64; layer::COUNT]>() as u64;
        if needed > memory {
            let [needed, memory] = [needed, memory].map(|bytes| bytes >> 20);
            let message = format!("the picture takes {needed} MiB of memory, and {memory} MiB are free");
            return Err(OutputError::without_file(message));
        }
        let edges = |start: fn(&PixelRect) -> u32, axis: usize| {
            let starts = headers.iter().flat_map(|(_, header)| {
                let origin = start(&header.rect()) - start(&region);
                header.edges()[axis].iter().map(move |edge| origin + edge)
            });
            let mut edges: Vec<u32> = starts.collect();
            edges.sort_unstable();
            edges.dedup();
            // Where no shard has pixels, tiles may be too far apart
            let between = |ends: &[u32]| (ends[0]..ends[1]).step_by(TILE_SIZE as usize).collect::<Vec<_>>();
            let last = edges.last().copied();
            edges.windows(2).flat_map(between).chain(last).collect()
        };
        let grid = TileGrid::with_edges([edges(|rect| rect.left, 0), edges(|rect| rect.top, 1)]);
        let grid =
            grid.ok_or_else(|| OutputError::new(first, "the tiles of the shards do not fit together"))?;
        let samples_per_pixel =
            headers.iter().map(|(_, header)| header.notes.samples_per_pixel).max().unwrap_or(0);
        let notes = ShardNotes { samples_per_pixel, runs: Vec::new(), ..header.notes.clone() };
        let (fingerprint, size) = (header.fingerprint.clone(), header.size);
        Ok(Self { film: FilmSums::on(grid), fingerprint, region, size, notes, added: Vec::new() })
    }

    /// Adds a shard.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, has changed since [`new`](Self::new), or has samples that are there already. The
    /// picture is then spoiled.
    pub fn add(&mut self, path: &Path) -> Result<(), OutputError> {
        let mut shard = ShardReader::open(path)?;
        let rect = shard.header().rect();
        let changed = || OutputError::new(path, "has changed while it was merged");
        let is_known = self.fingerprint == shard.header().fingerprint;
        if !is_known || around(self.region, rect) != self.region {
            return Err(changed());
        }
        let (left, top) = (rect.left - self.region.left, rect.top - self.region.top);
        while let Some((rect, other)) = shard.next_tile()? {
            let place = PixelRect { left: rect.left + left, top: rect.top + top, ..rect };
            for index in self.film.grid().touching(place) {
                let part = self.film.tile_rect(index);
                if part.intersection(&place) != Some(part) {
                    return Err(changed());
                }
                let tile = &mut self.film.tiles[index];
                tile.taken = tile.taken.union(&other.taken).map_err(|Range { start, end }| {
                    let added: Vec<String> =
                        self.added.iter().map(|path| path.display().to_string()).collect();
                    let message = format!("its samples {start}..{end} are also in {}", added.join(" or "));
                    OutputError::new(path, message).with_help("leave one of them out")
                })?;
                for (pixel, (x, y)) in part.pixels().enumerate() {
                    let other_pixel = (y - place.top) * place.width + (x - place.left);
                    tile.sums.add_pixel(pixel, &other.sums, other_pixel as usize);
                }
            }
        }
        self.notes.runs.extend(shard.header().notes.runs.iter().cloned());
        self.notes.inputs.extend(shard.header().notes.inputs.clone());
        self.added.push(path.to_owned());
        Ok(())
    }

    /// The sums of all that was added.
    pub fn film(&self) -> &FilmSums {
        &self.film
    }

    /// The shards' notes, with the runs of all of them.
    pub fn notes(&self) -> &ShardNotes {
        &self.notes
    }

    /// Where the pixels lie in the whole picture, and that one's width and height; `None` where they are all of it.
    pub fn place(&self) -> Option<(PixelRect, [u32; 2])> {
        (self.region != PixelRect::whole(self.size)).then_some((self.region, self.size))
    }

    /// Writes all that was added as one shard.
    ///
    /// # Errors
    /// As [`save_shard`].
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        let place = (self.region, self.size);
        save_shard(path, &self.film, self.fingerprint.clone(), place, self.notes.clone())
    }

    /// Samples up to a number that pixels lack, as ranges to render: rows of tiles that lack the same together.
    pub fn gaps(&self, samples: u32) -> Vec<Gap> {
        let mut gaps: Vec<Gap> = Vec::new();
        for (index, tile) in self.film.tiles.iter().enumerate() {
            let PixelRect { left, top, width, height } = self.film.tile_rect(index);
            let (left, top) = (left + self.region.left, top + self.region.top);
            for samples in tile.taken.missing(0..samples) {
                let region = [left, top, left + width, top + height];
                add_gap(&mut gaps, Gap { region, samples });
            }
        }
        let mut joined: Vec<Gap> = Vec::new();
        gaps.into_iter().for_each(|gap| add_below(&mut joined, gap));
        joined
    }
}

/// Adds a gap, to the one on its left if that lacks the same.
fn add_gap(gaps: &mut Vec<Gap>, gap: Gap) {
    let [left, top, right, bottom] = gap.region;
    let is_beside =
        |other: &&mut Gap| other.samples == gap.samples && other.region[1..] == [top, left, bottom];
    match gaps.iter_mut().rev().take_while(|other| other.region[1] == top).find(is_beside) {
        Some(other) => other.region[2] = right,
        None => gaps.push(gap),
    }
}

/// Adds a gap, to the one above if that is as wide and lacks the same.
fn add_below(gaps: &mut Vec<Gap>, gap: Gap) {
    let [left, top, right, bottom] = gap.region;
    let is_above = |other: &&mut Gap| {
        let [other_left, _, other_right, other_bottom] = other.region;
        other.samples == gap.samples && [other_left, other_right, other_bottom] == [left, right, top]
    };
    match gaps.iter_mut().find(is_above) {
        Some(other) => other.region[3] = bottom,
        None => gaps.push(gap),
    }
}

/// Refuses shards that have the same samples of the same pixels.
fn refuse_overlaps(headers: &[(&Path, ShardHeader)]) -> Result<(), OutputError> {
    let mut ranges: Vec<(Range<u32>, usize)> = Vec::new();
    for (number, (_, header)) in headers.iter().enumerate() {
        ranges.extend(header.samples.iter().map(|[start, end]| (*start..*end, number)));
    }
    ranges.sort_unstable_by_key(|(range, number)| (range.start, *number));
    for (place, (range, number)) in ranges.iter().enumerate() {
        for (other, other_number) in
            ranges[place + 1..].iter().take_while(|(other, _)| other.start < range.end)
        {
            let [(path, header), (other_path, other_header)] = [*number, *other_number].map(|i| &headers[i]);
            if header.rect().intersection(&other_header.rect()).is_some() {
                let (start, end) = (other.start, other.end.min(range.end));
                let message = format!("its samples {start}..{end} are also in {}", path.display());
                return Err(OutputError::new(other_path, message).with_help("leave one of them out"));
            }
        }
    }
    Ok(())
}

/// The least rectangle around both.
fn around(a: PixelRect, b: PixelRect) -> PixelRect {
    let (left, top) = (a.left.min(b.left), a.top.min(b.top));
    let right = (a.left + a.width).max(b.left + b.width);
    let bottom = (a.top + a.height).max(b.top + b.height);
    PixelRect { left, top, width: right - left, height: bottom - top }
}
