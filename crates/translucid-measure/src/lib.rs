//! Surface albedo and mean free path of a material, from photographs of light that creeps below its surface.
//!
//! An [`Experiment`] takes photographs of an edge of light, of a spot, or of a slab that is lit from behind; a [`SceneFit`]
//! takes one of a known scene.
//!
//! ```text
//! options.rs           how a photograph was taken
//! experiment.rs        from photographs of an edge or a spot to a material
//! measurement.rs       the material, with everything that shows how well it was measured
//! resynthesis.rs       the same setup with that material, as a scene
//!
//! linear_photo.rs      pixels in linear numbers
//! exposures.rs         several exposures as one
//! clipping.rs          light that is lost at either end of the range
//! pile_up.rs           values that share the greatest one
//! cut_noise.rs         the part of the dark's noise that a file has cut off
//! calibration.rs       light as reflectance, by something white
//!
//! region.rs            the part of a photograph beside a white card
//! trace.rs             place of the light's shape
//! edge_line.rs         where the card ends, and the light across that line
//! spot_place.rs        where a spot is, and the light around it
//! samples.rs           light by place, in blocks
//! even_light.rs        light that changes along the edge, taken out
//! resolution.rs        samples as fine as a fit needs
//!
//! response.rs          how a piece answers stripes of light: its modulation transfer function
//! slab.rs              that of slabs lit from behind
//! cubic_lagrange.rs    interpolation of their tables
//! edge.rs, spot.rs     forward models: what a camera sees beside an opaque card, and around a spot
//! edge_fit.rs          mean free paths and albedos that explain what a camera has seen beside a card
//! spot_fit.rs          those that explain a spot
//! clusters.rs          means of blocks, and the noise that their differences show
//! robust_least_squares.rs  the search for them, in which outliers lose weight
//! fit.rs               the numbers of a fit
//! similar_medium.rs    media with the same light as isotropic scatterers
//! alternative_model.rs models that are no half space
//! unknown_albedo.rs    intervals where the surface albedo is not known
//! detectability.rs     whether a mean free path can be told from none
//! limitations.rs       limits of a measurement, in sentences
//!
//! scene_fit.rs         the material of a scene, by pictures that the renderer makes
//! scene_material.rs    which material, and where its fit starts
//! known_shape.rs       the method: Newton's steps by noisy pictures
//! unknown.rs           parameters to find
//! ```
//!
//! # Units
//! Lengths are in millimeters where [`Options`] state them, in the unit of the samples for the models and fits, and in that of
//! the scene for a [`SceneFit`].
//!
//! # Out of scope
//! Files: photographs come as pixels.

#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as the fits need it"
)]

mod alternative_model;
mod calibration;
mod clipping;
mod clusters;
mod cubic_lagrange;
mod cut_noise;
mod detectability;
mod edge;
mod edge_fit;
mod edge_line;
mod error;
mod even_light;
mod experiment;
mod exposures;
mod fit;
mod known_shape;
mod limitations;
mod linear_photo;
mod measurement;
mod options;
mod pile_up;
mod recent_curves;
mod region;
mod remark;
mod resolution;
mod response;
mod resynthesis;
mod robust_least_squares;
mod samples;
mod scene_fit;
mod scene_material;
mod similar_medium;
mod slab;
mod spot;
mod spot_fit;
mod spot_place;
mod trace;
mod unknown;
mod unknown_albedo;

pub use alternative_model::AlternativeModel;
pub use edge::{Edge, EdgeModel};
pub use edge_fit::{fit_edge, fit_edge_of};
pub use edge_line::{EdgeLine, NoEdge};
pub use error::MeasureError;
pub use experiment::{Experiment, Photographs};
pub use fit::{Card, ChannelFit, Fit, Interval, Outline, Scale, USUAL_ALBEDO, White};
pub use known_shape::{Estimate, KnownShape, Progress, Request, SEEDS};
pub use linear_photo::{NamedPhoto, Photo};
pub use measurement::{Measurement, Quantity};
pub use options::{Options, Setup};
pub use remark::{CHANNELS, Remark, spelled, three_digits};
pub use response::{Response, Transfer};
pub use resynthesis::{Resynthesis, ResynthesizedPictures};
pub use samples::Samples;
pub use scene_fit::{SceneFit, SceneOptions, StepEnd};
pub use spot::{Spot, SpotModel};
pub use spot_fit::fit_spot;
pub use spot_place::{NoSpot, SpotPlace};
pub use trace::Trace;
pub use unknown::{Guess, Unknown};
