//! Typed reading of tables of values: every error names key, value, and what is allowed.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use translucid_profile::nearest;

use super::value::{Content, Entry, Value};
use super::word::Word;
use crate::color::hexadecimal_color;
use crate::interval::{Interval, WholeInterval};
use crate::{Error, Place};

/// What values were read from, into which errors point.
#[derive(Clone, Debug)]
pub struct Provenance {
    path: PathBuf,
    text: Arc<str>,
    /// Where the lines of the text end: a large file has many places.
    line_ends: Arc<[usize]>,
    /// What the values are about, as a whole: "a scene", or another kind of file.
    whole: &'static str,
    /// The part of a scene that the values are about, where they are in no file.
    part: Option<String>,
    /// The origin of the scene, from which the points that are read are counted.
    origin: [f64; 3],
    /// How keys of the outermost table are spelled.
    spelling: Spelling,
}

/// The way in which a door spells the keys of a question.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spelling {
    /// As they are: `surface_albedo`.
    #[default]
    Keys,
    /// As options of a command: `--surface-albedo`.
    Flags,
    /// As in JavaScript: `surfaceAlbedo`.
    Camel,
}

impl Spelling {
    /// The key in this spelling.
    pub fn of(self, key: &str) -> String {
        match self {
            Self::Keys => key.to_owned(),
            Self::Flags => format!("--{}", key.replace('_', "-")),
            Self::Camel => {
                let mut words = key.split('_');
                let mut spelled = words.next().unwrap_or_default().to_owned();
                for word in words {
                    let mut letters = word.chars();
                    spelled.extend(letters.next().into_iter().flat_map(char::to_uppercase));
                    spelled += letters.as_str();
                }
                spelled
            }
        }
    }
}

impl Provenance {
    /// A file with its text.
    pub fn file(path: &Path, text: &str) -> Self {
        let line_ends =
            text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(end, _)| end).collect();
        Self {
            path: path.to_owned(),
            text: Arc::from(text),
            line_ends,
            whole: "a scene",
            part: None,
            origin: [0.0; 3],
            spelling: Spelling::Keys,
        }
    }

    /// Values that are in no file: errors name the part of the scene that they are about.
    pub fn part(part: &str) -> Self {
        let (text, line_ends) = (Arc::from(""), Arc::from([]));
        let (path, part) = (PathBuf::new(), Some(part.to_owned()));
        Self { path, text, line_ends, whole: "it", part, origin: [0.0; 3], spelling: Spelling::Keys }
    }

    /// The same values in a scene of this origin.
    #[must_use]
    pub fn in_scene_at(self, origin: [f64; 3]) -> Self {
        Self { origin, ..self }
    }

    /// The same values, whose outermost keys are spelled otherwise in messages.
    #[must_use]
    pub fn spelled(self, spelling: Spelling) -> Self {
        Self { spelling, ..self }
    }

    /// The same values, as those of another thing than a scene, which messages name.
    #[must_use]
    pub fn of(self, whole: &'static str) -> Self {
        Self { whole, ..self }
    }

    /// The file; empty where there is none.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The text of the file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The place of bytes of the text.
    pub fn place(&self, span: Range<usize>) -> Place {
        match &self.part {
            Some(part) => Place::part(&self.path, part),
            None => Place {
                line: Some(1 + self.line_ends.partition_point(|&end| end < span.start)),
                excerpt: Some((Arc::clone(&self.text), span)),
                ..Place::file(&self.path)
            },
        }
    }

    /// An error at bytes of the text.
    pub fn error(&self, span: Range<usize>, message: impl Into<String>) -> Error {
        Error::at(self.place(span), message)
    }
}

/// A table of values: entries by key, each read with its place.
pub struct Table<'a> {
    source: &'a Provenance,
    entries: &'a [Entry],
    /// Where a missing key is reported: the table's header.
    span: Range<usize>,
    /// Dotted path of the table, empty for the whole source.
    path: String,
    /// Keys that the table may have.
    keys: Vec<&'static str>,
}

impl<'a> Table<'a> {
    /// All entries of a source.
    pub fn root(source: &'a Provenance, entries: &'a [Entry]) -> Self {
        Self { source, entries, span: 0..0, path: String::new(), keys: Vec::new() }
    }

