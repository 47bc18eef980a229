//! The state that all pages share: two settings of the scene, how they are looked at, and what was done.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use glam::Vec3;
use serde_json::{Map, Value, json};
use translucid_load::{Orientation, Piece, name_after_preset};
use translucid_scene::{
    Camera, Environment, Film, Image, Integrator, Material, Object, Scene, SceneError, SubsurfaceMethod, Unit,
};

use crate::base::Base;
use crate::clock::Instant;
use crate::json;
use crate::look::Look;
use crate::message::{Edited, Message, Side};
use crate::meter::Meter;
use crate::page_state::PageState;
use crate::settings::Devices;
use crate::value::piece;
use crate::view::Shown;
use translucid_render::FilmLayer;

/// Steps that can be undone.
const MOST_STEPS: usize = 200;

/// Materials in all these steps together, so that a scene of thousands does not fill the memory.
const MOST_MATERIALS: usize = 200_000;

/// Most pixels of the film: what a page can show or, in a browser, what its memory of 4 GiB holds.
const MOST_PIXELS: u64 = if cfg!(target_family = "wasm") { 1 << 22 } else { 1 << 24 };

/// Most images that pages may bring.
const MOST_IMAGES: usize = 16;

/// Most lights to which a page may add one.
const MOST_LIGHTS: usize = 1000;

/// Something moves until so long after the page's last word.
pub(crate) const MOTION_ENDS: Duration = Duration::from_millis(150);

/// Everything that undo brings back.
#[derive(Clone, PartialEq)]
struct Setup {
    base: Arc<Base>,
    looks: [Arc<Look>; 2],
    film: Film,
    camera: Camera,
    is_comparing: bool,
}

/// What is to be rendered and shown.
#[derive(Clone)]
pub(crate) struct Wanted {
    pub(crate) version: u32,
    /// A, and B where it is compared with.
    pub(crate) looks: [Option<Arc<Look>>; 2],
    /// The side that is looked at first.
    pub(crate) active: Side,
    pub(crate) camera: Camera,
    /// How the bare mesh is turned, if the scene is one.
    pub(crate) orientation: Option<Orientation>,
    pub(crate) film: Film,
    pub(crate) shown: Shown,
    pub(crate) is_paused: bool,
    /// Pictures that are not finished are denoised for the display, where something can do it.
    pub(crate) is_denoised: bool,
    /// Who traces the paths.
    pub(crate) device: String,
    /// When the page has said last that it moves something; none once it has let go.
    pub(crate) moving: Option<Instant>,
    /// Images of pages, after the scene's own.
    pub(crate) images: Vec<Arc<Image>>,
}

/// The state, and the one way to change it: [`apply`](Self::apply).
pub(crate) struct Studio {
    unit: Unit,
    /// Images and profile tables of the scene itself.
    own_images: Vec<Arc<Image>>,
    table_count: usize,
    image_facts: Vec<Value>,
    images: Vec<Arc<Image>>,
    setup: Setup,
    edited: Edited,
    shown: Shown,
    is_paused: bool,
    is_denoised: bool,
    /// Names of what can trace paths, the processor first, and the one that does.
    devices: Vec<String>,
    device: usize,
    moving: Option<Instant>,
    origin: Setup,
    done: VecDeque<Setup>,
    undone: Vec<Setup>,
    /// The gesture that the last step belongs to.
    gesture: Option<u64>,
    /// Whether the scene leaves the exposure to a meter, and the meter while it looks.
    is_metered: bool,
    meter: Option<Meter>,
    version: u32,
}

impl Studio {
    /// The state of a scene as it was loaded.
    ///
    /// # Errors
    /// The film is larger than a page can show.
    pub(crate) fn new(
        scene: &Scene,
        orientation: Option<Orientation>,
        is_metered: bool,
    ) -> Result<Self, SceneError> {
        check_size(&scene.film)?;
        let look = Arc::new(Look::of(scene));
        let looks = [Arc::clone(&look), look];
        let base = Arc::new(Base::of(scene, orientation));
        let setup = Setup { base, looks, film: scene.film, camera: scene.camera, is_comparing: false };
        Ok(Self {
            unit: scene.unit,
            own_images: scene.images.clone(),
            table_count: scene.profile_tables.len(),
            image_facts: scene.images.iter().map(|image| json::image(image)).collect(),
            images: Vec::new(),
            origin: setup.clone(),
            setup,
            edited: Edited::A,
            shown: Shown::Layer(FilmLayer::Radiance),
            is_paused: false,
            is_denoised: true,
            devices: vec![Devices::PROCESSOR.to_owned()],
            device: 0,
            moving: None,
            done: VecDeque::new(),
            undone: Vec::new(),
            gesture: None,
            is_metered,
            meter: is_metered.then(Meter::default),
            version: 1,
        })
    }

