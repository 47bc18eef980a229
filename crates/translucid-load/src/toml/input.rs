//! Colors and scalars that are constants or images.

use std::collections::HashSet;
use std::path::PathBuf;

use ::toml::de::DeValue;
use glam::{Affine2, Vec2, Vec3};
use translucid_scene::{
    Channel, ColorInput, ColorSpace, Interval, NormalMap, ScalarInput, Scene, SceneError, TextureRef,
    Warning, Wrap,
};

use super::document::{Item, Table};
use crate::color::hexadecimal_color;
use crate::file_request::FileRequest;
use crate::loading::Loading;

const COLOR_SPACES: [(&str, ColorSpace); 2] = [("srgb", ColorSpace::Srgb), ("linear", ColorSpace::Linear)];
const CHANNELS: [(&str, Channel); 4] =
    [("red", Channel::Red), ("green", Channel::Green), ("blue", Channel::Blue), ("alpha", Channel::Alpha)];
const WRAPS: [(&str, Wrap); 3] = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];

pub(super) const COLOR_KEYS: &[&str] =
    &["file", "color_space", "factor", "vertex_color", "uv_scale", "uv_offset", "uv_rotation", "wrap"];
pub(super) const SCALAR_KEYS: &[&str] =
    &["file", "color_space", "channel", "factor", "uv_scale", "uv_offset", "uv_rotation", "wrap"];
pub(super) const NORMAL_KEYS: &[&str] = &["file", "scale", "uv_scale", "uv_offset", "uv_rotation", "wrap"];

/// What becomes of documents that materials name.
#[derive(Clone, Debug, Default)]
pub(super) enum Documents {
    /// They are refused.
    #[default]
    Refused,
    /// They are opened later: of their materials only the keys and the name are read.
    Later,
    /// They are opened, and this was found in them.
    Opened(Vec<Warning>),
}

/// Images and profile tables that a scene is to have after those that it has.
#[derive(Clone, Debug, Default)]
pub(super) struct FileList {
    pub(super) images: Vec<FileRequest<ColorSpace>>,
    pub(super) tables: Vec<FileRequest<()>>,
    pub(super) documents: Documents,
    /// Documents that materials name, each with the material in it: what is found in one is told once.
    pub(super) named_documents: HashSet<(PathBuf, Option<String>)>,
    /// Number of images and of tables that the scene has: the index of a request is its index there.
    before: [usize; 2],
}

/// Files that things of a scene name, each with its index there.
#[derive(Clone, Debug, Default)]
pub(super) struct KnownFiles {
    pub(super) images: Vec<(PathBuf, ColorSpace, usize)>,
    pub(super) tables: Vec<(PathBuf, usize)>,
}

impl FileList {
    /// Nothing after what is in a scene.
    pub(super) fn after(scene: &Scene) -> Self {
        Self { before: [scene.images.len(), scene.profile_tables.len()], ..Self::default() }
    }

    /// The list in which documents are opened.
    pub(super) fn opening(self) -> Self {
        Self { documents: Documents::Opened(Vec::new()), ..self }
    }

    /// Takes what was found in documents, and their names.
    pub(super) fn take_findings(&mut self, loading: &mut Loading<'_>) {
        if let Documents::Opened(found) = &mut self.documents {
            loading.warnings.append(found);
            loading.add_files(self.named_documents.iter().map(|(path, _)| path.clone()));
        }
    }

    /// Index of an image that a document asks for.
    pub(super) fn image_of_document(&mut self, wanted: FileRequest<ColorSpace>) -> usize {
        self.before[0] + add(&mut self.images, wanted)
    }

    /// Index of the image in a file; the same file in the same color space is loaded once.
    pub(super) fn image(&mut self, file: &Item<'_>, color_space: ColorSpace) -> Result<usize, SceneError> {
        Ok(self.before[0] + request(&mut self.images, file, color_space)?)
    }

    /// Index of the table of profiles in a file.
    pub(super) fn table(&mut self, file: &Item<'_>) -> Result<usize, SceneError> {
        Ok(self.before[1] + request(&mut self.tables, file, ())?)
    }
}

