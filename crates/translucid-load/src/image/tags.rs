//! Tags of TIFF and of EXIF, which is a TIFF without pixels (TIFF 6.0; BigTIFF; EXIF 3.0).
//!
//! A reader of our own beside the crate `tiff`, since that opens no file whose first image it cannot decode, and messages are
//! to name what such a file is.

/// Most directories of a file that are followed.
const MOST_DIRECTORIES: usize = 4096;

/// The bytes of such a file.
#[derive(Clone, Copy)]
pub(super) struct TagFile<'a> {
    bytes: &'a [u8],
    is_big_endian: bool,
    /// Offsets have 64 bits.
    is_big: bool,
}

/// An image file directory.
#[derive(Clone)]
pub(super) struct Directory<'a> {
    file: TagFile<'a>,
    /// Tag, type, number of values, and where they stand.
    entries: Vec<(u16, u16, usize, usize)>,
    next: usize,
    start: usize,
}

impl<'a> TagFile<'a> {
    /// The file, if these bytes begin as one.
    pub(super) fn open(bytes: &'a [u8]) -> Option<Self> {
        let is_big_endian = match bytes.get(..2)? {
            b"II" => false,
            b"MM" => true,
            _ => return None,
        };
        let file = Self { bytes, is_big_endian, is_big: false };
        match file.number(2, 2)? {
            43 if file.number(4, 2)? == 8 => Some(Self { is_big: true, ..file }),
            43 => None,
            _ => Some(file),
        }
    }

    /// The directories of its pages.
    pub(super) fn pages(self) -> Vec<Directory<'a>> {
        let start = if self.is_big { self.number(8, 8) } else { self.number(4, 4) };
        self.chain(start.unwrap_or_default())
    }

    fn chain(self, start: usize) -> Vec<Directory<'a>> {
        let mut pages: Vec<Directory<'a>> = Vec::new();
        let mut seen = std::collections::HashSet::new();
        let mut start = start;
        while start != 0 && pages.len() < MOST_DIRECTORIES && seen.insert(start) {
            let Some(directory) = self.directory(start) else { break };
            start = directory.next;
            pages.push(directory);
        }
        pages
    }

    /// The directory at an offset, with as many entries as there are bytes for.
    fn directory(self, start: usize) -> Option<Directory<'a>> {
        let [count_size, entry_size, offset_size] = if self.is_big { [8, 20, 8] } else { [2, 12, 4] };
        let count = self.number(start, count_size)?;
        let first = start.checked_add(count_size)?;
        let read = |i: usize| {
            let at = first.checked_add(i.checked_mul(entry_size)?)?;
            let [tag, kind] = [self.number(at, 2)?, self.number(at + 2, 2)?];
            let number = self.number(at + 4, offset_size)?;
            let value = at + 4 + offset_size;
            let is_inside = number.checked_mul(size_of_type(kind as u16)?)? <= offset_size;
            let place = if is_inside { value } else { self.number(value, offset_size)? };
            Some((tag as u16, kind as u16, number, place))
        };
        let held = count.min(self.bytes.len() / entry_size);
        let entries = (0..held).filter_map(read).collect();
        let next = count.checked_mul(entry_size).and_then(|length| first.checked_add(length));
        let next = next.and_then(|at| self.number(at, offset_size)).unwrap_or_default();
        Some(Directory { file: self, entries, next, start })
    }

    /// A copy that begins with a directory, and whose value of two bytes at a place is another.
    pub(super) fn beginning_with(self, directory: &Directory<'_>, change: Option<(usize, u16)>) -> Vec<u8> {
        let mut bytes = self.bytes.to_vec();
        let mut put = |at: usize, number: u64, size: usize| {
            let digits = number.to_be_bytes();
            let mut digits = digits[8 - size..].to_vec();
            if !self.is_big_endian {
                digits.reverse();
            }
            if let Some(place) = bytes.get_mut(at..at + size) {
                place.copy_from_slice(&digits);
            }
        };
        let [at, size] = if self.is_big { [8, 8] } else { [4, 4] };
        put(at, directory.start as u64, size);
        if let Some((at, number)) = change {
            put(at, number.into(), 2);
        }
        bytes
    }

    fn number(self, at: usize, size: usize) -> Option<usize> {
        let bytes = self.bytes.get(at..at.checked_add(size)?)?;
        let digit = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        let number = match self.is_big_endian {
            true => bytes.iter().fold(0, digit),
            false => bytes.iter().rev().fold(0, digit),
        };
        usize::try_from(number).ok()
    }
}

