//! Laws of light as plain functions of single-precision numbers: facets, Fresnel's laws, and the shapes of lights.
//!
//! A law is written once. Processors call it, and the example `laws` writes it in WGSL, as [`WGSL`] has it: for graphics
//! processors, whose last bits differ. What both cannot compute alike, such as a sine, is a function of [`elementary`], with a
//! text for each; tables are behind a trait.
//!
//! **Units.** Directions are unit vectors, lengths those of the scene; radiance and irradiance are linear colors.
//!
//! **Out of scope.** Who calls a law when: paths, queues, the choice among lights. Laws in double precision, which devices lack:
//! rectangles and ellipses have one of each.

pub mod bsdf;
pub mod elementary;

mod beam;
mod conductor;
mod cone;
mod dielectric;
mod directions;
mod distant;
mod frame;
mod ggx;
mod layers;
mod phase_function;
mod receiver;
mod reflectances;
mod shading_normal;
mod sphere;
mod spot;
mod surface;
mod thin_wall;
mod triangle;
mod words;

pub use beam::BeamLight;
pub use conductor::MetalFresnel;
pub use cone::SpotCone;
pub use dielectric::{Refracted, fresnel_dielectric, mirrored, refract, refracted, scaled_ior};
pub use directions::{
    concentric_disk, cosine_hemisphere, one_minus_cos, sample_cosine, uniform_cone, uniform_cone_pdf,
    uniform_sphere, uniform_triangle,
};
pub use distant::DistantLight;
pub use frame::Frame;
pub use ggx::{Ggx, SMOOTH_ALPHA};
pub use layers::{Layers, Tables, glass_kept};
pub use phase_function::HenyeyGreenstein;
pub use receiver::{LightDraw, Receiver, luminance};
pub use reflectances::{
    AVERAGE_ROWS, COAT_ROWS, COLUMNS, GLASS_LEVELS, LOSS_COLUMNS, LOSS_ROWS, ROWS, SMOOTHEST, average_at,
    average_at_both, average_loss_at, deficit_at, grid_value, loss_at, reflectance_at,
};
pub use shading_normal::facing;
pub use sphere::SphereLight;
pub use spot::SpotLight;
pub use surface::SurfaceParameters;
pub use thin_wall::{Slab, roughness_through};
pub use triangle::triangle_importance;
pub use words::Words;

/// All laws in WGSL.
pub const WGSL: &str = concat!(include_str!("elementary.wgsl"), include_str!("laws.wgsl"));
