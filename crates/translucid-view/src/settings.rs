//! Where a scene comes from.

use translucid_load::ExtendedBase;
use translucid_scene::{Scene, SceneError};

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
