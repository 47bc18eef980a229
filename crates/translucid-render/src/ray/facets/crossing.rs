//! The refracted path of light through the plane of one facet to a point inside.

use glam::Vec3;

/// Part of a facet by which a crossing may lie beside it, for rounding: a ray decides later whether it is met.
pub(super) const ROOM: f32 = 1e-3;

/// Steps toward the point where light crosses a plane, by Newton's method, and by bisection where that fails.
const MOST_STEPS: u32 = 32;

/// Where light comes from that crosses a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightOrigin {
    /// A place.
    At(Vec3),
    /// This unit direction, from wherever it crosses the surface.
    Along(Vec3),
}

/// A refracted path from a point inside through a facet toward a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Unit direction inside, from the point.
    pub(crate) direction: Vec3,
    /// Way inside \[L\].
    pub(crate) distance: f32,
    /// Cosine of the direction inside to the normal.
    pub(crate) cosine: f32,
    /// Area perpendicular to the light at the point inside, over the solid angle that the light fills where it comes from
    /// a place \[L²/sr\], or over the perpendicular area that it fills outside.
    pub(crate) spread: f32,
    /// The object, and the triangle's number there.
    pub(crate) triangle: (u32, u32),
}

/// The point and the light that a crossing connects.
#[derive(Clone, Copy, Debug)]
pub(in crate::ray) struct Query {
    /// The point inside.
    pub(in crate::ray) from: Vec3,
    pub(in crate::ray) beyond: LightOrigin,
    /// Longest way inside \[L\].
    pub(in crate::ray) reach: f32,
    /// Refractive index inside over that outside, > 1.
    pub(in crate::ray) eta: f32,
    /// 1, or −1 where the body is in front of its surfaces.
    pub(in crate::ray) side: f32,
}

/// A triangle with where it comes from.
#[derive(Clone, Copy)]
pub(in crate::ray) struct Facet {
    pub(in crate::ray) vertices: [Vec3; 3],
    /// The object, and the triangle's number there.
    pub(in crate::ray) triangle: (u32, u32),
}

impl Facet {
    pub(super) fn middle(&self) -> Vec3 {
        let [a, b, c] = self.vertices;
        (a + b + c) / 3.0
    }

    /// Unit normal; `None` without an area.
    pub(super) fn normal(&self) -> Option<Vec3> {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a).try_normalize()
    }

    /// The way of the light through the facet's plane, if it is not far beside the facet.
    pub(super) fn crossing(&self, query: &Query) -> Option<Crossing> {
        let &Query { from, beyond, reach, eta, side } = query;
        let outward = self.normal()?;
        let normal = outward * side;
        let depth = (self.vertices[0] - from).dot(normal);
        let is_reached = depth > 0.0 && depth < reach;
        if !is_reached {
            return None;
        }
        let toward = match beyond {
            LightOrigin::Along(direction) => direction,
            LightOrigin::At(place) => {
                let lateral = place - from - normal * (place - from).dot(normal);
                let height = (place - self.vertices[0]).dot(normal);
                let sideways = crossing_of_plane(depth, height, lateral.length(), eta)?;
                let crossing = from + normal * depth + lateral.normalize_or_zero() * sideways;
                (place - crossing).try_normalize()?
            }
        };
        let outside = toward.dot(normal);
        if outside <= 0.0 {
            return None;
        }
        // η cos θ_i, without the cancellation of 1 − cos²
        let inside = ((eta - 1.0) * (eta + 1.0) + outside * outside).sqrt();
        let direction = ((toward + normal * (inside - outside)) / eta).normalize();
        let cosine = direction.dot(normal);
        let distance = depth / cosine;
        let crossing = from + direction * distance;
        if distance >= reach || !self.is_near(crossing, outward) {
            return None;
        }
        let spread = match beyond {
            LightOrigin::Along(_) => cosine / outside,
            LightOrigin::At(place) => {
                let (a, b) = (place.distance(crossing), distance / eta);
                (a + b) * (a * (cosine / outside) + b * (outside / cosine))
            }
        };
        Some(Crossing { direction, distance, cosine, spread, triangle: self.triangle })
    }

    /// Returns `true` if a point of the plane is in the facet, or just beside it.
    fn is_near(&self, point: Vec3, normal: Vec3) -> bool {
        let [a, b, c] = self.vertices;
        let double_area = (b - a).cross(c - a).dot(normal);
        [(a, b), (b, c), (c, a)]
            .iter()
            .all(|&(from, to)| (to - from).cross(point - from).dot(normal) >= -ROOM * double_area)
    }
}