impl<'a> Directory<'a> {
    pub(super) fn has(&self, tag: u16) -> bool {
        self.entries.iter().any(|entry| entry.0 == tag)
    }

    /// Where the file has a tag's values.
    pub(super) fn place(&self, tag: u16) -> Option<usize> {
        self.entries.iter().find(|entry| entry.0 == tag).map(|entry| entry.3)
    }

    /// The first of a tag's whole numbers.
    pub(super) fn number(&self, tag: u16) -> Option<usize> {
        self.numbers(tag).first().copied()
    }

    /// A tag's whole numbers; none if it has others.
    pub(super) fn numbers(&self, tag: u16) -> Vec<usize> {
        let Some(&(_, kind, count, place)) = self.entries.iter().find(|entry| entry.0 == tag) else {
            return Vec::new();
        };
        let size = match kind {
            1 | 3 | 4 | 7 | 13 | 16 | 18 => size_of_type(kind).unwrap_or(1),
            _ => return Vec::new(),
        };
        let held = count.min(self.file.bytes.len() / size);
        (0..held).map_while(|i| self.file.number(place.checked_add(i * size)?, size)).collect()
    }

    /// A tag's fractions.
    pub(super) fn fractions(&self, tag: u16) -> Vec<f64> {
        let Some(&(_, 5, count, place)) = self.entries.iter().find(|entry| entry.0 == tag) else {
            return Vec::new();
        };
        let part = |i: usize| Some(self.file.number(place.checked_add(4 * i)?, 4)? as f64);
        (0..count.min(16)).map_while(|i| Some(part(2 * i)? / part(2 * i + 1)?)).collect()
    }

    /// A tag's bytes.
    pub(super) fn bytes(&self, tag: u16) -> &'a [u8] {
        let found = self.entries.iter().find(|entry| entry.0 == tag);
        let bytes = found.and_then(|&(_, kind, count, place)| {
            let length = count.checked_mul(size_of_type(kind)?)?;
            self.file.bytes.get(place..place.checked_add(length)?)
        });
        bytes.unwrap_or_default()
    }

    /// A tag's text, up to its first zero.
    pub(super) fn text(&self, tag: u16) -> String {
        let bytes = self.bytes(tag).split(|byte| *byte == 0).next().unwrap_or_default();
        String::from_utf8_lossy(bytes).trim().to_owned()
    }

    /// The directories that a tag points to.
    pub(super) fn children(&self, tag: u16) -> Vec<Directory<'a>> {
        self.numbers(tag).into_iter().filter_map(|start| self.file.directory(start)).take(64).collect()
    }
}

/// Bytes of a value of a type.
fn size_of_type(kind: u16) -> Option<usize> {
    Some(match kind {
        1 | 2 | 6 | 7 => 1,
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16..=18 => 8,
        _ => return None,
    })
}

/// What EXIF states of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Exif {
    pub(super) orientation: u16,
    pub(super) color: Option<ExifColor>,
}

/// A color space that EXIF names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ExifColor {
    AdobeRgb,
    Uncalibrated,
}

impl Exif {
    /// Reads EXIF with or without the word that JPEG puts before it.
    pub(super) fn parse(bytes: &[u8]) -> Self {
        let bytes = bytes.strip_prefix(b"Exif\0\0").unwrap_or(bytes);
        let first = TagFile::open(bytes).and_then(|file| file.pages().into_iter().next());
        first.map(|first| Self::of(&first)).unwrap_or_default()
    }

    /// Reads the tags of a directory and of those that it names.
    pub(super) fn of(directory: &Directory<'_>) -> Self {
        let orientation = directory.number(274).and_then(|number| u16::try_from(number).ok()).unwrap_or(1);
        let exif = directory.children(0x8769).into_iter().next();
        let color = exif.and_then(|exif| {
            // R03 is the name that DCF 2.0 has for Adobe RGB; some cameras write 2 for it
            let interoperability = exif.children(0xa005).into_iter().next();
            let is_r03 = interoperability.is_some_and(|names| names.text(1) == "R03");
            match exif.number(0xa001) {
                Some(2) => Some(ExifColor::AdobeRgb),
                Some(1) => None,
                _ if is_r03 => Some(ExifColor::AdobeRgb),
                Some(0xffff) => Some(ExifColor::Uncalibrated),
                _ => None,
            }
        });
        Self { orientation, color }
    }
}
