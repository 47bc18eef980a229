//! Everything that paths know of a scene, and the light between two points of it.

pub(crate) mod shadow;
