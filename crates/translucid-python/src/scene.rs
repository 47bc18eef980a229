//! `Scene`: loaded from files, or made of arrays by the keys of scene files.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::{DVec3, Vec2, Vec3};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString, PyType};
use translucid_load::{Floor, LoadOptions, Piece, SceneBuilder, UpAxis, Viewpoint, load_scene};
use translucid_scene::{Film, Mesh, SceneError, SubsurfaceModel, Unit, Warning};

use crate::arrays::{Any, Numbers, Rule, is_aligned};
use crate::keys::Keys;
use crate::long_work;
use crate::names;
use crate::scene_error::{in_scene, scene_error, warn, wrong};

/// Most vertices of a mesh: those of the most triangles that a scene may have, without sharing any.
const MOST_VERTICES: usize = 3 << 28;

/// Most triangles of a mesh.
const MOST_TRIANGLES: usize = 1 << 28;

/// Largest coordinate of a vertex.
const LARGEST_COORDINATE: f64 = 1e9;

/// A scene while its parts are added.
struct Making {
    builder: SceneBuilder,
    /// Images that came as arrays.
    image_count: usize,
    light_count: usize,
}

/// Keys that were read, and the number of images that came as arrays with theirs.
struct Read {
    piece: Piece,
    image_count: usize,
}

