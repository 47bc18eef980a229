//! The file's outer shape: JSON alone, or a GLB container with a JSON and a binary chunk.
//!
//! glTF 2.0 specification, section 4, "GLB File Format Specification".

use std::path::Path;

use crate::result::Result;

use translucid_scene::{Place, SceneError};

/// The two parts of a file.
pub(super) struct Container<'a> {
    /// The JSON text.
    pub(super) json: &'a [u8],
    /// The binary chunk, which is the content of a first buffer without URI.
    pub(super) binary: Option<&'a [u8]>,
}

/// A chunk of a GLB file.
struct Chunk<'a> {
    kind: [u8; 4],
    data: &'a [u8],
    next: usize,
}

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Splits a file into its parts; what does not begin with the GLB magic is taken for JSON.
pub(super) fn split<'a>(bytes: &'a [u8], path: &Path) -> Result<Container<'a>> {
    if !bytes.starts_with(b"glTF") {
        let json = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        return Ok(Container { json, binary: None });
    }
    let bytes = read_header(bytes, path)?;
    let json = read_chunk(bytes, HEADER, path)?;
    if &json.kind != b"JSON" {
        let kind = json.kind.escape_ascii();
        return Err(at_byte(path, HEADER, format!("the first chunk is \"{kind}\", but must be \"JSON\"")));
    }
    Ok(Container { json: json.data, binary: find_binary(bytes, json.next, path)? })
}

/// Checks the header and cuts the bytes to the length that it states.
fn read_header<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a [u8]> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        let message = format!("the file ends after {} bytes, within the GLB header of {HEADER}", bytes.len());
        return Err(at_byte(path, bytes.len(), message));
    };
    if version != 2 {
        return Err(at_byte(path, 4, format!("the GLB version is {version}, but only 2 is known")));
    }
    let stated = length as usize;
    if stated < HEADER || stated > bytes.len() {
        let found = bytes.len();
        let message = format!("the GLB header states a length of {stated} bytes, but the file has {found}");
        return Err(at_byte(path, 8, message).with_help("the file is truncated or damaged"));
    }
    Ok(&bytes[..stated])
}

/// The data of the first binary chunk; chunks of unknown kinds are passed over, as the standard demands.
fn find_binary<'a>(bytes: &'a [u8], start: usize, path: &Path) -> Result<Option<&'a [u8]>> {
    let mut at = start;
    while at < bytes.len() {
        let chunk = read_chunk(bytes, at, path)?;
        if &chunk.kind == b"BIN\0" {
            return Ok(Some(chunk.data));
        }
        at = chunk.next;
    }
    Ok(None)
}

fn read_chunk<'a>(bytes: &'a [u8], at: usize, path: &Path) -> Result<Chunk<'a>> {
    let (Some(length), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
        return Err(at_byte(path, at, "the file ends within a chunk's header"));
    };
    let start = at + CHUNK_HEADER;
    let Some(data) = bytes.get(start..start.saturating_add(length as usize)) else {
        let left = bytes.len() - start;
        return Err(at_byte(path, at, format!("a chunk states {length} bytes, but {left} are left")));
    };
    Ok(Chunk { kind: kind.to_le_bytes(), data, next: start + data.len() })
}

/// Little-endian word at a byte position.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes)
}

fn at_byte(path: &Path, byte: usize, message: impl Into<String>) -> SceneError {
    SceneError::at(Place::part(path, format!("byte {byte}")), message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let mut bytes = (data.len() as u32).to_le_bytes().to_vec();
        bytes.extend(kind);
        bytes.extend(data);
        bytes
    }

    fn glb(chunks: &[Vec<u8>]) -> Vec<u8> {
        let body = chunks.concat();
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend(((HEADER + body.len()) as u32).to_le_bytes());
        bytes.extend(body);
        bytes
    }

    fn failure(bytes: &[u8]) -> String {
        split(bytes, Path::new("x.glb")).err().map(|e| e.to_string()).expect("an error")
    }

    #[test]
    fn split_finds_json_and_binary_and_passes_unknown_chunks() {
        let file = glb(&[chunk(b"JSON", b"{}  "), chunk(b"XTRA", b"1234"), chunk(b"BIN\0", b"abcd")]);
        let parts = split(&file, Path::new("x.glb")).unwrap();
        assert_eq!(parts.json, b"{}  ");
        assert_eq!(parts.binary, Some(&b"abcd"[..]));
    }

    #[test]
    fn split_takes_plain_json_with_or_without_byte_order_mark() {
        assert_eq!(split(b"{}", Path::new("x")).unwrap().json, b"{}");
        assert_eq!(split(b"\xEF\xBB\xBF{}", Path::new("x")).unwrap().json, b"{}");
    }

    #[test]
    fn split_names_the_byte_of_every_fault() {
        let good = glb(&[chunk(b"JSON", b"{}  "), chunk(b"BIN\0", b"abcd")]);
        assert!(failure(&good[..10]).contains("x.glb, byte 10: the file ends after 10 bytes"));
        assert!(failure(&good[..30]).contains("byte 8: the GLB header states a length of 36 bytes"));
        let mut version = good.clone();
        version[4] = 1;
        assert!(failure(&version).contains("byte 4: the GLB version is 1"));
        let mut long_chunk = good.clone();
        long_chunk[15] = 0xFF;
        assert!(failure(&long_chunk).contains("byte 12: a chunk states"));
        assert!(
            failure(&glb(&[chunk(b"BIN\0", b"abcd")])).contains("byte 12: the first chunk is \"BIN\\x00\"")
        );
        assert!(failure(&glb(&[])).contains("byte 12: the file ends within a chunk's header"));
        let mut short_header = good;
        short_header[8..12].copy_from_slice(&3u32.to_le_bytes());
        assert!(failure(&short_header).contains("states a length of 3 bytes"));
    }
}
