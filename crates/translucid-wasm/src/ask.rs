//! Questions of the desk: JavaScript's values to the desk's, and its answer as JSON.

use std::sync::atomic::AtomicBool;

use serde_json::{Map, Value as Json, json};
use translucid_desk::{Answer, Control, QUESTIONS, Unanswered};
use translucid_words::{Cell, Content, Described, Entry, Kind, Provenance, Spelling, Value};

use crate::options::Options;

/// Answers a question: its columns, text, pictures, notes and warnings.
pub(crate) fn ask(mut options: Options) -> Result<Json, String> {
    let name = options.text("question")?.unwrap_or_default();
    let question = QUESTIONS.into_iter().find(|question| question.name() == name);
    let question = question.ok_or_else(|| format!("there is no question {name:?}"))?;
    let said = options.take("said").unwrap_or_else(|| json!({}));
    let entries = match value(said, Some(&Kind::Table(question.keys()))).content {
        Content::Table(entries) => entries,
        _ => return Err(String::from("options must be an object")),
    };
    let source = Provenance::part("").of("the question").spelled(Spelling::Camel);
    let prepared = question.read(&source, &entries).map_err(|error| told(&error))?;
    let control = Control { call: "", stop: &AtomicBool::new(false), progress: &|_| {} };
    let answer = prepared.answer(&control).map_err(|reason| match reason {
        Unanswered::Input(error) | Unanswered::Work(error) => told(&error),
        Unanswered::Stopped => String::from("the work was stopped"),
    })?;
    Ok(shown(&answer))
}

fn told(error: &translucid_words::Error) -> String {
    error.help.as_ref().map_or(error.message.clone(), |help| format!("{} ({help})", error.message))
}

fn shown(answer: &Answer) -> Json {
    let number = |cell: Option<&Cell>| match cell {
        Some(Cell::Number(number)) if number.is_finite() => json!(number),
        Some(Cell::Word(word)) => json!(word),
        _ => Json::Null,
    };
    let columns = answer.tables.first().map_or(json!({}), |table| {
        let column = |(i, named): (usize, &translucid_words::Column)| {
            let cells: Vec<Json> = table.rows.iter().map(|row| number(row.get(i))).collect();
            (named.name.to_string(), Json::from(cells))
        };
        table.columns.iter().enumerate().map(column).collect::<Map<_, _>>().into()
    });
    let svg = answer.files.iter().find(|file| file.name.ends_with(".svg"));
    let notes = [&answer.notes[..], &answer.remarks].concat();
    json!({
        "columns": columns,
        "text": answer.text,
        "svg": svg.map(|file| String::from_utf8_lossy(&file.bytes)),
        "notes": notes,
        "warnings": answer.warnings,
    })
}

/// A value of JavaScript's: a number is `#` and its digits, a text `'` and itself.
fn value(json: Json, kind: Option<&Kind>) -> Value {
    match json {
        Json::Bool(flag) => flag.into(),
        Json::String(text) => {
            match (text.strip_prefix('#').map(str::parse::<f64>), text.strip_prefix('\'')) {
                (Some(Ok(number)), _) => whole_or_not(number),
                (_, Some(text)) => text.into(),
                _ => text.as_str().into(),
            }
        }
        Json::Array(list) => list_of(list, kind),
        Json::Object(object) => {
            let keys: &[Described] = match kind {
                Some(Kind::Table(keys) | Kind::Document(keys)) => keys,
                _ => &[],
            };
            let entry = |(name, json): (String, Json)| {
                let known = keys.iter().find(|key| Spelling::Camel.of(key.name) == name);
                Entry::new(known.map_or(&name, |key| key.name), value(json, known.map(|key| &key.kind)))
            };
            object.into_iter().map(entry).collect::<Vec<Entry>>().into()
        }
        Json::Number(number) => number.as_f64().unwrap_or(f64::NAN).into(),
        Json::Null => Content::Other("null").into(),
    }
}

/// JavaScript knows no whole numbers; those that are have no point.
fn whole_or_not(number: f64) -> Value {
    if number.fract() == 0.0 && number.abs() < 9e15 {
        Content::Integer(number as i128).into()
    } else {
        number.into()
    }
}

fn list_of(list: Vec<Json>, kind: Option<&Kind>) -> Value {
    let element = match kind {
        Some(Kind::Tables(keys, _)) => Some(Kind::Table(keys.clone())),
        Some(Kind::Document(keys)) => keys.iter().find_map(|key| match &key.kind {
            Kind::Tables(keys, _) => Some(Kind::Table(keys.clone())),
            _ => None,
        }),
        _ => None,
    };
    let values: Vec<Value> = list.into_iter().map(|json| value(json, element.as_ref())).collect();
    let number = |value: &Value| match value.content {
        Content::Float(x) => Some(x),
        Content::Integer(n) => Some(n as f64),
        _ => None,
    };
    match (kind, values.iter().map(number).collect::<Option<Vec<f64>>>()) {
        (Some(Kind::Varied(_)), Some(numbers)) if !numbers.is_empty() => {
            Content::Numbers(numbers.into()).into()
        }
        _ => values.into(),
    }
}

#[cfg(test)]
mod tests {
    use translucid_desk::wrong::wrong;

    use super::*;

    /// A value as the package writes it.
    fn written(value: &Value) -> Json {
        match &value.content {
            Content::Flag(flag) => json!(flag),
            Content::Text(text) => json!(format!("'{text}")),
            Content::List(list) => list.iter().map(written).collect(),
            Content::Table(entries) => entries
                .iter()
                .map(|entry| (Spelling::Camel.of(&entry.key), written(&entry.value)))
                .collect::<Map<_, _>>()
                .into(),
            _ => json!(format!("#{value}")),
        }
    }

    #[test]
    fn wrong_questions_are_refused_in_the_spelling_of_javascript() {
        for question in QUESTIONS {
            for wrong in wrong(question) {
                let said = written(&wrong.said.clone().into());
                let request = json!({ "question": format!("'{}", question.name()), "said": said });
                let Err(message) = ask(Options::new("options", request).unwrap()) else {
                    panic!("{}: {} may be {}", question.name(), wrong.key, wrong.value)
                };
                assert!(message.contains(&Spelling::Camel.of(wrong.key)), "{}: {message}", wrong.key);
                let reasons = ["must", "need", "allowed"];
                assert!(reasons.iter().any(|word| message.contains(word)), "{}: {message}", wrong.key);
            }
        }
    }
}
