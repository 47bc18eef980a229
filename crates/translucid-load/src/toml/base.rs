//! The scene that a file extends, as far as it is known when the file is read.

use translucid_scene::{Environment, Scene};

/// That scene.
pub(super) enum Base {
    Unknown,
    Known(Box<Scene>),
}

/// A scene that has whatever a change may need, for the check of a text before its base is known.
pub(super) fn any_base() -> Scene {
    Scene { environment: Some(Environment::default()), ..Scene::default() }
}
