//! Wrong questions, made from the descriptions: every door must refuse each of them, by the key, what was found and what is
//! allowed.

use translucid_words::{Content, Described, Entry, Kind, Value};

use crate::Ask;

/// A question that is right but for one value.
#[derive(Clone, Debug)]
pub struct Wrong {
    /// All that is said.
    pub said: Vec<Entry>,
    /// The key whose value is wrong.
    pub key: &'static str,
    /// Whether that is a key of the question itself, not of a table in it.
    pub is_outermost: bool,
    /// Its value.
    pub value: Value,
}

/// Every wrong question of a question: each key is changed in the first right question that has it, so that no other key
/// stands in its way, or else in the first of all.
pub fn wrong(question: &dyn Ask) -> Vec<Wrong> {
    let rights: Vec<Vec<Entry>> = (question.about().right)();
    let mut known = Vec::<(String, usize)>::new();
    for (number, right) in rights.iter().enumerate() {
        for path in paths(right, "") {
            if known.iter().all(|(other, _)| *other != path) {
                known.push((path, number));
            }
        }
    }
    let mut all = Vec::new();
    for (number, right) in rights.iter().enumerate() {
        change(&question.keys(), right, "", &mut |said, path, key, is_outermost, value| {
            let place = known.iter().find(|(other, _)| other == path).map_or(0, |(_, number)| *number);
            if place == number {
                all.push(Wrong { said, key, is_outermost, value });
            }
        });
    }
    all
}

/// Paths of all keys that entries have.
fn paths(entries: &[Entry], before: &str) -> Vec<String> {
    let all = |entry: &Entry| {
        let path = format!("{before}.{}", entry.key);
        let mut inner = table_of(&entry.value).map_or(Vec::new(), |entries| paths(&entries, &path));
        inner.push(path);
        inner
    };
    entries.iter().flat_map(all).collect()
}

/// A table, or the first of several.
fn table_of(value: &Value) -> Option<Vec<Entry>> {
    match &value.content {
        Content::Table(entries) => Some(entries.clone()),
        Content::List(list) => list.first().and_then(table_of),
        _ => None,
    }
}

/// Entries with a wrong value, the path of its key, the key, whether it is an outermost one, and the value.
type Found<'a> = dyn FnMut(Vec<Entry>, &str, &'static str, bool, Value) + 'a;

fn change(keys: &[Described], right: &[Entry], before: &str, found: &mut Found<'_>) {
    for key in keys {
        let path = format!("{before}.{}", key.name);
        for value in values(&key.kind) {
            found(with(right, key.name, value.clone()), &path, key.name, before.is_empty(), value);
        }
        let (Kind::Document(inner) | Kind::Table(inner) | Kind::Tables(inner, _)) = &key.kind else {
            continue;
        };
        let stated = right.iter().find(|entry| entry.key == key.name);
        let Some(first) = stated.and_then(|entry| table_of(&entry.value)) else { continue };
        change(inner, &first, &path, &mut |entries, path, name, _, value| {
            let table = Value::from(entries);
            let nested = if let Kind::Tables(..) = key.kind { Value::from(vec![table]) } else { table };
            found(with(right, key.name, nested), path, name, false, value);
        });
    }
}

/// Entries with another value of a key.
fn with(entries: &[Entry], key: &str, value: Value) -> Vec<Entry> {
    let others = entries.iter().filter(|entry| entry.key != key).cloned();
    others.chain([Entry::new(key, value)]).collect()
}

/// Values that a kind does not allow.
fn values(kind: &Kind) -> Vec<Value> {
    let word = || Value::from("no such word");
    match kind {
        Kind::Flag => vec![1.0.into(), word()],
        Kind::Whole(range) => {
            let low = range.low.checked_sub(1).map(Value::from);
            let high = range.high.checked_add(1).map(Value::from);
            low.into_iter().chain(high).chain([0.5.into(), (-1.0).into(), f64::NAN.into(), word()]).collect()
        }
        Kind::Number(range) => {
            let outside = range.outside().into_iter().map(Value::from);
            outside.chain([word(), true.into(), Value::list(&[0.5, 0.5])]).collect()
        }
        Kind::Varied(range) => range.outside().into_iter().map(Value::from).chain([true.into()]).collect(),
        Kind::Numbers(range, [least, most]) => {
            let outside = range.outside().into_iter().map(|x| Value::list(&[x]));
            let few = (*least > 0).then(|| Value::from(Vec::<Value>::new()));
            let inside = range.low.max(-1e9).midpoint(range.high.min(1e9));
            let many = (*most < 1000).then(|| Value::list(&vec![inside; most + 1]));
            outside.chain(few).chain(many).chain([word()]).collect()
        }
        Kind::Word(_) | Kind::Words(_) => vec![word(), 7.5.into()],
        Kind::Text(_) | Kind::Texts(_) | Kind::Path => vec![true.into()],
        Kind::Document(_) | Kind::Table(_) | Kind::Tables(..) => vec![1.5.into(), true.into()],
    }
}

#[cfg(test)]
mod tests {
    use translucid_words::{Provenance, Spelling};

    use super::*;
    use crate::QUESTIONS;

    #[test]
    fn right_questions_are_read_and_wrong_ones_refused_by_name() {
        for question in QUESTIONS {
            for spelling in [Spelling::Keys, Spelling::Flags, Spelling::Camel] {
                let source = Provenance::part("").of("the question").spelled(spelling);
                let read = |said: &[Entry]| question.read(&source, said).map(drop);
                for right in (question.about().right)() {
                    assert_eq!(read(&right).err(), None, "{}", question.name());
                }
                for wrong in wrong(question) {
                    let Err(error) = read(&wrong.said) else {
                        panic!("{}: {} may be {}", question.name(), wrong.key, wrong.value)
                    };
                    let own = if wrong.is_outermost { spelling } else { Spelling::Keys };
                    let key =
                        if spelling == Spelling::Camel { spelling.of(wrong.key) } else { own.of(wrong.key) };
                    let message = error.message;
                    assert!(message.contains(&key), "{key}: {message}");
                    let is_told = ["must", "need", "allowed"].iter().any(|word| message.contains(word));
                    assert!(is_told, "{key}: {message}");
                }
            }
        }
    }
}
