//! Scenes with each of their values changed to worse, one at a time.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use translucid_scene::description::{Part, Thing, Visit};
use translucid_scene::{
    Camera, Environment, Film, Image, Integrator, Material, Mesh, Object, Pixels, ProfileRow, ProfileTable,
    Scene,
};

/// Numbers that are likely to hurt.
const NUMBERS: [f32; 12] =
    [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1e38, -1e38, 1e-45, 1e-20, 2.0, 1e9, f32::MAX];
/// Counts that are likely to hurt.
const COUNTS: [u32; 4] = [0, 1 << 20, 1 << 31, u32::MAX];
/// Indices that are likely to hurt.
const INDICES: [usize; 4] = [0, 1, 100, usize::MAX];

/// A scene with one value changed.
#[derive(Clone, Debug)]
pub struct BrokenScene {
    /// Place of the value, as the message of [`Scene::validate`] begins if it refuses the scene.
    pub place: String,
    /// New value, in words.
    pub change: String,
    /// Whether the scene breaks a rule for sure; others may.
    pub is_invalid: bool,
    /// The scene.
    pub scene: Scene,
}

/// Every change of every value of a scene, one at a time.
pub fn broken_scenes(scene: &Scene) -> impl Iterator<Item = BrokenScene> {
    let mut count = 0;
    visit(&mut scene.clone(), &mut |_, slot| count += slot.changes());
    (0..count).map(|number| broken_scene(scene, number))
}

/// The scene with the change of a number.
fn broken_scene(scene: &Scene, number: usize) -> BrokenScene {
    let mut broken =
        BrokenScene { place: String::new(), change: String::new(), is_invalid: false, scene: scene.clone() };
    let mut before = 0;
    let BrokenScene { place, change, is_invalid, scene } = &mut broken;
    visit(scene, &mut |name, slot| {
        let own = slot.changes();
        if let Some(number) = number.checked_sub(before).filter(|&number| number < own) {
            *place = name.to_owned();
            (*change, *is_invalid) = slot.change(number);
        }
        before += own;
    });
    broken
}

