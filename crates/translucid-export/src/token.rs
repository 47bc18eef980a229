//! Words, numbers, signs, space and comments of a formula's text.

/// A piece of text; all pieces in a row are the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Token<'a> {
    /// A comment to the end of its line.
    Comment(&'a str),
    /// A keyword or a name.
    Word(&'a str),
    /// A number.
    Number(&'a str),
    /// Blanks and ends of lines.
    Space(&'a str),
    /// One sign, or an arrow.
    Sign(&'a str),
}

impl<'a> Token<'a> {
    /// The text of the piece.
    pub(crate) fn text(self) -> &'a str {
        match self {
            Self::Comment(text)
            | Self::Word(text)
            | Self::Number(text)
            | Self::Space(text)
            | Self::Sign(text) => text,
        }
    }
}

/// Cuts a text into pieces.
pub(crate) fn tokens<'a>(mut text: &'a str) -> Vec<Token<'a>> {
    let mut tokens = Vec::new();
    while let Some(first) = text.chars().next() {
        let run = |belongs: &dyn Fn(char) -> bool| text.find(|c| !belongs(c)).unwrap_or(text.len());
        let (token, length): (fn(&'a str) -> Token<'a>, usize) = if text.starts_with("//") {
            (Token::Comment, run(&|c| c != '\n'))
        } else if first.is_whitespace() {
            (Token::Space, run(&char::is_whitespace))
        } else if first.is_alphabetic() || first == '_' {
            (Token::Word, run(&|c| c.is_alphanumeric() || c == '_'))
        } else if first.is_ascii_digit() {
            (Token::Number, number_length(text))
        } else if text.starts_with("->") {
            (Token::Sign, 2)
        } else {
            (Token::Sign, first.len_utf8())
        };
        let (piece, rest) = text.split_at(length);
        tokens.push(token(piece));
        text = rest;
    }
    tokens
}

/// Length of the number that a text begins with; the sign of an exponent belongs to it.
fn number_length(text: &str) -> usize {
    let mut last = ' ';
    let end = text.find(|c: char| {
        let belongs = c.is_ascii_alphanumeric() || c == '.' || (c == '-' && last == 'e');
        last = c;
        !belongs
    });
    end.unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_in_a_row_are_the_text() {
        let text = "// a - b\nfn f(x: f32) -> f32 {\n    return x - 1e-18 * max(x, 2.0);\n}\n";
        let tokens = tokens(text);
        assert_eq!(tokens.iter().map(|token| token.text()).collect::<String>(), text);
        assert_eq!(tokens[0], Token::Comment("// a - b"));
        for expected in [Token::Sign("->"), Token::Number("1e-18"), Token::Word("max"), Token::Number("2.0")]
        {
            assert!(tokens.contains(&expected), "{expected:?}");
        }
    }
}
