//! The body that lies below a surface: surfaces of one subsurface group, as a path through the inside meets them.

use glam::Vec3;

use translucid_scene::{Object, Scene};

use super::clearance::Clearance;
use super::facets::{Crossing, Facets, LightOrigin, Query};
use super::geometry::{Geometry, SurfacePoint};
use super::hit::{Hit, offset_at};
use super::instances::LoneInstance;
use super::triangle::Ray;

/// Surfaces between a point in the body and where it ends: meshes of a group that overlap, or that are doubled.
const MOST_SURFACES: u32 = 64;

/// Cosine to the normal below which a path begins below its ray rather than on it: the way to there would be long.
const GRAZING: f32 = 0.1;

/// A point inside a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inside {
    pub(crate) position: Vec3,
    /// Closed meshes that the point is in.
    nesting: u32,
}

/// The body.
#[derive(Clone, Copy)]
pub(crate) struct Body<'a> {
    geometry: &'a Geometry,
    clearance: Option<&'a Clearance>,
    group: u32,
    /// The only object of the group, if it shares its mesh.
    alone: Option<LoneInstance<'a>>,
    /// 1, or −1 where the surface is seen from its back: the body is then in front of its surfaces.
    side: f32,
    /// Distance from surfaces at which a point is safely on one side \[L\].
    offset: f32,
}

/// Diagonals of the scene beyond which a walk has left an open mesh for good: hardly any would find the way back.
const FARTHEST: f32 = 2.0;

/// Part of the way to a facet after which it has been met, whatever the rounding.
const BEYOND_CROSSING: f32 = 1.001;

/// The end of a flight.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FlightEnd {
    /// It ends inside.
    Inside(Inside),
    /// It meets the body's end after a distance.
    Boundary { distance: f32, hit: Hit },
}

impl Inside {
    /// Just below the surface.
    fn below(position: Vec3) -> Self {
        Self { position, nesting: 1 }
    }
}

impl<'a> Body<'a> {
    /// The body below a surface that is seen from its outside (`side` 1) or, in an open mesh, from its inside (−1).
    pub(crate) fn below(scene: &'a Scene, geometry: &'a Geometry, point: &SurfacePoint, side: f32) -> Self {
        let alone = geometry.alone(point.object);
        let clearance = match alone {
            Some(_) => None,
            None => geometry.clearance(&scene.objects, point.group),
        };
        Self { geometry, clearance, group: point.group, alone, side, offset: point.offset }
    }

    /// Lower bound of the distance \[L\] from a point to the body's surfaces.
    fn clear_around(&self, point: Vec3) -> f32 {
        match (self.alone, self.clearance) {
            (Some(alone), _) => alone.clearance(point, self.geometry.cells()),
            (None, Some(clearance)) => clearance.at(point),
            (None, None) => 0.0,
        }
    }

    /// Returns `true` if closed surfaces bound the body: flights end there, and a point is inside whatever the way to it.
    pub(crate) fn is_bounded(&self) -> bool {
        let orientation = match (self.alone, self.clearance) {
            (Some(alone), _) => alone.orientation(self.geometry.cells()),
            (None, Some(clearance)) => clearance.orientation,
            (None, None) => 0.0,
        };
        orientation * self.side > 0.0
    }

