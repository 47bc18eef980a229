//! Edits of valid files, for formats of which nothing made up passes the first lines.

/// `file` with edits: each is four bytes, a place in two, a kind and a value; places count from the end for odd kinds.
///
/// A value is set, added, inserted, repeated over the next eight bytes, or ends the file.
pub fn edited(file: &[u8], edits: &[u8]) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for &[low, high, kind, value] in edits.as_chunks().0 {
        let from_start = usize::from(u16::from_le_bytes([low, high])) % bytes.len().max(1);
        let place = if kind % 2 == 0 { from_start } else { (bytes.len() - from_start).saturating_sub(1) };
        let rest = bytes.get_mut(place..).unwrap_or_default();
        match (kind / 2 % 5, rest) {
            (0, [byte, ..]) => *byte = value,
            (1, [byte, ..]) => *byte = byte.wrapping_add(value),
            (2, _) => bytes.insert(place, value),
            (3, rest) => rest.iter_mut().take(8).for_each(|byte| *byte = value),
            _ if value > 200 => bytes.truncate(place),
            _ => {}
        }
    }
    bytes
}
