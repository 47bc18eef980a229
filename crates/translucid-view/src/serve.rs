//! A page that a server serves.

use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use translucid_render::PreparedScene;
use translucid_scene::{Scene, SceneError};

use crate::engine::Engine;
use crate::server::Server;
use crate::settings::Settings;
use crate::shared::Shared;

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
