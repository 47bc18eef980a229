//! Readers and writers that keep a checksum of what passes.

use std::io::{self, Read, Write};

/// A reader or writer with the CRC-32 of all bytes that have passed.
#[derive(Debug)]
pub struct Checksummed<T> {
    inner: T,
    crc: crc32fast::Hasher,
}

impl<T> Checksummed<T> {
    /// A reader or writer that nothing has passed yet.
    pub fn new(inner: T) -> Self {
        Self { inner, crc: crc32fast::Hasher::new() }
    }

    /// The checksum of what has passed, and the reader or writer itself, past which the checksum goes.
    pub fn finish(self) -> (u32, T) {
        (self.crc.finalize(), self.inner)
    }
}

impl<T: Read> Read for Checksummed<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.crc.update(&buffer[..count]);
        Ok(count)
    }
}

impl<T: Write> Write for Checksummed<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.crc.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksum_is_that_of_the_bytes_both_ways() {
        // The check value of CRC-32/ISO-HDLC.
        let mut writer = Checksummed::new(Vec::new());
        writer.write_all(b"12345").unwrap();
        writer.write_all(b"6789").unwrap();
        let (crc, bytes) = writer.finish();
        assert_eq!((crc, &bytes[..]), (0xcbf4_3926, &b"123456789"[..]));
        let mut reader = Checksummed::new(&bytes[..]);
        reader.read_exact(&mut [0; 9]).unwrap();
        assert_eq!(reader.finish().0, crc);
    }
}
