//! Formats of images.

/// Format of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// OpenEXR, single precision.
    Exr,
    /// PNG, eight bits, linear.
    Png,
    /// DirectDraw surface, single precision, four channels.
    Dds,
    /// NumPy's archive: `lut`, and its `most_curvature`.
    Npz,
}

impl ImageFormat {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Png => "png",
            Self::Dds => "dds",
            Self::Npz => "npz",
        }
    }

    pub(crate) fn description(self) -> &'static str {
        match self {
            Self::Exr => "A lut as OpenEXR",
            Self::Png => "A lut as PNG, linear, 8 bits",
            Self::Dds => "A lut as DirectDraw surface, linear, 32 bits",
            Self::Npz => "A lut as arrays of NumPy",
        }
    }
}
