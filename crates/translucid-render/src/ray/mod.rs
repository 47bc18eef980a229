//! Rays, triangles and the hierarchy over them: what a ray meets.

mod body;
mod clearance;
mod facets;
mod geometry;
mod groups;
mod primitive;
mod triangle;
mod wide_tree;

pub(crate) use body::{Body, FlightEnd, Inside};
pub(crate) use facets::{Beyond, Crossing};
pub(crate) use geometry::SurfacePoint;
pub use geometry::{Geometry, Hit};
pub use triangle::Ray;
