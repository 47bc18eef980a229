//! A scene made ready. An edit prepares anew only the parts that it changes.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_scene::{
    Environment, Image, Integrator, Light, Material, Object, Scene, SceneError, SubsurfaceMethod,
};

use super::enclosed;
use super::fingerprint::{Fingerprint, fingerprint};
use super::inner_pieces::InnerPieces;
use super::picker::Picker;
use super::pixel_widths::pixel_widths;
use super::view::View;
use crate::light::{EmissiveTriangle, LightSet};
use crate::path::PathTracer;
use crate::ray::Geometry;
use crate::subsurface::transport::points::{PointCloud, PointPlan, PointProgress, PointSettings, serve};
use crate::subsurface::{Note, Recipes, Transports, media};
use crate::surface::{self, SurfaceTables};
use crate::world::{PixelWidth, World};

/// A scene with everything that does not depend on the view: the hierarchy over its triangles, its lights, the tables of
/// its materials.
///
/// The camera and the film are those of a [`View`].
pub struct PreparedScene {
    pub(super) world: World,
    recipes: Recipes,
    transports: Transports,
    inner_pieces: InnerPieces,
}

/// A change of a prepared scene.
#[derive(Clone, Debug)]
pub enum Edit {
    /// Another material in the place of this number.
    Material(usize, Box<Material>),
    /// Other lights.
    Lights(Vec<Light>),
    /// Another environment, or none.
    Environment(Option<Environment>),
    /// Another object in the place of this number: mesh, place, material, subsurface group.
    Object(usize, Box<Object>),
    /// Other objects in the place of all: some moved, added, gone. Meshes that are shared or
    /// [movable](Object::is_movable) are prepared only if they are new.
    Objects(Vec<Object>),
    /// Another material, behind those that the scene has.
    AddMaterial(Box<Material>),
    /// Without the material of this number, which no object has: those behind it move up.
    RemoveMaterial(usize),
    /// Other limits of paths, or another way of finding light under surfaces.
    Integrator(Integrator),
    /// Another image, behind those that the scene has, for edits that refer to it.
    AddImage(Arc<Image>),
    /// Without the images that nothing refers to: those behind them move up, and have the numbers of
    /// [`PreparedScene::scene`] then.
    DropUnusedImages,
}

/// Everything that was prepared anew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Renewed {
    /// The hierarchy over the triangles.
    pub geometry: bool,
    /// The lights.
    pub lights: bool,
    /// Number of materials with new tables.
    pub materials: usize,
    /// Points of the point-based method are to be made again: see [`PreparedScene::wants_points`].
    pub points: bool,
}

impl PreparedScene {
    /// Prepares a scene on the current rayon pool.
    ///
    /// # Errors
    /// The scene is not valid: see [`Scene::validate`].
    pub fn new(mut scene: Scene) -> Result<Self, SceneError> {
        scene.validate()?;
        let mut inner_pieces = InnerPieces::default();
        inner_pieces.leave_out(&mut scene);
        // Neither needs the other; the tree leaves threads idle now and then.
        let (geometry, (surfaces, recipes)) = rayon::join(
            || Geometry::new(&scene.objects),
            || (SurfaceTables::new(&scene.materials, &scene.integrator), Recipes::new(&scene)),
        );
        let lights = light_set(&scene, &geometry);
        let geometry = Arc::new(geometry);
        let transports = recipes.transports();
        let world = World { media: media(&transports), scene, geometry, surfaces, lights };
        let transports = Transports::new(&world, transports);
        Ok(Self { world, recipes, transports, inner_pieces })
    }

    /// The scene as it was given, with all edits; without faces that nobody can see inside translucent bodies.
    pub fn scene(&self) -> &Scene {
        &self.world.scene
    }

    /// The view that the scene states.
    ///
    /// # Errors
    /// None: the scene was found valid.
    pub fn view(&self) -> Result<View, SceneError> {
        View::of(&self.world.scene)
    }

    /// The lights of the scene.
    pub(crate) fn lights(&self) -> &LightSet {
        &self.world.lights
    }

    /// A picker of the objects that pixels show, for any thread; later edits do not change it.
    pub fn picker(&self) -> Picker {
        Picker::new(Arc::clone(&self.world.geometry))
    }

