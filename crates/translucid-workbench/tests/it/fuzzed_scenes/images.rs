//! Small images of extreme pixels, which all scenes share.

use std::fs::File;
use std::path::Path;

use super::random::Random;

/// For colors, scalars and normals.
pub(crate) const TEXTURES: [&str; 5] = ["extremes.exr", "spoilt.exr", "noise.png", "dot.png", "line.exr"];
/// For the environment.
pub(crate) const SKIES: [&str; 5] = ["hot.exr", "extremes.exr", "dark.exr", "noise.png", "dot.png"];
/// A profile of one's own.
pub(crate) const PROFILE: &str = "profile.csv";

/// Writes the files that scenes refer to.
pub(crate) fn write(directory: &Path) {
    // Negative values, values that vanish, values that the next factor makes infinite
    let extremes = [0.0, 1.0, 1e-9, -1.0, 1e-38, 1e6, 0.5, 1e30, -1e30, 2.0, 1e-45, 3e38];
    write_float(directory, "extremes.exr", [4, 3], |x, y| extremes[4 * y + x]);
    // The loader mends these
    let spoilt = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.3];
    write_float(directory, "spoilt.exr", [2, 2], |x, y| spoilt[2 * y + x]);
    write_float(directory, "line.exr", [17, 1], |x, _| x as f32 / 16.0);
    write_float(directory, "hot.exr", [16, 8], |x, y| if (x, y) == (11, 1) { 1e12 } else { 0.0 });
    write_float(directory, "dark.exr", [3, 2], |_, _| 0.0);
    write_bytes(directory, "noise.png", [7, 5]);
    write_bytes(directory, "dot.png", [1, 1]);
    let profile = "r,reflectance\n1e-9,1e9\n1e-3,3\n0.1,3\n0.2,0\n5,1e-9\n1e6,1e-30\n";
    std::fs::write(directory.join(PROFILE), profile).expect("a file in a directory of our own");
}

/// The channels are a value, its half, its negative, and 1.
fn write_float(
    directory: &Path,
    name: &str,
    [width, height]: [usize; 2],
    value: impl Fn(usize, usize) -> f32 + Sync,
) {
    let pixel = |x, y| {
        let value = value(x, y);
        (value, 0.5 * value, -value, 1.0_f32)
    };
    exr::prelude::write_rgba_file(directory.join(name), width, height, pixel).expect("an image that fits");
}

/// Random bytes, four channels.
fn write_bytes(directory: &Path, name: &str, [width, height]: [u32; 2]) {
    let mut random = Random::new(u64::from(width));
    let bytes: Vec<u8> = (0..width * height * 4).map(|_| random.next() as u8).collect();
    let file = File::create(directory.join(name)).expect("a file in a directory of our own");
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&bytes).expect("as many bytes as pixels have");
}
