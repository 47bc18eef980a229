//! Tests of the fits, and of the profiles that they gave, against the exact half space.

mod gamma;
mod gaussian_fits;
mod oblique;
mod refined;
mod scaling_fits;
mod similarity;
