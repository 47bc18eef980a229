//! The command line as a whole: help, lists, completions, and words that are not its own.

use crate::common::{files, run, stderr, stdout};
use translucid_scene::SubsurfaceModel;

const VERBS: [&str; 16] = [
    "render",
    "profile",
    "sample",
    "reference",
    "stack",
    "fit",
    "compare",
    "convert",
    "export",
    "oracle",
    "judge",
    "skin",
    "view",
    "models",
    "devices",
    "completions",
];

#[test]
fn models_are_listed_a_line_each() {
    let folder = tempfile::tempdir().unwrap();
    let list = stdout(folder.path(), "models");
    let names: Vec<&str> = list.lines().map(|line| line.split_whitespace().next().unwrap()).collect();
    assert_eq!(names, SubsurfaceModel::ALL.map(|model| model.name()));
    for verb in ["render", "profile"] {
        let help = stdout(folder.path(), &format!("{verb} --help"));
        assert!(help.contains("translucid models") && !help.contains("Grosjean"), "{help}");
    }
}

#[test]
fn completions_are_for_every_shell_and_pages_for_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = stdout(folder.path(), &format!("completions {shell}"));
        assert!(VERBS.iter().all(|verb| script.contains(verb)) && script.contains("region"), "{shell}");
        assert!(!script.contains("--crop"), "{shell}");
    }
    stdout(folder.path(), "completions -o package");
    let written = files(&folder.path().join("package"));
    for name in [
        "_translucid",
        "_translucid.ps1",
        "translucid.bash",
        "translucid.elv",
        "translucid.fish",
        "translucid.1",
    ] {
        assert!(written.iter().any(|file| file == name), "{name}: {written:?}");
    }
    for verb in VERBS {
        let page = folder.path().join(format!("package/translucid-{verb}.1"));
        assert!(std::fs::read_to_string(page).unwrap().contains(".TH"), "{verb}");
    }
    for (words, part) in [
        ("completions", "--output"),
        ("completions tcsh", "powershell"),
        ("completions bash -o a", "cannot be used"),
    ] {
        let output = run(folder.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(part), "{words}: {}", stderr(&output));
    }
}

#[test]
fn short_help_is_short() {
    let folder = tempfile::tempdir().unwrap();
    let output = crate::common::translucid(folder.path())
        .args(["render", "-h"])
        .env("COLUMNS", "100")
        .output()
        .unwrap();
    let help = String::from_utf8(output.stdout).unwrap();
    let long = stdout(folder.path(), "render --help");
    assert!(help.lines().count() <= 55 && long.lines().count() > 120, "{help}");
}

#[test]
fn quiet_and_verbose_are_for_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let walk = "reference --method monte-carlo --surface-albedo 0.5 --photons 1e3 --at 1";
    let said = |words: &str| {
        let output = run(folder.path(), words);
        assert_eq!(output.status.code(), Some(0), "{words}: {}", stderr(&output));
        stderr(&output)
    };
    assert!(said(walk).contains("walked 1000 photons"));
    for words in [format!("{walk} -q"), format!("-q {walk}"), format!("{walk} --quiet")] {
        assert_eq!(said(&words), "", "{words}");
    }
    for verb in VERBS {
        let help = stdout(folder.path(), &format!("{verb} -h"));
        assert!(help.contains("--quiet") && help.contains("--verbose"), "{verb}");
    }
    assert_eq!(run(folder.path(), &format!("{walk} -q -v")).status.code(), Some(2));
}

#[test]
fn options_of_other_renderers_get_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    for (given, own) in
        [("--crop=0,0,1,1", "--region"), ("--resolution 3x4", "--size"), ("--model dipole", "--subsurface")]
    {
        let output = run(folder.path(), &format!("render {given}"));
        assert_eq!(output.status.code(), Some(2), "{given}");
        let message = stderr(&output);
        assert!(message.contains("unexpected argument") && message.contains(own), "{message}");
    }
}

/// A file in the place of a verb.
#[test]
fn files_without_a_verb_get_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "vase.stl");
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("translucid render vase.stl"), "{message}");
    let message = stderr(&run(folder.path(), "rendr"));
    assert!(message.contains("'render'"), "{message}");
}

/// The terminal's width alone breaks a paragraph, not the lines of the program's text besides.
#[test]
fn paragraphs_of_help_are_wrapped_once() {
    let folder = tempfile::tempdir().unwrap();
    let help = stdout(folder.path(), "fit --help");
    for part in ["minimizes the error. A polynomial of the form", "the file does not determine (error above"]
    {
        assert!(help.contains(part), "{help}");
    }
}

/// A disk that is full takes no help.
#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_printed_is_an_error() {
    let full = std::fs::File::create("/dev/full").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut command = crate::common::translucid(folder.path());
    assert_eq!(command.args(["render", "--help"]).stdout(full).status().unwrap().code(), Some(1));
}
