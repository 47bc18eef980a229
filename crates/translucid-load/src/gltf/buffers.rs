//! Buffers and the byte ranges that buffer views cut from them.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use translucid_scene::SceneError;

use super::document::{self, BufferView, Document};
use super::meshopt::{Compressed, MOST_GROWTH};
use super::notes::Notes;
use super::uri;

/// Extensions by which a view's bytes are compressed.
pub(super) const MESHOPT: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// The bytes of every buffer.
pub(super) struct Buffers<'a> {
    contents: Vec<Cow<'a, [u8]>>,
    /// Decompressed bytes of the views that are compressed, by the view's number.
    decoded: HashMap<usize, Vec<u8>>,
}

/// A buffer view: a range of bytes and, for vertex attributes, the distance of its elements.
pub(super) struct View<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: Option<usize>,
    /// Name in messages.
    pub(super) label: String,
}

impl<'a> Buffers<'a> {
    /// Gets the bytes of every buffer: the binary chunk, a data URI, or a file beside the glTF.
    ///
    /// # Errors
    /// A buffer is not there or shorter than it says.
    pub(super) fn load(
        document: &Document,
        mut binary: Option<&'a [u8]>,
        notes: &Notes<'_>,
    ) -> Result<Self, SceneError> {
        let compressed = compressed_views(document, notes)?;
        let views = document.views.as_slice();
        // Buffers that have no bytes of their own: their views are compressed in others
        let stood_for: HashSet<usize> = compressed.iter().map(|&(view, _)| views[view].buffer).collect();
        let mut contents = Vec::new();
        for (index, buffer) in document.buffers.as_slice().iter().enumerate() {
            let part = document.buffers.label(index);
            let is_fallback = MESHOPT.iter().any(|name| buffer.extensions.contains_key(*name));
            let mut bytes = match (&buffer.uri, binary.take()) {
                (_, None) if stood_for.contains(&index) && (is_fallback || buffer.uri.is_none()) => {
                    contents.push(Cow::Borrowed(&[][..]));
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
            contents.push(bytes);
        }
        let mut buffers = Self { contents, decoded: HashMap::new() };
        buffers.decode(&compressed, document, notes)?;
        Ok(buffers)
    }

    fn decode(
        &mut self,
        compressed: &[(usize, Compressed)],
        document: &Document,
        notes: &Notes<'_>,
    ) -> Result<(), SceneError> {
        let most = self.total().saturating_mul(MOST_GROWTH).saturating_add(1 << 20);
        let mut length = 0_usize;
        for (view, data) in compressed {
            let part = document.views.label(*view);
            length = length.saturating_add(data.length());
            if length > most {
                let message = format!(
                    "with it the file's compressed data has more than {most} bytes, {MOST_GROWTH} times its size"
                );
                return Err(notes.error(&part, message));
            }
            document.buffers.get(data.buffer, &part, notes.path)?;
            let bytes =
                self.range((data.buffer, data.byte_offset, data.byte_length), &part, document, notes)?;
            let decoded = data.decode(bytes).map_err(|fault| notes.error(&part, fault))?;
            self.decoded.insert(*view, decoded);
        }
        Ok(())
    }

    /// Bytes of a buffer from an offset on, of a length.
    fn range(
        &self,
        (buffer, offset, length): (usize, usize, usize),
        part: &str,
        document: &Document,
        notes: &Notes<'_>,
    ) -> Result<&[u8], SceneError> {
        let bytes = &self.contents[buffer];
        bytes.get(offset..offset.saturating_add(length)).ok_or_else(|| {
            let message = format!(
                "it has byteOffset {offset} and byteLength {length}, but {} has {} bytes",
                document.buffers.label(buffer),
                bytes.len()
            );
            notes.error(part, message)
        })
    }

    /// The bytes of a buffer view.
    ///
    /// # Errors
    /// It or its buffer does not exist, or it reaches beyond the buffer.
    pub(super) fn view<'b>(
        &'b self,
        index: usize,
        document: &Document,
        user: &str,
        notes: &Notes<'_>,
    ) -> Result<View<'b>, SceneError> {
        let view = document.views.get(index, user, notes.path)?;
        let label = document.views.label(index);
        document.buffers.get(view.buffer, &label, notes.path)?;
        let bytes = match self.decoded.get(&index) {
            Some(bytes) => bytes,
            None => self.range((view.buffer, view.byte_offset, view.byte_length), &label, document, notes)?,
        };
        Ok(View { bytes, stride: view.byte_stride, label })
    }

    /// Bytes of all buffers together, a bound for what a sound file can describe.
    pub(super) fn total(&self) -> usize {
        let decoded: usize = self.decoded.values().map(Vec::len).sum();
        self.contents.iter().map(|bytes| bytes.len()).sum::<usize>() + decoded
    }
}

/// The views that are compressed, with their numbers.
fn compressed_views(document: &Document, notes: &Notes<'_>) -> Result<Vec<(usize, Compressed)>, SceneError> {
    let mut found = Vec::new();
    for (index, BufferView { extensions, .. }) in document.views.as_slice().iter().enumerate() {
        for name in MESHOPT.into_iter().filter(|_| !extensions.is_empty()) {
            let label = document.views.label(index);
            let compressed = document::extension::<Compressed>(extensions, name, &label, notes.path)?;
            found.extend(compressed.map(|compressed| (index, compressed)));
        }
    }
    Ok(found)
}
