//! Everything that connections and the renderer exchange.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
#[cfg(not(target_family = "wasm"))]
use std::time::Duration;

use serde_json::{Value, json};
use tokio::sync::watch;
use translucid_image::{DENOISER_VARIABLE, Denoiser, OutputError};
use translucid_load::Orientation;
use translucid_render::{FilmSums, ImageInfo, LiveFilm, Picker, View};
use translucid_scene::{Image, Scene, SceneError};

use crate::base::Base;
use crate::json;
use crate::message::Side;
use crate::page_state::PageState;
use crate::settings::{Devices, Settings};
use crate::studio::{Studio, Wanted};

/// A picture on its way to the pages.
#[derive(Clone)]
pub(crate) struct Frame {
    pub(crate) number: u32,
    /// Header and codes, as `PROTOCOL.md` says.
    pub(crate) bytes: Arc<[u8]>,
}

/// One side as it is rendered now.
#[derive(Clone)]
pub(crate) struct SideFilm {
    pub(crate) view: View,
    pub(crate) film: Arc<LiveFilm>,
    pub(crate) seconds: f64,
}

/// Latest values of everything that pages are told.
pub(crate) struct Shared {
    studio: Mutex<Studio>,
    changed: Condvar,
    /// Asks the renderer to look at the studio again.
    pub(crate) stop: AtomicBool,
    pub(crate) hello: String,
    pub(crate) state: watch::Sender<Arc<PageState>>,
    pub(crate) status: watch::Sender<Arc<str>>,
    /// Side A, side B, their comparison.
    pub(crate) frames: [watch::Sender<Option<Frame>>; 3],
    films: Mutex<[Option<SideFilm>; 2]>,
    notes: Mutex<Vec<String>>,
    /// What is to be said of the image that a page brought last.
    image_notes: Mutex<Vec<String>>,
    picker: Mutex<Picker>,
    /// The bare mesh as it was turned last, until the renderer takes it.
    turned: Mutex<Option<(Orientation, Scene)>>,
    /// The scene as it was loaded, but for its geometry and images: what edits are told from.
    pub(crate) origin: Scene,
    object_names: Vec<(String, usize)>,
    pub(crate) settings: Settings,
    /// Denoises pictures that are not finished, where it is installed.
    pub(crate) denoiser: Option<Denoiser>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    pub(crate) fn new(
        scene: &Scene,
        picker: Picker,
        notes: Vec<String>,
        settings: Settings,
    ) -> Result<Self, SceneError> {
        let denoiser = Denoiser::load();
        let orientation = settings.mesh.as_ref().map(|mesh| mesh.orientation);
        let mut studio = Studio::new(scene, orientation, settings.is_metered)?;
        studio.set_devices(&settings.devices);
        let mut hello = json::hello(&settings.name, scene);
        hello["denoiser"] = denoiser_for_people(&denoiser);
        let devices: Vec<_> = std::iter::once(Devices::PROCESSOR)
            .chain(settings.devices.names.iter().map(String::as_str))
            .collect();
        hello["devices"] = json!(devices);
        Ok(Self {
            hello: hello.to_string(),
            turned: Mutex::new(None),
            state: watch::Sender::new(Arc::new(studio.state(&notes, &settings.render_command()))),
            studio: Mutex::new(studio),
            changed: Condvar::new(),
            stop: AtomicBool::new(false),
            status: watch::Sender::new(Arc::from(
                r#"{"type":"status","phase":"preparing","detail":"","sides":{"a":null,"b":null},"difference":null}"#,
            )),
            frames: std::array::from_fn(|_| watch::Sender::new(None)),
            films: Mutex::new([None, None]),
            notes: Mutex::new(notes),
            image_notes: Mutex::default(),
            picker: Mutex::new(picker),
            origin: Scene {
                objects: Vec::new(),
                images: Vec::new(),
                profile_tables: scene.profile_tables.clone(),
                ..scene.clone()
            },
            object_names: scene.objects.iter().map(|object| (object.name.clone(), object.material)).collect(),
            settings,
            denoiser: denoiser.ok(),
        })
    }

    /// Changes the studio and tells everybody; the version from which on it counts.
    pub(crate) fn change(
        &self,
        change: impl FnOnce(&mut Studio) -> Result<(), SceneError>,
    ) -> Result<u32, SceneError> {
        let mut studio = locked(&self.studio);
        let before = studio.version();
        change(&mut studio)?;
        if studio.version() != before {
            self.publish(&studio);
            self.stop.store(true, Ordering::Relaxed);
            self.changed.notify_all();
        }
        Ok(studio.version())
    }

    /// Reads the studio.
    pub(crate) fn studio<T>(&self, read: impl FnOnce(&Studio) -> T) -> T {
        read(&locked(&self.studio))
    }

    /// The state that the renderer shall go for; nothing asks it to look again before the studio changes.
    pub(crate) fn take_wanted(&self) -> Wanted {
        let studio = locked(&self.studio);
        self.stop.store(false, Ordering::Relaxed);
        studio.wanted()
    }

