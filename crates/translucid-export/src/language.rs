//! Languages that formulas are written in, and the translation from WGSL into them.
//!
//! Formulas use a small part of WGSL: functions of numbers, `let` and `var` with a type, `if`, `for`, `return`, `select`
//! and structs of numbers. Every other language here spells these word for word, so a translation goes through the text
//! once and keeps its comments and layout.

use std::collections::HashMap;

use crate::number::literal;
use crate::token::{Token, tokens};

/// Language of an exported text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Language {
    /// WebGPU's shading language.
    Wgsl,
    /// OpenGL's and Vulkan's, version 3.30 or ES 3.00 and later.
    Glsl,
    /// DirectX's, shader model 5 and later.
    Hlsl,
    /// Metal's, version 2 and later.
    Msl,
    /// Open Shading Language.
    Osl,
    /// C99.
    C,
    /// C++17.
    Cpp,
}

impl Language {
    /// Every language.
    pub const ALL: [Self; 7] = [Self::Wgsl, Self::Glsl, Self::Hlsl, Self::Msl, Self::Osl, Self::C, Self::Cpp];

    /// The name of a function, whose WGSL name is given, as users of the language write it.
    pub(crate) fn function_name(self, name: &str) -> String {
        match self {
            Self::Wgsl | Self::Osl | Self::Cpp => name.to_owned(),
            Self::C => format!("translucid_{name}"),
            Self::Glsl | Self::Msl => camel_case(name),
            Self::Hlsl => {
                let name = camel_case(name);
                name[..1].to_uppercase() + &name[1..]
            }
        }
    }

    /// The name of a struct.
    fn struct_name(self, name: &str) -> String {
        if self == Self::C { format!("Translucid{name}") } else { name.to_owned() }
    }

    /// The name of a constant.
    fn constant_name(self, name: &str) -> String {
        if self == Self::C { format!("TRANSLUCID_{name}") } else { name.to_owned() }
    }

    /// A function of the language itself; none for a name that it spells as WGSL.
    fn built_in(self, name: &str) -> Option<&'static str> {
        const NAMES: [(&str, &str, &str); 9] = [
            ("abs", "fabsf", "std::fabs"),
            ("cos", "cosf", "std::cos"),
            ("exp", "expf", "std::exp"),
            ("log", "logf", "std::log"),
            ("max", "fmaxf", "std::fmax"),
            ("min", "fminf", "std::fmin"),
            ("pow", "powf", "std::pow"),
            ("sin", "sinf", "std::sin"),
            ("sqrt", "sqrtf", "std::sqrt"),
        ];
        let (_, c, cpp) = NAMES.iter().find(|(wgsl, ..)| *wgsl == name)?;
        match self {
            Self::C => Some(c),
            Self::Cpp => Some(cpp),
            _ => None,
        }
    }

    /// The type of a WGSL name.
    fn type_name(self, name: &str) -> String {
        match (name, self) {
            ("f32", _) => String::from("float"),
            ("i32", _) => String::from("int"),
            ("bool", Self::Osl | Self::C) => String::from("int"),
            ("bool", _) => String::from("bool"),
            _ => self.struct_name(name),
        }
    }

    /// A number as the language writes one of single precision.
    pub(crate) fn number(self, number: &str) -> String {
        let is_real = number.contains('.') || number.contains('e');
        let takes_suffix = matches!(self, Self::C | Self::Cpp | Self::Hlsl | Self::Msl);
        if is_real && takes_suffix { format!("{number}f") } else { number.to_owned() }
    }

    /// Words before a constant.
    fn constant_words(self) -> &'static str {
        match self {
            Self::Wgsl | Self::Glsl => "const",
            Self::Hlsl | Self::C => "static const",
            Self::Msl => "constant",
            Self::Cpp => "constexpr",
            // OSL knows no constants outside of functions
            Self::Osl => "#define",
        }
    }

    /// Words before a function that a header defines.
    fn function_words(self) -> &'static str {
        match self {
            Self::C => "static inline ",
            Self::Cpp | Self::Msl => "inline ",
            _ => "",
        }
    }

    /// A table of rows of one to four numbers each, as a constant.
    ///
    /// OSL has none outside of functions.
    pub(crate) fn table<const N: usize>(self, name: &str, rows: &[[f64; N]]) -> String {
        let count = rows.len();
        let name = self.constant_name(name);
        let number = |value: &f64| self.number(&literal(*value));
        let vector = |wgsl: &str, glsl: &str, hlsl: &str| match (N, self) {
            (1, Self::Wgsl) => String::from("f32"),
            (1, _) => String::from("float"),
            (_, Self::Wgsl) => format!("{wgsl}{N}<f32>"),
            (_, Self::Glsl) => format!("{glsl}{N}"),
            (_, _) => format!("{hlsl}{N}"),
        };
        let element = vector("vec", "vec", "float");
        let rows: Vec<String> = rows
            .iter()
            .map(|row| {
                let numbers = row.iter().map(number).collect::<Vec<_>>().join(", ");
                match (N, self) {
                    (1, _) => format!("    {numbers},\n"),
                    (_, Self::C | Self::Cpp) => format!("    {{{numbers}}},\n"),
                    _ => format!("    {element}({numbers}),\n"),
                }
            })
            .collect();
        let mut rows = rows.concat();
        let words = self.constant_words();
        match self {
            Self::Wgsl => {
                format!("{words} {name}: array<{element}, {count}> = array<{element}, {count}>(\n{rows});\n")
            }
            Self::Glsl => {
                // GLSL takes no comma after the last
                rows.truncate(rows.len().saturating_sub(2));
                format!("{words} {element} {name}[{count}] = {element}[{count}](\n{rows}\n);\n")
            }
            Self::C | Self::Cpp if N > 1 => format!("{words} float {name}[{count}][{N}] = {{\n{rows}}};\n"),
            _ => format!("{words} {element} {name}[{count}] = {{\n{rows}}};\n"),
        }
    }

    /// A whole file: a comment, and definitions, which a header guards by a name for what is in it.
    pub(crate) fn file(self, comment: &str, definitions: &str, content: &str) -> String {
        let guard = format!("TRANSLUCID_{}_H", content.to_uppercase().replace('-', "_"));
        match self {
            Self::C => format!(
                "{comment}\n#ifndef {guard}\n#define {guard}\n\n#include <math.h>\n\n{definitions}\n#endif\n"
            ),
            Self::Cpp => format!(
                "{comment}\n#ifndef {guard}\n#define {guard}\n\n#include <cmath>\n\nnamespace translucid {{\n\n{definitions}\n}} // namespace translucid\n\n#endif\n"
            ),
            Self::Msl => {
                format!("{comment}\n#include <metal_stdlib>\nusing namespace metal;\n\n{definitions}")
            }
            _ => format!("{comment}\n{definitions}"),
        }
    }

    /// Translates formulas.
    pub(crate) fn translate(self, wgsl: &str) -> String {
        if self == Self::Wgsl {
            return wgsl.to_owned();
        }
        let tokens = tokens(wgsl);
        let names = Names::defined(self, &tokens);
        let mut translation =
            Translation { language: self, tokens: &tokens, names: &names, text: String::new() };
        translation.write(0, tokens.len());
        translation.text
    }
}

