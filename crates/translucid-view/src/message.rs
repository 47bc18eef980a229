//! The messages of pages: JSON to values that are checked later against the scene.

use glam::{Mat3, Vec2, Vec3};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use translucid_scene::{Camera, Environment, Light, Projection};

/// A message of a page; `PROTOCOL.md` says what each means.
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
        #[serde(with = "LightMessage")]
        light: Light,
        gesture: Option<u64>,
    },
    AddLight {
        #[serde(with = "LightMessage")]
        light: Light,
    },
    RemoveLight {
        index: usize,
    },
    Environment {
        environment: Option<EnvironmentMessage>,
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
        camera: CameraMessage,
        #[serde(default)]
        moving: bool,
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
    Pick {
        x: f32,
        y: f32,
    },
    Profile {
        index: usize,
    },
    Numbers {
        index: usize,
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

/// What edits concern: one side, or both at once.
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

/// A [`Camera`] in JSON; angles in degrees.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CameraMessage {
    position: Vec3,
    target: Vec3,
    up: Vec3,
    projection: ProjectionMessage,
    shift: Vec2,
    lens_radius: f32,
    focus_distance: f32,
}

/// A [`Projection`] in JSON.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
enum ProjectionMessage {
    Perspective { fov: f32 },
    Orthographic { width: f32 },
}

impl From<CameraMessage> for Camera {
    fn from(message: CameraMessage) -> Self {
        let CameraMessage { position, target, up, projection, shift, lens_radius, focus_distance } = message;
        let projection = match projection {
            ProjectionMessage::Perspective { fov } => Projection::Perspective { horizontal_fov: fov },
            ProjectionMessage::Orthographic { width } => Projection::Orthographic { width },
        };
        Self { position, target, up, projection, shift, lens_radius, focus_distance }
    }
}

impl From<Camera> for CameraMessage {
    fn from(camera: Camera) -> Self {
        let Camera { position, target, up, projection, shift, lens_radius, focus_distance } = camera;
        let projection = match projection {
            Projection::Perspective { horizontal_fov } => {
                ProjectionMessage::Perspective { fov: horizontal_fov }
            }
            Projection::Orthographic { width } => ProjectionMessage::Orthographic { width },
        };
        Self { position, target, up, projection, shift, lens_radius, focus_distance }
    }
}

/// A [`Light`] in JSON.
#[derive(Deserialize, Serialize)]
#[serde(remote = "Light", tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum LightMessage {
    Rectangle {
        center: Vec3,
        edge_x: Vec3,
        edge_y: Vec3,
        radiance: Vec3,
        visible: bool,
    },
    Ellipse {
        center: Vec3,
        edge_x: Vec3,
        edge_y: Vec3,
        radiance: Vec3,
        visible: bool,
    },
    Sphere {
        center: Vec3,
        radius: f32,
        radiance: Vec3,
        visible: bool,
    },
    Distant {
        direction: Vec3,
        angular_radius: f32,
        irradiance: Vec3,
    },
    Spot {
        position: Vec3,
        direction: Vec3,
        radius: f32,
        intensity: Vec3,
        inner_angle: f32,
        outer_angle: f32,
        visible: bool,
    },
    Beam {
        origin: Vec3,
        direction: Vec3,
        radius: f32,
        power: Vec3,
    },
}

/// The light with a direction of length 1; as it is where it has none, which its check refuses.
pub(crate) fn with_unit_direction(mut light: Light) -> Light {
    if let Light::Distant { direction, .. } | Light::Spot { direction, .. } | Light::Beam { direction, .. } =
        &mut light
    {
        *direction = direction.as_dvec3().try_normalize().map_or(*direction, |unit| unit.as_vec3());
    }
    light
}

/// An environment; its image by its number among the scene's, its rotation about y in degrees.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EnvironmentMessage {
    radiance: [f32; 3],
    image: Option<usize>,
    rotation: f32,
    visible: bool,
}

impl From<EnvironmentMessage> for Environment {
    fn from(message: EnvironmentMessage) -> Self {
        Self {
            radiance: message.radiance.into(),
            image: message.image,
            world_from_environment: Mat3::from_rotation_y(message.rotation.to_radians()),
            visible: message.visible,
        }
    }
}

/// Keys and values as the lines of a scene file's table.
///
/// # Errors
/// A value is neither a number, a word, a truth nor a list of numbers: in words.
pub(crate) fn table_of(set: &Map<String, Value>) -> Result<String, String> {
    let mut text = String::new();
    for (key, value) in set {
        let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if key.is_empty() || !key.chars().all(is_bare) {
            return Err(format!("{key:?} is no key"));
        }
        let value = match value {
            Value::Bool(value) => value.to_string(),
            Value::Number(number) => number.to_string(),
            Value::String(word) => quoted(word)?,
            Value::Array(numbers) if numbers.iter().all(Value::is_number) && numbers.len() <= 16 => {
                value.to_string()
            }
            _ => return Err(format!("{key} must be a number, a word, true, false or a list of numbers")),
        };
        text += &format!("{key} = {value}\n");
    }
    Ok(text)
}

/// A word as TOML writes it.
fn quoted(word: &str) -> Result<String, String> {
    if word.chars().any(char::is_control) {
        return Err(String::from("a word must not have control characters"));
    }
    Ok(format!("\"{}\"", word.replace('\\', "\\\\").replace('"', "\\\"")))
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
        let text = r#"{"type":"light","index":0,"light":{"kind":"distant","direction":[0,3,4],"angular_radius":1,"irradiance":[1,1,1]}}"#;
        let Ok(Message::Light { light, .. }) = parse(text) else { panic!() };
        let Light::Distant { direction, .. } = with_unit_direction(light) else { panic!() };
        assert_eq!(direction, Vec3::new(0.0, 0.6, 0.8));
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

    #[test]
    fn tables_hold_values_and_nothing_else() {
        let table = |text: &str| table_of(serde_json::from_str::<Value>(text).unwrap().as_object().unwrap());
        assert_eq!(table(r#"{"a":[1,2.5e-7,3]}"#).unwrap(), "a = [1,2.5e-7,3]\n");
        assert_eq!(table(r#"{"a":"x\"\\y"}"#).unwrap(), "a = \"x\\\"\\\\y\"\n");
        for odd in
            [r#"{"a":{"file":"x"}}"#, r#"{"a b":1}"#, r#"{"a":"\n"}"#, r#"{"a":null}"#, r#"{"a":["x"]}"#]
        {
            assert!(table(odd).is_err(), "{odd}");
        }
    }
}
