//! Scene files that extend another scene or a mesh: they say only what is to be different.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use translucid_profile::nearest;
use translucid_scene::description::{Item, Table, read_size};
use translucid_scene::{Film, Place, Scene, SceneError, Warning, WholeInterval};

use super::SceneFile;
use super::base::Base;
use super::build::{check_present, check_present_or};
use super::mesh_base::MeshBase;
use super::object::read_material_name;
use crate::LoadOptions;
use crate::bare_mesh::load_bare_mesh;
use crate::file::{extension, stem};
use crate::loading::Loading;
use crate::model::{MESHES, is_mesh};
use crate::result::Result;

/// Keys of a scene file that extends another.
pub(super) const KEYS: &[&str] = &[
    "extends",
    "preset",
    "unit",
    "up",
    "rotate",
    "floor",
    "view",
    "camera",
    "film",
    "integrator",
    "material",
    "object",
    "light",
    "environment",
];

/// Keys of an `[[object]]` that changes one of the base.
const OBJECT_KEYS: &[&str] = &["name", "index", "material"];

/// The name of the built-in still life as a base.
const STILL_LIFE: &str = "still-life";

/// Most files of which each extends the next.
const LONGEST_CHAIN: usize = 16;

/// The base that a scene file extends.
#[derive(Clone, Debug)]
pub(super) struct Extends {
    origin: Origin,
    place: Place,
    /// The wishes for a mesh.
    mesh: MeshBase,
    /// Where the unit is stated.
    unit_place: Option<Place>,
    /// Size of the film, if the file states one: a camera that is chosen for the base fits it.
    size: Option<[u32; 2]>,
}

#[derive(Clone, Debug)]
enum Origin {
    StillLife,
    Scene(PathBuf),
    Mesh(PathBuf),
}

impl Origin {
    fn read(item: &Item<'_>) -> Result<Self> {
        if item.as_text() == Some(STILL_LIFE) {
            return Ok(Self::StillLife);
        }
        let path = item.file()?;
        if extension(&path) == "toml" {
            return Ok(Self::Scene(path));
        }
        if is_mesh(&path) {
            return Ok(Self::Mesh(path));
        }
        let files = format!("a scene (.toml) or mesh ({MESHES})");
        Err(item.refuse(&format!("\"{STILL_LIFE}\" or the path of {files}")))
    }
}

impl Extends {
    pub(super) fn read(root: &Table<'_>) -> Result<Self> {
        let item = root.require("extends")?;
        let origin = Origin::read(&item)?;
        let film = root.get("film").map(|item| item.table()).transpose()?;
        let size = film.and_then(|table| table.get("size"));
        Ok(Self {
            mesh: MeshBase::read(root, matches!(origin, Origin::Mesh(_)))?,
            unit_place: root.get("unit").map(|item| item.place()),
            size: size.map(|item| read_size(&item, Film::EDGE)).transpose()?,
            place: item.place(),
            origin,
        })
    }
}

/// Index of the thing of the base that a table changes, by its key `name` or `index`; none where the name is new.
pub(super) fn choose<'n>(
    table: &Table<'_>,
    names: impl Iterator<Item = &'n String>,
) -> Result<Option<usize>> {
    match (table.get("name"), table.get("index")) {
        (Some(_), Some(index)) => {
            Err(index.error(format!("{} has both name and index, but must have one", table.path())))
        }
        (None, None) => Err(table.error(format!("{} needs the key name or index", table.path()))),
        (None, Some(index)) => {
            let last = names.count().saturating_sub(1);
            index.integer(WholeInterval::new(0, last as u64)).map(|index| Some(index as usize))
        }
        (Some(item), None) => {
            let name = item.name()?;
            let same: Vec<usize> =
                names.enumerate().filter(|(_, other)| **other == name).map(|(i, _)| i).collect();
            match same[..] {
                [] => Ok(None),
                [one] => Ok(Some(one)),
                _ => {
                    let list = same.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
                    let error = item.refuse("a name that only one of the base has");
                    Err(error.with_help(format!("choose by the key index instead, one of {list}")))
                }
            }
        }
    }
}

