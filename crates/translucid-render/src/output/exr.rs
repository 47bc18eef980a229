//! OpenEXR files: linear radiance, layers and metadata.

use std::io;
use std::path::Path;

use ::exr::meta::attribute::AttributeValue;
use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, Text, WritableImage, f16,
};

use super::{Denoised, OutputError, write_atomically};
use crate::render::film::{FilmSums, layer};

/// What a picture's metadata says about its making.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageInfo {
    /// Where the scene came from.
    pub scene: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Samples per pixel: the fewest that any pixel has.
    pub samples: u32,
    /// Time spent rendering, in seconds, over all runs that added to the picture.
    pub seconds: f64,
    /// The command line that made it.
    pub command: String,
}

impl ImageInfo {
    /// Program and version, as both file formats state it.
    pub(super) fn software() -> String {
        format!("translucid {}", env!("CARGO_PKG_VERSION"))
    }

    /// The metadata as attributes of an OpenEXR header.
    fn attributes(&self) -> LayerAttributes {
        let text = |value: &str| Text::new_or_none(value).unwrap_or_else(|| Text::new_or_panic("?"));
        let mut attributes =
            LayerAttributes { software_name: Some(text(&Self::software())), ..Default::default() };
        for (name, value) in [
            ("translucidScene", AttributeValue::Text(text(&self.scene))),
            ("translucidCommand", AttributeValue::Text(text(&self.command))),
            ("translucidVersion", AttributeValue::Text(text(env!("CARGO_PKG_VERSION")))),
            // The format has no 64-bit integer.
            ("translucidSeed", AttributeValue::Text(text(&self.seed.to_string()))),
            ("translucidSamples", AttributeValue::I32(self.samples.min(i32::MAX as u32) as i32)),
            (
                "translucidSeconds",
                AttributeValue::F64(if self.seconds.is_finite() { self.seconds } else { 0.0 }),
            ),
        ] {
            attributes.other.insert(Text::new_or_panic(name), value);
        }
        attributes
    }
}

/// Writes all layers of a film as an OpenEXR file of one part, ZIP-compressed.
///
/// | channels | content | type |
/// |---|---|---|
/// | `R G B A` | radiance and coverage | 32-bit |
/// | `diffuse.RGB`, `specular.RGB`, `subsurface.RGB`, `emission.RGB` | light by its last event before the camera; they sum to `RGB` | 16-bit |
/// | `albedo.RGB` | albedo of the first surface | 16-bit |
/// | `normal.XYZ` | shading normal of the first surface, world space | 16-bit |
/// | `depth.Z` | mean distance to the first surface \[L\], 0 where there is none | 32-bit |
///
/// Colors are linear Rec. 709 and, as the format demands, multiplied by coverage; so are albedo and normal.
/// Values beyond a type's range become its greatest finite value, NaN becomes 0.
///
/// # Errors
/// The file cannot be written.
pub fn write_exr(path: &Path, film: &FilmSums, info: &ImageInfo) -> Result<(), OutputError> {
    write(path, film, None, info)
}

/// Writes the same and the denoised picture beside it, as 32-bit channels `denoised.RGB`.
///
/// The attribute `translucidDenoiser` says what has denoised it; all other channels are those of [`write_exr`].
/// Pixels that `denoised` does not have are 0.
///
/// # Errors
/// The file cannot be written.
pub fn write_exr_with_denoised(
    path: &Path,
    film: &FilmSums,
    denoised: &Denoised,
    info: &ImageInfo,
) -> Result<(), OutputError> {
    write(path, film, Some(denoised), info)
}

fn write(
    path: &Path,
    film: &FilmSums,
    denoised: Option<&Denoised>,
    info: &ImageInfo,
) -> Result<(), OutputError> {
    let size = (film.width as usize, film.height as usize);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let mut attributes = info.attributes();
    if let Some(by) = denoised.and_then(|denoised| Text::new_or_none(&denoised.by)) {
        attributes.other.insert(Text::new_or_panic("translucidDenoiser"), AttributeValue::Text(by));
    }
    let image = Image::from_layer(Layer::new(size, attributes, encoding, channels(film, denoised)));
    write_atomically(path, |out| image.write().to_buffered(out).map_err(io::Error::other))
}