/// A scene: objects with materials, lights, an environment, a camera.
///
/// It is loaded from a file by `load`, or put together here: every keyword is a key of scene files
/// (``docs/guide/scene-files.md``), with the same meaning, unit, range and default, and everything that
/// is not said is chosen as for scene files: a camera that shows all objects, and light where there is none.
/// Instead of the path of an image, an array of shape (H, W), (H, W, 3) or (H, W, 4) can be given: ``uint8`` codes,
/// or linear floating-point values.
///
/// Parameters
/// ----------
/// unit : {'mm', 'cm', 'm'}
///     Unit of all lengths.
/// camera, environment, film, integrator : dict, optional
///     As by `set_camera`, `set_environment`, `set_film`, `set_integrator`.
/// lights : list of dict, optional
///     Lights, each with the key ``type``.
/// origin : array_like, shape (3,), optional
///     A point near what the camera sees, for a scene far from zero: positions are counted from it, in double precision, before
///     they become single.
/// subsurface_grouping : {'object', 'material'}, optional
///     Which objects share light under their surfaces where they name no ``subsurface_group``.
///
/// Raises
/// ------
/// SceneError
///     A key is unknown, or a value not allowed; the message says where, and what is.
///
/// Notes
/// -----
/// Lengths are in `unit`, angles in degrees, colors linear Rec. 709 or ``'#rrggbb'``.
/// Materials have the names of OpenPBR Surface 1.1.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import translucid
/// >>> scene = translucid.Scene(unit="mm")
/// >>> scene.add_material("wax", subsurface_weight=1, subsurface_color=[0.9, 0.7, 0.4], subsurface_radius=1.5)
/// >>> vertices = np.array([[0, 9, 0], [6, 0, 0], [-3, 0, -5.2], [-3, 0, 5.2]])
/// >>> triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
/// >>> scene.add_mesh("pyramid", vertices, triangles, material="wax")
/// >>> scene
/// <translucid.Scene in mm: 1 object, 4 triangles, 1 material, 0 lights>
#[pyclass(frozen, module = "translucid", weakref)]
pub(crate) struct Scene {
    making: Arc<Mutex<Making>>,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (unit="mm", *, camera=None, environment=None, film=None, integrator=None, lights=None, origin=None, subsurface_grouping=None))]
    #[expect(clippy::too_many_arguments, reason = "the keywords of a scene file")]
    fn new(
        py: Python<'_>,
        unit: &str,
        camera: Option<&Bound<'_, PyDict>>,
        environment: Option<&Bound<'_, PyDict>>,
        film: Option<&Bound<'_, PyDict>>,
        integrator: Option<&Bound<'_, PyDict>>,
        lights: Option<&Any<'_>>,
        origin: Option<&Any<'_>>,
        subsurface_grouping: Option<&str>,
    ) -> PyResult<Self> {
        let unit = unit_of(unit)?;
        let origin = origin.map(origin_of).transpose()?.unwrap_or_default();
        let making = Making { builder: SceneBuilder::at(unit, origin), image_count: 0, light_count: 0 };
        let scene = Self::of(making);
        if let Some(grouping) = subsurface_grouping {
            let read = scene.read(py, "scene", Some(("subsurface_grouping", grouping)), None)?;
            scene.change(py, &read, |making, piece| making.builder.set_subsurface_grouping(piece))?;
        }
        if film.is_some() {
            scene.set_film(py, film)?;
        }
        if integrator.is_some() {
            scene.set_integrator(py, integrator)?;
        }
        if camera.is_some() {
            scene.set_camera(py, camera)?;
        }
        if environment.is_some() {
            scene.set_environment(py, environment)?;
        }
        for light in lights.map(|lights| lights.try_iter()).transpose()?.into_iter().flatten() {
            let light = light?;
            let keys = light.cast::<PyDict>().map_err(|_| {
                PyTypeError::new_err(format!("lights must be dictionaries, but one is {light}"))
            })?;
            scene.add_light(py, None, Some(keys))?;
        }
        Ok(scene)
    }

    /// Loads a scene file (``.toml``) or a mesh (``.glb``, ``.gltf``, ``.obj``, ``.ply``, ``.stl``).
    ///
    /// A mesh alone gets a material, a camera, lights and a backdrop where it has none. Whatever had to be repaired is
    /// said by a ``UserWarning``.
    ///
    /// Parameters
    /// ----------
    /// path : path-like
    ///     The file.
    /// preset : str, optional
    ///     Material of a mesh, by its name among the presets.
    /// unit : {'mm', 'cm', 'm'}, optional
    ///     Unit of a mesh's coordinates; by default m for glTF, else mm.
    /// size : (int, int), optional
    ///     Width and height of the picture in pixels, each in [1, 16384], which a chosen camera is made for.
    /// subsurface : str, optional
    ///     Model of the transport under all surfaces, in place of the materials' own.
    /// up : {'x', 'y', 'z', '-x', '-y', '-z'}, optional
    ///     Axis of a mesh that points up; by default y, or the axis across the flat underside of one that is no glTF.
    /// view : str, optional
    ///     Side to look from: ``'front'``, ``'back'``, ``'left'``, ``'right'``, ``'top'``, ``'bottom'``, or
    ///     ``'azimuth,elevation'`` in degrees.
    /// floor : str, optional
    ///     Floor below a mesh: ``'none'``, ``'backdrop'``, ``'shadow'``, ``'#rrggbb'`` or a grey in [0, 1].
    /// camera : str, optional
    ///     Camera of the file, by its name; by default the first.
    ///
    /// Returns
    /// -------
    /// Scene
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     The file cannot be read, or something in it is wrong: ``path`` and ``line`` say where.
    ///
    /// Examples
    /// --------
    /// >>> translucid.Scene.load("no-such.toml")
    /// Traceback (most recent call last):
    ///     ...
    /// translucid.SceneError: no-such.toml: cannot be read: No such file or directory (os error 2)
    #[classmethod]
    #[pyo3(signature = (path, *, preset=None, unit=None, size=None, subsurface=None, up=None, view=None, floor=None, camera=None))]
    #[expect(clippy::too_many_arguments, reason = "the options of the command")]
    fn load(
        class: &Bound<'_, PyType>,
        path: PathBuf,
        preset: Option<String>,
        unit: Option<&str>,
        size: Option<&Any<'_>>,
        subsurface: Option<&str>,
        up: Option<&str>,
        view: Option<&str>,
        floor: Option<&str>,
        camera: Option<String>,
    ) -> PyResult<Self> {
        let axes = UpAxis::WORDS.map(|(word, _)| word).join(", ");
        let floors = "none, backdrop, shadow, #rrggbb or a grey in [0, 1]";
        let sides = "front, back, left, right, top, bottom or azimuth,elevation in degrees";
        let options = LoadOptions {
            preset,
            unit: unit.map(unit_of).transpose()?,
            up: word("up", up, UpAxis::from_name, &axes)?,
            viewpoint: word("view", view, Viewpoint::from_text, sides)?,
            floor: word("floor", floor, Floor::from_text, floors)?,
            camera,
            ..picture_options(size, subsurface)?
        };
        let scene = load(class.py(), path, options)?;
        Ok(Self::of(Making { builder: scene.into(), image_count: 0, light_count: 0 }))
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Scene cannot be pickled: pass what it is made of, or the path of its file, and make it there",
        ))
    }

    /// The files that a scene file or a mesh is read from: what another machine needs to load it.
    #[staticmethod]
    fn _files(py: Python<'_>, path: PathBuf) -> PyResult<Vec<PathBuf>> {
        Ok(load(py, path, LoadOptions::default())?.files.into_iter().collect())
    }

    /// Adds a material.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name, which no other material has.
    /// **keys
    ///     As in a ``[[material]]`` of a scene file: ``base_color``, ``specular_roughness``, ``subsurface_weight``,
    ///     ``subsurface_color`` (the surface albedo), ``subsurface_radius`` and ``subsurface_radius_scale`` (the
    ///     mean free path, in the scene's unit), ``subsurface_model`` (by default ``"random-walk"``,
    ///     ``"random-walk-rough"`` if η is above 1, or a profile where the material or the integrator asks for what walks do
    ///     not do) …; ``preset`` begins with a measured material.
    ///     Colors and scalars may be textures: an array, or a dictionary with the keys ``image`` (an array) or
    ///     ``file``, ``factor``, ``color_space``, ``channel``, ``uv_scale``, ``uv_offset``, ``uv_rotation``, ``wrap``, ``filter``.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown, a value out of its range, or the name taken.
    ///
    /// Examples
    /// --------
    /// >>> scene = translucid.Scene()
    /// >>> scene.add_material("skin", preset="skin1", specular_roughness=0.35)
    /// >>> scene.add_material("wax", subsurface_colour=0.8)
    /// Traceback (most recent call last):
    ///     ...
    /// translucid.SceneError: material wax: it has no key subsurface_colour (did you mean subsurface_color? ...
    #[pyo3(signature = (name, **keys))]
    fn add_material(&self, py: Python<'_>, name: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let read = self.read(py, &format!("material {name}"), Some(("name", name)), keys)?;
        self.change_long(py, read, SceneBuilder::add_material)
    }

    /// Adds an object that is a mesh.
    ///
    /// Triangles without area are left out, with a ``UserWarning``.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name, which no other object has.
    /// vertices : array_like, shape (n, 3)
    ///     Coordinates in the scene's unit, within ±1e9.
    /// triangles : array_like of integers, shape (m, 3)
    ///     Indices of vertices, counted from 0, counter-clockwise as seen from outside.
    /// normals : array_like, shape (n, 3), optional
    ///     Shading normals; without them the mesh is flat between its edges.
    /// uv : array_like, shape (n, 2), optional
    ///     Texture coordinates, v upward.
    /// colors : array_like, shape (n, 3), optional
    ///     Linear colors, used by materials whose color is ``'vertex'``.
    /// **keys
    ///     As in an ``[[object]]`` of a scene file: ``material`` (a name), ``translate``, ``rotate``, ``scale`` or
    ///     ``matrix``, ``subsurface_group``; ``movable=True`` for one that `Session.edit_object` may move, which rays
    ///     find a little more slowly and whose place stretches no direction 100 times as much as another; ``transforms``
    ///     for many objects that share the mesh, a list of dictionaries
    ///     with those keys or an array of matrices of shape (n, 4, 4).
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     An array has another shape, a coordinate is not finite, an index is out of range, or a key is wrong.
    /// TypeError
    ///     An array is not of numbers, or the triangles are not of integers.
    #[pyo3(signature = (name, vertices, triangles, *, normals=None, uv=None, colors=None, **keys))]
    #[expect(clippy::too_many_arguments, reason = "the parts of a mesh")]
    fn add_mesh(
        &self,
        py: Python<'_>,
        name: &str,
        vertices: &Any<'_>,
        triangles: &Any<'_>,
        normals: Option<&Any<'_>>,
        uv: Option<&Any<'_>>,
        colors: Option<&Any<'_>>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let title = format!("mesh {name}");
        let mesh = mesh_of(&title, vertices, triangles, [normals, uv, colors])?;
        let read = self.read(py, &title, Some(("name", name)), keys)?;
        self.change_long(py, read, |builder, piece, warnings| builder.add_mesh_object(piece, mesh, warnings))
    }

    /// Adds an object that is a built-in shape or in a file.
    ///
    /// Parameters
    /// ----------
    /// name : str, optional
    ///     Its name, which no other object has; by default that of the shape or file.
    /// **keys
    ///     As in an ``[[object]]`` of a scene file: ``shape`` and its parameters or ``file``, ``material``,
    ///     ``translate``, ``transforms`` …
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, a value not allowed, or the file cannot be used.
    #[pyo3(signature = (name=None, **keys))]
    fn add_object(
        &self,
        py: Python<'_>,
        name: Option<&str>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let title = name.map_or_else(|| String::from("object"), |name| format!("object {name}"));
        let read = self.read(py, &title, name.map(|name| ("name", name)), keys)?;
        self.change_long(py, read, SceneBuilder::add_object)
    }

    /// Adds a light.
    ///
    /// Parameters
    /// ----------
    /// type : {'rectangle', 'ellipse', 'sphere', 'distant', 'spot', 'point', 'beam'}
    ///     What it is.
    /// **keys
    ///     As in a ``[[light]]`` of a scene file: ``center``, ``target``, ``size``, ``radiance`` … of a rectangle.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (r#type=None, **keys))]
    fn add_light(
        &self,
        py: Python<'_>,
        r#type: Option<&str>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let title = format!("light {}", py.detach(|| self.lock().light_count));
        let read = self.read(py, &title, r#type.map(|name| ("type", name)), keys)?;
        self.change(py, &read, |making, piece| {
            making.builder.add_light(piece)?;
            making.light_count += 1;
            Ok(())
        })
    }

    /// Sets the light from all around.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in the ``[environment]`` of a scene file: ``radiance``, ``file`` (an image, or an array), ``rotation``,
    ///     ``visible``.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_environment(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        self.change_long(py, self.read(py, "environment", None, keys)?, SceneBuilder::set_environment)
    }

    /// Sets the camera.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in the ``[camera]`` of a scene file: ``position``, ``target``, ``up``, ``fov`` (horizontal, in degrees)
    ///     or ``projection="orthographic"`` and ``width``, ``shift`` (to the right and up, in widths of the picture),
    ///     ``lens_radius``, ``focus_distance``.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_camera(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let read = self.read(py, "camera", None, keys)?;
        self.change(py, &read, |making, piece| making.builder.set_camera(piece))
    }

    /// Changes the film.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in the ``[film]`` of a scene file: ``size``, ``filter``, ``filter_radius``, ``exposure`` (in stops),
    ///     ``tone_mapping``.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_film(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let read = self.read(py, "film", None, keys)?;
        self.change(py, &read, |making, piece| making.builder.set_film(piece))
    }

    /// Changes how paths are traced.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in the ``[integrator]`` of a scene file: ``samples_per_pixel``, ``max_depth``, ``seed`` …
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_integrator(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let read = self.read(py, "integrator", None, keys)?;
        self.change(py, &read, |making, piece| making.builder.set_integrator(piece))
    }

    /// Unit of all lengths: ``'mm'``, ``'cm'`` or ``'m'``.
    #[getter]
    fn unit(&self, py: Python<'_>) -> &'static str {
        py.detach(|| self.lock().builder.scene().unit.name())
    }

    /// Names of the objects, in the order in which they were added.
    #[getter]
    fn objects(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.lock().builder.scene().objects.iter().map(|object| object.name.clone()).collect())
    }

    /// Names of the materials, in the order in which they were added.
    #[getter]
    fn materials(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| {
            self.lock().builder.scene().materials.iter().map(|material| material.name.clone()).collect()
        })
    }

    /// Width and height of the picture in pixels.
    #[getter]
    fn size(&self, py: Python<'_>) -> (u32, u32) {
        py.detach(|| {
            let film = self.lock().builder.scene().film;
            (film.width, film.height)
        })
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        py.detach(|| {
            let making = self.lock();
            let scene = making.builder.scene();
            let triangles = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
            let count = |n: usize, thing: &str| format!("{n} {thing}{}", if n == 1 { "" } else { "s" });
            format!(
                "<translucid.Scene in {}: {}, {}, {}, {}>",
                scene.unit.name(),
                count(scene.objects.len(), "object"),
                count(triangles, "triangle"),
                count(scene.materials.len(), "material"),
                count(scene.lights.len(), "light")
            )
        })
    }
}

