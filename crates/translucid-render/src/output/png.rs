//! PNG files: what the picture looks like on a display.

use std::io;
use std::path::Path;

use ::png::{BitDepth, ColorType, Encoder, SrgbRenderingIntent};
use translucid_scene::Film;

use super::exr::pixels;
use super::{Denoised, ImageInfo, OutputError, display_from_linear, write_atomically};
use crate::render::film::{FilmSums, layer};

/// Writes a film as an 8-bit sRGB picture, with the exposure and tone mapping of `settings`.
///
/// Where nothing covers a pixel the picture is transparent: such files have an alpha channel (straight,
/// as the format demands); others have none.
/// A fixed pattern of ±½ code hides the steps of smooth gradients.
/// Equal sums give equal bytes: the metadata has scene, seed, samples and version, but no time.
///
/// # Errors
/// The file cannot be written.
pub fn write_png(path: &Path, film: &FilmSums, settings: &Film, info: &ImageInfo) -> Result<(), OutputError> {
    write(path, film, &|x, y| film.radiance(x, y), settings, &texts(info))
}

/// Writes the denoised picture of a film in the same way; the metadata says what has denoised it.
///
/// Coverage is the film's. Pixels that `denoised` does not have are black.
///
/// # Errors
/// The file cannot be written.
pub fn write_denoised_png(
    path: &Path,
    film: &FilmSums,
    denoised: &Denoised,
    settings: &Film,
    info: &ImageInfo,
) -> Result<(), OutputError> {
    let radiance = |x: u32, y: u32| {
        let index = y as usize * film.width as usize + x as usize;
        denoised.radiance.get(index).copied().unwrap_or_default().map(f64::from)
    };
    let mut texts = texts(info);
    texts.push(("Denoiser", denoised.by.clone()));
    write(path, film, &radiance, settings, &texts)
}

/// The metadata: keywords and texts.
fn texts(info: &ImageInfo) -> Vec<(&'static str, String)> {
    vec![
        ("Software", ImageInfo::software()),
        ("Scene", info.scene.clone()),
        ("Seed", info.seed.to_string()),
        ("Samples", info.samples.to_string()),
    ]
}

fn write(
    path: &Path,
    film: &FilmSums,
    radiance: &dyn Fn(u32, u32) -> [f64; 3],
    settings: &Film,
    texts: &[(&str, String)],
) -> Result<(), OutputError> {
    let pixel = |(x, y): (u32, u32)| display_pixel(film, radiance(x, y), settings, x, y);
    let mut data: Vec<[u8; 4]> = pixels(film).map(pixel).collect();
    let opaque = data.iter().all(|pixel| pixel[3] == 255);
    let bytes: Vec<u8> = if opaque {
        data.drain(..).flat_map(|[r, g, b, _]| [r, g, b]).collect()
    } else {
        data.into_flattened()
    };
    let color = if opaque { ColorType::Rgb } else { ColorType::Rgba };
    write_atomically(path, |out| {
        let mut encoder = Encoder::new(out, film.width, film.height);
        encoder.set_color(color);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        for (keyword, text) in texts {
            encoder
                .add_itxt_chunk((*keyword).to_owned(), text.replace('\0', "?"))
                .map_err(io::Error::other)?;
        }
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        writer.write_image_data(&bytes).map_err(io::Error::other)?;
        writer.finish().map_err(io::Error::other)
    })
}

/// The pixel's color and straight alpha as 8-bit codes.
fn display_pixel(film: &FilmSums, radiance: [f64; 3], settings: &Film, x: u32, y: u32) -> [u8; 4] {
    let alpha = film.mean(x, y)[layer::ALPHA].max(0.0).min(1.0);
    let alpha_code = (alpha * 255.0).round() as u8;
    if alpha_code == 0 {
        return [0; 4];
    }
    let exposure = f64::from(settings.exposure).exp2();
    let linear = radiance.map(|value| (value / alpha * exposure) as f32);
    let [r, g, b] = display_from_linear(settings.tone_mapping, linear).map(|value| quantize(value, x, y));
    [r, g, b, alpha_code]
}

/// The 8-bit code of a display value in [0, 1], rounded up or down so that the mean over a region is
/// right. Whole codes stay what they are.
fn quantize(value: f32, x: u32, y: u32) -> u8 {
    (value * 255.0 + dither(x, y)).floor() as u8
}

