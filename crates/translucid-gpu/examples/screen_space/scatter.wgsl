// The pass itself. Before it in one text stands what `translucid export --to wgsl --what disk` writes.

struct View {
    clip_from_world: mat4x4<f32>,
    light: vec4<f32>,
}
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var irradiance: texture_2d<f32>;
@group(0) @binding(2) var position: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;

// Turns of the disk that a pixel averages; an engine takes one a frame and lets its temporal filter do the rest.
override turns: u32 = 8;
override taps: u32 = 25;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Interleaved gradient noise by J. Jimenez (Next Generation Post Processing in Call of Duty, SIGGRAPH 2014).
fn noise(at: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(at, vec2<f32>(0.06711056, 0.00583715))));
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(at.xy);
    let size = vec2<i32>(textureDimensions(irradiance));
    let here = textureLoad(irradiance, pixel, 0);
    if here.w == 0.0 {
        return vec4<f32>(0.0);
    }
    let center = textureLoad(position, pixel, 0).xyz;
    let n = textureLoad(normal, pixel, 0).xyz;
    // Two axes of the tangent plane
    let helper = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    let t = normalize(cross(helper, n));
    let b = cross(n, t);
    var offsets = DISK_OFFSETS;
    var weights = DISK_WEIGHTS;
    var light = vec3<f32>(0.0);
    var seen = vec3<f32>(0.0);
    for (var turn = 0u; turn < turns; turn++) {
        let angle = 6.283185307 * (f32(turn) + noise(at.xy)) / f32(turns);
        let x = cos(angle) * t + sin(angle) * b;
        let y = cos(angle) * b - sin(angle) * t;
        for (var i = 0u; i < taps; i++) {
            let clip = view.clip_from_world * vec4<f32>(center + offsets[i].x * x + offsets[i].y * y, 1.0);
            let uv = vec2<f32>(0.5, -0.5) * clip.xy / clip.w + 0.5;
            let there = vec2<i32>(floor(uv * vec2<f32>(size)));
            let arriving = textureLoad(irradiance, clamp(there, vec2<i32>(0), size - 1), 0);
            // Where the screen has no surface, the others stand for it
            light += weights[i] * arriving.rgb * arriving.w;
            seen += weights[i] * arriving.w;
        }
    }
    let albedo = vec3<f32>(SURFACE_ALBEDO_RED, SURFACE_ALBEDO_GREEN, SURFACE_ALBEDO_BLUE);
    return vec4<f32>(albedo * light / max(seen, vec3<f32>(1e-6)), 1.0);
}
