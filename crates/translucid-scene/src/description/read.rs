//! Reading the fields of a scene's things from a table.

use std::path::Path;

use glam::{Affine2, DVec3, Mat3, Vec2, Vec3};
use translucid_words::{Content, Interval, Item, Key, Table, WholeInterval, Word, quoted};

use super::files::FileList;
use super::layers::read_layers;
use super::slot::SceneSlot;
use super::vectors::Vectors;
use crate::placement::{check_edges, check_unit, is_rotation};
use crate::{
    Channel, ColorInput, ColorSpace, ImageKind, NormalMap, Projection, ScalarInput, SceneError,
    SubsurfaceModel, TextureFilter, TextureRef, Wrap,
};

/// Keys of a table with the image of a color.
pub const COLOR_KEYS: &[&str] = &[
    "file",
    "color_space",
    "factor",
    "vertex_color",
    "uv_scale",
    "uv_offset",
    "uv_rotation",
    "wrap",
    "filter",
];
/// Keys of a table with the image of a scalar.
pub const SCALAR_KEYS: &[&str] =
    &["file", "color_space", "channel", "factor", "uv_scale", "uv_offset", "uv_rotation", "wrap", "filter"];
/// Keys of a table with the image of a normal map.
pub const NORMAL_KEYS: &[&str] = &["file", "scale", "uv_scale", "uv_offset", "uv_rotation", "wrap", "filter"];

impl SceneSlot<'_> {
    /// Replaces the value by that of its keys, if they are there.
    pub(super) fn read_keys(
        self,
        table: &Table<'_>,
        keys: &[Key],
        files: &mut FileList,
    ) -> Result<(), SceneError> {
        match self {
            Self::Direction(direction, from) => return read_direction(table, direction, from),
            Self::Edges { center, edges } => return read_edges(table, center, edges),
            Self::Projection(projection) => return read_projection(table, projection),
            Self::Rotation(rotation) => return read_rotation(table, rotation),
            Self::Model(model) => return read_model(table, model, files),
            _ => {}
        }
        let Some(item) = table.get(keys[0].name) else { return Ok(()) };
        self.read_item(&item, files)
    }

    /// Replaces the value of a single key.
    fn read_item(self, item: &Item<'_>, files: &mut FileList) -> Result<(), SceneError> {
        match self {
            Self::Flag(flag) => *flag = item.flag()?,
            Self::Count(count, range) => *count = item.count(range)?,
            Self::Seed(seed) => *seed = item.integer(WholeInterval::new(0, u64::MAX))?,
            Self::Size([width, height], range) => [*width, *height] = read_size(item, range)?,
            Self::Word(word) => word.choose(item.choice(&word.names())?),
            Self::Number(x, range) | Self::Length(x, range) | Self::Angle(x, range) => {
                *x = item.number(range)?;
            }
            Self::Pair(pair, range) => *pair = item.vec2(range)?,
            Self::Point(point) => *point = item.point()?,
            Self::Vector(vector) => *vector = item.vec3(Interval::DIRECTION)?,
            Self::Rgb(color, range) => *color = item.color(range)?,
            Self::Triple(_, _) if item.as_text().is_some() => {
                return Err(item.mismatch("a number or three numbers"));
            }
            Self::Triple(numbers, range) => *numbers = item.color(range)?,
            Self::Radiance(color) | Self::Power(color) => *color = item.color(Interval::LIGHT)?,
            Self::Scalar(input, range) => *input = read_scalar(item, *input, range, files)?,
            Self::Color(input, range) => *input = read_color(item, *input, range, files)?,
            Self::NormalMap(map) => *map = read_normal_map(item, *map, files)?,
            Self::Layers(layers) => *layers = read_layers(item)?,
            // An environment reads its image itself: it may keep or lose that of a base
            Self::Absent
            | Self::Image(_)
            | Self::Direction(..)
            | Self::Edges { .. }
            | Self::Projection(_)
            | Self::Rotation(_)
            | Self::Model(_) => {}
        }
        Ok(())
    }
}

/// Width and height.
pub fn read_size(item: &Item<'_>, range: WholeInterval) -> Result<[u32; 2], SceneError> {
    let size = item.array::<2>("whole numbers, width and height")?;
    Ok([size[0].count(range)?, size[1].count(range)?])
}