    pub(crate) fn wanted(&self) -> Wanted {
        Wanted {
            version: self.version,
            looks: self.looks(),
            active: self.edited.sides()[0],
            camera: self.setup.camera,
            orientation: self.orientation(),
            film: self.setup.film,
            shown: self.shown,
            is_paused: self.is_paused,
            is_denoised: self.is_denoised,
            device: self.devices[self.device].clone(),
            moving: self.moving,
            images: self.images.clone(),
        }
    }

    pub(crate) fn version(&self) -> u32 {
        self.version
    }

    pub(crate) fn camera(&self) -> &Camera {
        &self.setup.camera
    }

    pub(crate) fn film(&self) -> &Film {
        &self.setup.film
    }

    pub(crate) fn orientation(&self) -> Option<Orientation> {
        self.setup.base.orientation
    }

    /// Center and radius of what the scene is about.
    pub(crate) fn bounds(&self) -> (Vec3, f32) {
        self.setup.base.bounds
    }

    /// The look that edits concern; of both the first.
    pub(crate) fn active_look(&self) -> &Arc<Look> {
        &self.setup.looks[self.edited.sides()[0] as usize]
    }

    /// A scene with the edits of the active side and without meshes, for one that differs in nothing else.
    pub(crate) fn edited(&self, from: &Scene) -> Scene {
        let look = self.active_look();
        let names = from.objects.iter().map(|object| Object { mesh: Arc::default(), ..object.clone() });
        Scene {
            unit: from.unit,
            origin: from.origin,
            camera: self.setup.camera,
            film: self.setup.film,
            integrator: look.integrator,
            objects: names.collect(),
            materials: look.materials.clone(),
            // Those of options come after those of the base
            images: from
                .images
                .iter()
                .chain(self.own_images.iter().skip(from.images.len()))
                .chain(&self.images)
                .map(Arc::clone)
                .collect(),
            profile_tables: from.profile_tables.clone(),
            lights: look.lights.clone(),
            environment: look.environment,
            files: from.files.clone(),
        }
    }

    /// The state as pages receive it, with notes and the command.
    pub(crate) fn state(&self, notes: &[String], command: &str) -> PageState {
        let parts = [
            ("camera", json::camera(&self.setup.camera)),
            ("cameras", json!([{ "name": "scene", "camera": json::camera(&self.setup.base.camera) }])),
            ("bounds", json::bounds(self.bounds())),
            ("orientation", json!(self.orientation().map(json::orientation))),
            ("film", json::film(&self.setup.film)),
            ("compare", json!(self.setup.is_comparing)),
            ("active", json!(self.edited.name())),
            ("view", json!(self.shown.name())),
            ("paused", json!(self.is_paused)),
            ("denoise", json!(self.is_denoised)),
            ("device", json!(self.devices[self.device])),
            ("undo", json!(!self.done.is_empty())),
            ("redo", json!(!self.undone.is_empty())),
            ("notes", json!(notes)),
            ("images", json!(self.image_facts)),
            ("command", json!(command)),
        ];
        PageState {
            version: self.version,
            parts: parts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect(),
            looks: self.looks(),
        }
    }

    /// A, and B where it is compared with.
    fn looks(&self) -> [Option<Arc<Look>>; 2] {
        let [a, b] = &self.setup.looks;
        [Some(Arc::clone(a)), self.setup.is_comparing.then(|| Arc::clone(b))]
    }