    /// Refuses keys that are not in the list.
    ///
    /// This comes before anything is read: a misspelt key is a better message than the missing one.
    ///
    /// # Errors
    /// There is such a key: the first in the source.
    pub fn allow(mut self, keys: &[&'static str]) -> Result<Self, Error> {
        self.keys = keys.to_vec();
        let unknown = self.entries.iter().filter(|entry| !self.keys.contains(&entry.key.as_str()));
        match unknown.min_by_key(|entry| entry.span.start) {
            Some(entry) => Err(self.unknown(entry)),
            None => Ok(self),
        }
    }

    fn unknown(&self, entry: &Entry) -> Error {
        let message = format!("{} has no key {}", self.path(), shown(&entry.key));
        let spelled = |key: &&str| match self.source.spelling {
            Spelling::Camel => Spelling::Camel.of(key),
            _ => (*key).to_owned(),
        };
        let keys: Vec<String> = self.keys.iter().map(spelled).collect();
        let all = format!("the keys are {}", keys.join(", "));
        let near = nearest(&entry.key, keys.iter().map(String::as_str)).map(str::to_owned);
        let help = match near.or_else(|| meant_by(&entry.key, &self.keys).map(spelled)) {
            Some(near) => format!("did you mean {near}? {all}"),
            None => all,
        };
        self.source.error(entry.span.clone(), message).with_help(help)
    }

    /// Origin of the scene that the table is part of.
    pub fn origin(&self) -> [f64; 3] {
        self.source.origin
    }

    /// Dotted path of the table.
    pub fn path(&self) -> &str {
        // An error of a part has the part before it
        if self.path.is_empty() { self.source.whole } else { &self.path }
    }

    /// Dotted path of a key.
    pub fn path_of(&self, key: &str) -> String {
        match self.source.spelling {
            spelling if self.path.is_empty() => spelling.of(key),
            Spelling::Camel => format!("{}.{}", self.path, Spelling::Camel.of(key)),
            _ => format!("{}.{key}", self.path),
        }
    }

    /// A key as messages about its own table have it.
    pub fn name_of(&self, key: &str) -> String {
        match self.source.spelling {
            Spelling::Flags if !self.path.is_empty() => key.to_owned(),
            spelling => spelling.of(key),
        }
    }

    /// The value of a key.
    pub fn get(&self, key: &'static str) -> Option<Item<'a>> {
        debug_assert!(self.keys.is_empty() || self.keys.contains(&key), "{key} is read but not allowed");
        let Entry { span, value, .. } = self.entries.iter().find(|entry| entry.key == key)?;
        let path = self.path_of(key);
        Some(Item { source: self.source, path, key_span: span.clone(), value })
    }

    /// The value of a key that must be there.
    ///
    /// # Errors
    /// It is not.
    pub fn require(&self, key: &'static str) -> Result<Item<'a>, Error> {
        self.get(key).ok_or_else(|| self.error(format!("{} needs the key {key}", self.path())))
    }

    /// The value of a key read by `read`, or the default.
    ///
    /// # Errors
    /// That of `read`.
    pub fn read<T>(
        &self,
        key: &'static str,
        default: T,
        read: impl FnOnce(&Item<'a>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.get(key).map_or(Ok(default), |item| read(&item))
    }

    /// The tables of an array of tables, none if the key is not there.
    ///
    /// # Errors
    /// It is no such array, or has more than `limit` tables.
    pub fn tables(&self, key: &'static str, limit: usize) -> Result<Vec<Table<'a>>, Error> {
        let Some(item) = self.get(key) else { return Ok(Vec::new()) };
        let Content::List(list) = &item.value.content else {
            return Err(item.mismatch(&format!("an array of tables, each with the header [[{key}]]")));
        };
        item.elements_within(list, limit)?.iter().map(Item::table).collect()
    }

    /// Its place.
    pub fn place(&self) -> Place {
        self.source.place(self.span.clone())
    }

    /// An error of the whole table.
    pub fn error(&self, message: impl Into<String>) -> Error {
        self.source.error(self.span.clone(), message)
    }
}

/// A value with the path that leads to it.
pub struct Item<'a> {
    source: &'a Provenance,
    path: String,
    key_span: Range<usize>,
    value: &'a Value,
}

impl<'a> Item<'a> {
    /// Dotted path of the key.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The value.
    pub fn content(&self) -> &'a Content {
        &self.value.content
    }

    /// Origin of the scene that the value is part of.
    pub fn origin(&self) -> [f64; 3] {
        self.source.origin
    }

    /// Its place.
    pub fn place(&self) -> Place {
        self.source.place(self.value.span.clone())
    }

    /// An error at the value.
    pub fn error(&self, message: impl Into<String>) -> Error {
        self.source.error(self.value.span.clone(), message)
    }

    /// "KEY is VALUE, but must be …", pointing at the value.
    pub fn refuse(&self, must_be: &str) -> Error {
        let found = match self.source.text.get(self.value.span.clone()) {
            Some(written) if !written.is_empty() => shown(written),
            _ => shown(&format!("{:#}", self.value)),
        };
        self.error(format!("{} is {found}, but must be {must_be}", self.path))
    }

    /// "KEY is a string, but must be …", pointing at the value.
    pub fn mismatch(&self, must_be: &str) -> Error {
        let found = match self.content() {
            // Options are texts in any case
            Content::Text(_) if self.source.spelling == Spelling::Flags => return self.refuse(must_be),
            Content::Text(_) => "a string",
            Content::Integer(_) | Content::Float(_) => "a number",
            Content::Flag(_) => "a truth value",
            Content::List(_) => "an array",
            Content::Table(_) => "a table",
            Content::Numbers(_) => "an array",
            Content::Object(_) => "an image",
            Content::Other(kind) => kind,
        };
        self.error(format!("{} is {found}, but must be {must_be}", self.path))
    }

    /// The text, if it is one.
    pub fn as_text(&self) -> Option<&'a str> {
        if let Content::Text(text) = self.content() { Some(text) } else { None }
    }

    /// Whether it is the word that takes away what the base of an extending file has.
    pub fn is_none(&self) -> bool {
        self.as_text() == Some("none")
    }
}

/// The kinds of values, each with the error of what is none.
///
/// # Errors
/// The value is of another kind, or out of the range.
impl<'a> Item<'a> {
    /// True or false.
    pub fn flag(&self) -> Result<bool, Error> {
        if let Content::Flag(flag) = self.content() { Ok(*flag) } else { Err(self.mismatch("true or false")) }
    }

    /// A text.
    pub fn text(&self) -> Result<&'a str, Error> {
        self.as_text().ok_or_else(|| self.mismatch("a string"))
    }

    /// A text of at least one character.
    pub fn name(&self) -> Result<String, Error> {
        match self.text()? {
            "" => Err(self.refuse("a name that is not empty")),
            name => Ok(name.to_owned()),
        }
    }

    /// A path, relative to the folder of the file that it was read from.
    pub fn file(&self) -> Result<PathBuf, Error> {
        match self.as_text() {
            None => Err(self.mismatch("the path of a file")),
            Some(path) if path.is_empty() || path.contains('\0') => Err(self.refuse("the path of a file")),
            Some(path) => Ok(self.source.path.parent().unwrap_or(Path::new("")).join(path)),
        }
    }

    /// One of the words of a type.
    pub fn word<T: Word>(&self) -> Result<T, Error> {
        self.word_of(T::WORDS)
    }

    /// One of a list of words.
    pub fn word_of<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, Error> {
        let names: Vec<&str> = words.iter().map(|&(name, _)| name).collect();
        self.choice(&names).map(|number| words[number].1)
    }

    /// The number of one of a list of words.
    pub fn choice(&self, names: &[&str]) -> Result<usize, Error> {
        let list = names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        let must_be = format!("one of {list}");
        let word = self.as_text().ok_or_else(|| self.mismatch(&must_be))?;
        names.iter().position(|&name| name == word).ok_or_else(|| {
            let error = self.refuse(&must_be);
            match nearest(word, names.iter().copied()) {
                Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
                None => error,
            }
        })
    }

    /// A whole number.
    pub fn integer(&self, range: WholeInterval) -> Result<u64, Error> {
        let must_be = range.to_string();
        match self.content() {
            Content::Integer(n) => {
                let n = u64::try_from(*n).ok().filter(|&n| range.contains(n));
                n.ok_or_else(|| self.refuse(&must_be))
            }
            Content::Float(_) => Err(self.refuse(&must_be)),
            _ => Err(self.mismatch(&must_be)),
        }
    }

    /// A whole number of 32 bits.
    pub fn count(&self, range: WholeInterval) -> Result<u32, Error> {
        self.integer(range).map(|n| n as u32)
    }

    /// A number in double precision.
    pub fn double(&self, range: Interval) -> Result<f64, Error> {
        let number = match self.content() {
            Content::Integer(n) => *n as f64,
            Content::Float(x) => *x,
            _ => return Err(self.mismatch(&format!("a number in {range}"))),
        };
        if range.contains(number) { Ok(number) } else { Err(self.refuse(&format!("in {range}"))) }
    }

    /// A number whose single precision is in the range.
    pub fn number(&self, range: Interval) -> Result<f32, Error> {
        let rounded = self.double(range)? as f32;
        // Rounding may reach an open end: 1e-60 becomes 0.
        if range.contains_single(rounded) {
            Ok(rounded)
        } else {
            Err(self.refuse(&format!("in {range} in single precision")))
        }
    }

    /// `N` numbers.
    pub fn numbers<const N: usize>(&self, range: Interval) -> Result<[f32; N], Error> {
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(self.array::<N>("numbers")?) {
            *number = item.number(range)?;
        }
        Ok(numbers)
    }

    /// `N` numbers in double precision.
    pub fn doubles<const N: usize>(&self, range: Interval) -> Result<[f64; N], Error> {
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(self.array::<N>("numbers")?) {
            *number = item.double(range)?;
        }
        Ok(numbers)
    }

    /// A color: a number, three numbers, or `"#rrggbb"`.
    pub fn rgb(&self, range: Interval) -> Result<[f32; 3], Error> {
        match self.content() {
            Content::Integer(_) | Content::Float(_) => self.number(range).map(|number| [number; 3]),
            Content::List(_) => self.numbers(range),
            Content::Text(word) => {
                hexadecimal_color(word).ok_or_else(|| self.refuse("\"#rrggbb\" with hexadecimal digits"))
            }
            _ => Err(self.mismatch("three numbers or \"#rrggbb\"")),
        }
    }

    /// An array of exactly `N` values; `what` names them in the message.
    pub fn array<const N: usize>(&self, what: &str) -> Result<Vec<Item<'a>>, Error> {
        let must_be = format!("an array of {N} {what}");
        match self.content() {
            Content::List(list) if list.len() == N => Ok(self.elements(list)),
            Content::List(list) => {
                let message = format!("{} has {} values, but must be {must_be}", self.path, list.len());
                Err(self.error(message))
            }
            _ => Err(self.mismatch(&must_be)),
        }
    }

