//! The header of a PLY file.

use std::collections::HashSet;
use std::path::Path;

use translucid_scene::{Place, SceneError};

use crate::number::NumberType;
use crate::result::Result;

/// How the values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a name.
fn number_type(word: &str) -> Result<NumberType, String> {
    Ok(match word {
        "char" | "int8" => NumberType::I8,
        "uchar" | "uint8" => NumberType::U8,
        "short" | "int16" => NumberType::I16,
        "ushort" | "uint16" => NumberType::U16,
        "int" | "int32" => NumberType::I32,
        "uint" | "uint32" => NumberType::U32,
        "float" | "float32" => NumberType::F32,
        "double" | "float64" => NumberType::F64,
        _ => return Err(format!("unknown type \"{word}\"")),
    })
}

/// One value, or a count and that many values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(NumberType),
    List { count: NumberType, item: NumberType },
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A table: `count` rows of the same properties.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Least number of bytes that a row takes.
    fn least_size(&self, format: Format) -> usize {
        let size = |property: &Property| match (format, property.kind) {
            (Format::Ascii, _) => 2, // A digit and a space or line end.
            (_, Kind::Scalar(scalar) | Kind::List { count: scalar, .. }) => scalar.size(),
        };
        self.properties.iter().map(size).sum()
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    names: HashSet<String>,
    /// The first picture that a comment names, as MeshLab writes it.
    pub(super) picture: Option<String>,
    /// Where the data begins [bytes].
    pub(super) length: usize,
    /// Number of lines.
    pub(super) lines: usize,
}

impl Header {
    /// Parses the header and checks its counts against the number of bytes that follow.
    pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Self> {
        let mut lines = Lines { bytes, length: 0, number: 0 };
        let mut header = Self {
            format: Format::Ascii,
            elements: Vec::new(),
            names: HashSet::new(),
            picture: None,
            length: 0,
            lines: 0,
        };
        let mut format = None;
        let at = |line: usize, message: String| SceneError::at(Place::line(path, line), message);
        if lines.next().is_none_or(|line| line.trim() != "ply") {
            return Err(at(1, String::from("is not a PLY file: the first line must be \"ply\"")));
        }
        loop {
            let line = lines.next();
            let line =
                line.ok_or_else(|| at(lines.number + 1, String::from("the header has no \"end_header\"")))?;
            if line.trim() == "end_header" {
                break;
            }
            header.read_line(&line, &mut format).map_err(|message| at(lines.number, message))?;
        }
        let absent = || at(lines.number, String::from("the header has no \"format\" line"));
        header.format = format.ok_or_else(absent)?;
        (header.length, header.lines) = (lines.length, lines.number);
        header.check_counts(bytes.len() - lines.length).map_err(|m| SceneError::at(Place::file(path), m))?;
        Ok(header)
    }

    fn read_line(&mut self, line: &str, format: &mut Option<Format>) -> Result<(), String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["comment", "TextureFile", ..] if self.picture.is_none() => {
                self.picture = line.split_once("TextureFile").map(|(_, name)| name.trim().replace('\\', "/"));
            }
            [] | ["comment" | "obj_info", ..] => (),
            ["format", _, version] if version != "1.0" => {
                return Err(format!("PLY version {version} is not known, only 1.0 is"));
            }
            ["format", name, _] => *format = Some(parse_format(name)?),
            ["element", name, count] => {
                if !self.names.insert(name.to_owned()) {
                    return Err(format!("there are two elements \"{name}\""));
                }
                self.elements.push(parse_element(name, count)?);
            }
            ["property", ref words @ ..] => {
                let property = parse_property(words)?;
                self.elements.last_mut().ok_or("a property before any element")?.properties.push(property);
            }
            _ => return Err(format!("\"{}\" is no line of a PLY header", line.trim())),
        }
        Ok(())
    }

    /// Refuses counts that the file is too short for, before memory is asked for them.
    fn check_counts(&self, available: usize) -> Result<(), String> {
        let mut needed = 0_usize;
        for element in &self.elements {
            needed = needed.saturating_add(element.count.saturating_mul(element.least_size(self.format)));
            // The last line of an ascii file may lack its end.
            if needed > available + 1 {
                return Err(format!(
                    "the header promises {} elements \"{}\", for which the file is too short: \
                     {available} bytes of data, at least {needed} needed",
                    element.count, element.name,
                ));
            }
        }
        Ok(())
    }
}

/// Lines of text before any binary data.
struct Lines<'a> {
    bytes: &'a [u8],
    /// Bytes read so far.
    length: usize,
    /// Lines read so far.
    number: usize,
}

impl Lines<'_> {
    fn next(&mut self) -> Option<String> {
        let rest = &self.bytes[self.length..];
        let end = rest.iter().position(|&byte| byte == b'\n')?;
        self.length += end + 1;
        self.number += 1;
        // A message should not quote kilobytes of what is no header.
        Some(String::from_utf8_lossy(&rest[..end.min(200)]).into_owned())
    }
}

fn parse_format(name: &str) -> Result<Format, String> {
    match name {
        "ascii" => Ok(Format::Ascii),
        "binary_little_endian" => Ok(Format::LittleEndian),
        "binary_big_endian" => Ok(Format::BigEndian),
        _ => Err(format!(
            "unknown format \"{name}\"; allowed are ascii, binary_little_endian and binary_big_endian"
        )),
    }
}

fn parse_element(name: &str, count: &str) -> Result<Element, String> {
    let count = count.parse().map_err(|_| format!("\"{count}\" is not a number of elements"))?;
    Ok(Element { name: name.to_owned(), count, properties: Vec::new() })
}

fn parse_property(words: &[&str]) -> Result<Property, String> {
    let (kind, name) = match *words {
        ["list", count, item, name] => {
            let count = number_type(count)?;
            if matches!(count, NumberType::F32 | NumberType::F64) {
                return Err(format!("the number of items of list \"{name}\" cannot be a float"));
            }
            (Kind::List { count, item: number_type(item)? }, name)
        }
        [kind, name] => (Kind::Scalar(number_type(kind)?), name),
        _ => return Err(String::from("a property needs a type and a name")),
    };
    Ok(Property { name: name.to_owned(), kind })
}
