//! Scenes in code: each thing by the keys of a scene file's table.

use std::collections::HashMap;
use std::collections::hash_map::Entry as MapEntry;
use std::hash::Hash;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Affine3A, DVec3};
use translucid_scene::description::{Content, Entry, FileRequest, Provenance, Table, Value};
use translucid_scene::{
    Camera, Environment, Film, Image, ImageKind, Integrator, Light, Material, Mesh, Pixels, Place, Scene,
    SceneError, SubsurfaceModel, Unit, Warning,
};

use super::build::{SceneBuilder, check_present, staged};
use super::files::NamedFiles;
use super::object::{GeometryOrigin, ObjectEntry};
use super::parse::parse;
use super::{Grouping, material, name_objects, object};
use crate::appearance::warn_of_panorama;
use crate::image::read_image;
use crate::loading::Loading;
use crate::options::LoadOptions;
use crate::profile_table::read_profile_table;
use crate::result::Result;

/// A thing of a scene: its keys and values, as they would stand in its table in a scene file.
///
/// Paths are relative to the current directory; an image at hand may stand in the place of one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    /// Its name in messages: "material skin".
    pub title: String,
    /// Its keys and values.
    pub entries: Vec<Entry>,
    /// [Origin](Scene::origin) of the scene that cameras and lights are read for; things that are added to a scene go by that
    /// scene's own.
    pub origin: DVec3,
}

impl Piece {
    /// A thing of these keys and values.
    pub fn new(title: &str, entries: Vec<Entry>) -> Self {
        Self { title: title.to_owned(), entries, origin: DVec3::ZERO }
    }

    /// A thing of lines `key = value` of a scene file.
    ///
    /// # Errors
    /// The lines are not TOML.
    pub fn parse(title: &str, lines: &str) -> Result<Self> {
        match parse(&Provenance::file(Path::new(""), lines)) {
            Ok(entries) => Ok(Self::new(title, entries)),
            Err(error) => Err(SceneError::at(Place::part(Path::new(""), title), error.message)),
        }
    }

    /// Whether images at hand are among the values.
    pub fn has_images(&self) -> bool {
        fn is_in(value: &Value) -> bool {
            match &value.content {
                Content::Object(_) => true,
                Content::List(values) => values.iter().any(is_in),
                Content::Table(entries) => entries.iter().any(|entry| is_in(&entry.value)),
                _ => false,
            }
        }
        self.entries.iter().any(|entry| is_in(&entry.value))
    }

    /// The thing in a scene of this origin.
    #[must_use]
    pub fn in_scene_at(self, origin: DVec3) -> Self {
        Self { origin, ..self }
    }

    fn place(&self) -> Place {
        Place::part(Path::new(""), &self.title)
    }

