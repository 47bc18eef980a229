//! A walk's place among shells of other media.

use glam::Vec3;

use crate::surface::{ShellPlace, Shells};

/// Shells of other media around a walk.
#[derive(Clone, Copy)]
pub(super) struct AmongShells<'a> {
    pub(super) shells: Shells<'a>,
    /// The walk's place among them.
    pub(super) place: ShellPlace,
    /// Where the flight under way began: at a collision, or where the walk was reflected or entered.
    pub(super) start: Vec3,
}

impl<'a> AmongShells<'a> {
    /// A walk that begins at the surface, or just below.
    pub(super) fn new(shells: Shells<'a>, start: Vec3) -> Self {
        Self { shells, place: shells.at_surface(), start }
    }
}
