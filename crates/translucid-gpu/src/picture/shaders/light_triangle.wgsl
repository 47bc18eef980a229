// A triangle that emits on the side from which its corners are seen counter-clockwise, drawn uniformly in area. Words: corners,
// mean radiance, and where its emission varies its number among the scene's triangles, else −1.

fn triangle_light_at(triangle: u32) -> u32 {
    return lights_at + light_number(9u) + triangle * LIGHT_TRIANGLE_WORDS;
}

// Estimate of the irradiance; 0 only from behind and if the triangle is below the horizon.
fn triangle_light_importance(triangle: u32, point: vec3f, normal: vec3f) -> f32 {
    let at = triangle_light_at(triangle);
    let a = light_vector(at) - point;
    let b = light_vector(at + 3u) - point;
    let c = light_vector(at + 6u) - point;
    // Twice the area times the height above the triangle
    let elevation = triangle_light_elevation(at, point);
    let middle = (a + b + c) / 3.0;
    let radius = max(max(distance(a, middle), distance(b, middle)), distance(c, middle));
    let distance = max(length(middle), radius);
    if (elevation <= 0.0 || distance <= 0.0) {
        return 0.0;
    }
    var cosine = 1.0;
    if (has_normal(normal)) {
        cosine = min(max(max(dot(normal, a), dot(normal, b)), dot(normal, c)) / distance, 1.0);
    }
    if (cosine <= 0.0) {
        return 0.0;
    }
    let intensity = 0.5 * light_luminance(light_vector(at + 9u)) * (elevation / distance);
    return max(intensity / distance / distance * cosine, LEAST_IMPORTANCE);
}

fn triangle_light_elevation(at: u32, point: vec3f) -> f32 {
    let a = light_vector(at);
    return dot(point - a, cross(light_vector(at + 3u) - a, light_vector(at + 6u) - a));
}

fn triangle_light_surface(triangle: u32) -> f32 {
    return tables[triangle_light_at(triangle) + 12u];
}

// Barycentric coordinates uniform in area [Heitz 2019, "A Low-Distortion Map Between Triangle and Square"].
fn triangle_light_place(u: vec2f) -> vec2f {
    return select(vec2f(u.x - 0.5 * u.y, 0.5 * u.y), vec2f(0.5 * u.x, u.y - 0.5 * u.x), u.y > u.x);
}

fn triangle_light_sample(triangle: u32, point: vec3f, u: vec2f) -> LightSample {
    let at = triangle_light_at(triangle);
    let a = light_vector(at);
    let b = triangle_light_place(u);
    // From the corner a, so that far from the origin the offsets keep their digits
    let offset = (a - point) + (light_vector(at + 3u) - a) * b.x + (light_vector(at + 6u) - a) * b.y;
    let distance = length(offset);
    let pdf = triangle_light_pdf(triangle, point, offset);
    if (distance <= 0.0 || pdf <= 0.0) {
        return no_light_sample();
    }
    var sample = light_sample_toward(offset / distance, distance, light_vector(at + 9u), pdf);
    sample.triangle = triangle;
    return sample;
}

// Solid-angle density at a place of this offset: distance² / (area × cosine); 0 from behind.
//
// The height of the point above the triangle is taken from a corner: from a place found by a ray it would have few digits at a
// slant.
fn triangle_light_pdf(triangle: u32, point: vec3f, offset: vec3f) -> f32 {
    let at = triangle_light_at(triangle);
    let elevation = triangle_light_elevation(at, point);
    if (elevation <= 0.0) {
        return 0.0;
    }
    let distance_squared = dot(offset, offset);
    return 2.0 * distance_squared * (sqrt(distance_squared) / elevation);
}