/// Reads `unit_direction` as it is, else `direction`, else from a point to `target`: exactly one of them is given.
fn read_direction(table: &Table<'_>, slot: &mut Vec3, from: Option<Vec3>) -> Result<(), SceneError> {
    let Some(item) = table.get("unit_direction") else {
        *slot = read_aim(table, from)?.as_vec3();
        return Ok(());
    };
    let direction = item.vec3(Interval::DIRECTION)?;
    if let Some(other) = table.get("direction").or_else(|| from.and_then(|_| table.get("target"))) {
        let message = format!("{} and {} are given, but only one of them must be", item.path(), other.path());
        return Err(other.error(message));
    }
    check_unit("", direction).map_err(|_| item.refuse("a vector of length 1"))?;
    *slot = direction;
    Ok(())
}

/// The unit vector along `direction`, or from a point to `target`.
fn read_aim(table: &Table<'_>, from: Option<Vec3>) -> Result<DVec3, SceneError> {
    let Some(from) = from else { return read_unit_vector(&table.require("direction")?) };
    match (table.get("direction"), table.get("target")) {
        (Some(direction), None) => read_unit_vector(&direction),
        (None, Some(target)) => {
            let to = target.point()?.as_dvec3() - from.as_dvec3();
            to.try_normalize().ok_or_else(|| target.refuse("a point other than the light's own"))
        }
        (Some(direction), Some(_)) => {
            Err(direction.error(format!("{} has both direction and target, but must have one", table.path())))
        }
        (None, None) => Err(table.error(format!("{} needs the key target or direction", table.path()))),
    }
}

fn read_unit_vector(item: &Item<'_>) -> Result<DVec3, SceneError> {
    let direction = item.vec3(Interval::DIRECTION)?.as_dvec3();
    direction.try_normalize().ok_or_else(|| item.refuse("a direction that is not zero"))
}

/// Reads `edge_x` and `edge_y`, or the edges of a rectangle that faces `target` or `direction`, by `up` and `size`.
fn read_edges(table: &Table<'_>, center: Vec3, [edge_x, edge_y]: [&mut Vec3; 2]) -> Result<(), SceneError> {
    if table.get("edge_x").is_none() && table.get("edge_y").is_none() {
        let normal = read_aim(table, Some(center))?;
        let up = table.read("up", DVec3::Y, read_unit_vector)?;
        let [width, height] = table.require("size")?.numbers(Interval::REACH)?;
        // A rectangle that faces along `up` has its edges along x and z.
        let across = up.cross(normal).try_normalize().filter(|_| up.cross(normal).length() > 1e-6);
        let across = across.unwrap_or_else(|| normal.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X));
        *edge_x = (across * f64::from(width)).as_vec3();
        *edge_y = (normal.cross(across) * f64::from(height)).as_vec3();
        return Ok(());
    }
    let (x, y) = (table.require("edge_x")?, table.require("edge_y")?);
    (*edge_x, *edge_y) = (x.vec3(Interval::PLACE)?, y.vec3(Interval::PLACE)?);
    if let Some(other) = ["target", "direction", "up", "size"].into_iter().find_map(|key| table.get(key)) {
        let message = format!("{} has edge_x and {}, but must have one of them", table.path(), other.path());
        return Err(other.error(message));
    }
    check_edges(*edge_x, *edge_y).map_err(|error| y.error(format!("{}, {}", table.path(), error.message)))
}

/// Words of `projection`, and whether they mean an orthographic one.
const PROJECTIONS: [(&str, bool); 2] = [("perspective", false), ("orthographic", true)];

fn read_projection(table: &Table<'_>, slot: &mut Projection) -> Result<(), SceneError> {
    let is_orthographic = table.read("projection", false, |item| item.word_of(&PROJECTIONS))?;
    let (name, other) = if is_orthographic { ("orthographic", "fov") } else { ("perspective", "width") };
    if let Some(item) = table.get(other) {
        return Err(
            item.error(format!("{} is not a key of a camera whose projection is {name}", item.path()))
        );
    }
    if is_orthographic {
        *slot = Projection::Orthographic { width: table.require("width")?.number(Interval::REACH)? };
    } else if let Some(item) = table.get("fov") {
        *slot = Projection::Perspective { horizontal_fov: item.number(Projection::FOV)? };
    }
    Ok(())
}

/// Reads `rotation` about y, or any as `matrix`: nine numbers row by row.
fn read_rotation(table: &Table<'_>, slot: &mut Mat3) -> Result<(), SceneError> {
    match (table.get("rotation"), table.get("matrix")) {
        (None, None) => {}
        (Some(angle), None) => *slot = Mat3::from_rotation_y(angle.number(Interval::ANGLE)?.to_radians()),
        (None, Some(item)) => {
            *slot = Mat3::from_cols_array(&item.numbers(Interval::DIRECTION)?).transpose();
            if !is_rotation(*slot) {
                return Err(item.refuse("a rotation, row by row"));
            }
        }
        (Some(_), Some(item)) => {
            let path = table.path();
            return Err(item.error(format!("{path} has both rotation and matrix, but must have one")));
        }
    }
    Ok(())
}