/// The place of a request in its list.
fn request<K: PartialEq>(
    requests: &mut Vec<FileRequest<K>>,
    file: &Item<'_>,
    kind: K,
) -> Result<usize, SceneError> {
    Ok(add(requests, FileRequest { path: file.file()?, kind, place: file.place() }))
}

/// The place of a request in its list; the same one is there once.
fn add<K: PartialEq>(requests: &mut Vec<FileRequest<K>>, wanted: FileRequest<K>) -> usize {
    let is_same = |request: &FileRequest<K>| request.path == wanted.path && request.kind == wanted.kind;
    requests.iter().position(is_same).unwrap_or_else(|| {
        requests.push(wanted);
        requests.len() - 1
    })
}

/// A color: a number, three numbers, `"#rrggbb"`, `"vertex"`, or a table with an image.
///
/// A table without a file changes `base`, where that has an image or vertex colors; the file "none" takes the image away.
pub(super) fn read_color(
    item: &Item<'_>,
    base: ColorInput,
    range: Interval,
    images: &mut FileList,
) -> Result<ColorInput, SceneError> {
    match item.value() {
        DeValue::String(word) if word.as_ref() == "vertex" => Ok(ColorInput::vertex()),
        DeValue::Table(_) => read_color_table(item.table()?, base, range, images),
        DeValue::String(word) if !word.starts_with('#') => {
            Err(item.refuse("three numbers, \"#rrggbb\", \"vertex\" or a table with an image file"))
        }
        DeValue::Integer(_) | DeValue::Float(_) | DeValue::Array(_) | DeValue::String(_) => {
            read_constant_color(item, range).map(ColorInput::constant)
        }
        _ => Err(item.mismatch("three numbers, \"#rrggbb\", \"vertex\" or a table with an image file")),
    }
}

/// A color without image: a number, three numbers, or `"#rrggbb"`.
pub(super) fn read_constant_color(item: &Item<'_>, range: Interval) -> Result<Vec3, SceneError> {
    match item.value() {
        DeValue::Integer(_) | DeValue::Float(_) => item.number(range).map(Vec3::splat),
        DeValue::Array(_) => item.vec3(range),
        DeValue::String(word) => {
            hexadecimal_color(word).ok_or_else(|| item.refuse("\"#rrggbb\" with hexadecimal digits"))
        }
        _ => Err(item.mismatch("three numbers or \"#rrggbb\"")),
    }
}

fn read_color_table(
    table: Table<'_>,
    base: ColorInput,
    range: Interval,
    images: &mut FileList,
) -> Result<ColorInput, SceneError> {
    let file = table.get("file");
    let is_removed = base.texture.is_some() && file.as_ref().is_some_and(Item::is_none);
    let texture = base.texture.filter(|_| !is_removed);
    let is_kept = texture.is_some() || base.vertex_color || table.get("vertex_color").is_some();
    if is_removed || (file.is_none() && is_kept) {
        let table = table.allow(&["file", "factor", "vertex_color"])?;
        let vertex_color = table.read("vertex_color", base.vertex_color, Item::boolean)?;
        let range = if texture.is_some() || vertex_color { ColorInput::TEXTURED } else { range };
        let factor = table.read("factor", base.factor, |item| read_constant_color(item, range))?;
        return Ok(ColorInput { factor, texture, vertex_color });
    }
    let table = table.allow(COLOR_KEYS)?;
    let color_space = table.read("color_space", ColorSpace::Srgb, |item| item.word(&COLOR_SPACES))?;
    Ok(ColorInput {
        factor: table.read("factor", Vec3::ONE, |item| read_constant_color(item, ColorInput::TEXTURED))?,
        texture: Some(read_texture(&table, color_space, images)?),
        vertex_color: table.read("vertex_color", false, Item::boolean)?,
    })
}

/// A scalar: a number or a table with an image. A table without a file changes `base`, where that has an image.
pub(super) fn read_scalar(
    item: &Item<'_>,
    base: ScalarInput,
    range: Interval,
    images: &mut FileList,
) -> Result<ScalarInput, SceneError> {
    match item.value() {
        DeValue::Table(_) => read_scalar_table(item.table()?, base, images),
        DeValue::Integer(_) | DeValue::Float(_) => item.number(range).map(ScalarInput::constant),
        _ => Err(item.mismatch(&format!("a number in {range} or a table with an image file"))),
    }
}

