//! Every wrong question that the descriptions give: the command refuses it by the option and what is allowed.

use translucid_desk::QUESTIONS;
use translucid_desk::wrong::{Wrong, wrong};
use translucid_words::{Content, Entry, Kind, Spelling, Value};

use crate::common::{stderr, translucid};

/// A value as the text of an option, if it can be one.
fn text(value: &Value) -> Option<String> {
    match &value.content {
        Content::Integer(_) | Content::Float(_) => Some(value.to_string()),
        Content::Text(text) => Some(text.clone()),
        Content::List(list) => Some(list.iter().map(text).collect::<Option<Vec<_>>>()?.join(",")),
        _ => None,
    }
}

/// The words of the command, where each value can be the text of an option: tables become files, right ones only.
fn words(wrong: &Wrong, directory: &std::path::Path, is_file: &dyn Fn(&str) -> bool) -> Option<Vec<String>> {
    let word = |entry: &Entry| match &entry.value.content {
        Content::Text(path) if is_file(&entry.key) => Some(path.clone()),
        Content::Table(keys) if entry.key != wrong.key => {
            let lines: Vec<String> = keys.iter().map(|key| format!("{key}\n")).collect();
            let file = format!("{}.toml", entry.key);
            std::fs::write(directory.join(&file), lines.concat()).unwrap();
            Some(file)
        }
        _ => Some(format!("{}={}", Spelling::Flags.of(&entry.key), text(&entry.value)?)),
    };
    wrong.said.iter().map(word).collect()
}

#[test]
fn wrong_questions_are_refused_by_their_options() {
    let directory = tempfile::tempdir().unwrap();
    let mut count = 0;
    for question in QUESTIONS {
        let keys = question.keys();
        // The file that a question is about is no option
        let is_file = |key: &str| {
            key == keys[0].name
                && keys[0].is_required
                && matches!(keys[0].kind, Kind::Document(_) | Kind::Path)
        };
        for wrong in wrong(question).into_iter().filter(|wrong| wrong.is_outermost && !is_file(wrong.key)) {
            let Some(words) = words(&wrong, directory.path(), &is_file) else { continue };
            let output = translucid(directory.path()).arg(question.name()).args(&words).output().unwrap();
            let (message, option) = (stderr(&output), Spelling::Flags.of(wrong.key));
            assert_eq!(output.status.code(), Some(2), "{} {words:?}: {message}", question.name());
            assert!(message.contains(&option), "{} {words:?}: {message}", question.name());
            assert!(
                ["must", "need", "allowed", "possible values", "unexpected value", "required"]
                    .iter()
                    .any(|word| message.contains(word)),
                "{} {words:?}: {message}",
                question.name()
            );
            count += 1;
        }
    }
    assert!(count > 10, "{count}");
}
