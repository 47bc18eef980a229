//! Schlick's approximation against Fresnel's reflectance.

use translucid_profile::{
    fresnel_from_inside, fresnel_from_outside, schlick_from_inside, schlick_from_outside,
};

/// Side that light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From the thinner side.
    Outside,
    /// From the medium.
    Inside,
}

impl Side {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Outside, Self::Inside];

    /// One word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Inside => "inside",
        }
    }
}

/// Reflectance of a boundary over the angle, exact and by Schlick's approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct FresnelCurve {
    /// Relative index of refraction.
    pub eta: f64,
    /// Side that light comes from.
    pub side: Side,
    /// Angle from the normal \[degrees\], exact reflectance, approximate reflectance.
    pub points: Vec<[f64; 3]>,
}

impl FresnelCurve {
    /// Indices of the talk's range of materials.
    pub const ETAS: [f64; 3] = [1.3, 1.4, 1.5];
    /// Steps to a degree.
    const STEPS: u32 = 8;

    /// Both reflectances at every eighth of a degree, from inside also where light of these angles outside goes to:
    /// near the critical angle much happens within a degree.
    pub fn new(eta: f64, side: Side) -> Self {
        let steps = (0..=90 * Self::STEPS).map(|i| f64::from(i) / f64::from(Self::STEPS));
        let point = |degrees: f64| {
            let cos_theta = degrees.to_radians().cos();
            match side {
                Side::Outside => {
                    [degrees, fresnel_from_outside(cos_theta, eta), schlick_from_outside(cos_theta, eta)]
                }
                Side::Inside => {
                    [degrees, fresnel_from_inside(cos_theta, eta), schlick_from_inside(cos_theta, eta)]
                }
            }
        };
        let mut angles: Vec<f64> = steps.clone().collect();
        if side == Side::Inside {
            angles.extend(steps.map(|degrees| (degrees.to_radians().sin() / eta).asin().to_degrees()));
            angles.sort_by(f64::total_cmp);
            angles.dedup();
        }
        Self { eta, side, points: angles.into_iter().map(point).collect() }
    }

    /// The angle at which the approximation is farthest off \[degrees\], and by how much.
    pub fn greatest_difference(&self) -> [f64; 2] {
        let off = |point: &[f64; 3]| point[2] - point[1];
        let worst = self.points.iter().max_by(|a, b| off(a).abs().total_cmp(&off(b).abs()));
        worst.map_or([0.0; 2], |point| [point[0], off(point)])
    }
}

/// All curves.
pub fn fresnel_curves() -> Vec<FresnelCurve> {
    let of = |side: Side| FresnelCurve::ETAS.map(|eta| FresnelCurve::new(eta, side));
    Side::ALL.into_iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_start_and_end_as_they_must() {
        for curve in fresnel_curves() {
            let r0 = ((curve.eta - 1.0) / (curve.eta + 1.0)).powi(2);
            let [first, last] = [curve.points[0], curve.points[curve.points.len() - 1]];
            for i in [1, 2] {
                assert!((first[i] - r0).abs() < 1e-12 && (last[i] - 1.0).abs() < 1e-9, "{curve:?}");
            }
            let [_, off] = curve.greatest_difference();
            assert!(off.abs() > 0.005 && off.abs() < 0.2, "{} {off}", curve.eta);
        }
    }

    /// Light that goes the same way back is reflected as much, and so is its approximation.
    #[test]
    fn greatest_difference_is_the_same_from_both_sides() {
        for eta in FresnelCurve::ETAS {
            let [outside, inside] = Side::ALL.map(|side| FresnelCurve::new(eta, side).greatest_difference());
            assert!((outside[1] - inside[1]).abs() < 1e-5, "{eta}: {outside:?} {inside:?}");
        }
    }
}
