//! The light under all surfaces of a scene, as paths find it.

use std::sync::Arc;

use glam::Vec3;
use translucid_scene::{Object, Scene, SubsurfaceMethod, SubsurfaceModel};

use super::exit_point::ExitPoint;
use super::normalization::Normalizer;
use super::note::{Note, NoteKind};
use super::parameters::Subsurface;
use super::transport::points::{
    CloudGroup, GatherPoint, GatherScratch, Gatherer, PixelWidths, PointCloud, serve,
};
use super::transport::{SubsurfaceTransport, Tracer};
use crate::ray::offset_at;
use crate::sampling::Sampler;
use crate::world::{Media, PathState, World};

/// Objects with layers that are compared with all others.
const MOST_LAYERED: usize = 256;

/// The transport of each material of a scene, and the points and shapes that they share.
///
/// Where light is gathered from points, points come first: a subsurface group that they leave out has the transport of
/// its material.
pub(crate) struct Transports {
    of_materials: Vec<Arc<SubsurfaceTransport>>,
    normalizer: Option<Normalizer>,
    /// Why there is no normalizer although a material asks for it.
    note: Option<Note>,
    points: Option<Points>,
}

/// The points that light is gathered from.
struct Points {
    gatherer: Gatherer,
    groups: Vec<CloudGroup>,
}

impl Transports {
    /// Lays the points of shapes that materials are normalized by.
    pub(crate) fn new(world: &World, of_materials: Vec<Arc<SubsurfaceTransport>>) -> Self {
        let (normalizer, note) = match Normalizer::new(world, &of_materials) {
            Ok(normalizer) => (normalizer, None),
            Err(error) => {
                // Its help is about the point-based method
                let message = format!(
                    "subsurface_normalization is left out: {}; a coarser point_tolerance or a longer mean free path needs fewer",
                    error.message
                );
                (None, Some(Note { kind: NoteKind::NoNormalization, material: None, message }))
            }
        };
        Self { of_materials, normalizer, note, points: None }
    }

    /// The transport of each material.
    pub(crate) fn all(&self) -> &[Arc<SubsurfaceTransport>] {
        &self.of_materials
    }

    /// The transport of a material.
    pub(crate) fn of(&self, material: usize) -> &SubsurfaceTransport {
        &self.of_materials[material]
    }

    /// Notes for the user on the materials of objects all of which are too far from the scene's origin.
    pub(crate) fn notes_on_places(&self, scene: &Scene) -> Vec<Note> {
        let mut notes: Vec<Note> = Vec::new();
        for object in &scene.objects {
            let material = &scene.materials[object.material];
            let transport = self.of(object.material);
            let is_known = notes.iter().any(|note| note.material.as_ref() == Some(&material.name));
            if is_known || matches!(transport, SubsurfaceTransport::Lambertian) {
                continue;
            }
            let (low, high) = object.bounds();
            let nearest = Vec3::ZERO.clamp(low, high).abs().max_element();
            let Subsurface { surface_albedo: albedo, length: stated } =
                transport.own().unwrap_or_else(|| Subsurface {
                    surface_albedo: material.subsurface_color.factor.clamp(Vec3::ZERO, Vec3::ONE),
                    length: material.subsurface_radius.factor * material.subsurface_radius_scale.factor,
                });
            let length = |at: f32| transport.length(albedo, stated, offset_at(at));
            let is_unresolved = |at: f32| {
                let medium = transport.medium();
                medium.is_some_and(|medium| medium.has_unresolved_shells(length(0.0), offset_at(at)))
            };
            let farthest = high.abs().max(low.abs()).max_element();
            let facet = is_unresolved(farthest).then(|| nearest_facet(object));
            if let Some(facet) = facet.filter(|facet| is_unresolved(*facet)) {
                let advice = if nearest > 0.0 {
                    "aim the camera at it, which moves the origin there"
                } else {
                    "make them thicker or less dense"
                };
                let message = format!(
                    "object {} is {facet} {} from the scene's origin, where single precision does not resolve such layers: \
                     they are rendered thicker or less dense; {advice}",
                    object.name,
                    scene.unit.name()
                );
                let material = Some(material.name.clone());
                notes.push(Note { kind: NoteKind::Unresolved, material, message });
                continue;
            }
            if length(0.0) != Vec3::ZERO && length(nearest) == Vec3::ZERO {
                let message = format!(
                    "object {} is {nearest} {} from the scene's origin, where single precision does not resolve so short a \
                     mean free path: it is rendered as Lambertian; aim the camera at it, which moves the origin there",
                    object.name,
                    scene.unit.name()
                );
                notes.push(Note {
                    kind: NoteKind::Unresolved,
                    material: Some(material.name.clone()),
                    message,
                });
            }
        }
        notes
    }

