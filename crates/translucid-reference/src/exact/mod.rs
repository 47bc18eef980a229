//! The exact half space of isotropic scatterers (g = 0).

mod directions;
mod dispersion;
mod h_function;
mod half_space;
mod inversion;
mod macdonald;
mod single_scattering;

pub use half_space::HalfSpace;
pub(crate) use single_scattering::Entrance;
pub use single_scattering::SingleScattering;

/// A radius as the formulas need it: at least the least normal number; NaN counts as 0.
fn positive_radius(r: f64) -> f64 {
    if r > f64::MIN_POSITIVE { r.min(f64::MAX) } else { f64::MIN_POSITIVE }
}