impl Scene {
    fn of(making: Making) -> Self {
        Self { making: Arc::new(Mutex::new(making)) }
    }

    fn lock(&self) -> MutexGuard<'_, Making> {
        lock(&self.making)
    }

    /// Reads the keys of a part of the scene, behind a word that is given by itself.
    fn read(
        &self,
        py: Python<'_>,
        title: &str,
        word: Option<(&str, &str)>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Read> {
        let mut image_count = py.detach(|| self.lock().image_count);
        let mut new = Keys::new(title, &mut image_count);
        if let Some((key, text)) = word {
            new = new.text(key, text);
        }
        let piece = new.arguments(keys)?.piece();
        Ok(Read { piece, image_count })
    }

    /// Changes the scene by keys, without the interpreter, so that nobody waits for the scene who holds the interpreter.
    fn change(
        &self,
        py: Python<'_>,
        read: &Read,
        apply: impl FnOnce(&mut Making, &Piece) -> Result<(), SceneError> + Send,
    ) -> PyResult<()> {
        py.detach(|| {
            let mut making = self.lock();
            making.image_count = making.image_count.max(read.image_count);
            apply(&mut making, &read.piece)
        })
        .map_err(scene_error)
    }

    /// As [`change`](Self::change), where files may be read: Ctrl-C ends the call at once, and nothing is added then.
    fn change_long(
        &self,
        py: Python<'_>,
        read: Read,
        apply: impl FnOnce(&mut SceneBuilder, &Piece, &mut Vec<Warning>) -> Result<(), SceneError>
        + Send
        + 'static,
    ) -> PyResult<()> {
        let making = Arc::clone(&self.making);
        let work = move |_: &AtomicBool, hand_over: &dyn Fn(_) -> bool| {
            let mut making = lock(&making);
            making.image_count = making.image_count.max(read.image_count);
            making.builder.all_or_nothing(|builder| {
                let mut warnings = Vec::new();
                let result = apply(builder, &read.piece, &mut warnings);
                let is_done = result.is_ok();
                hand_over((result, warnings)) && is_done
            });
        };
        let (result, warnings) = long_work::run_and_hand_over(py, work, |_| Ok(()))?;
        warn(py, &warnings)?;
        result.map_err(scene_error)
    }

    /// The scene as it is now, with what it does not say chosen.
    pub(crate) fn build(&self, py: Python<'_>, options: &LoadOptions) -> PyResult<translucid_scene::Scene> {
        py.detach(|| self.lock().builder.build(options)).map_err(scene_error)
    }
}

