//! Triangles as the traversal sees them, with a watertight intersection.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::primitive::{Block, CORNERS, Primitive};
use super::simd::{F32x8, LANES, SimdToken};

/// A ray segment: points `origin + t direction` with `t_min < t < t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub(crate) origin: Vec3,
    /// Unit length, so that t is a distance; where a mesh's own space is traced it is not, and t is the distance in the world.
    pub(crate) direction: Vec3,
    pub(crate) t_max: f32,
    way: RayVectors,
}

/// A ray as vectors, for trees: a processor that has written numbers one by one waits before it reads them as one vector.
#[derive(Clone, Copy, Debug)]
struct RayVectors {
    origin: Vec4,
    /// One over the direction, with a finite stand-in for 1/0.
    inverse: Vec4,
    /// By the last axis' component of the direction the next axis' one, that of the axis after, and one.
    shear: Vec4,
    /// A bit for each axis along which the ray goes down; above these the axis of the direction's largest component.
    axes: u32,
}

impl RayVectors {
    #[inline(always)]
    fn new(origin: Vec3, direction: Vec3) -> Self {
        let Vec3 { x, y, z } = direction;
        let direction = direction.extend(1.0);
        // Keeps 0·∞ out of the test of boxes.
        let is_flat = direction.abs().cmplt(Vec4::splat(1e-18));
        let inverse = Vec4::select(is_flat, Vec4::splat(1e18).copysign(direction), Vec4::ONE / direction);
        // Without branches: which axis it is changes from ray to ray.
        let (size_x, size_y, size_z) = (x.abs(), y.abs(), z.abs());
        let is_x = (size_x > size_y) & (size_x > size_z);
        let is_y = !is_x & (size_y > size_z);
        let of_axes = |x: f32, y: f32, z: f32| {
            if is_x {
                x
            } else if is_y {
                y
            } else {
                z
            }
        };
        let factor = 1.0 / of_axes(x, y, z);
        let shear = Vec4::new(of_axes(y, z, x) * factor, of_axes(z, x, y) * factor, factor, 0.0);
        let last = 2 - 2 * u32::from(is_x) - u32::from(is_y);
        Self { origin: origin.extend(0.0), inverse, shear, axes: direction.is_negative_bitmask() | last << 4 }
    }
}

impl Ray {
    /// A ray without end; the direction has unit length.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::segment(origin, direction, f32::INFINITY)
    }

    /// A ray that ends at distance `t_max` \[L\]; the direction has unit length.
    #[inline]
    pub fn segment(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        Self { origin, direction, t_max, way: RayVectors::new(origin, direction) }
    }

    /// The ray with another end.
    #[inline]
    pub(crate) fn until(&self, t_max: f32) -> Self {
        Self { t_max, ..*self }
    }

    /// The point at distance `t`.
    #[cfg(test)]
    pub(crate) fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    #[inline(always)]
    pub(super) fn start(&self) -> Vec4 {
        self.way.origin
    }

    /// One over the direction, with a finite stand-in for 1/0.
    #[inline(always)]
    pub(super) fn inverse(&self) -> Vec4 {
        self.way.inverse
    }

    /// A bit for each axis along which the ray goes down.
    #[inline(always)]
    pub(super) fn down(&self) -> u32 {
        self.way.axes & 0b111
    }
}

/// A ray as blocks of triangles want it: a permutation of axes and a shear turn its direction into (0, 0, 1).
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockRay {
    /// The axis of the direction's largest component is the last.
    axes: [usize; 3],
    /// In the order of these axes.
    origin: [f32; 3],
    factors: [f32; 3],
    /// Beyond this there is nothing to be found.
    pub(crate) t_max: f32,
}

impl BlockRay {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let RayVectors { origin, shear, axes, .. } = &ray.way;
        let last = (axes >> 4) as usize;
        let axes = [AXES[last + 1], AXES[last + 2], last];
        Self {
            axes,
            origin: axes.map(|axis| origin[axis]),
            factors: [shear.x, shear.y, shear.z],
            t_max: ray.t_max,
        }
    }
}

/// Numbers of axes, again and again.
static AXES: [usize; 5] = [0, 1, 2, 0, 1];

/// Where a ray meets a triangle: distance and barycentric coordinates of vertices 1 and 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleHit {
    pub(crate) t: f32,
    pub(crate) b1: f32,
    pub(crate) b2: f32,
}

