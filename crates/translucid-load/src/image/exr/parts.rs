//! Parts of an OpenEXR file, and the values of their channels.

use std::io::Cursor;

use exr::block::reader::ChunksReader;
use exr::block::{UncompressedBlock, lines::LineRef};
use exr::compression::Compression;
use exr::error::{Error, UnitResult};
use exr::math::Vec2;
use exr::meta::attribute::{IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::meta::{Headers, MetaData};
use exr::prelude::f16;
use translucid_scene::SceneError;

use super::super::file_bytes::ImageBytes;
use super::names::{channel_names, part_name, text};
use crate::result::Result;

/// Most channels of all parts together; Blender writes about a hundred with all passes of a view layer.
const MOST_CHANNELS: usize = 4096;

/// Methods of compression that can be read.
const CODECS: &str = "NONE, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA and DWAB";

/// Advice for a file of a codec that cannot be read.
const CODEC_HELP: &str =
    "save it with one of them; in Blender, set Codec in Output Properties to one such as ZIP or DWAA";

/// The parts of a file, which is valid as far as its headers go.
pub(super) struct Parts<'a> {
    source: &'a ImageBytes<'a>,
    headers: Headers,
    channels: Vec<Channel>,
}

/// A channel of a part.
struct Channel {
    part: usize,
    /// Its number in the part.
    index: usize,
    name: String,
}

/// A rectangle of pixels, which may begin anywhere.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Window {
    pub(super) start: [i64; 2],
    pub(super) size: [usize; 2],
}

impl Window {
    fn new(bounds: IntegerBounds) -> Self {
        let (start, size) = (bounds.position, bounds.size);
        Self { start: [start.0.into(), start.1.into()], size: [size.0, size.1] }
    }

    /// The number of a pixel, row by row, if the window has it.
    pub(super) fn index(self, [x, y]: [i64; 2]) -> Option<usize> {
        let inside =
            |i: usize, at: i64| usize::try_from(at - self.start[i]).ok().filter(|at| *at < self.size[i]);
        Some(inside(1, y)? * self.size[0] + inside(0, x)?)
    }

    /// The smallest window around both.
    pub(super) fn union(self, other: Self) -> Self {
        let end = |window: Self, i: usize| window.start[i] + window.size[i] as i64;
        let start = [0, 1].map(|i| self.start[i].min(other.start[i]));
        Self { start, size: [0, 1].map(|i| (end(self, i).max(end(other, i)) - start[i]) as usize) }
    }
}

/// The values of a channel in the data window of its part.
pub(super) struct Plane {
    pub(super) window: Window,
    pub(super) values: Vec<f32>,
}

impl Plane {
    /// The values in a window around the own one, 0 elsewhere.
    pub(super) fn placed_in(self, window: Window) -> Vec<f32> {
        if self.window == window {
            return self.values;
        }
        let mut values = vec![0.0; window.size[0] * window.size[1]];
        let rows = (self.window.start[1]..).zip(self.values.chunks_exact(self.window.size[0]));
        for (y, row) in rows {
            if let Some(start) = window.index([self.window.start[0], y]) {
                values[start..start + row.len()].copy_from_slice(row);
            }
        }
        values
    }
}

impl<'a> Parts<'a> {
    /// Reads the headers of all parts.
    ///
    /// # Errors
    /// They are damaged, a part is deep, or there are too many channels.
    pub(super) fn open(source: &'a ImageBytes<'a>) -> Result<Self> {
        let metadata = MetaData::read_from_buffered(Cursor::new(source.bytes), false);
        let headers = metadata.map_err(|error| refusal(source, &error))?.headers;
        let count: usize = headers.iter().map(|header| header.channels.list.len()).sum();
        if count > MOST_CHANNELS {
            let message = format!("the file has {count} channels, but at most {MOST_CHANNELS} can be read");
            return Err(source.error(message));
        }
        let names = channel_names(&headers).into_iter().enumerate();
        let channels = names.flat_map(|(part, names)| {
            names.into_iter().enumerate().map(move |(index, name)| Channel { part, index, name })
        });
        let parts = Self { source, channels: channels.collect(), headers };
        match parts.headers.iter().position(|header| header.deep) {
            Some(deep) => {
                let message =
                    format!("{} holds deep data, but only flat data can be read", parts.called(deep));
                Err(source.error(message).with_help("save it as flat scan lines or tiles"))
            }
            None => Ok(parts),
        }
    }

    /// The names of all channels.
    pub(super) fn names(&self) -> Vec<&str> {
        self.channels.iter().map(|channel| channel.name.as_str()).collect()
    }

    /// The data window of a channel's part.
    pub(super) fn data_window(&self, channel: usize) -> Window {
        Window::new(self.header(channel).data_window())
    }

    /// The display window of a channel's part.
    pub(super) fn display_window(&self, channel: usize) -> Window {
        Window::new(self.header(channel).shared_attributes.display_window)
    }

    /// The header of a channel's part.
    pub(super) fn header(&self, channel: usize) -> &Header {
        &self.headers[self.channels[channel].part]
    }

    /// A part as messages name it.
    fn called(&self, part: usize) -> String {
        match self.headers.len() {
            1 => String::from("the OpenEXR file"),
            _ => format!("part {} (\"{}\") of the OpenEXR file", part + 1, part_name(&self.headers[part])),
        }
    }

