//! The disk probes of Blender Cycles: the weight of a hit in its Christensen-Burley.
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
//! It is 1 on a plane, above 1 across a thin body, where it makes light that comes through brighter, and below 1 there for
//! a long-ranged channel beyond the balls of the others.

use glam::Vec3;

use super::strategy::projected;
use crate::sampling::Frame;
use crate::subsurface::kernel::CutProfile;
use crate::subsurface::parameters::Subsurface;

/// Probabilities q of Cycles' probes along the two tangents and the normal.
const PICKS: [f32; 3] = [0.25, 0.25, 0.5];

/// The disks around an exit.
#[derive(Clone, Copy)]
pub(in crate::subsurface::transport) struct CyclesDisk {
    frame: Frame,
    /// Channels that scatter.
    active: [bool; 3],
}

impl CyclesDisk {
    /// The disks around an exit.
    pub(super) fn of(subsurface: &Subsurface, geometric_normal: Vec3) -> Self {
        let active = subsurface.length.cmpgt(Vec3::ZERO);
        Self { frame: Frame::from_normal(geometric_normal), active: active.into() }
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

    /// [`factor_in_world`](Self::factor_in_world) with both vectors in the exit's frame.
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

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use translucid_profile::{
        AlbedoTable, AlbedoTableF32, Appearance, Configuration, Model, Parameterization,
    };

    use super::super::strategy::ProbeStrategy;
    use super::super::strategy::tests::exit_at_origin;
    use super::*;

    /// The energy beyond 16 d.
    const TAIL: f32 = 0.00362;

    const DRAWS: u32 = 1 << 15;

    fn table() -> AlbedoTableF32 {
        let appearance =
            Appearance { surface_albedo: 0.8, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
        let row = |_| Model::NormalizedDiffusion.profile(&appearance, Configuration::Diffuse, 1.0);
        AlbedoTableF32::from(&AlbedoTable::new(&[0.8], row).expect("a table"))
    }

    fn disk(length: Vec3) -> CyclesDisk {
        CyclesDisk::of(&Subsurface { surface_albedo: Vec3::ONE, length }, exit_at_origin().geometric_normal)
    }

    /// A plane that light has entered.
    struct Plane {
        through: Vec3,
        normal: Vec3,
    }

    impl Plane {
        /// Where a line meets it, as a distance along the line.
        fn met(&self, origin: Vec3, direction: Vec3) -> f32 {
            (self.through - origin).dot(self.normal) / direction.dot(self.normal)
        }
    }

    /// The probes of Cycles, one after the other: an axis, a channel, a radius of its, and the hit by the weight that the
    /// module's head states.
    fn cycles(profiles: &[CutProfile<'_>; 3], frame: &Frame, plane: &Plane) -> Vec3 {
        let normal = frame.to_local(plane.normal);
        let squares: f32 = (0..3).map(|j| (PICKS[j] * normal[j]).powi(2)).sum();
        let mut sum = Vec3::ZERO;
        for i in 0..DRAWS {
            let [of_axis, of_channel, of_radius, of_angle] = sobol_burley::sample_4d(i, 0, 3);
            let axis = if of_axis < 0.5 { 2 } else { usize::from(of_axis < 0.75) };
            let channel = (3.0 * of_channel) as usize;
            let radius = profiles[channel].sample(of_radius);
            let half = (profiles[channel].longest().powi(2) - radius * radius).max(0.0).sqrt();
            let (sin, cos) = (TAU * of_angle).sin_cos();
            let across = frame.axis((axis + 1) % 3) * cos + frame.axis((axis + 2) % 3) * sin;
            let at = plane.met(across * radius, frame.axis(axis));
            if at.abs() > half {
                continue;
            }
            let distance = (across * radius + frame.axis(axis) * at).length();
            let pdf = |profile: &CutProfile<'_>, r: f32| {
                if r <= profile.longest() { profile.pdf(r) } else { 0.0 }
            };
            let of_all: f32 = profiles.iter().map(|profile| pdf(profile, radius)).sum();
            let share = PICKS[axis] * normal[axis].abs() / squares;
            sum += Vec3::from_array(profiles.each_ref().map(|profile| pdf(profile, distance))) * share
                / (of_all / 3.0);
        }
        sum / DRAWS as f32
    }

    /// The mean of our own probes.
    fn ours(profiles: [CutProfile<'_>; 3], disk: &CyclesDisk, plane: &Plane) -> Vec3 {
        let strategy = ProbeStrategy::new(&exit_at_origin(), [0.25, 0.25, 1.0], profiles, [0.5, 0.2, 0.3])
            .expect("shares");
        let bounds = (Vec3::splat(-1e3), Vec3::splat(1e3));
        let normal = strategy.frame.to_local(plane.normal);
        let mut sum = Vec3::ZERO;
        for (i, axis) in (0..DRAWS).flat_map(|i| (0..3).map(move |axis| (i, axis))) {
            let [a, b, c, _] = sobol_burley::sample_4d(i, axis as u32, 5);
            let Some(ray) = strategy.sample(axis, [a, b, c], bounds) else { continue };
            let at = plane.met(ray.origin, ray.direction);
            if (0.0..=ray.t_max).contains(&at) {
                let offset = strategy.frame.to_local(ray.origin + ray.direction * at);
                let weight = strategy.weight(Vec3::ONE, offset, normal);
                sum += weight.value * disk.factor(&profiles, offset, normal);
            }
        }
        sum / DRAWS as f32
    }

    /// The other side of a thin body, parallel to the exit and tilted: both estimates are good to some 0.3 %.
    #[test]
    fn light_across_a_body_is_that_of_the_probes_of_cycles() {
        let table = table();
        let lengths = Vec3::new(2.0, 1.0, 0.6);
        let profiles = lengths.to_array().map(|length| CutProfile::new(table.at(0.8, length), TAIL));
        let disk = disk(lengths);
        for normal in [Vec3::Z, Vec3::new(0.3, 0.2, 0.9).normalize(), Vec3::new(0.9, 0.3, -0.2).normalize()] {
            for depth in [0.5, 3.0, 8.0] {
                let plane = Plane { through: Vec3::NEG_Z * depth, normal };
                let (found, expected) =
                    (ours(profiles, &disk, &plane), cycles(&profiles, &disk.frame, &plane));
                for c in 0..3 {
                    let (found, expected) = (found[c], expected[c]);
                    let least = 0.015 * expected + 2e-4;
                    assert!((found - expected).abs() < least, "{normal} {depth}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn a_plane_is_as_bright_as_by_areas() {
        let table = table();
        let lengths = Vec3::new(2.0, 1.0, 0.0);
        let profiles = [2.0, 1.0, 1.0].map(|length| CutProfile::new(table.at(0.8, length), TAIL));
        for r in [0.0, 1e-3, 0.5, 4.0, 0.99 * profiles[0].longest()] {
            let factor = disk(lengths).factor(&profiles, Vec3::new(0.6, 0.8, 0.0) * r, Vec3::Z);
            assert!((factor - 1.0).abs() < 1e-5, "{r}: {factor}");
        }
    }
}
