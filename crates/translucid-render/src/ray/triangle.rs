//! Triangles as the traversal sees them, with a watertight intersection.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::primitive::{Block, Primitive};

/// A ray segment: points `origin + t direction` with `t_min < t < t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub(crate) origin: Vec3,
    /// Unit length, so that t is a distance; where a mesh's own space is traced it is not, and t is the distance in the world.
    pub(crate) direction: Vec3,
    pub(crate) t_max: f32,
    shear: Shear,
}

/// The map that turns the ray's direction into (0, 0, 1): a permutation of axes and a shear.
#[derive(Clone, Copy, Debug)]
struct Shear {
    /// Axis of the direction's largest component, and the two others.
    axes: [usize; 3],
    factors: Vec3,
}

impl Shear {
    fn new(direction: Vec3) -> Self {
        let size = direction.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let inverse = 1.0 / direction[z];
        Self { axes: [x, y, z], factors: Vec3::new(direction[x] * inverse, direction[y] * inverse, inverse) }
    }
}

impl Ray {
    /// A ray without end; the direction has unit length.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::segment(origin, direction, f32::INFINITY)
    }

    /// A ray that ends at distance `t_max` \[L\]; the direction has unit length.
    pub fn segment(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        Self { origin, direction, t_max, shear: Shear::new(direction) }
    }

    /// The same ray with another end.
    #[inline]
    pub(crate) fn until(&self, t_max: f32) -> Self {
        Self { t_max, ..*self }
    }

    /// The point at distance `t`.
    #[cfg(test)]
    pub(crate) fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// A ray as blocks of triangles want it: each number four times, in the order of the sheared axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockRay {
    axes: [usize; 3],
    origin: [Vec4; 3],
    factors: [Vec4; 3],
    /// Beyond this there is nothing to be found.
    pub(crate) t_max: f32,
}

impl BlockRay {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let Shear { axes, factors } = ray.shear;
        let origin = axes.map(|axis| Vec4::splat(ray.origin[axis]));
        let factors = factors.to_array().map(Vec4::splat);
        Self { axes, origin, factors, t_max: ray.t_max }
    }
}

/// Where a ray meets a triangle: distance and barycentric coordinates of vertices 1 and 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleHit {
    pub(crate) t: f32,
    pub(crate) b1: f32,
    pub(crate) b2: f32,
}

/// Triangles that are tested together.
pub(crate) const LANES: usize = 4;

/// Four triangles side by side: a vertex coordinate of all four is one vector.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// By vertex, axis, lane. Empty lanes are NaN: no ray meets them.
    vertices: [[Vec4; 3]; 3],
    /// Index into the scene's objects.
    objects: [u32; LANES],
    /// Index into the object's triangles.
    triangles: [u32; LANES],
    /// The objects' subsurface groups.
    groups: [u32; LANES],
}

impl Default for TriangleBlock {
    fn default() -> Self {
        Self { vertices: [[Vec4::NAN; 3]; 3], objects: [0; LANES], triangles: [0; LANES], groups: [0; LANES] }
    }
}

impl Block for TriangleBlock {
    const LANES: usize = LANES;
}

impl TriangleBlock {
    /// Puts a triangle into a lane.
    pub(crate) fn set(&mut self, lane: usize, primitive: &Primitive) {
        for (corner, vertex) in primitive.vertices.iter().enumerate() {
            for axis in 0..3 {
                self.vertices[corner][axis][lane] = vertex[axis];
            }
        }
        self.objects[lane] = primitive.object;
        self.triangles[lane] = primitive.triangle;
        self.groups[lane] = primitive.group;
    }

    /// The triangle in a lane.
    pub(crate) fn get(&self, lane: usize) -> Primitive {
        let vertices = self.vertices.map(|v| Vec3::new(v[0][lane], v[1][lane], v[2][lane]));
        Primitive {
            vertices,
            object: self.objects[lane],
            triangle: self.triangles[lane],
            group: self.groups[lane],
        }
    }

    /// The object of a lane.
    pub(crate) fn object(&self, lane: usize) -> u32 {
        self.objects[lane]
    }

    /// The subsurface group of a lane.
    pub(crate) fn group(&self, lane: usize) -> u32 {
        self.groups[lane]
    }

    /// The nearest hit and its lane; of equal distances the first.
    #[inline(always)]
    pub(crate) fn closest(&self, ray: &BlockRay) -> Option<(TriangleHit, usize)> {
        self.intersect(ray)?.nearest(u32::MAX)
    }

