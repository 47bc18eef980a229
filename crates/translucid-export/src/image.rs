//! Tables as images: linear values, columns and rows as in the table.

use std::io::Cursor;

use translucid_image::{CodedPicture, MetadataValue, Picture, PictureChannel};
use translucid_reference::walk::npz_of_numbers;

use crate::curvature_table::CurvatureTable;
use crate::error::ExportError;
use crate::image_format::ImageFormat;
use crate::target::Target;
use crate::transmittance::TransmittanceTable;

/// Values of red, green, blue, row by row.
pub(crate) struct Table<'a> {
    name: &'static str,
    size: [usize; 2],
    values: &'a [[f64; 3]],
    /// The meaning of columns and rows.
    note: String,
    /// The number that they end with, and its name.
    most: (&'static str, f64),
}

impl<'a> Table<'a> {
    pub(crate) fn of_curvatures(table: &'a CurvatureTable) -> Self {
        let most = table.most_curvature;
        Self {
            name: "lut",
            size: table.size,
            values: &table.values,
            note: format!(
                "pre-integrated light on a sphere: columns N.L from -1 to 1, rows curvature from 0 to {most} per length"
            ),
            most: ("most_curvature", most),
        }
    }

    pub(crate) fn of_transmittances(table: &'a TransmittanceTable) -> Self {
        let (most, last) = (table.most_thickness, table.values.len() - 1);
        Self {
            name: "transmittance",
            size: [table.values.len(), 1],
            values: &table.values,
            note: format!(
                "transmittance of a slab: column i is the thickness {most} (i/{last})^2; {}",
                table.beyond()
            ),
            most: ("most_thickness", most),
        }
    }
}

/// The bytes of a file.
pub(crate) fn encode(table: &Table<'_>, format: ImageFormat) -> Result<Vec<u8>, ExportError> {
    // Memory takes whatever is written
    let name = Target::Image(format).name();
    let failed = |error: &dyn std::fmt::Display| ExportError::new("to", name, error.to_string());
    match format {
        ImageFormat::Exr => exr(table).map_err(|error| failed(&error)),
        ImageFormat::Png => {
            let codes: Vec<u8> =
                table.values.iter().flatten().map(|v| (255.0 * v).round().clamp(0.0, 255.0) as u8).collect();
            // Programs that pass over gAMA take what they are told at import
            let description = format!(
                "{}; codes are 255 times the values, linear (gAMA 1): import it as linear data, not as sRGB",
                table.note
            );
            CodedPicture::linear_rgb(table.size, &codes)
                .with_text("Description", &description)
                .encode()
                .map_err(|error| failed(&error))
        }
        ImageFormat::Dds => Ok(dds(table)),
        ImageFormat::Npz => npz(table).map_err(|error| failed(&error)),
    }
}

fn exr(table: &Table<'_>) -> std::io::Result<Vec<u8>> {
    let [width, height] = table.size;
    let row = |y: u32, values: &mut [f64]| {
        let start = y as usize * width;
        for (pixel, value) in values.chunks_exact_mut(3).zip(&table.values[start..start + width]) {
            pixel.copy_from_slice(value);
        }
    };
    let channels = ["R", "G", "B"].map(PictureChannel::single).to_vec();
    let mut picture = Picture::new([width as u32, height as u32], channels, row).with_data(true);
    picture.software = format!("translucid {}", env!("CARGO_PKG_VERSION"));
    picture.metadata.push((format!("translucid.{}", table.name), MetadataValue::Text(table.note.clone())));
    let mut file = Cursor::new(Vec::new());
    picture.write_exr(&mut file)?;
    Ok(file.into_inner())
}

/// A DDS file of one texture: magic, `DDS_HEADER`, `D3DFMT_A32B32G32R32F`, pixels.
fn dds(table: &Table<'_>) -> Vec<u8> {
    const CAPS_HEIGHT_WIDTH_PITCH_FORMAT: u32 = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000;
    const FOUR_CC: u32 = 0x4;
    const A32B32G32R32F: u32 = 116;
    const TEXTURE: u32 = 0x1000;
    let [width, height] = table.size.map(|side| side as u32);
    let mut header = [0_u32; 31];
    header[0] = 124;
    header[1] = CAPS_HEIGHT_WIDTH_PITCH_FORMAT;
    header[2] = height;
    header[3] = width;
    header[4] = 16 * width;
    header[18] = 32;
    header[19] = FOUR_CC;
    header[20] = A32B32G32R32F;
    header[26] = TEXTURE;
    let mut file = b"DDS ".to_vec();
    file.extend(header.into_iter().flat_map(u32::to_le_bytes));
    for [red, green, blue] in table.values {
        file.extend([*red, *green, *blue, 1.0].into_iter().flat_map(|v| (v as f32).to_le_bytes()));
    }
    file
}

fn npz(table: &Table<'_>) -> std::io::Result<Vec<u8>> {
    let [width, height] = table.size;
    let values: Vec<f64> = table.values.iter().flatten().copied().collect();
    npz_of_numbers(&[(table.name, &[height, width, 3], &values), (table.most.0, &[], &[table.most.1])])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> CurvatureTable {
        CurvatureTable { size: [3, 2], most_curvature: 0.5, values: vec![[0.0, 0.5, 1.0]; 6] }
    }

    /// An sRGB chunk would have engines bend the values.
    #[test]
    fn png_states_linear_values() {
        let bytes = encode(&Table::of_curvatures(&table()), ImageFormat::Png).unwrap();
        let has = |part: &[u8]| bytes.windows(part.len()).any(|window| window == part);
        // Its length, name and content
        assert!(has(&[&[0, 0, 0, 4], &b"gAMA"[..], &100_000_u32.to_be_bytes()].concat()));
        assert!(!has(b"\0\0\0\x01sRGB") && !has(b"cHRM") && !has(b"iCCP"));
        let note = String::from_utf8_lossy(&bytes);
        assert!(note.contains("linear (gAMA 1): import it as linear data"), "{note}");
    }

    #[test]
    fn formats_begin_as_they_must() {
        for (format, magic) in [
            (ImageFormat::Exr, &b"\x76\x2f\x31\x01"[..]),
            (ImageFormat::Png, b"\x89PNG"),
            (ImageFormat::Dds, b"DDS \x7c\0\0\0"),
            (ImageFormat::Npz, b"PK\x03\x04"),
        ] {
            let bytes = encode(&Table::of_curvatures(&table()), format).unwrap();
            assert!(bytes.starts_with(magic), "{format:?}");
        }
        assert_eq!(encode(&Table::of_curvatures(&table()), ImageFormat::Dds).unwrap().len(), 128 + 6 * 16);
    }
}
