//! Disks of Blender Cycles: what a hit of a probe stands for in its Christensen-Burley.
//!
//! Cycles draws a point of a disk around one of three axes at a distance ρ from P, and finds the surface above and below it
//! within the ball of the channel that was drawn. A hit at the distance r from P weighs
//!
//! ```text
//! p_c(r) / (⅓ Σ_k p_k(ρ)),     times its share w_j among the axes,     w_j = (q_j n·axis_j)² / Σ_i (q_i n·axis_i)²
//! ```
//!
//! with densities p per length where those per area, p/(2πr) and p/(2πρ), would be right, and with all channels in the
//! divisor, also those whose ball the hit is not in. In the mean that is R(r) over the area with a factor
//!
//! ```text
//! f = Σ_j w_j (r/ρ_j) Σ_{k: r ≤ R_m,k} p_k(ρ_j) / Σ_k p_k(ρ_j)
//! ```
//!
//! It is 1 on a plane as far as the shortest of the balls reaches, above 1 on what lies across a thin body, where it makes
//! light that comes through brighter, and below 1 for a long-ranged channel beyond the balls of the others.

use glam::Vec3;

use super::strategy::projected;
use crate::sampling::Frame;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::kernel::CutProfile;

/// Probabilities q of Cycles' probes along the two tangents and the normal.
const PICKS: [f32; 3] = [0.25, 0.25, 0.5];

/// The disks around an exit.
#[derive(Clone, Copy)]
pub(in crate::subsurface::transport) struct Disk {
    frame: Frame,
    /// Channels that scatter.
    active: [bool; 3],
}

impl Disk {
    /// The disks around an exit.
    pub(super) fn of(exit: &ExitPoint<'_>) -> Self {
        let active = exit.subsurface.length.cmpgt(Vec3::ZERO);
        Self { frame: Frame::from_normal(exit.point.geometric_normal), active: active.into() }
    }

    /// Factor f on R for a point at `offset` from the exit with normal `normal`.
    pub(in crate::subsurface::transport) fn factor_in_world(
        &self,
        profiles: &[CutProfile<'_>; 3],
        offset: Vec3,
        normal: Vec3,
    ) -> f32 {
        self.factor(profiles, self.frame.to_local(offset), self.frame.to_local(normal))
    }

    /// The same with both in the exit's frame.
    pub(super) fn factor(&self, profiles: &[CutProfile<'_>; 3], offset: Vec3, normal: Vec3) -> f32 {
        let distance = offset.length();
        let (mut sum, mut shares) = (0.0, 0.0);
        for axis in 0..3 {
            let pdf = PICKS[axis] * normal[axis];
            let (radius, ratio) = projected(offset, axis, distance);
            sum += pdf * pdf * ratio * self.share_within(profiles, radius, distance);
            shares += pdf * pdf;
        }
        if shares > 0.0 { sum / shares } else { 0.0 }
    }

    /// Share of the channels whose ball a distance is in among those that a disk's radius is drawn from.
    fn share_within(&self, profiles: &[CutProfile<'_>; 3], radius: f32, distance: f32) -> f32 {
        let (mut within, mut all) = (0.0, 0.0);
        for (profile, _) in profiles.iter().zip(self.active).filter(|(_, is_active)| *is_active) {
            let pdf = if radius <= profile.longest() { profile.pdf(radius) } else { 0.0 };
            all += pdf;
            within += if distance <= profile.longest() { pdf } else { 0.0 };
        }
        if all > 0.0 { within / all } else { 0.0 }
    }
}