    /// Does what a message asks for. Of those that only ask something, nothing.
    ///
    /// # Errors
    /// A value is out of its range, or there is no such thing; nothing has changed then.
    pub(crate) fn apply(&mut self, message: Message) -> Result<(), SceneError> {
        let moved = self.moving.take();
        match message {
            Message::Material { index, set, gesture } => {
                let set_preset = set.get("preset").and_then(Value::as_str).map(str::to_owned);
                self.edit(gesture, |studio, look| {
                    require("material", index, look.materials.len())?;
                    let set = piece(&format!("material {}", look.materials[index].name), set.clone());
                    let name = studio.name_after(set_preset.as_deref(), look, index);
                    look.materials[index] =
                        Material { name, ..studio.edited_material(&look.materials[index], &set)? };
                    Ok(())
                })?;
            }
            Message::Light { index, light, gesture } => {
                let light = piece(&format!("light {index}"), light).light()?;
                self.edit(gesture, |_, look| {
                    require("light", index, look.lights.len())?;
                    look.lights[index] = light;
                    Ok(())
                })?;
            }
            Message::AddLight { light } => self.add_light(light)?,
            Message::RemoveLight { index } => {
                self.edit(None, |_, look| {
                    require("light", index, look.lights.len())?;
                    look.lights.remove(index);
                    Ok(())
                })?;
            }
            Message::Environment { environment, gesture } => {
                let environment = environment.map(|keys| self.environment(keys)).transpose()?;
                self.edit(gesture, |_, look| {
                    look.environment = environment;
                    Ok(())
                })?;
            }
            Message::Integrator { set, gesture } => {
                let set = piece("integrator", set);
                self.edit(gesture, |_, look| {
                    look.integrator = set.integrator(look.integrator)?;
                    check_method(&look.integrator)
                })?;
            }
            Message::Film { set, gesture } => {
                let film = piece("film", set).film(self.setup.film)?;
                check_size(&film)?;
                self.change(gesture, |setup| setup.film = film);
            }
            Message::Camera { camera, moving, gesture } => {
                let camera = piece("camera", camera).camera()?;
                self.moving = moving.then(Instant::now);
                self.change(gesture, |setup| setup.camera = camera);
            }
            Message::Undo {} => {
                self.step(|studio| studio.done.pop_back(), |studio, now| studio.undone.push(now));
            }
            Message::Redo {} => {
                self.step(|studio| studio.undone.pop(), |studio, now| studio.done.push_back(now));
            }
            Message::Reset {} => {
                let origin = self.origin.clone();
                self.change(None, |setup| *setup = origin);
                self.meter = self.is_metered.then(Meter::default);
            }
            Message::Compare { on } => {
                self.change(None, |setup| {
                    if on && !setup.is_comparing {
                        setup.looks[1] = Arc::clone(&setup.looks[0]);
                    }
                    setup.is_comparing = on;
                });
            }
            Message::Side { side } => {
                if side != Edited::A && !self.setup.is_comparing {
                    return Err(SceneError::new("there is no side B: nothing is compared")
                        .with_help("begin a comparison first"));
                }
                self.edited = side;
            }
            Message::Swap {} => self.change(None, |setup| setup.looks.swap(0, 1)),
            Message::Show { view } => {
                let names = || Shown::ALL.map(Shown::name).join(", ");
                self.shown = Shown::from_name(&view).ok_or_else(|| {
                    SceneError::new(format!("view is {view:?}, but must be one of {}", names()))
                })?;
            }
            Message::Pause { on } => self.is_paused = on,
            Message::Denoise { on } => self.is_denoised = on,
            Message::Device { name } => {
                let number = self.devices.iter().position(|known| *known == name);
                self.device = number.ok_or_else(|| {
                    let names = self.devices.join(", ");
                    SceneError::new(format!("the device is {name:?}, but must be one of {names}"))
                })?;
            }
            // A renderer that has gone on already is not disturbed
            Message::Settled {} if moved.is_none_or(|last| last.elapsed() >= MOTION_ENDS) => return Ok(()),
            Message::Settled {} | Message::Frame {} => {}
            Message::Orient { .. }
            | Message::Pick { .. }
            | Message::Profile { .. }
            | Message::Numbers { .. }
            | Message::Painted { .. } => {
                return Ok(());
            }
        }
        self.settle();
        Ok(())
    }

