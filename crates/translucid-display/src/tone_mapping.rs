//! From linear radiance to display values.

/// Conversion of linear radiance to display values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToneMapping {
    /// Clip to [0, 1], sRGB transfer curve.
    Srgb,
    /// Khronos PBR Neutral: colors below the shoulder stay as they are.
    Neutral,
    /// AgX: a filmic curve whose highlights lose saturation.
    Agx,
}

impl ToneMapping {
    /// Every curve by its name, in the order of the variants.
    pub const WORDS: [(&str, Self); 3] =
        [("srgb", Self::Srgb), ("neutral", Self::Neutral), ("agx", Self::Agx)];

    /// The curve's name.
    pub fn name(self) -> &'static str {
        Self::WORDS[self as usize].0
    }

    /// The curve of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == name).map(|&(_, curve)| curve)
    }
}

/// AgX: mixes the primaries, so that a bright pure color has something to lose saturation to.
const INSET: [[f32; 3]; 3] = [
    [0.842_479_06, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_64, 0.079_166_127],
    [0.042_375_655, 0.078_433_6, 0.879_142_97],
];
/// AgX: undoes the mixing after the curve.
const OUTSET: [[f32; 3]; 3] = [
    [1.196_879_0, -0.098_020_88, -0.099_029_744],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];

/// Display values in [0, 1] (sRGB-encoded, ready to be quantized) of a linear Rec. 709 color.
///
/// Values that are negative or NaN count as 0, infinite ones as the greatest finite number.
pub fn display_from_linear(tone_mapping: ToneMapping, color: [f32; 3]) -> [f32; 3] {
    // `max` turns NaN into 0. The bound keeps sums and products of three channels finite.
    let color = color.map(|value| value.max(0.0).min(1e30));
    let display = match tone_mapping {
        ToneMapping::Srgb => color.map(encode_srgb),
        ToneMapping::Neutral => neutral(color).map(encode_srgb),
        ToneMapping::Agx => agx(color),
    };
    display.map(|value| value.max(0.0).min(1.0))
}

/// The sRGB transfer curve [IEC 61966-2-1], linear to encoded; values above 1 become 1.
fn encode_srgb(linear: f32) -> f32 {
    if linear >= 1.0 {
        // The formula gives a little less than white.
        return 1.0;
    }
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055 }
}

/// Khronos PBR Neutral [Khronos Group 2024, "Khronos PBR Neutral Tone Mapper", specification 1.0]:
/// base colors lit by unit light stay what they are, only highlights are compressed and lose saturation.
fn neutral(color: [f32; 3]) -> [f32; 3] {
    const F90: f32 = 0.04;
    const START_COMPRESSION: f32 = 0.8 - F90;
    const DESATURATION: f32 = 0.15;

    // Take off the Fresnel reflection that a dielectric adds to its base color.
    let least = color.into_iter().fold(f32::INFINITY, f32::min);
    let offset = if least < 2.0 * F90 { least - least * least / (4.0 * F90) } else { F90 };
    let color = color.map(|value| value - offset);

    // Compress the brightest channel towards 1, the others in proportion.
    let peak = color.into_iter().fold(0.0, f32::max);
    if peak < START_COMPRESSION {
        return color;
    }
    let range = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - range * range / (peak + range - START_COMPRESSION);
    let whiteness = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    color.map(|value| {
        let compressed = value * (new_peak / peak);
        compressed + (new_peak - compressed) * whiteness
    })
}

/// AgX by Troy Sobotka (2022), base look, with the polynomial for its curve by Benjamin Wrensch (2023,
/// "Minimal AgX Implementation", mean squared error 3.7e-6; of its two polynomials the sixth degree, since
/// the seventh falls near black). The result is encoded for the display.
fn agx(color: [f32; 3]) -> [f32; 3] {
    const EV_MIN: f32 = -12.473_93;
    const EV_MAX: f32 = 4.026_069;

    let mixed = multiply(&INSET, color);
    // Apply the curve to the logarithm; log2(0) is −∞, which the bound turns into the least exposure.
    let curved = mixed.map(|value| {
        let ev = libm::log2f(value).clamp(EV_MIN, EV_MAX);
        agx_curve((ev - EV_MIN) / (EV_MAX - EV_MIN))
    });
    multiply(&OUTSET, curved)
}

/// Wrensch's polynomial of sixth degree for the default contrast, on [0, 1].
fn agx_curve(x: f32) -> f32 {
    const COEFFICIENTS: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];
    COEFFICIENTS.into_iter().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

