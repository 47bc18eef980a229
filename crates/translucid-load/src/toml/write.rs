//! The writer of scene files: what of a scene differs from another, as a file that extends that one.

use std::fmt::Debug;
use std::sync::Arc;

use glam::{Mat3, Vec3};
use translucid_scene::{
    Camera, ColorInput, Light, Material, Object, PARAMETERS, Projection, Scene, SceneError, Slot,
    SubsurfaceModel, Unit, WORD_PARAMETERS,
};

use super::SceneFile;
use super::document::{DocumentText, Setting};
use super::extend::Base;
use super::settings::{FILM, INTEGRATOR};
use super::text::{color, number, numbers, quoted, vector};

/// What a written scene file extends: its keys `extends`, `preset` and `unit`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExtendedBase {
    /// Path of a scene or mesh, relative to the folder that the file will lie in, or "still-life".
    pub extends: String,
    /// Preset of a mesh.
    pub preset: Option<String>,
    /// Unit of a mesh's coordinates.
    pub unit: Option<Unit>,
}

impl ExtendedBase {
    /// A scene file that extends the base and changes its scene, `from`, into `to`.
    ///
    /// `from` is what [`load_scene`](crate::load_scene) makes of the base without further options.
    /// The file says what is different and nothing else, and every number so that it reads back to the same bits.
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
    pub fn write(
        &self,
        from: &Scene,
        to: &Scene,
        environment_file: Option<&str>,
    ) -> Result<String, SceneError> {
        let to = &with_numbers_of(from, to);
        let mut text = format!("extends = {}\n", quoted(&self.extends));
        if let Some(preset) = &self.preset {
            text += &format!("preset = {}\n", quoted(preset));
        }
        if let Some(unit) = self.unit {
            text += &format!("unit = {}\n", quoted(unit.name()));
        }
        // What stands at the root comes before the first table
        let lights = lights(from, to);
        let environment = environment(from, to, environment_file)?;
        let (at_root, in_tables): (Vec<_>, Vec<_>) =
            [lights, environment].into_iter().partition(|part| !part.starts_with('\n'));
        text += &at_root.concat();
        // A camera that is chosen for the base fits the film's size
        let is_resized = [from.film.width, from.film.height] != [to.film.width, to.film.height];
        if from.camera != to.camera || is_resized {
            text += &camera(&to.camera);
        }
        let mut film = from.film;
        if film.filter != to.film.filter {
            // The filter brings a radius of its own
            film.filter_radius = f32::NAN;
        }
        text += &table("\n[film]\n", &settings(FILM, &film, &to.film));
        text += &table("\n[integrator]\n", &settings(INTEGRATOR, &from.integrator, &to.integrator));
        require_same_number("materials", from.materials.len(), to.materials.len())?;
        for (index, (old, new)) in from.materials.iter().zip(&to.materials).enumerate() {
            let header = chosen("material", index, from.materials.iter().map(|material| &material.name));
            text += &table(&header, &material(old, new)?);
        }
        require_same_number("objects", from.objects.len(), to.objects.len())?;
        for (index, (old, new)) in from.objects.iter().zip(&to.objects).enumerate() {
            let lines = object(old, new, to)?;
            if !lines.is_empty() {
                text += &chosen("object", index, from.objects.iter().map(|object| &object.name));
                text += &lines;
            }
        }
        text += &in_tables.concat();
        verify(&text, from, to)?;
        Ok(text)
    }
}

fn require_same_number(things: &str, from: usize, to: usize) -> Result<(), SceneError> {
    if from == to {
        return Ok(());
    }
    Err(SceneError::new(format!(
        "the base has {from} {things} and the changed scene {to}, but both must have as many"
    )))
}

