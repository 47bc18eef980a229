//! Scenes drawn at random: three things on a floor, materials of every kind that devices have, lights and a sky.

use std::sync::Arc;

use glam::{Affine2, Affine3A, Mat3, Quat, Vec2, Vec3};
use translucid_profile::Model;
use translucid_scene::{
    Camera, Channel, ColorInput, ColorSpace, Environment, Film, Image, Light, Material, Mesh, NormalMap,
    Object, Pixels, Projection, ScalarInput, Scene, SubsurfaceModel, TextureRef, WalkSurface, Wrap,
};
use translucid_shapes::{ShapeParameters, build_shape};
use translucid_testing::SplitMix;

const SHAPES: [&str; 8] = ["sphere", "box", "cylinder", "cone", "torus", "pear", "tooth", "duck"];
const MODELS: [Model; 6] = [
    Model::NormalizedDiffusion,
    Model::NormalizedDiffusionRefined,
    Model::NormalizedDiffusionOblique,
    Model::Dipole,
    Model::QuantizedDiffusion,
    Model::Gaussians,
];

/// Random numbers as the parts of a scene need them.
struct Draw(SplitMix);

impl Draw {
    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.0.uniform_f32()
    }

    fn is(&mut self, chance: f32) -> bool {
        self.0.uniform_f32() < chance
    }

    fn of<T: Copy>(&mut self, things: &[T]) -> T {
        things[self.0.below(things.len())]
    }

    fn color(&mut self, low: f32, high: f32) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.within(low, high)))
    }

    /// A direction that points up.
    fn upward(&mut self) -> Vec3 {
        let around = self.within(0.0, std::f32::consts::TAU);
        let height = self.within(0.3, 1.0);
        let width = (1.0 - height * height).sqrt();
        Vec3::new(width * around.cos(), height, width * around.sin())
    }

    fn turn(&mut self) -> Quat {
        Quat::from_axis_angle(self.upward(), self.within(0.0, 6.0))
    }
}

/// The scene of a number.
pub(super) fn scene(number: u64) -> Scene {
    let draw = &mut Draw(SplitMix(number));
    let mut scene = Scene {
        camera: camera(draw),
        film: Film { width: super::EDGE, height: super::EDGE, ..Film::default() },
        images: vec![image(draw, 6, 4, 1.0), image(draw, 8, 4, 3.0)],
        materials: (0..4).map(|index| material(draw, index)).collect(),
        lights: (0..=draw.0.below(3)).map(|_| light(draw)).collect(),
        ..Scene::default()
    };
    scene.integrator.caustics = draw.is(0.3);
    scene.integrator.max_depth = draw.of(&[6, 12, 32]);
    scene.objects = (0..3).map(|index| thing(draw, index)).collect();
    scene.objects.push(floor());
    // Those are drawn from by the normal on the processor alone, so that nothing is the same then
    let image = draw.is(0.2).then_some(1);
    scene.environment = Some(Environment {
        radiance: draw.color(0.1, 0.6),
        image,
        world_from_environment: Mat3::from_quat(draw.turn()),
        visible: draw.is(0.6),
    });
    scene
}

fn camera(draw: &mut Draw) -> Camera {
    let position = draw.upward() * draw.within(5.0, 8.0);
    let projection = match draw.is(0.8) {
        true => Projection::Perspective { horizontal_fov: draw.within(25.0, 45.0) },
        false => Projection::Orthographic { width: draw.within(3.0, 5.0) },
    };
    let lens_radius = if draw.is(0.3) { 0.05 } else { 0.0 };
    Camera {
        position,
        target: Vec3::Y * 0.3,
        projection,
        lens_radius,
        focus_distance: position.length(),
        ..Camera::default()
    }
}

fn image(draw: &mut Draw, width: u32, height: u32, most: f32) -> Arc<Image> {
    let texels = (0..width * height).map(|_| draw.color(0.05, most).extend(1.0).to_array());
    let pixels = Pixels::Float(texels.collect());
    Arc::new(Image {
        name: "image".into(),
        path: None,
        width,
        height,
        color_space: ColorSpace::Linear,
        pixels,
    })
}

fn texture(draw: &mut Draw) -> TextureRef {
    let scale = Vec2::new(draw.within(0.5, 3.0), draw.within(0.5, 3.0));
    TextureRef {
        image_from_uv: Affine2::from_scale_angle_translation(scale, draw.within(0.0, 1.0), Vec2::splat(0.1)),
        wrap: [Wrap::Repeat, draw.of(&[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp])],
        ..TextureRef::new(0)
    }
}

fn tinted(draw: &mut Draw, low: f32, high: f32) -> ColorInput {
    let texture = draw.is(0.25).then(|| texture(draw));
    ColorInput { factor: draw.color(low, high), texture, vertex_color: draw.is(0.1) }
}