    /// The nearest of the body's surfaces.
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        match self.alone {
            Some(alone) => alone.closest(ray),
            None => self.geometry.closest_in_group(ray, self.group),
        }
    }

    /// Where a direction into the body begins below a surface point, and the way from the point to there \[L\]; `None` if
    /// the direction leads outside.
    pub(crate) fn enter(&self, point: &SurfacePoint, direction: Vec3) -> Option<(Inside, f32)> {
        let normal = point.geometric_normal * self.side;
        let cosine = -direction.dot(normal);
        // On the ray where it is deep enough, unless it hardly gets deeper
        let skipped = self.offset / cosine.max(GRAZING);
        let start = point.position + direction * skipped - normal * (self.offset - skipped * cosine);
        (cosine > 0.0).then(|| (Inside::below(start), skipped))
    }

    /// Returns `true` if a flight surely ends inside, in any direction; takes no ray.
    pub(crate) fn surely_holds(&self, from: Inside, length: f32) -> bool {
        length + self.offset <= self.clear_around(from.position)
    }

    /// Height \[L\] of the surface above the plane of one of its points, where a ray from such a `depth` below the point
    /// through an offset in that plane meets it; `None` where the ray does not come to it from inside, or only farther
    /// `beyond` the plane.
    pub(crate) fn height_beside(
        &self,
        point: &SurfacePoint,
        offset: Vec3,
        depth: f32,
        beyond: f32,
    ) -> Option<f32> {
        let down = point.geometric_normal * (-self.side * depth);
        let (direction, length) = (offset - down).normalize_and_length();
        let hit = self.closest(&Ray::segment(point.position + down, direction, length + beyond))?;
        let leaves = direction.dot(self.geometry.normal(&hit)) * self.side > 0.0;
        leaves.then(|| (hit.t - length) * (depth / length))
    }

    /// Follows a flight from a point inside.
    ///
    /// A collision nearer to the body's end than rounding allows counts as a little before it: on the other side the walk
    /// would never leave again.
    pub(crate) fn fly(&self, from: Inside, direction: Vec3, length: f32) -> FlightEnd {
        if self.surely_holds(from, length) {
            return FlightEnd::Inside(Inside { position: from.position + direction * length, ..from });
        }
        let mut nesting = from.nesting;
        let mut done = 0.0;
        for _ in 0..MOST_SURFACES {
            let start = from.position + direction * done;
            let ray = Ray::segment(start, direction, length - done + self.offset);
            let Some(hit) = self.closest(&ray) else { break };
            let distance = done + hit.t;
            let leaves = direction.dot(self.geometry.normal(&hit)) * self.side > 0.0;
            if leaves && nesting <= 1 {
                if distance <= length {
                    return FlightEnd::Boundary { distance, hit };
                }
                let position = from.position + direction * (distance - self.offset).max(0.0);
                return FlightEnd::Inside(Inside { position, nesting });
            }
            if distance > length {
                break;
            }
            nesting = if leaves { nesting - 1 } else { nesting + 1 };
            done = distance + self.offset;
        }
        FlightEnd::Inside(Inside { position: from.position + direction * length, nesting })
    }

    /// The end of a flight that has left the body after a distance, if there the body goes on behind a gap; calls `leave`
    /// wherever it leaves the body again.
    pub(crate) fn behind(
        &self,
        from: Inside,
        direction: Vec3,
        distance: f32,
        length: f32,
        mut leave: impl FnMut(f32, Hit),
    ) -> Option<Inside> {
        let position = from.position + direction * length;
        let mut nesting = 0_u32;
        let mut done = distance + self.offset;
        for _ in 0..MOST_SURFACES {
            let ray = Ray::segment(from.position + direction * done, direction, length - done);
            let hit = if done < length { self.closest(&ray) } else { None };
            let Some(hit) = hit else {
                return (nesting > 0 && position.is_finite()).then_some(Inside { position, nesting });
            };
            let leaves = direction.dot(self.geometry.normal(&hit)) * self.side > 0.0;
            if leaves && nesting == 1 {
                leave(done + hit.t, hit);
            }
            nesting = if leaves { nesting.saturating_sub(1) } else { nesting + 1 };
            done += hit.t + self.offset;
        }
        None
    }

    /// Returns `true` if the segment between two points lies in the body; the second has the surface's normal on the body's
    /// surface, and 0 inside.
    pub(crate) fn connects(&self, from: Inside, to: Vec3, normal: Vec3) -> bool {
        let (direction, length) = (to - from.position).normalize_and_length();
        // Collisions lie that much before the body's end. The place of the end itself is no more exact, which along a ray that
        // grazes it is a long way
        let of_end = match self.alone {
            Some(alone) => alone.offset_at(to),
            None => offset_at(to.abs().max_element()),
        };
        let offset = self.offset.max(of_end);
        let cosine = if normal == Vec3::ZERO { 1.0 } else { direction.dot(normal).max(f32::EPSILON) };
        length <= self.clear_around(from.position) + self.clear_around(to)
            || matches!(self.fly(from, direction, length - offset / cosine), FlightEnd::Inside(_))
    }

    /// Calls `found` for every refracted way on which light from outside could reach a point through a facet, if nothing were
    /// in between; `objects` are those of the scene, `eta` > 1 the index inside over that outside.
    pub(crate) fn crossings(
        &self,
        objects: &[Object],
        (from, reach): (Inside, f32),
        beyond: LightOrigin,
        eta: f32,
        found: impl FnMut(Crossing),
    ) {
        if self.surely_holds(from, reach) {
            return;
        }
        let query = Query { from: from.position, beyond, reach, eta, side: self.side };
        match self.alone.filter(LoneInstance::keeps_angles) {
            Some(alone) => alone.crossings(&query, found),
            None => {
                if let Some(facets) = self.geometry.facets(objects, self.group) {
                    facets.crossings(&query, found);
                }
            }
        }
    }

    /// The surfaces of the body, for their distances; `objects` are those of the scene.
    pub(crate) fn depths(&self, objects: &[Object]) -> Depths<'a> {
        let facets = match self.alone.filter(LoneInstance::keeps_angles) {
            Some(alone) => Some(alone.facets()),
            None => self.geometry.facets(objects, self.group),
        };
        Depths(facets)
    }

    /// Distance \[L\] from a point to the nearest surface: exact below `enough`; from there on a lower bound, which is not
    /// below `enough`, and mostly exact below `reach`.
    pub(crate) fn depth(&self, depths: &Depths<'_>, point: Vec3, enough: f32, reach: f32) -> f32 {
        let bound = self.clear_around(point);
        if bound >= enough {
            return bound;
        }
        match (self.alone.filter(LoneInstance::keeps_angles), depths.0) {
            (Some(alone), Some(facets)) => alone.distance(facets, point, reach),
            (None, Some(facets)) => facets.distance(point, reach),
            (_, None) => bound,
        }
    }

    /// Where the body ends on a way through a facet, if it ends there.
    pub(crate) fn end_at(&self, from: Inside, crossing: &Crossing) -> Option<Hit> {
        let beyond = crossing.distance * BEYOND_CROSSING + self.offset;
        let FlightEnd::Boundary { hit, .. } = self.fly(from, crossing.direction, beyond) else { return None };
        (self.geometry.object_and_triangle_of(&hit) == crossing.triangle).then_some(hit)
    }

    /// Returns `true` if a point is too far off to come back to the body, or not finite.
    pub(crate) fn is_lost(&self, at: &Inside) -> bool {
        let (low, high) = self.geometry.bounds();
        let farthest = (high - low) * FARTHEST;
        let off = (at.position - 0.5 * (low + high)).length_squared();
        off.is_nan() || off > farthest.length_squared()
    }

    /// Outward normal of a surface that a direction inside meets.
    pub(crate) fn normal(&self, hit: &Hit) -> Vec3 {
        self.geometry.normal(hit) * self.side
    }

    /// The point just inside a surface at which a walk is reflected.
    pub(crate) fn reflected(&self, hit: &Hit) -> Inside {
        Inside::below(self.geometry.position(hit) - self.normal(hit) * self.offset)
    }
}

