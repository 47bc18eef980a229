//! Accessors: typed arrays in the buffers, with strides, normalized integers and sparse values.

use super::buffers::{Buffers, View};
use super::document::{Accessor, Document, SparseIndices};
use super::notes::Notes;
use crate::SceneError;

/// A file's arrays.
pub(super) struct Arrays<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers<'a>,
    pub(super) notes: &'a Notes<'a>,
}

/// Type of a number in a buffer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u32) -> Option<Self> {
        let component = match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        };
        Some(component)
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number in the first bytes of a slice that is long enough.
    fn read(self, bytes: &[u8]) -> f64 {
        match self {
            Self::I8 => f64::from(bytes[0] as i8),
            Self::U8 => f64::from(bytes[0]),
            Self::I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            Self::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        }
    }

    /// Factor and lower limit that make a normalized integer a number in [0, 1] or [−1, 1]
    /// (glTF 2.0, section 3.11, "Animations", and 3.6.2.2, "Accessor Data Types").
    fn normalization(self) -> f64 {
        match self {
            Self::I8 => 1.0 / 127.0,
            Self::U8 => 1.0 / 255.0,
            Self::I16 => 1.0 / 32767.0,
            Self::U16 => 1.0 / 65535.0,
            Self::U32 => 1.0 / f64::from(u32::MAX),
            Self::F32 => 1.0,
        }
    }
}

/// Number of components of an element, for the shapes of vertex attributes.
fn components(shape: &str) -> Option<usize> {
    match shape {
        "SCALAR" => Some(1),
        "VEC2" => Some(2),
        "VEC3" => Some(3),
        "VEC4" => Some(4),
        _ => None,
    }
}

/// Elements at equal distances in a byte range that holds them all.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Strided<'a> {
    /// `None`: the elements do not lie within the bytes.
    fn new(bytes: &'a [u8], offset: usize, stride: usize, size: usize, count: usize) -> Option<Self> {
        let bytes = bytes.get(offset..)?;
        let length = count.checked_sub(1)?.checked_mul(stride)?.checked_add(size)?;
        (size <= stride && length <= bytes.len()).then_some(Self { bytes, stride, size, count })
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |i| &bytes[i * stride..i * stride + size])
    }
}

