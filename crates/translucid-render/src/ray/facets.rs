//! The flat pieces of a body's surface by place and normal: where light that is refracted reaches a point inside.
//!
//! Light from a place outside crosses the plane of a facet at one point on its way to a point inside. With the directions
//! ω_i from the point inside to there, and ω_o from there on, Snell's law says that η ω_i − ω_o is along the normal. A
//! binary tree with a box and a cone of normals for every node finds the facets for which that can be
//! [B. Walter, S. Zhao, N. Holzschuch & K. Bala 2009, "Single Scattering in Refractive Media with Triangle Mesh
//! Boundaries", ACM Transactions on Graphics 28(3)].

use std::ops::Range;

use glam::Vec3;

/// Facets of a leaf at most.
const LEAF: usize = 4;

/// Facets below which a branch is built by one thread.
const PIECE: usize = 4096;

/// Part of a facet by which a crossing may lie beside it, for rounding: whether it is met is for a ray to say.
const ROOM: f32 = 1e-3;

/// Rounding errors of directions and cosines, generously.
const ROUNDING: f32 = 1e-5;

/// Steps toward the point where light crosses a plane, by Newton's method, and by bisection where that fails.
const MOST_STEPS: u32 = 32;

/// Where light comes from that crosses a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Beyond {
    /// A place.
    At(Vec3),
    /// This unit direction, from wherever it crosses the surface.
    Along(Vec3),
}

/// A way from a point inside through a facet toward a light.
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

/// What a crossing is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Query {
    /// The point inside.
    pub(super) from: Vec3,
    pub(super) beyond: Beyond,
    /// Longest way inside \[L\].
    pub(super) reach: f32,
    /// Refractive index inside over that outside, > 1.
    pub(super) eta: f32,
    /// 1, or −1 where the body is in front of its surfaces.
    pub(super) side: f32,
}

/// A triangle with where it comes from.
#[derive(Clone, Copy)]
pub(super) struct Facet {
    pub(super) vertices: [Vec3; 3],
    /// The object, and the triangle's number there.
    pub(super) triangle: (u32, u32),
}

/// The tree over the facets of a body.
pub(super) struct Facets {
    /// A heap: the children of node i are 2i + 1 and 2i + 2, with half of its facets each; the last level are leaves.
    nodes: Vec<Node>,
    facets: Vec<Facet>,
}

/// A box around facets, and a cone around their normals.
#[derive(Clone, Copy)]
struct Node {
    low: Vec3,
    high: Vec3,
    axis: Vec3,
    /// Cosine of the cone's half-angle.
    cosine: f32,
}

impl Facets {
    /// The tree over facets; those without an area are left out.
    pub(super) fn new(mut facets: Vec<Facet>) -> Self {
        facets.retain(|facet| facet.normal().is_some());
        let mut levels = 0;
        while facets.len() >> levels > LEAF {
            levels += 1;
        }
        let count = facets.len();
        split(&mut facets, count, (0, 0), levels);
        let mut nodes = vec![Node::EMPTY; (2 << levels) - 1];
        let first_leaf = (1 << levels) - 1;
        for (leaf, node) in nodes[first_leaf..].iter_mut().enumerate() {
            *node = Node::around(&facets[range(facets.len(), levels, leaf)]);
        }
        for parent in (0..first_leaf).rev() {
            nodes[parent] = nodes[2 * parent + 1].with(&nodes[2 * parent + 2]);
        }
        Self { nodes, facets }
    }

    /// Calls `found` for every facet through whose plane the light comes to the point near enough to the facet.
    pub(super) fn crossings(&self, query: &Query, mut found: impl FnMut(Crossing)) {
        let first_leaf = self.nodes.len() / 2;
        let levels = (first_leaf + 1).trailing_zeros();
        // One child waits on each level
        let mut waiting = [0_u32; u32::BITS as usize];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let index = waiting[count] as usize;
            if !self.nodes[index].may_cross(query) {
                continue;
            }
            if index < first_leaf {
                waiting[count] = 2 * index as u32 + 2;
                waiting[count + 1] = 2 * index as u32 + 1;
                count += 2;
                continue;
            }
            let facets = &self.facets[range(self.facets.len(), levels, index - first_leaf)];
            facets.iter().filter_map(|facet| facet.crossing(query)).for_each(&mut found);
        }
    }
}

/// Facets of a node, by its place in a level.
fn range(count: usize, level: u32, place: usize) -> Range<usize> {
    // Both factors are below 2³²
    let start = |place: usize| ((place as u64 * count as u64) >> level) as usize;
    start(place)..start(place + 1)
}

