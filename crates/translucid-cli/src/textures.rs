//! `translucid convert --albedo-texture`: textures of surface albedos and mean free paths in another color space.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use clap::{ArgMatches, Args};
use rayon::prelude::*;
use translucid_image::{Picture, PictureChannel};
use translucid_load::load_plain_image;
use translucid_profile::Configuration;
use translucid_profile::convention::{ArgumentNames, ColorSpaces, LINEAR_SPACES, TexelMixer};
use translucid_scene::{ColorSpace, Image};

use crate::failure::Failure;
use crate::files::{Directory, input_among};
use crate::messages;

/// Files that are written: albedos, and mean free paths in the unit of those that were read.
const FILES: [&str; 2] = ["surface_albedo.exr", "mfp.exr"];

/// The textures, beside the options of the question *convert*.
#[derive(Args, Debug)]
pub(crate) struct TextureArguments {
    /// Texture of surface albedos, converted to --color-space with that of mean free paths; -o names a directory for both
    #[arg(long, value_name = "FILE", requires_all = ["mfp_texture", "color_space", "output"],
        conflicts_with_all = ["from", "surface_albedo", "wall_color", "thin", "to", "set", "to_unit"])]
    albedo_texture: Option<PathBuf>,
    /// Texture of mean free paths, in any unit: numbers, whatever color space the file states
    #[arg(long, value_name = "FILE", requires = "albedo_texture")]
    mfp_texture: Option<PathBuf>,
}

const NAMES: ArgumentNames = ArgumentNames {
    color_space: "--color-space",
    from_color_space: "--from-color-space",
    ..ArgumentNames::FIELDS
};

/// Converts the textures, if the options of *convert* name them.
pub(crate) fn run(options: &ArgMatches) -> Option<Result<(), Failure>> {
    let file = |name| options.try_get_one::<PathBuf>(name).ok().flatten();
    let text = |name| options.get_one::<String>(name);
    let paths = [file("albedo_texture")?, file("mfp_texture")?].map(PathBuf::as_path);
    let from = text("from_color_space").map_or(LINEAR_SPACES[0], String::as_str);
    let spaces = ColorSpaces { from, to: text("color_space")? };
    let configuration = text("configuration").and_then(|name| Configuration::from_name(name));
    let configuration = configuration.unwrap_or(Configuration::Diffuse);
    Some(convert(paths, spaces, configuration, file("output")?))
}

/// Converts the textures of albedos and mean free paths, and writes them to a directory.
fn convert(
    paths: [&Path; 2],
    spaces: ColorSpaces<'_>,
    configuration: Configuration,
    output: &Path,
) -> Result<(), Failure> {
    spaces.matrix(&NAMES)?;
    let mixer = TexelMixer::new(spaces.from, spaces.to, configuration)
        .ok_or_else(|| Failure::input("the color space is not known"))?;
    // Integers are albedos by the curve of sRGB, and mean free paths as they are
    let albedo = load(paths[0], ColorSpace::Srgb)?;
    let mfp = load(paths[1], ColorSpace::Linear)?;
    let [[w, h], [x, y]] = [&albedo, &mfp].map(|image| [image.width, image.height]);
    if [w, h] != [x, y] {
        let message = format!("--albedo-texture has {w} x {h} pixels and --mfp-texture {x} x {y}");
        return Err(Failure::input(message).with_help("scale one of them: both must have the same size"));
    }
    let row = |y: u32| -> Result<Vec<[[f32; 3]; 2]>, Failure> {
        let texel = |x: u32| -> Result<[[f32; 3]; 2], Failure> {
            let [a, l] = [&albedo, &mfp].map(|image| {
                let [red, green, blue, _] = image.texel(x, y).map(f64::from);
                [red, green, blue]
            });
            let mixed = mixer.mix(a, l).map_err(|error| {
                let path = paths[usize::from(error.parameter == "mfp")].display();
                Failure::input(format!("{path}, pixel ({x}, {y}): to {} {error}", spaces.to))
                    .with_help("surface albedos and mean free paths are numbers; a color may be outside of the new gamut")
            })?;
            Ok(mixed.map(|values| values.map(|value| value as f32)))
        };
        (0..w).map(texel).collect()
    };
    let rows: Vec<_> = (0..h).into_par_iter().map(row).collect::<Result<_, _>>()?;
    Directory::fill(output, |directory| {
        let files = FILES.map(|name| directory.file(name));
        if let Some(path) = input_among(files.iter().map(PathBuf::as_path), paths.into_iter()) {
            let message = format!("{} is read, and would be overwritten", path.display());
            return Err(Failure::input(message).with_help("name another directory with -o DIR"));
        }
        let contents = [0, 1].map(|which| texture(&rows, which, [w, h]));
        let [albedo, mfp] = contents;
        directory.write(&[(FILES[0].to_owned(), albedo?), (FILES[1].to_owned(), mfp?)])?;
        messages::line(&format!("2 files in {}", output.display()));
        Ok(())
    })
}

/// Numbers of a picture, whose color space is stated by the command.
fn load(path: &Path, color_space: ColorSpace) -> Result<Image, Failure> {
    let mut warnings = Vec::new();
    let image = load_plain_image(path, color_space, &mut warnings)?;
    messages::print_warnings(&warnings);
    Ok(image)
}

/// Bytes of the texture of albedos or of mean free paths.
fn texture(rows: &[Vec<[[f32; 3]; 2]>], which: usize, size: [u32; 2]) -> Result<Vec<u8>, Failure> {
    let channels = ["R", "G", "B"].map(PictureChannel::single);
    let fill = |y: u32, values: &mut [f64]| {
        for (pixel, texel) in values.chunks_exact_mut(3).zip(&rows[y as usize]) {
            pixel.copy_from_slice(&texel[which].map(f64::from));
        }
    };
    let mut file = Cursor::new(Vec::new());
    let picture = Picture::new(size, channels.to_vec(), fill)
        .with_data(true)
        .with_metadata(concat!("translucid ", env!("CARGO_PKG_VERSION")), Vec::new());
    picture.write_exr(&mut file).map_err(|error| Failure::work(format!("cannot make a picture: {error}")))?;
    Ok(file.into_inner())
}
