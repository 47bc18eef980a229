//! What is lost to those inside bodies or against them: lamps and cameras inside translucent bodies, cameras inside opaque
//! ones, glass that touches a body.

use std::collections::BTreeSet;

use glam::Vec3;
use translucid_scene::{Light, Material, Projection, ScalarInput, Scene};

use crate::ray::{Ray, offset_at};
use crate::subsurface::{Note, NoteKind};
use crate::world::World;

/// Lights that are looked at: to look at more would take longer than anybody waits for a note.
const MOST_LIGHTS: usize = 1024;

/// Directions in which the nearest surface must show its inside, at no round angles.
const DIRECTIONS: [Vec3; 3] =
    [Vec3::new(0.31, 0.84, 0.44), Vec3::new(-0.77, -0.21, 0.6), Vec3::new(0.42, -0.55, -0.72)];

/// Directions in which an opaque body must show its inside: a room of one mesh may have windows.
const MANY_DIRECTIONS: usize = 256;

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
    let camera = camera.or_else(|| {
        let object = &scene.objects[closed_around(world, scene.camera.position)?];
        let material = Some(scene.materials[object.material].name.clone());
        let message = format!(
            "the camera sees nothing but the inside of object {}, which is opaque, and no light is in there; place it \
             outside, or look at a mesh file from --view front",
            object.name
        );
        Some(Note { kind: NoteKind::Enclosed, material, message })
    });
    let of_light = |(number, light): (usize, &Light)| {
        let object = around(world, place(light)?)?;
        Some(note(object, format!("light {number} ({}) lights nothing, because it is", light.kind())))
    };
    let lights = scene.lights.iter().enumerate().take(MOST_LIGHTS).filter_map(of_light);
    camera.into_iter().chain(lights).chain(touching(world)).collect()
}

/// Bodies whose surfaces are looked at, and triangles of each.
const MOST_BODIES: usize = 256;
const TRIANGLES: usize = 64;
/// Distance of surfaces that are at one place, in offsets of rays, which then skip the second.
const AT_ONE_PLACE: f32 = 4.0;

/// Notes on bodies of which a quarter of the surface or more is where that of glass is.
fn touching(world: &World) -> Vec<Note> {
    let scene = &world.scene;
    let is_glass = |material: &Material| {
        material.transmission_weight != ScalarInput::constant(0.0) && !material.geometry_thin_walled
    };
    let glass = |object: usize| is_glass(&scene.materials[scene.objects[object].material]);
    let groups: BTreeSet<u32> = (0..scene.objects.len())
        .filter(|&object| glass(object))
        .map(|object| scene.objects[object].subsurface_group)
        .take(MOST_BODIES)
        .collect();
    let glass_at = |number: usize, triangle: usize| {
        let [a, b, c] = scene.objects[number].vertices(triangle);
        let (center, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a).try_normalize()?);
        let reach = AT_ONE_PLACE * offset_at(center.abs().max_element());
        let ray = Ray::segment(center + normal * reach, -normal, 2.0 * reach);
        let mut found = None;
        for &group in &groups {
            world.geometry.all_in_group(&ray, group, |hit| {
                let object = world.geometry.object(&hit) as usize;
                found = found.or((object != number && glass(object)).then_some(object));
            });
        }
        found
    };
    let note = |number: usize| {
        let object = &scene.objects[number];
        let count = object.mesh.triangles.len();
        let looked_at: Vec<usize> = (0..count).step_by(count.div_ceil(TRIANGLES).max(1)).collect();
        let found: Vec<usize> = looked_at.iter().filter_map(|&triangle| glass_at(number, triangle)).collect();
        let first = (4 * found.len() >= looked_at.len()).then(|| found.first()).flatten()?;
        let message = format!(
            "object {} has its surface where that of {} is, and light is lost between them; let it reach a little into the \
             glass, or leave a gap",
            object.name, scene.objects[*first].name
        );
        let material = Some(scene.materials[object.material].name.clone());
        Some(Note { kind: NoteKind::Touching, material, message })
    };
    let is_body = |number: &usize| {
        let material = &scene.materials[scene.objects[*number].material];
        material.has_subsurface() && !is_glass(material)
    };
    (0..scene.objects.len()).filter(is_body).take(MOST_BODIES).filter_map(note).collect()
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
    let is_translucent =
        |object: &usize| world.scene.materials[world.scene.objects[*object].material].has_subsurface();
    let seen = DIRECTIONS.map(|direction| inside_seen(world, point, direction).filter(is_translucent));
    let [Some(first), Some(_), Some(_)] = seen else { return None };
    Some(first)
}

/// The one object whose opaque inside is all that is seen from a point, if no light is among what it holds.
fn closed_around(world: &World, point: Vec3) -> Option<usize> {
    let first = inside_seen(world, point, DIRECTIONS[0])?;
    let scene = &world.scene;
    // Others see from more than a point
    let is_perspective = matches!(scene.camera.projection, Projection::Perspective { .. });
    if !is_perspective || !is_opaque(&scene.materials[scene.objects[first].material]) {
        return None;
    }
    // Directions of equal areas along a spiral
    let is_seen = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f32 / MANY_DIRECTIONS as f32;
        let (sin, cos) = libm::sincosf(2.399_963_2 * i as f32);
        let direction = Vec3::new(cos, sin, 0.0) * (1.0 - z * z).max(0.0).sqrt() + Vec3::Z * z;
        inside_seen(world, point, direction) == Some(first)
    };
    ((0..MANY_DIRECTIONS).all(is_seen) && !may_be_lit_inside(scene, first)).then_some(first)
}

/// Whether a lamp is in the box around an object, or something there glows; this errs on the side of light.
fn may_be_lit_inside(scene: &Scene, index: usize) -> bool {
    let bounds = |index: usize| {
        let object = &scene.objects[index];
        let corners = object.mesh.positions.iter().map(|p| object.world_from_local.transform_point3(*p));
        corners.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
    };
    let [low, high] = bounds(index);
    let holds = |[a, b]: [Vec3; 2]| a.cmple(high).all() && b.cmpge(low).all();
    let glows = |other: &usize| scene.materials[scene.objects[*other].material].emission_luminance > 0.0;
    scene.lights.iter().filter_map(place).any(|at| holds([at, at]))
        || (0..scene.objects.len()).filter(glows).any(|other| holds(bounds(other)))
}

/// Whether no light comes through.
fn is_opaque(material: &Material) -> bool {
    material.transmission_weight.factor == 0.0
        && material.subsurface_weight.factor == 0.0
        && material.geometry_opacity.factor == 1.0
        && material.geometry_opacity.texture.is_none()
}

/// The object whose inside is the nearest surface.
fn inside_seen(world: &World, point: Vec3, direction: Vec3) -> Option<usize> {
    let direction = direction.normalize();
    let hit = world.geometry.closest(&Ray::new(point, direction))?;
    let is_inside = world.geometry.normal(&hit).dot(direction) > 0.0;
    is_inside.then(|| world.geometry.object(&hit) as usize)
}
