//! Typed reading of a TOML document that knows where every key and value stands.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ::toml::Spanned;
use ::toml::de::{DeTable, DeValue};
use glam::{Vec2, Vec3};
use translucid_profile::nearest;
use translucid_scene::{Interval, Place, SceneError, WholeInterval};

/// The file that errors point into.
#[derive(Clone, Debug)]
pub(super) struct DocumentText {
    path: PathBuf,
    text: Arc<str>,
    /// What the text is about where it is no file's.
    part: Option<String>,
}

impl DocumentText {
    pub(super) fn new(path: &Path, text: &str) -> Self {
        Self { path: path.to_owned(), text: Arc::from(text), part: None }
    }

    /// A text that is in no file: errors name the part of the scene that it is about.
    pub(super) fn of_part(part: &str, text: &str) -> Self {
        Self { path: PathBuf::new(), text: Arc::from(text), part: Some(part.to_owned()) }
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn text(&self) -> &str {
        &self.text
    }

    pub(super) fn place(&self, span: Range<usize>) -> Place {
        match &self.part {
            Some(part) => Place::part(&self.path, part),
            None => Place::span(&self.path, &self.text, span),
        }
    }

    pub(super) fn error(&self, span: Range<usize>, message: impl Into<String>) -> SceneError {
        SceneError::at(self.place(span), message)
    }

    /// A path as the file writes it, relative to the file's folder.
    pub(super) fn resolve(&self, path: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }

    /// The parsed document.
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'_>>, SceneError> {
        DeTable::parse(&self.text).map_err(|error| {
            let end = self.text.len();
            let span = error.span().unwrap_or(end..end);
            self.error(span, format!("this is not valid TOML: {}", error.message()))
        })
    }
}

/// A key of a table of settings, how its value gets there, and as what it is written.
pub(super) struct Setting<T> {
    pub(super) key: &'static str,
    pub(super) read: fn(&Item<'_>, &mut T) -> Result<(), SceneError>,
    pub(super) write: fn(&T) -> String,
}

/// A table of the document: entries by key, each read with its place.
pub(super) struct Table<'a> {
    source: &'a DocumentText,
    entries: &'a DeTable<'a>,
    /// Where a missing key is reported: the table's header.
    span: Range<usize>,
    /// Dotted path of the table, empty for the whole file.
    path: String,
    /// Keys that the table may have.
    keys: Vec<&'static str>,
}

impl<'a> Table<'a> {
    /// The whole document.
    pub(super) fn root(source: &'a DocumentText, entries: &'a DeTable<'a>) -> Self {
        Self { source, entries, span: 0..0, path: String::new(), keys: Vec::new() }
    }

