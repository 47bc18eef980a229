//! OpenEXR images.

use std::io::Cursor;

use exr::error::Error;
use exr::image::{AnyChannels, FlatSamples, Layer};
use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, read};
use translucid_scene::{Pixels, SceneError};

use super::Decoded;
use super::file_bytes::ImageBytes;

/// Most channels of a layer: they are all in memory at once.
const MOST_CHANNELS: usize = 64;

/// Reads the first layer: its channels R, G, B (and A), or Y as grey, or else the first three.
///
/// A file of nothing but a depth is refused: it is no picture.
///
/// Channels of a group ("beauty.R") are taken if there are none without.
/// Pixels of the display window that the data window does not cover are black and clear.
pub(super) fn decode(source: &ImageBytes<'_>) -> Decoded {
    let image = read_first_layer(source)?;
    let window = image.attributes.display_window;
    let start = image.layer_data.attributes.layer_position;
    let planes = Planes::choose(&image.layer_data).map_err(|message| source.error(message))?;
    let [width, height] = [window.size.0, window.size.1];
    let mut pixels = Vec::with_capacity(source.check_size(width, height)?);
    for y in 0..height {
        let row = y as i64 + i64::from(window.position.1) - i64::from(start.1);
        let column = i64::from(window.position.0) - i64::from(start.0);
        pixels.extend((0..width).map(|x| planes.pixel(x as i64 + column, row)));
    }
    Ok(([width, height], Pixels::Float(pixels)))
}

/// All channels of the first layer of an OpenEXR file, as they are in it.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrChannels {
    /// Width and height of the data window in pixels.
    pub size: [usize; 2],
    /// Upper left pixel of the data window.
    pub position: [i32; 2],
    /// Names, sorted, and values row by row from the top.
    pub channels: Vec<(String, Vec<f32>)>,
}

/// Reads all channels of the first layer.
pub(super) fn decode_channels(source: &ImageBytes<'_>) -> Result<ExrChannels, SceneError> {
    let layer = read_first_layer(source)?.layer_data;
    let values = |samples: FlatSamples| match samples {
        FlatSamples::F16(values) => values.into_iter().map(|value| value.to_f32()).collect(),
        FlatSamples::F32(values) => values,
        FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
    };
    let position = layer.attributes.layer_position;
    let channels = layer.channel_data.list.into_iter();
    Ok(ExrChannels {
        size: [layer.size.0, layer.size.1],
        position: [position.0, position.1],
        channels: channels.map(|channel| (channel.name.to_string(), values(channel.sample_data))).collect(),
    })
}

type ExrImage = exr::image::Image<Layer<AnyChannels<FlatSamples>>>;

/// The first layer, once it is known to be of a size that can be read.
fn read_first_layer(source: &ImageBytes<'_>) -> Result<ExrImage, SceneError> {
    let metadata = MetaData::read_from_buffered(Cursor::new(source.bytes), false);
    for header in metadata.map_err(|error| refusal(source, &error))?.headers {
        check_layer(source, &header)?;
    }
    read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(source.bytes))
        .map_err(|error| refusal(source, &error))
}

fn refusal(source: &ImageBytes<'_>, error: &Error) -> SceneError {
    let refused = source.error(format!("cannot read the OpenEXR file: {error}"));
    match error {
        Error::NotSupported(_) => {
            refused.with_help("save it as flat scan lines or tiles with ZIP, PIZ or RLE compression")
        }
        _ => refused,
    }
}

/// Refuses what would need memory without bound, before it is asked for.
fn check_layer(source: &ImageBytes<'_>, header: &Header) -> Result<(), SceneError> {
    source.check_size(header.layer_size.0, header.layer_size.1)?;
    let channels = &header.channels.list;
    if channels.len() > MOST_CHANNELS {
        let message =
            format!("a layer has {} channels, but at most {MOST_CHANNELS} can be read", channels.len());
        return Err(source.error(message));
    }
    match channels.iter().find(|channel| channel.sampling.0 != 1 || channel.sampling.1 != 1) {
        Some(channel) => {
            let message = format!("channel {} is subsampled, which cannot be read", channel.name);
            Err(source.error(message).with_help("save it with full channels R, G, B"))
        }
        None => Ok(()),
    }
}

