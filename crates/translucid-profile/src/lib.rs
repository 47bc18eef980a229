//! Placeholder until the profile's files arrive.

/// How light enters the medium in the profile's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Configuration {
    /// A pencil beam enters perpendicularly.
    Searchlight,
    /// Light enters at a point with a cosine distribution (the talk's "diffuse transmission").
    #[default]
    Diffuse,
}

/// Which length a profile is built from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Parameterization {
    /// Mean free path ℓ in the volume.
    #[default]
    Mfp,
    /// Diffuse mean free path ℓ_d on the surface.
    Dmfp,
}