    /// The values of an array of at most `limit`; `what` names them in the message.
    pub fn list(&self, what: &str, limit: usize) -> Result<Vec<Item<'a>>, Error> {
        let Content::List(list) = self.content() else {
            return Err(self.mismatch(&format!("an array of {what}")));
        };
        self.elements_within(list, limit)
    }

    /// A table, or those of an array of one or more.
    pub fn one_or_more_tables(&self, limit: usize) -> Result<Vec<Table<'a>>, Error> {
        match self.content() {
            Content::List(list) if list.is_empty() => Err(self.refuse("one table or more")),
            Content::List(list) => self.elements_within(list, limit)?.iter().map(Item::table).collect(),
            Content::Table(_) => Ok(vec![self.table()?]),
            _ => Err(self.mismatch("a table, or several with names")),
        }
    }

    /// The tables of an array of tables.
    pub fn tables(&self, limit: usize) -> Result<Vec<Table<'a>>, Error> {
        match self.content() {
            Content::List(list) => self.elements_within(list, limit)?.iter().map(Item::table).collect(),
            _ => Err(self.mismatch("an array of tables")),
        }
    }

    fn elements_within(&self, list: &'a [Value], limit: usize) -> Result<Vec<Item<'a>>, Error> {
        if list.len() <= limit {
            return Ok(self.elements(list));
        }
        let (path, count) = (&self.path, list.len());
        Err(self.error(format!("there are {count} of {path}, but at most {limit} are allowed")))
    }

    fn elements(&self, list: &'a [Value]) -> Vec<Item<'a>> {
        let element = |(i, value): (usize, &'a Value)| Item {
            source: self.source,
            path: format!("{}[{i}]", self.path),
            key_span: value.span.clone(),
            value,
        };
        list.iter().enumerate().map(element).collect()
    }

    /// A table, its keys still to be checked with [`Table::allow`].
    pub fn table(&self) -> Result<Table<'a>, Error> {
        let Content::Table(entries) = self.content() else { return Err(self.mismatch("a table")) };
        // A table made by dotted keys has no header.
        let span = if self.value.span.is_empty() { self.key_span.clone() } else { self.value.span.clone() };
        Ok(Table { source: self.source, entries, span, path: self.path.clone(), keys: Vec::new() })
    }
}