/// Gives an object of the base another material; in a base that is not known only the keys are checked.
pub(super) fn change_object(table: Table<'_>, is_known: bool, scene: &mut Scene) -> Result<()> {
    let table = table.allow(OBJECT_KEYS).map_err(|error| {
        let help = "an object with the key file or shape is a new one and has further keys";
        SceneError { help: Some(error.help.map_or(help.to_owned(), |old| format!("{old}; {help}"))), ..error }
    })?;
    let material = table.require("material")?;
    if !is_known {
        return material.text().map(drop);
    }
    let names = || scene.objects.iter().map(|object| &object.name);
    let Some(index) = choose(&table, names())? else {
        let item = table.require("name")?;
        let error = item.refuse("the name of an object of the base");
        let near = nearest(item.text()?, names().map(String::as_str));
        return Err(match near {
            Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
            None => error.with_help("a new object needs the key file or shape"),
        });
    };
    scene.objects[index].material = read_material_name(&material, &scene.materials)?;
    Ok(())
}

/// Refuses a new object with the name of one of the base.
pub(super) fn refuse_known_name(table: &Table<'_>, base: &Scene) -> Result<()> {
    let item = table.require("name")?;
    let name = item.text()?;
    if base.objects.iter().all(|object| object.name != name) {
        return Ok(());
    }
    let error = item.refuse("a name that no other has");
    Err(error.with_help("without file and shape the table changes that object of the base"))
}

impl SceneFile {
    /// The built-in still life, part of the program.
    ///
    /// # Errors
    /// None: it is valid.
    pub(crate) fn still_life() -> Result<Self> {
        let text = include_str!("../../scenes/still-life.toml");
        Self::parse(text, Path::new("scenes/still-life.toml"))
    }

    /// Returns `true` if the file extends a mesh.
    pub(crate) fn is_on_mesh(&self) -> bool {
        self.extends.as_ref().is_some_and(|extends| matches!(extends.origin, Origin::Mesh(_)))
    }

    /// Opens the meshes and images, and what the file extends, and makes the scene.
    ///
    /// # Errors
    /// A file is missing or cannot be used; a change does not fit what it changes; an option does not fit the scene.
    pub fn load(self, options: &LoadOptions, warnings: &mut Vec<Warning>) -> Result<Scene> {
        let mut loading = Loading::new(&options.watch, warnings);
        let scene = Chain::of(self)?.load(options, &mut loading)?;
        Ok(Scene { files: loading.into_files(), ..scene })
    }
}

/// A scene file with all that it extends.
struct Chain {
    /// The mesh that the first file extends, if it does not stand by itself.
    mesh: Option<(PathBuf, Extends)>,
    /// From the base on.
    files: Vec<SceneFile>,
}

/// Mesh files in place of those that a chain names.
struct Replacements<'a> {
    mesh: Option<&'a Path>,
    /// For each file, by the number of the object.
    objects: Vec<HashMap<usize, &'a Path>>,
}

impl Chain {
    fn of(file: SceneFile) -> Result<Self> {
        let mut paths = vec![identity(file.source.path())];
        let mut files = vec![file];
        let mut mesh = None;
        while let Some(extends) = files.last().and_then(|file| file.extends.clone()) {
            let error = |message: String| Err(SceneError::at(extends.place.clone(), message));
            if files.len() == LONGEST_CHAIN {
                return error(format!("more than {LONGEST_CHAIN} scene files extend each other"));
            }
            match &extends.origin {
                Origin::StillLife => files.push(SceneFile::still_life()?),
                Origin::Scene(path) => {
                    check_present(path, &extends.place)?;
                    let path_of_all = identity(path);
                    if paths.contains(&path_of_all) {
                        return error(format!(
                            "the file {} extends itself, over others or at once",
                            path.display()
                        ));
                    }
                    paths.push(path_of_all);
                    files.push(SceneFile::read(path)?);
                }
                Origin::Mesh(path) => {
                    mesh = Some((path.clone(), extends));
                    break;
                }
            }
        }
        files.reverse();
        Ok(Self { mesh, files })
    }

    fn load(self, options: &LoadOptions, loading: &mut Loading<'_>) -> Result<Scene> {
        loading.add_files(self.files.iter().filter_map(|file| file.file.clone()));
        let Replacements { mesh, objects } = self.replacements(&options.mesh_overrides)?;
        let stated = self.files.iter().rev().find_map(|file| file.extends.as_ref()?.size);
        let of_base = LoadOptions {
            size: options.size.or(stated),
            watch: options.watch.clone(),
            ..LoadOptions::default()
        };
        let last = self.files.len() - 1;
        // The camera that is asked for is one of those that the last file to state any has
        let states = self.files.iter().rposition(|file| !file.cameras.is_empty());
        let states = if self.mesh.is_some() { states } else { states.or(Some(last)) };
        let camera_of = |number| options.camera.clone().filter(|_| states == number);
        let mut base = match &self.mesh {
            Some((path, extends)) => {
                let of_mesh = LoadOptions { camera: camera_of(None), ..of_base.clone() };
                Some(load_mesh(mesh.unwrap_or(path), extends, &of_mesh, loading)?)
            }
            None => None,
        };
        for (number, file) in self.files.into_iter().enumerate() {
            let of_file = if number == last { options } else { &of_base };
            let of_file = LoadOptions { camera: camera_of(Some(number)), ..of_file.clone() };
            base = Some(match base {
                Some(base) => extend(base, &file, &objects[number], &of_file, loading)?,
                None => file.with_documents(loading)?.assemble(&objects[number], &of_file, loading)?,
            });
        }
        let mut scene = base.ok_or_else(|| SceneError::new("there is no scene"))?;
        options.surroundings.apply(&mut scene, loading)?;
        Ok(scene)
    }

