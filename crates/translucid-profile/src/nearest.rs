//! The nearest valid name, for "did you mean".

/// The candidate that a misspelt `name` most likely stands for, if any is near enough.
///
/// Distance is the number of inserted, lost, changed or swapped letters, at most a third of the
/// name's length and at least one.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // The distance takes time and memory in the product of both lengths.
    if name.len() > 100 {
        return None;
    }
    let name = normalized(name);
    let limit = |candidate: &str| (name.chars().count().max(candidate.chars().count()) / 3).max(1);
    candidates
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(&name, &normalized(candidate)), candidate))
        .filter(|&(distance, candidate)| distance <= limit(candidate))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

fn normalized(name: &str) -> String {
    name.to_lowercase().replace([' ', '_'], "-")
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn nearest_finds_slips_of_the_pen() {
        let names = ["position", "target", "fov"];
        assert_eq!(nearest("positon", names), Some("position"));
        assert_eq!(nearest("Target", names), Some("target"));
        assert_eq!(nearest("vof", names), None);
        assert_eq!(nearest("fv", names), Some("fov"));
        assert_eq!(nearest("mabel", ["marble", "milk"]), Some("marble"));
        assert_eq!(nearest("", names), None);
        assert_eq!(nearest(&"x".repeat(1_000_000), names), None);
    }
}
