//! Where buffers and images lie: `data:` URIs with base64, and files beside the glTF.

use std::path::{Component, Path, PathBuf};

use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use base64::engine::{DecodePaddingMode, Engine};
use base64::{DecodeError, alphabet};

use super::notes::Notes;
use crate::file::read_file;

/// Bytes that a URI stands for.
#[derive(Debug)]
pub(super) struct Contents {
    pub(super) bytes: Vec<u8>,
    /// The file that they came from, if they did.
    pub(super) path: Option<PathBuf>,
}

/// Bytes behind a URI of a buffer or image.
///
/// # Errors
/// Error in words that go on after the name of the buffer or image.
pub(super) fn read(uri: &str, notes: &Notes<'_>) -> Result<Contents, String> {
    match uri.strip_prefix("data:") {
        Some(data) => read_data(data).map(|bytes| Contents { bytes, path: None }),
        None => read_beside(uri, notes),
    }
}

/// At most 60 characters of a name, so that a message stays one.
pub(super) fn clip(name: &str) -> String {
    let mut clipped: String = name.chars().take(60).flat_map(char::escape_debug).collect();
    if name.chars().nth(60).is_some() {
        clipped.push('…');
    }
    clipped
}

fn read_data(data: &str) -> Result<Vec<u8>, String> {
    let (kind, content) = data.split_once(',').ok_or("its data URI has no comma")?;
    if !kind.ends_with(";base64") {
        return Err(format!("its data URI is \"{}\", but only base64 is read", clip(kind)));
    }
    decode_base64(content)
}

/// Standard base64 (RFC 4648, section 4) with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

fn decode_base64(text: &str) -> Result<Vec<u8>, String> {
    BASE64.decode(text).map_err(|error| match error {
        DecodeError::InvalidByte(at, _) => format!("its base64 data is broken at character {}", at + 1),
        _ => format!("its base64 data has {} characters, which cannot be", text.len()),
    })
}

fn read_beside(uri: &str, notes: &Notes<'_>) -> Result<Contents, String> {
    let candidates = [percent_decoded(uri), Some(uri.to_owned())];
    let mut failure = String::new();
    for relative in candidates.into_iter().flatten() {
        let path = beside(&relative, notes.path)?;
        match read_file(&path) {
            Ok(bytes) => {
                notes.add_file(&path);
                return Ok(Contents { bytes, path: Some(path) });
            }
            Err(error) if failure.is_empty() => failure = format!("{} {}", path.display(), error.message),
            Err(_) => (),
        }
    }
    Err(failure)
}

/// A path relative to the glTF file's folder; a file of another place on the machine is not its business.
fn beside(relative: &str, gltf: &Path) -> Result<PathBuf, String> {
    let path = Path::new(relative);
    let plain =
        |part: Component<'_>| matches!(part, Component::Normal(_) | Component::ParentDir | Component::CurDir);
    if relative.contains("://") || relative.starts_with("file:") || !path.components().all(plain) {
        return Err(format!("\"{}\" is not a path relative to the glTF file", clip(relative)));
    }
    Ok(gltf.parent().unwrap_or(Path::new("")).join(path))
}

/// Percent decoding (RFC 3986, section 2.1), if there is something to decode and the result is UTF-8.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        match (first, tail) {
            (b'%', [high, low, after @ ..]) => {
                let digit = |c: &u8| char::from(*c).to_digit(16);
                bytes.push((digit(high)? * 16 + digit(low)?) as u8);
                rest = after;
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).ok().filter(|decoded| decoded != uri)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_read_with_and_without_padding() {
        assert_eq!(decode_base64("Zm9vYmFy").unwrap(), b"foobar"); // RFC 4648, section 10
        assert_eq!(decode_base64("Zm9vYg==").unwrap(), b"foob");
        assert_eq!(decode_base64("Zm9vYg").unwrap(), b"foob");
    }

    #[test]
    fn base64_decoding_says_where_the_text_is_broken() {
        assert_eq!(decode_base64("AAAA*AAA").unwrap_err(), "its base64 data is broken at character 5");
        assert_eq!(decode_base64("AAAAA").unwrap_err(), "its base64 data has 5 characters, which cannot be");
        assert_eq!(decode_base64("A=AA").unwrap_err(), "its base64 data is broken at character 2");
    }

    #[test]
    fn percent_decoding_handles_spaces_umlauts_and_broken_escapes() {
        assert_eq!(percent_decoded("a%20b%C3%A4.bin").as_deref(), Some("a bä.bin"));
        assert_eq!(percent_decoded("plain.bin"), None);
        assert_eq!(percent_decoded("100%.bin"), None);
        assert_eq!(percent_decoded("%FF.bin"), None);
    }

    #[test]
    fn read_refuses_what_is_not_beside_the_file() {
        for uri in ["/etc/passwd", "http://example.org/a.bin", "file:///a.bin", "%2Fetc/passwd"] {
            let message = read(uri, &Notes::new(Path::new("models/a.gltf"))).unwrap_err();
            assert!(message.contains("is not a path relative to the glTF file"), "{uri}: {message}");
        }
        let notes = Notes::new(Path::new("a.gltf"));
        assert!(read("no such.bin", &notes).unwrap_err().starts_with("no such.bin cannot be read: "));
        assert!(
            read("", &Notes::new(&std::env::temp_dir().join("a.gltf"))).unwrap_err().contains("not a file")
        );
    }

    #[test]
    fn read_refuses_data_uris_that_are_not_base64() {
        let notes = Notes::new(Path::new("a.gltf"));
        let message = read("data:text/plain,hello", &notes).unwrap_err();
        assert_eq!(message, "its data URI is \"text/plain\", but only base64 is read");
        assert_eq!(read("data:", &notes).unwrap_err(), "its data URI has no comma");
    }
}