    /// The value that `read` makes of the table.
    fn read<T>(&self, read: impl FnOnce(Table<'_>) -> Result<T>) -> Result<T> {
        self.read_at(self.origin, read)
    }

    /// As `read`, in a scene of this origin.
    fn read_at<T>(&self, origin: DVec3, read: impl FnOnce(Table<'_>) -> Result<T>) -> Result<T> {
        read(Table::root(&Provenance::part(&self.title).in_scene_at(origin.to_array()), &self.entries))
    }

    /// The camera of `[camera]`.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value out of its range.
    pub fn camera(&self) -> Result<Camera> {
        self.read(|table| Camera::DESCRIPTION.of_table(table))
    }

    /// The light of a `[[light]]`.
    ///
    /// # Errors
    /// A key is unknown or missing, or a value out of its range.
    pub fn light(&self) -> Result<Light> {
        self.read(Light::read)
    }

    /// Another place and another material of an object of a scene, by those keys of an `[[object]]`; none where no key
    /// says one.
    ///
    /// # Errors
    /// A key is unknown, or a value not allowed.
    pub fn object_change(&self, scene: &Scene) -> Result<(Option<Affine3A>, Option<usize>)> {
        self.read_at(scene.origin, |table| {
            object::read_change(&table.allow(&object::change_keys())?, &scene.materials)
        })
    }

    /// A film with the changes of a `[film]`.
    ///
    /// # Errors
    /// A key is unknown, or a value out of its range.
    pub fn film(&self, film: Film) -> Result<Film> {
        self.read(|table| Film::DESCRIPTION.changed_by(film, table))
    }

    /// An integrator with the changes of an `[integrator]`.
    ///
    /// # Errors
    /// A key is unknown, or a value out of its range.
    pub fn integrator(&self, integrator: Integrator) -> Result<Integrator> {
        self.read(|table| Integrator::DESCRIPTION.changed_by(integrator, table))
    }

    /// A material of a scene with the changes of a `[[material]]`, which bring no files.
    ///
    /// # Errors
    /// A key is unknown, a value out of its range, or a file is named.
    pub fn material(&self, material: &Material, unit: Unit) -> Result<Material> {
        let mut files = NamedFiles::default();
        let changed = self.changed_material(material, unit, &mut files)?;
        refuse_images(&files)?;
        Ok(changed)
    }

    /// A material of a scene with the changes of a `[[material]]`, and the images that they bring: their numbers go on
    /// from those of the scene's images.
    ///
    /// # Errors
    /// A key is unknown, a value out of its range, an image cannot be used, or a table of profiles is named.
    pub fn material_with_images(
        &self,
        scene: &Scene,
        material: &Material,
        warnings: &mut Vec<Warning>,
    ) -> Result<(Material, Vec<Arc<Image>>)> {
        let mut files = NamedFiles::after(scene).opening();
        let changed = self.changed_material(material, scene.unit, &mut files);
        let mut loading = Loading::unwatched(warnings);
        files.take_findings(&mut loading);
        let changed = changed?;
        Ok((changed, self.all_images(&files, &mut loading)?))
    }

    fn changed_material(&self, material: &Material, unit: Unit, files: &mut NamedFiles) -> Result<Material> {
        let changed = self.read(|table| {
            let table = table.allow(&Material::keys())?;
            material::read_material(&table, material.clone(), unit, files)
        })?;
        match files.list.tables.first() {
            Some(table) => {
                Err(SceneError::at(table.place.clone(), "this scene takes no further tables of profiles")
                    .with_help("make a scene that has it"))
            }
            None => Ok(Material { name: material.name.clone(), ..changed }),
        }
    }

    /// The environment of an `[environment]` without a file.
    ///
    /// # Errors
    /// A key is unknown or missing, a value out of its range, or a file is named.
    pub fn environment(&self) -> Result<Environment> {
        let mut files = NamedFiles::default();
        let environment = self.read_environment(&mut files)?;
        refuse_images(&files)?;
        Ok(environment)
    }

    /// The environment of an `[environment]`, and the image that it brings: its number goes on from those of the scene's
    /// images.
    ///
    /// # Errors
    /// A key is unknown or missing, a value out of its range, or an image cannot be used.
    pub fn environment_with_images(
        &self,
        scene: &Scene,
        warnings: &mut Vec<Warning>,
    ) -> Result<(Environment, Vec<Arc<Image>>)> {
        let mut files = NamedFiles::after(scene);
        let environment = self.read_environment(&mut files)?;
        let images = self.all_images(&files, &mut Loading::unwatched(warnings))?;
        images.iter().for_each(|image| warn_of_panorama(image, warnings));
        Ok((environment, images))
    }

    fn read_environment(&self, files: &mut NamedFiles) -> Result<Environment> {
        self.read(|table| Environment::read(table, None, &mut files.list))
    }

    fn all_images(&self, files: &NamedFiles, loading: &mut Loading<'_>) -> Result<Vec<Arc<Image>>> {
        files.list.images.iter().map(|request| load_or_take(request, loading)).collect()
    }
}

fn refuse_images(files: &NamedFiles) -> Result<()> {
    match files.list.images.first() {
        Some(image) => Err(SceneError::at(image.place.clone(), "this scene takes no further images")
            .with_help("make a scene that has it")),
        None => Ok(()),
    }
}

/// The image at hand or in a file.
fn load_or_take(request: &FileRequest<ImageKind>, loading: &mut Loading<'_>) -> Result<Arc<Image>> {
    // Floating-point values are linear in any case
    let color_space = request.kind.color_space();
    let is_as_asked =
        |image: &Image| image.color_space == color_space || matches!(image.pixels, Pixels::Float(_));
    match &request.image {
        Some(image) if is_as_asked(image) => Ok(Arc::clone(image)),
        Some(image) => Ok(Arc::new(Image { color_space, ..Image::clone(image) })),
        None => {
            check_present(&request.path, &request.place)?;
            read_image(&request.path, request.kind, loading).map(Arc::new)
        }
    }
}

/// The index of each file among all that a scene has, which those that are not known join.
fn numbered<K: Copy + Eq + Hash, T>(
    requests: &[FileRequest<K>],
    known: &mut HashMap<(PathBuf, K), usize>,
    all: &mut Vec<T>,
    mut load: impl FnMut(&FileRequest<K>) -> Result<T>,
) -> Result<Vec<usize>> {
    let number = |request: &FileRequest<K>| match known.entry((request.path.clone(), request.kind)) {
        MapEntry::Occupied(known) => Ok(*known.get()),
        MapEntry::Vacant(new) => {
            all.push(load(request)?);
            Ok(*new.insert(all.len() - 1))
        }
    };
    requests.iter().map(number).collect()
}

impl SceneBuilder {
    /// A scene in a unit of length without anything in it.
    pub fn new(unit: Unit) -> Self {
        Self::at(unit, DVec3::ZERO)
    }

    /// A scene without anything in it, whose [origin](Scene::origin) is near what will be seen.
    pub fn at(unit: Unit, origin: DVec3) -> Self {
        Self::of(Scene { unit, origin, ..Scene::default() })
    }

    /// The scene so far, without the things that are chosen at the end.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Sets which objects share light under the surface where they name no group: "object" or "material".
    ///
    /// # Errors
    /// It is another word.
    pub fn set_subsurface_grouping(&mut self, piece: &Piece) -> Result<()> {
        self.grouping = piece.read(|table| {
            let table = table.allow(&["subsurface_grouping"])?;
            table.require("subsurface_grouping")?.word::<Grouping>()
        })?;
        Ok(())
    }

    /// Adds the material of a `[[material]]`, with the key `name`.
    ///
    /// # Errors
    /// A key is unknown or missing, a value out of its range, the name taken, or a file cannot be used.
    pub fn add_material(&mut self, piece: &Piece, warnings: &mut Vec<Warning>) -> Result<()> {
        let mut files = NamedFiles::default().opening();
        let unit = self.scene.unit;
        let new = piece.read(|table| {
            let table = table.allow(&Material::keys())?;
            table.require("name")?;
            material::read_material(&table, Material::default(), unit, &mut files)
        });
        let mut loading = Loading::unwatched(warnings);
        files.take_findings(&mut loading);
        let mut new = new?;
        Self::require_new_name(piece, &new.name, self.scene.materials.iter().map(|other| &other.name))?;
        let (images, tables) = self.add_files(&files, &mut loading)?;
        self.scene.files.append(&mut loading.into_files());
        new.for_each_image(|image| *image = images[*image]);
        if let SubsurfaceModel::Tabulated(table) = &mut new.subsurface_model {
            *table = tables[*table];
        }
        self.scene.materials.push(new);
        Ok(())
    }

    /// Adds the object of an `[[object]]`, with one of the keys `file` and `shape`.
    ///
    /// # Errors
    /// A key is unknown or missing, a value out of its range, the name taken, or a file cannot be used.
    pub fn add_object(&mut self, piece: &Piece, warnings: &mut Vec<Warning>) -> Result<()> {
        let materials = &self.scene.materials;
        let origin = self.scene.origin;
        let entry = piece.read_at(origin, |table| Ok(object::read_object(table, Some(materials))?.0))?;
        let entry = self.named(piece, entry)?;
        match entry.geometry {
            GeometryOrigin::Shape { .. } => self.add_shape(&entry, warnings),
            _ => {
                let mut loading = Loading::unwatched(warnings);
                self.add_file(&entry, None, &mut loading)?;
                self.scene.files.append(&mut loading.into_files());
                Ok(())
            }
        }
    }

    /// Adds an object with a mesh that is at hand, by the keys of an `[[object]]` but for those of its geometry.
    ///
    /// The mesh is repaired as those of files are, see [`repair_mesh`](translucid_scene::repair_mesh).
    ///
    /// # Errors
    /// A key is unknown, a value out of its range, the name taken, or nothing is left of the mesh.
    pub fn add_mesh_object(&mut self, piece: &Piece, mesh: Mesh, warnings: &mut Vec<Warning>) -> Result<()> {
        let materials = &self.scene.materials;
        let read = |table: Table<'_>| object::read_mesh_object(table, piece.place(), materials);
        let entry = piece.read_at(self.scene.origin, read)?;
        let entry = self.named(piece, entry)?;
        self.add_given(&entry, mesh, warnings)
    }

    /// An object with a name that no other has.
    fn named(&self, piece: &Piece, entry: ObjectEntry) -> Result<ObjectEntry> {
        let names = || self.scene.objects.iter().map(|object| &object.name);
        if !entry.name.is_empty() {
            Self::require_new_name(piece, &entry.name, names())?;
            return Ok(entry);
        }
        let mut entries = [entry];
        name_objects(&mut entries, names().cloned().collect());
        let [entry] = entries;
        Ok(entry)
    }

    fn require_new_name<'a>(
        piece: &Piece,
        name: &str,
        mut names: impl Iterator<Item = &'a String>,
    ) -> Result<()> {
        if names.all(|other| other != name) {
            return Ok(());
        }
        let message = format!("name is {name:?}, but must be a name that no other has");
        Err(SceneError::at(piece.place(), message))
    }

    /// Adds the light of a `[[light]]`.
    ///
    /// # Errors
    /// As [`Piece::light`].
    pub fn add_light(&mut self, piece: &Piece) -> Result<()> {
        self.scene.lights.push(piece.read_at(self.scene.origin, Light::read)?);
        Ok(())
    }

    /// Sets the environment, of an `[environment]`.
    ///
    /// # Errors
    /// As [`Piece::environment_with_images`], or a file cannot be used.
    pub fn set_environment(&mut self, piece: &Piece, warnings: &mut Vec<Warning>) -> Result<()> {
        let mut files = NamedFiles::default();
        let mut environment = piece.read_environment(&mut files)?;
        let mut loading = Loading::unwatched(warnings);
        let (images, _) = self.add_files(&files, &mut loading)?;
        self.scene.files.append(&mut loading.into_files());
        environment.image = environment.image.map(|image| images[image]);
        if let Some(image) = environment.image {
            warn_of_panorama(&self.scene.images[image], warnings);
        }
        self.scene.environment = Some(environment);
        Ok(())
    }

    /// Sets the camera, of a `[camera]`.
    ///
    /// # Errors
    /// As [`Piece::camera`].
    pub fn set_camera(&mut self, piece: &Piece) -> Result<()> {
        let read = |table: Table<'_>| Camera::DESCRIPTION.of_table(table);
        self.camera = Some(piece.read_at(self.scene.origin, read)?);
        Ok(())
    }

    /// Changes the film, by a `[film]`.
    ///
    /// # Errors
    /// As [`Piece::film`].
    pub fn set_film(&mut self, piece: &Piece) -> Result<()> {
        self.scene.film = piece.film(self.scene.film)?;
        Ok(())
    }

    /// Changes the integrator, by an `[integrator]`.
    ///
    /// # Errors
    /// As [`Piece::integrator`].
    pub fn set_integrator(&mut self, piece: &Piece) -> Result<()> {
        self.scene.integrator = piece.integrator(self.scene.integrator)?;
        Ok(())
    }

    /// Brings the files of a thing into the scene; the index that each of them has there.
    fn add_files(
        &mut self,
        files: &NamedFiles,
        loading: &mut Loading<'_>,
    ) -> Result<(Vec<usize>, Vec<usize>)> {
        let Self { scene, files: known, .. } = self;
        let images = numbered(&files.list.images, &mut known.images, &mut scene.images, |request| {
            load_or_take(request, loading)
        })?;
        let tables = numbered(&files.list.tables, &mut known.tables, &mut scene.profile_tables, |request| {
            check_present(&request.path, &request.place)?;
            read_profile_table(&request.path, loading)
        })?;
        Ok((images, tables))
    }

    /// The scene, with a camera that shows all of it and with light where it states none.
    ///
    /// Only the size and the model of the options count.
    ///
    /// # Errors
    /// There are no objects, or what was chosen is beyond what a scene may have.
    pub fn build(&self, options: &LoadOptions) -> Result<Scene> {
        if self.scene.objects.is_empty() {
            return Err(SceneError::new("the scene has no objects, but must have at least one"));
        }
        let scene = Scene { film: options.film(self.scene.film), ..self.scene.clone() };
        options.finish(staged(scene, self.camera, options))
    }
}

/// A scene to add to: its camera stays.
impl From<Scene> for SceneBuilder {
    fn from(scene: Scene) -> Self {
        let camera = Some(scene.camera);
        let mut builder = Self::of(scene);
        builder.camera = camera;
        builder
    }
}

#[cfg(test)]
mod tests {
    use translucid_scene::ColorSpace;

