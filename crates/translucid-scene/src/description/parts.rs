//! The numbers of a scene's things, and the lists that they refer to.

use translucid_words::{Interval, WholeInterval};

/// A number of a thing, with its range.
pub enum Part<'a> {
    /// A number.
    Number(&'a mut f32, Interval),
    /// A whole number.
    Count(&'a mut u32, WholeInterval),
    /// The index of something in the scene.
    Index(&'a mut usize, List),
}

/// A list of a scene that others refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum List {
    /// Its images.
    Images,
    /// Its tables of profiles.
    ProfileTables,
}

/// Number of things in the lists of a scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Number of images.
    pub images: usize,
    /// Number of tables of profiles.
    pub profile_tables: usize,
}
