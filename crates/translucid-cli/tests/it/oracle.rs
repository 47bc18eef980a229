//! `oracle`: its files, and the tests of the page that are made with them.

#![allow(
    clippy::print_stdout,
    reason = "sizes, and what was not run, are for those who ask with --nocapture"
)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;

use serde_json::Value;

use crate::common::{files, run, signal, start, stderr};
use crate::markdown::{Code, Page, root};

const TABLES: [&str; 8] = ["disk", "edge", "inversion", "line", "profile", "slabs", "spheres", "totals"];

/// A directory with the tables `oracle/…`, made once for all tests; those of walks by few photons.
static MADE: LazyLock<(tempfile::TempDir, Output)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "oracle -o oracle --photons 1000");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    (folder, output)
});

fn read(name: &str) -> String {
    fs::read_to_string(MADE.0.path().join("oracle").join(name)).unwrap()
}

/// Rows of a CSV file by the names of its columns.
fn rows(name: &str) -> Vec<Vec<(String, String)>> {
    let text = read(name);
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), names.len(), "{name}: {line}");
        names.iter().zip(cells).map(|(name, cell)| ((*name).to_owned(), cell.to_owned())).collect()
    };
    lines.map(row).collect()
}

/// Whether a value is as the schema says, as far as the schema of these files goes.
fn assert_follows(value: &Value, schema: &Value, place: &str) {
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        other => panic!("{other}"),
    };
    for (keyword, rule) in schema.as_object().unwrap() {
        match keyword.as_str() {
            "type" => {
                let names = rule.as_array().cloned().unwrap_or_else(|| vec![rule.clone()]);
                assert!(
                    names.iter().any(|name| is(name.as_str().unwrap())),
                    "{place} is {value}, not {rule}"
                );
            }
            "const" => assert_eq!(value, rule, "{place}"),
            "enum" => assert!(rule.as_array().unwrap().contains(value), "{place}: {value}"),
            "required" => {
                for name in rule.as_array().unwrap() {
                    assert!(value.get(name.as_str().unwrap()).is_some(), "{place} has no {name}");
                }
            }
            "properties" => {
                for (name, own) in value.as_object().unwrap() {
                    let rule = rule.get(name).unwrap_or_else(|| panic!("{place} has {name}"));
                    assert_follows(own, rule, &format!("{place}.{name}"));
                }
            }
            "items" => {
                for (i, own) in value.as_array().unwrap().iter().enumerate() {
                    assert_follows(own, rule, &format!("{place}[{i}]"));
                }
            }
            "additionalProperties" | "$schema" | "title" | "description" => {}
            other => panic!("the schema has {other}"),
        }
    }
}

#[test]
fn files_follow_the_schema_and_say_what_makes_them() {
    let mut expected: Vec<String> =
        TABLES.iter().flat_map(|name| ["csv", "json"].map(|end| format!("{name}.{end}"))).collect();
    expected.push("schema.json".into());
    expected.sort();
    let folder = MADE.0.path().join("oracle");
    assert_eq!(files(&folder), expected);
    let bytes: u64 = expected.iter().map(|name| fs::metadata(folder.join(name)).unwrap().len()).sum();
    println!("{bytes} bytes");
    assert!(bytes < 5_000_000, "{bytes}");

    let schema: Value = serde_json::from_str(&read("schema.json")).unwrap();
    for name in TABLES {
        let table: Value = serde_json::from_str(&read(&format!("{name}.json"))).unwrap();
        assert_follows(&table, &schema, name);
        assert_eq!(table["version"], env!("CARGO_PKG_VERSION"));
        assert_eq!(table["command"], format!("translucid oracle --only {name} --photons 1000 -o DIR"));
        // Both files have the same numbers
        let columns: Vec<&str> = table["columns"]
            .as_array()
            .unwrap()
            .iter()
            .map(|column| column["name"].as_str().unwrap())
            .collect();
        let csv = rows(&format!("{name}.csv"));
        let json = table["rows"].as_array().unwrap();
        assert!(csv.len() == json.len() && csv.len() > 50, "{name}: {}", csv.len());
        for (row, values) in csv.iter().zip(json) {
            assert!(row.iter().map(|(name, _)| name.as_str()).eq(columns.iter().copied()), "{name}");
            for ((_, cell), value) in row.iter().zip(values.as_array().unwrap()) {
                match value {
                    Value::Number(number) => {
                        // This parser of JSON may miss by the last digit
                        let [a, b] = [cell.parse().unwrap(), number.as_f64().unwrap()];
                        assert!((a - b).abs() <= 1e-15 * f64::abs(a), "{name}: {a} {b}");
                    }
                    Value::String(word) => assert_eq!(cell, word),
                    _ => assert!(cell.is_empty() && value.is_null(), "{name}: {cell}"),
                }
            }
        }
    }
}