/// Up to eight triangles of one object that share their corners: two cache lines.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// Corners by their axis.
    corners: [[f32; CORNERS]; 3],
    /// By vertex the corner of each lane, three bits each; lanes without a triangle repeat the first.
    vertices: [u32; 3],
    /// A bit for each lane with a triangle.
    lanes: u32,
    corner_count: u32,
    /// Where the numbers of the triangles begin among those of the tree.
    first: u32,
    /// Index into the scene's objects.
    object: u32,
    /// The object's subsurface group.
    group: u32,
}

impl Default for TriangleBlock {
    fn default() -> Self {
        Self::zeroed()
    }
}

impl Block for TriangleBlock {
    const LANES: usize = LANES;

    fn set_first(&mut self, first: u32) {
        self.first = first;
    }
}

impl TriangleBlock {
    /// Puts a triangle into a lane, the first before the others.
    pub(crate) fn set(&mut self, lane: usize, primitive: &Primitive) {
        for (vertex, position) in primitive.vertices.iter().enumerate() {
            let corner = self.corner(*position);
            if lane == 0 {
                self.vertices[vertex] = (0..LANES).fold(0, |lanes, lane| lanes | corner << (3 * lane));
            } else {
                let shift = 3 * lane;
                self.vertices[vertex] = self.vertices[vertex] & !(0b111 << shift) | corner << shift;
            }
        }
        self.lanes |= 1 << lane;
        self.object = primitive.object;
        self.group = primitive.group;
    }

    /// The number of a corner, which it gets if it has none.
    fn corner(&mut self, position: Vec3) -> u32 {
        let at = |corner: usize| self.corners.map(|axis| axis[corner].to_bits());
        let known = (0..self.corner_count as usize)
            .find(|&corner| at(corner) == position.to_array().map(f32::to_bits));
        if let Some(corner) = known {
            return corner as u32;
        }
        let new = self.corner_count;
        for axis in 0..3 {
            self.corners[axis][new as usize] = position[axis];
        }
        self.corner_count += 1;
        new
    }

    /// The triangle in a lane, by the numbers of the tree's triangles.
    pub(crate) fn get(&self, lane: usize, numbers: &[u32]) -> Primitive {
        let vertices = self.vertices.map(|lanes| {
            let corner = (lanes >> (3 * lane)) as usize % CORNERS;
            Vec3::from(self.corners.map(|axis| axis[corner]))
        });
        let triangle = numbers[self.first as usize + lane];
        Primitive { vertices, object: self.object, triangle, group: self.group }
    }

    pub(crate) fn object(&self) -> u32 {
        self.object
    }

    /// The subsurface group.
    pub(crate) fn group(&self) -> u32 {
        self.group
    }

    /// The nearest hit and its lane; of equal distances the first.
    #[inline(always)]
    pub(crate) fn closest(&self, vectors: impl SimdToken, ray: &BlockRay) -> Option<(TriangleHit, usize)> {
        self.intersect(vectors, ray)?.nearest()
    }

    /// Returns `true` if there is a hit.
    #[inline(always)]
    pub(crate) fn is_hit(&self, vectors: impl SimdToken, ray: &BlockRay) -> bool {
        self.intersect(vectors, ray).is_some()
    }

