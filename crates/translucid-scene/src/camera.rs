//! Cameras with a thin lens.

use glam::{Vec2, Vec3};

use crate::SceneError;
use crate::interval::{Interval, refusal};

/// A camera. Right-handed; the image's x axis points right, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Center of the lens \[L\].
    pub position: Vec3,
    /// Point on the optical axis \[L\], in the middle of an image without shift; differs from `position`.
    pub target: Vec3,
    /// Upward direction, not parallel to the viewing direction; any length.
    pub up: Vec3,
    /// How far the picture reaches.
    pub projection: Projection,
    /// Shift of the picture's frame to the right and upward, in widths of the picture: the axis is that far left of and
    /// below the picture's middle, and parallel edges stay parallel. Within ±100.
    pub shift: Vec2,
    /// Radius of the lens \[L\]; 0 is a pinhole.
    pub lens_radius: f32,
    /// Distance from the lens to the plane in focus, along the viewing direction \[L\], > 0.
    pub focus_distance: f32,
}

/// How lines of sight spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// They meet in the lens.
    Perspective {
        /// Full horizontal field of view of a picture without shift in degrees, in (0, 180).
        horizontal_fov: f32,
    },
    /// They are parallel.
    Orthographic {
        /// Width of what the picture shows \[L\], > 0.
        width: f32,
    },
}

impl Projection {
    /// Range of a field of view.
    pub const FOV: Interval = Interval::open(0.0, 180.0);

    /// Width of what the picture shows at a depth along the view \[L\].
    pub fn width_at(self, depth: f64) -> f64 {
        match self {
            Self::Perspective { horizontal_fov } => {
                2.0 * depth * libm::tan((0.5 * f64::from(horizontal_fov)).to_radians())
            }
            Self::Orthographic { width } => f64::from(width),
        }
    }

    /// The projection that shows `factor` times the width.
    pub fn widened(self, factor: f64) -> Self {
        match self {
            Self::Perspective { .. } => {
                let tangent = 0.5 * factor * self.width_at(1.0);
                Self::Perspective { horizontal_fov: (2.0 * libm::atan(tangent)).to_degrees() as f32 }
            }
            Self::Orthographic { width } => Self::Orthographic { width: (factor * f64::from(width)) as f32 },
        }
    }

    fn check(self) -> Result<(), SceneError> {
        match self {
            Self::Perspective { horizontal_fov } => Self::FOV.check("horizontal_fov", horizontal_fov),
            Self::Orthographic { width } => Interval::REACH.check("width", width),
        }
    }
}

/// A pinhole at z = 5 that looks at the origin, with y upward and a field of view of 40°.
impl Default for Camera {
    fn default() -> Self {
        Self {
            position: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Perspective { horizontal_fov: 40.0 },
            shift: Vec2::ZERO,
            lens_radius: 0.0,
            focus_distance: 5.0,
        }
    }
}

impl Camera {
    /// Range of the components of `shift`.
    pub const SHIFT: Interval = Interval::closed(-100.0, 100.0);
    /// Requirement on `target`, in words.
    pub const TARGET: &str = "a point other than the camera's position";
    /// Requirement on `up`, in words.
    pub const UP: &str = "a direction that is not parallel to the viewing direction";
    /// Sine of the smallest angle between `up` and the viewing direction.
    const LEAST_SINE: f64 = 1e-4;

    /// The camera to which things are `factor` times as large about the middle of the picture.
    pub fn zoomed(&self, factor: f32) -> Self {
        let projection = self.projection.widened(f64::from(factor).recip());
        // The middle stays where it is on the image plane, whose width is another
        Self { projection, shift: self.shift * factor, ..*self }
    }

    /// Tells whether `up` spans the image plane's vertical together with the viewing direction.
    pub fn has_usable_up(&self) -> bool {
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
    /// use translucid_scene::{Camera, Projection};
    ///
    /// let projection = Projection::Perspective { horizontal_fov: 180.0 };
    /// let camera = Camera { projection, ..Camera::default() };
    /// assert_eq!(camera.validate().unwrap_err().message, "camera, horizontal_fov = 180: must be in (0, 180)");
    /// ```
    pub fn validate(&self) -> Result<(), SceneError> {
        self.check().map_err(|error| error.within("camera"))
    }

    fn check(&self) -> Result<(), SceneError> {
        Interval::PLACE.check_all("position", self.position.to_array())?;
        Interval::PLACE.check_all("target", self.target.to_array())?;
        Interval::DIRECTION.check_all("up", self.up.to_array())?;
        self.projection.check()?;
        Self::SHIFT.check_all("shift", self.shift.to_array())?;
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