    /// Waits until the studio has another version, at most so long.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn wait(&self, version: u32, longest: Duration) {
        let studio = locked(&self.studio);
        drop(self.changed.wait_timeout_while(studio, longest, |studio| studio.version() == version));
    }

    fn publish(&self, studio: &Studio) {
        let notes = [&self.notes, &self.image_notes].map(|notes| locked(notes).clone()).concat();
        let command = self.settings.render_command();
        self.state.send_replace(Arc::new(studio.state(&notes, &command)));
    }

    /// Sets what is said of a brought image, from the next change on.
    pub(crate) fn set_image_notes(&self, notes: Vec<String>) {
        *locked(&self.image_notes) = notes;
    }

    /// Everything that is not rendered as it was asked for.
    pub(crate) fn set_notes(&self, notes: Vec<String>) {
        let studio = locked(&self.studio);
        if *locked(&self.notes) != notes {
            *locked(&self.notes) = notes;
            self.publish(&studio);
        }
    }

    /// The scene with the edits of the active side, as a scene file.
    ///
    /// # Errors
    /// The base is not there any more, or is another scene now.
    pub(crate) fn scene_text(&self) -> Result<String, SceneError> {
        let orientation = self.studio(Studio::orientation);
        let from = (self.settings.load_base)(orientation)?;
        let (to, now) = self.studio(|studio| (studio.edited(&from), studio.orientation()));
        if now != orientation {
            return self.scene_text();
        }
        let image = to.environment.and_then(|environment| environment.image);
        let brought =
            image.filter(|image| *image >= from.images.len()).and_then(|image| to.images.get(image));
        let mut base = self.settings.base.clone();
        if let Some(Orientation { up, rotate }) = orientation {
            base.mesh.up = Some(up);
            base.mesh.rotate = rotate;
        }
        base.write(&from, &to, brought.map(|image| file_of(image)).as_deref())
    }

    /// Turns the bare mesh.
    ///
    /// # Errors
    /// The scene is none, or cannot be loaded any more.
    pub(crate) fn turn(&self, orientation: Orientation, gesture: Option<u64>) -> Result<u32, SceneError> {
        let scene = self.load_turned(orientation)?;
        let base = Base::of(&scene, Some(orientation));
        *locked(&self.turned) = Some((orientation, scene));
        self.change(|studio| studio.turn(base, gesture))
    }

    /// The bare mesh turned so, as its scene is shown.
    ///
    /// # Errors
    /// As [`turn`](Self::turn).
    pub(crate) fn take_turned(&self, orientation: Orientation) -> Result<Scene, SceneError> {
        match locked(&self.turned).take() {
            Some((known, scene)) if known == orientation => Ok(scene),
            _ => self.load_turned(orientation),
        }
    }

    fn load_turned(&self, orientation: Orientation) -> Result<Scene, SceneError> {
        let Some(mesh) = &self.settings.mesh else {
            return Err(SceneError::new("the scene is no bare mesh, and cannot be turned")
                .with_help("turn objects in its file, by their key rotate"));
        };
        let size = self.studio(|studio| [studio.film().width, studio.film().height]);
        (mesh.load)(orientation, size)
    }

    /// Answers to `pick` are from this geometry on.
    pub(crate) fn set_picker(&self, picker: Picker) {
        *locked(&self.picker) = picker;
    }

    /// The exposure of a picture that is to be metered, which becomes that of the film.
    pub(crate) fn meter(&self, film: &FilmSums, is_last: bool) -> Option<f32> {
        if film.samples() == 0 || !self.studio(Studio::is_metering) {
            return None;
        }
        let exposure = film.display_picture(&ImageInfo::default()).metered_exposure().ok()?;
        let mut studio = locked(&self.studio);
        // A choice may have come meanwhile
        if !studio.is_metering() {
            return None;
        }
        studio.meter(exposure, film.samples(), is_last);
        self.publish(&studio);
        Some(exposure)
    }

    pub(crate) fn side(&self, side: Side) -> Option<SideFilm> {
        locked(&self.films)[side as usize].clone()
    }

    pub(crate) fn set_films(&self, films: [Option<SideFilm>; 2]) {
        *locked(&self.films) = films;
    }

    /// The answer to a `pick`.
    pub(crate) fn picked(&self, id: Option<u32>, [x, y]: [f32; 2]) -> Value {
        let view = self.side(Side::A).map(|side| side.view);
        let picked = view.as_ref().and_then(|view| locked(&self.picker).pick(view, [x, y]));
        let object = picked.map(|picked| &self.object_names[picked.object]);
        let values = |side: Side| {
            let film = self.side(side)?.film;
            let sums = film.sums();
            let is_there = sums.samples() > 0;
            let is_inside = x >= 0.0 && y >= 0.0 && x < sums.width as f32 && y < sums.height as f32;
            (is_there && is_inside).then(|| {
                let mean = sums.mean(x as u32, y as u32);
                json::layers(|layer| layer.values_of(&mean))
            })
        };
        json!({
            "type": "picked",
            "id": id,
            "x": x,
            "y": y,
            "object": object.map(|(name, _)| name),
            "material": object.map(|(_, material)| material),
            "position": picked.map(|picked| picked.position.to_array()),
            "distance": picked.map(|picked| picked.distance),
            "sides": { "a": values(Side::A), "b": values(Side::B) },
        })
    }
}

/// The path of an image of the command's, or the name of one that a page has brought.
fn file_of(image: &Image) -> String {
    let path = image.path.as_deref().and_then(|path| std::path::absolute(path).ok());
    path.map_or_else(|| image.name.clone(), |path| path.display().to_string())
}

/// A denoiser by its name, or how to get one, and more about that.
fn denoiser_for_people(denoiser: &Result<Denoiser, OutputError>) -> Value {
    let (text, hint) = match denoiser {
        Ok(denoiser) => (denoiser.name().to_owned(), String::new()),
        Err(_) if cfg!(target_family = "wasm") => (String::from("none in a browser alone"), String::new()),
        // A path that somebody has given, and that is wrong
        Err(error) if std::env::var_os(DENOISER_VARIABLE).is_some_and(|path| !path.is_empty()) => {
            (format!("none: {}", error.message), error.help.clone().unwrap_or_default())
        }
        Err(error) => (String::from("none: pip install pyoidn"), error.message.clone()),
    };
    json!({ "text": text, "hint": hint })
}
