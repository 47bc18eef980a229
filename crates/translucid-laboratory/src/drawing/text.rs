//! Fonts, and the room that text takes: by the widths of DejaVu Sans, the widest of the usual ones.

/// Units of a font in its size.
const UNITS_PER_EM: f64 = 2048.0;

/// Advance widths of the characters from space to tilde in DejaVu Sans 2.37, from its table `hmtx`.
const REGULAR: [u16; 95] = [
    651, 821, 942, 1716, 1303, 1946, 1597, 563, 799, 799, 1024, 1716, 651, 739, 651, 690, 1303, 1303, 1303,
    1303, 1303, 1303, 1303, 1303, 1303, 1303, 690, 690, 1716, 1716, 1716, 1087, 2048, 1401, 1405, 1430, 1577,
    1294, 1178, 1587, 1540, 604, 604, 1343, 1141, 1767, 1532, 1612, 1235, 1612, 1423, 1300, 1251, 1499, 1401,
    2025, 1403, 1251, 1403, 799, 690, 799, 1716, 1024, 1024, 1255, 1300, 1126, 1300, 1260, 721, 1300, 1298,
    569, 569, 1186, 569, 1995, 1298, 1253, 1300, 1300, 842, 1067, 803, 1298, 1212, 1675, 1212, 1212, 1075,
    1303, 690, 1303, 1716,
];

/// Widths of the letters of DejaVu Sans Bold 2.37, in the same order and units.
const BOLD: [u16; 95] = [
    713, 934, 1067, 1716, 1425, 2052, 1786, 627, 936, 936, 1071, 1716, 778, 850, 778, 748, 1425, 1425, 1425,
    1425, 1425, 1425, 1425, 1425, 1425, 1425, 819, 819, 1716, 1716, 1716, 1188, 2048, 1585, 1561, 1503, 1700,
    1399, 1399, 1681, 1714, 762, 762, 1587, 1305, 2038, 1714, 1741, 1501, 1741, 1577, 1475, 1397, 1663, 1585,
    2259, 1579, 1483, 1485, 936, 748, 936, 1716, 1024, 1024, 1382, 1466, 1214, 1466, 1389, 891, 1466, 1458,
    702, 702, 1362, 702, 2134, 1458, 1407, 1466, 1466, 1010, 1219, 979, 1458, 1335, 1892, 1321, 1335, 1192,
    1458, 748, 1458, 1716,
];

/// Advance widths of the other characters of labels, in the regular and in the bold font.
const OTHERS: [(&str, [u16; 2]); 31] = [
    ("°–", [1024, 1024]),
    ("±×→−≈≤≥", [1716, 1716]),
    ("²³¹⁰⁴⁵⁶⁷⁸⁹₀₁₂₃", [821, 897]),
    ("·", [651, 778]),
    ("ΑΔ", [1401, 1585]),
    ("Σ", [1294, 1399]),
    ("α", [1350, 1407]),
    ("β", [1307, 1466]),
    ("γ", [1212, 1395]),
    ("δθ", [1253, 1407]),
    ("ε", [1107, 1140]),
    ("η", [1298, 1458]),
    ("κ", [1207, 1455]),
    ("λ", [1212, 1296]),
    ("μ", [1303, 1507]),
    ("ν", [1144, 1395]),
    ("π", [1233, 1620]),
    ("ρ", [1300, 1466]),
    ("σ", [1298, 1595]),
    ("τ", [1233, 1307]),
    ("φ", [1351, 1602]),
    ("χ", [1183, 1321]),
    ("ψ", [1351, 1626]),
    ("ω", [1715, 1780]),
    ("—…", [2048, 2048]),
    ("⁻", [1081, 1081]),
    ("ℓ", [846, 966]),
    ("√", [1305, 1366]),
    ("∞", [1706, 1706]),
    ("∫", [1067, 1249]),
    ("ꟻ", [1178, 1399]),
];

/// Font of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Font {
    /// Size \[px\].
    pub(crate) size: f64,
    pub(crate) weight: Weight,
}

/// Thickness of letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    Bold,
}

impl Font {
    pub(crate) const fn regular(size: f64) -> Self {
        Self { size, weight: Weight::Regular }
    }

    pub(crate) const fn bold(size: f64) -> Self {
        Self { size, weight: Weight::Bold }
    }

