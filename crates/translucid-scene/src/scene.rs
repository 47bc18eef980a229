//! The whole scene: what a loader returns and a renderer takes.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::{
    Camera, Environment, Film, Image, Integrator, Light, Material, Mesh, Object, ProfileTable, SceneError,
    Unit,
};
use translucid_words::check_index;

/// Everything needed to make a picture.
///
/// [`validate`](Self::validate) reports what is wrong with a scene made in code; a scene from a file is valid.
/// The default has a camera, a film and no objects.
///
/// ```
/// use translucid_scene::{Environment, Material, Mesh, Object, Scene};
///
/// let mesh = Mesh {
///     positions: vec![[0.0, 0.0, 0.0].into(), [1.0, 0.0, 0.0].into(), [0.0, 1.0, 0.0].into()],
///     triangles: vec![[0, 1, 2]],
///     ..Mesh::default()
/// };
/// let scene = Scene {
///     objects: vec![Object { name: "triangle".into(), mesh: mesh.into(), ..Object::default() }],
///     materials: vec![Material::default()],
///     environment: Some(Environment::default()),
///     ..Scene::default()
/// };
/// scene.validate()?;
/// # Ok::<(), translucid_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Length unit of every number below.
    pub unit: Unit,
    /// The point of the world from which all positions below are counted \[L\]: single precision has digits for what is near
    /// it. Zero in a scene that is not far from the world's own origin.
    pub origin: DVec3,
    /// The camera.
    pub camera: Camera,
    /// Image size, filter, exposure, tone mapping.
    pub film: Film,
    /// Samples per pixel and path limits.
    pub integrator: Integrator,
    /// Surfaces.
    pub objects: Vec<Object>,
    /// Materials that [`Object::material`] refers to.
    pub materials: Vec<Material>,
    /// Images that texture references and the environment refer to; scenes may share them.
    pub images: Vec<Arc<Image>>,
    /// Profiles that [`SubsurfaceModel::Tabulated`](crate::SubsurfaceModel::Tabulated) refers to.
    pub profile_tables: Vec<ProfileTable>,
    /// Lights other than emissive objects and the environment.
    pub lights: Vec<Light>,
    /// Light from infinity in all directions; `None` is black.
    pub environment: Option<Environment>,
    /// Files that the scene was read from: all that another machine needs to load it. Empty for one that is made in code.
    pub files: BTreeSet<PathBuf>,
}

/// The checks of parts take time in proportion to the part: an edit need not check more.
impl Scene {
    /// Most triangles of a scene, shared ones counted once: 3 GiB of indices.
    pub const MOST_TRIANGLES: usize = 1 << 28;

    /// Most objects of a scene: some 10 GB with what a renderer makes of them.
    pub const MOST_OBJECTS: usize = 1 << 24;

    /// Checks everything that a renderer relies on: every index, every range, every mesh.
    ///
    /// # Errors
    /// Something is out of its range or dangling: the message names its place, its value and what it must be.
    ///
    /// ```
    /// use translucid_scene::{Material, Scene};
    ///
    /// let material = Material { name: "skin".into(), specular_ior: f32::NAN, ..Material::default() };
    /// let scene = Scene { materials: vec![material], ..Scene::default() };
    /// let message = scene.validate().unwrap_err().message;
    /// assert_eq!(message, "material skin, specular_ior = NaN: must be in [1, 4]");
    /// ```
    pub fn validate(&self) -> Result<(), SceneError> {
        self.camera.validate()?;
        self.film.validate()?;
        self.integrator.validate()?;
        self.validate_environment()?;
        first_error(self.materials.len(), |i| self.validate_material(i))?;
        first_error(self.lights.len(), |i| self.validate_light(i))?;
        self.validate_objects()?;
        let image = |i| check_one("image", &self.images, i, |image| &image.name, |image| image.check());
        first_error(self.images.len(), image)?;
        first_error(self.profile_tables.len(), |i| self.profile_tables[i].validate())
    }

