//! Photons that have left the medium, and counts of the others.

/// The face of the medium through which light leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// Face of entry, z = 0: reflectance.
    Reflected,
    /// Far face of a slab, z = thickness: transmittance.
    Transmitted,
}

/// A photon that has left the medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PhotonExit {
    /// Place of exit in mean free paths from the center of the entry; the beam is tilted towards +x.
    pub(crate) x: f32,
    /// See `x`.
    pub(crate) y: f32,
    /// Cosine to the face's normal *inside* the medium, in (0, 1].
    pub(crate) cos_theta: f32,
    /// Number of collisions before; 0 for light that crosses a slab untouched.
    pub(crate) order: u32,
    /// The face.
    pub(crate) side: Side,
}

/// Counts of a range of photons, besides the exits. Whole numbers: sums are exact in any order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PhotonCounts {
    /// Photons that entered the medium.
    pub(crate) launched: u64,
    /// Photons whose walk ended inside: absorbed, at the reference albedo.
    pub(crate) absorbed: u64,
    /// Collisions, the absorbing one included.
    pub(crate) collisions: u64,
}

impl PhotonCounts {
    /// Sum of counts, or nothing where a number does not fit.
    pub(crate) fn checked_add(self, other: Self) -> Option<Self> {
        Some(Self {
            launched: self.launched.checked_add(other.launched)?,
            absorbed: self.absorbed.checked_add(other.absorbed)?,
            collisions: self.collisions.checked_add(other.collisions)?,
        })
    }
}
