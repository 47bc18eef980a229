//! From a checked scene file and the files that it names to a scene.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Affine3A, DVec3};
use rayon::prelude::*;
use translucid_scene::description::FileRequest;
use translucid_scene::{
    Camera, Interval, Light, Material, Mesh, Object, Place, Scene, SceneError, Unit, Warning, repair_mesh,
};
use translucid_shapes::build_shape;

use super::base::Base;
use super::files::KnownFiles;
use super::object::{GeometryOrigin, ObjectEntry};
use super::{Grouping, LARGEST_FILE, SceneFile};
use crate::appearance::warn_of_darkened;
use crate::extent::warn_of_extent;
use crate::file::{is_file, read_file, with_nearest};
use crate::image::read_image;
use crate::loading::Loading;
use crate::mesh_file::{MeshFile, scale_lengths};
use crate::model::{is_gltf, load_model};
use crate::options::LoadOptions;
use crate::orientation::bounds;
use crate::origin::{origin_near, place_of_file};
use crate::profile_table::read_profile_table;
use crate::result::Result;
use crate::shared_mesh::SharedMesh;
use crate::stage::Stage;

/// Entries whose shapes are made at the same time: enough to keep many threads busy, few enough that a scene which
/// goes beyond [`Scene::MOST_TRIANGLES`] is noticed in time.
const SHAPES_AT_ONCE: usize = 32;

/// Most lights that files may bring, in all their places.
const MOST_LIGHTS: usize = 1 << 20;

impl SceneFile {
    /// Reads a scene file without opening the files that it names.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), or the file cannot be read, is not UTF-8, or has more than 16 MiB.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self { file: Some(path.to_owned()), ..Self::parse(&read_text(path)?, path)? })
    }

    /// Opens the meshes and images and makes the scene, with other meshes for some of the objects.
    pub(super) fn assemble(
        self,
        overrides: &HashMap<usize, &Path>,
        options: &LoadOptions,
        loading: &mut Loading<'_>,
    ) -> Result<Scene> {
        let camera = self.camera(options.camera.as_deref())?;
        let mut scene = self.scene;
        scene.film = options.film(scene.film);
        let images =
            load_files(&self.images, |image| read_image(&image.path, image.kind, loading).map(Arc::new))?;
        scene.images.extend(images);
        let mut builder = SceneBuilder { grouping: self.grouping, camera, ..SceneBuilder::of(scene) };
        let replacement = |index: usize| overrides.get(&index).copied();
        for (index, entry) in self.objects.iter().enumerate() {
            builder.expect(entry, replacement(index));
        }
        if builder.camera.is_none() && builder.scene.origin == DVec3::ZERO {
            let known = loading.warnings.len();
            let origin = builder.origin_of_files(&self.objects, replacement, loading)?;
            if origin != DVec3::ZERO {
                loading.warnings.truncate(known);
                let source = self.source.in_scene_at(origin.to_array());
                let file = Self::of(source, self.entries, Base::Unknown, Some(loading))?;
                return file.assemble(overrides, options, loading);
            }
        }
        for (chunk, entries) in self.objects.chunks(SHAPES_AT_ONCE).enumerate() {
            let of_one_use = |entry: &ObjectEntry| {
                if builder.uses(entry, None) > 1 { None } else { ReadyMesh::of_shape(entry) }
            };
            let shapes: Vec<_> = entries.par_iter().map(of_one_use).collect();
            for (number, (entry, shape)) in entries.iter().zip(shapes).enumerate() {
                let index = chunk * SHAPES_AT_ONCE + number;
                loading.watch.tell(index, self.objects.len())?;
                match (shape, &entry.geometry) {
                    (Some(shape), _) => builder.add_ready(entry, 0, shape?, loading.warnings)?,
                    (None, GeometryOrigin::Shape { .. }) => {
                        builder.add_shape(entry, loading.warnings)?;
                    }
                    (None, _) => builder.add_file(entry, replacement(index), loading)?,
                }
            }
        }
        let mut scene = match (self.extends, builder.camera) {
            // Whatever is missing was chosen for the base
            (Some(_), Some(camera)) => Scene { camera: options.moved(camera), ..builder.scene },
            (_, camera) => staged(builder.scene, camera, options),
        };
        let tables = load_files(&self.profile_tables, |table| read_profile_table(&table.path, loading))?;
        scene.profile_tables.extend(tables);
        // Files that the scene names, and what follows from them, may go beyond what the text was checked for.
        options.finish(scene).map_err(|error| error.or_at(self.source.path()))
    }

    /// Numbers and names of the objects whose mesh is in a file.
    pub(super) fn mesh_files(&self) -> impl Iterator<Item = (usize, &str)> {
        let is_file = |object: &ObjectEntry| matches!(object.geometry, GeometryOrigin::File { .. });
        let objects = self.objects.iter().enumerate();
        objects.filter(move |(_, object)| is_file(object)).map(|(i, object)| (i, object.name.as_str()))
    }
}

