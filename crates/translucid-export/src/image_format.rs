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
