//! Writes what follows from the descriptions of questions: Python's functions, JavaScript's with their types, and the tables
//! of options in the guide.
//!
//! ```sh
//! cargo run -p translucid-desk --example doors
//! ```
//!
//! Functions go into `python/translucid/_questions.py` and between the markers `// questions` and `// end of questions` of
//! the npm package, tables between `<!-- options: NAME -->` and `<!-- end of options -->` of the guide. The test of this
//! example fails where they are out of date.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use translucid_desk::{Ask, IN_WASM, QUESTIONS};
use translucid_words::{Described, Kind, Spelling};

/// Questions that Python has under another name and signature, written by hand.
const OWN_IN_PYTHON: [&str; 2] = ["layers", "convert"];
/// Questions that JavaScript has under a signature written by hand.
const OWN_IN_JAVASCRIPT: [&str; 1] = ["convert"];

/// Pages of the guide with tables of options, or of the keys of a table among them by its path.
const PAGES: [&str; 5] = [
    "docs/guide/stack.md",
    "docs/guide/layers.md",
    "docs/guide/skin.md",
    "docs/guide/oracle.md",
    "docs/guide/conventions.md",
];

/// The start of a table, before its path.
const MARKER: &str = "<!-- options: ";

fn main() -> ExitCode {
    let written = files().and_then(|files| {
        files.into_iter().try_for_each(|file| std::fs::write(file.path, file.new).map_err(|e| e.to_string()))
    });
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            #[expect(clippy::print_stderr, reason = "a program")]
            {
                eprintln!("{error}");
            }
            ExitCode::FAILURE
        }
    }
}

/// A file as it is and as it must be.
struct Generated {
    path: PathBuf,
    #[cfg_attr(not(test), expect(dead_code, reason = "the test compares"))]
    old: String,
    new: String,
}

fn files() -> Result<Vec<Generated>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let file = |name: &str, new: &dyn Fn(&str) -> Result<String, String>| {
        let path = root.join(name);
        let old = std::fs::read_to_string(&path).unwrap_or_default();
        let new = new(&old).map_err(|error| format!("{name}: {error}"))?;
        Ok::<_, String>(Generated { path, old, new })
    };
    let between = |old: &str, text: &str| replaced(old, "// questions\n", "// end of questions\n", text);
    let mut all = vec![
        file("python/translucid/_questions.py", &|_| Ok(python()))?,
        file("crates/translucid-wasm/package/translucid.js", &|old| between(old, &javascript()))?,
        file("crates/translucid-wasm/package/translucid.d.ts", &|old| between(old, &types()))?,
    ];
    for page in PAGES {
        all.push(file(page, &|old| {
            paths(old).into_iter().try_fold(old.to_owned(), |text, path| {
                replaced(&text, &format!("{MARKER}{path} -->\n"), "<!-- end of options -->", &keys_at(path)?)
            })
        })?);
    }
    Ok(all)
}

/// Paths of the tables in a page.
fn paths(page: &str) -> Vec<&str> {
    page.split(MARKER).skip(1).filter_map(|rest| rest.split(" -->").next()).collect()
}

/// A text with something else between two markers.
fn replaced(text: &str, begin: &str, end: &str, new: &str) -> Result<String, String> {
    let missing = || format!("there is no {:?} … {:?}", begin.trim_end(), end.trim_end());
    let (head, rest) = text.split_once(begin).ok_or_else(missing)?;
    let (_, tail) = rest.split_once(end).ok_or_else(missing)?;
    Ok(format!("{head}{begin}{new}{end}{tail}"))
}

/// The Markdown table of a question's options, or of the keys at a path.
fn keys_at(path: &str) -> Result<String, String> {
    let (name, path) = path.split_once('.').unwrap_or((path, ""));
    let question = QUESTIONS.into_iter().find(|question| question.name() == name);
    let mut keys = question.ok_or_else(|| format!("there is no question {name}"))?.keys();
    for name in path.split('.').filter(|name| !name.is_empty()) {
        let key = keys.into_iter().find(|key| key.name == name);
        keys = match key.ok_or_else(|| format!("there is no key {name}"))?.kind {
            Kind::Document(keys) | Kind::Table(keys) | Kind::Tables(keys, _) => keys,
            _ => return Err(format!("{name} has no keys")),
        };
    }
    Ok(markdown(&keys, path.is_empty()))
}