    /// Everything that is not rendered as the scene asks for.
    pub fn notes(&self) -> Vec<Note> {
        let scene = &self.world.scene;
        let on_places = self.transports.notes_on_places(scene);
        self.recipes
            .notes(scene)
            .chain(self.transports.note())
            .chain(on_places)
            .chain(Transports::notes_on_layers(scene))
            .chain(enclosed::notes(&self.world))
            .chain(self.inner_pieces.notes(scene))
            .collect()
    }

    /// Fingerprint of everything that the picture of a view depends on: two runs with the same one may be joined.
    pub fn fingerprint(&self, view: &View) -> Fingerprint {
        fingerprint(&self.world.scene, view)
    }

    /// Changes the scene, and prepares anew only the parts that depend on the change.
    ///
    /// Pictures are then those of a scene that is prepared anew, bit for bit.
    ///
    /// # Errors
    /// There is nothing of that number, or the new value is not valid in this scene, which then stays as it was.
    pub fn edit(&mut self, edit: Edit) -> Result<Renewed, SceneError> {
        let has_another_sky = matches!(edit, Edit::Environment(_));
        let renewed = match edit {
            Edit::Material(index, material) => self.edit_material(index, *material)?,
            Edit::Object(index, object) => self.edit_object(index, *object)?,
            Edit::Objects(objects) => self.edit_objects(objects)?,
            Edit::AddMaterial(material) => self.add_material(*material)?,
            Edit::RemoveMaterial(index) => self.remove_material(index)?,
            Edit::Lights(lights) => {
                let validate =
                    |scene: &Scene| (0..scene.lights.len()).try_for_each(|index| scene.validate_light(index));
                self.swap_checked(lights, |scene| &mut scene.lights, validate)?;
                Renewed { lights: true, ..Renewed::default() }
            }
            Edit::Environment(environment) => {
                self.swap_checked(environment, |scene| &mut scene.environment, Scene::validate_environment)?;
                Renewed { lights: true, ..Renewed::default() }
            }
            Edit::AddImage(image) => {
                image.validate()?;
                self.world.scene.images.push(image);
                return Ok(Renewed::default());
            }
            Edit::DropUnusedImages => {
                self.world.scene.drop_unused_images();
                return Ok(Renewed::default());
            }
            Edit::Integrator(integrator) => {
                self.swap_checked(
                    integrator,
                    |scene| &mut scene.integrator,
                    |scene| scene.integrator.validate(),
                )?;
                let scene = &self.world.scene;
                for index in 0..scene.materials.len() {
                    self.world.surfaces.update(index, &scene.materials[index], &scene.integrator);
                    self.recipes.update(scene, index);
                }
                Renewed { materials: scene.materials.len(), ..Renewed::default() }
            }
        };
        if renewed.lights || renewed.geometry {
            let World { scene, geometry, lights, .. } = &mut self.world;
            let mut new = LightSet::new(scene, emissive_triangles(scene, geometry), geometry.bounds());
            if renewed.geometry || has_another_sky {
                new.look_for_openings(geometry);
            } else {
                new.keep_openings(lights);
            }
            *lights = new;
        }
        if renewed.geometry || renewed.materials > 0 {
            self.renew_transports();
        }
        self.transports.forget_points();
        Ok(Renewed { points: self.wants_points(), ..renewed })
    }

    /// Takes the transports of changed materials, or for a changed geometry. They have no points yet.
    fn renew_transports(&mut self) {
        let transports = self.recipes.transports();
        self.world.media = media(&transports);
        self.transports = Transports::new(&self.world, transports);
        self.recipes.clean();
    }

    /// Puts a value into the scene, which stays as it was if it is then not valid. Returns the value that was there.
    fn swap_checked<T>(
        &mut self,
        mut value: T,
        place: impl Fn(&mut Scene) -> &mut T,
        validate: impl Fn(&Scene) -> Result<(), SceneError>,
    ) -> Result<T, SceneError> {
        let scene = &mut self.world.scene;
        std::mem::swap(place(scene), &mut value);
        let result = validate(scene);
        if let Err(error) = result {
            std::mem::swap(place(scene), &mut value);
            return Err(error);
        }
        Ok(value)
    }

