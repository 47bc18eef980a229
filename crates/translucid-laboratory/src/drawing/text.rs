//! How much room text takes.

/// Width of a line of text of a font size \[px\], after the advances of DejaVu Sans, the widest of the usual fonts.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    size * text.chars().map(advance).sum::<f64>()
}

/// Advance of a character in DejaVu Sans as a part of the font size, to about a tenth.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' => 0.28,
        ' ' | 'f' | 'r' | 't' | 'I' | 'J' | '.' | ',' | ':' | ';' | '|' | '/' | '-' | '(' | ')' | '['
        | ']' => 0.39,
        '⁰' | '¹' | '²' | '³' | '⁴' | '⁵' | '⁶' | '⁷' | '⁸' | '⁹' | 'ℓ' => 0.41,
        '⁻' => 0.53,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '—' => 0.95,
        '=' | '+' | '<' | '>' | '±' | '×' | '−' | '~' | '≤' | '≥' => 0.84,
        'A'..='Z' => 0.70,
        'c' | 'k' | 's' | 'v' | 'x' | 'y' | 'z' => 0.57,
        'a'..='z' | '0'..='9' => 0.635,
        c if c.is_ascii() => 0.64,
        // Of scripts with square characters no label is known; they would be as wide as high
        c if u32::from(c) < 0x1100 => 0.66,
        _ => 0.9,
    }
}

/// The text in lines no wider than `most` \[px\], broken between words and after hyphens where it can be.
pub(crate) fn wrap(text: &str, size: f64, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        for (i, part) in word.split_inclusive('-').enumerate() {
            let space = if i == 0 { " " } else { "" };
            match lines.last_mut() {
                Some(line) if width(line, size) + width(space, size) + width(part, size) <= most => {
                    line.push_str(space);
                    line.push_str(part);
                }
                _ => lines.push(part.to_owned()),
            }
        }
    }
    // What is still too wide ends in an ellipsis
    for line in &mut lines {
        if width(line, size) > most {
            while width(line, size) + width("…", size) > most && line.pop().is_some() {}
            line.push('…');
        }
    }
    lines
}

/// At most `count` of the lines, the last with an ellipsis where some are left out.
pub(crate) fn at_most(mut lines: Vec<String>, count: usize) -> Vec<String> {
    if lines.len() > count {
        lines.truncate(count);
        if let Some(last) = lines.last_mut() {
            *last = format!("{} …", last.trim_end_matches('…').trim_end());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrap_keeps_words_and_widths() {
        let text = "Error of the models against the time that a call of them takes";
        let lines = wrap(text, 12.0, 150.0);
        assert_eq!(lines.join(" "), text);
        assert!(lines.len() > 2 && lines.iter().all(|line| width(line, 12.0) <= 150.0));
    }

    #[test]
    fn wrap_shortens_what_has_no_spaces() {
        let lines = wrap(&"W".repeat(1000), 12.0, 100.0);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].ends_with('…') && width(&lines[0], 12.0) <= 100.0);
        assert!(wrap(" ", 12.0, 100.0).is_empty());
        assert_eq!(wrap("normalized-diffusion-refined", 12.0, 160.0), ["normalized-diffusion-", "refined"]);
    }
}
