//! The exact half space of isotropic scatterers (g = 0).