/// A threshold in (0, 1) per pixel, the same for all channels, so that grey stays grey.
///
/// Multiples of the plane's two irrationals (the root of x³ = x + 1) spread evenly over any neighborhood
/// [M. Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"].
fn dither(x: u32, y: u32) -> f32 {
    const STEP_X: u32 = 3_242_174_889; // 2³² · 0.754877666
    const STEP_Y: u32 = 2_447_445_414; // 2³² · 0.569840291
    let phase = x.wrapping_mul(STEP_X).wrapping_add(y.wrapping_mul(STEP_Y));
    ((phase >> 16) as f32 + 0.5) / 65536.0
}

#[cfg(test)]
mod tests {
    use std::fs;

    use translucid_scene::ToneMapping;

    use super::*;
    use crate::render::film::tests::test_film;

    fn settings(exposure: f32) -> Film {
        Film { exposure, tone_mapping: ToneMapping::Srgb, ..Film::default() }
    }

    fn constant_film(color: [f64; 3], alpha: f64) -> FilmSums {
        let mut film = FilmSums::new(32, 32);
        for tile in &mut film.tiles {
            tile.samples = 2;
            for sums in &mut tile.pixels {
                for channel in 0..3 {
                    sums[layer::DIFFUSE.start + channel] = 2.0 * color[channel];
                }
                sums[layer::ALPHA] = 2.0 * alpha;
            }
        }
        film
    }

    fn read_back(path: &Path) -> (::png::OutputInfo, Vec<u8>, Vec<(String, String)>) {
        let decoder = ::png::Decoder::new(io::BufReader::new(fs::File::open(path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let texts = reader.info().utf8_text.iter();
        let texts = texts.map(|chunk| (chunk.keyword.clone(), chunk.get_text().unwrap())).collect();
        (info, bytes, texts)
    }

    fn written(film: &FilmSums, settings: &Film) -> (::png::OutputInfo, Vec<u8>, Vec<(String, String)>) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("picture.png");
        let info = ImageInfo { scene: String::from("Äpfel.toml"), samples: 2, ..Default::default() };
        write_png(&path, film, settings, &info).unwrap();
        read_back(&path)
    }

    #[test]
    fn png_of_an_opaque_film_is_rgb_with_metadata() {
        let (info, bytes, texts) = written(&constant_film([1.0, 0.0, 1.0], 1.0), &settings(0.0));
        assert_eq!((info.width, info.height, info.color_type), (32, 32, ColorType::Rgb));
        assert!(bytes.chunks(3).all(|pixel| pixel == [255, 0, 255]));
        assert!(texts.contains(&(String::from("Scene"), String::from("Äpfel.toml"))));
        assert!(texts.contains(&(String::from("Samples"), String::from("2"))));
    }

    #[test]
    fn png_alpha_is_straight() {
        // White of coverage ¼: the color is not darkened by its coverage.
        let (info, bytes, _) = written(&constant_film([0.25; 3], 0.25), &settings(0.0));
        assert_eq!(info.color_type, ColorType::Rgba);
        assert!(bytes.chunks(4).all(|pixel| pixel == [255, 255, 255, 64]));
    }

    #[test]
    fn png_of_nothing_is_transparent() {
        let (_, bytes, _) = written(&constant_film([0.0; 3], 0.0), &settings(0.0));
        assert!(bytes.iter().all(|&byte| byte == 0));
    }

    #[test]
    fn png_dither_keeps_the_mean() {
        // Linear ⅒ two stops up is 0.4, encoded 0.6651850 · 255 = 169.622.
        let (_, bytes, _) = written(&constant_film([0.1; 3], 1.0), &settings(2.0));
        let mean = bytes.iter().map(|&byte| f64::from(byte)).sum::<f64>() / bytes.len() as f64;
        assert!((mean - 169.622).abs() < 0.02, "{mean}");
        assert!(bytes.chunks(3).all(|pixel| pixel[0] == pixel[1] && pixel[1] == pixel[2]));
        assert!(bytes.iter().all(|byte| (169..=170).contains(byte)));
    }

    #[test]
    fn png_survives_values_that_are_not_finite() {
        let mut film = test_film(20, 20);
        film.tiles[0].pixels[0] = [f64::NAN; layer::COUNT];
        film.tiles[0].pixels[1] = [f64::INFINITY; layer::COUNT];
        film.tiles[0].pixels[2] = [f64::NEG_INFINITY; layer::COUNT];
        written(&film, &settings(0.0));
    }
}
