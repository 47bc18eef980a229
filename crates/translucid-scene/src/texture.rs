//! Inputs of material parameters: a constant times an optional image.

use glam::{Affine2, Vec2, Vec3};

use translucid_words::Interval;

/// Treatment of texture coordinates outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Wrap {
    /// Repeat the image.
    #[default]
    Repeat,
    /// Repeat, mirrored every other time.
    Mirror,
    /// Stretch the edge pixels.
    Clamp,
}

/// An image's value between the centers of its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TextureFilter {
    /// Interpolated between the four nearest pixels.
    #[default]
    Linear,
    /// That of the pixel, all over its square.
    Nearest,
}

/// The channel that a scalar input reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Channel {
    /// Red; for grey images the grey value.
    #[default]
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Alpha.
    Alpha,
}

/// A reference to an image with its mapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into `Scene::images`.
    pub image: usize,
    /// Image coordinates (v upward) from mesh texture coordinates.
    pub image_from_uv: Affine2,
    /// Wrap modes in u and v.
    pub wrap: [Wrap; 2],
    /// Value between pixels.
    pub filter: TextureFilter,
}

impl TextureRef {
    /// Range of every number of [`image_from_uv`](Self::image_from_uv).
    pub const MAPPING: Interval = Interval::DIRECTION;

    /// The image over the unit square, repeated.
    pub fn new(image: usize) -> Self {
        let (wrap, filter) = ([Wrap::Repeat; 2], TextureFilter::Linear);
        Self { image, image_from_uv: Affine2::IDENTITY, wrap, filter }
    }

    /// Image coordinates of a mesh coordinate, before wrapping.
    pub fn coordinates(&self, uv: Vec2) -> Vec2 {
        self.image_from_uv.transform_point2(uv)
    }
}

/// A color parameter: factor × image × vertex color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant factor, linear Rec. 709.
    pub factor: Vec3,
    /// Image, if any.
    pub texture: Option<TextureRef>,
    /// Whether the mesh's vertex colors multiply the result.
    pub vertex_color: bool,
}

impl ColorInput {
    /// Range of the factor on an image or vertex colors: the product is clamped where it is evaluated.
    pub const TEXTURED: Interval = Interval::FACTOR;

    /// A constant color.
    pub const fn constant(color: Vec3) -> Self {
        Self { factor: color, texture: None, vertex_color: false }
    }

    /// The mesh's vertex colors.
    pub const fn vertex() -> Self {
        Self { factor: Vec3::ONE, texture: None, vertex_color: true }
    }
}

/// A scalar parameter: factor × one channel of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Constant factor.
    pub factor: f32,
    /// Image and channel, if any.
    pub texture: Option<(TextureRef, Channel)>,
}

impl ScalarInput {
    /// Range of the factor on an image: it may be a length.
    pub const TEXTURED: Interval = Interval::LENGTH;

    /// A constant.
    pub const fn constant(factor: f32) -> Self {
        Self { factor, texture: None }
    }
}

/// A tangent-space normal map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The image, data in [0, 1] meaning [−1, 1].
    pub texture: TextureRef,
    /// Factor on the x and y components, in [−100, 100].
    pub scale: f32,
}

impl NormalMap {
    /// Range of `scale`.
    pub const SCALE: Interval = Interval::closed(-100.0, 100.0);
}