#[test]
fn tables_are_made_again_with_the_same_bytes_and_spare_files_of_others() {
    let folder = tempfile::tempdir().unwrap();
    let words = "oracle -o again --photons 1000 --only slabs,totals --threads 1";
    assert_eq!(run(folder.path(), words).status.code(), Some(0));
    // Over its own files
    assert_eq!(run(folder.path(), &words.replace("slabs,", "")).status.code(), Some(0));
    let again = folder.path().join("again");
    assert_eq!(files(&again), ["schema.json", "slabs.csv", "slabs.json", "totals.csv", "totals.json"]);
    for name in files(&again) {
        assert!(fs::read_to_string(again.join(&name)).unwrap() == read(&name), "{name}");
    }
    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(folder.path().join("mine/edge.csv"), "mine").unwrap();
    let output = run(folder.path(), "oracle -o mine --only edge");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("was not made by translucid oracle"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(folder.path().join("mine/edge.csv")).unwrap(), "mine");
    assert_eq!(files(folder.path()), ["again", "mine"]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_oracle_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let output = signal(start(folder.path(), "oracle -o tables --photons 1e10"), "-INT", || true);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(files(folder.path()).is_empty(), "{:?}", files(folder.path()));
}

/// The page's table has the file's numbers, to three digits.
#[test]
fn page_shows_the_table_of_edges() {
    let text = fs::read_to_string(root().join("docs/guide/oracle.md")).unwrap();
    let lines =
        text.lines().skip_while(|line| *line != "<!-- measured: translucid oracle --only edge -->").skip(3);
    let all = rows("edge.csv");
    let mut count = 0;
    for line in lines.take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        for (a, shown) in ["0.5", "0.8", "0.9", "0.95"].iter().zip(&cells[1..]) {
            let wanted = ["diffuse", "0", "1", *a];
            let is_row = |row: &&Vec<(String, String)>| {
                let same = row.iter().zip(wanted).all(|((_, cell), wanted)| cell == wanted);
                let distance: f64 = row[5].1.parse().unwrap();
                same && (distance / cells[0].parse::<f64>().unwrap() - 1.0).abs() < 1e-9
            };
            let row = all.iter().find(is_row).unwrap_or_else(|| panic!("{a} {line}"));
            assert_eq!(format!("{:.3}", row[6].1.parse::<f64>().unwrap()), **shown, "A = {a}: {line}");
            count += 1;
        }
    }
    assert_eq!(count, 24);
}

/// The page's code in a language.
fn snippet(language: &str) -> String {
    let code: Vec<Code> = Page::read(&root().join("docs/guide/oracle.md")).code();
    code.iter().find(|block| block.language == language).unwrap().lines.join("\n")
}

fn has(program: &str) -> bool {
    Command::new(program).arg("--help").output().is_ok()
}

/// Runs a snippet with a pass that is right, the table itself, and with one that is too dark.
fn assert_tells(folder: &Path, run: impl Fn(f64) -> Output) {
    for (factor, is_right) in [(1.0, true), (0.9, false)] {
        let output = run(factor);
        let words = format!("{}{}", String::from_utf8_lossy(&output.stdout), stderr(&output));
        assert_eq!(output.status.success(), is_right, "{factor} in {}: {words}", folder.display());
    }
}

/// The distances and values of the table that the snippets test with, as text.
fn knots() -> Vec<[String; 2]> {
    let is_wanted = |row: &Vec<(String, String)>| {
        row.iter().zip(["diffuse", "0", "1", "0.8"]).all(|((_, cell), wanted)| cell == wanted)
    };
    let wanted = rows("edge.csv").into_iter().filter(is_wanted);
    let knots: Vec<[String; 2]> = wanted.map(|row| [row[5].1.clone(), row[6].1.clone()]).collect();
    assert_eq!(knots.len(), 41);
    knots
}

