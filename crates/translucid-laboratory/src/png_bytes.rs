//! Pictures as PNG files.

use std::io;

use translucid_image::CodedPicture;

/// A PNG of three bytes a pixel that says which program has made it, and how many pixels go on a meter of paper.
pub(crate) fn encode_png(
    size: [usize; 2],
    codes: &[u8],
    pixels_per_meter: Option<u32>,
) -> io::Result<Vec<u8>> {
    let software = concat!("translucid ", env!("CARGO_PKG_VERSION"));
    let picture = CodedPicture::rgb(size, codes).with_text("Software", software);
    CodedPicture { pixels_per_meter, ..picture }.encode()
}
