//! The scene file: TOML text to a description, then with its meshes and images to a scene.

mod base;
mod build;
mod camera;
mod extend;
mod files;
mod material;
mod mesh_base;
mod object;
mod origin;
mod parse;
mod piece;
#[cfg(test)]
mod tests;
mod write;

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base::Base;
use extend::Extends;
use files::{Documents, NamedFiles};
use glam::DVec3;
use object::{GeometryOrigin, ObjectEntry};
use parse::parse;
use translucid_scene::description::{Entry, FileRequest, Item, Provenance, Table, Word};
use translucid_scene::{Camera, Environment, Film, ImageKind, Integrator, Light, Material, Scene};

pub use build::SceneBuilder;
pub use material::name_after_preset;
pub use mesh_base::MeshBase;
pub use piece::Piece;
pub use write::ExtendedBase;

use crate::NamedCamera;
use crate::file::stem;
use crate::loading::Loading;
use crate::result::Result;

/// Most bytes of a scene file; geometry and images are in files of their own.
pub(super) const LARGEST_FILE: u64 = 16 << 20;

/// Most entries of each list: objects, materials, lights.
const MOST_ENTRIES: usize = 65_536;

const KEYS: &[&str] = &[
    "extends",
    "unit",
    "subsurface_grouping",
    "camera",
    "film",
    "integrator",
    "material",
    "object",
    "light",
    "environment",
];

/// Grouping of objects that name no group: members share light under the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Grouping {
    /// None: each is a body of its own.
    #[default]
    Object,
    /// All of the same material.
    Material,
}

impl Word for Grouping {
    const WORDS: &'static [(&'static str, Self)] = &[("object", Self::Object), ("material", Self::Material)];
}

/// Reads any TOML file: its text, and its entries with their places.
///
/// # Errors
/// The file cannot be read, has more than 16 MiB, or is not TOML.
pub fn load_toml(path: &Path) -> Result<(Provenance, Vec<Entry>)> {
    let source = Provenance::file(path, &build::read_text(path)?);
    let entries = parse(&source)?;
    Ok((source, entries))
}

/// A scene file that has been read and checked, without the meshes and images that it names.
///
/// [`parse`](Self::parse) looks at nothing but the text; [`load`](Self::load) opens the files.
/// If a file extends another, `parse` checks what can be known without that one, and `load` checks the rest.
/// The format is described in `docs/guide/scene-files.md`.
#[derive(Clone, Debug)]
pub struct SceneFile {
    source: Provenance,
    entries: Arc<[Entry]>,
    /// The file that the text was read from, if it was.
    file: Option<PathBuf>,
    /// What the file extends, if anything.
    extends: Option<Extends>,
    /// All but the camera and what is in files; that of the base with the changes, where it is known.
    scene: Scene,
    grouping: Grouping,
    /// Cameras that the file states.
    cameras: Vec<NamedCamera>,
    /// The camera of the base where the file states none, as far as that is known.
    base_camera: Option<Camera>,
    objects: Vec<ObjectEntry>,
    images: Vec<FileRequest<ImageKind>>,
    profile_tables: Vec<FileRequest<()>>,
    /// Whether materials are in documents that have not been opened.
    has_documents: bool,
}

