//! The codecs and filters of EXT_meshopt_compression and KHR_meshopt_compression, after the appendices A and B of the
//! latter's specification (A. Kapoulkine and others, 2025).
//!
//! The letters are the specification's. A stream that ends too early, or has bytes left, is damaged.

use serde::Deserialize;

use super::extensions::Members;
use crate::result::Result;

/// Compressed contents of a buffer view.
pub(super) struct Compressed {
    pub(super) buffer: usize,
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    /// Bytes of an element.
    byte_stride: usize,
    /// Number of elements.
    count: usize,
    mode: Mode,
    filter: Filter,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "UPPERCASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "UPPERCASE")]
enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl Compressed {
    /// Reads the place, form and filter of a compressed view from the extension's object.
    pub(super) fn of(data: &Members<'_>) -> Result<Self> {
        Ok(Self {
            buffer: data.require("buffer")?,
            byte_offset: data.get("byteOffset")?.unwrap_or(0),
            byte_length: data.require("byteLength")?,
            byte_stride: data.require("byteStride")?,
            count: data.require("count")?,
            mode: data.require("mode")?,
            filter: data.get("filter")?.unwrap_or_default(),
        })
    }

    /// Bytes of the contents.
    pub(super) fn length(&self) -> usize {
        self.count.saturating_mul(self.byte_stride)
    }

    /// The contents, or what is wrong in words that go on after the view's name.
    pub(super) fn decode(&self, bytes: &[u8]) -> Result<Vec<u8>, String> {
        let (stride, count) = (self.byte_stride, self.count);
        let fits = match self.mode {
            Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
            Mode::Triangles => matches!(stride, 2 | 4) && count.is_multiple_of(3),
            Mode::Indices => matches!(stride, 2 | 4),
        };
        let can_be_filtered = match self.filter {
            Filter::None => true,
            Filter::Octahedral | Filter::Color => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
            Filter::Exponential => stride.is_multiple_of(4),
        };
        if !fits || !(can_be_filtered && (self.filter == Filter::None || self.mode == Mode::Attributes)) {
            return Err(format!(
                "its meshopt mode and filter cannot have {count} elements of {stride} bytes"
            ));
        }
        let decoded = match self.mode {
            Mode::Attributes => attributes(bytes, count, stride),
            Mode::Triangles => triangles(bytes, count).map(|indices| indices_as_bytes(&indices, stride)),
            Mode::Indices => indices(bytes, count).map(|indices| indices_as_bytes(&indices, stride)),
        };
        let mut decoded = decoded.ok_or("its meshopt data is damaged")?;
        match self.filter {
            Filter::None => {}
            Filter::Octahedral if stride == 4 => elements::<1>(&mut decoded, 127.0, octahedral),
            Filter::Octahedral => elements::<2>(&mut decoded, 32767.0, octahedral),
            Filter::Quaternion => elements::<2>(&mut decoded, 32767.0, quaternion),
            Filter::Exponential => decoded.as_chunks_mut().0.iter_mut().for_each(exponential),
            Filter::Color if stride == 4 => elements::<1>(&mut decoded, 255.0, color),
            Filter::Color => elements::<2>(&mut decoded, 65535.0, color),
        }
        Ok(decoded)
    }
}

/// The first `count` bytes, which are taken off.
fn take<'a>(data: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (taken, rest) = data.split_at_checked(count)?;
    *data = rest;
    Some(taken)
}

/// Mode 0.
fn attributes(bytes: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&header, rest) = bytes.split_first()?;
    let (is_version_0, modes, least) = match header {
        0xa0 => (true, 0, 32),
        0xa1 => (false, stride / 4, 24),
        _ => return None,
    };
    let tail = stride + modes;
    let (mut data, padded) = rest.split_at_checked(rest.len().checked_sub(tail.max(least))?)?;
    let (baseline, modes) = padded[padded.len() - tail..].split_at(stride);
    let mut last = baseline.to_vec();
    let most = ((8192 / stride) & !15).min(256);
    let mut decoded = Vec::new();
    let mut deltas = vec![[0; 4]; most];
    while decoded.len() < count * stride {
        let start = decoded.len();
        let elements = most.min(count - start / stride);
        let control = if is_version_0 { &[][..] } else { take(&mut data, stride / 4)? };
        decoded.resize(start + elements * stride, 0);
        for channel in 0..stride / 4 {
            for byte in 0..4 {
                let widths = match control.get(channel).map(|control| (control >> (2 * byte)) & 3) {
                    None => Some([0, 2, 4, 8]),
                    Some(0) => Some([0, 1, 2, 4]),
                    Some(1) => Some([1, 2, 4, 8]),
                    Some(2) => Some([0; 4]),
                    Some(_) => None,
                };
                match widths {
                    Some([0, 0, ..]) => deltas.iter_mut().for_each(|delta| delta[byte] = 0),
                    Some(widths) => read_deltas(&mut data, widths, elements, |i, delta| {
                        if let Some(deltas) = deltas.get_mut(i) {
                            deltas[byte] = delta;
                        }
                    })?,
                    None => {
                        let literal = take(&mut data, elements)?;
                        deltas.iter_mut().zip(literal).for_each(|(delta, &value)| delta[byte] = value);
                    }
                }
            }
            let (mode, at) = (modes.get(channel).copied().unwrap_or(0), 4 * channel);
            let mut value: [u8; 4] = last[at..at + 4].try_into().ok()?;
            for (element, delta) in decoded[start..].chunks_exact_mut(stride).zip(&deltas) {
                value = changed(value, *delta, mode)?;
                element[at..at + 4].copy_from_slice(&value);
            }
            last[at..at + 4].copy_from_slice(&value);
        }
    }
    data.is_empty().then_some(decoded)
}