    /// Refuses keys that are not in the list.
    ///
    /// This comes before anything is read: a misspelt key is a better message than the missing one.
    pub(super) fn allow(mut self, keys: &[&'static str]) -> Result<Self, SceneError> {
        self.keys = keys.to_vec();
        let unknown = self.entries.iter().filter(|(key, _)| !self.keys.contains(&key.get_ref().as_ref()));
        match unknown.min_by_key(|(key, _)| key.span().start) {
            Some((key, _)) => Err(self.unknown(key.get_ref(), key.span())),
            None => Ok(self),
        }
    }

    fn unknown(&self, key: &str, span: Range<usize>) -> SceneError {
        let message = format!("{} has no key {}", self.title(), shown(key));
        let all = format!("the keys are {}", self.keys.join(", "));
        let help = match nearest(key, self.keys.iter().copied()) {
            Some(near) => format!("did you mean {near}? {all}"),
            None => all,
        };
        self.source.error(span, message).with_help(help)
    }

    fn title(&self) -> &str {
        // An error of a part has the part before it
        let whole = if self.source.part.is_some() { "it" } else { "a scene" };
        if self.path.is_empty() { whole } else { &self.path }
    }

    /// The value of a key.
    pub(super) fn get(&self, key: &'static str) -> Option<Item<'a>> {
        debug_assert!(self.keys.is_empty() || self.keys.contains(&key), "{key} is read but not allowed");
        let (key_read, value) = self.entries.get_key_value(key)?;
        let path = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        Some(Item { source: self.source, path, key_span: key_read.span(), value })
    }

    /// The value of a key that must be there.
    pub(super) fn require(&self, key: &'static str) -> Result<Item<'a>, SceneError> {
        self.get(key).ok_or_else(|| self.error(format!("{} needs the key {key}", self.title())))
    }

    /// The value of a key read by `read`, or the default.
    pub(super) fn read<T>(
        &self,
        key: &'static str,
        default: T,
        read: impl FnOnce(&Item<'a>) -> Result<T, SceneError>,
    ) -> Result<T, SceneError> {
        self.get(key).map_or(Ok(default), |item| read(&item))
    }

    /// Replaces a value by that of a key, if it is there.
    pub(super) fn update<T>(
        &self,
        key: &'static str,
        value: &mut T,
        read: impl FnOnce(&Item<'a>) -> Result<T, SceneError>,
    ) -> Result<(), SceneError> {
        self.get(key).map_or(Ok(()), |item| read(&item).map(|read| *value = read))
    }

    /// Settings with the changes of a key's table, if it is there.
    pub(super) fn settings<T>(&self, key: &'static str, to: T, keys: &[Setting<T>]) -> Result<T, SceneError> {
        match self.get(key) {
            Some(item) => item.table()?.changed(to, keys),
            None => Ok(to),
        }
    }

    /// Settings with the changes of this table.
    pub(super) fn changed<T>(self, mut settings: T, keys: &[Setting<T>]) -> Result<T, SceneError> {
        let names: Vec<_> = keys.iter().map(|setting| setting.key).collect();
        let table = self.allow(&names)?;
        for Setting { key, read, .. } in keys {
            table.get(key).map_or(Ok(()), |item| read(&item, &mut settings))?;
        }
        Ok(settings)
    }

    /// The tables of an array of tables, none if the key is not there.
    pub(super) fn tables(&self, key: &'static str, limit: usize) -> Result<Vec<Table<'a>>, SceneError> {
        let Some(item) = self.get(key) else { return Ok(Vec::new()) };
        let DeValue::Array(array) = item.value.get_ref() else {
            return Err(item.mismatch(&format!("an array of tables, each with the header [[{key}]]")));
        };
        if array.len() > limit {
            return Err(
                item.error(format!("there are {} of {key}, but at most {limit} are allowed", array.len()))
            );
        }
        item.elements(array).iter().map(Item::table).collect()
    }

    pub(super) fn error(&self, message: impl Into<String>) -> SceneError {
        self.source.error(self.span.clone(), message)
    }

    /// Dotted path of the table.
    pub(super) fn path(&self) -> &str {
        self.title()
    }
}

/// A value of the document with the path that leads to it.
pub(super) struct Item<'a> {
    source: &'a DocumentText,
    path: String,
    key_span: Range<usize>,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Item<'a> {
    /// Dotted path of the key.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    pub(super) fn value(&self) -> &'a DeValue<'a> {
        self.value.get_ref()
    }

    pub(super) fn place(&self) -> Place {
        self.source.place(self.value.span())
    }

    pub(super) fn error(&self, message: impl Into<String>) -> SceneError {
        self.source.error(self.value.span(), message)
    }

    /// "KEY is VALUE, but must be …", pointing at the value.
    pub(super) fn refuse(&self, must_be: &str) -> SceneError {
        let found = self.source.text().get(self.value.span()).unwrap_or_default();
        self.error(format!("{} is {}, but must be {must_be}", self.path, shown(found)))
    }

    /// "KEY is a string, but must be …", pointing at the value.
    pub(super) fn mismatch(&self, must_be: &str) -> SceneError {
        let found = match self.value() {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "a truth value",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "an array",
            DeValue::Table(_) => "a table",
        };
        self.error(format!("{} is {found}, but must be {must_be}", self.path))
    }

    pub(super) fn boolean(&self) -> Result<bool, SceneError> {
        self.value().as_bool().ok_or_else(|| self.mismatch("true or false"))
    }

    pub(super) fn string(&self) -> Result<&'a str, SceneError> {
        self.value().as_str().ok_or_else(|| self.mismatch("a string"))
    }

    /// A string of at least one character.
    pub(super) fn name(&self) -> Result<String, SceneError> {
        match self.string()? {
            "" => Err(self.refuse("a name that is not empty")),
            name => Ok(name.to_owned()),
        }
    }

    /// Whether it is the word that takes away what the base of an extending file has.
    pub(super) fn is_none(&self) -> bool {
        self.value().as_str() == Some("none")
    }

    /// A path relative to the scene file.
    pub(super) fn file(&self) -> Result<PathBuf, SceneError> {
        match self.value().as_str() {
            None => Err(self.mismatch("the path of a file")),
            Some("") => Err(self.refuse("the path of a file")),
            Some(path) if path.contains('\0') => Err(self.refuse("the path of a file")),
            Some(path) => Ok(self.source.resolve(path)),
        }
    }

    /// One of a list of words.
    pub(super) fn word<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, SceneError> {
        let names = || words.iter().map(|&(name, _)| name);
        let list = names().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        let must_be = format!("one of {list}");
        let word = self.value().as_str().ok_or_else(|| self.mismatch(&must_be))?;
        words.iter().find(|&&(name, _)| name == word).map(|&(_, meaning)| meaning).ok_or_else(|| {
            let error = self.refuse(&must_be);
            match nearest(word, names()) {
                Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
                None => error,
            }
        })
    }

    /// A whole number.
    pub(super) fn integer(&self, range: WholeInterval) -> Result<u64, SceneError> {
        let must_be = range.to_string();
        match self.value() {
            DeValue::Integer(integer) => {
                let parsed = u64::from_str_radix(integer.as_str(), integer.radix()).ok();
                parsed.filter(|&n| range.contains(n)).ok_or_else(|| self.refuse(&must_be))
            }
            DeValue::Float(_) => Err(self.refuse(&must_be)),
            _ => Err(self.mismatch(&must_be)),
        }
    }

    /// A whole number of 32 bits.
    pub(super) fn count(&self, range: WholeInterval) -> Result<u32, SceneError> {
        self.integer(range).map(|n| n as u32)
    }

    /// A number in double precision.
    pub(super) fn double(&self, range: Interval) -> Result<f64, SceneError> {
        let parsed = match self.value() {
            // Through u128: exact for every integer that a double can hold, of either sign.
            DeValue::Integer(integer) => {
                i128::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64)
            }
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => return Err(self.mismatch(&format!("a number in {range}"))),
        };
        parsed.filter(|&x| range.contains(x)).ok_or_else(|| self.refuse(&format!("in {range}")))
    }

    /// A number whose single precision is in the range.
    pub(super) fn number(&self, range: Interval) -> Result<f32, SceneError> {
        let rounded = self.double(range)? as f32;
        // Rounding may reach an open end: 1e-60 becomes 0.
        if range.contains_single(rounded) {
            Ok(rounded)
        } else {
            Err(self.refuse(&format!("in {range} in single precision")))
        }
    }

    /// `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, range: Interval) -> Result<[f32; N], SceneError> {
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(self.array::<N>("numbers")?) {
            *number = item.number(range)?;
        }
        Ok(numbers)
    }

    /// Two numbers.
    pub(super) fn vec2(&self, range: Interval) -> Result<Vec2, SceneError> {
        self.numbers(range).map(Vec2::from_array)
    }

    /// Three numbers.
    pub(super) fn vec3(&self, range: Interval) -> Result<Vec3, SceneError> {
        self.numbers(range).map(Vec3::from_array)
    }

    /// An array of exactly `N` values; `what` names them in the message.
    pub(super) fn array<const N: usize>(&self, what: &str) -> Result<Vec<Item<'a>>, SceneError> {
        let must_be = format!("an array of {N} {what}");
        match self.value() {
            DeValue::Array(array) if array.len() == N => Ok(self.elements(array)),
            DeValue::Array(array) => {
                let message = format!("{} has {} values, but must be {must_be}", self.path, array.len());
                Err(self.error(message))
            }
            _ => Err(self.mismatch(&must_be)),
        }
    }

