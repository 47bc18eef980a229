//! The path tracer: next-event estimation and multiple importance sampling at every vertex.
//!
//! ```text
//! loop
//!   follow the ray to the nearest surface or light; add its emission, weighted by MIS
//!   at a surface: add light from one sampled light, weighted by MIS
//!   draw the next event; where the camera sees a translucent surface, follow a reflection beside the light from below:
//!     a direction            → go on from here
//!     subsurface scattering  → draw the entry point by a probe, add light from one sampled light there,
//!                              draw a cosine direction, go on from there
//!                              (or find the light in another way, see `subsurface::transport`)
//! ```
//!
//! With `caustics` off, clear surfaces let light that falls on a matte surface pass straight through, with
//! their Fresnel transmittance and color: shadow rays of matte surfaces pass, and so do paths from there
//! on. Later reflections of such *soft* paths are roughened. No energy is dropped, but no light is
//! focused. MIS is right only if shadow rays and paths pass the same surfaces.

mod emission;
mod shadow_catcher;
mod tracer;
mod vertex;

pub(crate) use tracer::PathTracer;