fn multiply(rows: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [ToneMapping; 3] = [ToneMapping::Srgb, ToneMapping::Neutral, ToneMapping::Agx];

    fn close(found: [f32; 3], expected: [f32; 3], tolerance: f32) {
        for c in 0..3 {
            assert!((found[c] - expected[c]).abs() <= tolerance, "{found:?}, expected {expected:?}");
        }
    }

    #[test]
    fn srgb_meets_the_standard_points() {
        // Linear values of the 8-bit codes 0, 55, 188 and 255 [IEC 61966-2-1].
        for (linear, code) in [(0.0, 0.0), (0.038_204_37, 55.0), (0.502_886_5, 188.0), (1.0, 255.0)] {
            assert!((encode_srgb(linear) * 255.0 - code).abs() < 2e-3, "{linear}");
        }
        assert_eq!(display_from_linear(ToneMapping::Srgb, [5.0, -1.0, 1.0]), [1.0, 0.0, 1.0]);
    }

    #[test]
    fn neutral_meets_points_worked_by_hand() {
        // Below the shoulder: min ≥ 0.08, so exactly 0.04 comes off.
        close(neutral([0.5, 0.3, 0.1]), [0.46, 0.26, 0.06], 1e-6);
        // min < 0.08: offset = 0.04 − 6.25 · 0.04² = 0.03.
        close(neutral([0.4, 0.2, 0.04]), [0.37, 0.17, 0.01], 1e-6);
        // Grey 2: peak 1.96, new peak 1 − 0.0576/(1.96 + 0.24 − 0.76) = 0.96, grey stays grey.
        close(neutral([2.0; 3]), [0.96; 3], 1e-6);
        // (2.04, 1.04, 0.04): offset 0.03, peak 2.01, new peak 1 − 0.0576/1.49 = 0.9613423,
        // whiteness 1 − 1/(0.15 · 1.0486577 + 1) = 0.1359182.
        close(neutral([2.04, 1.04, 0.04]), [0.961_342_3, 0.548_064, 0.134_795], 2e-5);
    }

    #[test]
    fn agx_meets_known_points() {
        // Middle grey, 10 of 16.5 stops above black, is the curve's pivot: Sobotka's sigmoid sends it to
        // ½, the polynomial misses that by less than three times its root mean square error of 1.9e-3.
        for value in agx([0.18; 3]) {
            assert!((value - 0.5).abs() < 5.7e-3, "{value}");
        }
        // The ends of the range.
        close(display_from_linear(ToneMapping::Agx, [0.0; 3]), [0.0; 3], 0.0);
        close(display_from_linear(ToneMapping::Agx, [1e9; 3]), [0.998_58; 3], 3e-4);
    }

    #[test]
    fn agx_outset_undoes_the_inset() {
        for axis in 0..3 {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            close(multiply(&OUTSET, multiply(&INSET, unit)), unit, 2e-4);
        }
    }

    #[test]
    fn every_transform_is_monotone_on_grey_and_keeps_it_grey() {
        for tone_mapping in ALL {
            let mut last = -1.0;
            for i in 0..4000 {
                let value = (0.01 * (f32::from(i as i16) - 2000.0)).exp2();
                let [r, g, b] = display_from_linear(tone_mapping, [value; 3]);
                // The rows of AgX's published matrices sum to 1 within 2e-4, a twentieth of an 8-bit code.
                assert!(
                    (r - g).abs() < 3e-4 && (g - b).abs() < 3e-4,
                    "{tone_mapping:?} {value}: {r} {g} {b}"
                );
                assert!(r >= last - 1e-6, "{tone_mapping:?} falls at {value}: {last} then {r}");
                last = r;
            }
        }
    }

    #[test]
    fn every_transform_keeps_the_order_of_channels() {
        for tone_mapping in ALL {
            for i in 0..200 {
                let s = (f32::from(i as i16) * 0.1 - 12.0).exp2();
                let [r, g, b] = display_from_linear(tone_mapping, [0.9 * s, 0.5 * s, 0.2 * s]);
                // In the last of AgX's range both channels are white within the 3e-4 of its matrices.
                assert!(r >= g - 3e-4 && g >= b - 3e-4, "{tone_mapping:?} {s}: {r} {g} {b}");
            }
        }
    }

    #[test]
    fn every_transform_survives_anything() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, 0.0, 1e-45];
        for tone_mapping in ALL {
            for (r, g, b) in triples(&odd) {
                for value in display_from_linear(tone_mapping, [r, g, b]) {
                    assert!((0.0..=1.0).contains(&value), "{tone_mapping:?} {r} {g} {b}: {value}");
                }
            }
        }
    }

    /// All triples of the values.
    fn triples(values: &[f32]) -> Vec<(f32, f32, f32)> {
        let mut triples = Vec::new();
        for &r in values {
            for &g in values {
                triples.extend(values.iter().map(|&b| (r, g, b)));
            }
        }
        triples
    }
}