/// Reads the deltas of one byte of the elements, in groups of 16 whose header bits say how many bits each has.
fn read_deltas(
    data: &mut &[u8],
    widths: [usize; 4],
    elements: usize,
    mut set: impl FnMut(usize, u8),
) -> Option<()> {
    let groups = elements.div_ceil(16);
    let header = take(data, groups.div_ceil(4))?;
    for group in 0..groups {
        let width = widths[usize::from((header[group / 4] >> (2 * (group % 4))) & 3)];
        let packed = take(data, 2 * width)?;
        let sentinel = ((1_u16 << width) - 1) as u8;
        for i in 0..16 {
            let delta = match width {
                0 => 0,
                1 => (packed[i / 8] >> (i % 8)) & 1,
                8 => packed[i],
                _ => (packed[i * width / 8] >> (8 - width - i * width % 8)) & sentinel,
            };
            let is_elsewhere = matches!(width, 1 | 2 | 4) && delta == sentinel;
            set(16 * group + i, if is_elsewhere { take(data, 1)?[0] } else { delta });
        }
    }
    Some(())
}

/// Four bytes after a delta, by the mode of their channel.
fn changed(value: [u8; 4], delta: [u8; 4], mode: u8) -> Option<[u8; 4]> {
    match (mode & 15, mode >> 4) {
        (0, 0) => {
            let unzigzag = |v: u8| if v & 1 == 0 { v >> 1 } else { !(v >> 1) };
            Some(std::array::from_fn(|i| value[i].wrapping_add(unzigzag(delta[i]))))
        }
        (1, 0) => {
            let half = |[a, b, c, d]: [u8; 4]| [u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])];
            let unzigzag = |v: u16| if v & 1 == 0 { v >> 1 } else { !(v >> 1) };
            let ([p, q], [v, w]) = (half(value), half(delta).map(unzigzag));
            let ([a, b], [c, d]) = (p.wrapping_add(v).to_le_bytes(), q.wrapping_add(w).to_le_bytes());
            Some([a, b, c, d])
        }
        (2, rotation) => {
            let delta = u32::from_le_bytes(delta).rotate_right(rotation.into());
            Some((u32::from_le_bytes(value) ^ delta).to_le_bytes())
        }
        _ => None,
    }
}

/// The last sixteen entries, the newest at index 0.
struct Fifo<T>([Option<T>; 16]);

impl<T: Copy> Fifo<T> {
    fn push(&mut self, entry: T) {
        self.0.rotate_right(1);
        self.0[0] = Some(entry);
    }

    fn get(&self, index: u8) -> Option<T> {
        *self.0.get(usize::from(index))?
    }
}

/// An unsigned number of 7 bits a byte.
fn leb128(data: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for shift in [0, 7, 14, 21, 28] {
        let byte = take(data, 1)?[0];
        value |= u32::from(byte & 127) << shift;
        if byte < 128 {
            return Some(value);
        }
    }
    None
}

/// State of the decoder of triangles.
struct Triangles<'a> {
    data: &'a [u8],
    next: u32,
    last: u32,
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
}

