//! A ball with bumps, and the scene that it is rendered in.

use std::f32::consts::{PI, TAU};

use glam::{Mat3, Vec3};
use translucid_profile::Model;
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Integrator, Light, Material, Mesh, Object, Projection,
    ScalarInput, Scene, SubsurfaceModel, Unit,
};

/// Field of view in degrees.
pub(crate) const FIELD_OF_VIEW: f32 = 22.0;
/// Distance of the camera \[L\].
pub(crate) const DISTANCE: f32 = 6.0;

/// A mesh of wax with a mean free path \[L\] in its reddest channel, under a lamp and a sky, in a square picture.
pub(crate) fn scene(mesh: Mesh, length: f32, size: u32) -> Scene {
    let material = Material {
        name: "wax".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::new(0.8, 0.6, 0.4)),
        subsurface_radius: ScalarInput::constant(length),
        subsurface_radius_scale: ColorInput::constant(Vec3::new(1.0, 0.6, 0.4)),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusion),
        ..Material::default()
    };
    Scene {
        unit: Unit::Centimeter,
        camera: Camera {
            position: Vec3::new(0.0, -DISTANCE, 1.0),
            target: Vec3::ZERO,
            up: Vec3::Z,
            projection: Projection::Perspective { horizontal_fov: FIELD_OF_VIEW },
            focus_distance: DISTANCE,
            ..Camera::default()
        },
        film: Film { width: size, height: size, ..Film::default() },
        integrator: Integrator::default(),
        objects: vec![Object {
            name: "wax".into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 0,
            ..Object::default()
        }],
        materials: vec![material],
        images: Vec::new(),
        profile_tables: Vec::new(),
        lights: vec![Light::Rectangle {
            center: Vec3::new(4.0, -2.0, 4.0),
            edge_x: Vec3::new(-0.5, 0.7, 0.8),
            edge_y: Vec3::new(0.45, 0.42, -0.086),
            radiance: Vec3::splat(20.0),
            visible: false,
        }],
        environment: Some(Environment {
            radiance: Vec3::splat(0.2),
            image: None,
            world_from_environment: Mat3::IDENTITY,
            visible: false,
        }),
        ..Scene::default()
    }
}

/// A ball with bumps, 2 across, of about so many triangles.
pub(crate) fn bumpy_ball(triangles: u64) -> Mesh {
    let rows = ((triangles as f64 / 4.0).sqrt().round() as u32).max(4);
    let columns = 2 * rows;
    let mut mesh = Mesh::default();
    for (i, j) in (0..=rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let (theta, phi) = (PI * i as f32 / rows as f32, TAU * j as f32 / columns as f32);
        let bump = 0.04 * (11.0 * theta).sin() * (9.0 * phi).sin() * theta.sin();
        let direction = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        mesh.positions.push(direction * (0.96 + bump));
    }
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let (a, b) = (i * columns + j, i * columns + (j + 1) % columns);
        if i > 0 {
            mesh.triangles.push([a, a + columns, b]);
        }
        if i + 1 < rows {
            mesh.triangles.push([b, a + columns, b + columns]);
        }
    }
    mesh
}
