//! Perspective camera with a thin lens.

use glam::Vec3;

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