/// The samples of red, green, blue and alpha, each of the whole data window.
struct Planes<'a> {
    color: [Option<&'a FlatSamples>; 3],
    alpha: Option<&'a FlatSamples>,
    width: i64,
    height: i64,
}

impl<'a> Planes<'a> {
    fn choose(layer: &'a Layer<AnyChannels<FlatSamples>>) -> Result<Self, String> {
        let names: Vec<String> =
            layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
        let plane = |i: usize| layer.channel_data.list.get(i).map(|channel| &channel.sample_data);
        let named = |name: String| names.iter().position(|other| *other == name).and_then(plane);
        let group = |name: &str| {
            let full = names.iter().find(|other| other.rsplit('.').next() == Some(name))?;
            Some(&full[..full.len() - name.len()])
        };
        // Prefer channels without a group, then the first group that has red or grey.
        let prefix = ["R", "Y"].into_iter().find_map(|name| {
            let plain = names.iter().any(|other| other == name).then_some("");
            plain.or_else(|| group(name))
        });
        let member = |name: &str| named(format!("{}{name}", prefix.unwrap_or_default()));
        let color = match (member("R"), member("Y")) {
            (Some(red), _) => [Some(red), member("G"), member("B")],
            (None, Some(grey)) => [Some(grey); 3],
            (None, None) if names.is_empty() => return Err(String::from("the OpenEXR file has no channels")),
            (None, None) if names.iter().all(|name| is_depth(name)) => {
                let names = names.join(", ");
                return Err(format!("the OpenEXR file is no picture, but a depth: its channels are {names}"));
            }
            (None, None) if names.len() == 1 => [plane(0); 3],
            (None, None) => [plane(0), plane(1), plane(2)],
        };
        let [width, height] = [layer.size.0, layer.size.1].map(|edge| edge as i64);
        Ok(Self { color, alpha: member("A"), width, height })
    }

    fn pixel(&self, x: i64, y: i64) -> [f32; 4] {
        if !(0..self.width).contains(&x) || !(0..self.height).contains(&y) {
            return [0.0; 4];
        }
        let index = (y * self.width + x) as usize;
        let [r, g, b] = self.color.map(|plane| plane.map_or(0.0, |plane| sample(plane, index)));
        [r, g, b, self.alpha.map_or(1.0, |plane| sample(plane, index))]
    }
}

/// Whether a channel holds distances, by the names that OpenEXR and programs have for it.
fn is_depth(name: &str) -> bool {
    matches!(name.rsplit('.').next(), Some("Z" | "ZBack" | "depth" | "Depth"))
}

fn sample(plane: &FlatSamples, index: usize) -> f32 {
    match plane {
        FlatSamples::F16(values) => values.get(index).map_or(0.0, |value| value.to_f32()),
        FlatSamples::F32(values) => values.get(index).copied().unwrap_or_default(),
        FlatSamples::U32(values) => values.get(index).map_or(0.0, |&value| value as f32),
    }
}

