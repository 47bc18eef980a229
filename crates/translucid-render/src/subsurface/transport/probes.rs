//! Where light that leaves at a point has entered: ray-traced probes.
//!
//! Probes are segments through the neighborhood of the exit point P: along some of three axes, at a
//! distance r from P that is drawn from the profile of one of three channels.
//! Every surface point x that they meet could have been found along each axis and by each channel; the
//! expected number of probes that find it, per area, is the sum over all of them,
//!
//! ```text
//! p(x) = Σ_axis a_j |n·axis_j| Σ_channel q_c p_c(r_j) / (2π r_j),   p_c = 0 where |x − P| > R_m,c
//! ```
//!
//! with a_j the probability that axis j is probed and r_j the distance of x from P *projected* along it,
//! and its weight is R(|x − P|) / p(x) [King et al. 2013, "BSSRDF Importance Sampling", with the axes as
//! strategies of several samples each, combined over channels].
//! One probe along one axis chosen at random would be cheaper, but misses the surface half of the time.
//! The profile is cut at R_m, where all but a small tail of its energy is inside, and renormalized; the
//! ball |x − P| ≤ R_m is the same for all axes, so the density is exact.
//! Where a texture gives the entry a say in R (see [`Pairing`]), channels are the exit's profile and the widest one that
//! the texture has, so that every R is covered.
//! All hits count: one of them is drawn in proportion to its weight and stands for their sum.

use std::f32::consts::TAU;

use glam::Vec3;

use crate::path::tracer::World;
use crate::ray::Ray;
use crate::ray::{Hit, SurfacePoint};
use crate::sampling::Frame;
use crate::sampling::{Sampler, choose};
use crate::subsurface::kernel::cut::{CutNormalizedDiffusion, CutProfile, CutTable, Truncation};
use crate::subsurface::kernel::tables::ProfileSource;
use crate::subsurface::pairing::Pairing;
use crate::subsurface::transport::shared::{ExitProfiles, Nearness};
use crate::surface::material::Subsurface;

/// Probabilities of probing along the two tangents and the normal.
///
/// Measured on the head at equal samples: one axis at random (¼, ¼, ½) has 2.1 times the squared error of
/// these at 0.78 times the CPU time; all three always (1, 1, 1) 0.87 times the error at 1.5 times the time.
pub(crate) const AXIS_PROBES: [f32; 3] = [0.25, 0.25, 1.0];

/// Part of a probe's length within which two hits that face the same way are one: rounding differs between the copies
/// of a face.
const SAME_PLACE: f32 = 1e-6;

/// |n · axis| below which a hit is left out: its density would be rounding noise.
const GRAZING: f32 = 1e-6;

/// The point that light leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exit<'a> {
    pub(crate) point: &'a SurfacePoint,
    /// Number of its material.
    pub(crate) material: usize,
    pub(crate) subsurface: Subsurface,
    /// What the result will be multiplied with: channels that matter more are probed more.
    pub(crate) importance: Vec3,
}

/// A point that light enters, with R(|x − P|) over the density of finding it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) hit: Hit,
    pub(crate) weight: Vec3,
    /// The parameters of R.
    pub(crate) subsurface: Subsurface,
}

/// Finds entry points; keeps its memory between calls.
pub(crate) struct Prober {
    truncation: Truncation,
    axis_probes: [f32; 3],
    hits: Vec<Hit>,
    /// Weight of each hit, and the sum of importances up to it.
    weights: Vec<(HitWeight, f32)>,
}

/// What a hit counts for.
#[derive(Clone, Copy, Debug, Default)]
struct HitWeight {
    /// R / p.
    value: Vec3,
    /// 1 / (2πr p) for the distance r \[L\].
    inverse_density: f32,
    /// r \[L\].
    distance: f32,
}

impl HitWeight {
    fn scaled(self, factor: f32) -> Self {
        Self { value: self.value * factor, inverse_density: self.inverse_density * factor, ..self }
    }
}

/// What an exit has to share with others.
pub(crate) struct Shareable<'w> {
    pub(crate) profiles: ExitProfiles<'w>,
    pub(crate) nearness: Nearness,
    /// The hit that probes have found, if any.
    pub(crate) found: Option<Found>,
}

/// A hit that can serve other exits, too.
pub(crate) struct Found {
    pub(crate) hit: Hit,
    /// R(|x − P|) over the density of finding it, per channel of the exit that found it.
    pub(crate) weight: Vec3,
    /// Unbiased estimate of 1 over that density \[L²\].
    pub(crate) contribution: f32,
}

