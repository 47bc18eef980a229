//! Numerical mathematics: quadrature, roots, elementary functions to a chosen accuracy, small matrices.

pub(crate) mod elementary;
pub(crate) mod legendre_panel;
pub(crate) mod monotone_cubic;
pub(crate) mod polynomial;
pub mod quadrature;
pub mod roots;
pub(crate) mod scaled_erfc;
pub(crate) mod slices;
pub mod split_mix;
pub(crate) mod square_matrix;