pub(super) fn read_text(path: &Path) -> Result<String> {
    let length = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    if length > LARGEST_FILE {
        let message = format!("the file has {length} bytes, but at most {LARGEST_FILE} are allowed");
        return Err(SceneError::at(Place::file(path), message));
    }
    let bytes = read_file(path)?;
    String::from_utf8(bytes).map_err(|error| {
        let place = Place::part(path, format!("byte {}", error.utf8_error().valid_up_to()));
        SceneError::at(place, "the file must be UTF-8 text, but this is not")
    })
}

/// Loads the files that are asked for.
fn load_files<K, T>(
    requests: &[FileRequest<K>],
    mut load: impl FnMut(&FileRequest<K>) -> Result<T>,
) -> Result<Vec<T>> {
    let checked =
        |request: &FileRequest<K>| check_present(&request.path, &request.place).and_then(|()| load(request));
    requests.iter().map(checked).collect()
}

/// A missing file is the scene file's mistake, so the message points there.
pub(super) fn check_present(path: &Path, place: &Place) -> Result<()> {
    check_present_or(path, place, None)
}

/// As [`check_present`], with advice for a file that is missing.
pub(super) fn check_present_or(path: &Path, place: &Place, advice: Option<String>) -> Result<()> {
    if is_file(path) {
        return Ok(());
    }
    let found = if path.is_dir() { "is a folder, not a file" } else { "does not exist" };
    let error = SceneError::at(place.clone(), format!("the file {} {found}", path.display()));
    Err(with_nearest(SceneError { help: advice, ..error }, path))
}

/// Objects that may exchange light under the surface.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Group {
    Named(String),
    /// Index of the material.
    Material(usize),
    /// Entry of the scene file and group within the mesh file.
    Own(usize, u32),
}

/// A mesh in its place in the scene, checked and valid.
pub(super) struct ReadyMesh {
    mesh: Arc<Mesh>,
    /// The part of its placement that is not baked into its vertices.
    world_from_local: Affine3A,
    /// Triangles before the repair, which others do not count.
    triangles: usize,
    warnings: Vec<Warning>,
}

impl ReadyMesh {
    /// The shape of an entry with one place; none if it has a file.
    fn of_shape(entry: &ObjectEntry) -> Option<Result<Self>> {
        let mesh = raw_shape(entry)?;
        Some(mesh.and_then(|mesh| Self::new(entry, &entry.places[0].as_affine3a(), mesh)))
    }

    /// A mesh in a place, shared if it can be there.
    fn of_shared(entry: &ObjectEntry, place: &Affine3A, shared: &SharedMesh) -> Result<Self> {
        match shared.placed(place) {
            Some(Object { mesh, world_from_local, .. }) => {
                Ok(Self { mesh, world_from_local, triangles: 0, warnings: Vec::new() })
            }
            None => Self::new(entry, place, Mesh::clone(shared.mesh())),
        }
    }

    /// A mesh in its own space.
    fn movable(entry: &ObjectEntry, place: &Affine3A, mut mesh: Mesh) -> Result<Self> {
        let triangles = mesh.triangles.len();
        let mut warnings = Vec::new();
        repair_mesh(&mut mesh, &entry.place, &mut warnings)?;
        let object = Object { mesh: mesh.into(), world_from_local: *place, ..Object::default() };
        object.check_place(|| object.mesh.flattest(), object.mesh.bounds()).map_err(|error| {
            let message = format!("it is movable, but its {}", error.message);
            SceneError::at(entry.place.clone(), message).with_help("leave movable out")
        })?;
        Ok(Self { mesh: object.mesh, world_from_local: *place, triangles, warnings })
    }