/// Keys by the names that they have in other programs, which no spelling leads to.
const OTHER_NAMES: &[(&str, &[&str])] = &[
    ("file", &["mesh", "path", "filename", "image", "texture", "uri"]),
    ("base_color", &["albedo", "color", "diffuse", "diffuse_color"]),
    ("base_metalness", &["metallic", "metal"]),
    ("geometry_opacity", &["alpha", "opacity"]),
    ("specular_ior", &["eta", "index", "index_of_refraction", "ior"]),
    ("specular_roughness", &["roughness"]),
    ("subsurface_color", &["scattering_color", "surface_albedo"]),
    ("subsurface_radius", &["mean_free_path", "mfp"]),
    ("subsurface_scatter_anisotropy", &["anisotropy", "g"]),
    ("translate", &["location", "position", "translation"]),
    ("samples", &["spp"]),
    ("position", &["from", "location", "origin"]),
    ("target", &["look_at", "lookat", "to"]),
];

/// The key that another program's name stands for, if it is one of these.
fn meant_by<'a>(name: &str, keys: &'a [&'static str]) -> Option<&'a &'static str> {
    keys.iter().find(|key| OTHER_NAMES.iter().any(|(ours, others)| ours == *key && others.contains(&name)))
}

/// Text as a message shows it: one line, not too long.
fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let line: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > LONGEST { format!("{line}…") } else { line }
}
