//! Text inside HTML and SVG.

/// The text with what would be markup written out, for elements and quoted attributes.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in printable(text).chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            c => escaped.push(c),
        }
    }
    escaped
}

/// The text with spaces in place of control characters, which XML has no way to write.
pub(crate) fn printable(text: &str) -> String {
    let is_other = |c: char| c.is_control() && c != '\n' || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().map(|c| if is_other(c) { ' ' } else { c }).collect()
}

/// A name that can be a part of an id: letters, digits, "-" and "_".
pub(crate) fn identifier(text: &str) -> String {
    let keep = |c: char| {
        if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c.to_ascii_lowercase() } else { '-' }
    };
    let name: String = text.chars().map(keep).collect();
    if name.is_empty() { String::from("unnamed") } else { name }
}

/// A file's name as a link to it, with what is not plain in percent signs.
pub(crate) fn link(name: &str) -> String {
    let mut link = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => link.push(char::from(byte)),
            _ => link += &format!("%{byte:02X}"),
        }
    }
    link
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_leaves_no_markup() {
        assert_eq!(escape("a<b>&\"c'\u{0}"), "a&lt;b&gt;&amp;&quot;c&#39; ");
    }

    #[test]
    fn identifier_is_plain() {
        assert_eq!(identifier("../A = 0.5"), "---a---0-5");
        assert_eq!(identifier(""), "unnamed");
    }
}
