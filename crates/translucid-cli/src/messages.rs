//! Messages on stderr, with the excerpt of the file that they are about; for programs as JSON, an object a line.

use std::io::{self, IsTerminal, Write};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use annotate_snippets::{AnnotationKind, Element, Group, Level, Origin, Renderer, Snippet};
use serde_json::{Value, json};
use translucid_scene::{Place, Warning};

use crate::failure::{Failure, FailureKind};

/// Excerpts of warnings that are printed before the rest is only counted.
const WARNINGS_SHOWN: usize = 20;

/// Whether a program reads the messages.
static IS_JSON: AtomicBool = AtomicBool::new(false);

/// From now on messages are JSON, or words.
pub(crate) fn speak_json(is_json: bool) {
    IS_JSON.store(is_json, Ordering::Relaxed);
}

/// Whether messages are JSON.
pub(crate) fn is_json() -> bool {
    IS_JSON.load(Ordering::Relaxed)
}

/// How much is printed besides results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Verbosity {
    /// Errors, warnings and notes.
    Quiet,
    Usual,
    Verbose,
}

static VERBOSITY: AtomicU8 = AtomicU8::new(Verbosity::Usual as u8);

/// From now on as much is printed.
pub(crate) fn set_verbosity(verbosity: Verbosity) {
    VERBOSITY.store(verbosity as u8, Ordering::Relaxed);
}

/// Whether only errors, warnings and notes are printed.
pub(crate) fn is_quiet() -> bool {
    VERBOSITY.load(Ordering::Relaxed) == Verbosity::Quiet as u8
}

/// Whether what takes how long is printed.
pub(crate) fn is_verbose() -> bool {
    VERBOSITY.load(Ordering::Relaxed) == Verbosity::Verbose as u8
}

/// Prints an object with the name of an event, if a program reads the messages.
pub(crate) fn event(name: &str, mut fields: Value) {
    if is_json() {
        fields["event"] = name.into();
        // Nobody is left to be told when stderr is closed.
        let _ = writeln!(io::stderr().lock(), "{fields}");
    }
}

/// Prints why a verb failed and what to do about it.
pub(crate) fn print_failure(failure: &Failure) {
    let weight = if failure.kind == FailureKind::Interrupted { Weight::Warning } else { Weight::Error };
    print(weight, &failure.message, failure.place.as_ref(), failure.help.as_deref());
}

/// Prints what a loader repaired or left out, and how many such warnings there are.
pub(crate) fn print_warnings(warnings: &[Warning]) {
    for warning in warnings.iter().take(WARNINGS_SHOWN) {
        print(Weight::Warning, &warning.message, warning.place.as_ref(), None);
    }
    match warnings.len() {
        0 => {}
        1 => put("1 warning"),
        count if count > WARNINGS_SHOWN => {
            put(&format!("{count} warnings, the first {WARNINGS_SHOWN} above"));
        }
        count => put(&format!("{count} warnings")),
    }
}

/// Prints what went wrong without ending the work.
pub(crate) fn print_warning(message: &str) {
    print(Weight::Warning, message, None, None);
}

/// Prints something worth knowing that needs no action.
pub(crate) fn print_note(message: &str) {
    print(Weight::Note, message, None, None);
}

/// Prints a plain line, unless it is to be quiet.
pub(crate) fn line(text: &str) {
    if !is_quiet() {
        put(text);
    }
}

fn put(text: &str) {
    if is_json() {
        return event("message", json!({ "text": text.trim() }));
    }
    // Nobody is left to be told when stderr is closed.
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Whether stderr shows colors and can be redrawn.
pub(crate) fn is_interactive() -> bool {
    !is_json() && io::stderr().is_terminal()
}

/// Weight of a message, as the name of its event.
#[derive(Clone, Copy)]
enum Weight {
    Error,
    Warning,
    Note,
}

fn print(weight: Weight, message: &str, place: Option<&Place>, help: Option<&str>) {
    let (name, level) = match weight {
        Weight::Error => ("error", Level::ERROR),
        Weight::Warning => ("warning", Level::WARNING),
        Weight::Note => ("note", Level::NOTE),
    };
    if is_json() {
        let place = place.map(ToString::to_string);
        return event(name, json!({ "text": message, "place": place, "help": help }));
    }
    let colored = is_interactive() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let renderer = if colored { Renderer::styled() } else { Renderer::plain() };
    put(&format(&renderer, level, message, place, help));
}

fn format(
    renderer: &Renderer,
    level: Level<'_>,
    message: &str,
    place: Option<&Place>,
    help: Option<&str>,
) -> String {
    let mut report: Group<'_> = level.primary_title(printable(message)).elements(place.map(excerpt));
    if let Some(help) = help {
        report = report.element(Level::HELP.message(printable(help)));
    }
    renderer.render(&[report])
}

/// The part of the file that a message is about, or at least its name.
fn excerpt(place: &Place) -> Element<'_> {
    match &place.excerpt {
        Some((text, span)) if !text.is_empty() => Snippet::source(&**text)
            .path(printable(&place.path.display().to_string()))
            .annotation(AnnotationKind::Primary.span(within(text, span)))
            .into(),
        _ => Origin::path(printable(&place.to_string())).into(),
    }
}

/// The span cut to the text and widened to whole characters.
fn within(text: &str, span: &Range<usize>) -> Range<usize> {
    let mut start = span.start.min(text.len());
    let mut end = span.end.clamp(start, text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    while !text.is_char_boundary(end) {
        end += 1;
    }
    start..end
}

/// The text without control characters: names from files must not command a terminal.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;

    #[test]
    fn message_shows_the_line_and_the_help() {
        let text: Arc<str> = Arc::from("unit = \"mm\"\nseeed = 3\n");
        let place = Place::span(Path::new("a.toml"), &text, 12..17);
        let shown = format(
            &Renderer::plain(),
            Level::ERROR,
            "unknown key",
            Some(&place),
            Some("did you mean `seed`?"),
        );
        for part in ["error: unknown key", "a.toml:2:1", "seeed = 3", "^^^^^", "help: did you mean `seed`?"] {
            assert!(shown.contains(part), "{part} is missing in\n{shown}");
        }
    }

    #[test]
    fn message_names_the_part_of_a_binary_file() {
        let place = Place::part(Path::new("a.glb"), "accessor 3");
        let shown = format(&Renderer::plain(), Level::ERROR, "too short", Some(&place), None);
        assert!(shown.contains("a.glb, accessor 3"), "{shown}");
    }

    #[test]
    fn message_survives_spans_that_do_not_fit() {
        let text: Arc<str> = Arc::from("ä = 1");
        for span in [0..1, 1..1, 1..99, 50..60, usize::MAX..usize::MAX] {
            let place = Place {
                path: "a.toml".into(),
                line: None,
                excerpt: Some((Arc::clone(&text), span)),
                part: None,
            };
            let shown = format(&Renderer::plain(), Level::ERROR, "odd", Some(&place), None);
            for part in ["error: odd", "a.toml:1:", "ä = 1"] {
                assert!(shown.contains(part), "{part} is missing in\n{shown}");
            }
        }
    }

    #[test]
    fn message_disarms_control_characters() {
        let place = Place::file(Path::new("\u{1b}[2Ja.toml"));
        let shown = format(&Renderer::plain(), Level::ERROR, "\u{1b}[31mred\u{7}", Some(&place), None);
        assert!(!shown.contains('\u{1b}') && !shown.contains('\u{7}'), "{shown:?}");
    }
}