/// A Markdown table of options or keys.
fn markdown(keys: &[Described], are_options: bool) -> String {
    let head = if are_options { "option" } else { "key" };
    let mut text = format!("\n| {head} | meaning | default |\n|---|---|---|\n");
    for (i, key) in keys.iter().enumerate() {
        let name = match key.kind {
            // The file that a question is about is no option
            Kind::Document(_) | Kind::Path if are_options && i == 0 && key.is_required => {
                String::from("FILE")
            }
            _ if are_options => Spelling::Flags.of(key.name),
            _ => key.name.to_owned(),
        };
        let more = if key.more.is_empty() { String::new() } else { format!(" {}", key.more) };
        let words = match key.kind.words() {
            words if words.iter().all(|word| key.doc.contains(word)) => String::new(),
            words => {
                format!(": {}", words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "))
            }
        };
        let default = match (&key.kind, key.is_required) {
            (_, true) => "must be given",
            (Kind::Flag, _) => "off",
            _ => &key.default,
        };
        // Writing to a string cannot fail
        let _ = writeln!(text, "| `{name}` | {}{words}{more} | {default} |", key.doc.replace('|', "\\|"));
    }
    text + "\n"
}

/// Lines of at most so many characters, each behind an indent.
fn wrapped(text: &str, indent: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last().map_or(0, |line| line.chars().count());
        if line > 0 && indent.len() + line + 1 + word.chars().count() > 118 {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            *line += if line.is_empty() { "" } else { " " };
            *line += word;
        }
    }
    lines.iter().map(|line| format!("{indent}{line}\n")).collect()
}

/// The meaning of a key as a sentence.
fn sentence(key: &Described) -> String {
    let mut letters = key.doc.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    let default = match key.default.as_str() {
        "" | "none" => String::new(),
        default => format!(" Default: {default}."),
    };
    let more = if key.more.is_empty() { String::new() } else { format!(" {}", key.more) };
    format!("{first}{}.{more}{default}", letters.as_str())
}

fn python() -> String {
    let mut text = String::from(
        "\"\"\"Questions of the desk as functions: generated by `cargo run -p translucid-desk --example doors`.\"\"\"\n\n\
         from __future__ import annotations\n\n\
         import os\n\
         from collections.abc import Callable, Iterable, Mapping\n\
         from typing import Any, Literal\n\n\
         from numpy.typing import ArrayLike\n\n\
         from ._answer import Answer, answer\n\n",
    );
    let own: Vec<&dyn Ask> =
        QUESTIONS.into_iter().filter(|question| !OWN_IN_PYTHON.contains(&question.name())).collect();
    let names: Vec<String> = own.iter().map(|question| format!("{:?}", question.name())).collect();
    let _ = writeln!(text, "__all__ = [{}]", names.join(", "));
    own.into_iter().for_each(|question| text += &python_function(question));
    text
}

fn python_type(kind: &Kind) -> String {
    let literal = |words: &[&str]| {
        format!("Literal[{}]", words.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", "))
    };
    match kind {
        Kind::Flag => "bool".into(),
        Kind::Whole(_) => "int".into(),
        Kind::Number(_) => "float".into(),
        Kind::Numbers(..) | Kind::Varied(_) => "ArrayLike".into(),
        Kind::Word(words) => literal(words),
        Kind::Words(words) => {
            let one = literal(words);
            format!("{one} | Iterable[{one}]")
        }
        Kind::Text(_) => "str".into(),
        Kind::Texts(_) => "str | Iterable[str]".into(),
        Kind::Path => "str | os.PathLike[str]".into(),
        Kind::Table(_) => "Mapping[str, Any]".into(),
        Kind::Tables(..) => "Iterable[Mapping[str, Any]]".into(),
        Kind::Document(_) => {
            "str | os.PathLike[str] | Mapping[str, Any] | Iterable[Mapping[str, Any]]".into()
        }
    }
}

