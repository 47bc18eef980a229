//! Destinations of exported texts.

use translucid_profile::values;

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
    /// Every target with its name and a line about it.
    #[rustfmt::skip]
    const ROWS: [(Self, [&'static str; 2]); 12] = [
        (Self::Text(Language::Wgsl), ["wgsl", "WebGPU's shading language"]),
        (Self::Text(Language::Glsl), ["glsl", "OpenGL's and Vulkan's, from 3.30 or ES 3.00 on"]),
        (Self::Text(Language::Hlsl), ["hlsl", "DirectX's"]),
        (Self::Text(Language::Msl), ["msl", "Metal's"]),
        (Self::Text(Language::Osl), ["osl", "Open Shading Language"]),
        (Self::Text(Language::C), ["c", "A header for C99"]),
        (Self::Text(Language::Cpp), ["cpp", "A header for C++17"]),
        (Self::MaterialX, ["materialx", "A document with a node for each function, or an OpenPBR material"]),
        (Self::Image(ImageFormat::Exr), ["exr", "A lut or a transmittance as OpenEXR"]),
        (Self::Image(ImageFormat::Png), ["png", "A lut or a transmittance as PNG, linear, 8 bits"]),
        (Self::Image(ImageFormat::Dds), ["dds", "A lut or a transmittance as DirectDraw surface, linear, 32 bits"]),
        (Self::Image(ImageFormat::Npz), ["npz", "A lut or a transmittance as arrays of NumPy"]),
    ];

    /// Every target.
    pub const ALL: [Self; 12] = values(&Self::ROWS);

    fn texts(self) -> [&'static str; 2] {
        Self::ROWS.iter().find(|(target, _)| *target == self).map_or([""; 2], |&(_, texts)| texts)
    }

    /// Name as the command line writes it.
    pub fn name(self) -> &'static str {
        self.texts()[0]
    }

    /// One line about it.
    pub fn description(self) -> &'static str {
        self.texts()[1]
    }
}
