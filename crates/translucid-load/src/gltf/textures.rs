//! Images, each decoded once for each use, and the mapping from texture coordinates to them.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{Affine2, Mat2, Vec2};
use translucid_scene::{
    ColorSpace, Image, ImageKind, Pixels, Place, TextureFilter, TextureRef, Warning, Wrap,
};

use super::buffers::Arrays;
use super::document::TextureInfo;
use super::extensions::Members;
use super::uri;
use crate::image::{self, decode_for};
use crate::result::Result;

/// Use of an image's pixels.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Use {
    /// Colors with the sRGB curve.
    Color,
    /// Numbers as they are.
    Data,
    /// Alpha as it is, but 0 below and 1 from a cutoff on, given by its bits.
    Mask(u32),
}

/// The images that materials asked for.
#[derive(Default)]
pub(super) struct ImageShelf {
    pub(super) images: Vec<Image>,
    /// Repairs made by decoding.
    pub(super) warnings: Vec<Warning>,
    /// Textures by their index in the file; `None` could not be read, and a warning has been given.
    known: HashMap<(usize, Use), Option<usize>>,
}

/// KHR_texture_transform.
#[derive(Default)]
struct TextureTransform {
    offset: [f32; 2],
    rotation: f32,
    scale: Option<[f32; 2]>,
    tex_coord: Option<usize>,
}

impl TextureTransform {
    fn of(data: &Members<'_>) -> Result<Self> {
        Ok(Self {
            offset: data.get("offset")?.unwrap_or_default(),
            rotation: data.get("rotation")?.unwrap_or_default(),
            scale: data.get("scale")?,
            tex_coord: data.get("texCoord")?,
        })
    }

    /// The map on coordinates whose v points up.
    ///
    /// The extension's own map M = translation · rotation · scale is for v down, where its rotation by an
    /// angle takes (u, v) to (u cos + v sin, −u sin + v cos). With the flip F: v → 1 − v this is F M F.
    fn image_from_uv(&self) -> Affine2 {
        let (offset, scale) = (Vec2::from_array(self.offset), self.scale.map_or(Vec2::ONE, Vec2::from_array));
        let map = Affine2::from_scale_angle_translation(scale, -self.rotation, offset);
        let flip = Affine2::from_mat2_translation(Mat2::from_diagonal(Vec2::new(1.0, -1.0)), Vec2::Y);
        flip * map * flip
    }
}

impl ImageShelf {
    /// A texture's image and mapping and the number of its texture coordinates, or `None` (with a
    /// warning) if the image cannot be read.
    pub(super) fn texture(
        &mut self,
        info: &TextureInfo,
        used_as: Use,
        part: &str,
        arrays: &Arrays<'_>,
    ) -> Result<Option<(TextureRef, usize)>> {
        let (document, path) = (arrays.document, arrays.notes.path);
        let texture = document.textures.get(info.index, part)?;
        let label = document.textures.label(info.index);
        let transform = Members::of(&info.extensions, "KHR_texture_transform", part, path)?;
        let transform = transform.as_ref().map(TextureTransform::of).transpose()?.unwrap_or_default();
        let image_from_uv = transform.image_from_uv();
        if !image_from_uv.to_cols_array().iter().all(|&number| TextureRef::MAPPING.contains_single(number)) {
            return Err(arrays.notes.error(part, "its KHR_texture_transform is too large"));
        }
        let (wrap, filter) = match texture.sampler {
            Some(sampler) => {
                let sampler = document.samplers.get(sampler, &label)?;
                ([wrap(sampler.wrap_s), wrap(sampler.wrap_t)], filter(sampler.mag_filter))
            }
            None => ([Wrap::Repeat; 2], TextureFilter::Linear),
        };
        let webp = Members::of(&texture.extensions, "EXT_texture_webp", &label, path)?;
        let webp = webp.map(|data| data.require("source")).transpose()?;
        let Some(source) = webp.or(texture.source) else {
            let reason = match texture.extensions.keys().next() {
                Some(name) => format!("{} is not read", uri::clip(name)),
                None => String::from("it has no source"),
            };
            arrays.notes.warn(part, format!("{label} is left out: {reason}"));
            return Ok(None);
        };
        let image = self.image(source, used_as, part, &label, arrays)?;
        let set = transform.tex_coord.unwrap_or(info.tex_coord);
        Ok(image.map(|image| (TextureRef { image, image_from_uv, wrap, filter }, set)))
    }