/// Sorts the facets of a node, so many of `count` in all, into the leaves below.
fn split(facets: &mut [Facet], count: usize, (level, place): (u32, usize), levels: u32) {
    if level == levels {
        return;
    }
    let (low, high) = bounds(facets.iter().map(Facet::middle));
    let axis = (high - low).max_position();
    let middle = range(count, level + 1, 2 * place).len();
    facets.select_nth_unstable_by(middle, |a, b| {
        a.middle()[axis].total_cmp(&b.middle()[axis]).then(a.triangle.cmp(&b.triangle))
    });
    let (left, right) = facets.split_at_mut(middle);
    let is_large = left.len() >= PIECE;
    let mut left = || split(left, count, (level + 1, 2 * place), levels);
    let mut right = || split(right, count, (level + 1, 2 * place + 1), levels);
    if is_large {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
}

/// Least and greatest coordinates.
fn bounds(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    points.fold(nothing, |(low, high), point| (low.min(point), high.max(point)))
}

impl Facet {
    fn middle(&self) -> Vec3 {
        let [a, b, c] = self.vertices;
        (a + b + c) / 3.0
    }

    /// Unit normal; `None` without an area.
    fn normal(&self) -> Option<Vec3> {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a).try_normalize()
    }

    /// The way of the light through the facet's plane, if it is not far beside the facet.
    fn crossing(&self, query: &Query) -> Option<Crossing> {
        let &Query { from, beyond, reach, eta, side } = query;
        let outward = self.normal()?;
        let normal = outward * side;
        let depth = (self.vertices[0] - from).dot(normal);
        // A NaN fails the comparison
        if !(depth > 0.0 && depth < reach) {
            return None;
        }
        let toward = match beyond {
            Beyond::Along(direction) => direction,
            Beyond::At(place) => {
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
            Beyond::Along(_) => cosine / outside,
            Beyond::At(place) => {
                let (a, b) = (place.distance(crossing), distance / eta);
                (a + b) * (a * (cosine / outside) + b * (outside / cosine))
            }
        };
        Some(Crossing { direction, distance, cosine, spread, triangle: self.triangle })
    }

    /// Whether a point of the plane is in the facet, or just beside.
    fn is_near(&self, point: Vec3, normal: Vec3) -> bool {
        let [a, b, c] = self.vertices;
        let double_area = (b - a).cross(c - a).dot(normal);
        [(a, b), (b, c), (c, a)]
            .iter()
            .all(|&(from, to)| (to - from).cross(point - from).dot(normal) >= -ROOM * double_area)
    }
}

/// How far sideways a ray from a depth below a plane crosses it on its way to a height above and so much `lateral`
/// distance: the root s of η s/√(s² + depth²) = (lateral − s)/√((lateral − s)² + height²), whose difference grows with s.
fn crossing_of_plane(depth: f32, height: f32, lateral: f32, eta: f32) -> Option<f32> {
    if !(height > 0.0) {
        return None;
    }
    // Refracted away from the normal outside, a ray crosses nearer than the straight line
    let (mut low, mut high) = (0.0, lateral * (depth / (depth + height)));
    let mut s = high / eta;
    for _ in 0..MOST_STEPS {
        let rest = lateral - s;
        let (a, b) = (s.hypot(depth), rest.hypot(height));
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

impl Node {
    const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, axis: Vec3::Z, cosine: 1.0 };

    fn around(facets: &[Facet]) -> Self {
        let (low, high) = bounds(facets.iter().flat_map(|facet| facet.vertices));
        let normals = || facets.iter().filter_map(Facet::normal);
        let axis = normals().sum::<Vec3>().normalize_or(Vec3::Z);
        Self { low, high, axis, cosine: normals().map(|normal| normal.dot(axis)).fold(1.0, f32::min) }
    }

    /// The node around two.
    fn with(&self, other: &Self) -> Self {
        if self.low.x > self.high.x {
            return *other;
        }
        if other.low.x > other.high.x {
            return *self;
        }
        let (low, high) = (self.low.min(other.low), self.high.max(other.high));
        // Around the middle of both axes each cone reaches as far as it is wide, and as its axis is off
        let axis = (self.axis + other.axis).normalize_or(Vec3::Z);
        let cosine = [self, other].map(|node| widened(node.cosine, node.axis.dot(axis)));
        Self { low, high, axis, cosine: cosine[0].min(cosine[1]) }
    }

    /// Whether light may come to the point through a facet of the node.
    fn may_cross(&self, &Query { from, beyond, reach, eta, side }: &Query) -> bool {
        let off = (self.low - from).max(from - self.high).max(Vec3::ZERO);
        if !(off.length_squared() < reach * reach) {
            return false;
        }
        let middle = 0.5 * (self.low + self.high);
        let radius = 0.5 * (self.high - self.low).length();
        let (inside, room_inside) = directions(middle - from, radius);
        let (outside, room_outside) = match beyond {
            Beyond::Along(direction) => (direction, 0.0),
            Beyond::At(place) => directions(place - middle, radius),
        };
        let along = inside * eta - outside;
        let length = along.length();
        let room = (eta * room_inside + room_outside + ROUNDING) / length;
        if !(room < 1.0) {
            return true;
        }
        let widest = widened(self.cosine, (1.0 - room * room).sqrt());
        along.dot(self.axis) * side >= length * (widest - ROUNDING)
    }
}

/// Directions to a ball: the middle one, and how much the others differ from it at most.
fn directions(to: Vec3, radius: f32) -> (Vec3, f32) {
    let distance = to.length();
    let sine = radius / distance;
    if !(sine < 1.0) {
        return (Vec3::ZERO, 2.0);
    }
    // The chord of an angle is its sine over the cosine of its half, which is below this up to 90°
    (to / distance, sine * (1.0 + 0.4143 * sine * sine))
}

/// Cosine of the sum of two angles, in [0°, 180°] each, by their cosines; −1 from 180° on.
fn widened(a: f32, b: f32) -> f32 {
    if a <= -b {
        return -1.0;
    }
    let sine = |cosine: f32| (1.0 - cosine * cosine).max(0.0).sqrt();
    a * b - sine(a) * sine(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(i: u32, salt: u32) -> f32 {
        sobol_burley::sample(i, salt, 9)
    }

    fn point(i: u32, salt: u32) -> Vec3 {
        Vec3::new(random(i, salt), random(i, salt + 1), random(i, salt + 2)) - 0.5
    }

    fn facet(i: u32, size: f32) -> Facet {
        let middle = point(i, 0);
        Facet { vertices: [3, 6, 9].map(|salt| middle + size * point(i, salt)), triangle: (0, i) }
    }

    fn query(i: u32) -> Query {
        let place = point(i, 24);
        let beyond = match i % 3 {
            0 => Beyond::Along(place.normalize()),
            1 => Beyond::At(place * 20.0),
            _ => Beyond::At(place * 2.0),
        };
        let side = if i % 5 == 0 { -1.0 } else { 1.0 };
        Query { from: point(i, 20), beyond, reach: 2.0 * random(i, 23), eta: 1.0 + random(i, 27), side }
    }

    /// The tree finds what a loop over all facets does.
    #[test]
    fn all_crossings_are_found() {
        for count in [0, 1, 5, 300, 20_000] {
            let facets: Vec<Facet> = (0..count).map(|i| facet(i, 0.2)).collect();
            let tree = Facets::new(facets.clone());
            let mut all = 0;
            for i in 0..300 {
                let query = query(i);
                let mut found = Vec::new();
                tree.crossings(&query, |crossing| found.push(crossing.triangle));
                found.sort_unstable();
                let met = |facet: &Facet| {
                    let crossing = facet.crossing(&query)?;
                    // Those beside a facet may lie outside its node
                    let at = query.from + crossing.direction * crossing.distance;
                    Some((crossing.triangle, facet.barycentric(at).min_element() >= 0.0))
                };
                let expected: Vec<_> = facets.iter().filter_map(met).collect();
                let is_met = |triangle: &(u32, u32)| found.binary_search(triangle).is_ok();
                assert!(expected.iter().filter(|(_, inside)| *inside).all(|(triangle, _)| is_met(triangle)));
                assert!(found.iter().all(|found| expected.iter().any(|(triangle, _)| found == triangle)));
                all += found.len();
            }
            assert!(all >= count as usize / 10, "{count}: {all}");
        }
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
                Beyond::At(place) => (place.as_dvec3() - at).normalize(),
                Beyond::Along(direction) => direction.as_dvec3(),
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
                    Beyond::At(place) => (place.as_dvec3(), (-outside + x * dx + y * dy).normalize()),
                    Beyond::Along(_) => (at + outside + x * dx + y * dy, -outside),
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

    /// Nothing that a mesh, a body or a light can be makes a way that is no number.
    #[test]
    fn extremes_stay_finite() {
        let lengths = [0.0, 1e-30, 1e-6, 1.0, 1e12, 1e30];
        let mut seen = 0;
        for (i, &size) in lengths.iter().enumerate() {
            for (j, &depth) in lengths.iter().enumerate() {
                for &distance in &lengths {
                    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| (corner - 0.25) * size);
                    let facet =
                        Facet { vertices: corners.map(|corner| corner.with_z(0.0)), triangle: (0, 0) };
                    let tree = Facets::new(vec![facet]);
                    let toward = Vec3::new(0.3 * i as f32, 0.2, 0.1 * j as f32 + 1e-3).normalize();
                    for beyond in [Beyond::At(toward * distance), Beyond::Along(toward)] {
                        let query = Query {
                            from: Vec3::NEG_Z * depth,
                            beyond,
                            reach: f32::INFINITY,
                            eta: 1.5,
                            side: 1.0,
                        };
                        tree.crossings(&query, |crossing| {
                            let Crossing { direction, distance, cosine, spread, .. } = crossing;
                            assert!(direction.is_finite() && distance.is_finite(), "{query:?} {crossing:?}");
                            assert!(cosine > 0.0 && spread >= 0.0, "{query:?} {crossing:?}");
                            seen += 1;
                        });
                    }
                }
            }
        }
        assert!(seen > 20, "{seen}");
    }

    impl Facet {
        fn barycentric(&self, point: Vec3) -> Vec3 {
            let [a, b, c] = self.vertices;
            let normal = (b - a).cross(c - a);
            let part =
                |from: Vec3, to: Vec3| (to - from).cross(point - from).dot(normal) / normal.length_squared();
            Vec3::new(part(a, b), part(b, c), part(c, a))
        }
    }
}
