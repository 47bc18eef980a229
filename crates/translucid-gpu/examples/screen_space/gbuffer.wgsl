// What an engine's passes before the subsurface one leave: irradiance, position and normal for each pixel.

struct View {
    clip_from_world: mat4x4<f32>,
    // Direction toward the light; w: radius of a lit disk on the plane z = 0, or 0 for the light
    light: vec4<f32>,
}
@group(0) @binding(0) var<uniform> view: View;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
}

@vertex
fn vertex(@location(0) position: vec3<f32>, @location(1) normal: vec3<f32>) -> Vertex {
    return Vertex(view.clip_from_world * vec4<f32>(position, 1.0), position, normal);
}

struct Pixel {
    // w: 1 where there is a surface
    @location(0) irradiance: vec4<f32>,
    @location(1) position: vec4<f32>,
    @location(2) normal: vec4<f32>,
}

@fragment
fn fragment(in: Vertex) -> Pixel {
    let n = normalize(in.normal);
    var irradiance = vec3<f32>(select(0.0, 1.0, length(in.position.xy) < view.light.w));
    if view.light.w == 0.0 {
        // A lamp, and a dim sky
        irradiance = 2.5 * max(dot(n, view.light.xyz), 0.0) * vec3<f32>(1.0, 0.95, 0.88)
            + (0.15 + 0.1 * n.y) * vec3<f32>(0.8, 0.9, 1.0);
    }
    return Pixel(vec4<f32>(irradiance, 1.0), vec4<f32>(in.position, 1.0), vec4<f32>(n, 0.0));
}
