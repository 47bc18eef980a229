//! Reflectance profiles for other people's renderers: text to paste, in the language that the renderer is written in.
//!
//! Formulas are written once, in WGSL (`src/formulas/`), with coefficients that come from the profile crate.
//! A text takes the functions that it offers and those that these call.
//! WGSL has one spelling for everything that the formulas need, so [`Language`] translates them into GLSL, HLSL, MSL,
//! OSL, C and C++ word by word, with their comments and names. naga could write three of these languages; but it drops
//! comments, renames what ends in a digit and flattens expressions into temporaries, and what people paste they want to
//! read. For MaterialX the formulas are run with nodes in the place of numbers.
//!
//! # Units
//! Lengths are in any one unit that the caller keeps to.
//!
//! # Out of scope
//! Files: an export is bytes. Scenes, pictures. In WebAssembly images and transmittances, too.
//!
//! ```
//! use translucid_export::{Export, Language, Sizes, Subject, Target};
//! use translucid_profile::{Configuration, Model};
//!
//! # fn main() -> Result<(), translucid_export::ExportError> {
//! let export = Export {
//!     target: Target::Text(Language::Glsl),
//!     subjects: &[Subject::Sampler],
//!     models: &[Model::NormalizedDiffusion],
//!     material: None,
//!     configuration: Configuration::Diffuse,
//!     g: 0.0,
//!     eta: 1.0,
//!     sizes: Sizes::default(),
//!     command: "an example",
//! };
//! let shader = String::from_utf8_lossy(&export.bytes()?).into_owned();
//! assert!(shader.contains("float burleySample(float u, float d) {"));
//! # Ok(())
//! # }
//! ```

mod curvature_table;
mod disk;
mod error;
mod export;
mod formula;
mod function;
mod header;
#[cfg(not(target_family = "wasm"))]
mod image;
mod image_format;
mod inversion;
mod kernel;
mod language;
mod material;
mod materialx;
mod node_graph;
mod number;
mod subject;
mod sum;
mod symbolic;
mod target;
mod token;
#[cfg(not(target_family = "wasm"))]
mod transmittance;

pub use curvature_table::CurvatureTable;
pub use error::ExportError;
pub use export::{Export, Sizes};
#[doc(hidden)]
pub use formula::directional_formulas;
pub use function::{Function, functions};
pub use image_format::ImageFormat;
pub use language::Language;
pub use material::{Material, Surface};
pub use subject::Subject;
pub use sum::exponentials;
pub use target::Target;
