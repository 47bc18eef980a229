//! Files and documents that the things of a scene name.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

use translucid_scene::description::FileList;
use translucid_scene::{ImageKind, Scene, Warning};

use crate::loading::Loading;

/// The fate of documents that materials name.
#[derive(Clone, Debug, Default)]
pub(super) enum Documents {
    /// They are refused.
    #[default]
    Refused,
    /// They are opened later: of their materials only the keys and the name are read.
    Later,
    /// They are opened, and this was found in them.
    Opened(Vec<Warning>),
}

/// Files that a scene is to have after those that it has.
#[derive(Clone, Debug, Default)]
pub(super) struct NamedFiles {
    pub(super) list: FileList,
    pub(super) documents: Documents,
    /// Documents that materials name, each with the material in it: a warning about one is given once.
    pub(super) named_documents: HashSet<(PathBuf, Option<String>)>,
}

/// Files that things of a scene name, each with its index there.
#[derive(Clone, Debug, Default)]
pub(super) struct KnownFiles {
    pub(super) images: HashMap<(PathBuf, ImageKind), usize>,
    pub(super) tables: HashMap<(PathBuf, ()), usize>,
}

impl NamedFiles {
    /// Nothing after the files of a scene.
    pub(super) fn after(scene: &Scene) -> Self {
        Self { list: FileList::after(scene.images.len(), scene.profile_tables.len()), ..Self::default() }
    }

    /// The list in which documents are opened.
    pub(super) fn opening(self) -> Self {
        Self { documents: Documents::Opened(Vec::new()), ..self }
    }

    /// Takes the warnings about documents, and their names.
    pub(super) fn take_findings(&mut self, loading: &mut Loading<'_>) {
        if let Documents::Opened(found) = &mut self.documents {
            loading.warnings.append(found);
            loading.add_files(self.named_documents.iter().map(|(path, _)| path.clone()));
        }
    }
}