    use translucid_scene::description::image_value;

    use super::*;
    use crate::SceneFile;

    fn pieces(builder: &mut SceneBuilder) -> Result<()> {
        let mut warnings = Vec::new();
        builder.add_material(
            &Piece::parse(
                "material wax",
                "name = 'wax'\nsubsurface_weight = 1\nsubsurface_color = '#ff8800'\nsubsurface_scatter_anisotropy = 0.5",
            ).unwrap(),
            &mut warnings,
        )?;
        let ball =
            Piece::parse("object ball", "name = 'ball'\nshape = 'sphere'\nmaterial = 'wax'\nscale = 2")
                .unwrap();
        builder.add_object(&ball, &mut warnings)?;
        let box_ = Piece::parse("object box", "shape = 'box'\ntranslate = [4, 0, 0]").unwrap();
        builder.add_object(&box_, &mut warnings)?;
        builder.set_film(&Piece::parse("film", "size = [96, 64]\nexposure = 1").unwrap())?;
        builder.set_integrator(&Piece::parse("integrator", "seed = 7").unwrap())?;
        let light = "type = 'sphere'\ncenter = [0, 9, 0]\nradius = 1\nradiance = 3";
        builder.add_light(&Piece::parse("light", light).unwrap())
    }

    #[test]
    fn scene_of_pieces_is_that_of_the_file_with_the_same_keys() {
        let text = "unit = 'mm'\n[[material]]\nname = 'wax'\nsubsurface_weight = 1\nsubsurface_color = '#ff8800'\n\
            subsurface_scatter_anisotropy = 0.5\n[[object]]\nname = 'ball'\nshape = 'sphere'\nmaterial = 'wax'\n\
            scale = 2\n[[object]]\nshape = 'box'\ntranslate = [4, 0, 0]\n[film]\nsize = [96, 64]\nexposure = 1\n\
            [integrator]\nseed = 7\n[[light]]\ntype = 'sphere'\ncenter = [0, 9, 0]\nradius = 1\nradiance = 3\n";
        let file = SceneFile::parse(text, Path::new("a.toml")).unwrap();
        let of_file = file.load(&LoadOptions::default(), &mut Vec::new()).unwrap();
        let mut builder = SceneBuilder::new(Unit::Millimeter);
        pieces(&mut builder).unwrap();
        assert_eq!(format!("{:?}", builder.build(&LoadOptions::default()).unwrap()), format!("{of_file:?}"));
    }

