//! The facets of a body's surface in a tree, by place and normal: through which of them refracted light reaches a point
//! inside.
//!
//! Light from a place outside crosses the plane of a facet at one point on its way to a point inside. With the directions
//! ω_i from the point inside to there, and ω_o from there on, η ω_i − ω_o is along the normal by Snell's law. A
//! binary tree with a box and a cone of normals for every node finds the facets where that is possible
//! [B. Walter, S. Zhao, N. Holzschuch & K. Bala 2009, "Single Scattering in Refractive Media with Triangle Mesh
//! Boundaries", ACM Transactions on Graphics 28(3)].

mod cone;
mod crossing;
mod lanes;
mod nearest;

use std::ops::Range;

use glam::Vec3;

use cone::NormalCone;
pub(crate) use crossing::{Crossing, LightOrigin};
pub(super) use crossing::{Facet, Query};
use lanes::{FacetNode, LANES, Leaf};

/// Nodes that wait at most on the way down: all but one child on each level of a tree over 2³² facets.
const MOST_WAITING: usize = 96;

/// Levels of a binary tree that are one of this.
const BINARY: u32 = LANES.ilog2();

/// The tree over the facets of a body.
pub(super) struct Facets {
    /// Level after level, then come the leaves: after the root its children, then the eight children of each of those.
    nodes: Vec<FacetNode>,
    leaves: Vec<Leaf>,
    /// Children of the root.
    first: usize,
    facets: Vec<Facet>,
}

impl Facets {
    /// The tree over facets; those without an area are left out.
    ///
    /// On one thread: other threads may wait for the tree, and a thread that waits for help could be given work that waits for
    /// it, too.
    pub(super) fn new(mut facets: Vec<Facet>) -> Self {
        facets.retain(|facet| facet.normal().is_some());
        let count = facets.len();
        let mut levels = 0;
        while count > LANES << levels {
            levels += 1;
        }
        split(&mut facets, count, (0, 0), levels);
        let of_leaf = |place: usize| &facets[range(count, levels, place)];
        let leaves: Vec<Leaf> = (0..1 << levels).map(|place| Leaf::new(of_leaf(place))).collect();

        // Cones of a binary tree as a heap, of which every third level is kept
        let inner = leaves.len() - 1;
        let mut cones = vec![NormalCone::EMPTY; inner];
        cones.extend((0..leaves.len()).map(|place| NormalCone::around(of_leaf(place))));
        for parent in (0..inner).rev() {
            cones[parent] = cones[2 * parent + 1].with(&cones[2 * parent + 2]);
        }
        let mut nodes = Vec::new();
        let mut level = 0;
        let mut below = if levels % BINARY == 0 { BINARY } else { levels % BINARY };
        let first = 1 << below;
        while level < levels {
            for place in 0..1 << level {
                let children = (place << below)..((place + 1) << below);
                let first_of_level = (1 << (level + below)) - 1;
                nodes.push(FacetNode::new(children.map(|child: usize| &cones[first_of_level + child])));
            }
            (level, below) = (level + below, BINARY);
        }
        Self { nodes, leaves, first, facets }
    }

    /// Calls `found` for every facet through whose plane the light comes to the point near enough to the facet.
    pub(super) fn crossings(&self, query: &Query, mut found: impl FnMut(Crossing)) {
        let levels = self.leaves.len().ilog2();
        let mut waiting = [0_u32; MOST_WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let index = waiting[count] as usize;
            if let Some(node) = self.nodes.get(index) {
                let child = if index == 0 { 1 } else { 1 + self.first + (index - 1) * LANES };
                for lane in lanes_of(node.may_cross(query)) {
                    waiting[count] = (child + lane) as u32;
                    count += 1;
                }
                continue;
            }
            let leaf = index - self.nodes.len();
            let facets = &self.facets[range(self.facets.len(), levels, leaf)];
            let crossings = lanes_of(self.leaves[leaf].may_cross(query));
            crossings.filter_map(|lane| facets[lane].crossing(query)).for_each(&mut found);
        }
    }
}

/// Lanes whose bits are set, from the lowest.
fn lanes_of(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (mask != 0).then(|| mask.trailing_zeros() as usize)?;
        mask &= mask - 1;
        Some(lane)
    })
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
    split(left, count, (level + 1, 2 * place), levels);
    split(right, count, (level + 1, 2 * place + 1), levels);
}

/// Least and greatest coordinates.
fn bounds(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    points.fold(nothing, |(low, high), point| (low.min(point), high.max(point)))
}

#[cfg(test)]
mod tests {
    use super::crossing::tests::{facet, query};
    use super::*;

    /// The tree finds the same facets as a loop over all.
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
                    for beyond in [LightOrigin::At(toward * distance), LightOrigin::Along(toward)] {
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
