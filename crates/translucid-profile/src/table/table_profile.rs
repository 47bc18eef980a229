//! A profile that owns the table that it is read from.

use std::sync::Arc;

use crate::profile::methods_of;
use crate::{AlbedoTable, Profile, ProfileView};

/// The profile of an [`AlbedoTable`] at one surface albedo and length, together with the table: a [`ProfileView`] that
/// borrows nothing; several may share a table.
#[derive(Clone, Debug)]
pub struct TableProfile {
    table: Arc<AlbedoTable>,
    surface_albedo: f64,
    length: f64,
}

impl AlbedoTable {
    /// Makes the profile of a surface albedo A ∈ \[0, 1\] and a length \[L\] and keeps the table in it.
    ///
    /// Both are clamped as [`at`](Self::at) does.
    pub fn into_profile(self, surface_albedo: f64, length: f64) -> TableProfile {
        Self::profile_of_shared(&Arc::new(self), surface_albedo, length)
    }

    /// Makes the profile that [`into_profile`](Self::into_profile) makes, of a table that others use, too.
    pub fn profile_of_shared(table: &Arc<Self>, surface_albedo: f64, length: f64) -> TableProfile {
        TableProfile { table: Arc::clone(table), surface_albedo, length }
    }
}

impl TableProfile {
    fn view(&self) -> ProfileView<'_> {
        self.table.at(self.surface_albedo, self.length)
    }
}

impl Profile for TableProfile {
    methods_of!(|own| own.view(); all);

    fn scale(&self) -> f64 {
        self.view().scale()
    }
}
