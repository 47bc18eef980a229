//! Culling of eight boxes or facets at once, with the widest vectors of the processor.
//!
//! Loops over lanes have no branches, so that the compiler turns them into vectors, and no fused operations, so that every
//! processor gives the same bits. A NaN passes, for the exact test to decide, except in the normal of a facet.

use glam::Vec3;

use super::cone::NormalCone;
use super::crossing::{Facet, LightOrigin, Query, ROOM};

/// Children of a node and facets of a leaf at most.
pub(super) const LANES: usize = 8;

/// A number for each of them.
type Lanes = [f32; LANES];

/// Rounding errors of directions and cosines, generously.
const ROUNDING: f32 = 1e-5;

/// Boxes around the facets of a node's children, and cones around their normals.
#[derive(Clone, Copy)]
pub(super) struct FacetNode {
    low: [Lanes; 3],
    high: [Lanes; 3],
    axis: [Lanes; 3],
    /// Cosines and sines of the cones' half-angles.
    cosine: Lanes,
    sine: Lanes,
}

/// Corners of facets; those that are missing have no area.
#[derive(Clone, Copy)]
pub(super) struct Leaf([[Lanes; 3]; 3]);

impl FacetNode {
    pub(super) fn new<'a>(children: impl Iterator<Item = &'a NormalCone>) -> Self {
        let mut cones = [&NormalCone::EMPTY; LANES];
        cones.iter_mut().zip(children).for_each(|(lane, cone)| *lane = cone);
        let lanes = |of: fn(&NormalCone) -> Vec3| [0, 1, 2].map(|axis| cones.map(|cone| of(cone)[axis]));
        Self {
            low: lanes(|cone| cone.low),
            high: lanes(|cone| cone.high),
            axis: lanes(|cone| cone.axis),
            cosine: cones.map(|cone| cone.cosine),
            sine: cones.map(|cone| (1.0 - cone.cosine * cone.cosine).max(0.0).sqrt()),
        }
    }

    /// Children through whose facets light may come to the point, as bits.
    pub(super) fn may_cross(&self, query: &Query) -> u32 {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor was found to have AVX2.
            return unsafe { self.may_cross_avx2(query) };
        }
        self.may_cross_portable(query)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn may_cross_avx2(&self, query: &Query) -> u32 {
        self.may_cross_portable(query)
    }

    /// With the unit direction u and the distance d to the middle of a ball of radius r around a box, directions to the
    /// box differ from u by no more than the chord of asin(r/d), which is below r/d (1 + 0.4143 (r/d)²). So does
    /// η ω_i − ω_o from that of the middles, by the sum of both chords times η and 1.
    #[inline(always)]
    fn may_cross_portable(&self, query: &Query) -> u32 {
        let &Query { from, beyond, reach, eta, side } = query;
        let (is_place, place) = match beyond {
            LightOrigin::At(place) => (true, place),
            LightOrigin::Along(direction) => (false, direction),
        };
        let squared_reach = reach * reach;
        let [low_x, low_y, low_z] = &self.low;
        let [high_x, high_y, high_z] = &self.high;
        let [axis_x, axis_y, axis_z] = &self.axis;
        let mut may_cross = [false; LANES];
        for i in 0..LANES {
            let off = |low: f32, high: f32, from: f32| larger(larger(low - from, from - high), 0.0);
            let off_x = off(low_x[i], high_x[i], from.x);
            let off_y = off(low_y[i], high_y[i], from.y);
            let off_z = off(low_z[i], high_z[i], from.z);
            let is_far = off_x * off_x + off_y * off_y + off_z * off_z >= squared_reach;

            let (x, y, z) =
                (0.5 * (low_x[i] + high_x[i]), 0.5 * (low_y[i] + high_y[i]), 0.5 * (low_z[i] + high_z[i]));
            let (wide, high, deep) = (high_x[i] - x, high_y[i] - y, high_z[i] - z);
            let radius = (wide * wide + high * high + deep * deep).sqrt();
            let (dx, dy, dz) = (x - from.x, y - from.y, z - from.z);
            let per_inside = 1.0 / (dx * dx + dy * dy + dz * dz).sqrt();
            let (tx, ty, tz) = (place.x - x, place.y - y, place.z - z);
            let per_outside = 1.0 / (tx * tx + ty * ty + tz * tz).sqrt();
            let sine_inside = radius * per_inside;
            let sine_outside = if is_place { radius * per_outside } else { 0.0 };
            let chord = |sine: f32| sine * (1.0 + 0.4143 * sine * sine);
            let (ox, oy, oz) = if is_place {
                (tx * per_outside, ty * per_outside, tz * per_outside)
            } else {
                (place.x, place.y, place.z)
            };
            let scale = eta * per_inside;
            let (hx, hy, hz) = (dx * scale - ox, dy * scale - oy, dz * scale - oz);
            let length = (hx * hx + hy * hy + hz * hz).sqrt();
            let sine = (eta * chord(sine_inside) + chord(sine_outside) + ROUNDING) / length;
            let cosine = larger(1.0 - sine * sine, 0.0).sqrt();
            // All directions where one of the angles is not below 90°, or their sum not below 180°
            let is_any =
                sine_inside >= 1.0 || sine_outside >= 1.0 || sine >= 1.0 || self.cosine[i] <= -cosine;
            let widest = self.cosine[i] * cosine - self.sine[i] * sine - ROUNDING;
            let along = (hx * axis_x[i] + hy * axis_y[i] + hz * axis_z[i]) * side;
            let is_off = along < length * widest;
            may_cross[i] = !is_far & (is_any | !is_off);
        }
        bits(may_cross)
    }
}

