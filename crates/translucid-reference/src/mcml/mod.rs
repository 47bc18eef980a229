//! MCML's files: `.mci`, which describe runs, and `.mco`, which hold what came out.
//!
//! The format is that of MCML 1.2 (L. Wang, S. L. Jacques and L. Zheng, *MCML: Monte Carlo modeling of light transport in
//! multi-layered tissues*, 1995), whose file version is 1.0. Lengths are in centimeters, coefficients in 1/cm.
//!
//! # Out of scope
//! Files themselves: text goes in, text comes out. The format of MCML 2.0, whose file version is `mcmli2.0`.

mod c_numbers;
mod mci;
mod mco;

pub use mci::{MciLayer, MciRun, parse_mci};
pub use mco::{Mco, McoFigure};

#[cfg(test)]
mod judge;
