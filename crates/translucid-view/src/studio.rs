//! The state that all pages share: two settings of the scene, how they are looked at, and what was done.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use serde_json::{Map, Value, json};
use translucid_load::Piece;
use translucid_scene::{
    Camera, Environment, Film, Image, Integrator, Material, Object, Scene, SceneError, SubsurfaceMethod, Unit,
};

use crate::clock::Instant;
use crate::json;
use crate::look::Look;
use crate::message::{Edited, Message, Side};
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
    image_count: usize,
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
    version: u32,
}

impl Studio {
    /// The state of a scene as it was loaded.
    ///
    /// # Errors
    /// The film is larger than a page can show.
    pub(crate) fn new(scene: &Scene) -> Result<Self, SceneError> {
        check_size(&scene.film)?;
        let look = Arc::new(Look::of(scene));
        let looks = [Arc::clone(&look), look];
        let setup = Setup { looks, film: scene.film, camera: scene.camera, is_comparing: false };
        Ok(Self {
            unit: scene.unit,
            image_count: scene.images.len(),
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
            version: 1,
        })
    }

    pub(crate) fn wanted(&self) -> Wanted {
        Wanted {
            version: self.version,
            looks: self.looks(),
            active: self.edited.sides()[0],
            camera: self.setup.camera,
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
            images: from.images.iter().chain(&self.images).map(Arc::clone).collect(),
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
                self.edit(gesture, |studio, look| {
                    require("material", index, look.materials.len())?;
                    let set = piece(&format!("material {}", look.materials[index].name), set.clone());
                    look.materials[index] = studio.edited_material(&look.materials[index], &set)?;
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
            Message::Pick { .. }
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
        let number = self.image_count + self.images.len();
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
        environment.validate(self.image_count + self.images.len())?;
        Ok(environment)
    }

    fn edited_material(&self, old: &Material, set: &Piece) -> Result<Material, SceneError> {
        let new = set.material(old, self.unit)?;
        new.validate(self.image_count + self.images.len(), self.table_count)?;
        Ok(new)
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

    fn step(&mut self, take: impl FnOnce(&mut Self) -> Option<Setup>, keep: impl FnOnce(&mut Self, Setup)) {
        if let Some(setup) = take(self) {
            let now = std::mem::replace(&mut self.setup, setup);
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

#[cfg(test)]
mod tests {
    use translucid_load::{LoadOptions, still_life};
    use translucid_scene::Pixels;

    use super::*;
    use crate::message::Numbered;

    fn studio() -> Studio {
        Studio::new(&still_life(&LoadOptions::default()).unwrap()).unwrap()
    }

    fn say(studio: &mut Studio, text: &str) -> Result<(), SceneError> {
        studio.apply(Numbered::parse(text).message.unwrap())
    }

    fn radius(studio: &Studio, side: usize) -> f32 {
        studio.setup.looks[side].materials[2].subsurface_radius.factor
    }

    fn set_radius(studio: &mut Studio, radius: f32, gesture: u32) {
        let text = format!(
            r#"{{"type":"material","index":2,"set":{{"subsurface_radius":{radius}}},"gesture":{gesture}}}"#
        );
        say(studio, &text).unwrap();
    }

    #[test]
    fn gestures_are_steps_of_undo() {
        let mut studio = studio();
        let first = radius(&studio, 0);
        for (value, gesture) in [(1.0, 1), (1.5, 1), (2.0, 1), (3.0, 2), (4.0, 2)] {
            set_radius(&mut studio, value, gesture);
        }
        assert_eq!(studio.done.len(), 2);
        let undo = |studio: &mut Studio| say(studio, r#"{"type":"undo"}"#).unwrap();
        undo(&mut studio);
        assert_eq!(radius(&studio, 0), 2.0);
        undo(&mut studio);
        assert_eq!(radius(&studio, 0), first);
        undo(&mut studio);
        assert_eq!(radius(&studio, 0), first);
        for _ in 0..2 {
            say(&mut studio, r#"{"type":"redo"}"#).unwrap();
        }
        assert_eq!(radius(&studio, 0), 4.0);
        // The same gesture after an undo is a step of its own, and forgets what was undone
        undo(&mut studio);
        set_radius(&mut studio, 9.0, 2);
        assert!(studio.undone.is_empty() && studio.done.len() == 2);
        say(&mut studio, r#"{"type":"reset"}"#).unwrap();
        assert_eq!(radius(&studio, 0), first);
        undo(&mut studio);
        assert_eq!(radius(&studio, 0), 9.0);
    }

    #[test]
    fn edits_concern_the_active_side() {
        let mut studio = studio();
        let first = radius(&studio, 0);
        assert!(say(&mut studio, r#"{"type":"side","side":"b"}"#).is_err());
        say(&mut studio, r#"{"type":"compare","on":true}"#).unwrap();
        say(&mut studio, r#"{"type":"side","side":"b"}"#).unwrap();
        set_radius(&mut studio, 5.0, 1);
        assert_eq!([0, 1].map(|side| radius(&studio, side)), [first, 5.0]);
        say(&mut studio, r#"{"type":"show","view":"flip"}"#).unwrap();
        say(&mut studio, r#"{"type":"swap"}"#).unwrap();
        assert_eq!([0, 1].map(|side| radius(&studio, side)), [5.0, first]);
        say(&mut studio, r#"{"type":"compare","on":false}"#).unwrap();
        let wanted = studio.wanted();
        assert!(wanted.looks[1].is_none() && wanted.active == Side::A && !wanted.shown.compares());
    }

    #[test]
    fn wrong_edits_change_nothing_and_say_what_is_allowed() {
        let mut studio = studio();
        let before = studio.state(&[], "").message(None);
        for (text, words) in [
            (r#"{"type":"material","index":99,"set":{}}"#, "material 99 is not there"),
            (r#"{"type":"material","index":2,"set":{"subsurface_color":2}}"#, "must be in [0, 1]"),
            (
                r#"{"type":"material","index":2,"set":{"subsurface_colour":1}}"#,
                "it has no key subsurface_colour",
            ),
            (
                r#"{"type":"material","index":2,"set":{"base_color":{"file":"/etc/passwd"}}}"#,
                "no further images",
            ),
            (r#"{"type":"material","index":2,"set":{"geometry_normal":"/etc/passwd"}}"#, "no further images"),
            (
                r#"{"type":"material","index":2,"set":{"subsurface_table":"/etc/passwd"}}"#,
                "no further tables",
            ),
            (r#"{"type":"film","set":{"size":[16384,16384]}}"#, "but a page shows at most"),
            (r#"{"type":"film","set":{"exposure":99}}"#, "must be in [-32, 32]"),
            (r#"{"type":"integrator","set":{"samples_per_pixel":0}}"#, "samples_per_pixel is 0"),
            (
                r#"{"type":"environment","environment":{"radiance":[1,1,1],"image":3,"rotation":0,"visible":true}}"#,
                "image",
            ),
            (
                r#"{"type":"light","index":0,"light":{"type":"sphere","center":[0,0,0],"radius":-1,"radiance":[1,1,1],"visible":true}}"#,
                "light 0: radius is -1, but must be in (0, 1e10]",
            ),
            (
                r#"{"type":"camera","camera":{"position":[0,0,0],"target":[0,0,0],"up":[0,1,0],"fov":40,"shift":[0,0],"lens_radius":0,"focus_distance":1}}"#,
                "target",
            ),
            (r#"{"type":"show","view":"everything"}"#, "must be one of radiance"),
        ] {
            let error = say(&mut studio, text).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
        assert_eq!(studio.state(&[], "").message(None), before);
    }

    #[test]
    fn preset_keeps_the_name() {
        let mut studio = studio();
        let name = studio.active_look().materials[2].name.clone();
        say(&mut studio, r#"{"type":"material","index":2,"set":{"preset":"jade"}}"#).unwrap();
        let material = &studio.active_look().materials[2];
        assert_eq!(material.name, name);
        assert!(material.subsurface_color.texture.is_none() && !material.subsurface_color.vertex_color);
    }

    #[test]
    fn images_of_pages_light_the_scene() {
        let mut studio = studio();
        let image = || Image {
            name: "sky.hdr".into(),
            path: None,
            width: 1,
            height: 1,
            color_space: translucid_scene::ColorSpace::Linear,
            pixels: Pixels::Float(vec![[1.0; 4]]),
        };
        studio.add_environment(image()).unwrap();
        assert_eq!(studio.active_look().environment.unwrap().image, Some(0));
        for _ in 1..MOST_IMAGES {
            studio.add_environment(image()).unwrap();
        }
        assert!(studio.add_environment(image()).is_err());
    }

    /// A page's messages, to be broken.
    const MESSAGES: [&str; 10] = [
        r#"{"type":"material","index":3,"set":{"subsurface_radius":0.5,"subsurface_color":[0.5,0.4,0.3]},"gesture":1}"#,
        r#"{"type":"material","index":4,"set":{"preset":"jade","subsurface_model":"dipole"}}"#,
        r#"{"type":"light","index":0,"light":{"type":"sphere","center":[0,30,9],"radius":3,"radiance":[9,9,9],"visible":true}}"#,
        r#"{"type":"environment","environment":{"radiance":[1,1,1],"image":null,"rotation":30,"visible":false}}"#,
        r#"{"type":"integrator","set":{"samples_per_pixel":2,"subsurface_sharing":false,"seed":7}}"#,
        r#"{"type":"film","set":{"exposure":1.5,"tone_mapping":"agx","size":[24,16]}}"#,
        r#"{"type":"camera","camera":{"position":[0,20,70],"target":[0,9,0],"up":[0,1,0],"fov":40,"shift":[0,0],"lens_radius":0,"focus_distance":60}}"#,
        r#"{"type":"compare","on":true}"#,
        r#"{"type":"side","side":"b"}"#,
        r#"{"type":"undo"}"#,
    ];

    /// More than 100,000 are read, most of them refused; whatever is not leaves a state that is valid.
    #[test]
    fn mutated_messages_are_refused_or_valid() {
        let mut scene = still_life(&LoadOptions::default()).unwrap();
        let mut studio = Studio::new(&scene).unwrap();
        let (mut read, mut applied) = (0, 0);
        for text in MESSAGES {
            for bytes in translucid_testing::mutants(text.as_bytes(), 10_500) {
                read += 1;
                let message = Numbered::parse(&String::from_utf8_lossy(&bytes)).message;
                if message.is_ok_and(|message| studio.apply(message).is_ok()) {
                    applied += 1;
                    scene.camera = *studio.camera();
                    scene.film = studio.setup.film;
                    let look = studio.active_look();
                    scene.materials.clone_from(&look.materials);
                    scene.lights.clone_from(&look.lights);
                    scene.environment = look.environment;
                    scene.integrator = look.integrator;
                    let parts = [scene.camera.validate(), scene.film.validate(), scene.integrator.validate()];
                    let materials = (0..scene.materials.len()).map(|i| scene.validate_material(i));
                    let lights = (0..scene.lights.len()).map(|i| scene.validate_light(i));
                    let all = parts
                        .into_iter()
                        .chain(materials)
                        .chain(lights)
                        .chain([scene.validate_environment()]);
                    all.for_each(|result| result.unwrap());
                }
            }
        }
        assert!(read > 100_000 && applied > 100 && applied < read / 2, "{applied} of {read}");
        assert!(studio.done.len() <= MOST_STEPS);
    }
}