impl Triangles<'_> {
    /// The index to be seen next for the first time.
    fn new_index(&mut self) -> u32 {
        self.next = self.next.wrapping_add(1);
        self.next.wrapping_sub(1)
    }

    fn free_index(&mut self) -> Option<u32> {
        let v = leb128(&mut self.data)?;
        self.last = self.last.wrapping_add(if v & 1 == 0 { v >> 1 } else { !(v >> 1) });
        Some(self.last)
    }

    /// The index that four bits stand for where three indices are coded.
    fn index(&mut self, bits: u8) -> Option<u32> {
        match bits {
            0 => Some(self.new_index()),
            15 => self.free_index(),
            _ => self.vertices.get(bits - 1),
        }
    }

    /// A triangle at an edge that was seen not long ago.
    fn at_edge(&mut self, x: u8, y: u8) -> Option<[u32; 3]> {
        let [a, b] = self.edges.get(x)?;
        let c = match y {
            0 => self.new_index(),
            1..13 => self.vertices.get(y)?,
            13 | 14 => {
                self.last = if y == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            _ => self.free_index()?,
        };
        if !(1..13).contains(&y) {
            self.vertices.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Some([a, b, c])
    }

    /// A triangle of three indices.
    fn apart(&mut self, first: u8, zw: u8) -> Option<[u32; 3]> {
        let (z, w) = (zw >> 4, zw & 15);
        let a = self.index(first)?;
        let b = self.index(z)?;
        let c = self.index(w)?;
        self.vertices.push(a);
        if matches!(z, 0 | 15) {
            self.vertices.push(b);
        }
        if matches!(w, 0 | 15) {
            self.vertices.push(c);
        }
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Some([a, b, c])
    }
}

/// Mode 1.
fn triangles(bytes: &[u8], count: usize) -> Option<Vec<u32>> {
    let (&0xe1, mut data) = bytes.split_first()? else { return None };
    let codes = take(&mut data, count / 3)?;
    let (data, aux) = data.split_at_checked(data.len().checked_sub(16)?)?;
    let (edges, vertices) = (Fifo([None; 16]), Fifo([None; 16]));
    let mut state = Triangles { data, next: 0, last: 0, edges, vertices };
    let mut found = Vec::with_capacity(count);
    for &code in codes {
        let (x, y) = (code >> 4, code & 15);
        found.extend(match (x, y) {
            (0..15, _) => state.at_edge(x, y)?,
            (_, 0..14) => state.apart(0, aux[usize::from(y)])?,
            _ => {
                let zw = take(&mut state.data, 1)?[0];
                if zw == 0 {
                    state.next = 0;
                }
                state.apart(if y == 14 { 0 } else { 15 }, zw)?
            }
        });
    }
    state.data.is_empty().then_some(found)
}

/// Mode 2.
fn indices(bytes: &[u8], count: usize) -> Option<Vec<u32>> {
    let (&0xd1, data) = bytes.split_first()? else { return None };
    let (mut data, _) = data.split_at_checked(data.len().checked_sub(4)?)?;
    if count > data.len() {
        return None;
    }
    let mut last = [0_u32; 2];
    let mut index = || {
        let v = leb128(&mut data)?;
        let last = &mut last[(v & 1) as usize];
        *last = last.wrapping_add(if v & 2 == 0 { v >> 2 } else { !(v >> 2) });
        Some(*last)
    };
    let found = (0..count).map(|_| index()).collect::<Option<_>>()?;
    data.is_empty().then_some(found)
}

fn indices_as_bytes(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(stride)).collect()
}

/// Changes elements of four integers of so many bytes by a filter; `most` is what 1 becomes.
fn elements<const BYTES: usize>(bytes: &mut [u8], most: f32, filter: fn([i32; 4], f32) -> [i32; 4]) {
    for element in bytes.chunks_exact_mut(4 * BYTES) {
        let integer = |i: usize| match BYTES {
            1 => i32::from(element[i] as i8),
            _ => i32::from(i16::from_le_bytes([element[2 * i], element[2 * i + 1]])),
        };
        let filtered = filter(std::array::from_fn(integer), most);
        for (bytes, integer) in element.chunks_exact_mut(BYTES).zip(filtered) {
            bytes.copy_from_slice(&integer.to_le_bytes()[..BYTES]);
        }
    }
}

fn octahedral([x, y, one, w]: [i32; 4], most: f32) -> [i32; 4] {
    let [x, y] = [x, y].map(|v| v as f32 / one as f32);
    let z = 1.0 - x.abs() - y.abs();
    let t = z.min(0.0);
    let v = [x - t.copysign(x), y - t.copysign(y), z];
    let length = v.iter().map(|v| v * v).sum::<f32>().sqrt();
    let [x, y, z] = v.map(|v| (v / length * most).round() as i32);
    [x, y, z, w]
}

fn quaternion([x, y, z, w]: [i32; 4], most: f32) -> [i32; 4] {
    let one = (w | 3) as f32;
    let v = [x, y, z].map(|v| v as f32 / one * std::f32::consts::FRAC_1_SQRT_2);
    let greatest = (1.0 - v.iter().map(|v| v * v).sum::<f32>()).max(0.0).sqrt();
    let mut found = [greatest, v[0], v[1], v[2]].map(|v| (v * most).round() as i32);
    found.rotate_right((w & 3) as usize);
    found
}

