//! Decoded images.

/// How stored values relate to linear light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorSpace {
    /// sRGB transfer curve: colors in 8-bit files.
    Srgb,
    /// Values as they are: data, normals, float images.
    Linear,
}

/// Pixels in rows from top to bottom, four channels red, green, blue, alpha.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// 8 bits a channel, to be decoded by the image's color space (alpha is always linear).
    Byte(Vec<[u8; 4]>),
    /// Linear half or full precision data; finite.
    Float(Vec<[f32; 4]>),
}

/// A decoded image of `width × height` pixels, both at least 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Name for messages, usually the file's.
    pub name: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Color space of `Pixels::Byte` data.
    pub color_space: ColorSpace,
    /// The data.
    pub pixels: Pixels,
}