    /// A table, or those of an array of one or more.
    pub(super) fn one_or_more_tables(&self, limit: usize) -> Result<Vec<Table<'a>>, SceneError> {
        match self.value() {
            DeValue::Array(array) if array.is_empty() => Err(self.refuse("one table or more")),
            DeValue::Array(array) if array.len() > limit => {
                let (path, count) = (&self.path, array.len());
                Err(self.error(format!("there are {count} of {path}, but at most {limit} are allowed")))
            }
            DeValue::Array(array) => self.elements(array).iter().map(Item::table).collect(),
            DeValue::Table(_) => Ok(vec![self.table()?]),
            _ => Err(self.mismatch("a table, or several with names")),
        }
    }

    fn elements(&self, array: &'a [Spanned<DeValue<'a>>]) -> Vec<Item<'a>> {
        let element = |(i, value): (usize, &'a Spanned<DeValue<'a>>)| Item {
            source: self.source,
            path: format!("{}[{i}]", self.path),
            key_span: value.span(),
            value,
        };
        array.iter().enumerate().map(element).collect()
    }

    /// A table, its keys still to be checked with [`Table::allow`].
    pub(super) fn table(&self) -> Result<Table<'a>, SceneError> {
        let DeValue::Table(entries) = self.value() else { return Err(self.mismatch("a table")) };
        // A table made by dotted keys has no header.
        let span = if self.value.span().is_empty() { self.key_span.clone() } else { self.value.span() };
        Ok(Table { source: self.source, entries, span, path: self.path.clone(), keys: Vec::new() })
    }
}

/// Text of a file as a message shows it: one line, not too long.
fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let line: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > LONGEST { format!("{line}…") } else { line }
}
