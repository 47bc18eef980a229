//! A scene's parts as JSON, for pages.

use glam::Vec3;
use serde_json::{Map, Value, json};
use translucid_load::{Orientation, UpAxis};
use translucid_profile::convention::{conversion_system_names, presets};
use translucid_render::FilmLayer;
use translucid_scene::description::{SceneSlot, Thing};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Image, Integrator, Light, Material, Scene, SubsurfaceModel,
};

use crate::look::Look;
use crate::message::Edited;
use crate::value::json_of;
use crate::view::Shown;

pub(crate) fn camera(camera: &Camera) -> Value {
    json_of(&Camera::DESCRIPTION, camera).into()
}

pub(crate) fn film(film: &Film) -> Value {
    let mut object = json_of(&Film::DESCRIPTION, film);
    object.remove("size");
    object
        .extend([("width", film.width), ("height", film.height)].map(|(key, n)| (key.to_owned(), json!(n))));
    object.into()
}

pub(crate) fn bounds((center, radius): (Vec3, f32)) -> Value {
    json!({ "center": center.to_array(), "radius": radius })
}

pub(crate) fn orientation(orientation: Orientation) -> Value {
    json!({ "up": orientation.up.name(), "rotate": orientation.rotate })
}

pub(crate) fn image(image: &Image) -> Value {
    json!({ "name": image.name, "width": image.width, "height": image.height })
}

pub(crate) fn look(look: &Look) -> Value {
    json!({
        "materials": look.materials.iter().map(|each| material(each, &look.integrator)).collect::<Vec<_>>(),
        "lights": look.lights.iter().map(light).collect::<Vec<_>>(),
        "environment": look.environment.as_ref().map(environment),
        "integrator": json_of(&Integrator::DESCRIPTION, &look.integrator),
    })
}

fn material(material: &Material, integrator: &Integrator) -> Value {
    let mut copy = material.clone();
    let (mut parameters, mut words) = (Map::new(), Map::new());
    for field in Material::DESCRIPTION.fields {
        let (value, image, vertex) = match (field.slot)(&mut copy) {
            SceneSlot::Number(x, _) | SceneSlot::Length(x, _) => (json!(x), false, false),
            SceneSlot::Scalar(input, _) => (json!(input.factor), input.texture.is_some(), false),
            SceneSlot::Color(ColorInput { factor, texture, vertex_color }, _) => {
                (json!(factor.to_array()), texture.is_some(), *vertex_color)
            }
            SceneSlot::Word(word) => {
                words.insert(field.key().to_owned(), json!(word.name()));
                continue;
            }
            _ => continue,
        };
        let entry = json!({ "value": value, "image": image, "vertex": vertex });
        parameters.insert(field.key().to_owned(), entry);
    }
    let mfp = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    let mut object = json!({ "name": material.name, "parameters": parameters, "mfp": mfp.to_array() });
    object["model"] = json!(material.model(integrator).name());
    object["subsurface_model"] = json!(material.subsurface_model.name());
    object.as_object_mut().expect("it is one").append(&mut words);
    object
}

fn light(light: &Light) -> Value {
    let mut object = json_of(light.description(), light);
    object.insert(String::from("type"), json!(light.kind()));
    object.into()
}

fn environment(environment: &Environment) -> Value {
    // The matrix turns about y: its z axis is (sin, 0, cos)
    let axis = environment.world_from_environment.z_axis;
    json!({
        "radiance": environment.radiance.to_array(),
        "image": environment.image,
        "rotation": axis.x.atan2(axis.z).to_degrees(),
        "visible": environment.visible,
    })
}