/// The kind of a parameter in a docstring.
fn python_kind(kind: &Kind) -> String {
    match kind {
        Kind::Word(words) => {
            format!("{{{}}}", words.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", "))
        }
        Kind::Words(words) => python_kind(&Kind::Word(words.clone())) + ", or a list of them",
        Kind::Numbers(..) | Kind::Varied(_) => "array_like".into(),
        Kind::Text(form) => format!("str: {form}"),
        Kind::Texts(form) => format!("list of str: {form}"),
        Kind::Document(_) => "list of dict, dict, or path of a TOML file".into(),
        other => python_type(other)
            .replace("Iterable[Mapping[str, Any]]", "list of dict")
            .replace("Mapping[str, Any]", "dict"),
    }
}

fn python_function(question: &dyn Ask) -> String {
    let mut text = String::new();
    let (required, optional): (Vec<Described>, Vec<Described>) =
        question.keys().into_iter().partition(|key| key.is_required);
    let mut signature: Vec<String> =
        required.iter().map(|key| format!("{}: {}", key.name, python_type(&key.kind))).collect();
    signature.push("*".into());
    signature.extend(optional.iter().map(|key| match (&key.kind, key.default.as_str()) {
        (Kind::Flag, _) => format!("{}: bool = False", key.name),
        (Kind::Word(words), default) if words.contains(&default) => {
            format!("{}: {} = {default:?}", key.name, python_type(&key.kind))
        }
        _ => format!("{}: {} | None = None", key.name, python_type(&key.kind)),
    }));
    signature.push("threads: int | None = None".into());
    signature.push("progress: Callable[[int, int], object] | bool | Literal[\"tqdm\"] | None = None".into());
    let _ = writeln!(text, "\n\ndef {}(\n    {},\n) -> Answer:", question.name(), signature.join(",\n    "));
    let _ = writeln!(text, "    \"\"\"{}.\n", question.doc());
    text += &wrapped(&question.about().more.replace("\n\n", " "), "    ");
    text += "\n    Parameters\n    ----------\n";
    for key in required.iter().chain(&optional) {
        let optional = if key.is_required || key.kind == Kind::Flag { "" } else { ", optional" };
        let _ = writeln!(text, "    {} : {}{optional}", key.name, python_kind(&key.kind));
        text += &wrapped(&sentence(key), "        ");
        text += &python_keys(&key.kind, "        ");
    }
    text += "    threads : int, optional\n        Number of threads; by default one per processor. The answer does not depend on it.\n    \
             progress : callable, bool or \"tqdm\", optional\n        Called now and then with the parts done and the parts in all, \
             and an exception ends the call; True for a bar.\n\n    Returns\n    -------\n    Answer\n";
    text += match question.about().formats {
        [] => "        Without columns: `files` are its files by their names.\n",
        _ => "        Columns by their names, with `text`, `files` and `notes` beside them:\n\n",
    };
    for column in question.about().columns {
        let unit = match column.unit {
            "" | "1" => String::new(),
            unit => format!(" [{unit}]"),
        };
        text += &wrapped(&format!("- ``{}``{unit}: {}", column.name, column.meaning), "        ");
    }
    text += "\n    Raises\n    ------\n    ValueError\n        If a key is missing or unknown, a value is outside its range, or shapes do \
             not broadcast; the message names it.\n    TypeError\n        If a value is of a type that no key takes.\n";
    if !question.about().source.is_empty() {
        text += "\n    Notes\n    -----\n";
        text += &wrapped(question.about().source, "    ");
    }
    text += "    \"\"\"\n";
    let _ = writeln!(text, "    return answer({:?}, locals())", question.name());
    text
}

/// The keys of tables, as a list below a parameter.
fn python_keys(kind: &Kind, indent: &str) -> String {
    let (Kind::Document(keys) | Kind::Table(keys) | Kind::Tables(keys, _)) = kind else {
        return String::new();
    };
    let mut text = String::from("\n");
    for key in keys {
        let rest = wrapped(&format!("- ``{}``: {}", key.name, sentence(key)), indent);
        text += &rest;
        text += python_keys(&key.kind, &format!("{indent}  ")).trim_start_matches('\n');
    }
    text
}

fn of_javascript() -> impl Iterator<Item = &'static dyn Ask> {
    IN_WASM.into_iter().filter(|question| !OWN_IN_JAVASCRIPT.contains(&question.name()))
}

