//! NumPy's array format, as far as tables need it.
//!
//! R. Kern 2007, *A Simple File Format for NumPy Arrays* (NEP 1), version 1.0: eight bytes of magic and version,
//! the header's length in two, a Python dictionary in ASCII, then the elements in C order.
//!
//! ```text
//! \x93NUMPY \x01\x00 HEADER_LENGTH {'descr': '<u8', 'fortran_order': False, 'shape': (2, 3), }      \n DATA
//! ```

use std::io::{self, Read, Write};

const MAGIC: [u8; 8] = *b"\x93NUMPY\x01\x00";
/// Bytes before the dictionary.
const PREFIX: usize = 10;
/// Longest dictionary that is read: one of four dimensions takes 118 bytes.
const LONGEST: usize = 1024;

/// Header of an array file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Type of the elements, `<u8` or `<f8` or `|S` with a length.
    pub(crate) descr: String,
    /// Length in each dimension; none for a single number.
    pub(crate) shape: Vec<u64>,
}

impl Header {
    /// Number of elements, or nothing where it does not fit.
    pub(crate) fn elements(&self) -> Option<u64> {
        self.shape.iter().try_fold(1u64, |product, &n| product.checked_mul(n))
    }

    /// Reads a header, up to the first byte of the data.
    ///
    /// # Errors
    /// The file cannot be read, or what was found is not such a header.
    pub(crate) fn read(input: &mut impl Read) -> Result<Self, String> {
        let mut prefix = [0; PREFIX];
        input.read_exact(&mut prefix).map_err(|error| format!("cannot be read: {error}"))?;
        if prefix[..MAGIC.len()] != MAGIC {
            return Err("is not an array of version 1.0 of NumPy's format".to_owned());
        }
        let length = usize::from(u16::from_le_bytes([prefix[8], prefix[9]]));
        if length > LONGEST {
            return Err(format!("has a header of {length} bytes, but at most {LONGEST} are allowed"));
        }
        let mut text = vec![0; length];
        input.read_exact(&mut text).map_err(|error| format!("cannot be read: {error}"))?;
        let text = String::from_utf8(text).map_err(|_| "has a header that is not text".to_owned())?;
        let (descr, shape) = Parser(&text)
            .dictionary()
            .ok_or_else(|| format!("has the header {:?}, which is not understood", text.trim_end()))?;
        Ok(Self { descr, shape })
    }
}

/// Writes a header; the data has to follow.
pub(crate) fn write_header(out: &mut impl Write, descr: &str, shape: &[usize]) -> io::Result<()> {
    // A tuple of one has a comma
    let comma = if shape.len() == 1 { "," } else { "" };
    let shape: Vec<_> = shape.iter().map(usize::to_string).collect();
    let shape = shape.join(", ") + comma;
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}");
    // Spaces put the data on a multiple of 64 bytes, with the newline at the header's end
    let length = (PREFIX + text.len() + 1).next_multiple_of(64) - PREFIX;
    text.extend(std::iter::repeat_n(' ', length - 1 - text.len()));
    text.push('\n');
    let length = u16::try_from(length).map_err(|_| io::Error::other("an array with too many dimensions"))?;
    out.write_all(&MAGIC)?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(text.as_bytes())
}

/// The rest of a header's text.
struct Parser<'a>(&'a str);

impl<'a> Parser<'a> {
    /// Type and shape, from `{'descr': '…', 'fortran_order': False, 'shape': (…)}`, the keys in any order.
    fn dictionary(mut self) -> Option<(String, Vec<u64>)> {
        let (mut descr, mut order, mut shape) = (None, None, None);
        self.token("{")?;
        while self.token("}").is_none() {
            let key = self.string()?;
            self.token(":")?;
            let new = match key {
                "descr" => descr.replace(self.string()?.to_owned()).is_none(),
                "fortran_order" => order.replace(self.token("False")?).is_none(),
                "shape" => shape.replace(self.tuple()?).is_none(),
                _ => false,
            };
            if !new {
                return None;
            }
            if self.token(",").is_none() {
                self.token("}")?;
                break;
            }
        }
        order?;
        self.0.trim_ascii().is_empty().then_some((descr?, shape?))
    }

    /// Takes a piece of text, after spaces.
    fn token(&mut self, token: &str) -> Option<()> {
        self.0 = self.0.trim_ascii_start().strip_prefix(token)?;
        Some(())
    }