    /// Checks all objects, their meshes and the number of their triangles.
    ///
    /// # Errors
    /// There are no objects, or more than 2²⁴, one of them is broken, or there are more than 2²⁸ triangles.
    pub fn validate_objects(&self) -> Result<(), SceneError> {
        if self.objects.is_empty() {
            return Err(SceneError::new("the scene has no objects, but must have at least one"));
        }
        self.validate_triangle_count()?;
        // A mesh is looked at once, however many objects share it
        let mut first_uses = HashMap::new();
        let mesh_of = |object: &Object| Arc::as_ptr(&object.mesh).addr();
        for (index, object) in self.objects.iter().enumerate() {
            first_uses.entry(mesh_of(object)).or_insert(index);
        }
        let is_first = |index: usize| first_uses[&mesh_of(&self.objects[index])] == index;
        first_error(self.objects.len(), |i| if is_first(i) { self.validate_object(i) } else { Ok(()) })?;
        if !self.objects.iter().any(Object::is_placed) {
            return first_error(self.objects.len(), |i| {
                self.check_object(i, |object| self.check_material(object))
            });
        }
        let facts: HashMap<usize, _> = first_uses
            .par_iter()
            .map(|(&mesh, &index)| {
                let first = &self.objects[index].mesh;
                (mesh, (first.flattest(), first.bounds()))
            })
            .collect();
        first_error(self.objects.len(), |i| {
            self.check_object(i, |object| {
                let (flattest, bounds) = facts[&mesh_of(object)];
                self.check_material(object)?;
                object.check_place(|| flattest, bounds)
            })
        })
    }

    /// Checks all objects of a scene that had others before, which were valid: meshes that were there are not looked at again.
    ///
    /// # Errors
    /// As [`validate_objects`](Self::validate_objects).
    pub fn validate_objects_after(&self, before: &[Object]) -> Result<(), SceneError> {
        if self.objects.is_empty() {
            return Err(SceneError::new("the scene has no objects, but must have at least one"));
        }
        self.validate_triangle_count()?;
        let mesh_of = |object: &Object| Arc::as_ptr(&object.mesh).addr();
        let place_of = |object: &Object| object.world_from_local.to_cols_array().map(f32::to_bits);
        let meshes: HashSet<usize> = before.iter().map(mesh_of).collect();
        let placed: HashSet<_> = before.iter().map(|object| (mesh_of(object), place_of(object))).collect();
        first_error(self.objects.len(), |i| {
            let object = &self.objects[i];
            if !meshes.contains(&mesh_of(object)) {
                return self.validate_object(i);
            }
            self.check_object(i, |object| {
                self.check_material(object)?;
                if placed.contains(&(mesh_of(object), place_of(object))) {
                    return Ok(());
                }
                object.check_place(|| object.mesh.flattest(), object.mesh.bounds())
            })
        })
    }

    /// Checks the numbers of objects and of triangles, without looking at them.
    ///
    /// # Errors
    /// There are more than 2²⁴ objects, or more than 2²⁸ triangles: those of meshes [worth
    /// sharing](Mesh::is_worth_sharing) count once, others, and those that emit light, for each object.
    pub fn validate_triangle_count(&self) -> Result<(), SceneError> {
        let objects = self.objects.len();
        if objects > Self::MOST_OBJECTS {
            return Err(SceneError::new(format!(
                "the scene has {objects} objects, but at most {} are allowed",
                Self::MOST_OBJECTS
            )));
        }
        let mut uses: HashMap<usize, (&Mesh, usize)> = HashMap::new();
        for object in &self.objects {
            uses.entry(Arc::as_ptr(&object.mesh).addr()).or_insert((&object.mesh, 0)).1 += 1;
        }
        let of_mesh = |&(mesh, uses): &(&Mesh, usize)| {
            let times = if mesh.is_worth_sharing(uses) { 1 } else { uses };
            mesh.triangles.len().saturating_mul(times)
        };
        let count = uses.values().map(of_mesh).fold(0_usize, usize::saturating_add);
        if count > Self::MOST_TRIANGLES {
            return Err(SceneError::new(format!(
                "the scene has {count} triangles, but at most {} are allowed",
                Self::MOST_TRIANGLES
            )));
        }
        let emits = |object: &&Object| {
            self.materials.get(object.material).is_some_and(|material| material.emission_luminance > 0.0)
        };
        let lamps = self.objects.iter().filter(emits).map(|object| object.mesh.triangles.len());
        let count = lamps.fold(0_usize, usize::saturating_add);
        if count > Self::MOST_TRIANGLES {
            return Err(SceneError::new(format!(
                "the scene has {count} triangles that emit light, each placing of a mesh counted, but at most \
                 {} are allowed",
                Self::MOST_TRIANGLES
            )));
        }
        Ok(())
    }