/// Reads `subsurface_model` or `subsurface_table`.
fn read_model(table: &Table<'_>, slot: &mut SubsurfaceModel, files: &mut FileList) -> Result<(), SceneError> {
    let model = table.get("subsurface_model");
    if let Some(item) = &model {
        *slot = SubsurfaceModel::ALL[item.choice(&SubsurfaceModel::ALL.map(SubsurfaceModel::name))?];
    }
    let Some(item) = table.get("subsurface_table") else { return Ok(()) };
    if model.is_some() {
        let message = "subsurface_table is the model: leave subsurface_model out, or the table";
        return Err(SceneError::at(item.place(), message));
    }
    *slot = SubsurfaceModel::Tabulated(files.table(&item)?);
    Ok(())
}

/// A color: a number, three numbers, `"#rrggbb"`, `"vertex"`, or a table with an image.
///
/// A table without a file changes `base`, where that has an image or vertex colors; the file "none" takes the image away.
fn read_color(
    item: &Item<'_>,
    base: ColorInput,
    range: Interval,
    files: &mut FileList,
) -> Result<ColorInput, SceneError> {
    match item.content() {
        Content::Text(word) if word == "vertex" => Ok(ColorInput::vertex()),
        Content::Table(_) => read_color_table(item.table()?, base, range, files),
        Content::Text(word) if !word.starts_with('#') => {
            let error = item.refuse("three numbers, \"#rrggbb\", \"vertex\" or a table with an image file");
            Err(with_table(error, word))
        }
        Content::Integer(_) | Content::Float(_) | Content::List(_) | Content::Text(_) => {
            item.color(range).map(ColorInput::constant)
        }
        _ => Err(item.mismatch("three numbers, \"#rrggbb\", \"vertex\" or a table with an image file")),
    }
}

fn read_color_table(
    table: Table<'_>,
    base: ColorInput,
    range: Interval,
    files: &mut FileList,
) -> Result<ColorInput, SceneError> {
    let file = table.get("file");
    let is_removed = base.texture.is_some() && file.as_ref().is_some_and(Item::is_none);
    let texture = base.texture.filter(|_| !is_removed);
    let is_kept = texture.is_some() || base.vertex_color || table.get("vertex_color").is_some();
    if is_removed || (file.is_none() && is_kept) {
        let table = table.allow(&["file", "factor", "vertex_color"])?;
        let vertex_color = table.read("vertex_color", base.vertex_color, Item::flag)?;
        let range = if texture.is_some() || vertex_color { ColorInput::TEXTURED } else { range };
        let factor = table.read("factor", base.factor, |item| item.color(range))?;
        return Ok(ColorInput { factor, texture, vertex_color });
    }
    let table = table.allow(COLOR_KEYS)?;
    let color_space = table.read("color_space", ColorSpace::Srgb, |item| item.word())?;
    Ok(ColorInput {
        factor: table.read("factor", Vec3::ONE, |item| item.color(ColorInput::TEXTURED))?,
        texture: Some(read_texture(&table, ImageKind::Color(color_space), files)?),
        vertex_color: table.read("vertex_color", false, Item::flag)?,
    })
}

/// The error of a text where a table with an image belongs: how that is written, if the text may be a file's name.
fn with_table(error: SceneError, text: &str) -> SceneError {
    if Path::new(text).extension().is_none() {
        return error;
    }
    error.with_help(format!("an image is written {{ file = {} }}", quoted(text)))
}

/// A scalar: a number or a table with an image. A table without a file changes `base`, where that has an image.
fn read_scalar(
    item: &Item<'_>,
    base: ScalarInput,
    range: Interval,
    files: &mut FileList,
) -> Result<ScalarInput, SceneError> {
    match item.content() {
        Content::Table(_) => read_scalar_table(item.table()?, base, files),
        Content::Integer(_) | Content::Float(_) => item.number(range).map(ScalarInput::constant),
        content => {
            let error = item.mismatch(&format!("a number in {range} or a table with an image file"));
            Err(match content {
                Content::Text(word) => with_table(error, word),
                _ => error,
            })
        }
    }
}