    /// All hits with their lanes.
    #[inline(always)]
    pub(crate) fn all(
        &self,
        vectors: impl SimdToken,
        ray: &BlockRay,
        mut found: impl FnMut(TriangleHit, usize),
    ) {
        let Some(hits) = self.intersect(vectors, ray) else { return };
        let mut mask = hits.mask;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % LANES;
            mask &= mask - 1;
            found(hits.get(lane), lane);
        }
    }

    /// Watertight intersection [Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection"] of
    /// all lanes; `None` without a hit.
    ///
    /// The vertices are sheared so that the ray becomes the z axis; a vertex gets the same two numbers in
    /// all its triangles. The sign of an edge function of such points, a difference of two rounded
    /// products, is never wrong (rounding keeps order; at worst it is zero), so no ray slips through a
    /// shared edge or vertex. Zeros are decided so that one triangle of an edge has the ray and the other
    /// has not: a probe counts all its hits.
    #[inline(always)]
    fn intersect<V: SimdToken>(&self, vectors: V, ray: &BlockRay) -> Option<BlockHits> {
        // Without closures: the compiler would not make vector instructions part of them.
        let BlockRay { axes: [x, y, z], origin: [ox, oy, oz], factors: [fx, fy, fz], .. } = *ray;
        let depth = vectors.load(&self.corners[z]) - vectors.splat(oz);
        let sheared_x = (vectors.load(&self.corners[x]) - vectors.splat(ox)) - vectors.splat(fx) * depth;
        let sheared_y = (vectors.load(&self.corners[y]) - vectors.splat(oy)) - vectors.splat(fy) * depth;
        let [a, b, c] = self.vertices;
        let (ax, ay) = (vectors.pick(sheared_x, a), vectors.pick(sheared_y, a));
        let (bx, by) = (vectors.pick(sheared_x, b), vectors.pick(sheared_y, b));
        let (cx, cy) = (vectors.pick(sheared_x, c), vectors.pick(sheared_y, c));
        let (mut u, mut v, mut w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        // For a hit all are positive or all negative, and zeros may become either. Most rays that meet a block's box meet no
        // triangle.
        let zero = vectors.splat(0.0);
        let (least, greatest) = (u.lesser(v).lesser(w), u.greater(v).greater(w));
        let maybe = (zero.is_at_most(least) | greatest.is_at_most(zero)) & self.lanes;
        if maybe == 0 {
            return None;
        }
        let mut inside = zero.is_below(least) | greatest.is_below(zero);
        if maybe & !inside != 0 {
            let corners = [
                [ax.to_array(), ay.to_array()],
                [bx.to_array(), by.to_array()],
                [cx.to_array(), cy.to_array()],
            ];
            let edges = decide_zeros(&corners, [u.to_array(), v.to_array(), w.to_array()]);
            (u, v, w) = (vectors.load(&edges[0]), vectors.load(&edges[1]), vectors.load(&edges[2]));
            let (least, greatest) = (u.lesser(v).lesser(w), u.greater(v).greater(w));
            inside = zero.is_below(least) | greatest.is_below(zero);
        }
        let sheared_z = vectors.splat(fz) * depth;
        let (az, bz, cz) =
            (vectors.pick(sheared_z, a), vectors.pick(sheared_z, b), vectors.pick(sheared_z, c));
        let inverse = vectors.splat(1.0) / (u + v + w);
        let t = (u * az + v * bz + w * cz) * inverse;
        // Comparisons with NaN are false: triangles without area are missed.
        let before_end = zero.is_below(t) & t.is_below(vectors.splat(ray.t_max));
        let mask = inside & before_end & self.lanes;
        if mask == 0 {
            return None;
        }
        let (b1, b2) = (v * inverse, w * inverse);
        Some(BlockHits { mask, t: t.to_array(), b1: b1.to_array(), b2: b2.to_array() })
    }
}

/// Gives edge functions that came out as zero a sign.
///
/// First in double precision, where the products are exact; a ray exactly on an edge then belongs to the
/// triangle whose edge runs upward (or, if level, to the right), as rasterizers have it: the neighbor's edge
/// runs the other way.
#[cold]
#[inline(never)]
fn decide_zeros(p: &[[[f32; LANES]; 2]; 3], mut edges: [[f32; LANES]; 3]) -> [[f32; LANES]; 3] {
    let [a, b, c] = p;
    for (edge, (from, to)) in edges.iter_mut().zip([(c, b), (a, c), (b, a)]) {
        for lane in 0..LANES {
            if edge[lane] != 0.0 {
                continue;
            }
            let product = |i: usize, j: usize| f64::from(from[i][lane]) * f64::from(to[j][lane]);
            let exact = product(0, 1) - product(1, 0);
            let (dx, dy) = (to[0][lane] - from[0][lane], to[1][lane] - from[1][lane]);
            let claimed = if exact == 0.0 { dy > 0.0 || (dy == 0.0 && dx > 0.0) } else { exact > 0.0 };
            edge[lane] = if claimed { f32::MIN_POSITIVE } else { -f32::MIN_POSITIVE };
        }
    }
    edges
}

/// The hit of a ray in a block.
struct BlockHits {
    /// A bit for each lane with a hit before the ray's end; not 0.
    mask: u32,
    t: [f32; LANES],
    b1: [f32; LANES],
    b2: [f32; LANES],
}

impl BlockHits {
    #[inline(always)]
    fn get(&self, lane: usize) -> TriangleHit {
        TriangleHit { t: self.t[lane], b1: self.b1[lane], b2: self.b2[lane] }
    }

