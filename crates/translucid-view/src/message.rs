//! The messages of pages: JSON to values that are checked later against the scene.

use serde::Deserialize;
use serde_json::{Map, Value};

/// A message of a page; `PROTOCOL.md` explains each.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Message {
    Material {
        index: usize,
        set: Map<String, Value>,
        gesture: Option<u64>,
    },
    Light {
        index: usize,
        light: Map<String, Value>,
        gesture: Option<u64>,
    },
    AddLight {
        light: Map<String, Value>,
    },
    RemoveLight {
        index: usize,
    },
    Environment {
        environment: Option<Map<String, Value>>,
        gesture: Option<u64>,
    },
    Integrator {
        set: Map<String, Value>,
        gesture: Option<u64>,
    },
    Film {
        set: Map<String, Value>,
        gesture: Option<u64>,
    },
    Camera {
        camera: Map<String, Value>,
        #[serde(default)]
        moving: bool,
        gesture: Option<u64>,
    },
    Orient {
        up: String,
        rotate: [f32; 3],
        gesture: Option<u64>,
    },
    Frame {},
    Settled {},
    Undo {},
    Redo {},
    Reset {},
    Compare {
        on: bool,
    },
    Side {
        side: Edited,
    },
    Swap {},
    Show {
        view: String,
    },
    Pause {
        on: bool,
    },
    Denoise {
        on: bool,
    },
    Device {
        name: String,
    },
    Pick {
        x: f32,
        y: f32,
    },
    Profile {
        index: usize,
    },
    Numbers {
        index: usize,
        color_space: Option<String>,
        thin: Option<f64>,
    },
    Painted {
        frame: u32,
    },
}

/// One of the two settings that are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Side {
    #[default]
    A,
    B,
}

/// The side that edits concern, or both at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Edited {
    A,
    B,
    Both,
}

impl Edited {
    pub(crate) const ALL: [Self; 3] = [Self::A, Self::B, Self::Both];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::B => "b",
            Self::Both => "both",
        }
    }

    /// The sides; the first is the one that panels show.
    pub(crate) fn sides(self) -> &'static [Side] {
        match self {
            Self::A => &[Side::A],
            Self::B => &[Side::B],
            Self::Both => &[Side::A, Side::B],
        }
    }
}

/// A message, and the number that the page knows its answer by.
pub(crate) struct Numbered {
    pub(crate) id: Option<u32>,
    /// The message, or why it is none, in words.
    pub(crate) message: Result<Message, String>,
}

impl Numbered {
    /// Reads a text frame.
    pub(crate) fn parse(text: &str) -> Self {
        let mut value: Value = match serde_json::from_str(text) {
            Ok(value) => value,
            Err(error) => {
                return Self { id: None, message: Err(format!("the message is not JSON: {error}")) };
            }
        };
        let Some(fields) = value.as_object_mut() else {
            return Self { id: None, message: Err("a message must be a JSON object".to_owned()) };
        };
        let id = fields.remove("id").and_then(|id| id.as_u64()).and_then(|id| u32::try_from(id).ok());
        Self { id, message: serde_json::from_value(value).map_err(|error| error.to_string()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Message, String> {
        Numbered::parse(text).message
    }

    #[test]
    fn messages_are_read_with_their_numbers() {
        let numbered = Numbered::parse(r#"{"type":"pick","x":1.5,"y":2,"id":7}"#);
        assert_eq!(numbered.id, Some(7));
        assert!(matches!(numbered.message, Ok(Message::Pick { x: 1.5, y: 2.0 })));
    }

    #[test]
    fn what_is_no_message_is_refused_in_words() {
        for (text, words) in [
            ("", "not JSON"),
            ("[]", "must be a JSON object"),
            ("{}", "missing field `type`"),
            (r#"{"type":"destroy"}"#, "unknown variant `destroy`"),
            (r#"{"type":"pick","x":1}"#, "missing field `y`"),
            (r#"{"type":"pick","x":1,"y":"2"}"#, "invalid type"),
            (r#"{"type":"undo","all":true}"#, "unknown field `all`"),
            (r#"{"type":"side","side":"c"}"#, "unknown variant `c`"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