impl Prober {
    pub(crate) fn new(truncation: Truncation, axis_probes: [f32; 3]) -> Self {
        Self { truncation, axis_probes, hits: Vec::new(), weights: Vec::new() }
    }

    /// Draws an entry point; `None` where the probes meet nothing.
    pub(crate) fn sample(&mut self, world: &World, exit: &Exit<'_>, sampler: &mut Sampler) -> Option<Entry> {
        let truncation = self.truncation;
        match exit.subsurface.source {
            ProfileSource::NormalizedDiffusion => {
                let profile = |_, length| CutNormalizedDiffusion::new(length, &truncation);
                self.sample_by(world, exit, sampler, profile)
            }
            ProfileSource::Table(table)
            | ProfileSource::Directional { table, .. }
            | ProfileSource::Oblique { table, .. } => {
                let table = world.materials.profile_tables().table(table);
                let profile = |albedo, length| CutTable::new(table.at(albedo, length), truncation.tail);
                self.sample_by(world, exit, sampler, profile)
            }
            // Walks find their way out themselves
            ProfileSource::RandomWalk(_) => None,
        }
    }

    /// Draws an entry point for all exits nearby, for an exit whose own parameters are all that counts; `None` if no
    /// channel scatters.
    pub(crate) fn sample_to_share<'w>(
        &mut self,
        world: &'w World,
        exit: &Exit<'_>,
        sampler: &mut Sampler,
    ) -> Option<Shareable<'w>> {
        let truncation = self.truncation;
        match exit.subsurface.source {
            ProfileSource::NormalizedDiffusion => {
                let profile = |_, length| CutNormalizedDiffusion::new(length, &truncation);
                self.share_by(world, exit, sampler, profile, ExitProfiles::NormalizedDiffusion)
            }
            ProfileSource::Table(table)
            | ProfileSource::Directional { table, .. }
            | ProfileSource::Oblique { table, .. } => {
                let table = world.materials.profile_tables().table(table);
                let profile = |albedo, length| CutTable::new(table.at(albedo, length), truncation.tail);
                self.share_by(world, exit, sampler, profile, ExitProfiles::Table)
            }
            ProfileSource::RandomWalk(_) => None,
        }
    }

    fn share_by<'w, P: CutProfile>(
        &mut self,
        world: &World,
        exit: &Exit<'_>,
        sampler: &mut Sampler,
        profile: impl Fn(f32, f32) -> P,
        all: impl Fn([P; 3]) -> ExitProfiles<'w>,
    ) -> Option<Shareable<'w>> {
        let channels = Channels::new(exit, profile)?;
        let axis_probes = self.axis_probes;
        let proposals = &channels.proposals;
        let found = self.sample_from(proposals, world, exit, sampler, |_, offset, normal| {
            channels.weight(offset, normal, axis_probes)
        });
        let profiles = all(proposals.profiles);
        let nearness = Nearness::new(proposals.shares, profiles.reaches(), self.truncation.tail);
        let found = found.map(|(hit, weight)| Found {
            hit,
            weight: weight.value,
            contribution: TAU * nearness.distance(weight.distance) * weight.inverse_density,
        });
        Some(Shareable { profiles, nearness, found })
    }

    /// The same with the profile of a surface albedo and a length.
    fn sample_by<P: CutProfile>(
        &mut self,
        world: &World,
        exit: &Exit<'_>,
        sampler: &mut Sampler,
        profile: impl Fn(f32, f32) -> P,
    ) -> Option<Entry> {
        if let Some(pairing) = world.materials.pairing(exit.material) {
            return self.sample_pair(world, pairing, exit, sampler, profile);
        }
        let channels = Channels::new(exit, profile)?;
        let axis_probes = self.axis_probes;
        let (hit, weight) =
            self.sample_from(&channels.proposals, world, exit, sampler, |_, offset, normal| {
                channels.weight(offset, normal, axis_probes)
            })?;
        let weight = weight.value;
        Some(Entry { hit, weight, subsurface: exit.subsurface })
    }

    /// Draws an entry point where its own parameters have a say: by the exit's profile and by the widest that there can
    /// be, so that none is missed.
    fn sample_pair<P: CutProfile>(
        &mut self,
        world: &World,
        pairing: &Pairing,
        exit: &Exit<'_>,
        sampler: &mut Sampler,
        profile: impl Fn(f32, f32) -> P,
    ) -> Option<Entry> {
        let Subsurface { albedo, length, .. } = exit.subsurface;
        let widest = pairing.widest(world, exit);
        let first = (0..3).find(|&c| length[c] > 0.0)?;
        let proposal = |i: usize| {
            let c = if length[i % 3] > 0.0 { i % 3 } else { first };
            if i < 3 { profile(albedo[c], length[c]) } else { profile(widest.albedo[c], widest.length[c]) }
        };
        let brightest = pairing.brightest(albedo);
        let share = |i: usize| {
            let c = i % 3;
            if length[c] > 0.0 { brightest[c] * exit.importance[c] } else { 0.0 }
        };
        let proposals = Proposals::<P, 6>::new(std::array::from_fn(proposal), std::array::from_fn(share))?;
        let axis_probes = self.axis_probes;
        let (hit, weight) = self.sample_from(&proposals, world, exit, sampler, |hit, offset, normal| {
            let (density, distance) = proposals.density(offset, normal, axis_probes);
            if density <= 0.0 {
                return HitWeight::default();
            }
            let pair = pairing.pair(world, exit, hit);
            let value = |c: usize| {
                if length[c] <= 0.0 || pair.length[c] <= 0.0 {
                    return 0.0;
                }
                let profile = profile(pair.albedo[c], pair.length[c]);
                if distance <= profile.longest() { pair.albedo[c] * profile.pdf(distance) } else { 0.0 }
            };
            let value = Vec3::new(value(0), value(1), value(2)) / density;
            HitWeight { value, inverse_density: 1.0 / density, distance }
        })?;
        let weight = weight.value;
        Some(Entry { hit, weight, subsurface: pairing.pair(world, exit, &hit) })
    }

    /// The same with the profiles that probes are drawn from, and the weight of a hit at an offset from the exit with a
    /// normal, both in the exit's frame.
    fn sample_from<P: CutProfile, const N: usize>(
        &mut self,
        proposals: &Proposals<P, N>,
        world: &World,
        exit: &Exit<'_>,
        sampler: &mut Sampler,
        weight: impl Fn(&Hit, Vec3, Vec3) -> HitWeight,
    ) -> Option<(Hit, HitWeight)> {
        let geometry = &world.geometry;
        let frame = Frame::from_normal(exit.point.geometric_normal);
        self.hits.clear();
        self.weights.clear();
        let mut sum = 0.0;
        let mut pick = 0.0;
        for axis in 0..3 {
            let u = sampler.next_4d();
            pick = u[3];
            if u[0] >= self.axis_probes[axis] {
                continue;
            }
            let (index, _) = choose(proposals.shares, u[0] / self.axis_probes[axis]);
            let first = self.hits.len();
            let profile = &proposals.profiles[index];
            let position = exit.point.position;
            let Some(ray) = probe_segment(position, &frame, axis, profile, [u[1], u[2]], geometry.bounds())
            else {
                continue;
            };
            geometry.all_in_group(&ray, exit.point.group, |hit| self.hits.push(hit));
            // The tree's order must not show in the picture.
            let number = |hit: &Hit| geometry.object_and_triangle_of(hit);
            self.hits[first..]
                .sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then_with(|| number(a).cmp(&number(b))));
            let mut before = (f32::NEG_INFINITY, Vec3::ZERO);
            for hit in &self.hits[first..] {
                let normal = geometry.normal(hit);
                // A face that lies twice in the same place would count twice
                let is_copy = hit.t - before.0 <= SAME_PLACE * ray.t_max && normal.dot(before.1) > 0.999;
                before = (hit.t, normal);
                let weight = if is_copy || frame.axis(axis).dot(normal).abs() < GRAZING {
                    HitWeight::default()
                } else {
                    let offset = geometry.position(hit) - exit.point.position;
                    weight(hit, frame.to_local(offset), frame.to_local(normal))
                };
                sum += (weight.value * exit.importance).element_sum();
                self.weights.push((weight, sum));
            }
        }
        self.pick(pick * sum, exit.importance, sum)
    }

    /// The hit at which the running sum of importances passes `goal` stands for all of them.
    fn pick(&self, goal: f32, importance: Vec3, sum: f32) -> Option<(Hit, HitWeight)> {
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let index = self.weights.partition_point(|&(_, cumulative)| cumulative <= goal);
        let (weight, _) = *self.weights.get(index)?;
        let own = (weight.value * importance).element_sum();
        (own > 0.0).then(|| (self.hits[index], weight.scaled(sum / own)))
    }
}