    /// A mesh with its place baked into its vertices.
    fn new(entry: &ObjectEntry, place: &Affine3A, mesh: Mesh) -> Result<Self> {
        let triangles = mesh.triangles.len();
        let mut mesh = mesh.transformed(place);
        check_bounds(&mesh, &entry.place)?;
        let mut warnings = Vec::new();
        repair_mesh(&mut mesh, &entry.place, &mut warnings)?;
        Ok(Self { mesh: mesh.into(), world_from_local: Affine3A::IDENTITY, triangles, warnings })
    }
}

/// The shape of an entry where it is made; none if that has a file.
fn raw_shape(entry: &ObjectEntry) -> Option<Result<Mesh>> {
    let GeometryOrigin::Shape { name, parameters } = &entry.geometry else { return None };
    let at_place = |error: SceneError| SceneError { place: Some(entry.place.clone()), ..error };
    Some(build_shape(name, parameters).map_err(at_place))
}

/// Key that identifies a mesh before it is loaded.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Source {
    /// A file, and the name of the unit of its coordinates.
    File(PathBuf, &'static str),
    /// A shape, and its parameters with the bits of their values.
    Shape(String, Vec<(String, u64)>),
}

/// A mesh file and the index that its first material has in the scene, once it is there.
#[derive(Clone, Debug)]
struct LoadedMeshFile {
    model: MeshFile,
    /// Files that it was read from.
    files: BTreeSet<PathBuf>,
    first_material: Option<usize>,
    /// Those meshes of the model that several objects have, by their address.
    shared: HashMap<usize, SharedMesh>,
}

/// A scene on its way: things are added one after another, what it does not say is chosen at the end.
///
/// Each thing is a [`Piece`](crate::Piece) with the keys of a scene file's table, and fails at once if it is wrong.
///
/// ```
/// use translucid_load::{LoadOptions, Piece, SceneBuilder};
/// use translucid_scene::Unit;
///
/// let mut builder = SceneBuilder::new(Unit::Millimeter);
/// let mut warnings = Vec::new();
/// builder.add_material(&Piece::parse("material jade", "name = 'jade'\npreset = 'jade'")?, &mut warnings)?;
/// builder.add_object(&Piece::parse("object ball", "shape = 'sphere'\nmaterial = 'jade'")?, &mut warnings)?;
/// let error = builder.set_film(&Piece::parse("film", "sise = [64, 64]")?).unwrap_err();
/// assert!(error.to_string().starts_with("film: it has no key sise (did you mean size?"));
/// let scene = builder.build(&LoadOptions::default())?;
/// assert_eq!(scene.lights.len(), 2); // those of a scene that has none
/// # Ok::<(), translucid_scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    /// The scene so far.
    pub(super) scene: Scene,
    pub(super) grouping: Grouping,
    /// The camera, if it is not to be chosen.
    pub(super) camera: Option<Camera>,
    default_material: Option<usize>,
    models: HashMap<Source, LoadedMeshFile>,
    /// Shapes that several objects have.
    shapes: HashMap<Source, SharedMesh>,
    /// Uses of a mesh that are known: those that are to come, and those that there have been.
    expected: HashMap<Source, usize>,
    used: HashMap<Source, usize>,
    groups: HashMap<Group, u32>,
    next_group: u32,
    /// Entries that objects were made of: several for an entry with a file.
    entries: usize,
    /// Triangles before the repair.
    triangles: usize,
    /// Files that were brought in piece by piece.
    pub(super) files: KnownFiles,
}

