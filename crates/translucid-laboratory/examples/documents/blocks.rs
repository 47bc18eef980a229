//! Blocks of a page that a program writes, between two markers; all the rest is prose, which it leaves alone.
//!
//! ```text
//! <!-- generated: NAME -->
//! what the program wrote
//! <!-- end -->
//! ```
//!
//! A marker stands on a line of its own, outside of code.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

/// Beginning of a block; the name and `-->` follow.
const START: &str = "<!-- generated:";
const END: &str = "<!-- end -->";

/// A block of a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Block {
    pub(crate) name: String,
    /// Line of the marker that opens it, from 1.
    pub(crate) line: usize,
    /// The lines between the markers, from 0.
    content: Range<usize>,
}

/// Reason why a page cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BlockError {
    /// From 1.
    pub(crate) line: usize,
    pub(crate) message: String,
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.line, self.message)
    }
}

/// The blocks of a page, in their order.
///
/// # Errors
/// A block has no end, an end no beginning, a name no letters, or a name is there twice.
pub(crate) fn blocks(text: &str) -> Result<Vec<Block>, BlockError> {
    let mut found: Vec<Block> = Vec::new();
    let mut open: Option<(String, usize)> = None;
    let mut is_code = false;
    for (i, line) in text.lines().enumerate() {
        let error = |message: String| Err(BlockError { line: i + 1, message });
        let line = line.trim();
        if line.starts_with("```") {
            is_code = !is_code;
        } else if is_code {
            continue;
        } else if let Some(rest) = line.strip_prefix(START) {
            let name = rest.strip_suffix("-->").unwrap_or_default().trim();
            if name.is_empty() {
                return error(format!("a marker is `{START} NAME -->`, but this is `{line}`"));
            }
            if let Some((name, start)) = &open {
                let line = start + 1;
                return error(format!(
                    "the block `{name}` of line {line} has no `{END}` before this one begins"
                ));
            }
            if let Some(other) = found.iter().find(|block| block.name == name) {
                return error(format!("the block `{name}` is in line {} already", other.line));
            }
            open = Some((name.to_owned(), i));
        } else if line == END {
            let Some((name, start)) = open.take() else {
                return error(format!("`{END}` ends nothing"));
            };
            found.push(Block { name, line: start + 1, content: start + 1..i });
        } else if line.contains(START) || line.contains(END) {
            return error(String::from("a marker stands on a line of its own"));
        }
    }
    match open {
        Some((name, start)) => {
            Err(BlockError { line: start + 1, message: format!("the block `{name}` has no `{END}`") })
        }
        None => Ok(found),
    }
}

/// The page with new contents of its blocks; one that is not among the new ones keeps what it has.
///
/// # Errors
/// As [`blocks`].
pub(crate) fn replaced(text: &str, contents: &BTreeMap<String, String>) -> Result<String, BlockError> {
    let lines: Vec<&str> = text.lines().collect();
    let mut written = String::with_capacity(text.len());
    let mut next = 0;
    let push = |written: &mut String, lines: &[&str]| {
        for line in lines {
            written.push_str(line);
            written.push('\n');
        }
    };
    for block in blocks(text)? {
        let Some(content) = contents.get(&block.name) else { continue };
        let shown = lines[block.content.clone()].join("\n");
        push(&mut written, &lines[next..block.content.start]);
        next = block.content.end;
        let content = content.trim_end();
        if is_same(&shown, content) {
            push(&mut written, &lines[block.content]);
        } else {
            push(&mut written, &content.lines().collect::<Vec<_>>());
        }
    }
    push(&mut written, &lines[next..]);
    Ok(written)
}

/// Tells whether two texts differ at most in the last digit of numbers: processors round differently.
pub(crate) fn is_same(a: &str, b: &str) -> bool {
    let (mut a, mut b) = (Tokens(a), Tokens(b));
    loop {
        match (a.next(), b.next()) {
            (None, None) => return true,
            (Some(x), Some(y)) if x == y || is_same_number(x, y) => {}
            _ => return false,
        }
    }
}

/// Two numbers with equally many decimals, and hardly more than one step of the last of them apart.
fn is_same_number(a: &str, b: &str) -> bool {
    let decimals = |text: &str| text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let is_decimal = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    let (Ok(x), Ok(y)) = (a.parse::<f64>(), b.parse::<f64>()) else { return false };
    let places = decimals(a).max(decimals(b));
    // Whole numbers are counts, and trailing zeros may be left out
    is_decimal(a) && is_decimal(b) && places > 0 && (x - y).abs() < 1.5 * 0.1f64.powi(places as i32)
}

