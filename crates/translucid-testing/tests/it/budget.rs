//! Every crate has a budget of lines of code, so that the workspace grows on purpose.
//!
//! A commit that needs more says why, and raises the number of its crate here.

#![allow(clippy::print_stdout, reason = "the counts are for those who ask with --nocapture")]

use crate::imports;

/// Crates with the lines of code that each may have: without tests, comments and empty lines.
const BUDGETS: [(&str, usize); 21] = [
    ("translucid-broken-scenes", 400),
    ("translucid-capi", 1800),
    ("translucid-cli", 9900),
    ("translucid-display", 100),
    ("translucid-export", 2850),
    ("translucid-files", 200),
    ("translucid-fit", 1400),
    ("translucid-gpu", 920),
    ("translucid-image", 800),
    ("translucid-laboratory", 7130),
    ("translucid-load", 12800),
    ("translucid-measure", 4150),
    ("translucid-profile", 8590),
    ("translucid-python", 5270),
    ("translucid-reference", 10990),
    ("translucid-render", 19260),
    ("translucid-scene", 3930),
    ("translucid-shapes", 2140),
    ("translucid-testing", 200),
    ("translucid-view", 3560),
    ("translucid-wasm", 680),
];

#[test]
fn crates_are_within_their_budgets() {
    let counts: Vec<(String, usize)> = imports::crate_names()
        .into_iter()
        .map(|name| (name.clone(), imports::lines_of_code(&name)))
        .collect();
    let mut faults = String::new();
    for (name, count) in &counts {
        let budget = BUDGETS.iter().find(|(known, _)| known == name).map_or(0, |(_, budget)| *budget);
        println!("{name:24} {count:6} of {budget:6}");
        if *count > budget {
            faults += &format!("{name} has {count} lines of code, but may have {budget}\n");
        }
    }
    let (count, budget) =
        (counts.iter().map(|(_, count)| count).sum::<usize>(), BUDGETS.map(|(_, b)| b).iter().sum::<usize>());
    println!("{:24} {count:6} of {budget:6}", "all");
    assert!(faults.is_empty(), "\n{faults}");
}

#[test]
fn code_is_told_from_comments_and_tests() {
    let text = "//! Head\n\n/// Doc\npub fn f() -> &'static str {\n    // Why\n    \"two\n lines\"\n}\n\n#[cfg(test)]\nmod tests {\n    \
                fn g() {}\n}\n";
    assert_eq!(imports::lines_of_code_in(text), 4);
}