impl SceneBuilder {
    /// A scene that goes on from this one, its camera to be chosen.
    pub(super) fn of(scene: Scene) -> Self {
        let groups = scene.objects.iter().map(|object| object.subsurface_group.saturating_add(1));
        // Shared meshes are counted when the scene is checked
        let own = scene.objects.iter().filter(|object| !object.is_placed());
        let triangles = own.map(|object| object.mesh.triangles.len()).sum();
        Self {
            next_group: groups.max().unwrap_or(0),
            entries: 0,
            triangles,
            scene,
            grouping: Grouping::Object,
            camera: None,
            default_material: None,
            models: HashMap::new(),
            shapes: HashMap::new(),
            expected: HashMap::new(),
            used: HashMap::new(),
            groups: HashMap::new(),
            files: KnownFiles::default(),
        }
    }

    /// Makes a change that adds things, and takes all of it back where it returns false: it has failed, or nobody waits for
    /// it any more.
    pub fn all_or_nothing(&mut self, change: impl FnOnce(&mut Self) -> bool) {
        let Scene { objects, materials, images, profile_tables, lights, environment, files, .. } =
            &self.scene;
        let (environment, files) = (*environment, files.clone());
        let [objects, materials, images, tables, lights] =
            [objects.len(), materials.len(), images.len(), profile_tables.len(), lights.len()];
        let (default_material, triangles) = (self.default_material, self.triangles);
        if !change(self) {
            self.scene.objects.truncate(objects);
            self.scene.materials.truncate(materials);
            self.scene.images.truncate(images);
            self.scene.profile_tables.truncate(tables);
            self.scene.lights.truncate(lights);
            (self.scene.environment, self.scene.files) = (environment, files);
            (self.default_material, self.triangles) = (default_material, triangles);
            self.files.images.retain(|_, image| *image < images);
            self.files.tables.retain(|_, table| *table < tables);
            // What a file had of materials went into the scene
            self.models.retain(|_, loaded| loaded.first_material.is_none_or(|first| first < materials));
        }
    }

    /// Key of the mesh of an entry, with another file in place of its own; none if it is at hand.
    fn source(&self, entry: &ObjectEntry, replacement: Option<&Path>) -> Option<Source> {
        match &entry.geometry {
            GeometryOrigin::File { path, unit } => {
                let path = replacement.unwrap_or(path);
                Some(Source::File(path.to_owned(), self.unit(path, *unit).name()))
            }
            GeometryOrigin::Shape { name, parameters } => {
                let parameters = parameters.iter().map(|(name, value)| (name.to_owned(), value.to_bits()));
                Some(Source::Shape(name.clone(), parameters.collect()))
            }
            GeometryOrigin::Given => None,
        }
    }

    /// The unit of a file's coordinates.
    fn unit(&self, path: &Path, stated: Option<Unit>) -> Unit {
        stated.unwrap_or(if is_gltf(path) { Unit::Meter } else { self.scene.unit })
    }

    /// Says that an entry is to come.
    fn expect(&mut self, entry: &ObjectEntry, replacement: Option<&Path>) {
        if let Some(source) = self.source(entry, replacement) {
            *self.expected.entry(source).or_insert(0) += entry.places.len();
        }
    }

    /// How often the mesh of an entry is used, as far as is known, this entry included.
    fn uses(&self, entry: &ObjectEntry, replacement: Option<&Path>) -> usize {
        let Some(source) = self.source(entry, replacement) else { return entry.places.len() };
        let used = self.used.get(&source).copied().unwrap_or(0) + entry.places.len();
        used.max(self.expected.get(&source).copied().unwrap_or(0))
    }

    /// Adds an object whose mesh is there, in the place of a number.
    fn add_ready(
        &mut self,
        entry: &ObjectEntry,
        place: usize,
        mesh: ReadyMesh,
        warnings: &mut Vec<Warning>,
    ) -> Result<()> {
        let material = entry.material.unwrap_or_else(|| self.default_material());
        self.entries += 1;
        self.add_mesh(entry, mesh, (entry.name_at(&entry.name, place), material, 0), warnings)
    }

    /// Adds an object in all of its places.
    fn add_shared(
        &mut self,
        entry: &ObjectEntry,
        shared: &SharedMesh,
        warnings: &mut Vec<Warning>,
    ) -> Result<()> {
        // One after the other: what has to be baked may be too much
        entry.places.iter().enumerate().try_for_each(|(number, place)| {
            let mesh = ReadyMesh::of_shared(entry, &place.as_affine3a(), shared)?;
            self.add_ready(entry, number, mesh, warnings)
        })
    }

