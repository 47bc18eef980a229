//! Point-based subsurface scattering: light that enters is computed once at points all over the surface, and
//! light that leaves is a sum over them [Jensen & Buhler 2002, "A Rapid Hierarchical Rendering Technique for
//! Translucent Materials"].
//!
//! ```text
//! plan.rs            how close the points of each subsurface group have to lie, and whether they fit into memory
//! surfels.rs         pass 1: points in blue noise, each with the area that it stands for
//! irradiance.rs      pass 2: transmitted irradiance at each point by the path tracer, as exact as need be
//! cloud.rs           points and their light together
//! smooth_profile.rs  profiles as smooth tables with bounds of their curvature
//! hierarchy.rs       clusters of points: their light and its moments
//! gather.rs          the sum at a point that light leaves, refined until its error bound is small enough
//! words.rs           the same for devices
//! ```
//!
//! One number, `point_tolerance`, drives all: the error of each step is about in proportion to it.

mod cloud;
mod gather;
mod hash_grid;
mod hierarchy;
mod irradiance;
mod patches;
mod plan;
pub(crate) mod smooth_profile;
mod surfels;
pub(crate) mod words;

pub(crate) use cloud::{CloudGroup, PointSettings, serve};
pub use cloud::{PointCloud, PointPass, PointProgress};
pub(crate) use gather::{GatherPoint, GatherScratch, Gatherer};
pub(crate) use plan::PixelWidths;
pub use plan::PointPlan;