/// All channels of the file, sorted by name as the format demands; in one pass over the film, since a
/// second copy of its sums would be as large as the first.
fn channels(film: &FilmSums, denoised: Option<&Denoised>) -> AnyChannels<FlatSamples> {
    let halves = half_channels();
    let count = film.width as usize * film.height as usize;
    let mut single_data = [(); SINGLE_CHANNELS.len()].map(|()| Vec::with_capacity(count));
    let mut half_data: Vec<Vec<f16>> = halves.iter().map(|_| Vec::with_capacity(count)).collect();
    for (x, y) in pixels(film) {
        let (mean, [r, g, b]) = (film.mean(x, y), film.radiance(x, y));
        for (data, value) in single_data.iter_mut().zip([r, g, b, mean[layer::ALPHA], mean_depth(&mean)]) {
            data.push(finite(value, f64::from(f32::MAX)) as f32);
        }
        for (data, (_, index)) in half_data.iter_mut().zip(&halves) {
            data.push(f16::from_f64(finite(mean[*index], f64::from(f16::MAX.to_f32()))));
        }
    }
    let singles = SINGLE_CHANNELS.iter().zip(single_data);
    let singles =
        singles.map(|(name, data)| AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(data)));
    let halves = halves.iter().zip(half_data);
    let halves =
        halves.map(|((name, _), data)| AnyChannel::new(Text::new_or_panic(name), FlatSamples::F16(data)));
    let denoised = denoised.into_iter().flat_map(|denoised| {
        let pixel = |i: usize| denoised.radiance.get(i).copied().unwrap_or_default();
        ["denoised.R", "denoised.G", "denoised.B"].into_iter().enumerate().map(move |(channel, name)| {
            let data = (0..count).map(|i| finite(f64::from(pixel(i)[channel]), f64::from(f32::MAX)) as f32);
            AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(data.collect()))
        })
    });
    AnyChannels::sort(singles.chain(halves).chain(denoised).collect())
}

/// Channels of 32 bits.
const SINGLE_CHANNELS: [&str; 5] = ["R", "G", "B", "A", "depth.Z"];

/// Channels of 16 bits: name and index among the sums.
fn half_channels() -> Vec<(String, usize)> {
    [
        ("diffuse", layer::DIFFUSE, "RGB"),
        ("specular", layer::SPECULAR, "RGB"),
        ("subsurface", layer::SUBSURFACE, "RGB"),
        ("emission", layer::EMISSION, "RGB"),
        ("albedo", layer::ALBEDO, "RGB"),
        ("normal", layer::NORMAL, "XYZ"),
    ]
    .into_iter()
    .flat_map(|(name, range, components)| {
        range.zip(components.chars()).map(move |(index, component)| (format!("{name}.{component}"), index))
    })
    .collect()
}

/// Coordinates of all pixels, row by row.
pub(super) fn pixels(film: &FilmSums) -> impl Iterator<Item = (u32, u32)> {
    let (width, height) = (film.width, film.height);
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// Mean distance over the samples that see a surface.
fn mean_depth(mean: &[f64; layer::COUNT]) -> f64 {
    if mean[layer::SURFACE] > 0.0 { mean[layer::DEPTH] / mean[layer::SURFACE] } else { 0.0 }
}

/// The value within ±limit; NaN is 0.
pub(super) fn finite(value: f64, limit: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(-limit, limit) }
}

#[cfg(test)]
mod tests {
    use ::exr::prelude::{ReadChannels, ReadLayers, read};

    use super::*;
    use crate::render::film::tests::test_film;

    fn read_back(path: &Path) -> Layer<AnyChannels<FlatSamples>> {
        let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        image.all_attributes().from_file(path).unwrap().layer_data
    }

    fn values(layer: &Layer<AnyChannels<FlatSamples>>, name: &str) -> Vec<f32> {
        let text = Text::new_or_panic(name);
        let channel = layer.channel_data.list.iter().find(|channel| channel.name == text);
        channel.unwrap_or_else(|| panic!("no channel {name}")).sample_data.values_as_f32().collect()
    }

    #[test]
    fn exr_holds_every_layer_and_the_metadata() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.exr");
        let film = test_film(37, 21);
        let info = ImageInfo {
            scene: String::from("scenes/apple.toml"),
            seed: u64::MAX,
            samples: 5,
            seconds: 1.25,
            command: String::from("translucid render scenes/apple.toml"),
        };
        write_exr(&path, &film, &info).unwrap();