#[test]
fn python_of_the_page_tells_right_from_wrong() {
    if !has("python3") {
        return println!("there is no python3: not run");
    }
    let folder = MADE.0.path();
    assert_tells(folder, |factor| {
        let knots: Vec<String> = knots().iter().map(|[x, dark]| format!("({x}, {dark})")).collect();
        let pass = format!(
            "knots = [{}]\ndef dark(x):\n    return {factor} * min(knots, key=lambda knot: abs(knot[0] - x))[1]\n",
            knots.join(", ")
        );
        fs::write(folder.join("my_pass.py"), pass).unwrap();
        let mut command = Command::new("python3");
        command
            .current_dir(folder)
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .args(["-c", &snippet("python")])
            .output()
            .unwrap()
    });
}

/// A function of the nearest knot in a language with C's operators.
fn nearest(knots: &[[String; 2]], factor: f64, line: impl Fn(&str, &str) -> String) -> String {
    let lines: Vec<String> = knots.iter().map(|[x, dark]| line(x, dark)).collect();
    lines.join("\n").replace("FACTOR", &format!("{factor:.1}"))
}

#[test]
fn go_of_the_page_tells_right_from_wrong() {
    if !has("go") {
        return println!("there is no go: not run");
    }
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("oracle")).unwrap();
    fs::write(folder.path().join("oracle/edge.csv"), read("edge.csv")).unwrap();
    fs::write(folder.path().join("go.mod"), "module pass\n\ngo 1.19\n").unwrap();
    fs::write(folder.path().join("edge_test.go"), snippet("go")).unwrap();
    assert_tells(folder.path(), |factor| {
        let body = nearest(&knots(), factor, |x, dark| {
            format!("\tif math.Abs(x/{x}-1) < 1e-6 {{ return FACTOR * {dark} }}")
        });
        let pass = format!(
            "package pass\n\nimport \"math\"\n\nfunc Dark(x float64) float64 {{\n{body}\n\treturn 9\n}}\n"
        );
        fs::write(folder.path().join("pass.go"), pass).unwrap();
        let mut command = Command::new("go");
        command
            .current_dir(folder.path())
            .env("GOCACHE", folder.path().join("cache"))
            .env("GOFLAGS", "-mod=mod");
        command.args(["test", "./..."]).output().unwrap()
    });
}

/// A table that has no such row is no proof.
#[test]
fn go_of_the_page_fails_without_rows() {
    if !has("go") {
        return println!("there is no go: not run");
    }
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("oracle")).unwrap();
    let head = read("edge.csv").lines().next().unwrap().to_owned();
    fs::write(folder.path().join("oracle/edge.csv"), head + "\n").unwrap();
    fs::write(folder.path().join("go.mod"), "module pass\n\ngo 1.19\n").unwrap();
    fs::write(folder.path().join("edge_test.go"), snippet("go")).unwrap();
    fs::write(folder.path().join("pass.go"), "package pass\n\nfunc Dark(x float64) float64 { return 9 }\n")
        .unwrap();
    let mut command = Command::new("go");
    command.current_dir(folder.path()).env("GOCACHE", folder.path().join("cache")).env("GOFLAGS", "-mod=mod");
    let output = command.args(["test", "./..."]).output().unwrap();
    let words = String::from_utf8_lossy(&output.stdout);
    assert!(!output.status.success() && words.contains("no row of edge.csv"), "{words}");
}

#[test]
fn csharp_of_the_page_tells_right_from_wrong() {
    if !has("mcs") || !has("mono") {
        return println!("there is no mono: not run");
    }
    let folder = MADE.0.path();
    assert_tells(folder, |factor| {
        let body = nearest(&knots(), factor, |x, dark| {
            format!("if (Math.Abs(x/{x}-1) < 1e-6) return FACTOR * {dark};")
        });
        let pass = format!(
            "using System; static class Pass {{ public static double Dark(double x) {{ {body} return 9; }} }}"
        );
        fs::write(folder.join("Pass.cs"), pass).unwrap();
        fs::write(folder.join("EdgeTest.cs"), snippet("csharp")).unwrap();
        let mut command = Command::new("mcs");
        let made =
            command.current_dir(folder).args(["-out:edge.exe", "EdgeTest.cs", "Pass.cs"]).output().unwrap();
        assert!(made.status.success(), "{}", stderr(&made));
        Command::new("mono").current_dir(folder).arg("edge.exe").output().unwrap()
    });
}

#[test]
fn glsl_of_the_page_is_valid() {
    if !has("glslangValidator") {
        return println!("there is no glslangValidator: not run");
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("edge.frag"), snippet("glsl")).unwrap();
    let mut command = Command::new("glslangValidator");
    let output =
        command.current_dir(folder.path()).args(["-V", "edge.frag", "-o", "edge.spv"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