fn lock(making: &Mutex<Making>) -> MutexGuard<'_, Making> {
    making.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The scene of an argument: a `Scene`, or the path of a file.
pub(crate) fn scene_of(argument: &Any<'_>, options: LoadOptions) -> PyResult<translucid_scene::Scene> {
    let py = argument.py();
    if let Ok(scene) = argument.cast::<Scene>() {
        return scene.get().build(py, &options);
    }
    let is_path = argument.is_instance_of::<PyString>() || argument.hasattr("__fspath__")?;
    if !is_path {
        let kind = argument.get_type().name()?;
        let message = format!("scene is of type {kind}, but must be a Scene or the path of a file");
        return Err(PyTypeError::new_err(message));
    }
    load(py, argument.extract()?, options)
}

/// Loads a file and warns of what was repaired.
fn load(py: Python<'_>, path: PathBuf, options: LoadOptions) -> PyResult<translucid_scene::Scene> {
    let (scene, warnings) = long_work::run_or_leave(py, move || {
        let mut warnings = Vec::new();
        (load_scene(&path, &options, &mut warnings), warnings)
    })?;
    warn(py, &warnings)?;
    scene.map_err(scene_error)
}

/// Size and model of a picture in place of the scene's.
pub(crate) fn picture_options(size: Option<&Any<'_>>, subsurface: Option<&str>) -> PyResult<LoadOptions> {
    let model = |name: &str| {
        let names = SubsurfaceModel::ALL.map(SubsurfaceModel::name);
        SubsurfaceModel::from_name(name).ok_or_else(|| names::unknown("subsurface", name, &names))
    };
    let size = size
        .map(|size| whole_numbers("size", size, "two numbers, width and height", [1, Film::LONGEST_EDGE]));
    Ok(LoadOptions {
        size: size.transpose()?,
        subsurface_model: subsurface.map(model).transpose()?,
        ..LoadOptions::default()
    })
}

