//! Progress of loading, for those who wait for it.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::result::Result;

use translucid_scene::SceneError;

/// Progress of loading a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoadProgress {
    /// Objects of a scene file, or nodes of a glTF file, that are there.
    pub done: usize,
    /// Their number.
    pub total: usize,
}

type Hear = dyn Fn(LoadProgress) -> ControlFlow<()> + Send + Sync;

/// Hears how far loading is, and may end it; by default nobody does.
#[derive(Clone, Default)]
pub struct LoadWatch(Option<Arc<Hear>>);

impl LoadWatch {
    pub(crate) const NOBODY: Self = Self(None);

    /// Calls `hear` between objects; with [`ControlFlow::Break`] loading ends with an error.
    pub fn new(hear: impl Fn(LoadProgress) -> ControlFlow<()> + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(hear)))
    }

    /// Reports progress.
    ///
    /// # Errors
    /// It shall end.
    pub(super) fn tell(&self, done: usize, total: usize) -> Result<()> {
        match self.0.as_ref().map(|hear| hear(LoadProgress { done, total })) {
            Some(ControlFlow::Break(())) => Err(SceneError::new("loading was stopped")),
            _ => Ok(()),
        }
    }
}

impl fmt::Debug for LoadWatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "LoadWatch(..)" } else { "LoadWatch" })
    }
}
