//! The distance from a point to the nearest facet.

use glam::{DVec3, Vec3};

use super::crossing::Facet;
use super::lanes::LANES;
use super::{Facets, MOST_WAITING, range};

impl Facets {
    /// Distance \[L\] from a point to the nearest facet, or `reach` where that is nearer.
    pub(in crate::ray) fn distance(&self, from: Vec3, reach: f32) -> f32 {
        let levels = self.leaves.len().ilog2();
        let mut waiting = [(0_u32, 0.0_f32); MOST_WAITING];
        let (mut count, mut least) = (1, reach * reach);
        while count > 0 {
            count -= 1;
            let (index, squared) = waiting[count];
            if squared >= least {
                continue;
            }
            let index = index as usize;
            let Some(node) = self.nodes.get(index) else {
                let facets = &self.facets[range(self.facets.len(), levels, index - self.nodes.len())];
                least = facets.iter().map(|facet| facet.squared_distance(from)).fold(least, f32::min);
                continue;
            };
            let child = if index == 0 { 1 } else { 1 + self.first + (index - 1) * LANES };
            // The nearest comes last, and is looked at first
            let first = count;
            for (lane, squared) in node.squared_distances(from).into_iter().enumerate() {
                if squared < least {
                    let mut place = count;
                    while place > first && waiting[place - 1].1 < squared {
                        waiting[place] = waiting[place - 1];
                        place -= 1;
                    }
                    waiting[place] = ((child + lane) as u32, squared);
                    count += 1;
                }
            }
        }
        least.sqrt().min(reach)
    }
}

impl Facet {
    /// Squared distance to a point, in double precision: facets may be much larger than their distance.
    fn squared_distance(&self, from: Vec3) -> f32 {
        let [a, b, c] = self.vertices.map(|vertex| vertex.as_dvec3() - from.as_dvec3());
        let normal = (b - a).cross(c - a);
        let edges = [(a, b), (b, c), (c, a)];
        if edges.iter().all(|&(start, end)| normal.dot(start.cross(end)) >= 0.0) {
            return (a.dot(normal).powi(2) / normal.length_squared()) as f32;
        }
        let to_edge = |(start, end): (DVec3, DVec3)| {
            let edge = end - start;
            let along = (-start.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            (start + edge * along).length_squared()
        };
        edges.into_iter().map(to_edge).fold(f64::INFINITY, f64::min) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::super::crossing::tests::facet;
    use super::*;

    /// The tree finds the distance of a loop over all, and no point of a facet is nearer.
    #[test]
    fn distance_is_that_of_the_nearest_facet() {
        let random = |i: u32, salt: u32| sobol_burley::sample(i, salt, 11);
        for count in [0, 1, 5, 300, 20_000] {
            let facets: Vec<Facet> = (0..count).map(|i| facet(i, 0.2)).collect();
            let tree = Facets::new(facets.clone());
            for i in 0..200 {
                let from = Vec3::new(random(i, 0), random(i, 1), random(i, 2)) * 4.0 - 2.0;
                let least =
                    facets.iter().map(|facet| facet.squared_distance(from)).fold(f32::INFINITY, f32::min);
                assert_eq!(tree.distance(from, 100.0), least.sqrt().min(100.0), "{count} {from}");
                assert_eq!(tree.distance(from, 0.05), least.sqrt().min(0.05), "{count} {from}");
            }
        }
    }

    /// Beside a fine search over the facet, also where it is much larger than the distance.
    #[test]
    fn distance_to_a_facet_is_the_least() {
        let random = |i: u32, salt: u32| f64::from(sobol_burley::sample(i, salt, 12));
        for i in 0..2000 {
            let size = if i % 2 == 0 { 1.0 } else { 1e4 };
            let corner = |salt: u32| {
                DVec3::new(random(i, salt) - 0.5, random(i, salt + 1) - 0.5, random(i, salt + 2) - 0.5) * size
            };
            let vertices = [0, 3, 6].map(|salt| corner(salt).as_vec3());
            let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
            // A point in the triangle, then one above or beside it
            let (u, v) = (random(i, 9), random(i, 10));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let normal = (b - a).cross(c - a).normalize();
            let height = 0.3 * random(i, 11);
            let from = (a + (b - a) * u + (c - a) * v + normal * height).as_vec3();
            let found = Facet { vertices, triangle: (0, 0) }.squared_distance(from).sqrt();
            // The point itself is rounded
            let rounding = 1e-6 * (1.0 + from.abs().max_element());
            assert!((f64::from(found) - height).abs() < f64::from(rounding), "{found} {height}");
            for (corner, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                let away = (corner - others[0]).normalize() + (corner - others[1]).normalize();
                let from = (corner + away.normalize() * height).as_vec3();
                let found = Facet { vertices, triangle: (0, 0) }.squared_distance(from).sqrt();
                assert!((f64::from(found) - height).abs() < f64::from(rounding), "{found} {height}");
            }
        }
    }
}
