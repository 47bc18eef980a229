//! Buffers and the byte ranges that buffer views cut from them.

use std::borrow::Cow;

use translucid_scene::SceneError;

use super::document::{Buffer, Document};
use super::notes::Notes;
use super::uri;

/// The bytes of every buffer.
pub(super) struct Buffers<'a> {
    contents: Vec<Cow<'a, [u8]>>,
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
        let mut contents = Vec::new();
        for (index, buffer) in document.buffers.as_slice().iter().enumerate() {
            let part = document.buffers.label(index);
            let mut bytes = match (&buffer.uri, binary.take()) {
                (Some(uri), _) => uri::read(uri, notes)
                    .map(|found| Cow::Owned(found.bytes))
                    .map_err(|e| notes.error(&part, e))?,
                (None, Some(bytes)) => Cow::Borrowed(bytes),
                (None, None) => return Err(notes.error(&part, without_data(buffer))),
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
        Ok(Self { contents })
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
        let buffer = &self.contents[view.buffer];
        let end = view.byte_offset.saturating_add(view.byte_length);
        let Some(bytes) = buffer.get(view.byte_offset..end) else {
            let message = format!(
                "it has byteOffset {} and byteLength {}, but {} has {} bytes",
                view.byte_offset,
                view.byte_length,
                document.buffers.label(view.buffer),
                buffer.len()
            );
            return Err(notes.error(&label, message));
        };
        Ok(View { bytes, stride: view.byte_stride, label })
    }

    /// Bytes of all buffers together, a bound for what a sound file can describe.
    pub(super) fn total(&self) -> usize {
        self.contents.iter().map(|bytes| bytes.len()).sum()
    }
}

/// Words for a buffer without URI and binary chunk.
fn without_data(buffer: &Buffer) -> String {
    match buffer.extensions.keys().find(|name| name.contains("meshopt")) {
        Some(name) => format!("its data is compressed by {}, which is not read", uri::clip(name)),
        None => String::from("it has neither a URI nor a GLB binary chunk"),
    }
}