    /// Adds an object whose mesh is at hand.
    pub(super) fn add_given(
        &mut self,
        entry: &ObjectEntry,
        mesh: Mesh,
        warnings: &mut Vec<Warning>,
    ) -> Result<()> {
        match &entry.places[..] {
            [place] if entry.is_movable => {
                self.add_ready(entry, 0, ReadyMesh::movable(entry, &place.as_affine3a(), mesh)?, warnings)
            }
            [place] => self.add_ready(entry, 0, ReadyMesh::new(entry, &place.as_affine3a(), mesh)?, warnings),
            places => {
                let shared = SharedMesh::new(mesh.into(), places.len(), &entry.place, warnings)?;
                self.add_shared(entry, &shared, warnings)
            }
        }
    }

    /// Adds an object with a shape, which is made once however many have it.
    pub(super) fn add_shape(&mut self, entry: &ObjectEntry, warnings: &mut Vec<Warning>) -> Result<()> {
        let uses = self.uses(entry, None);
        let Some(source) = self.source(entry, None) else { return Ok(()) };
        *self.used.entry(source.clone()).or_insert(0) += entry.places.len();
        let shared = match self.shapes.remove(&source) {
            Some(shared) if shared.is_shared() => shared,
            known => {
                let mesh = known.map(|known| Ok(Arc::clone(known.mesh())));
                let Some(mesh) = mesh.or_else(|| raw_shape(entry).map(|mesh| mesh.map(Arc::new))) else {
                    return Ok(());
                };
                SharedMesh::new(mesh?, uses, &entry.place, warnings)?
            }
        };
        self.add_shared(entry, &shared, warnings)?;
        if uses > 1 {
            self.shapes.insert(source, shared);
        }
        Ok(())
    }

    /// Adds what is in the file of an entry, or in the one that replaces it.
    pub(super) fn add_file(
        &mut self,
        entry: &ObjectEntry,
        replacement: Option<&Path>,
        loading: &mut Loading<'_>,
    ) -> Result<()> {
        let GeometryOrigin::File { path, unit } = &entry.geometry else { return Ok(()) };
        let path = replacement.unwrap_or(path);
        let advice = format!("put the mesh there, or give its path with --mesh {}=PATH", entry.name);
        check_present_or(path, &entry.place, Some(advice))?;
        let uses = self.uses(entry, replacement);
        // Taken out while its parts are added, and put back for the next object with the same file.
        let mut loaded = self.loaded(path, *unit, loading)?;
        let unit = self.unit(path, *unit);
        let source = Source::File(path.to_owned(), unit.name());
        loading.add_files(loaded.files.iter().cloned());
        *self.used.entry(source.clone()).or_insert(0) += entry.places.len();
        let first_material = self.first_material(entry, &mut loaded, loading.warnings);
        let mut uses_of_mesh: HashMap<usize, usize> = HashMap::new();
        for part in &loaded.model.objects {
            *uses_of_mesh.entry(Arc::as_ptr(&part.mesh).addr()).or_insert(0) += uses;
        }
        for (number, place) in entry.places.iter().enumerate() {
            let place = place_of_file(place, loaded.model.origin).as_affine3a();
            self.entries += 1;
            for part in &loaded.model.objects {
                let material = entry.material.unwrap_or_else(|| match first_material {
                    Some(first) => first + part.material,
                    None => self.default_material(),
                });
                let name = entry.name_at(&entry.name, number);
                let name =
                    if loaded.model.objects.len() == 1 { name } else { format!("{name}/{}", part.name) };
                let address = Arc::as_ptr(&part.mesh).addr();
                let place = if part.is_placed() { place * part.world_from_local } else { place };
                let mesh = if part.mesh.is_worth_sharing(uses_of_mesh[&address]) {
                    let shared = match loaded.shared.entry(address) {
                        Entry::Occupied(known) => known.into_mut(),
                        Entry::Vacant(new) => {
                            let mesh = Arc::clone(&part.mesh);
                            new.insert(SharedMesh::new(
                                mesh,
                                uses_of_mesh[&address],
                                &entry.place,
                                loading.warnings,
                            )?)
                        }
                    };
                    ReadyMesh::of_shared(entry, &place, shared)?
                } else {
                    ReadyMesh::new(entry, &place, Mesh::clone(&part.mesh))?
                };
                self.add_mesh(entry, mesh, (name, material, part.subsurface_group), loading.warnings)?;
            }
            let lights = loaded.model.lights.iter();
            self.scene.lights.extend(lights.filter_map(|light| transformed_light(light, &place)));
            if self.scene.lights.len() > MOST_LIGHTS {
                let message = format!("the scene has more than {MOST_LIGHTS} lights up to here");
                return Err(SceneError::at(entry.place.clone(), message));
            }
        }
        self.warn_of_extent(entry, unit, loaded.model.objects.len(), loading.warnings);
        self.models.insert(source, loaded);
        Ok(())
    }

