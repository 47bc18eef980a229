//! Rays, triangles and the hierarchy over them.

mod binary_tree;
mod body;
mod clearance;
mod facets;
mod geometry;
mod groups;
mod hit;
mod instances;
mod orientation;
mod primitive;
mod simd;
mod triangle;
mod wide_tree;

pub(crate) use binary_tree::BinaryBuilder;
pub(crate) use body::{Body, Depths, FlightEnd, Inside};
pub(crate) use facets::{Crossing, LightOrigin};
pub use geometry::Geometry;
pub(crate) use geometry::SurfacePoint;
pub use hit::Hit;
pub(crate) use hit::offset_at;
pub(crate) use instances::{MeshSharing, Placement};
pub(crate) use orientation::orientation;
pub(crate) use primitive::Primitive;
pub use triangle::Ray;
pub(crate) use wide_tree::AT_ONCE as TRIANGLES_AT_ONCE;