fn camel_case(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |text, word| text + &word[..1].to_uppercase() + &word[1..])
}

/// Names that a text defines, and what the language calls them.
struct Names<'a>(HashMap<&'a str, String>);

impl<'a> Names<'a> {
    fn defined(language: Language, tokens: &[Token<'a>]) -> Self {
        let defined = tokens.windows(3).filter_map(|window| match window {
            [Token::Word("fn"), _, Token::Word(name)] => Some((*name, language.function_name(name))),
            [Token::Word("struct"), _, Token::Word(name)] => Some((*name, language.struct_name(name))),
            [Token::Word("const"), _, Token::Word(name)] => Some((*name, language.constant_name(name))),
            _ => None,
        });
        Self(defined.collect())
    }
}

struct Translation<'a> {
    language: Language,
    tokens: &'a [Token<'a>],
    names: &'a Names<'a>,
    text: String,
}

impl<'a> Translation<'a> {
    /// Writes the pieces of a range.
    fn write(&mut self, start: usize, end: usize) {
        let mut at = start;
        while at < end {
            at = match self.tokens[at] {
                Token::Word("fn") => self.function(at),
                Token::Word("struct") => self.structure(at),
                // A declaration's type stands before its name
                Token::Word("let" | "var") => at + 2,
                Token::Word("const") => self.constant(at),
                Token::Word("select") => self.selection(at),
                Token::Word(name) if self.is_sign(at + 1, ":") => {
                    self.declare(name, at + 3);
                    at + 4
                }
                token => {
                    self.piece(token);
                    at + 1
                }
            };
        }
    }

    /// Writes one piece that means the same wherever it stands.
    fn piece(&mut self, token: Token<'_>) {
        let text = match token {
            Token::Word(word) => self.word(word),
            Token::Number(number) => self.language.number(number),
            Token::Comment(comment) => self.comment(comment),
            Token::Space(text) | Token::Sign(text) => text.to_owned(),
        };
        self.text += &text;
    }

    fn word(&self, word: &str) -> String {
        let own = self.names.0.get(word).cloned();
        own.or_else(|| self.language.built_in(word).map(String::from)).unwrap_or_else(|| word.to_owned())
    }

    /// A comment with the names that the language gives functions.
    fn comment(&self, comment: &str) -> String {
        let pieces = tokens(&comment[2..]).into_iter().map(|token| match token {
            Token::Word(word) => self.names.0.get(word).map_or(word, String::as_str),
            token => token.text(),
        });
        format!("//{}", pieces.collect::<String>())
    }

    /// Writes `type name` for a name whose type stands at a place.
    fn declare(&mut self, name: &str, type_at: usize) {
        let kind = self.language.type_name(self.tokens[type_at].text());
        let name = self.word(name);
        self.text += &format!("{kind} {name}");
    }

