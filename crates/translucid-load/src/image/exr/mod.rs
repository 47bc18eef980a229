//! OpenEXR images.

mod names;
mod parts;
mod picture;
mod stated;

use translucid_scene::{SceneError, Warning};

use super::encoding::Samples;
use super::file_bytes::ImageBytes;
use super::{Decoded, Picture as Decoding};
use crate::result::Result;
use parts::{Parts, Plane};
use picture::Picture;

/// Reads the picture of a file, in whatever part it is: channels R, G, B (and A), or Y as grey, or else three others. X, Y, Z
/// without a layer are CIE XYZ.
///
/// A file of nothing but a depth is refused: it is no picture. So is one of several layers none of which is called a picture.
///
/// Channels of a layer ("beauty.R") are taken if there are none without.
/// Pixels of the display window that the data window does not cover are black and clear.
pub(super) fn decode(source: &ImageBytes<'_>, warnings: &mut Vec<Warning>) -> Decoded {
    let parts = Parts::open(source)?;
    let picture = Picture::choose(&parts.names())
        .map_err(|(message, help)| SceneError { help, ..source.error(message) })?;
    let channels = picture.channels();
    let window = parts.display_window(channels[0]);
    let [width, height] = window.size;
    let mut pixels = Vec::with_capacity(source.check_size(width, height)?);
    let planes = parts.read(&channels)?;
    let plane = |channel: usize| channels.iter().position(|other| *other == channel).map(|i| &planes[i]);
    let color = picture.color.map(|channel| channel.and_then(plane));
    let alpha = picture.alpha.and_then(plane);
    for y in (window.start[1]..).take(height) {
        pixels.extend((window.start[0]..).take(width).map(|x| pixel(color, alpha, [x, y])));
    }
    if let Some(message) = picture.said {
        warnings.push(Warning { message, place: Some(source.place.clone()) });
    }
    let stated = stated::stated(parts.header(channels[0]));
    let stated = stated.or_else(|| picture.is_xyz.then(|| stated::xyz("channels X, Y, Z")));
    Ok(Decoding { stated, ..Decoding::plain([width, height], Samples::Float(pixels)) })
}

/// A pixel of the planes of red, green and blue, and of alpha if there is one.
fn pixel(color: [Option<&Plane>; 3], alpha: Option<&Plane>, at: [i64; 2]) -> [f32; 4] {
    let value = |plane: &Plane| plane.window.index(at).map(|index| plane.values[index]);
    let [r, g, b] = color.map(|plane| plane.and_then(value));
    if [r, g, b] == [None; 3] {
        return [0.0; 4];
    }
    let alpha = alpha.map_or(1.0, |alpha| value(alpha).unwrap_or_default());
    let [r, g, b] = [r, g, b].map(Option::unwrap_or_default);
    [r, g, b, alpha]
}

/// All channels of an OpenEXR file, whatever its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrChannels {
    /// Width and height in pixels of the smallest window around the data windows of all parts.
    pub size: [usize; 2],
    /// Its upper left pixel.
    pub position: [i32; 2],
    /// Names as a file of one part has them, and values row by row from the top; 0 outside of the part's data window.
    ///
    /// Within a part they are sorted by name.
    pub channels: Vec<(String, Vec<f32>)>,
}

/// Reads all channels of all parts.
pub(super) fn decode_channels(source: &ImageBytes<'_>) -> Result<ExrChannels> {
    let parts = Parts::open(source)?;
    let names: Vec<String> = parts.names().into_iter().map(str::to_owned).collect();
    let windows = (0..names.len()).map(|channel| parts.data_window(channel));
    let window = windows.reduce(parts::Window::union);
    let window = window.ok_or_else(|| source.error("the OpenEXR file has no channels"))?;
    let pixels = source.check_size(window.size[0], window.size[1])?;
    source.check_samples((pixels as u64).saturating_mul(names.len() as u64))?;
    let planes = parts.read(&(0..names.len()).collect::<Vec<_>>())?.into_iter();
    let channels = names.into_iter().zip(planes.map(|plane| plane.placed_in(window))).collect();
    Ok(ExrChannels { size: window.size, position: window.start.map(|start| start as i32), channels })
}