/// Lateral distance s at which a ray crosses a plane, from `depth` below it to `height` above it and `lateral` away: the root
/// of η s/√(s² + depth²) = (lateral − s)/√((lateral − s)² + height²), whose difference grows with s.
fn crossing_of_plane(depth: f32, height: f32, lateral: f32, eta: f32) -> Option<f32> {
    if height.is_nan() || height <= 0.0 {
        return None;
    }
    // Refracted away from the normal outside, a ray crosses nearer than the straight line
    let (mut low, mut high) = (0.0, lateral * (depth / (depth + height)));
    let mut s = high / eta;
    for _ in 0..MOST_STEPS {
        let rest = lateral - s;
        let (a, b) = ((s * s + depth * depth).sqrt(), (rest * rest + height * height).sqrt());
        let excess = eta * (s / a) - rest / b;
        if excess > 0.0 {
            high = s;
        } else {
            low = s;
        }
        let slope = eta * (depth / a).powi(2) / a + (height / b).powi(2) / b;
        let newton = s - excess / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let is_done = (next - s).abs() <= 4.0 * f32::EPSILON * (s + depth);
        s = next;
        if is_done {
            break;
        }
    }
    s.is_finite().then_some(s)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn random(i: u32, salt: u32) -> f32 {
        sobol_burley::sample(i, salt, 9)
    }

    fn point(i: u32, salt: u32) -> Vec3 {
        Vec3::new(random(i, salt), random(i, salt + 1), random(i, salt + 2)) - 0.5
    }

    pub(crate) fn facet(i: u32, size: f32) -> Facet {
        let middle = point(i, 0);
        Facet { vertices: [3, 6, 9].map(|salt| middle + size * point(i, salt)), triangle: (0, i) }
    }

    pub(crate) fn query(i: u32) -> Query {
        let place = point(i, 24);
        let beyond = match i % 3 {
            0 => LightOrigin::Along(place.normalize()),
            1 => LightOrigin::At(place * 20.0),
            _ => LightOrigin::At(place * 2.0),
        };
        let side = if i.is_multiple_of(5) { -1.0 } else { 1.0 };
        Query { from: point(i, 20), beyond, reach: 2.0 * random(i, 23), eta: 1.0 + random(i, 27), side }
    }

    /// Snell's law holds at each crossing, and light sent from the place, or in parallel, around the one that comes to the
    /// point spreads as it says.
    #[test]
    fn crossings_obey_snell_and_spread_as_light_does() {
        let mut seen = 0;
        for i in 0..3000 {
            let (facet, query) = (facet(i, 2.0), query(i));
            let Some(crossing) = facet.crossing(&query) else { continue };
            let normal = facet.normal().unwrap().as_dvec3() * f64::from(query.side);
            let (eta, from) = (f64::from(query.eta), query.from.as_dvec3());
            let inside = crossing.direction.as_dvec3();
            let at = from + inside * f64::from(crossing.distance);
            let outside = match query.beyond {
                LightOrigin::At(place) => (place.as_dvec3() - at).normalize(),
                LightOrigin::Along(direction) => direction.as_dvec3(),
            };
            let along = inside * eta - outside;
            let slanted = outside.dot(normal) < 0.02;
            assert!(along.cross(normal).length() < if slanted { 1e-3 } else { 2e-5 }, "{i}");
            assert!(((at - facet.vertices[0].as_dvec3()).dot(normal)).abs() < 1e-5, "{i}");
            if slanted {
                continue;
            }
            // Where light that starts a little beside meets the plane through the point across the light
            let (u, v) = inside.any_orthonormal_pair();
            let (x, y) = outside.any_orthonormal_pair();
            let step = 1e-5;
            let arrives = |dx: f64, dy: f64| {
                let (start, toward) = match query.beyond {
                    LightOrigin::At(place) => (place.as_dvec3(), (-outside + x * dx + y * dy).normalize()),
                    LightOrigin::Along(_) => (at + outside + x * dx + y * dy, -outside),
                };
                let entry = start + toward * ((at - start).dot(normal) / toward.dot(normal));
                let cosine = -toward.dot(normal);
                let bent = (toward + normal * cosine) / eta
                    - normal * (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt();
                let end = entry + bent * ((from - entry).dot(inside) / bent.dot(inside)) - from;
                glam::DVec2::new(end.dot(u), end.dot(v))
            };
            let a = (arrives(step, 0.0) - arrives(-step, 0.0)) / (2.0 * step);
            let b = (arrives(0.0, step) - arrives(0.0, -step)) / (2.0 * step);
            let spread = a.perp_dot(b).abs();
            let found = f64::from(crossing.spread);
            assert!((found / spread - 1.0).abs() < 2e-3, "{i}: {found} {spread} {query:?}");
            seen += 1;
        }
        assert!(seen > 100, "{seen}");
    }
}