    /// `fn name(x: T) -> U {` as `U name(T x) {`; returns where the body begins.
    fn function(&mut self, at: usize) -> usize {
        let arrow = self.find(at, "->");
        let kind = self.language.type_name(self.tokens[arrow + 2].text());
        self.text += &format!("{}{kind} ", self.language.function_words());
        // Before the arrow there is a space
        self.write(at + 2, arrow - 1);
        arrow + 3
    }

    /// `struct Name { x: T, }` as `struct Name { T x; };`; returns where it ends.
    fn structure(&mut self, at: usize) -> usize {
        let end = self.find(at, "}");
        let is_c = self.language == Language::C;
        let name = self.word(self.tokens[at + 2].text());
        self.text += if is_c { "typedef struct " } else { "struct " };
        self.text += &name;
        let mut at = at + 3;
        while at < end {
            at = match self.tokens[at] {
                Token::Word(name) => {
                    self.declare(name, at + 3);
                    at + 4
                }
                Token::Sign(",") => {
                    self.text += ";";
                    at + 1
                }
                token => {
                    self.piece(token);
                    at + 1
                }
            };
        }
        self.text += &if is_c { format!("}} {name};") } else { String::from("};") };
        end + 1
    }

    /// `const NAME: f32 = x;`; returns where it ends.
    fn constant(&mut self, at: usize) -> usize {
        self.text += self.language.constant_words();
        if self.language != Language::Osl {
            self.text += " ";
            return at + 2;
        }
        let (equals, end) = (self.find(at, "="), self.find(at, ";"));
        let name = self.word(self.tokens[at + 2].text());
        self.text += &format!(" {name} (");
        self.write(equals + 2, end);
        self.text += ")";
        end + 1
    }

    /// `select(a, b, condition)` as `(condition ? b : a)`; returns where it ends.
    fn selection(&mut self, at: usize) -> usize {
        let mut depth = 0;
        let mut ends = Vec::new();
        let mut close = at + 1;
        loop {
            match self.tokens[close] {
                Token::Sign("(") => depth += 1,
                Token::Sign(")") => depth -= 1,
                Token::Sign(",") if depth == 1 => ends.push(close),
                _ => {}
            }
            if depth == 0 {
                break;
            }
            close += 1;
        }
        self.text += "(";
        self.write(ends[1] + 2, close);
        self.text += " ? ";
        self.write(ends[0] + 2, ends[1]);
        self.text += " : ";
        self.write(at + 2, ends[0]);
        self.text += ")";
        close + 1
    }

    fn is_sign(&self, at: usize, sign: &str) -> bool {
        self.tokens.get(at) == Some(&Token::Sign(sign))
    }

    /// Where a sign stands next; formulas are whole, so there is one.
    fn find(&self, from: usize, sign: &str) -> usize {
        (from..self.tokens.len()).find(|at| self.is_sign(*at, sign)).unwrap_or(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMULA: &str = "\
// Twice.
fn twice_of(x: f32, is_on: bool) -> f32 {
    let y: f32 = min(x, 2.0); // see twice_of
    return select(y, 2.0 * y, is_on);
}
";

    #[test]
    fn translations_keep_comments_and_layout() {
        let c = "\
// Twice.
static inline float translucid_twice_of(float x, int is_on) {
    float y = fminf(x, 2.0f); // see translucid_twice_of
    return (is_on ? 2.0f * y : y);
}
";
        assert_eq!(Language::C.translate(FORMULA), c);
        let glsl = "\
// Twice.
float twiceOf(float x, bool is_on) {
    float y = min(x, 2.0); // see twiceOf
    return (is_on ? 2.0 * y : y);
}
";
        assert_eq!(Language::Glsl.translate(FORMULA), glsl);
        assert_eq!(Language::Wgsl.translate(FORMULA), FORMULA);
        assert!(Language::Hlsl.translate(FORMULA).contains("float TwiceOf(float x, bool is_on) {"));
    }

    #[test]
    fn structs_and_constants_are_spelled_as_each_language_does() {
        let text = "struct At {\n    // across\n    x: f32,\n}\n\nconst HALF: f32 = 0.5;\n";
        let c = "typedef struct TranslucidAt {\n    // across\n    float x;\n} TranslucidAt;\n\n\
                 static const float TRANSLUCID_HALF = 0.5f;\n";
        assert_eq!(Language::C.translate(text), c);
        let osl = "struct At {\n    // across\n    float x;\n};\n\n#define HALF (0.5)\n";
        assert_eq!(Language::Osl.translate(text), osl);
    }

    #[test]
    fn tables_are_constants() {
        let rows = [[1.0, 2.0], [3.0, 4.0]];
        assert_eq!(
            Language::C.table("TAPS", &rows),
            "static const float TRANSLUCID_TAPS[2][2] = {\n    {1.0f, 2.0f},\n    {3.0f, 4.0f},\n};\n"
        );
        assert_eq!(
            Language::Glsl.table("TAPS", &rows),
            "const vec2 TAPS[2] = vec2[2](\n    vec2(1.0, 2.0),\n    vec2(3.0, 4.0)\n);\n"
        );
    }
}