    /// Lets pages choose from devices, beginning with the first one of a start.
    pub(crate) fn set_devices(&mut self, devices: &Devices) {
        self.devices.extend(devices.names.iter().cloned());
        let by_script = devices.by_script.as_ref().filter(|device| device.is_first);
        let first = devices.first.as_ref().map(|device| device.name());
        let first = first.or(by_script.map(|device| device.name.as_str()));
        self.device = first.and_then(|name| self.devices.iter().position(|known| known == name)).unwrap_or(0);
    }

    /// Turns the bare mesh: the camera, lights and environment that were made for it are made anew.
    ///
    /// # Errors
    /// It is another scene so.
    pub(crate) fn turn(&mut self, base: Base, gesture: Option<u64>) -> Result<(), SceneError> {
        let before = Arc::clone(&self.setup.base);
        if base.materials != before.materials {
            let message =
                format!("the scene has {} materials so, but had {}", base.materials, before.materials);
            return Err(
                SceneError::new(message).with_help("begin anew with it: the mesh, or its floor, is another")
            );
        }
        self.change(gesture, |setup| {
            for look in &mut setup.looks {
                before.follow(&base, Arc::make_mut(look));
            }
            if setup.camera == before.camera {
                setup.camera = base.camera;
            }
            setup.base = Arc::new(base);
        });
        self.settle();
        Ok(())
    }

    /// Whether the exposure is that of the pictures.
    pub(crate) fn is_metering(&self) -> bool {
        self.meter.is_some()
    }

    /// Takes the exposure that was metered of a picture with so many samples, here and wherever it was the same.
    pub(crate) fn meter(&mut self, exposure: f32, samples: u32, is_last: bool) {
        self.meter = self.meter.and_then(|meter| meter.after_picture(samples, is_last));
        let before = self.setup.film.exposure;
        let steps = self.done.iter_mut().chain(&mut self.undone);
        for setup in steps.chain([&mut self.setup, &mut self.origin]) {
            if setup.film.exposure == before {
                setup.film.exposure = exposure;
            }
        }
    }

    /// Looks from a camera that is known to be valid.
    pub(crate) fn set_camera(&mut self, camera: Camera) {
        self.change(None, |setup| setup.camera = camera);
        self.settle();
    }

    /// Makes an image that a page has brought the environment's.
    ///
    /// # Errors
    /// There are too many.
    pub(crate) fn add_environment(&mut self, image: Image) -> Result<(), SceneError> {
        if self.images.len() >= MOST_IMAGES {
            return Err(SceneError::new(format!(
                "this session has {MOST_IMAGES} images from pages, which is the most"
            ))
            .with_help("save the scene and begin anew"));
        }
        let number = self.image_count();
        self.image_facts.push(json::image(&image));
        self.images.push(Arc::new(image));
        self.edit(None, |_, look| {
            let old = look.environment.filter(|environment| environment.image.is_some());
            look.environment = Some(Environment { image: Some(number), ..old.unwrap_or_default() });
            Ok(())
        })?;
        self.settle();
        Ok(())
    }

    /// What follows from every change.
    fn settle(&mut self) {
        self.version = self.version.wrapping_add(1);
        if !self.setup.is_comparing {
            self.edited = Edited::A;
            if self.shown.compares() {
                self.shown = Shown::Layer(FilmLayer::Radiance);
            }
        }
    }

    fn add_light(&mut self, keys: Map<String, Value>) -> Result<(), SceneError> {
        let light = piece("the new light", keys).light()?;
        self.edit(None, |_, look| {
            if look.lights.len() >= MOST_LIGHTS {
                return Err(SceneError::new(format!(
                    "the scene has {} lights, and a page adds one to less than {MOST_LIGHTS}",
                    look.lights.len()
                )));
            }
            look.lights.push(light);
            Ok(())
        })
    }

    /// An environment by its keys, but for the image, which is one of the session's by its number.
    fn environment(&self, mut keys: Map<String, Value>) -> Result<Environment, SceneError> {
        let image = keys.remove("image").unwrap_or_default();
        let number = image.as_u64().and_then(|number| usize::try_from(number).ok());
        if number.is_none() && !image.is_null() {
            let message =
                format!("environment: image is {image}, but must be the number of an image or null");
            return Err(SceneError::new(message));
        }
        let environment = Environment { image: number, ..piece("environment", keys).environment()? };
        environment.validate(self.image_count())?;
        Ok(environment)
    }

