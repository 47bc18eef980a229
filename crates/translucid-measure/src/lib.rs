//! Surface albedo and mean free path of a material, from a photograph of light that creeps below its surface.
//!
//! ```text
//! response.rs       how a half space answers stripes of light: its modulation transfer function
//! edge.rs           what a camera sees beside an opaque card: the forward model
//! least_squares.rs  robust weighted least squares
//! ```

mod edge;
mod least_squares;
mod response;

pub use edge::{Edge, EdgeModel};
pub use least_squares::{Minimum, minimize};
pub use response::Response;
