//! The writer of scene files: what of a scene differs from another, as a file that extends that one.

use std::fmt::Debug;
use std::sync::Arc;

use glam::DVec3;
use translucid_profile::convention::{Preset, presets};
use translucid_scene::description::{Content, Entry, Part, Provenance, Visit, quoted};
use translucid_scene::{
    Camera, Environment, Film, Integrator, Light, Material, Object, Scene, SceneError, SubsurfaceModel, Unit,
};

use super::SceneFile;
use super::base::Base;
use super::material::name_after_preset;
use super::mesh_base::MeshBase;
use super::parse::parse;
use crate::result::Result;

/// The base that a written scene file extends: its key `extends`, and those for a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExtendedBase {
    /// Path of a scene or mesh, relative to the folder that the file will lie in, or "still-life".
    pub extends: String,
    /// Wishes for the mesh, if the base is one.
    pub mesh: MeshBase,
}

impl ExtendedBase {
    /// A scene file that extends the base and changes its scene, `from`, into `to`.
    ///
    /// `from` is what [`load_scene`](crate::load_scene) makes of the base with no options but those of `mesh`.
    /// The file has the differences and nothing else, and every number reads back to the same bits.
    /// Meshes are not looked at, so the objects may be without.
    /// An image of `to` is one of `from` if both share it, wherever it is in their lists.
    /// `environment_file` is the path of an environment's image that `from` does not have.
    ///
    /// # Errors
    /// Something changed that a scene file cannot say: there are more or fewer objects or materials, another name, or
    /// another image.
    ///
    /// ```
    /// use translucid_load::{ExtendedBase, LoadOptions, still_life};
    ///
    /// let from = still_life(&LoadOptions::default())?;
    /// let mut to = from.clone();
    /// to.film.exposure = 0.5;
    /// let base = ExtendedBase { extends: "still-life".into(), ..ExtendedBase::default() };
    /// assert_eq!(base.write(&from, &to, None)?, "extends = \"still-life\"\n\n[film]\nexposure = 0.5\n");
    /// # Ok::<(), translucid_scene::SceneError>(())
    /// ```
    pub fn write(&self, from: &Scene, to: &Scene, environment_file: Option<&str>) -> Result<String> {
        let to = &with_numbers_of(from, to);
        let mut text = format!("extends = {}\n", quoted(&self.extends));
        text += &table("", &self.mesh.write());
        // What stands at the root comes before the first table
        let lights = lights(from, to);
        let environment = environment(from, to, environment_file)?;
        let (at_root, in_tables): (Vec<_>, Vec<_>) =
            [lights, environment].into_iter().partition(|part| !part.starts_with('\n'));
        text += &at_root.concat();
        // A camera that is chosen for the base fits the film's size
        let is_resized = [from.film.width, from.film.height] != [to.film.width, to.film.height];
        if from.camera != to.camera || is_resized {
            text += &table("\n[camera]\n", &Camera::DESCRIPTION.write_at(&to.camera, to.origin.to_array()));
        }
        let mut film = from.film;
        if film.filter != to.film.filter {
            // The filter brings a radius of its own
            film.filter_radius = f32::NAN;
        }
        text += &table("\n[film]\n", &Film::DESCRIPTION.write_changes(&film, &to.film));
        let integrator = Integrator::DESCRIPTION.write_changes(&from.integrator, &to.integrator);
        text += &table("\n[integrator]\n", &integrator);
        require_same_number("materials", from.materials.len(), to.materials.len())?;
        for (index, (old, new)) in from.materials.iter().zip(&to.materials).enumerate() {
            let header = chosen("material", index, from.materials.iter().map(|material| &material.name));
            // Those before it have their new names by then
            let others = to.materials[..index].iter().chain(&from.materials[index + 1..]);
            let others: Vec<&str> = others.map(|other| other.name.as_str()).collect();
            text += &table(&header, &material(old, new, &others, to.unit)?);
        }
        require_same_number("objects", from.objects.len(), to.objects.len())?;
        for (index, (old, new)) in from.objects.iter().zip(&to.objects).enumerate() {
            let header = chosen("object", index, from.objects.iter().map(|object| &object.name));
            text += &table(&header, &object(old, new, to)?);
        }
        text += &in_tables.concat();
        verify(&text, from, to)?;
        Ok(text)
    }
}

fn require_same_number(things: &str, from: usize, to: usize) -> Result<()> {
    if from == to {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "the base has {from} {things} and the changed scene {to}, but both must have as many"
    )))
}

