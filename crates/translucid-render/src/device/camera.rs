//! A view as numbers for the rays of a device.

use glam::Vec3;
use translucid_image::PixelRect;
use translucid_scene::Projection;

use crate::render::View;

/// The rays of a view, as [`View`] makes them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceCamera {
    /// Position of the lens \[L\].
    pub position: Vec3,
    /// Axes to the right, down and forward.
    pub axes: [Vec3; 3],
    /// Half the width and height of the picture at depth 1 (of an orthographic one \[L\]), and the point in its middle.
    pub half_size: [f32; 2],
    /// The point in the middle of the picture, in the same units.
    pub middle: [f32; 2],
    /// Width and height of the whole film \[pixels of the film\].
    pub size: [f32; 2],
    /// Edge of a pixel \[pixels of the film\].
    pub step: f32,
    /// Radius of the lens \[L\], 0 for a pinhole.
    pub lens_radius: f32,
    /// Distance in focus \[L\].
    pub focus_distance: f32,
    /// Rays are parallel.
    pub is_orthographic: bool,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The pixels to be traced.
    pub region: PixelRect,
}

impl DeviceCamera {
    /// The rays of a view.
    pub fn new(view: &View) -> Self {
        let camera = view.camera();
        let (frame, half_size, middle, size, step) = view.projection();
        Self {
            position: camera.position,
            axes: [frame.x, frame.y, frame.z],
            half_size,
            middle,
            size,
            step,
            lens_radius: camera.lens_radius,
            focus_distance: camera.focus_distance,
            is_orthographic: matches!(camera.projection, Projection::Orthographic { .. }),
            seed: view.seed(),
            region: view.region(),
        }
    }
}
