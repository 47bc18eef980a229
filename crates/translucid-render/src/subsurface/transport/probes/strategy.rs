//! How probes are drawn, and how likely a point is to be found by them.
//!
//! Every surface point x that probes meet could have been found along each axis and by each channel; the expected number
//! of probes that find it, per area, is the sum over all of them,
//!
//! ```text
//! p(x) = Σ_axis a_j |n·axis_j| Σ_channel q_c p_c(r_j) / (2π r_j),   p_c = 0 where |x − P| > R_m,c
//! ```
//!
//! with a_j the probability that axis j is probed and r_j the distance of x from P *projected* along it,
//! and its weight is R(|x − P|) / p(x) [King et al. 2013, "BSSRDF Importance Sampling", with the axes as
//! strategies of several samples each, combined over channels].
//! The profile is cut at R_m, where all but a small tail of its energy is inside, and renormalized; the
//! ball |x − P| ≤ R_m is the same for all axes, so the density is exact.

use std::f32::consts::TAU;

use glam::Vec3;

use super::HitWeight;
use crate::ray::{Ray, SurfacePoint};
use crate::sampling::{Frame, choose};
use crate::subsurface::kernel::CutProfile;

/// The probes of an exit point: N profiles along three axes.
pub(in crate::subsurface::transport) struct ProbeStrategy<'k, const N: usize> {
    exit: Vec3,
    /// The axes: two tangents and the geometric normal.
    pub(super) frame: Frame,
    /// Probabilities of probing along them.
    axes: [f32; 3],
    pub(in crate::subsurface::transport) profiles: [CutProfile<'k>; N],
    /// Probabilities of the profiles: not all 0, and 1 in sum.
    pub(in crate::subsurface::transport) shares: [f32; N],
}