/// A table, if there is something in it.
fn table(header: &str, entries: &[Entry]) -> String {
    let lines: String = entries.iter().map(|entry| format!("{entry}\n")).collect();
    if lines.is_empty() { lines } else { format!("{header}{lines}") }
}

/// The header of a table that changes a thing of the base, by the name if no other has that.
fn chosen<'n>(kind: &str, index: usize, names: impl Iterator<Item = &'n String> + Clone) -> String {
    let name = names.clone().nth(index).map_or("", String::as_str);
    let key = match names.filter(|other| *other == name).count() {
        1 if !name.is_empty() => format!("name = {}", quoted(name)),
        _ => format!("index = {index}"),
    };
    format!("\n[[{kind}]]\n{key}\n")
}

/// The parameters that differ, from a preset where that is shorter.
fn material(from: &Material, to: &Material, others: &[&str], unit: Unit) -> Result<Vec<Entry>> {
    if let (old, new @ SubsurfaceModel::Tabulated(_)) = (from.subsurface_model, to.subsurface_model)
        && old != new
    {
        return Err(unsaid(&format!("the table of material {}", to.name)));
    }
    let plain = Material::DESCRIPTION.write_changes(from, to);
    let mut names_image = !to.layers.is_empty();
    to.clone().for_each_image(|_| names_image = true);
    if names_image {
        return Ok(plain);
    }
    let gives_name =
        |preset: &&Preset| name_after_preset(from, unit, preset.name, others.iter().copied()) == to.name;
    let from_preset = |preset: &Preset| {
        let changes = Material::DESCRIPTION.write_changes(&Material::of_preset(preset, unit), to);
        std::iter::once(Entry::new("preset", preset.name)).chain(changes).collect::<Vec<_>>()
    };
    let shortest = presets().iter().filter(gives_name).map(from_preset).min_by_key(Vec::len);
    // Nothing but a preset brings another name
    let is_renamed = from.name != to.name;
    Ok(shortest.filter(|entries| is_renamed || entries.len() < plain.len()).unwrap_or(plain))
}

fn object(from: &Object, to: &Object, scene: &Scene) -> Result<Vec<Entry>> {
    if from.material == to.material {
        return Ok(Vec::new());
    }
    let name = scene.materials.get(to.material).map(|material| material.name.as_str());
    let name = name.ok_or_else(|| unsaid(&format!("the material of object {}", to.name)))?;
    Ok(vec![Entry::new("material", name)])
}

/// Tables of all lights, if they differ; a line at the root where there are none any more.
fn lights(from: &Scene, to: &Scene) -> String {
    let texts = |scene: &Scene| scene.lights.iter().map(|of| light(of, scene.origin)).collect::<Vec<_>>();
    match texts(to) {
        lights if lights == texts(from) => String::new(),
        lights if lights.is_empty() => String::from("light = []\n"),
        lights => lights.concat(),
    }
}

fn light(light: &Light, origin: DVec3) -> String {
    let mut entries = light.write_at(origin);
    entries.retain(|entry| entry.value.content != Content::Flag(true));
    table("\n[[light]]\n", &entries)
}

/// The table of an environment that differs, without a file where it keeps its image; a line at the root where there is
/// none any more.
fn environment(from: &Scene, to: &Scene, file: Option<&str>) -> Result<String> {
    if format!("{:?}", from.environment) == format!("{:?}", to.environment) {
        return Ok(String::new());
    }
    let Some(new) = &to.environment else { return Ok(String::from("environment = \"none\"\n")) };
    let file = match new.image {
        image if image == from.environment.and_then(|old| old.image) => None,
        None => Some("none"),
        Some(image) => {
            let file = file.filter(|_| image >= from.images.len());
            Some(file.ok_or_else(|| unsaid("the image of the environment, without a file for it,"))?)
        }
    };
    let base = from.environment.filter(|_| file.is_none()).unwrap_or_default();
    let mut entries: Vec<Entry> = file.into_iter().map(|file| Entry::new("file", file)).collect();
    let changes = Environment::DESCRIPTION.write_changes(&base, new);
    // The radiance is written in any case: a new environment may need it
    let all = Environment::DESCRIPTION.write(new);
    let is_written =
        |entry: &Entry| entry.key == "radiance" || changes.iter().any(|other| other.key == entry.key);
    entries.extend(all.into_iter().filter(is_written));
    Ok(table("\n[environment]\n", &entries))
}