impl SceneFile {
    /// Reads and checks the text of a scene file.
    ///
    /// `path` is the file that messages name; paths in the text are relative to its folder.
    ///
    /// # Errors
    /// The text is not TOML, or has an unknown key, a value of the wrong type, out of its range, a missing
    /// key, or a name that is not there: the error points at the key or value.
    ///
    /// ```
    /// use std::path::{Path, PathBuf};
    /// use translucid_load::SceneFile;
    ///
    /// let error = SceneFile::parse("unit = \"mm\"\n[film]\nexposur = 1.0\n", Path::new("ball.toml")).unwrap_err();
    /// assert_eq!(error.message, "film has no key exposur");
    /// assert_eq!(error.place.unwrap().line, Some(3));
    /// ```
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let source = Provenance::file(path, text);
        let entries = parse(&source)?.into();
        Self::of(source, entries, Base::Unknown, None)
    }

    /// Reads a text; one that extends a scene changes the base, or is checked as far as it can be without.
    ///
    /// Documents of materials are opened where there is a place for what is found in them.
    fn of(
        source: Provenance,
        entries: Arc<[Entry]>,
        base: Base,
        loading: Option<&mut Loading<'_>>,
    ) -> Result<Self> {
        let root = Table::root(&source, &entries);
        let is_extending = root.get("extends").is_some();
        let origin = match &base {
            Base::Known(scene) => scene.origin,
            Base::Unknown if is_extending || root.origin() != [0.0; 3] => DVec3::from_array(root.origin()),
            Base::Unknown => origin::of_scene_file(&root),
        };
        let source = source.in_scene_at(origin.to_array());
        let root = Table::root(&source, &entries).allow(if is_extending { extend::KEYS } else { KEYS })?;
        let extends = if is_extending { Some(Extends::read(&root)?) } else { None };
        let (mut scene, is_known) = match base {
            Base::Known(scene) => (*scene, true),
            Base::Unknown if is_extending => (base::any_base(), false),
            Base::Unknown => {
                (Scene { unit: root.require("unit")?.word()?, origin, ..Scene::default() }, true)
            }
        };
        let mut files = NamedFiles::after(&scene);
        files.documents = if loading.is_some() { Documents::Opened(Vec::new()) } else { Documents::Later };
        if is_known {
            let read = read_materials(&root, is_extending, &mut scene, &mut files);
            loading.into_iter().for_each(|loading| files.take_findings(loading));
            read?;
        }
        let is_later = matches!(files.documents, Documents::Later);
        let has_documents = is_later && !files.named_documents.is_empty();
        scene.environment = read_environment(&root, is_extending, scene.environment, &mut files)?;
        let cameras = root.read("camera", Vec::new(), camera::read_cameras)?;
        if root.get("light").is_some() {
            let lights = root.tables("light", MOST_ENTRIES)?;
            scene.lights = lights.into_iter().map(Light::read).collect::<Result<_, _>>()?;
        }
        if let Some(item) = root.get("film") {
            scene.film = Film::DESCRIPTION.changed_by(scene.film, item.table()?)?;
        }
        if let Some(item) = root.get("integrator") {
            scene.integrator = Integrator::DESCRIPTION.changed_by(scene.integrator, item.table()?)?;
        }
        let objects = read_objects(&root, is_extending, is_known, &mut scene)?;
        let grouping = match is_extending {
            true => Grouping::Object,
            false => root.read("subsurface_grouping", Grouping::Object, Item::word)?,
        };
        let base_camera = is_extending.then_some(scene.camera);
        let (images, profile_tables) = (files.list.images, files.list.tables);
        Ok(Self {
            source,
            entries,
            file: None,
            extends,
            scene,
            grouping,
            cameras,
            base_camera,
            objects,
            images,
            profile_tables,
            has_documents,
        })
    }
}

impl SceneFile {
    /// The file with the materials of its documents.
    fn with_documents(self, loading: &mut Loading<'_>) -> Result<Self> {
        match self.has_documents {
            true => Self::of(self.source, self.entries, Base::Unknown, Some(loading)),
            false => Ok(self),
        }
    }

    /// The camera of a name, or the first, or that of the base; none if it is to be chosen.
    fn camera(&self, name: Option<&str>) -> Result<Option<Camera>> {
        let chosen =
            NamedCamera::choose(&self.cameras, name).map_err(|error| error.or_at(self.source.path()))?;
        Ok(chosen.map(|named| named.camera).or(self.base_camera))
    }
}

