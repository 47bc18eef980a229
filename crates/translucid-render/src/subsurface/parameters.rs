//! The appearance of a medium at a point of its surface.

use glam::Vec3;

/// Parameters of light under a surface, per channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subsurface {
    /// Surface albedo A in [0, 1].
    pub(crate) surface_albedo: Vec3,
    /// Length that scales the transport \[L\], 0 where the channel is Lambertian: for a profile the length that the
    /// material states, for a walk the mean free path 1/σ_t.
    pub(crate) length: Vec3,
}

impl Subsurface {
    /// Surface albedo, 0 in channels that do not scatter below the surface.
    pub(crate) fn scattering_albedo(&self) -> Vec3 {
        let of = |c: usize| if self.length[c] > 0.0 { self.surface_albedo[c] } else { 0.0 };
        Vec3::new(of(0), of(1), of(2))
    }
}