fn unsaid(what: &str) -> SceneError {
    SceneError::new(format!("{what} cannot be written in a scene file that extends another"))
}

/// The scene without meshes, its images numbered as in `from`; those that are not there come behind.
fn with_numbers_of(from: &Scene, to: &Scene) -> Scene {
    let mut images = from.images.clone();
    let mut numbers = Vec::new();
    for image in &to.images {
        let known = images.iter().position(|other| Arc::ptr_eq(other, image));
        numbers.push(known.unwrap_or(images.len()));
        if known.is_none() {
            images.push(Arc::clone(image));
        }
    }
    let mut scene = without_meshes(to);
    // A number that no image has stays wrong
    scene.for_each_image(|number| *number = numbers.get(*number).copied().unwrap_or(usize::MAX));
    Scene { images, ..scene }
}

fn without_meshes(scene: &Scene) -> Scene {
    let object =
        |&Object { ref name, world_from_local, material, subsurface_group, is_movable, .. }: &Object| {
            Object {
                name: name.clone(),
                mesh: Arc::default(),
                world_from_local,
                material,
                subsurface_group,
                is_movable,
            }
        };
    Scene {
        unit: scene.unit,
        origin: scene.origin,
        camera: scene.camera,
        film: scene.film,
        integrator: scene.integrator,
        objects: scene.objects.iter().map(object).collect(),
        materials: scene.materials.clone(),
        images: scene.images.clone(),
        profile_tables: scene.profile_tables.clone(),
        lights: scene.lights.clone(),
        environment: scene.environment,
        ..Scene::default()
    }
}

/// Reads the text back, as changes of the base: it must give what was to be written.
fn verify(text: &str, from: &Scene, to: &Scene) -> Result<()> {
    let source = Provenance::file("the scene to be written".as_ref(), text);
    let entries = parse(&source)?.into();
    let read = SceneFile::of(source, entries, Base::Known(Box::new(without_meshes(from))), None)?;
    let mut environment = to.environment;
    if let Some(image) = environment.as_mut().and_then(|environment| environment.image.as_mut()) {
        // The only new image that is written
        *image = (*image).min(from.images.len());
    }
    let mut camera = read.camera(None)?.unwrap_or_default();
    let mut scene = read.scene;
    keep_digits(&mut camera, &mut scene.lights, to);
    require_same("the camera", &camera, &to.camera)?;
    require_same("the film", &scene.film, &to.film)?;
    require_same("the integrator", &scene.integrator, &to.integrator)?;
    require_same("the lights", &scene.lights, &to.lights)?;
    require_same("the environment", &scene.environment, &environment)?;
    for (read, wanted) in scene.materials.iter().zip(&to.materials) {
        require_same(&format!("material {}", wanted.name), read, wanted)?;
    }
    for (read, wanted) in scene.objects.iter().zip(&to.objects) {
        let facts = |object: &Object| (object.name.clone(), object.material, object.subsurface_group);
        require_same(&format!("object {}", wanted.name), &facts(read), &facts(wanted))?;
    }
    Ok(())
}

/// Far from the world's origin, the last digits of a point are beyond double precision: they become those that were meant.
fn keep_digits(camera: &mut Camera, lights: &mut [Light], to: &Scene) {
    if to.origin == DVec3::ZERO {
        return;
    }
    let error = (4.0 * f64::EPSILON * to.origin.abs().max_element()) as f32;
    let mut wanted = Vec::new();
    let mut collect = |_: &str, part: Part<'_>| {
        if let Part::Number(x, _) = part {
            wanted.push(*x);
        }
    };
    Camera::DESCRIPTION.visit(&mut to.camera.clone(), &mut collect);
    to.lights.iter().for_each(|light| light.description().visit(&mut light.clone(), &mut collect));
    let mut wanted = wanted.into_iter();
    let mut keep = |_: &str, part: Part<'_>| {
        if let (Part::Number(x, _), Some(wanted)) = (part, wanted.next())
            && (*x - wanted).abs() <= error
        {
            *x = wanted;
        }
    };
    Camera::DESCRIPTION.visit(camera, &mut keep);
    lights.iter_mut().for_each(|light| light.description().visit(light, &mut keep));
}

/// Distinguishes values that `==` does not: 0 and -0.
fn require_same<T: Debug>(what: &str, read: &T, wanted: &T) -> Result<()> {
    if format!("{read:?}") == format!("{wanted:?}") {
        Ok(())
    } else {
        Err(unsaid(&format!("the change of {what}")))
    }
}