/// Adds materials, or changes those of the base.
fn read_materials(
    root: &Table<'_>,
    is_extending: bool,
    scene: &mut Scene,
    files: &mut NamedFiles,
) -> Result<()> {
    let mut keys = Material::keys();
    keys.extend(is_extending.then_some("index"));
    let base = scene.materials.len();
    let (mut names, mut changed) = (HashSet::new(), HashSet::new());
    for table in root.tables("material", MOST_ENTRIES)? {
        let table = table.allow(&keys)?;
        let chosen = if is_extending {
            extend::choose(&table, scene.materials[..base].iter().map(|material| &material.name))?
        } else {
            table.require("name")?;
            None
        };
        let Some(index) = chosen else {
            let material = material::read_material(&table, Material::default(), scene.unit, files)?;
            claim_name(&table, &material.name, &mut names)?;
            scene.materials.push(material);
            continue;
        };
        if !changed.insert(index) {
            return Err(table.error("another table of the list changes this material, too"));
        }
        let old = scene.materials[index].clone();
        let name = match table.get("preset") {
            None => old.name.clone(),
            Some(item) => {
                let others = scene.materials.iter().enumerate().filter(|(other, _)| *other != index);
                let others = others.map(|(_, material)| material.name.as_str());
                name_after_preset(&old, scene.unit, item.text()?, others).to_owned()
            }
        };
        let new = material::read_material(&table, old, scene.unit, files)?;
        scene.materials[index] = Material { name, ..new };
    }
    Ok(())
}

fn read_environment(
    root: &Table<'_>,
    is_extending: bool,
    base: Option<Environment>,
    files: &mut NamedFiles,
) -> Result<Option<Environment>> {
    match root.get("environment") {
        None => Ok(base),
        Some(item) if is_extending && item.is_none() => Ok(None),
        Some(item) => Environment::read(item.table()?, base, &mut files.list).map(Some),
    }
}

/// Reads new objects, and changes those of the base.
fn read_objects(
    root: &Table<'_>,
    is_extending: bool,
    is_known: bool,
    scene: &mut Scene,
) -> Result<Vec<ObjectEntry>> {
    let tables = root.tables("object", MOST_ENTRIES)?;
    if tables.is_empty() && !is_extending {
        return Err(root
            .error("the scene has no [[object]]")
            .with_help("add one with the key file or shape"));
    }
    let mut names = HashSet::new();
    let mut objects = Vec::new();
    for table in tables {
        if is_extending && table.get("file").is_none() && table.get("shape").is_none() {
            extend::change_object(table, is_known, scene)?;
            continue;
        }
        let materials = is_known.then_some(&*scene.materials);
        let (object, table) = object::read_object(table, materials)?;
        if !object.name.is_empty() {
            extend::refuse_known_name(&table, scene)?;
            claim_name(&table, &object.name, &mut names)?;
        }
        objects.push(object);
    }
    names.extend(scene.objects.iter().map(|object| object.name.clone()));
    name_objects(&mut objects, names);
    Ok(objects)
}

/// Refuses a name that another table of the list has.
fn claim_name(table: &Table<'_>, name: &str, names: &mut HashSet<String>) -> Result<()> {
    if names.insert(name.to_owned()) {
        return Ok(());
    }
    let taken = |item: &Item<'_>| item.refuse("a name that no other table of the list has");
    Err(table.get("name").as_ref().map_or_else(|| table.error("the name is taken"), taken))
}

/// Names the nameless after their file or shape, with a number where that is taken.
fn name_objects(objects: &mut [ObjectEntry], mut names: HashSet<String>) {
    for (i, object) in objects.iter_mut().enumerate().filter(|(_, object)| object.name.is_empty()) {
        let plain = match &object.geometry {
            GeometryOrigin::File { path, .. } => stem(path),
            GeometryOrigin::Shape { name, .. } => name.clone(),
            GeometryOrigin::Given => String::from("mesh"),
        };
        object.name = if names.contains(&plain) { format!("{plain} (object {})", i + 1) } else { plain };
        names.insert(object.name.clone());
    }
}