    fn edit_material(&mut self, index: usize, material: Material) -> Result<Renewed, SceneError> {
        require("material", index, self.world.scene.materials.len())?;
        let old = self.swap_checked(
            material,
            |scene| &mut scene.materials[index],
            |scene| scene.validate_material(index),
        )?;
        let scene = &self.world.scene;
        let new = &scene.materials[index];
        self.world.surfaces.update(index, new, &scene.integrator);
        self.recipes.update(scene, index);
        let emission = |material: &Material| (material.emission_luminance, material.emission_color);
        let lights = emission(&old) != emission(new);
        // A body that has become clear shows what is in it
        let geometry = self.inner_pieces.leave_out(&mut self.world.scene);
        if geometry {
            self.renew_geometry();
        }
        Ok(Renewed { lights: lights || geometry, geometry, materials: 1, ..Renewed::default() })
    }

    fn edit_object(&mut self, index: usize, object: Object) -> Result<Renewed, SceneError> {
        require("object", index, self.world.scene.objects.len())?;
        let old = self.swap_checked(
            object,
            |scene| &mut scene.objects[index],
            |scene| scene.validate_object(index).and_then(|()| scene.validate_triangle_count()),
        )?;
        self.inner_pieces.leave_out(&mut self.world.scene);
        self.renew_geometry();
        let scene = &self.world.scene;
        // Vertex colors may count in the widest profile of a material
        for material in [old.material, scene.objects[index].material] {
            self.recipes.update(scene, material);
        }
        Ok(Renewed { geometry: true, lights: true, ..Renewed::default() })
    }

    fn edit_objects(&mut self, objects: Vec<Object>) -> Result<Renewed, SceneError> {
        let scene = &mut self.world.scene;
        let old = std::mem::replace(&mut scene.objects, objects);
        if let Err(error) = scene.validate_objects_after(&old) {
            scene.objects = old;
            return Err(error);
        }
        self.inner_pieces.leave_out(&mut self.world.scene);
        self.renew_geometry();
        let scene = &self.world.scene;
        // Vertex colors may count in the widest profile of a material
        let colored = |objects: &[Object]| -> HashSet<(usize, usize)> {
            let has_colors = |object: &&Object| !object.mesh.colors.is_empty();
            let key = |object: &Object| (Arc::as_ptr(&object.mesh).addr(), object.material);
            objects.iter().filter(has_colors).map(key).collect()
        };
        let changed: HashSet<usize> = colored(&old)
            .symmetric_difference(&colored(&scene.objects))
            .map(|&(_, material)| material)
            .collect();
        for &material in &changed {
            self.recipes.update(scene, material);
        }
        Ok(Renewed { geometry: true, lights: true, ..Renewed::default() })
    }

    fn renew_geometry(&mut self) {
        self.world.geometry = Arc::new(self.world.geometry.renewed(&self.world.scene.objects));
    }

    fn add_material(&mut self, material: Material) -> Result<Renewed, SceneError> {
        let scene = &mut self.world.scene;
        scene.materials.push(material);
        let index = scene.materials.len() - 1;
        if let Err(error) = scene.validate_material(index) {
            scene.materials.pop();
            return Err(error);
        }
        self.world.surfaces.push(&scene.materials[index], &scene.integrator);
        self.recipes.push(scene);
        Ok(Renewed { materials: 1, ..Renewed::default() })
    }

    fn remove_material(&mut self, index: usize) -> Result<Renewed, SceneError> {
        let scene = &mut self.world.scene;
        require("material", index, scene.materials.len())?;
        if let Some(object) = scene.objects.iter().find(|object| object.material == index) {
            let name = &scene.materials[index].name;
            return Err(SceneError::new(format!("material {name} is that of the object {}", object.name)));
        }
        scene.materials.remove(index);
        for object in &mut scene.objects {
            object.material -= usize::from(object.material > index);
        }
        self.world.surfaces.remove(index);
        self.recipes.remove(index);
        self.renew_transports();
        Ok(Renewed::default())
    }

    /// Returns `true` if the scene asks for points that it does not have yet. Until it has, probes find the light.
    pub fn wants_points(&self) -> bool {
        self.world.scene.integrator.subsurface_method == SubsurfaceMethod::PointBased
            && !self.transports.has_points()
    }