    #[test]
    fn errors_name_the_thing_and_the_key() {
        let mut builder = SceneBuilder::new(Unit::Millimeter);
        pieces(&mut builder).unwrap();
        let mut refuse = |title: &str, text: &str| {
            let piece = Piece::parse(title, text).unwrap();
            let error = match title.split(' ').next() {
                Some("material") => builder.add_material(&piece, &mut Vec::new()),
                Some("object") => builder.add_object(&piece, &mut Vec::new()),
                Some("mesh") => builder.add_mesh_object(&piece, Mesh::default(), &mut Vec::new()),
                _ => builder.add_light(&piece),
            };
            error.unwrap_err().to_string()
        };
        for (title, text, message) in [
            (
                "material a",
                "name = 'a'\nbase_colr = 1",
                "material a: it has no key base_colr (did you mean base_color?",
            ),
            (
                "material a",
                "name = 'a'\nbase_color = nan",
                "material a: base_color is nan, but must be in [0, 1]",
            ),
            (
                "material wax",
                "name = 'wax'",
                "material wax: name is \"wax\", but must be a name that no other has",
            ),
            (
                "material a",
                "name = 'a'\nbase_color = {file = 'no.png'}",
                "material a: the file no.png does not exist",
            ),
            ("object a", "name = 'a'", "object a: it needs the key file or shape"),
            (
                "object a",
                "shape = 'cone'\nmaterial = 'vax'",
                "object a: material is \"vax\", but must be the name of a material",
            ),
            ("mesh a", "material = 'wax'", "mesh a: the mesh has no triangles"),
            ("light 1", "type = 'sun'", "light 1: type is \"sun\", but must be one of"),
        ] {
            let found = refuse(title, text);
            assert!(found.starts_with(message), "{found}\n{message}");
        }
        assert_eq!((builder.scene().materials.len(), builder.scene().objects.len()), (2, 2));
    }