    /// The nearest hit of a subsurface group and its lane; of equal distances the first.
    #[inline(always)]
    pub(crate) fn closest_in_group(&self, ray: &BlockRay, group: u32) -> Option<(TriangleHit, usize)> {
        let mut lanes = 0;
        for (lane, &own) in self.groups.iter().enumerate() {
            lanes |= u32::from(own == group) << lane;
        }
        if lanes == 0 {
            return None;
        }
        self.intersect(ray)?.nearest(lanes)
    }

    /// Whether there is a hit.
    #[inline(always)]
    pub(crate) fn is_hit(&self, ray: &BlockRay) -> bool {
        self.intersect(ray).is_some()
    }

    /// All hits with their lanes.
    #[inline(always)]
    pub(crate) fn all(&self, ray: &BlockRay, mut found: impl FnMut(TriangleHit, usize)) {
        let Some(hits) = self.intersect(ray) else { return };
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
    fn intersect(&self, ray: &BlockRay) -> Option<BlockHits> {
        let BlockRay { axes: [x, y, z], origin, factors, .. } = ray;
        let sheared = |vertex: &[Vec4; 3]| {
            let depth = vertex[*z] - origin[2];
            [
                (vertex[*x] - origin[0]) - factors[0] * depth,
                (vertex[*y] - origin[1]) - factors[1] * depth,
                factors[2] * depth,
            ]
        };
        let [a, b, c] = [sheared(&self.vertices[0]), sheared(&self.vertices[1]), sheared(&self.vertices[2])];
        let mut edges = [c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]];
        let is_zero = |edge: Vec4| edge.cmpeq(Vec4::ZERO);
        if (is_zero(edges[0]) | is_zero(edges[1]) | is_zero(edges[2])).any() {
            edges = decide_zeros(&[a, b, c], edges);
        }
        let [u, v, w] = edges;
        let is_left = u.cmpgt(Vec4::ZERO) & v.cmpgt(Vec4::ZERO) & w.cmpgt(Vec4::ZERO);
        let is_right = u.cmplt(Vec4::ZERO) & v.cmplt(Vec4::ZERO) & w.cmplt(Vec4::ZERO);
        let inside = is_left | is_right;
        // Most rays that meet a block's box meet no triangle.
        if !inside.any() {
            return None;
        }
        let determinant = u + v + w;
        let inverse = determinant.recip();
        let t = (u * a[2] + v * b[2] + w * c[2]) * inverse;
        // Comparisons with NaN are false: empty lanes and degenerate triangles miss.
        let hit =
            inside & determinant.cmpne(Vec4::ZERO) & t.cmpgt(Vec4::ZERO) & t.cmplt(Vec4::splat(ray.t_max));
        let mask = hit.bitmask();
        if mask == 0 {
            return None;
        }
        let [t, b1, b2] = [t, v * inverse, w * inverse].map(|lanes| lanes.to_array());
        Some(BlockHits { mask, t, b1, b2 })
    }
}

/// Gives edge functions that came out as zero a sign.
///
/// First in double precision, where the products are exact; a ray exactly on an edge then belongs to the
/// triangle whose edge runs upward (or, if level, to the right), as rasterizers have it: the neighbor's edge
/// runs the other way.
#[cold]
#[inline(never)]
fn decide_zeros(p: &[[Vec4; 3]; 3], mut edges: [Vec4; 3]) -> [Vec4; 3] {
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

    /// The nearest hit among some lanes; of equal distances the first.
    #[inline(always)]
    fn nearest(&self, lanes: u32) -> Option<(TriangleHit, usize)> {
        let mut mask = self.mask & lanes;
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

    /// A block with the triangle in its third lane.
    fn leaf(vertices: [Vec3; 3]) -> TriangleBlock {
        let mut block = TriangleBlock::default();
        block.set(2, &Primitive { vertices, object: 0, triangle: 0, group: 0 });
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
            let hit =
                triangle.closest(&BlockRay::new(&ray)).expect("the ray aims at a point of the triangle").0;
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
            assert!(fan.iter().any(|t| t.closest(&BlockRay::new(&ray)).is_some()), "ray {k} slips through");
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
                let hits = halves.iter().filter(|half| half.closest(&BlockRay::new(&ray)).is_some()).count();
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
                if let Some((hit, _)) = triangle.closest(&BlockRay::new(&ray)) {
                    assert!(hit.t.is_finite() && hit.b1.is_finite() && hit.b2.is_finite());
                }
            }
        }
    }
}