fn exponential(bytes: &mut [u8; 4]) {
    let bits = i32::from_le_bytes(*bytes);
    let (exponent, mantissa) = (bits >> 24, (bits << 8) >> 8);
    *bytes = ((f64::from(mantissa) * libm::exp2(f64::from(exponent))) as f32).to_le_bytes();
}

fn color([y, co, cg, alpha]: [i32; 4], most: f32) -> [i32; 4] {
    // The first and the last component have no sign
    let [y, alpha] = [y, alpha].map(|v| v & most as i32);
    // All bits up to the highest one
    let all = (1 << (32 - alpha.leading_zeros()).min(16)) - 1;
    let a = alpha & (all >> 1);
    let scale = most / all.max(1) as f32;
    [y + co - cg, y + cg, y - co - cg, (a << 1) | (a & 1)].map(|v| (v as f32 * scale).round() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the specification's section on attributes, as the only byte that changes of sixteen elements.
    #[test]
    fn deltas_are_those_of_the_specification() {
        let mut data: &[u8] = &[2, 0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let mut found = [0; 16];
        read_deltas(&mut data, [0, 2, 4, 8], 16, |i, delta| found[i] = delta).unwrap();
        assert!(data.is_empty());
        let unzigzag = |v: u8| (if v & 1 == 0 { v >> 1 } else { !(v >> 1) }) as i8;
        let expected = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0];
        assert_eq!(found.map(unzigzag), expected);
    }

    #[test]
    fn numbers_of_seven_bits_are_those_of_the_specification() {
        for (bytes, value) in
            [(&[0x7f][..], 0x7f), (&[0x81, 0x04], 0x201), (&[0xff, 0xa0, 0x05], 0x1_5070 + 0xf)]
        {
            let mut data = bytes;
            assert_eq!((leb128(&mut data), data.len()), (Some(value), 0));
        }
        assert_eq!(leb128(&mut &[0xff; 6][..]), None);
    }

    #[test]
    fn channels_change_by_bytes_by_words_or_by_bits() {
        assert_eq!(changed([0, 255, 1, 7], [1, 2, 4, 0], 0), Some([255, 0, 3, 7]));
        assert_eq!(changed([255, 0, 0, 1], [2, 0, 1, 0], 1), Some([0, 1, 255, 0]));
        assert_eq!(changed([0, 0, 0, 1], [1, 0, 0, 0], 2), Some([1, 0, 0, 1]));
        assert_eq!(changed([0; 4], [0, 1, 0, 0], 2 + (8 << 4)), Some([1, 0, 0, 0]));
        assert_eq!((changed([0; 4], [0; 4], 3), changed([0; 4], [0; 4], 16)), (None, None));
    }

    /// Strips of a first triangle of new vertices and one across its last edge, as gltfpack writes a square.
    #[test]
    fn triangles_and_indices_are_decoded() {
        let mut bytes = vec![0xe1, 0xf0, 0x00];
        bytes.extend([0; 16]);
        assert_eq!(triangles(&bytes, 6), Some(vec![0, 1, 2, 0, 2, 3]));
        assert_eq!((triangles(&bytes[..18], 6), triangles(&bytes, 9)), (None, None));
        let bytes = [0xd1, 0, 4, 4, 17, 2, 0, 0, 0, 0];
        assert_eq!(indices(&bytes, 5), Some(vec![0, 1, 2, 4, 1]));
    }

    #[test]
    fn filters_keep_directions_turns_numbers_and_colors() {
        assert_eq!(octahedral([127, 0, 127, -5], 127.0), [127, 0, 0, -5]);
        assert_eq!(octahedral([0, 0, 31, 1], 127.0), [0, 0, 127, 1]);
        assert_eq!(octahedral([32767, -32767, 32767, 0], 32767.0), [0, 0, -32767, 0]);
        for greatest in 0..4 {
            let mut expected = [0; 4];
            expected[greatest as usize] = 32767;
            assert_eq!(quaternion([0, 0, 0, (2047 & !3) | greatest], 32767.0), expected);
        }
        let mut bytes = (((-1_i32) << 24) | 3).to_le_bytes();
        exponential(&mut bytes);
        assert_eq!(f32::from_le_bytes(bytes), 1.5);
        // Red of 8 bits: Y = (r + 2 g + b) / 4, Co = (r − b) / 2, Cg = (−r + 2 g − b) / 4, opaque
        assert_eq!(color([64, 127, -64, 255], 255.0), [255, 0, 1, 255]);
        assert_eq!(color([8, 0, 0, 15], 255.0), [136, 136, 136, 255]);
        assert_eq!(color([0; 4], 255.0), [0; 4]);
    }
}
