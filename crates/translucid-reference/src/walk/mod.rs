//! The Monte Carlo walk: photons through a half space or a slab.

mod at_albedo;
pub(crate) mod boundary;
pub(crate) mod deflection_table;
mod device;
pub(crate) mod edge_search;
mod exit_buffer;
pub(crate) mod instruction_sets;
pub(crate) mod kernel;
pub(crate) mod lanes;
mod layout;
mod measure;
mod npy;
mod npz;
mod orders;
mod photon_exit;
mod photon_ranges;
pub(crate) mod photon_source;
pub(crate) mod photons;
mod pilot;
mod problem;
pub(crate) mod random;
mod run;
mod run_until;
pub(crate) mod scatter;
mod table_error;
mod table_file;
mod trace;
mod weights;
mod white_table;

pub use at_albedo::{AtAlbedo, AtRadius};
pub use device::{Device, DeviceTally, DeviceWalk};
#[cfg(test)]
pub(crate) use instruction_sets::narrower_levels;
pub use layout::{Layout, Region};
#[doc(hidden)]
pub use measure::Walker;
pub use npz::npz_of_numbers;
pub use orders::OrderBins;
pub use photon_exit::Side;
pub(crate) use photon_exit::{PhotonCounts, PhotonExit};
pub use photon_ranges::PhotonRange;
pub use pilot::PilotError;
pub use problem::{Parameters, Problem};
pub use run::Control;
pub use run_until::{Forecast, Goal};
pub use table_error::TableError;
#[cfg(test)]
pub(crate) use trace::trace;
use trace::trace_until;
pub use white_table::WhiteTable;

pub use crate::phase_function::PhaseFunction;
pub use crate::phase_table::PhaseTable;

#[cfg(test)]
mod chi_square;
#[cfg(test)]
mod replay;
#[cfg(test)]
mod trace_against_twin;
#[cfg(test)]
mod trace_angles;
#[cfg(test)]
mod trace_totals;
