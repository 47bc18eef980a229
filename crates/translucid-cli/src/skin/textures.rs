//! Textures of melanin and blood that become textures of one medium.

use std::io::Cursor;
use std::path::Path;
use std::sync::atomic::Ordering;

use translucid_image::{Picture, PictureChannel};
use translucid_laboratory::skin::{Skin, SkinTable};
use translucid_load::load_image;
use translucid_reference::walk::Control;
use translucid_scene::{ColorSpace, Image};

use super::{SkinArguments, refused};
use crate::failure::Failure;
use crate::files::{Directory, NamedFile, input_among};
use crate::progress::{Meter, Unit};
use crate::{interrupt, machine, messages};

/// Files that are written: albedos, mean free paths in millimeters, and a material that has both.
const FILES: [&str; 3] = ["surface_albedo.exr", "mfp.exr", "material.toml"];

/// Writes the textures to a directory.
pub(super) fn run(arguments: &SkinArguments) -> Result<(), Failure> {
    let Some(output) = arguments.table.file() else {
        return Err(
            Failure::input("textures need a directory to be written to").with_help("name it with -o DIR")
        );
    };
    let parameters = arguments.parameters();
    Skin::new(parameters).map_err(refused)?;
    let melanin = Amount::new("--melanin", parameters.melanin, arguments.melanin_texture.as_deref())?;
    let blood = Amount::new("--blood", parameters.blood, arguments.blood_texture.as_deref())?;
    let size = size(&melanin, &blood)?;
    let pool = machine::threads(arguments.threads)?;
    Directory::fill(output, |directory| {
        let inputs = [&arguments.melanin_texture, &arguments.blood_texture].into_iter().flatten();
        let files = FILES.map(|name| directory.file(name));
        if let Some(path) =
            input_among(files.iter().map(|path| path.as_path()), inputs.map(|path| path.as_path()))
        {
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
        let table = table.map_err(refused)?.filter(|_| !interrupt::STOP.load(Ordering::Relaxed));
        let table = table.ok_or_else(|| Failure::interrupted("nothing was written"))?;
        let [color, scale] = [FILES[0], FILES[1]].map(|name| format!("{{ file = \"{name}\" }}"));
        let text = arguments.material(&color, 1.0, &scale);
        let [albedo, mfp] = [0, 1].map(|which| texture(&table, which, [&melanin, &blood], size));
        let named = |name: &str, content| -> NamedFile { (name.to_owned(), content) };
        directory.write(&[
            named(FILES[0], albedo?),
            named(FILES[1], mfp?),
            named(FILES[2], text.into_bytes()),
        ])?;
        let [albedo, mfp] = table.error;
        messages::line(&format!(
            "{} files in {}; between the skins computed, albedos are off by up to {albedo:.4}, mean free paths by up to {:.1} %",
            FILES.len(),
            output.display(),
            100.0 * mfp
        ));
        Ok(())
    })
}

/// Amount of a pigment at each pixel.
struct Amount {
    option: &'static str,
    /// Amount where the texture is 1, and everywhere if there is none.
    full: f64,
    texture: Option<Image>,
    /// Least and greatest amount.
    ends: [f64; 2],
}

impl Amount {
    fn new(option: &'static str, full: f64, path: Option<&Path>) -> Result<Self, Failure> {
        let Some(path) = path else { return Ok(Self { option, full, texture: None, ends: [full; 2] }) };
        let mut warnings = Vec::new();
        let image = load_image(path, ColorSpace::Linear, &mut warnings)?;
        messages::print_warnings(&warnings);
        let mut amount = Self { option, full, texture: Some(image), ends: [full; 2] };
        amount.ends = amount.range();
        let [least, most] = amount.ends;
        if least < 0.0 || most > 1.0 {
            let message = format!(
                "{} with {option} {full} has amounts from {least:.4} to {most:.4}, but they must be in [0, 1]",
                path.display()
            );
            return Err(
                Failure::input(message).with_help(format!("{option} is the amount where the texture is 1"))
            );
        }
        Ok(amount)
    }

    fn range(&self) -> [f64; 2] {
        let Some(image) = &self.texture else { return self.ends };
        let pixels = (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y)));
        let amounts = pixels.map(|(x, y)| self.at(x, y));
        amounts.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], amount| [a.min(amount), b.max(amount)])
    }

    /// Amount at a pixel; the red channel counts.
    fn at(&self, x: u32, y: u32) -> f64 {
        self.texture.as_ref().map_or(self.full, |image| self.full * f64::from(image.texel(x, y)[0]))
    }
}

/// Width and height of the textures, which are the same.
fn size(melanin: &Amount, blood: &Amount) -> Result<[u32; 2], Failure> {
    let size = |amount: &Amount| amount.texture.as_ref().map(|image| [image.width, image.height]);
    match [melanin, blood].map(size) {
        [Some([w, h]), Some([x, y])] if [w, h] != [x, y] => {
            let [melanin, blood] = [melanin.option, blood.option];
            Err(Failure::input(format!(
                "{melanin}-texture has {w} x {h} pixels and {blood}-texture {x} x {y}, but they must have the same"
            )))
        }
        [Some(size), _] | [None, Some(size)] => Ok(size),
        [None, None] => Err(Failure::input("there is no texture")),
    }
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
