//! Accessors: typed arrays in the buffers, with strides, normalized integers and sparse values.

use super::buffers::{Arrays, View};
use super::document::{Accessor, SparseArray};
use crate::number::NumberType;
use crate::result::Result;

/// The type that glTF has a number for.
pub(super) fn component(code: u32) -> Option<NumberType> {
    Some(match code {
        5120 => NumberType::I8,
        5121 => NumberType::U8,
        5122 => NumberType::I16,
        5123 => NumberType::U16,
        5125 => NumberType::U32,
        5126 => NumberType::F32,
        _ => return None,
    })
}

/// Factor that makes a normalized integer a number in [0, 1] or [−1, 1]
/// (glTF 2.0, section 3.11, "Animations", and 3.6.2.2, "Accessor Data Types").
fn normalization(component: NumberType) -> f64 {
    match component {
        NumberType::I8 => 1.0 / 127.0,
        NumberType::U8 => 1.0 / 255.0,
        NumberType::I16 => 1.0 / 32767.0,
        NumberType::U16 => 1.0 / 65535.0,
        NumberType::U32 => 1.0 / f64::from(u32::MAX),
        NumberType::I32 | NumberType::F32 | NumberType::F64 => 1.0,
    }
}

/// Number of components of an element, for the shapes of vertex attributes and of transforms.
pub(super) fn components(shape: &str) -> Option<usize> {
    match shape {
        "SCALAR" => Some(1),
        "VEC2" => Some(2),
        "VEC3" => Some(3),
        "VEC4" => Some(4),
        "MAT4" => Some(16),
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
    pub(super) fn count(&self, index: usize, user: &str) -> Result<usize> {
        Ok(self.document.accessors.get(index, user)?.count)
    }

    /// Elements of `N` numbers; integers are divided by their range if the accessor is normalized.
    ///
    /// An accessor of three components read as four gets 1 as the fourth: opaque vertex colors.
    pub(super) fn numbers<const N: usize>(&self, index: usize, user: &str) -> Result<Vec<[f32; N]>> {
        let accessor = self.document.accessors.get(index, user)?;
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
                    if accessor.normalized { (raw * normalization(component)).max(-1.0) } else { raw };
                *number = value as f32;
            }
            element
        };
        self.elements((index, accessor), component.size() * found, &part, read)
    }

    /// Vertex indices.
    pub(super) fn indices(&self, index: usize, user: &str) -> Result<Vec<u32>> {
        let accessor = self.document.accessors.get(index, user)?;
        let part = format!("{}, {user}", self.document.accessors.label(index));
        let component = self.component(accessor.component_type, &part)?;
        if accessor.shape != "SCALAR"
            || !matches!(component, NumberType::U8 | NumberType::U16 | NumberType::U32)
        {
            let message = "indices must be SCALAR and of component type 5121, 5123 or 5125";
            return Err(self.notes.error(&part, message));
        }
        self.elements((index, accessor), component.size(), &part, |bytes| component.read(bytes) as u32)
    }

    fn component(&self, code: u32, part: &str) -> Result<NumberType> {
        component(code).ok_or_else(|| {
            let message =
                format!("its componentType is {code}, but must be 5120, 5121, 5122, 5123, 5125 or 5126");
            self.notes.error(part, message)
        })
    }

    /// All elements of an accessor, the sparse ones put in their places.
    fn elements<T: Clone>(
        &self,
        (index, accessor): (usize, &Accessor),
        size: usize,
        part: &str,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        if accessor.count == 0 {
            return Err(self.notes.error(part, "its count is 0, but must be at least 1"));
        }
        let mut elements = match (self.unpacked.get(&index), accessor.buffer_view) {
            (Some(unpacked), _) => unpacked.bytes.chunks_exact(size).map(&read).collect(),
            (None, Some(view)) => {
                let view = self.view(view, part)?;
                let range = (accessor.byte_offset, size, accessor.count);
                self.strided(&view, range, part)?.iter().map(&read).collect()
            }
            (None, None) => vec![read(&vec![0; size]); self.zeros(accessor, part)?],
        };
        self.apply_sparse(accessor, size, part, &mut elements, read)?;
        Ok(elements)
    }

    /// Number of zeros that an accessor without a buffer view stands for.
    ///
    /// Nothing in the file backs the count, so it must not exceed the bytes that the file has.
    fn zeros(&self, accessor: &Accessor, part: &str) -> Result<usize> {
        if accessor.sparse.is_none() {
            return Err(self.notes.error(part, "it has neither a bufferView nor sparse values"));
        }
        let limit = self.total();
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
    ) -> Result<Strided<'v>> {
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
    ) -> Result<()> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        if sparse.count == 0 {
            return Ok(());
        }
        let part = format!("{part}, sparse values");
        let array = |array: &SparseArray, size: usize| {
            let view = self.view(array.buffer_view, &part)?;
            self.strided(&view, (array.byte_offset, size, sparse.count), &part)
        };
        let component = self.component(sparse.indices.component_type, &part)?;
        let indices = array(&sparse.indices, component.size())?;
        let values = array(&sparse.values, size)?;
        for (index, value) in indices.iter().zip(values.iter()) {
            let (index, count) = (component.read(index) as usize, elements.len());
            *elements.get_mut(index).ok_or_else(|| {
                self.notes
                    .error(&part, format!("index {index} is out of range: the accessor's count is {count}"))
            })? = read(value);
        }
        Ok(())
    }
}
