//! The files that a thing names, to be opened when it is whole.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use translucid_words::{Content, Item, Object};

use crate::{Image, ImageKind, Place, SceneError};

/// A file that a scene needs, and where it is asked for.
#[derive(Clone, Debug)]
pub struct FileRequest<K> {
    /// Its path; of an image at hand the name.
    pub path: PathBuf,
    /// Kind of request, which tells it from another request for the same file.
    pub kind: K,
    /// Where it is asked for.
    pub place: Place,
    /// The image, if it is at hand.
    pub image: Option<Arc<Image>>,
}

/// Images and profile tables that a scene is to have after those that it has.
#[derive(Clone, Debug, Default)]
pub struct FileList {
    /// Images, each to be decoded as its kind.
    pub images: Vec<FileRequest<ImageKind>>,
    /// Tables of profiles.
    pub tables: Vec<FileRequest<()>>,
    /// Number of images and of tables that the scene has: the index of a request is its index there.
    before: [usize; 2],
    /// The place of each request in its list; tables are of no kind.
    places: HashMap<(PathBuf, Option<ImageKind>), usize>,
}

impl FileList {
    /// Nothing after so many images and tables of profiles.
    pub fn after(images: usize, tables: usize) -> Self {
        Self { before: [images, tables], ..Self::default() }
    }

    /// Index of an image; the same one of the same kind is loaded once.
    pub fn add_image(&mut self, wanted: FileRequest<ImageKind>) -> usize {
        let (key, new) = ((wanted.path.clone(), Some(wanted.kind)), self.images.len());
        let place = *self.places.entry(key).or_insert(new);
        self.images.extend((place == new).then_some(wanted));
        self.before[0] + place
    }

    /// Index of the image in a file, or of that at hand.
    ///
    /// # Errors
    /// The value is neither.
    pub fn image(&mut self, item: &Item<'_>, kind: ImageKind) -> Result<usize, SceneError> {
        let (path, image) = match item.content() {
            Content::Object(object) => (PathBuf::from(&object.name), image_of(object)),
            _ => (item.file()?, None),
        };
        Ok(self.add_image(FileRequest { path, kind, place: item.place(), image }))
    }

    /// Index of the table of profiles in a file.
    ///
    /// # Errors
    /// The value is no path.
    pub fn table(&mut self, item: &Item<'_>) -> Result<usize, SceneError> {
        let wanted = FileRequest { path: item.file()?, kind: (), place: item.place(), image: None };
        let new = self.tables.len();
        let place = *self.places.entry((wanted.path.clone(), None)).or_insert(new);
        self.tables.extend((place == new).then_some(wanted));
        Ok(self.before[1] + place)
    }
}

/// An image as a value, where the path of a file could stand.
pub fn image_value(image: Arc<Image>) -> Object {
    Object { name: image.name.clone(), data: image }
}

/// The image that a value is.
fn image_of(object: &Object) -> Option<Arc<Image>> {
    Arc::clone(&object.data).downcast().ok()
}