/// The profiles that probes are drawn from, and the shares of probes they get.
struct Proposals<P, const N: usize> {
    profiles: [P; N],
    /// Not all 0, and 1 in sum.
    shares: [f32; N],
}

impl<P: CutProfile, const N: usize> Proposals<P, N> {
    /// `None` where all shares are 0.
    fn new(profiles: [P; N], shares: [f32; N]) -> Option<Self> {
        let sum: f32 = shares.iter().sum();
        (sum > 0.0 && sum.is_finite()).then(|| Self { profiles, shares: shares.map(|s| s / sum) })
    }

    /// Density of finding a point at `offset` from the exit with normal `normal`, both in the exit's frame, times its
    /// distance and 2π; and its distance.
    ///
    /// Both R and the densities go like 1/r: each is multiplied with |x − P|, so that they stay finite.
    /// The factor 2π is in both and cancels.
    #[inline]
    fn density(&self, offset: Vec3, normal: Vec3, axis_probes: [f32; 3]) -> (f32, f32) {
        let squared = offset.length_squared();
        let distance = squared.sqrt();
        let inside: [bool; N] = std::array::from_fn(|i| distance <= self.profiles[i].longest());
        let mut density = 0.0;
        for axis in 0..3 {
            let cosine = axis_probes[axis] * normal[axis].abs();
            if cosine == 0.0 {
                continue;
            }
            // Not |x − P|² less the way along the axis: rounding would leave nothing of a short distance, where some
            // profiles have no density at all.
            let across = [offset[(axis + 1) % 3], offset[(axis + 2) % 3]];
            let projected = (across[0] * across[0] + across[1] * across[1]).sqrt().max(distance * 1e-6);
            // At P itself the ratio tends to 1 on a plane facing the axis.
            let ratio = if distance > 0.0 { distance / projected } else { 1.0 };
            let mut sum = 0.0;
            for (i, profile) in self.profiles.iter().enumerate() {
                if inside[i] && self.shares[i] > 0.0 {
                    sum += self.shares[i] * profile.pdf(projected);
                }
            }
            density += cosine * ratio * sum;
        }
        (density, distance)
    }
}

