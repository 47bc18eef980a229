//! A scene's parts as JSON, for pages.

use serde_json::value::Serializer;
use serde_json::{Map, Value, json};
use translucid_profile::convention::{conversion_system_names, presets};
use translucid_render::FilmLayer;
use translucid_scene::{
    Camera, Environment, Film, Image, Integrator, Light, Material, Scene, SubsurfaceModel,
};

use crate::look::Look;
use crate::message::{CameraMessage, Edited, LightMessage};
use crate::view::Shown;

/// The camera; its plain fields always have a value in JSON.
pub(crate) fn camera(camera: &Camera) -> Value {
    json!(CameraMessage::from(*camera))
}

pub(crate) fn film(film: &Film) -> Value {
    json!({
        "width": film.width,
        "height": film.height,
        "exposure": film.exposure,
        "tone_mapping": film.tone_mapping.name(),
    })
}

pub(crate) fn image(image: &Image) -> Value {
    json!({ "name": image.name, "width": image.width, "height": image.height })
}

pub(crate) fn look(look: &Look) -> Value {
    json!({
        "materials": look.materials.iter().map(|each| material(each, &look.integrator)).collect::<Vec<_>>(),
        "lights": look.lights.iter().map(light).collect::<Vec<_>>(),
        "environment": look.environment.as_ref().map(environment),
        "integrator": integrator(&look.integrator),
    })
}

fn material(material: &Material, integrator: &Integrator) -> Value {
    let parameters: Map<String, Value> = material
        .parameters()
        .into_iter()
        .map(|parameter| {
            let value = match parameter.numbers[..] {
                [number] => json!(number),
                _ => json!(parameter.numbers),
            };
            let entry = json!({
                "value": value,
                "image": parameter.has_image,
                "vertex": parameter.has_vertex_color,
            });
            (parameter.name.to_owned(), entry)
        })
        .collect();
    let mfp = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    let mut object = json!({ "name": material.name, "parameters": parameters, "mfp": mfp.to_array() });
    object["model"] = json!(material.model(integrator).name());
    for word in material.words() {
        object[word.name] = json!(word.word);
    }
    object
}

fn light(light: &Light) -> Value {
    LightMessage::serialize(light, Serializer).unwrap_or_default()
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

fn integrator(integrator: &Integrator) -> Value {
    json!({
        "samples_per_pixel": integrator.samples_per_pixel,
        "max_depth": integrator.max_depth,
        "max_diffuse_depth": integrator.max_diffuse_depth,
        "subsurface_method": integrator.subsurface_method.name(),
        "subsurface_sharing": integrator.subsurface_sharing,
        "caustics": integrator.caustics,
        "seed": integrator.seed,
    })
}

/// Everything about a scene that no edit changes, and the names that a page offers.
pub(crate) fn hello(name: &str, scene: &Scene, bounds: ([f32; 3], f32), origin: &Camera) -> Value {
    let plain = Material::default();
    let parameter = |parameter: translucid_scene::ParameterValue| {
        json!({
            "name": parameter.name,
            "kind": if parameter.numbers.len() == 1 { "number" } else { "color" },
            "min": parameter.range[0],
            "max": parameter.range[1],
        })
    };
    let mut words: Map<String, Value> =
        plain.words().into_iter().map(|word| (word.name.to_owned(), json!(word.words))).collect();
    words.insert("subsurface_method".to_owned(), json!(["ray-traced", "point-based", "cycles-disk"]));
    words.insert("tone_mapping".to_owned(), json!(["srgb", "neutral", "agx"]));
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
        "protocol": 1,
        "version": env!("CARGO_PKG_VERSION"),
        "name": name,
        "unit": scene.unit.name(),
        "objects": objects,
        "bounds": { "center": bounds.0, "radius": bounds.1 },
        "cameras": [{ "name": "scene", "camera": camera(origin) }],
        "parameters": plain.parameters().into_iter().map(parameter).collect::<Vec<_>>(),
        "models": SubsurfaceModel::ALL.map(model),
        "words": words,
        "presets": presets().iter().map(|p| json!({ "name": p.name, "source": p.source })).collect::<Vec<_>>(),
        "systems": conversion_system_names(),
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