/// So many whole numbers.
pub(crate) fn whole_numbers<const N: usize>(
    name: &str,
    argument: &Any<'_>,
    must_be: &str,
    [min, max]: [u32; 2],
) -> PyResult<[u32; N]> {
    let wrong = || PyTypeError::new_err(format!("{name} is {argument}, but must be {must_be}"));
    let elements: Vec<Any<'_>> =
        argument.try_iter().map_err(|_| wrong())?.take(N + 1).collect::<PyResult<_>>()?;
    let elements: [Any<'_>; N] = elements
        .try_into()
        .map_err(|_| PyValueError::new_err(format!("{name} is {argument}, but must be {must_be}")))?;
    let mut numbers = [0; N];
    for (i, (number, element)) in numbers.iter_mut().zip(&elements).enumerate() {
        *number = whole_number(&format!("{name}[{i}]"), element, min.into(), max.into())? as u32;
    }
    Ok(numbers)
}

/// A whole number in a range.
pub(crate) fn whole_number(name: &str, argument: &Any<'_>, min: u64, max: u64) -> PyResult<u64> {
    let must_be = || format!("but must be a whole number in [{min}, {max}]");
    if argument.is_instance_of::<PyBool>() || !argument.hasattr("__index__")? {
        let kind = argument.get_type().name()?;
        return Err(PyTypeError::new_err(format!("{name} is of type {kind}, {}", must_be())));
    }
    let number: Option<u64> = argument.call_method0("__index__")?.extract().ok();
    number.filter(|n| (min..=max).contains(n)).ok_or_else(|| {
        let shown = argument.str().map_or_else(|_| String::from("too large"), |text| text.to_string());
        PyValueError::new_err(format!("{name} is {shown}, {}", must_be()))
    })
}

/// What a word means, if it is given.
fn word<T>(
    name: &str,
    text: Option<&str>,
    read: impl Fn(&str) -> Option<T>,
    allowed: &str,
) -> PyResult<Option<T>> {
    let wrong =
        |text: &str| PyValueError::new_err(format!("{name} is {text:?}, but must be one of {allowed}"));
    text.map(|text| read(text).ok_or_else(|| wrong(text))).transpose()
}

fn origin_of(array: &Any<'_>) -> PyResult<DVec3> {
    let numbers = Numbers::extract("origin", array)?;
    numbers.require(&Rule::new(
        "origin",
        "finite and within ±1e9",
        -LARGEST_COORDINATE,
        LARGEST_COORDINATE,
    ))?;
    let found: Vec<f64> = numbers.iter().collect();
    let three: Result<[f64; 3], _> = found.try_into();
    three.map(DVec3::from_array).map_err(|found| {
        PyValueError::new_err(format!("origin has {} numbers, but must have three", found.len()))
    })
}

fn unit_of(name: &str) -> PyResult<Unit> {
    let message = || format!("unit is {name:?}, but must be one of \"mm\", \"cm\", \"m\"");
    Unit::from_name(name).ok_or_else(|| scene_error(SceneError::new(message())))
}

/// A mesh of arrays: vertices, triangles, and if given normals, texture coordinates and colors.
pub(crate) fn mesh_of(
    title: &str,
    vertices: &Any<'_>,
    triangles: &Any<'_>,
    [normals, uv, colors]: [Option<&Any<'_>>; 3],
) -> PyResult<Mesh> {
    let positions = rows(title, "vertices", vertices, None)?;
    let count = positions.len();
    let triangles = triangles_of(title, triangles, count)?;
    let of_vertices = |name, array: Option<&Any<'_>>| {
        array.map_or(Ok(Vec::new()), |array| rows::<3>(title, name, array, Some(count)))
    };
    let vectors = |rows: Vec<[f32; 3]>| rows.into_iter().map(Vec3::from_array).collect();
    let uvs = uv.map_or(Ok(Vec::new()), |uv| rows::<2>(title, "uv", uv, Some(count)))?;
    Ok(Mesh {
        positions: vectors(positions),
        normals: vectors(of_vertices("normals", normals)?),
        uvs: uvs.into_iter().map(Vec2::from_array).collect(),
        colors: vectors(of_vertices("colors", colors)?),
        triangles,
        ..Mesh::default()
    })
}

/// The rows of an array of shape (n, N), where n is known or at least 1.
fn rows<const N: usize>(
    title: &str,
    name: &str,
    array: &Any<'_>,
    count: Option<usize>,
) -> PyResult<Vec<[f32; N]>> {
    let numbers = Numbers::extract(name, array).map_err(|error| in_scene(title, error, array.py()))?;
    let shape = numbers.shape();
    let is_right = match count {
        Some(count) => *shape == [count, N],
        None => matches!(*shape, [n, columns] if n > 0 && columns == N),
    };
    if !is_right {
        let rows = count.map_or_else(|| String::from("n"), |count| count.to_string());
        let at_least = if count.is_none() { " with n at least 1" } else { ", a row for each vertex" };
        let message = format!("{name} has the shape {shape:?}, but must have [{rows}, {N}]{at_least}");
        return Err(wrong(title, &message));
    }
    if shape[0] > MOST_VERTICES {
        return Err(wrong(title, &format!("{name} has {} rows, but may have {MOST_VERTICES}", shape[0])));
    }
    let allowed = "finite and within ±1e9";
    numbers
        .require(&Rule::new(name, allowed, -LARGEST_COORDINATE, LARGEST_COORDINATE))
        .map_err(|error| in_scene(title, error, array.py()))?;
    let mut all = Vec::new();
    all.try_reserve_exact(shape[0]).map_err(|_| wrong(title, &format!("{name} does not fit into memory")))?;
    let mut numbers = numbers.iter();
    while let Some(first) = numbers.next() {
        let mut row = [first as f32; N];
        row[1..].iter_mut().zip(&mut numbers).for_each(|(x, number)| *x = number as f32);
        all.push(row);
    }
    Ok(all)
}

/// The rows of an array of indices of shape (m, 3).
fn triangles_of(title: &str, array: &Any<'_>, vertices: usize) -> PyResult<Vec<[u32; 3]>> {
    let py = array.py();
    let name = "triangles";
    let array = py
        .import("numpy")?
        .call_method1("asarray", (array,))
        .map_err(|error| wrong(title, &format!("{name} must be an array of integers: {error}")))?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if !matches!(shape[..], [m, 3] if m > 0) {
        let message = format!("{name} has the shape {shape:?}, but must have [m, 3] with m at least 1");
        return Err(wrong(title, &message));
    }
    let dtype = array.getattr("dtype")?;
    if !matches!(dtype.getattr("kind")?.extract::<String>()?.as_str(), "i" | "u") {
        return Err(PyTypeError::new_err(format!(
            "{title}: {name} must be integers, but is of dtype {dtype}"
        )));
    }
    if shape[0] > MOST_TRIANGLES {
        return Err(wrong(title, &format!("{name} has {} rows, but may have {MOST_TRIANGLES}", shape[0])));
    }
    let found = match (
        array.cast::<PyArrayDyn<u32>>(),
        array.cast::<PyArrayDyn<i32>>(),
        array.cast::<PyArrayDyn<u64>>(),
    ) {
        (Ok(array), ..) if is_aligned(array) => indices(array, vertices),
        (_, Ok(array), _) if is_aligned(array) => indices(array, vertices),
        (.., Ok(array)) if is_aligned(array) => indices(array, vertices),
        _ => {
            let array = array.call_method1("astype", ("int64",))?;
            indices(array.cast::<PyArrayDyn<i64>>()?, vertices)
        }
    };
    found?.map_err(|(row, column)| {
        let index = array.get_item((row, column)).and_then(|n| n.str().map(|n| n.to_string()));
        let index = index.unwrap_or_default();
        let message = format!(
            "{name}[{row}, {column}] is {index}, but must be in [0, {}]: there are {vertices} vertices",
            vertices - 1
        );
        wrong(title, &message)
    })
}

/// Row and column of an array.
type Place = (usize, usize);

/// The rows of indices below a number, or the place of the first that is not.
fn indices<T: Element + Copy + TryInto<u32>>(
    array: &Bound<'_, PyArrayDyn<T>>,
    vertices: usize,
) -> PyResult<Result<Vec<[u32; 3]>, Place>> {
    let array = array.try_readonly()?;
    let view = array.as_array();
    let mut rows = Vec::with_capacity(array.len() / 3);
    let mut row = [0; 3];
    for (place, &index) in view.iter().enumerate() {
        let index = index.try_into().ok().filter(|&index: &u32| (index as usize) < vertices);
        let Some(index) = index else { return Ok(Err((place / 3, place % 3))) };
        row[place % 3] = index;
        if place % 3 == 2 {
            rows.push(row);
        }
    }
    Ok(Ok(rows))
}
