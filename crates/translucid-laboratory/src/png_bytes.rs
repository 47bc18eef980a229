//! Pictures as PNG files.

use std::io;

/// A PNG of three bytes a pixel that says which program has made it, and how many pixels go on a meter of paper.
pub(crate) fn encode_png(size: [u32; 2], codes: &[u8], pixels_per_meter: Option<u32>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_pixel_dims(pixels_per_meter.map(|per_meter| png::PixelDimensions {
        xppu: per_meter,
        yppu: per_meter,
        unit: png::Unit::Meter,
    }));
    let software = format!("translucid {}", env!("CARGO_PKG_VERSION"));
    encoder.add_text_chunk(String::from("Software"), software).map_err(io::Error::other)?;
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer.write_image_data(codes).and_then(|()| writer.finish()).map_err(io::Error::other)?;
    Ok(bytes)
}
