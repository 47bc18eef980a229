//! Warnings of one kind, of which a few are enough.

use std::collections::HashMap;

use translucid_scene::Warning;

/// Warnings of a kind that are kept.
const MOST: usize = 8;

/// Replaces all but the first warnings of each kind, from a number of them on, by their count.
///
/// Warnings are of one kind that differ in numbers, paths and what is quoted.
pub(super) fn count_kinds(warnings: &mut Vec<Warning>, from: usize) {
    if warnings.len() <= from + MOST {
        return;
    }
    let mut counts: HashMap<String, usize> = HashMap::new();
    let mut lasts = Vec::new();
    let mut number = 0;
    let mut kept = 0;
    warnings.retain(|warning| {
        number += 1;
        if number <= from {
            kept += 1;
            return true;
        }
        let kind = kind(&warning.message);
        let count = counts.entry(kind.clone()).or_insert(0);
        *count += 1;
        if *count == MOST {
            lasts.push((kept, kind));
        }
        kept += usize::from(*count <= MOST);
        *count <= MOST
    });
    for (at, kind) in lasts {
        if let Some(more) = counts.get(&kind).map(|count| count - MOST).filter(|&more| more > 0) {
            warnings[at].message += &format!(" (and {more} more like this)");
        }
    }
}

/// The message without what tells two of a kind apart.
fn kind(message: &str) -> String {
    let unquoted: String = message.split('"').step_by(2).collect();
    let is_path = |word: &&str| word.contains(['/', '\\']);
    let words = unquoted.split_whitespace().filter(|word| !is_path(word));
    words.flat_map(str::chars).filter(|c| !c.is_numeric()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_of_a_kind_are_counted_from_the_ninth_on() {
        let warning = |message: String| Warning { message, place: None };
        let mut warnings = vec![warning("before".into())];
        for i in 0..20 {
            warnings.push(warning(format!("there is no material \"m{i}\" in the library")));
            warnings.push(warning(format!("{} corners of another kind", i % 2)));
        }
        warnings.truncate(1 + 2 * 10);
        count_kinds(&mut warnings, 1);
        assert_eq!(warnings.len(), 1 + 2 * MOST);
        assert_eq!(warnings[15].message, "there is no material \"m7\" in the library (and 2 more like this)");
        assert_eq!(warnings[16].message, "1 corners of another kind (and 2 more like this)");
        let before = warnings.clone();
        count_kinds(&mut warnings, 9);
        assert_eq!(warnings, before);
    }
}