    /// Width of a line of text \[px\].
    pub(crate) fn width(self, text: &str) -> f64 {
        text.chars().map(|c| self.advance(c)).sum()
    }

    /// Width of a character; one that is not in the tables counts as a square.
    fn advance(self, c: char) -> f64 {
        let (ascii, other) = match self.weight {
            Weight::Regular => (&REGULAR, 0),
            Weight::Bold => (&BOLD, 1),
        };
        let of_ascii = || ascii.get((c as usize).checked_sub(usize::from(b' '))?).copied();
        let of_others =
            || OTHERS.iter().find(|(group, _)| group.contains(c)).map(|(_, widths)| widths[other]);
        let units = of_ascii().or_else(of_others).map_or(UNITS_PER_EM, f64::from);
        self.size * (units / UNITS_PER_EM)
    }

    /// From the middle of small letters and digits to the base line \[px\].
    pub(crate) fn half_height(self) -> f64 {
        0.36 * self.size
    }

    /// The text in lines no wider than `most` \[px\], broken between words and after hyphens where it can be; at most
    /// so many lines, the last with an ellipsis where some are left out.
    pub(crate) fn wrap(self, text: &str, most: f64, count: usize) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            for (i, part) in word.split_inclusive('-').enumerate() {
                let space = if i == 0 { " " } else { "" };
                match lines.last_mut() {
                    Some(line) if self.width(line) + self.width(space) + self.width(part) <= most => {
                        line.push_str(space);
                        line.push_str(part);
                    }
                    _ => lines.push(part.to_owned()),
                }
            }
        }
        lines.iter_mut().for_each(|line| self.shorten(line, most));
        if lines.len() > count {
            lines.truncate(count);
            if let Some(last) = lines.last_mut() {
                *last = format!("{} …", last.trim_end_matches('…').trim_end());
            }
        }
        lines
    }

    /// Ends a line that is too wide in an ellipsis.
    fn shorten(self, line: &mut String, most: f64) {
        let mut right = 0.0;
        let mut ends = line.char_indices().map(|(i, c)| {
            right += self.advance(c);
            (i, right)
        });
        let room = most - self.advance('…');
        let Some((end, right)) = ends.find(|(_, right)| *right > room) else { return };
        if right > most || ends.any(|(_, right)| right > most) {
            line.truncate(end);
            line.push('…');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FONT: Font = Font::regular(12.0);

    #[test]
    fn wrap_keeps_words_and_widths() {
        let text = "Error of the models against the time that a call of them takes";
        let lines = FONT.wrap(text, 150.0, 9);
        assert_eq!(lines.join(" "), text);
        assert!(lines.len() > 2 && lines.iter().all(|line| FONT.width(line) <= 150.0));
        assert_eq!(FONT.wrap(text, 150.0, 2), [lines[0].clone(), format!("{} …", lines[1])]);
    }

    #[test]
    fn wrap_shortens_what_has_no_spaces() {
        let lines = FONT.wrap(&"W".repeat(1000), 100.0, 9);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].ends_with('…') && FONT.width(&lines[0]) <= 100.0);
        assert!(FONT.wrap(" ", 100.0, 9).is_empty());
        assert_eq!(FONT.wrap("normalized-diffusion-refined", 160.0, 9), ["normalized-diffusion-", "refined"]);
    }

    #[test]
    fn widths_are_those_of_the_font() {
        let hello = 1540.0 + 1260.0 + 2.0 * 569.0 + 1253.0;
        assert!((FONT.width("Hello") - 12.0 * hello / 2048.0).abs() < 1e-9);
        assert!(Font::bold(12.0).width("Hello") > FONT.width("Hello"));
        assert_eq!(FONT.width("~"), 12.0 * 1716.0 / 2048.0);
        assert_eq!(FONT.width("字\u{7f}"), 24.0);
    }

    /// A wrong width would only move a label: none that this crate writes is guessed.
    #[test]
    fn labels_have_known_widths() {
        for c in "ΑαβεηθλμπρσφℓΣ∫√²³⁻⁰¹⁴⁵⁶⁷⁸⁹₀₁₂−×±≤≥°…–—ꟻ→".chars()
        {
            assert!(OTHERS.iter().any(|(group, _)| group.contains(c)), "{c}");
        }
    }
}