    fn edited_material(&self, old: &Material, set: &Piece) -> Result<Material, SceneError> {
        let new = set.material(old, self.unit)?;
        new.validate(self.image_count(), self.table_count)?;
        Ok(new)
    }

    /// The name of a material that is given a preset, or not: others have other names, now and in the file that a saved scene
    /// extends.
    fn name_after(&self, preset: Option<&str>, look: &Look, index: usize) -> String {
        let Some(preset) = preset else { return look.materials[index].name.clone() };
        let origin = &self.origin.looks[0].materials;
        let all = look.materials.iter().zip(origin).enumerate();
        let others = all.filter(|(other, _)| *other != index);
        let others = others.flat_map(|(_, (now, then))| [now.name.as_str(), then.name.as_str()]);
        name_after_preset(&origin[index], self.unit, preset, others).to_owned()
    }

    /// Number of the scene's images and those of pages.
    fn image_count(&self) -> usize {
        self.own_images.len() + self.images.len()
    }

    /// Changes the looks that edits concern, all of them or, after an error, none.
    fn edit(
        &mut self,
        gesture: Option<u64>,
        edit: impl Fn(&Self, &mut Look) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        let mut looks = self.setup.looks.clone();
        for side in self.edited.sides() {
            edit(self, Arc::make_mut(&mut looks[*side as usize]))?;
        }
        self.change(gesture, |setup| setup.looks = looks);
        Ok(())
    }

    /// Changes what undo brings back, as a step of its own unless it belongs to the gesture of the last one.
    fn change(&mut self, gesture: Option<u64>, change: impl FnOnce(&mut Setup)) {
        let before = self.setup.clone();
        change(&mut self.setup);
        if self.setup == before {
            return;
        }
        self.disturb_meter(&before);
        if gesture.is_none() || gesture != self.gesture {
            self.done.push_back(before);
            let materials = self.setup.looks[0].materials.len().max(1);
            while self.done.len() > MOST_STEPS.min(MOST_MATERIALS / materials).max(4) {
                self.done.pop_front();
            }
        }
        self.gesture = gesture;
        self.undone.clear();
    }

    /// Lets the meter know of a change: it does not meddle with a choice, and looks anew where the mesh has turned.
    fn disturb_meter(&mut self, before: &Setup) {
        let is_chosen = |setup: &Setup| setup.film.exposure != self.origin.film.exposure;
        self.meter = match self.meter {
            _ if self.setup.film.exposure != before.film.exposure => None,
            _ if self.is_metered
                && self.setup.base.orientation != before.base.orientation
                && !is_chosen(&self.setup) =>
            {
                Some(Meter::default())
            }
            meter => meter.and_then(Meter::after_change),
        };
    }

    fn step(&mut self, take: impl FnOnce(&mut Self) -> Option<Setup>, keep: impl FnOnce(&mut Self, Setup)) {
        if let Some(setup) = take(self) {
            let now = std::mem::replace(&mut self.setup, setup);
            self.disturb_meter(&now);
            keep(self, now);
            self.gesture = None;
        }
    }
}

fn require(what: &str, index: usize, count: usize) -> Result<(), SceneError> {
    if index < count {
        return Ok(());
    }
    Err(SceneError::new(format!("{what} {index} is not there: the scene has {count}, counted from 0")))
}

fn check_size(film: &Film) -> Result<(), SceneError> {
    if u64::from(film.width) * u64::from(film.height) <= MOST_PIXELS {
        return Ok(());
    }
    let (width, height) = (film.width, film.height);
    let message = format!("the film has {width}x{height} pixels, but a page shows at most {MOST_PIXELS}");
    Err(SceneError::new(message).with_help("choose a smaller size"))
}

/// Points take long to lay, and a worker would hear nothing meanwhile.
fn check_method(integrator: &Integrator) -> Result<(), SceneError> {
    if cfg!(target_family = "wasm") && integrator.subsurface_method == SubsurfaceMethod::PointBased {
        return Err(SceneError::new("subsurface_method is point-based, which a browser is too slow for")
            .with_help("render the saved scene with translucid render --subsurface-method point-based"));
    }
    Ok(())
}