    /// The nearest hit; of equal distances the first.
    #[inline(always)]
    fn nearest(&self) -> Option<(TriangleHit, usize)> {
        let mut mask = self.mask;
        let mut best = None;
        let mut nearest = f32::INFINITY;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % LANES;
            mask &= mask - 1;
            if self.t[lane] < nearest {
                nearest = self.t[lane];
                best = Some(lane);
            }
        }
        best.map(|lane| (self.get(lane), lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::simd::Portable;

    /// A block with the triangle.
    fn leaf(vertices: [Vec3; 3]) -> TriangleBlock {
        let mut block = TriangleBlock::default();
        block.set(0, &Primitive { vertices, object: 0, triangle: 0, group: 0 });
        block
    }

    #[test]
    fn intersect_returns_distance_and_barycentrics() {
        let [a, b, c] = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(3.0, 0.0, 2.5), Vec3::new(0.5, 2.0, 1.0)];
        let triangle = leaf([a, b, c]);
        for (b1, b2) in [(0.2, 0.3), (0.05, 0.5), (0.6, 0.1), (0.33, 0.33)] {
            let point = a * (1.0 - b1 - b2) + b * b1 + c * b2;
            let origin = Vec3::new(0.4, -3.0, -7.0);
            let ray = Ray::new(origin, (point - origin).normalize());
            let hit = triangle
                .closest(Portable, &BlockRay::new(&ray))
                .expect("the ray aims at a point of the triangle")
                .0;
            assert!((hit.t - (point - origin).length()).abs() < 1e-5, "{hit:?}");
            assert!((hit.b1 - b1).abs() < 1e-5 && (hit.b2 - b2).abs() < 1e-5, "{hit:?} {b1} {b2}");
        }
    }

    /// A fan of triangles around a vertex, rays through random points of its edges: each ray must meet
    /// at least one triangle.
    #[test]
    fn intersect_leaks_at_no_edge_or_vertex() {
        let ring: Vec<Vec3> = (0..7)
            .map(|i| {
                let a = i as f32 * std::f32::consts::TAU / 7.0;
                Vec3::new(a.cos() * 3.1, a.sin() * 2.7, (a * 2.0).sin() * 0.3)
            })
            .collect();
        let center = Vec3::new(0.13, -0.07, 0.21);
        let fan: Vec<_> = (0..7).map(|i| leaf([center, ring[i], ring[(i + 1) % 7]])).collect();
        for k in 0..20_000_u32 {
            let random = |salt: u32| sobol_burley::sample(k, salt, 7);
            let s = if k % 5 == 0 { 0.0 } else { random(0) * 0.999 };
            let target = center.lerp(ring[k as usize % 7], s);
            let origin = Vec3::new(random(1) * 20.0 - 10.0, random(2) * 20.0 - 10.0, -4.0 - random(3) * 30.0);
            let ray = Ray::new(origin, (target - origin).normalize());
            assert!(
                fan.iter().any(|t| t.closest(Portable, &BlockRay::new(&ray)).is_some()),
                "ray {k} slips through"
            );
        }
    }

    /// Rays that pass two triangles' edge exactly, or within rounding at a large scale, meet one of them.
    #[test]
    fn intersect_counts_a_shared_edge_once() {
        let [a, b, c, d] =
            [(-1e3, -1e3), (1e3, -1e3), (1e3, 1e3), (-1e3, 1e3)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let halves = [leaf([a, b, c]), leaf([a, c, d])];
        for k in 0..20_000_u32 {
            let random =
                |salt: u32| (sobol_burley::sample(k, salt, 5) - 0.5) * if k % 2 == 0 { 0.0 } else { 1e-4 };
            let along = k as f32 * 1e-3;
            let origin = Vec3::new(along + random(0), along + random(1), 1.0);
            for direction in [Vec3::NEG_Z, Vec3::new(0.3, 0.3, -0.9).normalize()] {
                let ray = Ray::new(origin, direction);
                let hits = halves
                    .iter()
                    .filter(|half| half.closest(Portable, &BlockRay::new(&ray)).is_some())
                    .count();
                assert_eq!(hits, 1, "ray {k} from {origin}");
            }
        }
    }

    #[test]
    fn intersect_survives_degenerate_input() {
        let point = leaf([Vec3::ONE; 3]);
        let line = leaf([Vec3::ZERO, Vec3::X, Vec3::X * 2.0]);
        let huge = leaf([Vec3::ZERO, Vec3::X * 1e18, Vec3::Y * 1e18]);
        for triangle in [point, line, huge] {
            for direction in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE.normalize()] {
                let ray = Ray::new(Vec3::new(-1.0, -1.0, -1.0), direction);
                if let Some((hit, _)) = triangle.closest(Portable, &BlockRay::new(&ray)) {
                    assert!(hit.t.is_finite() && hit.b1.is_finite() && hit.b2.is_finite());
                }
            }
        }
    }
}
