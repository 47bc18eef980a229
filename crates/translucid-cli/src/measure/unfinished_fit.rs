//! A fit that was interrupted, in a file from which `--resume` goes on.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::Path;

use serde_json::{Value, json};
use translucid_files::{OutputError, write_atomically};
use translucid_measure::{Guess, Progress};

use crate::table::exact;

/// Key of the format's version, by which such a file is recognized.
const KEY: &str = "translucid_unfinished_fit";
const VERSION: u64 = 2;

/// More steps than a fit takes.
const MOST_STEPS: u64 = 1000;

/// More bytes than such a file has.
const MOST_BYTES: u64 = 1 << 16;

/// Numbers of a guess.
const NUMBERS: usize = 10;

/// The content of such a file.
pub(super) struct UnfinishedFit(Value);

/// Writes how far a fit is; the file is whole or not there.
pub(super) fn save_progress(path: &Path, fingerprint: &str, progress: &Progress) -> Result<(), OutputError> {
    let Progress { guess, best, steps, retreats } = progress;
    let best = best.map(|(guess, square)| json!({ "guess": numbers(&guess), "square": exact(square) }));
    let text = json!({
        KEY: VERSION,
        "fingerprint": fingerprint,
        "guess": numbers(guess),
        "best": best,
        "steps": steps,
        "retreats": retreats,
    });
    write_atomically(path, |out| writeln!(out, "{text:#}"))
}

/// Reads such a file; refuses any other, which the fit would replace.
pub(super) fn load_progress(path: &Path) -> Result<UnfinishedFit, OutputError> {
    let mut text = String::new();
    let read = File::open(path).and_then(|file| file.take(MOST_BYTES).read_to_string(&mut text));
    match read.ok().and_then(|_| serde_json::from_str(&text).ok()) {
        Some(value @ Value::Object(_)) if value[KEY] != Value::Null => Ok(UnfinishedFit(value)),
        _ => Err(OutputError::new(path, "is no unfinished fit, and would be replaced by one")
            .with_help("name another file with --checkpoint")),
    }
}

impl UnfinishedFit {
    /// The progress of the fit with a fingerprint; refuses that of another one.
    pub(super) fn of(&self, path: &Path, fingerprint: &str) -> Result<Progress, OutputError> {
        let refuse = |message: &str| {
            OutputError::new(path, message).with_help("leave out --resume to start the fit anew")
        };
        if self.0[KEY] != json!(VERSION) {
            return Err(refuse("is an unfinished fit of another version of translucid"));
        }
        if self.0["fingerprint"] != json!(fingerprint) {
            return Err(refuse("is an unfinished fit of another scene or other settings"));
        }
        self.progress().ok_or_else(|| refuse("is a damaged unfinished fit"))
    }

    fn progress(&self) -> Option<Progress> {
        let count = |key: &str| self.0[key].as_u64().filter(|count| *count < MOST_STEPS).map(|c| c as u32);
        let best = match &self.0["best"] {
            Value::Null => None,
            best => Some((guess(&best["guess"])?, number(&best["square"])?)),
        };
        Some(Progress {
            guess: guess(&self.0["guess"])?,
            best,
            steps: count("steps")?,
            retreats: count("retreats")?,
        })
    }
}

/// The numbers of a guess as texts, which come back to the last bit: JSON's own may miss it.
fn numbers(guess: &Guess) -> Vec<String> {
    let Guess { surface_albedo, mfp, g, radiance } = guess;
    surface_albedo.iter().chain(mfp).chain([g]).chain(radiance).map(|number| exact(*number)).collect()
}

fn number(value: &Value) -> Option<f64> {
    value.as_str()?.parse().ok().filter(|number: &f64| number.is_finite())
}

fn guess(value: &Value) -> Option<Guess> {
    let numbers: Vec<f64> = value.as_array()?.iter().map(number).collect::<Option<_>>()?;
    let [a, b, c, x, y, z, g, r, s, t]: [f64; NUMBERS] = numbers.try_into().ok()?;
    Some(Guess { surface_albedo: [a, b, c], mfp: [x, y, z], g, radiance: [r, s, t] })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn progress_comes_back_to_the_last_bit() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.fit");
        let guess = Guess {
            surface_albedo: [0.1, 1.0 / 3.0, 0.7],
            mfp: [1e-9, 2.0, 1e7],
            g: -0.3,
            radiance: [1.0; 3],
        };
        let best = Some((Guess { g: 0.1 + 0.2, ..guess }, 1.0 / 7.0));
        for progress in [
            Progress { guess, best: None, steps: 0, retreats: 0 },
            Progress { guess, best, steps: 7, retreats: 2 },
        ] {
            save_progress(&path, "#1234", &progress).unwrap();
            let kept = load_progress(&path).unwrap();
            assert_eq!(kept.of(&path, "#1234").unwrap(), progress);
            let error = kept.of(&path, "#4321").unwrap_err();
            assert!(error.message.contains("another scene") && error.help.is_some(), "{error}");
        }
    }

    /// Whatever is missing or out of its range, there is an error and no panic.
    #[test]
    fn damaged_files_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.fit");
        let guess = Guess { surface_albedo: [0.5; 3], mfp: [1.0; 3], g: 0.0, radiance: [1.0; 3] };
        let progress = Progress { guess, best: Some((guess, 1.0)), steps: 1, retreats: 0 };
        save_progress(&path, "#1", &progress).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        for (from, to) in [
            ("\"steps\": 1", "\"steps\": 100000"),
            ("\"steps\": 1", "\"steps\": -1"),
            ("\"retreats\"", "\"retreat\""),
            ("\"0.5\"", "\"NaN\""),
            ("\"0.5\"", "0.5"),
            ("\"square\"", "\"squares\""),
            ("\"guess\"", "\"guesses\""),
            ("_fit\": 2", "_fit\": 1"),
            (KEY, "something_else"),
            ("}", ""),
        ] {
            assert!(text.contains(from), "{from}: {text}");
            fs::write(&path, text.replacen(from, to, 1)).unwrap();
            let error = load_progress(&path).and_then(|kept| kept.of(&path, "#1")).unwrap_err();
            assert!(error.help.is_some() && error.to_string().contains("a.fit"), "{error}");
        }
    }
}