/// A text as unsigned decimal numbers and what is between them.
struct Tokens<'a>(&'a str);

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let is_digit = |c: char| c.is_ascii_digit() || c == '.';
        let first = self.0.chars().next()?;
        let end = self.0.find(|c: char| is_digit(c) != is_digit(first)).unwrap_or(self.0.len());
        let (token, rest) = self.0.split_at(end);
        self.0 = rest;
        Some(token)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# Title\n\n<!-- generated: a/b -->\nold\n\n| 1.00 |\n<!-- end -->\nprose\n\
                        <!-- generated: c -->\n<!-- end -->\n\n```text\n<!-- generated: d -->\n```\nlast\n";

    fn contents(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
        pairs.iter().map(|(name, content)| ((*name).to_owned(), (*content).to_owned())).collect()
    }

    #[test]
    fn blocks_are_found_with_their_lines() {
        let found = blocks(PAGE).unwrap();
        let found: Vec<(&str, usize)> = found.iter().map(|block| (block.name.as_str(), block.line)).collect();
        assert_eq!(found, [("a/b", 3), ("c", 9)]);
        assert_eq!(blocks("no blocks\n").unwrap(), []);
    }

    #[test]
    fn replaced_leaves_prose_alone() {
        let written =
            replaced(PAGE, &contents(&[("a/b", "new\nlines\n"), ("c", "more"), ("d", "no")])).unwrap();
        let expected = PAGE
            .replace("old\n\n| 1.00 |\n", "new\nlines\n")
            .replace("<!-- generated: c -->\n", "<!-- generated: c -->\nmore\n");
        assert_eq!(written, expected);
        // Again is the same, and nothing new changes nothing
        assert_eq!(
            replaced(&written, &contents(&[("a/b", "new\nlines\n"), ("c", "more")])).unwrap(),
            written
        );
        assert_eq!(replaced(&written, &contents(&[])).unwrap(), written);
    }

    #[test]
    fn blocks_that_differ_in_rounding_stay() {
        let rounded = contents(&[("a/b", "old\n\n| 1.01 |")]);
        assert_eq!(replaced(PAGE, &rounded).unwrap(), PAGE);
        let changed = contents(&[("a/b", "old\n\n| 1.02 |")]);
        assert!(replaced(PAGE, &changed).unwrap().contains("| 1.02 |"));
    }

    #[test]
    fn numbers_are_the_same_to_their_last_digit() {
        for (a, b) in
            [("x 1.25 y", "x 1.26 y"), ("", ""), ("a", "a"), ("−3.10e-5", "−3.11e-5"), ("1.2", "1.20")]
        {
            assert!(is_same(a, b), "{a} {b}");
        }
        for (a, b) in [
            ("1.25", "1.27"),
            ("12", "13"),
            ("a 1.0", "b 1.0"),
            ("1.0", "1.0 2.0"),
            ("1.0", ""),
            ("1.0", "-1.0"),
        ] {
            assert!(!is_same(a, b), "{a} {b}");
        }
    }

    #[test]
    fn broken_markers_are_refused_where_they_are() {
        for (page, line, message) in [
            ("a\n<!-- generated: x -->\n", 2, "has no `<!-- end -->`"),
            ("a\n<!-- end -->\n", 2, "ends nothing"),
            ("<!-- generated: x -->\n<!-- generated: y -->\n<!-- end -->\n", 2, "of line 1 has no"),
            (
                "<!-- generated: x -->\n<!-- end -->\n<!-- generated: x -->\n<!-- end -->\n",
                3,
                "in line 1 already",
            ),
            ("<!-- generated: -->\n<!-- end -->\n", 1, "a marker is"),
            ("<!-- generated: x\n<!-- end -->\n", 1, "a marker is"),
            ("text <!-- generated: x -->\n", 1, "on a line of its own"),
            ("<!-- generated: x -->\ntext <!-- end -->\n", 2, "on a line of its own"),
        ] {
            let error = blocks(page).unwrap_err();
            assert_eq!(error.line, line, "{page}");
            assert!(error.message.contains(message), "{error}");
            assert!(replaced(page, &contents(&[("x", "new")])).is_err());
        }
    }
}
