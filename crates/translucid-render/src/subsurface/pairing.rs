//! Surface albedo and mean free path of a pair of points, where a texture gives exit and entry different ones.
//!
//! ```text
//! entry   A(x_i), ℓ(x_i)
//! both    √(A(x_o) A(x_i)), √(ℓ(x_o) ℓ(x_i))
//! ```
//!
//! The geometric means are reciprocal, and of those that were tried nearest to photons that walk through two media side
//! by side (the example `textured_edge` of `translucid-reference`).

use std::collections::HashSet;
use std::sync::Arc;

use glam::Vec3;
use translucid_scene::{ColorInput, Material, ScalarInput, Scene, SubsurfaceTextureAt};

use super::exit_point::ExitPoint;
use super::kernel::SubsurfaceKernel;
use super::parameters::Subsurface;
use crate::ray::SurfacePoint;
use crate::surface;
use crate::surface::bsdf::SurfaceParameters;
use crate::world::World;

/// Surface albedos among which the widest profile is sought.
const ALBEDOS: u16 = 64;

/// Margin for widths between these albedos: around the greatest, widths change by less than this from one to the next.
const MARGIN: f32 = 1.02;

/// How the parameters of exit and entry go together in a textured material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pairing {
    /// The exit's parameters count as well.
    is_symmetric: bool,
    /// Greatest surface albedo anywhere, per channel.
    surface_albedo: Vec3,
    /// Greatest length anywhere, as the material states it, per channel \[L\].
    length: Vec3,
    /// The surface albedo whose profile is widest, per channel.
    widest: Vec3,
}

/// Parameters that a material states where light enters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StatedParameters {
    /// Number of the material.
    material: usize,
    surface_albedo: Vec3,
    /// Length, per channel \[L\].
    length: Vec3,
}

impl StatedParameters {
    /// The parameters stated at a point.
    pub(crate) fn at(world: &World, point: &SurfacePoint) -> Self {
        let (index, material) = world.material(point);
        Self {
            material: index,
            surface_albedo: surface::surface_albedo_at(&world.scene, material, point),
            length: surface::stated_length_at(&world.scene, material, point),
        }
    }

    /// The parameters stated at a point, if they count for any exit.
    pub(crate) fn if_paired(world: &World, point: &SurfacePoint) -> Option<Self> {
        let (_, material) = world.material(point);
        entries_count(material).then(|| Self::at(world, point))
    }
}

/// The exit of a pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairedExit {
    /// Number of the material.
    material: usize,
    pub(crate) subsurface: Subsurface,
    /// Rounding error of its position \[L\].
    offset: f32,
}

impl PairedExit {
    pub(crate) fn new(exit: &ExitPoint<'_>) -> Self {
        Self { material: exit.material, subsurface: exit.subsurface, offset: exit.point.offset }
    }
}

impl Pairing {
    /// `None` where the exit's parameters count alone: the material asks for it, or all points have the same.
    pub(crate) fn new(scene: &Scene, index: usize, kernel: &SubsurfaceKernel) -> Option<Self> {
        let material = &scene.materials[index];
        if !entries_count(material) {
            return None;
        }
        let color = greatest_color(scene, index, &material.subsurface_color);
        let surface_albedo = color.clamp(Vec3::ZERO, Vec3::ONE);
        let radius = greatest_scalar(scene, &material.subsurface_radius).max(0.0);
        let scale = greatest_color(scene, index, &material.subsurface_radius_scale).max(Vec3::ZERO);
        let tail = scene.integrator.subsurface_tail;
        Some(Self {
            is_symmetric: material.subsurface_texture_at == SubsurfaceTextureAt::Both,
            surface_albedo,
            length: scale * radius,
            widest: surface_albedo.map(|brightest| widest(brightest, kernel, tail)),
        })
    }