impl<'k, const N: usize> ProbeStrategy<'k, N> {
    /// `None` where all shares are 0.
    #[inline]
    pub(super) fn new(
        exit: &SurfacePoint,
        axes: [f32; 3],
        profiles: [CutProfile<'k>; N],
        shares: [f32; N],
    ) -> Option<Self> {
        let sum: f32 = shares.iter().sum();
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            exit: exit.position,
            frame: Frame::from_normal(exit.geometric_normal),
            axes,
            profiles,
            shares: shares.map(|s| s / sum),
        })
    }

    /// Draws the probe along an axis by three numbers uniform in [0, 1); `None` where it is left out, or there is nothing
    /// to meet within the scene's bounds.
    #[inline]
    pub(super) fn sample(&self, axis: usize, u: [f32; 3], bounds: (Vec3, Vec3)) -> Option<Ray> {
        if u[0] >= self.axes[axis] {
            return None;
        }
        let (index, _) = choose(self.shares, u[0] / self.axes[axis]);
        let profile = &self.profiles[index];
        segment(self.exit, &self.frame, axis, (profile.sample(u[1]), profile.longest()), u[2], bounds)
    }

    /// Density of finding a point at `offset` from the exit with normal `normal`, both in the exit's frame, times its
    /// distance and 2π; and its distance.
    ///
    /// Both R and the densities go like 1/r: each is multiplied with |x − P|, so that they stay finite.
    /// The factor 2π is in both and cancels.
    #[inline]
    pub(super) fn density(&self, offset: Vec3, normal: Vec3) -> (f32, f32) {
        let squared = offset.length_squared();
        let distance = squared.sqrt();
        let inside: [bool; N] = std::array::from_fn(|i| distance <= self.profiles[i].longest());
        let mut density = 0.0;
        for axis in 0..3 {
            let cosine = self.axes[axis] * normal[axis].abs();
            if cosine == 0.0 {
                continue;
            }
            let (projected, ratio) = projected(offset, axis, distance);
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

impl ProbeStrategy<'_, 3> {
    /// R / p and 1 / p for a point at `offset` from the exit with normal `normal`, both in the exit's frame; `albedo` is
    /// 0 in channels that do not scatter.
    #[inline]
    pub(super) fn weight(&self, albedo: Vec3, offset: Vec3, normal: Vec3) -> HitWeight {
        let (density, distance) = self.density(offset, normal);
        if density <= 0.0 {
            return HitWeight::default();
        }
        let value = |c: usize| {
            let profile = &self.profiles[c];
            if distance <= profile.longest() { albedo[c] * profile.pdf(distance) } else { 0.0 }
        };
        let value = Vec3::new(value(0), value(1), value(2)) / density;
        // Density and profile are those times 2πr
        HitWeight { value, inverse_density: 1.0 / density, distance }
    }
}

/// Distance of an offset projected along an axis \[L\], and the whole distance over it.
#[inline]
pub(super) fn projected(offset: Vec3, axis: usize, distance: f32) -> (f32, f32) {
    // Not |x − P|² less the way along the axis: rounding would leave nothing of a short distance, where some
    // profiles have no density at all.
    let across = [offset[(axis + 1) % 3], offset[(axis + 2) % 3]];
    let projected = (across[0] * across[0] + across[1] * across[1]).sqrt().max(distance * 1e-6);
    // At P itself the ratio tends to 1 on a plane facing the axis.
    (projected, if distance > 0.0 { distance / projected } else { 1.0 })
}

/// The segment of a probe at a radius, inside the ball of its channel, and near the scene: seen from a thousand times its
/// size away a mesh would drown in rounding. `None` where there is nothing to meet.
fn segment(
    exit: Vec3,
    frame: &Frame,
    axis: usize,
    (radius, longest): (f32, f32),
    u: f32,
    (low, high): (Vec3, Vec3),
) -> Option<Ray> {
    let (sin, cos) = libm::sincosf(TAU * u);
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
pub(super) mod tests {
    use std::f32::consts::PI;

    use translucid_profile::{
        AlbedoTable, AlbedoTableF32, Appearance, Configuration, Model, Parameterization,
    };
    use translucid_scene::{Mesh, Object};

    use super::*;
    use crate::ray::Geometry;

    const TAIL: f32 = 1e-3;

    fn table(model: Model) -> AlbedoTableF32 {
        let appearance =
            Appearance { surface_albedo: 0.8, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
        let row = |_| model.profile(&appearance, Configuration::Diffuse, 1.0);
        AlbedoTableF32::from(&AlbedoTable::new(&[0.8], row).expect("a table"))
    }

    #[test]
    fn segments_of_the_longest_lengths_are_finite() {
        let frame = Frame::from_normal(Vec3::Y);
        let table = table(Model::NormalizedDiffusion);
        // The greatest length of a material times a factor of its channel times the reach of a profile table
        let profile = CutProfile::new(table.at(0.8, 1e15 * 1e6), TAIL);
        for (axis, u) in [0.0, 0.3, 1.0 - f32::EPSILON].into_iter().flat_map(|u| [(0, u), (2, u)]) {
            for size in [1e-9, 1.0, 1e9].map(Vec3::splat) {
                let radii = (profile.sample(u), profile.longest());
                let ray = segment(Vec3::ZERO, &frame, axis, radii, 0.4, (-size, size));
                let is_finite =
                    |ray: Ray| ray.origin.is_finite() && ray.direction.is_finite() && ray.t_max.is_finite();
                assert!(ray.is_none_or(is_finite), "{ray:?}");
            }
        }
    }

    fn ball() -> Geometry {
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
        Geometry::new(&[Object {
            name: "ball".into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 0,
            ..Object::default()
        }])
    }

    /// A probe as long as a million balls meets the ball as one as long as a few.
    #[test]
    fn segments_much_longer_than_a_body_meet_it_where_it_is() {
        let geometry = ball();
        let exit = Vec3::new(0.6, 0.8, 0.0);
        let frame = Frame::from_normal(Vec3::new(0.48, 0.64, 0.6));
        for (axis, longest) in
            [10.0, 1e7].into_iter().flat_map(|length| (0..3).map(move |axis| (axis, length)))
        {
            let ray = segment(exit, &frame, axis, (0.5, longest), 0.7, geometry.bounds());
            let mut hits = 0;
            if let Some(ray) = ray {
                geometry.all_in_group(&ray, 0, |hit| {
                    hits += 1;
                    assert!((geometry.position(&hit).length() - 1.0).abs() < 0.01, "{longest}, {axis}");
                    let off = (geometry.position(&hit) - ray.origin).cross(ray.direction).length();
                    assert!(off < 1e-4, "{longest}, {axis}: {off}");
                });
            }
            assert_eq!(hits, 2, "{longest}, {axis}");
        }
    }

    pub(in super::super) fn exit_at_origin() -> SurfacePoint {
        SurfacePoint {
            position: Vec3::ZERO,
            geometric_normal: Vec3::Z,
            shading_normal: Vec3::Z,
            uv: glam::Vec2::ZERO,
            color: Vec3::ONE,
            offset: 0.0,
            object: 0,
            triangle: 0,
            group: 0,
        }
    }

    /// On the other side of a body, straight below the exit, the density is |x − P| p(r)/r for every small r, also of
    /// profiles whose p(r)/r is finite at r = 0.
    #[test]
    fn density_survives_rounding_far_below_the_exit() {
        let table = table(Model::Gaussians);
        let view = table.at(0.8, 3.0);
        let profile = CutProfile::new(view, TAIL);
        assert!(profile.longest() > 3.0, "the other side is within reach");
        let strategy =
            ProbeStrategy::new(&exit_at_origin(), [0.25, 0.25, 1.0], [profile], [1.0]).expect("a share");
        for r in [0.0_f32, 1e-7, 1e-5, 1e-4, 1e-3] {
            let normal = Vec3::new(1e-4, 0.0, -1.0).normalize();
            let (density, distance) = strategy.density(Vec3::new(r, 0.0, -3.0), normal);
            let expected = distance * TAU * view.pdf_area(r) / view.cdf(profile.longest());
            assert!((density / expected - 1.0).abs() < 1e-3, "r = {r}: {density} instead of {expected}");
        }
    }

    /// Over many draws along one axis the mean of 1/p over the points found on a plane that faces it is the plane's area
    /// within reach.
    #[test]
    fn density_is_that_of_the_samples() {
        let table = table(Model::NormalizedDiffusion);
        let profile = CutProfile::new(table.at(0.8, 1.0), TAIL);
        let strategy =
            ProbeStrategy::new(&exit_at_origin(), [0.0, 0.0, 1.0], [profile; 2], [0.3, 0.7]).expect("shares");
        let bounds = (Vec3::splat(-50.0), Vec3::splat(50.0));
        let (n, mut sum) = (1 << 14, 0.0);
        for i in 0..n {
            let [a, b, c, _] = sobol_burley::sample_4d(i, 0, 7);
            let ray = strategy.sample(2, [a, b, c], bounds).expect("a probe");
            let at = ray.origin + ray.direction * (ray.origin.z / -ray.direction.z);
            let (density, distance) = strategy.density(at, Vec3::Z);
            // Counts radii within 1 only, where 1/p is not large
            sum += if distance < 1.0 { f64::from(TAU * distance / density) } else { 0.0 };
        }
        let area = sum / f64::from(n);
        assert!((area / std::f64::consts::PI - 1.0).abs() < 0.01, "{area}");
    }
}
