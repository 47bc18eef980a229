//! Machines other than the processor that walk photons.

use std::ops::Range;

use super::layout::Layout;
use super::problem::Problem;

/// A machine that walks photons in the processor's place, see [`Control::device`](super::Control::device).
///
/// It follows the same law with other roundings and other random numbers: its photons are as good, and not the same. So
/// photons of devices and of the processor are not added up in one table, while those of two devices are: a photon's walk
/// is to be a function of seed and index on all of them, to the bit.
pub trait Device: Sync {
    /// Walks photons of a seed, in the order of their indices; the first ones where `stops` becomes true, which is asked
    /// some times a second, as `progress` is told how many have ended.
    ///
    /// # Errors
    /// It cannot, for a reason that the user is told.
    fn walk(
        &self,
        walk: &DeviceWalk,
        photons: Range<u64>,
        stops: &dyn Fn() -> bool,
        progress: &dyn Fn(u64),
    ) -> Result<DeviceTally, String>;
}

/// A walk for a device.
#[derive(Clone, Copy, Debug)]
pub struct DeviceWalk<'a> {
    /// Medium and light.
    pub problem: &'a Problem,
    /// Bins of place and order.
    pub layout: &'a Layout,
    /// Probability of surviving a collision, in (0, 1).
    pub reference_albedo: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Photons that a device has walked. Whole numbers: they do not depend on how the work was shared out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceTally {
    /// Photons that entered the medium, all of which have left it or been absorbed.
    pub launched: u64,
    /// Photons that were absorbed.
    pub absorbed: u64,
    /// Collisions, the absorbing ones included.
    pub collisions: u64,
    /// Number of photons that left, and the sum of their orders of scattering, by face, place ([`Layout`]'s ring × sectors +
    /// sector) and bin of orders, the last varying fastest.
    pub exits: Vec<(u64, u64)>,
}

/// Kind of machine whose arithmetic and random numbers the photons of a table have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Machine {
    #[default]
    Processor,
    Device,
}

impl Machine {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Processor => "processor",
            Self::Device => "device",
        }
    }
}
