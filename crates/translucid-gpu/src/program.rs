//! The path tracer's kernels as text, and what whoever drives them needs to know: wgpu here, a page's script in a browser.
//!
//! Binding 0 holds the [`settings`], bindings 1 to 5 the arrays of a [`DeviceScene`](translucid_render::device::DeviceScene) in
//! their order, then come the slots, the counters with their lists, and the samples. A round clears the counters of the lists
//! and dispatches all [`KERNELS`]; the second counter says how many samples are done.

use std::ops::Range;

use glam::Vec3;
use translucid_render::device::{DeviceCamera, shader_constants};
use translucid_render::{PixelSample, View};

/// The shaders of paths, in the order in which they read best.
const PATH_SHADERS: &[&str] = &[
    include_str!("picture/shaders/kernels.wgsl"),
    include_str!("picture/shaders/camera.wgsl"),
    include_str!("picture/shaders/surface_step.wgsl"),
    include_str!("picture/shaders/walk_step.wgsl"),
    include_str!("picture/shaders/layers.wgsl"),
    include_str!("picture/shaders/probe_step.wgsl"),
    include_str!("picture/shaders/pairing.wgsl"),
    include_str!("picture/shaders/normalization.wgsl"),
    include_str!("picture/shaders/profile.wgsl"),
    include_str!("picture/shaders/directional_dipole.wgsl"),
    include_str!("picture/shaders/shadow.wgsl"),
    include_str!("picture/shaders/state.wgsl"),
    include_str!("picture/shaders/scene.wgsl"),
    include_str!("picture/shaders/material.wgsl"),
    include_str!("picture/shaders/point.wgsl"),
    include_str!("picture/shaders/ray.wgsl"),
    include_str!("picture/shaders/depth.wgsl"),
    include_str!("picture/shaders/instance.wgsl"),
    include_str!("picture/shaders/sampler.wgsl"),
];

/// The laws that devices share with the processor, and the tables that they ask.
pub const LAWS: [&str; 2] = [translucid_law::WGSL, include_str!("picture/shaders/interface.wgsl")];

/// The shaders of lights, which know nothing of paths.
pub const LIGHT_SHADERS: [&str; 9] = [
    include_str!("picture/shaders/light.wgsl"),
    include_str!("picture/shaders/light_selection.wgsl"),
    include_str!("picture/shaders/light_tree.wgsl"),
    include_str!("picture/shaders/light_rectangle.wgsl"),
    include_str!("picture/shaders/light_ellipse.wgsl"),
    include_str!("picture/shaders/light_sky.wgsl"),
    include_str!("picture/shaders/light_triangle.wgsl"),
    include_str!("picture/shaders/light_directions.wgsl"),
    include_str!("picture/shaders/light_tables.wgsl"),
];

/// All shaders, the laws and constants that they share with Rust, and the formulas of directional models, which exports have.
pub fn text() -> String {
    let shaders = LAWS.concat() + &PATH_SHADERS.concat() + &LIGHT_SHADERS.concat();
    constants() + &shaders + &translucid_export::directional_formulas()
}

/// Constants that Rust and the shaders share, as text: those of the scene's words, of samples and of counters.
pub fn constants() -> String {
    let own = [
        ("SAMPLE_WORDS", SAMPLE_WORDS),
        ("COUNTERS", COUNTERS as usize),
        ("FIRST_LIST", LIST_COUNTERS.start as usize),
    ];
    let own = own.map(|(name, value)| (name.to_owned(), value));
    shader_constants().chain(own).map(|(name, value)| format!("const {name} = {value}u;\n")).collect()
}

/// The kernels of a round, and how many slots one invocation each they need.
pub const KERNELS: [(&str, u32); 10] = [
    ("begin_samples", 1),
    ("trace", 2),
    ("end_flights", 1),
    ("find_depths", 2),
    ("weigh_probes", 1),
    ("look", 2),
    ("pass_on", 1),
    ("meet_surfaces", 1),
    ("sample_lights", 1),
    ("scatter_paths", 1),
];
/// Bytes of a slot: `Slot` in `shaders/state.wgsl`.
pub const SLOT_BYTES: u64 = 1088;
/// Counters before the lists of slots.
pub const COUNTERS: u64 = 12;
/// Numbers of the counters that count the lists' slots.
pub const LIST_COUNTERS: Range<u64> = 2..12;
/// Words of a sample.
pub const SAMPLE_WORDS: usize = 20;
/// Paths under way at a time: nearly as many as the threads of the largest processors of 2025, whose states are within
/// 128 MiB; and on a central processor.
pub const SLOTS: (u32, u32) = (15 << 13, 1 << 12);
/// Rounds between two looks at the counters, at most.
pub const MOST_ROUNDS: u32 = 256;

/// A node that no ray meets.
pub const EMPTY_NODE: [u32; 8] = {
    let [high, low] = [f32::INFINITY.to_bits(), f32::NEG_INFINITY.to_bits()];
    [high, high, high, 0, low, low, low, 0]
};

/// Words of the settings.
pub const SETTINGS: usize = 32;

/// The words for samples of a view from a number on, `items` in all, by so many paths at a time.
pub fn settings(view: &View, first: u32, items: u32, slots: u32) -> [u32; SETTINGS] {
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

/// The samples that the kernels have written.
pub fn samples(words: &[u32]) -> Vec<PixelSample> {
    words.as_chunks().0.iter().map(sample).collect()
}

fn sample(words: &[u32; SAMPLE_WORDS]) -> PixelSample {
    let value = |at: usize| f32::from_bits(words[at]);
    let color = |at: usize| Vec3::new(value(at), value(at + 1), value(at + 2));
    PixelSample {
        diffuse: color(0),
        specular: color(3),
        subsurface: color(6),
        emission: color(9),
        alpha: value(12),
        albedo: color(13),
        normal: color(16),
        depth: value(19),
    }
}
