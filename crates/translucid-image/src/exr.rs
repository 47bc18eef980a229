//! OpenEXR files: all channels of a picture, and metadata.

use std::io::{self, Seek, Write};
use std::ops::Range;
use std::path::Path;

use ::exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use ::exr::block::writer::ChunksWriter;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{AttributeValue, ChannelDescription, Chromaticities, IntegerBounds, SampleType};
use ::exr::meta::header::{Header, ImageAttributes};
use ::exr::prelude::{Compression, LayerAttributes, LineOrder, SmallVec, Text, Vec2, f16};
use miniz_oxide::deflate::compress_to_vec_zlib;
use rayon::prelude::*;
use translucid_files::write_atomically;

use crate::picture::{finite, finite_single, invalid};
use crate::{MetadataValue, OutputError, Picture, Precision};

/// Level of deflation: noise has little to find, and level 4, which the exr crate would take, needs several times as
/// long for hardly smaller files.
const DEFLATE_LEVEL: u8 = 1;

/// Chunks that are compressed at once, and wait in memory to be written.
const CHUNKS_AT_ONCE: usize = 32;

/// Red, green, blue and white of ITU-R BT.709.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};

impl Picture<'_> {
    /// Writes all channels as an OpenEXR file of one part, ZIP-compressed.
    ///
    /// The data window is the picture's region, the display window the whole. The color of channels R, G, B is stated: linear
    /// Rec. 709, or data ([`is_data`](Self::is_data)). Values beyond a channel's range become
    /// its greatest finite value, NaN becomes 0.
    ///
    /// # Errors
    /// As [`write_atomically`], or the picture is none, see [`write_exr`](Self::write_exr).
    pub fn save_exr(&self, path: &Path) -> Result<(), OutputError> {
        write_atomically(path, |out| self.write_exr(out))
    }

    /// Writes what [`save_exr`](Self::save_exr) does to anything that can go back to its beginning.
    ///
    /// # Errors
    /// `out` refuses, the picture has no pixels or no channels, its region is not within the whole, or two channels
    /// have the same name or one that is none.
    pub fn write_exr(&self, out: impl Write + Seek) -> io::Result<()> {
        self.check()?;
        let (channels, sorted) = self.sorted_channels()?;
        let rows = self.region.rows();
        let corner = Vec2(self.region.left as i32, self.region.top as i32);
        let [whole_width, whole_height] = self.whole.map(|edge| edge as usize);
        let display_window = IntegerBounds::from_dimensions((whole_width, whole_height));
        let [width, height] = self.size();
        let header = Header::new(Text::default(), (width, height), channels)
            .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
            .with_attributes(self.attributes()?.with_position(corner))
            .with_shared_attributes(ImageAttributes {
                chromaticities: (self.has_color() && !self.is_data).then_some(REC_709),
                ..ImageAttributes::new(display_window)
            });
        let rows_of_chunk = Compression::ZIP16.scan_lines_per_block();
        ::exr::block::write(out, SmallVec::from_iter([header]), true, |_, writer| {
            let tops: Vec<u32> = rows.clone().step_by(rows_of_chunk).collect();
            for (first, tops) in (0..).step_by(CHUNKS_AT_ONCE).zip(tops.chunks(CHUNKS_AT_ONCE)) {
                let chunk = |&top: &u32| {
                    let bottom = rows.end.min(top + rows_of_chunk as u32);
                    let compressed_pixels_le = compressed(self.bytes_of_rows(top..bottom, &sorted));
                    let block = CompressedScanLineBlock { y_coordinate: top as i32, compressed_pixels_le };
                    Chunk { layer_index: 0, compressed_block: CompressedBlock::ScanLine(block) }
                };
                let chunks: Vec<Chunk> = tops.par_iter().map(chunk).collect();
                for (index, chunk) in (first..).zip(chunks) {
                    writer.write_chunk(index, chunk)?;
                }
            }
            Ok(())
        })
        .map_err(io::Error::other)
    }

    /// Whether there are channels R, G, B.
    fn has_color(&self) -> bool {
        self.indices_of(["R", "G", "B"]).is_ok()
    }

    /// The metadata as attributes of a header, and the name that the Color Interop Forum has for the color.
    fn attributes(&self) -> io::Result<LayerAttributes> {
        let text = |value: &str| Text::new_or_none(value).unwrap_or_else(|| Text::from("?"));
        let mut attributes = LayerAttributes::default();
        if !self.software.is_empty() {
            attributes.software_name = Some(text(&self.software));
        }
        if self.has_color() {
            let name = if self.is_data { "data" } else { "lin_rec709_scene" };
            attributes.other.insert(Text::from("colorInteropID"), AttributeValue::Text(Text::from(name)));
        }
        for (name, value) in &self.metadata {
            let value = match value {
                MetadataValue::Text(value) => AttributeValue::Text(text(value)),
                MetadataValue::Integer(value) => AttributeValue::I32(*value),
                MetadataValue::Real(value) => {
                    AttributeValue::F64(if value.is_finite() { *value } else { 0.0 })
                }
            };
            attributes.other.insert(name_from(name)?, value);
        }
        Ok(attributes)
    }

    /// The channels sorted by name, as the format demands, and the place of each among the values of a pixel.
    fn sorted_channels(&self) -> io::Result<(SmallVec<[ChannelDescription; 5]>, Vec<usize>)> {
        let mut channels = Vec::new();
        for (index, channel) in self.channels.iter().enumerate() {
            let name = name_from(&channel.name)?;
            let sample_type = match channel.precision {
                Precision::Half => SampleType::F16,
                Precision::Single => SampleType::F32,
            };
            channels.push((ChannelDescription::named(name, sample_type), index));
        }
        channels.sort_by(|(a, _), (b, _)| a.name.cmp(&b.name));
        if let Some(twice) = channels.windows(2).find(|pair| pair[0].0.name == pair[1].0.name) {
            return Err(invalid(&format!("there are two channels {}", twice[0].0.name)));
        }
        Ok(channels.into_iter().unzip())
    }

    /// The values of some rows as the format has them: row by row, and in each channel by channel.
    fn bytes_of_rows(&self, rows: Range<u32>, sorted_channels: &[usize]) -> Vec<u8> {
        let mut row = self.new_row();
        let mut bytes = Vec::new();
        for y in rows {
            self.read_row(y, &mut row);
            for &index in sorted_channels {
                let values = row.iter().skip(index).step_by(self.channels.len());
                match self.channels[index].precision {
                    Precision::Half => bytes.extend(values.flat_map(|value| half(*value).to_le_bytes())),
                    Precision::Single => {
                        bytes.extend(values.flat_map(|value| finite_single(*value).to_le_bytes()));
                    }
                }
            }
        }
        bytes
    }
}