/// A value that can be changed.
enum SceneSlot<'a> {
    Number(&'a mut f32),
    Double(&'a mut f64),
    Count(&'a mut u32),
    Index(&'a mut usize),
    List(&'a mut dyn Cut),
}

impl SceneSlot<'_> {
    fn changes(&self) -> usize {
        match self {
            Self::Number(_) | Self::Double(_) => NUMBERS.len(),
            Self::Count(_) => COUNTS.len(),
            Self::Index(_) => INDICES.len(),
            Self::List(_) => 3,
        }
    }

    /// Makes the change of a number; returns it in words, and whether no valid scene has such a value.
    fn change(self, number: usize) -> (String, bool) {
        match self {
            Self::Number(slot) => {
                *slot = NUMBERS[number];
                (slot.to_string(), !slot.is_finite())
            }
            Self::Double(slot) => {
                *slot = f64::from(NUMBERS[number]);
                (slot.to_string(), !slot.is_finite())
            }
            Self::Count(slot) => {
                *slot = COUNTS[number];
                (slot.to_string(), false)
            }
            Self::Index(slot) => {
                *slot = INDICES[number];
                (slot.to_string(), *slot >= 100)
            }
            Self::List(list) => list.cut(number),
        }
    }
}

/// A list that can be made shorter or longer.
trait Cut {
    fn cut(&mut self, number: usize) -> (String, bool);
}

impl<T: Clone> Cut for Vec<T> {
    fn cut(&mut self, number: usize) -> (String, bool) {
        let change = match number {
            0 => {
                self.clear();
                "emptied"
            }
            1 => {
                self.pop();
                "without its last"
            }
            _ => {
                self.extend(self.first().cloned());
                "with its first again at its end"
            }
        };
        (String::from(change), false)
    }
}

/// Receives the place and the slot of each value.
type Visitor<'a> = dyn FnMut(&str, SceneSlot<'_>) + 'a;

/// Shows every value of a scene; a new field of a type is an error here.
fn visit(scene: &mut Scene, v: &mut Visitor<'_>) {
    let Scene {
        unit: _,
        // Nothing is measured from it
        origin: _,
        camera,
        film,
        integrator,
        objects,
        materials,
        images,
        profile_tables,
        lights,
        environment,
        files: _,
    } = scene;
    visit_described("camera", camera, &Camera::DESCRIPTION, v);
    visit_described("film", film, &Film::DESCRIPTION, v);
    visit_described("integrator", integrator, &Integrator::DESCRIPTION, v);
    v("objects", SceneSlot::List(objects));
    objects.iter_mut().for_each(|object| visit_object(object, v));
    v("materials", SceneSlot::List(materials));
    for material in materials {
        let name = format!("material {}", material.name);
        visit_described(&name, material, &Material::DESCRIPTION, v);
    }
    v("images", SceneSlot::List(images));
    images.iter_mut().for_each(|image| visit_image(Arc::make_mut(image), v));
    v("profile_tables", SceneSlot::List(profile_tables));
    profile_tables.iter_mut().for_each(|table| visit_table(table, v));
    v("lights", SceneSlot::List(lights));
    for (i, light) in lights.iter_mut().enumerate() {
        let name = format!("light {i} ({})", light.kind());
        let kind = light.description();
        visit_described(&name, light, kind, v);
    }
    if let Some(environment) = environment {
        visit_described("environment", environment, &Environment::DESCRIPTION, v);
    }
}

fn visit_numbers<'a>(place: &str, numbers: impl IntoIterator<Item = &'a mut f32>, v: &mut Visitor<'_>) {
    for (i, number) in numbers.into_iter().enumerate() {
        v(&format!("{place}[{i}]"), SceneSlot::Number(number));
    }
}

fn visit_vector(place: &str, vector: &mut Vec3, v: &mut Visitor<'_>) {
    visit_numbers(place, vector.as_mut(), v);
}

/// Shows every number of a thing that has a description.
fn visit_described<T: Clone>(name: &str, thing: &mut T, by: &Thing<T>, v: &mut Visitor<'_>) {
    by.visit(thing, &mut |key, part| {
        let slot = match part {
            Part::Number(number, _) => SceneSlot::Number(number),
            Part::Count(count, _) => SceneSlot::Count(count),
            Part::Index(index, _) => SceneSlot::Index(index),
        };
        v(&format!("{name}, {key}"), slot);
    });
}

fn visit_object(object: &mut Object, v: &mut Visitor<'_>) {
    let Object { name, mesh, world_from_local, material, subsurface_group, is_movable: _ } = object;
    let place = |field: &str| format!("object {name}, {field}");
    let mut numbers = world_from_local.to_cols_array();
    numbers.iter_mut().for_each(|number| v(&place("world_from_local"), SceneSlot::Number(number)));
    *world_from_local = Affine3A::from_cols_array(&numbers);
    v(&place("material"), SceneSlot::Index(material));
    v(&place("subsurface_group"), SceneSlot::Count(subsurface_group));
    let Mesh { positions, normals, uvs, tangents, colors, triangles } = Arc::make_mut(mesh);
    let place = |field: &str| place(&format!("mesh, {field}"));
    v(&place("positions"), SceneSlot::List(positions));
    v(&place("normals"), SceneSlot::List(normals));
    v(&place("uvs"), SceneSlot::List(uvs));
    v(&place("tangents"), SceneSlot::List(tangents));
    v(&place("colors"), SceneSlot::List(colors));
    v(&place("triangles"), SceneSlot::List(triangles));
    for (list, name) in [(positions, "positions"), (normals, "normals"), (colors, "colors")] {
        for (i, vector) in list.iter_mut().enumerate() {
            visit_vector(&place(&format!("{name}[{i}]")), vector, v);
        }
    }
    for (i, uv) in uvs.iter_mut().enumerate() {
        visit_numbers(&place(&format!("uvs[{i}]")), uv.as_mut(), v);
    }
    for (i, tangent) in tangents.iter_mut().enumerate() {
        visit_numbers(&place(&format!("tangents[{i}]")), tangent.as_mut(), v);
    }
    for (i, corners) in triangles.iter_mut().enumerate() {
        corners.iter_mut().for_each(|vertex| v(&place(&format!("triangles[{i}]")), SceneSlot::Count(vertex)));
    }
}

fn visit_image(image: &mut Image, v: &mut Visitor<'_>) {
    let Image { name, path: _, width, height, color_space: _, pixels } = image;
    let place = |field: &str| format!("image {name}, {field}");
    v(&place("width"), SceneSlot::Count(width));
    v(&place("height"), SceneSlot::Count(height));
    match pixels {
        Pixels::Byte(pixels) => v(&place("pixels"), SceneSlot::List(pixels)),
        Pixels::Float(pixels) => {
            v(&place("pixels"), SceneSlot::List(pixels));
            pixels.iter_mut().for_each(|pixel| visit_numbers(&place("pixel"), pixel, v));
        }
    }
}

fn visit_table(table: &mut ProfileTable, v: &mut Visitor<'_>) {
    let ProfileTable { path, rows } = table;
    let place = |field: &str| format!("profile table {}, {field}", path.display());
    v(&place("rows"), SceneSlot::List(rows));
    for (i, row) in rows.iter_mut().enumerate() {
        let ProfileRow { surface_albedo, radii, reflectances, enclosed } = row;
        let place = |field: &str| place(&format!("rows[{i}], {field}"));
        surface_albedo.iter_mut().for_each(|albedo| v(&place("surface_albedo"), SceneSlot::Double(albedo)));
        for (name, list) in [("radii", radii), ("reflectances", reflectances), ("enclosed", enclosed)] {
            v(&place(name), SceneSlot::List(list));
            list.iter_mut().for_each(|number| v(&place(name), SceneSlot::Double(number)));
        }
    }
}

#[cfg(test)]
mod tests {
    use translucid_scene::Light;

    use super::*;
    use crate::scene_of_everything;

    #[test]
    fn scene_of_everything_is_valid() {
        assert_eq!(scene_of_everything().validate(), Ok(()));
    }

    #[test]
    fn broken_scenes_are_refused_where_they_are_broken() {
        let (mut refused, mut accepted) = (0, 0);
        for BrokenScene { place, change, is_invalid, scene } in broken_scenes(&scene_of_everything()) {
            let Err(error) = scene.validate() else {
                assert!(!is_invalid, "{place} = {change} is accepted");
                accepted += 1;
                continue;
            };
            refused += 1;
            let message = &error.message;
            assert!(error.place.is_none(), "{message} is not in a file");
            let telling =
                ["must be", "must have", "must rise", "but"].iter().any(|words| message.contains(words));
            assert!(telling || place.starts_with("profile table"), "{place} = {change}: {message}");
            if is_invalid {
                // Vectors are shown whole, without the number of the component.
                let field = place.trim_end_matches(|c: char| c.is_ascii_digit() || "[]".contains(c));
                assert!(message.starts_with(field), "{place} = {change}: {message}");
                assert!(message.contains(" = "), "{place} = {change}: {message}");
            }
        }
        // Neither everything nor nothing is refused.
        assert!(refused > 3000 && accepted > 1000, "{refused} refused, {accepted} accepted");
    }

    #[test]
    fn scenes_broken_between_fields_are_refused() {
        let refusal = |change: fn(&mut Scene)| {
            let mut scene = scene_of_everything();
            change(&mut scene);
            scene.validate().expect_err("the scene is broken").message
        };
        let message = refusal(|scene| scene.camera.target = scene.camera.position);
        assert_eq!(message, "camera, target = [0, 0, 5]: must be a point other than the camera's position");
        let message = refusal(|scene| scene.camera.up = Vec3::NEG_Z);
        let must_be = "must be a direction that is not parallel to the viewing direction";
        assert_eq!(message, format!("camera, up = [0, 0, -1]: {must_be}"));
        let message = refusal(|scene| scene.camera.lens_radius = 1281.0);
        let must_be =
            "must be at most 256 times the distance to `target` or the plane in focus, whichever is greater";
        assert_eq!(message, format!("camera, lens_radius = 1281: {must_be}"));
        let message = refusal(|scene| scene.objects.clear());
        assert_eq!(message, "the scene has no objects, but must have at least one");
        let message = refusal(|scene| {
            scene.objects.iter_mut().for_each(|object| object.name = "twin".into());
            scene.objects[1].material = 4;
        });
        assert_eq!(
            message,
            "object twin (index 1), material = 4: must be less than 4, the number of materials"
        );
        let message = refusal(|scene| {
            scene.lights[0] = Light::Rectangle {
                center: Vec3::ZERO,
                edge_x: Vec3::X,
                edge_y: Vec3::new(0.1, 1.0, 0.0),
                radiance: Vec3::ONE,
                visible: false,
            }
        });
        assert!(message.ends_with("must be perpendicular to edge_x"), "{message}");
    }
}
