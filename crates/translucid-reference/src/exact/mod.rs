//! The exact half space of isotropic scatterers (g = 0).

mod dispersion;
mod h_function;
mod inversion;
mod macdonald;