/// A small valid file.
#[cfg(test)]
pub(super) fn example() -> Vec<u8> {
    use exr::prelude::{Image, WritableImage};
    let mut bytes = Cursor::new(Vec::new());
    let image = Image::from_channels(
        (9, 7),
        exr::image::SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
            (at.x() as f32, at.y() as f32, 0.5_f32)
        }),
    );
    image.write().to_buffered(&mut bytes).expect("a valid image");
    bytes.into_inner()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use exr::prelude::{
        AnyChannel, Encoding, Image as ExrImage, IntegerBounds, LayerAttributes, SmallVec, WritableImage,
    };
    use translucid_scene::{ColorSpace, Image, Place, Warning};

    use super::*;
    use crate::decode_image;

    /// A file of 3 × 2 pixels whose channel c has the value 10 c + index.
    fn file(
        names: &[&str],
        attributes: LayerAttributes,
        encoding: Encoding,
    ) -> ExrImage<Layer<AnyChannels<FlatSamples>>> {
        let channel = |(c, name): (usize, &&str)| {
            let values = (0..6).map(|i| (10 * c + i) as f32).collect();
            AnyChannel::new(*name, FlatSamples::F32(values))
        };
        let list: SmallVec<[AnyChannel<FlatSamples>; 4]> = names.iter().enumerate().map(channel).collect();
        ExrImage::from_layer(Layer::new((3, 2), attributes, encoding, AnyChannels::sort(list)))
    }

    fn bytes(image: &ExrImage<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn plain(names: &[&str]) -> Vec<u8> {
        bytes(&file(names, LayerAttributes::default(), Encoding::FAST_LOSSLESS))
    }

    fn decoded(bytes: &[u8]) -> Result<(Image, Vec<Warning>), SceneError> {
        let mut warnings = Vec::new();
        let place = Place::file(Path::new("a.exr"));
        let image = decode_image(&place, bytes, ColorSpace::Srgb, &mut warnings)?;
        Ok((image, warnings))
    }

    #[test]
    fn exr_finds_its_channels_by_name() {
        let texel = |names: &[&str]| decoded(&plain(names)).unwrap().0.texel(1, 0);
        assert_eq!(texel(&["R", "G", "B"]), [1.0, 11.0, 21.0, 1.0]);
        assert_eq!(texel(&["A", "B", "G", "R", "Z"]), [31.0, 21.0, 11.0, 1.0]);
        assert_eq!(texel(&["Y"]), [1.0, 1.0, 1.0, 1.0]);
        assert_eq!(texel(&["mask"]), [1.0, 1.0, 1.0, 1.0]);
        let error = decoded(&plain(&["Z", "ZBack"])).unwrap_err().to_string();
        assert!(error.ends_with("is no picture, but a depth: its channels are Z, ZBack"), "{error}");
        assert_eq!(texel(&["x", "y", "z", "zz"]), [1.0, 11.0, 21.0, 1.0]);
        assert_eq!(texel(&["u", "v"]), [1.0, 11.0, 0.0, 1.0]);
        let grouped = ["albedo.B", "albedo.G", "albedo.R", "B", "G", "R"];
        assert_eq!(texel(&grouped), [51.0, 41.0, 31.0, 1.0]);
        assert_eq!(texel(&["b.A", "b.B", "b.G", "b.R", "depth"]), [31.0, 21.0, 11.0, 1.0]);
    }

    #[test]
    fn exr_is_linear_and_counts_what_is_not_finite() {
        let mut image = file(&["R", "G", "B"], LayerAttributes::default(), Encoding::UNCOMPRESSED);
        let mut broken = vec![1.0_f32; 6];
        broken[2] = f32::NAN;
        broken[5] = f32::INFINITY;
        image.layer_data.channel_data.list[0].sample_data = FlatSamples::F32(broken);
        let (image, warnings) = decoded(&bytes(&image)).unwrap();
        assert_eq!(image.color_space, ColorSpace::Linear);
        assert_eq!(image.texel(2, 0)[2], 0.0);
        assert_eq!(warnings.len(), 1);
        let expected = "a.exr: 2 pixels have values that are NaN or infinite: set to 0";
        assert_eq!(warnings[0].to_string(), expected);
    }

    #[test]
    fn exr_of_a_smaller_data_window_keeps_its_place() {
        let attributes = LayerAttributes::default().with_position(exr::math::Vec2(1, 0));
        let mut image = file(&["R", "G", "B"], attributes, Encoding::FAST_LOSSLESS);
        image.attributes.display_window = IntegerBounds::new((0, -1), (5, 3));
        let (image, _) = decoded(&bytes(&image)).unwrap();
        assert_eq!((image.width, image.height), (5, 3));
        assert_eq!(image.texel(0, 1), [0.0; 4]);
        assert_eq!(image.texel(1, 0), [0.0; 4]);
        assert_eq!(image.texel(1, 1), [0.0, 10.0, 20.0, 1.0]);
        assert_eq!(image.texel(3, 2), [5.0, 15.0, 25.0, 1.0]);
    }

    #[test]
    fn exr_that_is_broken_is_refused_with_its_name() {
        let good = plain(&["R", "G", "B"]);
        let window = good.windows(10).position(|bytes| bytes == b"dataWindow").unwrap();
        let mut huge = good.clone();
        huge[window + 27..window + 31].copy_from_slice(&0x7000_0000_i32.to_le_bytes());
        let mut version = good.clone();
        version[4] = 9;
        for bytes in [&good[..4], &good[..100], &good[..good.len() - 20], &huge, &version] {
            let message = decoded(bytes).unwrap_err().to_string();
            assert!(message.starts_with("a.exr: "), "{message}");
            assert!(message.contains("OpenEXR") || message.contains("too large"), "{message}");
        }
    }
}
