//! The data of a PLY file, value by value.

use std::path::Path;

use translucid_scene::{Place, SceneError};

use crate::number::NumberType;

/// Why there is no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The file ends.
    End,
    /// The line ends (ascii).
    ShortLine,
    /// The line goes on (ascii).
    LongLine,
    /// A word that is no number (ascii).
    NotANumber,
    /// A list of fewer than no items.
    NegativeCount,
    /// An index that is no whole number.
    NotWhole,
}

/// A reader of values; `f64` holds each of PLY's types exactly.
pub(super) trait Values {
    /// Goes to the next row.
    fn begin_row(&mut self) -> Result<(), Fault>;

    fn value(&mut self, scalar: NumberType) -> Result<f64, Fault>;

    fn skip(&mut self, scalar: NumberType, count: usize) -> Result<(), Fault>;

    /// Checks that the row has no more values.
    fn end_row(&mut self) -> Result<(), Fault>;

    /// Error in a row of an element.
    fn error(&self, path: &Path, fault: Fault, row: &str) -> SceneError;

    /// Number of items of a list.
    fn list_length(&mut self, scalar: NumberType) -> Result<usize, Fault> {
        let count = self.value(scalar)?;
        if count >= 0.0 { Ok(count as usize) } else { Err(Fault::NegativeCount) }
    }
}

/// Values of a binary file.
pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    pub(super) bytes: &'a [u8],
    pub(super) position: usize,
}

impl<const BIG_ENDIAN: bool> Values for Binary<'_, BIG_ENDIAN> {
    fn begin_row(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    fn value(&mut self, scalar: NumberType) -> Result<f64, Fault> {
        let size = scalar.size();
        let bytes = self.bytes.get(self.position..self.position + size).ok_or(Fault::End)?;
        self.position += size;
        if !BIG_ENDIAN {
            return Ok(scalar.read(bytes));
        }
        let mut reversed = [0; 8];
        reversed.iter_mut().zip(bytes.iter().rev()).for_each(|(to, from)| *to = *from);
        Ok(scalar.read(&reversed))
    }

    fn skip(&mut self, scalar: NumberType, count: usize) -> Result<(), Fault> {
        let left = self.bytes.len() - self.position;
        let length = scalar.size().saturating_mul(count);
        if length > left {
            return Err(Fault::End);
        }
        self.position += length;
        Ok(())
    }

    fn end_row(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    fn error(&self, path: &Path, fault: Fault, row: &str) -> SceneError {
        let message = match fault {
            Fault::NegativeCount => format!("{row} has a list of negative length"),
            Fault::NotWhole => format!("{row} has an index that is no whole number"),
            _ => format!("the file ends in {row}"),
        };
        SceneError::at(Place::part(path, format!("byte {}", self.position)), message)
    }
}

/// Values of a text file: one row a line.
pub(super) struct Ascii<'a> {
    rest: &'a [u8],
    row: &'a [u8],
    word: &'a [u8],
    line: usize,
}

impl<'a> Ascii<'a> {
    /// Values of `bytes` after `line` lines.
    pub(super) fn new(bytes: &'a [u8], line: usize) -> Self {
        Self { rest: bytes, row: &[], word: &[], line }
    }

    /// Takes the next word of the row, empty at its end.
    fn next_word(&mut self) -> &'a [u8] {
        let row = self.row.trim_ascii_start();
        let end = row.iter().position(u8::is_ascii_whitespace).unwrap_or(row.len());
        (self.word, self.row) = row.split_at(end);
        self.word
    }
}

impl Values for Ascii<'_> {
    fn begin_row(&mut self) -> Result<(), Fault> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|&byte| byte == b'\n').unwrap_or(self.rest.len());
            self.row = self.rest[..end].trim_ascii();
            self.rest = &self.rest[self.rest.len().min(end + 1)..];
            self.line += 1;
            if !self.row.is_empty() {
                return Ok(());
            }
        }
        Err(Fault::End)
    }

    fn value(&mut self, _: NumberType) -> Result<f64, Fault> {
        let word = self.next_word();
        if word.is_empty() {
            return Err(Fault::ShortLine);
        }
        let number = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or(Fault::NotANumber)
    }

    fn skip(&mut self, _: NumberType, count: usize) -> Result<(), Fault> {
        for _ in 0..count {
            if self.next_word().is_empty() {
                return Err(Fault::ShortLine);
            }
        }
        Ok(())
    }

    fn end_row(&mut self) -> Result<(), Fault> {
        if self.next_word().is_empty() { Ok(()) } else { Err(Fault::LongLine) }
    }

    fn error(&self, path: &Path, fault: Fault, row: &str) -> SceneError {
        let word = String::from_utf8_lossy(&self.word[..self.word.len().min(40)]);
        let message = match fault {
            Fault::End => format!("the file ends before {row}"),
            Fault::ShortLine => format!("{row} has fewer values than its properties"),
            Fault::LongLine => format!("{row} has more values than its properties, from \"{word}\" on"),
            Fault::NotANumber => format!("\"{word}\" in {row} is not a number"),
            Fault::NegativeCount => format!("{row} has a list of length {word}"),
            Fault::NotWhole => format!("{row} has the index {word}, which is no whole number"),
        };
        SceneError::at(Place::line(path, self.line), message)
    }
}
