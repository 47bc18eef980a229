//! The images of a scene as words.
//!
//! ```text
//! images[i]            where the texels of image i begin
//! images[at + 2 (y width + x)]    red and green as half floats, then blue and alpha
//! ```

use translucid_scene::{Image, SceneError};

/// Greatest value of a half float.
const GREATEST_HALF: f32 = 65504.0;

/// Appends the images to words that other things stand in, and returns where their places begin.
pub(super) fn append<'a>(
    images: impl Iterator<Item = &'a Image> + Clone,
    words: &mut Vec<u32>,
) -> Result<u32, SceneError> {
    let places = words.len();
    words.resize(places + images.clone().count(), 0);
    for (number, image) in images.enumerate() {
        words[places + number] = words.len() as u32;
        for y in 0..image.height {
            for x in 0..image.width {
                let texel = image.texel(x, y);
                if texel.iter().any(|value| value.abs() > GREATEST_HALF) {
                    let message = format!("image {} has values above {GREATEST_HALF}", image.name);
                    return Err(SceneError::new(message));
                }
                let [r, g, b, a] = texel.map(half_bits);
                words.extend([r | g << 16, b | a << 16]);
            }
        }
    }
    Ok(places as u32)
}

/// Bits of the half float nearest to a number of at most [`GREATEST_HALF`].
fn half_bits(value: f32) -> u32 {
    let bits = value.to_bits();
    let sign = bits >> 16 & 0x8000;
    let magnitude = f32::from_bits(bits & 0x7fff_ffff);
    if magnitude < 6.103_515_6e-5 {
        // Below 2⁻¹⁴ steps are 2⁻²⁴
        return sign | (magnitude * 16_777_216.0 + 0.5) as u32;
    }
    let rounded = (magnitude.to_bits() + 0x0fff + (magnitude.to_bits() >> 13 & 1)) >> 13;
    sign | (rounded - (112 << 10)).min(0x7bff)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(bits: u32) -> f32 {
        let (exponent, fraction) = ((bits >> 10 & 31) as i32, (bits & 1023) as f32);
        let magnitude = match exponent {
            0 => fraction / 16_777_216.0,
            _ => (1.0 + fraction / 1024.0) * 2.0_f32.powi(exponent - 15),
        };
        if bits & 0x8000 == 0 { magnitude } else { -magnitude }
    }

    #[test]
    fn halves_are_the_nearest() {
        for bits in (0..0x7c00).chain(0x8000..0xfc00) {
            assert_eq!(half_bits(value(bits)), bits);
        }
        for i in 1..2000_u16 {
            let x = f32::from(i).powi(3) * 1.7e-6;
            assert!((value(half_bits(x)) - x).abs() <= (x / 2048.0).max(0.5 / 16_777_216.0), "{x}");
        }
        assert_eq!(value(half_bits(65504.0)), 65504.0);
    }
}
