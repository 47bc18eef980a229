//! The lights with a surface that rays can meet, in a hierarchy of boxes if there are many.

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;

use super::LightHit;
use super::emitters::PlacedLight;
use crate::ray::BinaryBuilder;

/// Up to this many are tested one by one.
const MOST_TESTED: usize = 8;

/// Room around boxes for rounding, relative to their coordinates.
const BOX_ROOM: f32 = 8.0 * f32::EPSILON;

/// Widens the interval in which a ray is within a box, see `wide_tree`: relative to the distance.
const WIDEN: f32 = 8.0 * f32::EPSILON;

/// Lights with a surface among a scene's lights.
#[derive(Clone, Debug)]
pub(crate) struct Surfaces {
    /// Their numbers.
    lights: Vec<u32>,
    hierarchy: Option<LightHierarchy>,
}

/// Boxes over the lights.
#[derive(Clone, Debug)]
struct LightHierarchy {
    nodes: Vec<Bvh2Node>,
    /// Places among the lights, in the order of the leaves.
    places: Vec<u32>,
}

impl Surfaces {
    pub(crate) fn new(sources: &[PlacedLight]) -> Self {
        let lights: Vec<u32> = (0..sources.len())
            .filter(|&light| sources[light].is_surface())
            .map(|light| light as u32)
            .collect();
        let boxes: Vec<Aabb> =
            lights.iter().filter_map(|&light| roomy_box(&sources[light as usize])).collect();
        // Without a box for each of them there is no hierarchy.
        let hierarchy = (lights.len() > MOST_TESTED && boxes.len() == lights.len()).then(|| {
            let mut builder = BinaryBuilder::default();
            builder.build(&boxes);
            let (nodes, places) = builder.into_parts();
            LightHierarchy { nodes, places }
        });
        Self { lights, hierarchy }
    }

    /// The nearest one that a ray meets before `t_max` on the side that emits, among those that `counts` accepts by
    /// their visibility to the camera.
    #[inline]
    pub(crate) fn nearest(
        &self,
        sources: &[PlacedLight],
        ray: (Vec3, Vec3),
        t_max: f32,
        counts: impl Fn(bool) -> bool,
    ) -> Option<LightHit> {
        let mut nearest = None;
        let mut limit = t_max;
        let mut test = |light: u32| {
            if let Some(hit) = intersect(sources, light, ray, &counts).filter(|hit| hit.t < limit) {
                limit = hit.t;
                nearest = Some(hit);
            }
            limit
        };
        match &self.hierarchy {
            None => self.lights.iter().for_each(|&light| {
                test(light);
            }),
            Some(hierarchy) => traverse(hierarchy, ray, t_max, |place| test(self.lights[place])),
        }
        nearest
    }
}

#[inline]
fn intersect(
    sources: &[PlacedLight],
    light: u32,
    (origin, direction): (Vec3, Vec3),
    counts: impl Fn(bool) -> bool,
) -> Option<LightHit> {
    let light = light as usize;
    let (t, radiance) = sources[light].intersect((origin, direction), counts)?;
    Some(LightHit { t, radiance, position: origin + direction * t, light })
}

/// Calls `test` for the primitives whose boxes a ray meets before the distance that it returned last.
fn traverse(
    hierarchy: &LightHierarchy,
    (origin, direction): (Vec3, Vec3),
    t_max: f32,
    mut test: impl FnMut(usize) -> f32,
) {
    // A finite stand-in for 1/0 keeps 0·∞ out of the test.
    let inverse = |d: f32| if d.abs() < 1e-18 { 1e18_f32.copysign(d) } else { 1.0 / d };
    let inverse = Vec3A::new(inverse(direction.x), inverse(direction.y), inverse(direction.z));
    let origin = Vec3A::from(origin);
    let enters = |node: usize, limit: f32| {
        let &Aabb { min, max } = hierarchy.nodes[node].aabb();
        let (a, b) = ((min - origin) * inverse, (max - origin) * inverse);
        let begin = a.min(b).max_element().max(0.0);
        let end = a.max(b).min_element();
        (begin * (1.0 - WIDEN) <= (end * (1.0 + WIDEN)).min(limit)).then_some(begin)
    };
    let mut limit = t_max;
    let mut open = TraversalStack::new();
    if let Some(t) = enters(0, limit) {
        open.push((0, t));
    }
    while let Some((index, t)) = open.pop() {
        if t * (1.0 - WIDEN) > limit {
            continue;
        }
        let node = &hierarchy.nodes[index as usize];
        let first = node.first_index as usize;
        if node.is_leaf() {
            for place in first..first + node.prim_count as usize {
                limit = test(hierarchy.places[place] as usize);
            }
            continue;
        }
        match (enters(first, limit), enters(first + 1, limit)) {
            (Some(left), Some(right)) if left > right => {
                open.push((first as u32, left));
                open.push((first as u32 + 1, right));
            }
            (left, right) => {
                right.into_iter().for_each(|t| open.push((first as u32 + 1, t)));
                left.into_iter().for_each(|t| open.push((first as u32, t)));
            }
        }
    }
}

/// Nodes yet to visit with the distance to them: an array, and beyond it memory that only degenerate trees need.
struct TraversalStack {
    array: [(u32, f32); Self::ARRAY],
    used: usize,
    overflow: Vec<(u32, f32)>,
}

impl TraversalStack {
    const ARRAY: usize = 48;

    fn new() -> Self {
        Self { array: [(0, 0.0); Self::ARRAY], used: 0, overflow: Vec::new() }
    }

    fn push(&mut self, visit: (u32, f32)) {
        if self.used < Self::ARRAY {
            self.array[self.used] = visit;
            self.used += 1;
        } else {
            self.overflow.push(visit);
        }
    }

    fn pop(&mut self) -> Option<(u32, f32)> {
        if let Some(visit) = self.overflow.pop() {
            return Some(visit);
        }
        self.used = self.used.checked_sub(1)?;
        Some(self.array[self.used])
    }
}

/// A box a little larger than a light.
fn roomy_box(light: &PlacedLight) -> Option<Aabb> {
    let bounds = light.bounds()?;
    let (low, high) = (Vec3A::from(bounds.low), Vec3A::from(bounds.high));
    let room = low.abs().max(high.abs()).max_element() * BOX_ROOM;
    let found = Aabb::new(low - room, high + room);
    (found.min.is_finite() && found.max.is_finite()).then_some(found)
}
