//! What a walk hands to its tally.

/// The face of the medium through which light leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// Where it entered: z = 0, reflectance.
    Reflected,
    /// The far face of a slab: z = thickness, transmittance.
    Transmitted,
}

/// A photon that has left the medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PhotonExit {
    /// Where it left, in mean free paths from the center of the entry; the beam is tilted towards +x.
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

/// What became of a range of photons, besides the exits. Whole numbers: sums are exact in any order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PhotonCounts {
    /// Photons that entered the medium.
    pub(crate) launched: u64,
    /// Photons whose walk ended inside: absorbed, at the reference albedo.
    pub(crate) absorbed: u64,
    /// Collisions, the absorbing one included.
    pub(crate) collisions: u64,
}