/// The parameters of materials that are numbers or colors, and the words of every key that takes one.
fn parameters_and_words() -> (Vec<Value>, Map<String, Value>) {
    let (mut parameters, mut words) = (Vec::new(), Map::new());
    let mut plain = Material::default();
    for field in Material::DESCRIPTION.fields {
        let (kind, range) = match (field.slot)(&mut plain) {
            SceneSlot::Number(_, range) | SceneSlot::Length(_, range) | SceneSlot::Scalar(_, range) => {
                ("number", range)
            }
            SceneSlot::Color(_, range) => ("color", range),
            _ => continue,
        };
        parameters.push(json!({ "name": field.key(), "kind": kind, "min": range.low, "max": range.high }));
    }
    words.insert(String::from("subsurface_model"), json!(SubsurfaceModel::ALL.map(SubsurfaceModel::name)));
    insert_words(&Material::DESCRIPTION, &mut words);
    insert_words(&Integrator::DESCRIPTION, &mut words);
    insert_words(&Film::DESCRIPTION, &mut words);
    (parameters, words)
}

fn insert_words<T>(description: &Thing<T>, words: &mut Map<String, Value>) {
    let mut plain = (description.plain)();
    for field in description.fields {
        if let SceneSlot::Word(word) = (field.slot)(&mut plain) {
            words.insert(field.key().to_owned(), json!(word.names()));
        }
    }
}

/// A kind of light: an example of it, and the fields that have a row of their own, in the order of its keys.
fn kind_of_light(kind: &Thing<Light>) -> Value {
    let mut example = (kind.plain)();
    let [mut place, mut strength] = [Value::Null, Value::Null];
    let mut fields = Vec::new();
    for field in kind.fields {
        let (of, range) = match (field.slot)(&mut example) {
            SceneSlot::Point(_) => {
                place = json!(field.key());
                ("point", None)
            }
            SceneSlot::Radiance(_) => {
                strength = json!(field.key());
                ("radiance", None)
            }
            SceneSlot::Power(_) => {
                strength = json!(field.key());
                ("power", None)
            }
            SceneSlot::Direction(..) => ("direction", None),
            SceneSlot::Edges { .. } => ("edges", None),
            SceneSlot::Length(_, range) => ("length", Some(range)),
            SceneSlot::Angle(_, range) => ("angle", Some(range)),
            SceneSlot::Number(_, range) => ("number", Some(range)),
            SceneSlot::Flag(_) => ("flag", None),
            _ => continue,
        };
        let [min, max] = [range.map(|range| range.low), range.map(|range| range.high)];
        fields.push(
            json!({ "key": field.key(), "kind": of, "min": min, "max": max, "hint": field.keys[0].doc }),
        );
    }
    json!({ "name": kind.name, "place": place, "strength": strength, "fields": fields, "example": light(&example) })
}

/// Everything about a scene that no edit changes, and the names that a page offers.
pub(crate) fn hello(name: &str, scene: &Scene) -> Value {
    let (parameters, words) = parameters_and_words();
    let model = |model: SubsurfaceModel| json!({ "name": model.name(), "description": model.description() });
    let objects: Vec<Value> = scene
        .objects
        .iter()
        .map(|object| {
            json!({
                "name": object.name,
                "material": object.material,
                "triangles": object.mesh.triangles.len(),
            })
        })
        .collect();
    json!({
        "type": "hello",
        "protocol": 2,
        "version": env!("CARGO_PKG_VERSION"),
        "name": name,
        "unit": scene.unit.name(),
        "objects": objects,
        "parameters": parameters,
        "lights": Light::KINDS.map(kind_of_light),
        "models": SubsurfaceModel::ALL.map(model),
        "words": words,
        "presets": presets().iter().map(|p| json!({ "name": p.name, "source": p.source, "group": p.group.name() })).collect::<Vec<_>>(),
        "systems": conversion_system_names(),
        "up": UpAxis::WORDS.map(|(name, _)| name),
        "sides": Edited::ALL.map(Edited::name),
        "views": Shown::ALL.map(Shown::name),
    })
}

/// Mean values of a film's pixel, by the names of its layers.
pub(crate) fn layers(values: impl Fn(FilmLayer) -> Vec<f32>) -> Value {
    let entries = FilmLayer::ALL.map(|layer| {
        let numbers = values(layer);
        let value = if numbers.len() == 1 { json!(numbers[0]) } else { json!(numbers) };
        (layer.name().to_owned(), value)
    });
    Value::Object(entries.into_iter().collect())
}
