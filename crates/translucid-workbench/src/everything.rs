//! A small valid scene with a bit of everything.

use std::sync::Arc;

use glam::{Affine2, Affine3A, Mat3, Vec2, Vec3, Vec4};
use translucid_profile::Model;
use translucid_scene::description::SceneSlot;
use translucid_scene::{
    Camera, Channel, ColorSpace, Environment, Film, Image, Integrator, LayerMedium, Light, Material, Mesh,
    NormalMap, Object, Pixels, ProfileRow, ProfileTable, ScalarInput, Scene, SubsurfaceLayer,
    SubsurfaceModel, TextureFilter, TextureRef, Unit, WalkSurface, Wrap,
};

/// A valid scene with every kind of light, of material and of texture, four triangulated tetrahedra and a film of 8 × 8
/// pixels.
pub fn scene_of_everything() -> Scene {
    let material = |name: &str, subsurface_model| Material {
        name: name.into(),
        subsurface_weight: ScalarInput::constant(0.8),
        subsurface_radius: ScalarInput::constant(0.2),
        subsurface_model,
        ..Material::default()
    };
    Scene {
        unit: Unit::Millimeter,
        camera: Camera { lens_radius: 0.01, ..Camera::default() },
        film: Film { width: 8, height: 8, ..Film::default() },
        integrator: Integrator { samples_per_pixel: 1, max_depth: 6, ..Integrator::default() },
        objects: (0..4).map(object).collect(),
        materials: vec![
            textured(material("painted", SubsurfaceModel::Profile(Model::NormalizedDiffusion))),
            material("measured", SubsurfaceModel::Tabulated(0)),
            Material {
                transmission_weight: ScalarInput::constant(0.5),
                transmission_depth: 0.5,
                coat_weight: ScalarInput::constant(0.5),
                emission_luminance: 0.5,
                geometry_opacity: ScalarInput::constant(0.9),
                layers: layers(),
                ..material("wandering", SubsurfaceModel::RandomWalk(WalkSurface::Clear))
            },
            Material {
                transmission_weight: ScalarInput::constant(0.5),
                geometry_thin_walled: true,
                ..material("leaf", SubsurfaceModel::Default)
            },
        ],
        images: vec![Arc::new(bytes()), Arc::new(floats())],
        profile_tables: vec![profile_table()],
        lights: lights(),
        environment: Some(Environment {
            radiance: Vec3::splat(0.2),
            image: Some(1),
            world_from_environment: Mat3::from_rotation_y(0.5),
            visible: true,
        }),
        ..Scene::default()
    }
}

/// A layer of each kind.
fn layers() -> Vec<SubsurfaceLayer> {
    let color = Vec3::new(0.3, 0.5, 0.7);
    let media = [
        LayerMedium::Appearance { surface_albedo: color, mfp: color },
        LayerMedium::Coefficients { scattering: color, absorption: color },
    ];
    media.map(|medium| SubsurfaceLayer { thickness: 0.05, medium, g: 0.3 }).to_vec()
}

/// A tetrahedron with every attribute.
fn object(number: usize) -> Object {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let mut mesh = Mesh {
        positions: corners.map(|p| p + Vec3::X * (number as f32 - 1.0) * 0.9).into(),
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE],
        colors: vec![Vec3::splat(0.9); 4],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..Mesh::default()
    };
    mesh.normals = mesh.smooth_normals();
    let tangent = |n: &Vec3| n.any_orthonormal_vector().extend(1.0);
    mesh.tangents = mesh.normals.iter().map(tangent).collect::<Vec<Vec4>>();
    // The second one is a mirror image
    let scale = if number == 1 { Vec3::new(-1.0, 1.5, 1.0) } else { Vec3::ONE };
    Object {
        name: format!("body {number}"),
        mesh: mesh.into(),
        world_from_local: Affine3A::from_scale(scale),
        material: number,
        subsurface_group: number as u32 % 2,
        is_movable: number == 1,
    }
}

/// A material whose inputs all have images or vertex colors.
fn textured(mut material: Material) -> Material {
    let texture = TextureRef {
        image: 0,
        image_from_uv: Affine2::from_scale(Vec2::splat(2.0)),
        wrap: [Wrap::Mirror, Wrap::Clamp],
        filter: TextureFilter::Nearest,
    };
    for field in Material::DESCRIPTION.fields {
        match (field.slot)(&mut material) {
            SceneSlot::Scalar(input, _) => input.texture = Some((texture, Channel::Green)),
            SceneSlot::Color(input, _) => {
                input.texture = Some(texture);
                input.vertex_color = true;
            }
            _ => {}
        }
    }
    material.geometry_normal = Some(NormalMap { texture, scale: 0.5 });
    material
}

fn bytes() -> Image {
    let pixels = Pixels::Byte((0..6).map(|i| [40 * i, 128, 255 - i, 200]).collect());
    Image { name: "bytes".into(), path: None, width: 3, height: 2, color_space: ColorSpace::Srgb, pixels }
}

fn floats() -> Image {
    let pixels = Pixels::Float(vec![[0.5, 1.0, 2.0, 1.0]; 4]);
    Image { name: "floats".into(), path: None, width: 2, height: 2, color_space: ColorSpace::Linear, pixels }
}

fn profile_table() -> ProfileTable {
    let row = |surface_albedo: f64| {
        let radii: Vec<f64> = (0..8).map(|i| 0.05 * 2_f64.powi(i)).collect();
        let reflectances = radii.iter().map(|r| surface_albedo * libm::exp(-r) / r).collect();
        let enclosed = radii.iter().map(|r| -surface_albedo * libm::expm1(-r)).collect();
        ProfileRow { surface_albedo: Some(surface_albedo), radii, reflectances, enclosed }
    };
    ProfileTable { path: "table.csv".into(), rows: vec![row(0.3), row(0.9)] }
}

/// One of every kind, and one that shines from a single direction.
fn lights() -> Vec<Light> {
    let sun = Light::Distant { direction: Vec3::Z, angular_radius: 0.0, irradiance: Vec3::ONE };
    Light::KINDS.map(|kind| (kind.plain)()).into_iter().chain([sun]).collect()
}
