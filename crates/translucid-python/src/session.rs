//! `Session`: a picture that becomes better step by step, while its scene is edited and its film read.

use std::collections::HashMap;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyRange};
use translucid_gpu::Choice;
use translucid_image::{Denoiser, PixelRect};
use translucid_load::{Piece, SceneBuilder};
use translucid_render::{
    Edit, FilmSums, LiveFilm, PreparedScene, RunningSession, ShardNotes, ShardRun, View,
};
use translucid_scene::{Material, Mesh, SceneError, repair_mesh};

use crate::arrays::Any;
use crate::keys::{named_piece_of, piece_of, plain_piece_of};
use crate::live_session::LiveSession;
use crate::long_work;
use crate::mattes::{Kind, mattes};
use crate::names::{all_of_object, index_of};
use crate::scene::{mesh_of, picture_options, scene_of, whole_number};
use crate::scene_error::{scene_error, warn};
use crate::session_arguments::{DENOISED, MOST_SAMPLES, layer_of, region_of, sample_range};
use crate::session_state::{Failure, refusal};

/// Most threads of a session.
const MOST_THREADS: u64 = 1024;

/// Most ids of a pixel.
const MOST_LEVELS: u64 = 64;

/// Longest time between two looks at a session that is waited for.
const LONGEST_NAP: Duration = Duration::from_millis(20);

/// A rendering that goes on step by step.
///
/// Its picture can be read while it runs, in another thread or between steps. After an edit the film begins anew, and
/// only what depends on the edit is prepared again.
///
/// Parameters
/// ----------
/// scene : Scene or path-like
///     What to render: taken as it is now, later changes of it do not count.
/// size : (int, int), optional
///     Width and height in pixels, each in [1, 16384]; by default the scene's.
/// subsurface : str, optional
///     Model of the transport under all surfaces, in place of the materials' own.
/// seed : int, optional
///     Seed of the random numbers; by default the scene's.
/// threads : int, optional
///     Threads to render with, at most 1024; by default one per processor. The picture does not depend on it.
/// device : str, optional
///     Who traces the paths: "cpu", "gpu" (the best graphics processor), "auto" (that, or the processor where there is none or
///     devices lack what the scene needs, with a warning), or a part of a device's name. A device finds the same light by
///     other paths.
/// region : (int, int, int, int), optional
///     Render these pixels only: from (x0, y0) at the upper left to just before (x1, y1). They are those of the whole
///     picture, bit for bit.
///
/// Examples
/// --------
/// >>> scene = translucid.Scene()
/// >>> scene.add_material("wax", preset="wax")
/// >>> scene.add_object("ball", shape="sphere", material="wax")
/// >>> session = translucid.Session(scene, size=(32, 24))
/// >>> session.step()
/// >>> session.samples
/// 1
/// >>> session.edit_material("wax", subsurface_radius=2)
/// >>> session.run(4)
/// >>> session.snapshot("alpha").shape
/// (24, 32, 1)
#[pyclass(frozen, subclass, module = "translucid", weakref)]
pub(crate) struct Session {
    live: LiveSession,
}

