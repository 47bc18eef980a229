//! From a checked scene file and the files that it names to a scene.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::input::{ImageRequest, TableRequest};
use super::object::{GeometryOrigin, ObjectEntry};
use super::{Grouping, LARGEST_FILE, SceneFile};
use crate::error::nearest;
use crate::interval::Interval;
use crate::load::mesh_file::{MeshFile, scale_lengths};
use crate::load::stage::Stage;
use crate::load::{LoadOptions, is_gltf, load_image, load_model, load_profile_table, read_file};
use crate::scene::MOST_TRIANGLES;
use crate::{
    Image, Light, Material, Mesh, Object, Place, ProfileTable, Scene, SceneError, Unit, Warning, build_shape,
    repair_mesh,
};

/// Entries whose shapes are made at the same time: enough to keep many threads busy, few enough that a scene which
/// goes beyond [`MOST_TRIANGLES`] is noticed in time.
const SHAPES_AT_ONCE: usize = 32;

impl SceneFile {
    /// Reads a scene file without opening the files that it names.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), or the file cannot be read, is not UTF-8, or has more than 16 MiB.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::parse(&read_text(path)?, path)
    }

    /// Opens the meshes and images and makes the scene.
    ///
    /// # Errors
    /// A file is missing or cannot be used; an option does not fit the scene.
    pub fn load(self, options: &LoadOptions, warnings: &mut Vec<Warning>) -> Result<Scene, SceneError> {
        let overrides = resolve_overrides(&self.objects, &options.mesh_overrides)?;
        let mut builder = Builder {
            unit: self.unit,
            grouping: self.grouping,
            objects: Vec::new(),
            images: load_images(&self.images, warnings)?,
            lights: self.lights,
            materials: self.materials,
            default_material: None,
            models: HashMap::new(),
            groups: HashMap::new(),
            triangles: 0,
            warnings,
        };
        for (chunk, entries) in self.objects.chunks(SHAPES_AT_ONCE).enumerate() {
            let shapes: Vec<_> = entries.par_iter().map(ReadyMesh::of_shape).collect();
            for (number, (entry, shape)) in entries.iter().zip(shapes).enumerate() {
                let index = chunk * SHAPES_AT_ONCE + number;
                match shape {
                    Some(shape) => builder.add_shape(index, entry, shape?)?,
                    None => builder.add_entry_of_file(index, entry, overrides.get(&index))?,
                }
            }
        }
        let frame = Stage::of(&builder.objects);
        let film = options.film(self.film);
        let aspect = f64::from(film.width) / f64::from(film.height);
        let camera = self.camera.unwrap_or_else(|| frame.camera(&builder.objects, aspect));
        let mut environment = self.environment;
        if builder.is_dark() && environment.is_none() {
            builder.lights = frame.lights();
            environment = Some(frame.environment());
        }
        let scene = Scene {
            unit: self.unit,
            camera,
            film,
            integrator: self.integrator,
            objects: builder.objects,
            materials: builder.materials,
            images: builder.images,
            profile_tables: load_profile_tables(&self.profile_tables)?,
            lights: builder.lights,
            environment,
        };
        // Files that the scene names, and what follows from them, may go beyond what the text was checked for.
        scene.validate().map_err(|error| error.or_at(&self.path))?;
        Ok(scene)
    }
}

fn read_text(path: &Path) -> Result<String, SceneError> {
    let length = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    if length > LARGEST_FILE {
        let message = format!("the scene file has {length} bytes, but at most {LARGEST_FILE} are allowed");
        return Err(SceneError::at(Place::file(path), message));
    }
    let bytes = read_file(path)?;
    String::from_utf8(bytes).map_err(|error| {
        let place = Place::part(path, format!("byte {}", error.utf8_error().valid_up_to()));
        SceneError::at(place, "a scene file must be UTF-8 text, but this is not")
    })
}

/// The mesh path of each object that has an override.
fn resolve_overrides<'a>(
    objects: &[ObjectEntry],
    overrides: &'a [(Option<String>, PathBuf)],
) -> Result<HashMap<usize, &'a PathBuf>, SceneError> {
    let is_file = |object: &ObjectEntry| matches!(object.geometry, GeometryOrigin::File { .. });
    let files: Vec<usize> = (0..objects.len()).filter(|&i| is_file(&objects[i])).collect();
    let names = || files.iter().map(|&i| objects[i].name.as_str());
    let list = || names().collect::<Vec<_>>().join(", ");
    let mut resolved = HashMap::new();
    for (name, path) in overrides {
        let index = match name {
            Some(name) => files.iter().copied().find(|&i| objects[i].name == *name).ok_or_else(|| {
                let error = SceneError::new(format!("there is no object \"{name}\" with a mesh file"));
                match nearest(name, names()) {
                    Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
                    None => error.with_help(format!("the objects with a mesh file are {}", list())),
                }
            })?,
            None => match files[..] {
                [only] => only,
                [] => return Err(SceneError::new("the scene has no object with a mesh file to replace")),
                _ => {
                    let message = format!("the scene has {} objects with a mesh file", files.len());
                    let help = format!("say which one to replace as NAME=PATH; they are {}", list());
                    return Err(SceneError::new(message).with_help(help));
                }
            },
        };
        resolved.insert(index, path);
    }
    Ok(resolved)
}