    /// The points that pictures of a view need.
    ///
    /// Their spacing follows the mean free path, and no less the width of a pixel.
    pub fn plan_points(&self, view: &View) -> PointPlan {
        PointPlan::new(&self.world, self.transports.all(), &pixel_widths(&self.world, view))
    }

    /// Lays the points that a view needs and computes the light that enters there, on the current rayon pool; `None` when
    /// stopped.
    ///
    /// The points do not depend on the number of threads.
    ///
    /// # Errors
    /// The points would take more than `memory` bytes.
    pub fn make_points(
        &self,
        view: &View,
        memory: u64,
        progress: &(dyn Fn(PointProgress) + Sync),
        stop: &AtomicBool,
    ) -> Result<Option<PointCloud>, SceneError> {
        let laid = PointCloud::laid(
            &self.world,
            &self.plan_points(view),
            &PointSettings { memory, progress, stop },
        )?;
        // Paths that begin at entry points are in no pixel
        let tracer = || self.tracer(PixelWidth::default());
        Ok(laid.and_then(|points| points.lit(&self.world, tracer, progress, stop)))
    }

    /// Returns `true` if this scene's points lie close enough for a view: points made for much wider pixels do not.
    pub fn points_serve(&self, points: &PointCloud, view: &View) -> bool {
        serve(points.groups(), &pixel_widths(&self.world, view))
    }

    /// Forgets points that lie too far apart for a view.
    pub(crate) fn keep_points_for(&mut self, view: &View) {
        if self.transports.has_points()
            && self.transports.needs_closer_points(&pixel_widths(&self.world, view))
        {
            self.transports.forget_points();
        }
    }

    /// Gathers light under surfaces from this scene's points instead of probing for it.
    ///
    /// Probes find the light of subsurface groups without points.
    pub fn set_points(&mut self, points: &PointCloud) {
        self.transports.set_points(&self.world, points);
    }

    /// A tracer of paths through pixels of a width.
    pub(crate) fn tracer(&self, pixel_width: PixelWidth) -> PathTracer<'_> {
        PathTracer::new(&self.world, &self.transports, pixel_width)
    }

    /// Probes along (tangent, tangent, normal) with these probabilities.
    pub(crate) fn set_probe_axes(&mut self, axes: [f32; 3]) {
        self.recipes.set_axes(axes);
        for index in 0..self.world.scene.materials.len() {
            self.recipes.update(&self.world.scene, index);
        }
        self.renew_transports();
    }

    pub(crate) fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Returns `true` if light may pass any of the surfaces that shadow rays meet.
    pub(crate) fn shadows_look(&self) -> bool {
        self.world.surfaces.any_lets_light_through() || self.world.media.any()
    }

    pub(crate) fn parts(&self) -> (&World, &Transports) {
        (&self.world, &self.transports)
    }
}

/// Refuses a number that is out of range.
fn require(what: &str, index: usize, count: usize) -> Result<(), SceneError> {
    if index < count {
        return Ok(());
    }
    Err(SceneError::new(format!("{what} {index} is not there: the scene has {count}, counted from 0")))
}

/// The lights of a scene, emissive triangles included.
fn light_set(scene: &Scene, geometry: &Geometry) -> LightSet {
    let mut lights = LightSet::new(scene, emissive_triangles(scene, geometry), geometry.bounds());
    lights.look_for_openings(geometry);
    lights
}

/// The triangles of all objects that emit light.
fn emissive_triangles(scene: &Scene, geometry: &Geometry) -> Vec<EmissiveTriangle> {
    let mut found = Vec::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let material = &scene.materials[object.material];
        if material.emission_luminance <= 0.0 {
            continue;
        }
        for number in 0..object.mesh.triangles.len() as u32 {
            let primitive = geometry.primitive(index as u32, number);
            let vertices = object.vertices(number as usize);
            let center = vertices.iter().sum::<Vec3>() / 3.0;
            let point = geometry.point_on(scene, primitive, center);
            let radiance = surface::emission_at(scene, material, &point);
            // A textured emitter may be dark in the middle of a triangle and bright beside it.
            let floor = if material.emission_color.texture.is_some() {
                Vec3::splat(1e-3 * material.emission_luminance)
            } else {
                Vec3::ZERO
            };
            found.push(EmissiveTriangle { vertices, radiance: radiance.max(floor), primitive });
        }
    }
    found
}
