//! Textures of melanin and blood that become textures of one medium.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use translucid_image::{Picture, PictureChannel};
use translucid_laboratory::skin::{Skin, SkinParameters, SkinTable};
use translucid_load::load_image;
use translucid_reference::walk::Control;
use translucid_scene::{ColorSpace, Image};

use super::{SkinArguments, refused};
use crate::failure::Failure;
use crate::files::{Directory, input_among};
use crate::progress::{Meter, Unit};
use crate::{interrupt, machine, messages};

/// Files that are written: albedos, mean free paths in millimeters, and a material that has both.
const FILES: [&str; 3] = ["surface_albedo.exr", "mfp.exr", "material.toml"];

/// Writes the textures to a directory.
pub(super) fn run(arguments: &SkinArguments) -> Result<(), Failure> {
    let Some(output) = arguments.table.file() else {
        return Err(Failure::input("textures need a directory").with_help("name it with -o DIR"));
    };
    let parameters = arguments.parameters();
    let paths = [&arguments.melanin_texture, &arguments.blood_texture];
    let melanin = Amount::new(parameters.melanin, paths[0].as_deref())?;
    let blood = Amount::new(parameters.blood, paths[1].as_deref())?;
    for end in [0, 1] {
        let [melanin, blood] = [melanin.ends[end], blood.ends[end]];
        Skin::new(SkinParameters { melanin, blood, ..parameters }).map_err(refused)?;
    }
    let size = size(&melanin, &blood)?;
    let pool = machine::threads(arguments.threads)?;
    Directory::fill(output, |directory| {
        let files = FILES.map(|name| directory.file(name));
        let read = paths.into_iter().flatten().map(PathBuf::as_path);
        if let Some(path) = input_among(files.iter().map(PathBuf::as_path), read) {
            let message = format!("{} is read, and would be overwritten", path.display());
            return Err(Failure::input(message).with_help("name another directory with -o DIR"));
        }
        interrupt::catch("\nstopping; nothing has been written yet")?;
        let meter = Meter::new(Unit::Parts);
        let control = Control { stop: &interrupt::STOP, ..Control::default() };
        let ends = [melanin.ends, blood.ends];
        let mut progress = |done: f64| meter.update((1e6 * done) as u64, 1_000_000);
        let table =
            pool.install(|| SkinTable::new(parameters, ends, arguments.photons, &control, &mut progress));
        meter.finish();
        let table = table.map_err(refused)?.ok_or_else(|| Failure::interrupted("nothing was written"))?;
        let [albedo, mfp] = [0, 1].map(|which| texture(&table, which, [&melanin, &blood], size));
        let [color, scale] = [FILES[0], FILES[1]].map(|name| format!("{{ file = \"{name}\" }}"));
        let material = arguments.material(&color, 1.0, &scale).into_bytes();
        let contents = FILES.map(str::to_owned).into_iter().zip([albedo?, mfp?, material]);
        directory.write(&contents.collect::<Vec<_>>())?;
        messages::line(&format!(
            "3 files in {}; between the skins computed, albedos are off by up to {:.4}, mean free paths by up to {:.1} %",
            output.display(),
            table.error[0],
            100.0 * table.error[1]
        ));
        Ok(())
    })
}

/// Amount of a pigment at each pixel.
struct Amount {
    /// Amount where the texture is 1, and everywhere if there is none.
    full: f64,
    texture: Option<Image>,
    /// Least and greatest amount.
    ends: [f64; 2],
}

impl Amount {
    fn new(full: f64, path: Option<&Path>) -> Result<Self, Failure> {
        let mut amount = Self { full, texture: None, ends: [full; 2] };
        let Some(path) = path else { return Ok(amount) };
        let mut warnings = Vec::new();
        let image = load_image(path, ColorSpace::Linear, &mut warnings)?;
        messages::print_warnings(&warnings);
        let [width, height] = [image.width, image.height];
        amount.texture = Some(image);
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let amounts = pixels.map(|(x, y)| amount.at(x, y));
        let ends = amounts.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], at| [a.min(at), b.max(at)]);
        Ok(Self { ends, ..amount })
    }

    /// Amount at a pixel; the red channel counts.
    fn at(&self, x: u32, y: u32) -> f64 {
        self.texture.as_ref().map_or(self.full, |image| self.full * f64::from(image.texel(x, y)[0]))
    }
}

/// Width and height of the textures, which are the same.
fn size(melanin: &Amount, blood: &Amount) -> Result<[u32; 2], Failure> {
    let size = |amount: &Amount| amount.texture.as_ref().map_or([1; 2], |image| [image.width, image.height]);
    let [[w, h], [x, y]] = [melanin, blood].map(size);
    if [w, h] != [x, y] && melanin.texture.is_some() && blood.texture.is_some() {
        let message = format!("--melanin-texture has {w} x {h} pixels and --blood-texture {x} x {y}");
        return Err(Failure::input(message).with_help("scale one of them: both must have the same size"));
    }
    Ok([w.max(x), h.max(y)])
}

/// Bytes of the texture of albedos or of mean free paths.
fn texture(
    table: &SkinTable,
    which: usize,
    amounts: [&Amount; 2],
    size: [u32; 2],
) -> Result<Vec<u8>, Failure> {
    let channels = ["R", "G", "B"].map(PictureChannel::single);
    let fill = |y: u32, values: &mut [f64]| {
        for (x, pixel) in values.chunks_exact_mut(3).enumerate() {
            let [melanin, blood] = amounts.map(|amount| amount.at(x as u32, y));
            pixel.copy_from_slice(&table.medium(melanin, blood)[which]);
        }
    };
    let mut file = Cursor::new(Vec::new());
    let picture = Picture::new(size, channels.to_vec(), fill)
        .with_metadata(concat!("translucid ", env!("CARGO_PKG_VERSION")), Vec::new());
    picture.write_exr(&mut file).map_err(|error| Failure::work(format!("cannot make a picture: {error}")))?;
    Ok(file.into_inner())
}
