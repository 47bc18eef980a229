//! Small scenes.

use glam::{Mat3, Vec3};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Integrator, Light, Material, Mesh, Object, Projection,
    ScalarInput, Scene, Unit,
};

/// A middle gray.
pub(crate) const GRAY: Vec3 = Vec3::splat(0.5);

/// A Lambertian material without an interface.
pub(crate) fn matte(color: Vec3) -> Material {
    Material {
        base_color: ColorInput::constant(color),
        specular_weight: ScalarInput::constant(0.0),
        ..Material::default()
    }
}

/// Two triangles spanning center ± x ± y, normal along x × y.
pub(crate) fn quad(center: Vec3, x: Vec3, y: Vec3) -> Mesh {
    Mesh {
        positions: vec![center - x - y, center + x - y, center + x + y, center - x + y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// Objects of one material and one subsurface group, one scattering event, no light.
pub(crate) fn scene(meshes: Vec<Mesh>, material: Material) -> Scene {
    let objects = meshes
        .into_iter()
        .map(|mesh| Object {
            name: "object".into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 0,
            ..Object::default()
        })
        .collect();
    Scene {
        unit: Unit::Millimeter,
        camera: Camera {
            position: Vec3::Z,
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Perspective { horizontal_fov: 45.0 },
            focus_distance: 1.0,
            ..Camera::default()
        },
        film: Film { width: 16, height: 16, ..Film::default() },
        integrator: Integrator { max_depth: 1, ..Integrator::default() },
        objects,
        materials: vec![material],
        images: Vec::new(),
        profile_tables: Vec::new(),
        lights: Vec::new(),
        environment: None,
        ..Scene::default()
    }
}

/// Environment of the same radiance from everywhere, which the camera does not see.
pub(crate) fn uniform_environment(radiance: Vec3) -> Option<Environment> {
    Some(Environment { radiance, image: None, world_from_environment: Mat3::IDENTITY, visible: false })
}

/// A distant delta light of irradiance 1 on a surface that faces it.
pub(crate) fn distant(toward: Vec3) -> Light {
    Light::Distant { direction: toward.normalize(), angular_radius: 0.0, irradiance: Vec3::ONE }
}

/// A UV sphere with outward normals.
pub(crate) fn sphere(radius: f32, rows: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let columns = 2 * rows;
    for i in 0..=rows {
        for j in 0..columns {
            let (theta, phi) = (
                std::f32::consts::PI * i as f32 / rows as f32,
                std::f32::consts::TAU * j as f32 / columns as f32,
            );
            let n = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            mesh.positions.push(n * radius);
            mesh.normals.push(n);
        }
    }
    for i in 0..rows {
        for j in 0..columns {
            let (a, b) = (i * columns + j, i * columns + (j + 1) % columns);
            let (c, e) = (a + columns, b + columns);
            if i > 0 {
                mesh.triangles.push([a, c, b]);
            }
            if i + 1 < rows {
                mesh.triangles.push([b, c, e]);
            }
        }
    }
    mesh
}