    #[test]
    fn changes_that_are_taken_back_leave_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("a.obj");
        let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
        std::fs::write(&file, text).unwrap();
        std::fs::write(directory.path().join("a.mtl"), "newmtl a\nKd 1 0 0\n").unwrap();
        let piece = Piece::parse("object a", &format!("file = {file:?}")).unwrap();
        let mut builder = SceneBuilder::new(Unit::Millimeter);
        pieces(&mut builder).unwrap();
        let before = format!("{:?}", builder.scene());
        for is_kept in [false, true] {
            builder.all_or_nothing(|builder| {
                builder.add_object(&piece, &mut Vec::new()).unwrap();
                is_kept
            });
            assert_eq!(format!("{:?}", builder.scene()) != before, is_kept);
        }
        let scene = builder.scene();
        assert_eq!((scene.objects.len(), scene.materials.len()), (3, 3));
        assert_eq!(scene.objects[2].material, 2);
        builder.build(&LoadOptions::default()).unwrap();
    }

    #[test]
    fn images_at_hand_are_taken_by_their_name_and_color_space() {
        let pixels = Pixels::Byte(vec![[188, 0, 0, 255]]);
        let image = Image {
            name: "array 0".into(),
            path: None,
            width: 1,
            height: 1,
            color_space: ColorSpace::Srgb,
            pixels,
        };
        let texture = Value::from(vec![Entry::new("file", image_value(Arc::new(image)))]);
        let entries = vec![
            Entry::new("name", "a"),
            Entry::new("base_color", texture.clone()),
            Entry::new("specular_roughness", texture),
        ];
        let piece = Piece::new("material a", entries);
        let mut builder = SceneBuilder::new(Unit::Millimeter);
        builder.add_material(&piece, &mut Vec::new()).unwrap();
        let scene = builder.scene();
        let color = scene.materials[0].base_color.texture.unwrap().image;
        let (roughness, _) = scene.materials[0].specular_roughness.texture.unwrap();
        assert_eq!(scene.images[color].color_space, ColorSpace::Srgb);
        assert_eq!(scene.images[roughness.image].color_space, ColorSpace::Linear);
    }

