//! Textures of melanin and blood that become textures of one medium.

use std::io::Cursor;
use std::path::Path;

use translucid_image::{Picture, PictureChannel};
use translucid_laboratory::skin::{Skin, SkinParameters, SkinTable};
use translucid_load::load_image;
use translucid_reference::walk::Control as WalkControl;
use translucid_scene::{ColorSpace, Image};
use translucid_words::Error;

use super::{AskedSkin, refused};
use crate::answer::{Answer, Control, NamedFile, Unanswered};

/// Files that are made: albedos, mean free paths in millimeters, and a material that has both.
pub(super) const FILES: [&str; 3] = ["surface_albedo.exr", "mfp.exr", "material.toml"];

/// The textures.
pub(super) fn answer(asked: &AskedSkin, control: &Control<'_>) -> Result<Answer, Unanswered> {
    let parameters = asked.parameters();
    let mut warnings = Vec::new();
    let melanin = Amount::new(parameters.melanin, asked.melanin_texture.as_deref(), &mut warnings)?;
    let blood = Amount::new(parameters.blood, asked.blood_texture.as_deref(), &mut warnings)?;
    for end in [0, 1] {
        let [melanin, blood] = [melanin.ends[end], blood.ends[end]];
        Skin::new(SkinParameters { melanin, blood, ..parameters }).map_err(refused)?;
    }
    let size = size(&melanin, &blood)?;
    let watch = WalkControl { stop: control.stop, ..WalkControl::default() };
    let ends = [melanin.ends, blood.ends];
    let table = SkinTable::new(parameters, ends, asked.photons, &watch, &mut |done| (control.progress)(done));
    let table = table.map_err(refused)?.ok_or(Unanswered::Stopped)?;
    let [albedo, mfp] = [0, 1].map(|which| texture(&table, which, [&melanin, &blood], size));
    let [color, scale] = [FILES[0], FILES[1]].map(|name| format!("{{ file = \"{name}\" }}"));
    let material = asked.material(control.call, &color, 1.0, &scale).into_bytes();
    let files = FILES.into_iter().zip([albedo?, mfp?, material]);
    let remark = format!(
        "between the skins computed, albedos are off by up to {:.4}, mean free paths by up to {:.1} %",
        table.error[0],
        100.0 * table.error[1]
    );
    Ok(Answer {
        files: files.map(|(name, bytes)| NamedFile { name: name.into(), bytes }).collect(),
        remarks: vec![remark],
        warnings,
        ..Answer::default()
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
    fn new(full: f64, path: Option<&Path>, warnings: &mut Vec<String>) -> Result<Self, Error> {
        let mut amount = Self { full, texture: None, ends: [full; 2] };
        let Some(path) = path else { return Ok(amount) };
        let mut found = Vec::new();
        let image = load_image(path, ColorSpace::Linear, &mut found)?;
        warnings.extend(found.iter().map(ToString::to_string));
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
fn size(melanin: &Amount, blood: &Amount) -> Result<[u32; 2], Error> {
    let size = |amount: &Amount| amount.texture.as_ref().map_or([1; 2], |image| [image.width, image.height]);
    let [[w, h], [x, y]] = [melanin, blood].map(size);
    if [w, h] != [x, y] && melanin.texture.is_some() && blood.texture.is_some() {
        let message = format!("melanin_texture has {w} x {h} pixels and blood_texture {x} x {y}");
        return Err(Error::new(message).with_help("scale one of them: both must have the same size"));
    }
    Ok([w.max(x), h.max(y)])
}

/// Bytes of the texture of albedos or of mean free paths.
fn texture(
    table: &SkinTable,
    which: usize,
    amounts: [&Amount; 2],
    size: [u32; 2],
) -> Result<Vec<u8>, Unanswered> {
    let channels = ["R", "G", "B"].map(PictureChannel::single);
    let fill = |y: u32, values: &mut [f64]| {
        for (x, pixel) in values.chunks_exact_mut(3).enumerate() {
            let [melanin, blood] = amounts.map(|amount| amount.at(x as u32, y));
            pixel.copy_from_slice(&table.medium(melanin, blood)[which]);
        }
    };
    let mut file = Cursor::new(Vec::new());
    let picture = Picture::new(size, channels.to_vec(), fill)
        .with_data(which == 1)
        .with_metadata(concat!("translucid ", env!("CARGO_PKG_VERSION")), Vec::new());
    let failed = |error| Unanswered::Work(Error::new(format!("cannot make a picture: {error}")));
    picture.write_exr(&mut file).map_err(failed)?;
    Ok(file.into_inner())
}