impl FacetNode {
    /// Squared distances from a point to the boxes of the children, infinite where there is no child.
    pub(super) fn squared_distances(&self, from: Vec3) -> Lanes {
        let ([low_x, low_y, low_z], [high_x, high_y, high_z]) = (&self.low, &self.high);
        std::array::from_fn(|i| {
            let off = |low: f32, high: f32, from: f32| (low - from).max(from - high).max(0.0);
            let off_x = off(low_x[i], high_x[i], from.x);
            let off_y = off(low_y[i], high_y[i], from.y);
            let off_z = off(low_z[i], high_z[i], from.z);
            off_x * off_x + off_y * off_y + off_z * off_z
        })
    }
}

impl Leaf {
    pub(super) fn new(facets: &[Facet]) -> Self {
        let corner =
            |lane: usize, corner: usize| facets.get(lane).map_or(Vec3::ZERO, |facet| facet.vertices[corner]);
        let lanes = |number: usize, axis: usize| std::array::from_fn(|lane| corner(lane, number)[axis]);
        Self([0, 1, 2].map(|number| [0, 1, 2].map(|axis| lanes(number, axis))))
    }

    /// Facets through which light may come to the point, as bits.
    pub(super) fn may_cross(&self, query: &Query) -> u32 {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor was found to have AVX2.
            return unsafe { self.may_cross_avx2(query) };
        }
        self.may_cross_portable(query)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn may_cross_avx2(&self, query: &Query) -> u32 {
        self.may_cross_portable(query)
    }

