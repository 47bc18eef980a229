//! A session in a Web Worker, for pages that no server serves.
//!
//! The page's `worker.js` alone calls this module. It asks for room, writes there, calls, and reads the output; it never passes
//! a pointer in. Messages and pictures are those of `PROTOCOL.md`. There is one session, and one thread for everything.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use serde_json::json;
use tokio::sync::watch;
use translucid_gpu::program;
use translucid_load::{ExtendedBase, LoadOptions, Orientation, give_file, load_oriented, still_life};
use translucid_render::PreparedScene;
use translucid_render::device::DeviceLimits;
use translucid_scene::{Scene, SceneError, SubsurfaceMethod, Warning};

use crate::conversation::{Heard, hear, refusal};
use crate::engine::Engine;
use crate::files::{PictureFormat, bring_environment, encode_picture};
use crate::message::Side;
use crate::page_state::PageState;
use crate::settings::{Devices, MeshToTurn, ScriptDevice, Settings};
use crate::shared::{Frame, Shared};

/// Pixels of a film that nobody has chosen: a worker has one thread.
const SIZE: [u32; 2] = [640, 360];

/// Nothing but the worker's own end ends its rendering.
static QUIT: AtomicBool = AtomicBool::new(false);

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Tells of a defect, in UTF-8, which ends this module.
    safe fn fail(text: *const u8, length: usize);
}

#[derive(Default)]
struct Desk {
    input: Vec<u8>,
    output: Vec<u8>,
    session: Option<Session>,
    /// The graphics processor of the session to come.
    device: Option<ScriptDevice>,
}

thread_local! {
    static DESK: RefCell<Desk> = RefCell::default();
}

/// Makes room for the input of the next call.
#[unsafe(no_mangle)]
extern "C" fn input(length: usize) -> *mut u8 {
    DESK.with_borrow_mut(|desk| {
        desk.input.clear();
        desk.input.resize(length, 0);
        desk.input.as_mut_ptr()
    })
}

/// The output of the last call.
#[unsafe(no_mangle)]
extern "C" fn output() -> *const u8 {
    DESK.with_borrow(|desk| desk.output.as_ptr())
}

/// Bytes of the output.
#[unsafe(no_mangle)]
extern "C" fn output_length() -> usize {
    DESK.with_borrow(|desk| desk.output.len())
}

/// Gives the readers a file: a name of so many bytes, then the content.
#[unsafe(no_mangle)]
extern "C" fn give(name: usize) {
    DESK.with_borrow_mut(|desk| {
        let (name, content) = desk.named_input(name);
        give_file(&name, content.to_vec());
    });
}

/// The kernels of pictures and what a script needs to know to have a graphics processor run them, as JSON.
#[unsafe(no_mangle)]
extern "C" fn program() {
    let text = json!({
        "code": program::text(),
        "kernels": program::KERNELS,
        "slots": [program::SLOTS.0, program::SLOTS.1],
        "slotBytes": program::SLOT_BYTES,
        "counters": program::COUNTERS,
        "listCounters": [program::LIST_COUNTERS.start, program::LIST_COUNTERS.end],
        "settings": program::SETTINGS,
        "sampleWords": program::SAMPLE_WORDS,
        "mostRounds": program::MOST_ROUNDS,
    });
    DESK.with_borrow_mut(|desk| desk.output = text.to_string().into_bytes());
}

/// Offers the session to come a graphics processor whose name is the input and whose arrays hold so many bytes.
#[unsafe(no_mangle)]
extern "C" fn offer(array_bytes: f64, is_first: u32) {
    DESK.with_borrow_mut(|desk| {
        let name = String::from_utf8_lossy(&desk.input).into_owned();
        let limits = DeviceLimits { array_bytes: array_bytes as u64 };
        desk.device = Some(ScriptDevice { name, limits, is_first: is_first != 0 });
    });
}

/// Puts the next job of the graphics processor into the output, as words: 1, 0 where there is none, or 2 where its kernels are
/// wanted first.
#[unsafe(no_mangle)]
extern "C" fn job() -> u32 {
    DESK.with_borrow_mut(|desk| {
        let Some(engine) = desk.session.as_mut().map(|session| &mut session.engine) else { return 0 };
        if engine.wants_kernels() {
            return 2;
        }
        let Some(words) = engine.next_job() else { return 0 };
        desk.output = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        1
    })
}