    /// The parameters of light that leaves at an exit and enters where this is stated: length 0 in channels in which that
    /// of either is.
    ///
    /// In another material, whose lengths may mean something else, the exit's count.
    pub(crate) fn pair(
        &self,
        kernel: &SubsurfaceKernel,
        exit: &PairedExit,
        entry: &StatedParameters,
    ) -> Subsurface {
        let own = exit.subsurface;
        if entry.material != exit.material {
            return own;
        }
        let StatedParameters { mut surface_albedo, mut length, .. } = *entry;
        if self.is_symmetric {
            surface_albedo = geometric_mean(surface_albedo, own.surface_albedo);
            length = geometric_mean(length, own.length);
        }
        let length = Vec3::select(own.length.cmpgt(Vec3::ZERO), length, Vec3::ZERO);
        Subsurface { surface_albedo, length: kernel.resolved(surface_albedo, length, exit.offset) }
    }

    /// Parameters of a profile that is at least as wide as that of any pair.
    pub(crate) fn widest(&self, kernel: &SubsurfaceKernel) -> Subsurface {
        let length = kernel.resolved(self.widest, self.length * MARGIN, 0.0);
        Subsurface { surface_albedo: self.widest, length }
    }

    /// The pairing for a device: whether the exit's parameters count as well, the greatest surface albedos, surface albedos
    /// and lengths of the [widest](Self::widest) profiles.
    pub(crate) fn words(&self, kernel: &SubsurfaceKernel) -> Vec<f32> {
        let Subsurface { surface_albedo, length } = self.widest(kernel);
        let colors = [self.surface_albedo, surface_albedo, length].map(|color| color.to_array());
        [&[f32::from(u8::from(self.is_symmetric))], colors.as_flattened()].concat()
    }

    /// Greatest surface albedo of any pair with an exit of the given one.
    pub(crate) fn brightest(&self, exit: Vec3) -> Vec3 {
        if self.is_symmetric { geometric_mean(self.surface_albedo, exit) } else { self.surface_albedo }
    }

    /// Makes paths look below a dark exit where the light may have entered at a bright point.
    ///
    /// The color only sets how often they do.
    pub(crate) fn brighten(&self, surface: &mut SurfaceParameters) {
        let color = surface.surface_albedo;
        let brighter = color.max(0.5 * self.brightest(color));
        surface.surface_albedo = color + (brighter - color) * surface.subsurface_active;
    }
}

fn geometric_mean(a: Vec3, b: Vec3) -> Vec3 {
    // One root for each: the product of two small ones may be 0, that of two large ones infinite
    let root = |v: Vec3| v.map(f32::sqrt);
    root(a) * root(b)
}

/// Returns `true` if the entries' parameters count for a material, and may differ.
fn entries_count(material: &Material) -> bool {
    let is_varied = |color: &ColorInput| color.texture.is_some() || color.vertex_color;
    material.subsurface_texture_at != SubsurfaceTextureAt::Exit
        && (is_varied(&material.subsurface_color)
            || is_varied(&material.subsurface_radius_scale)
            || material.subsurface_radius.texture.is_some())
}

/// The surface albedo up to `brightest` whose profile reaches furthest.
fn widest(brightest: f32, kernel: &SubsurfaceKernel, tail: f32) -> f32 {
    let reach = |a: f32| kernel.radial(a, 1.0).truncation_radius(tail);
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
        // A mesh that several objects share is looked at once
        let mut known = HashSet::new();
        let meshes = objects.map(|object| &object.mesh).filter(|mesh| known.insert(Arc::as_ptr(mesh).addr()));
        greatest *= meshes.map(|mesh| of_mesh(&mesh.colors)).reduce(Vec3::max).unwrap_or(Vec3::ONE);
    }
    greatest
}

fn greatest_scalar(scene: &Scene, input: &ScalarInput) -> f32 {
    match &input.texture {
        None => input.factor,
        Some((texture, channel)) => input.factor * scene.images[texture.image].greatest()[*channel as usize],
    }
}
