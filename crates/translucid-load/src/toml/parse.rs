//! The door for scene files: TOML to values that know where they stand.

use ::toml::Spanned;
use ::toml::de::{DeArray, DeTable, DeValue};
use translucid_scene::description::{Content, Entry, Provenance, Value};

use crate::result::Result;

/// The entries of a document.
///
/// # Errors
/// The text is not TOML.
pub(super) fn parse(source: &Provenance) -> Result<Vec<Entry>> {
    let table = DeTable::parse(source.text()).map_err(|error| {
        let end = source.text().len();
        let span = error.span().unwrap_or(end..end);
        source.error(span, format!("this is not valid TOML: {}", error.message()))
    })?;
    Ok(entries(table.into_inner()))
}

fn entries(table: DeTable<'_>) -> Vec<Entry> {
    let entry = |(key, value): (Spanned<_>, _)| {
        let span = key.span();
        Entry { key: String::from(key.into_inner()), span, value: self::value(value) }
    };
    table.into_iter().map(entry).collect()
}

fn list(array: DeArray<'_>) -> Vec<Value> {
    array.into_iter().map(value).collect()
}

fn value(value: Spanned<DeValue<'_>>) -> Value {
    let span = value.span();
    let content = match value.into_inner() {
        DeValue::Boolean(flag) => Content::Flag(flag),
        // Beyond 128 bits no range goes
        DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix())
            .map_or(Content::Float(f64::INFINITY), Content::Integer),
        DeValue::Float(float) => Content::Float(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::String(text) => Content::Text(text.into_owned()),
        DeValue::Array(array) => Content::List(list(array)),
        DeValue::Table(table) => Content::Table(entries(table)),
        DeValue::Datetime(_) => Content::Other("a date"),
    };
    Value { content, span }
}