        let layer = read_back(&path);
        assert_eq!(layer.size, (37, 21).into());
        let (red, green, alpha) = (values(&layer, "R"), values(&layer, "G"), values(&layer, "A"));
        let (diffuse, normal) = (values(&layer, "diffuse.G"), values(&layer, "normal.Z"));
        let albedo = values(&layer, "albedo.B");
        for (index, (x, y)) in pixels(&film).enumerate() {
            let (mean, radiance) = (film.mean(x, y), film.radiance(x, y));
            assert!((f64::from(red[index]) - radiance[0]).abs() < 1e-6, "{x} {y}");
            assert!((f64::from(green[index]) - radiance[1]).abs() < 1e-6, "{x} {y}");
            assert_eq!(alpha[index], mean[layer::ALPHA] as f32);
            assert!((f64::from(diffuse[index]) - mean[1]).abs() < 1e-3);
            assert!((f64::from(normal[index]) - mean[18]).abs() < 1e-3);
            assert!((f64::from(albedo[index]) - mean[15]).abs() < 1e-3);
        }
        let text = |name: &str| layer.attributes.other[&Text::new_or_panic(name)].clone();
        assert_eq!(text("translucidScene"), AttributeValue::Text(Text::new_or_panic("scenes/apple.toml")));
        assert_eq!(text("translucidSeed"), AttributeValue::Text(Text::new_or_panic(u64::MAX.to_string())));
        assert_eq!(text("translucidSamples"), AttributeValue::I32(5));
        assert_eq!(text("translucidSeconds"), AttributeValue::F64(1.25));
    }

    #[test]
    fn exr_with_denoised_has_it_beside_what_it_had() {
        let directory = tempfile::tempdir().unwrap();
        let [plain, both] = ["plain.exr", "both.exr"].map(|name| directory.path().join(name));
        let film = test_film(7, 5);
        let radiance = (0..35).map(|i| [i as f32, f32::INFINITY, f32::NAN]).collect();
        let denoised = Denoised { radiance, by: String::from("a broom 1.0.0") };
        write_exr(&plain, &film, &ImageInfo::default()).unwrap();
        write_exr_with_denoised(&both, &film, &denoised, &ImageInfo::default()).unwrap();

        let (plain, both) = (read_back(&plain), read_back(&both));
        for channel in &plain.channel_data.list {
            let same = both.channel_data.list.iter().find(|other| other.name == channel.name).unwrap();
            assert!(same.sample_data == channel.sample_data, "{}", channel.name);
        }
        assert_eq!(both.channel_data.list.len(), plain.channel_data.list.len() + 3);
        assert_eq!(values(&both, "denoised.R"), (0..35).map(|i| i as f32).collect::<Vec<_>>());
        assert_eq!(values(&both, "denoised.G"), [f32::MAX; 35]);
        assert_eq!(values(&both, "denoised.B"), [0.0; 35]);
        let name = Text::new_or_panic("translucidDenoiser");
        assert_eq!(both.attributes.other[&name], AttributeValue::Text(Text::new_or_panic("a broom 1.0.0")));
        assert!(!plain.attributes.other.contains_key(&name));
    }

    #[test]
    fn exr_depth_is_the_mean_over_samples_that_hit() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.exr");
        let mut film = FilmSums::new(2, 1);
        film.tiles[0].samples = 4;
        // One of four samples sees a surface 10 away, the others a visible sky.
        let sums = &mut film.tiles[0].pixels[0];
        (sums[layer::ALPHA], sums[layer::DEPTH], sums[layer::SURFACE]) = (4.0, 10.0, 1.0);
        write_exr(&path, &film, &ImageInfo::default()).unwrap();
        assert_eq!(values(&read_back(&path), "depth.Z"), [10.0, 0.0]);
    }

    #[test]
    fn exr_has_finite_values_only() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.exr");
        let mut film = FilmSums::new(4, 1);
        film.tiles[0].samples = 1;
        for (pixel, odd) in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300].into_iter().enumerate() {
            film.tiles[0].pixels[pixel] = [odd; layer::COUNT];
        }
        write_exr(&path, &film, &ImageInfo::default()).unwrap();
        for channel in read_back(&path).channel_data.list {
            assert!(channel.sample_data.values_as_f32().all(f32::is_finite), "{}", channel.name);
        }
    }
}
