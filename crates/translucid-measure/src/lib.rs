//! Surface albedo and mean free path of a material, from a photograph of light that creeps below its surface.
//!
//! ```text
//! photo.rs          linear pixels
//! cut_noise.rs      what of the dark's noise a file has cut off
//! edge_line.rs      where the card ends, and the light across that line
//! resolution.rs     samples as fine as a fit needs
//! spot_place.rs     where a spot is, and the light around it
//! samples.rs        light by place, in blocks
//! response.rs       how a piece answers stripes of light: its modulation transfer function
//! cubic.rs          cubics through the values of a table
//! slab.rs           that of slabs lit from behind
//! edge.rs           what a camera sees beside an opaque card: the forward model
//! spot.rs           what it sees around a spot
//! edge_fit.rs       mean free paths and albedos that explain what a camera has seen beside a card
//! spot_fit.rs       those that explain a spot
//! fit.rs            what a photograph tells
//! clusters.rs       means of blocks, and the noise that their differences tell
//! seen.rs           whether it tells that light creeps
//! least_squares.rs  robust weighted least squares
//! known_shape.rs    a material that explains a picture of a known scene
//! ```

#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as the fits need it"
)]

mod clusters;
mod cubic;
mod cut_noise;
mod edge;
mod edge_fit;
mod edge_line;
mod fit;
mod known_shape;
mod least_squares;
mod photo;
mod resolution;
mod response;
mod samples;
mod seen;
mod slab;
mod spot;
mod spot_fit;
mod spot_place;

pub use edge::{Edge, EdgeModel};
pub use edge_fit::{fit_edge, fit_edge_of};
pub use edge_line::{EdgeLine, NoEdge};
pub use fit::{Card, ChannelFit, Fit, Interval, Outline, Scale};
pub use known_shape::{Estimate, Guess, KnownShape, Progress, Request, SEEDS, Unknown};
pub use least_squares::{Minimum, minimize};
pub use photo::Photo;
pub use response::{Response, Transfer};
pub use samples::Samples;
pub use spot::{Spot, SpotModel};
pub use spot_fit::fit_spot;
pub use spot_place::{NoSpot, SpotPlace};