fn javascript() -> String {
    let function = |question: &dyn Ask| match first_required(question) {
        Some(first) => format!(
            "export const {0} = ({1}, options = {{}}) => ask({0:?}, {{ {1}, ...options }});\n",
            question.name(),
            first
        ),
        None => format!("export const {0} = (options = {{}}) => ask({0:?}, options);\n", question.name()),
    };
    of_javascript().map(function).collect()
}

/// The key that a function takes first.
fn first_required(question: &dyn Ask) -> Option<String> {
    let keys = question.keys();
    keys.first().filter(|key| key.is_required).map(|key| Spelling::Camel.of(key.name))
}

fn types() -> String {
    of_javascript().map(type_of).collect()
}

fn type_of(question: &dyn Ask) -> String {
    let name = question.name();
    let title = name[..1].to_uppercase() + &name[1..];
    let mut text = format!("/** Options of {{@link {name}}}. */\nexport interface {title}Options {{\n");
    let keys = question.keys();
    let first = first_required(question);
    for key in keys.iter().skip(usize::from(first.is_some())) {
        text += &member(key, "    ");
    }
    text += "}\n";
    let head = match (&first, keys.first()) {
        (Some(name), Some(key)) => format!("{name}: {}, ", javascript_type(&key.kind, "")),
        _ => String::new(),
    };
    let _ = writeln!(
        text,
        "/**\n * {}.\n *\n{} *\n{} */\nexport function {name}({head}options?: {title}Options): Answer;\n",
        question.doc(),
        wrapped(&question.about().more.replace("\n\n", " "), " * "),
        question
            .about()
            .columns
            .iter()
            .map(|column| wrapped(&format!("- `{}`: {}", column.name, column.meaning), " * "))
            .collect::<String>(),
    );
    text
}

fn member(key: &Described, indent: &str) -> String {
    let optional = if key.is_required { "" } else { "?" };
    let name = Spelling::Camel.of(key.name);
    format!(
        "{indent}/** {} */\n{indent}{name}{optional}: {};\n",
        sentence(key).replace("*/", "* /"),
        javascript_type(&key.kind, indent)
    )
}

fn javascript_type(kind: &Kind, indent: &str) -> String {
    let words = |words: &[&str]| words.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(" | ");
    let table = |keys: &[Described]| {
        let inner = format!("{indent}    ");
        let members: String = keys.iter().map(|key| member(key, &inner)).collect();
        format!("{{\n{members}{indent}}}")
    };
    match kind {
        Kind::Flag => "boolean".into(),
        Kind::Whole(_) | Kind::Number(_) => "number".into(),
        Kind::Numbers(..) | Kind::Varied(_) => "number | ArrayLike<number>".into(),
        Kind::Word(list) => words(list),
        Kind::Words(list) => format!("({0}) | ({0})[]", words(list)),
        Kind::Text(_) | Kind::Path => "string".into(),
        Kind::Texts(_) => "string | string[]".into(),
        Kind::Table(keys) => table(keys),
        Kind::Tables(keys, _) => format!("{}[]", table(keys)),
        Kind::Document(keys) => {
            let first = keys.iter().find(|key| matches!(key.kind, Kind::Tables(..)));
            let list =
                first.map_or(String::new(), |key| format!(" | {}", javascript_type(&key.kind, indent)));
            format!("{}{list}", table(keys))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_question_is_exported_and_has_a_page() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let module = std::fs::read_to_string(root.join("python/translucid/__init__.py")).unwrap();
        for name in QUESTIONS.map(|question| question.name()) {
            let is_own = OWN_IN_PYTHON.contains(&name);
            assert!(
                is_own || module.contains(&format!("    \"{name}\",\n")),
                "translucid.{name} is not exported"
            );
            let has_table =
                |page: &&str| paths(&std::fs::read_to_string(root.join(page)).unwrap()).contains(&name);
            assert!(PAGES.iter().any(has_table), "no page has the options of {name}");
        }
    }

    #[test]
    fn doors_are_those_of_the_descriptions() {
        for Generated { path, old, new } in files().unwrap() {
            assert!(
                old == new,
                "{} is out of date: cargo run -p translucid-desk --example doors",
                path.display()
            );
        }
    }
}
