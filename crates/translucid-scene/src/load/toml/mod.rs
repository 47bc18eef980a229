//! The scene file: TOML text to a description, then with its meshes and images to a scene.

mod build;
mod camera;
mod document;
mod input;
mod light;
mod material;
mod object;
mod piece;
mod settings;
#[cfg(test)]
mod tests;

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use document::{DocumentText, Item, Table};
use input::{FileList, FileRequest};
use object::{GeometryOrigin, ObjectEntry};

pub use build::SceneBuilder;
pub use piece::Piece;

use super::stem;
use crate::{Camera, ColorSpace, Material, Scene, SceneError, Unit};

/// Most bytes of a scene file; geometry and images are in files of their own.
pub(super) const LARGEST_FILE: u64 = 16 << 20;

/// Most entries of each list: objects, materials, lights.
const MOST_ENTRIES: usize = 65_536;

const KEYS: &[&str] = &[
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

/// Which objects share light under the surface where they name no group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Grouping {
    /// None: each is a body of its own.
    #[default]
    Object,
    /// All of the same material.
    Material,
}

const GROUPINGS: [(&str, Grouping); 2] = [("object", Grouping::Object), ("material", Grouping::Material)];

/// A scene file that has been read and checked, without the meshes and images that it names.
///
/// [`parse`](Self::parse) looks at nothing but the text; [`load`](Self::load) opens the files.
/// The format is described in `docs/guide/scene-files.md`.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The file that messages name.
    path: PathBuf,
    /// All but the camera and what is in files.
    scene: Scene,
    grouping: Grouping,
    camera: Option<Camera>,
    objects: Vec<ObjectEntry>,
    images: Vec<FileRequest<ColorSpace>>,
    profile_tables: Vec<FileRequest<()>>,
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
    /// use translucid_scene::SceneFile;
    ///
    /// let error = SceneFile::parse("unit = \"mm\"\n[film]\nexposur = 1.0\n", Path::new("ball.toml")).unwrap_err();
    /// assert_eq!(error.message, "film has no key exposur");
    /// assert_eq!(error.place.unwrap().line, Some(3));
    /// ```
    pub fn parse(text: &str, path: &Path) -> Result<Self, SceneError> {
        let source = DocumentText::new(path, text);
        let document = source.parse()?;
        let root = Table::root(&source, document.get_ref()).allow(KEYS)?;
        let unit = root.require("unit")?.word(&Unit::WORDS)?;
        let mut files = FileList::default();
        let materials = read_materials(&root, unit, &mut files)?;
        let environment = match open(&root, "environment", light::ENVIRONMENT_KEYS)? {
            Some(table) => Some(light::read_environment(&table, &mut files)?),
            None => None,
        };
        let camera = open(&root, "camera", camera::KEYS)?;
        let lights = root.tables("light", MOST_ENTRIES)?;
        let scene = Scene {
            unit,
            film: root.settings("film", settings::FILM)?,
            integrator: root.settings("integrator", settings::INTEGRATOR)?,
            materials,
            lights: lights.into_iter().map(light::read_light).collect::<Result<_, _>>()?,
            environment,
            ..Scene::default()
        };
        let objects = read_objects(&root, &scene.materials)?;
        Ok(Self {
            path: path.to_owned(),
            scene,
            grouping: root.read("subsurface_grouping", Grouping::Object, |item| item.word(&GROUPINGS))?,
            camera: camera.map(|table| camera::read_camera(&table)).transpose()?,
            objects,
            images: files.images,
            profile_tables: files.tables,
        })
    }
}

/// A table of the root, if it is there.
fn open<'a>(
    root: &Table<'a>,
    key: &'static str,
    keys: &[&'static str],
) -> Result<Option<Table<'a>>, SceneError> {
    root.get(key).map(|item| item.table()?.allow(keys)).transpose()
}

fn read_materials(root: &Table<'_>, unit: Unit, files: &mut FileList) -> Result<Vec<Material>, SceneError> {
    let (mut names, keys) = (HashSet::new(), material::keys());
    let mut materials = Vec::new();
    for table in root.tables("material", MOST_ENTRIES)? {
        let table = table.allow(&keys)?;
        table.require("name")?;
        let material = material::read_material(&table, Material::default(), unit, files)?;
        claim_name(&table, &material.name, &mut names)?;
        materials.push(material);
    }
    Ok(materials)
}

fn read_objects(root: &Table<'_>, materials: &[Material]) -> Result<Vec<ObjectEntry>, SceneError> {
    let tables = root.tables("object", MOST_ENTRIES)?;
    if tables.is_empty() {
        return Err(root
            .error("the scene has no [[object]]")
            .with_help("add one with the key file or shape"));
    }
    let mut names = HashSet::new();
    let mut objects = Vec::new();
    for table in tables {
        let (object, table) = object::read_object(table, materials)?;
        if !object.name.is_empty() {
            claim_name(&table, &object.name, &mut names)?;
        }
        objects.push(object);
    }
    name_objects(&mut objects, names);
    Ok(objects)
}

/// Refuses a name that another table of the list has.
fn claim_name(table: &Table<'_>, name: &str, names: &mut HashSet<String>) -> Result<(), SceneError> {
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