/// Lets the graphics processor trace, whose kernels are made.
#[unsafe(no_mangle)]
extern "C" fn begin() {
    DESK.with_borrow_mut(|desk| desk.session.iter_mut().for_each(|session| session.engine.begin_script()));
}

/// Whether the samples of a job are still of use: 1 or 0.
#[unsafe(no_mangle)]
extern "C" fn wants(job: u32) -> u32 {
    DESK.with_borrow_mut(|desk| {
        desk.session.as_mut().is_some_and(|session| session.engine.wants_job(job)).into()
    })
}

/// Takes the samples of a job, which are the input as words; none where it was given up.
#[unsafe(no_mangle)]
extern "C" fn finish(job: u32) {
    DESK.with_borrow_mut(|desk| {
        let words: Vec<u32> =
            desk.input.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        if let Some(session) = &mut desk.session {
            session.engine.finish_job(job, &words);
        }
    });
}

/// Does without the graphics processor from now on, for the reason that is the input.
#[unsafe(no_mangle)]
extern "C" fn lose() {
    DESK.with_borrow_mut(|desk| {
        let reason = String::from_utf8_lossy(&desk.input);
        if let Some(session) = &mut desk.session {
            session.engine.lose_script(&reason);
        }
    });
}

/// Begins the session with the file of the name that is the input, or the still life: 0, or 1 with the error.
#[unsafe(no_mangle)]
extern "C" fn open() -> u32 {
    std::panic::set_hook(Box::new(|info| {
        let text = info.to_string();
        fail(text.as_ptr(), text.len());
    }));
    DESK.with_borrow_mut(|desk| {
        let name = String::from_utf8_lossy(&desk.input).into_owned();
        let opened = Session::open(&name, desk.device.take()).map(|session| desk.session = Some(session));
        desk.answer(opened.map(|()| Vec::new()))
    })
}

/// Hears a message of the page, which is the input.
#[unsafe(no_mangle)]
extern "C" fn tell() {
    DESK.with_borrow_mut(|desk| {
        let text = String::from_utf8_lossy(&desk.input);
        if let Some(session) = &mut desk.session {
            session.hear(&text);
        }
    });
}

/// Renders for about so many milliseconds; for how many nothing is left to do, unless the page says something.
#[unsafe(no_mangle)]
extern "C" fn step(milliseconds: f64) -> f64 {
    DESK.with_borrow_mut(|desk| {
        let Some(session) = &mut desk.session else { return f64::INFINITY };
        let rest = session.engine.step(Some(Duration::from_secs_f64(milliseconds / 1000.0)));
        rest.map_or(0.0, |rest| rest.as_secs_f64() * 1000.0)
    })
}

/// Puts the next packet for the page into the output: 1 a text, 2 a picture, 0 where there is none.
#[unsafe(no_mangle)]
extern "C" fn take() -> u32 {
    DESK.with_borrow_mut(|desk| match desk.session.as_mut().and_then(Session::next_packet) {
        None => 0,
        Some(Packet::Text(text)) => {
            desk.output = text.into_bytes();
            1
        }
        Some(Packet::Picture(bytes)) => {
            desk.output.clear();
            desk.output.extend_from_slice(&bytes);
            2
        }
    })
}

/// Puts a piece of a sample into the output for another worker to trace, as bytes that only this module reads: 1, or 0 where
/// there is none.
#[unsafe(no_mangle)]
extern "C" fn deal() -> u32 {
    DESK.with_borrow_mut(|desk| match desk.session.as_mut().and_then(|session| session.engine.deal()) {
        None => 0,
        Some(piece) => {
            desk.output = piece;
            1
        }
    })
}

/// Traces the piece of another worker's that is the input, for that one's [`receive`].
#[unsafe(no_mangle)]
extern "C" fn trace() {
    DESK.with_borrow_mut(|desk| {
        if let Some(session) = &mut desk.session {
            desk.output = session.engine.trace(&desk.input);
        }
    });
}