    /// The origin for the first of the files whose objects are far from the scene's; zero where none is.
    fn origin_of_files<'a>(
        &mut self,
        entries: &'a [ObjectEntry],
        replacement: impl Fn(usize) -> Option<&'a Path>,
        loading: &mut Loading<'_>,
    ) -> Result<DVec3> {
        for (index, entry) in entries.iter().enumerate() {
            let GeometryOrigin::File { path, unit } = &entry.geometry else { continue };
            let path = replacement(index).unwrap_or(path);
            if is_file(path) {
                let loaded = self.loaded(path, *unit, loading)?;
                let model = &loaded.model;
                let place = place_of_file(&entry.places[0], model.origin);
                let (low, high) = bounds(&model.objects);
                let scale = libm::cbrt(place.matrix3.determinant().abs());
                let size = 0.5 * f64::from((high - low).max_element()) * scale;
                let origin = origin_near(place.translation, size);
                let unit = self.unit(path, *unit).name();
                self.models.insert(Source::File(path.to_owned(), unit), loaded);
                if origin != DVec3::ZERO {
                    return Ok(origin);
                }
            }
        }
        Ok(DVec3::ZERO)
    }

    /// Warns of a file whose objects, the last of the scene, are of a size that no one means.
    fn warn_of_extent(&self, entry: &ObjectEntry, unit: Unit, count: usize, warnings: &mut Vec<Warning>) {
        let Scene { objects, materials, unit: of_scene, .. } = &self.scene;
        let new = &objects[objects.len() - count..];
        let advice = |unit: Unit| format!("unit = \"{}\"", unit.name());
        warn_of_extent((new, materials), [*of_scene, unit], advice, &entry.place, warnings);
    }

    /// A mesh file, taken out of those that are known.
    fn loaded(
        &mut self,
        path: &Path,
        stated: Option<Unit>,
        loading: &mut Loading<'_>,
    ) -> Result<LoadedMeshFile> {
        let unit = self.unit(path, stated);
        if let Some(loaded) = self.models.remove(&Source::File(path.to_owned(), unit.name())) {
            return Ok(loaded);
        }
        let mut own = Loading::new(loading.watch, loading.warnings);
        let mut model = load_model(path, &mut own)?;
        scale_lengths(&mut model, (unit.in_millimeters() / self.scene.unit.in_millimeters()) as f32);
        let files = own.into_files();
        Ok(LoadedMeshFile { model, files, first_material: None, shared: HashMap::new() })
    }

    /// Brings the file's own materials and images into the scene when they are first used.
    fn first_material(
        &mut self,
        entry: &ObjectEntry,
        loaded: &mut LoadedMeshFile,
        warnings: &mut Vec<Warning>,
    ) -> Option<usize> {
        if entry.material.is_none() && !loaded.model.materials.is_empty() && loaded.first_material.is_none() {
            if let GeometryOrigin::File { path, .. } = &entry.geometry {
                warn_of_darkened(&loaded.model, path, warnings);
            }
            loaded.first_material = Some(self.scene.materials.len());
            let shift = self.scene.images.len();
            self.scene.images.extend(loaded.model.images.drain(..).map(Arc::new));
            for material in &mut loaded.model.materials {
                material.for_each_image(|image| *image += shift);
            }
            self.scene.materials.append(&mut loaded.model.materials);
        }
        loaded.first_material
    }

    fn add_mesh(
        &mut self,
        entry: &ObjectEntry,
        ReadyMesh { mesh, world_from_local, triangles, warnings: mut of_mesh }: ReadyMesh,
        (name, material, model_group): (String, usize, u32),
        warnings: &mut Vec<Warning>,
    ) -> Result<()> {
        self.triangles += triangles;
        if self.triangles > Scene::MOST_TRIANGLES {
            let most = Scene::MOST_TRIANGLES;
            let message = format!("the scene has more than {most} triangles up to here");
            return Err(SceneError::at(entry.place.clone(), message));
        }
        warnings.append(&mut of_mesh);
        let group = match &entry.subsurface_group {
            Some(name) => Group::Named(name.clone()),
            None if self.grouping == Grouping::Material => Group::Material(material),
            None => Group::Own(self.entries, model_group),
        };
        let next = self.next_group;
        let subsurface_group = *self.groups.entry(group).or_insert(next);
        if subsurface_group == next {
            self.next_group += 1;
        }
        if self.scene.objects.len() >= Scene::MOST_OBJECTS {
            let most = Scene::MOST_OBJECTS;
            let message = format!("the scene has more than {most} objects up to here");
            return Err(SceneError::at(entry.place.clone(), message));
        }
        let is_movable = entry.is_movable;
        self.scene.objects.push(Object {
            name,
            mesh,
            world_from_local,
            material,
            subsurface_group,
            is_movable,
        });
        Ok(())
    }

    /// The material of objects that have none.
    fn default_material(&mut self) -> usize {
        *self.default_material.get_or_insert_with(|| {
            self.scene.materials.push(Material::default());
            self.scene.materials.len() - 1
        })
    }
}

