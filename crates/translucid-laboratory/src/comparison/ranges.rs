//! Radii and albedos that errors are stated for.

/// Greatest radii that errors are stated for, in mean free paths.
pub const R_MAX: [f64; 3] = [8.0, 16.0, f64::INFINITY];

/// The surface albedos that the talk takes its means over: 0.01, 0.02, … 0.99.
pub fn talk_albedos() -> Vec<f64> {
    (1..=99).map(|percent| f64::from(percent) / 100.0).collect()
}
