//! The Rust of the pages on models and on the library, as tests.
//!
//! `cargo test --doc` compiles and runs what a page shows; nothing else sees this.

#[doc = include_str!("../../../docs/models/better-dipole.md")]
struct BetterDipole;

#[doc = include_str!("../../../docs/models/dipole.md")]
struct Dipole;

#[doc = include_str!("../../../docs/models/directional-dipole.md")]
struct DirectionalDipole;

#[doc = include_str!("../../../docs/models/exact.md")]
struct Exact;

#[doc = include_str!("../../../docs/models/gaussians.md")]
struct Gaussians;

#[doc = include_str!("../../../docs/models/normalized-diffusion.md")]
struct NormalizedDiffusion;

#[doc = include_str!("../../../docs/models/normalized-diffusion-oblique.md")]
struct NormalizedDiffusionOblique;

#[doc = include_str!("../../../docs/models/normalized-diffusion-refined.md")]
struct NormalizedDiffusionRefined;

#[doc = include_str!("../../../docs/models/photon-beam-diffusion.md")]
struct PhotonBeamDiffusion;

#[doc = include_str!("../../../docs/models/quantized-diffusion.md")]
struct QuantizedDiffusion;

#[doc = include_str!("../../../docs/models/random-walk.md")]
struct RandomWalk;

#[doc = include_str!("../../../docs/models/tables.md")]
struct Tables;

#[doc = include_str!("../../../docs/guide/library.md")]
struct Library;