fn load_images(requests: &[ImageRequest], warnings: &mut Vec<Warning>) -> Result<Vec<Image>, SceneError> {
    let load = |request: &ImageRequest| {
        check_present(&request.path, &request.place)?;
        load_image(&request.path, request.color_space, warnings)
    };
    requests.iter().map(load).collect()
}

fn load_profile_tables(requests: &[TableRequest]) -> Result<Vec<ProfileTable>, SceneError> {
    let load = |request: &TableRequest| {
        check_present(&request.path, &request.place)?;
        load_profile_table(&request.path)
    };
    requests.iter().map(load).collect()
}

/// A missing file is the scene file's mistake, so the message points there.
fn check_present(path: &Path, place: &Place) -> Result<(), SceneError> {
    if path.is_file() {
        return Ok(());
    }
    let found = if path.is_dir() { "is a folder, not a file" } else { "does not exist" };
    Err(SceneError::at(place.clone(), format!("the file {} {found}", path.display())))
}

/// Objects that may exchange light under the surface.
#[derive(PartialEq, Eq, Hash)]
enum Group {
    Named(String),
    /// Index of the material.
    Material(usize),
    /// Entry of the scene file and group within the mesh file.
    Own(usize, u32),
}

/// A mesh in its place in the scene, checked and valid.
struct ReadyMesh {
    mesh: Mesh,
    /// Triangles before the repair.
    triangles: usize,
    warnings: Vec<Warning>,
}

impl ReadyMesh {
    /// The shape of an entry; none if that has a file.
    fn of_shape(entry: &ObjectEntry) -> Option<Result<Self, SceneError>> {
        let GeometryOrigin::Shape { name, parameters } = &entry.geometry else { return None };
        let at_place = |error: SceneError| SceneError { place: Some(entry.place.clone()), ..error };
        Some(build_shape(name, parameters).map_err(at_place).and_then(|mesh| Self::new(entry, mesh)))
    }

    fn new(entry: &ObjectEntry, mesh: Mesh) -> Result<Self, SceneError> {
        let triangles = mesh.triangles.len();
        let mut mesh = mesh.transformed(&entry.world_from_object);
        check_bounds(&mesh, &entry.place)?;
        let mut warnings = Vec::new();
        repair_mesh(&mut mesh, &entry.place, &mut warnings)?;
        Ok(Self { mesh, triangles, warnings })
    }
}

/// A mesh file and the index that its first material has in the scene, once it is there.
struct LoadedMeshFile {
    model: MeshFile,
    first_material: Option<usize>,
}

struct Builder<'a> {
    unit: Unit,
    grouping: Grouping,
    objects: Vec<Object>,
    materials: Vec<Material>,
    default_material: Option<usize>,
    images: Vec<Image>,
    lights: Vec<Light>,
    models: HashMap<(PathBuf, &'static str), LoadedMeshFile>,
    groups: HashMap<Group, u32>,
    triangles: usize,
    warnings: &'a mut Vec<Warning>,
}

