//! Options of a call, as JavaScript gives them: checked one by one, and none left over.
//!
//! A number arrives as `#` and its digits, a text as `'` and itself, so that every number has all its bits, also those
//! that JSON does not have.

use serde_json::{Map, Value};
use translucid_profile::{Configuration, Model, ParameterError, nearest};
use translucid_words::Spelling;

/// Options that are not read yet, and the names of those that may be there.
pub(crate) struct Options {
    entries: Map<String, Value>,
    known: Vec<&'static str>,
}

impl Options {
    /// # Errors
    /// The value is no object.
    pub(crate) fn new(name: &str, value: Value) -> Result<Self, String> {
        match value {
            Value::Object(entries) => Ok(Self { entries, known: Vec::new() }),
            other => Err(wrong(name, &other, "an object")),
        }
    }

    pub(crate) fn take(&mut self, name: &'static str) -> Option<Value> {
        self.known.push(name);
        self.entries.remove(name)
    }

    pub(crate) fn number(&mut self, name: &'static str) -> Result<Option<f64>, String> {
        self.take(name).map(|value| number(name, &value)).transpose()
    }

    pub(crate) fn needed_number(&mut self, name: &'static str) -> Result<f64, String> {
        self.number(name)?.ok_or_else(|| format!("{name} is missing"))
    }

    /// A number or a list of them.
    pub(crate) fn numbers(&mut self, name: &'static str) -> Result<Option<Vec<f64>>, String> {
        self.take(name).map(|value| numbers(name, &value)).transpose()
    }

    pub(crate) fn text(&mut self, name: &'static str) -> Result<Option<String>, String> {
        self.take(name).map(|value| text(name, &value).map(str::to_owned)).transpose()
    }

    /// A text or a list of them.
    pub(crate) fn texts(&mut self, name: &'static str) -> Result<Option<Vec<String>>, String> {
        let read = |value| match value {
            Value::Array(list) => list.iter().map(|value| text(name, value).map(str::to_owned)).collect(),
            one => text(name, &one).map(|text| vec![text.to_owned()]),
        };
        self.take(name).map(read).transpose()
    }

    pub(crate) fn is_set(&mut self, name: &'static str) -> bool {
        self.take(name) == Some(Value::Bool(true))
    }

    pub(crate) fn configuration(&mut self) -> Result<Option<Configuration>, String> {
        let Some(name) = self.text("configuration")? else { return Ok(None) };
        let known = Configuration::WORDS.map(|(word, _)| word);
        Configuration::from_name(&name).map(Some).ok_or_else(|| unknown("configuration", &name, &known))
    }

    /// Refuses options that nobody has read.
    ///
    /// # Errors
    /// There is one; the message suggests the nearest name.
    pub(crate) fn finish(self) -> Result<(), String> {
        let Some(name) = self.entries.keys().next() else { return Ok(()) };
        let all = format!("the options are {}", self.known.join(", "));
        let help =
            nearest(name, self.known).map_or(all.clone(), |near| format!("did you mean \"{near}\"? {all}"));
        Err(format!("there is no option {name:?} ({help})"))
    }
}

pub(crate) fn number(name: &str, value: &Value) -> Result<f64, String> {
    let digits = value.as_str().and_then(|text| text.strip_prefix('#'));
    digits.and_then(|digits| digits.parse().ok()).ok_or_else(|| wrong(name, value, "a number"))
}

pub(crate) fn numbers(name: &str, value: &Value) -> Result<Vec<f64>, String> {
    match value {
        Value::Array(list) => list.iter().map(|value| number(name, value)).collect(),
        one => number(name, one).map(|one| vec![one]),
    }
}

fn text<'a>(name: &str, value: &'a Value) -> Result<&'a str, String> {
    let text = value.as_str().and_then(|text| text.strip_prefix('\''));
    text.ok_or_else(|| wrong(name, value, "a text"))
}

fn wrong(name: &str, value: &Value, wanted: &str) -> String {
    let found = match value {
        Value::Array(_) => String::from("a list"),
        Value::Object(_) => String::from("an object"),
        Value::String(text) if text.starts_with('#') => text[1..].to_owned(),
        Value::String(text) => format!("{:?}", text.strip_prefix('\'').unwrap_or(text)),
        other => other.to_string(),
    };
    format!("{name} is {found}, but must be {wanted}")
}

/// The message of a name that is none of those there are.
pub(crate) fn unknown(parameter: &str, name: &str, known: &[&str]) -> String {
    format!("{parameter} is {name:?}, but must be one of {}", known.join(", "))
}

pub(crate) fn model(name: &str) -> Result<Model, String> {
    Model::from_name(name).ok_or_else(|| unknown("model", name, &Model::ALL.map(Model::name)))
}

/// The message of an error, with its parameter's name in the spelling of JavaScript.
pub(crate) fn message(error: &ParameterError) -> String {
    error.to_string().replacen(error.parameter, &Spelling::Camel.of(error.parameter), 1)
}

/// Refuses numbers outside a range.
///
/// # Errors
/// One of them is; where they are several, the message has its index.
pub(crate) fn require(
    name: &str,
    numbers: &[f64],
    is_one: bool,
    is_good: impl Fn(f64) -> bool,
    allowed: &str,
) -> Result<(), String> {
    match numbers.iter().position(|&x| !is_good(x)) {
        None => Ok(()),
        Some(i) => {
            let index = if is_one { String::new() } else { format!("[{i}]") };
            Err(format!("{name}{index} is {}, but must be {allowed}", numbers[i]))
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn options(value: Value) -> Options {
        Options::new("options", value).unwrap()
    }

    #[test]
    fn numbers_keep_all_their_bits() {
        for x in [0.1, 0.30000000000000004, 5e-324, f64::MAX, -0.0, f64::INFINITY] {
            let mut given = options(json!({ "x": format!("#{x}") }));
            assert_eq!(given.number("x").unwrap().unwrap().to_bits(), x.to_bits());
        }
        assert!(number("x", &json!("#NaN")).unwrap().is_nan());
    }

    #[test]
    fn what_is_of_another_kind_is_named() {
        for (value, expected) in [
            (json!("'a"), "x is \"a\", but must be a number"),
            (json!(["#1"]), "x is a list, but must be a number"),
            (json!(null), "x is null, but must be a number"),
            (json!({}), "x is an object, but must be a number"),
            (json!(true), "x is true, but must be a number"),
        ] {
            assert_eq!(number("x", &value).unwrap_err(), expected);
        }
        assert_eq!(text("x", &json!("#1")).unwrap_err(), "x is 1, but must be a text");
        assert_eq!(Options::new("x", json!("#1")).err().unwrap(), "x is 1, but must be an object");
    }

    #[test]
    fn options_that_nobody_reads_are_refused() {
        let mut given = options(json!({ "surfacealbedo": "#0.5" }));
        assert_eq!(given.needed_number("surfaceAlbedo").unwrap_err(), "surfaceAlbedo is missing");
        assert_eq!(
            given.finish().unwrap_err(),
            "there is no option \"surfacealbedo\" (did you mean \"surfaceAlbedo\"? the options are surfaceAlbedo)"
        );
    }

    #[test]
    fn names_are_spelled_as_in_javascript() {
        let error = ParameterError::new("sigma_a", -1.0, "at least 0");
        assert_eq!(message(&error), "sigmaA is -1, but must be at least 0");
    }
}