    /// Reads these channels, in this order, each given once.
    ///
    /// # Errors
    /// Their parts are damaged, too large, of a codec that cannot be read, or have a subsampled channel.
    pub(super) fn read(&self, channels: &[usize]) -> Result<Vec<Plane>> {
        let mut slots: Vec<Vec<Option<usize>>> = vec![Vec::new(); self.headers.len()];
        for (slot, channel) in channels.iter().map(|&channel| &self.channels[channel]).enumerate() {
            let part = &mut slots[channel.part];
            part.resize(self.headers[channel.part].channels.list.len(), None);
            part[channel.index] = Some(slot);
        }
        self.check(&slots)?;
        let mut planes: Vec<Plane> = channels
            .iter()
            .map(|&channel| {
                let window = self.data_window(channel);
                Plane { window, values: vec![0.0; window.size[0] * window.size[1]] }
            })
            .collect();
        let is_wanted = |part: usize, level: Vec2<usize>| level == Vec2(0, 0) && !slots[part].is_empty();
        exr::block::read(Cursor::new(self.source.bytes), false)
            .and_then(|reader| {
                reader.filter_chunks(false, |_, tile, block| is_wanted(block.layer, tile.level_index))
            })
            .and_then(|chunks| {
                chunks.decompress_parallel(false, |metadata, block| {
                    // A chunk says itself where it belongs, whatever the table of chunks says
                    match is_wanted(block.index.layer, block.index.level) {
                        true => copy_block(&block, &metadata.headers, &slots[block.index.layer], &mut planes),
                        false => Ok(()),
                    }
                })
            })
            .map_err(|error| refusal(self.source, &error))?;
        Ok(planes)
    }

    /// Refuses parts that cannot be read or would need memory without bound, before it is asked for.
    fn check(&self, slots: &[Vec<Option<usize>>]) -> Result<()> {
        let mut samples = 0_u64;
        for (part, header) in self.headers.iter().enumerate().filter(|(part, _)| !slots[*part].is_empty()) {
            let codec = match header.compression {
                Compression::HTJ2K32 | Compression::HTJ2K256 => Some("HTJ2K"),
                _ => None,
            };
            if let Some(codec) = codec {
                return Err(unknown_codec(self.source, &self.called(part), codec));
            }
            let pixels = self.source.check_size(header.layer_size.0, header.layer_size.1)?;
            let channels = &header.channels.list;
            if let Some(channel) = channels.iter().find(|channel| channel.sampling != Vec2(1, 1)) {
                let (name, part) = (text(&channel.name), self.called(part));
                let message = format!("channel {name} of {part} is subsampled, which cannot be read");
                return Err(self.source.error(message).with_help("save it with full channels R, G, B"));
            }
            samples = samples.saturating_add((pixels as u64).saturating_mul(channels.len() as u64));
        }
        self.source.check_samples(samples)
    }
}

/// Copies the rows of a block to the planes of its part's channels.
fn copy_block(
    block: &UncompressedBlock,
    headers: &[Header],
    slots: &[Option<usize>],
    planes: &mut [Plane],
) -> UnitResult {
    let channels = &headers[block.index.layer].channels;
    for line in block.lines(channels) {
        let (at, channel) = (line.location.position, line.location.channel);
        let Some(plane) = slots[channel].map(|slot| &mut planes[slot]) else { continue };
        let start = at.1 * plane.window.size[0] + at.0;
        let row = plane.values.get_mut(start..start + line.location.sample_count);
        let row = row.ok_or_else(|| Error::Invalid("a block outside of the data window".into()))?;
        match channels.list[channel].sample_type {
            SampleType::F16 => copy_row(line, row, f16::to_f32)?,
            SampleType::F32 => copy_row(line, row, |value: f32| value)?,
            SampleType::U32 => copy_row(line, row, |value: u32| value as f32)?,
        }
    }
    Ok(())
}

fn copy_row<T: exr::io::Data>(line: LineRef<'_>, row: &mut [f32], single: fn(T) -> f32) -> UnitResult {
    for (value, sample) in row.iter_mut().zip(line.read_samples::<T>()) {
        *value = single(sample?);
    }
    Ok(())
}

fn refusal(source: &ImageBytes<'_>, error: &Error) -> SceneError {
    match later_codec(source.bytes) {
        Some(codec) => unknown_codec(source, "the OpenEXR file", &codec),
        None => source.error(format!("cannot read the OpenEXR file: {error}")),
    }
}

fn unknown_codec(source: &ImageBytes<'_>, part: &str, codec: &str) -> SceneError {
    let message = format!("{part} is compressed with {codec}, but only {CODECS} can be read");
    source.error(message).with_help(CODEC_HELP)
}

/// A codec of OpenEXR 3.5 and later in any header: its name, or else its number.
fn later_codec(bytes: &[u8]) -> Option<String> {
    let attribute = b"\0compression\0compression\0\x01\0\0\0";
    let values = bytes.windows(attribute.len() + 1).filter(|window| window.starts_with(attribute));
    let code = values.map(|window| window[attribute.len()]).find(|code| *code > 11)?;
    Some(match code {
        12 => String::from("LJ2K"),
        13 => String::from("ZSTD"),
        _ => format!("method {code}"),
    })
}
