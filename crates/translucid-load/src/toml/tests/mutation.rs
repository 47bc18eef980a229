//! Damaged scene files: never a panic, always a scene or an error.

use std::path::Path;

use translucid_testing::{SplitMix, power};

use crate::{LoadOptions, SceneFile};

/// A scene that uses every part of the format and no file.
const SEED_SCENE: &str = include_str!("every_feature.toml");

/// Words that are likely to hurt.
const WORDS: [&str; 24] = [
    "nan",
    "-inf",
    "1e400",
    "-1",
    "0",
    "99999999999999999999",
    "1e-45",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "\"vertex\"",
    "[[object]]\n",
    "[object.x]\n",
    "shape = \"torus\"\n",
    "scale = 0.0\n",
    "=",
    "\n",
    "\\u0000",
    "ä",
    "0x",
    "true",
    "''",
];

pub(super) fn mutate(text: &str, random: &mut SplitMix) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(8) {
            0 => bytes[at] = random.bits() as u8 & 0x7f,
            1 => drop(bytes.drain(at..(at + random.below(40)).min(bytes.len()))),
            2 => drop(bytes.splice(at..at, WORDS[random.below(WORDS.len())].bytes())),
            3 => drop(bytes.splice(at..(at + 3).min(bytes.len()), WORDS[random.below(WORDS.len())].bytes())),
            // Digits stay digits, so that many files stay valid and some leave a range.
            5..=7 => {
                let digits: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
                if let Some(&at) = digits.get(random.below(digits.len())) {
                    bytes[at] = b'0' + random.below(10) as u8;
                }
            }
            _ => {
                let piece = bytes[at..(at + random.below(80)).min(bytes.len())].to_vec();
                let to = random.below(bytes.len());
                drop(bytes.splice(to..to, piece));
            }
        }
        if bytes.is_empty() {
            bytes.push(b'\n');
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn seed_scene_is_valid() {
    let scene = SceneFile::parse(SEED_SCENE, Path::new("seed.toml"));
    scene.unwrap_or_else(|error| panic!("{error}")).load(&LoadOptions::default(), &mut Vec::new()).unwrap();
}

#[test]
fn mutated_scenes_parse_or_say_where_not() {
    let mut random = SplitMix(1);
    let (mut valid, rounds) = (0, power(5_000));
    for round in 0..rounds {
        let text = mutate(SEED_SCENE, &mut random);
        match SceneFile::parse(&text, Path::new("mutated.toml")) {
            Ok(_) => valid += 1,
            Err(error) => {
                let place =
                    error.place.unwrap_or_else(|| panic!("round {round}: no place: {}", error.message));
                let (excerpt, span) = place.excerpt.unwrap();
                assert!(
                    excerpt.get(span.clone()).is_some(),
                    "round {round}: {span:?} is no part of the text"
                );
                assert!(!error.message.is_empty());
            }
        }
    }
    // Both sides are exercised.
    assert!((rounds / 20..rounds - rounds / 20).contains(&valid), "{valid} of {rounds} are valid");
}

#[test]
fn mutated_scenes_load_or_say_why_not() {
    let mut random = SplitMix(2);
    for round in 0..60 {
        let text = mutate(SEED_SCENE, &mut random);
        let Ok(file) = SceneFile::parse(&text, Path::new("mutated.toml")) else { continue };
        let Ok(scene) = file.load(&LoadOptions::default(), &mut Vec::new()) else { continue };
        assert_eq!(scene.validate(), Ok(()), "round {round}");
    }
}
