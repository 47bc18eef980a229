//! Directions to look from.

use std::fmt;

use glam::{DQuat, DVec3};
use translucid_scene::Camera;

/// A direction to look from, at things whose up is +y and whose front is +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Angle about y from the front, positive toward +x \[degrees\].
    pub azimuth: f64,
    /// Angle above the horizon, in [−90, 90] \[degrees\].
    pub elevation: f64,
}

/// Elevation beyond which +y is no good upward direction of a picture \[degrees\].
const STEEP: f64 = 80.0;

impl Viewpoint {
    /// Every viewpoint that has a name, by it.
    pub const WORDS: [(&str, Self); 6] = [
        ("front", Self::of(0.0, 0.0)),
        ("back", Self::of(180.0, 0.0)),
        ("left", Self::of(-90.0, 0.0)),
        ("right", Self::of(90.0, 0.0)),
        ("top", Self::of(0.0, 90.0)),
        ("bottom", Self::of(0.0, -90.0)),
    ];

    /// From this azimuth and elevation \[degrees\].
    pub const fn of(azimuth: f64, elevation: f64) -> Self {
        Self { azimuth, elevation }
    }

    /// The viewpoint of a name, or of the text `AZIMUTH,ELEVATION`.
    ///
    /// ```
    /// use translucid_load::Viewpoint;
    ///
    /// assert_eq!(Viewpoint::from_text("right"), Viewpoint::from_text("90, 0"));
    /// assert_eq!(Viewpoint::from_text("0,91"), None);
    /// ```
    pub fn from_text(text: &str) -> Option<Self> {
        if let Some((_, viewpoint)) = Self::WORDS.iter().find(|(word, _)| *word == text) {
            return Some(*viewpoint);
        }
        let (azimuth, elevation) = text.split_once(',')?;
        let within =
            |text: &str, most: f64| text.trim().parse().ok().filter(|angle: &f64| angle.abs() <= most);
        Some(Self::of(within(azimuth, 36_000.0)?, within(elevation, 90.0)?))
    }

    /// The viewpoint in a direction from what is looked at.
    pub(crate) fn toward(direction: DVec3) -> Self {
        let elevation = libm::atan2(direction.y, libm::hypot(direction.x, direction.z)).to_degrees();
        Self::of(libm::atan2(direction.x, direction.z).to_degrees(), elevation)
    }

    /// Unit direction from what is looked at to the camera.
    pub(crate) fn direction(self) -> DVec3 {
        let (height, reach) = libm::sincos(self.elevation.to_radians());
        let (sine, cosine) = libm::sincos(self.azimuth.to_radians());
        DVec3::new(reach * sine, height, reach * cosine)
    }

    /// As [`direction`](Self::direction) at the horizon.
    pub(crate) fn horizontal(self) -> DVec3 {
        Self { elevation: 0.0, ..self }.direction()
    }

    /// Upward direction of a picture from there: +y, from straight above and below the horizontal that is up there.
    pub(crate) fn up(self) -> DVec3 {
        if self.elevation.abs() < STEEP { DVec3::Y } else { self.horizontal() * -self.elevation.signum() }
    }

    /// A camera moved here about its target, as far from it as it was.
    pub(crate) fn of_camera(self, camera: &Camera) -> Camera {
        let target = camera.target.as_dvec3();
        let position = target + camera.position.as_dvec3().distance(target) * self.direction();
        Camera { position: position.as_vec3(), up: self.up().as_vec3(), ..*camera }
    }
}

/// A camera carried about the vertical line through its target, so that what it looks at turns by an angle \[degrees\].
pub(crate) fn turned_about_target(camera: &Camera, degrees: f64) -> Camera {
    let rotation = DQuat::from_rotation_y(-degrees.to_radians());
    let target = camera.target.as_dvec3();
    Camera {
        position: (target + rotation * (camera.position.as_dvec3() - target)).as_vec3(),
        up: (rotation * camera.up.as_dvec3()).as_vec3(),
        ..*camera
    }
}

impl fmt::Display for Viewpoint {
    /// The text that [`from_text`](Self::from_text) reads back.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match Self::WORDS.iter().find(|(_, viewpoint)| viewpoint == self) {
            Some((name, _)) => f.write_str(name),
            None => write!(f, "{},{}", self.azimuth, self.elevation),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn viewpoints_have_names_or_two_angles() {
        for (text, direction) in [
            ("front", Vec3::Z),
            ("back", -Vec3::Z),
            ("left", -Vec3::X),
            ("right", Vec3::X),
            ("top", Vec3::Y),
            ("bottom", -Vec3::Y),
            ("90,0", Vec3::X),
            (" -90 , 0", -Vec3::X),
        ] {
            let viewpoint = Viewpoint::from_text(text).expect(text);
            assert!(viewpoint.direction().as_vec3().abs_diff_eq(direction, 1e-6), "{text}");
            assert!(viewpoint.direction().cross(viewpoint.up()).length() > 0.1, "{text}");
            assert_eq!(Viewpoint::from_text(&viewpoint.to_string()), Some(viewpoint), "{text}");
        }
        for text in ["", "fron", "1", "1,", ",1", "0,91", "nan,0", "0,inf", "1,2,3"] {
            assert_eq!(Viewpoint::from_text(text), None, "{text}");
        }
    }

    #[test]
    fn viewpoint_toward_a_direction_is_in_it() {
        for direction in [DVec3::X, DVec3::new(-0.6, 0.48, 0.64), DVec3::NEG_Y, DVec3::new(0.0, -0.6, -0.8)] {
            assert!(Viewpoint::toward(direction).direction().distance(direction) < 1e-12, "{direction}");
        }
    }

    #[test]
    fn cameras_keep_target_and_distance() {
        let camera = Camera { position: Vec3::new(3.0, 1.0, 4.0), target: Vec3::X, ..Camera::default() };
        let distance = camera.position.distance(camera.target);
        let seen = Viewpoint::of(90.0, 0.0).of_camera(&camera);
        assert!(seen.position.abs_diff_eq(Vec3::new(1.0 + distance, 0.0, 0.0), 1e-5), "{seen:?}");
        // What is at the front comes to the right, where the camera saw +x.
        let turned = turned_about_target(&camera, 90.0);
        assert!(turned.position.abs_diff_eq(Vec3::new(-3.0, 1.0, 2.0), 1e-5), "{turned:?}");
        assert_eq!((turned.target, turned.up), (camera.target, camera.up));
    }
}