    fn image(
        &mut self,
        index: usize,
        used_as: Use,
        part: &str,
        texture: &str,
        arrays: &Arrays<'_>,
    ) -> Result<Option<usize>> {
        arrays.document.images.get(index, texture)?;
        if let Some(&known) = self.known.get(&(index, used_as)) {
            return Ok(known);
        }
        let found = match used_as {
            Use::Mask(cutoff) => match self.image(index, Use::Color, part, texture, arrays)? {
                Some(color) => Ok(masked(&self.images[color], f32::from_bits(cutoff))),
                None => return Ok(None),
            },
            Use::Color => self.decode(index, ColorSpace::Srgb, arrays),
            Use::Data => self.decode(index, ColorSpace::Linear, arrays),
        };
        let found = match found {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() - 1)
            }
            Err(reason) => {
                let label = arrays.document.images.label(index);
                arrays.notes.warn(part, format!("{label} is left out: {reason}"));
                None
            }
        };
        self.known.insert((index, used_as), found);
        Ok(found)
    }

    /// The image, or what is wrong with it in words that go on after its name.
    fn decode(&mut self, index: usize, space: ColorSpace, arrays: &Arrays<'_>) -> Result<Image, String> {
        let image = &arrays.document.images.as_slice()[index];
        let mut label = arrays.document.images.label(index);
        let mut path = None;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                if !uri.starts_with("data:") {
                    label = format!("{label} ({})", uri::clip(uri));
                }
                let contents = uri::read(uri, arrays.notes)?;
                path = contents.path;
                Cow::Owned(contents.bytes)
            }
            (None, Some(view)) => {
                let view = arrays.view(view, &label);
                Cow::Borrowed(view.map_err(|error| error.message)?.bytes)
            }
            (None, None) => return Err(String::from("it has neither a URI nor a bufferView")),
        };
        let place = Place::part(arrays.notes.path, label);
        let kind = ImageKind::Plain(space);
        let image = decode_for(image::Use::Gltf, &place, &bytes, kind, &mut self.warnings);
        image.map(|image| Image { path, ..image }).map_err(|error| error.message)
    }
}

/// Wrap mode of a sampler; an unknown number repeats, the default.
fn wrap(code: Option<u32>) -> Wrap {
    match code {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// The filter of a sampler near enough to see its pixels: farther away samples average them in any case.
fn filter(code: Option<u32>) -> TextureFilter {
    if code == Some(9728) { TextureFilter::Nearest } else { TextureFilter::Linear }
}

/// A copy whose alpha is 1 where it was at least `cutoff` and 0 elsewhere.
fn masked(image: &Image, cutoff: f32) -> Image {
    let pixels = match &image.pixels {
        Pixels::Byte(pixels) => {
            let cut = |[r, g, b, a]: [u8; 4]| [r, g, b, if f32::from(a) >= 255.0 * cutoff { 255 } else { 0 }];
            Pixels::Byte(pixels.iter().copied().map(cut).collect())
        }
        Pixels::Float(pixels) => {
            let cut = |[r, g, b, a]: [f32; 4]| [r, g, b, if a >= cutoff { 1.0 } else { 0.0 }];
            Pixels::Float(pixels.iter().copied().map(cut).collect())
        }
    };
    Image { pixels, ..image.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn image_from_uv_maps_the_specification_s_example_to_the_lower_left_quadrant() {
        // KHR_texture_transform, "Example JSON": the lower left quadrant, rotated clockwise by 90°.
        let rotation = std::f32::consts::FRAC_PI_2;
        let transform =
            TextureTransform { offset: [0.0, 1.0], rotation, scale: Some([0.5; 2]), tex_coord: None };
        let map = transform.image_from_uv();
        for (uv, expected) in [([0.0, 0.0], [0.5, 0.0]), ([0.0, 1.0], [0.0, 0.0]), ([1.0, 1.0], [0.0, 0.5])] {
            let found = map.transform_point2(Vec2::from_array(uv));
            assert!(found.abs_diff_eq(Vec2::from_array(expected), 1e-6), "{uv:?} → {found}");
        }
    }

    #[test]
    fn image_from_uv_without_rotation_is_the_plain_map_seen_upside_down() {
        let transform =
            TextureTransform { offset: [0.1, 0.2], scale: Some([2.0, 3.0]), ..TextureTransform::default() };
        let map = transform.image_from_uv();
        for (u, v) in [(0.0, 0.0), (0.3, 0.8), (-1.0, 2.0)] {
            let found = map.transform_point2(Vec2::new(u, 1.0 - v));
            assert!(found.abs_diff_eq(Vec2::new(2.0 * u + 0.1, 1.0 - (3.0 * v + 0.2)), 1e-5));
        }
        assert!(TextureTransform::default().image_from_uv().abs_diff_eq(Affine2::IDENTITY, 0.0));
    }

    #[test]
    fn masked_alpha_is_zero_below_the_cutoff_and_one_from_it_on() {
        let pixels = Pixels::Byte(vec![[1, 2, 3, 127], [4, 5, 6, 128]]);
        let image = Image {
            name: "a".into(),
            path: None,
            width: 2,
            height: 1,
            color_space: ColorSpace::Srgb,
            pixels,
        };
        assert_eq!(masked(&image, 0.5).pixels, Pixels::Byte(vec![[1, 2, 3, 0], [4, 5, 6, 255]]));
    }
}