    /// Light from a direction crosses the plane at one point. From a place it crosses nearer than on the straight line, but
    /// not nearer than at the depth times the tangent that belongs to the straight line's sine over η: both ends of that
    /// range are beyond the same edge where it misses the facet.
    #[inline(always)]
    fn may_cross_portable(&self, query: &Query) -> u32 {
        let &Query { from, beyond, reach, eta, side } = query;
        let (is_place, to) = match beyond {
            LightOrigin::At(place) => (true, place - from),
            LightOrigin::Along(direction) => (false, direction),
        };
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = &self.0;
        let mut may_cross = [false; LANES];
        for i in 0..LANES {
            // Corners as seen from the point, and the normal, twice the area long
            let (ax, ay, az) = (ax[i] - from.x, ay[i] - from.y, az[i] - from.z);
            let (bx, by, bz) = (bx[i] - from.x, by[i] - from.y, bz[i] - from.z);
            let (cx, cy, cz) = (cx[i] - from.x, cy[i] - from.y, cz[i] - from.z);
            let (ux, uy, uz) = (bx - ax, by - ay, bz - az);
            let (vx, vy, vz) = (cx - ax, cy - ay, cz - az);
            let (nx, ny, nz) = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
            let squared = nx * nx + ny * ny + nz * nz;
            let per_length = side / squared.sqrt();
            let (ex, ey, ez) = (nx * per_length, ny * per_length, nz * per_length);
            let depth = ax * ex + ay * ey + az * ez;
            let rise = to.x * ex + to.y * ey + to.z * ez;
            let is_behind = depth <= 0.0 || depth >= reach || rise <= if is_place { depth } else { 0.0 };

            // The lateral direction, and the least and greatest lateral distance
            let (lx, ly, lz) = (to.x - ex * rise, to.y - ey * rise, to.z - ez * rise);
            let lateral2 = lx * lx + ly * ly + lz * lz;
            let squared_sine = lateral2 / (lateral2 + rise * rise);
            let bent = squared_sine / (eta * eta);
            let least = depth * (bent / ((1.0 - bent) * lateral2)).sqrt();
            let least = if lateral2 > 0.0 { least } else { 0.0 };
            let most = if is_place { depth / rise } else { least };
            let (px, py, pz) = (depth * ex, depth * ey, depth * ez);
            let (qx, qy, qz) = (px + lx * most, py + ly * most, pz + lz * most);
            let (px, py, pz) = (px + lx * least, py + ly * least, pz + lz * least);

            // Beyond an edge: (to − from) × (p − from) · n below rounding errors
            let least_area = -ROOM * squared;
            let beyond = |fx: f32, fy: f32, fz: f32, tx: f32, ty: f32, tz: f32| {
                let (dx, dy, dz) = (tx - fx, ty - fy, tz - fz);
                // n × (to − from)
                let (wx, wy, wz) = (ny * dz - nz * dy, nz * dx - nx * dz, nx * dy - ny * dx);
                let of = |px: f32, py: f32, pz: f32| (px - fx) * wx + (py - fy) * wy + (pz - fz) * wz;
                (of(px, py, pz) < least_area) & (of(qx, qy, qz) < least_area)
            };
            let is_beside = beyond(ax, ay, az, bx, by, bz)
                | beyond(bx, by, bz, cx, cy, cz)
                | beyond(cx, cy, cz, ax, ay, az);
            may_cross[i] = (squared > 0.0) & !is_behind & !is_beside;
        }
        bits(may_cross)
    }
}

/// The larger number; the second if one of them is none.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn bits(lanes: [bool; LANES]) -> u32 {
    lanes.iter().enumerate().fold(0, |bits, (lane, &is_set)| bits | u32::from(is_set) << lane)
}

#[cfg(test)]
mod tests {
    use super::super::crossing::tests::{facet, query};
    use super::*;

    /// Every processor has to make the same picture.
    #[test]
    fn lanes_are_the_same_in_vectors() {
        let mut passed = 0;
        for i in 0..2000 {
            let facets: Vec<Facet> = (0..LANES as u32).map(|lane| facet(i * 8 + lane, 0.5)).collect();
            let cones = facets.chunks(2).map(NormalCone::around).collect::<Vec<_>>();
            let (leaf, node, query) = (Leaf::new(&facets), FacetNode::new(cones.iter()), query(i));
            assert_eq!(leaf.may_cross(&query), leaf.may_cross_portable(&query));
            assert_eq!(node.may_cross(&query), node.may_cross_portable(&query));
            assert_eq!(node.may_cross(&query) >> cones.len(), 0, "nothing is found where there is no child");
            passed += node.may_cross(&query).count_ones() + leaf.may_cross(&query).count_ones();
        }
        assert!(passed > 1000, "{passed}");
    }
}
