//! Everything that connections and the renderer exchange.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
#[cfg(not(target_family = "wasm"))]
use std::time::Duration;

use glam::Vec3;
use serde_json::{Value, json};
use tokio::sync::watch;
use translucid_image::Denoiser;
use translucid_render::{LiveFilm, Picker, View};
use translucid_scene::{Scene, SceneError};

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
    picker: Picker,
    /// Center and radius of what the scene is about.
    pub(crate) bounds: (Vec3, f32),
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
        let denoiser = Denoiser::load().ok();
        let mut studio = Studio::new(scene)?;
        studio.set_devices(&settings.devices);
        let bounds = bounds(scene, &picker);
        let mut hello = json::hello(&settings.name, scene, (bounds.0.to_array(), bounds.1), &scene.camera);
        hello["denoises"] = json!(denoiser.is_some());
        let devices: Vec<_> = std::iter::once(Devices::PROCESSOR)
            .chain(settings.devices.names.iter().map(String::as_str))
            .collect();
        hello["devices"] = json!(devices);
        Ok(Self {
            hello: hello.to_string(),
            bounds,
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
            picker,
            origin: Scene {
                objects: Vec::new(),
                images: Vec::new(),
                profile_tables: scene.profile_tables.clone(),
                ..scene.clone()
            },
            object_names: scene.objects.iter().map(|object| (object.name.clone(), object.material)).collect(),
            settings,
            denoiser,
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
        let notes = locked(&self.notes);
        let command = self.settings.render_command();
        self.state.send_replace(Arc::new(studio.state(&notes, &command)));
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
        let from = (self.settings.load_base)()?;
        let to = self.studio(|studio| studio.edited(&from));
        let image = to.environment.and_then(|environment| environment.image);
        let brought =
            image.filter(|image| *image >= from.images.len()).and_then(|image| to.images.get(image));
        self.settings.base.write(&from, &to, brought.map(|image| image.name.as_str()))
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
        let picked = view.as_ref().and_then(|view| self.picker.pick(view, [x, y]));
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

/// A sphere around everything that is translucent or, where nothing is, around everything.
fn bounds(scene: &Scene, picker: &Picker) -> (Vec3, f32) {
    let is_translucent =
        |object: &&translucid_scene::Object| scene.materials[object.material].has_subsurface();
    let boxes = scene.objects.iter().filter(is_translucent).map(|object| object.mesh.bounds());
    let translucent = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (low, high) = translucent.unwrap_or_else(|| picker.bounds());
    (0.5 * (low + high), 0.5 * (high - low).length())
}