    #[test]
    fn edited_material_keeps_what_is_not_named() {
        let mut builder = SceneBuilder::new(Unit::Millimeter);
        pieces(&mut builder).unwrap();
        let wax = builder.scene().materials[0].clone();
        let edit = Piece::parse("material wax", "subsurface_radius = 3\nsubsurface_eta = 1.3").unwrap();
        let edited = edit.material(&wax, Unit::Millimeter).unwrap();
        assert_eq!((edited.subsurface_radius.factor, edited.subsurface_color), (3.0, wax.subsurface_color));
        // The scene had decided on the model, and does so again; a model that is named stays.
        let model = |material: &Material| material.model(&Integrator::default()).name();
        assert_eq!([model(&wax), model(&edited)], ["random-walk", "random-walk-rough"]);
        let named = Piece::parse("material wax", "subsurface_model = 'random-walk'").unwrap();
        let named = named.material(&wax, Unit::Millimeter).unwrap();
        assert_eq!(model(&edit.material(&named, Unit::Millimeter).unwrap()), "random-walk");
        for (text, message, with_images) in [
            (
                "base_color = {file = 'a.png'}",
                "this scene takes no further images",
                "the file a.png does not exist",
            ),
            (
                "subsurface_table = 'a.csv'",
                "this scene takes no further tables of profiles",
                "this scene takes no further tables of profiles",
            ),
        ] {
            let file = Piece::parse("material wax", text).unwrap();
            let error = file.material(&wax, Unit::Millimeter).unwrap_err();
            assert!(error.to_string().starts_with(&format!("material wax: {message}")), "{error}");
            let error = file.material_with_images(builder.scene(), &wax, &mut Vec::new()).unwrap_err();
            assert!(error.to_string().starts_with(&format!("material wax: {with_images}")), "{error}");
        }
    }

