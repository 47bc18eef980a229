// Light from a direction, or from a disc of the sky. Words: irradiance (of a disc radiance), direction, and of a disc sin² of
// its angular radius and 1 − cos of it.

// Estimate of the irradiance; 0 only below the horizon.
fn distant_light_importance(at: u32, normal: vec3f) -> f32 {
    let direction = light_vector(at + 5u);
    let color = light_luminance(light_radiance(at));
    let sin_squared = tables[at + 8u];
    let is_disc = light_kind(at) == LIGHT_DISC;
    let irradiance = select(color, color * PI * sin_squared, is_disc);
    if (!has_normal(normal)) {
        return irradiance;
    }
    return irradiance * clamp(dot(normal, direction) + sqrt(sin_squared), 0.0, 1.0);
}

fn disc_light_direction(at: u32, u: vec2f) -> vec3f {
    return uniform_cone(light_vector(at + 5u), tables[at + 9u], u);
}

// Tests the chord, whose square is 2(1 − cos θ): a cosine is not exact enough for the rim of the sun.
fn disc_light_covers(at: u32, direction: vec3f) -> bool {
    let chord = direction - light_vector(at + 5u);
    return dot(chord, chord) <= 2.0 * tables[at + 9u];
}

fn disc_light_radiance(at: u32, direction: vec3f) -> vec3f {
    return select(vec3f(0.0), light_radiance(at), disc_light_covers(at, direction));
}

fn disc_light_pdf(at: u32, direction: vec3f) -> f32 {
    return select(0.0, uniform_cone_pdf(tables[at + 9u]), disc_light_covers(at, direction));
}
