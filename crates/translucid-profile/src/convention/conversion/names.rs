//! Names of systems, and what a misspelt one may have meant.

use crate::InputError;
use crate::convention::System;

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
    Err(InputError::new(message).with_help(advice(name, &conversion_system_names())))
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
    // The distance takes time in the product of both lengths
    if name.is_empty() || name.len() > 100 {
        return Vec::new();
    }
    let beginning: Vec<_> = known.iter().copied().filter(|n| n.to_lowercase().starts_with(&name)).collect();
    if !beginning.is_empty() {
        return beginning;
    }
    let distance = |n: &str| strsim::damerau_levenshtein(&name, &n.to_lowercase());
    let near = known.iter().map(|n| (distance(n), *n)).min_by_key(|&(d, _)| d);
    near.filter(|&(d, _)| d <= (name.chars().count() / 3).max(1)).map(|(_, n)| n).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meant_finds_slips_and_beginnings() {
        let known = ["renderman", "cycles-burley", "cycles-skin"];
        assert_eq!(meant("Rendermann", &known), ["renderman"]);
        assert_eq!(meant("cycles", &known), ["cycles-burley", "cycles-skin"]);
        assert!(meant("maya", &known).is_empty() && meant("", &known).is_empty());
        assert!(meant(&"x".repeat(1_000_000), &known).is_empty());
    }
}