    #[test]
    fn images_of_an_edit_are_numbered_behind_those_of_the_scene() {
        let image = |name: &str| {
            let pixels = Pixels::Float(vec![[0.25; 4]]);
            let color_space = ColorSpace::Linear;
            Arc::new(Image { name: name.into(), path: None, width: 1, height: 1, color_space, pixels })
        };
        let texture = |name: &str| vec![Entry::new("file", image_value(image(name)))];
        let mut builder = SceneBuilder::new(Unit::Millimeter);
        let entries = vec![Entry::new("name", "a"), Entry::new("specular_roughness", texture("first"))];
        let first = Piece::new("material a", entries);
        builder.add_material(&first, &mut Vec::new()).unwrap();
        let scene = builder.scene();
        let mut texture = texture("second");
        texture.push(Entry::new("color_space", "linear"));
        let second = Piece::new("material a", vec![Entry::new("base_color", texture)]);
        let (edited, images) =
            second.material_with_images(scene, &scene.materials[0], &mut Vec::new()).unwrap();
        assert_eq!(images, [image("second")]);
        assert_eq!(edited.base_color.texture.unwrap().image, 1);
        assert_eq!(edited.specular_roughness.texture.unwrap().0.image, 0);
        let sky = Piece::new("environment", vec![Entry::new("file", image_value(image("sky")))]);
        let (environment, images) = sky.environment_with_images(scene, &mut Vec::new()).unwrap();
        assert_eq!((environment.image, images), (Some(1), vec![image("sky")]));
    }
}
