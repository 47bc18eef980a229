//! Perspective camera with a thin lens.

use glam::Vec3;

use crate::SceneError;
use crate::interval::{Interval, refusal};

/// A perspective camera. Right-handed; the image's x axis points right, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Center of the lens \[L\].
    pub position: Vec3,
    /// Point in the middle of the image \[L\]; differs from `position`.
    pub target: Vec3,
    /// Upward direction, not parallel to the viewing direction; any length.
    pub up: Vec3,
    /// Full horizontal field of view in degrees, in (0, 180).
    pub horizontal_fov: f32,
    /// Radius of the lens \[L\]; 0 is a pinhole.
    pub lens_radius: f32,
    /// Distance from the lens to the plane in focus, along the viewing direction \[L\], > 0.
    pub focus_distance: f32,
}

/// A pinhole at z = 5 that looks at the origin, with y upward and a field of view of 40°.
impl Default for Camera {
    fn default() -> Self {
        Self {
            position: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            horizontal_fov: 40.0,
            lens_radius: 0.0,
            focus_distance: 5.0,
        }
    }
}

impl Camera {
    /// Range of `horizontal_fov`.
    pub(crate) const FOV: Interval = Interval::open(0.0, 180.0);
    /// Requirement on `target`, in words.
    pub(crate) const TARGET: &str = "a point other than the camera's position";
    /// Requirement on `up`, in words.
    pub(crate) const UP: &str = "a direction that is not parallel to the viewing direction";
    /// Sine of the smallest angle between `up` and the viewing direction.
    const LEAST_SINE: f64 = 1e-4;

    /// Tells whether `up` spans the image plane's vertical together with the viewing direction.
    pub(crate) fn has_usable_up(&self) -> bool {
        let view = self.target.as_dvec3() - self.position.as_dvec3();
        let sine = self.up.as_dvec3().normalize_or_zero().cross(view.normalize_or_zero()).length();
        sine > Self::LEAST_SINE
    }

    /// Checks every field.
    ///
    /// # Errors
    /// A number is out of its range, the camera looks at its own position, or `up` is parallel to the view.
    ///
    /// ```
    /// use translucid_scene::Camera;
    ///
    /// let camera = Camera { horizontal_fov: 180.0, ..Camera::default() };
    /// assert_eq!(camera.validate().unwrap_err().message, "camera, horizontal_fov = 180: must be in (0, 180)");
    /// ```
    pub fn validate(&self) -> Result<(), SceneError> {
        self.check().map_err(|error| error.within("camera"))
    }

    fn check(&self) -> Result<(), SceneError> {
        Interval::PLACE.check_all("position", self.position.to_array())?;
        Interval::PLACE.check_all("target", self.target.to_array())?;
        Interval::DIRECTION.check_all("up", self.up.to_array())?;
        Self::FOV.check("horizontal_fov", self.horizontal_fov)?;
        Interval::LENGTH.check("lens_radius", self.lens_radius)?;
        Interval::REACH.check("focus_distance", self.focus_distance)?;
        if self.target == self.position {
            return Err(refusal("target", self.target, Self::TARGET));
        }
        if !self.has_usable_up() {
            return Err(refusal("up", self.up, Self::UP));
        }
        Ok(())
    }
}