#[pymethods]
impl Session {
    #[new]
    #[pyo3(signature = (scene, *, size=None, subsurface=None, seed=None, threads=None, device="cpu", region=None))]
    pub(crate) fn new(
        scene: &Any<'_>,
        size: Option<&Any<'_>>,
        subsurface: Option<&str>,
        seed: Option<&Any<'_>>,
        threads: Option<&Any<'_>>,
        device: &str,
        region: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let options = picture_options(size, subsurface)?;
        let seed = seed.map(|seed| whole_number("seed", seed, 0, u64::MAX)).transpose()?;
        let threads = threads.map(|threads| whole_number("threads", threads, 1, MOST_THREADS)).transpose()?;
        let threads = threads.unwrap_or(0) as usize;
        let region = region.map(region_of).transpose()?;
        let py = scene.py();
        let mut scene = scene_of(scene, options)?;
        scene.integrator.seed = seed.unwrap_or(scene.integrator.seed);
        let choice = Choice::open_for_pictures(device).map_err(PyValueError::new_err)?;
        let (session, note) = long_work::run_or_leave(py, move || -> Result<_, Failure> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::work)?;
            let view = View::of(&scene)?;
            let view = region.map_or(Ok(view.clone()), |region| view.with_region(region))?;
            translucid_render::Session::require_memory(
                &scene,
                view.region(),
                translucid_render::Session::BYTES_PER_PIXEL,
            )?;
            let prepared = pool.install(|| PreparedScene::new(scene))?;
            let mut session = translucid_render::Session::new(prepared, view);
            session.set_device(choice.on_device())?;
            let note = choice.note.filter(|_| choice.device.is_none()).or_else(|| refusal(&session));
            Ok((session, note))
        })??;
        if let Some(note) = note {
            let text =
                CString::new(note).map_err(|_| PyValueError::new_err("a device's name holds a NUL"))?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
        }
        Ok(Self { live: LiveSession::new(session, threads) })
    }

    /// Renders until every pixel has a number of samples.
    ///
    /// Ctrl-C ends it with KeyboardInterrupt; the samples so far stay, and another run goes on from them.
    ///
    /// Parameters
    /// ----------
    /// samples : int or range, optional
    ///     Samples that each pixel shall have in the end, at most 2**24; by default as many as the scene states. A
    ///     ``range`` with a step of 1 has the samples of these numbers alone, for processes that share the work and
    ///     `save` their parts.
    /// progress : bool, 'tqdm' or callable, optional
    ///     Called now and then with the numbers of paths that are done and that there are in all; ``True`` and
    ///     ``'tqdm'`` show a bar. An exception in it ends the rendering and is passed on.
    ///
    /// Raises
    /// ------
    /// KeyboardInterrupt
    ///     Ctrl-C was pressed.
    #[pyo3(signature = (samples=None, *, progress=None))]
    fn run(&self, py: Python<'_>, samples: Option<&Any<'_>>, progress: Option<&Any<'_>>) -> PyResult<()> {
        self.start(py, samples)?;
        self.wait(py, progress)
    }

    /// Adds samples to each pixel.
    ///
    /// Parameters
    /// ----------
    /// samples : int
    ///     How many.
    /// progress : bool, 'tqdm' or callable, optional
    ///     As in `run`.
    ///
    /// Raises
    /// ------
    /// KeyboardInterrupt
    ///     Ctrl-C was pressed.
    #[pyo3(signature = (samples=None, *, progress=None))]
    fn step(&self, py: Python<'_>, samples: Option<&Any<'_>>, progress: Option<&Any<'_>>) -> PyResult<()> {
        let more = samples.map_or(Ok(1), |samples| whole_number("samples", samples, 1, MOST_SAMPLES))?;
        let goal = (more + u64::from(self.samples(py))).min(MOST_SAMPLES);
        self.live.start_to(py, 0..goal as u32)?;
        self.wait(py, progress)
    }

    /// Renders in the background until every pixel has a number of samples.
    ///
    /// Parameters
    /// ----------
    /// samples : int or range, optional
    ///     As in `run`.
    ///
    /// Raises
    /// ------
    /// RuntimeError
    ///     It runs already.
    #[pyo3(signature = (samples=None))]
    fn start(&self, py: Python<'_>, samples: Option<&Any<'_>>) -> PyResult<()> {
        let samples = match samples {
            Some(samples) => match samples.cast::<PyRange>() {
                Ok(range) => sample_range(range)?,
                Err(_) => 0..whole_number("samples", samples, 1, MOST_SAMPLES)? as u32,
            },
            None => 0..py.detach(|| self.live.facts().samples_per_pixel),
        };
        self.live.start_to(py, samples)
    }

    /// Waits for a session that runs in the background.
    ///
    /// Ctrl-C ends the session with KeyboardInterrupt.
    ///
    /// Parameters
    /// ----------
    /// progress : bool, 'tqdm' or callable, optional
    ///     As in `run`.
    ///
    /// Raises
    /// ------
    /// KeyboardInterrupt
    ///     Ctrl-C was pressed.
    #[pyo3(signature = (*, progress=None))]
    fn wait(&self, py: Python<'_>, progress: Option<&Any<'_>>) -> PyResult<()> {
        let mut reported = None;
        let mut report = |is_last: bool| -> PyResult<()> {
            let Some(progress) = progress else { return Ok(()) };
            let [done, total] = self.live.progress();
            if reported != Some(done) || is_last {
                reported = Some(done);
                progress.call1((done, total))?;
            }
            Ok(())
        };
        let mut nap = Duration::from_micros(200);
        loop {
            let has_ended = py.detach(|| {
                // Short steps are not to wait for a long nap
                std::thread::sleep(nap);
                nap = (nap * 2).min(LONGEST_NAP);
                !self.live.is_running()
            });
            if has_ended {
                self.live.end(py, RunningSession::wait)?;
                return report(true);
            }
            if let Err(error) = py.check_signals().and_then(|()| report(false)) {
                // The exception is what the caller is to hear of
                let _ = self.cancel(py);
                return Err(error);
            }
        }
    }

    /// Ends what runs in the background, within milliseconds. The samples so far stay.
    fn cancel(&self, py: Python<'_>) -> PyResult<()> {
        self.live.end(py, RunningSession::stop)
    }

    /// Writes the samples so far as a shard, which `translucid merge` joins with others of the same scene and settings to
    /// the picture of one run, bit for bit.
    ///
    /// What runs in the background is ended.
    ///
    /// Parameters
    /// ----------
    /// path : path-like
    ///     The file, which is whole or not there.
    /// scene : str, default ""
    ///     Where the scene came from, for the notes of the picture.
    /// samples_per_pixel : int, optional
    ///     Samples that the whole picture is to have, by which a merge finds what is missing; by default as many as the scene
    ///     states.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file cannot be written.
    #[pyo3(signature = (path, *, scene="", samples_per_pixel=None))]
    #[expect(clippy::needless_pass_by_value, reason = "what Python gives")]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        scene: &str,
        samples_per_pixel: Option<&Any<'_>>,
    ) -> PyResult<()> {
        let planned = samples_per_pixel
            .map(|samples| whole_number("samples_per_pixel", samples, 1, MOST_SAMPLES))
            .transpose()?;
        let saved = self.live.with_idle(py, |session| {
            let name = scene.to_owned();
            let scene = session.prepared().scene();
            let notes = ShardNotes {
                scene: name,
                seed: session.view().seed(),
                samples_per_pixel: planned
                    .map_or(scene.integrator.samples_per_pixel, |samples| samples as u32),
                exposure: Some(scene.film.exposure),
                tone_mapping: scene.film.tone_mapping.name().to_owned(),
                ..ShardNotes::default()
            };
            session.set_notes(notes, ShardRun { threads: self.live.threads(), ..ShardRun::default() });
            Ok(session.save(&path))
        })?;
        saved.map_err(|error| PyOSError::new_err(error.to_string()))
    }

    /// A layer of the picture as it is now.
    ///
    /// Parameters
    /// ----------
    /// layer : str
    ///     ``'radiance'`` (linear Rec. 709, multiplied by coverage), its parts ``'diffuse'``, ``'specular'``,
    ///     ``'subsurface'``, ``'emission'`` by the last event before the camera, ``'alpha'``, and of the first
    ///     surface ``'albedo'``, ``'normal'`` (world space) and ``'depth'`` (distance in the scene's unit, 0 where there
    ///     is none); ``'denoised'`` is the radiance without its noise, by Intel Open Image Denoise (``pip install
    ///     pyoidn``).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (height, width, 3), or (height, width, 1) for alpha and depth, float32.
    #[pyo3(signature = (layer="radiance"))]
    fn snapshot<'py>(&self, py: Python<'py>, layer: &str) -> PyResult<Any<'py>> {
        let film = self.live.film(py);
        if layer == DENOISED {
            return self.denoised(py, film);
        }
        let layer = layer_of(layer)?;
        let (shape, values) = py.detach(|| {
            let [width, height] = size_of(&film.sums());
            ([height, width, layer.channels()], film.layer(layer))
        });
        Ok(values.into_pyarray(py).reshape(shape)?.into_any())
    }

    /// The pairs of `cryptomatte`, which the Python half documents.
    #[pyo3(signature = (kind, levels, names))]
    #[expect(clippy::needless_pass_by_value, reason = "what Python gives")]
    fn _cryptomatte<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        levels: &Any<'_>,
        names: HashMap<String, String>,
    ) -> PyResult<Any<'py>> {
        let levels = whole_number("levels", levels, 1, MOST_LEVELS)? as usize;
        mattes(py, &self.live, Kind::from_name(kind)?, levels, &names)
    }

    /// Changes a material; what is not named stays.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    /// **keys
    ///     As in `Scene.add_material`, arrays and files of images among them, but for ``subsurface_table``.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (name, **keys))]
    fn edit_material(&self, py: Python<'_>, name: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let piece = piece_of(&format!("material {name}"), keys)?;
        self.live.edit_with_files(py, |session, warnings| {
            let scene = session.prepared().scene();
            let names = scene.materials.iter().map(|material| material.name.as_str());
            let index = index_of("material", name, names)?;
            let old = &scene.materials[index];
            let (material, images) = piece.material_with_images(scene, old, warnings)?;
            Ok((images, Edit::Material(index, Box::new(material))))
        })
    }

    /// Changes the vertices or all of an object's mesh; its material stays.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    /// vertices, triangles, normals, uv, colors
    ///     As in `Scene.add_mesh`, in their place in the scene.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (name, vertices, triangles, *, normals=None, uv=None, colors=None))]
    #[expect(clippy::too_many_arguments, reason = "the parts of a mesh")]
    fn edit_mesh(
        &self,
        py: Python<'_>,
        name: &str,
        vertices: &Any<'_>,
        triangles: &Any<'_>,
        normals: Option<&Any<'_>>,
        uv: Option<&Any<'_>>,
        colors: Option<&Any<'_>>,
    ) -> PyResult<()> {
        let title = format!("mesh {name}");
        let mut mesh: Mesh = mesh_of(&title, vertices, triangles, [normals, uv, colors])?;
        let mut warnings = Vec::new();
        let place = translucid_scene::Place::part(std::path::Path::new(""), title);
        py.detach(|| repair_mesh(&mut mesh, &place, &mut warnings)).map_err(scene_error)?;
        warn(py, &warnings)?;
        self.live.edit(py, move |session| {
            let scene = session.prepared().scene();
            let names = scene.objects.iter().map(|object| object.name.as_str());
            let index = index_of("object", name, names)?;
            let old = &scene.objects[index];
            let (name, material, subsurface_group) = (old.name.clone(), old.material, old.subsurface_group);
            let object = translucid_scene::Object {
                name,
                mesh: mesh.into(),
                material,
                subsurface_group,
                ..Default::default()
            };
            session.edit(Edit::Object(index, Box::new(object))).map(drop)
        })
    }

    /// Adds an object that is a mesh.
    ///
    /// Parameters
    /// ----------
    /// name, vertices, triangles, normals, uv, colors
    ///     As in `Scene.add_mesh`.
    /// **keys
    ///     As there; ``material`` must be among them. A ``subsurface_group`` is a new one.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
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
        let piece = named_piece_of(&title, name, keys)?;
        let mut warnings = Vec::new();
        self.live.edit(py, |session| {
            let mut builder = SceneBuilder::from(session.prepared().scene().clone());
            let materials = builder.scene().materials.len();
            builder.add_mesh_object(&piece, mesh, &mut warnings)?;
            if builder.scene().materials.len() > materials {
                return Err(SceneError::new(format!("{title}: it needs the key material")));
            }
            session.edit(Edit::Objects(builder.scene().objects.clone())).map(drop)
        })?;
        warn(py, &warnings)
    }

    /// Moves an object, or gives it another material; what is not named stays.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name. Where `Scene.add_mesh` made several of one mesh, ``name[…]``, it is that of all.
    /// **keys
    ///     ``material``; and if it was added with ``movable=True`` its place by ``translate``, ``rotate`` and ``scale`` or by
    ///     ``matrix``, from the vertices as they were given.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     There is no such object, a key is unknown, or a value not allowed.
    #[pyo3(signature = (name, **keys))]
    fn edit_object(&self, py: Python<'_>, name: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let piece = plain_piece_of(&format!("object {name}"), keys)?;
        self.live.edit(py, |session| {
            let scene = session.prepared().scene();
            let (place, material) = piece.object_change(scene)?;
            let mut objects = scene.objects.clone();
            for index in all_of_object(name, &objects)? {
                let object = &mut objects[index];
                object.material = material.unwrap_or(object.material);
                match place {
                    Some(place) if object.is_movable => object.world_from_local = place,
                    Some(_) => {
                        let message = format!("object {} cannot be moved", object.name);
                        return Err(SceneError::new(message).with_help("add it with movable=True"));
                    }
                    None => {}
                }
            }
            session.edit(Edit::Objects(objects)).map(drop)
        })
    }

    /// Takes an object away; one must stay.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     As in `edit_object`.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     There is no such object, or no other.
    fn remove_object(&self, py: Python<'_>, name: &str) -> PyResult<()> {
        self.live.edit(py, |session| {
            let mut objects = session.prepared().scene().objects.clone();
            let gone = all_of_object(name, &objects)?;
            let mut index = 0..objects.len();
            objects.retain(|_| !index.next().is_some_and(|index| gone.contains(&index)));
            session.edit(Edit::Objects(objects)).map(drop)
        })
    }

    /// Adds a material.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name, which no other material has.
    /// **keys
    ///     As in `Scene.add_material`, but for ``subsurface_table``.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown, a value out of its range, or the name taken.
    #[pyo3(signature = (name, **keys))]
    fn add_material(&self, py: Python<'_>, name: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let piece = piece_of(&format!("material {name}"), keys)?;
        self.live.edit_with_files(py, |session, warnings| {
            let scene = session.prepared().scene();
            if scene.materials.iter().any(|material| material.name == name) {
                return Err(SceneError::new(format!("material {name}: another has that name")));
            }
            let new = Material { name: name.to_owned(), ..Material::default() };
            let (material, images) = piece.material_with_images(scene, &new, warnings)?;
            Ok((images, Edit::AddMaterial(Box::new(material))))
        })
    }

    /// Takes a material away that no object has.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     There is no such material, or an object has it.
    fn remove_material(&self, py: Python<'_>, name: &str) -> PyResult<()> {
        self.live.edit(py, |session| {
            let materials = &session.prepared().scene().materials;
            let index = index_of("material", name, materials.iter().map(|material| material.name.as_str()))?;
            session.edit(Edit::RemoveMaterial(index))?;
            session.edit(Edit::DropUnusedImages).map(drop)
        })
    }

    /// Changes the film, and renders all of it.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in `Scene.set_film`.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_film(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let piece = plain_piece_of("film", keys)?;
        self.live.edit(py, |session| {
            let view = session.view();
            let film = piece.film(*view.film())?;
            session.set_view(View::new(*view.camera(), film, view.seed())?);
            Ok(())
        })
    }

    /// Renders some of the pixels only.
    ///
    /// Parameters
    /// ----------
    /// region : (int, int, int, int), optional
    ///     From (x0, y0) at the upper left to just before (x1, y1); all of them if it is not given.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     The region is empty, or reaches beyond the film.
    #[pyo3(signature = (region=None))]
    fn set_region(&self, py: Python<'_>, region: Option<&Any<'_>>) -> PyResult<()> {
        let region = region.map(region_of).transpose()?;
        self.live.edit(py, |session| {
            let [width, height] = session.view().whole_size();
            session.set_view(session.view().with_region(region.unwrap_or([0, 0, width, height]))?);
            Ok(())
        })
    }

    /// Looks from elsewhere; nothing of the scene is prepared again.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in `Scene.set_camera`.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_camera(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let piece = plain_piece_of("camera", keys)?;
        self.live.edit(py, |session| {
            let camera = piece.in_scene_at(session.prepared().scene().origin).camera()?;
            session.set_view(session.view().with_camera(camera)?);
            Ok(())
        })
    }

    /// Takes other lights in place of all.
    ///
    /// Parameters
    /// ----------
    /// lights : list of dict
    ///     As in `Scene`.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    fn set_lights(&self, py: Python<'_>, lights: &Any<'_>) -> PyResult<()> {
        let read = |(i, light): (usize, PyResult<Any<'_>>)| {
            let light = light?;
            let keys = light.cast::<PyDict>().map_err(|_| {
                PyTypeError::new_err(format!("lights must be dictionaries, but one is {light}"))
            })?;
            plain_piece_of(&format!("light {i}"), Some(keys))
        };
        let pieces: Vec<Piece> = lights.try_iter()?.enumerate().map(read).collect::<PyResult<_>>()?;
        self.live.edit(py, |session| {
            let origin = session.prepared().scene().origin;
            let lights = pieces.into_iter().map(|piece| piece.in_scene_at(origin).light());
            let lights = lights.collect::<Result<_, _>>()?;
            session.edit(Edit::Lights(lights)).map(drop)
        })
    }

    /// Takes another environment.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in `Scene.set_environment`, ``file`` (an image, or an array) among them; without any there is none.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_environment(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let Some(keys) = keys.filter(|keys| !keys.is_empty()) else {
            return self.live.edit(py, |session| session.edit(Edit::Environment(None)).map(drop));
        };
        let piece = piece_of("environment", Some(keys))?;
        self.live.edit_with_files(py, |session, warnings| {
            let scene = session.prepared().scene();
            let (environment, images) = piece.environment_with_images(scene, warnings)?;
            Ok((images, Edit::Environment(Some(environment))))
        })
    }

    /// Changes how paths are traced.
    ///
    /// Parameters
    /// ----------
    /// **keys
    ///     As in `Scene.set_integrator`.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     A key is unknown or missing, or a value not allowed.
    #[pyo3(signature = (**keys))]
    fn set_integrator(&self, py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let piece = plain_piece_of("integrator", keys)?;
        self.live.edit(py, |session| {
            let integrator = piece.integrator(session.prepared().scene().integrator)?;
            session.edit(Edit::Integrator(integrator))?;
            let view = session.view();
            let new = View::new(*view.camera(), *view.film(), integrator.seed)?;
            let PixelRect { left, top, width, height } = view.region();
            session.set_view(new.with_region([left, top, left + width, top + height])?);
            Ok(())
        })
    }

    /// Fewest samples that any pixel has.
    #[getter]
    fn samples(&self, py: Python<'_>) -> u32 {
        let film = self.live.film(py);
        py.detach(|| film.samples())
    }

    /// Whether it runs in the background.
    #[getter]
    fn is_running(&self, py: Python<'_>) -> bool {
        py.detach(|| self.live.is_running())
    }

    /// Width and height of the picture in pixels.
    #[getter]
    fn size(&self, py: Python<'_>) -> (usize, usize) {
        let film = self.live.film(py);
        py.detach(|| {
            let [width, height] = size_of(&film.sums());
            (width, height)
        })
    }

    /// Everything that is not rendered as the scene asks for, in words.
    #[getter]
    fn notes(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.live.facts().notes.clone())
    }

    /// Samples per pixel that the scene states.
    #[getter]
    fn _samples_per_pixel(&self, py: Python<'_>) -> u32 {
        py.detach(|| self.live.facts().samples_per_pixel)
    }

    /// Exposure in stops and tone mapping that the scene's film states.
    #[getter]
    fn _display(&self, py: Python<'_>) -> (f32, &'static str) {
        py.detach(|| {
            let facts = self.live.facts();
            (facts.exposure, facts.tone_mapping)
        })
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (width, height) = self.size(py);
        format!("<translucid.Session of {width}x{height} pixels with {} samples>", self.samples(py))
    }
}

impl Session {
    /// The radiance denoised.
    fn denoised<'py>(&self, py: Python<'py>, film: Arc<LiveFilm>) -> PyResult<Any<'py>> {
        let threads = self.live.threads();
        let denoised = long_work::run_or_leave(py, move || {
            let sums = film.sums().clone();
            let [width, height] = size_of(&sums);
            let denoised = sums.denoise(&Denoiser::load()?, threads)?;
            Ok::<_, translucid_image::OutputError>((
                [height, width, 3],
                denoised.radiance.into_iter().flatten().collect::<Vec<f32>>(),
            ))
        })?;
        let (shape, values) = denoised.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        Ok(values.into_pyarray(py).reshape(shape)?.into_any())
    }
}

/// Width and height.
fn size_of(sums: &FilmSums) -> [usize; 2] {
    [sums.width as usize, sums.height as usize]
}