/// The surfaces of a body, for their distances.
#[derive(Clone, Copy)]
pub(crate) struct Depths<'a>(Option<&'a Facets>);

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use translucid_scene::Object;
    use translucid_shapes::{ShapeParameters, build_shape};

    use super::*;

    /// Boxes of one group, by their x and half their height and depth: the first two overlap, the third lies behind a gap.
    const BOXES: [(Range<f32>, f32); 3] = [(0.0..1.0, 0.5), (0.7..1.9, 0.45), (2.2..3.0, 0.55)];

    /// Boxes that a point is in.
    fn nesting(at: Vec3) -> u32 {
        let holds = |(x, half): &&(Range<f32>, f32)| x.contains(&at.x) && at.y.abs().max(at.z.abs()) < *half;
        BOXES.iter().filter(holds).count() as u32
    }

    /// Distances between which a line is in each of the boxes that it meets, from near to far.
    fn ways_through(from: Vec3, direction: Vec3) -> Vec<Range<f64>> {
        let way = |(x, half): &(Range<f32>, f32)| {
            let (low, high) = (Vec3::new(x.start, -half, -half), Vec3::new(x.end, *half, *half));
            let [a, b] = [low, high].map(|corner| (corner - from).as_dvec3() / direction.as_dvec3());
            a.min(b).max_element()..a.max(b).min_element()
        };
        let mut ways: Vec<Range<f64>> = BOXES.iter().map(way).filter(|way| !way.is_empty()).collect();
        ways.sort_by(|a, b| a.start.total_cmp(&b.start));
        ways
    }

    /// Distances between which a line is in any of them.
    fn union(ways: &[Range<f64>]) -> Vec<Range<f64>> {
        let mut union: Vec<Range<f64>> = Vec::new();
        for way in ways {
            match union.last_mut().filter(|last| last.end >= way.start) {
                Some(last) => last.end = last.end.max(way.end),
                None => union.push(way.clone()),
            }
        }
        union
    }

    /// Flights through boxes against intervals along the line: their ends, the boxes behind gaps, and visibility.
    #[test]
    fn flights_are_those_through_a_union_of_boxes() {
        let objects = BOXES.map(|(x, half)| {
            let mut mesh =
                build_shape("box", &ShapeParameters::new().with("edge_radius", 0.0)).expect("a box");
            let size = Vec3::new(0.5 * (x.end - x.start), half, half);
            mesh.positions.iter_mut().for_each(|p| *p = *p * size + Vec3::X * (0.5 * (x.start + x.end)));
            Object {
                name: "box".into(),
                mesh: mesh.into(),
                material: 0,
                subsurface_group: 7,
                ..Object::default()
            }
        });
        let geometry = Geometry::new(&objects);
        let clearances = [None, geometry.clearance(&objects, 7)];
        let (mut behind, mut left) = (0, 0);
        for i in 0..20_000 {
            let random = |salt: u32| sobol_burley::sample(i, salt, 5);
            let place =
                |salt: u32| Vec3::new(3.0 * random(salt), random(salt + 1) - 0.5, random(salt + 2) - 0.5);
            let position = place(0);
            let target = position + (place(3) - position) * (2.0 * random(6));
            let from = Inside { position, nesting: nesting(position) };
            let (direction, length) = (target - position).normalize_and_length();
            let ways = ways_through(position, direction);
            let mut places: Vec<f64> = ways.iter().flat_map(|way| [way.start, way.end]).collect();
            places.extend([0.0, f64::from(length)]);
            places.sort_by(f64::total_cmp);
            // Surfaces closer to each other than rounding errors count as one, and a grazed one may count twice
            let is_close = |a: f64, b: f64| (a - b).abs() < 1e-4;
            let is_grazing = direction.abs().min_element() < 0.05;
            if from.nesting == 0 || is_grazing || places.windows(2).any(|pair| is_close(pair[0], pair[1])) {
                continue;
            }
            let ways = union(&ways);
            for clearance in clearances {
                let body =
                    Body { geometry: &geometry, clearance, group: 7, alone: None, side: 1.0, offset: 3e-6 };
                let first = ways.iter().find(|way| way.contains(&0.0)).expect("it is inside").end;
                let is_seen = first > f64::from(length);
                let is_inside = nesting(target) > 0;
                if is_inside {
                    assert_eq!(body.connects(from, target, Vec3::ZERO), is_seen, "{position} {target}");
                }
                let FlightEnd::Boundary { distance, hit } = body.fly(from, direction, length) else {
                    assert!(is_seen, "{position} {target}");
                    continue;
                };
                assert!(is_close(distance.into(), first) && !is_seen, "{position} {target}");
                let (end, normal) = (position + direction * distance, body.normal(&hit));
                assert!(
                    normal.dot(direction) > 0.0 && body.connects(from, end, normal),
                    "{position} {target}"
                );
                let mut leaves = Vec::new();
                let found = body
                    .behind(from, direction, distance, length, |distance, hit| leaves.push((distance, hit)));
                let expected: Vec<f64> = ways
                    .iter()
                    .map(|way| way.end)
                    .filter(|end| *end > first + 1e-4 && *end < f64::from(length))
                    .collect();
                assert_eq!(leaves.len(), expected.len(), "{position} {target}: {leaves:?} {expected:?}");
                for ((distance, hit), expected) in leaves.into_iter().zip(expected) {
                    let (end, normal) = (position + direction * distance, body.normal(&hit));
                    assert!(is_close(distance.into(), expected), "{position} {target}");
                    assert!(!body.connects(from, end, normal), "{position} {target}");
                    left += 1;
                }
                assert_eq!(
                    found.map(|at| at.nesting),
                    is_inside.then(|| nesting(target)),
                    "{position} {target}"
                );
                behind += u32::from(found.is_some());
            }
        }
        assert!(behind > 1000 && left > 100, "{behind} {left}");
    }

    /// A flight that has met the body's end has seen it: also in a needle, and where the surface that the walk began at is
    /// so near the origin that its own rounding errors are small.
    #[test]
    fn ends_of_flights_are_seen() {
        for (half, largest) in [(Vec3::ONE, 1e-3), (Vec3::new(1.5, 0.01, 0.01), 1.5)] {
            let mut mesh =
                build_shape("box", &ShapeParameters::new().with("edge_radius", 0.0)).expect("a box");
            mesh.positions.iter_mut().for_each(|p| *p *= half);
            let objects = [Object { mesh: mesh.into(), ..Object::default() }];
            let geometry = Geometry::new(&objects);
            let offset = offset_at(largest);
            let body =
                Body { geometry: &geometry, clearance: None, group: 0, alone: None, side: 1.0, offset };
            let mut hidden = 0;
            for i in 0..20_000 {
                let random = |salt: u32| 2.0 * sobol_burley::sample(i, salt, 5) - 1.0;
                let from = Inside::below(Vec3::new(random(0), random(1), random(2)) * half * 0.999);
                let direction = Vec3::new(random(3), random(4), random(5)).normalize();
                let FlightEnd::Boundary { hit, .. } = body.fly(from, direction, 10.0) else {
                    panic!("no end from {from:?} toward {direction}");
                };
                let end = geometry.position(&hit);
                hidden += u32::from(!body.connects(from, end, body.normal(&hit)));
            }
            // Where edges are a thousandth of a triangle's length, distances along a ray are not always that exact
            assert!(hidden <= 40, "{half}: {hidden}");
        }
    }
}
