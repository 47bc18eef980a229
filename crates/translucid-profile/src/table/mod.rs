//! Profiles as tables over the radius, for one surface albedo or for all, and curves through samples.

pub(crate) mod albedo_table;
pub(crate) mod monotone_cell;
mod monotone_cell_f32;
pub(crate) mod precision;
pub(crate) mod profile_rows;
pub(crate) mod radial_table;
mod radial_table_build;
mod sample_curve;
pub(crate) mod sampled_profile;
pub(crate) mod table_profile;
pub(crate) mod table_text;
pub(crate) mod tabulated_profile;
