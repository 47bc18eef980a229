//! The command as it was typed, for the files that it makes.

use std::ffi::OsString;
use std::sync::{PoisonError, RwLock};

/// The words of the command that runs, the program's own first.
static WORDS: RwLock<Vec<OsString>> = RwLock::new(Vec::new());

/// From now on the command has these words.
pub(crate) fn set(words: Vec<OsString>) {
    *WORDS.write().unwrap_or_else(PoisonError::into_inner) = words;
}

/// The command in one line, with quotes where a shell needs them.
pub(crate) fn shown() -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    let words = WORDS.read().unwrap_or_else(PoisonError::into_inner);
    let words = words.iter().enumerate().map(|(index, word)| {
        let word = word.to_string_lossy().into_owned();
        match index {
            0 => String::from("translucid"),
            _ if !word.is_empty() && word.chars().all(plain) => word,
            _ => format!("'{}'", word.replace('\'', r"'\''")),
        }
    });
    words.collect::<Vec<_>>().join(" ")
}
