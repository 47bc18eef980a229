//! Schlick's approximation against Fresnel's reflectance.

use translucid_profile::{
    fresnel_from_inside, fresnel_from_outside, schlick_from_inside, schlick_from_outside,
};

/// Where light comes from.
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
    /// Where light comes from.
    pub side: Side,
    /// Angle from the normal \[degrees\], exact reflectance, approximate reflectance.
    pub points: Vec<[f64; 3]>,
}

impl FresnelCurve {
    /// Indices of the talk's range of materials.
    pub const ETAS: [f64; 3] = [1.3, 1.4, 1.5];
    /// Steps to a degree; from inside everything happens within a few.
    const STEPS: u32 = 8;

    /// Both reflectances at every eighth of a degree.
    pub fn new(eta: f64, side: Side) -> Self {
        let point = |i: u32| {
            let degrees = f64::from(i) / f64::from(Self::STEPS);
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
        Self { eta, side, points: (0..=90 * Self::STEPS).map(point).collect() }
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
}
