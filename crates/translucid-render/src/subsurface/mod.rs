//! Light under surfaces: for each material a kernel, and the transport that finds the light.
//!
//! ```text
//! kernel/          S(x_i, ω_i, x_o): the profile, cut and tabulated, and what directions change
//! transport/       how light is found: probes, shared probes, points, a walk
//! pairing.rs       whose parameters count where a texture gives exit and entry point different ones
//! normalization.rs what a shape holds of a profile
//! exit_point.rs    a point that light leaves
//! entry_point.rs   light that arrives where it enters
//! ```

pub(crate) mod entry_point;
mod exit_point;
pub(crate) mod kernel;
mod normalization;
mod note;
mod pairing;
mod parameters;
pub(crate) mod transport;

use std::sync::Arc;

use glam::Vec3;
use translucid_scene::{Scene, SubsurfaceMethod, SubsurfaceModel, WalkSurface};

use crate::ray::SurfacePoint;
use crate::surface::bsdf::SurfaceParameters;
use crate::surface::{WalkMedium, WalkRecipe};
use crate::world::{Media, World};
use kernel::{Cutting, KernelRecipe, SubsurfaceKernel};
use normalization::Normalizer;
use pairing::Pairing;
use transport::points::{CloudGroup, GatherScratch, Leaving, PixelWidths, PointCloud, serve};
use transport::probes::Probes;
use transport::walk::Walks;

pub(crate) use exit_point::ExitPoint;
use note::Remark;
pub use note::{Note, NoteKind};
pub(crate) use parameters::Subsurface;
pub(crate) use transport::{SubsurfaceTransport, Tracing, TransportScratch};

/// Probabilities of probing along the two tangents and the normal.
///
/// Measured on the head at equal samples: one axis at random (¼, ¼, ½) has 2.1 times the squared error of
/// these at 0.78 times the CPU time; all three always (1, 1, 1) 0.87 times the error at 1.5 times the time.
const AXIS_PROBES: [f32; 3] = [0.25, 0.25, 1.0];

/// The light under all surfaces of a scene, made ready.
pub(crate) struct SubsurfaceSet {
    /// For each material.
    transports: Vec<SubsurfaceTransport>,
    /// For each material, in words.
    notes: Vec<Vec<Remark>>,
    axes: [f32; 3],
    /// The groups of the points that light is gathered from, if there are any.
    points: Option<Vec<CloudGroup>>,
    normalizer: Option<Normalizer>,
    normalizer_note: Option<Note>,
    kernels: Cache<KernelRecipe, SubsurfaceKernel>,
    media: Cache<WalkRecipe, WalkMedium>,
}

/// Things that were made from recipes, for those who ask again.
struct Cache<R, T>(Vec<(R, Arc<T>)>);

impl<R: PartialEq, T> Cache<R, T> {
    fn get<E>(&mut self, recipe: R, make: impl FnOnce(&R) -> Result<T, E>) -> Result<Arc<T>, E> {
        if let Some((_, made)) = self.0.iter().find(|(known, _)| *known == recipe) {
            return Ok(Arc::clone(made));
        }
        let made = Arc::new(make(&recipe)?);
        self.0.push((recipe, Arc::clone(&made)));
        Ok(made)
    }

    /// Forgets what nobody uses.
    fn clean(&mut self) {
        self.0.retain(|(_, made)| Arc::strong_count(made) > 1);
    }
}

