//! Lamps and cameras inside translucent bodies, which light up and see nothing.

use glam::Vec3;
use translucid_scene::Light;

use crate::ray::Ray;
use crate::subsurface::{Note, NoteKind};
use crate::world::World;

/// Lights that are looked at: to look at more would take longer than anybody waits for a note.
const MOST_LIGHTS: usize = 1024;

/// Directions in which the nearest surface must show its inside, at no round angles.
const DIRECTIONS: [Vec3; 3] =
    [Vec3::new(0.31, 0.84, 0.44), Vec3::new(-0.77, -0.21, 0.6), Vec3::new(0.42, -0.55, -0.72)];

/// Notes on the scene's camera and on its lights.
pub(super) fn notes(world: &World) -> Vec<Note> {
    let scene = &world.scene;
    let note = |object: usize, what: String| {
        let object = &scene.objects[object];
        let material = Some(scene.materials[object.material].name.clone());
        let message = format!(
            "{what} inside the body of object {}, where light is not followed to it; leave a cavity around it in the mesh",
            object.name
        );
        Note { kind: NoteKind::Enclosed, material, message }
    };
    let camera = around(world, scene.camera.position);
    let camera = camera.map(|object| note(object, String::from("the camera may see nothing, because it is")));
    let of_light = |(number, light): (usize, &Light)| {
        let object = around(world, place(light)?)?;
        Some(note(object, format!("light {number} ({}) lights nothing, because it is", light.kind())))
    };
    let lights = scene.lights.iter().enumerate().take(MOST_LIGHTS).filter_map(of_light);
    camera.into_iter().chain(lights).collect()
}

/// The place of a light that has one.
fn place(light: &Light) -> Option<Vec3> {
    match *light {
        Light::Rectangle { center, .. } | Light::Ellipse { center, .. } | Light::Sphere { center, .. } => {
            Some(center)
        }
        Light::Spot { position, .. } => Some(position),
        Light::Beam { origin, .. } => Some(origin),
        Light::Distant { .. } => None,
    }
}

/// The object of a translucent body whose inside is all that is seen from a point.
fn around(world: &World, point: Vec3) -> Option<usize> {
    let seen = DIRECTIONS.map(|direction| {
        let hit = world.geometry.closest(&Ray::new(point, direction.normalize()))?;
        let object = world.geometry.object(&hit) as usize;
        let is_inside = world.geometry.normal(&hit).dot(direction) > 0.0;
        (is_inside && world.scene.materials[world.scene.objects[object].material].has_subsurface())
            .then_some(object)
    });
    let [Some(first), Some(_), Some(_)] = seen else { return None };
    Some(first)
}
