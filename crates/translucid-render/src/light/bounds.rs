//! Bounds of a cluster of lights: their place, the directions of their emission, and their intensity.
//!
//! The description is that of A. Conty Estevez & C. Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
//! Splitting", Proc. ACM Comput. Graph. Interact. Tech. 1(2), §3: a box, a cone of normals and an angle about each
//! normal beyond which there is no light.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};
use translucid_law::SpotCone;

/// Room for the rounding of cones to single precision \[rad\].
const CONE_ROOM: f32 = 1e-6;

/// Bounds of one light or of several.
///
/// A ray that leaves a light of the cluster leaves from the box, at an angle of at most `theta_e` to a normal that is
/// at most `theta_o` from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightBounds {
    /// Corners of the box \[L\].
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
    /// Unit axis of the cone of normals.
    pub(crate) axis: Vec3,
    /// Half-angle of that cone \[rad\].
    pub(crate) theta_o: f32,
    /// Angle from a normal beyond which nothing is emitted \[rad\].
    pub(crate) theta_e: f32,
    /// Sum of the lights' greatest intensities (luminance) \[power per sr\].
    pub(crate) strength: f32,
    /// Sum of the lights' mean intensities over all directions, and of their first moments: in the direction ω the
    /// intensity is about `mean` + `lean` · ω \[power per sr\].
    pub(crate) mean: f32,
    pub(crate) lean: Vec3,
    /// Sum of strength × mean direction of the cone of normals: as long as `strength` if all normals are the same.
    pub(crate) facing: Vec3,
}

impl LightBounds {
    /// A light that shines on all sides alike.
    pub(crate) fn everywhere(low: Vec3, high: Vec3, strength: f32) -> Self {
        let (theta_o, theta_e) = (PI, FRAC_PI_2);
        let (lean, facing) = (Vec3::ZERO, Vec3::ZERO);
        Self { low, high, axis: Vec3::Z, theta_o, theta_e, strength, mean: strength, lean, facing }
    }

    /// A flat light that shines on the side of its unit normal with the cosine.
    pub(crate) fn one_sided(low: Vec3, high: Vec3, normal: Vec3, strength: f32) -> Self {
        Self {
            low,
            high,
            axis: normal,
            theta_o: 0.0,
            theta_e: FRAC_PI_2,
            strength,
            // 3/4π ∫ cos² over the hemisphere is ½.
            mean: 0.25 * strength,
            lean: normal * (0.5 * strength),
            facing: normal * strength,
        }
    }

    /// A light that shines from a box into a cone, with so much intensity on the axis.
    pub(crate) fn cone(low: Vec3, high: Vec3, cone: &SpotCone, strength: f32) -> Self {
        if cone.cos_outer <= -1.0 {
            return Self::everywhere(low, high, strength);
        }
        let axis = cone.axis;
        let theta_o = libm::acosf(cone.cos_inner);
        let theta_e = (libm::acosf(cone.cos_outer) - theta_o).max(0.0);
        // As if it shone fully up to the middle of the falloff: the mean is then the share of the sphere, and the
        // first moment 3/4π ∫ cos over the cap.
        let cos = libm::cosf((theta_o + 0.5 * theta_e).min(PI));
        Self {
            low,
            high,
            axis,
            theta_o,
            theta_e,
            strength,
            mean: 0.5 * (1.0 - cos) * strength,
            lean: axis * (0.75 * (1.0 - cos * cos) * strength),
            facing: axis * (0.5 * (1.0 + libm::cosf(theta_o)) * strength),
        }
    }

    /// Returns `true` if every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite() && self.axis.is_finite() && self.strength.is_finite()
    }

    /// Bounds of both.
    pub(crate) fn union(&self, other: &Self) -> Self {
        let (axis, theta_o) = self.cone_with(other);
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axis,
            theta_o,
            theta_e: self.theta_e.max(other.theta_e),
            strength: (self.strength + other.strength).min(f32::MAX),
            mean: (self.mean + other.mean).min(f32::MAX),
            lean: self.lean + other.lean,
            facing: self.facing + other.facing,
        }
    }

    /// The narrowest cone around both cones of normals.
    fn cone_with(&self, other: &Self) -> (Vec3, f32) {
        let (wide, narrow) = if self.theta_o >= other.theta_o { (self, other) } else { (other, self) };
        let (a, b) = (wide.axis.as_dvec3(), narrow.axis.as_dvec3());
        // The arc cosine of small angles would have no digits.
        let between = libm::atan2(a.cross(b).length(), a.dot(b)) as f32;
        if (between + narrow.theta_o).min(PI) <= wide.theta_o {
            return (wide.axis, wide.theta_o);
        }
        let theta_o = 0.5 * (wide.theta_o + between + narrow.theta_o) + CONE_ROOM;
        if theta_o >= PI {
            return (wide.axis, PI);
        }
        (turned(a, b, f64::from(theta_o - wide.theta_o)), theta_o)
    }
}

/// The unit vector at an angle from `a` toward `b`.
fn turned(a: DVec3, b: DVec3, angle: f64) -> Vec3 {
    let across = (b - a * a.dot(b)).try_normalize().unwrap_or_else(|| a.any_orthonormal_vector());
    let (sin, cos) = libm::sincos(angle);
    (a * cos + across * sin).as_vec3().normalize()
}

#[cfg(test)]
mod tests {
    use translucid_law::uniform_sphere;

    use super::*;
    use crate::sampling::Sampler;

    fn cone(axis: Vec3, theta_o: f32) -> LightBounds {
        LightBounds { theta_o, ..LightBounds::one_sided(Vec3::ZERO, Vec3::ONE, axis, 1.0) }
    }

    #[test]
    fn union_holds_both_cones() {
        for index in 0..2000 {
            let [a, b, c, d] = Sampler::new(1, index, 0, 0).next_4d();
            let [s, t, ..] = Sampler::new(2, index, 0, 0).next_4d();
            let first = cone(uniform_sphere([a, b]), s * s * PI);
            let second = cone(uniform_sphere([c, d]), t * t * t * PI);
            let both = first.union(&second);
            assert_eq!(both, second.union(&first));
            for part in [first, second] {
                // The far side of the cone, in the plane of both axes.
                let reach = part.theta_o + part.axis.dot(both.axis).clamp(-1.0, 1.0).acos();
                assert!(reach <= both.theta_o + 1e-3 || both.theta_o == PI, "{part:?} in {both:?}");
            }
        }
    }

    #[test]
    fn union_of_opposite_normals_is_a_half_turn_about_something_between() {
        let both = cone(Vec3::X, 0.0).union(&cone(Vec3::NEG_X, 0.0));
        assert!((both.theta_o - FRAC_PI_2).abs() < 1e-5 && both.axis.x.abs() < 1e-5, "{both:?}");
        assert_eq!(cone(Vec3::X, 2.0).union(&cone(Vec3::NEG_X, 2.0)).theta_o, PI);
    }
}
