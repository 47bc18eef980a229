//! The profiles of materials.

pub(crate) mod cut;
pub(crate) mod direction;
pub(crate) mod tables;
