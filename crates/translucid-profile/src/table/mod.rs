//! Profiles as tables over the radius, for one surface albedo or for all, and curves through samples.

pub(crate) mod albedo_table;
<<<<<<< HEAD
mod energy_profile;
=======
pub(crate) mod albedo_table_f32;
>>>>>>> profile
pub(crate) mod monotone_cell;
mod monotone_cell_f32;
pub(crate) mod precision;
pub(crate) mod radial_table;
mod radial_table_build;
<<<<<<< HEAD
=======
mod radial_table_f32;
mod sample_curve;
>>>>>>> profile
pub(crate) mod sampled_profile;
pub(crate) mod table_profile;
pub(crate) mod tabulated_profile;
