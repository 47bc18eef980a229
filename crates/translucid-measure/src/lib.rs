//! Surface albedo and mean free path of a material, from a photograph of light that creeps below its surface.
//!
//! ```text
//! photo.rs          linear pixels
//! cut_noise.rs      what of the dark's noise a file has cut off
//! edge_line.rs      where the card ends, and the light across that line
//! response.rs       how a half space answers stripes of light: its modulation transfer function
//! resolution.rs     samples as fine as a fit needs
//! edge.rs           what a camera sees beside an opaque card: the forward model
//! edge_fit.rs       mean free paths and albedos that explain what a camera has seen
//! least_squares.rs  robust weighted least squares
//! known_shape.rs    a material that explains a picture of a known scene
//! ```

#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as the fits need it"
)]

mod cut_noise;
mod edge;
mod edge_fit;
mod edge_line;
mod known_shape;
mod least_squares;
mod photo;
mod resolution;
mod response;

pub use edge::{Edge, EdgeModel};
pub use edge_fit::{Card, ChannelFit, EdgeFit, EdgeSamples, Interval, Scale};
pub use edge_line::{EdgeLine, NoEdge};
pub use known_shape::{Estimate, Guess, KnownShape, Progress, Request, SEEDS, Unknown};
pub use least_squares::{Minimum, minimize};
pub use photo::Photo;
pub use response::Response;
