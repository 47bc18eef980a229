//! Packets of tev's protocol.
//!
//! T. Müller, tev (<https://github.com/Tom94/tev>), `Ipc.h`, and its Python package tevclient. A packet is
//! ```text
//! length u32, itself included · kind u8 · fields
//! ```
//! with little-endian numbers and texts that end with a zero byte. Nothing is answered.

use translucid_image::PixelRect;

/// Channels of a picture, the values of a pixel side by side.
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// Kinds of packets; that of an update is the third version, which has strides.
const CLOSE_IMAGE: u8 = 2;
const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE: u8 = 6;

/// Closes the picture of a name, if there is one.
pub(super) fn close_image(name: &str) -> Vec<u8> {
    Packet::of(CLOSE_IMAGE).text(name).finish()
}

/// Makes a black picture and shows it.
pub(super) fn create_image(name: &str, size: [u32; 2]) -> Vec<u8> {
    let packet = Packet::of(CREATE_IMAGE).flag(true).text(name).counts(size).counts([CHANNELS.len() as u32]);
    CHANNELS.into_iter().fold(packet, Packet::text).finish()
}

/// Sets pixels of a picture, row by row.
pub(super) fn update_image(name: &str, rect: PixelRect, pixels: impl Iterator<Item = [f32; 4]>) -> Vec<u8> {
    let PixelRect { left, top, width, height } = rect;
    let packet = Packet::of(UPDATE_IMAGE).flag(false).text(name).counts([CHANNELS.len() as u32]);
    let packet = CHANNELS.into_iter().fold(packet, Packet::text).counts([left, top, width, height]);
    let offsets = (0..).take(CHANNELS.len());
    let strides = [CHANNELS.len() as i64; CHANNELS.len()];
    let mut packet = packet.longs(offsets).longs(strides);
    packet.bytes.extend(pixels.flatten().flat_map(f32::to_le_bytes));
    packet.finish()
}

/// A packet on its way.
struct Packet {
    bytes: Vec<u8>,
}

impl Packet {
    /// A packet whose length is still to be told.
    fn of(kind: u8) -> Self {
        Self { bytes: vec![0, 0, 0, 0, kind] }
    }

    fn flag(mut self, is_set: bool) -> Self {
        self.bytes.push(u8::from(is_set));
        self
    }

    /// A text up to a zero byte, which would end it.
    fn text(mut self, text: &str) -> Self {
        self.bytes.extend(text.bytes().take_while(|&byte| byte != 0));
        self.bytes.push(0);
        self
    }

    /// Numbers of 32 bits with a sign, none of which needs it.
    fn counts(mut self, counts: impl IntoIterator<Item = u32>) -> Self {
        self.bytes.extend(counts.into_iter().flat_map(u32::to_le_bytes));
        self
    }

    fn longs(mut self, longs: impl IntoIterator<Item = i64>) -> Self {
        self.bytes.extend(longs.into_iter().flat_map(i64::to_le_bytes));
        self
    }

    fn finish(mut self) -> Vec<u8> {
        let length = self.bytes.len() as u32;
        self.bytes[..4].copy_from_slice(&length.to_le_bytes());
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::super::blocks;
    use super::*;

    /// What tevclient 1.0.4 sends for a picture of 130×2 pixels at (3, 5): see `tests/data/tev/record.py`.
    const OF_TEVCLIENT: &[u8] = include_bytes!("../../../tests/data/tev/tevclient-1.0.4.bin");

    #[test]
    fn packets_are_those_of_tevclient() {
        let name = "ä b.exr";
        let mut bytes = [close_image(name), create_image(name, [200, 9])].concat();
        for block in blocks([130, 2]) {
            let pixels =
                block.pixels().map(|(x, y)| [0.0, 0.25, 0.5, 0.75].map(|c| x as f32 + 256.0 * y as f32 + c));
            let rect = PixelRect { left: block.left + 3, top: block.top + 5, ..block };
            bytes.extend(update_image(name, rect, pixels));
        }
        assert!(bytes == OF_TEVCLIENT);
    }
}