/// The profiles of the exit's three channels.
struct Channels<P> {
    /// Of channels that do not scatter the profile of one that does: their shares and albedos are 0.
    proposals: Proposals<P, 3>,
    albedo: Vec3,
}

impl<P: CutProfile> Channels<P> {
    /// `None` if no channel scatters.
    fn new(exit: &Exit<'_>, profile: impl Fn(f32, f32) -> P) -> Option<Self> {
        let Subsurface { albedo, length, .. } = exit.subsurface;
        let active = |c: usize| length[c] > 0.0;
        let share = |c: usize| if active(c) { albedo[c] * exit.importance[c] } else { 0.0 };
        let shares = [share(0), share(1), share(2)];
        let first = (0..3).find(|&c| active(c))?;
        let profile = |c: usize| {
            let c = if active(c) { c } else { first };
            profile(albedo[c], length[c])
        };
        let albedo_of = |c: usize| if active(c) { albedo[c] } else { 0.0 };
        Some(Self {
            proposals: Proposals::new([profile(0), profile(1), profile(2)], shares)?,
            albedo: Vec3::new(albedo_of(0), albedo_of(1), albedo_of(2)),
        })
    }

    /// R / p and 1 / p for a point at `offset` from the exit with normal `normal`, both in the exit's frame.
    #[inline]
    fn weight(&self, offset: Vec3, normal: Vec3, axis_probes: [f32; 3]) -> HitWeight {
        let (density, distance) = self.proposals.density(offset, normal, axis_probes);
        if density <= 0.0 {
            return HitWeight::default();
        }
        let value = |c: usize| {
            let profile = &self.proposals.profiles[c];
            if distance <= profile.longest() { self.albedo[c] * profile.pdf(distance) } else { 0.0 }
        };
        let value = Vec3::new(value(0), value(1), value(2)) / density;
        // Density and profile are those times 2πr
        HitWeight { value, inverse_density: 1.0 / density, distance }
    }
}

