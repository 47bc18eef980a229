//! Every dependency of the workspace has its reason in ARCHITECTURE.md, and every reason a dependency.

use std::collections::BTreeSet;

use crate::imports;

fn read(name: &str) -> String {
    std::fs::read_to_string(imports::crates().join("..").join(name)).unwrap()
}

/// Names of the crates from elsewhere in a `Cargo.toml`.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let section = manifest.split("[workspace.dependencies]").nth(1).unwrap_or_default();
    let lines = section.lines().skip(1).take_while(|line| !line.starts_with('['));
    let names = lines.filter_map(|line| line.split_once('=')).map(|(name, _)| name.trim().to_owned());
    names.filter(|name| !name.starts_with("translucid-") && !name.starts_with('#')).collect()
}

/// Names in the first column of the table behind "Each has to earn its line".
fn reasons(page: &str) -> BTreeSet<String> {
    let section = page.split("## Dependencies").nth(1).unwrap_or_default();
    let table = section.lines().skip_while(|line| !line.starts_with("|---")).skip(1);
    let rows = table.take_while(|line| line.starts_with('|')).filter_map(|line| line.split('|').nth(1));
    let names = rows.flat_map(|cell| cell.trim().trim_end_matches(" (tests only)").split(", "));
    names.map(str::to_owned).collect()
}

#[test]
fn dependencies_have_their_reasons() {
    assert_eq!(dependencies(&read("Cargo.toml")), reasons(&read("ARCHITECTURE.md")));
}

#[test]
fn dependencies_are_used() {
    let manifests: Vec<String> =
        imports::crate_names().iter().map(|name| read(&format!("crates/{name}/Cargo.toml"))).collect();
    let is_used =
        |name: &String| manifests.iter().any(|text| text.contains(&format!("\n{name}.workspace = true")));
    let unused: Vec<String> =
        dependencies(&read("Cargo.toml")).into_iter().filter(|name| !is_used(name)).collect();
    assert!(unused.is_empty(), "{unused:?}");
}

/// Crates of the workspace that a crate depends on outside of its tests, without `translucid-`.
fn known(name: &str) -> BTreeSet<String> {
    let manifest = read(&format!("crates/{name}/Cargo.toml"));
    // Those of some targets only, too
    let is_of_code = |section: &&str| {
        let head = section.lines().next().unwrap_or_default();
        head == "dependencies]" || head.starts_with("target.") && head.ends_with(".dependencies]")
    };
    let sections = manifest.split("\n[").filter(is_of_code);
    let lines = sections.flat_map(|section| section.lines().skip(1));
    let names = lines.filter_map(|line| line.strip_prefix("translucid-")?.split('.').next());
    names.map(str::to_owned).collect()
}

#[test]
fn crates_know_those_that_the_table_says() {
    let page = read("ARCHITECTURE.md");
    for name in imports::crate_names() {
        let row = page.lines().find(|line| line.starts_with(&format!("| `{name}` |")));
        let cell = row.and_then(|row| row.split('|').nth(3)).unwrap_or_else(|| panic!("no row for {name}"));
        let said: BTreeSet<String> = match cell.trim() {
            "–" => BTreeSet::new(),
            "all" => imports::crate_names()
                .iter()
                .map(|name| name.trim_start_matches("translucid-").to_owned())
                .filter(|other| !["cli", "testing"].contains(&other.as_str()))
                .collect(),
            names => names.split(", ").map(str::to_owned).collect(),
        };
        assert_eq!(known(&name), said, "{name}");
    }
}