/// Takes a piece that another worker has traced, which is the input.
#[unsafe(no_mangle)]
extern "C" fn receive() {
    DESK.with_borrow(|desk| {
        if let Some(session) = &desk.session {
            session.engine.receive(&desk.input);
        }
    });
}

/// Makes a picture the environment, a name of so many bytes, then the content: 0, or 1 with the error.
#[unsafe(no_mangle)]
extern "C" fn environment(name: usize) -> u32 {
    DESK.with_borrow_mut(|desk| {
        let (name, content) = desk.named_input(name);
        let shared = desk.session.as_ref().map(|session| session.shared);
        let brought = shared.map_or(Ok(()), |shared| bring_environment(shared, &name, content));
        desk.answer(brought.map(|()| Vec::new()))
    })
}

/// Makes a file of the scene (0), or of the picture as OpenEXR (1) or PNG (2) of side A (0) or B (1): 0 with its name, a line
/// break and its content, or 1 with the error.
#[unsafe(no_mangle)]
extern "C" fn save(kind: u32, side: u32) -> u32 {
    DESK.with_borrow_mut(|desk| {
        let side = if side == 0 { Side::A } else { Side::B };
        let made = desk.session.as_ref().map_or(Ok(Vec::new()), |session| session.file(kind, side));
        desk.answer(made)
    })
}

impl Desk {
    /// A name of so many bytes, and what follows it.
    fn named_input(&self, name: usize) -> (String, &[u8]) {
        let (name, content) = self.input.split_at(name.min(self.input.len()));
        (String::from_utf8_lossy(name).into_owned(), content)
    }

    fn answer(&mut self, result: Result<Vec<u8>, SceneError>) -> u32 {
        let (status, output) = match result {
            Ok(output) => (0, output),
            Err(error) => (1, refusal(&error).to_string().into_bytes()),
        };
        self.output = output;
        status
    }
}

/// What a page receives.
enum Packet {
    Text(String),
    Picture(Arc<[u8]>),
}

/// The session, and what the page knows of it.
struct Session {
    shared: &'static Shared,
    engine: Engine<'static>,
    /// Texts to be taken first.
    texts: VecDeque<String>,
    state: watch::Receiver<Arc<PageState>>,
    told: Option<Arc<PageState>>,
    status: watch::Receiver<Arc<str>>,
    frames: [watch::Receiver<Option<Frame>>; 3],
    /// Numbers of pictures that are not on the screen yet.
    on_their_way: [Option<u32>; 3],
}

impl Session {
    fn open(name: &str, device: Option<ScriptDevice>) -> Result<Self, SceneError> {
        let mut warnings = Vec::new();
        let (scene, orientation) = load(name, Some(SIZE), None, &mut warnings)?;
        let prepared = PreparedScene::new(scene)?;
        let notes = prepared.notes().iter().map(ToString::to_string).collect();
        let shared =
            Shared::new(prepared.scene(), prepared.picker(), notes, settings(name, orientation, device))?;
        // For as long as the worker lives, which is that of the session
        let shared: &'static Shared = Box::leak(Box::new(shared));
        let engine = Engine::new(shared, prepared, &QUIT);
        let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let mut session = Self {
            engine,
            texts: VecDeque::from([shared.hello.clone()]),
            state: shared.state.subscribe(),
            told: None,
            status: shared.status.subscribe(),
            frames: std::array::from_fn(|kind| shared.frames[kind].subscribe()),
            on_their_way: [None; 3],
            shared,
        };
        session.state.mark_changed();
        session.status.mark_changed();
        session.frames.iter_mut().for_each(watch::Receiver::mark_changed);
        if !warnings.is_empty() {
            session.texts.push_back(json!({ "type": "warnings", "messages": warnings }).to_string());
        }
        Ok(session)
    }

    fn hear(&mut self, text: &str) {
        let answer = match hear(self.shared, text) {
            Heard::Answer(answer) => answer,
            Heard::Question(question) => question.answer(self.shared),
            Heard::Turn(turn) => turn.answer(self.shared),
            Heard::Painted(frame) => {
                for number in &mut self.on_their_way {
                    number.take_if(|number| *number == frame);
                }
                return;
            }
        };
        // An answer comes after the changes that were made before its question
        let changes = self.changes();
        self.texts.extend(changes);
        self.texts.push_back(answer);
    }

