// The scene's words, and the head of its tables. `translucid-render`'s `device` states their meaning; constants that no shader
// states are its `shader_constants`.

struct Settings {
    // Position of the lens, and its radius.
    position: vec3f,
    lens_radius: f32,
    // Axes to the right, down and forward.
    right: vec3f,
    focus_distance: f32,
    down: vec3f,
    // Edge of a pixel in pixels of the film.
    step: f32,
    forward: vec3f,
    is_orthographic: u32,
    half_size: vec2f,
    middle: vec2f,
    size: vec2f,
    seed: vec2u,
    // Left and upper edge, width and height of the region in pixels.
    corner: vec2u,
    region: vec2u,
    // Number of the first sample of a pixel, samples of this call in all, and slots.
    first_sample: u32,
    items: u32,
    slots: u32,
    // Samples begin no more once a stop was asked for.
    is_stopped: u32,
}

@group(0) @binding(0) var<uniform> settings: Settings;
@group(0) @binding(1) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(2) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(3) var<storage, read> attributes: array<f32>;
@group(0) @binding(4) var<storage, read> tables: array<f32>;
@group(0) @binding(5) var<storage, read> images: array<u32>;

fn head(place: u32) -> u32 {
    return u32(tables[place]);
}

const NEVER = 1e30;

fn power_heuristic(ours: f32, others: f32) -> f32 {
    // Squares of densities may overflow
    let ratio = others / max(ours, 1e-30);
    return 1.0 / (1.0 + ratio * ratio);
}

fn sum(color: vec3f) -> f32 {
    return color.x + color.y + color.z;
}

// Transmittance of a clear medium over a distance; an infinite one (in an open mesh) absorbs nothing.
fn absorbed(absorption: vec3f, distance: f32) -> vec3f {
    if (greatest(absorption) == 0.0 || distance >= NEVER) {
        return vec3f(1.0);
    }
    return exp(-absorption * max(distance, 0.0));
}

// Axes whose third is a unit normal.
fn frame_of(z: vec3f) -> mat3x3f {
    let frame = frame_from_normal(z);
    return mat3x3f(frame.x, frame.y, frame.z);
}

fn to_local(frame: mat3x3f, v: vec3f) -> vec3f {
    return vec3f(dot(v, frame[0]), dot(v, frame[1]), dot(v, frame[2]));
}
