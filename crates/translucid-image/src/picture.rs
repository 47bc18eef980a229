//! A picture to be written: what it shows of a larger one, its channels and what is known of its making.

use std::fmt;
use std::io;

use crate::PixelRect;

/// Fills the values of a row: those of all channels of a pixel side by side.
type FillRow<'a> = dyn Fn(u32, &mut [f64]) + Sync + 'a;

/// A rectangle of pixels with named channels, whose values are asked for row by row.
///
/// ```
/// use translucid_image::{Picture, PictureChannel};
///
/// let channels = ["R", "G", "B"].map(PictureChannel::single);
/// let ramp = |y: u32, values: &mut [f64]| {
///     for (x, pixel) in values.chunks_exact_mut(3).enumerate() {
///         pixel.copy_from_slice(&[x as f64 / 16.0, f64::from(y) / 9.0, 0.5]);
///     }
/// };
/// let picture = Picture::new([16, 9], channels.to_vec(), ramp);
/// let mut file = std::io::Cursor::new(Vec::new());
/// picture.write_exr(&mut file)?;
/// assert!(file.get_ref().starts_with(&[0x76, 0x2f, 0x31, 0x01]));
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Picture<'a> {
    /// Pixels that the file has.
    pub region: PixelRect,
    /// Width and height of the whole picture that the region is a part of.
    pub whole: [u32; 2],
    /// Channels in the order of the values of a pixel.
    pub channels: Vec<PictureChannel>,
    /// Program that has made the picture, with its version.
    pub software: String,
    /// Whether channels R, G, B are numbers, and not a color in linear Rec. 709 as OpenEXR files state it.
    pub is_data: bool,
    /// Further notes about the making, by name.
    pub metadata: Vec<(String, MetadataValue)>,
    fill_row: Box<FillRow<'a>>,
}

impl<'a> Picture<'a> {
    /// A whole picture of a width and height, without metadata.
    ///
    /// `fill_row` is given the number of a row and the place for its values, pixel after pixel, those of a pixel in the
    /// order of `channels`. They may be anything, NaN included.
    pub fn new(
        size: [u32; 2],
        channels: Vec<PictureChannel>,
        fill_row: impl Fn(u32, &mut [f64]) + Sync + 'a,
    ) -> Self {
        Self {
            region: PixelRect::whole(size),
            whole: size,
            channels,
            software: String::new(),
            is_data: false,
            metadata: Vec::new(),
            fill_row: Box::new(fill_row),
        }
    }

    /// The picture as a region of a larger one of this width and height.
    ///
    /// Rows keep the numbers that they have in the larger picture, and begin at the column `region.left`.
    #[must_use]
    pub fn within(self, region: PixelRect, whole: [u32; 2]) -> Self {
        Self { region, whole, ..self }
    }

    /// The picture, whose channels R, G, B are no color, or one of another space, if that is so.
    #[must_use]
    pub fn with_data(self, is_data: bool) -> Self {
        Self { is_data, ..self }
    }

    /// Adds what is known of the making.
    #[must_use]
    pub fn with_metadata(self, software: &str, metadata: Vec<(String, MetadataValue)>) -> Self {
        Self { software: software.to_owned(), metadata, ..self }
    }

    /// Width and height of the region in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.region.width as usize, self.region.height as usize]
    }

    /// Place of a channel among the values of a pixel.
    pub(crate) fn index_of(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|channel| channel.name == name)
    }

    /// Places of several channels; the error names one that is not there.
    pub(crate) fn indices_of<const N: usize>(&self, names: [&str; N]) -> io::Result<[usize; N]> {
        let mut indices = [0; N];
        for (index, name) in indices.iter_mut().zip(names) {
            *index = self.index_of(name).ok_or_else(|| invalid(&format!("there is no channel {name}")))?;
        }
        Ok(indices)
    }

    /// Memory for the values of a row.
    pub(crate) fn new_row(&self) -> Vec<f64> {
        vec![0.0; self.size()[0] * self.channels.len()]
    }

    /// Fills in the values of a row, by its number in the whole picture.
    ///
    /// `values` has room for those of all pixels of the row, one after another.
    pub fn read_row(&self, y: u32, values: &mut [f64]) {
        (self.fill_row)(y, values);
    }

    /// Refuses pictures without pixels or channels and regions that are not within the whole.
    pub(crate) fn check(&self) -> io::Result<()> {
        let [width, height] = self.whole;
        if !self.region.is_within(self.whole) {
            let (x, y) = (self.region.columns(), self.region.rows());
            return Err(invalid(&format!(
                "the region {},{},{},{} is not a part of {width}x{height} pixels",
                x.start, y.start, x.end, y.end
            )));
        }
        if i32::try_from(width.max(height)).is_err() {
            return Err(invalid(&format!("{width}x{height} pixels are too many for a file")));
        }
        if self.channels.is_empty() {
            return Err(invalid("the picture has no channels"));
        }
        Ok(())
    }
}

impl fmt::Debug for Picture<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Picture")
            .field("region", &self.region)
            .field("whole", &self.whole)
            .field("channels", &self.channels)
            .field("software", &self.software)
            .field("metadata", &self.metadata)
            .finish_non_exhaustive()
    }
}

/// An error about a picture that cannot be a file.
pub(crate) fn invalid(message: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

/// A channel of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureChannel {
    /// Name, as `R` or `albedo.G`.
    pub name: String,
    /// Precision in files of floating-point numbers.
    pub precision: Precision,
}

impl PictureChannel {
    /// A channel of 32-bit numbers.
    pub fn single(name: &str) -> Self {
        Self { name: name.to_owned(), precision: Precision::Single }
    }

    /// A channel of 16-bit numbers.
    pub fn half(name: &str) -> Self {
        Self { name: name.to_owned(), precision: Precision::Half }
    }
}

/// Floating-point format of a channel in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 16 bits.
    Half,
    /// 32 bits.
    Single,
}

/// A note about the making of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum MetadataValue {
    /// A text.
    Text(String),
    /// A whole number.
    Integer(i32),
    /// A number; one that is not finite is written as 0.
    Real(f64),
}

impl fmt::Display for MetadataValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::Integer(number) => number.fmt(f),
            Self::Real(number) => number.fmt(f),
        }
    }
}

/// The value within ±limit; NaN is 0.
pub(crate) fn finite(value: f64, limit: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(-limit, limit) }
}

/// The value as a finite 32-bit number; NaN is 0.
pub(crate) fn finite_single(value: f64) -> f32 {
    finite(value, f64::from(f32::MAX)) as f32
}
