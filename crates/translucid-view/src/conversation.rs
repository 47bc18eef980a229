//! What becomes of a page's message, whatever brings it.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};
use translucid_load::{MeshBase, Orientation, UpAxis};
use translucid_scene::{Camera, Film, Material, Projection, SceneError};

use crate::message::{Message, Numbered};
use crate::numbers::Wish;
use crate::shared::Shared;
use crate::{numbers, profile_panel};

/// What a message comes to.
pub(crate) enum Heard {
    /// The answer.
    Answer(String),
    /// A question whose answer takes a while to compute.
    Question(Question),
    /// A change that takes a while to make.
    Turn(Turn),
    /// The picture of this number is on the screen.
    Painted(u32),
}

/// The wish to turn the bare mesh.
pub(crate) struct Turn {
    id: Option<u32>,
    up: String,
    rotate: [f32; 3],
    gesture: Option<u64>,
}

/// A question about a material.
pub(crate) struct Question {
    pub(crate) topic: Topic,
    id: Option<u32>,
    index: usize,
    wish: Wish,
}

#[derive(Clone, Copy)]
pub(crate) enum Topic {
    Profile,
    Numbers,
}

/// Does what a message asks for.
pub(crate) fn hear(shared: &Shared, text: &str) -> Heard {
    let Numbered { id, message } = Numbered::parse(text);
    let message = match message {
        Ok(message) => message,
        Err(words) => return Heard::Answer(error(id, &SceneError::new(words))),
    };
    match message {
        Message::Painted { frame } => Heard::Painted(frame),
        Message::Pick { x, y } => Heard::Answer(shared.picked(id, [x, y]).to_string()),
        Message::Profile { index } => {
            Heard::Question(Question { topic: Topic::Profile, id, index, wish: Wish::default() })
        }
        Message::Numbers { index, color_space, thin } => {
            Heard::Question(Question { topic: Topic::Numbers, id, index, wish: Wish { color_space, thin } })
        }
        Message::Orient { up, rotate, gesture } => Heard::Turn(Turn { id, up, rotate, gesture }),
        message => {
            let changed = shared.change(|studio| {
                if let Message::Frame {} = message {
                    let camera = framed(studio.camera(), studio.film(), studio.bounds());
                    studio.set_camera(camera);
                    return Ok(());
                }
                studio.apply(message)
            });
            Heard::Answer(applied(id, changed))
        }
    }
}

/// The answer to a change.
fn applied(id: Option<u32>, changed: Result<u32, SceneError>) -> String {
    match changed {
        Ok(version) => json!({ "type": "applied", "id": id, "version": version }).to_string(),
        Err(refused) => error(id, &refused),
    }
}

impl Turn {
    /// Turns the mesh, which is loaded for that.
    pub(crate) fn answer(&self, shared: &Shared) -> String {
        applied(self.id, self.orientation().and_then(|orientation| shared.turn(orientation, self.gesture)))
    }

    fn orientation(&self) -> Result<Orientation, SceneError> {
        let Self { up, rotate, .. } = self;
        let axis = UpAxis::from_name(up).ok_or_else(|| {
            let names = UpAxis::WORDS.map(|(name, _)| name).join(", ");
            SceneError::new(format!("up is {up:?}, but must be one of {names}"))
        })?;
        MeshBase::ANGLES.check_all("rotate", rotate)?;
        Ok(Orientation { up: axis, rotate: *rotate })
    }

    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn id(&self) -> Option<u32> {
        self.id
    }
}

impl Question {
    /// The answer about the material as it is now.
    pub(crate) fn answer(&self, shared: &Shared) -> String {
        let Self { topic, id, index, ref wish } = *self;
        let material = shared.studio(|studio| {
            let look = studio.active_look();
            let material = look.materials.get(index)?;
            Some(Material { subsurface_model: material.model(&look.integrator), ..material.clone() })
        });
        let Some(material) = material else {
            return error(id, &SceneError::new(format!("material {index} is not there")));
        };
        let unit = shared.origin.unit;
        let mut answer = match topic {
            Topic::Profile => profile_panel::profile(&material, &shared.origin.profile_tables, unit),
            Topic::Numbers => numbers::numbers(&material, unit, wish),
        };
        answer["id"] = json!(id);
        answer["index"] = json!(index);
        answer.to_string()
    }

    /// The answer when it could not be computed.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn failed(id: Option<u32>) -> String {
        error(id, &SceneError::new("this failed: a defect"))
    }

    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn id(&self) -> Option<u32> {
        self.id
    }
}

/// An error as pages show it.
pub(crate) fn refusal(error: &SceneError) -> Value {
    let place = error.place.as_ref().map_or_else(String::new, |place| format!("{place}: "));
    json!({ "message": format!("{place}{}", error.message), "help": error.help })
}

fn error(id: Option<u32>, error: &SceneError) -> String {
    let mut answer = refusal(error);
    answer["type"] = json!("error");
    answer["id"] = json!(id);
    answer.to_string()
}

/// The camera moved along its direction, or its picture widened, until a sphere is in the middle of the picture.
fn framed(camera: &Camera, film: &Film, (center, radius): (Vec3, f32)) -> Camera {
    let backward = (camera.position - camera.target).as_dvec3().normalize_or(glam::DVec3::Z);
    let aspect = f64::from(film.width) / f64::from(film.height);
    let reach = 1.05 * f64::from(radius).max(1e-6);
    let (distance, projection) = match camera.projection {
        Projection::Perspective { .. } => {
            let across = camera.projection.width_at(0.5);
            (reach / across.min(across / aspect).atan().sin(), camera.projection)
        }
        Projection::Orthographic { .. } => {
            let width = (2.0 * reach * aspect.max(1.0)) as f32;
            (2.0 * reach, Projection::Orthographic { width })
        }
    };
    let position = (center.as_dvec3() + backward * distance).as_vec3();
    let (target, focus_distance, shift) = (center, distance as f32, Vec2::ZERO);
    let moved = Camera { position, target, projection, shift, focus_distance, ..*camera };
    if moved.validate().is_ok() { moved } else { *camera }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn framed_camera_keeps_its_direction_and_sees_the_sphere() {
        let camera = Camera { position: Vec3::new(3.0, 4.0, 5.0), target: Vec3::ONE, ..Camera::default() };
        let sphere = (Vec3::new(-2.0, 0.0, 7.0), 3.0);
        let film = Film { width: 100, height: 300, ..Film::default() };
        let moved = framed(&camera, &film, sphere);
        let direction = |camera: &Camera| (camera.target - camera.position).normalize();
        assert!(direction(&moved).distance(direction(&camera)) < 1e-5 && moved.target == sphere.0);
        // Seen under less than the field of view, which is the narrower here
        let half_angle = f64::from(sphere.1 / moved.position.distance(sphere.0)).asin();
        let half_fov = camera.projection.width_at(0.5).atan();
        assert!(half_angle < half_fov && half_angle > 0.9 * half_fov);

        let parallel = Camera { projection: Projection::Orthographic { width: 1.0 }, ..camera };
        for (film, least) in [(film, 6.0), (Film { width: 300, height: 100, ..film }, 18.0)] {
            let moved = framed(&parallel, &film, sphere);
            let width = moved.projection.width_at(0.0);
            assert!(width > least && width < 1.1 * least, "{width}");
            assert!(moved.position.distance(sphere.0) > sphere.1);
        }
    }
}