/// The segment of a probe inside the ball of its channel, and near the scene: seen from a thousand times its size away a
/// mesh would drown in rounding. `None` where there is nothing to meet.
fn probe_segment(
    exit: Vec3,
    frame: &Frame,
    axis: usize,
    profile: &impl CutProfile,
    u: [f32; 2],
    (low, high): (Vec3, Vec3),
) -> Option<Ray> {
    let longest = profile.longest();
    let radius = profile.sample(u[0]);
    let (sin, cos) = (TAU * u[1]).sin_cos();
    let (first, second) = (frame.axis((axis + 1) % 3), frame.axis((axis + 2) % 3));
    // √(R_m² − r²), whose squares might overflow
    let half = (longest - radius).max(0.0).sqrt() * (longest + radius).sqrt();
    let center = exit + (first * cos + second * sin) * radius;
    let direction = -frame.axis(axis);
    let middle = (0.5 * (low + high) - center).dot(direction);
    let reach = (high - low).length();
    let (start, end) = ((-half).max(middle - reach), half.min(middle + reach));
    (start < end).then(|| Ray::segment(center + direction * start, direction, end - start))
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use translucid_scene::{Mesh, Object};

    use super::*;
    use crate::ray::Geometry;

    #[test]
    fn probes_of_the_longest_lengths_are_finite() {
        let frame = Frame::from_normal(Vec3::Y);
        // The greatest length of a material times a factor of its channel times the reach of a profile table
        let profile = CutNormalizedDiffusion::new(1e15 * 1e6, &Truncation::new(1e-3));
        for (axis, u) in [0.0, 0.3, 1.0 - f32::EPSILON].into_iter().flat_map(|u| [(0, u), (2, u)]) {
            for size in [1e-9, 1.0, 1e9].map(Vec3::splat) {
                let ray = probe_segment(Vec3::ZERO, &frame, axis, &profile, [u, 0.4], (-size, size));
                let is_finite =
                    |ray: Ray| ray.origin.is_finite() && ray.direction.is_finite() && ray.t_max.is_finite();
                assert!(ray.is_none_or(is_finite), "{ray:?}");
            }
        }
    }

    /// A probe as long as a million balls meets the ball as one as long as a few.
    #[test]
    fn probes_much_longer_than_a_body_meet_it_where_it_is() {
        let (rows, columns) = (40_u32, 80_u32);
        let mut mesh = Mesh::default();
        for (i, j) in (0..=rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let (theta, phi) = (PI * i as f32 / rows as f32, 2.0 * PI * j as f32 / columns as f32);
            let (x, z) = (theta.sin() * phi.cos(), theta.sin() * phi.sin());
            mesh.positions.push(Vec3::new(x, theta.cos(), -z));
        }
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let (a, b) = (i * columns + j, i * columns + (j + 1) % columns);
            mesh.triangles.extend([[a, a + columns, b], [b, a + columns, b + columns]]);
        }
        let ball = Object { name: "ball".into(), mesh, material: 0, subsurface_group: 0 };
        let geometry = Geometry::new(&[ball]);
        let exit = Vec3::new(0.6, 0.8, 0.0);
        let frame = Frame::from_normal(Vec3::new(0.48, 0.64, 0.6));
        for (axis, length) in [1.0, 1e6].into_iter().flat_map(|length| (0..3).map(move |axis| (axis, length)))
        {
            let profile = CutNormalizedDiffusion::new(length, &Truncation::new(1e-3));
            // Random numbers so near to 0 that the probe passes at about half the ball's radius
            let u = 1.0 - (0.5 / length).min(0.4);
            let u = if profile.sample(u) < profile.sample(1.0 - u) { u } else { 1.0 - u };
            let ray = probe_segment(exit, &frame, axis, &profile, [u, 0.7], geometry.bounds());
            let mut hits = 0;
            if let Some(ray) = ray {
                geometry.all_in_group(&ray, 0, |hit| {
                    hits += 1;
                    assert!((geometry.position(&hit).length() - 1.0).abs() < 0.01, "{length}, {axis}");
                    let off = (geometry.position(&hit) - ray.origin).cross(ray.direction).length();
                    assert!(off < 1e-4, "{length}, {axis}: {off}");
                });
            }
            assert_eq!(hits, 2, "{length}, {axis}");
        }
    }

    /// p(r) = r e^{−r}: no density at r = 0, like profiles that are finite there.
    #[derive(Clone, Copy)]
    struct Finite;

    impl CutProfile for Finite {
        fn pdf(&self, r: f32) -> f32 {
            r * (-r).exp()
        }

        fn sample(&self, u: f32) -> f32 {
            u
        }

        fn longest(&self) -> f32 {
            10.0
        }
    }

    /// On the other side of a body, straight below the exit, the density is |x − P| p(r)/r for every small r.
    #[test]
    fn density_survives_rounding_far_below_the_exit() {
        let proposals = Proposals::new([Finite], [1.0]).expect("a share");
        for r in [0.0_f32, 1e-7, 1e-5, 1e-4, 1e-3] {
            let normal = Vec3::new(1e-4, 0.0, -1.0).normalize();
            let (density, distance) = proposals.density(Vec3::new(r, 0.0, -3.0), normal, [0.25, 0.25, 1.0]);
            let expected = distance * (-r).exp();
            assert!((density / expected - 1.0).abs() < 1e-3, "r = {r}: {density} instead of {expected}");
        }
    }
}