fn read_scalar_table(
    table: Table<'_>,
    base: ScalarInput,
    images: &mut FileList,
) -> Result<ScalarInput, SceneError> {
    if table.get("file").is_none() && base.texture.is_some() {
        let table = table.allow(&["file", "factor"])?;
        let factor = table.read("factor", base.factor, |item| item.number(ScalarInput::TEXTURED))?;
        return Ok(ScalarInput { factor, ..base });
    }
    let table = table.allow(SCALAR_KEYS)?;
    let color_space = table.read("color_space", ColorSpace::Linear, |item| item.word(&COLOR_SPACES))?;
    let channel = table.read("channel", Channel::Red, |item| item.word(&CHANNELS))?;
    Ok(ScalarInput {
        factor: table.read("factor", 1.0, |item| item.number(ScalarInput::TEXTURED))?,
        texture: Some((read_texture(&table, color_space, images)?, channel)),
    })
}

/// A normal map: the image's path, or a table.
///
/// A table without a file changes `base`, where there is one, and "none" takes it away.
pub(super) fn read_normal_map(
    item: &Item<'_>,
    base: Option<NormalMap>,
    images: &mut FileList,
) -> Result<Option<NormalMap>, SceneError> {
    match (item.value(), base) {
        (DeValue::String(_), Some(_)) if item.is_none() => Ok(None),
        (DeValue::String(_), _) => {
            let image = images.image(item, ColorSpace::Linear)?;
            Ok(Some(NormalMap { texture: TextureRef::new(image), scale: 1.0 }))
        }
        (DeValue::Table(_), base) => read_normal_table(item.table()?, base, images).map(Some),
        _ => Err(item.mismatch("the path of an image or a table with an image file")),
    }
}

fn read_normal_table(
    table: Table<'_>,
    base: Option<NormalMap>,
    images: &mut FileList,
) -> Result<NormalMap, SceneError> {
    let base = base.filter(|_| table.get("file").is_none());
    let table = table.allow(if base.is_some() { &["file", "scale"] } else { NORMAL_KEYS })?;
    let texture = match base {
        Some(base) => base.texture,
        None => read_texture(&table, ColorSpace::Linear, images)?,
    };
    let scale = base.map_or(1.0, |base| base.scale);
    Ok(NormalMap { texture, scale: table.read("scale", scale, |item| item.number(NormalMap::SCALE))? })
}

fn read_texture(
    table: &Table<'_>,
    color_space: ColorSpace,
    images: &mut FileList,
) -> Result<TextureRef, SceneError> {
    Ok(TextureRef {
        image: images.image(&table.require("file")?, color_space)?,
        image_from_uv: read_mapping(table)?,
        wrap: table.read("wrap", [Wrap::Repeat; 2], read_wrap)?,
    })
}

/// Scale, then rotation counter-clockwise, then offset.
fn read_mapping(table: &Table<'_>) -> Result<Affine2, SceneError> {
    let scale = table.read("uv_scale", Vec2::ONE, |item| match item.value() {
        DeValue::Array(_) => item.vec2(TextureRef::MAPPING),
        _ => item.number(TextureRef::MAPPING).map(Vec2::splat),
    })?;
    let angle = table.read("uv_rotation", 0.0, |item| item.number(Interval::ANGLE))?;
    let offset = table.read("uv_offset", Vec2::ZERO, |item| item.vec2(TextureRef::MAPPING))?;
    Ok(Affine2::from_scale_angle_translation(scale, angle.to_radians(), offset))
}

/// One word for both directions, or one for each.
fn read_wrap(item: &Item<'_>) -> Result<[Wrap; 2], SceneError> {
    let DeValue::Array(_) = item.value() else { return item.word(&WRAPS).map(|wrap| [wrap; 2]) };
    let words = item.array::<2>("words")?;
    let mut wraps = [Wrap::Repeat; 2];
    for (wrap, word) in wraps.iter_mut().zip(&words) {
        *wrap = word.word(&WRAPS)?;
    }
    Ok(wraps)
}
