//! Buffers and the byte ranges that buffer views cut from them.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use super::document::{BufferView, Document};
use super::extensions::Members;
use super::meshopt::Compressed;
use super::notes::Notes;
use super::uri;
use crate::result::Result;

/// Extensions by which a view's bytes are compressed.
pub(super) const MESHOPT: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// Bytes that a byte of a file can stand for, on average; real ones stand for less than ten, a flat grid of squares that
/// Draco compressed for 130.
const MOST_GROWTH: usize = 256;

/// Decompressed bytes that a file may have whatever its size.
const SMALL: usize = 1 << 24;

/// A file's arrays, and what they are read from.
pub(super) struct Arrays<'a> {
    pub(super) document: &'a Document,
    pub(super) notes: &'a Notes<'a>,
    /// The bytes of every buffer.
    pub(super) contents: Vec<Cow<'a, [u8]>>,
    /// Decompressed bytes of the views that are compressed, by the view's number.
    pub(super) decoded: HashMap<usize, Vec<u8>>,
    /// Contents of the accessors that Draco compressed, by the accessor's number.
    pub(super) unpacked: HashMap<usize, Unpacked>,
    /// Bytes that may still be decompressed.
    pub(super) allowance: usize,
}

/// Contents of an accessor that come from a compressed stream.
pub(super) struct Unpacked {
    /// The elements, without gaps.
    pub(super) bytes: Vec<u8>,
    /// Number of the stream's view, and of the attribute in it; none for the triangles.
    pub(super) source: (usize, Option<u32>),
}

/// A buffer view: a range of bytes and, for vertex attributes, the distance of its elements.
pub(super) struct View<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: Option<usize>,
    /// Name in messages.
    pub(super) label: String,
}

impl<'a> Arrays<'a> {
    /// Gets the bytes of every buffer: the binary chunk, a data URI, or a file beside the glTF.
    ///
    /// # Errors
    /// A buffer is not there or shorter than it says.
    pub(super) fn load(
        document: &'a Document,
        mut binary: Option<&'a [u8]>,
        notes: &'a Notes<'a>,
    ) -> Result<Self> {
        let (decoded, unpacked) = (HashMap::new(), HashMap::new());
        let mut arrays = Self { document, notes, contents: Vec::new(), decoded, unpacked, allowance: 0 };
        let compressed = arrays.compressed_views()?;
        let views = document.views.as_slice();
        // Buffers that have no bytes of their own: their views are compressed in others
        let stood_for: HashSet<usize> = compressed.iter().map(|&(view, _)| views[view].buffer).collect();
        for (index, buffer) in document.buffers.as_slice().iter().enumerate() {
            let part = document.buffers.label(index);
            let is_fallback = MESHOPT.iter().any(|name| buffer.extensions.contains_key(*name));
            let mut bytes = match (&buffer.uri, binary.take()) {
                (_, None) if stood_for.contains(&index) && (is_fallback || buffer.uri.is_none()) => {
                    arrays.contents.push(Cow::Borrowed(&[][..]));
                    continue;
                }
                (Some(uri), _) => uri::read(uri, notes)
                    .map(|found| Cow::Owned(found.bytes))
                    .map_err(|e| notes.error(&part, e))?,
                (None, Some(bytes)) => Cow::Borrowed(bytes),
                (None, None) => {
                    return Err(notes.error(&part, "it has neither a URI nor a GLB binary chunk"));
                }
            };
            if bytes.len() < buffer.byte_length {
                let (stated, found) = (buffer.byte_length, bytes.len());
                return Err(
                    notes.error(&part, format!("its byteLength is {stated}, but it has {found} bytes"))
                );
            }
            match &mut bytes {
                Cow::Borrowed(bytes) => *bytes = &bytes[..buffer.byte_length],
                Cow::Owned(bytes) => bytes.truncate(buffer.byte_length),
            }
            arrays.contents.push(bytes);
        }
        arrays.allowance = arrays.total().saturating_mul(MOST_GROWTH).saturating_add(SMALL);
        arrays.decode(&compressed)?;
        Ok(arrays)
    }

    fn decode(&mut self, compressed: &[(usize, Compressed)]) -> Result<()> {
        for (view, data) in compressed {
            let part = self.document.views.label(*view);
            self.allow(data.length(), &part)?;
            self.document.buffers.get(data.buffer, &part)?;
            let bytes = self.range((data.buffer, data.byte_offset, data.byte_length), &part)?;
            let decoded = data.decode(bytes).map_err(|fault| self.notes.error(&part, fault))?;
            self.decoded.insert(*view, decoded);
        }
        Ok(())
    }

    /// Takes the bytes to which a part is decompressed from the allowance.
    pub(super) fn allow(&mut self, length: usize, part: &str) -> Result<()> {
        self.allowance = self.allowance.checked_sub(length).ok_or_else(|| {
            let message = format!(
                "with it the file's compressed data has more than {MOST_GROWTH} times its size and {SMALL} bytes"
            );
            self.notes.error(part, message)
        })?;
        Ok(())
    }

    /// Bytes of a buffer from an offset on, of a length.
    fn range(&self, (buffer, offset, length): (usize, usize, usize), part: &str) -> Result<&[u8]> {
        let bytes = &self.contents[buffer];
        bytes.get(offset..offset.saturating_add(length)).ok_or_else(|| {
            let message = format!(
                "it has byteOffset {offset} and byteLength {length}, but {} has {} bytes",
                self.document.buffers.label(buffer),
                bytes.len()
            );
            self.notes.error(part, message)
        })
    }

    /// The bytes of a buffer view.
    ///
    /// # Errors
    /// It or its buffer does not exist, or it reaches beyond the buffer.
    pub(super) fn view(&self, index: usize, user: &str) -> Result<View<'_>> {
        let view = self.document.views.get(index, user)?;
        let label = self.document.views.label(index);
        self.document.buffers.get(view.buffer, &label)?;
        let bytes = match self.decoded.get(&index) {
            Some(bytes) => bytes,
            None => self.range((view.buffer, view.byte_offset, view.byte_length), &label)?,
        };
        Ok(View { bytes, stride: view.byte_stride, label })
    }

    /// Bytes of all buffers together, a bound for what a sound file can describe.
    pub(super) fn total(&self) -> usize {
        let decoded: usize = self.decoded.values().map(Vec::len).sum();
        let unpacked: usize = self.unpacked.values().map(|unpacked| unpacked.bytes.len()).sum();
        self.contents.iter().map(|bytes| bytes.len()).sum::<usize>() + decoded + unpacked
    }

    /// The views that are compressed, with their numbers.
    fn compressed_views(&self) -> Result<Vec<(usize, Compressed)>> {
        let mut found = Vec::new();
        for (index, BufferView { extensions, .. }) in self.document.views.as_slice().iter().enumerate() {
            for name in MESHOPT.into_iter().filter(|_| !extensions.is_empty()) {
                let label = self.document.views.label(index);
                let data = Members::of(extensions, name, &label, self.notes.path)?;
                let compressed = data.map(|data| Compressed::of(&data)).transpose()?;
                found.extend(compressed.map(|compressed| (index, compressed)));
            }
        }
        Ok(found)
    }
}
