//! Colors as words.

/// Linear color of `#rrggbb` in sRGB (IEC 61966-2-1).
pub fn hexadecimal_color(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let packed = u32::from_str_radix(digits, 16).ok()?;
    let channel = |shift: u32| linear_from_srgb(f64::from((packed >> shift) & 255) / 255.0) as f32;
    Some([channel(16), channel(8), channel(0)])
}

/// Linear value of a channel in sRGB.
pub fn linear_from_srgb(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_colors_are_decoded_from_srgb() {
        assert_eq!(hexadecimal_color("#ffffff"), Some([1.0; 3]));
        assert_eq!(hexadecimal_color("#000000"), Some([0.0; 3]));
        // IEC 61966-2-1: code 188 is 0.5029 of linear light, code 10 is 10 / 255 / 12.92.
        let color = hexadecimal_color("#BC0a00").unwrap();
        let expected = [0.502_886, 0.003_035_3, 0.0];
        assert!(color.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{color:?}");
    }

    #[test]
    fn hexadecimal_colors_have_six_digits() {
        for text in ["#fff", "#fffffff", "ffffff", "#ggffff", "#+fffff", "#", "", "#ääá"] {
            assert_eq!(hexadecimal_color(text), None, "{text}");
        }
    }
}
