//! Destinations of exported texts.

use crate::image_format::ImageFormat;
use crate::language::Language;

/// The destination of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A text in a language.
    Text(Language),
    /// A document of nodes and materials.
    MaterialX,
    /// A table as an image.
    Image(ImageFormat),
}

impl Target {
    /// Every target.
    pub const ALL: [Self; 12] = [
        Self::Text(Language::Wgsl),
        Self::Text(Language::Glsl),
        Self::Text(Language::Hlsl),
        Self::Text(Language::Msl),
        Self::Text(Language::Osl),
        Self::Text(Language::C),
        Self::Text(Language::Cpp),
        Self::MaterialX,
        Self::Image(ImageFormat::Exr),
        Self::Image(ImageFormat::Png),
        Self::Image(ImageFormat::Dds),
        Self::Image(ImageFormat::Npz),
    ];

    /// Name as the command line writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text(Language::Wgsl) => "wgsl",
            Self::Text(Language::Glsl) => "glsl",
            Self::Text(Language::Hlsl) => "hlsl",
            Self::Text(Language::Msl) => "msl",
            Self::Text(Language::Osl) => "osl",
            Self::Text(Language::C) => "c",
            Self::Text(Language::Cpp) => "cpp",
            Self::MaterialX => "materialx",
            Self::Image(format) => format.name(),
        }
    }

    /// One line about it.
    pub fn description(self) -> &'static str {
        match self {
            Self::Text(Language::Wgsl) => "WebGPU's shading language",
            Self::Text(Language::Glsl) => "OpenGL's and Vulkan's, from 3.30 or ES 3.00 on",
            Self::Text(Language::Hlsl) => "DirectX's",
            Self::Text(Language::Msl) => "Metal's",
            Self::Text(Language::Osl) => "Open Shading Language",
            Self::Text(Language::C) => "A header for C99",
            Self::Text(Language::Cpp) => "A header for C++17",
            Self::MaterialX => "A document with a node for each function, or an OpenPBR material",
            Self::Image(format) => format.description(),
        }
    }
}
