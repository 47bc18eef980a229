// Parallel beam of finite radius, which no ray meets. Words: irradiance, origin, direction of travel, radius.

fn beam_light_importance(at: u32, point: vec3f, normal: vec3f) -> f32 {
    let sample = beam_light_sample(at, point);
    return select(0.0, light_luminance(sample.radiance) * light_cosine(normal, sample.direction), sample.is_usable);
}

fn beam_light_sample(at: u32, point: vec3f) -> LightSample {
    let offset = point - light_vector(at + 5u);
    let direction = light_vector(at + 8u);
    let distance = dot(offset, direction);
    if (distance > 0.0 && length(offset - direction * distance) <= tables[at + 11u]) {
        return light_sample_delta(-direction, distance, light_radiance(at));
    }
    return no_light_sample();
}
