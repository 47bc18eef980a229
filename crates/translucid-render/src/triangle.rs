//! A triangle as the traversal sees it, with a watertight intersection.

use glam::Vec3;

/// A ray segment: points `origin + t direction` with `t_min < t < t_max`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3,
    /// Unit length, so that t is a distance.
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

    #[inline]
    fn apply(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.axes;
        Vec3::new(v[x] - self.factors.x * v[z], v[y] - self.factors.y * v[z], self.factors.z * v[z])
    }
}

impl Ray {
    /// A ray without end.
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::segment(origin, direction, f32::INFINITY)
    }

    /// A ray that ends at distance `t_max`.
    pub(crate) fn segment(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        Self { origin, direction, t_max, shear: Shear::new(direction) }
    }

    /// The point at distance `t`.
    pub(crate) fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Where a ray meets a triangle: distance and barycentric coordinates of vertices 1 and 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleHit {
    pub(crate) t: f32,
    pub(crate) b1: f32,
    pub(crate) b2: f32,
}

/// Vertices beside the numbers that a traversal needs: 48 bytes.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct LeafTriangle {
    pub(crate) vertices: [Vec3; 3],
    /// Index into the scene's objects.
    pub(crate) object: u32,
    /// Index into the object's triangles.
    pub(crate) triangle: u32,
    /// The object's subsurface group.
    pub(crate) group: u32,
}

impl LeafTriangle {
    /// The geometric normal, counter-clockwise, twice the area long.
    pub(crate) fn normal(&self) -> Vec3 {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a)
    }

    /// The point at barycentric coordinates of vertices 1 and 2.
    pub(crate) fn point(&self, [b1, b2]: [f32; 2]) -> Vec3 {
        let [a, b, c] = self.vertices;
        a + (b - a) * b1 + (c - a) * b2
    }

    /// Watertight intersection [Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection"].
    ///
    /// The vertices are sheared so that the ray becomes the z axis; a vertex gets the same two numbers in
    /// all its triangles. The sign of an edge function of such points, a difference of two rounded
    /// products, is never wrong (rounding keeps order; at worst it is zero, and zero counts as inside),
    /// so no ray slips through a shared edge or vertex.
    #[inline]
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<TriangleHit> {
        let [a, b, c] = self.vertices.map(|vertex| ray.shear.apply(vertex - ray.origin));
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let t = (u * a.z + v * b.z + w * c.z) * inverse;
        // Written so that NaN fails, too.
        if !(t > 0.0 && t < ray.t_max) {
            return None;
        }
        Some(TriangleHit { t, b1: v * inverse, b2: w * inverse })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf(vertices: [Vec3; 3]) -> LeafTriangle {
        LeafTriangle { vertices, object: 0, triangle: 0, group: 0 }
    }

    #[test]
    fn intersect_returns_distance_and_barycentrics() {
        let [a, b, c] = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(3.0, 0.0, 2.5), Vec3::new(0.5, 2.0, 1.0)];
        let triangle = leaf([a, b, c]);
        for (b1, b2) in [(0.2, 0.3), (0.05, 0.5), (0.6, 0.1), (0.33, 0.33)] {
            let point = a * (1.0 - b1 - b2) + b * b1 + c * b2;
            let origin = Vec3::new(0.4, -3.0, -7.0);
            let ray = Ray::new(origin, (point - origin).normalize());
            let hit = triangle.intersect(&ray).expect("the ray aims at a point of the triangle");
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
            assert!(fan.iter().any(|t| t.intersect(&ray).is_some()), "ray {k} slips through");
        }
    }

    #[test]
    fn intersect_survives_degenerate_input() {
        let point = leaf([Vec3::ONE; 3]);
        let line = leaf([Vec3::ZERO, Vec3::X, Vec3::X * 2.0]);
        let huge = leaf([Vec3::ZERO, Vec3::X * 1e18, Vec3::Y * 1e18]);
        for triangle in [point, line, huge] {
            for direction in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE.normalize()] {
                if let Some(hit) = triangle.intersect(&Ray::new(Vec3::new(-1.0, -1.0, -1.0), direction)) {
                    assert!(hit.t.is_finite() && hit.b1.is_finite() && hit.b2.is_finite());
                }
            }
        }
    }
}