fn material(draw: &mut Draw, index: usize) -> Material {
    let mut material = Material {
        name: format!("material {index}"),
        base_color: tinted(draw, 0.1, 0.9),
        specular_weight: ScalarInput::constant(draw.of(&[0.0, 0.5, 1.0])),
        specular_roughness: ScalarInput::constant(draw.within(0.1, 0.8)),
        specular_ior: draw.within(1.3, 1.7),
        subsurface_scatter_anisotropy: draw.of(&[0.0, 0.5, 0.8]),
        ..Material::default()
    };
    if draw.is(0.25) {
        material.specular_roughness.texture = Some((texture(draw), Channel::Green));
    }
    if draw.is(0.2) {
        material.coat_weight = ScalarInput::constant(draw.within(0.3, 1.0));
        material.coat_color = ColorInput::constant(draw.color(0.6, 1.0));
        material.coat_roughness = ScalarInput::constant(draw.of(&[0.0, 0.1, 0.4]));
    }
    if draw.is(0.15) {
        material.geometry_normal = Some(NormalMap { texture: texture(draw), scale: 0.3 });
    }
    if draw.is(0.1) {
        material.geometry_opacity = ScalarInput::constant(draw.within(0.3, 0.9));
    }
    match draw.0.below(8) {
        0 => material.base_metalness = ScalarInput::constant(draw.of(&[0.5, 1.0])),
        1 => {
            material.transmission_weight = ScalarInput::constant(draw.of(&[0.6, 1.0]));
            material.transmission_color = ColorInput::constant(draw.color(0.5, 1.0));
            material.transmission_depth = draw.of(&[0.0, 0.7]);
        }
        2 => {
            material.geometry_thin_walled = true;
            material.transmission_weight = ScalarInput::constant(draw.of(&[0.0, 0.8]));
            material.subsurface_weight = ScalarInput::constant(draw.within(0.4, 1.0));
            material.subsurface_color = tinted(draw, 0.3, 0.9);
        }
        3 => {
            material.emission_luminance = draw.within(0.2, 1.0);
            material.emission_color = tinted(draw, 0.3, 1.0);
        }
        kind => below(draw, &mut material, kind < 6),
    }
    material
}

/// Light goes below the surface, by a walk or by a profile.
fn below(draw: &mut Draw, material: &mut Material, is_walk: bool) {
    // Without reflection both sides follow the same ways
    material.specular_weight = ScalarInput::constant(draw.of(&[0.0, 0.0, 0.0, 1.0]));
    material.subsurface_weight = ScalarInput::constant(draw.of(&[0.5, 1.0]));
    material.subsurface_color = tinted(draw, 0.2, 0.95);
    material.subsurface_radius = ScalarInput::constant(draw.within(0.03, 0.4));
    material.subsurface_radius_scale = ColorInput::constant(draw.color(0.3, 1.0));
    let surface = draw.of(&WalkSurface::ALL);
    // Below a refracting boundary devices meet lights by chance: few bright samples, whose errors are no symmetric numbers
    if !(is_walk && surface == WalkSurface::Clear) {
        material.subsurface_eta = draw.of(&[1.0, 1.4]);
    }
    material.subsurface_model = match is_walk {
        true => SubsurfaceModel::RandomWalk(surface),
        false => SubsurfaceModel::Profile(draw.of(&MODELS)),
    };
}

fn thing(draw: &mut Draw, index: usize) -> Object {
    let name = draw.of(&SHAPES);
    let mut mesh = build_shape(name, &ShapeParameters::new()).unwrap();
    let [low, high] = [Vec3::min, Vec3::max].map(|of| mesh.positions.iter().copied().reduce(of).unwrap());
    let size = draw.within(0.8, 1.6) / (high - low).max_element();
    let middle = 0.5 * (low + high);
    mesh.positions.iter_mut().for_each(|position| *position = (*position - middle) * size);
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x + 0.3 * p.z, p.y)).collect();
    mesh.tangents.clear();
    mesh.colors = mesh.positions.iter().map(|p| (0.7 + 0.3 * *p).clamp(Vec3::ZERO, Vec3::ONE)).collect();
    let place = Vec3::new(1.3 * (index as f32 - 1.0), draw.within(0.4, 0.8), draw.within(-0.8, 0.8));
    Object {
        name: format!("{name} {index}"),
        mesh: mesh.into(),
        world_from_local: Affine3A::from_rotation_translation(draw.turn(), place),
        material: index,
        subsurface_group: draw.0.below(2) as u32,
        is_movable: draw.is(0.5),
    }
}

fn floor() -> Object {
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
    let mesh = Mesh {
        positions: corners.map(|(x, z)| Vec3::new(20.0 * x, -0.6, 20.0 * z)).to_vec(),
        uvs: corners.map(|(x, z)| Vec2::new(4.0 * x, 4.0 * z)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    Object { name: "floor".into(), mesh: mesh.into(), material: 3, subsurface_group: 9, ..Object::default() }
}

fn light(draw: &mut Draw) -> Light {
    let toward = draw.upward();
    let place = toward * draw.within(3.0, 6.0);
    let (edge, visible) = (draw.within(0.5, 2.0), draw.is(0.5));
    let edge_x = toward.any_orthonormal_vector();
    let edge_y = toward.cross(edge_x).normalize();
    let (edge_x, edge_y) = (edge_x * edge, -edge_y * edge);
    let color = draw.color(0.5, 1.0);
    match draw.0.below(6) {
        0 => Light::Rectangle { center: place, edge_x, edge_y, radiance: 12.0 * color, visible },
        1 => Light::Ellipse { center: place, edge_x, edge_y, radiance: 12.0 * color, visible },
        2 => Light::Sphere { center: place, radius: 0.3 * edge, radiance: 20.0 * color, visible },
        3 => Light::Distant {
            direction: -toward,
            angular_radius: draw.of(&[0.0, 0.3, 4.0]),
            irradiance: color,
        },
        kind => Light::Spot {
            position: place,
            direction: -toward,
            radius: if kind == 4 { 0.2 } else { 0.0 },
            intensity: 30.0 * color,
            inner_angle: 15.0,
            outer_angle: 30.0,
            visible,
        },
    }
}