/// A table, if there is something in it.
fn table(header: &str, lines: &str) -> String {
    if lines.is_empty() { String::new() } else { format!("{header}{lines}") }
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

/// Lines of the settings that differ.
fn settings<T>(list: &[Setting<T>], from: &T, to: &T) -> String {
    let lines = list.iter().map(|Setting { key, write, .. }| (key, write(from), write(to)));
    lines.filter(|(_, old, new)| old != new).map(|(key, _, new)| format!("{key} = {new}\n")).collect()
}

fn camera(camera: &Camera) -> String {
    let Camera { position, target, up, projection, shift, lens_radius, focus_distance } = *camera;
    let projection = match projection {
        Projection::Perspective { horizontal_fov } => format!("fov = {}", number(horizontal_fov)),
        Projection::Orthographic { width } => {
            format!("projection = \"orthographic\"\nwidth = {}", number(width))
        }
    };
    format!(
        "\n[camera]\nposition = {}\ntarget = {}\nup = {}\n{projection}\nshift = [{}, {}]\nlens_radius = {}\nfocus_distance = {}\n",
        vector(position),
        vector(target),
        vector(up),
        number(shift.x),
        number(shift.y),
        number(lens_radius),
        number(focus_distance)
    )
}

/// Lines of the parameters that differ.
fn material(from: &Material, to: &Material) -> Result<String, SceneError> {
    let (mut old, mut new) = (from.clone(), to.clone());
    let mut lines = String::new();
    for parameter in PARAMETERS {
        let (old, new) = (parameter.slot(&mut old), parameter.slot(&mut new));
        if let Some(value) = input(&old, &new) {
            lines += &format!("{} = {value}\n", parameter.name);
        }
    }
    lines += &model(from, to)?;
    for parameter in WORD_PARAMETERS.iter().filter(|one| one.word(from) != one.word(to)) {
        lines += &format!("{} = {}\n", parameter.name, quoted(parameter.word(to)));
    }
    match (&from.geometry_normal, &to.geometry_normal) {
        (Some(_), None) => lines += "geometry_normal = \"none\"\n",
        (Some(old), Some(new)) if number(old.scale) != number(new.scale) => {
            lines += &format!("geometry_normal = {{ scale = {} }}\n", number(new.scale));
        }
        _ => {}
    }
    Ok(lines)
}

/// The value of a parameter that differs. An image stays or goes; another one is noticed when the text is read back.
fn input(old: &Slot<'_>, new: &Slot<'_>) -> Option<String> {
    match (old, new) {
        (Slot::Number(old), Slot::Number(new)) => Some(number(**new)).filter(|new| *new != number(**old)),
        (Slot::Scalar(old), Slot::Scalar(new)) => {
            let factor = number(new.factor);
            let is_same = old.texture == new.texture && number(old.factor) == factor;
            let value = if new.texture.is_some() { format!("{{ factor = {factor} }}") } else { factor };
            (!is_same).then_some(value)
        }
        (Slot::Color(old), Slot::Color(new)) => color_input(old, new),
        _ => None,
    }
}

fn color_input(old: &ColorInput, new: &ColorInput) -> Option<String> {
    let factor = color(new.factor);
    let is_same_kind = old.texture == new.texture && old.vertex_color == new.vertex_color;
    if is_same_kind && color(old.factor) == factor {
        return None;
    }
    Some(match new.vertex_color {
        true if new.texture.is_none() && new.factor == Vec3::ONE => String::from("\"vertex\""),
        false if new.texture.is_none() => factor,
        vertex_color => {
            let is_removed = old.texture.is_some() && new.texture.is_none();
            let file = if is_removed { "file = \"none\", " } else { "" };
            format!("{{ {file}factor = {factor}, vertex_color = {vertex_color} }}")
        }
    })
}

/// The model, where it differs.
fn model(from: &Material, to: &Material) -> Result<String, SceneError> {
    match (from.subsurface_model, to.subsurface_model) {
        (old, new) if old == new => Ok(String::new()),
        (_, SubsurfaceModel::Tabulated(_)) => Err(unsaid(&format!("the table of material {}", to.name))),
        (_, new) => Ok(format!("subsurface_model = {}\n", quoted(new.name()))),
    }
}

fn object(from: &Object, to: &Object, scene: &Scene) -> Result<String, SceneError> {
    if from.material == to.material {
        return Ok(String::new());
    }
    let name = scene.materials.get(to.material).map(|material| quoted(&material.name));
    name.map(|name| format!("material = {name}\n"))
        .ok_or_else(|| unsaid(&format!("the material of object {}", to.name)))
}

/// Tables of all lights, if they differ; a line at the root where there are none any more.
fn lights(from: &Scene, to: &Scene) -> String {
    let texts = |scene: &Scene| scene.lights.iter().map(light).collect::<Vec<_>>();
    match texts(to) {
        lights if lights == texts(from) => String::new(),
        lights if lights.is_empty() => String::from("light = []\n"),
        lights => lights.concat(),
    }
}

fn light(light: &Light) -> String {
    let shown = |visible: bool| if visible { "" } else { "visible = false\n" };
    let lines = match *light {
        Light::Rectangle { center, edge_x, edge_y, radiance, visible }
        | Light::Ellipse { center, edge_x, edge_y, radiance, visible } => format!(
            "center = {}\nedge_x = {}\nedge_y = {}\nradiance = {}\n{}",
            vector(center),
            vector(edge_x),
            vector(edge_y),
            color(radiance),
            shown(visible)
        ),
        Light::Sphere { center, radius, radiance, visible } => format!(
            "center = {}\nradius = {}\nradiance = {}\n{}",
            vector(center),
            number(radius),
            color(radiance),
            shown(visible)
        ),
        Light::Distant { direction, angular_radius, irradiance } => format!(
            "{}angular_radius = {}\nirradiance = {}\n",
            direction_line(direction),
            number(angular_radius),
            color(irradiance)
        ),
        Light::Spot { position, direction, radius, intensity, inner_angle, outer_angle, visible } => format!(
            "position = {}\n{}radius = {}\nintensity = {}\ninner_angle = {}\nouter_angle = {}\n{}",
            vector(position),
            direction_line(direction),
            number(radius),
            color(intensity),
            number(inner_angle),
            number(outer_angle),
            shown(visible)
        ),
        Light::Beam { origin, direction, radius, power } => format!(
            "origin = {}\n{}radius = {}\npower = {}\n",
            vector(origin),
            direction_line(direction),
            number(radius),
            color(power)
        ),
    };
    format!("\n[[light]]\ntype = {}\n{lines}", quoted(light.kind()))
}

/// A direction, in the form that is not normalized where that would change its bits.
fn direction_line(direction: Vec3) -> String {
    let is_kept = direction.as_dvec3().try_normalize().map(|read| read.as_vec3()) == Some(direction);
    format!("{} = {}\n", if is_kept { "direction" } else { "unit_direction" }, vector(direction))
}

/// The table of an environment that differs, without a file where it keeps its image; a line at the root where there is
/// none any more.
fn environment(from: &Scene, to: &Scene, file: Option<&str>) -> Result<String, SceneError> {
    if format!("{:?}", from.environment) == format!("{:?}", to.environment) {
        return Ok(String::new());
    }
    let Some(new) = &to.environment else { return Ok(String::from("environment = \"none\"\n")) };
    let file = match new.image {
        image if image == from.environment.and_then(|old| old.image) => String::new(),
        None => String::from("file = \"none\"\n"),
        Some(image) => {
            let file = file.filter(|_| image >= from.images.len());
            let file = file.ok_or_else(|| unsaid("the image of the environment, without a file for it,"))?;
            format!("file = {}\n", quoted(file))
        }
    };
    let base = from.environment.filter(|_| file.is_empty()).unwrap_or_default();
    let mut lines = format!("{file}radiance = {}\n", color(new.radiance));
    if bits(new.world_from_environment) != bits(base.world_from_environment) {
        lines += &rotation(new.world_from_environment);
    }
    if new.visible != base.visible {
        lines += &format!("visible = {}\n", new.visible);
    }
    Ok(format!("\n[environment]\n{lines}"))
}

fn bits(matrix: Mat3) -> [u32; 9] {
    matrix.to_cols_array().map(f32::to_bits)
}

fn rotation(matrix: Mat3) -> String {
    match degrees(matrix) {
        Some(angle) => format!("rotation = {}\n", number(angle)),
        None => format!("matrix = {}\n", numbers(&matrix.transpose().to_cols_array())),
    }
}

/// The angle about y that gives the very bits of a rotation, with few digits if there is such a one.
fn degrees(rotation: Mat3) -> Option<f32> {
    let angle = libm::atan2(f64::from(rotation.z_axis.x), f64::from(rotation.z_axis.z)).to_degrees();
    let rounded = (0..6).map(|digits| 10_f64.powi(digits)).map(|unit| ((angle * unit).round() / unit) as f32);
    let exact = (-4..=4).map(|step| f32::from_bits((angle as f32).to_bits().wrapping_add_signed(step)));
    rounded.chain(exact).find(|angle| bits(Mat3::from_rotation_y(angle.to_radians())) == bits(rotation))
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
fn verify(text: &str, from: &Scene, to: &Scene) -> Result<(), SceneError> {
    let source = DocumentText::of_part("the scene to be written", text);
    let read = SceneFile::of(&source, Base::Known(Box::new(without_meshes(from))), None)?;
    let mut environment = to.environment;
    if let Some(image) = environment.as_mut().and_then(|environment| environment.image.as_mut()) {
        // The only new image that is written
        *image = (*image).min(from.images.len());
    }
    let scene = &read.scene;
    require_same("the camera", &read.camera(None)?, &Some(to.camera))?;
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

/// Tells apart what `==` does not: 0 and -0.
fn require_same<T: Debug>(what: &str, read: &T, wanted: &T) -> Result<(), SceneError> {
    if format!("{read:?}") == format!("{wanted:?}") {
        Ok(())
    } else {
        Err(unsaid(&format!("the change of {what}")))
    }
}
