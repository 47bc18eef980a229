//! Triangles cut into small patches.

use glam::{DVec3, Vec3};
use translucid_scene::Object;

/// A triangle or a part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) corners: [DVec3; 3],
    /// Halvings that led to it.
    depth: u32,
}

impl Patch {
    pub(super) fn of_triangle(object: &Object, triangle: usize) -> Self {
        Self { corners: object.vertices(triangle).map(Vec3::as_dvec3), depth: 0 }
    }

    pub(super) fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        0.5 * (b - a).cross(c - a).length()
    }

    pub(super) fn center(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }

    /// Unit normal on the outside; zero where rounding leaves none.
    pub(super) fn normal(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize_or_zero().as_vec3()
    }

    /// The point for two uniform random numbers in [0, 1), uniform in area.
    pub(super) fn point(&self, u: f64, v: f64) -> DVec3 {
        let [a, b, c] = self.corners;
        let root = u.sqrt();
        a * (1.0 - root) + b * (root * (1.0 - v)) + c * (root * v)
    }

    /// Calls `found` for every part after halving longest edges until no area is above `most_area` > 0.
    pub(super) fn for_each_part(self, most_area: f64, mut found: impl FnMut(&Self)) {
        let halvings = libm::log2(self.area() / most_area).ceil().clamp(0.0, 48.0) as u32;
        // Parts of a triangle have equal areas, so all of them are halved equally often.
        let mut stack = vec![self];
        while let Some(patch) = stack.pop() {
            if patch.depth >= halvings {
                found(&patch);
            } else {
                stack.extend(patch.halves());
            }
        }
    }

    fn halves(&self) -> [Self; 2] {
        let [a, b, c] = self.corners;
        let lengths = [(b - a).length_squared(), (c - b).length_squared(), (a - c).length_squared()];
        // Turn so that the longest edge is from the first to the second corner
        let [a, b, c] = match lengths {
            [ab, bc, ca] if ab >= bc && ab >= ca => [a, b, c],
            [_, bc, ca] if bc >= ca => [b, c, a],
            _ => [c, a, b],
        };
        let middle = (a + b) * 0.5;
        let part = |corners| Self { corners, depth: self.depth + 1 };
        [part([a, middle, c]), part([middle, b, c])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_small_and_cover_the_triangle() {
        let corners = [DVec3::ZERO, DVec3::new(7.0, 0.0, 1.0), DVec3::new(0.0, 0.3, 2.0)];
        let whole = Patch { corners, depth: 0 };
        let (mut area, mut moment, mut count) = (0.0, DVec3::ZERO, 0);
        whole.for_each_part(0.01, |part| {
            assert!(part.area() <= 0.01 && part.area() > 0.004_9);
            assert!(part.normal().distance(whole.normal()) < 1e-6);
            area += part.area();
            moment += part.center() * part.area();
            count += 1;
        });
        assert!((area / whole.area() - 1.0).abs() < 1e-12 && count > 100);
        assert!((moment / area).distance(whole.center()) < 1e-12);
    }
}
