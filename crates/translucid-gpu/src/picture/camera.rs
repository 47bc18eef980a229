//! A view as the uniform words of the shaders: `Settings` in `scene.wgsl`.

use glam::Vec3;
use translucid_render::View;
use translucid_render::device::DeviceCamera;

/// Words of the settings.
pub(super) const SETTINGS: usize = 32;

/// The words for samples of a view from a number on, `items` in all, by so many paths at a time.
pub(super) fn settings(view: &View, first: u32, items: u32, slots: u32) -> [u32; SETTINGS] {
    let camera = DeviceCamera::new(view);
    let mut words = [0; SETTINGS];
    let axis = |axis: Vec3, behind: u32| {
        let [x, y, z] = axis.to_array().map(f32::to_bits);
        [x, y, z, behind]
    };
    let rows = [
        axis(camera.position, camera.lens_radius.to_bits()),
        axis(camera.axes[0], camera.focus_distance.to_bits()),
        axis(camera.axes[1], camera.step.to_bits()),
        axis(camera.axes[2], camera.is_orthographic.into()),
        pair(camera.half_size.map(f32::to_bits), camera.middle.map(f32::to_bits)),
        pair(camera.size.map(f32::to_bits), [camera.seed as u32, (camera.seed >> 32) as u32]),
        pair([camera.region.left, camera.region.top], [camera.region.width, camera.region.height]),
        [first, items, slots, 0],
    ];
    words.copy_from_slice(rows.as_flattened());
    words
}

fn pair([a, b]: [u32; 2], [c, d]: [u32; 2]) -> [u32; 4] {
    [a, b, c, d]
}