    /// The replacement of each mesh.
    fn replacements<'a>(&self, overrides: &'a [(Option<String>, PathBuf)]) -> Result<Replacements<'a>> {
        let mesh = self.mesh.iter().map(|(path, _)| (None, stem(path)));
        let files = self.files.iter().enumerate().flat_map(|(number, file)| {
            file.mesh_files().map(move |(object, name)| (Some((number, object)), name.to_owned()))
        });
        let (places, names): (Vec<_>, Vec<_>) = mesh.chain(files).unzip();
        let mut replacements = Replacements { mesh: None, objects: vec![HashMap::new(); self.files.len()] };
        for (name, path) in overrides {
            match places[find_name(&names, name.as_deref())?] {
                None => replacements.mesh = Some(path.as_path()),
                Some((number, object)) => drop(replacements.objects[number].insert(object, path.as_path())),
            }
        }
        Ok(replacements)
    }
}

/// Identity of a file, whatever path names it.
fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn load_mesh(
    path: &Path,
    extends: &Extends,
    options: &LoadOptions,
    loading: &mut Loading<'_>,
) -> Result<Scene> {
    let advice = String::from("put the mesh there, or give its path with --mesh PATH");
    check_present_or(path, &extends.place, Some(advice))?;
    load_bare_mesh(path, &extends.mesh.apply(options.clone()), loading).map(|(scene, _)| scene)
}

/// Changes a base by a file.
fn extend(
    base: Scene,
    file: &SceneFile,
    overrides: &HashMap<usize, &Path>,
    options: &LoadOptions,
    loading: &mut Loading<'_>,
) -> Result<Scene> {
    if let Some(Extends { mesh: MeshBase { unit: Some(unit), .. }, unit_place: Some(place), .. }) =
        &file.extends
        && *unit != base.unit
    {
        let message =
            format!("unit is \"{}\", but the scene that is extended is in {}", unit.name(), base.unit.name());
        return Err(SceneError::at(place.clone(), message).with_help("leave it out"));
    }
    let first_new = base.materials.len();
    let (source, entries) = (file.source.clone(), Arc::clone(&file.entries));
    let file = SceneFile::of(source, entries, Base::Known(Box::new(base)), Some(loading))?;
    let path = file.source.path().to_owned();
    let new: Vec<String> = file.scene.materials[first_new..].iter().map(|m| m.name.clone()).collect();
    let scene = file.assemble(overrides, options, loading)?;
    for (number, name) in new.iter().enumerate() {
        if !scene.objects.iter().any(|object| object.material == first_new + number) {
            let old = scene.materials[..first_new].iter().map(|material| material.name.as_str());
            let near = nearest(name, old).map_or(String::new(), |near| format!(": did you mean \"{near}\"?"));
            let message = format!("no object has the new material \"{name}\"{near}");
            loading.warnings.push(Warning { message, place: Some(Place::file(&path)) });
        }
    }
    Ok(scene)
}

/// Index of a name among those of the objects with a mesh file; without a name that of the only one.
fn find_name(names: &[String], name: Option<&str>) -> Result<usize> {
    let list = || names.join(", ");
    let Some(name) = name else {
        return match names.len() {
            1 => Ok(0),
            0 => Err(SceneError::new("the scene has no object with a mesh file to replace")),
            count => {
                let message = format!("the scene has {count} objects with a mesh file");
                let help = format!("say which one to replace as NAME=PATH; they are {}", list());
                Err(SceneError::new(message).with_help(help))
            }
        };
    };
    names.iter().position(|other| other == name).ok_or_else(|| {
        let error = SceneError::new(format!("there is no object \"{name}\" with a mesh file"));
        match nearest(name, names.iter().map(String::as_str)) {
            Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
            None if names.is_empty() => error.with_help("the scene has no object with a mesh file"),
            None => error.with_help(format!("the objects with a mesh file are {}", list())),
        }
    })
}
