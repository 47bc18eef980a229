//! Values as a scene file has them, so that each reads back to the same bits.

use glam::Vec3;

/// The shortest digits that read back to the number; a reader takes them in double precision first.
pub(super) fn number(x: f32) -> String {
    let shortest = format!("{x:?}");
    match shortest.parse::<f64>() {
        Ok(read) if (read as f32).to_bits() == x.to_bits() => shortest,
        // The digits are those of the double that the number is.
        _ => format!("{:?}", f64::from(x)),
    }
}

/// An array of numbers.
pub(super) fn numbers(list: &[f32]) -> String {
    format!("[{}]", list.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", "))
}

/// A vector.
pub(super) fn vector(v: Vec3) -> String {
    numbers(&v.to_array())
}

/// A color: one number where the channels are equal.
pub(super) fn color(c: Vec3) -> String {
    let [red, green, blue] = c.to_array().map(number);
    if red == green && green == blue { red } else { format!("[{red}, {green}, {blue}]") }
}

/// A text in quotes.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04X}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

/// The word of a list that has this meaning.
pub(super) fn word_of<T: Copy + PartialEq>(words: &[(&'static str, T)], meaning: T) -> &'static str {
    words.iter().find(|(_, other)| *other == meaning).map_or("", |(word, _)| word)
}