/// A small valid file.
#[cfg(test)]
pub(super) fn example() -> Vec<u8> {
    use exr::prelude::{Image, WritableImage};
    let mut bytes = std::io::Cursor::new(Vec::new());
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
    use std::io::Cursor;
    use std::path::Path;

    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, ImageAttributes, IntegerBounds,
        Layer, LayerAttributes, SmallVec, Text, Vec2, WritableImage, f16,
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

    fn decoded(bytes: &[u8]) -> Result<(Image, Vec<Warning>)> {
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
        let attributes = LayerAttributes::default().with_position(Vec2(1, 0));
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
    fn exr_of_other_primaries_becomes_rec_709() {
        use exr::meta::attribute::{AttributeValue, Chromaticities};
        let with = |change: &dyn Fn(&mut ImageAttributes)| {
            let mut image = file(&["R", "G", "B"], LayerAttributes::default(), Encoding::UNCOMPRESSED);
            for (channel, value) in image.layer_data.channel_data.list.iter_mut().zip([0.2, 0.8, 0.2]) {
                channel.sample_data = FlatSamples::F32(vec![value; 6]);
            }
            change(&mut image.attributes);
            decoded(&bytes(&image)).unwrap()
        };
        let id = |id: &str| {
            with(&|attributes| {
                attributes.other.insert("colorInteropID".into(), AttributeValue::Text(id.into()));
            })
        };
        let expected = [-0.1731_f32, 0.8845, 0.1226];
        let is_near = |image: &Image, expected: [f32; 3]| {
            image
                .texel(1, 1)
                .into_iter()
                .zip(expected)
                .all(|(value, expected)| (value - expected).abs() < 5e-4)
        };
        let ap1 = Chromaticities {
            red: Vec2(0.713, 0.293),
            green: Vec2(0.165, 0.83),
            blue: Vec2(0.128, 0.044),
            white: Vec2(0.32168, 0.33767),
        };
        let stated = with(&|attributes| attributes.chromaticities = Some(ap1)).0;
        assert!(is_near(&stated, expected), "{:?}", stated.texel(1, 1));
        let named = id("lin_ap1_scene").0;
        assert!(is_near(&named, expected), "{:?}", named.texel(1, 1));
        assert!(is_near(&id("lin_rec709_scene").0, [0.2, 0.8, 0.2]));
        // sRGB's curve and the matrix of SMPTE EG 432-1
        assert!(
            is_near(&id("srgb_p3d65_scene").0, [-0.0953, 0.6278, -0.0118]),
            "{:?}",
            id("srgb_p3d65_scene").0.texel(1, 1)
        );
        let aces = with(&|attributes| {
            attributes.other.insert("acesImageContainerFlag".into(), AttributeValue::I32(1));
        });
        // The matrix of AP0 to Rec. 709 by Bradford has 2.5217, −1.1341, −0.3877 in its first row
        assert!((aces.0.texel(0, 0)[0] - (0.2 * 2.5217 - 0.8 * 1.1341 - 0.2 * 0.3877)).abs() < 2e-3);
        // The matrix of IEC 61966-2-1 from X, Y, Z
        let xyz = Chromaticities {
            red: Vec2(1.0, 0.0),
            green: Vec2(0.0, 1.0),
            blue: Vec2(0.0, 0.0),
            white: Vec2(1.0 / 3.0, 1.0 / 3.0),
        };
        let stated = with(&|attributes| attributes.chromaticities = Some(xyz)).0;
        assert!(is_near(&stated, [-0.6814, 1.3152, 0.0593]), "{:?}", stated.texel(1, 1));
        let mut named = file(&["X", "Y", "Z"], LayerAttributes::default(), Encoding::FAST_LOSSLESS);
        for (channel, value) in named.layer_data.channel_data.list.iter_mut().zip([0.2, 0.8, 0.2]) {
            channel.sample_data = FlatSamples::F32(vec![value; 6]);
        }
        let named = decoded(&bytes(&named)).unwrap().0;
        assert!(is_near(&named, [-0.6814, 1.3152, 0.0593]), "{:?}", named.texel(1, 1));
        let (image, warnings) = id("ocio:something");
        assert!(is_near(&image, [0.2, 0.8, 0.2]));
        assert!(
            warnings[0].to_string().contains("colorInteropID \"ocio:something\" is not known"),
            "{warnings:?}"
        );
    }

    type Part = Layer<AnyChannels<FlatSamples>>;

    /// A part of 3 × 2 pixels, as [`file`] has it, with its name and the column where it begins.
    fn part(name: &str, start: i32, channels: &[&str]) -> Part {
        let attributes = LayerAttributes::named(name).with_position(Vec2(start, 0));
        file(channels, attributes, Encoding::FAST_LOSSLESS).layer_data
    }

    /// A file of these parts, whose display window has 4 × 2 pixels.
    fn parts(parts: &[Part]) -> Vec<u8> {
        let window = ImageAttributes::new(IntegerBounds::from_dimensions((4, 2)));
        let mut bytes = Cursor::new(Vec::new());
        ExrImage::from_layers(window, parts.to_vec()).write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn channels(bytes: &[u8]) -> Result<ExrChannels> {
        decode_channels(&ImageBytes { place: &Place::file(Path::new("a.exr")), bytes })
    }

    fn names(bytes: &[u8]) -> Vec<String> {
        channels(bytes).unwrap().channels.into_iter().map(|(name, _)| name).collect()
    }

    fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        let starts: Vec<usize> =
            (0..bytes.len() - from.len()).filter(|&start| bytes[start..].starts_with(from)).collect();
        assert!(!starts.is_empty());
        for start in starts.into_iter().rev() {
            bytes.splice(start..start + from.len(), to.iter().copied());
        }
        bytes
    }

    /// As Blender writes a file whose Interleave is off.
    fn passes() -> Vec<u8> {
        let combined = ["V.Combined.A", "V.Combined.B", "V.Combined.G", "V.Combined.R"];
        let mut depth = part("V.Depth", 0, &["V.Depth.Z"]);
        depth.channel_data.list[0].sample_data = FlatSamples::F16(vec![f16::from_f32(0.5); 6]);
        let mut index = part("V.Index", 0, &["V.Index.X"]);
        index.channel_data.list[0].sample_data = FlatSamples::U32(vec![7; 6]);
        parts(&[depth, part("V.Combined", 0, &combined), index])
    }

    #[test]
    fn exr_of_several_parts_has_the_channels_of_all() {
        let read = channels(&passes()).unwrap();
        assert_eq!((read.size, read.position), ([3, 2], [0, 0]));
        let expected = [
            ("V.Depth.Z", [0.5; 6]),
            ("V.Combined.A", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]),
            ("V.Combined.B", [10.0, 11.0, 12.0, 13.0, 14.0, 15.0]),
            ("V.Combined.G", [20.0, 21.0, 22.0, 23.0, 24.0, 25.0]),
            ("V.Combined.R", [30.0, 31.0, 32.0, 33.0, 34.0, 35.0]),
            ("V.Index.X", [7.0; 6]),
        ];
        assert_eq!(read.channels, expected.map(|(name, values)| (name.to_owned(), values.to_vec())));
        let (image, warnings) = decoded(&passes()).unwrap();
        assert_eq!(image.texel(1, 0), [31.0, 21.0, 11.0, 1.0]);
        assert_eq!(image.texel(3, 0), [0.0; 4]);
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn exr_of_parts_with_the_same_names_has_those_of_one_part() {
        let rgb = ["B", "G", "R"];
        let two = parts(&[part("albedo", 0, &rgb), part("beauty", 0, &["A", "B", "G", "R"])]);
        assert_eq!(names(&two), ["albedo.B", "albedo.G", "albedo.R", "A", "B", "G", "R"]);
        let (image, warnings) = decoded(&two).unwrap();
        assert_eq!(image.texel(1, 0), [31.0, 21.0, 11.0, 1.0]);
        assert!(warnings.is_empty(), "{warnings:?}");

        let first = parts(&[part("a", 0, &["B", "G", "R", "Z"]), part("b", 0, &rgb), part("c", 0, &["Z"])]);
        assert_eq!(names(&first), ["B", "G", "R", "Z", "b.B", "b.G", "b.R", "c.Z"]);
        // Names that repeat and names that lack do not tell parts apart.
        let again = replaced(&first, b"name\0string\0\x01\0\0\0b", b"name\0string\0\x01\0\0\0a");
        assert_eq!(names(&again)[4..], ["a.B", "a.G", "a.R", "c.Z"]);
        let nameless = replaced(&first, b"name\0string", b"nane\0string");
        assert_eq!(names(&nameless)[4..], ["part 2.B", "part 2.G", "part 2.R", "part 3.Z"]);

        let mut views =
            [part("l", 0, &["V.Combined.R"]), part("r", 0, &["V.Combined.R"]), part("d", 0, &["V.d.Z"])];
        for (part, view) in views.iter_mut().zip(["left", "right"]) {
            part.attributes.view_name = Some(Text::from(view));
        }
        assert_eq!(names(&parts(&views)), ["V.Combined.left.R", "V.Combined.right.R", "V.d.Z"]);
        let warnings = decoded(&parts(&views)).unwrap().1;
        assert!(
            warnings[0].to_string().contains("a.exr: the layer \"V.Combined.left\" is taken"),
            "{warnings:?}"
        );
    }

    #[test]
    fn exr_of_parts_with_windows_of_their_own_keeps_their_places() {
        let windows = parts(&[part("near", 0, &["near.V"]), part("far", 1, &["A", "B", "G", "R"])]);
        let read = channels(&windows).unwrap();
        assert_eq!((read.size, read.position), ([4, 2], [0, 0]));
        assert_eq!(read.channels[0].1, [0.0, 1.0, 2.0, 0.0, 3.0, 4.0, 5.0, 0.0]);
        assert_eq!(read.channels[2].1, [0.0, 10.0, 11.0, 12.0, 0.0, 13.0, 14.0, 15.0]);
        let image = decoded(&windows).unwrap().0;
        assert_eq!([image.texel(0, 0), image.texel(1, 0)], [[0.0; 4], [30.0, 20.0, 10.0, 0.0]]);
        let apart = channels(&parts(&[part("a", 0, &["a.V"]), part("b", 40_000, &["b.V"])]));
        let message = apart.unwrap_err().to_string();
        assert!(message.contains("too large: 40003 × 2 pixels"), "{message}");
    }

    #[test]
    fn exr_of_a_codec_or_part_that_cannot_be_read_is_refused_with_their_names() {
        let codec = b"compression\0compression\0\x01\0\0\0";
        let with = |file: &[u8], code: u8| {
            replaced(file, &[&codec[..], &[1]].concat(), &[&codec[..], &[code]].concat())
        };
        let rle = bytes(&file(&["B", "G", "R"], LayerAttributes::default(), Encoding::FAST_LOSSLESS));
        let deep = replaced(&passes(), b"\x0a\0\0\0tiledimage", b"\x08\0\0\0deeptile");
        for (file, expected) in [
            (with(&rle, 11), "a.exr: the OpenEXR file is compressed with HTJ2K, but only NONE, RLE"),
            (with(&rle, 13), "a.exr: the OpenEXR file is compressed with ZSTD, but only NONE, RLE"),
            (
                with(&passes(), 10),
                "a.exr: part 2 (\"V.Combined\") of the OpenEXR file is compressed with HTJ2K",
            ),
            (deep, "a.exr: part 1 (\"V.Depth\") of the OpenEXR file holds deep data, but only flat data"),
        ] {
            let message = decoded(&file).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
        let help = decoded(&with(&rle, 11)).unwrap_err().help.unwrap();
        assert!(
            help.contains("in Blender, set Codec in Output Properties to one such as ZIP or DWAA"),
            "{help}"
        );
    }

    #[test]
    fn exr_claims_no_more_than_its_bytes_may_hold() {
        let names: Vec<String> = (0..5000).map(|i| format!("c{i:04}")).collect();
        let many: Vec<&str> = names.iter().map(String::as_str).collect();
        let message = channels(&plain(&many)).unwrap_err().to_string();
        assert!(message.contains("5000 channels, but at most 4096"), "{message}");
        // A window of 2048 × 2048 pixels is small for one channel, but not for a hundred
        let window = |columns: i32, rows: i32| {
            [&b"dataWindow\0box2i\0\x10\0\0\0"[..], &[0; 8], &columns.to_le_bytes(), &rows.to_le_bytes()]
                .concat()
        };
        let claim = replaced(&plain(&many[..100]), &window(2, 1), &window(2047, 2047));
        let message = channels(&claim).unwrap_err().to_string();
        assert!(message.contains("hold 419430400 values"), "{message}");
    }

    #[test]
    fn exr_of_several_parts_survives_any_mutation() {
        for mutant in translucid_testing::mutants(&passes(), 2_000) {
            let _ = (decoded(&mutant), channels(&mutant));
        }
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
