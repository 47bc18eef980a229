//! Conventions of other systems: a material in their numbers, by what each means by "radius".
//!
//! Every system that renders subsurface scattering takes a length, and no two agree what it is.
//! The width d of Burley's profile for a length of 1, by the rule of each system's own code:
//!
//! | rule | A = 0.2 | A = 0.5 | A = 0.8 | A = 0.95 |
//! |---|---|---|---|---|
//! | Blender EEVEE, gray | 0.077 | 0.077 | 0.077 | 0.077 |
//! | Blender Cycles Christensen–Burley since 3.0 | 0.080 | 0.080 | 0.080 | 0.080 |
//! | the same before, SORT, EEVEE beside a white channel | 0.027 | 0.046 | 0.072 | 0.077 |
//! | pbrt-v3 Disney | 0.200 | 0.200 | 0.200 | 0.200 |
//! | MoonRay, Unreal 5.0, RenderMan with `unitLength` 1 | 0.283 | 0.279 | 0.119 | 0.055 |
//! | appleseed | 0.316 | 0.650 | 0.952 | 1.083 |
//! | RISE; random walks and media by the diffuse fit | 0.338 | 0.583 | 0.909 | 0.972 |
//! | Unreal since 5.1 | 0.527 | 1.083 | 1.587 | 1.804 |
//! | Unity HDRP, MaterialX | 1.000 | 1.000 | 1.000 | 1.000 |
//!
//! # What is equal
//! - Systems that draw Burley's profile ([`Equal::Width`]): the width d in each channel. Profile and surface albedo are
//!   then the same function, to the last digit.
//! - Systems that walk or solve a medium ([`Equal::MeanFreePath`]): the transport mean free path ℓ* and the surface
//!   albedo, the anisotropy being 0 except where a system states its own.
//! - From one kind to the other: d = ℓ*/s(A), the fit of Christensen and Burley for the chosen
//!   [`Configuration`](crate::Configuration). This is as good as the fit is ([`scaling`](crate::scaling)).
//!
//! The surface albedo has different names, and media are found for it by inversions of different quality; conversions
//! leave it as it is, but for the random walks of Blender Cycles, which do not return the color that they are told
//! ([`CyclesWalk`]).
//!
//! A channel of length 0 is Lambertian in every system.
//!
//! A [`Conversion`] takes a whole material from one system to others, by the names of its parameters; a [`Preset`] is a
//! material that somebody measured.
//!
//! ```
//! use translucid_profile::Configuration;
//! use translucid_profile::convention::{SurfaceAlbedo, System, Written};
//!
//! # fn main() -> Result<(), translucid_profile::ParameterError> {
//! let find = |name| System::named(name).next().unwrap();
//! let albedo = SurfaceAlbedo::gray(0.8)?;
//! // A diffuse mean free path of 20 with RenderMan's unitLength of 0.1, in scene units
//! let renderman = find("renderman");
//! let channel = renderman.read(&[20.0, 1.0, 0.1], albedo, Configuration::Diffuse)?;
//! // looks in Blender Cycles like this radius
//! let cycles = find("cycles-burley");
//! let Written::Length(radius) = cycles.write(&channel, &cycles.defaults(), Configuration::Diffuse)? else { panic!() };
//! assert!((radius - 2.999).abs() < 0.001);
//! # Ok(())
//! # }
//! ```

mod albedo;
mod channel;
mod conversion;
mod cycles_material;
mod cycles_walk;
mod known;
mod mixed_texels;
mod mixture;
mod multiscatter;
mod parameter;
mod preset;
#[doc(hidden)]
pub mod primaries;
mod rule;
mod skin;
mod system;
mod unit;

#[cfg(test)]
mod tests;

pub use albedo::SurfaceAlbedo;
pub use channel::Channel;
pub use conversion::{
    ArgumentNames, ColorSpaces, Conversion, Converted, ConvertedNumber, Setting, conversion_system_names,
};
pub use cycles_material::{CyclesMaterial, CyclesMethod};
pub use cycles_walk::CyclesWalk;
pub use mixed_texels::TexelMixer;
pub use mixture::MixedChannel;
pub use parameter::{Parameter, Role};
pub use preset::{Preset, PresetGroup, preset, presets};
pub use primaries::{LINEAR_SPACES, rgb_from_rgb};
pub use system::{Equal, Source, System, Written};
pub use unit::Unit;