impl Builder<'_> {
    fn add_shape(&mut self, index: usize, entry: &ObjectEntry, shape: ReadyMesh) -> Result<(), SceneError> {
        let material = entry.material.unwrap_or_else(|| self.default_material());
        self.add_mesh(index, entry, shape, (entry.name.clone(), material, 0))
    }

    fn add_entry_of_file(
        &mut self,
        index: usize,
        entry: &ObjectEntry,
        replacement: Option<&&PathBuf>,
    ) -> Result<(), SceneError> {
        let GeometryOrigin::File { path, unit } = &entry.geometry else { return Ok(()) };
        let path = replacement.map_or(path, |path| *path);
        check_present(path, &entry.place).map_err(|error| error.with_help(override_help(&entry.name)))?;
        self.add_file(index, entry, path, *unit)
    }

    fn add_file(
        &mut self,
        index: usize,
        entry: &ObjectEntry,
        path: &Path,
        unit: Option<Unit>,
    ) -> Result<(), SceneError> {
        let unit = unit.unwrap_or(if is_gltf(path) { Unit::Meter } else { self.unit });
        let key = (path.to_owned(), unit.name());
        // Taken out while its parts are added, and put back for the next object with the same file.
        let mut loaded = match self.models.remove(&key) {
            Some(loaded) => loaded,
            None => LoadedMeshFile { model: self.load(path, unit)?, first_material: None },
        };
        let first_material = self.first_material(entry, &mut loaded);
        for part in &loaded.model.objects {
            let material = entry.material.unwrap_or_else(|| match first_material {
                Some(first) => first + part.material,
                None => self.default_material(),
            });
            let name = if loaded.model.objects.len() == 1 {
                entry.name.clone()
            } else {
                format!("{}/{}", entry.name, part.name)
            };
            let mesh = ReadyMesh::new(entry, part.mesh.clone())?;
            self.add_mesh(index, entry, mesh, (name, material, part.subsurface_group))?;
        }
        for light in &loaded.model.lights {
            self.lights.extend(transformed_light(light, entry));
        }
        self.models.insert(key, loaded);
        Ok(())
    }

    fn load(&mut self, path: &Path, unit: Unit) -> Result<MeshFile, SceneError> {
        let mut model = load_model(path, self.warnings)?;
        scale_lengths(&mut model, (unit.in_millimeters() / self.unit.in_millimeters()) as f32);
        Ok(model)
    }

    /// Brings the file's own materials and images into the scene when they are first used.
    fn first_material(&mut self, entry: &ObjectEntry, loaded: &mut LoadedMeshFile) -> Option<usize> {
        if entry.material.is_none() && !loaded.model.materials.is_empty() && loaded.first_material.is_none() {
            loaded.first_material = Some(self.materials.len());
            let shift = self.images.len();
            self.images.append(&mut loaded.model.images);
            self.materials.extend(loaded.model.materials.iter().map(|material| {
                let mut material = material.clone();
                material.for_each_texture(|texture| texture.image += shift);
                material
            }));
        }
        loaded.first_material
    }

    fn add_mesh(
        &mut self,
        index: usize,
        entry: &ObjectEntry,
        ReadyMesh { mesh, triangles, mut warnings }: ReadyMesh,
        (name, material, model_group): (String, usize, u32),
    ) -> Result<(), SceneError> {
        self.triangles += triangles;
        if self.triangles > MOST_TRIANGLES {
            let message = format!("the scene has more than {MOST_TRIANGLES} triangles up to here");
            return Err(SceneError::at(entry.place.clone(), message));
        }
        self.warnings.append(&mut warnings);
        let group = match &entry.subsurface_group {
            Some(name) => Group::Named(name.clone()),
            None if self.grouping == Grouping::Material => Group::Material(material),
            None => Group::Own(index, model_group),
        };
        let next = self.groups.len() as u32;
        let subsurface_group = *self.groups.entry(group).or_insert(next);
        self.objects.push(Object { name, mesh, material, subsurface_group });
        Ok(())
    }

    /// The material of objects that have none.
    fn default_material(&mut self) -> usize {
        *self.default_material.get_or_insert_with(|| {
            self.materials.push(Material::default());
            self.materials.len() - 1
        })
    }

    /// Whether neither a light nor a surface in use emits.
    fn is_dark(&self) -> bool {
        let emits = |object: &Object| self.materials[object.material].emission_luminance > 0.0;
        self.lights.is_empty() && !self.objects.iter().any(emits)
    }
}

/// A mesh out of bounds is refused here; the repair would cut it off.
fn check_bounds(mesh: &Mesh, place: &Place) -> Result<(), SceneError> {
    let (low, high) = mesh.bounds();
    let reach = low.abs().max(high.abs()).max_element();
    if Interval::COORDINATE.contains(f64::from(reach)) {
        return Ok(());
    }
    let range = Interval::COORDINATE;
    let message = format!("the object reaches to {reach:e} in x, y or z, but coordinates must be in {range}");
    Err(SceneError::at(place.clone(), message))
}

fn override_help(name: &str) -> String {
    format!("put the mesh there, or give its path with --mesh {name}=PATH")
}

/// A mesh file's light moved with its object; its intensity grows with the square of the scale, so that
/// what it lights stays as bright.
fn transformed_light(light: &Light, entry: &ObjectEntry) -> Option<Light> {
    let map = &entry.world_from_object;
    let direct = |direction| map.transform_vector3(direction).try_normalize();
    match *light {
        Light::Spot { position, direction, intensity, inner_angle, outer_angle } => Some(Light::Spot {
            position: map.transform_point3(position),
            direction: direct(direction)?,
            intensity: intensity * map.matrix3.determinant().abs().powf(2.0 / 3.0),
            inner_angle,
            outer_angle,
        }),
        Light::Distant { direction, angular_radius, irradiance } => {
            Some(Light::Distant { direction: direct(direction)?, angular_radius, irradiance })
        }
        // Mesh files have no others.
        Light::Rectangle { .. } | Light::Sphere { .. } | Light::Beam { .. } => None,
    }
}
