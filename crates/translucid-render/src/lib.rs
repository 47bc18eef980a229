//! A path tracer that renders subsurface scattering with approximate reflectance profiles.
//!
//! # Units
//! Lengths in the scene's unit, colors linear Rec. 709, angles in radians unless a name says degrees.
//!
//! # Out of scope
//! Reading scenes (`translucid-scene`) and the profiles' mathematics (`translucid-profile`).

mod bsdf;
mod film;
mod frame;

pub use bsdf::{
    Bsdf, BsdfSample, BsdfValue, EntryBsdf, Ggx, GlassTable, Lobe, MaterialTables, MetalFresnel, MetalTable,
    ReflectanceTable, SurfaceParameters, fresnel_dielectric, scaled_ior,
};
pub use film::{FilmSums, PixelSample, TILE_SIZE, TileSums, layer};
pub use frame::Frame;
