//! The BSDF: scattering of light at the interface of a material.
//!
//! Directions are unit vectors in the local shading frame whose z axis is the shading normal and points
//! out of the object; `wo` goes to where light is carried, `wi` to where it comes from, both away from
//! the surface.
//!
//! From outside in a surface is a coat, then by `metalness` a metal or a dielectric interface, and under
//! that clear transmission, subsurface scattering or a matte base:
//!
//! ```text
//! f = coat + K (metal + specular reflection + transmission) + A T(ωi) T(ωo) / (π T̄)
//! K(ωi, ωo) = min(T_coat(ωi), T_coat(ωo))         reciprocal, never gains energy, exact for a mirror
//! T(ω) = (1 − E_coat(ω)) (1 − E_specular(ω)) + X(ω)       share that passes the interfaces from direction ω
//! T̄ = 2 ∫ T(μ) μ dμ                                so that uniform light sees 1 − T(ωo) + A T(ωo)
//! ```
//!
//! X is the light that `K` takes too much from the specular reflection; it vanishes without a coat.
//! The matte term is the coupling of Kelemen & Szirmay-Kalos (2001, "A Microfacet Based Coupled
//! Specular-Matte BRDF Model with Importance Sampling"): light that the interface does not reflect enters,
//! and A is the albedo of the light that enters. Subsurface scattering is the matte term with A spread over the surface,
//! the BSSRDF `S = T(ωo) R(r) T(ωi) / (π T̄)`, which without an interface is exactly `R / π`.
//!
//! A thin-walled surface has the same layers on both sides, and light that comes through it leaves on the
//! other side: `f = A' T(ωi) T(ωo) / (π T̄)` there, with A' the albedo of transmission, and clear transmission straight on.
//!
//! # Conventions
//! Weights carry *basic* radiance L/n² (n the refractive index where the light is): a lossless crossing
//! keeps its weight 1 both ways. The factor n² cancels for light that enters and leaves.

#[cfg(test)]
mod brute_force;
mod coated_table;
mod glass_table;
#[cfg(test)]
mod judged;
#[cfg(test)]
mod laws;
mod layers;
#[cfg(test)]
mod light_below;
mod reflectance_table;
mod scattering;

pub use glass_table::GlassTable;
pub use layers::{EntryBsdf, MaterialTables};
pub use reflectance_table::{MetalTable, ReflectanceTable};
pub(crate) use scattering::LightBelow;
pub use scattering::{Bsdf, BsdfSample, BsdfValue, Lobe};
pub use translucid_law::{
    Ggx, MetalFresnel, Slab, SurfaceParameters, fresnel_dielectric, refract, sample_cosine, scaled_ior,
};
