//! The door for pages: JSON to values, and things by their keys to JSON.

use serde_json::{Map, Value as Json, json};
use translucid_load::Piece;
use translucid_scene::description::{Content, Entry, SceneSlot, Slot, Thing, Value};

/// A thing of a scene by the keys and values of a message.
pub(crate) fn piece(title: &str, keys: Map<String, Json>) -> Piece {
    Piece::new(title, entries(keys))
}

fn entries(object: Map<String, Json>) -> Vec<Entry> {
    object.into_iter().map(|(key, json)| Entry::new(&key, value(json))).collect()
}

fn value(json: Json) -> Value {
    let content = match json {
        Json::Null => Content::Other("null"),
        Json::Bool(flag) => Content::Flag(flag),
        Json::Number(number) => match number.as_i128() {
            Some(n) => Content::Integer(n),
            None => Content::Float(number.as_f64().unwrap_or(f64::NAN)),
        },
        Json::String(text) => Content::Text(text),
        Json::Array(list) => Content::List(list.into_iter().map(value).collect()),
        Json::Object(object) => Content::Table(entries(object)),
    };
    content.into()
}

/// A thing by its keys, which [`piece`] reads back. Every color has three numbers.
pub(crate) fn json_of<T: Clone>(description: &Thing<T>, thing: &T) -> Map<String, Json> {
    let mut copy = thing.clone();
    let mut object = Map::new();
    for field in description.fields {
        match (field.slot)(&mut copy) {
            SceneSlot::Radiance(color) | SceneSlot::Power(color) => {
                object.insert(field.key().to_owned(), json!(color.to_array()));
            }
            SceneSlot::Direction(direction, _) => {
                object.insert(String::from("direction"), json!(direction.to_array()));
            }
            slot => object.extend(
                slot.write(field.keys, [0.0; 3])
                    .into_iter()
                    .map(|entry| (entry.key, json_value(&entry.value))),
            ),
        }
    }
    object
}

fn json_value(value: &Value) -> Json {
    match &value.content {
        Content::Flag(flag) => json!(flag),
        Content::Integer(n) => json!(n),
        Content::Float(x) => json!(x),
        Content::Text(text) => json!(text),
        Content::List(values) => values.iter().map(json_value).collect(),
        Content::Table(entries) => {
            Json::Object(entries.iter().map(|entry| (entry.key.clone(), json_value(&entry.value))).collect())
        }
        Content::Numbers(numbers) => json!(numbers[..]),
        Content::Object(_) | Content::Other(_) => Json::Null,
    }
}

#[cfg(test)]
mod tests {
    use translucid_scene::{Camera, Film, Integrator, Light};

    use super::*;

    #[test]
    fn values_keep_their_kinds() {
        let keys = json!({"a": [1, 2.5e-7], "b": "x\"\n", "c": null, "d": {"e": true}, "f": u64::MAX});
        let Json::Object(keys) = keys else { panic!() };
        let text: Vec<String> = entries(keys).iter().map(ToString::to_string).collect();
        let expected = [
            "a = [1, 2.5e-7]",
            "b = \"x\\\"\\u000A\"",
            "c = null",
            "d = { e = true }",
            "f = 18446744073709551615",
        ];
        assert_eq!(text, expected);
    }

    #[test]
    fn things_come_back_from_json() {
        for kind in Light::KINDS {
            let light = (kind.plain)();
            let mut keys = json_of(light.description(), &light);
            keys.insert(String::from("type"), json!(light.kind()));
            assert_eq!(piece("light", keys).light(), Ok(light));
        }
        let (camera, film, integrator) = (Camera::default(), Film::default(), Integrator::default());
        let keys = json_of(&Camera::DESCRIPTION, &camera);
        assert_eq!(piece("camera", keys).camera(), Ok(camera));
        let keys = json_of(&Film::DESCRIPTION, &film);
        assert_eq!(piece("film", keys).film(Film { exposure: 3.0, ..film }), Ok(film));
        let keys = json_of(&Integrator::DESCRIPTION, &integrator);
        assert_eq!(
            piece("integrator", keys).integrator(Integrator { seed: 7, ..integrator }),
            Ok(integrator)
        );
    }
}
