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
    /// NumPy's archive: `lut` and its `most_curvature`, or `transmittance` and its `most_thickness`.
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
            Self::Exr => "A lut or a transmittance as OpenEXR",
            Self::Png => "A lut or a transmittance as PNG, linear, 8 bits",
            Self::Dds => "A lut or a transmittance as DirectDraw surface, linear, 32 bits",
            Self::Npz => "A lut or a transmittance as arrays of NumPy",
        }
    }
}
