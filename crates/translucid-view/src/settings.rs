//! Where a scene comes from.

use std::sync::Arc;

use translucid_load::{ExtendedBase, Orientation};
use translucid_render::device::{DeviceLimits, TracingDevice};
use translucid_scene::{Scene, SceneError};

/// The scene's origin, as pages and saved files state it.
pub struct Settings {
    /// The scene's name for people.
    pub name: String,
    /// The base that a saved scene extends.
    pub base: ExtendedBase,
    /// Loads that base, with its mesh turned as asked for, to tell what has changed.
    pub load_base: Box<dyn Fn(Option<Orientation>) -> Result<Scene, SceneError> + Send + Sync>,
    /// The bare mesh that the scene is, if it is one.
    pub mesh: Option<MeshToTurn>,
    /// Whether the exposure is metered until somebody chooses it.
    pub is_metered: bool,
    /// The command that was given, as pictures state it.
    pub command: String,
    /// Options that a command needs besides a saved scene.
    pub options: String,
    /// What can trace paths.
    pub devices: Devices,
}

/// A bare mesh, which pages may turn.
pub struct MeshToTurn {
    /// How it is turned at first.
    pub orientation: Orientation,
    /// Loads the scene as it is shown, turned otherwise, for a film of a width and height.
    pub load: Box<LoadTurned>,
}

/// Loads a scene whose mesh is turned, for a film of a width and height.
pub type LoadTurned = dyn Fn(Orientation, [u32; 2]) -> Result<Scene, SceneError> + Send + Sync;

/// Devices beside the processor, which messages call [`PROCESSOR`](Devices::PROCESSOR).
pub struct Devices {
    /// Names from which a page chooses.
    pub names: Vec<String>,
    /// Opens a device of such a name; the message of the error says why it cannot be used.
    pub open: Box<OpenDevice>,
    /// The device of the start.
    pub first: Option<Arc<dyn TracingDevice>>,
    /// A device that a page's script drives, in a browser.
    pub by_script: Option<ScriptDevice>,
}

/// A device that a page's script drives.
pub struct ScriptDevice {
    /// Its name among those of the devices.
    pub name: String,
    /// How much it holds.
    pub limits: DeviceLimits,
    /// Whether it traces from the start on.
    pub is_first: bool,
}

/// Opens a device of a name.
pub type OpenDevice = dyn Fn(&str) -> Result<Arc<dyn TracingDevice>, String> + Send + Sync;

impl Devices {
    /// The processor's name.
    pub const PROCESSOR: &str = "cpu";
}

impl Default for Devices {
    /// The processor alone.
    fn default() -> Self {
        let open = |name: &str| Err(format!("there is no device {name}"));
        Self { names: Vec::new(), open: Box::new(open), first: None, by_script: None }
    }
}

impl Settings {
    /// The name without folder and extension.
    fn stem(&self) -> String {
        let last = self.name.rsplit(['/', '\\']).next().unwrap_or_default();
        let stem = last.rsplit_once('.').map_or(last, |(stem, _)| stem).replace(' ', "-");
        if stem.is_empty() { "scene".to_owned() } else { stem }
    }

    /// Name of a saved scene.
    pub(crate) fn scene_file(&self) -> String {
        format!("{}-look.toml", self.stem())
    }

    /// Name of a saved picture.
    pub(crate) fn picture_file(&self, extension: &str) -> String {
        format!("{}.{extension}", self.stem())
    }

    /// The command that renders a saved scene.
    pub(crate) fn render_command(&self) -> String {
        let separator = if self.options.is_empty() { "" } else { " " };
        format!("translucid render {}{separator}{}", self.scene_file(), self.options)
    }
}
