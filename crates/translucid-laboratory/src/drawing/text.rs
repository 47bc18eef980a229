//! Fonts, and the room that text takes: by the glyphs of DejaVu Sans, the widest of the usual ones.

use std::sync::LazyLock;

use ttf_parser::Face;

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

    /// The glyphs.
    pub(super) fn face(self) -> Option<&'static Face<'static>> {
        static REGULAR: LazyLock<Option<Face<'static>>> =
            LazyLock::new(|| Face::parse(dejavu::sans::regular(), 0).ok());
        static BOLD: LazyLock<Option<Face<'static>>> =
            LazyLock::new(|| Face::parse(dejavu::sans::bold(), 0).ok());
        match self.weight {
            Weight::Regular => REGULAR.as_ref(),
            Weight::Bold => BOLD.as_ref(),
        }
    }

    /// Width of a line of text \[px\].
    pub(crate) fn width(self, text: &str) -> f64 {
        text.chars().map(|c| self.advance(c)).sum()
    }

    fn advance(self, c: char) -> f64 {
        let units = |face: &Face<'_>| {
            let advance = face.glyph_hor_advance(face.glyph_index(c).unwrap_or_default())?;
            Some(f64::from(advance) / f64::from(face.units_per_em()))
        };
        self.size * self.face().and_then(units).unwrap_or(0.0)
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

    /// Advances in the font's own tables, of 2048 units for its size.
    #[test]
    fn widths_are_those_of_the_font() {
        assert!(
            (FONT.width("Hello") - 12.0 * (1540.0 + 1260.0 + 2.0 * 569.0 + 1253.0) / 2048.0).abs() < 1e-9
        );
        assert!(Font::bold(12.0).width("Hello") > FONT.width("Hello"));
        // What labels of this project have: no glyph of them is missing
        for c in "ΑαβεηθλμπρσφℓΣ∫√²³⁻⁰¹⁴⁵⁶⁷⁸⁹₀₁₂−×±≤≥°…–—ꟻ→".chars()
        {
            assert!(FONT.face().unwrap().glyph_index(c).is_some(), "{c}");
        }
    }
}
