//! Rays, triangles and the hierarchy over them: what a ray meets.

mod body;
mod clearance;
mod closed;
mod eight;
mod facets;
mod geometry;
mod groups;
mod hit;
mod instances;
mod primitive;
mod triangle;
mod wide_tree;

pub(crate) use body::{Body, FlightEnd, Inside};
pub(crate) use facets::{Beyond, Crossing};
pub use geometry::Geometry;
pub(crate) use geometry::SurfacePoint;
pub use hit::Hit;
pub use triangle::Ray;
pub(crate) use wide_tree::AT_ONCE as TRIANGLES_AT_ONCE;