    /// What the page has not been told of the state.
    fn changes(&mut self) -> Option<String> {
        if !self.state.has_changed().unwrap_or(false) {
            return None;
        }
        let state = Arc::clone(&self.state.borrow_and_update());
        let text = state.message(self.told.as_deref());
        self.told = Some(state);
        Some(text)
    }

    /// Texts in their order, then the latest state, report and pictures.
    fn next_packet(&mut self) -> Option<Packet> {
        if let Some(text) = self.texts.pop_front().or_else(|| self.changes()) {
            return Some(Packet::Text(text));
        }
        if self.status.has_changed().unwrap_or(false) {
            return Some(Packet::Text(self.status.borrow_and_update().to_string()));
        }
        for (frames, on_its_way) in self.frames.iter_mut().zip(&mut self.on_their_way) {
            if on_its_way.is_none()
                && frames.has_changed().unwrap_or(false)
                && let Some(frame) = &*frames.borrow_and_update()
            {
                *on_its_way = Some(frame.number);
                return Some(Packet::Picture(Arc::clone(&frame.bytes)));
            }
        }
        None
    }

    /// A file for the page to keep: its name, a line break and its content.
    fn file(&self, kind: u32, side: Side) -> Result<Vec<u8>, SceneError> {
        let settings = &self.shared.settings;
        let (name, content) = match kind {
            0 => (settings.scene_file(), self.shared.scene_text()?.into_bytes()),
            kind => {
                let format = if kind == 1 { PictureFormat::Exr } else { PictureFormat::Png };
                let film = self.shared.side(side).filter(|side| side.film.samples() > 0);
                let film = film.ok_or_else(|| SceneError::new("there is no picture yet"))?;
                let bytes = encode_picture(self.shared, &film, format);
                let bytes = bytes.map_err(|error| SceneError::new(error.to_string()))?;
                (settings.picture_file(format.extension()), bytes)
            }
        };
        Ok([name.as_bytes(), b"\n", &content].concat())
    }
}

/// Loads the file of a name, or the still life where that is empty.
fn load(
    name: &str,
    size: Option<[u32; 2]>,
    turned: Option<Orientation>,
    warnings: &mut Vec<Warning>,
) -> Result<(Scene, Option<Orientation>), SceneError> {
    // A scene file has a size of its own
    let size = size.filter(|_| !name.ends_with(".toml"));
    let options = LoadOptions { size, ..LoadOptions::default() };
    let options = turned.map_or(options.clone(), |turned| turned.apply(options));
    let (mut scene, orientation) = match name {
        "" => (still_life(&options)?, None),
        name => load_oriented(Path::new(name), &options, warnings)?,
    };
    if scene.integrator.subsurface_method == SubsurfaceMethod::PointBased {
        scene.integrator.subsurface_method = SubsurfaceMethod::RayTraced;
        let message = String::from("subsurface_method is ray-traced here: a browser is too slow for points");
        warnings.push(Warning { message, place: None });
    }
    Ok((scene, orientation))
}

fn settings(name: &str, orientation: Option<Orientation>, device: Option<ScriptDevice>) -> Settings {
    let names = device.iter().map(|device| device.name.clone()).collect();
    let [base, mesh] = [name.to_owned(), name.to_owned()];
    let load_at =
        |name: &str, size, turned| load(name, size, turned, &mut Vec::new()).map(|(scene, _)| scene);
    let load_turned = move |orientation, size: [u32; 2]| load_at(&mesh, Some(size), Some(orientation));
    let (name, extends) = if name.is_empty() { ("still life", "still-life") } else { (name, name) };
    Settings {
        name: name.to_owned(),
        base: ExtendedBase { extends: extends.to_owned(), ..ExtendedBase::default() },
        load_base: Box::new(move |turned| load_at(&base, None, turned)),
        mesh: orientation.map(|orientation| MeshToTurn { orientation, load: Box::new(load_turned) }),
        is_metered: orientation.is_some(),
        command: String::from("translucid view, in a browser"),
        options: String::new(),
        devices: Devices { names, by_script: device, ..Devices::default() },
    }
}
