//! The result that readers return.

use translucid_scene::SceneError;

/// A result whose error is, unless another is named, that of an input.
pub(crate) type Result<T, E = SceneError> = std::result::Result<T, E>;
