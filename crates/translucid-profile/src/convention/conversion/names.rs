//! Names of systems, and what a misspelt one may have meant.

use crate::convention::System;
use crate::{InputError, nearest};

/// Names of all systems that materials are converted between, each once.
pub fn conversion_system_names() -> Vec<&'static str> {
    let mut names: Vec<_> = System::ALL.iter().map(|system| system.name).collect();
    names.dedup();
    names
}

/// The ways to specify a material in the system of a name.
pub(super) fn systems(argument: &str, name: &str) -> Result<Vec<&'static System>, InputError> {
    let found: Vec<_> = System::named(name).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let message = format!("{argument} names the system \"{name}\", which is not known");
    let known = conversion_system_names();
    let help = match meant_by_version_or_title(name) {
        Some(meant) if self::meant(name, &known).len() < 2 => {
            format!("did you mean {meant}? Known are {}", known.join(", "))
        }
        _ => advice(name, &known),
    };
    Err(InputError::new(message).with_help(help))
}

/// Systems with their versions, for a name with a version that is not known, or a word of their titles.
fn meant_by_version_or_title(name: &str) -> Option<String> {
    let name = name.to_lowercase();
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit() || ".-_ ".contains(c));
    if base.is_empty() || name.len() > 100 {
        return None;
    }
    let is_meant = |system: &&System| {
        let of_title = |word: &str| word.to_lowercase() == base;
        base.len() < name.len() && system.name.starts_with(base)
            || system.title.split([' ', ',']).any(of_title)
    };
    let mut found: Vec<String> = System::ALL
        .iter()
        .filter(is_meant)
        .map(|system| format!("{} ({})", system.name, system.version))
        .collect();
    found.dedup();
    (!found.is_empty()).then(|| found.join(" or "))
}

/// "did you mean", and all there is.
pub(super) fn advice(name: &str, known: &[&str]) -> String {
    let list = known.join(", ");
    match meant(name, known).as_slice() {
        [] => format!("known are {list}"),
        names => format!("did you mean {}? Known are {list}", names.join(" or ")),
    }
}

/// Names that begin with what was written, else the nearest if it is near.
fn meant<'a>(name: &str, known: &[&'a str]) -> Vec<&'a str> {
    let name = name.to_lowercase();
    if name.is_empty() {
        return Vec::new();
    }
    let beginning: Vec<_> = known.iter().copied().filter(|n| n.to_lowercase().starts_with(&name)).collect();
    if !beginning.is_empty() {
        return beginning;
    }
    nearest(&name, known.iter().copied()).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_and_titles_lead_to_their_systems() {
        let of = |name: &str| meant_by_version_or_title(name).unwrap_or_default();
        assert!(of("unreal-5.2").starts_with("unreal (5.1 and later) or unreal-5.0 (5.0 and before)"));
        assert!(of("Blender").contains("cycles-walk (5.2 and 5.3)") && of("Blender").contains("eevee (3.x"));
        assert_eq!(of("unity"), "hdrp (since 2018)");
        assert_eq!(of("maya") + &of("") + &of("5.2") + &of(&"x".repeat(1000)), "");
        let message = systems("from", "rendermann").unwrap_err().help.unwrap();
        assert!(message.starts_with("did you mean renderman? Known are"), "{message}");
    }

    #[test]
    fn meant_finds_slips_and_beginnings() {
        let known = ["renderman", "cycles-burley", "cycles-skin"];
        assert_eq!(meant("Rendermann", &known), ["renderman"]);
        assert_eq!(meant("cycles", &known), ["cycles-burley", "cycles-skin"]);
        assert!(meant("maya", &known).is_empty() && meant("", &known).is_empty());
        assert!(meant(&"x".repeat(1_000_000), &known).is_empty());
    }
}
