//! A file that something in a file asks for.

use std::path::PathBuf;

use translucid_scene::Place;

/// A file that a scene needs, and where it is asked for.
#[derive(Clone, Debug)]
pub(super) struct FileRequest<K> {
    pub(super) path: PathBuf,
    /// Kind of request, which tells it from another request for the same file.
    pub(super) kind: K,
    pub(super) place: Place,
}
