// Point light with a cone, which no ray meets. Words: position, then as a spherical light's.

fn spot_light_importance(at: u32, point: vec3f, normal: vec3f) -> f32 {
    let offset = light_vector(at + 5u) - point;
    let distance = length(offset);
    if (distance <= 0.0) {
        return 0.0;
    }
    let direction = offset / distance;
    let cone = light_cone(at);
    let lit = cone_falloff(cone, -dot(direction, cone.axis)) * light_cosine(normal, direction);
    if (lit <= 0.0) {
        return 0.0;
    }
    return max(light_luminance(light_radiance(at)) * lit / distance / distance, LEAST_IMPORTANCE);
}

fn spot_light_sample(at: u32, point: vec3f) -> LightSample {
    let offset = light_vector(at + 5u) - point;
    let distance = length(offset);
    if (distance <= 0.0) {
        return no_light_sample();
    }
    let direction = offset / distance;
    let cone = light_cone(at);
    let falloff = cone_falloff(cone, -dot(direction, cone.axis));
    if (falloff <= 0.0) {
        return no_light_sample();
    }
    return light_sample_delta(direction, distance, light_radiance(at) * falloff / distance / distance);
}