    /// Notes for the user on materials whose layers follow surfaces inside a body of several meshes.
    pub(crate) fn notes_on_layers(scene: &Scene) -> Vec<Note> {
        let has_layers = |object: &&Object| {
            let material = &scene.materials[object.material];
            !material.layers.is_empty() && material.subsurface_model != SubsurfaceModel::Layers
        };
        let mut notes: Vec<Note> = Vec::new();
        for object in scene.objects.iter().filter(has_layers).take(MOST_LAYERED) {
            let name = &scene.materials[object.material].name;
            let (low, high) = object.bounds();
            let meets = |other: &&Object| {
                let (from, to) = other.bounds();
                other.subsurface_group == object.subsurface_group
                    && !std::ptr::eq(*other, object)
                    && (low.max(from).cmple(high.min(to))).all()
            };
            let is_known = notes.iter().any(|note| note.material.as_ref() == Some(name));
            let Some(other) = scene.objects.iter().find(meets).filter(|_| !is_known) else { continue };
            let message = format!(
                "objects {} and {} may overlap and are one body: its layers follow both surfaces, also where one is inside \
                 the other",
                object.name, other.name
            );
            notes.push(Note { kind: NoteKind::LayersInside, material: Some(name.clone()), message });
        }
        notes
    }

    /// Note for the user on the shapes.
    pub(crate) fn note(&self) -> Option<Note> {
        self.note.clone()
    }

    /// Gathers light from points in place of probing for it, where the scene asks for that; the points are the scene's.
    pub(crate) fn set_points(&mut self, world: &World, points: &PointCloud) {
        let is_wanted = world.scene.integrator.subsurface_method == SubsurfaceMethod::PointBased;
        self.points = is_wanted.then(|| Points {
            gatherer: points.gatherer(world, &self.of_materials),
            groups: points.groups().to_vec(),
        });
    }

    /// Forgets the points: they belong to a scene that has changed.
    pub(crate) fn forget_points(&mut self) {
        self.points = None;
    }

    /// Returns `true` if light is gathered from points.
    pub(crate) fn has_points(&self) -> bool {
        self.points.is_some()
    }

    /// Returns `true` if there are points, but too far apart for pixels of these widths.
    pub(crate) fn needs_closer_points(&self, pixels: &PixelWidths) -> bool {
        self.points.as_ref().is_some_and(|points| !serve(&points.groups, pixels))
    }

    /// Leaves a surface through the medium below; false where the path is over.
    pub(crate) fn scatter<'a, T: Tracer<'a>>(
        &'a self,
        tracer: &mut T,
        world: &'a World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        sampler: &mut Sampler,
    ) -> bool {
        if let Some(points) = &self.points
            && points.gatherer.scatter(tracer, world, path, exit)
        {
            return false;
        }
        self.of(exit.material).scatter(tracer, world, path, exit, sampler)
    }

    /// The points by which materials are normalized.
    pub(crate) fn normalizer(&self) -> Option<&Normalizer> {
        self.normalizer.as_ref()
    }

    /// Factor on light that leaves at a point, for its shape.
    pub(crate) fn shape_factor(
        &self,
        scene: &Scene,
        exit: &ExitPoint<'_>,
        scratch: &mut GatherScratch,
    ) -> Vec3 {
        let Some(normalizer) = &self.normalizer else { return Vec3::ONE };
        normalizer.factor(&scene.materials[exit.material], &GatherPoint::at(exit), scratch)
    }
}

/// The media that light may pass without being scattered, for each material that has one.
pub(crate) fn media(transports: &[Arc<SubsurfaceTransport>]) -> Media {
    Media::new(transports.iter().map(|transport| transport.medium()))
}

/// Least distance \[L\] of an object's facets, or of boxes around them, from the origin, by the largest coordinate.
fn nearest_facet(object: &Object) -> f32 {
    let at = |vertex: u32| object.world_from_local.transform_point3(object.mesh.positions[vertex as usize]);
    let distance = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(at);
        Vec3::ZERO.clamp(a.min(b).min(c), a.max(b).max(c)).abs().max_element()
    };
    object.mesh.triangles.iter().map(distance).fold(f32::INFINITY, f32::min)
}