impl SubsurfaceSet {
    /// The kernels and media of a scene's materials.
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut new = Self {
            transports: Vec::new(),
            notes: Vec::new(),
            axes: AXIS_PROBES,
            points: None,
            normalizer: None,
            normalizer_note: None,
            kernels: Cache(Vec::new()),
            media: Cache(Vec::new()),
        };
        scene.materials.iter().for_each(|_| new.push(scene));
        new
    }

    /// Makes what the next of a scene's materials needs.
    pub(crate) fn push(&mut self, scene: &Scene) {
        let (transport, notes) = self.prepare(scene, self.transports.len());
        self.transports.push(transport);
        self.notes.push(notes);
    }

    /// Forgets a material; those behind it move up.
    pub(crate) fn remove(&mut self, index: usize) {
        self.transports.remove(index);
        self.notes.remove(index);
        self.kernels.clean();
        self.media.clean();
    }

    /// Makes what a changed material needs. Points belong to the scene before the change: see `forget_points`.
    pub(crate) fn update(&mut self, scene: &Scene, index: usize) {
        let (transport, notes) = self.prepare(scene, index);
        self.transports[index] = transport;
        self.notes[index] = notes;
        self.kernels.clean();
        self.media.clean();
    }

    /// Lays the points of shapes that materials are normalized by.
    pub(crate) fn normalize(&mut self, world: &World) {
        (self.normalizer, self.normalizer_note) = match Normalizer::new(world, &self.transports) {
            Ok(normalizer) => (normalizer, None),
            Err(error) => {
                // Its help is for those who gather light from points
                let message = format!(
                    "subsurface_normalization is left out: {}; a coarser point_tolerance or a longer mean free path needs fewer",
                    error.message
                );
                (None, Some(Note { kind: NoteKind::NoNormalization, material: None, message }))
            }
        };
    }

    fn prepare(&mut self, scene: &Scene, index: usize) -> (SubsurfaceTransport, Vec<Remark>) {
        let material = &scene.materials[index];
        let is_absent = material.subsurface_weight.factor <= 0.0;
        match material.model(&scene.integrator) {
            _ if is_absent => (SubsurfaceTransport::Lambertian, Vec::new()),
            SubsurfaceModel::RandomWalk(surface) => self.prepare_walk(scene, index, surface),
            model => self.prepare_profile(scene, index, model),
        }
    }

    fn prepare_walk(
        &mut self,
        scene: &Scene,
        index: usize,
        surface: WalkSurface,
    ) -> (SubsurfaceTransport, Vec<Remark>) {
        let material = &scene.materials[index];
        let recipe = WalkRecipe::of(material, surface);
        match self.media.get(recipe, WalkRecipe::make) {
            Ok(medium) => {
                let notes =
                    Note::of_nearest(material, surface.name_of_walk(), recipe.g_and_eta()).into_iter();
                let notes = notes.chain(Note::of_walk(scene, material)).collect();
                let is_even = material.subsurface_color.texture.is_none()
                    && material.subsurface_radius.texture.is_none()
                    && material.subsurface_radius_scale.texture.is_none();
                let share = scene.integrator.subsurface_sharing && is_even;
                (SubsurfaceTransport::Walk(Walks { medium, share }), notes)
            }
            Err(error) => self.stand_in(scene, index, surface.name_of_walk(), &error.to_string()),
        }
    }

    fn prepare_profile(
        &mut self,
        scene: &Scene,
        index: usize,
        model: SubsurfaceModel,
    ) -> (SubsurfaceTransport, Vec<Remark>) {
        let material = &scene.materials[index];
        let Some(recipe) = KernelRecipe::of(material, model) else {
            return (SubsurfaceTransport::Lambertian, Vec::new());
        };
        let kernel = match self.kernels.get(recipe, |recipe| recipe.make(&scene.profile_tables)) {
            Ok(kernel) => kernel,
            Err(error) => return self.stand_in(scene, index, model.name(), &error),
        };
        let mut notes: Vec<Remark> = kernel::unfitted(material, model).into_iter().collect();
        let model = model.name();
        notes.extend(kernel.notes().iter().map(|(kind, words)| (*kind, format!("{model} {words}"))));
        let is_point_based = scene.integrator.subsurface_method == SubsurfaceMethod::PointBased;
        if is_point_based && kernel.knows_directions() {
            let words =
                format!("{model} follows the direction of light; points hold its mean over all directions");
            notes.push((NoteKind::MeanOverDirections, words));
        }
        (self.transport(scene, index, kernel), notes)
    }

    /// Burley's profile in place of one that cannot be made.
    fn stand_in(
        &mut self,
        scene: &Scene,
        index: usize,
        model: &str,
        error: &str,
    ) -> (SubsurfaceTransport, Vec<Remark>) {
        let material = &scene.materials[index];
        let recipe = KernelRecipe::stand_in(material);
        let words = format!("{model}: {error}; normalized-diffusion stands in for it");
        let notes = vec![(NoteKind::StandIn, words)];
        match self.kernels.get(recipe, |recipe| recipe.make(&[])) {
            Ok(kernel) => (self.transport(scene, index, kernel), notes),
            Err(_) => (SubsurfaceTransport::Lambertian, notes),
        }
    }

    /// The transport of a material with a kernel.
    fn transport(&self, scene: &Scene, index: usize, kernel: Arc<SubsurfaceKernel>) -> SubsurfaceTransport {
        let integrator = &scene.integrator;
        let is_disk = integrator.subsurface_method == SubsurfaceMethod::CyclesDisk;
        // Cycles knows the exit's parameters only
        let pairing = if is_disk { None } else { Pairing::new(scene, index, &kernel) };
        let cutting = Cutting::new(&kernel, integrator.subsurface_tail);
        let probes = Probes { kernel, pairing, cutting, axes: self.axes, is_disk };
        let probing = if integrator.subsurface_sharing && probes.can_share() {
            SubsurfaceTransport::Shared(probes)
        } else {
            SubsurfaceTransport::Probes(probes)
        };
        match integrator.subsurface_method {
            SubsurfaceMethod::RayTraced | SubsurfaceMethod::CyclesDisk => probing,
            SubsurfaceMethod::PointBased => SubsurfaceTransport::Points(Box::new(probing), None),
        }
    }

    /// Gathers light from points, which are the scene's, in place of probing for it.
    pub(crate) fn set_points(&mut self, world: &World, points: &PointCloud) {
        let gatherer = Arc::new(points.gatherer(world, &self.transports));
        for transport in &mut self.transports {
            if let SubsurfaceTransport::Points(_, own) = transport {
                *own = Some(Arc::clone(&gatherer));
            }
        }
        self.points = Some(points.groups().to_vec());
    }

    /// Forgets the points: they belong to a scene that has changed.
    pub(crate) fn forget_points(&mut self) {
        for transport in &mut self.transports {
            if let SubsurfaceTransport::Points(_, own) = transport {
                *own = None;
            }
        }
        self.points = None;
    }

    /// Whether light is gathered from points.
    pub(crate) fn has_points(&self) -> bool {
        self.points.is_some()
    }

    /// Whether the points, if there are any, lie too far apart for pixels of such widths.
    pub(crate) fn needs_closer_points(&self, pixels: &PixelWidths) -> bool {
        self.points.as_ref().is_some_and(|groups| !serve(groups, pixels))
    }

    /// Sets the probabilities of probing along (tangent, tangent, normal).
    pub(crate) fn set_axes(&mut self, axes: [f32; 3]) {
        self.axes = axes;
        self.transports.iter_mut().for_each(|transport| transport.set_axes(axes));
    }

    /// Notes for the user.
    pub(crate) fn notes(&self, scene: &Scene) -> Vec<Note> {
        let of_materials = self.notes.iter().zip(&scene.materials).flat_map(|(notes, material)| {
            let note = |(kind, words): &Remark| {
                let (material, message) = (Some(material.name.clone()), words.clone());
                Note { kind: *kind, material, message }
            };
            notes.iter().map(note)
        });
        of_materials.chain(self.normalizer_note.clone()).collect()
    }

    /// The media that light may pass without being scattered, for each material that has one.
    pub(crate) fn media(&self) -> Media {
        Media::new(self.transports.iter().map(SubsurfaceTransport::medium))
    }

    /// For each material how its light is found.
    pub(crate) fn transports(&self) -> &[SubsurfaceTransport] {
        &self.transports
    }

    /// Parameters of the medium below a point of a material.
    pub(crate) fn at(&self, scene: &Scene, material: usize, point: &SurfacePoint) -> Subsurface {
        self.transports[material].at(scene, &scene.materials[material], point)
    }

    /// Has paths look below a material where an exit is dark, but light may have entered where it is bright.
    pub(crate) fn brighten(&self, material: usize, surface: &mut SurfaceParameters) {
        if let Some(pairing) = self.transports[material].probes().and_then(|probes| probes.pairing.as_ref()) {
            pairing.brighten(surface);
        }
    }

    /// Factor on light that leaves at a point, for its shape.
    pub(crate) fn shape_factor(
        &self,
        scene: &Scene,
        exit: &ExitPoint<'_>,
        scratch: &mut GatherScratch,
    ) -> Vec3 {
        let Some(normalizer) = &self.normalizer else { return Vec3::ONE };
        normalizer.factor(&scene.materials[exit.material], &Leaving::at(exit), scratch)
    }

    /// Factor on light that leaves where the shape is known to hold so much of the profile's energy.
    pub(crate) fn shape_factor_of(scene: &Scene, exit: &ExitPoint<'_>, energy: Vec3) -> Vec3 {
        normalization::factor_of(&scene.materials[exit.material], energy)
    }
}
