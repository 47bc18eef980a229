//! Comparisons of reflectance profiles and of rendered pictures, drawn as figures and laid out as pages.
//!
//! - [`colorimetry`]: colors of spectra.
//! - [`comparison`]: the numbers, of every model against the exact solution.
//! - [`figures`]: the charts, tables and the page of a comparison.
//! - [`Chart`]: curves, points with error bars, histograms and bands over two [`Axis`]es; it becomes an SVG
//!   and a [`DataTable`] of its numbers.
//! - [`Ink`]: the subject of a series; a model has one color, dash pattern and marker in every figure.
//! - [`DataTable`]: words and numbers, as CSV or HTML.
//! - [`picture`]: rendered pictures beside each other, how far they are apart, and a sheet that shows it.
//! - [`stack`]: colors of plane layers over grounds, and swatches of them.
//! - [`judge`]: an engine's picture of a lit shape beside the exact light.
//! - [`oracle`]: tables of light under surfaces, for tests of other programs.
//! - [`residual_chart`]: what fits to a table leave over.
//! - [`skin`]: pigments → layers → color and medium.
//! - [`Page`]: text, charts, pictures and tables as one HTML file that needs nothing else.
//!
//! ```
//! use translucid_laboratory::{Axis, Chart, Ink, Mark, Series};
//! use translucid_profile::{Model, NormalizedDiffusion, Profile};
//!
//! # fn main() -> Result<(), translucid_profile::ParameterError> {
//! let profile = NormalizedDiffusion::from_d(0.5, 1.0)?;
//! let points = (1..100).map(|i| f64::from(i) / 10.0).map(|r| [r, profile.eval(r)]).collect();
//! let mut chart = Chart::new("profile", "Normalized diffusion", Axis::linear("r", "ℓ"), Axis::logarithmic("R(r) ℓ²", ""));
//! chart.series.push(Series::new("A = 0.5", Ink::Model(Model::NormalizedDiffusion), Mark::Line, points));
//! assert!(chart.svg().starts_with("<svg"));
//! # Ok(())
//! # }
//! ```
//!
//! # Units
//! A chart's numbers have the units that its axes name.
//!
//! # Out of scope
//! Writing files: everything here returns text or bytes.

// In WebAssembly, where the reference has no walks, nothing is compared with them.

mod chart;
pub mod colorimetry;
#[cfg(not(target_family = "wasm"))]
pub mod comparison;
mod data_table;
mod drawing;
#[cfg(not(target_family = "wasm"))]
pub mod figures;
#[cfg(not(target_family = "wasm"))]
pub mod judge;
mod markup;
#[cfg(doctest)]
mod model_pages;
#[cfg(not(target_family = "wasm"))]
pub mod oracle;
mod page;
pub mod picture;
mod random;
#[cfg(not(target_family = "wasm"))]
pub mod skin;
pub mod stack;

pub use chart::{Axis, Chart, Ink, Mark, ResidualScale, Residuals, Scale, Series, residual_chart};
pub use page::{Block, Page, Plate, Section};
pub use random::random;
pub use translucid_words::{Cell, DataTable};
