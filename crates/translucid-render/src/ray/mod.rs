//! Rays, triangles and the hierarchy over them: what a ray meets.

mod geometry;
mod primitive;
mod triangle;
mod wide_tree;

pub(crate) use geometry::SurfacePoint;
pub use geometry::{Geometry, Hit};
pub use triangle::Ray;