impl Arrays<'_> {
    /// Number of elements that an accessor states; not yet checked against the buffers.
    pub(super) fn count(&self, index: usize, user: &str) -> Result<usize, SceneError> {
        Ok(self.document.accessors.get(index, user, self.notes.path)?.count)
    }

    /// Elements of `N` numbers; integers are divided by their range if the accessor is normalized.
    ///
    /// An accessor of three components read as four gets 1 as the fourth: opaque vertex colors.
    pub(super) fn numbers<const N: usize>(
        &self,
        index: usize,
        user: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let accessor = self.document.accessors.get(index, user, self.notes.path)?;
        let part = format!("{}, {user}", self.document.accessors.label(index));
        let found = components(&accessor.shape).unwrap_or(0);
        if found != N && (found, N) != (3, 4) {
            let message = format!("its type is {}, but {N} components are needed", accessor.shape);
            return Err(self.notes.error(&part, message));
        }
        let component = self.component(accessor.component_type, &part)?;
        let read = |bytes: &[u8]| {
            let mut element = [1.0; N];
            for (number, bytes) in element.iter_mut().zip(bytes.chunks_exact(component.size())) {
                let raw = component.read(bytes);
                let value =
                    if accessor.normalized { (raw * component.normalization()).max(-1.0) } else { raw };
                *number = value as f32;
            }
            element
        };
        self.elements(accessor, component.size() * found, &part, read)
    }

    /// Vertex indices.
    pub(super) fn indices(&self, index: usize, user: &str) -> Result<Vec<u32>, SceneError> {
        let accessor = self.document.accessors.get(index, user, self.notes.path)?;
        let part = format!("{}, {user}", self.document.accessors.label(index));
        let component = self.component(accessor.component_type, &part)?;
        if accessor.shape != "SCALAR" || !matches!(component, Component::U8 | Component::U16 | Component::U32)
        {
            let message = "indices must be SCALAR and of component type 5121, 5123 or 5125";
            return Err(self.notes.error(&part, message));
        }
        self.elements(accessor, component.size(), &part, |bytes| component.read(bytes) as u32)
    }

    fn component(&self, code: u32, part: &str) -> Result<Component, SceneError> {
        Component::from_code(code).ok_or_else(|| {
            let message =
                format!("its componentType is {code}, but must be 5120, 5121, 5122, 5123, 5125 or 5126");
            self.notes.error(part, message)
        })
    }

    /// All elements of an accessor, the sparse ones put in their places.
    fn elements<T: Clone>(
        &self,
        accessor: &Accessor,
        size: usize,
        part: &str,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, SceneError> {
        if accessor.count == 0 {
            return Err(self.notes.error(part, "its count is 0, but must be at least 1"));
        }
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let view = self.buffers.view(view, self.document, part, self.notes)?;
                let range = (accessor.byte_offset, size, accessor.count);
                self.strided(&view, range, part)?.iter().map(&read).collect()
            }
            None => vec![read(&vec![0; size]); self.zeros(accessor, part)?],
        };
        self.apply_sparse(accessor, size, part, &mut elements, read)?;
        Ok(elements)
    }

    /// Number of zeros that an accessor without a buffer view stands for.
    ///
    /// Nothing in the file backs the count, so it must not exceed the bytes that the file has.
    fn zeros(&self, accessor: &Accessor, part: &str) -> Result<usize, SceneError> {
        if accessor.sparse.is_none() {
            return Err(self.notes.error(part, "it has neither a bufferView nor sparse values"));
        }
        let limit = self.buffers.total();
        if accessor.count > limit {
            let message =
                format!("its count is {}, but the file's buffers have {limit} bytes", accessor.count);
            return Err(self.notes.error(part, message));
        }
        Ok(accessor.count)
    }

    /// The (offset, element size, count) elements of a view.
    fn strided<'v>(
        &self,
        view: &View<'v>,
        (offset, size, count): (usize, usize, usize),
        part: &str,
    ) -> Result<Strided<'v>, SceneError> {
        let stride = view.stride.unwrap_or(size);
        Strided::new(view.bytes, offset, stride, size, count).ok_or_else(|| {
            let message = format!(
                "{count} elements of {size} bytes, {stride} bytes apart, from byteOffset {offset}, do not fit in the {} bytes of {}",
                view.bytes.len(),
                view.label
            );
            self.notes.error(part, message)
        })
    }

    fn apply_sparse<T>(
        &self,
        accessor: &Accessor,
        size: usize,
        part: &str,
        elements: &mut [T],
        read: impl Fn(&[u8]) -> T,
    ) -> Result<(), SceneError> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        if sparse.count == 0 {
            return Ok(());
        }
        let part = format!("{part}, sparse values");
        let indices = self.sparse_indices(&sparse.indices, sparse.count, &part)?;
        let view = self.buffers.view(sparse.values.buffer_view, self.document, &part, self.notes)?;
        let values = self.strided(&view, (sparse.values.byte_offset, size, sparse.count), &part)?;
        for (index, value) in indices.into_iter().zip(values.iter()) {
            let count = elements.len();
            *elements.get_mut(index).ok_or_else(|| {
                self.notes
                    .error(&part, format!("index {index} is out of range: the accessor's count is {count}"))
            })? = read(value);
        }
        Ok(())
    }

    fn sparse_indices(
        &self,
        indices: &SparseIndices,
        count: usize,
        part: &str,
    ) -> Result<Vec<usize>, SceneError> {
        let component = self.component(indices.component_type, part)?;
        let view = self.buffers.view(indices.buffer_view, self.document, part, self.notes)?;
        let values = self.strided(&view, (indices.byte_offset, component.size(), count), part)?;
        Ok(values.iter().map(|bytes| component.read(bytes) as usize).collect())
    }
}
