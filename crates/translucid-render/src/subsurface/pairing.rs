//! Whose surface albedo and mean free path count where a texture gives exit and entry different ones.
//!
//! ```text
//! entry   A(x_i), ℓ(x_i)
//! both    √(A(x_o) A(x_i)), √(ℓ(x_o) ℓ(x_i))
//! ```
//!
//! The geometric means are reciprocal, and of those that were tried nearest to photons that walk through two media side
//! by side (the example `textured_edge` of `translucid-reference`).

use glam::Vec3;
use translucid_profile::d_from_surface_albedo_f32;
use translucid_scene::{ColorInput, Material, ScalarInput, Scene, SubsurfaceModel, SubsurfaceTextureAt};

use crate::path::tracer::World;
use crate::ray::Hit;
use crate::subsurface::kernel::tables::{ProfileSource, ProfileTables};
use crate::subsurface::transport::probes::Exit;
use crate::surface::bsdf::SurfaceParameters;
use crate::surface::material::{self, Subsurface};

/// Surface albedos among which the widest profile is sought.
const ALBEDOS: u16 = 64;

/// What the search misses between them, and more: widths change by less than this from one to the next around the
/// greatest.
const MARGIN: f32 = 1.02;

/// How the parameters of exit and entry go together in a textured material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pairing {
    /// Whether the exit's parameters count as well.
    is_symmetric: bool,
    /// Greatest surface albedo anywhere, per channel.
    albedo: Vec3,
    /// Greatest length anywhere, as the material states it, per channel \[L\].
    length: Vec3,
    /// The surface albedo whose profile is widest, per channel.
    widest: Vec3,
}

impl Pairing {
    /// `None` where the exit's parameters count alone: it is asked for, or all points have the same.
    pub(crate) fn new(
        scene: &Scene,
        index: usize,
        source: ProfileSource,
        tables: &ProfileTables,
    ) -> Option<Self> {
        let material = &scene.materials[index];
        let is_profile =
            matches!(material.subsurface_model, SubsurfaceModel::Profile(_) | SubsurfaceModel::Tabulated(_));
        let is_textured = [material.subsurface_color, material.subsurface_radius_scale]
            .iter()
            .any(|color| color.texture.is_some() || color.vertex_color)
            || material.subsurface_radius.texture.is_some();
        if material.subsurface_texture_at == SubsurfaceTextureAt::Exit || !is_profile || !is_textured {
            return None;
        }
        let albedo = greatest_color(scene, index, &material.subsurface_color).clamp(Vec3::ZERO, Vec3::ONE);
        let radius = greatest_scalar(scene, &material.subsurface_radius).max(0.0);
        let scale = greatest_color(scene, index, &material.subsurface_radius_scale).max(Vec3::ZERO);
        let tail = scene.integrator.subsurface_tail;
        let widest = |c: usize| widest(albedo[c], material, source, tables, tail);
        Some(Self {
            is_symmetric: material.subsurface_texture_at == SubsurfaceTextureAt::Both,
            albedo,
            length: scale * radius,
            widest: Vec3::new(widest(0), widest(1), widest(2)),
        })
    }

    /// The parameters of light that leaves at the exit and enters at a hit.
    ///
    /// In another material, whose lengths may mean something else, the exit's count.
    pub(crate) fn pair(&self, world: &World, exit: &Exit<'_>, hit: &Hit) -> Subsurface {
        let point = world.geometry.surface_point(&world.scene, hit);
        let (index, material) = world.material(&point);
        if index != exit.material {
            return exit.subsurface;
        }
        let mut albedo = material::albedo_at(&world.scene, material, &point);
        let mut length = material::stated_length_at(&world.scene, material, &point);
        if self.is_symmetric {
            albedo = geometric_mean(albedo, exit.subsurface.albedo);
            length = geometric_mean(length, material::stated_length_at(&world.scene, material, exit.point));
        }
        world.materials.subsurface(index, material, albedo, length, exit.point.offset)
    }

    /// Parameters of a profile that is at least as wide as that of any pair.
    pub(crate) fn widest(&self, world: &World, exit: &Exit<'_>) -> Subsurface {
        let material = &world.scene.materials[exit.material];
        let length = self.length * MARGIN;
        world.materials.subsurface(exit.material, material, self.widest, length, 0.0)
    }

    /// Greatest surface albedo of any pair with an exit of the given one.
    pub(crate) fn brightest(&self, exit: Vec3) -> Vec3 {
        if self.is_symmetric { geometric_mean(self.albedo, exit) } else { self.albedo }
    }

    /// Has paths look below where an exit is dark, but light may have entered where it is bright.
    ///
    /// The color only says how often.
    pub(crate) fn brighten(&self, surface: &mut SurfaceParameters) {
        let color = surface.subsurface_color;
        let brighter = color.max(0.5 * self.brightest(color));
        let active = Vec3::from_array(surface.subsurface_active.map(|a| f32::from(u8::from(a))));
        surface.subsurface_color = color + (brighter - color) * active;
    }
}

fn geometric_mean(a: Vec3, b: Vec3) -> Vec3 {
    // One root for each: the product of two small ones may be 0, that of two large ones infinite
    let root = |v: Vec3| v.map(f32::sqrt);
    root(a) * root(b)
}

/// The surface albedo up to `brightest` whose profile reaches furthest.
fn widest(
    brightest: f32,
    material: &Material,
    source: ProfileSource,
    tables: &ProfileTables,
    tail: f32,
) -> f32 {
    let reach = |a: f32| match source.table() {
        Some(table) => tables.table(table).at(a, 1.0).truncation_radius(tail),
        None => {
            let Material { subsurface_parameter, subsurface_configuration, .. } = *material;
            d_from_surface_albedo_f32(a, 1.0, subsurface_parameter, subsurface_configuration)
        }
    };
    let albedo = |i: u16| brightest * f32::from(i) / f32::from(ALBEDOS);
    let greater = |a: f32, b: f32| if reach(b) > reach(a) { b } else { a };
    (0..=ALBEDOS).map(albedo).fold(brightest, greater)
}

fn greatest_color(scene: &Scene, material: usize, input: &ColorInput) -> Vec3 {
    let mut greatest = input.factor;
    if let Some(texture) = &input.texture {
        let [r, g, b, _] = scene.images[texture.image].greatest();
        greatest *= Vec3::new(r, g, b);
    }
    if input.vertex_color {
        let objects = scene.objects.iter().filter(|object| object.material == material);
        // Meshes without colors are white
        let of_mesh = |colors: &[Vec3]| colors.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ONE);
        greatest *= objects.map(|object| of_mesh(&object.mesh.colors)).reduce(Vec3::max).unwrap_or(Vec3::ONE);
    }
    greatest
}

fn greatest_scalar(scene: &Scene, input: &ScalarInput) -> f32 {
    match &input.texture {
        None => input.factor,
        Some((texture, channel)) => input.factor * scene.images[texture.image].greatest()[*channel as usize],
    }
}
