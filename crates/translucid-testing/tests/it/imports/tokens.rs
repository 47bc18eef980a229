//! Words and signs of Rust code, without comments, strings and tests.

/// A word or a sign, and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    /// A word, `::`, or one character of what else there is.
    pub(super) text: String,
    /// From 1.
    pub(super) line: usize,
}

impl Token {
    pub(super) fn is(&self, text: &str) -> bool {
        self.text == text
    }

    pub(super) fn is_word(&self) -> bool {
        self.text.starts_with(is_of_word)
    }
}

/// Words by which an item begins.
const ITEMS: [&str; 12] =
    ["const", "enum", "extern", "fn", "impl", "mod", "static", "struct", "trait", "type", "union", "use"];

/// Tokens of a file but for items under `#[cfg(test)]` and `#[cfg(doctest)]`.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    without_tests(&all_tokens(text))
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn all_tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let (mut i, mut line) = (0, 1);
    while i < chars.len() {
        let end = end_of_piece(&chars, i);
        if let Some(text) = token(&chars[i..end]) {
            tokens.push(Token { text, line });
        }
        line += chars[i..end].iter().filter(|c| **c == '\n').count();
        i = end;
    }
    tokens
}

/// The token that a piece of code is, unless it is a space, a comment or a literal.
fn token(piece: &[char]) -> Option<String> {
    let is_text = piece.len() > 1 && !is_of_word(piece[0]) && piece != [':', ':'];
    let is_literal = piece.iter().any(|c| matches!(c, '"' | '\'')) && piece.len() > 1;
    (!is_text && !is_literal && !piece[0].is_whitespace()).then(|| piece.iter().collect())
}

/// End of the comment, literal, word or sign that begins at `start`.
fn end_of_piece(chars: &[char], start: usize) -> usize {
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    match (at(start), at(start + 1)) {
        ('/', '/') => end_where(chars, start, |c| c == '\n'),
        ('/', '*') => end_of_block_comment(chars, start),
        (':', ':') => start + 2,
        ('"', _) => end_of_string(chars, start + 1),
        ('b' | 'c', '"') => end_of_string(chars, start + 2),
        ('r', '"' | '#') => end_of_raw_string(chars, start + 1),
        ('b' | 'c', 'r') if matches!(at(start + 2), '"' | '#') => end_of_raw_string(chars, start + 2),
        ('\'', '\\') => end_where(chars, start + 3, |c| c == '\'') + 1,
        ('\'', _) if at(start + 2) == '\'' => start + 3,
        // A lifetime
        ('\'', _) => end_where(chars, start + 1, |c| !is_of_word(c)),
        (c, _) if is_of_word(c) => end_where(chars, start, |c| !is_of_word(c)),
        _ => start + 1,
    }
    .min(chars.len())
}

fn end_where(chars: &[char], start: usize, is_end: impl Fn(char) -> bool) -> usize {
    (start..chars.len()).find(|i| is_end(chars[*i])).unwrap_or(chars.len())
}

fn end_of_block_comment(chars: &[char], start: usize) -> usize {
    let mut depth = 0;
    let mut i = start;
    while i + 1 < chars.len() {
        match (chars[i], chars[i + 1]) {
            ('/', '*') => depth += 1,
            ('*', '/') => depth -= 1,
            _ => {
                i += 1;
                continue;
            }
        }
        i += 2;
        if depth == 0 {
            return i;
        }
    }
    chars.len()
}

fn end_of_string(chars: &[char], start: usize) -> usize {
    let mut i = start;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// End of a raw string whose `#`s begin at `start`, or of the word `r` where it is none.
fn end_of_raw_string(chars: &[char], start: usize) -> usize {
    let quote = end_where(chars, start, |c| c != '#');
    let hashes = quote - start;
    if chars.get(quote) != Some(&'"') {
        return start;
    }
    let is_end =
        |i: &usize| chars[*i] == '"' && chars[i + 1..].iter().take_while(|c| **c == '#').count() >= hashes;
    (quote + 1..chars.len()).find(is_end).map_or(chars.len(), |end| end + 1 + hashes)
}

fn without_tests(tokens: &[Token]) -> Vec<Token> {
    let mut kept = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let end = end_of_attribute(tokens, i);
        if end > i && is_for_tests(&tokens[i..end]) {
            i = end_of_item(tokens, end);
        } else {
            kept.push(tokens[i].clone());
            i += 1;
        }
    }
    kept
}

/// Whether an attribute is a `cfg` that holds in tests only.
fn is_for_tests(attribute: &[Token]) -> bool {
    let has = |text: &str| attribute.iter().any(|token| token.is(text));
    attribute[2].is("cfg") && (has("test") || has("doctest")) && !has("not") && !has("any")
}

/// End of the attribute `#[…]` that begins at `start`, or `start` where there is none.
fn end_of_attribute(tokens: &[Token], start: usize) -> usize {
    let is_attribute = tokens[start].is("#") && tokens.get(start + 1).is_some_and(|token| token.is("["));
    if is_attribute { end_of_brackets(tokens, start + 1) } else { start }
}

/// End of the brackets of any kind that open at `start`.
fn end_of_brackets(tokens: &[Token], start: usize) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(start) {
        match token.text.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    tokens.len()
}

/// End of an item, a statement or a field: behind its block or `;`, or a field's `,`.
fn end_of_item(tokens: &[Token], start: usize) -> usize {
    let mut i = start;
    let mut is_item = false;
    while i < tokens.len() {
        is_item |= ITEMS.contains(&tokens[i].text.as_str());
        match tokens[i].text.as_str() {
            ";" => return i + 1,
            "," if !is_item => return i + 1,
            "{" => {
                let end = end_of_brackets(tokens, i);
                return if tokens.get(end).is_some_and(|token| token.is(";")) { end + 1 } else { end };
            }
            "(" | "[" => i = end_of_brackets(tokens, i),
            "}" => return i,
            _ => i += 1,
        }
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(code: &str) -> String {
        let texts: Vec<String> = tokens(code).into_iter().map(|token| token.text).collect();
        texts.join(" ")
    }

    #[test]
    fn comments_and_literals_are_left_out() {
        assert_eq!(texts("a::b // c\n/* d /* e */ f */ g"), "a :: b g");
        assert_eq!(texts(r##"a "b \" c" d r#"e " f"# g b"h" '"' '\'' i"##), "a d g i");
        assert_eq!(texts("fn f<'a>(r: &'a str) -> u8 { b'x' }"), "fn f < > ( r : & str ) - > u8 { b }");
    }

    #[test]
    fn tests_are_left_out() {
        assert_eq!(texts("a #[cfg(test)] mod tests { b { c } } d"), "a d");
        assert_eq!(texts("a #[cfg(test)] use b::{c, d}; e"), "a e");
        assert_eq!(texts("a #[cfg(test)] #[path(x)] mod b; #[cfg(unix)] c"), "a # [ cfg ( unix ) ] c");
        assert_eq!(texts("#[cfg(all(test, unix))] fn f<A, B>(a: B) -> C { d } e"), "e");
        assert_eq!(texts("{ #[cfg(test)] a: B, c: D }"), "{ c : D }");
    }

    #[test]
    fn lines_are_counted() {
        let found = tokens("a\n\"\n\"\n/*\n*/ b");
        assert_eq!(found.iter().map(|token| token.line).collect::<Vec<_>>(), [1, 5]);
    }
}