/// The scene with a camera, and with lights where it has none.
pub(super) fn staged(mut scene: Scene, camera: Option<Camera>, options: &LoadOptions) -> Scene {
    let stage = Stage::of(&scene.objects);
    let aspect = f64::from(scene.film.width) / f64::from(scene.film.height);
    let automatic = stage.turning(options.turn.is_some()).seen_from(options.viewpoint);
    scene.camera = match camera {
        Some(camera) => options.moved(camera),
        None => options.turned(automatic.camera(&scene.objects, aspect)),
    };
    let emits = |object: &Object| scene.materials[object.material].emission_luminance > 0.0;
    let is_dark = scene.lights.is_empty() && !scene.objects.iter().any(emits);
    if is_dark && scene.environment.is_none() && options.surroundings.file.is_none() {
        scene.lights = stage.lights();
        scene.environment = Some(stage.environment());
    }
    scene
}

/// A mesh out of bounds is refused here; the repair would cut it off.
fn check_bounds(mesh: &Mesh, place: &Place) -> Result<()> {
    let (low, high) = mesh.bounds();
    let (reach, range) = (low.abs().max(high.abs()).max_element(), Interval::COORDINATE);
    if range.contains(f64::from(reach)) {
        return Ok(());
    }
    let message = format!("the object reaches to {reach:e} in x, y or z, but coordinates must be in {range}");
    Err(SceneError::at(place.clone(), message))
}

/// A mesh file's light moved with its object; its intensity grows with the square of the scale, so that
/// what it lights stays as bright.
fn transformed_light(light: &Light, map: &Affine3A) -> Option<Light> {
    let direct = |direction| map.transform_vector3(direction).try_normalize();
    match *light {
        Light::Spot { position, direction, radius, intensity, inner_angle, outer_angle, visible } => {
            let scale = libm::cbrtf(map.matrix3.determinant().abs());
            Some(Light::Spot {
                position: map.transform_point3(position),
                direction: direct(direction)?,
                radius: radius * scale,
                intensity: intensity * scale * scale,
                inner_angle,
                outer_angle,
                visible,
            })
        }
        Light::Distant { direction, angular_radius, irradiance } => {
            Some(Light::Distant { direction: direct(direction)?, angular_radius, irradiance })
        }
        // Mesh files have no others.
        _ => None,
    }
}
