//! `translucid view`: a page that renders a scene live in the browser while its materials and lights are edited.
//!
//! ```text
//! page ⇄ socket → Studio (state, undo) → Engine (renderer's thread) → frames → page
//! ```
//!
//! One server, one renderer, one state: all pages that are open show the same. `PROTOCOL.md` beside this crate's manifest
//! says what pages and server exchange.
//!
//! # Safety
//! It listens on this machine only, and answers nobody who does not know the token in its address, comes by another name
//! or from another site. A page can name no file: what it brings comes as bytes, within limits, to loaders that are made for
//! hostile ones. Every message is checked before it changes anything.
//!
//! # Out of scope
//! The command line, and messages on a terminal (`translucid-cli`).

mod engine;
mod json;
mod look;
mod message;
mod numbers;
mod page;
mod page_state;
mod profile_panel;
mod server;
mod shared;
mod studio;
mod value;
mod view;

use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use translucid_load::ExtendedBase;
use translucid_render::PreparedScene;
use translucid_scene::{Scene, SceneError};

use engine::Engine;
use server::Server;
use shared::Shared;

/// The scene's origin, as pages and saved files state it.
pub struct Settings {
    /// The scene's name for people.
    pub name: String,
    /// The base that a saved scene extends.
    pub base: ExtendedBase,
    /// Loads that base, to tell what has changed.
    pub load_base: Box<dyn Fn() -> Result<Scene, SceneError> + Send + Sync>,
    /// The command that was given, as pictures state it.
    pub command: String,
    /// Options that a command needs besides a saved scene.
    pub options: String,
}

impl Settings {
    /// The name without folder and extension.
    fn stem(&self) -> String {
        let last = self.name.rsplit(['/', '\\']).next().unwrap_or_default();
        let stem = last.rsplit_once('.').map_or(last, |(stem, _)| stem).replace(' ', "-");
        if stem.is_empty() { "scene".to_owned() } else { stem }
    }

    /// Name of a saved scene.
    fn scene_file(&self) -> String {
        format!("{}-look.toml", self.stem())
    }

    /// The command that renders a saved scene.
    fn render_command(&self) -> String {
        let separator = if self.options.is_empty() { "" } else { " " };
        format!("translucid render {}{separator}{}", self.scene_file(), self.options)
    }
}

/// Something that keeps a page from being served.
#[derive(Debug)]
pub enum ViewError {
    /// The scene cannot be shown.
    Scene(SceneError),
    /// The port is taken, or a thread cannot be started.
    Io(io::Error),
}

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(f),
            Self::Io(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ViewError {}

impl From<SceneError> for ViewError {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

/// A page that is served, and shows that its scene is being loaded until it is there.
pub struct Page {
    server: Server,
}

impl Page {
    /// Serves at a port of this machine or, for 0, at any that is free.
    ///
    /// # Errors
    /// The port is taken, or a thread cannot be started.
    pub fn serve(port: u16) -> io::Result<Self> {
        Ok(Self { server: Server::start(port)? })
    }

    /// The page's address, which lets in whoever knows it.
    #[must_use]
    pub fn address(&self) -> String {
        self.server.address()
    }

    /// Opens the address in the user's browser.
    ///
    /// # Errors
    /// There is none, or it cannot be started.
    pub fn open(&self) -> io::Result<()> {
        open::that_detached(self.address())
    }

    /// Shows a scene until `quit` is true; renders on the current rayon pool.
    ///
    /// # Errors
    /// The scene is not valid, or its film larger than a page can show.
    pub fn show(&self, scene: Scene, settings: Settings, quit: &AtomicBool) -> Result<(), ViewError> {
        let prepared = PreparedScene::new(scene)?;
        let notes = prepared.notes().iter().map(ToString::to_string).collect();
        let shared = Arc::new(Shared::new(prepared.scene(), prepared.picker(), notes, settings)?);
        self.server.show(Arc::clone(&shared));
        Engine::new(&shared, prepared, quit).run();
        Ok(())
    }
}