/// Bytes of a chunk, ZIP-compressed as OpenEXR does: those at even places before those at odd ones, each as its difference
/// from the one before plus 128, deflated; as they were where that is not shorter.
fn compressed(bytes: Vec<u8>) -> Vec<u8> {
    let mut parted: Vec<u8> =
        bytes.iter().step_by(2).chain(bytes.iter().skip(1).step_by(2)).copied().collect();
    for i in (1..parted.len()).rev() {
        parted[i] = parted[i].wrapping_sub(parted[i - 1]).wrapping_add(128);
    }
    let deflated = compress_to_vec_zlib(&parted, DEFLATE_LEVEL);
    if deflated.len() < bytes.len() { deflated } else { bytes }
}

/// The name of a channel or a note.
fn name_from(name: &str) -> io::Result<Text> {
    let text = Text::new_or_none(name).filter(|text| !text.as_slice().is_empty());
    text.ok_or_else(|| invalid(&format!("`{name}` cannot be a name in an OpenEXR file")))
}

/// The value as a finite 16-bit number; NaN is 0.
fn half(value: f64) -> f16 {
    // By way of single precision everywhere: processors that convert halves know no other
    f16::from_f32(finite(value, f64::from(f16::MAX.to_f32())) as f32)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use ::exr::prelude::{AnyChannels, FlatSamples, Image, Layer, ReadChannels, ReadLayers, read};

    use super::*;
    use crate::{PictureChannel, PixelRect};

    type ReadImage = Image<Layer<AnyChannels<FlatSamples>>>;

    fn read_back(picture: &Picture<'_>) -> ReadImage {
        let mut file = Cursor::new(Vec::new());
        picture.write_exr(&mut file).unwrap();
        let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        image.all_attributes().from_buffered(Cursor::new(file.into_inner())).unwrap()
    }

    fn values(image: &ReadImage, name: &str) -> Vec<f32> {
        let text = Text::new_or_panic(name);
        let channel = image.layer_data.channel_data.list.iter().find(|channel| channel.name == text);
        channel.unwrap_or_else(|| panic!("no channel {name}")).sample_data.values_as_f32().collect()
    }

    /// A picture whose values tell row, column and channel.
    fn numbered(size: [u32; 2], channels: Vec<PictureChannel>) -> Picture<'static> {
        let count = channels.len();
        Picture::new(size, channels, move |y, values| {
            for (i, value) in values.iter_mut().enumerate() {
                *value = f64::from(y) + (i / count) as f64 * 0.015_625 + (i % count) as f64 * 100.0;
            }
        })
    }

    #[test]
    fn exr_holds_every_channel_and_the_metadata() {
        let channels =
            [PictureChannel::single("b"), PictureChannel::half("a.X"), PictureChannel::single("A")];
        let metadata = [
            ("kind", MetadataValue::Text(String::from("ramp"))),
            ("count", MetadataValue::Integer(-5)),
            ("time", MetadataValue::Real(1.25)),
            ("never", MetadataValue::Real(f64::NAN)),
        ];
        let metadata = metadata.map(|(name, value)| (name.to_owned(), value)).to_vec();
        let image = read_back(&numbered([37, 21], channels.to_vec()).with_metadata("a brush 2", metadata));
        assert_eq!(image.layer_data.size, Vec2(37, 21));
        for (channel, name) in ["b", "a.X", "A"].into_iter().enumerate() {
            let exact = |i: usize| (i / 37) as f32 + (i % 37) as f32 * 0.015_625 + channel as f32 * 100.0;
            for (i, value) in values(&image, name).into_iter().enumerate() {
                let error = if name == "a.X" { 0.04 } else { 0.0 };
                assert!((value - exact(i)).abs() <= error, "{name}, pixel {i}: {value}");
            }
        }
        let attributes = &image.layer_data.attributes;
        let note = |name: &str| attributes.other[&Text::new_or_panic(name)].clone();
        assert_eq!(attributes.software_name, Some(Text::new_or_panic("a brush 2")));
        assert_eq!(note("kind"), AttributeValue::Text(Text::new_or_panic("ramp")));
        assert_eq!(note("count"), AttributeValue::I32(-5));
        assert_eq!(note("time"), AttributeValue::F64(1.25));
        assert_eq!(note("never"), AttributeValue::F64(0.0));
    }

    /// <https://github.com/AcademySoftwareFoundation/ColorInterop>: names of color spaces.
    #[test]
    fn exr_states_its_color() {
        let stated = |names: &[&str], is_data: bool| {
            let channels = names.iter().map(|name| PictureChannel::half(name)).collect();
            let image = read_back(&numbered([3, 2], channels).with_data(is_data));
            let id = image.layer_data.attributes.other.get(&Text::new_or_panic("colorInteropID")).cloned();
            (image.attributes.chromaticities, id)
        };
        let id = |name: &str| Some(AttributeValue::Text(Text::new_or_panic(name)));
        assert_eq!(stated(&["R", "G", "B", "albedo.R"], false), (Some(REC_709), id("lin_rec709_scene")));
        assert_eq!(stated(&["R", "G", "B"], true), (None, id("data")));
        assert_eq!(stated(&["Y"], false), (None, None));
    }

    #[test]
    fn exr_of_a_region_has_its_pixels_and_its_place() {
        let channels = vec![PictureChannel::single("Y")];
        let whole = values(&read_back(&numbered([40, 30], channels.clone())), "Y");
        let region = PixelRect { left: 7, top: 11, width: 5, height: 19 };
        let part = Picture::new([40, 30], channels, |y, values| {
            for (i, value) in values.iter_mut().enumerate() {
                *value = f64::from(y) + (i + 7) as f64 * 0.015_625;
            }
        });
        let image = read_back(&part.within(region, [40, 30]));
        assert_eq!(image.layer_data.size, Vec2(5, 19));
        assert_eq!(image.layer_data.attributes.layer_position, Vec2(7, 11));
        assert_eq!(image.attributes.display_window, IntegerBounds::from_dimensions(Vec2(40, 30)));
        for (i, value) in values(&image, "Y").into_iter().enumerate() {
            assert_eq!(value, whole[(11 + i / 5) * 40 + 7 + i % 5], "pixel {i}");
        }
    }

    #[test]
    fn exr_holds_many_chunks_of_noise() {
        // More chunks than are compressed at once, and too little in common to become shorter
        let noise = |y: u32, x: usize| (y * 2 + x as u32).wrapping_mul(2_654_435_769) as f32;
        let picture = Picture::new([2, 530], vec![PictureChannel::single("Y")], |y, values| {
            (0..).zip(values).for_each(|(x, value)| *value = f64::from(noise(y, x)));
        });
        for (i, value) in values(&read_back(&picture), "Y").into_iter().enumerate() {
            assert_eq!(value, noise(i as u32 / 2, i % 2), "pixel {i}");
        }
    }

    #[test]
    fn exr_has_finite_values_only() {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300];
        let channels = vec![PictureChannel::single("single"), PictureChannel::half("half")];
        let fill = |_, values: &mut [f64]| {
            values.chunks_exact_mut(2).zip(odd).for_each(|(pixel, value)| pixel.fill(value));
        };
        let image = read_back(&Picture::new([4, 1], channels, fill));
        assert_eq!(values(&image, "single"), [0.0, f32::MAX, f32::MIN, f32::MAX]);
        assert_eq!(values(&image, "half"), [0.0, 65504.0, -65504.0, 65504.0]);
    }

    #[test]
    fn exr_of_no_picture_is_an_error() {
        let one = || vec![PictureChannel::single("Y")];
        let twice = [one(), one()].concat();
        let part = |width, height| {
            numbered([3, 2], one()).within(PixelRect { left: 1, top: 1, width, height }, [3, 2])
        };
        for (picture, words) in [
            (numbered([0, 2], one()), "not a part of 0x2"),
            (numbered([3, 2], Vec::new()), "no channels"),
            (numbered([3, 2], twice), "two channels Y"),
            (numbered([3, 2], vec![PictureChannel::half("")]), "cannot be a name"),
            (part(0, 1), "not a part"),
            (part(3, 1), "the region 1,1,4,2 is not a part of 3x2 pixels"),
            (part(1, 2), "not a part"),
            (numbered([u32::MAX, 1], one()), "too many"),
        ] {
            let error = picture.write_exr(Cursor::new(Vec::new())).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
        let nameless = vec![(String::new(), MetadataValue::Integer(1))];
        let picture = numbered([3, 2], one()).with_metadata("", nameless);
        assert!(picture.write_exr(Cursor::new(Vec::new())).is_err());
    }
}
