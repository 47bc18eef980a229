// The cone that a spot shines into: its light falls, between two angles from its axis, by the smooth step 3x² − 2x³ in the
// cosine.

struct LightCone {
    axis: vec3f,
    // Cosine of the angle up to which the light is even.
    cos_inner: f32,
    // Cosine of the angle from which on there is none; below −1 where it shines to all sides.
    cos_outer: f32,
}

fn light_cone(at: u32) -> LightCone {
    return LightCone(light_vector(at + 10u), tables[at + 13u], tables[at + 14u]);
}

// Share of the light on the axis at the cosine of an angle from it.
fn cone_falloff(cone: LightCone, cosine: f32) -> f32 {
    if (cosine >= cone.cos_inner) {
        return 1.0;
    }
    // Between equal angles there is no falloff
    let width = cone.cos_inner - cone.cos_outer;
    if (cosine <= cone.cos_outer || width <= 0.0) {
        return 0.0;
    }
    let x = clamp((cosine - cone.cos_outer) / width, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

// Solid angle over 2π, at most 2.
fn cone_one_minus_cos(cone: LightCone) -> f32 {
    return 1.0 - max(cone.cos_outer, -1.0);
}