    /// Checks one object.
    ///
    /// # Errors
    /// There is no such object, or it is broken.
    pub fn validate_object(&self, index: usize) -> Result<(), SceneError> {
        self.check_object(index, |object| {
            self.check_material(object)?;
            object.mesh.validate()?;
            object.check_place(|| object.mesh.flattest(), object.mesh.bounds())
        })
    }

    fn check_object(
        &self,
        index: usize,
        check: impl Fn(&Object) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        check_one("object", &self.objects, index, |object| &object.name, check)
    }

    fn check_material(&self, object: &Object) -> Result<(), SceneError> {
        check_index("material", object.material, self.materials.len(), "materials")
    }

    /// Checks one material.
    ///
    /// # Errors
    /// There is no such material, or it is broken.
    pub fn validate_material(&self, index: usize) -> Result<(), SceneError> {
        let (images, tables) = (self.images.len(), self.profile_tables.len());
        let check = |material: &Material| material.check(images, tables);
        check_one("material", &self.materials, index, |material| &material.name, check)
    }

    /// Checks one light.
    ///
    /// # Errors
    /// There is no such light, or it is broken.
    pub fn validate_light(&self, index: usize) -> Result<(), SceneError> {
        get(&self.lights, index, "light")?.validate(index)
    }

    /// Checks the environment, if there is one.
    ///
    /// # Errors
    /// It is broken.
    pub fn validate_environment(&self) -> Result<(), SceneError> {
        self.environment.as_ref().map_or(Ok(()), |environment| environment.validate(self.images.len()))
    }
}

impl Scene {
    /// Drops the images that nothing refers to; those behind move up.
    pub fn drop_unused_images(&mut self) {
        let mut is_used = vec![false; self.images.len()];
        self.for_each_image(|number| is_used.get_mut(*number).into_iter().for_each(|used| *used = true));
        self.for_each_image(|number| *number = is_used.iter().take(*number).filter(|used| **used).count());
        let mut is_used = is_used.into_iter();
        self.images.retain(|_| is_used.next() == Some(true));
    }

    /// Every reference to an image.
    pub fn for_each_image(&mut self, mut visit: impl FnMut(&mut usize)) {
        self.materials.iter_mut().for_each(|material| material.for_each_image(&mut visit));
        self.environment.iter_mut().filter_map(|environment| environment.image.as_mut()).for_each(visit);
    }
}

/// The first error of so many checks.
fn first_error(
    count: usize,
    check: impl Fn(usize) -> Result<(), SceneError> + Sync,
) -> Result<(), SceneError> {
    (0..count).into_par_iter().find_map_first(|i| check(i).err()).map_or(Ok(()), Err)
}

fn get<'a, T>(list: &'a [T], index: usize, thing: &str) -> Result<&'a T, SceneError> {
    let count = list.len();
    list.get(index).ok_or_else(|| SceneError::new(format!("there is no {thing} {index} of {count}")))
}

/// Checks a thing of a list. An error names it by its name, with its index where others have the name, too, or it has
/// none.
fn check_one<T>(
    thing: &str,
    list: &[T],
    index: usize,
    name: impl Fn(&T) -> &str,
    check: impl Fn(&T) -> Result<(), SceneError>,
) -> Result<(), SceneError> {
    let one = get(list, index, thing)?;
    check(one).map_err(|error| {
        let own = name(one);
        match list.iter().filter(|other| name(other) == own).count() {
            _ if own.is_empty() => error.within(format_args!("{thing} {index}")),
            1 => error.within(format_args!("{thing} {own}")),
            _ => error.within(format_args!("{thing} {own} (index {index})")),
        }
    })
}
