//! Light that has entered below one pixel's surface point, shared with the pixels around it.
//!
//! Exits x_1 … x_n of a block of pixels each find an entry point y_i by probes of their own, with an unbiased estimate
//! W_i of 1/p_i(y_i), and the light E_i that arrives there: a shadow ray and a path, which is what costs.
//! Where exits lie closer together than light travels below the surface, all of them could have found all entries, so
//! each takes light from every entry:
//!
//! ```text
//! L_j = Σ_i w_i(y_i) R_j(|x_j − y_i|) W_i E_i,     w_i(y) = g_i(y) / Σ_k g_k(y)
//! ```
//!
//! This is multiple importance sampling with one sample of each of n strategies [Veach & Guibas 1995] and strategies
//! that are known by their contribution weights only [Lin et al. 2022, "Generalized Resampled Importance Sampling"].
//! It is unbiased for any g_i that is positive only where p_i is: g_i is a rational stand-in for exit i's profile (see
//! [`Nearness`]), cut at the same radius as its probes.
//! Near x_j its own g_j grows like R_j, so no weight is larger than without sharing.
//!
//! The sum over i is itself drawn from: a few of its terms, in proportion to g_j W_i w_i E_i and evenly spaced along the
//! running sum, stand for all. What R_j is need be evaluated for these only, so all models and their directions
//! are alike to it.
//!
//! Only exits whose light would have the same bounds share: see [`Kind`].

use glam::Vec3;

use crate::subsurface::kernel::tables::ProfileTables;
use crate::surface::material::Subsurface;

mod nearness;
mod pool;

pub(crate) use nearness::Nearness;
pub(crate) use pool::{Arrival, EntryLight, ExitProfiles, Kind, Pool, Waiting};

/// Mean radius of the widest profile, in pixels, from which on an exit shares.
///
/// Below, an entry is of little use to the neighbors, and which of them lies how near is noise of its own. What counts as
/// a pixel is known before any entry is, so the choice changes no mean.
pub(crate) const LEAST_PIXELS: f32 = 1.5;

/// Whether an exit of these parameters, which the light that leaves is multiplied with a throughput, may share.
///
/// Numbers like the inverse square of its lengths \[L\] and their products have to stay finite, and no profile may be 0
/// where its stand-in is not, as one from a file might.
pub(crate) fn can_share(tables: &ProfileTables, subsurface: &Subsurface, throughput: Vec3) -> bool {
    let Subsurface { length, source, .. } = *subsurface;
    let usual = |c: usize| length[c] <= 0.0 || (1e-8..1e8).contains(&length[c]);
    (0..3).all(usual) && throughput.max_element() > 1e-15 && !tables.is_from_file(source)
}
