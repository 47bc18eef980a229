//! The bytes of a frame for pages.

use std::sync::Arc;

/// The header of a frame, as `PROTOCOL.md` defines it.
pub(super) struct Header {
    pub(super) kind: u8,
    pub(super) divisor: u8,
    pub(super) is_last: bool,
    pub(super) number: u32,
    pub(super) version: u32,
    pub(super) size: [u32; 2],
    pub(super) samples: u32,
    pub(super) seconds: f32,
}

impl Header {
    /// The bytes of a frame with these codes.
    pub(super) fn before(&self, codes: &[u8]) -> Arc<[u8]> {
        let mut bytes = Vec::with_capacity(24 + codes.len());
        bytes.extend([84, self.kind, self.divisor, u8::from(self.is_last)]);
        bytes.extend(self.number.to_le_bytes());
        bytes.extend(self.version.to_le_bytes());
        // An edge of a film has at most 16384 pixels
        self.size.iter().for_each(|edge| bytes.extend((*edge as u16).to_le_bytes()));
        bytes.extend(self.samples.to_le_bytes());
        bytes.extend(self.seconds.to_le_bytes());
        bytes.extend(codes);
        bytes.into()
    }
}
