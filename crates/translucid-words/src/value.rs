//! A value as somebody gave it, whatever he wrote it in.

use std::any::Any;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::interval::Written;

/// A value of a key, from a file, a command line, a page or Python.
///
/// It is displayed as a file has it, so that every number reads back to the same bits; `{:#}` as messages have it, where
/// 1 may be whole or not.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// The value itself.
    pub content: Content,
    /// Its bytes in the text of its [`Provenance`](super::Provenance); empty where that has none.
    pub span: Range<usize>,
}

/// The kinds of values.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// True or false.
    Flag(bool),
    /// A whole number.
    Integer(i128),
    /// Any other number, or a whole one that is too large.
    Float(f64),
    /// A text.
    Text(String),
    /// Several values in a row.
    List(Vec<Value>),
    /// Values by their keys.
    Table(Vec<Entry>),
    /// A number for each of several channels or elements.
    Numbers(Arc<[f64]>),
    /// A thing at hand, where the path of a file could stand.
    Object(Object),
    /// Something that no key takes, by what it is: "a date".
    Other(&'static str),
}

/// A thing at hand: an image, for example.
#[derive(Clone)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// The thing.
    pub data: Arc<dyn Any + Send + Sync>,
}

impl PartialEq for Object {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.data, &other.data)
    }
}

impl fmt::Debug for Object {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Object({:?})", self.name)
    }
}

/// A key of a table with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// The key's bytes in the text.
    pub span: Range<usize>,
    /// Its value.
    pub value: Value,
}

impl Entry {
    /// A key and a value that are in no text.
    pub fn new(key: &str, value: impl Into<Value>) -> Self {
        Self { key: key.to_owned(), span: 0..0, value: value.into() }
    }
}

impl From<Content> for Value {
    fn from(content: Content) -> Self {
        Self { content, span: 0..0 }
    }
}

macro_rules! values {
    ($($from:ty: |$x:ident| $content:expr;)*) => {
        $(impl From<$from> for Value {
            fn from($x: $from) -> Self {
                $content.into()
            }
        })*
    };
}

values! {
    bool: |flag| Content::Flag(flag);
    u32: |n| Content::Integer(n.into());
    u64: |n| Content::Integer(n.into());
    f32: |x| Content::Float(digits(x));
    f64: |x| Content::Float(x);
    &str: |text| Content::Text(text.to_owned());
    String: |text| Content::Text(text);
    Object: |object| Content::Object(object);
    Vec<Value>: |values| Content::List(values);
    Vec<Entry>: |entries| Content::Table(entries);
    [f32; 3]: |vector| Value::list(&vector);
}

impl Value {
    /// A list of numbers.
    pub fn list<T: Copy + Into<Self>>(numbers: &[T]) -> Self {
        numbers.iter().map(|&x| x.into()).collect::<Vec<_>>().into()
    }

    /// A color: one number where the channels are equal.
    pub fn color(color: [f32; 3]) -> Self {
        let channels = color.map(f32::to_bits);
        if channels == [channels[0]; 3] { color[0].into() } else { color.into() }
    }
}

/// The double of the fewest digits that reads back to a number in single precision.
pub fn digits(x: f32) -> f64 {
    match format!("{x:?}").parse::<f64>() {
        Ok(read) if (read as f32).to_bits() == x.to_bits() => read,
        _ => f64::from(x),
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.content {
            Content::Flag(flag) => write!(f, "{flag}"),
            Content::Integer(n) => write!(f, "{n}"),
            Content::Float(x) if x.is_nan() => f.write_str("nan"),
            Content::Float(x) if f.alternate() => write!(f, "{}", Written(*x)),
            Content::Float(x) => write!(f, "{x:?}"),
            Content::Text(text) => f.write_str(&quoted(text)),
            Content::List(values) => {
                f.write_str("[")?;
                write_list(f, values.iter())?;
                f.write_str("]")
            }
            Content::Table(entries) => {
                f.write_str("{ ")?;
                write_list(f, entries.iter())?;
                f.write_str(" }")
            }
            Content::Numbers(numbers) => {
                f.write_str("[")?;
                write_list(f, numbers.iter().map(|number| Value::from(*number)))?;
                f.write_str("]")
            }
            Content::Object(object) => write!(f, "the image {}", quoted(&object.name)),
            Content::Other(kind) => f.write_str(kind),
        }
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = ", self.key)?;
        self.value.fmt(f)
    }
}

fn write_list(f: &mut fmt::Formatter<'_>, list: impl Iterator<Item = impl fmt::Display>) -> fmt::Result {
    for (i, one) in list.enumerate() {
        f.write_str(if i == 0 { "" } else { ", " })?;
        one.fmt(f)?;
    }
    Ok(())
}

/// A text in quotes, as files have it.
pub fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04X}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_displayed_as_scene_files_have_them() {
        let table = vec![Entry::new("factor", 0.5_f32), Entry::new("on", true)];
        for (value, text) in [
            (Value::from(0.1_f32), "0.1"),
            (Value::from(f32::NAN), "nan"),
            (Value::from(1e-7_f32), "1e-7"),
            (Value::from(u64::MAX), "18446744073709551615"),
            (Value::from("a\"b\n"), "\"a\\\"b\\u000A\""),
            (Value::from([1.0, -0.0, 2.5]), "[1.0, -0.0, 2.5]"),
            (Value::color([1.0; 3]), "1.0"),
            (Value::from(table), "{ factor = 0.5, on = true }"),
        ] {
            assert_eq!(value.to_string(), text);
        }
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        // The shortest digits of the second lie between two numbers in single precision once they are a double.
        for bits in [0x3dcc_cccd, 0x7149_f2ca, 1, 0x8000_0000, 0x7f7f_ffff, 0x0080_0000] {
            let Content::Float(x) = Value::from(f32::from_bits(bits)).content else { panic!() };
            assert_eq!((x.to_string().parse::<f64>().unwrap() as f32).to_bits(), bits);
        }
    }
}