    fn string(&mut self) -> Option<&'a str> {
        self.token("'")?;
        let (string, rest) = self.0.split_once('\'')?;
        self.0 = rest;
        Some(string)
    }

    fn tuple(&mut self) -> Option<Vec<u64>> {
        let mut numbers = Vec::new();
        self.token("(")?;
        while self.token(")").is_none() {
            self.0 = self.0.trim_ascii_start();
            let end = self.0.find(|c: char| !c.is_ascii_digit())?;
            numbers.push(self.0[..end].parse().ok()?);
            self.0 = &self.0[end..];
            if self.token(",").is_none() {
                self.token(")")?;
                break;
            }
        }
        Some(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_text(text: &str) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes
    }

    #[test]
    fn header_comes_back() {
        let shapes: [&[usize]; 5] = [&[], &[0], &[7], &[2, 3], &[2, 30_000, 720, 4096]];
        for shape in shapes {
            for descr in ["<u8", "<f8", "|S17"] {
                let mut bytes = Vec::new();
                write_header(&mut bytes, descr, shape).unwrap();
                assert_eq!((bytes.len() % 64, bytes.last()), (0, Some(&b'\n')));
                let (mut rest, shape) = (&bytes[..], shape.iter().map(|&n| n as u64).collect());
                assert_eq!(Header::read(&mut rest).unwrap(), Header { descr: descr.to_owned(), shape });
                assert!(rest.is_empty());
            }
        }
    }

    /// As NumPy 2 writes an array of shape (2, 3).
    #[test]
    fn header_is_that_of_numpy() {
        let mut bytes = Vec::new();
        write_header(&mut bytes, "<f8", &[2, 3]).unwrap();
        let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
        let expected = with_text(&format!("{text:117}\n"));
        assert_eq!(bytes, expected);
    }

    #[test]
    fn header_may_be_written_otherwise() {
        for text in [
            "{'descr': '<u8', 'fortran_order': False, 'shape': (4,)}",
            "  { 'shape':( 4 , ),'fortran_order' :False, 'descr':'<u8' , } \n",
            "{'descr': '<u8', 'fortran_order': False, 'shape': (4)}",
        ] {
            let header = Header::read(&mut &with_text(text)[..]).unwrap();
            assert_eq!(header, Header { descr: "<u8".to_owned(), shape: vec![4] });
        }
    }

    #[test]
    fn header_that_is_none_is_refused() {
        for text in [
            "",
            "{}",
            "{'descr': '<u8', 'shape': (4,)}",
            "{'descr': '<u8', 'fortran_order': True, 'shape': (4,)}",
            "{'descr': '<u8', 'fortran_order': False, 'shape': (4,), 'more': 1}",
            "{'descr': '<u8', 'descr': '<u8', 'fortran_order': False, 'shape': (4,)}",
            "{'descr': '<u8', 'fortran_order': False, 'shape': (-4,)}",
            "{'descr': '<u8', 'fortran_order': False, 'shape': (99999999999999999999,)}",
            "{'descr': '<u8', 'fortran_order': False, 'shape': (4,)} x",
            "{'descr': '<u8', 'fortran_order': False, 'shape': (4",
            "{'descr': '<u8', 'fortran_order': False, 'shape': (,)}",
            "{'descr: <u8, 'fortran_order': False, 'shape': (4,)}",
        ] {
            assert!(Header::read(&mut &with_text(text)[..]).is_err(), "{text}");
        }
        assert!(Header::read(&mut &b"\x93NUMPY\x02\x00\x01\x00\x00\x00{"[..]).is_err());
        let long = with_text(&" ".repeat(LONGEST + 1));
        assert!(Header::read(&mut &long[..]).unwrap_err().contains("at most 1024"));
        let mut whole = Vec::new();
        write_header(&mut whole, "<u8", &[4]).unwrap();
        for length in 0..whole.len() {
            assert!(Header::read(&mut &whole[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn elements_do_not_overflow() {
        let header = |shape: &[u64]| Header { descr: String::new(), shape: shape.to_vec() };
        assert_eq!(header(&[]).elements(), Some(1));
        assert_eq!(header(&[3, 0, 5]).elements(), Some(0));
        assert_eq!(header(&[1 << 32, 1 << 32]).elements(), None);
    }
}