fn read_scalar_table(
    table: Table<'_>,
    base: ScalarInput,
    files: &mut FileList,
) -> Result<ScalarInput, SceneError> {
    if table.get("file").is_none() && base.texture.is_some() {
        let table = table.allow(&["file", "factor"])?;
        let factor = table.read("factor", base.factor, |item| item.number(ScalarInput::TEXTURED))?;
        return Ok(ScalarInput { factor, ..base });
    }
    let table = table.allow(SCALAR_KEYS)?;
    let color_space = table.read("color_space", ColorSpace::Linear, |item| item.word())?;
    let channel = table.read("channel", Channel::Red, |item| item.word())?;
    Ok(ScalarInput {
        factor: table.read("factor", 1.0, |item| item.number(ScalarInput::TEXTURED))?,
        texture: Some((read_texture(&table, ImageKind::Plain(color_space), files)?, channel)),
    })
}

/// A normal map: the image's path, or a table.
///
/// A table without a file changes `base`, where there is one, and "none" takes it away.
fn read_normal_map(
    item: &Item<'_>,
    base: Option<NormalMap>,
    files: &mut FileList,
) -> Result<Option<NormalMap>, SceneError> {
    match (item.content(), base) {
        (Content::Text(_), Some(_)) if item.is_none() => Ok(None),
        (Content::Text(_), _) => {
            let image = files.image(item, ImageKind::Plain(ColorSpace::Linear))?;
            Ok(Some(NormalMap { texture: TextureRef::new(image), scale: 1.0 }))
        }
        (Content::Table(_), base) => read_normal_table(item.table()?, base, files).map(Some),
        _ => Err(item.mismatch("the path of an image or a table with an image file")),
    }
}

fn read_normal_table(
    table: Table<'_>,
    base: Option<NormalMap>,
    files: &mut FileList,
) -> Result<NormalMap, SceneError> {
    let base = base.filter(|_| table.get("file").is_none());
    let table = table.allow(if base.is_some() { &["file", "scale"] } else { NORMAL_KEYS })?;
    let texture = match base {
        Some(base) => base.texture,
        None => read_texture(&table, ImageKind::Plain(ColorSpace::Linear), files)?,
    };
    let scale = base.map_or(1.0, |base| base.scale);
    Ok(NormalMap { texture, scale: table.read("scale", scale, |item| item.number(NormalMap::SCALE))? })
}

fn read_texture(table: &Table<'_>, kind: ImageKind, files: &mut FileList) -> Result<TextureRef, SceneError> {
    Ok(TextureRef {
        image: files.image(&table.require("file")?, kind)?,
        image_from_uv: read_mapping(table)?,
        wrap: table.read("wrap", [Wrap::Repeat; 2], read_wrap)?,
        filter: table.read("filter", TextureFilter::Linear, |item| item.word())?,
    })
}

/// Scale, then rotation counter-clockwise, then offset.
fn read_mapping(table: &Table<'_>) -> Result<Affine2, SceneError> {
    let scale = table.read("uv_scale", Vec2::ONE, |item| match item.content() {
        Content::List(_) => item.vec2(TextureRef::MAPPING),
        _ => item.number(TextureRef::MAPPING).map(Vec2::splat),
    })?;
    let angle = table.read("uv_rotation", 0.0, |item| item.number(Interval::ANGLE))?;
    let offset = table.read("uv_offset", Vec2::ZERO, |item| item.vec2(TextureRef::MAPPING))?;
    Ok(Affine2::from_scale_angle_translation(scale, angle.to_radians(), offset))
}

/// One word for both directions, or one for each.
fn read_wrap(item: &Item<'_>) -> Result<[Wrap; 2], SceneError> {
    let Content::List(_) = item.content() else { return item.word().map(|wrap| [wrap; 2]) };
    let words = item.array::<2>("words")?;
    let mut wraps = [Wrap::Repeat; 2];
    for (wrap, word) in wraps.iter_mut().zip(&words) {
        *wrap = word.word()?;
    }
    Ok(wraps)
}

impl Word for ColorSpace {
    const WORDS: &'static [(&'static str, Self)] = &[("srgb", Self::Srgb), ("linear", Self::Linear)];
}

impl Word for Channel {
    const WORDS: &'static [(&'static str, Self)] =
        &[("red", Self::Red), ("green", Self::Green), ("blue", Self::Blue), ("alpha", Self::Alpha)];
}

impl Word for TextureFilter {
    const WORDS: &'static [(&'static str, Self)] = &[("linear", Self::Linear), ("nearest", Self::Nearest)];
}

impl Word for Wrap {
    const WORDS: &'static [(&'static str, Self)] =
        &[("repeat", Self::Repeat), ("mirror", Self::Mirror), ("clamp", Self::Clamp)];
}
