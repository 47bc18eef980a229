//! Light from infinity, as data and by its keys.

use glam::{Mat3, Vec3};

use crate::description::{Counts, Fallback, FileList, Item, Key, SceneSlot, Table, Thing, field};
use crate::{ColorSpace, ImageKind, SceneError};

use Fallback::{Plain, Words};

/// Light from infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Radiance where there is no image; a factor on the image where there is one.
    pub radiance: Vec3,
    /// Latitude–longitude image (index into `Scene::images`); its middle column is seen along −z
    /// of the environment's frame, its top row along +y.
    pub image: Option<usize>,
    /// World direction from environment direction (a rotation).
    pub world_from_environment: Mat3,
    /// Whether the camera sees it; if not the background is black with alpha 0.
    pub visible: bool,
}

/// White light from everywhere, which the camera sees.
impl Default for Environment {
    fn default() -> Self {
        Self { radiance: Vec3::ONE, image: None, world_from_environment: Mat3::IDENTITY, visible: true }
    }
}

const FILE: &[Key] = &[Key::new(
    "file",
    "latitude–longitude image; its middle is seen toward -z, its top toward +y",
    Words("none"),
)];

const RADIANCE: &[Key] = &[Key::new(
    "radiance",
    "color; a factor on the image where there is one",
    Words("must be given without `file`, else 1"),
)];

const ROTATION: &[Key] = &[
    Key::new("rotation", "angle about +y, counter-clockwise from above", Words("0")),
    Key::new("matrix", "in its place any rotation: nine numbers, row by row", Words("none")),
];

impl Environment {
    /// The environment by its keys.
    pub const DESCRIPTION: Thing<Self> = Thing {
        name: "environment",
        doc: "light from all around",
        plain: Self::default,
        fields: &[
            field!(Environment { radiance } => SceneSlot::Radiance(radiance); RADIANCE),
            field!(Environment { image } => SceneSlot::Image(image); FILE),
            field!(Environment { world_from_environment } => SceneSlot::Rotation(world_from_environment); ROTATION),
            field!(Environment { visible } => SceneSlot::Flag(visible),
                "whether the camera sees it other than through bodies and glass; if not the background is black with alpha 0", Plain),
        ],
        rules: &[],
    };

    /// Reads an environment; without a file it has what the table does not name from `base`, if there is one.
    ///
    /// # Errors
    /// A key is unknown, a value not allowed, or neither a radiance nor a file is given.
    pub fn read(table: Table<'_>, base: Option<Self>, files: &mut FileList) -> Result<Self, SceneError> {
        let table = table.allow(&Self::DESCRIPTION.keys())?;
        let named = table.get("file");
        let is_removed = base.is_some() && named.as_ref().is_some_and(Item::is_none);
        let file = named.filter(|_| !is_removed);
        // With an image of its own, or without that of the base, it is a new one
        let base = base.filter(|_| file.is_none() && !is_removed);
        if base.is_none() && file.is_none() {
            table.require("radiance")?;
        }
        let mut read = Self::DESCRIPTION.change(base.unwrap_or_default(), &table, files)?;
        if let Some(item) = file {
            read.image = Some(files.image(&item, ImageKind::Color(ColorSpace::Srgb))?);
        }
        Ok(read)
    }

    /// Checks every field in a scene of so many images.
    ///
    /// # Errors
    /// A radiance is out of its range, there is no image of that index, or the matrix is not a rotation.
    pub fn validate(&self, images: usize) -> Result<(), SceneError> {
        let counts = Counts { images, ..Counts::default() };
        Self::DESCRIPTION.check(self, &counts).map_err(|error| error.within("environment"))
    }
}
